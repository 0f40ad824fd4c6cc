//! One light's work for one frame, as a host hands it over, and what of it is drawn.

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
    /// Where visibility goes: a 32-bit float for each point and channel, red, green and blue of a point after one another. Usage
    /// `STORAGE`, no larger than a binding.
    pub visibilities: &'a wgpu::Buffer,
    /// Number of channels; [`Casters::mask_channels`] returns the number that the casters need.
    pub channels: MaskChannels,
}

/// What a host asks for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asked<'a> {
    /// A mask of a depth buffer.
    Mask(Frame<'a>),
    /// Visibilities of points.
    Points(PointFrame<'a>),
}

impl<'a> Asked<'a> {
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
    /// A set of casters that lights share; every technique takes it.
    Set {
        /// The casters, brought to the GPU by [`CasterSet::update`].
        set: &'a CasterSet,
        /// A bit for each layer whose casters the light sees; `u32::MAX` for all.
        layers: u32,
    },
    /// The same of the casters that reach into a ball, such as a light's range: no others are drawn, and what changes outside of the ball
    /// redraws nothing. Visibility is right within it if it holds the light; every technique takes it.
    Within {
        /// The casters, brought to the GPU by [`CasterSet::update`].
        set: &'a CasterSet,
        /// A bit for each layer whose casters the light sees; `u32::MAX` for all.
        layers: u32,
        /// Centre of the ball, world space.
        center: Vec3,
        /// Radius of the ball, metres; may be infinite.
        radius_m: f32,
    },
    /// Geometry in the host's own buffers, for those that have it in just this form; every technique takes it.
    Meshes(&'a [MeshCaster<'a>]),
    /// The host's own light depth map, for the techniques that need no more: `hard`, `pcf`, `pcss`,
    /// `vsm`, `lvsm`, `evsm`, `esm`, `convolution`, `moment`.
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

    /// Key of the casters; `None` where nothing tells when they change.
    pub(crate) fn key(&self) -> Option<CastersKey> {
        match *self {
            Self::Set { set, layers } => Some(set.key(layers, None)),
            Self::Within { set, layers, center, radius_m } => Some(set.key(layers, Some(Ball { center, radius_m }))),
            Self::Meshes(_) | Self::DepthMap(_) => None,
        }
    }
}

/// A frame's casters, with a set's meshes in the set's place.
pub(super) enum FrameCasters<'a> {
    /// Meshes of a set.
    Set(Vec<MeshCaster<'a>>),
    /// The host's own.
    Host(PreparedCasters<'a>),
}

impl<'a> FrameCasters<'a> {
    /// Of a frame's casters.
    ///
    /// # Errors
    /// Where a set has changes that were not brought to the GPU.
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

    /// The meshes; none where the host has drawn them.
    pub(super) fn meshes(&self) -> Option<&[MeshCaster<'a>]> {
        match self {
            Self::Set(meshes) => Some(meshes),
            Self::Host(PreparedCasters::Draws(meshes)) => Some(meshes),
            Self::Host(PreparedCasters::HostDepthMap(_)) => None,
        }
    }
}

/// A frame with its casters as they are drawn.
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
