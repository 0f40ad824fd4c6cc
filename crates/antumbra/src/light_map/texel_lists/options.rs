//! What lists to make.

use glam::UVec2;

/// Samples of a texel where coverage counts: as many as every device has.
pub(crate) const COVERAGE_SAMPLES: u32 = 4;

/// How opacities at one place come together; the numbers of `fragments.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accumulation {
    /// Their sum: they do not overlap.
    Add = 0,
    /// The product of transmittances: they overlap at random.
    Multiply = 1,
    /// The largest: they cover one another.
    Max = 2,
    /// By how much the farther one was found to lie behind the nearer.
    Overlap = 3,
}

/// A distance in depth: `slope · z + m`, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DepthTolerance {
    /// For perspective views.
    pub(crate) slope: f32,
    /// For orthographic views.
    pub(crate) m: f32,
}

/// How the fragments come into their lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gather {
    /// Count, scan, collect.
    Arrays,
    /// Link, pack.
    Linked,
}

/// What lists to make.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ListOptions {
    /// Texels along each side.
    pub(crate) map_size: UVec2,
    /// Texels that a map has at most, whatever its sides: there is room for as many.
    pub(crate) most_texels: u32,
    /// Fragments to have room for.
    pub(crate) capacity: u32,
    /// Entries of [`TexelLists::lists`]: one a texel, and what the owner adds behind them.
    pub(crate) list_count: u32,
    /// Bytes of what the owner makes of the lists: they are the light's own where those are.
    pub(crate) owners_bytes: u64,
    /// Three channels of opacity.
    pub(crate) colored: bool,
    /// Fragments to keep of each list, from the nearest; 0 keeps all.
    pub(crate) layers: u32,
    /// Joins neighbours in a list that are at least this near, at their mean depth.
    pub(crate) join: Option<DepthTolerance>,
    /// Closed opaque meshes leave every face, too.
    pub(crate) all_faces: bool,
    /// How much farther than they are to store the fragments of surfaces that leave both faces, so that they do not
    /// shade themselves.
    pub(crate) open_offset: DepthTolerance,
    /// How joined opacities come together.
    pub(crate) accumulation: Accumulation,
    /// How to gather.
    pub(crate) gather: Gather,
    /// Samples of a texel, 1 or [`COVERAGE_SAMPLES`]: with those a fragment's opacity counts the share of the texel that
    /// it covers, where the caster is opaque and its buffers have the usage `STORAGE`.
    pub(crate) samples: u32,
    /// How near to one another fragments that cover different samples must be to count as one surface.
    pub(crate) adjoin: DepthTolerance,
}
