//! `ray_traced`: rays from each receiver to points of the light, through bounding volume hierarchies (trees) of the casters' triangles.
//!
//! Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980, introduced rays to lights; Cook, Porter, Carpenter,
//! "Distributed Ray Tracing", SIGGRAPH 1984, rays to points over a light. A pixel's visibility is the weighted mean of its rays'
//! transmittance. This is the definition: more rays converge to the truth, and the same points give the ray tracer's own figure.
//!
//! It runs in compute shaders on any WebGPU device, without a ray tracing extension. Trees have two levels: one tree over each mesh's
//! triangles in object space, built once (`mesh/mod.rs`) and refitted where vertices move, and one over the frame's instances, rebuilt
//! where casters may have moved. All are built on the GPU: the CPU's work does not grow with the number of triangles. `tree/mod.rs` names
//! the source of the trees, and why it was chosen.
//!
//! With `weights=irradiance` a ray is weighted by the irradiance that its point of the light gives the receiver: the mask is the
//! fraction of the light's own irradiance that arrives, by which a host multiplies an area light (Heitz, Hill, McGuire, "Combining
//! Analytic Direct Illumination and Stochastic Shadows", I3D 2018). An emission texture weighs by its luminance.
//!
//! Traversal is stackless: a ray's state is its position in each tree's order of nodes. It ends where no light is left. Textured casters
//! are sampled at each hit, twelve textures per pass, with further passes if there are more; the transmittances of several tinted
//! surfaces multiply along each ray.
//!
//! Segments begin and end as in `sample_based`: on the surface itself for closed casters, of which only the outside blocks; and at a ray
//! offset for open ones, which covers rounding and vertex snapping by the rasteriser.
//!
//! ```text
//! new meshes ──► boxes ──► codes ──► sort ──► links ──► fit ─┐
//! moved meshes ────────────────────────────────────────► fit ┤
//! instances ───► boxes ──► codes ──► sort ──► links ──► fit ─┴─► trace ──► mask
//! ```
//!
//! # Memory
//! 64 bytes per triangle of each mesh, however many instances it has (80 with a texture), and 245 per instance. Each light has its
//! own trees. Building meshes takes 68 bytes per triangle more, refitting 45.
//!
//! # Limits
//! Few rays show as noise, which [`Denoise`](crate::Denoise) removes. Time grows with the rays, and with the geometry around each:
//! leaves near the light are expensive. Meshes without a [version](crate::MeshCaster::version) are refitted in each frame, whether they
//! move or not, and keep their original order. A mesh that claims to be closed and is not leaks where it is open.

use glam::{Vec3, Vec4};

use antumbra_light::{Light, LightShape};

use crate::contract::{CastersKey, Error, MeshCaster, Opacity, PreparedFrame, SampleWeights};
use crate::gpu::{
    Bindings, Content, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, sized_buffer, upload_growable,
};
use crate::light_map::caster_surface::SurfaceValues;
use crate::light_map::readable_meshes::readable_meshes;
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;
use crate::techniques::{Coverage, Technique};

#[cfg(test)]
mod cpu;
pub(crate) mod gpu_types;
mod mesh;
mod params;
#[cfg(test)]
mod tests;
mod textures;
mod top;
mod tree;

use gpu_types::{CASTER_VECTORS, FLAG_CLOSED, FLAG_OPEN, RayBatch};
use mesh::{MeshPlace, Meshes};
pub use params::RayTracedParams;
use textures::{MAX_TEXTURES, Textures};
use top::Top;
use tree::TreePrograms;

bindings! {
    struct Traced = "ray_traced", COMPUTE, group 1 of [RAY_TRACED_TRACE] {
        0 rays: Uniform,
        1 tables: Storage,
        2 top_nodes: Storage,
        3 instances: Storage,
        4 nodes: Storage,
        5 triangles: Storage,
        6 snapped_texels: Uniform,
        7 passed_before: ReadWrite,
    }
}

/// Number of rays per pass on software drivers; their limit allows each about three thousand loop iterations.
const PASS_RAYS: u32 = 16;
/// Number of rays per pass on hardware GPUs.
const PASS_RAYS_OF_CARDS: u32 = 64;
/// Least loop limit of hardware GPUs: see [`max_iterations`](crate::gpu).
const TURNS_OF_CARDS: u32 = 1_000_000;

/// Technique that traces rays to points of the light.
#[derive(Debug)]
pub struct RayTraced {
    inputs: FrameInputs,
    trees: TreePrograms,
    meshes: Meshes,
    top: Top,
    layout: wgpu::BindGroupLayout,
    surfaces_layout: wgpu::BindGroupLayout,
    program: wgpu::ComputePipeline,
    no_texture: (wgpu::TextureView, wgpu::Sampler),
    tables: Option<wgpu::Buffer>,
    passed: Option<wgpu::Buffer>,
    /// Cache key of the tree over instances.
    content: Content<(CastersKey, u64)>,
}

/// Passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedRays {
    inputs: PreparedInputs,
    /// Whether the tree over instances has to be built.
    builds_top: bool,
    passes: Vec<Pass>,
}

/// Pass over some rays and one group of textures.
#[derive(Debug)]
struct Pass {
    rays: wgpu::BindGroup,
    surfaces: wgpu::BindGroup,
}

impl Technique for RayTraced {
    const NAME: &'static str = "ray_traced";
    type Params = RayTracedParams;
    type Prepared = PreparedRays;

    fn coverage(_params: &RayTracedParams) -> Coverage {
        Coverage::Everything
    }

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let inputs = FrameInputs::new(gpu);
        let (layout, surfaces_layout) = (Traced::layout(gpu), textures::layout(gpu));
        let layouts = [&inputs.layout, &layout, &surfaces_layout];
        Ok(Self {
            program: compute_pipeline(gpu, "ray_traced", shaders::RAY_TRACED_TRACE, &layouts),
            trees: TreePrograms::new(gpu),
            meshes: Meshes::new(gpu),
            top: Top::new(gpu),
            no_texture: textures::none(gpu),
            inputs,
            layout,
            surfaces_layout,
            tables: None,
            passed: None,
            content: Content::default(),
        })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &RayTracedParams,
    ) -> Result<PreparedRays, Error> {
        frame.light.validate().map_err(|source| Error::Light { technique: Self::NAME, source })?;
        let casters: Vec<&MeshCaster<'_>> = readable_meshes(Self::NAME, frame, None)?
            .iter()
            .filter(|caster| caster.index_count > 0 && caster.instance_count > 0)
            .collect();
        let inputs = self.inputs.prepare(stage, frame);
        let places = self.meshes.prepare(stage, &self.trees, Self::NAME, &casters)?;
        self.top.prepare(stage, &self.trees, Self::NAME, &casters, &places, self.meshes.nodes())?;
        let nodes = self.meshes.nodes().size();
        let builds_top = !self.content.ask(stage.casters().map(|casters| (casters, nodes)));
        let mut textures = Textures::default();
        let points = points_of(frame.light, params, stage.noise_frame());
        let mut table: Vec<[u32; 4]> = points.iter().map(|point| bits_of(point.at.extend(0.0))).collect();
        let sees_within = frame.sees_within();
        for (caster, place) in casters.iter().zip(&places) {
            let is_closed = caster.closed && !sees_within(&caster.bounds);
            table.extend(caster_words(caster, *place, is_closed, textures.number_of(caster)));
        }
        let passes = self.prepare_passes(stage, frame, params, &points, &table, &textures)?;
        Ok(PreparedRays { inputs, builds_top, passes })
    }

    fn record(&self, recorder: &mut Recorder<'_>, _frame: &PreparedFrame<'_>, prepared: &PreparedRays) {
        self.meshes.record(recorder, &self.trees);
        if prepared.builds_top {
            self.top.record(recorder, &self.trees);
        }
        recorder.compute("trace", Span::Only, |pass| {
            pass.set_pipeline(&self.program);
            prepared.inputs.bind(pass);
            for of_pass in &prepared.passes {
                pass.set_bind_group(1, &of_pass.rays, &[]);
                pass.set_bind_group(2, &of_pass.surfaces, &[]);
                prepared.inputs.dispatch(pass);
            }
        });
    }

    fn memory_bytes(&self) -> u64 {
        let own: u64 = [&self.tables, &self.passed].into_iter().flatten().map(wgpu::Buffer::size).sum();
        own + self.meshes.memory_bytes() + self.top.memory_bytes()
    }
}

impl RayTraced {
    /// Uploads the table of light points and casters, and returns a pass for each batch of rays and group of textures.
    fn prepare_passes(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &RayTracedParams,
        points: &[UnitPoint],
        table: &[[u32; 4]],
        textures: &Textures<'_>,
    ) -> Result<Vec<Pass>, Error> {
        let tables =
            upload_growable(stage, &mut self.tables, "antumbra ray tables", bytemuck::cast_slice(table)).clone();
        let surfaces = textures.groups(stage, &self.surfaces_layout, &self.no_texture);
        let weighs_irradiance = params.weights == SampleWeights::Irradiance;
        let pixels = u64::from(frame.receivers.size_px.x) * u64::from(frame.receivers.size_px.y);
        let stores_passed = surfaces.len() > 1;
        let pass_rays = rays_per_pass(stage, pixels, stores_passed, weighs_irradiance)?;
        let passed_stride = if stores_passed { pass_rays } else { 0 };
        let keeps_sums = weighs_irradiance && points.len() > pass_rays as usize;
        let passed_bytes = 4 * (pixels * (u64::from(passed_stride) + u64::from(keeps_sums))).max(1);
        let usage = wgpu::BufferUsages::STORAGE;
        let passed = sized_buffer(stage, &mut self.passed, "antumbra ray passed", passed_bytes, usage).clone();
        let all_weight = points.iter().map(|point| f64::from(point.weight)).sum::<f64>().max(f64::MIN_POSITIVE);
        let is_rotated = params.rotate && is_even(frame.light);
        let mut passes = Vec::new();
        let mut first_point = 0;
        for batch in points.chunks(pass_rays as usize) {
            let weight: f64 = batch.iter().map(|point| f64::from(point.weight)).sum();
            for (group, surfaces) in (0..).zip(&surfaces) {
                let rays = RayBatch {
                    first_point,
                    point_count: batch.len() as u32,
                    share: (weight / all_weight) as f32,
                    bias_scale: params.bias_scale,
                    all_points: points.len() as u32,
                    instance_count: self.top.count(),
                    texture_group: group,
                    is_last_group: (group + 1 == textures.group_count()).into(),
                    rotate: is_rotated.into(),
                    max_iterations: stage.device.max_iterations(),
                    passed_stride,
                    weighs_irradiance: weighs_irradiance.into(),
                };
                let traced = Traced {
                    rays: &stage.uniform("antumbra rays", &rays),
                    tables: &tables,
                    top_nodes: self.top.nodes(),
                    instances: self.top.instances(),
                    nodes: self.meshes.nodes(),
                    triangles: self.meshes.triangles(),
                    snapped_texels: stage.snapped_texels(),
                    passed_before: &passed,
                };
                passes.push(Pass { rays: traced.group(stage, &self.layout), surfaces: surfaces.clone() });
            }
            first_point += batch.len() as u32;
        }
        Ok(passes)
    }
}

/// Returns the number of rays per pass. `stores_passed`: each ray's transmittance is stored between passes over groups of textures, and
/// with `stores_sums` also a sum for each pixel; then a binding must hold them.
fn rays_per_pass(stage: &Stage<'_>, pixels: u64, stores_passed: bool, stores_sums: bool) -> Result<u32, Error> {
    let max_rays = if stage.device.max_iterations() < TURNS_OF_CARDS { PASS_RAYS } else { PASS_RAYS_OF_CARDS };
    if !stores_passed {
        return Ok(max_rays);
    }
    let words = stage.device.limits().max_storage_buffer_binding_size / 4 / pixels.max(1);
    let rays = words.saturating_sub(stores_sums.into()).min(u64::from(max_rays)) as u32;
    if rays == 0 {
        return Err(Error::Unsupported {
            technique: RayTraced::NAME,
            needed: format!(
                "{} bytes for the transmittance of one ray per pixel, besides so many textures",
                4 * pixels
            ),
            had: "too little left in a binding".into(),
            remedy: "use a smaller mask or fewer textures, or request a larger max_storage_buffer_binding_size",
        });
    }
    Ok(rays)
}

/// Point of the unit cube, which the shader maps to the light, and the weight of the light that it represents.
#[derive(Clone, Copy, Debug)]
struct UnitPoint {
    at: Vec3,
    weight: f32,
}

/// Returns the points that rays go to; for a list of points as many as it has.
fn points_of(light: &Light, params: &RayTracedParams, run: u32) -> Vec<UnitPoint> {
    if let LightShape::Points { positions_m } = &light.shape {
        return vec![UnitPoint { at: Vec3::ZERO, weight: 1.0 }; positions_m.len()];
    }
    let picture = light.emission.as_ref().filter(|_| matches!(light.shape, LightShape::Rectangle { .. }));
    let weight = |at: Vec3| picture.map_or(1.0, |picture| picture.luminance_at(at.truncate()));
    let points = params.sample_set.run(run, params.samples, params.seed);
    points.into_iter().map(|at| UnitPoint { at, weight: weight(at) }).collect()
}

/// Whether the light is the same under any shift of the points on the torus.
fn is_even(light: &Light) -> bool {
    !matches!(light.shape, LightShape::Points { .. }) && light.emission.is_none()
}

fn bits_of(vector: Vec4) -> [u32; 4] {
    vector.to_array().map(f32::to_bits)
}

/// Returns a caster's entry in the table: see `top/instance.wesl`.
fn caster_words(
    caster: &MeshCaster<'_>,
    place: MeshPlace,
    is_closed: bool,
    texture: Option<u32>,
) -> [[u32; 4]; CASTER_VECTORS as usize] {
    let MeshPlace { first_node, first_triangle, triangle_stride } = place;
    let group = texture.map_or(0, |number| number / MAX_TEXTURES);
    let slot = texture.map_or(u32::from(u8::MAX), |number| number % MAX_TEXTURES);
    let is_opaque = matches!(caster.opacity, Opacity::Opaque);
    let flags = if !is_opaque {
        FLAG_OPEN
    } else if is_closed {
        FLAG_CLOSED
    } else {
        0
    };
    let surface = SurfaceValues::of(&caster.opacity);
    let (factor, cutoff, coverage) =
        surface.map_or((Vec4::ZERO, 0.0, 0), |surface| (surface.factor, surface.cutoff, surface.coverage));
    [[flags, first_node, first_triangle, triangle_stride], bits_of(factor), [cutoff.to_bits(), coverage, slot, group]]
}
