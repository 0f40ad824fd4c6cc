//! Numbers that the shaders share; the same as in `settings.wesl`.

pub(crate) const PROJECT_SPHERE: u32 = 0;
pub(crate) const PROJECT_PARALLEL: u32 = 1;

pub(crate) const STOP_WHEN_OCCLUDED: u32 = 1;
pub(crate) const PENUMBRA_ONLY: u32 = 2;
pub(crate) const CUT_BY_PLANE: u32 = 4;
pub(crate) const CULL_FACING: u32 = 8;
pub(crate) const KEEP_BITS: u32 = 16;
pub(crate) const FIRST_TRIANGLES: u32 = 32;
pub(crate) const LAST_TRIANGLES: u32 = 64;
pub(crate) const FIRST_POINTS: u32 = 128;
pub(crate) const NO_TRIANGLES: u32 = 256;

pub(crate) const FLAG_CLOSED: u32 = 1;
pub(crate) const FLAG_MASKED: u32 = 4;
pub(crate) const FLAG_TINTED: u32 = 8;

/// Entries of the state that `bounds.wesl` gathers.
pub(crate) const STATE_LENGTH: u64 = 49;
/// Planes and boxes that `count.wesl` leaves.
pub(crate) const SHAFT_LENGTH: u64 = 22;
/// Cells of the sort of triangles: 64³.
pub(crate) const CELL_COUNT: u32 = 1 << 18;
/// Words of the work buffer before the groups'.
pub(crate) const FIRST_GROUP: u32 = 8;
