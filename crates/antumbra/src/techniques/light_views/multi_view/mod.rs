//! `multi_view`: one depth map for each of many light points, the mean of their hard shadows.
//!
//! Paul Heckbert and Michael Herf, "Simulating Soft Shadows with Graphics Hardware", CMU-CS-97-104, 1997; the
//! "brute force" that Marrs et al. 2014 and Sintorn et al. 2008 measure against, with 2 × 2 filtered comparison. Each
//! view is fitted on its own. Its window is warped if that makes texels smaller where the camera looks (see
//! `light_map/light_view`), and its texels are shifted by a fraction of one (`window = plain` omits both, as in the papers).
//! Maps are rendered in batches that fit a memory budget and are added to the mask, so that 1024 views never need 1024 maps.
//!
//! Each receiver sees another disc of a sphere, but receivers share views: so light points lie within the ball such that they are
//! spread evenly over the disc from everywhere (`light_views/ball`). Under a bulb in a box the rmse with 64 views is .020; with
//! points on one disc, which faces the receivers' centre, it is .032.
//!
//! Comparison is with the receiver's plane at each of the four texels (`compare = gather`), or by the hardware's
//! comparison sampler with one reference depth (`compare = hardware`, as in the papers), which needs a slope bias and
//! so detaches contacts at grazing light.
//!
//! # By triangles
//! By default (`compare = triangles`) a texel holds the triangle that it shows besides its depth
//! (`light_map/caster_triangles`; the idea is that of Lecocq et al., "Sub-Pixel Shadow Mapping", I3D 2014), and a map tells
//! which triangles may be in the way. The segment from the receiver to the light point is tested exactly against those of the
//! 6 × 6 texels around it, and onwards over the surfaces that they belong to. The only bias is for the rounding of the depth
//! buffer, and edges are exact. A segment that none of these triangles blocks is not yet lit: casters behind the first
//! are not in the map. So each view tells how far from the light it knows the segment, as in a life table whose
//! subjects leave before they die, and the light that passes is the product-limit estimate (Kaplan and Meier,
//! "Nonparametric Estimation from Incomplete Observations", JASA 53, 1958) over spans s of the segment,
//!
//! ```text
//! V = Π (1 − hidden_s / known_s)        known_s = 1 − Σ_{r<s} (hidden_r + lost_r)
//! ```
//!
//! where `hidden_s` is the light that ends at a caster in span s, and `lost_s` that of texels whose caster lies there, in
//! front of the receiver, but not in the segment's way: nothing is known behind it. Triangles too small to be walked over
//! count by the fraction of the four nearest texels that they fill. Triangles do not tell where a surface has holes: if any
//! caster is not opaque, slopes are compared instead.
//!
//! Triangles narrower than a texel are drawn a texel wide, so that some texel shows them. rmse at 320 × 180 with 256 views, by
//! slopes and by triangles: `ring-in-grass` .058 .027, `ten-knots` .021 .011; with 64, `checker-far` .017 .010, `window` .012 .010.
//!
//! # By slopes
//! With `compare = sharp`, or if a caster is not opaque, each texel holds its surface's slope besides its depth
//! (`light_map/depth_layers`), with which the surface is extended to the receiver: whether the receiver is behind the surface
//! is known to a small part of a texel, at a crease, behind a sheet that crosses another, under a bump at a terminator.
//! The bias is 3 % of the one that a comparison without slopes needs, plus the rounding of the depth buffer.
//!
//! No single view knows where between two texels a surface ends. A texel's answer holds at its centre, and since texels
//! are shifted between views, centres lie all around the receiver. A kernel narrower than a texel, over the texels of all
//! views, blurs an edge less than the bilinear mean, and has fewer answers to average. Its best width depends on the
//! occluder's distance, which the texel tells. Light points see the edge of a contact in one place, so that few answers
//! are enough and blur shows; the shadow of a distant occluder is blurred over several texels anyway. Occluders are sorted
//! into three kinds by the number of texels over which the light's size blurs their shadows, and the light that passes is
//!
//! ```text
//! V = (1 − far) · (1 − near | not far) · (1 − contact | not near, not far)
//! ```
//!
//! each factor by its own kernel: bilinear, .1 to .5 texels wide by the number of views, and .4 times that. A map
//! holds what is nearest to the light, and so most blurred: what it tells about nearer occluders holds only where no farther
//! one hides, hence the conditions. At 320 × 180 with 64 views, rmse by bilinear means alone and by these kernels:
//! `ring-in-grass` .147 .079, `fence-geometry` .027 .018, `tree` .033 .020; with 256 views `ring-in-grass` .057 (without
//! slopes .072), `ten-knots` .021 (.0275).
//!
//! # Translucent casters
//! A map holds only whether a surface is there. So a translucent surface is drawn in the fraction of views that equals the
//! fraction of light that it stops (Enderton, Sintorn, Shirley, Luebke, "Stochastic Transparency", I3D 2010): that fraction is
//! compared with a number for each triangle and view, from sequences that are stratified over a triangle's views and differ
//! between triangles (`primitives/stochastic.wesl`). One surface is exact to a view's share of the light; for several in a row
//! the mean is the product, with noise. If casters tint, each colour has its own views, for three times the time.
//!
//! # Limits
//! Every view rasterises the whole scene: time is proportional to views × triangles. Too few views for the width of the penumbra
//! show as overlapping hard shadows, since all pixels share the light points; by triangles nothing blurs them, so that hair under
//! 64 views has more noise than by slopes. No view may see what lies behind several surfaces within a few texels, as in dense
//! grass. Triangles cost 80 bytes each, 8 bytes per texel instead of 4, and 32 bytes per pixel; slopes 8 bytes per texel and
//! 24 per pixel. By slopes or depths alone, occluders much thinner than a texel let light through.

use std::ops::Range;

use antumbra_light::{Aabb, LightPoint};
use glam::{Mat4, Vec2, Vec3};

use crate::contract::{DrawnMap, Error, MaskChannels, MeshCaster, Opacity, PreparedCasters, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Span, Stage};
use crate::light_map::caster_depth::{CasterDepth, DrawnView, check_map_size};
use crate::light_map::caster_triangles::maps::TriangleMaps;
use crate::light_map::depth_layers::{DepthLayers, LayersSize};
use crate::light_map::light_view::LightView;
use crate::light_map::readable_meshes::readable_meshes;
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::techniques::Technique;
use crate::techniques::light_views::gpu_types::ALL_CHANNELS;
use crate::techniques::light_views::{
    Batch, Comparison, MapSamplers, PointChoice, SampleViews, UnitPoints, batch_size, light_points, shifted_apart,
    views_from,
};

mod accumulation;
pub(crate) mod bands;
mod params;
#[cfg(test)]
mod tests;

use accumulation::{Accumulations, BandGroup, BatchMaps};
use bands::{Band, Bands};
pub use params::{MultiViewCompare, MultiViewParams, MultiViewWindow};

/// Bound on the bytes of one batch's maps: within WebGPU's default buffer limit, and small enough for any adapter.
const BATCH_BUDGET_BYTES: u64 = 64 << 20;

/// Bytes per pixel of the sums of sharp comparisons: `EdgeSums` of `accumulate_sharp.wesl`.
const SUMS_BYTES: u64 = 24;

/// Bytes per pixel of comparisons by triangles: `life_tables` of `accumulate_triangles.wesl`.
const LIFE_TABLE_BYTES: u64 = 32;

/// Maximum number of light points of a batch: beyond it the setup cost of the resolve is negligible.
const MAX_BATCH: u32 = 32;

/// Remedy in errors of comparisons by triangles.
const WITHOUT_TRIANGLES: &str = "set `compare` to sharp";

/// One depth map per light sample.
#[derive(Debug)]
pub struct MultiView {
    inputs: FrameInputs,
    /// Depth maps, with slopes for sharp comparisons.
    layers: DepthLayers,
    /// Triangle maps, created on first use.
    triangle_maps: Option<TriangleMaps>,
    accumulations: Accumulations,
    compare: MultiViewCompare,
    samplers: MapSamplers,
    unit_points: UnitPoints,
    sample_views: SampleViews,
    /// Per-pixel state that is kept from batch to batch.
    bands: Bands,
    /// Light points of the frame's last batch, whose maps remain once it is drawn.
    last_points: Range<u32>,
    /// Views of all light points, and texels along a side of their maps.
    views: (Vec<LightView>, u32),
}

/// Batches of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedViews {
    inputs: PreparedInputs,
    /// Pipeline that adds a batch to the mask.
    accumulate: wgpu::ComputePipeline,
    /// Whether maps hold triangles, not depths alone.
    by_triangles: bool,
    batches: Vec<DrawnBatch>,
}

/// Batch of views whose maps are drawn and added to the mask.
#[derive(Debug)]
struct DrawnBatch {
    /// Indices of the batch's views among all drawn ones; if each colour has its own views, they differ between colours.
    views: Range<u32>,
    groups: Vec<BandGroup>,
}

/// Colour weights of the light that a view counts, and the mask's channel that it is added to.
type Color = (Vec3, u32);

impl Technique for MultiView {
    const NAME: &'static str = "multi_view";
    type Params = MultiViewParams;
    type Prepared = PreparedViews;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let inputs = FrameInputs::new(gpu);
        Ok(Self {
            layers: DepthLayers::new(gpu),
            triangle_maps: None,
            accumulations: Accumulations::new(gpu, &inputs),
            compare: MultiViewCompare::Triangles,
            samplers: MapSamplers::new(gpu),
            inputs,
            unit_points: UnitPoints::default(),
            sample_views: SampleViews::new(),
            bands: Bands::default(),
            last_points: 0..0,
            views: (Vec::new(), 0),
        })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &MultiViewParams,
    ) -> Result<PreparedViews, Error> {
        let technique = Self::NAME;
        let meshes = frame.casters.meshes(technique, "each light point has its own view")?;
        check_map_size(stage, technique, params.view_size, "set a smaller `view_size`")?;
        self.compare = comparison_of(meshes, params);
        if self.compare == MultiViewCompare::Triangles {
            readable_meshes(technique, frame, Some(WITHOUT_TRIANGLES))?;
        }
        let bands = self.prepare_bands(stage, frame)?;
        let inputs = self.inputs.prepare(stage, frame);
        let (points, views) = self.points_and_views(frame, meshes, params);
        let maps = self.batch_of_maps(params.view_size, points.len() as u32);
        let colors = colors_of(frame);
        self.prepare_maps(stage, &views, meshes, maps, &colors)?;
        let is_sharp = self.compare == MultiViewCompare::Sharp;
        let comparison = Comparison {
            view_size: params.view_size,
            hardware_compare: self.compare == MultiViewCompare::Hardware,
            bias_scale: params.bias_scale,
            slope_bias_texels: 0.0,
            kernel_texels: if is_sharp { kernel_texels(points.len()) } else { 0.0 },
            light_radius: frame.light.bounding_radius(),
        };
        let channels: Vec<u32> = colors.iter().map(|(_, channel)| *channel).collect();
        self.sample_views.prepare_channels(stage, &points, &views, maps.views, &comparison, &channels);
        let of_color = self.sample_views.batches().len() / channels.len();
        let accumulation = self.accumulations.of(self.compare);
        let batch_maps =
            BatchMaps { layers: &self.layers, triangles: self.triangle_maps.as_ref(), samplers: &self.samplers };
        let bind = |(i, batch): (usize, &Batch)| {
            let first = (i / of_color * views.len()) as u32 + batch.first;
            DrawnBatch {
                views: first..first + batch.count,
                groups: accumulation.bind(stage, batch, &batch_maps, frame.receivers.size_px.y, &bands),
            }
        };
        let batches = self.sample_views.batches().iter().enumerate().map(bind).collect();
        let last_points = self.sample_views.batches().last().map(|batch| batch.first..batch.first + batch.count);
        self.last_points = last_points.unwrap_or_default();
        self.views = (views, params.view_size);
        Ok(PreparedViews {
            inputs,
            accumulate: accumulation.pipeline.clone(),
            by_triangles: self.compare == MultiViewCompare::Triangles,
            batches,
        })
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedViews) {
        let PreparedCasters::Draws(meshes) = &frame.casters else { return };
        let PreparedViews { inputs, accumulate, by_triangles, batches } = prepared;
        let maps = self.triangle_maps.as_ref().filter(|_| *by_triangles);
        if let Some(maps) = maps {
            maps.triangles().record(recorder, "triangles");
        }
        for DrawnBatch { views, groups } in batches {
            match maps {
                Some(maps) => maps.record(recorder, "depth maps", views.clone()),
                None => self.layers.record(recorder, "depth maps", views.clone(), meshes),
            }
            recorder.compute("accumulate", Span::Only, |pass| {
                pass.set_pipeline(accumulate);
                inputs.bind(pass);
                for BandGroup { rows, group } in groups {
                    pass.set_bind_group(1, group, &[]);
                    inputs.dispatch_rows(pass, *rows);
                }
            });
        }
    }

    /// Maps of the last batch: each batch is drawn over the one before. Empty if all lights share them.
    fn drawn_maps(&self) -> Vec<DrawnMap> {
        if self.last_points.is_empty() {
            return Vec::new();
        }
        let (slices, are_own) = match &self.triangle_maps {
            Some(maps) => (maps.depth_slices(), maps.are_own()),
            None => (self.layers.depth_slices(), self.layers.are_own()),
        };
        if !are_own {
            return Vec::new();
        }
        let (views, view_size) = &self.views;
        let map = |(point, depth): (u32, &wgpu::TextureView)| DrawnMap {
            light_point: Some(point),
            ..views[point as usize].to_gpu(*view_size).drawn_map(depth, 1, CasterDepth::CLEAR_DEPTH)
        };
        self.last_points.clone().zip(slices).map(map).collect()
    }

    fn memory_bytes(&self) -> u64 {
        self.layers.memory_bytes()
            + self.triangle_maps.as_ref().map_or(0, TriangleMaps::memory_bytes)
            + self.sample_views.memory_bytes()
            + self.bands.memory_bytes()
    }
}

impl MultiView {
    /// Returns the light points, and the view from each.
    fn points_and_views(
        &mut self,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'_>],
        params: &MultiViewParams,
    ) -> (Vec<LightPoint>, Vec<LightView>) {
        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let choice = PointChoice {
            samples: params.samples,
            sample_set: params.sample_set,
            seed: params.seed,
            shift: Vec2::ZERO,
        };
        let points = light_points(frame.light, &choice, &mut self.unit_points);
        let corners = frame.receivers.corners();
        let is_warped = params.window == MultiViewWindow::Warped;
        let seen = if is_warped { frame.receivers.seen_points(&corners) } else { Vec::new() };
        let views = views_from(frame.light, &points, &bounds, &corners, &seen);
        let views = if is_warped { shifted_apart(views, params.view_size) } else { views };
        (points, views)
    }

    /// Size of the maps that exist at the same time.
    fn batch_of_maps(&self, view_size: u32, point_count: u32) -> LayersSize {
        let with_gradients = self.compare == MultiViewCompare::Sharp;
        let one = LayersSize { size: view_size, views: 1, layers: 1, with_gradients };
        let by_triangles = self.compare == MultiViewCompare::Triangles;
        let texel_bytes = if by_triangles { TriangleMaps::TEXEL_BYTES } else { one.texel_bytes() };
        let map_bytes = u64::from(view_size).pow(2) * texel_bytes;
        LayersSize { views: batch_size(BATCH_BUDGET_BYTES, map_bytes, MAX_BATCH.min(point_count)), ..one }
    }

    /// Prepares to draw the views into maps of triangles or of depth, one colour after the other.
    fn prepare_maps(
        &mut self,
        stage: &Stage<'_>,
        views: &[LightView],
        meshes: &[MeshCaster<'_>],
        of: LayersSize,
        colors: &[Color],
    ) -> Result<(), Error> {
        let clip_from_world: Vec<Mat4> = views.iter().map(LightView::clip_from_world).collect();
        if self.compare == MultiViewCompare::Triangles {
            let maps = self.triangle_maps.get_or_insert_with(|| TriangleMaps::new(stage));
            let technique = Self::NAME;
            return maps.prepare(stage, technique, &clip_from_world, meshes, [of.size, of.views], WITHOUT_TRIANGLES);
        }
        self.triangle_maps = None;
        let is_stochastic = meshes.iter().any(|mesh| matches!(mesh.opacity, Opacity::Translucent { .. }));
        let of_color = |(color_weights, _): &Color| {
            let color_weights = *color_weights;
            (0..).zip(&clip_from_world).map(move |(point, clip_from_world)| DrawnView {
                clip_from_world: *clip_from_world,
                light_point: is_stochastic.then_some(point),
                color_weights,
            })
        };
        let views: Vec<_> = colors.iter().flat_map(of_color).collect();
        self.layers.prepare_views(stage, &views, meshes, of);
        Ok(())
    }

    /// Prepares the per-pixel state that is kept from batch to batch; only the mask if depths are compared.
    fn prepare_bands(&mut self, stage: &Stage<'_>, frame: &PreparedFrame<'_>) -> Result<Vec<Band>, Error> {
        let bytes_each = match self.compare {
            MultiViewCompare::Triangles => LIFE_TABLE_BYTES,
            MultiViewCompare::Sharp => SUMS_BYTES,
            MultiViewCompare::Gather | MultiViewCompare::Hardware => {
                self.bands = Bands::default();
                return Ok(Vec::new());
            }
        };
        self.bands.prepare(stage, Self::NAME, frame.receivers.size_px, bytes_each)
    }
}

/// Colours of the mask if casters tint; otherwise all light at once.
fn colors_of(frame: &PreparedFrame<'_>) -> Vec<Color> {
    match (frame.casters.mask_channels(), frame.mask.channels()) {
        (MaskChannels::Three, MaskChannels::Three) => vec![(Vec3::X, 0), (Vec3::Y, 1), (Vec3::Z, 2)],
        _ => vec![(DrawnView::LUMINANCE, ALL_CHANNELS)],
    }
}

/// Comparison in use: by slopes instead of triangles if a caster is not opaque, since triangles do not tell where a surface has holes.
fn comparison_of(meshes: &[MeshCaster<'_>], params: &MultiViewParams) -> MultiViewCompare {
    let has_holes = meshes.iter().any(|mesh| !matches!(mesh.opacity, Opacity::Opaque));
    match params.compare {
        MultiViewCompare::Triangles if has_holes => MultiViewCompare::Sharp,
        compare => compare,
    }
}

/// Standard deviation of the wider kernel for a number of views, texels. A Gaussian of σ holds 4 π σ² n independent texels of n
/// views: about 32 of them here, fewer are noise.
fn kernel_texels(view_count: usize) -> f32 {
    (1.6 / (view_count as f32).sqrt()).clamp(0.1, 0.5)
}
