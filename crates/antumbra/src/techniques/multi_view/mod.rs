//! `multi_view`: one depth map for each of many light points, the mean of their hard shadows.
//!
//! Paul Heckbert and Michael Herf, "Simulating Soft Shadows with Graphics Hardware", CMU-CS-97-104, 1997; the
//! "brute force" that Marrs et al. 2014 and Sintorn et al. 2008 measure against, with 2 × 2 filtered comparison. Each
//! view is fitted on its own, in a window that is warped where that makes texels smaller where the camera looks (see
//! `blocks/light_view`), and with its texels moved by a part of one (`window = plain` leaves both out, as the papers
//! do). Maps are rendered in batches that fit a memory budget and are added into the mask, so
//! that 1024 views never need 1024 maps.
//!
//! Comparison is with the receiver's plane at each of the four texels (`compare = gather`), or by the hardware's
//! comparison sampler with one reference depth (`compare = hardware`, as in the papers), which needs a slope bias and
//! so detaches contacts at grazing light.
//!
//! By default (`compare = sharp`) the views together see finer than any one. Each texel holds its surface's slope beside
//! its depth (`blocks/depth_layers`), and so is carried on to the receiver as it lies: whether the receiver is behind the
//! surface is known to a small part of a texel, at a crease, behind a sheet that crosses another, under a bump at a
//! terminator. The bias is 3 % of the one that a comparison without slopes needs, and what the depth buffer rounds.
//!
//! Where the surface ends between two texels no one view knows. A texel's answer holds at its centre, and since texels
//! are moved apart between views, centres lie all around the receiver: a kernel narrower than a texel over all views'
//! texels blurs an edge less than the bilinear mean, and has fewer answers to average. How narrow it should be
//! follows from how far off the occluder is, which its texel tells. Light points see the edge of a contact in one place,
//! so that few answers are enough and blur shows; the shadow of something far off is blurred over several texels anyway.
//! With occluders sorted into three kinds by the texels that the light's size blurs them over, the light that passes is
//!
//! ```text
//! V = (1 − far) · (1 − near | not far) · (1 − contact | not near, not far)
//! ```
//!
//! each factor by a kernel of its own: bilinear, .1 to .5 texels wide by the number of views, and .4 times that. A map
//! holds what is nearest to the light, and so most blurred: what it says of nearer things holds where nothing farther
//! hides, which is what the conditions ask for. On 320 × 180 with 64 views, rmse by bilinear means alone and so:
//! `ring-in-grass` .147 .079, `fence-geometry` .027 .018, `tree` .033 .020; with 256 views `ring-in-grass` .057 (without
//! slopes .072), `ten-knots` .021 (.0275).
//!
//! # Limits
//! Every view rasterises the whole scene: time is views × triangles. Fewer views than the penumbra is wide show as
//! overlapping hard shadows, since all pixels share the light points. Occluders much thinner than a texel let light
//! through, sharp or not, and so do several that cross within a tenth of a texel: blades of grass. Sharp comparisons
//! hold 8 bytes a texel instead of 4 and 24 bytes a pixel, and show noise in penumbrae narrower than a texel where views
//! are few. A sphere's points lie on the disc that faces the middle of the receivers, so receivers far to the side see it
//! a little too narrow.

use antumbra_light::Aabb;
use glam::{Mat4, Vec2};

use crate::blocks::caster_depth::check_map_size;
use crate::blocks::depth_layers::{DepthLayers, LayersSize};
use crate::blocks::frame_inputs::FrameInputs;
use crate::blocks::light_view::LightView;
use crate::contract::{Casters, Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder, Span, compute_pipeline, read_write_entry, sized_buffer, texture_entry};
use crate::shaders;
use crate::techniques::sample_views::{
    Batch, Comparison, MapSamplers, PointChoice, SampleViews, UnitPoints, batch_size, light_points, shifted_apart,
    views_from,
};

mod params;
#[cfg(test)]
mod tests;

pub use params::{MultiViewCompare, MultiViewParams, MultiViewWindow};

/// Maps of one batch together stay below this: WebGPU's default buffer limit, and little enough for any adapter.
const BATCH_BUDGET_BYTES: u64 = 64 << 20;

/// What sharp comparisons add up for each pixel: `EdgeSums` of `accumulate_sharp.wesl`.
const SUMS_BYTES: u64 = 24;

/// No batch is larger: beyond this the resolve's setup no longer shows.
const MAX_BATCH: u32 = 32;

/// One depth map per light sample.
#[derive(Debug)]
pub struct MultiView {
    layers: DepthLayers,
    inputs: FrameInputs,
    batch_layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    sharp_pipeline: wgpu::ComputePipeline,
    is_sharp: bool,
    samplers: MapSamplers,
    unit_points: UnitPoints,
    sample_views: SampleViews,
    edge_sums: Option<wgpu::Buffer>,
    batches: Vec<(Batch, wgpu::BindGroup)>,
}

impl Technique for MultiView {
    const KIND: TechniqueKind = TechniqueKind::MultiView;
    type Params = MultiViewParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let inputs = FrameInputs::new(gpu);
        let sampler_entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Sampler(ty),
            count: None,
        };
        let mut entries = SampleViews::layout_entries().to_vec();
        entries.extend([
            texture_entry(3, wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array),
            sampler_entry(4, wgpu::SamplerBindingType::NonFiltering),
            sampler_entry(5, wgpu::SamplerBindingType::Comparison),
            read_write_entry(6, wgpu::ShaderStages::COMPUTE),
            texture_entry(7, wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2Array),
        ]);
        let batch_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra multi_view batch"),
            entries: &entries,
        });
        let accumulate = |wgsl| compute_pipeline(gpu, "multi_view accumulate", wgsl, &[&inputs.layout, &batch_layout]);
        let pipeline = accumulate(shaders::MULTI_VIEW_ACCUMULATE);
        let sharp_pipeline = accumulate(shaders::MULTI_VIEW_ACCUMULATE_SHARP);
        Ok(Self {
            layers: DepthLayers::new(gpu),
            batch_layout,
            pipeline,
            sharp_pipeline,
            is_sharp: false,
            samplers: MapSamplers::new(gpu),
            inputs,
            unit_points: UnitPoints::default(),
            sample_views: SampleViews::new(),
            edge_sums: None,
            batches: Vec::new(),
        })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &MultiViewParams) -> Result<(), Error> {
        let technique = Self::KIND.name();
        let Casters::Meshes(meshes) = &frame.casters else {
            return Err(Error::BadFrame {
                technique,
                what: "the casters",
                had: "a depth map".into(),
                needed: "meshes: every light point has a view of its own".into(),
            });
        };
        check_map_size(gpu, technique, params.view_size, "set a smaller `view_size`")?;
        // Sums for every pixel where comparisons are sharp; a stand-in elsewhere.
        let is_sharp = params.compare == MultiViewCompare::Sharp;
        self.is_sharp = is_sharp;
        let sums_bytes =
            if is_sharp { SUMS_BYTES * u64::from(frame.receivers.size_px.element_product()) } else { SUMS_BYTES };
        let most_bytes = gpu.device.limits().max_storage_buffer_binding_size;
        if sums_bytes > most_bytes {
            return Err(Error::Unsupported {
                technique,
                needed: format!("a buffer of {sums_bytes} bytes, {SUMS_BYTES} for each pixel"),
                had: format!("at most {most_bytes}"),
                remedy: "set `compare` to gather",
            });
        }
        self.inputs.prepare(gpu, technique, frame)?;

        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let choice = PointChoice {
            samples: params.samples,
            sample_set: params.sample_set,
            seed: params.seed,
            shift: Vec2::ZERO,
        };
        let points = light_points(frame.light, &choice, &mut self.unit_points, &bounds, frame.receivers.bounds);
        let corners = frame.receivers.corners();
        let is_warped = params.window == MultiViewWindow::Warped;
        let seen = if is_warped { frame.receivers.seen_points(&corners) } else { Vec::new() };
        let views = views_from(frame.light, &points, &bounds, &corners, &seen);
        let views = if is_warped { shifted_apart(views, params.view_size) } else { views };
        let clip_from_world: Vec<Mat4> = views.iter().map(LightView::clip_from_world).collect();
        // Gradients carry a texel's surface to the receiver.
        let mut of = LayersSize { size: params.view_size, views: 1, layers: 1, with_gradients: is_sharp };
        let map_bytes = u64::from(params.view_size).pow(2) * of.texel_bytes();
        of.views = batch_size(BATCH_BUDGET_BYTES, map_bytes, MAX_BATCH.min(points.len() as u32));
        self.layers.prepare(gpu, &clip_from_world, meshes, of);
        let comparison = Comparison {
            view_size: params.view_size,
            hardware_compare: params.compare == MultiViewCompare::Hardware,
            bias_scale: params.bias_scale,
            slope_bias_texels: 0.0,
            kernel_texels: if is_sharp { kernel_texels(points.len()) } else { 0.0 },
            light_radius: frame.light.bounding_radius(),
        };
        self.sample_views.prepare(gpu, &points, &views, of.views, &comparison);
        let usage = wgpu::BufferUsages::STORAGE;
        let edge_sums = sized_buffer(gpu, &mut self.edge_sums, "antumbra edge sums", sums_bytes.max(SUMS_BYTES), usage);
        let bind_group = |batch: &Batch| {
            let mut entries = self.sample_views.entries(batch).to_vec();
            entries.extend([
                wgpu::BindGroupEntry {
                    binding: 3,
                    resource: wgpu::BindingResource::TextureView(self.layers.depth_array()),
                },
                wgpu::BindGroupEntry { binding: 4, resource: wgpu::BindingResource::Sampler(&self.samplers.gather) },
                wgpu::BindGroupEntry {
                    binding: 5,
                    resource: wgpu::BindingResource::Sampler(&self.samplers.comparison),
                },
                wgpu::BindGroupEntry { binding: 6, resource: edge_sums.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 7,
                    resource: wgpu::BindingResource::TextureView(self.layers.gradient_array()),
                },
            ]);
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra multi_view batch"),
                layout: &self.batch_layout,
                entries: &entries,
            })
        };
        self.batches = self.sample_views.batches().iter().map(|batch| (batch.clone(), bind_group(batch))).collect();
        Ok(())
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let Casters::Meshes(meshes) = &frame.casters else { return };
        for (batch, bind_group) in &self.batches {
            self.layers.record(recorder, "depth maps", batch.first..batch.first + batch.count, meshes);
            recorder.compute("accumulate", Span::Only, |pass| {
                pass.set_pipeline(if self.is_sharp { &self.sharp_pipeline } else { &self.pipeline });
                self.inputs.bind(pass);
                pass.set_bind_group(1, bind_group, &[]);
                self.inputs.dispatch(pass);
            });
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.layers.memory_bytes()
            + self.sample_views.memory_bytes()
            + self.edge_sums.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

/// The wider kernel's standard deviation in texels for so many views. A Gaussian of σ holds 4 π σ² n independent texels of n
/// views: about 32 are held, fewer are noise.
fn kernel_texels(view_count: usize) -> f32 {
    (1.6 / (view_count as f32).sqrt()).clamp(0.1, 0.5)
}
