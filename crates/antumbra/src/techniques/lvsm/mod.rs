//! `lvsm`: layered variance shadow maps.
//!
//! Andrew Lauritzen, Michael McCool, "Layered Variance Shadow Maps", Graphics Interface 2008. The light's range of depth is
//! cut into layers, each a variance shadow map of depths clamped to it: what lies nearer than the layer becomes one occluder
//! at its near end, and two moments describe that exactly. So light no longer bleeds from layer to layer, and since a
//! layer covers little depth, 16-bit fixed point suffices. A receiver reads its own layer alone, and two where they overlap.
//!
//! Layers are placed at equal steps, by hand, or by Lloyd's relaxation (section 4) on a histogram of second occluders, all
//! on the GPU from the one depth map; the first frame converges at once, and later frames go on from its splits.
//!
//! Where we depart from the paper, and why:
//! - A layer's two moments are a word of their own (16-bit) rather than half of a four-channel texel: the memory is the
//!   same, and a receiver reads half as much.
//! - The overlap δ follows from the kernel: what a plane at 45° spans under it.
//! - Printed as it is, the relaxation places means *on* second occluders; the split must lie behind one to clamp it. Splits
//!   are shifted by 1.5 δ, and keep gaps of 3 δ. Background is left out of the histogram. Clusters teleport by inertia
//!   rather than for want of any weight (see `blocks/lloyd`). On `overlap` with four layers this is what takes the leak
//!   to .0013, a twentieth of `vsm`'s.
//!
//! # Limits
//! Light still bleeds among occluders of one layer: in foliage, whose depths have no gaps, more layers help slowly. Receivers
//! steeper than 45° to the light may show faint lines where layers meet. Narrow layers raise the least variance (eq. 7).
//! The width is in texels, the same for every occluder.

use crate::blocks::lloyd::{Lloyd, Relaxation};
use crate::blocks::packed_map::Packing;
use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{
    Gpu, Recorder, Span, compute_pipeline, create_uniform, read_write_entry, uniform_entry, write_uniform,
};
use crate::shaders;
use crate::techniques::filterable::{BasisShaders, Filterable, FrameMap};

pub(crate) mod gpu_types;
mod params;

use gpu_types::{LvsmHistogramUniform, LvsmUniform};
pub use params::{LayerPlacement, LvsmParams, LvsmShow};

/// Layered variance shadow maps.
#[derive(Debug)]
pub struct Lvsm {
    map: Filterable<LvsmUniform>,
    lloyd: Lloyd,
    histogram_layout: wgpu::BindGroupLayout,
    histogram_uniform: wgpu::Buffer,
    histogram_group: wgpu::BindGroup,
    /// For light maps of one sample a texel, and of several.
    histogram_pipelines: [Option<wgpu::ComputePipeline>; 2],
    /// Whether the prepared frame relaxes, and how many neighbourhoods a side it looks at.
    relaxes: Option<u32>,
}

/// The most neighbourhoods along a side that the histogram takes; its integers hold this many.
const MAX_NEIGHBOURHOODS: u32 = 512;

/// Threads along each side of a workgroup of the histogram.
const TILE: u32 = 8;

impl Technique for Lvsm {
    const KIND: TechniqueKind = TechniqueKind::Lvsm;
    type Params = LvsmParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::LVSM_ENCODE,
            encode_multisampled: shaders::LVSM_ENCODE_MULTISAMPLED,
            resolve: shaders::LVSM_RESOLVE,
        };
        let lloyd = Lloyd::new(gpu);
        let histogram_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra second occluders"),
            entries: &[uniform_entry(0, wgpu::ShaderStages::COMPUTE), read_write_entry(1, wgpu::ShaderStages::COMPUTE)],
        });
        let histogram_uniform = create_uniform::<LvsmHistogramUniform>(gpu, "antumbra second occluders");
        let histogram_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra second occluders"),
            layout: &histogram_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: histogram_uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: lloyd.histogram().as_entire_binding() },
            ],
        });
        Ok(Self {
            map: Filterable::new(gpu, Self::KIND, shaders),
            lloyd,
            histogram_layout,
            histogram_uniform,
            histogram_group,
            histogram_pipelines: [None, None],
            relaxes: None,
        })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &LvsmParams) -> Result<(), Error> {
        let map = self.map.prepare_map(gpu, frame, &params.settings())?;
        let overlap = automatic_overlap(&map, params);
        self.place(gpu, &map, params, overlap)?;
        let packing = Packing::from(params.storage);
        let uniform = LvsmUniform {
            layer_count: params.layers,
            overlap,
            layer_step: packing.step(),
            // Without overlap there is nothing to blend over.
            blends: (params.blend && overlap > 0.0).into(),
            shows_layers: (params.show == LvsmShow::Layers).into(),
            ..LvsmUniform::default()
        };
        self.map.prepare_basis(gpu, 2 * params.layers, packing, 0.0, &uniform, Some(self.lloyd.splits()));
        if self.relaxes.is_some() {
            let several = map.sample_count > 1;
            let pipeline = &mut self.histogram_pipelines[usize::from(several)];
            if pipeline.is_none() {
                let wgsl = if several { shaders::LVSM_HISTOGRAM_MULTISAMPLED } else { shaders::LVSM_HISTOGRAM };
                let layouts = [self.map.encode_layout(), &self.histogram_layout];
                *pipeline = Some(compute_pipeline(gpu, "second occluders", wgsl, &layouts));
            }
        }
        Ok(())
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.map.record_map(recorder, frame);
        if let Some(neighbourhoods) = self.relaxes {
            self.lloyd.record_clear(recorder);
            recorder.compute("splits", Span::First, |pass| {
                let several = self.map.is_multisampled();
                pass.set_pipeline(self.histogram_pipelines[usize::from(several)].as_ref().expect("made by prepare"));
                pass.set_bind_group(0, self.map.encode_group(), &[]);
                pass.set_bind_group(1, &self.histogram_group, &[]);
                pass.dispatch_workgroups(neighbourhoods.div_ceil(TILE), neighbourhoods.div_ceil(TILE), 1);
            });
            self.lloyd.record(recorder, "splits", Span::Last);
        }
        self.map.record_basis(recorder);
    }

    fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes() + if self.relaxes.is_some() { self.lloyd.memory_bytes() } else { 0 }
    }
}

/// δ of section 3.4, in t: the depth that a plane at 45° to the light spans under the kernel, in the middle of the range;
/// no more than leaves every layer of an even split its own middle half.
fn automatic_overlap(map: &FrameMap, params: &LvsmParams) -> f32 {
    let view = &map.view;
    let range_m = view.far_m - view.near_m;
    let middle_m = 0.5 * (view.near_m + view.far_m);
    let texel_m = view.texel_in_plane * if view.perspective == 1 { middle_m } else { 1.0 };
    let reach_texels = 0.5 * params.kernel_size + 1.0;
    (params.overlap * reach_texels * texel_m / range_m).min(0.25 / params.layers as f32)
}

impl Lvsm {
    /// Sets the splits, or makes ready for the GPU to find them.
    fn place(&mut self, gpu: &Gpu, map: &FrameMap, params: &LvsmParams, overlap: f32) -> Result<(), Error> {
        let split_count = params.layers - 1;
        self.relaxes = None;
        match params.placement {
            _ if split_count == 0 => {}
            LayerPlacement::Uniform => {
                let splits: Vec<f32> = (1..params.layers).map(|i| i as f32 / params.layers as f32).collect();
                self.lloyd.set(gpu, &splits);
            }
            LayerPlacement::Manual => {
                let depths_m = params.split_depths.values();
                if depths_m.len() != split_count as usize || depths_m.windows(2).any(|pair| pair[0] >= pair[1]) {
                    return Err(Error::BadFrame {
                        technique: Self::KIND.name(),
                        what: "`split_depths`",
                        had: format!("`{}`", params.split_depths),
                        needed: format!("{split_count} ascending depths in metres for {} layers", params.layers),
                    });
                }
                let view = &map.view;
                let t_of = |depth_m: &f32| ((depth_m - view.near_m) / (view.far_m - view.near_m)).clamp(0.0, 1.0);
                let splits: Vec<f32> = depths_m.iter().map(t_of).collect();
                self.lloyd.set(gpu, &splits);
            }
            LayerPlacement::Lloyd => {
                let stride = (map.size.max_element().div_ceil(MAX_NEIGHBOURHOODS)).max(2);
                write_uniform(
                    gpu,
                    &self.histogram_uniform,
                    &LvsmHistogramUniform { stride, ..LvsmHistogramUniform::default() },
                );
                let how = Relaxation {
                    iterations: 1,
                    moved_count: params.splits_per_frame,
                    shift: 1.5 * overlap,
                    least_gap: 3.0 * overlap,
                };
                self.lloyd.prepare(gpu, split_count, &how);
                self.relaxes = Some(map.size.max_element().div_ceil(stride));
            }
        }
        Ok(())
    }
}
