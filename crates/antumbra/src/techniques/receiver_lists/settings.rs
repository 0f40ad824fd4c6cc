//! Constants that Rust and the shaders share.

use crate::gpu::shared_constants;

shared_constants! {
    pub(crate) const PROJECT_SPHERE: u32 = 0, as in LISTS_BOUNDS;
    pub(crate) const PROJECT_PARALLEL: u32 = 1, as in LISTS_BOUNDS;

    pub(crate) const STOP_WHEN_OCCLUDED: u32 = 1, as in EVALUATION_EVALUATE;
    pub(crate) const PENUMBRA_ONLY: u32 = 2, as in EVALUATION_EVALUATE;
    pub(crate) const CUT_BY_PLANE: u32 = 4, as in EVALUATION_EVALUATE;
    pub(crate) const CULL_FACING: u32 = 8, as in TRIANGLES_COUNT;
    pub(crate) const KEEP_BITS: u32 = 16, as in EVALUATION_EVALUATE;
    pub(crate) const FIRST_TRIANGLES: u32 = 32, as in EVALUATION_EVALUATE;
    pub(crate) const LAST_TRIANGLES: u32 = 64, as in EVALUATION_EVALUATE;
    pub(crate) const FIRST_POINTS: u32 = 128, as in EVALUATION_EVALUATE;
    pub(crate) const CHOOSES: u32 = 256, as in LISTS_BOUNDS;

    pub(crate) const SUBSET_ALL: u32 = 0, as in LISTS_BOUNDS;
    pub(crate) const SUBSET_KNOWN: u32 = 1, as in LISTS_BOUNDS;
    pub(crate) const SUBSET_MISSING: u32 = 2, as in LISTS_BOUNDS;

    pub(crate) const FLAG_CLOSED: u32 = 1, as in TRIANGLES_COUNT;
    pub(crate) const FLAG_MASKED: u32 = 4, as in EVALUATION_EVALUATE;
    pub(crate) const FLAG_TINTED: u32 = 8, as in EVALUATION_EVALUATE;

    pub(crate) const EITHER: u32 = 0, as in EVALUATION_BEGIN;
    pub(crate) const DRAWN: u32 = 1, as in EVALUATION_BEGIN;
    pub(crate) const WALKED: u32 = 2, as in EVALUATION_BEGIN;

    /// Number of entries of the state that `lists/bounds.wesl` computes.
    pub(crate) const STATE_LENGTH: u64 = 51, as in LISTS_BOUNDS;
    /// Number of words of the work buffer before the groups' words.
    pub(crate) const FIRST_GROUP: u32 = 8, as in EVALUATION_EVALUATE;
}

/// Number of planes and boxes that `lists/count.wesl` writes.
pub(crate) const SHAFT_LENGTH: u64 = 22;
/// Number of cells of the sort of triangles: 64³.
pub(crate) const CELL_COUNT: u32 = 1 << 18;
