//! Lists of a frame, for inspection by a host.

use glam::UVec2;

use super::ViewSamples;
use super::plan::FramePlan;
use crate::contract::{DrawnLists, ListLengths, ListLevel, ListOrder};

/// Layout of a frame's lists.
#[derive(Clone, Copy, Debug)]
pub(super) struct ListWindows {
    /// Number of windows; `None` if receivers are sorted into cells: see [`FramePlan`].
    pub(super) count: Option<u32>,
    pub(super) side: u32,
    /// Whether the device chooses between windows and cells.
    pub(super) are_chosen: bool,
}

impl ListWindows {
    pub(super) fn of(plan: &FramePlan) -> Self {
        Self { count: plan.windows.map(|windows| windows.count), side: plan.window_side, are_chosen: plan.chooses() }
    }
}

impl ViewSamples {
    /// Returns the lists of each window, or those of the cells into which receivers are sorted.
    pub(crate) fn drawn_lists(&self) -> Vec<DrawnLists> {
        let (Some(windows), Some(counts)) = (self.windows, &self.buffers.counts) else { return Vec::new() };
        let side = windows.side;
        let of_window = |window: u32| DrawnLists {
            words: counts.clone(),
            // The prefix sum has turned counts into positions.
            lengths: ListLengths::Between,
            listed: "receivers",
            order: match windows.count {
                // After the total of all windows' lists.
                Some(_) if windows.are_chosen => ListOrder::Chosen { word: side * side + 1 },
                Some(_) => ListOrder::Rows,
                None => ListOrder::Halvings,
            },
            levels: vec![ListLevel { first: window * side * side, size_texels: UVec2::splat(side) }],
        };
        (0..windows.count.unwrap_or(1)).map(of_window).collect()
    }
}
