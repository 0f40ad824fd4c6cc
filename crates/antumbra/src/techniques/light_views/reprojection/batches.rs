//! Shared passes of `reprojection` and `reprojection_layered`: central maps, fragments scattered into a batch of views, and
//! that batch added to the mask; batch after batch, within a memory budget.

#[cfg(test)]
use std::sync::Arc;

use antumbra_light::Aabb;
#[cfg(test)]
use glam::Mat4;
use glam::Vec2;

use super::behind::open_about_light;
use super::central::Views;
use super::resolve::{PreparedResolve, Resolve};
use super::scatter::{PreparedScatter, Scatter, Targets};
use super::settings::{ReprojectionFilter, Settings, Splat};
use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::gpu::{Gpu, LeasedBuffer, Recorder, Scratch, Stage};
use crate::light_map::caster_depth::{CasterDepth, check_map_size};
use crate::light_map::depth_layers::{DepthLayers, LayersSize};
use crate::light_map::light_view::{LightView, LightViewGpu};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::techniques::light_views::{Comparison, SampleViews, UnitPoints, batch_size, light_points};

/// Memory budget of one batch's integer maps, bytes: half of WebGPU's smallest limit for a binding.
pub(crate) const BATCH_BUDGET_BYTES: u64 = 64 << 20;

/// Alignment of the integer maps' rows, texels: that of copies to textures.
const ROW_ALIGNMENT_TEXELS: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4;

/// Central maps, scatter and resolve of a reprojecting technique.
#[derive(Debug)]
pub(crate) struct Engine {
    technique: &'static str,
    inputs: FrameInputs,
    layers: DepthLayers,
    with_gradients: bool,
    unit_points: UnitPoints,
    sample_views: SampleViews,
    scatter: Scatter,
    resolve: Resolve,
    target_buffer: LeasedBuffer,
    /// Views of the frame's central maps; empty if no central map is drawn.
    central: Vec<LightViewGpu>,
    frame_number: u32,
    #[cfg(test)]
    matrices_on_cpu: Vec<Mat4>,
    #[cfg(test)]
    widths: Vec<(f32, f32)>,
}

/// Passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedEngine {
    inputs: PreparedInputs,
    needs_central_map: bool,
    is_from_behind: bool,
    faces: u32,
    targets: Targets,
    scatter: PreparedScatter,
    resolve: PreparedResolve,
}

/// State that tests compare with the CPU reference.
#[cfg(test)]
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    /// Integer maps of the last batch.
    pub(crate) targets: &'a wgpu::Buffer,
    /// Matrices from the central images to the targets: see `central.rs`.
    pub(crate) matrices: &'a [Mat4],
    /// Width of a texel of each central view as a difference in depth: (a, b) of a · depth + b.
    pub(crate) widths: &'a [(f32, f32)],
    /// Central depths and gradients.
    pub(crate) central: &'a [Arc<wgpu::Texture>; 2],
    /// List of surfels and its counts, if there is one.
    pub(crate) list: Option<[&'a wgpu::Buffer; 2]>,
}

impl Engine {
    pub(crate) fn new(gpu: &Gpu, technique: &'static str, with_gradients: bool) -> Self {
        Self {
            technique,
            inputs: FrameInputs::new(gpu),
            layers: DepthLayers::new(gpu),
            with_gradients,
            unit_points: UnitPoints::default(),
            sample_views: SampleViews::new(),
            scatter: Scatter::new(gpu),
            resolve: Resolve::new(technique),
            target_buffer: LeasedBuffer::default(),
            central: Vec::new(),
            frame_number: 0,
            #[cfg(test)]
            matrices_on_cpu: Vec::new(),
            #[cfg(test)]
            widths: Vec::new(),
        }
    }

    /// Shift of this frame's light points: Halton's points (1960) in bases 2 and 3, which spread each point evenly
    /// over the frames. (Steps of the R2 sequence would map an R2 set onto itself.)
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

    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        settings: &Settings,
    ) -> Result<PreparedEngine, Error> {
        let meshes = frame.casters.meshes(self.technique, "the central map is fitted to the light's points")?;
        let largest = settings.central_size.max(settings.view_size);
        check_map_size(stage, self.technique, largest, "set a smaller `view_size` or `central_scale`")?;
        let inputs = self.inputs.prepare(stage, frame);

        let light = frame.light;
        let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
        let points = light_points(light, &settings.points, &mut self.unit_points);
        let views = Views::of(light, &points, &bounds, &frame.receivers.corners(), settings);
        let faces = views.faces();
        let clip_from_world: Vec<_> = views.central.iter().map(LightView::clip_from_world).collect();
        let layers_size = LayersSize {
            size: views.central_size,
            views: clip_from_world.len() as u32,
            // Surfaces behind the light take one layer.
            layers: settings.source.layers() + u32::from(views.behind.is_some()),
            with_gradients: self.with_gradients,
        };
        let is_from_behind = views.behind.is_some();
        let drawn = if is_from_behind { &open_about_light(light, meshes) } else { meshes };
        self.layers.prepare(stage, &clip_from_world, drawn, layers_size);

        let (targets, in_batch) = self.make_targets(stage, &views, points.len() as u32)?;
        let comparison = comparison(settings, views.view_size);
        self.sample_views.prepare(stage, &points, &views.targets, in_batch, &comparison);
        let matrices = views.matrices(settings);
        let (groups, ranges) = matrices.groups(faces, self.sample_views.batches());
        let scatter = self.scatter.prepare(
            stage,
            settings,
            &views,
            matrices.is_affine,
            (&groups, &ranges),
            &self.layers,
            &targets,
            &points,
            frame.receivers.bounds.filter(|bounds| !bounds.is_empty()),
        );
        let resolve = self.resolve.prepare(stage, settings.filter, &self.inputs, &self.sample_views, &targets);
        let needs_central_map = settings.source.needs_central_map();
        let drawn = if needs_central_map { &views.central[..] } else { &[] };
        self.central = drawn.iter().map(|view| view.to_gpu(views.central_size)).collect();
        #[cfg(test)]
        {
            self.widths = views.central.iter().map(|v| v.depth_per_texel(views.central_size, 1.0)).collect();
            self.matrices_on_cpu = matrices.target_from_central;
        }
        Ok(PreparedEngine { inputs, needs_central_map, is_from_behind, faces, targets, scatter, resolve })
    }

    /// Allocates the integer maps of as many of `point_count` light points as the budget holds, and returns that number, too.
    fn make_targets(&mut self, stage: &Stage<'_>, views: &Views, point_count: u32) -> Result<(Targets, u32), Error> {
        let (view_size, faces) = (views.view_size, views.faces());
        let row_texels = view_size.next_multiple_of(ROW_ALIGNMENT_TEXELS);
        let bytes_a_point = u64::from(row_texels) * u64::from(view_size) * 4 * u64::from(faces);
        let array_limit = stage.device.limits().max_texture_array_layers;
        let most = point_count.min((array_limit / faces).max(1));
        let in_batch = batch_size(BATCH_BUDGET_BYTES, bytes_a_point, most);
        let bytes = bytes_a_point * u64::from(in_batch);
        let binding_limit = stage.device.limits().max_storage_buffer_binding_size;
        if bytes > binding_limit {
            return Err(Error::Unsupported {
                technique: self.technique,
                needed: format!("{bytes} bytes for one light point's maps"),
                had: format!("at most {binding_limit} bytes per binding"),
                remedy: "set a smaller `view_size`",
            });
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let descriptor = wgpu::BufferDescriptor {
            label: Some("antumbra reprojected maps"),
            size: bytes,
            usage,
            mapped_at_creation: false,
        };
        let buffer = self.target_buffer.sized(&stage.device, Scratch::ReprojectedMaps, &descriptor).clone();
        Ok((Targets { buffer, view_size, row_texels, map_count: in_batch * faces }, in_batch))
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedEngine) {
        let PreparedCasters::Draws(meshes) = &frame.casters else { return };
        if prepared.needs_central_map {
            let drawn = if prepared.is_from_behind { &open_about_light(frame.light, meshes) } else { *meshes };
            self.layers.record(recorder, "central depth map", 0..self.layers.size().views, drawn);
        }
        for (index, batch) in self.sample_views.batches().iter().enumerate() {
            let targets = &prepared.targets;
            self.scatter.record(recorder, &self.layers, targets, &prepared.scatter, index, meshes);
            let map_count = batch.count * prepared.faces;
            self.resolve.record(recorder, &prepared.inputs, targets, &prepared.resolve, index, map_count);
        }
    }

    /// Central maps with their layers, if there are any and they belong to this light. Maps of light points are buffers, and not included.
    pub(crate) fn drawn_maps(&self) -> Vec<DrawnMap> {
        if self.central.is_empty() || !self.layers.are_own() {
            return Vec::new();
        }
        let layers = self.layers.size().layers as usize;
        let map = |(view, slices): (&LightViewGpu, &[wgpu::TextureView])| DrawnMap {
            layers_behind: slices[1..].to_vec(),
            ..view.drawn_map(&slices[0], 1, CasterDepth::CLEAR_DEPTH)
        };
        self.central.iter().zip(self.layers.depth_slices().chunks_exact(layers)).map(map).collect()
    }

    /// Bytes of central maps, one batch of integer maps, the texture that they are copied into, and the lists.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.layers.memory_bytes()
            + self.target_buffer.own_bytes()
            + self.scatter.memory_bytes()
            + self.resolve.memory_bytes()
            + self.sample_views.memory_bytes()
    }

    /// Returns the state that tests compare with the CPU reference.
    #[cfg(test)]
    pub(crate) fn parts(&self) -> Parts<'_> {
        Parts {
            targets: self.target_buffer.buffer().expect("prepare comes first"),
            matrices: &self.matrices_on_cpu,
            widths: &self.widths,
            central: self.layers.textures(),
            list: self.scatter.list_buffers(),
        }
    }

    /// Limits the list of surfels for a test: names of one piece, and of all pieces.
    #[cfg(test)]
    pub(crate) fn limit_list(&mut self, piece: u32, kept: u64) {
        self.scatter.limit(super::surfel_list::Limits { piece, kept });
    }
}

/// Returns the comparison of receivers with maps of `view_size`² texels.
fn comparison(settings: &Settings, view_size: u32) -> Comparison {
    Comparison {
        view_size,
        hardware_compare: settings.filter == ReprojectionFilter::Draw,
        bias_scale: if settings.bias_before { 0.0 } else { settings.bias_scale },
        kernel_texels: 0.0,
        light_radius: 0.0,
        slope_bias_texels: match settings.splat {
            Splat::Point => 0.5,
            Splat::NearCentre(texels) => texels,
            Splat::Surfel(_) => 0.0,
        },
    }
}
