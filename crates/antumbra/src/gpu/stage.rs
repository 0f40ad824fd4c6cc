//! Frame preparation: uploads that wait for the frame's commands, and resources cached from earlier frames.
//!
//! `prepare` describes each frame completely, with every bind group, as if there had been no frame before. The stage returns
//! what an earlier frame of the same light created for an equal description. So nothing is created twice, and no code tracks
//! what may have changed.
//!
//! Uploads do not go through the queue, which would run them before the host's next submission, even if that is another frame
//! of the same light. They are collected in a staging buffer, and the frame's commands begin by copying them to their
//! targets. So frames can be prepared and recorded one after the other and submitted together.

mod bind_groups;
mod uploads;

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Deref;

use glam::Vec3;
use hashbrown::{DefaultHashBuilder, HashTable};

use super::Gpu;
use crate::contract::CastersKey;
pub(crate) use bind_groups::Resource;
use bind_groups::{CachedGroup, CachedView};
pub(crate) use uploads::StagedUploads;
use uploads::{Copy, Staging, Uploads};

/// Context in which a technique prepares: the device, and the state retained between frames.
#[derive(Debug)]
pub struct Stage<'a> {
    gpu: &'a Gpu,
    keep: RefCell<RetainedState>,
    /// Key of the frame's casters; `None` if their changes are unknown.
    casters: Option<CastersKey>,
    /// Origin of the frame's positions, world space.
    anchor: Vec3,
    /// Index of the frame's random numbers.
    noise_frame: u32,
    stable_box: Option<[Vec3; 8]>,
    auto_texels_before: Option<u32>,
    /// Number of maps of one light that share its memory.
    sharers: u32,
    /// Whether uploads go to the queue at once, for tests that record no frame of a light.
    #[cfg(test)]
    is_at_once: bool,
}

impl Deref for Stage<'_> {
    type Target = Gpu;

    fn deref(&self) -> &Gpu {
        self.gpu
    }
}

/// State of a light that is retained between frames.
#[derive(Debug, Default)]
pub(crate) struct RetainedState {
    /// Number of frames prepared.
    frame: u64,
    hashes: DefaultHashBuilder,
    groups: HashTable<CachedGroup>,
    views: HashTable<CachedView>,
    /// Buffers by label and usage, in the order in which a frame requests them.
    buffers: HashMap<(&'static str, wgpu::BufferUsages), BufferRow>,
    uploads: Uploads,
    staging: Vec<Staging>,
    /// Texels along a side of the map whose size is chosen per frame; `None` if there is none.
    auto_texels: Option<u32>,
}

/// Retained value, and the last frame that used it.
#[derive(Debug)]
struct Used<T> {
    value: T,
    frame: u64,
}

/// Buffers with the same label and usage.
#[derive(Debug, Default)]
struct BufferRow {
    buffers: Vec<Used<wgpu::Buffer>>,
    next: usize,
    frame: u64,
}

/// Frames after which unused resources are dropped: hosts may alternate between as many depth buffers and masks.
const RETAINED_FRAMES: u64 = 8;

/// Usage of buffers from [`Stage::uniform`].
const UNIFORM: wgpu::BufferUsages = wgpu::BufferUsages::UNIFORM.union(wgpu::BufferUsages::COPY_DST);

/// Usage of buffers from [`Stage::storage`].
const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_DST);

impl<'a> Stage<'a> {
    /// Creates a stage for the next frame.
    pub(crate) fn new(gpu: &'a Gpu, mut keep: RetainedState, casters: Option<CastersKey>) -> Self {
        keep.frame += 1;
        let auto_texels_before = keep.auto_texels.take();
        keep.uploads.bytes.clear();
        keep.uploads.copies.clear();
        Self {
            gpu,
            keep: RefCell::new(keep),
            casters,
            anchor: Vec3::ZERO,
            noise_frame: 0,
            stable_box: None,
            auto_texels_before,
            sharers: 1,
            #[cfg(test)]
            is_at_once: false,
        }
    }

    /// Creates a stage for one part of the frame with a state of its own; [`finish_part`](Self::finish_part) ends it. Maps
    /// are fitted to the box with the given corners, if any, so that their texels do not move.
    pub(crate) fn of_part(&self, keep: RetainedState, stable_box: Option<[Vec3; 8]>) -> Self {
        Self {
            anchor: self.anchor,
            noise_frame: self.noise_frame,
            stable_box,
            #[cfg(test)]
            is_at_once: self.is_at_once,
            ..Self::new(self.gpu, keep, self.casters)
        }
    }

    /// Creates a stage for one frame whose uploads are queued at once.
    #[cfg(test)]
    pub(crate) fn at_once(gpu: &'a Gpu) -> Self {
        Self { is_at_once: true, ..Self::new(gpu, RetainedState::default(), None) }
    }

    /// Sets the anchor: the origin of all positions of the frame except those of caster vertices and instances.
    pub(crate) fn anchored(self, anchor: Vec3) -> Self {
        Self { anchor, ..self }
    }

    /// Sets the index of the frame's random numbers; 0 in every frame without denoising.
    pub(crate) fn of_noise_frame(self, noise_frame: u32) -> Self {
        Self { noise_frame, ..self }
    }

    /// Corners of a box around the receivers that mostly stays fixed while the camera moves; `None` if maps are fitted to the
    /// receivers themselves.
    pub(crate) fn stable_box(&self) -> Option<[Vec3; 8]> {
        self.stable_box
    }

    /// Texels along a side of the last frame's map, if its size is chosen per frame.
    pub(crate) fn auto_texels(&self) -> Option<u32> {
        self.auto_texels_before
    }

    /// Stores the size chosen for this frame; the next frame finds `None` unless this is called.
    pub(crate) fn note_auto_texels(&self, texels: u32) {
        self.keep.borrow_mut().auto_texels = Some(texels);
    }

    /// Sets the number of maps of a light that share its memory.
    pub(crate) fn sharing(self, maps: usize) -> Self {
        Self { sharers: maps.max(1) as u32, ..self }
    }

    /// Memory limit of a map whose size is chosen per frame, bytes: a quarter of the budget, split among the light's maps.
    pub(crate) fn auto_map_bytes(&self) -> u64 {
        /// Number of lights that can own maps even at the limit.
        const LIGHTS: u64 = 4;
        self.gpu.device.budget().bytes() / LIGHTS / u64::from(self.sharers)
    }

    /// Index of the frame's random numbers.
    pub(crate) fn noise_frame(&self) -> u32 {
        self.noise_frame
    }

    /// Anchor, world space: subtracted from instance positions by passes that read them.
    pub(crate) fn anchor(&self) -> Vec3 {
        self.anchor
    }

    /// Key of the frame's casters and their version, relative to the anchor; `None` if changes are unknown.
    pub(crate) fn casters(&self) -> Option<CastersKey> {
        self.casters.map(|casters| casters.relative_to(self.anchor))
    }

    /// Ends the frame. Returns the retained state and the uploads.
    pub(crate) fn finish(self) -> (RetainedState, StagedUploads) {
        let gpu = self.gpu;
        let mut keep = self.into_retained();
        let staged = keep.stage_uploads(gpu);
        (keep, staged)
    }

    /// Ends a part of a frame. Returns its retained state; its uploads, to buffers of its own, join the frame's.
    pub(crate) fn finish_part(self, of_frame: &Stage<'_>) -> RetainedState {
        let mut keep = self.into_retained();
        of_frame.keep.borrow_mut().uploads.append(&mut keep.uploads);
        keep
    }

    /// Returns the state retained for the next frame, without long-unused resources.
    fn into_retained(self) -> RetainedState {
        let mut keep = self.keep.into_inner();
        let oldest = keep.frame.saturating_sub(RETAINED_FRAMES);
        keep.groups.retain(|kept| kept.group.frame >= oldest);
        keep.views.retain(|kept| kept.view.frame >= oldest);
        for row in keep.buffers.values_mut() {
            row.buffers.retain(|buffer| buffer.frame >= oldest);
        }
        keep
    }

    /// Returns a uniform buffer that holds `value`, reused from the last frame by label and order of requests.
    pub(crate) fn uniform<T: bytemuck::NoUninit>(&self, label: &'static str, value: &T) -> wgpu::Buffer {
        self.uniform_array(label, std::slice::from_ref(value))
    }

    /// Returns a uniform buffer that holds an array, reused in the same way.
    pub(crate) fn uniform_array<T: bytemuck::NoUninit>(&self, label: &'static str, values: &[T]) -> wgpu::Buffer {
        let bytes = bytemuck::cast_slice::<T, u8>(values);
        let buffer = self.frame_buffer(label, UNIFORM, bytes.len() as u64);
        self.upload(&buffer, 0, bytes);
        buffer
    }

    /// Returns a storage buffer that holds `data`. It must not be empty, because WebGPU has no empty bindings.
    pub(crate) fn storage<T: bytemuck::NoUninit>(&self, label: &'static str, data: &[T]) -> wgpu::Buffer {
        let bytes = bytemuck::cast_slice::<T, u8>(data);
        let buffer = self.frame_buffer(label, STORAGE, bytes.len() as u64);
        self.upload(&buffer, 0, bytes);
        buffer
    }

    /// Returns the frame's next buffer of this label and usage, of exactly `bytes` bytes.
    pub(crate) fn frame_buffer(&self, label: &'static str, usage: wgpu::BufferUsages, bytes: u64) -> wgpu::Buffer {
        let mut keep = self.keep.borrow_mut();
        let frame = keep.frame;
        let row = keep.buffers.entry((label, usage)).or_default();
        if row.frame != frame {
            (row.frame, row.next) = (frame, 0);
        }
        let make = || Used {
            value: self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage,
                mapped_at_creation: false,
            }),
            frame,
        };
        let place = row.next;
        row.next += 1;
        if place == row.buffers.len() {
            row.buffers.push(make());
        } else if row.buffers[place].value.size() != bytes {
            row.buffers[place] = make();
        }
        row.buffers[place].frame = frame;
        row.buffers[place].value.clone()
    }

    /// Uploads `bytes` to a buffer with usage `COPY_DST` before the frame's passes; their number is a multiple of four.
    pub(crate) fn upload(&self, to: &wgpu::Buffer, to_offset: u64, bytes: &[u8]) {
        if bytes.is_empty() {
            return;
        }
        #[cfg(test)]
        if self.is_at_once {
            self.gpu.queue.write_buffer(to, to_offset, bytes);
            return;
        }
        let Uploads { bytes: all, copies } = &mut self.keep.borrow_mut().uploads;
        let from = all.len() as u64;
        all.extend_from_slice(bytes);
        copies.push(Copy { to: to.clone(), to_offset, from, bytes: bytes.len() as u64 });
    }
}

impl RetainedState {
    /// Memory of the frame's own buffers and of staging buffers, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let of_frame = self.buffers.values().flat_map(|row| &row.buffers).map(|buffer| buffer.value.size());
        of_frame.chain(self.staging.iter().map(|staging| staging.buffer.size())).sum()
    }

    /// Texels along a side of the last prepared frame's map, if its size is chosen per frame.
    pub(crate) fn auto_texels(&self) -> Option<u32> {
        self.auto_texels
    }
}
