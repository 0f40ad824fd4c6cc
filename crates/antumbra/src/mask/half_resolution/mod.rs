//! Half resolution: a technique writes a mask of half the size from receivers of half the size; an upsampling pass interpolates the rest.
//!
//! ```text
//! receivers ──► pick ──► those of half the size ──► technique ──► mask of half the size ──► upsample ──► mask
//!     └────────────────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! This works with any technique. It receives a depth buffer of half the size and its camera, and nothing else: cascades, cube faces and
//! the smoothing of `smrt` are all at half the size. A half-size pixel lies at the first pixel of a square of four, so that its surface
//! is one that the depth buffer contains (`pick.wesl`). A pixel's visibility comes from half-size pixels on its own surface alone
//! (`upsample.wesl`). One image of half the size serves all lights, one after the other.
//!
//! Memory per half-size pixel: 4 bytes of depth, 16 of normals, 4 per channel of the mask. Over the full image both passes read depth
//! and normals once; `upsample` mostly reads one to four half-size pixels.
//!
//! # Limits
//! Penumbrae narrower than two pixels are widened to that. A feature one pixel in size may be in no square; it then has the visibility
//! of nearby surfaces.

use std::sync::Arc;

use glam::{Mat4, UVec2, Vec2};

use crate::contract::{Camera, Mask, MaskChannels, PreparedFrame, PreparedReceivers, Surfaces};
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, passed_texture, texels};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::receivers::{DEPTH_FORMAT, NORMAL_FORMAT};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Width of a workgroup's tile, pixels.
const TILE: u32 = 8;

bindings! {
    struct Picked = "receivers of half the size", COMPUTE, group 1 of [HALF_RESOLUTION_PICK] {
        0 half_depth: WrittenTexture(DEPTH_FORMAT),
        1 half_normals: WrittenTexture(NORMAL_FORMAT),
    }

    struct Upsampled = "mask of half the size", COMPUTE, group 1 of [HALF_RESOLUTION_UPSAMPLE] {
        0 half_depth: Texture(texels::FLOAT),
        1 half_normals: Texture(texels::FLOAT),
        2 half_mask: TextureArray(texels::FLOAT),
    }
}

/// Passes that halve receivers and upsample masks.
#[derive(Debug)]
pub(crate) struct HalfResolution {
    inputs: FrameInputs,
    layouts: [wgpu::BindGroupLayout; 2],
    pick: wgpu::ComputePipeline,
    upsample: wgpu::ComputePipeline,
    /// Image of the last frame.
    image: Option<HalfImage>,
}

/// Passes of one frame, and the image between them.
#[derive(Debug)]
pub(crate) struct PreparedHalf {
    inputs: PreparedInputs,
    image: HalfImage,
    pick: (wgpu::ComputePipeline, wgpu::BindGroup),
    upsample: (wgpu::ComputePipeline, wgpu::BindGroup),
}

/// Receivers and mask of half the size.
#[derive(Clone, Debug)]
struct HalfImage {
    size_px: UVec2,
    depth: (Arc<wgpu::Texture>, wgpu::TextureView),
    normals: (Arc<wgpu::Texture>, wgpu::TextureView),
    scratch: Arc<wgpu::Texture>,
    mask: Mask,
}

impl HalfResolution {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let inputs = FrameInputs::new(gpu);
        let layouts = [Picked::layout(gpu), Upsampled::layout(gpu)];
        let pipeline = |label, shader, layout| compute_pipeline(gpu, label, shader, &[&inputs.layout, layout]);
        Self {
            pick: pipeline("receivers of half the size", shaders::HALF_RESOLUTION_PICK, &layouts[0]),
            upsample: pipeline("mask of half the size", shaders::HALF_RESOLUTION_UPSAMPLE, &layouts[1]),
            inputs,
            layouts,
            image: None,
        }
    }

    /// Prepares a frame whose receivers are a depth buffer, and whose mask has 32 bits.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, frame: &PreparedFrame<'_>) -> PreparedHalf {
        let inputs = self.inputs.prepare(stage, frame);
        let size_px = half_of(frame.receivers.size_px);
        let image = HalfImage::prepare(stage, size_px, frame.mask.channels(), self.image.as_ref());
        let (half_depth, half_normals) = (&image.depth.1, &image.normals.1);
        let picked = Picked { half_depth, half_normals }.group(stage, &self.layouts[0]);
        let upsampled = Upsampled { half_depth, half_normals, half_mask: image.mask.layers_view() };
        let upsampled = upsampled.group(stage, &self.layouts[1]);
        self.image = Some(image.clone());
        PreparedHalf { inputs, image, pick: (self.pick.clone(), picked), upsample: (self.upsample.clone(), upsampled) }
    }
}

impl PreparedHalf {
    /// Returns the frame as the technique receives it.
    pub(crate) fn frame_of<'a>(&'a self, frame: &PreparedFrame<'a>) -> PreparedFrame<'a> {
        let HalfImage { size_px, depth, normals, mask, .. } = &self.image;
        let surfaces = match frame.receivers.surfaces {
            Surfaces::Depth { camera, .. } => {
                let clip_from_view = half_clip(frame.receivers.size_px) * camera.clip_from_view;
                Surfaces::Depth { depth: &depth.1, camera: Camera { clip_from_view, ..camera } }
            }
            points @ Surfaces::Points { .. } => points,
        };
        let receivers = PreparedReceivers {
            size_px: *size_px,
            origin_px: UVec2::ZERO,
            surfaces,
            normals: Some(&normals.1),
            ..frame.receivers
        };
        PreparedFrame { receivers, mask, ..*frame }
    }

    /// Records the pass from the frame's receivers to those of half the size.
    pub(crate) fn record_pick(&self, recorder: &mut Recorder<'_>) {
        let (pipeline, group) = &self.pick;
        let tiles = self.image.size_px.map(|px| px.div_ceil(TILE));
        recorder.compute("receivers of half the size", Span::Only, |pass| {
            pass.set_pipeline(pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, group, &[]);
            pass.dispatch_workgroups(tiles.x, tiles.y, 1);
        });
    }

    /// Records the pass from the mask of half the size to the frame's.
    pub(crate) fn record_upsample(&self, recorder: &mut Recorder<'_>) {
        let (pipeline, group) = &self.upsample;
        recorder.compute("mask of half the size", Span::Only, |pass| {
            pass.set_pipeline(pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, group, &[]);
            self.inputs.dispatch(pass);
        });
    }
}

impl HalfImage {
    /// Prepares an image. It reuses the `earlier` image's mask if their texture is the same.
    fn prepare(stage: &Stage<'_>, size_px: UVec2, channels: MaskChannels, earlier: Option<&Self>) -> Self {
        let texture = |scratch, format| {
            let texture =
                stage.device.scratch_texture(scratch, &passed_texture("antumbra half resolution", format, size_px, 1));
            let view = stage.create_view(&texture, &wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        let of_mask = passed_texture("antumbra half resolution", Mask::FORMAT, size_px, channels.count());
        let scratch = stage.device.scratch_texture(Scratch::HalfMask, &of_mask);
        let mask = earlier
            .filter(|earlier| earlier.scratch == scratch)
            .map_or_else(|| Mask::of_own_layers(&scratch, 0, channels), |earlier| earlier.mask.clone());
        Self {
            size_px,
            depth: texture(Scratch::HalfDepth, DEPTH_FORMAT),
            normals: texture(Scratch::HalfNormals, NORMAL_FORMAT),
            scratch,
            mask,
        }
    }
}

/// Returns half of a size, rounded up.
fn half_of(size_px: UVec2) -> UVec2 {
    size_px.map(|px| px.div_ceil(2))
}

/// Returns the matrix from an image's clip space to that of a half-size image, whose pixel (i, j) is at the image's pixel (2i, 2j).
///
/// With P a position in pixels from the left, i + ½ at pixel i's centre, its position in the half image is (P + ½) / 2: the centre 2i + ½
/// becomes i + ½. With x = 2P / w − 1, and likewise for the half image's width h, x' = w / 2h · x + (w + 1) / 2h − 1. Rows run against y.
fn half_clip(size_px: UVec2) -> Mat4 {
    let (size, doubled) = (size_px.as_vec2(), 2.0 * half_of(size_px).as_vec2());
    let scale = size / doubled;
    let offset = ((size + 1.0) / doubled - 1.0) * Vec2::new(1.0, -1.0);
    Mat4::from_translation(offset.extend(0.0)) * Mat4::from_scale(scale.extend(1.0))
}
