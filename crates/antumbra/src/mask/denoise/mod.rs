//! Denoising of any technique's mask, over frames and over neighbouring pixels.
//!
//! ```text
//! technique ──► noisy mask ──► over time ──► means ──► over pixels ──► the host's mask
//!                 means and depth of the frame before ──┘
//! ```
//!
//! **Over time** (`over_time.wesl`): each point is reprojected into the previous frame (Nehab et al. 2007, "Accelerating
//! real-time shading with reverse reprojection caching"; Scherzer, Jeschke, Wimmer 2007, "Pixel-correct shadow maps with
//! temporal reprojection and shadow test confidence"). Its history is dropped if that frame saw another surface; otherwise
//! the newest value is added to its mean. The earlier mean is clamped to the range of the pixel's neighbours in the new
//! frame (as in temporal antialiasing: Salvi 2016, "An excursion in temporal supersampling"). It counts for as many frames
//! as it can be right for: where light or casters move, the history shortens accordingly.
//!
//! **Over pixels** (`over_pixels.wesl`): a plane is fitted to the means on the same surface. The Gaussian weights are no wider
//! than an eighth of the penumbra, which is known from the slope of visibility itself, and become narrower with the number of
//! frames. The filtered mask is shown and not fed back, so that nothing is filtered twice.
//!
//! Cost per pixel and channel. Over time: reads 4 bytes of the noisy mask, 12 of the history, four times, and 4 of depth; writes 12.
//! Over pixels: reads 8 and 4 of depth, writes 4. Workgroups load the neighbourhood of their pixels once: 2.3 times as much over
//! time, 3.1 times over pixels. Neither searches the neighbourhood of a pixel that is and was fully lit or dark. Memory: 24 bytes
//! per pixel, 8 more per pixel and channel for masks of three channels.
//!
//! # Limits
//! Bias is not noise: a blocker search of few taps misses faint blockers in most frames, so that the outer penumbra stays too bright
//! (half-plane, 8 + 8 taps, 16 frames: rmse .020; 64 + 8: .006). Mirrors and glass are not receivers here. Moving surfaces without motion
//! vectors are recognised by depth alone: a point of a surface that slides along itself keeps the shadow of the place. Slow changes of a
//! faint penumbra are indistinguishable from noise for some frames, and lag by them. Under a moving camera means are interpolated from four
//! pixels each frame, which softens edges finer than a pixel.

use std::sync::Arc;

use glam::{Mat4, UVec2, Vec3};

use crate::contract::{Camera, Denoise, Mask, PreparedFrame};
use crate::gpu::{
    Bindings, Gpu, Recorder, Scratch, Span, Stage, array_view, bindings, compute_pipeline_without_zeroing,
    create_uniform, gpu_structs, texels, write_uniform,
};
use crate::receivers::DEPTH_FORMAT;
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Format of the history: mean, mean of squares, number of frames. A half float's 11 bits resolve 1/2048, an eighth of what
/// one sample in eight changes a mean of 32 frames by.
const MEANS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Period of the noise frame index. Up to this number, multiples of the golden ratio keep three digits of their fraction.
const NOISE_FRAMES: u32 = 1024;

gpu_structs! {
    /// Camera of the previous frame in this frame's coordinates, and settings.
    pub(crate) struct DenoiseFrame {
        clip_from_world_before: Mat4,
        world_from_clip_before: Mat4,
        background_depth_before: f32,
        max_frames: f32,
        has_before: u32,
        has_motion: u32,
    }
}

bindings! {
    struct OverTime = "denoise over time", COMPUTE, group 1 of [DENOISE_OVER_TIME] {
        0 denoise: Uniform,
        1 noisy: TextureArray(texels::FLOAT),
        2 means_before: TextureArray(texels::FLOAT),
        3 depth_before: Texture(texels::FLOAT),
        4 motion: Texture(texels::FLOAT),
        5 means_now: WrittenArray(MEANS_FORMAT),
        6 depth_now: WrittenTexture(DEPTH_FORMAT),
    }

    struct OverPixels = "denoise over pixels", COMPUTE, group 1 of [DENOISE_OVER_PIXELS] {
        0 means: TextureArray(texels::FLOAT),
    }
}

/// Denoiser of one light's mask, seen by one camera.
#[derive(Debug)]
pub(crate) struct Denoiser {
    inputs: FrameInputs,
    over_time_layout: wgpu::BindGroupLayout,
    over_pixels_layout: wgpu::BindGroupLayout,
    over_time: wgpu::ComputePipeline,
    over_pixels: wgpu::ComputePipeline,
    uniform: wgpu::Buffer,
    noisy: Option<NoisyMask>,
    /// History of the previous frame and of this one, in alternation.
    kept: Option<[FrameHistory; 2]>,
    before: Option<Camera>,
    /// Number of frames since the first.
    frames: u32,
    /// Number of frames since the last change.
    still_frames: u32,
}

/// Denoising passes of one frame.
#[derive(Debug)]
pub(crate) struct PreparedDenoise {
    /// Mask that the technique writes.
    pub(crate) noisy: Mask,
    inputs: PreparedInputs,
    /// Passes over time and over pixels: label, pipeline and bind group.
    passes: [(&'static str, wgpu::ComputePipeline, wgpu::BindGroup); 2],
    channels: u32,
}

/// Mask that the technique writes.
#[derive(Debug)]
struct NoisyMask {
    /// Shared texture: each light's commands fill and read it before another light's do.
    scratch: Arc<wgpu::Texture>,
    mask: Mask,
}

/// History of one frame.
#[derive(Debug)]
struct FrameHistory {
    size_px: UVec2,
    channels: u32,
    means_view: wgpu::TextureView,
    depth_view: wgpu::TextureView,
}

impl Denoiser {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let inputs = FrameInputs::new(gpu);
        let over_time_layout = OverTime::layout(gpu);
        let over_pixels_layout = OverPixels::layout(gpu);
        let pipeline = |label, shader, layout| {
            compute_pipeline_without_zeroing(gpu, label, shader, &[], &[&inputs.layout, layout])
        };
        Self {
            over_time: pipeline("denoise over time", shaders::DENOISE_OVER_TIME, &over_time_layout),
            over_pixels: pipeline("denoise over pixels", shaders::DENOISE_OVER_PIXELS, &over_pixels_layout),
            uniform: create_uniform::<DenoiseFrame>(gpu, "antumbra denoising"),
            inputs,
            over_time_layout,
            over_pixels_layout,
            noisy: None,
            kept: None,
            before: None,
            frames: 0,
            still_frames: 0,
        }
    }

    /// Returns the random number index of the next frame.
    pub(crate) fn noise_frame(&self) -> u32 {
        self.frames % NOISE_FRAMES
    }

    /// Whether the mask is as smooth as it becomes, if nothing changes.
    pub(crate) fn is_settled(&self, settings: &Denoise) -> bool {
        self.still_frames >= settings.max_frames
    }

    /// Returns the noisy mask, in the size and channels of the host's `mask`.
    fn noisy_mask(&mut self, gpu: &Gpu, mask: &Mask) -> Mask {
        let descriptor = wgpu::TextureDescriptor {
            label: Some("antumbra noisy mask"),
            size: extent(mask.size_px(), mask.channels().count()),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Mask::FORMAT,
            usage: Mask::usages(Mask::FORMAT),
            view_formats: &[],
        };
        let scratch = gpu.device.scratch_texture(Scratch::NoisyMask, &descriptor);
        let made = self.noisy.take().filter(|noisy| noisy.scratch == scratch);
        let noisy = made.unwrap_or_else(|| {
            let mask = Mask::of_own_layers(&scratch, 0, mask.channels());
            NoisyMask { scratch, mask }
        });
        self.noisy.insert(noisy).mask.clone()
    }

    /// Prepares a frame. `frame` is relative to the stage's anchor and has the output mask; `host` is the same frame in
    /// the host's world. `is_same` says whether nothing has changed since the previous frame.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        [host, frame]: [&PreparedFrame<'_>; 2],
        settings: &Denoise,
        is_same: bool,
    ) -> PreparedDenoise {
        let inputs = self.inputs.prepare(stage, frame);
        let noisy = self.noisy_mask(stage, frame.mask);
        let (size, channels) = (frame.receivers.size_px, frame.mask.channels().count());
        let kept = self.kept.take().filter(|[kept, _]| (kept.size_px, kept.channels) == (size, channels));
        if kept.is_none() {
            self.before = None;
        }
        let kept = kept
            .unwrap_or_else(|| [FrameHistory::new(stage, size, channels), FrameHistory::new(stage, size, channels)]);
        let [before, now] = if self.frames.is_multiple_of(2) { [&kept[0], &kept[1]] } else { [&kept[1], &kept[0]] };
        let max_frames = settings.max_frames as f32;
        let uniform = DenoiseFrame {
            max_frames,
            has_motion: settings.motion.is_some().into(),
            ..self.seen_before(stage.anchor())
        };
        write_uniform(stage, &self.uniform, &uniform);
        let over_time = OverTime {
            denoise: &self.uniform,
            noisy: noisy.layers_view(),
            means_before: &before.means_view,
            depth_before: &before.depth_view,
            motion: settings.motion.as_ref().unwrap_or(&before.depth_view),
            means_now: &now.means_view,
            depth_now: &now.depth_view,
        };
        let over_pixels = OverPixels { means: &now.means_view }.group(stage, &self.over_pixels_layout);
        let passes = [
            ("denoise over time", self.over_time.clone(), over_time.group(stage, &self.over_time_layout)),
            ("denoise over pixels", self.over_pixels.clone(), over_pixels),
        ];
        self.kept = Some(kept);
        self.before = host.receivers.camera().copied();
        self.frames += 1;
        self.still_frames = if is_same { self.still_frames + 1 } else { 1 };
        PreparedDenoise { noisy, inputs, passes, channels }
    }

    /// Returns the previous frame's camera, relative to `anchor`.
    fn seen_before(&self, anchor: Vec3) -> DenoiseFrame {
        let Some(before) = self.before else { return DenoiseFrame::default() };
        let from_anchor = glam::DMat4::from_translation(anchor.as_dvec3());
        let clip_from_world = before.clip_from_view.as_dmat4() * before.view_from_world.as_dmat4() * from_anchor;
        DenoiseFrame {
            clip_from_world_before: clip_from_world.as_mat4(),
            world_from_clip_before: clip_from_world.inverse().as_mat4(),
            background_depth_before: before.depth_convention.background(),
            has_before: 1,
            ..DenoiseFrame::default()
        }
    }

    /// Size of the history, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let of = |kept: &FrameHistory| u64::from(kept.size_px.element_product() * (8 * kept.channels + 4));
        self.kept.iter().flatten().map(of).sum()
    }
}

impl PreparedDenoise {
    /// Denoises what the technique has written into the host's mask.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        for (label, pipeline, group) in &self.passes {
            recorder.compute(label, Span::Only, |pass| {
                pass.set_pipeline(pipeline);
                self.inputs.bind(pass);
                pass.set_bind_group(1, group, &[]);
                self.inputs.dispatch_layers(pass, self.channels);
            });
        }
    }
}

impl FrameHistory {
    fn new(gpu: &Gpu, size_px: UVec2, channels: u32) -> Self {
        let texture = |label, format, layers| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(size_px, layers),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
                view_formats: &[],
            })
        };
        let view = |texture: &wgpu::Texture| gpu.device.create_view(texture, &wgpu::TextureViewDescriptor::default());
        let means = texture("antumbra means", MEANS_FORMAT, channels);
        let depth = texture("antumbra depth of the means", DEPTH_FORMAT, 1);
        Self { size_px, channels, means_view: array_view(gpu, &means), depth_view: view(&depth) }
    }
}

fn extent(size_px: UVec2, layers: u32) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: layers }
}
