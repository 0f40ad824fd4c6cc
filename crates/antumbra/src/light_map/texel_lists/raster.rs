//! Passes that draw casters into lists.

use glam::{UVec2, Vec2, Vec3};

use super::gpu_types::{Gathered, ListSurface, ListView, Surface, Triangles};
use super::options::{COVERAGE_SAMPLES, Gather, ListOptions};
use super::storage::Storage;
use crate::contract::{MeshCaster, Opacity, SurfaceTexture};
use crate::gpu::{
    Bindings, DrawPipeline, Gpu, NoDepth, Recorder, Span, Stage, create_uniform, white_texture, write_uniform,
};
use crate::light_map::caster_depth::{Bound, INSTANCES, POSITIONS, UVS, ViewSides, caster_primitives, make_no_uvs};
use crate::light_map::caster_surface::SurfaceValues;
use crate::light_map::light_view::LightView;
use crate::shaders;

/// Mip levels of a mask that the fragment stage can reach.
const MIP_LEVELS: u32 = 7;

/// Kind of draw of a caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Draw {
    /// Opaque, one sample per texel.
    Opaque = 0,
    /// With its texture or colour, one sample per texel.
    Surface = 1,
    /// Opaque, with coverage.
    Covered = 2,
}

/// Operation of a geometry pass on its fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    Count = 0,
    Collect = 1,
    Link = 2,
}

/// Pipelines that draw casters into lists.
#[derive(Debug)]
pub(super) struct ListRaster {
    layout: wgpu::BindGroupLayout,
    surface_layout: wgpu::BindGroupLayout,
    triangles_layout: wgpu::BindGroupLayout,
    /// Pipelines by [`Pass`], by [`Draw`], and by whether the mesh is closed.
    pipelines: [[[wgpu::RenderPipeline; 2]; 3]; 3],
    view_uniform: wgpu::Buffer,
    white: wgpu::TextureView,
    sampler: wgpu::Sampler,
    no_uvs: Option<wgpu::Buffer>,
    /// Kind of draw and bind group, one per caster: its surface, or its triangles if they are drawn with coverage.
    caster_groups: Vec<(Draw, Option<wgpu::BindGroup>)>,
    /// Whether the view may see the caster, one per caster.
    is_in_view: Vec<bool>,
}

impl ListRaster {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let layout = Gathered::layout(gpu);
        let triangles_layout = Triangles::layout(gpu);
        let surface_layout = Surface::layout(gpu);
        let layouts = [&layout, &triangles_layout, &surface_layout];
        Self {
            pipelines: [Pass::Count, Pass::Collect, Pass::Link].map(|pass| {
                [Draw::Opaque, Draw::Surface, Draw::Covered]
                    .map(|draw| [false, true].map(|closed| raster_pipeline(gpu, layouts, pass, draw, closed)))
            }),
            layout,
            surface_layout,
            triangles_layout,
            view_uniform: create_uniform::<ListView>(gpu, "antumbra list view"),
            white: white_texture(gpu),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
            no_uvs: None,
            caster_groups: Vec::new(),
            is_in_view: Vec::new(),
        }
    }

    /// Uploads a frame's parameters and returns the bind group of its passes.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        view: &LightView,
        casters: &[MeshCaster<'_>],
        storage: &Storage,
    ) -> wgpu::BindGroup {
        let Storage { options, cursors, fragments, counters, nodes, links, .. } = storage;
        write_uniform(stage, &self.view_uniform, &list_view(view, options, stage.anchor()));
        self.caster_groups = self.caster_groups(stage, casters, options.samples);
        let sides = ViewSides::of(&view.clip_from_world());
        self.is_in_view.clear();
        self.is_in_view.extend(casters.iter().map(|caster| sides.may_hold(&caster.bounds)));
        make_no_uvs(stage, &mut self.no_uvs, casters);
        let gathered = if options.gather == Gather::Linked { nodes } else { fragments };
        let gathered = Gathered { list_view: &self.view_uniform, cursors, fragments: gathered, counters, links };
        gathered.group(stage, &self.layout)
    }

    /// Returns the kind of draw and the bind group of each caster.
    fn caster_groups(
        &self,
        stage: &Stage<'_>,
        casters: &[MeshCaster<'_>],
        samples: u32,
    ) -> Vec<(Draw, Option<wgpu::BindGroup>)> {
        // Casters of a set have their triangles in the same buffers.
        let mut covered: Option<([&wgpu::Buffer; 2], wgpu::BindGroup)> = None;
        (casters.iter())
            .map(|caster| {
                let buffers = [caster.positions, caster.indices];
                let known = covered.as_ref().filter(|(of, _)| *of == buffers).map(|(_, group)| group);
                let (draw, group) = self.caster_group(stage, caster, samples, known);
                if let (Draw::Covered, Some(group)) = (draw, &group) {
                    covered = Some((buffers, group.clone()));
                }
                (draw, group)
            })
            .collect()
    }

    /// Returns the kind of draw and the bind group of a caster. Coverage needs triangles that shaders can read; `known` is an
    /// existing group of this caster's triangles.
    fn caster_group(
        &self,
        stage: &Stage<'_>,
        caster: &MeshCaster<'_>,
        samples: u32,
        known: Option<&wgpu::BindGroup>,
    ) -> (Draw, Option<wgpu::BindGroup>) {
        if let Some(surface) = self.surface(stage, &caster.opacity) {
            return (Draw::Surface, Some(surface));
        }
        let buffers = [caster.positions, caster.indices];
        if samples == 1 || !buffers.iter().all(|buffer| buffer.usage().contains(wgpu::BufferUsages::STORAGE)) {
            return (Draw::Opaque, None);
        }
        let [caster_positions, caster_indices] = buffers;
        let make = || Triangles { caster_positions, caster_indices }.group(stage, &self.triangles_layout);
        (Draw::Covered, Some(known.cloned().unwrap_or_else(make)))
    }

    fn surface(&self, stage: &Stage<'_>, opacity: &Opacity<'_>) -> Option<wgpu::BindGroup> {
        let SurfaceValues { factor, cutoff, coverage } = SurfaceValues::of(opacity)?;
        let texture = opacity.texture();
        let mips = texture.map_or_else(Vec::new, |texture| mip_views(stage, texture));
        let size_texels =
            texture.map_or(Vec2::ONE, |t| Vec2::new(t.view.texture().width() as f32, t.view.texture().height() as f32));
        let mip_count = 1 + mips.len() as u32;
        let surface = ListSurface { factor, size_texels, cutoff, coverage, mip_count, ..ListSurface::default() };
        let uniform = stage.uniform("antumbra list surface", &surface);
        let first = texture.map_or(&self.white, |t| t.view);
        let mip = |level: usize| mips.get(level - 1).unwrap_or(first);
        let surface = Surface {
            surface: &uniform,
            surface_sampler: texture.map_or(&self.sampler, |t| t.sampler),
            surface_texture: first,
            surface_mip_1: mip(1),
            surface_mip_2: mip(2),
            surface_mip_3: mip(3),
            surface_mip_4: mip(4),
            surface_mip_5: mip(5),
            surface_mip_6: mip(6),
        };
        Some(surface.group(stage, &self.surface_layout))
    }

    /// Records a pass over all casters. Casters with coverage have a pass of their own, with more samples.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        (label, pass): (&'static str, Pass),
        storage: &Storage,
        group: &wgpu::BindGroup,
        casters: &[MeshCaster<'_>],
    ) {
        let is_drawn = |covered: bool| {
            self.caster_groups.iter().any(|(draw, _)| (*draw == Draw::Covered) == covered)
                && (!covered || storage.no_covered_depth.is_some())
        };
        let parts: Vec<bool> = [false, true].into_iter().filter(|covered| is_drawn(*covered)).collect();
        for (i, covered) in parts.iter().enumerate() {
            let no_depth = storage.no_covered_depth.as_ref().filter(|_| *covered).unwrap_or(&storage.no_depth);
            recorder.render_pass(label, Span::of(i, parts.len()), &[], no_depth.view(), None, |render| {
                let UVec2 { x, y } = storage.options.map_size;
                render.set_viewport(0.0, 0.0, x as f32, y as f32, 0.0, 1.0);
                render.set_scissor_rect(0, 0, x, y);
                render.set_bind_group(0, group, &[]);
                self.draw(render, storage, pass, *covered, casters);
            });
        }
    }

    fn draw(
        &self,
        render: &mut wgpu::RenderPass<'_>,
        storage: &Storage,
        pass: Pass,
        covered: bool,
        casters: &[MeshCaster<'_>],
    ) {
        let mut bound = Bound::default();
        let mut bound_group = None;
        for ((caster, (draw, group)), is_in_view) in casters.iter().zip(&self.caster_groups).zip(&self.is_in_view) {
            let is_empty = caster.index_count == 0 || caster.instance_count == 0;
            if is_empty || !is_in_view || covered != (*draw == Draw::Covered) {
                continue;
            }
            let closed = caster.closed && *draw != Draw::Surface && !storage.options.all_faces;
            bound.pipeline(render, &self.pipelines[pass as usize][*draw as usize][usize::from(closed)]);
            if covered {
                if bound_group.replace(group) != Some(group) {
                    render.set_bind_group(1, group, &[]);
                }
                bound.vertices(render, 0, caster.instances);
                render.draw(caster.index_range(), caster.instance_range());
                continue;
            }
            bound.vertices(render, 0, caster.instances);
            bound.vertices(render, 1, caster.positions);
            if *draw == Draw::Surface {
                render.set_bind_group(2, group, &[]);
                let uvs = match caster.opacity.texture() {
                    Some(texture) => texture.uvs,
                    _ => self.no_uvs.as_ref().expect("`prepare` creates it for such casters"),
                };
                bound.vertices(render, 2, uvs);
            }
            bound.indices(render, caster.indices);
            render.draw_indexed(caster.index_range(), 0, caster.instance_range());
        }
    }
}

/// Returns a view of each of the texture's mip levels from 1; none unless the texture is 2D with one layer, so that its
/// levels are those of the host's view.
fn mip_views(stage: &Stage<'_>, texture: &SurfaceTexture<'_>) -> Vec<wgpu::TextureView> {
    let whole = texture.view.texture();
    if whole.dimension() != wgpu::TextureDimension::D2 || whole.depth_or_array_layers() != 1 {
        return Vec::new();
    }
    (1..whole.mip_level_count().min(MIP_LEVELS))
        .map(|level| {
            stage.create_view(
                whole,
                &wgpu::TextureViewDescriptor {
                    base_mip_level: level,
                    mip_level_count: Some(1),
                    ..wgpu::TextureViewDescriptor::default()
                },
            )
        })
        .collect()
}

fn list_view(view: &LightView, options: &ListOptions, anchor_in_world: Vec3) -> ListView {
    ListView {
        clip_from_world: view.clip_from_world(),
        origin_in_world: view.frame.center,
        capacity: options.capacity,
        axis_in_world: view.frame.axis,
        colored: options.colored.into(),
        map_size: options.map_size,
        open_slope: options.open_offset.slope,
        open_m: options.open_offset.m,
        near_m: view.near_m,
        far_m: view.far_m,
        anchor_in_world,
        ..ListView::default()
    }
}

/// Creates a pipeline; `layouts` are those of groups 0, 1 and 2.
fn raster_pipeline(
    gpu: &Gpu,
    layouts: [&wgpu::BindGroupLayout; 3],
    pass: Pass,
    draw: Draw,
    closed: bool,
) -> wgpu::RenderPipeline {
    let [raster, covered, surface] = layouts.map(Some);
    let (layouts, vertex_buffers): (&[_], &[_]) = match draw {
        Draw::Opaque => (&[raster], &[Some(INSTANCES), Some(POSITIONS)]),
        Draw::Covered => (&[raster, covered], &[Some(INSTANCES)]),
        Draw::Surface => (&[raster, None, surface], &[Some(INSTANCES), Some(POSITIONS), Some(UVS)]),
    };
    let vertex = match (draw, closed) {
        (Draw::Surface, _) => "vertex_surface",
        (Draw::Opaque, true) => "vertex_closed",
        (Draw::Opaque, false) => "vertex_open",
        (Draw::Covered, true) => "vertex_covered_closed",
        (Draw::Covered, false) => "vertex_covered_open",
    };
    let fragment = match (pass, draw) {
        (Pass::Count, Draw::Opaque) => "count_opaque",
        (Pass::Count, Draw::Surface) => "count_surface",
        (Pass::Count, Draw::Covered) => "count_covered",
        (Pass::Collect, Draw::Opaque) => "collect_opaque",
        (Pass::Collect, Draw::Surface) => "collect_surface",
        (Pass::Collect, Draw::Covered) => "collect_covered",
        (Pass::Link, Draw::Opaque) => "link_opaque",
        (Pass::Link, Draw::Surface) => "link_surface",
        (Pass::Link, Draw::Covered) => "link_covered",
    };
    DrawPipeline {
        label: "antumbra list raster",
        wgsl: shaders::TEXEL_LISTS_RASTER,
        layouts,
        vertex,
        vertex_buffers,
        fragment: Some(fragment),
        // Counter-clockwise from outside: the remaining faces are those that face away from the light.
        primitive: caster_primitives(gpu, closed.then_some(wgpu::Face::Front)),
        depth: Some(NoDepth::state()),
        sample_count: if draw == Draw::Covered { COVERAGE_SAMPLES } else { 1 },
        ..DrawPipeline::default()
    }
    .create(gpu)
}
