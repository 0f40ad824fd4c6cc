//! Layers written while casters are drawn, one render target per word of the packed map.
//!
//! Lauritzen and McCool 2008, section 5: all layers in one pass by multiple render targets. The paper says that after a fast
//! depth-only pass, such a pass costs the same for any scene. WebGPU's default limits allow eight targets of 32 bits: eight
//! layers of 16-bit moments in one pass over the casters, more in two.
//!
//! With relaxed splits, a depth-only pass draws the map first, because a frame's splits depend on the same frame's depths.

use super::gpu_types::{LayerDraw, LvsmUniform};
use crate::contract::MeshCaster;
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings};
use crate::light_map::caster_depth::{CasterDepth, CasterProgram, CasterProgramDescriptor};
use crate::primitives::packed_map::{PackedMap, Packing};
use crate::shaders;
use crate::techniques::filterable::{Filterable, PreparedBasis};

bindings! {
    struct LayerTarget = "layer targets", FRAGMENT, group 2 of [LVSM_TARGETS_OPAQUE, LVSM_TARGETS_CUTOUT] {
        0 light_view: Uniform,
        1 settings: Uniform,
        2 lvsm: Uniform,
        3 splits: Storage,
        4 draw: Uniform,
    }
}

/// Number of outputs of the shaders: WebGPU's default `max_color_attachments`; at four bytes each, also its default
/// `max_color_attachment_bytes_per_sample`.
const MAX_TARGETS: u32 = 8;

/// Returns the maximum number of targets of a draw on this device.
fn max_targets(gpu: &Gpu) -> usize {
    let limits = gpu.device.limits();
    let by_bytes = limits.max_color_attachment_bytes_per_sample / 4;
    MAX_TARGETS.min(limits.max_color_attachments).min(by_bytes).max(1) as usize
}

/// Programs that draw the casters once per eight words.
#[derive(Debug)]
pub(super) struct LayerTargets {
    layout: wgpu::BindGroupLayout,
    /// Programs keyed by the number of targets, and by whether depths are distances.
    programs: Vec<((usize, bool), CasterProgram)>,
}

/// Draws of one frame.
#[derive(Debug)]
pub(super) struct PreparedLayers {
    draws: Vec<Draw>,
    /// Word of texels without a caster.
    clear: wgpu::Color,
}

/// One pass over the casters.
#[derive(Debug)]
struct Draw {
    group: wgpu::BindGroup,
    /// Index of the draw's program in `programs`.
    program: usize,
    /// Range of words that the draw writes.
    words: std::ops::Range<usize>,
}

impl LayerTargets {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self { layout: LayerTarget::layout(gpu), programs: Vec::new() }
    }

    /// Prepares draws of every word of the map that `passes` has prepared as `basis`.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        passes: &Filterable<LvsmUniform>,
        basis: &PreparedBasis,
        casters: &CasterDepth,
        packing: Packing,
        splits: &wgpu::Buffer,
    ) -> PreparedLayers {
        // Background lies behind every layer: both moments are 1.
        let clear = wgpu::Color { r: f64::from(packing.word_of_ones()), ..wgpu::Color::TRANSPARENT };
        let word_count = basis.layer_views().len();
        let mut draws = Vec::new();
        let most = max_targets(stage);
        for first in (0..word_count).step_by(most) {
            let words = first..word_count.min(first + most);
            let program = self.program(stage, passes, casters, words.len());
            let draw =
                stage.uniform("antumbra layer draw", &LayerDraw { first_word: first as u32, ..LayerDraw::default() });
            let (light_view, settings, lvsm) = passes.uniforms();
            let group = LayerTarget { light_view, settings, lvsm, splits, draw: &draw }.group(stage, &self.layout);
            draws.push(Draw { group, program, words });
        }
        PreparedLayers { draws, clear }
    }

    /// Returns the index of the program with `target_count` targets, and compiles it if it is missing.
    fn program(
        &mut self,
        gpu: &Gpu,
        passes: &Filterable<LvsmUniform>,
        casters: &CasterDepth,
        target_count: usize,
    ) -> usize {
        let key = (target_count, passes.is_distance());
        if let Some(made) = self.programs.iter().position(|(made_for, _)| *made_for == key) {
            return made;
        }
        let targets = vec![Some(PackedMap::FORMAT.into()); target_count];
        let descriptor = CasterProgramDescriptor {
            label: "antumbra layers",
            opaque_wgsl: shaders::LVSM_TARGETS_OPAQUE,
            cutout_wgsl: shaders::LVSM_TARGETS_CUTOUT,
            opaque_fragment: Some("fragment"),
            cutout_fragment: "fragment",
            constants: &passes.distance_constant(),
            layout: Some(&self.layout),
            targets: &targets,
            depth_compare: wgpu::CompareFunction::Greater,
            depth_write: true,
            front_faces_of_solids: false,
            sample_count: 1,
        };
        self.programs.push((key, casters.program(gpu, &descriptor)));
        self.programs.len() - 1
    }

    /// Draws the casters into the words of `views`, and clears and redraws `depth` with the same depths.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        depth: &wgpu::TextureView,
        views: &[wgpu::TextureView],
        casters: &CasterDepth,
        meshes: &[MeshCaster<'_>],
        prepared: &PreparedLayers,
    ) {
        let PreparedLayers { draws, clear } = prepared;
        let cleared = |value| wgpu::Operations { load: wgpu::LoadOp::Clear(value), store: wgpu::StoreOp::Store };
        let depth_ops =
            wgpu::Operations { load: wgpu::LoadOp::Clear(CasterDepth::CLEAR_DEPTH), store: wgpu::StoreOp::Store };
        for (i, draw) in draws.iter().enumerate() {
            let attached = |view| {
                let ops = cleared(*clear);
                Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
            };
            let targets: Vec<_> = views[draw.words.clone()].iter().map(attached).collect();
            let span = Span::of(i, draws.len());
            recorder.render_pass("layers", span, &targets, depth, Some(depth_ops), |pass| {
                pass.set_bind_group(2, &draw.group, &[]);
                casters.draw_with(&self.programs[draw.program].1, pass, 0, meshes);
            });
        }
    }
}
