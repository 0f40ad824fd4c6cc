//! The lists as a host may look at them.

use glam::UVec2;

use super::ViewSamples;
use crate::contract::{DrawnLists, ListLengths, ListLevel, ListOrder};

/// Layout of a frame's lists.
#[derive(Clone, Copy, Debug)]
pub(super) struct ListWindows {
    /// `None` where receivers are sorted into cells: see [`FramePlan`].
    pub(super) count: Option<u32>,
    pub(super) side: u32,
    /// The device chooses between windows and cells.
    pub(super) are_chosen: bool,
}

impl ViewSamples {
    /// The lists of each window that receivers are seen through, or those of the cells that they are sorted into.
    pub(crate) fn drawn_lists(&self) -> Vec<DrawnLists> {
        let (Some(windows), Some(counts)) = (self.windows, &self.buffers.counts) else { return Vec::new() };
        let side = windows.side;
        let of_window = |window: u32| DrawnLists {
            words: counts.clone(),
            // The scan has made places of counts.
            lengths: ListLengths::Between,
            listed: "receivers",
            order: match windows.count {
                // Behind the total of all windows' lists.
                Some(_) if windows.are_chosen => ListOrder::Told { word: side * side + 1 },
                Some(_) => ListOrder::Rows,
                None => ListOrder::Halvings,
            },
            levels: vec![ListLevel { first: window * side * side, size_texels: UVec2::splat(side) }],
        };
        (0..windows.count.unwrap_or(1)).map(of_window).collect()
    }
}
