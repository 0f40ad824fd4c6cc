//! Frame cache key: a light's mask is redrawn when the key changes.

use antumbra_light::{Aabb, Light, ShadowDistance};
use glam::{UVec2, Vec3};

use super::frame::FrameRequest;
use super::{Frame, PointFrame};
use crate::contract::{Camera, CastersKey, Denoise, MaskChannels, MaskPlace, Params, PointBuffer, PointWidths};

/// Key of a frame: all that its mask depends on.
#[derive(Debug, PartialEq)]
pub(super) struct FrameKey<P> {
    params: P,
    denoise: Option<Denoise>,
    is_half_resolution: bool,
    light: Light,
    casters: CastersKey,
    receivers: ReceiversKey,
    points: [Vec<Vec3>; 2],
    version: u64,
}

/// Key of receivers and of their output.
#[derive(Debug, PartialEq)]
enum ReceiversKey {
    Mask {
        mask: (wgpu::Texture, MaskPlace, MaskChannels),
        size_px: UVec2,
        origin_px: UVec2,
        depth: wgpu::TextureView,
        camera: Box<Camera>,
        normals: Option<wgpu::TextureView>,
        bounds: Option<Aabb>,
        shadow_distance: Option<ShadowDistance>,
    },
    Points {
        visibilities: (wgpu::Buffer, MaskChannels),
        count: u32,
        row_length: Option<u32>,
        /// Buffer, offset and stride of positions, normals and widths.
        buffers: [Option<(wgpu::Buffer, u64, u32)>; 3],
        width_m: Option<f32>,
        bounds: Aabb,
    },
}

impl ReceiversKey {
    fn of_mask(frame: &Frame<'_>) -> Self {
        let receivers = &frame.receivers;
        Self::Mask {
            mask: (frame.mask.texture().clone(), frame.mask.place(), frame.mask.channels()),
            size_px: receivers.size_px,
            origin_px: receivers.origin_px,
            depth: receivers.depth.clone(),
            camera: Box::new(receivers.camera()),
            normals: receivers.normals.cloned(),
            bounds: receivers.bounds,
            shadow_distance: receivers.shadow_distance,
        }
    }

    fn of_points(frame: &PointFrame<'_>) -> Self {
        let receivers = &frame.receivers;
        let width_m = match receivers.widths {
            PointWidths::Same(width_m) => Some(width_m),
            PointWidths::Each(_) => None,
        };
        let key = |buffer: PointBuffer<'_>| (buffer.buffer.clone(), buffer.offset, buffer.stride);
        Self::Points {
            visibilities: (frame.visibilities.clone(), frame.channels),
            count: receivers.count,
            row_length: receivers.row_length,
            buffers: receivers.buffers().map(|buffer| buffer.map(key)),
            width_m,
            bounds: receivers.bounds,
        }
    }
}

impl<P: Params> FrameKey<P> {
    /// Creates the key of a frame; `None` if receivers or casters have no version.
    pub(super) fn of(
        params: &P,
        (denoise, is_half_resolution): (Option<&Denoise>, bool),
        request: &FrameRequest<'_>,
        casters: Option<CastersKey>,
    ) -> Option<Self> {
        let (casters, (version, points)) = (
            casters?,
            match request {
                FrameRequest::Mask(Frame { receivers, .. }) => (receivers.version?, [receivers.hull, receivers.seen]),
                FrameRequest::Points(PointFrame { receivers, .. }) => {
                    (receivers.version?, [receivers.hull, receivers.seen])
                }
            },
        );
        Some(Self {
            casters,
            version,
            params: params.clone(),
            denoise: denoise.cloned(),
            is_half_resolution,
            light: request.light().for_shadows(),
            receivers: match request {
                FrameRequest::Mask(frame) => ReceiversKey::of_mask(frame),
                FrameRequest::Points(frame) => ReceiversKey::of_points(frame),
            },
            points: points.map(<[Vec3]>::to_vec),
        })
    }
}
