//! Levels: position of their lists, how each is made from another one, and the blur of its lookup.

use glam::UVec2;

use crate::light_map::texel_lists::options::DepthTolerance;

/// Level of the hierarchy. Level 0 is the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Level {
    /// Index of its first list.
    pub(crate) first: u32,
    /// Number of texels along each side.
    pub(crate) size: UVec2,
    /// Distance between its texels, in texels of the base.
    pub(crate) spacing: f32,
    /// Texel (x, y) lies at (x + offset, y + offset) · spacing in the base: ½ for halved levels, 0 in the stack, −½ if its
    /// first kernel is shifted.
    pub(crate) offset: f32,
    /// Side of the box that blurs as much as the level's bilinear lookup, in texels of the base.
    pub(crate) width: f32,
    /// Side of the box with the variance of the texels that a list merges, in texels of the base; 0 for a single texel.
    pub(crate) merged: f32,
    /// Number of doublings of its kernel; halves are possible.
    pub(crate) octave: f32,
    /// Index of the level that it merges.
    pub(crate) source: usize,
    /// Merge step from that level; `None` for the base.
    pub(crate) step: Option<Step>,
    /// Depth limit, metres: surfaces that begin beyond it are dropped, because no receiver looks them up in the level.
    pub(crate) z_limit_m: f32,
}

impl Level {
    /// Returns the side of the square of texels that a list merges, in texels of the base.
    pub(crate) fn kernel(&self) -> f32 {
        self.octave.floor().exp2() * (1.0 + self.octave.fract())
    }
}

/// Merge step: a texel merges four lists of its source, at `stride · texel + {near, far}` in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    pub(crate) stride: u32,
    pub(crate) near: i32,
    pub(crate) far: i32,
    /// Whether one of the four lists is taken unchanged instead.
    pub(crate) subsample: bool,
}

/// Maximum number of kernel sizes, including the base: a base of 8192 texels a side halved to one.
pub(crate) const MAX_OCTAVES: u32 = 14;

/// Maximum width of kernels of a fine stack, in texels of the level; wider ones halve the level. Kernels of two texels distort
/// the filter's shape (`lantern-wall` .015 instead of .012); kernels of eight give the same with a tenth more lists.
const FINE_KERNEL_TEXELS: u32 = 4;

/// Options of the hierarchy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevelOptions {
    /// Number of texels along each side of the base.
    pub(crate) map_size: UVec2,
    /// Number of kernel sizes, including the base; bounded by a kernel as wide as the map.
    pub(crate) octaves: u32,
    /// Side in texels: levels halve while they have more than its square.
    pub(crate) stack_size: u32,
    /// Whether the stack halves again when kernels have many texels, and has a level between each two kernels.
    pub(crate) fine: bool,
    /// Number of first steps that keep one of four lists.
    pub(crate) subsampled_steps: u32,
    /// Number of samples per texel of the base.
    pub(crate) samples: u32,
}

/// Returns the levels of a base.
///
/// They halve down to the stack. From there on kernels grow by overlapping (figure 7): the first level of the stack has its
/// texels at the corners of the previous level, and so one more per side; each further level merges texels at twice the
/// distance. In a fine stack, a kernel shifted by a fourth of itself to either side makes one of 1.3 times its width, about
/// half-way to the next, and levels halve once kernels are four texels wide.
pub(crate) fn levels(options: &LevelOptions) -> Vec<Level> {
    let LevelOptions { map_size, octaves, fine, subsampled_steps, samples, .. } = *options;
    let mut levels: Vec<Level> = Vec::new();
    let mut grid = Grid { size: map_size, spacing: 1, is_stacked: false };
    // Index of the level of the last whole octave.
    let mut source = 0;
    for i in 0..octaves.min(MAX_OCTAVES) {
        let kernel = 1u32 << i;
        if i > 0 && kernel / 2 >= map_size.max_element() {
            break;
        }
        let step = (i > 0).then(|| grid.advance(i, options));
        let Grid { size, spacing, is_stacked } = grid;
        // Widths of the lookup and of the merged texels, for an area in squares of the kernel.
        let widths = |area: f32| {
            let merged_squared = area * (kernel as f32).powi(2) - 4f32.powi(subsampled_steps.min(i) as i32);
            (effective_width(merged_squared, spacing, samples), merged_squared.sqrt())
        };
        let (width, merged) = widths(1.0);
        let level = Level {
            first: 0,
            size,
            spacing: spacing as f32,
            offset: if is_stacked { 0.0 } else { 0.5 },
            octave: i as f32,
            width,
            merged,
            source,
            step,
            z_limit_m: f32::MAX,
        };
        source = levels.len();
        levels.push(level);
        if fine && is_stacked && i + 1 < octaves && kernel < map_size.max_element() {
            let fourth = (kernel / spacing / 4) as i32;
            // A fourth of a kernel of two texels is half a texel: the new texels lie between the old ones.
            let (near, far, size, offset) =
                if fourth == 0 { (-1, 0, size + 1, -0.5) } else { (-fourth, fourth, size, 0.0) };
            // Two positions at ¼ kernel from the middle have the variance of a square of √¾ kernels.
            let (width, merged) = widths(1.75);
            let step = Some(Step { stride: 1, near, far, subsample: false });
            levels.push(Level { size, offset, octave: i as f32 + 0.5, width, merged, source, step, ..level });
        }
    }
    let mut first = 0;
    for level in &mut levels {
        level.first = first;
        first += level.size.element_product();
    }
    levels
}

/// Texels of the last whole octave while levels are made.
#[derive(Clone, Copy)]
struct Grid {
    size: UVec2,
    /// Distance between texels, in texels of the base.
    spacing: u32,
    is_stacked: bool,
}

impl Grid {
    /// Advances to octave `i`, at least 1. Returns the merge step from the previous one.
    fn advance(&mut self, i: u32, options: &LevelOptions) -> Step {
        let kernel_texels = (1u32 << i) / self.spacing;
        // Half the distance between the merged texels, in texels of the previous level.
        let half = (kernel_texels / 4) as i32;
        if !self.is_stacked && self.size.element_product() > options.stack_size * options.stack_size {
            self.size = self.size.map(|texels| texels.div_ceil(2));
            self.spacing *= 2;
            Step { stride: 2, near: 0, far: 1, subsample: i <= options.subsampled_steps }
        } else if !self.is_stacked {
            self.is_stacked = true;
            self.size += UVec2::ONE;
            Step { stride: 1, near: -1, far: 0, subsample: false }
        } else if options.fine && kernel_texels > FINE_KERNEL_TEXELS {
            self.size = self.size.map(|texels| (texels - 1).div_ceil(2) + 1);
            self.spacing *= 2;
            Step { stride: 2, near: -half, far: half, subsample: false }
        } else {
            Step { stride: 1, near: -half, far: half, subsample: false }
        }
    }
}

/// Returns the side of the box with the variance of a level's lookup. The texels of a kernel, `2^subsampled_steps` apart, have
/// the variance (kernel² − 4^steps) / 12 = `merged_squared` / 12. The samples in a texel add theirs, and bilinear interpolation
/// between texels `spacing` apart adds a tent's, spacing² / 6. A box has width² / 12.
fn effective_width(merged_squared: f32, spacing: u32, samples: u32) -> f32 {
    let spacing = spacing as f32;
    // Four samples lie at ±1/8 and ±3/8 along either axis.
    let in_texel = if samples > 1 { 12.0 * 5.0 / 64.0 } else { 0.0 };
    (merged_squared + in_texel + 2.0 * spacing * spacing).sqrt()
}

/// Depths of receivers and occluders, and the filter widths between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthReach {
    pub(crate) perspective: bool,
    /// Smallest depth of an occluder, metres.
    pub(crate) near_m: f32,
    /// Largest depth of a receiver, metres.
    pub(crate) far_m: f32,
    /// Filter width per unit of g, in texels of the base.
    pub(crate) filter_per_g: f32,
}

impl DepthReach {
    /// Returns the depth at which the farthest receiver needs a filter of this width; others need it nearer to the light.
    fn z_of_filter(&self, width: f32) -> f32 {
        let g = width / self.filter_per_g;
        if self.perspective { 1.0 / (g + 1.0 / self.far_m) } else { self.far_m - g }
    }
}

/// Removes what no receiver looks up. A level serves depths up to the depth of the next finer level's filter. Surfaces beyond
/// that depth for the farthest receiver are never read; a level without nearer depths is never read at all.
pub(crate) fn prune_levels(levels: &mut Vec<Level>, reach: &DepthReach, epsilon: impl Fn(&Level) -> DepthTolerance) {
    let z_far: Vec<f32> =
        [0.0].into_iter().chain(levels.iter().map(|level| level.width)).map(|finer| reach.z_of_filter(finer)).collect();
    let needed = z_far.iter().skip(1).take_while(|z_far| **z_far > reach.near_m).count() + 1;
    levels.truncate(needed);
    // A surface extends ε beyond its nearest fragment, and its mean depth may lie there.
    let end_of_surface = |level: &Level, z: f32| {
        let epsilon = epsilon(level);
        z + epsilon.slope * z + epsilon.m
    };
    for (level, z_far) in levels.iter_mut().zip(z_far) {
        // The lookup continues for the surface that begins before z_far.
        level.z_limit_m = end_of_surface(level, z_far);
    }
    // A level keeps everything that the levels made from it need.
    for i in (1..levels.len()).rev() {
        let (source, limit) = (levels[i].source, end_of_surface(&levels[i], levels[i].z_limit_m));
        levels[source].z_limit_m = levels[source].z_limit_m.max(limit);
    }
}

/// Returns the number of lists of all levels.
pub(crate) fn list_count(levels: &[Level]) -> u32 {
    levels.iter().map(|level| level.size.element_product()).sum()
}

/// Rung of the lookup ladder: a level and the filter width that it is looked up for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rung {
    pub(crate) level: usize,
    /// Filter width for one part of the light, in texels of the base.
    pub(crate) filter: f32,
    /// Distance from the receiver's position within which lookups for any part of the light read, in texels of the base.
    pub(crate) reach: f32,
}

/// Returns one level for all depths; `count` starts from 1 and is clamped to the last level.
pub(crate) fn fixed_rung(levels: &[Level], count: u32) -> Rung {
    let level = (count.max(1) as usize).min(levels.len()) - 1;
    Rung { level, filter: 0.0, reach: levels[level].spacing + 0.5 * levels[level].kernel() }
}

/// Returns the rungs from the receiver towards the light: every level for its own filter width. If parts of the light are
/// looked up beside the receiver, a rung at the receiver itself precedes them: the base without a filter.
pub(crate) fn rungs(levels: &[Level], in_parts: bool) -> Vec<Rung> {
    let rung = |i: usize, filter: f32| {
        // Parts are looked up half their filter aside, lists lie up to a texel of the level away, and they merge half a kernel.
        let shift = if in_parts { 0.5 * filter } else { 0.0 };
        Rung { level: i, filter, reach: shift + levels[i].spacing + 0.5 * levels[i].kernel() }
    };
    let at_receiver = in_parts.then(|| rung(0, 0.0));
    let of_levels = levels.iter().enumerate().map(|(i, level)| rung(i, level.width));
    at_receiver.into_iter().chain(of_levels).collect()
}
