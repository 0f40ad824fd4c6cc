//! Mean of a mask over the frames in which nothing moved.
//!
//! This block serves any technique whose frames differ by random numbers alone. The technique writes its mask, and this block
//! replaces each pixel by the mean of all its frames since the last change. Sintorn, Eisemann, Assarsson 2008 (section 4.2,
//! figure 7) accumulate this way "if the scene is static and the camera does not move".
//!
//! Changes are: the light, the camera, the mask's size, the technique's settings and the list of meshes, which the CPU compares; the
//! *content* of the casters' buffers, known by a caster set's version or, without a set, by a fingerprint computed on the GPU; and a
//! pixel's own depth, which restarts that pixel alone. The first frame after a change is the technique's own, bit for bit.
//!
//! ```text
//! casters ──► fingerprint ─┐
//! mask, depth, means ──────┴─► accumulate ──► mask, means
//! ```

use std::hash::{DefaultHasher, Hash, Hasher};

use antumbra_light::Light;
use glam::UVec2;

use crate::contract::{
    Camera, CastersKey, Error, MeshCaster, Opacity, PreparedCasters, PreparedFrame, SurfaceCoverage, SurfaceTexture,
};
use crate::gpu::{
    Bindings, Content, Gpu, Recorder, Span, Stage, bindings, compute_entry, compute_pipeline, create_uniform,
    gpu_structs, sized_buffer, write_uniform,
};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;

gpu_structs! {
    /// Data of one frame.
    pub(crate) struct AccumulationFrame {
        /// Generation counter: differs after each change that the CPU saw; never 0.
        generation: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

bindings! {
    struct Fingerprinted = "fingerprint", COMPUTE, group 0 of [ACCUMULATION_FINGERPRINT] {
        0 words: Storage,
        1 state: ReadWrite,
    }

    struct Accumulated = "accumulation", COMPUTE, group 1 of [ACCUMULATION_ACCUMULATE] {
        0 accumulation: Uniform,
        1 state: ReadWrite,
        2 means: ReadWrite,
        3 seen: ReadWrite,
    }
}

/// Largest number of workgroups that read a buffer.
const FINGERPRINT_GROUPS: u32 = 64;
/// Number of words that a workgroup reads per iteration.
const FINGERPRINT_THREADS: u32 = 256;

/// Accumulation pass of one mask.
#[derive(Debug)]
pub(crate) struct Accumulation {
    fingerprint_layout: wgpu::BindGroupLayout,
    accumulate_layout: wgpu::BindGroupLayout,
    fingerprint: wgpu::ComputePipeline,
    accumulate: wgpu::ComputePipeline,
    remember: wgpu::ComputePipeline,
    uniform: wgpu::Buffer,
    /// Fingerprint being computed, last frame's fingerprint, last frame's generation.
    state: wgpu::Buffer,
    /// Mean of each pixel, layer after layer.
    means: Option<wgpu::Buffer>,
    /// Key of each pixel's position, and number of frames in its mean.
    seen: Option<wgpu::Buffer>,
    content: Content<FrameState>,
    generation: u32,
}

/// Frame state that the CPU compares from frame to frame.
#[derive(Debug, PartialEq)]
struct FrameState {
    light: Light,
    /// Camera; `None` if receivers are points.
    camera: Option<Camera>,
    size_px: UVec2,
    mask_layers: u32,
    casters: SeenCasters,
    settings: u64,
}

/// Identity of the casters, as far as the CPU knows them.
#[derive(Debug, PartialEq)]
enum SeenCasters {
    /// Key of a caster set, which changes with anything in it.
    Set(CastersKey),
    /// Hash of everything except the content of the casters' buffers.
    Hashed(u64),
}

/// Bind groups of one frame.
#[derive(Debug)]
pub(crate) struct PreparedAccumulation {
    /// Bind group of each of the casters' buffers, with its number of workgroups.
    fingerprints: Vec<(wgpu::BindGroup, u32)>,
    accumulate: wgpu::BindGroup,
}

impl Accumulation {
    pub(crate) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let fingerprint_layout = Fingerprinted::layout(gpu);
        let accumulate_layout = Accumulated::layout(gpu);
        let layouts = [&inputs.layout, &accumulate_layout];
        let entry =
            |name| compute_entry(gpu, name, shaders::ACCUMULATION_ACCUMULATE, Some(name), &[], layouts.as_slice());
        Self {
            fingerprint: compute_pipeline(
                gpu,
                "fingerprint",
                shaders::ACCUMULATION_FINGERPRINT,
                &[&fingerprint_layout],
            ),
            accumulate: entry("accumulate"),
            remember: entry("remember"),
            uniform: create_uniform::<AccumulationFrame>(gpu, "antumbra accumulation"),
            state: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra accumulation state"),
                size: 12,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            fingerprint_layout,
            accumulate_layout,
            means: None,
            seen: None,
            content: Content::default(),
            generation: 0,
        }
    }

    /// Compares a frame with the previous one; must be called first, once per frame. `settings` is a hash of whatever else must not
    /// change, `set` the key of the caster set. Returns the number of frames since the CPU last saw a change, from 0.
    pub(crate) fn begin(&mut self, frame: &PreparedFrame<'_>, set: Option<CastersKey>, settings: u64) -> u32 {
        let receivers = &frame.receivers;
        let now = FrameState {
            light: frame.light.for_shadows(),
            camera: receivers.camera().copied(),
            size_px: receivers.size_px,
            mask_layers: frame.mask.channels().count(),
            casters: set.map_or_else(|| SeenCasters::Hashed(hash_of_casters(&frame.casters)), SeenCasters::Set),
            settings,
        };
        if !self.content.ask(Some(now)) {
            self.generation = self.generation.wrapping_add(1).max(1);
        }
        self.content.repeats()
    }

    /// Prepares the frame that [`Self::begin`] saw.
    ///
    /// # Errors
    /// If the means of all pixels exceed the limit of a buffer binding.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        technique: &'static str,
        frame: &PreparedFrame<'_>,
    ) -> Result<PreparedAccumulation, Error> {
        let pixels = u64::from(frame.receivers.size_px.x) * u64::from(frame.receivers.size_px.y);
        let layers = u64::from(frame.mask.channels().count());
        let limit = stage.device.limits().max_storage_buffer_binding_size;
        let needed = pixels * 4 * layers.max(2);
        if needed > limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("{needed} bytes to accumulate {pixels} pixels"),
                had: format!("at most {limit} bytes per binding"),
                remedy: "set `accumulate` to false, or render the mask in several parts",
            });
        }
        write_uniform(
            stage,
            &self.uniform,
            &AccumulationFrame { generation: self.generation, ..AccumulationFrame::default() },
        );
        let storage = wgpu::BufferUsages::STORAGE;
        let means = sized_buffer(stage, &mut self.means, "antumbra means", pixels * 4 * layers, storage);
        let seen = sized_buffer(stage, &mut self.seen, "antumbra means' frames", pixels * 8, storage);
        let accumulate = Accumulated { accumulation: &self.uniform, state: &self.state, means, seen };
        let accumulate = accumulate.group(stage, &self.accumulate_layout);
        // The version of a caster set covers the content of its buffers.
        let unknown = if stage.casters().is_some() { Vec::new() } else { buffers_of(&frame.casters) };
        let fingerprints = unknown
            .into_iter()
            .map(|buffer| {
                let group = Fingerprinted { words: buffer, state: &self.state }.group(stage, &self.fingerprint_layout);
                let groups = (buffer.size() / 4).div_ceil(u64::from(FINGERPRINT_THREADS));
                (group, groups.clamp(1, u64::from(FINGERPRINT_GROUPS)) as u32)
            })
            .collect();
        Ok(PreparedAccumulation { fingerprints, accumulate })
    }

    /// Replaces the mask, which the technique's passes have written, by the mean.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, inputs: &PreparedInputs, prepared: &PreparedAccumulation) {
        recorder.compute("accumulate", Span::Only, |pass| {
            pass.set_pipeline(&self.fingerprint);
            for (group, workgroups) in &prepared.fingerprints {
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(*workgroups, 1, 1);
            }
            pass.set_pipeline(&self.accumulate);
            inputs.bind(pass);
            pass.set_bind_group(1, &prepared.accumulate, &[]);
            inputs.dispatch(pass);
            pass.set_pipeline(&self.remember);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }

    /// Size of the means and state, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.state.size() + [&self.means, &self.seen].into_iter().flatten().map(wgpu::Buffer::size).sum::<u64>()
    }
}

/// Returns the buffers whose content defines the casters' geometry, each once.
fn buffers_of<'a>(casters: &PreparedCasters<'a>) -> Vec<&'a wgpu::Buffer> {
    let PreparedCasters::Draws(meshes) = casters else { return Vec::new() };
    let mut buffers: Vec<_> = meshes.iter().flat_map(|mesh| [mesh.positions, mesh.indices, mesh.instances]).collect();
    buffers.sort_unstable();
    buffers.dedup();
    buffers
}

/// Returns a hash of everything about the casters except the content of their buffers.
fn hash_of_casters(casters: &PreparedCasters<'_>) -> u64 {
    let mut hasher = DefaultHasher::new();
    match casters {
        PreparedCasters::Draws(meshes) => meshes.iter().for_each(|mesh| hash_mesh(mesh, &mut hasher)),
        PreparedCasters::HostDepthMap(map) => {
            map.view.hash(&mut hasher);
            map.size_px.hash(&mut hasher);
            map.clip_from_world.to_cols_array().map(f32::to_bits).hash(&mut hasher);
        }
    }
    hasher.finish()
}

fn hash_mesh(mesh: &MeshCaster<'_>, hasher: &mut impl Hasher) {
    let texture = |texture: &SurfaceTexture<'_>, hasher: &mut DefaultHasher| {
        texture.uvs.hash(hasher);
        texture.view.hash(hasher);
        texture.sampler.hash(hasher);
    };
    (mesh.positions, mesh.indices, mesh.instances).hash(hasher);
    (mesh.first_triangle, mesh.index_count, mesh.first_instance, mesh.instance_count, mesh.closed).hash(hasher);
    [mesh.bounds.min, mesh.bounds.max].map(|corner| corner.to_array().map(f32::to_bits)).hash(hasher);
    let mut surface = DefaultHasher::new();
    match &mesh.opacity {
        Opacity::Opaque => {}
        Opacity::Masked { texture: alpha, alpha_factor, cutoff } => {
            texture(alpha, &mut surface);
            [alpha_factor, cutoff].map(|v| v.to_bits()).hash(&mut surface);
        }
        Opacity::Translucent { coverage, transmitted, texture: picture } => {
            picture.iter().for_each(|picture| texture(picture, &mut surface));
            transmitted.to_array().map(f32::to_bits).hash(&mut surface);
            let numbers = match coverage {
                SurfaceCoverage::Whole => [0.0; 2],
                SurfaceCoverage::Alpha(alpha) => [*alpha, 0.0],
                SurfaceCoverage::Cutoff { alpha_factor, cutoff } => [*alpha_factor, *cutoff],
            };
            (std::mem::discriminant(coverage), numbers.map(f32::to_bits)).hash(&mut surface);
        }
    }
    (std::mem::discriminant(&mesh.opacity), surface.finish()).hash(hasher);
}
