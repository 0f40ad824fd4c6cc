//! What `reprojection` and `reprojection_layered` share: central maps, fragments scattered into a batch of views, and
//! that batch added into the mask.

use std::borrow::Cow;

use antumbra_light::{Aabb, Light, LightFrame, LightPoint};
use glam::{DMat4, DVec4, Mat4, Vec2, Vec3};

use super::gpu_types::{DrawMaps, SplatBatch};
use crate::blocks::caster_depth::{CasterDepth, CasterProgram, CasterProgramDescriptor};
use crate::blocks::depth_layers::{DepthLayers, array_view, slice_views};
use crate::blocks::frame_inputs::FrameInputs;
use crate::blocks::light_view::{FitTo, LightView, Window};
use crate::contract::{Casters, Error, Frame, MeshCaster, TechniqueKind, param_choice};
use crate::gpu::{
    Gpu, Recorder, Span, compute_pipeline, create_uniform, read_write_entry, shader_module, storage_entry,
    texture_entry, uniform_entry, upload_storage, write_uniform,
};
use crate::shaders;
use crate::techniques::map_resolve::fit_central_view;
use crate::techniques::sample_views::{
    Batch, Comparison, PointChoice, SampleViews, UnitPoints, batch_size, light_points, views_from,
};

param_choice! {
    /// Which shader stage scatters the fragments.
    pub enum ReprojectionPath {
        /// A compute pass over the central map.
        Compute = "compute",
        /// A fragment pass over the central map: the paper's three-pass form.
        Fragment = "fragment",
        /// The fragments of the central rasterisation themselves: the paper's two-pass form.
        FragmentTwoPass = "fragment_two_pass",
    }
}

param_choice! {
    /// How the integer maps are compared with receivers.
    pub enum ReprojectionFilter {
        /// Four loads from the integers.
        Manual = "manual",
        /// Copied into a float texture, one gather.
        Copy = "copy",
        /// Drawn into a depth texture, the hardware's comparison sampler.
        Draw = "draw",
    }
}

param_choice! {
    /// What the central map is.
    pub enum ReprojectionProjection {
        /// A cube where the light's plane view would be cut, a plane elsewhere.
        Auto = "auto",
        /// One view along the light's axis.
        Plane = "plane",
        /// The faces of a cube.
        Cube = "cube",
    }
}

/// Where a fragment is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Splat {
    /// In the texel that it falls in.
    Point,
    /// There, if it is no farther from the texel's centre than this, texels.
    NearCentre(f32),
    /// In every texel whose centre lies in its footprint, its slope held at this (depth per width).
    Surfel(f32),
}

/// Which fragments there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// The nearest layers, scattered from maps by compute.
    LayersByCompute(u32),
    /// The nearest layer, scattered from a map by a fragment pass.
    LayerByFragments,
    /// While rasterising: what passes the depth test until then.
    NearestWhileRasterising,
    /// While rasterising: everything.
    AllWhileRasterising,
}

/// One frame's settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) view_size: u32,
    pub(crate) central_size: u32,
    pub(crate) points: PointChoice,
    pub(crate) splat: Splat,
    pub(crate) source: Source,
    pub(crate) synchronized: bool,
    pub(crate) filter: ReprojectionFilter,
    pub(crate) projection: ReprojectionProjection,
    pub(crate) bias_before: bool,
    pub(crate) bias_scale: f32,
}

/// Integer maps of one batch together stay below this: half of WebGPU's smallest limit for a binding.
pub(crate) const BATCH_BUDGET_BYTES: u64 = 64 << 20;

/// Rows of the integer maps start where copies into textures may.
const ROW_ALIGNMENT_TEXELS: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4;

/// A plane view wider than this tangent is cut or wasteful; a cube takes its place.
const WIDEST_PLANE_TANGENT: f32 = 2.5;

/// Faces of a cube, in the order of `sample_views.wesl`; the last looks back and is left out for lights that send
/// nothing there.
const CUBE_FACES: usize = 6;

/// How far a cube's face reaches beyond its edge, texels: bilinear quads and the bias stay on the face.
const FACE_BORDER_TEXELS: f32 = 2.0;

/// Half a fragment's side, and a hundredth of it more: where both maps' texels fall on one grid, texel centres lie on
/// fragments' edges, and rounding would leave cracks. Reaching farther closes the last cracks of curved surfaces, and
/// widens every occluder: at .55 the leak on `shanty` falls by a third and the overshadow grows by a half.
pub(crate) const SURFEL_REACH: f32 = 0.505;

/// Central maps, scatter, accumulation.
#[derive(Debug)]
pub(crate) struct Engine {
    kind: TechniqueKind,
    inputs: FrameInputs,
    layers: DepthLayers,
    unit_points: UnitPoints,
    sample_views: SampleViews,
    splat_layout: wgpu::BindGroupLayout,
    central_layout: wgpu::BindGroupLayout,
    scatter: Option<(Source, Scatter)>,
    accumulate: Option<(ReprojectionFilter, Accumulate)>,
    matrices: Option<wgpu::Buffer>,
    targets: Option<wgpu::Buffer>,
    filterable: Option<Filterable>,
    prepared: Option<Prepared>,
    frame_number: u32,
    #[cfg(test)]
    matrices_on_cpu: Vec<Mat4>,
}

/// The pipelines of a [`Source`]; made when first asked for, since a host uses one.
#[derive(Debug)]
enum Scatter {
    Compute(wgpu::ComputePipeline),
    Screen(wgpu::RenderPipeline),
    Raster(CasterProgram),
}

/// The pipelines of a [`ReprojectionFilter`].
#[derive(Debug)]
struct Accumulate {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    gather_sampler: wgpu::Sampler,
    comparison_sampler: wgpu::Sampler,
    draw: Option<(wgpu::BindGroupLayout, wgpu::RenderPipeline)>,
}

/// What the integers are copied or drawn into.
#[derive(Debug)]
struct Filterable {
    texture: wgpu::Texture,
    array: wgpu::TextureView,
    slices: Vec<wgpu::TextureView>,
}

/// What `record` needs.
#[derive(Debug)]
struct Prepared {
    view_size: u32,
    row_texels: u32,
    faces: u32,
    central: Option<wgpu::BindGroup>,
    batches: Vec<PreparedBatch>,
    draw: Option<wgpu::BindGroup>,
}

#[derive(Debug)]
struct PreparedBatch {
    count: u32,
    /// One a central view.
    splats: Vec<wgpu::BindGroup>,
    accumulate: wgpu::BindGroup,
}

impl Engine {
    pub(crate) fn new(gpu: &Gpu, kind: TechniqueKind, with_gradients: bool) -> Self {
        let stages = wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT;
        let splat_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra splat"),
            entries: &[uniform_entry(0, stages), storage_entry(1, stages), read_write_entry(2, stages)],
        });
        let central_entry = |binding, sample_type| wgpu::BindGroupLayoutEntry {
            visibility: stages,
            ..texture_entry(binding, sample_type, wgpu::TextureViewDimension::D2Array)
        };
        let central_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra central map"),
            entries: &[
                central_entry(0, wgpu::TextureSampleType::Depth),
                central_entry(1, wgpu::TextureSampleType::Float { filterable: false }),
            ],
        });
        Self {
            kind,
            inputs: FrameInputs::new(gpu),
            layers: DepthLayers::new(gpu, with_gradients),
            unit_points: UnitPoints::default(),
            sample_views: SampleViews::new(),
            splat_layout,
            central_layout,
            scatter: None,
            accumulate: None,
            matrices: None,
            targets: None,
            filterable: None,
            prepared: None,
            frame_number: 0,
            #[cfg(test)]
            matrices_on_cpu: Vec::new(),
        }
    }

    /// The shift of this frame's light points: Halton's points (1960) in bases 2 and 3, which spread each point evenly
    /// over the frames. (Steps of the R2 sequence would carry an R2 set onto itself.)
    pub(crate) fn next_jitter(&mut self) -> Vec2 {
        let radical_inverse = |base: u32| {
            let (mut rest, mut digit, mut sum) = (self.frame_number, 1.0 / base as f32, 0.0);
            while rest > 0 {
                sum += (rest % base) as f32 * digit;
                rest /= base;
                digit /= base as f32;
            }
            sum
        };
        let shift = Vec2::new(radical_inverse(2), radical_inverse(3));
        self.frame_number = (self.frame_number + 1) % 4096;
        shift
    }

    pub(crate) fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, settings: &Settings) -> Result<(), Error> {
        let technique = self.kind.name();
        let Casters::Meshes(meshes) = &frame.casters else {
            return Err(Error::BadFrame {
                technique,
                what: "the casters",
                had: "a depth map".into(),
                needed: "meshes: the central map is fitted to the light's points".into(),
            });
        };
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if settings.central_size > limit || settings.view_size > limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("maps of {}² texels", settings.central_size.max(settings.view_size)),
                had: format!("at most {limit}²"),
                remedy: "set a smaller `view_size` or `central_scale`",
            });
        }
        self.inputs.prepare(gpu, technique, frame)?;

        let light = frame.light;
        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let seen = frame.receivers.corners();
        let points = light_points(light, &settings.points, &mut self.unit_points, &bounds, frame.receivers.bounds);
        let halved = Settings {
            view_size: (settings.view_size / 2).max(1),
            central_size: (settings.central_size / 2).max(1),
            ..*settings
        };
        let plane = central_plane(light, &bounds, &seen);
        let looks_back = light.reaches(&light.frame(), light.center - light.axis);
        let is_cube = needs_cube(light, &plane, looks_back, settings.projection);
        let settings = if is_cube { &halved } else { settings };
        let (central, targets) = if is_cube {
            let all = bounds.iter().copied().fold(Aabb::of(seen.iter().copied()), Aabb::union);
            central_and_target_cubes(plane.frame, &points, all, looks_back, settings)
        } else {
            (vec![plane], views_from(light, &points, &bounds, &seen, &[]))
        };
        let faces = central.len() as u32;
        let layers = match settings.source {
            Source::LayersByCompute(layers) => layers,
            _ => 1,
        };
        let clip_from_world: Vec<Mat4> = central.iter().map(LightView::clip_from_world).collect();
        self.layers.prepare(gpu, &clip_from_world, meshes, settings.central_size, layers);

        // Batches.
        let row_texels = settings.view_size.next_multiple_of(ROW_ALIGNMENT_TEXELS);
        let bytes_a_point = u64::from(row_texels) * u64::from(settings.view_size) * 4 * u64::from(faces);
        let array_limit = gpu.device.limits().max_texture_array_layers;
        let most = (points.len() as u32).min((array_limit / faces).max(1));
        let in_batch = batch_size(BATCH_BUDGET_BYTES, bytes_a_point, most);
        let bytes = bytes_a_point * u64::from(in_batch);
        let binding_limit = gpu.device.limits().max_storage_buffer_binding_size;
        if bytes > binding_limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("{bytes} bytes for one light point's maps"),
                had: format!("{binding_limit} bytes a binding"),
                remedy: "set a smaller `view_size`",
            });
        }
        let comparison = Comparison {
            view_size: settings.view_size,
            hardware_compare: settings.filter == ReprojectionFilter::Draw,
            bias_scale: if settings.bias_before { 0.0 } else { settings.bias_scale },
            slope_bias_texels: match settings.splat {
                Splat::Point => 0.5,
                Splat::NearCentre(texels) => texels,
                Splat::Surfel(_) => 0.0,
            },
        };
        self.sample_views.prepare(gpu, &points, &targets, in_batch, &comparison);
        if self.targets.as_ref().is_none_or(|buffer| buffer.size() != bytes) {
            self.targets = Some(gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra reprojected maps"),
                size: bytes,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }));
        }
        let mut matrices = target_from_central(&central, &targets, settings);
        matrices.extend(faces_from_central(&central, settings));
        upload_storage(gpu, &mut self.matrices, "antumbra targets from central", &matrices);
        #[cfg(test)]
        {
            self.matrices_on_cpu = matrices;
        }
        let middle = central[0].frame.center;
        let light_radius_m = points.iter().map(|point| point.xyz.distance(middle)).fold(0.0, f32::max);
        self.make_pipelines(gpu, settings);
        self.make_filterable(gpu, settings, in_batch * faces);
        self.prepared =
            Some(self.bind(gpu, settings, &central, targets.len() as u32, layers, row_texels, light_radius_m));
        Ok(())
    }

    fn bind(
        &self,
        gpu: &Gpu,
        settings: &Settings,
        central: &[LightView],
        list_length: u32,
        layers: u32,
        row_texels: u32,
        light_radius_m: f32,
    ) -> Prepared {
        const MADE: &str = "prepare has made it";
        let faces = central.len() as u32;
        let targets = self.targets.as_ref().expect(MADE);
        let matrices = self.matrices.as_ref().expect(MADE);
        let (_, accumulate) = self.accumulate.as_ref().expect(MADE);
        let bind_splat = |batch: &Batch, view: usize| {
            let (kind, reach, steepest) = match settings.splat {
                Splat::Point => (0, 0.0, 0.0),
                Splat::NearCentre(texels) => (1, texels, 0.0),
                Splat::Surfel(slope) => (2, SURFEL_REACH, slope),
            };
            let (width_of_depth, width) = central[view].depth_per_texel(settings.central_size, 1.0);
            let uniform = create_uniform::<SplatBatch>(gpu, "antumbra splat");
            write_uniform(
                gpu,
                &uniform,
                &SplatBatch {
                    view_size: settings.view_size,
                    row_texels,
                    first: view as u32 * list_length + batch.first,
                    count: batch.count,
                    faces,
                    points: list_length / faces,
                    first_slice: view as u32 * layers,
                    synchronized: settings.synchronized.into(),
                    kind,
                    reach,
                    steepest,
                    width_of_depth,
                    width,
                    first_face: faces * (list_length + view as u32),
                    face_half_size: central[0].window.half_size.x,
                    face_slack_m: (1.0 + central[0].window.half_size.x) * light_radius_m,
                    ..SplatBatch::default()
                },
            );
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra splat"),
                layout: &self.splat_layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: matrices.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 2, resource: targets.as_entire_binding() },
                ],
            })
        };
        let bind_accumulate = |batch: &Batch| {
            let mut entries = self.sample_views.entries(batch).to_vec();
            let sampler =
                |binding, sampler| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::Sampler(sampler) };
            match &self.filterable {
                None => entries.push(wgpu::BindGroupEntry { binding: 3, resource: targets.as_entire_binding() }),
                Some(filterable) => entries.extend([
                    wgpu::BindGroupEntry {
                        binding: 3,
                        resource: wgpu::BindingResource::TextureView(&filterable.array),
                    },
                    sampler(4, &accumulate.gather_sampler),
                ]),
            }
            if accumulate.draw.is_some() {
                entries.push(sampler(5, &accumulate.comparison_sampler));
            }
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra reprojected views"),
                layout: &accumulate.layout,
                entries: &entries,
            })
        };
        let batches = self
            .sample_views
            .batches()
            .iter()
            .map(|batch| PreparedBatch {
                count: batch.count,
                splats: (0..central.len()).map(|view| bind_splat(batch, view)).collect(),
                accumulate: bind_accumulate(batch),
            })
            .collect();
        let needs_central = matches!(settings.source, Source::LayersByCompute(_) | Source::LayerByFragments);
        let central_maps = needs_central.then(|| {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra central map"),
                layout: &self.central_layout,
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::TextureView(self.layers.depth_array()),
                    },
                    wgpu::BindGroupEntry {
                        binding: 1,
                        resource: wgpu::BindingResource::TextureView(self.layers.gradient_array()),
                    },
                ],
            })
        });
        let draw = accumulate.draw.as_ref().map(|(layout, _)| {
            let uniform = create_uniform::<DrawMaps>(gpu, "antumbra draw maps");
            let draw_maps = DrawMaps { view_size: settings.view_size, row_texels, ..DrawMaps::default() };
            write_uniform(gpu, &uniform, &draw_maps);
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra draw maps"),
                layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: targets.as_entire_binding() },
                ],
            })
        });
        Prepared { view_size: settings.view_size, row_texels, faces, central: central_maps, batches, draw }
    }

    fn make_pipelines(&mut self, gpu: &Gpu, settings: &Settings) {
        let pipeline_of = |source| match source {
            Source::LayersByCompute(_) => Source::LayersByCompute(1),
            other => other,
        };
        let source = pipeline_of(settings.source);
        if self.scatter.as_ref().is_none_or(|(made, _)| *made != source) {
            let scatter = match source {
                Source::LayersByCompute(_) => Scatter::Compute(self.compute_scatter(gpu)),
                Source::LayerByFragments => Scatter::Screen(self.screen_scatter(gpu)),
                Source::NearestWhileRasterising => Scatter::Raster(self.raster_scatter(gpu, true)),
                Source::AllWhileRasterising => Scatter::Raster(self.raster_scatter(gpu, false)),
            };
            self.scatter = Some((source, scatter));
        }
        if self.accumulate.as_ref().is_none_or(|(made, _)| *made != settings.filter) {
            self.accumulate = Some((settings.filter, Accumulate::new(gpu, self.kind, settings.filter, &self.inputs)));
        }
    }

    fn compute_scatter(&self, gpu: &Gpu) -> wgpu::ComputePipeline {
        let module = shader_module(gpu, "reprojection", shaders::REPROJECTION_SPLAT_COMPUTE);
        gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("reprojection"),
            layout: Some(&self.scatter_layout(gpu)),
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
    }

    /// Groups 1, the central map, and 2, the splat; group 0 is the casters' where there are any.
    fn scatter_layout(&self, gpu: &Gpu) -> wgpu::PipelineLayout {
        gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("reprojection"),
            bind_group_layouts: &[None, Some(&self.central_layout), Some(&self.splat_layout)],
            immediate_size: 0,
        })
    }

    fn screen_scatter(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        screen_pipeline(
            gpu,
            "reprojection by fragments",
            shaders::REPROJECTION_SPLAT_SCREEN,
            &self.scatter_layout(gpu),
            "splat",
            false,
        )
    }

    /// `nearest`: with the depth test, before the fragment stage where the device can be told so. Elsewhere, and on
    /// devices that cannot, hidden fragments are reprojected too.
    fn raster_scatter(&self, gpu: &Gpu, nearest: bool) -> CasterProgram {
        let early = nearest && gpu.has(wgpu::Features::SHADER_EARLY_DEPTH_TEST);
        let wgsl = |text: &'static str| -> Cow<'static, str> {
            if early { text.replace("@fragment", "@early_depth_test(force) @fragment").into() } else { text.into() }
        };
        self.layers.casters().program(
            gpu,
            &CasterProgramDescriptor {
                label: "reprojection while rasterising",
                opaque_wgsl: &wgsl(shaders::REPROJECTION_SPLAT_OPAQUE),
                cutout_wgsl: &wgsl(shaders::REPROJECTION_SPLAT_CUTOUT),
                opaque_fragment: Some("splat"),
                cutout_fragment: "splat",
                layout: Some(&self.splat_layout),
                targets: &[],
                depth_compare: if nearest { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Always },
                depth_write: nearest,
                front_faces_of_solids: !nearest,
                sample_count: 1,
            },
        )
    }

    fn make_filterable(&mut self, gpu: &Gpu, settings: &Settings, map_count: u32) {
        let (format, usage) = match settings.filter {
            ReprojectionFilter::Manual => {
                self.filterable = None;
                return;
            }
            ReprojectionFilter::Copy => (wgpu::TextureFormat::R32Float, wgpu::TextureUsages::COPY_DST),
            ReprojectionFilter::Draw => (CasterDepth::FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT),
        };
        let size =
            wgpu::Extent3d { width: settings.view_size, height: settings.view_size, depth_or_array_layers: map_count };
        if self.filterable.as_ref().is_some_and(|f| f.texture.size() == size && f.texture.format() == format) {
            return;
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra filterable reprojected maps"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        self.filterable = Some(Filterable { array: array_view(&texture), slices: slice_views(&texture), texture });
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        const MADE: &str = "prepare comes before record";
        let Casters::Meshes(meshes) = &frame.casters else { return };
        let prepared = self.prepared.as_ref().expect(MADE);
        let (_, scatter) = self.scatter.as_ref().expect(MADE);
        let (_, accumulate) = self.accumulate.as_ref().expect(MADE);
        let targets = self.targets.as_ref().expect(MADE);
        if prepared.central.is_some() {
            self.layers.record(recorder, "central depth map", meshes);
        }
        for batch in &prepared.batches {
            recorder.commands(REPROJECT, Span::First, |encoder| encoder.clear_buffer(targets, 0, None));
            for (view, splat) in batch.splats.iter().enumerate() {
                let span = if view + 1 == batch.splats.len() { Span::Last } else { Span::Middle };
                self.record_scatter(recorder, span, scatter, prepared, view as u32, splat, meshes);
            }
            if let Some(filterable) = &self.filterable {
                match (&accumulate.draw, &prepared.draw) {
                    (Some((_, pipeline)), Some(bind_group)) => {
                        record_draw(recorder, filterable, pipeline, bind_group, batch.count * prepared.faces);
                    }
                    _ => record_copy(recorder, filterable, targets, prepared, batch.count * prepared.faces),
                }
            }
            recorder.compute("accumulate", Span::Only, |pass| {
                pass.set_pipeline(&accumulate.pipeline);
                self.inputs.bind(pass);
                pass.set_bind_group(1, &batch.accumulate, &[]);
                self.inputs.dispatch(pass);
            });
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one step of `record`")]
    fn record_scatter(
        &self,
        recorder: &mut Recorder<'_>,
        span: Span,
        scatter: &Scatter,
        prepared: &Prepared,
        view: u32,
        splat: &wgpu::BindGroup,
        meshes: &[MeshCaster<'_>],
    ) {
        let held = self.layers.size();
        let slice = &self.layers.depth_slices()[(view * held.layers) as usize];
        match scatter {
            Scatter::Compute(pipeline) => recorder.compute(REPROJECT, span, |pass| {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, prepared.central.as_ref(), &[]);
                pass.set_bind_group(2, splat, &[]);
                let groups = held.size.div_ceil(SCATTER_TILE);
                pass.dispatch_workgroups(groups, groups, held.layers);
            }),
            Scatter::Screen(pipeline) => recorder.render_pass(REPROJECT, span, &[], slice, None, |pass| {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, prepared.central.as_ref(), &[]);
                pass.set_bind_group(2, splat, &[]);
                pass.draw(0..3, 0..held.layers);
            }),
            Scatter::Raster(program) => {
                let ops = wgpu::Operations {
                    load: wgpu::LoadOp::Clear(CasterDepth::CLEAR_DEPTH),
                    store: wgpu::StoreOp::Discard,
                };
                recorder.render_pass(REPROJECT, span, &[], slice, Some(ops), |pass| {
                    pass.set_bind_group(2, splat, &[]);
                    self.layers.casters().draw_with(program, pass, view, meshes);
                });
            }
        }
    }

    /// Bytes of central maps, one batch of integer maps, what they are copied into, and the lists.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let buffers = [&self.targets, &self.matrices].into_iter().flatten().map(wgpu::Buffer::size).sum::<u64>();
        let filterable = self.filterable.as_ref().map_or(0, |f| {
            let size = f.texture.size();
            u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers) * 4
        });
        self.layers.memory_bytes() + buffers + filterable + self.sample_views.memory_bytes()
    }

    /// The last batch's integer maps, the matrices, and the central depths and gradients, for tests.
    #[cfg(test)]
    pub(crate) fn parts(&self) -> (&wgpu::Buffer, &[Mat4], &[wgpu::Texture; 2]) {
        (self.targets.as_ref().expect("prepare comes first"), &self.matrices_on_cpu, self.layers.textures())
    }
}

/// The label of the scatter, its clearing included.
const REPROJECT: &str = "reprojected depth maps";

/// Threads along each side of a scatter's workgroup.
const SCATTER_TILE: u32 = 8;

fn record_copy(
    recorder: &mut Recorder<'_>,
    filterable: &Filterable,
    targets: &wgpu::Buffer,
    prepared: &Prepared,
    map_count: u32,
) {
    recorder.commands("filterable depth maps", Span::Only, |encoder| {
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo {
                buffer: targets,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(prepared.row_texels * 4),
                    rows_per_image: Some(prepared.view_size),
                },
            },
            filterable.texture.as_image_copy(),
            wgpu::Extent3d { width: prepared.view_size, height: prepared.view_size, depth_or_array_layers: map_count },
        );
    });
}

fn record_draw(
    recorder: &mut Recorder<'_>,
    filterable: &Filterable,
    pipeline: &wgpu::RenderPipeline,
    bind_group: &wgpu::BindGroup,
    map_count: u32,
) {
    for map in 0..map_count {
        let span = Span::of(map as usize, map_count as usize);
        let target = &filterable.slices[map as usize];
        recorder.depth_pass("filterable depth maps", span, target, CasterDepth::CLEAR_DEPTH, |pass| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind_group, &[]);
            pass.draw(0..3, map..map + 1);
        });
    }
}

impl Accumulate {
    fn new(gpu: &Gpu, kind: TechniqueKind, filter: ReprojectionFilter, inputs: &FrameInputs) -> Self {
        let mut entries = SampleViews::layout_entries().to_vec();
        let sampler_entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Sampler(ty),
            count: None,
        };
        let array = wgpu::TextureViewDimension::D2Array;
        let wgsl = match filter {
            ReprojectionFilter::Manual => {
                entries.push(storage_entry(3, wgpu::ShaderStages::COMPUTE));
                shaders::REPROJECTION_ACCUMULATE_MANUAL
            }
            ReprojectionFilter::Copy => {
                entries.push(texture_entry(3, wgpu::TextureSampleType::Float { filterable: false }, array));
                entries.push(sampler_entry(4, wgpu::SamplerBindingType::NonFiltering));
                shaders::REPROJECTION_ACCUMULATE_COPIED
            }
            ReprojectionFilter::Draw => {
                entries.push(texture_entry(3, wgpu::TextureSampleType::Depth, array));
                entries.push(sampler_entry(4, wgpu::SamplerBindingType::NonFiltering));
                entries.push(sampler_entry(5, wgpu::SamplerBindingType::Comparison));
                shaders::MULTI_VIEW_ACCUMULATE
            }
        };
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra reprojected views"),
            entries: &entries,
        });
        let sampler = |label, filter, compare| {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                mag_filter: filter,
                min_filter: filter,
                compare,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        let draw = (filter == ReprojectionFilter::Draw).then(|| {
            let stages = wgpu::ShaderStages::FRAGMENT;
            let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("antumbra draw maps"),
                entries: &[uniform_entry(0, stages), storage_entry(1, stages)],
            });
            let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("antumbra draw maps"),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let wgsl = shaders::REPROJECTION_DRAW;
            let pipeline = screen_pipeline(gpu, "antumbra draw maps", wgsl, &pipeline_layout, "draw", true);
            (layout, pipeline)
        });
        Self {
            pipeline: compute_pipeline(gpu, kind.name(), wgsl, &[&inputs.layout, &layout]),
            layout,
            gather_sampler: sampler("antumbra gather", wgpu::FilterMode::Nearest, None),
            // Lit where the receiver is at least as near as the map: reversed depth.
            comparison_sampler: sampler(
                "antumbra compare",
                wgpu::FilterMode::Linear,
                Some(wgpu::CompareFunction::GreaterEqual),
            ),
            draw,
        }
    }
}

/// A pipeline that draws a triangle over a whole depth attachment.
fn screen_pipeline(
    gpu: &Gpu,
    label: &str,
    wgsl: &str,
    layout: &wgpu::PipelineLayout,
    fragment: &str,
    depth_write: bool,
) -> wgpu::RenderPipeline {
    let module = shader_module(gpu, label, wgsl);
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: CasterDepth::FORMAT,
            depth_write_enabled: Some(depth_write),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// The one central view of a plane.
fn central_plane(light: &Light, casters: &[Aabb], receivers: &[Vec3]) -> LightView {
    let fit = |window| fit_central_view(light, &FitTo { casters, receivers, window });
    fit(LightView::best_roll(fit))
}

/// Whether the centre is a cube: where asked for, or where a plane view would be cut.
fn needs_cube(light: &Light, plane: &LightView, looks_back: bool, projection: ReprojectionProjection) -> bool {
    !light.is_distant()
        && match projection {
            ReprojectionProjection::Plane => false,
            ReprojectionProjection::Cube => true,
            ReprojectionProjection::Auto => {
                light.fov_rad.is_none() && (looks_back || plane.window.half_size.max_element() > WIDEST_PLANE_TANGENT)
            }
        }
}

/// The faces about the light's middle, and for each light point as many.
fn central_and_target_cubes(
    middle: LightFrame,
    points: &[LightPoint],
    all: Aabb,
    looks_back: bool,
    settings: &Settings,
) -> (Vec<LightView>, Vec<LightView>) {
    let faces = if looks_back { CUBE_FACES } else { CUBE_FACES - 1 };
    let cube = |center: Vec3, size| {
        let far_m = if all.is_empty() {
            1.0
        } else {
            all.corners().iter().map(|corner| corner.distance(center)).fold(0.0, f32::max)
        };
        cube_faces(LightFrame { center, ..middle }, far_m, size).into_iter().take(faces)
    };
    let central = cube(middle.center, settings.central_size).collect();
    (central, points.iter().flat_map(|point| cube(point.xyz, settings.view_size)).collect())
}

/// The faces of a cube about `frame`'s centre, in the order of [`CUBE_FACES`].
fn cube_faces(frame: LightFrame, far_m: f32, size: u32) -> [LightView; CUBE_FACES] {
    let LightFrame { right, up, axis, .. } = frame;
    let half_size = 1.0 / (1.0 - 2.0 * FACE_BORDER_TEXELS / size as f32).max(0.5);
    // Each (right, up, -axis) is right-handed.
    [
        (right, up, axis),
        (-axis, up, right),
        (axis, up, -right),
        (right, -axis, up),
        (right, axis, -up),
        (-right, up, -axis),
    ]
    .map(|(right, up, axis)| LightView {
        frame: LightFrame { right, up, axis, ..frame },
        perspective: true,
        window: Window::square(half_size),
        near_m: far_m * CUBE_NEAR_FRACTION,
        far_m: far_m * 1.001,
    })
}

/// The near plane of a cube's faces, as a fraction of the far plane: reversed 32-bit depths keep their precision.
const CUBE_NEAR_FRACTION: f32 = 1e-3;

/// Texels and depth of a target from texels and depth of the centre, for each central view a list for each face.
///
/// With bias before reprojection, the central depth first moves away from the light by the automatic bias of the
/// central map: Z grows by the factor 1 + b, or by b where rays are parallel, so that depth changes affinely.
fn target_from_central(central: &[LightView], targets: &[LightView], settings: &Settings) -> Vec<Mat4> {
    let mut matrices = Vec::with_capacity(central.len() * targets.len());
    for view in central {
        let mut world_from_texels = texels_from_world(view, settings.central_size).inverse();
        if settings.bias_before {
            let bias = 0.5 * settings.bias_scale * view.texel_in_plane(settings.central_size);
            world_from_texels *= view.depth_moved_away(bias);
        }
        let faces = central.len();
        for target in (0..faces).flat_map(|face| targets.iter().skip(face).step_by(faces)) {
            let matrix = texels_from_world(target, settings.view_size) * world_from_texels;
            // Any multiple is the same map; this one keeps w near 1.
            let scale = matrix.w_axis.w.abs().max(matrix.row(3).abs().max_element());
            matrices.push((matrix * scale.recip()).as_mat4());
        }
    }
    matrices
}

/// For each central view and each face: metres from the light's middle along the face's axes, homogeneous, from texels
/// and depth of the view.
fn faces_from_central(central: &[LightView], settings: &Settings) -> Vec<Mat4> {
    let metres_from_world = |frame: &LightFrame| {
        let rows = [frame.right, frame.up, frame.axis].map(|axis| {
            let axis = axis.as_dvec3();
            axis.extend(-axis.dot(frame.center.as_dvec3()))
        });
        DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose()
    };
    let mut matrices = Vec::with_capacity(central.len() * central.len());
    for view in central {
        let world_from_texels = texels_from_world(view, settings.central_size).inverse();
        matrices.extend(central.iter().map(|face| (metres_from_world(&face.frame) * world_from_texels).as_mat4()));
    }
    matrices
}

/// Texels and depth of a view's map, homogeneous.
fn texels_from_world(view: &LightView, size: u32) -> DMat4 {
    let half = 0.5 * f64::from(size);
    let texels_from_clip = DMat4::from_cols(
        DVec4::new(half, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -half, 0.0, 0.0),
        DVec4::Z,
        DVec4::new(half, half, 0.0, 1.0),
    );
    texels_from_clip * view.clip_from_world_f64()
}
