//! Measurements of one side: compilation, errors, times, memory, RMSE.

use antumbra::TechniqueKind;

use super::times::Times;

/// Measurements of one side.
#[derive(Clone, Copy, Debug)]
pub struct SideReadings<'a> {
    /// Technique that is being compiled.
    pub compiling: Option<TechniqueKind>,
    /// Reason why the technique cannot draw.
    pub problem: Option<&'a str>,
    /// Overflow of the last frame, as text.
    pub overflow: Option<&'a str>,
    /// Times of the last frames.
    pub times: &'a Times,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: u64,
    /// Texels along a side of each map whose size is chosen for each frame.
    pub auto_map_sizes: &'a [u32],
    /// Root-mean-square error against the ground truth traced so far.
    pub rmse: Option<f64>,
}
