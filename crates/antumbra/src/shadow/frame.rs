//! Frame of one light as a host describes it, and its casters as they are drawn.

use antumbra_light::Light;
use glam::Vec3;

use crate::casters::{Ball, CasterSet};
use crate::contract::{
    CastersKey, DepthMapCaster, Error, Mask, MaskChannels, MeshCaster, PointReceivers, PreparedCasters, PreparedFrame,
    PreparedReceivers, Receivers,
};

/// Frame of one light: inputs and output.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Light.
    pub light: &'a Light,
    /// Casters.
    pub casters: Casters<'a>,
    /// Receivers.
    pub receivers: Receivers<'a>,
    /// Output mask; its size is the receivers'.
    pub mask: &'a Mask,
}

/// Frame of one light for points in place of a depth buffer.
#[derive(Clone, Copy, Debug)]
pub struct PointFrame<'a> {
    /// Light.
    pub light: &'a Light,
    /// Casters.
    pub casters: Casters<'a>,
    /// Points.
    pub receivers: PointReceivers<'a>,
    /// Output buffer: a 32-bit float per point and channel, with red, green and blue of a point next to one another. Usage
    /// `STORAGE`, no larger than a binding.
    pub visibilities: &'a wgpu::Buffer,
    /// Number of channels; [`Casters::mask_channels`] returns the number that the casters need.
    pub channels: MaskChannels,
}

/// Request of a host.
#[derive(Clone, Copy, Debug)]
pub(super) enum FrameRequest<'a> {
    /// A mask of a depth buffer.
    Mask(Frame<'a>),
    /// Visibilities of points.
    Points(PointFrame<'a>),
}

impl<'a> FrameRequest<'a> {
    pub(super) fn light(&self) -> &'a Light {
        match self {
            Self::Mask(frame) => frame.light,
            Self::Points(frame) => frame.light,
        }
    }

    pub(super) fn casters(&self) -> &Casters<'a> {
        match self {
            Self::Mask(frame) => &frame.casters,
            Self::Points(frame) => &frame.casters,
        }
    }
}

/// Casters in one of four forms.
#[derive(Clone, Copy, Debug)]
pub enum Casters<'a> {
    /// A set of casters that lights share. Every technique supports it.
    Set {
        /// Casters, uploaded by [`CasterSet::update`].
        set: &'a CasterSet,
        /// Bit mask of the layers whose casters the light sees; `u32::MAX` for all.
        layers: u32,
    },
    /// Casters of a set that reach into a ball, such as a light's range. No others are drawn, and changes outside of the ball
    /// redraw nothing. Visibility is correct within the ball if it contains the light. Every technique supports it.
    Within {
        /// Casters, uploaded by [`CasterSet::update`].
        set: &'a CasterSet,
        /// Bit mask of the layers whose casters the light sees; `u32::MAX` for all.
        layers: u32,
        /// Centre of the ball, world space.
        center: Vec3,
        /// Radius of the ball, metres; may be infinite.
        radius_m: f32,
    },
    /// Geometry in the host's own buffers, for hosts that have it in this form. Every technique supports it.
    Meshes(&'a [MeshCaster<'a>]),
    /// The host's own light depth map, for the techniques that need nothing else: `hard`, `pcf`, `pcss`, `vsm`, `lvsm`, `evsm`,
    /// `esm`, `convolution`, `moment`.
    DepthMap(DepthMapCaster<'a>),
}

impl Casters<'_> {
    /// Number of mask channels that these casters need: three if any tints, otherwise one.
    pub fn mask_channels(&self) -> MaskChannels {
        match self {
            Self::Set { set, layers } | Self::Within { set, layers, .. } => set.mask_channels(*layers),
            Self::Meshes(meshes) => PreparedCasters::Draws(meshes).mask_channels(),
            Self::DepthMap(map) => PreparedCasters::HostDepthMap(*map).mask_channels(),
        }
    }

    /// Cache key of the casters; `None` if their changes are unknown.
    pub(crate) fn key(&self) -> Option<CastersKey> {
        match *self {
            Self::Set { set, layers } => Some(set.key(layers, None)),
            Self::Within { set, layers, center, radius_m } => Some(set.key(layers, Some(Ball { center, radius_m }))),
            Self::Meshes(_) | Self::DepthMap(_) => None,
        }
    }
}

/// A frame's casters, with a set resolved to its meshes.
pub(super) enum FrameCasters<'a> {
    /// Meshes of a set.
    Set(Vec<MeshCaster<'a>>),
    /// The host's own.
    Host(PreparedCasters<'a>),
}

impl<'a> FrameCasters<'a> {
    /// Resolves a frame's casters.
    ///
    /// # Errors
    /// If a set has changes that were not uploaded.
    pub(super) fn of(casters: &Casters<'a>) -> Result<Self, Error> {
        Ok(match *casters {
            Casters::Set { set, layers } => Self::Set(set.meshes(layers, None)?),
            Casters::Within { set, layers, center, radius_m } => {
                Self::Set(set.meshes(layers, Some(Ball { center, radius_m }))?)
            }
            Casters::Meshes(meshes) => Self::Host(PreparedCasters::Draws(meshes)),
            Casters::DepthMap(map) => Self::Host(PreparedCasters::HostDepthMap(map)),
        })
    }

    /// Meshes; `None` for a host's depth map.
    pub(super) fn meshes(&self) -> Option<&[MeshCaster<'a>]> {
        match self {
            Self::Set(meshes) => Some(meshes),
            Self::Host(PreparedCasters::Draws(meshes)) => Some(meshes),
            Self::Host(PreparedCasters::HostDepthMap(_)) => None,
        }
    }
}

/// Creates a frame with its casters as they are drawn.
pub(super) fn prepared<'f>(
    light: &'f Light,
    casters: &'f FrameCasters<'_>,
    receivers: PreparedReceivers<'f>,
    mask: &'f Mask,
) -> PreparedFrame<'f> {
    let casters = match casters {
        FrameCasters::Set(meshes) => PreparedCasters::Draws(meshes),
        FrameCasters::Host(casters) => *casters,
    };
    PreparedFrame { light, casters, receivers, mask, noisy: None }
}
