//! Points as receivers: one pass packs a host's buffers into textures, which passes over receivers read in place of a depth buffer,
//! and another writes the resulting mask into a buffer. No technique depends on either.
//!
//! ```text
//! positions, normals, widths ──► pack ──► textures of texels ──► technique ──► mask ──► write ──► visibilities
//! ```

use std::sync::Arc;

use glam::{UVec2, Vec3};

use crate::contract::{Mask, MaskChannels, PointBuffer, PointReceivers, PointWidths, PreparedReceivers, Surfaces};
use crate::gpu::{
    Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, gpu_structs, passed_texture, texels,
};
use crate::receivers::NORMAL_FORMAT;
use crate::shaders;

#[cfg(test)]
pub(crate) mod tests;

/// Width of a tile, texels: as in `points.wesl`, and as in workgroups over receivers.
const TILE: u32 = 8;

bindings! {
    struct Read = "points", COMPUTE, group 0 of [POINTS_PACK] {
        0 points: Uniform,
        1 position_words: Storage,
        2 normal_words: Storage,
        3 width_words: Storage,
        4 positions: WrittenTexture(NORMAL_FORMAT),
        5 normals: WrittenTexture(NORMAL_FORMAT),
    }

    struct Written = "points' visibilities", COMPUTE, group 0 of [POINTS_WRITE] {
        0 points: Uniform,
        1 mask: TextureArray(texels::FLOAT),
        2 visibilities: ReadWrite,
    }
}

gpu_structs! {
    /// Layout of points in buffers and textures.
    pub(crate) struct PointLayout {
        anchor: Vec3,
        count: u32,
        row_length: u32,
        are_in_rows: u32,
        first_position: u32,
        position_stride: u32,
        has_normals: u32,
        first_normal: u32,
        normal_stride: u32,
        has_widths: u32,
        first_width: u32,
        width_stride: u32,
        width_m: f32,
        channels: u32,
    }
}

/// Returns the size of the points' textures and of their mask, texels.
pub(crate) fn size_of_points(count: u32, row_length: Option<u32>) -> UVec2 {
    let Some(row_length) = row_length else {
        let tiles = count.div_ceil(TILE * TILE);
        let in_row = (f64::from(tiles).sqrt().ceil() as u32).max(1);
        return TILE * UVec2::new(in_row, tiles.div_ceil(in_row));
    };
    UVec2::new(row_length, count.div_ceil(row_length.max(1)))
}

/// Points of a frame, in the textures that techniques read.
#[derive(Clone, Debug)]
pub(crate) struct PointTextures {
    size_px: UVec2,
    positions: (Arc<wgpu::Texture>, wgpu::TextureView),
    normals: (Arc<wgpu::Texture>, wgpu::TextureView),
    /// Texture that techniques write. Lights share it: each light's commands fill and read it before another light's do.
    scratch: Arc<wgpu::Texture>,
    mask: Mask,
    read: (wgpu::ComputePipeline, wgpu::BindGroup),
    write: (wgpu::ComputePipeline, wgpu::BindGroup),
}

impl PointTextures {
    /// Prepares a frame's points. `earlier` is the previous frame's.
    pub(crate) fn prepare(
        stage: &Stage<'_>,
        receivers: &PointReceivers<'_>,
        visibilities: &wgpu::Buffer,
        channels: MaskChannels,
        earlier: Option<Self>,
    ) -> Self {
        let size_px = size_of_points(receivers.count, receivers.row_length);
        let texture = |scratch| {
            let texture =
                stage.device.scratch_texture(scratch, &passed_texture("antumbra points", NORMAL_FORMAT, size_px, 1));
            let view = stage.create_view(&texture, &wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        let (positions, normals) = (texture(Scratch::PointPositions), texture(Scratch::PointNormals));
        let scratch = stage.device.scratch_texture(
            Scratch::PointMask,
            &passed_texture("antumbra points", Mask::FORMAT, size_px, channels.count()),
        );
        let mask = earlier
            .filter(|earlier| earlier.scratch == scratch)
            .map_or_else(|| Mask::of_own_layers(&scratch, 0, channels), |earlier| earlier.mask);
        let points = &stage.uniform("antumbra points", &PointLayout::new(stage.anchor(), receivers, size_px, channels));
        // Positions are bound, unread, in place of buffers that the host did not provide.
        let words = receivers.buffers().map(|buffer| buffer.unwrap_or(receivers.positions).buffer);
        let read_layout = Read::layout(stage);
        let read = Read {
            points,
            position_words: words[0],
            normal_words: words[1],
            width_words: words[2],
            positions: &positions.1,
            normals: &normals.1,
        };
        let write_layout = Written::layout(stage);
        let write = Written { points, mask: mask.layers_view(), visibilities };
        let (read_group, write_group) = (read.group(stage, &read_layout), write.group(stage, &write_layout));
        Self {
            size_px,
            read: (compute_pipeline(stage, "points", shaders::POINTS_PACK, &[&read_layout]), read_group),
            write: (
                compute_pipeline(stage, "points' visibilities", shaders::POINTS_WRITE, &[&write_layout]),
                write_group,
            ),
            positions,
            normals,
            scratch,
            mask,
        }
    }

    /// Compiles both passes before the first frame.
    pub(crate) fn compile_ahead(gpu: &Gpu) {
        compute_pipeline(gpu, "points", shaders::POINTS_PACK, &[&Read::layout(gpu)]);
        compute_pipeline(gpu, "points' visibilities", shaders::POINTS_WRITE, &[&Written::layout(gpu)]);
    }

    /// Returns the points as receivers, with the bounds and hull that the host provides.
    pub(crate) fn receivers<'a>(&'a self, host: &PointReceivers<'a>) -> PreparedReceivers<'a> {
        PreparedReceivers {
            size_px: self.size_px,
            origin_px: UVec2::ZERO,
            surfaces: Surfaces::Points { positions: &self.positions.1, on_surfaces: host.normals.is_some() },
            normals: Some(&self.normals.1),
            bounds: Some(host.bounds),
            hull: host.hull,
            seen: host.seen,
            shadow_distance: None,
        }
    }

    /// Mask that the technique writes.
    pub(crate) fn mask(&self) -> &Mask {
        &self.mask
    }

    /// Records the packing of the host's points.
    pub(crate) fn record_read(&self, recorder: &mut Recorder<'_>) {
        self.record(recorder, "points", &self.read);
    }

    /// Records the writing of the technique's mask to the host's buffer.
    pub(crate) fn record_write(&self, recorder: &mut Recorder<'_>) {
        self.record(recorder, "points' visibilities", &self.write);
    }

    fn record(
        &self,
        recorder: &mut Recorder<'_>,
        label: &'static str,
        (pipeline, group): &(wgpu::ComputePipeline, wgpu::BindGroup),
    ) {
        let tiles = self.size_px.map(|px| px.div_ceil(TILE));
        recorder.compute(label, Span::Only, |pass| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(tiles.x, tiles.y, 1);
        });
    }
}

impl PointLayout {
    fn new(anchor: Vec3, receivers: &PointReceivers<'_>, size_px: UVec2, channels: MaskChannels) -> Self {
        let words = |buffer: &PointBuffer<'_>| ((buffer.offset / 4) as u32, buffer.stride / 4);
        let (first_position, position_stride) = words(&receivers.positions);
        let (first_normal, normal_stride) = receivers.normals.as_ref().map_or((0, 0), words);
        let (has_widths, (first_width, width_stride), width_m) = match &receivers.widths {
            PointWidths::Same(width_m) => (0, (0, 0), *width_m),
            PointWidths::Each(widths) => (1, words(widths), 0.0),
        };
        Self {
            anchor,
            count: receivers.count,
            row_length: size_px.x,
            are_in_rows: receivers.row_length.is_some().into(),
            first_position,
            position_stride,
            has_normals: receivers.normals.is_some().into(),
            first_normal,
            normal_stride,
            has_widths,
            first_width,
            width_stride,
            width_m,
            channels: channels.count(),
        }
    }
}
