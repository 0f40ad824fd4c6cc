//! Nearest depth layers of the casters from one view or several: depth, and the gradient of depth along the surface.
//!
//! Layer 0 is the depth map. Each further layer holds the nearest surfaces behind the one before (depth peeling, Everitt
//! 2001), with one geometry pass per layer. Layers behind the first omit back faces of closed meshes, so that a layer is
//! another object and not a far side: a solid's front blocks all that its back would. Slices of both arrays are ordered by
//! view, then by layer.

use std::ops::Range;
use std::sync::Arc;

use glam::Mat4;

use crate::contract::MeshCaster;
use crate::gpu::{Bindings, Gpu, Lease, Recorder, Scratch, Span, Stage, array_view, bindings, slice_views, texels};
use crate::light_map::caster_depth::{CasterDepth, CasterProgram, CasterProgramDescriptor, DrawnView};
use crate::shaders;

pub(crate) mod behind;
#[cfg(test)]
mod tests;

bindings! {
    /// Input of a layer's pass: the layer before it.
    struct NearerLayer = "nearer layer", FRAGMENT, group 2 of [DEPTH_LAYERS_LAYER_OPAQUE, DEPTH_LAYERS_LAYER_CUTOUT] {
        0 nearer_layer: Texture(texels::DEPTH),
    }
}

/// Nearest depth layers of the casters.
#[derive(Debug)]
pub(crate) struct DepthLayers {
    casters: CasterDepth,
    /// Programs for maps with gradients, created on first use.
    programs: Option<Programs>,
    maps: Option<Maps>,
}

/// Dimensions of [`DepthLayers`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LayersSize {
    /// Texels along a side.
    pub(crate) size: u32,
    /// Number of views at a time.
    pub(crate) views: u32,
    pub(crate) layers: u32,
    /// Whether gradients are stored. Without them there is one layer, drawn without a fragment stage.
    pub(crate) with_gradients: bool,
}

#[derive(Debug)]
struct Programs {
    nearest: CasterProgram,
    /// Program of a layer behind another one.
    next: CasterProgram,
    nearer_layout: wgpu::BindGroupLayout,
}

#[derive(Debug)]
struct Maps {
    of: LayersSize,
    /// Lease of both textures.
    lease: Lease,
    /// Depths and gradients.
    #[cfg_attr(not(test), expect(dead_code, reason = "kept alive for the lights that share them"))]
    textures: [Arc<wgpu::Texture>; 2],
    depth_array: wgpu::TextureView,
    depth_slices: Vec<wgpu::TextureView>,
    gradient_array: wgpu::TextureView,
    gradient_slices: Vec<wgpu::TextureView>,
    /// Bind groups of the layer before each slice; `None` for nearest layers.
    nearer: Vec<Option<wgpu::BindGroup>>,
}

impl DepthLayers {
    /// Format of gradients, in units of `layer.wesl`: the rounding to 11 bits is small compared with the bias.
    pub(crate) const GRADIENT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self { casters: CasterDepth::new(gpu), programs: None, maps: None }
    }

    /// Rasteriser whose bindings the layers' pipelines share.
    pub(crate) fn casters(&self) -> &CasterDepth {
        &self.casters
    }

    /// Allocates maps, and uploads the views of the whole light: as many as the maps hold, or more that are drawn in turn.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        clip_from_world: &[Mat4],
        casters: &[MeshCaster<'_>],
        of: LayersSize,
    ) {
        let views: Vec<_> = clip_from_world.iter().copied().map(DrawnView::whole).collect();
        self.prepare_views(stage, &views, casters, of);
    }

    /// [`prepare`](Self::prepare) for any views.
    pub(crate) fn prepare_views(
        &mut self,
        stage: &Stage<'_>,
        views: &[DrawnView],
        casters: &[MeshCaster<'_>],
        of: LayersSize,
    ) {
        self.casters.prepare_views(stage, views, casters);
        if of.with_gradients && self.programs.is_none() {
            self.programs = Some(Programs::new(stage, &self.casters));
        }
        if self.maps.as_ref().is_none_or(|maps| maps.of != of) {
            // The old maps return their bytes to the budget before the new ones take theirs.
            self.maps = None;
            self.maps = Some(Maps::new(stage, of, self.programs.as_ref()));
        }
    }

    fn maps(&self) -> &Maps {
        self.maps.as_ref().expect("prepare comes before use")
    }

    /// `texture_depth_2d_array`, one slice per layer of a view.
    pub(crate) fn depth_array(&self) -> &wgpu::TextureView {
        &self.maps().depth_array
    }

    /// `texture_2d_array<f32>` of the same size; one texel without gradients.
    pub(crate) fn gradient_array(&self) -> &wgpu::TextureView {
        &self.maps().gradient_array
    }

    /// Views of single slices, for attachments.
    pub(crate) fn depth_slices(&self) -> &[wgpu::TextureView] {
        &self.maps().depth_slices
    }

    /// Whether no other light draws into the maps.
    pub(crate) fn are_own(&self) -> bool {
        self.maps.as_ref().is_some_and(|maps| maps.lease.is_own())
    }

    /// Current dimensions.
    pub(crate) fn size(&self) -> LayersSize {
        self.maps().of
    }

    /// Draws every layer of a range of views, the first view into the first map.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        label: &'static str,
        views: Range<u32>,
        casters: &[MeshCaster<'_>],
    ) {
        let maps = self.maps();
        let slice_count = views.len() * maps.of.layers as usize;
        for (slice, target) in maps.depth_slices.iter().enumerate().take(slice_count) {
            let (view, layer) = (views.start + slice as u32 / maps.of.layers, slice as u32 % maps.of.layers);
            let span = Span::of(slice, slice_count);
            let Some(programs) = self.programs.as_ref().filter(|_| maps.of.with_gradients) else {
                recorder.depth_pass(label, span, target, CasterDepth::CLEAR_DEPTH, |pass| {
                    self.casters.draw(pass, view, casters);
                });
                continue;
            };
            let gradient = wgpu::RenderPassColorAttachment {
                view: &maps.gradient_slices[slice],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            };
            let depth_ops =
                wgpu::Operations { load: wgpu::LoadOp::Clear(CasterDepth::CLEAR_DEPTH), store: wgpu::StoreOp::Store };
            recorder.render_pass(label, span, &[Some(gradient)], target, Some(depth_ops), |pass| {
                if layer > 0 {
                    pass.set_bind_group(2, maps.nearer[slice].as_ref(), &[]);
                }
                self.casters.draw_with(
                    if layer == 0 { &programs.nearest } else { &programs.next },
                    pass,
                    view,
                    casters,
                );
            });
        }
    }

    /// Bytes of the maps; 0 if lights share them.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.maps.as_ref().map_or(0, |maps| maps.lease.own_bytes())
    }

    /// Depths and gradients, for tests.
    #[cfg(test)]
    pub(crate) fn textures(&self) -> &[Arc<wgpu::Texture>; 2] {
        &self.maps().textures
    }
}

impl LayersSize {
    /// Bytes of all layers at one texel of a view.
    pub(crate) fn texel_bytes(self) -> u64 {
        u64::from(self.layers) * if self.with_gradients { 8 } else { 4 }
    }
}

impl Programs {
    fn new(gpu: &Gpu, casters: &CasterDepth) -> Self {
        let nearer_layout = NearerLayer::layout(gpu);
        let program = |entry_point, layout, front_faces_of_solids| {
            casters.program(
                gpu,
                &CasterProgramDescriptor {
                    label: "antumbra depth layer",
                    opaque_wgsl: shaders::DEPTH_LAYERS_LAYER_OPAQUE,
                    cutout_wgsl: shaders::DEPTH_LAYERS_LAYER_CUTOUT,
                    opaque_fragment: Some(entry_point),
                    cutout_fragment: entry_point,
                    constants: &[],
                    layout,
                    targets: &[Some(DepthLayers::GRADIENT_FORMAT.into())],
                    depth_compare: wgpu::CompareFunction::Greater,
                    depth_write: true,
                    front_faces_of_solids,
                    sample_count: 1,
                },
            )
        };
        Self {
            // With back faces: from inside a solid, its back is nearest.
            nearest: program("nearest", None, false),
            next: program("next", Some(&nearer_layout), true),
            nearer_layout,
        }
    }
}

impl Maps {
    fn new(stage: &Stage<'_>, of: LayersSize, programs: Option<&Programs>) -> Self {
        let lease = Lease::new(&stage.device, u64::from(of.size).pow(2) * u64::from(of.views) * of.texel_bytes());
        let texture = |scratch, label, format, size, slices| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: slices },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            };
            lease.texture(&stage.device, scratch, &descriptor)
        };
        let slices = of.views * of.layers;
        let (gradient_size, gradient_slices) = if of.with_gradients { (of.size, slices) } else { (1, 1) };
        let depth = texture(Scratch::DepthLayers, "antumbra depth layers", CasterDepth::FORMAT, of.size, slices);
        let gradients = texture(
            Scratch::LayerGradients,
            "antumbra depth layers' gradients",
            DepthLayers::GRADIENT_FORMAT,
            gradient_size,
            gradient_slices,
        );
        let depth_slices = slice_views(stage, &depth);
        let nearer = (0..slices)
            .map(|slice| {
                let layout = programs.filter(|_| slice % of.layers > 0).map(|programs| &programs.nearer_layout)?;
                let nearer = NearerLayer { nearer_layer: &depth_slices[slice as usize - 1] };
                Some(nearer.cached_group(stage, layout))
            })
            .collect();
        Self {
            of,
            depth_array: array_view(stage, &depth),
            depth_slices,
            gradient_array: array_view(stage, &gradients),
            gradient_slices: slice_views(stage, &gradients),
            textures: [depth, gradients],
            lease,
            nearer,
        }
    }
}
