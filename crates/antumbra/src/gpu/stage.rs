//! Frame preparation: uploads that wait for the frame's commands, and resources cached from earlier frames.
//!
//! `prepare` describes its frame in full, every bind group of it, as if nothing had been there before; the stage gives
//! back what an earlier frame of the same light made of the same parts. So nothing that is described twice is made twice,
//! and nobody keeps lists of what may have changed.
//!
//! Uploads do not go to the queue, which would run them before whatever the host submits next, another frame of the
//! same light included. They are put into a staging buffer of their own, and the frame's commands begin by copying them
//! to where they belong. Frames may so be prepared and recorded one after the other and submitted together.

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
use bind_groups::{KeptGroup, KeptView};
pub(crate) use uploads::StagedUploads;
use uploads::{Copy, Staging, Uploads};

/// What a technique prepares with: the device, and what is kept from frame to frame.
#[derive(Debug)]
pub struct Stage<'a> {
    gpu: &'a Gpu,
    keep: RefCell<Keep>,
    /// The frame's casters, where they can be told from others.
    casters: Option<CastersKey>,
    /// Where the frame counts places from.
    anchor: Vec3,
    /// Index of frames whose random numbers differ.
    noise_frame: u32,
    stable_box: Option<[Vec3; 8]>,
    auto_texels_before: Option<u32>,
    /// Maps of one light that share what may be spent on them.
    sharers: u32,
    /// Uploads go to the queue, for tests that record no frame of a light.
    #[cfg(test)]
    is_at_once: bool,
}

impl Deref for Stage<'_> {
    type Target = Gpu;

    fn deref(&self) -> &Gpu {
        self.gpu
    }
}

/// What is kept of a light from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Keep {
    /// Counts the frames prepared.
    frame: u64,
    hashes: DefaultHashBuilder,
    groups: HashTable<KeptGroup>,
    views: HashTable<KeptView>,
    /// By label and usage, in the order in which a frame asks for them.
    buffers: HashMap<(&'static str, wgpu::BufferUsages), BufferRow>,
    uploads: Uploads,
    staging: Vec<Staging>,
    /// Texels along a side of the map whose size is chosen for each frame.
    auto_texels: Option<u32>,
}

/// Something kept, and the last frame that used it.
#[derive(Debug)]
struct Used<T> {
    value: T,
    frame: u64,
}

/// Buffers of one label.
#[derive(Debug, Default)]
struct BufferRow {
    buffers: Vec<Used<wgpu::Buffer>>,
    next: usize,
    frame: u64,
}

/// What no frame has used for so long is dropped: hosts may take turns with as many depth buffers and masks.
const KEPT_FRAMES: u64 = 8;

/// What [`Stage::uniform`] makes.
const UNIFORM: wgpu::BufferUsages = wgpu::BufferUsages::UNIFORM.union(wgpu::BufferUsages::COPY_DST);

/// What [`Stage::storage`] makes.
const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_DST);

impl<'a> Stage<'a> {
    /// A stage for the next frame.
    pub(crate) fn new(gpu: &'a Gpu, mut keep: Keep, casters: Option<CastersKey>) -> Self {
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

    /// A stage for a part of the frame, which has a state of its own; its maps are fitted to a box, where one is given, whose
    /// corners these are, so that their texels stay where they are. [`finish_part`](Self::finish_part) ends it.
    pub(crate) fn of_part(&self, keep: Keep, stable_box: Option<[Vec3; 8]>) -> Self {
        Self {
            anchor: self.anchor,
            noise_frame: self.noise_frame,
            stable_box,
            #[cfg(test)]
            is_at_once: self.is_at_once,
            ..Self::new(self.gpu, keep, self.casters)
        }
    }

    /// A stage for one frame whose uploads are queued at once.
    #[cfg(test)]
    pub(crate) fn at_once(gpu: &'a Gpu) -> Self {
        Self { is_at_once: true, ..Self::new(gpu, Keep::default(), None) }
    }

    /// The same for a frame whose places, but for those of casters' vertices and instances, are counted from an anchor.
    pub(crate) fn anchored(self, anchor: Vec3) -> Self {
        Self { anchor, ..self }
    }

    /// The same for a frame whose random numbers are those of this index; 0 is every frame's that is not denoised.
    pub(crate) fn of_noise_frame(self, noise_frame: u32) -> Self {
        Self { noise_frame, ..self }
    }

    /// The corners of a box about what receives that mostly stays where it is while the camera moves; `None` where maps
    /// are fitted to what receives itself.
    pub(crate) fn stable_box(&self) -> Option<[Vec3; 8]> {
        self.stable_box
    }

    /// Texels along a side that the map had in the frame before, where its size is chosen for each frame.
    pub(crate) fn auto_texels(&self) -> Option<u32> {
        self.auto_texels_before
    }

    /// Notes what was chosen for this frame; where nothing is noted the next one knows of none.
    pub(crate) fn note_auto_texels(&self, texels: u32) {
        self.keep.borrow_mut().auto_texels = Some(texels);
    }

    /// The same for one of so many maps of a light.
    pub(crate) fn sharing(self, maps: usize) -> Self {
        Self { sharers: maps.max(1) as u32, ..self }
    }

    /// Bytes that a map may take whose size is chosen for each frame: of what the lights have, a quarter for one light.
    pub(crate) fn auto_map_bytes(&self) -> u64 {
        /// So many lights have maps of their own however large their maps would be.
        const LIGHTS: u64 = 4;
        self.gpu.device.budget().bytes() / LIGHTS / u64::from(self.sharers)
    }

    /// Random number index of a frame.
    pub(crate) fn noise_frame(&self) -> u32 {
        self.noise_frame
    }

    /// What passes that read casters' instances take off their places.
    pub(crate) fn anchor(&self) -> Vec3 {
        self.anchor
    }

    /// What tells the frame's casters from others, and from what they were; `None` where nothing does.
    pub(crate) fn casters(&self) -> Option<CastersKey> {
        self.casters.map(|casters| casters.counted_from(self.anchor))
    }

    /// Ends the frame: what is kept, and the uploads.
    pub(crate) fn finish(self) -> (Keep, StagedUploads) {
        let gpu = self.gpu;
        let mut keep = self.into_keep();
        let staged = keep.stage_uploads(gpu);
        (keep, staged)
    }

    /// Ends a part of a frame: what is kept. Its uploads go with the frame's: each part has buffers of its own.
    pub(crate) fn finish_part(self, of_frame: &Stage<'_>) -> Keep {
        let mut keep = self.into_keep();
        of_frame.keep.borrow_mut().uploads.append(&mut keep.uploads);
        keep
    }

    /// What is kept for the next frame.
    fn into_keep(self) -> Keep {
        let mut keep = self.keep.into_inner();
        let oldest = keep.frame.saturating_sub(KEPT_FRAMES);
        keep.groups.retain(|kept| kept.group.frame >= oldest);
        keep.views.retain(|kept| kept.view.frame >= oldest);
        for row in keep.buffers.values_mut() {
            row.buffers.retain(|buffer| buffer.frame >= oldest);
        }
        keep
    }

    /// A uniform buffer of the frame's own that holds `value`: the frame before had it for the same, by label and order.
    pub(crate) fn uniform<T: bytemuck::NoUninit>(&self, label: &'static str, value: &T) -> wgpu::Buffer {
        self.uniform_array(label, std::slice::from_ref(value))
    }

    /// The same of an array.
    pub(crate) fn uniform_array<T: bytemuck::NoUninit>(&self, label: &'static str, values: &[T]) -> wgpu::Buffer {
        let bytes = bytemuck::cast_slice::<T, u8>(values);
        let buffer = self.frame_buffer(label, UNIFORM, bytes.len() as u64);
        self.upload(&buffer, 0, bytes);
        buffer
    }

    /// A storage buffer of the frame's own that holds `data`, which is not empty: WebGPU has no empty bindings.
    pub(crate) fn storage<T: bytemuck::NoUninit>(&self, label: &'static str, data: &[T]) -> wgpu::Buffer {
        let bytes = bytemuck::cast_slice::<T, u8>(data);
        let buffer = self.frame_buffer(label, STORAGE, bytes.len() as u64);
        self.upload(&buffer, 0, bytes);
        buffer
    }

    /// The next of the frame's buffers of this label and usage, of exactly so many bytes.
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

    /// Puts `bytes`, a multiple of four of them, into a buffer with usage `COPY_DST` before the frame's passes.
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

impl Keep {
    /// Bytes of the frame's own buffers and of those that uploads pass through.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let of_frame = self.buffers.values().flat_map(|row| &row.buffers).map(|buffer| buffer.value.size());
        of_frame.chain(self.staging.iter().map(|staging| staging.buffer.size())).sum()
    }

    /// Texels along a side of the map of the frame prepared last, where its size was chosen for that frame.
    pub(crate) fn auto_texels(&self) -> Option<u32> {
        self.auto_texels
    }
}
