//! Keys of frames: a light's mask is drawn again where its frame's key changes.

use antumbra_light::{Aabb, Light, ShadowDistance};
use glam::{Mat4, UVec2, Vec3};

use super::Frame;
use crate::contract::{CastersKey, Denoise, DepthConvention, MaskChannels, MaskPlace, Params};

/// Key of a frame: all that its mask depends on.
#[derive(Debug, PartialEq)]
pub(super) struct FrameKey<P> {
    params: P,
    denoise: Option<Denoise>,
    light: Light,
    casters: CastersKey,
    mask: (wgpu::Texture, MaskPlace, MaskChannels),
    size_px: UVec2,
    origin_px: UVec2,
    depth: wgpu::TextureView,
    depth_convention: DepthConvention,
    camera: [Mat4; 2],
    normals: Option<wgpu::TextureView>,
    bounds: Option<Aabb>,
    points: [Vec<Vec3>; 2],
    shadow_distance: Option<ShadowDistance>,
    version: u64,
}

impl<P: Params> FrameKey<P> {
    /// `None` where the host does not say when depth or casters change.
    pub(super) fn of(
        params: &P,
        denoise: Option<&Denoise>,
        frame: &Frame<'_>,
        casters: Option<CastersKey>,
    ) -> Option<Self> {
        let receivers = &frame.receivers;
        Some(Self {
            casters: casters?,
            version: receivers.version?,
            params: params.clone(),
            denoise: denoise.cloned(),
            light: frame.light.for_shadows(),
            mask: (frame.mask.texture().clone(), frame.mask.place(), frame.mask.channels()),
            size_px: receivers.size_px,
            origin_px: receivers.origin_px,
            depth: receivers.depth.clone(),
            depth_convention: receivers.depth_convention,
            camera: [receivers.view_from_world, receivers.clip_from_view],
            normals: receivers.normals.cloned(),
            bounds: receivers.bounds,
            points: [receivers.hull, receivers.seen].map(<[Vec3]>::to_vec),
            shadow_distance: receivers.shadow_distance,
        })
    }
}
