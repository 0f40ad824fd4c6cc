//! Options of texel lists.

use glam::UVec2;

/// Samples per texel if coverage counts; every device supports as many.
pub(crate) const COVERAGE_SAMPLES: u32 = 4;

/// Mode that combines opacities at one place; numbered as in `fragments.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accumulation {
    /// Sum: surfaces do not overlap.
    Add = 0,
    /// Product of transmittances: surfaces overlap at random.
    Multiply = 1,
    /// Maximum: surfaces cover one another.
    Max = 2,
    /// Measured overlap of the farther surface with the nearer one.
    Overlap = 3,
}

/// Distance in depth: `slope · z + m`, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DepthTolerance {
    /// Metres per metre of depth, for perspective views.
    pub(crate) slope: f32,
    /// Metres, for orthographic views.
    pub(crate) m: f32,
}

/// Method that gathers fragments into lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gather {
    /// Count, scan, collect.
    Arrays,
    /// Link, pack.
    Linked,
}

/// Options of texel lists.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ListOptions {
    /// Texels along each side.
    pub(crate) map_size: UVec2,
    /// Largest number of texels of a map, for which buffers have room.
    pub(crate) max_texels: u32,
    /// Largest number of fragments.
    pub(crate) capacity: u32,
    /// Entries of [`PreparedLists::lists`](super::PreparedLists::lists): one per texel, then those of the owner.
    pub(crate) list_count: u32,
    /// Bytes of what the owner derives from the lists; they share the lists' lease.
    pub(crate) owners_bytes: u64,
    /// Whether opacity has three channels.
    pub(crate) colored: bool,
    /// Number of layers to keep of each list, from the nearest; 0 keeps all.
    pub(crate) layers: u32,
    /// Distance up to which neighbours in a list are joined, at their mean depth; `None` joins nothing.
    pub(crate) join: Option<DepthTolerance>,
    /// Whether closed opaque meshes contribute all faces, too.
    pub(crate) all_faces: bool,
    /// Depth offset away from the light for fragments of surfaces that contribute both faces, so that they do not shade
    /// themselves.
    pub(crate) open_offset: DepthTolerance,
    /// Mode that combines joined opacities.
    pub(crate) accumulation: Accumulation,
    /// Method that gathers fragments.
    pub(crate) gather: Gather,
    /// Samples per texel, 1 or [`COVERAGE_SAMPLES`]. With the latter, opacity includes the share of the texel that a fragment
    /// covers, if its caster is opaque and has buffers with the usage `STORAGE`.
    pub(crate) samples: u32,
    /// Distance up to which fragments that cover different samples count as one surface.
    pub(crate) adjoin: DepthTolerance,
}
