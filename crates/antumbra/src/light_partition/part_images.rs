//! Images of one part's receivers and mask. A pass picks the receivers, the technique runs on them, and a pass joins its mask to
//! the light's. One set of images serves all parts and all lights: it is filled and read before the next part.

use std::num::NonZeroU64;
use std::sync::Arc;

use glam::UVec2;

use super::Part;
use super::region::RegionGpu;
use crate::contract::{Mask, MaskChannels, PreparedFrame, PreparedReceivers, Surfaces};
use crate::gpu::{
    Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, gpu_structs, passed_texture, texels,
};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::receivers::{DEPTH_FORMAT, NORMAL_FORMAT};
use crate::shaders;

bindings! {
    struct Picked = "receivers of a part", COMPUTE, group 1 of [LIGHT_PARTITION_PICK] {
        0 region: StoragePart,
        1 part_depth: WrittenTexture(DEPTH_FORMAT),
        2 part_normals: WrittenTexture(NORMAL_FORMAT),
    }

    struct Joined = "mask of a part", COMPUTE, group 1 of [LIGHT_PARTITION_JOIN] {
        0 region: StoragePart,
        1 part_mask: TextureArray(texels::FLOAT),
        2 joining: StoragePart,
    }
}

gpu_structs! {
    /// Parameters for joining a part's mask to the light's.
    pub(crate) struct JoiningGpu {
        is_first: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

/// Stride of bindings in a buffer, bytes: WebGPU's default alignment of offsets.
const SLOT_BYTES: usize = 256;

/// Passes that pick the receivers of parts and join their masks.
#[derive(Debug)]
pub(crate) struct PartImages {
    inputs: FrameInputs,
    layouts: [wgpu::BindGroupLayout; 2],
    pick: wgpu::ComputePipeline,
    join: wgpu::ComputePipeline,
    /// Texture of one texel in place of normals, if the host has them.
    no_normals: wgpu::TextureView,
    /// Texture of one texel in place of depth, for points.
    no_depth: wgpu::TextureView,
    /// Image of the last frame.
    image: Option<PartImage>,
}

/// Receivers, mask and passes of the parts of one frame.
#[derive(Debug)]
pub(crate) struct PreparedPartImages {
    inputs: PreparedInputs,
    image: PartImage,
    /// Bind groups by part: of `pick` and, if parts have a mask of their own, of `join`.
    groups: Vec<(wgpu::BindGroup, Option<wgpu::BindGroup>)>,
    pick: wgpu::ComputePipeline,
    join: wgpu::ComputePipeline,
}

/// Receivers and mask of a part.
#[derive(Clone, Debug)]
struct PartImage {
    /// Depth; `None` for points, since normals mark their background.
    depth: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
    /// Normals; `None` if the host's are used.
    normals: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
    /// Mask; `None` if parts write noisy visibility.
    mask: Option<Mask>,
    /// Texture of the mask.
    scratch: Option<Arc<wgpu::Texture>>,
}

impl PartImages {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let inputs = FrameInputs::new(gpu);
        let layouts = [Picked::layout(gpu), Joined::layout(gpu)];
        let one_texel = |format| {
            let texture = gpu.device.create_texture(&receivers_of(format, UVec2::ONE));
            gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default())
        };
        Self {
            pick: compute_pipeline(
                gpu,
                "receivers of a part",
                shaders::LIGHT_PARTITION_PICK,
                &[&inputs.layout, &layouts[0]],
            ),
            join: compute_pipeline(
                gpu,
                "mask of a part",
                shaders::LIGHT_PARTITION_JOIN,
                &[&inputs.layout, &layouts[1]],
            ),
            no_normals: one_texel(NORMAL_FORMAT),
            no_depth: one_texel(DEPTH_FORMAT),
            inputs,
            layouts,
            image: None,
        }
    }

    /// Prepares the parts of a frame. The frame's mask must have 32 bits per channel, or its visibility must be noisy.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        parts: &[Part],
    ) -> PreparedPartImages {
        let inputs = self.inputs.prepare(stage, frame);
        let image = PartImage::prepare(stage, frame, self.image.as_ref());
        let places = places_of_parts(stage, parts);
        let place = |slot: usize, size: usize| wgpu::BufferBinding {
            buffer: &places,
            offset: (slot * SLOT_BYTES) as u64,
            size: NonZeroU64::new(size as u64),
        };
        let mut groups = Vec::with_capacity(parts.len());
        for i in 0..parts.len() {
            let (region, joining) = (place(2 * i, size_of::<RegionGpu>()), place(2 * i + 1, size_of::<JoiningGpu>()));
            let normals = image.normals.as_ref().map_or(&self.no_normals, |(_, view)| view);
            let depth = image.depth.as_ref().map_or(&self.no_depth, |(_, view)| view);
            let picked = Picked { region: region.clone(), part_depth: depth, part_normals: normals };
            let joined = image
                .mask
                .as_ref()
                .map(|mask| Joined { region, part_mask: mask.layers_view(), joining }.group(stage, &self.layouts[1]));
            groups.push((picked.group(stage, &self.layouts[0]), joined));
        }
        self.image = Some(image.clone());
        PreparedPartImages { inputs, image, groups, pick: self.pick.clone(), join: self.join.clone() }
    }
}

impl PreparedPartImages {
    /// Returns a part's frame: the part's light, receivers and mask, and the frame's casters.
    pub(crate) fn frame_of<'a>(&'a self, frame: &PreparedFrame<'a>, part: &'a Part) -> PreparedFrame<'a> {
        let image = &self.image;
        let surfaces = match (&image.depth, frame.receivers.surfaces) {
            (Some((_, depth)), Surfaces::Depth { camera, .. }) => Surfaces::Depth { depth, camera },
            (_, surfaces) => surfaces,
        };
        let receivers = PreparedReceivers {
            surfaces,
            normals: image.normals.as_ref().map(|(_, view)| view).or(frame.receivers.normals),
            bounds: Some(antumbra_light::Aabb::of(part.hull.iter().copied())),
            hull: &part.hull,
            seen: &part.seen,
            ..frame.receivers
        };
        // Noisy visibility needs no joining: parts write their own pixels of one texture.
        let mask = image.mask.as_ref().unwrap_or(frame.mask);
        PreparedFrame { light: &part.light, receivers, mask, ..*frame }
    }

    /// Records the pass that picks the receivers of part `i`.
    pub(crate) fn pick(&self, recorder: &mut Recorder<'_>, i: usize) {
        self.record(recorder, "receivers of a part", &self.pick, &self.groups[i].0);
    }

    /// Records the pass that joins the mask of part `i`, if it has its own, to the frame's.
    pub(crate) fn join(&self, recorder: &mut Recorder<'_>, i: usize) {
        if let Some(group) = &self.groups[i].1 {
            self.record(recorder, "mask of a part", &self.join, group);
        }
    }

    fn record(
        &self,
        recorder: &mut Recorder<'_>,
        label: &'static str,
        pipeline: &wgpu::ComputePipeline,
        group: &wgpu::BindGroup,
    ) {
        recorder.compute(label, Span::Only, |pass| {
            pass.set_pipeline(pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, group, &[]);
            self.inputs.dispatch(pass);
        });
    }
}

impl PartImage {
    /// Creates the image, and reuses the mask of an earlier one if its texture is the same.
    fn prepare(stage: &Stage<'_>, frame: &PreparedFrame<'_>, earlier: Option<&Self>) -> Self {
        let receivers = &frame.receivers;
        let are_seen = receivers.camera().is_some();
        // The host's normals are read in place, so depth has the same texel positions.
        let size_px = receivers.origin_px + receivers.size_px;
        let texture = |scratch, format| {
            let texture = stage.device.scratch_texture(scratch, &receivers_of(format, size_px));
            let view = stage.create_view(&texture, &wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        let channels = frame.mask.channels();
        let scratch = frame.noisy.is_none().then(|| part_mask(stage, frame.mask.size_px(), channels));
        let made = earlier.filter(|earlier| earlier.scratch == scratch).and_then(|earlier| earlier.mask.clone());
        let mask = made.or_else(|| scratch.as_ref().map(|texture| Mask::of_own_layers(texture, 0, channels)));
        Self {
            depth: are_seen.then(|| texture(Scratch::PartDepth, DEPTH_FORMAT)),
            normals: (!are_seen || receivers.normals.is_none()).then(|| texture(Scratch::PartNormals, NORMAL_FORMAT)),
            mask,
            scratch,
        }
    }
}

/// Uploads the regions and joining parameters of all parts into one buffer, in slots. It has room for the usual number of parts,
/// which come and go. It is no uniform buffer, since drivers may specialise shaders for uniform values.
fn places_of_parts(stage: &Stage<'_>, parts: &[Part]) -> wgpu::Buffer {
    const ROOM: usize = 8;
    let mut bytes = vec![0u8; 2 * SLOT_BYTES * parts.len().next_multiple_of(ROOM)];
    for (i, (part, slots)) in parts.iter().zip(bytes.chunks_exact_mut(2 * SLOT_BYTES)).enumerate() {
        let joining = JoiningGpu { is_first: u32::from(i == 0), padding_0: 0, padding_1: 0, padding_2: 0 };
        slots[..size_of::<RegionGpu>()].copy_from_slice(bytemuck::bytes_of(&part.region.to_gpu()));
        slots[SLOT_BYTES..SLOT_BYTES + size_of::<JoiningGpu>()].copy_from_slice(bytemuck::bytes_of(&joining));
    }
    stage.storage("antumbra places of parts", &bytes)
}

fn receivers_of(format: wgpu::TextureFormat, size_px: UVec2) -> wgpu::TextureDescriptor<'static> {
    passed_texture("antumbra receivers of a part", format, size_px, 1)
}

fn part_mask(stage: &Stage<'_>, size_px: UVec2, channels: MaskChannels) -> Arc<wgpu::Texture> {
    let descriptor = wgpu::TextureDescriptor {
        usage: Mask::usages(Mask::FORMAT),
        ..passed_texture("antumbra mask of a part", Mask::FORMAT, size_px, channels.count())
    };
    stage.device.scratch_texture(Scratch::PartMask, &descriptor)
}
