//! `lvsm`: layered variance shadow maps.
//!
//! Andrew Lauritzen, Michael McCool, "Layered Variance Shadow Maps", Graphics Interface 2008. The light's depth range is cut
//! into layers. Each layer is a variance shadow map of depths clamped to it: geometry nearer than the layer becomes one
//! occluder at its near end, which two moments describe exactly, so light does not bleed between layers. A layer covers little
//! depth, so 16-bit fixed point suffices. A receiver reads only its own layer, or two where they overlap.
//!
//! Layers are placed at equal steps, by hand, or by Lloyd's relaxation (section 4) on a histogram, all on the GPU from the one
//! depth map. The first frame converges at once; later frames start from its splits, which move gradually to their new places.
//! The histogram counts where visible receivers need a split, weighted by the bleeding that it removes. With `relax_over = map`
//! it counts the map's second occluders, weighted by their variance, as in the paper.
//!
//! Differences from the paper; `lvsm:paper` restores the paper's choice wherever a parameter names it:
//! - A layer's two moments have a word of their own (16-bit) rather than half of a four-channel texel: the memory is the same,
//!   and a receiver reads half as much.
//! - Layers are encoded from the light map's depths in a pass after it, which the paper proposes beside its own multiple
//!   targets (`layers_by = targets`).
//! - The overlap δ follows from the kernel: the depth that a plane at 45° spans under it.
//! - Depth is measured along the world axis nearest to the light's, along which a floor has one depth. The paper uses the
//!   distance to the light (`depth_axis = distance`), which curves a floor.
//! - A layer's bound is that of depths in [0, 1] (`primitives/depth_basis/variance`), at most Chebyshev's: occluders at the
//!   layer's near end are black whatever the least variance, and surfaces far behind the receiver are not overrated. A single
//!   layer is `vsm`.
//! - Where layers overlap, both bounds are valid. A receiver on the split takes the smaller one, a receiver at distance δ that
//!   of its own layer, with a blend in between. The paper blends both bounds, which admits the worse one
//!   (`transition = mixed`).
//! - The relaxation considers what receivers see, as the paper's conclusion proposes. For each of up to 128² receivers, 25 taps
//!   of the map under its kernel give the bleeding, and a split behind the last occluder ends it. On `overlap` with four layers
//!   and a kernel of 9 of 384 texels, `umbra_leak` is .0007, all of which is in the exact truth too; `vsm` has .052. The bound
//!   and the world axis of depth contribute as much (.0012 without either).
//! - The least variance is that of each receiver's own plane (eq. 7 scales it to the layer). The paper has one σ²min for all
//!   (`least_variance = global`).
//! - Over the map, as published, the relaxation places means *on* second occluders, but a split must lie behind one to clamp
//!   it. Splits are therefore shifted by 1.5 δ (not with `relax_over = map_as_published`). The paper does not say whether
//!   background is an occluder: here it is ignored (`relax_background` counts it), and so is the optional clamp of weights
//!   (`relax_from`, `relax_up_to`).
//! - Splits keep gaps of 3 δ, and clusters teleport by inertia rather than only when they have no weight (see
//!   `primitives/lloyd`; `teleport = weight`).
//!
//! # Limits
//! Light still bleeds between occluders of one layer: in foliage, whose depths have no gaps, more layers help only slowly.
//! Receivers steeper than 45° to the light may show faint lines where layers meet. Narrow layers raise the least variance
//! (eq. 7). The width is in texels, the same for every occluder. Splits follow the camera, unless they are relaxed over the
//! map: they move by fractions of a layer while it moves, and the bleeding changes with them.

use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::primitives::packed_map::Packing;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::filterable::{BasisShaders, Filterable, FrameMap, Multisampling, PreparedBasis, ResolveBy};

pub(crate) mod gpu_types;
mod params;
mod targets;

use gpu_types::LvsmUniform;
mod relaxation;
#[cfg(test)]
mod tests;

pub use params::{
    LayerPlacement, LvsmBound, LvsmLayersBy, LvsmLeastVariance, LvsmParams, LvsmShow, LvsmTeleport, LvsmTransition,
    RelaxOver,
};
use relaxation::{LayerRelaxation, PreparedRelaxation};
use targets::{LayerTargets, PreparedLayers};

/// Passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedLvsm {
    basis: PreparedBasis,
    /// Passes that move the splits; `None` if the splits are given.
    relaxation: Option<PreparedRelaxation>,
    /// Draws that write the layers; `None` if layers are encoded from depth.
    layers: Option<PreparedLayers>,
}

/// Layered variance shadow maps.
#[derive(Debug)]
pub struct Lvsm {
    map: Filterable<LvsmUniform>,
    relaxation: LayerRelaxation,
    targets: LayerTargets,
}

impl Technique for Lvsm {
    const NAME: &'static str = "lvsm";
    type Params = LvsmParams;
    type Prepared = PreparedLvsm;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::LVSM_ENCODE,
            encode_multisampled: shaders::LVSM_ENCODE_MULTISAMPLED,
            resolve: shaders::LVSM_RESOLVE,
        };
        Ok(Self {
            map: Filterable::new(gpu, Self::NAME, shaders),
            relaxation: LayerRelaxation::new(gpu),
            targets: LayerTargets::new(gpu),
        })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &LvsmParams,
    ) -> Result<PreparedLvsm, Error> {
        let is_drawn = self.draws_layers(frame, params)?;
        self.map.set_drawn(is_drawn);
        let map = self.map.prepare_map(stage, frame, &params.settings())?;
        let overlap = automatic_overlap(&map, params);
        let splits = given_splits(&map, params)?;
        let packing = Packing::from(params.storage);
        let uniform = LvsmUniform {
            layer_count: params.layers,
            overlap,
            layer_step: packing.step(),
            // Without an overlap there is no interval to blend over.
            blends: (params.blend && overlap > 0.0).into(),
            shows_layers: (params.show == LvsmShow::Layers).into(),
            least_variance: match params.least_variance {
                LvsmLeastVariance::Receiver => 0.0,
                LvsmLeastVariance::Global => variance_at_45_degrees(&map),
            },
            ..LvsmUniform::default()
        };
        let constants = [
            ("IS_MIXED", f64::from(u8::from(params.transition == LvsmTransition::Mixed))),
            ("IS_CHEBYSHEV", f64::from(u8::from(params.bound == LvsmBound::Chebyshev))),
        ];
        self.map.specialise(&constants);
        let channels = 2 * params.layers;
        let splits_buffer = Some(self.relaxation.splits());
        let basis = self.map.prepare_basis(stage, &map, channels, packing, 0.0, &uniform, splits_buffer);
        let casters = self.map.casters().filter(|_| is_drawn);
        let layers = casters
            .map(|casters| self.targets.prepare(stage, &self.map, &basis, casters, packing, self.relaxation.splits()));
        let relaxation = if let Some(splits) = splits {
            self.relaxation.set(stage, &splits);
            None
        } else {
            let view_size = frame.receivers.size_px;
            Some(self.relaxation.prepare(stage, &self.map, &basis, &map, view_size, params, overlap))
        };
        Ok(PreparedLvsm { basis, relaxation, layers })
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedLvsm) {
        let PreparedLvsm { basis, relaxation, layers } = prepared;
        // Unless a relaxation needs depth first, the layers' draws write depth too.
        if layers.is_none() || relaxation.is_some() {
            self.map.record_map(recorder, frame, basis);
        }
        if let Some(relaxation) = relaxation {
            self.relaxation.record(recorder, basis, relaxation);
        }
        if let (Some(layers), PreparedCasters::Draws(meshes), Some((depth, casters))) =
            (layers, &frame.casters, self.map.own_depth())
        {
            self.targets.record(recorder, depth, basis.layer_views(), casters, meshes, layers);
        }
        basis.record(recorder);
    }

    /// Whether the splits have stopped moving: they approach their places over several frames.
    fn is_settled(&self, _params: &LvsmParams, still_frames: u32) -> bool {
        self.relaxation.is_settled(still_frames)
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.map.drawn_map()
    }

    fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes() + self.relaxation.memory_bytes()
    }
}

impl Lvsm {
    /// Returns whether the caster pass writes the frame's layers.
    fn draws_layers(&self, frame: &PreparedFrame<'_>, params: &LvsmParams) -> Result<bool, Error> {
        let has_casters = matches!(frame.casters, PreparedCasters::Draws(_));
        if params.layers_by == LvsmLayersBy::Depth || params.resolve == ResolveBy::Exact || !has_casters {
            return Ok(false);
        }
        if params.msaa != Multisampling::One {
            return Err(Error::Unsupported {
                technique: Self::NAME,
                needed: format!("render targets with {} samples per texel for layers", params.msaa.count()),
                had: "targets with 1 sample only".into(),
                remedy: "set `msaa` to 1, or `layers_by` to `depth`",
            });
        }
        Ok(true)
    }
}

/// Returns δ of section 3.4, in t: the depth that a plane at 45° to the light spans under the kernel, in the middle of the
/// range. It is limited so that every layer of an even split keeps its middle half.
fn automatic_overlap(map: &FrameMap, params: &LvsmParams) -> f32 {
    let reach_texels = 0.5 * params.kernel_size + 1.0;
    (params.overlap * reach_texels * texel_of_range(map)).min(0.25 / params.layers as f32)
}

/// Returns a texel's width in the middle of the range, in t.
fn texel_of_range(map: &FrameMap) -> f32 {
    let view = &map.view;
    let range_m = map.range.far_m - map.range.near_m;
    let middle_m = 0.5 * (view.near_m + view.far_m);
    view.texel_in_plane * if view.perspective == 1 { middle_m } else { 1.0 } / range_m
}

/// Returns the global σ²min of eq. 7, in t²: for a plane at 45° to the light in the middle of the range, the square of half its
/// step from texel to texel, as `minimum_variance` computes it for every plane.
fn variance_at_45_degrees(map: &FrameMap) -> f32 {
    (0.5 * texel_of_range(map)).powi(2)
}

/// Returns the splits that the CPU knows, in t; `None` if the GPU relaxes them.
fn given_splits(map: &FrameMap, params: &LvsmParams) -> Result<Option<Vec<f32>>, Error> {
    let split_count = params.layers as usize - 1;
    match params.placement {
        _ if split_count == 0 => Ok(Some(Vec::new())),
        LayerPlacement::Uniform => Ok(Some((1..params.layers).map(|i| i as f32 / params.layers as f32).collect())),
        LayerPlacement::Manual => {
            let depths_m = params.split_depths.values();
            if depths_m.len() != split_count || depths_m.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(Error::BadFrame {
                    technique: Lvsm::NAME,
                    what: "`split_depths`",
                    had: format!("`{}`", params.split_depths),
                    needed: format!("{split_count} ascending depths in metres for {} layers", params.layers),
                });
            }
            let range = &map.range;
            let t_of = |depth_m: &f32| ((depth_m - range.near_m) / (range.far_m - range.near_m)).clamp(0.0, 1.0);
            Ok(Some(depths_m.iter().map(t_of).collect()))
        }
        LayerPlacement::Lloyd => Ok(None),
    }
}
