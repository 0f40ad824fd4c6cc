//! `multi_view`: one depth map for each of many light points, the mean of their hard shadows.
//!
//! Paul Heckbert and Michael Herf, "Simulating Soft Shadows with Graphics Hardware", CMU-CS-97-104, 1997; the
//! "brute force" that Marrs et al. 2014 and Sintorn et al. 2008 measure against, with 2 × 2 filtered comparison. Each
//! view is fitted on its own. Maps are rendered in batches that fit a memory budget and are added into the mask, so
//! that 1024 views never need 1024 maps.
//!
//! Comparison is with the receiver's plane at each of the four texels (`compare = gather`), or by the hardware's
//! comparison sampler with one reference depth (`compare = hardware`, as in the papers), which needs a slope bias and
//! so detaches contacts at grazing light.
//!
//! # Limits
//! Every view rasterises the whole scene: time is views × triangles. Fewer views than the penumbra is wide show as
//! overlapping hard shadows, since all pixels share the light points. A sphere's points lie on the disc that faces the
//! middle of the receivers, so receivers far to the side see it a little too narrow.

use antumbra_light::{Aabb, Light, LightFrame, LightPoint, LightShape};
use glam::Vec3;

use crate::blocks::caster_depth::CasterDepth;
use crate::blocks::frame_inputs::FrameInputs;
use crate::blocks::light_view::{FitTo, LightView};
use crate::contract::{Casters, Error, Frame, Technique, TechniqueKind};
use crate::gpu::{
    Gpu, Recorder, Span, compute_pipeline, create_uniform, storage_entry, texture_entry, uniform_entry, upload_storage,
    write_uniform,
};
use crate::shaders;
use crate::techniques::map_resolve::{light_views, reach_tangent};

pub(crate) mod gpu_types;
mod params;

use gpu_types::{MultiViewBatch, MultiViewSample};
pub use params::{MultiViewCompare, MultiViewParams};

/// Maps of one batch together stay below this: WebGPU's default buffer limit, and little enough for any adapter.
const BATCH_BUDGET_BYTES: u64 = 64 << 20;

/// No batch is larger: beyond this the resolve's setup no longer shows.
const MAX_BATCH: u32 = 32;

/// One depth map per light sample.
#[derive(Debug)]
pub struct MultiView {
    casters: CasterDepth,
    inputs: FrameInputs,
    batch_layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    comparison_sampler: wgpu::Sampler,
    gather_sampler: wgpu::Sampler,
    maps: Option<Maps>,
    views: Option<wgpu::Buffer>,
    samples: Option<wgpu::Buffer>,
    view_count: u32,
    batches: Vec<Batch>,
}

/// The depth maps of one batch.
#[derive(Debug)]
struct Maps {
    array: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    size: u32,
}

/// Views `first..first + count` and their bind group.
#[derive(Debug)]
struct Batch {
    first: u32,
    count: u32,
    bind_group: wgpu::BindGroup,
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
        let batch_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra multi_view batch"),
            entries: &[
                uniform_entry(0, wgpu::ShaderStages::COMPUTE),
                storage_entry(1, wgpu::ShaderStages::COMPUTE),
                storage_entry(2, wgpu::ShaderStages::COMPUTE),
                texture_entry(3, wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array),
                sampler_entry(4, wgpu::SamplerBindingType::NonFiltering),
                sampler_entry(5, wgpu::SamplerBindingType::Comparison),
            ],
        });
        let pipeline = compute_pipeline(
            gpu,
            "multi_view accumulate",
            shaders::MULTI_VIEW_ACCUMULATE,
            &[&inputs.layout, &batch_layout],
        );
        let sampler = |label, filter, compare| {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                mag_filter: filter,
                min_filter: filter,
                compare,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        Ok(Self {
            casters: CasterDepth::new(gpu),
            batch_layout,
            pipeline,
            // Lit where the receiver is at least as near as the map: reversed depth.
            comparison_sampler: sampler(
                "antumbra compare",
                wgpu::FilterMode::Linear,
                Some(wgpu::CompareFunction::GreaterEqual),
            ),
            gather_sampler: sampler("antumbra gather", wgpu::FilterMode::Nearest, None),
            inputs,
            maps: None,
            views: None,
            samples: None,
            view_count: 0,
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
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if params.view_size > limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("light maps of {}² texels", params.view_size),
                had: format!("at most {limit}²"),
                remedy: "set a smaller `view_size`",
            });
        }
        self.inputs.prepare(gpu, technique, frame)?;

        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let points = light_points(frame.light, params, &bounds, frame.receivers.bounds);
        let views = views_from(frame.light, &points, &bounds, &frame.receivers.corners());
        let (clip_from_world, gpu_views) = light_views(&views, params.view_size);
        let total_weight: f32 = points.iter().map(|point| point.weight).sum();
        let samples: Vec<MultiViewSample> = points
            .iter()
            .map(|point| MultiViewSample {
                point: point.xyz.extend(point.w).to_array(),
                weight: point.weight / total_weight.max(f32::MIN_POSITIVE),
                ..MultiViewSample::default()
            })
            .collect();
        self.casters.prepare(gpu, &clip_from_world, meshes);
        self.view_count = views.len() as u32;

        let map_bytes = u64::from(params.view_size).pow(2) * 4;
        let batch_size = ((BATCH_BUDGET_BYTES / map_bytes) as u32).clamp(1, MAX_BATCH).min(self.view_count);
        if self.maps.as_ref().is_none_or(|m| m.size != params.view_size || m.layers.len() != batch_size as usize) {
            self.maps = Some(Maps::new(gpu, params.view_size, batch_size));
        }
        let views = upload_storage(gpu, &mut self.views, "antumbra multi_view views", &gpu_views);
        let samples = upload_storage(gpu, &mut self.samples, "antumbra multi_view samples", &samples);
        let maps = self.maps.as_ref().expect("made above where it was missing");

        self.batches = (0..self.view_count)
            .step_by(batch_size as usize)
            .map(|first| {
                let count = batch_size.min(self.view_count - first);
                let uniform = create_uniform::<MultiViewBatch>(gpu, "antumbra multi_view batch");
                write_uniform(
                    gpu,
                    &uniform,
                    &MultiViewBatch {
                        first,
                        count,
                        hardware_compare: (params.compare == MultiViewCompare::Hardware).into(),
                        bias_scale: params.bias_scale,
                    },
                );
                let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("antumbra multi_view batch"),
                    layout: &self.batch_layout,
                    entries: &[
                        wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                        wgpu::BindGroupEntry { binding: 1, resource: views.as_entire_binding() },
                        wgpu::BindGroupEntry { binding: 2, resource: samples.as_entire_binding() },
                        wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::TextureView(&maps.array) },
                        wgpu::BindGroupEntry {
                            binding: 4,
                            resource: wgpu::BindingResource::Sampler(&self.gather_sampler),
                        },
                        wgpu::BindGroupEntry {
                            binding: 5,
                            resource: wgpu::BindingResource::Sampler(&self.comparison_sampler),
                        },
                    ],
                });
                Batch { first, count, bind_group }
            })
            .collect();
        Ok(())
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let (Casters::Meshes(meshes), Some(maps)) = (&frame.casters, &self.maps) else { return };
        for batch in &self.batches {
            for (i, layer) in maps.layers.iter().take(batch.count as usize).enumerate() {
                let span = Span::of(i, batch.count as usize);
                recorder.depth_pass("depth maps", span, layer, CasterDepth::CLEAR_DEPTH, |pass| {
                    self.casters.draw(pass, batch.first + i as u32, meshes);
                });
            }
            recorder.compute("accumulate", Span::Only, |pass| {
                pass.set_pipeline(&self.pipeline);
                self.inputs.bind(pass);
                pass.set_bind_group(1, &batch.bind_group, &[]);
                self.inputs.dispatch(pass);
            });
        }
    }

    fn memory_bytes(&self) -> u64 {
        let maps = self.maps.as_ref().map_or(0, |m| u64::from(m.size).pow(2) * 4 * m.layers.len() as u64);
        let buffer = |buffer: &Option<wgpu::Buffer>| buffer.as_ref().map_or(0, wgpu::Buffer::size);
        maps + buffer(&self.views) + buffer(&self.samples)
    }
}

impl Maps {
    fn new(gpu: &Gpu, size: u32, layer_count: u32) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra multi_view maps"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layer_count },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: CasterDepth::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let array = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        });
        let layers = (0..layer_count)
            .map(|layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..wgpu::TextureViewDescriptor::default()
                })
            })
            .collect();
        Self { array, layers, size }
    }
}

/// The light points that all receivers share.
fn light_points(light: &Light, params: &MultiViewParams, casters: &[Aabb], receivers: Option<Aabb>) -> Vec<LightPoint> {
    let frame = light.frame();
    if let LightShape::Points { positions_m } = &light.shape {
        return positions_m.iter().map(|p| LightPoint { xyz: *p, w: 1.0, weight: 1.0 }).collect();
    }
    let all = receivers.unwrap_or_else(|| casters.iter().copied().fold(Aabb::EMPTY, Aabb::union));
    let seen_from = if all.is_empty() { light.center + light.axis } else { all.center() };
    params
        .sample_set
        .points(params.samples, params.seed)
        .into_iter()
        .map(|u| light.point(&frame, u, seen_from))
        .collect()
}

/// The views from all light points, of one roll, which suits the first.
fn views_from(light: &Light, points: &[LightPoint], casters: &[Aabb], receivers: &[Vec3]) -> Vec<LightView> {
    let Some(first) = points.first() else { return Vec::new() };
    let window = LightView::best_roll(|window| view_from(light, first, &FitTo { casters, receivers, window }));
    let fit = FitTo { casters, receivers, window };
    points.iter().map(|point| view_from(light, point, &fit)).collect()
}

/// The view from one light point, with the light's own axes; a sun's directions each have their own.
fn view_from(light: &Light, point: &LightPoint, fit: &FitTo<'_>) -> LightView {
    let frame = light.frame();
    if light.is_distant() {
        let axis = (-point.xyz).normalize_or(frame.axis);
        let right = axis.cross(frame.up).normalize_or(frame.right);
        let frame = LightFrame { center: Vec3::ZERO, right, up: right.cross(axis), axis };
        LightView::fit_orthographic(frame, 0.0, fit)
    } else {
        // Receivers are asked for from this point alone, but the light's own frustum starts at its centre.
        let margin_m = if light.fov_rad.is_some() { light.bounding_radius() } else { 0.0 };
        let frame = LightFrame { center: point.xyz, ..frame };
        LightView::fit_perspective(frame, margin_m, reach_tangent(light), fit)
    }
}
