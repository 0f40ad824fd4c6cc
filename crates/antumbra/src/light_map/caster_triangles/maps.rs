//! Depth maps that also store the id of each texel's triangle. Triangles narrower than a texel are drawn a texel
//! wide: maps give candidates, and exact tests against the triangles decide.

use std::ops::Range;
use std::sync::Arc;

use glam::Mat4;

use super::CasterTriangles;
use crate::contract::{Error, MeshCaster};
use crate::gpu::{
    Bindings, DrawPipeline, Gpu, Lease, Recorder, Scratch, Span, Stage, array_view, bindings, create_uniform,
    depth_state, gpu_structs, slice_views, write_uniform,
};
use crate::light_map::caster_depth::{CasterDepth, caster_primitives};
use crate::shaders;

gpu_structs! {
    /// Parameters that all maps share.
    pub(crate) struct TriangleMap {
        size_texels: f32,
        padding_0: f32,
        padding_1: f32,
        padding_2: f32,
    }
}

bindings! {
    struct Drawn = "triangle maps", VERTEX, group 2 of [CASTER_TRIANGLES_MAP] {
        0 triangle_map: Uniform,
        1 triangles: Storage,
    }
}

/// Maps of a batch of views, and the triangles that they show.
#[derive(Debug)]
pub(crate) struct TriangleMaps {
    triangles: CasterTriangles,
    casters: CasterDepth,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    uniform: wgpu::Buffer,
    group: Option<wgpu::BindGroup>,
    maps: Option<Maps>,
}

#[derive(Debug)]
struct Maps {
    size: u32,
    views: u32,
    /// Lease of both textures, which belong to the light while it holds the lease.
    lease: Lease,
    _textures: [Arc<wgpu::Texture>; 2],
    depth_array: wgpu::TextureView,
    depth_slices: Vec<wgpu::TextureView>,
    id_array: wgpu::TextureView,
    id_slices: Vec<wgpu::TextureView>,
}

impl TriangleMaps {
    /// Format of triangle ids.
    const ID_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

    /// Bytes per texel: depth and id.
    pub(crate) const TEXEL_BYTES: u64 = 8;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = Drawn::layout(gpu);
        let casters = CasterDepth::new(gpu);
        Self {
            pipeline: map_pipeline(gpu, [Some(casters.view_layout()), None, Some(&layout)]),
            triangles: CasterTriangles::new(gpu),
            casters,
            layout,
            uniform: create_uniform::<TriangleMap>(gpu, "antumbra triangle maps"),
            group: None,
            maps: None,
        }
    }

    /// Allocates `views` maps of `size` texels a side; if `clip_from_world` has more views, they are drawn in turn.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        technique: &'static str,
        clip_from_world: &[Mat4],
        casters: &[MeshCaster<'_>],
        [size, views]: [u32; 2],
        remedy: &'static str,
    ) -> Result<(), Error> {
        self.triangles.prepare(stage, technique, casters, remedy)?;
        self.casters.prepare(stage, clip_from_world, casters);
        write_uniform(stage, &self.uniform, &TriangleMap { size_texels: size as f32, ..TriangleMap::default() });
        let drawn = Drawn { triangle_map: &self.uniform, triangles: self.triangles.buffer() };
        self.group = Some(drawn.group(stage, &self.layout));
        if self.maps.as_ref().is_none_or(|maps| (maps.size, maps.views) != (size, views)) {
            // The old maps return their bytes to the budget before the new ones take theirs.
            self.maps = None;
            self.maps = Some(Maps::new(stage, size, views));
        }
        Ok(())
    }

    fn maps(&self) -> &Maps {
        self.maps.as_ref().expect("prepare comes before use")
    }

    /// `texture_depth_2d_array`, one slice per view.
    pub(crate) fn depth_array(&self) -> &wgpu::TextureView {
        &self.maps().depth_array
    }

    /// Views of single depth maps.
    pub(crate) fn depth_slices(&self) -> &[wgpu::TextureView] {
        &self.maps().depth_slices
    }

    /// `texture_2d_array<u32>` of the same size; see `triangles.wesl`.
    pub(crate) fn id_array(&self) -> &wgpu::TextureView {
        &self.maps().id_array
    }

    /// Whether no other light draws into the maps.
    pub(crate) fn are_own(&self) -> bool {
        self.maps.as_ref().is_some_and(|maps| maps.lease.is_own())
    }

    /// Triangles to which the ids refer.
    pub(crate) fn triangles(&self) -> &CasterTriangles {
        &self.triangles
    }

    /// Draws a range of views, the first into the first map.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, label: &'static str, views: Range<u32>) {
        let maps = self.maps();
        let count = views.len();
        for (slice, view) in views.enumerate() {
            let id = wgpu::RenderPassColorAttachment {
                view: &maps.id_slices[slice],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            };
            let depth_ops =
                wgpu::Operations { load: wgpu::LoadOp::Clear(CasterDepth::CLEAR_DEPTH), store: wgpu::StoreOp::Store };
            let (span, depth) = (Span::of(slice, count), &maps.depth_slices[slice]);
            recorder.render_pass(label, span, &[Some(id)], depth, Some(depth_ops), |pass| {
                pass.set_pipeline(&self.pipeline);
                self.casters.bind_view(pass, view);
                pass.set_bind_group(2, self.group.as_ref(), &[]);
                pass.draw(0..3 * self.triangles.count(), 0..1);
            });
        }
    }

    pub(crate) fn memory_bytes(&self) -> u64 {
        self.triangles.memory_bytes() + self.maps.as_ref().map_or(0, |maps| maps.lease.own_bytes())
    }
}

fn map_pipeline(gpu: &Gpu, layouts: [Option<&wgpu::BindGroupLayout>; 3]) -> wgpu::RenderPipeline {
    DrawPipeline {
        label: "antumbra triangle map",
        wgsl: shaders::CASTER_TRIANGLES_MAP,
        layouts: &layouts,
        targets: &[Some(TriangleMaps::ID_FORMAT.into())],
        primitive: caster_primitives(gpu, None),
        depth: Some(depth_state(CasterDepth::FORMAT, wgpu::CompareFunction::Greater, true)),
        ..DrawPipeline::default()
    }
    .create(gpu)
}

impl Maps {
    fn new(gpu: &Gpu, size: u32, views: u32) -> Self {
        let bytes = TriangleMaps::TEXEL_BYTES * u64::from(size).pow(2) * u64::from(views);
        let lease = Lease::new(&gpu.device, bytes);
        let texture = |scratch, label, format| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: views },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            lease.texture(&gpu.device, scratch, &descriptor)
        };
        let depth = texture(Scratch::TriangleDepths, "antumbra triangle maps' depths", CasterDepth::FORMAT);
        let id = texture(Scratch::TriangleIds, "antumbra triangle maps", TriangleMaps::ID_FORMAT);
        Self {
            size,
            views,
            depth_array: array_view(gpu, &depth),
            depth_slices: slice_views(gpu, &depth),
            id_array: array_view(gpu, &id),
            id_slices: slice_views(gpu, &id),
            _textures: [depth, id],
            lease,
        }
    }
}
