//! Irradiance of surfaces by a light of unit radiance: traced, and unshadowed by the image's shader.
//!
//! A renderer's image of a white diffuse surface is irradiance over π, and a mask is a factor of it. [`IrradianceTruth`]
//! is the ground truth of their product.

use std::f64::consts::PI;
use std::num::NonZero;
use std::thread;

use antumbra_light::{Light, LightPoint, LightShape, SampleSet};
use antumbra_reference::{ReceiverPoint, Receivers, ReferenceError, SampledLight, Tracer, VisibilityOptions};
use antumbra_render::shading::{IRRADIANCE_WGSL, LightBuffers};
use antumbra_scene::{Scene, Setup};
use glam::{DVec3, UVec2, Vec3, Vec4};
use wgpu::util::DeviceExt;

use crate::device::{DeviceError, LabDevice};
use crate::error::LabError;
use crate::picture::{Visibility, VisibilityValues};
use crate::readback::read_f32;
use crate::truth::{SurfacePoint, is_same_surface};
use crate::view::View;

/// Irradiance of all visible surfaces by one light.
#[derive(Clone, Debug)]
pub struct IrradianceTruth {
    /// Traced irradiance and analytic unshadowed irradiance of each pixel; `None` for background and where depth buffer
    /// and camera ray show different surfaces.
    pixels: Vec<Option<(TracedIrradiance, f64)>>,
}

impl IrradianceTruth {
    /// Traces `rays` light samples from every pixel of a view, for the setup's light with index `light`.
    ///
    /// # Errors
    /// If the scene or the light cannot be traced, or the device fails.
    pub fn new(
        lab: &LabDevice,
        scene: &Scene,
        setup: &Setup,
        size_px: UVec2,
        light: usize,
        rays: u32,
    ) -> Result<Self, LabError> {
        let (camera, light) = (&setup.camera, &setup.lights[light]);
        let tracer = Tracer::new(scene)?;
        let mut receivers = tracer.primary(camera, size_px);
        let drawn = View::new(lab, scene, setup, size_px)?.surface_points()?;
        for (hit, drawn) in receivers.points.iter_mut().zip(drawn) {
            let of = |hit: &ReceiverPoint| SurfacePoint { position: hit.position, normal: hit.normal };
            *hit = hit.filter(|hit| drawn.is_some_and(|drawn| is_same_surface(&of(hit), &drawn, camera.eye)));
        }
        let options = VisibilityOptions { samples: rays, set: SampleSet::Stratified, ..VisibilityOptions::default() };
        let traced = traced(&tracer, &receivers, light, &options)?;
        let frame = light.frame();
        let hits = receivers.points.iter().flatten();
        let places: Vec<_> = hits.clone().map(|hit| (hit.position, hit.normal)).collect();
        let mut analytic = analytic(lab, light, &places)?
            .into_iter()
            .zip(hits)
            .map(|(irradiance, hit)| if light.reaches(&frame, hit.position) { f64::from(irradiance) } else { 0.0 });
        Ok(Self { pixels: traced.into_iter().map(|traced| Some((traced?, analytic.next()?))).collect() })
    }

    /// Returns the number of valid pixels.
    pub fn count(&self) -> usize {
        self.pixels.iter().flatten().count()
    }

    /// Returns the root mean square error of analytic irradiance times a mask (green if coloured), relative to the mean irradiance.
    pub fn rmse(&self, mask: &Visibility) -> f64 {
        self.rmse_of(|i, _| match &mask.values {
            VisibilityValues::One(values) => values[i].into(),
            VisibilityValues::Three(values) => values[i].y.into(),
        })
    }

    /// Returns the same error for the traced visibility: the error of the plain product with exact visibility.
    pub fn rmse_of_visibility(&self) -> f64 {
        self.rmse_of(|_, traced| traced.visibility)
    }

    /// Returns the same error for the traced ratio: the difference between analytic unshadowed irradiance and its sum over samples.
    pub fn rmse_of_ratio(&self) -> f64 {
        self.rmse_of(|_, traced| traced.arriving / traced.unshadowed.max(f64::MIN_POSITIVE))
    }

    fn rmse_of(&self, factor: impl Fn(usize, &TracedIrradiance) -> f64) -> f64 {
        let (mut squares, mut sum) = (0.0, 0.0);
        for (i, pixel) in self.pixels.iter().enumerate() {
            if let Some((traced, analytic)) = pixel {
                squares += (factor(i, traced) * analytic - traced.arriving).powi(2);
                sum += analytic;
            }
        }
        let count = self.count() as f64;
        (squares / count).sqrt() / (sum / count)
    }
}

/// Irradiance by a light of unit radiance, summed over samples of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedIrradiance {
    /// Irradiance that passes the opaque casters.
    pub arriving: f64,
    /// Irradiance without casters.
    pub unshadowed: f64,
    /// Visible fraction of the light's points, as `docs/formats.md` defines visibility.
    pub visibility: f64,
}

/// Returns the irradiance of every receiver, from one ray to each point of the light; `None` for background. Casters that
/// transmit light are ignored. A sphere is the disc that faces the receiver, as for visibility: its irradiance is less than the
/// sphere's by the square of radius over distance.
///
/// # Errors
/// If the light or the options are invalid.
pub fn traced(
    tracer: &Tracer,
    receivers: &Receivers,
    light: &Light,
    options: &VisibilityOptions,
) -> Result<Vec<Option<TracedIrradiance>>, ReferenceError> {
    let light = (light, &SampledLight::new(light, options)?);
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let chunk = receivers.points.len().div_ceil(threads).max(1);
    let parts: Vec<Vec<_>> = thread::scope(|scope| {
        let part = |(k, points): (usize, &'_ [Option<ReceiverPoint>])| {
            let points = points.to_vec();
            scope.spawn(move || {
                let indexed = (k * chunk..).zip(&points);
                indexed.map(|(i, point)| point.map(|point| traced_at(tracer, light, i, &point))).collect()
            })
        };
        let running: Vec<_> = receivers.points.chunks(chunk).enumerate().map(part).collect();
        running.into_iter().map(|part| part.join().expect("threads do not panic")).collect()
    });
    Ok(parts.concat())
}

fn traced_at(
    tracer: &Tracer,
    (light, sampled): (&Light, &SampledLight),
    index: usize,
    receiver: &ReceiverPoint,
) -> TracedIrradiance {
    let mask = tracer.visible_mask(sampled, index, receiver);
    let points = sampled.points_for(index, receiver.position);
    let (mut all, mut arriving, mut weight, mut seen) = (0.0, 0.0, 0.0, 0.0);
    let reached = f64::from(u8::from(light.reaches(&light.frame(), receiver.position)));
    for (i, point) in points.iter().enumerate() {
        let open = f64::from((mask[i / 64] >> (i % 64) & 1) as u32);
        let emitted = f64::from(point.weight);
        let given = emitted * reached * given_by_point(light, point, receiver);
        all += given;
        arriving += open * given;
        weight += emitted;
        seen += open * emitted;
    }
    let per_point = measure(light) / f64::max(weight, f64::MIN_POSITIVE);
    TracedIrradiance {
        arriving: per_point * arriving,
        unshadowed: per_point * all,
        visibility: seen / f64::max(weight, f64::MIN_POSITIVE),
    }
}

/// Returns the product of both cosines over the squared distance.
fn given_by_point(light: &Light, point: &LightPoint, receiver: &ReceiverPoint) -> f64 {
    let d = point.vector_from(receiver.position).as_dvec3();
    let facing: Option<DVec3> = match light.shape {
        LightShape::Ellipsoid { .. } | LightShape::Points { .. } => None,
        LightShape::Sphere { .. } => Some((receiver.position - light.center).as_dvec3().normalize()),
        _ => Some(light.frame().axis.as_dvec3()),
    };
    let squared = d.length_squared();
    let towards = d / squared.sqrt();
    let cosines = towards.dot(receiver.normal.as_dvec3()).max(0.0) * facing.map_or(1.0, |n| (-n.dot(towards)).max(0.0));
    cosines / squared
}

/// Returns the area that the light's points represent together, m²; for a sun, on its tangent disc at a distance of 1. For a list, all
/// points share one radiant intensity.
fn measure(light: &Light) -> f64 {
    match &light.shape {
        LightShape::Rectangle { size_m } => f64::from(size_m.x) * f64::from(size_m.y),
        LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => PI * f64::from(*radius_m).powi(2),
        LightShape::Ellipsoid { radii_m } => PI * f64::from(radii_m.element_product()).powf(2.0 / 3.0),
        LightShape::Sun { angular_diameter_rad } => PI * f64::from((0.5 * angular_diameter_rad).tan()).powi(2),
        LightShape::Points { .. } => 1.0,
    }
}

/// Shader that evaluates `irradiance` at points with normals.
const PROBE: &str = "
struct Receiver { pos_in_world: vec3f, normal_in_world: vec3f, }
@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<storage, read> light_points: array<vec4f>;
@group(0) @binding(2) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(3) var results: texture_storage_2d<r32float, write>;
@compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3u) {
    let i = id.y * textureDimensions(results).x + id.x;
    if i < arrayLength(&receivers) {
        let receiver = receivers[i];
        textureStore(results, id.xy, vec4f(irradiance(light, receiver.pos_in_world, receiver.normal_in_world)));
    }
}
";

/// Number of receivers per row of the results.
const ROW: u32 = 1024;

/// Returns the unshadowed irradiance at points with normals, by a light of unit radiance (a list of points: of unit intensity), as
/// [`Shading`](crate::shading::Shading) computes it.
///
/// # Errors
/// If the device fails.
pub fn analytic(lab: &LabDevice, light: &Light, receivers: &[(Vec3, Vec3)]) -> Result<Vec<f32>, DeviceError> {
    if receivers.is_empty() {
        return Ok(Vec::new());
    }
    let device = &lab.device;
    let pipeline = probe_pipeline(device);
    let buffers = LightBuffers::new(device, light, Vec3::ZERO);
    let buffer = |contents: &[u8], usage| {
        let label = Some("irradiance");
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage })
    };
    let uniform = buffer(buffers.uniform_bytes(), wgpu::BufferUsages::UNIFORM);
    let places: Vec<Vec4> = receivers.iter().flat_map(|(x, n)| [x.extend(0.0), n.extend(0.0)]).collect();
    let storage = buffer(bytemuck::cast_slice(&places), wgpu::BufferUsages::STORAGE);
    let size = wgpu::Extent3d {
        width: ROW.min(receivers.len() as u32),
        height: (receivers.len() as u32).div_ceil(ROW),
        depth_or_array_layers: 1,
    };
    let results = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("irradiance"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let resources = [
        uniform.as_entire_binding(),
        buffers.points.as_entire_binding(),
        storage.as_entire_binding(),
        wgpu::BindingResource::TextureView(&results.create_view(&wgpu::TextureViewDescriptor::default())),
    ];
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("irradiance"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(size.width, size.height, 1);
    }
    lab.queue.submit([encoder.finish()]);
    let mut values = read_f32(lab, &results)?;
    values.truncate(receivers.len());
    Ok(values)
}

/// Creates the pipeline that evaluates the irradiance of each point.
fn probe_pipeline(device: &wgpu::Device) -> wgpu::ComputePipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("irradiance"),
        source: wgpu::ShaderSource::Wgsl([IRRADIANCE_WGSL, PROBE].concat().into()),
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("irradiance"),
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}
