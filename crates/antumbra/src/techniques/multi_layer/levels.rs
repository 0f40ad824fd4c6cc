//! The levels: where their lists lie, how each is made from the one before, and how much its lookup blurs.

use glam::UVec2;

/// One level. Level 0 is the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Level {
    /// Its first entry among the lists.
    pub(crate) first: u32,
    /// Texels along each side.
    pub(crate) size: UVec2,
    /// Distance of its texels, in texels of the base.
    pub(crate) spacing: f32,
    /// Texel (x, y) lies at (x + offset, y + offset) · spacing in the base: ½ where levels halve, 0 in the stack.
    pub(crate) offset: f32,
    /// Side of the box that blurs as much as the level's bilinear lookup, in texels of the base.
    pub(crate) width: f32,
    /// How it merges the level before; `None` for the base.
    pub(crate) step: Option<Step>,
}

/// Which four lists of the level before a texel merges: `stride · texel + {near, far}` in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    pub(crate) stride: u32,
    pub(crate) near: i32,
    pub(crate) far: i32,
    /// Take one of the four as it is.
    pub(crate) subsample: bool,
}

/// The most levels: a base of 8192 texels a side halved to one.
pub(crate) const MAX_LEVELS: usize = 14;

/// The levels of a base of `map_size` texels, at most `count` and at most down to a kernel as wide as the map.
///
/// Halving goes on while a level has more than `stack_size`² texels. From there on kernels grow by overlapping (figure 7): the
/// first level of the stack has its texels at the corners of the level before, and so one more a side; each further one
/// merges texels at twice the distance.
pub(crate) fn levels(map_size: UVec2, count: u32, stack_size: u32, subsampled_steps: u32, samples: u32) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    let (mut first, mut size, mut spacing) = (0, map_size, 1);
    // Levels of the stack so far.
    let mut stacked = 0;
    let kernel_of = |i: u32| 1u32 << i;
    for i in 0..count.min(MAX_LEVELS as u32) {
        if i > 0 && kernel_of(i - 1) >= map_size.max_element() {
            break;
        }
        let mut step = None;
        if i > 0 && stacked == 0 && size.element_product() > stack_size * stack_size {
            step = Some(Step { stride: 2, near: 0, far: 1, subsample: i <= subsampled_steps });
            size = size.map(|texels| texels.div_ceil(2));
            spacing *= 2;
        } else if i > 0 {
            stacked += 1;
            // Half the kernel of the level before, in texels: what lies on either side of the corner.
            let half = (kernel_of(i) / spacing / 4) as i32;
            step = Some(if stacked == 1 {
                size += UVec2::ONE;
                Step { stride: 1, near: -1, far: 0, subsample: false }
            } else {
                Step { stride: 1, near: -half, far: half, subsample: false }
            });
        }
        levels.push(Level {
            first,
            size,
            spacing: spacing as f32,
            offset: if stacked == 0 { 0.5 } else { 0.0 },
            width: effective_width(kernel_of(i), spacing, subsampled_steps.min(i), samples),
            step,
        });
        first += size.element_product();
    }
    levels
}

/// A square of `kernel`² texels, `2^subsampled_steps` apart, has the variance of their places, (kernel² − 4^steps) / 12,
/// and that of the samples in a texel; looking it up bilinearly between texels `spacing` apart adds a tent's,
/// spacing² / 6. A box has width² / 12.
fn effective_width(kernel: u32, spacing: u32, subsampled_steps: u32, samples: u32) -> f32 {
    let (kernel, spacing) = (kernel as f32, spacing as f32);
    // Four samples lie at ±1/8 and ±3/8 along either axis.
    let in_texel = if samples > 1 { 12.0 * 5.0 / 64.0 } else { 0.0 };
    (kernel * kernel - 4f32.powi(subsampled_steps as i32) + in_texel + 2.0 * spacing * spacing).sqrt()
}

/// How many lists all levels have.
pub(crate) fn list_count(levels: &[Level]) -> u32 {
    levels.iter().map(|level| level.size.element_product()).sum()
}
