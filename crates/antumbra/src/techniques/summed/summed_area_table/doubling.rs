//! Steps of recursive doubling: which sums each adds up.

use glam::UVec2;

use super::{BLOCK, DOUBLING_READS, MAX_TILE};

/// Steps of recursive doubling.
#[derive(Debug, PartialEq)]
pub(super) struct Doubling {
    /// Distances between the sums that a step adds up.
    pub(super) strides: Vec<UVec2>,
    /// Number of last steps that run only if the tile is larger than their stride.
    pub(super) late_count: usize,
}

impl Doubling {
    /// Returns the steps for a table of tiles of `side`, or if that is 0 for the tile that will be chosen: 2 ⌈log₈ side⌉ steps,
    /// as many passes as Shen et al. 2013 have (section 6.1, table 2).
    ///
    /// There is at least one step, so that a single texel is copied. Steps along x and along y commute. Steps that a chosen
    /// tile may skip come last, in pairs, so that the sums stay in the same texture.
    pub(super) fn of(size: UVec2, side: u32) -> Self {
        let strides_below = |length: u32| {
            std::iter::successors(Some(1), |stride: &u32| Some(stride * DOUBLING_READS))
                .take_while(move |stride| *stride < length)
        };
        // Every tile that may be chosen needs the strides below the smallest.
        let least = if side == 0 { BLOCK } else { side };
        let mut strides: Vec<UVec2> = strides_below(size.x.min(least)).map(|x| UVec2::new(x, 0)).collect();
        strides.extend(strides_below(size.y.min(least)).map(|y| UVec2::new(0, y)));
        if strides.is_empty() {
            strides.push(UVec2::new(1, 0));
        }
        let late = strides_below(size.max_element().min(MAX_TILE)).filter(|stride| side == 0 && *stride >= BLOCK);
        let early_count = strides.len();
        strides.extend(late.flat_map(|stride| [UVec2::new(stride, 0), UVec2::new(0, stride)]));
        Self { late_count: strides.len() - early_count, strides }
    }
}

// One dispatch count serves all late steps: every tile that may be chosen runs either all or none of them.
const _: () = assert!(MAX_TILE <= DOUBLING_READS * DOUBLING_READS * DOUBLING_READS && BLOCK > DOUBLING_READS);
