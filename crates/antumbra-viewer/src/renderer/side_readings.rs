//! Readings of one side: compilation, faults, times, memory, error.

use antumbra::TechniqueKind;

use super::times::Times;

/// Readings of one side.
#[derive(Clone, Copy, Debug)]
pub struct SideReadings<'a> {
    /// What is being compiled.
    pub compiling: Option<TechniqueKind>,
    /// Why it cannot draw.
    pub problem: Option<&'a str>,
    /// What the last frame lacked room for.
    pub overflow: Option<&'a str>,
    /// Times of the last frames.
    pub times: &'a Times,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: u64,
    /// Texels along a side of each map whose size is chosen for each frame.
    pub auto_map_sizes: &'a [u32],
    /// The error against the truth so far.
    pub rmse: Option<f64>,
}
