//! Plan of a frame, computed on the CPU: the view, its levels, and the parameters of every pass.

use std::borrow::Cow;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{UVec2, Vec2};

use super::STEP_STRIDE;
use super::designs::{FilterDesign, LookupDesign};
use super::gpu_types::{FilterStep, MultiLayerLadder, MultiLayerRung, MultiLayerUniform};
use super::levels::{DepthReach, Level, LevelOptions, fixed_rung, levels, list_count, prune_levels, rungs};
use super::nearest::{NearestSquares, Squares, squares_for};
use super::params::{
    MultiLayerDepthAverage, MultiLayerEpsilonGrowth, MultiLayerFaces, MultiLayerFilterWidths, MultiLayerGather,
    MultiLayerHierarchy, MultiLayerListAccumulation, MultiLayerMapShape, MultiLayerParams, MultiLayerShow,
};
use crate::contract::{MaskChannels, MeshCaster, PreparedFrame};
use crate::gpu::Stage;
use crate::light_map::central_view::{central_reach, fit_central_view_within};
use crate::light_map::light_view::{FitTo, FollowedLight, LightView, LightViewGpu, Window, WindowShape};
use crate::light_map::map_texels::map_texels;
use crate::light_map::stable_fit::{corners_to_hold, in_whole_texels};
use crate::light_map::texel_lists::options::{Accumulation, DepthTolerance, Gather, ListOptions};

/// Depth difference, in texel widths, up to which a sample counts only the nearest fragment of a texel. Errors against truth: 0
/// darkens thin casters twice (`fence-geometry` .073, `tree` .058); 1 gives .067 and .056, 2 gives .064 and .057. Large values
/// lift receivers to objects that nearly touch them (`street` .077 with 1, .079 with 2, .086 with 4).
const ADJOINING_TEXELS: f32 = 1.0;

/// Automatic bias, in texel widths: a third more than the library's own (`light_map/bias.wesl`), so that fewer folds finer than
/// texels shade themselves. With ½, ⅔ and ¾, `street` has .0606, .0597, .0596 at 320 × 180. But leaves lose shadows of objects
/// that touch them: `tree` has .0437, .0448, .0467 at 256 × 144.
const BIAS_TEXELS: f32 = 2.0 / 3.0;

/// Returns the memory of a base with its fragments and levels, bytes: 50 MiB at 1024² on most scenes.
fn bytes_of(size: u32) -> u64 {
    50 * u64::from(size).pow(2)
}

/// Plan of a frame's lists, levels and lookups.
#[derive(Debug)]
pub(super) struct FramePlan<'a> {
    params: &'a MultiLayerParams,
    pub(super) view: LightView,
    pub(super) gpu_view: LightViewGpu,
    /// Side of a square base with the same number of texels.
    pub(super) square_size: u32,
    /// Number of texels along each side of the base.
    pub(super) map_size: UVec2,
    pub(super) levels: Vec<Level>,
    tolerances: Tolerances,
    filter_per_g: f32,
    colored: bool,
}

/// Depth tolerances within which surfaces count as one.
#[derive(Clone, Copy, Debug)]
struct Tolerances {
    /// Width of a texel, metres; in a perspective view per metre of depth.
    texel_in_plane: f32,
    perspective: bool,
    /// ε of the base, in texel widths, and its growth factor per octave.
    epsilon: f32,
    growth: f32,
}

impl Tolerances {
    fn new(view: &LightView, gpu_view: &LightViewGpu, params: &MultiLayerParams) -> Self {
        Self {
            texel_in_plane: gpu_view.texel_in_plane,
            perspective: view.perspective,
            epsilon: params.epsilon,
            growth: match params.epsilon_growth {
                MultiLayerEpsilonGrowth::Sqrt2 => std::f32::consts::SQRT_2,
                MultiLayerEpsilonGrowth::Double => 2.0,
            },
        }
    }

    /// Returns a tolerance of a number of texel widths.
    fn widths(self, widths: f32) -> DepthTolerance {
        let widths = widths * self.texel_in_plane;
        if self.perspective {
            DepthTolerance { slope: widths, m: 0.0 }
        } else {
            DepthTolerance { slope: 0.0, m: widths }
        }
    }

    /// Returns ε of a level.
    fn epsilon(self, octave: f32) -> DepthTolerance {
        self.widths(self.epsilon * self.growth.powf(octave))
    }
}

impl<'a> FramePlan<'a> {
    pub(super) fn new(
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'_>],
        params: &'a MultiLayerParams,
    ) -> Self {
        let light = &*uniform(frame.light);
        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let extent = light_extent(light);
        let is_square = params.map_shape == MultiLayerMapShape::Square;
        let receivers = corners_to_hold(stage, &frame.receivers);
        let window = if is_square { WindowShape::Square } else { WindowShape::Rolled(Vec2::X) };
        let fit = FitTo { casters: &bounds, receivers: &receivers, window };
        let view = fit_central_view_within(light, FollowedLight::Whole, reach(light), &fit);
        let square_size = map_texels(stage, frame, params.map_size, bytes_of, &view, &bounds);
        let (view, map_size) =
            if is_square { (view, UVec2::splat(square_size)) } else { shaped_as_light(view, extent, square_size) };
        let view = in_whole_texels(stage, view, map_size);
        let gpu_view = view.to_gpu_of(map_size);
        let tolerances = Tolerances::new(&view, &gpu_view, params);
        let mut levels = levels(&LevelOptions {
            map_size,
            octaves: params.levels,
            stack_size: if params.hierarchy == MultiLayerHierarchy::MipMap { 1 } else { params.stack_size },
            fine: params.hierarchy == MultiLayerHierarchy::FineYMap,
            subsampled_steps: params.subsampled_steps,
            samples: params.msaa.count(),
        });
        if params.filter_widths == MultiLayerFilterWidths::Merged {
            levels.iter_mut().for_each(|level| level.width = level.kernel());
        }
        // The filter of a quarter is half as wide as the light's.
        let filter_per_g = filter_per_g(&view, extent, map_size) * if is_in_parts(params) { 0.5 } else { 1.0 };
        // Only the shader knows what a pixel's footprint adds to filters.
        if params.prune && params.footprint == 0.0 && params.fixed_level == 0 {
            let reach =
                DepthReach { perspective: view.perspective, near_m: view.near_m, far_m: view.far_m, filter_per_g };
            prune_levels(&mut levels, &reach, |level| tolerances.epsilon(level.octave));
        }
        let colored = frame.casters.mask_channels() == MaskChannels::Three;
        Self { params, view, gpu_view, square_size, map_size, levels, tolerances, filter_per_g, colored }
    }

    /// Returns the options of the lists, with memory for `capacity` fragments.
    pub(super) fn list_options(&self, capacity: u32) -> ListOptions {
        let params = self.params;
        ListOptions {
            map_size: self.map_size,
            max_texels: self.square_size.pow(2),
            capacity,
            list_count: list_count(&self.levels),
            owners_bytes: NearestSquares::bytes_of(self.square_size),
            colored: self.colored,
            layers: params.layers,
            join: params.join_base.then(|| self.tolerances.epsilon(0.0)),
            all_faces: params.faces == MultiLayerFaces::All,
            // Faces turned away from the light never receive, so closed meshes need no bias.
            open_offset: self.tolerances.widths(BIAS_TEXELS * params.bias_scale),
            accumulation: self.list_accumulation(),
            gather: match params.gather {
                MultiLayerGather::Arrays => Gather::Arrays,
                MultiLayerGather::Linked => Gather::Linked,
            },
            samples: params.msaa.count(),
            adjoin: self.tolerances.widths(ADJOINING_TEXELS),
        }
    }

    fn list_accumulation(&self) -> Accumulation {
        match self.params.list_accumulation {
            MultiLayerListAccumulation::Add => Accumulation::Add,
            MultiLayerListAccumulation::Multiply => Accumulation::Multiply,
            MultiLayerListAccumulation::Max => Accumulation::Max,
            MultiLayerListAccumulation::Overlap => Accumulation::Overlap,
        }
    }

    /// Returns the parameters and rungs of the lookup.
    pub(super) fn lookup(&self, squares: &[Squares]) -> (MultiLayerUniform, MultiLayerLadder) {
        let rungs = match self.params.fixed_level {
            0 => rungs(&self.levels, is_in_parts(self.params)),
            level => vec![fixed_rung(&self.levels, level)],
        };
        let lookup = MultiLayerUniform {
            rung_count: rungs.len() as u32,
            filter_per_g: self.filter_per_g,
            footprint_px: self.params.footprint,
            bias_texels: BIAS_TEXELS * self.params.bias_scale,
        };
        let squared = |i: Option<usize>| i.and_then(|i| rungs.get(i)).map_or(-1.0, |rung| rung.filter * rung.filter);
        let mut ladder = MultiLayerLadder::default();
        for (i, (gpu_rung, rung)) in ladder.rungs.iter_mut().zip(&rungs).enumerate() {
            let level = &self.levels[rung.level];
            let epsilon = self.tolerances.epsilon(level.octave);
            let squares = squares_for(squares, rung.reach);
            *gpu_rung = MultiLayerRung {
                size: level.size,
                first: level.first,
                spacing: level.spacing,
                offset: level.offset,
                width: level.width,
                merged: level.merged,
                epsilon_slope: epsilon.slope,
                epsilon_m: epsilon.m,
                squared: squared(Some(i)),
                squared_finer: squared(i.checked_sub(1)),
                squared_coarser: squared(Some(i + 1)),
                reach: rung.reach,
                square_shift: squares.shift,
                square_first: squares.first,
                ..MultiLayerRung::default()
            };
        }
        (lookup, ladder)
    }

    /// Returns the key of the lookup's pipeline.
    pub(super) fn design(&self) -> LookupDesign {
        LookupDesign {
            colored: self.colored,
            list_accumulation: self.list_accumulation(),
            level_accumulation: self.params.level_accumulation,
            light_parts: self.params.light_parts,
            level_weights: self.params.level_weights,
            hat: self.params.hat,
            lists: self.params.lists,
            planes: self.params.planes,
            shows_levels: self.params.show == MultiLayerShow::Levels,
        }
    }

    /// Returns the key of the filter's pipeline.
    pub(super) fn filter_design(&self) -> FilterDesign {
        FilterDesign {
            averages_by_count: self.params.depth_average == MultiLayerDepthAverage::Count,
            colored: self.colored,
            list_accumulation: self.list_accumulation(),
        }
    }

    /// Returns the steps that make each level from its source: a [`FilterStep`] every [`STEP_STRIDE`] bytes.
    pub(super) fn filter_steps(&self, capacity: u32) -> Vec<u8> {
        let steps = self.levels.iter().filter_map(|level| {
            let (step, source) = (level.step?, &self.levels[level.source]);
            let epsilon = self.tolerances.epsilon(level.octave);
            Some(FilterStep {
                source_size: source.size,
                target_size: level.size,
                source_first: source.first,
                target_first: level.first,
                stride: step.stride,
                near_child: step.near,
                far_child: step.far,
                subsample: step.subsample.into(),
                epsilon_slope: epsilon.slope,
                epsilon_m: epsilon.m,
                capacity,
                z_limit_m: level.z_limit_m,
                complete_from_m: self.view.complete_from_m,
                ..FilterStep::default()
            })
        });
        // A base alone has no steps, but bindings must not be empty.
        let mut bytes = vec![0; STEP_STRIDE as usize * self.levels.len()];
        for (bytes, step) in bytes.chunks_exact_mut(STEP_STRIDE as usize).zip(steps) {
            bytes[..size_of::<FilterStep>()].copy_from_slice(bytemuck::bytes_of(&step));
        }
        bytes
    }
}

/// Whether parts of the light are looked up one by one.
fn is_in_parts(params: &MultiLayerParams) -> bool {
    params.light_parts.count() > 1
}

/// Maximum aspect ratio of a texel: beyond it the long side blurs detail that the short one resolves.
const MAX_TEXEL_ASPECT: f32 = 16.0;

/// Returns the extent of the light from its centre along its right or up axis.
fn reach(light: &Light) -> f32 {
    match &light.shape {
        LightShape::Rectangle { size_m } => 0.5 * size_m.max_element(),
        _ => central_reach(light),
    }
}

/// Maximum aspect ratio of a map, which keeps a map of 4096² texels within WebGPU's 8192 per side.
const MAX_MAP_ASPECT: f32 = 4.0;

/// Map sides are multiples of `map_size` divided by this, so that a moving window seldom changes them.
const MAP_SIZE_STEPS: u32 = 64;

/// Returns the sides of a map of at most `map_size`² texels with the window's aspect ratio, and the window, widened for
/// rounding. Texels have the light's aspect ratio, so that square kernels of them have the light's proportions.
fn shaped_as_light(view: LightView, extent: Vec2, map_size: u32) -> (LightView, UVec2) {
    let texel_aspect = if extent.min_element() > 0.0 { extent.x / extent.y } else { 1.0 };
    let texel = Vec2::new(texel_aspect.clamp(1.0 / MAX_TEXEL_ASPECT, MAX_TEXEL_ASPECT), 1.0);
    let in_texels = view.window.half_size / texel;
    let map_aspect = (in_texels.x / in_texels.y).clamp(1.0 / MAX_MAP_ASPECT, MAX_MAP_ASPECT);
    let step = (map_size / MAP_SIZE_STEPS).max(1);
    let width = (map_size as f32 * map_aspect.sqrt() / step as f32).round() as u32 * step;
    let height = map_size * map_size / width / step * step;
    let sides = UVec2::new(width, height);
    let texel = texel * (in_texels / sides.as_vec2()).max_element();
    (LightView { window: Window { half_size: texel * sides.as_vec2(), ..view.window }, ..view }, sides)
}

/// Returns the filter width per unit of g, in texels.
fn filter_per_g(view: &LightView, extent: Vec2, map_size: UVec2) -> f32 {
    let texel = 2.0 * view.window.half_size / map_size.as_vec2();
    // The geometric mean matters where the light is more elongated than texels may be.
    let in_texels = (extent.max(Vec2::ZERO) / texel).max(Vec2::splat(1e-12));
    (in_texels.x * in_texels.y).sqrt()
}

/// Returns the sides, along right and up, of the rectangle whose points have the variance of the light's. Metres; tangents for
/// a sun.
pub(super) fn light_extent(light: &Light) -> Vec2 {
    match &light.shape {
        LightShape::Rectangle { size_m } => *size_m,
        _ => light.moments().equivalent_size(),
    }
}

/// Returns a light with varying emission as the uniform rectangle of its mean and variance; other lights unchanged.
fn uniform(light: &Light) -> Cow<'_, Light> {
    let (LightShape::Rectangle { .. }, Some(_)) = (&light.shape, &light.emission) else { return Cow::Borrowed(light) };
    let moments = light.moments();
    let size_m = moments.equivalent_size();
    let center = moments.mean_in_world(&light.frame());
    Cow::Owned(Light { shape: LightShape::Rectangle { size_m }, center, emission: None, ..light.clone() })
}
