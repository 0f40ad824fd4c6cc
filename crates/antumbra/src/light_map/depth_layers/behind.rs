//! Layers behind a depth map that another pass draws: depth only.

use super::NearerLayer;
use crate::contract::MeshCaster;
use std::sync::Arc;

use crate::gpu::{Bindings, Gpu, Lease, Recorder, Scratch, Span, Stage, array_view, slice_views};
use crate::light_map::caster_depth::{CasterDepth, CasterProgram, CasterProgramDescriptor};
use crate::shaders;

/// Nearest layers behind a depth map.
#[derive(Debug)]
pub(crate) struct LayersBehind {
    program: CasterProgram,
    nearer_layout: wgpu::BindGroupLayout,
    maps: Option<Maps>,
}

#[derive(Debug)]
struct Maps {
    size: u32,
    array: (Arc<wgpu::Texture>, wgpu::TextureView),
    slices: Vec<wgpu::TextureView>,
    /// Bind groups of the layer before each drawn slice.
    nearer: Vec<wgpu::BindGroup>,
}

impl LayersBehind {
    /// Creates the pipelines, for maps that `casters` draws.
    pub(crate) fn new(gpu: &Gpu, casters: &CasterDepth) -> Self {
        let nearer_layout = NearerLayer::layout(gpu);
        let program = casters.program(
            gpu,
            &CasterProgramDescriptor {
                label: "antumbra layer behind",
                opaque_wgsl: shaders::DEPTH_LAYERS_LAYER_OPAQUE,
                cutout_wgsl: shaders::DEPTH_LAYERS_LAYER_CUTOUT,
                opaque_fragment: Some("next_depth"),
                cutout_fragment: "next_depth",
                constants: &[],
                layout: Some(&nearer_layout),
                targets: &[],
                depth_compare: wgpu::CompareFunction::Greater,
                depth_write: true,
                front_faces_of_solids: true,
                sample_count: 1,
            },
        );
        Self { program, nearer_layout, maps: None }
    }

    /// Allocates `layers` maps of `size`² texels; for 0 layers, a dummy that is never drawn or read.
    ///
    /// Reuses them while their number and size are unchanged: callers with another `nearest` must [release](Self::release) them first.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        lease: &Lease,
        nearest: &wgpu::TextureView,
        size: u32,
        layers: u32,
    ) {
        let size = if layers == 0 { 1 } else { size };
        if self.maps.as_ref().is_some_and(|maps| maps.size == size && maps.nearer.len() == layers as usize) {
            return;
        }
        let texture = lease.texture(&stage.device, Scratch::LayersBehind, &descriptor(size, layers));
        let slices = slice_views(stage, &texture);
        let before = std::iter::once(nearest).chain(&slices);
        let nearer = before
            .take(layers as usize)
            .map(|layer| NearerLayer { nearer_layer: layer }.cached_group(stage, &self.nearer_layout))
            .collect();
        self.maps = Some(Maps { size, array: (Arc::clone(&texture), array_view(stage, &texture)), slices, nearer });
    }

    /// Releases the maps, before maps of another kind.
    pub(crate) fn release(&mut self) {
        self.maps = None;
    }

    /// Bytes of `layers` maps of `size`² texels.
    pub(crate) fn bytes_of(size: u32, layers: u32) -> u64 {
        u64::from(size).pow(2) * u64::from(layers) * 4
    }

    /// `texture_depth_2d_array`, one slice per layer.
    pub(crate) fn array(&self) -> &wgpu::TextureView {
        &self.maps.as_ref().expect("prepare comes before use").array.1
    }

    /// Draws every layer in the first of `casters`' views.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, casters: &CasterDepth, meshes: &[MeshCaster<'_>]) {
        let Some(maps) = &self.maps else { return };
        for (i, (slice, nearer)) in maps.slices.iter().zip(&maps.nearer).enumerate() {
            let span = Span::of(i, maps.nearer.len());
            recorder.depth_pass("layers behind", span, slice, CasterDepth::CLEAR_DEPTH, |pass| {
                pass.set_bind_group(2, nearer, &[]);
                casters.draw_with(&self.program, pass, 0, meshes);
            });
        }
    }

    /// Views of the drawn layers.
    pub(crate) fn drawn(&self) -> Vec<wgpu::TextureView> {
        self.maps.as_ref().map(|maps| maps.slices[..maps.nearer.len()].to_vec()).unwrap_or_default()
    }

    #[cfg(test)]
    pub(crate) fn texture(&self) -> &wgpu::Texture {
        &self.maps.as_ref().expect("prepare comes before use").array.0
    }
}

fn descriptor(size: u32, layers: u32) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some("antumbra layers behind"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers.max(1) },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: CasterDepth::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    }
}
