//! Casters: the host's meshes, or a depth map of the light that the host has rendered.

use std::ops::Range;

use antumbra_light::Aabb;
use glam::{Mat4, UVec2, Vec3};

use super::{DepthConvention, MaskChannels};

/// Casters of a frame, as techniques receive them.
#[derive(Clone, Copy, Debug)]
pub enum PreparedCasters<'a> {
    /// Meshes.
    Draws(&'a [MeshCaster<'a>]),
    /// The host's own light depth map.
    HostDepthMap(DepthMapCaster<'a>),
}

impl PreparedCasters<'_> {
    /// Number of mask channels that these casters need: three if any tints, otherwise one.
    pub fn mask_channels(&self) -> MaskChannels {
        match self {
            Self::Draws(meshes) if meshes.iter().any(|mesh| mesh.opacity.tints()) => MaskChannels::Three,
            Self::Draws(_) | Self::HostDepthMap(_) => MaskChannels::One,
        }
    }
}

impl<'a> MeshCaster<'a> {
    /// One instance of `index_count / 3` triangles: opaque, not closed, its bounds unknown. `with_` and a field's name set the rest.
    pub fn new(
        positions: &'a wgpu::Buffer,
        indices: &'a wgpu::Buffer,
        index_count: u32,
        instances: &'a wgpu::Buffer,
    ) -> Self {
        Self {
            positions,
            indices,
            first_triangle: 0,
            index_count,
            instances,
            first_instance: 0,
            instance_count: 1,
            closed: false,
            opacity: Opacity::Opaque,
            bounds: Aabb::EVERYTHING,
            version: None,
        }
    }

    /// Sets [`first_triangle`](Self::first_triangle).
    pub fn with_first_triangle(self, first_triangle: u32) -> Self {
        Self { first_triangle, ..self }
    }

    /// Sets [`first_instance`](Self::first_instance) and [`instance_count`](Self::instance_count).
    pub fn with_instances(self, instances: Range<u32>) -> Self {
        Self { first_instance: instances.start, instance_count: instances.end.saturating_sub(instances.start), ..self }
    }

    /// Sets [`closed`](Self::closed).
    pub fn with_closed(self, closed: bool) -> Self {
        Self { closed, ..self }
    }

    /// Sets [`opacity`](Self::opacity).
    pub fn with_opacity(self, opacity: Opacity<'a>) -> Self {
        Self { opacity, ..self }
    }

    /// Sets [`bounds`](Self::bounds). Known bounds make light maps tighter.
    pub fn with_bounds(self, bounds: Aabb) -> Self {
        Self { bounds, ..self }
    }

    /// Sets [`version`](Self::version).
    pub fn with_version(self, version: impl Into<Option<MeshVersion>>) -> Self {
        Self { version: version.into(), ..self }
    }

    /// The indices to draw.
    pub(crate) fn index_range(&self) -> Range<u32> {
        3 * self.first_triangle..3 * self.first_triangle + self.index_count
    }

    /// The instances to draw.
    pub(crate) fn instance_range(&self) -> Range<u32> {
        self.first_instance..self.first_instance + self.instance_count
    }
}

/// Indexed triangles of one surface, drawn `instance_count` times.
///
/// Buffers stay the host's. They need the usages `VERTEX`, and `INDEX` for the indices; techniques that read
/// triangles in compute (`ray_traced`, `alias_free`, `sample_based`, `multi_view` unless it compares otherwise) also need `STORAGE` on all
/// three, and `multi_layer` sees parts of texels where positions and indices have it.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct MeshCaster<'a> {
    /// Object-space positions: `[f32; 3]` each, tightly packed from offset 0.
    pub positions: &'a wgpu::Buffer,
    /// `u32` each, three a triangle, from offset 0.
    pub indices: &'a wgpu::Buffer,
    /// First triangle to draw.
    pub first_triangle: u32,
    /// Number of indices to draw.
    pub index_count: u32,
    /// World-from-object matrices: column-major, affine `[[f32; 4]; 4]` each, tightly packed.
    pub instances: &'a wgpu::Buffer,
    /// First instance to draw.
    pub first_instance: u32,
    /// Number of instances to draw.
    pub instance_count: u32,
    /// Triangles counter-clockwise from outside bound a solid, which holds no receivers but where the camera's near plane is
    /// within `bounds`. Some techniques then need no bias.
    pub closed: bool,
    /// Effect of the surface on light.
    pub opacity: Opacity<'a>,
    /// World-space box of all instances, infinite on sides that are not known ([`Aabb::EVERYTHING`] on all).
    pub bounds: Aabb,
    /// What tells the mesh from what it was, for a technique that keeps something of a mesh from frame to frame (`ray_traced`); `None`
    /// where nothing does: all of it may be another in each frame.
    pub version: Option<MeshVersion>,
}

/// Version key of a mesh's positions and indices: equal versions mean equal meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MeshVersion {
    /// No other mesh has it, nor has the same place in buffers once it holds another mesh.
    pub mesh: u64,
    /// Pose counter: another number for each skinned or morphed pose.
    pub vertices: u64,
}

/// Effect of a surface on light.
#[derive(Clone, Copy, Debug)]
pub enum Opacity<'a> {
    /// Blocks all.
    Opaque,
    /// Blocks all where `alpha_factor` × the texture's filtered alpha ≥ `cutoff`, nothing elsewhere.
    Masked {
        /// Texture with alpha.
        texture: SurfaceTexture<'a>,
        /// Multiplies the texture's alpha.
        alpha_factor: f32,
        /// Coverage threshold, 0 to 1.
        cutoff: f32,
    },
    /// Lets pass `(1 − coverage) + coverage · transmitted` of each colour. Techniques that know only opaque casters count
    /// it as opaque where it stops at least half of white light.
    Translucent {
        /// How much of the surface is there.
        coverage: SurfaceCoverage,
        /// What passes where it is, linear, 0 to 1: transmission × tint. [`Vec3::ZERO`] for surfaces that are blended by
        /// their alpha and transmit nothing: they cover, and never tint.
        transmitted: Vec3,
        /// Its RGB multiplies `transmitted`, its alpha the coverage's.
        texture: Option<SurfaceTexture<'a>>,
    },
}

/// Coverage of a translucent surface. Without a texture alpha is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceCoverage {
    /// All of it, whatever the texture's alpha.
    Whole,
    /// So much × the texture's filtered alpha: alpha blending.
    Alpha(f32),
    /// All where `alpha_factor` × the texture's filtered alpha ≥ `cutoff`, none elsewhere.
    Cutoff {
        /// Multiplies the texture's alpha.
        alpha_factor: f32,
        /// 0 to 1.
        cutoff: f32,
    },
}

impl SurfaceCoverage {
    /// Whether all of its numbers are finite.
    pub(crate) fn is_finite(self) -> bool {
        match self {
            Self::Whole => true,
            Self::Alpha(alpha) => alpha.is_finite(),
            Self::Cutoff { alpha_factor, cutoff } => alpha_factor.is_finite() && cutoff.is_finite(),
        }
    }
}

impl<'a> Opacity<'a> {
    /// Whether the surface can change the colour of light.
    pub fn tints(&self) -> bool {
        match self {
            Self::Opaque | Self::Masked { .. } => false,
            Self::Translucent { transmitted, texture, .. } => tints(*transmitted, texture.is_some()),
        }
    }

    /// The surface's texture.
    pub(crate) fn texture(&self) -> Option<&SurfaceTexture<'a>> {
        match self {
            Self::Opaque => None,
            Self::Masked { texture, .. } => Some(texture),
            Self::Translucent { texture, .. } => texture.as_ref(),
        }
    }
}

/// Whether a translucent surface may change light's colour.
pub(crate) fn tints(transmitted: Vec3, is_textured: bool) -> bool {
    let is_grey = transmitted == Vec3::splat(transmitted.x);
    transmitted != Vec3::ZERO && (is_textured || !is_grey)
}

/// Texture of a caster.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceTexture<'a> {
    /// Texture coordinates: `[f32; 2]` a vertex, tightly packed from offset 0.
    pub uvs: &'a wgpu::Buffer,
    /// A 2D view of a filterable colour format.
    pub view: &'a wgpu::TextureView,
    /// Filtering sampler; it also sets the texture's address modes.
    pub sampler: &'a wgpu::Sampler,
}

/// Depth map of a light, rendered by the host.
#[derive(Clone, Copy, Debug)]
pub struct DepthMapCaster<'a> {
    /// `Depth32Float` (depth aspect), 2D, one layer.
    pub view: &'a wgpu::TextureView,
    /// Size, texels.
    pub size_px: UVec2,
    /// The matrix it was rendered with: a perspective from the light's centre along its axis, or for a sun an
    /// orthographic one along its axis. Any roll and any window of either.
    pub clip_from_world: Mat4,
    /// Depth convention.
    pub depth_convention: DepthConvention,
}
