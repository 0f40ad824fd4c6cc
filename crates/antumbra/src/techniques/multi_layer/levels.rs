//! The levels: where their lists lie, how each is made from the one before, and how much its lookup blurs.

use glam::UVec2;

use crate::light_map::texel_lists::options::DepthTolerance;

/// One level. Level 0 is the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Level {
    /// Its first entry among the lists.
    pub(crate) first: u32,
    /// Texels along each side.
    pub(crate) size: UVec2,
    /// Distance of its texels, in texels of the base.
    pub(crate) spacing: f32,
    /// Texel (x, y) lies at (x + offset, y + offset) · spacing in the base: ½ where levels halve, 0 in the stack, −½ where
    /// its first kernel is shifted.
    pub(crate) offset: f32,
    /// Side of the box that blurs as much as the level's bilinear lookup, in texels of the base.
    pub(crate) width: f32,
    /// Side of the box that is spread as the texels which a list merges, in texels of the base: 0 of one.
    pub(crate) merged: f32,
    /// How often its kernel has doubled.
    pub(crate) octave: f32,
    /// The level that it merges.
    pub(crate) source: usize,
    /// How it merges that level; `None` for the base.
    pub(crate) step: Option<Step>,
    /// Surfaces that begin beyond this depth are left out, since no receiver looks them up in the level.
    pub(crate) z_limit_m: f32,
}

impl Level {
    /// Side of what a list merges texels of, in texels of the base.
    pub(crate) fn kernel(&self) -> f32 {
        self.octave.floor().exp2() * (1.0 + self.octave.fract())
    }
}

/// Which four lists of its source a texel merges: `stride · texel + {near, far}` in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    pub(crate) stride: u32,
    pub(crate) near: i32,
    pub(crate) far: i32,
    /// Take one of the four as it is.
    pub(crate) subsample: bool,
}

/// The most doublings of kernels, the base among them: a base of 8192 texels a side halved to one.
pub(crate) const MAX_OCTAVES: u32 = 14;

/// Kernels of a fine stack are at most so many texels wide; beyond that its levels have fewer. Kernels of two texels miss
/// their shape (`lantern-wall` .015 instead of .012); of eight, a tenth more lists give the same.
const FINE_KERNEL_TEXELS: u32 = 4;

/// What levels to make.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevelOptions {
    /// Texels along each side of the base.
    pub(crate) map_size: UVec2,
    /// How often kernels double, the base counted; at most down to a kernel as wide as the map.
    pub(crate) octaves: u32,
    /// Levels halve while they have more than the square of this many texels.
    pub(crate) stack_size: u32,
    /// The stack halves again where kernels have many texels, and has a level between each two kernels.
    pub(crate) fine: bool,
    /// First steps that keep one of four lists.
    pub(crate) subsampled_steps: u32,
    /// Of a texel of the base.
    pub(crate) samples: u32,
}

/// The levels of a base.
///
/// They halve down to the stack. From there on kernels grow by overlapping (figure 7): the first level of the stack has
/// its texels at the corners of the level before, and so one more a side; each further one merges texels at twice the
/// distance. In a fine stack, a kernel shifted by a fourth of itself to either side makes one of 1.3 times its width,
/// about half-way to the next, and levels halve once kernels are four texels wide.
pub(crate) fn levels(options: &LevelOptions) -> Vec<Level> {
    let LevelOptions { map_size, octaves, stack_size, fine, subsampled_steps, samples } = *options;
    let mut levels: Vec<Level> = Vec::new();
    // Of the level of the last whole octave.
    let (mut size, mut spacing, mut source) = (map_size, 1, 0);
    let mut first = 0;
    let mut is_stacked = false;
    let mut push = |levels: &mut Vec<Level>, level: Level| {
        levels.push(Level { first, ..level });
        first += level.size.element_product();
    };
    for i in 0..octaves.min(MAX_OCTAVES) {
        let kernel = 1u32 << i;
        if i > 0 && kernel / 2 >= map_size.max_element() {
            break;
        }
        // Half the distance of what is merged, in texels of the level before.
        let half = (kernel / spacing / 4) as i32;
        let step = if i == 0 {
            None
        } else if !is_stacked && size.element_product() > stack_size * stack_size {
            size = size.map(|texels| texels.div_ceil(2));
            spacing *= 2;
            Some(Step { stride: 2, near: 0, far: 1, subsample: i <= subsampled_steps })
        } else if !is_stacked {
            is_stacked = true;
            size += UVec2::ONE;
            Some(Step { stride: 1, near: -1, far: 0, subsample: false })
        } else if fine && kernel / spacing > FINE_KERNEL_TEXELS {
            size = size.map(|texels| (texels - 1).div_ceil(2) + 1);
            spacing *= 2;
            Some(Step { stride: 2, near: -half, far: half, subsample: false })
        } else {
            Some(Step { stride: 1, near: -half, far: half, subsample: false })
        };
        let merged_squared = |kernel_squared: f32| kernel_squared - 4f32.powi(subsampled_steps.min(i) as i32);
        let whole = merged_squared((kernel as f32).powi(2));
        let level = Level {
            first: 0,
            size,
            spacing: spacing as f32,
            offset: if is_stacked { 0.0 } else { 0.5 },
            octave: i as f32,
            width: effective_width(whole, spacing, samples),
            merged: whole.sqrt(),
            source,
            step,
            z_limit_m: f32::MAX,
        };
        source = levels.len();
        push(&mut levels, level);
        if fine && is_stacked && i + 1 < octaves && kernel < map_size.max_element() {
            let fourth = (kernel / spacing / 4) as i32;
            // A fourth of a kernel of two texels is half of one: texels lie between those of the kernel.
            let (near, far, size, offset) =
                if fourth == 0 { (-1, 0, size + 1, -0.5) } else { (-fourth, fourth, size, 0.0) };
            // Two places ¼ kernel from the middle have the variance of a square of √¾ kernels.
            let squared = merged_squared(1.75 * (kernel as f32).powi(2));
            let width = effective_width(squared, spacing, samples);
            let step = Some(Step { stride: 1, near, far, subsample: false });
            push(
                &mut levels,
                Level { size, offset, octave: i as f32 + 0.5, width, merged: squared.sqrt(), source, step, ..level },
            );
        }
    }
    levels
}

/// A kernel that blurs as a square of so many texels, `2^subsampled_steps` apart, has the variance of their places,
/// (kernel² − 4^steps) / 12 = `merged_squared` / 12, and that of the samples in a texel; looking it up bilinearly between texels
/// `spacing` apart adds a tent's, spacing² / 6. A box has width² / 12.
fn effective_width(merged_squared: f32, spacing: u32, samples: u32) -> f32 {
    let spacing = spacing as f32;
    // Four samples lie at ±1/8 and ±3/8 along either axis.
    let in_texel = if samples > 1 { 12.0 * 5.0 / 64.0 } else { 0.0 };
    (merged_squared + in_texel + 2.0 * spacing * spacing).sqrt()
}

/// What depths receivers and occluders may have, and what filter lies between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthReach {
    pub(crate) perspective: bool,
    /// No occluder is nearer.
    pub(crate) near_m: f32,
    /// No receiver is farther.
    pub(crate) far_m: f32,
    /// A filter's width, in texels of the base, for each unit of g.
    pub(crate) filter_per_g: f32,
}

impl DepthReach {
    /// The depth at which the farthest receiver asks for a filter of this width; all others ask for it nearer to the light.
    fn z_of_filter(&self, width: f32) -> f32 {
        let g = width / self.filter_per_g;
        if self.perspective { 1.0 / (g + 1.0 / self.far_m) } else { self.far_m - g }
    }
}

/// Leaves out what no receiver looks up. A level serves depths up to the one for which the next finer level's filter is
/// asked for: what lies beyond that of the farthest receiver is never read, nor is any of a level where nothing is nearer.
pub(crate) fn keep_what_is_looked_up(
    levels: &mut Vec<Level>,
    reach: &DepthReach,
    epsilon: impl Fn(&Level) -> DepthTolerance,
) {
    let z_far: Vec<f32> =
        [0.0].into_iter().chain(levels.iter().map(|level| level.width)).map(|finer| reach.z_of_filter(finer)).collect();
    let needed = z_far.iter().skip(1).take_while(|z_far| **z_far > reach.near_m).count() + 1;
    levels.truncate(needed);
    // A surface reaches ε beyond its nearest fragment, where its mean depth may lie.
    let end_of_surface = |level: &Level, z: f32| {
        let epsilon = epsilon(level);
        z + epsilon.slope * z + epsilon.m
    };
    for (level, z_far) in levels.iter_mut().zip(z_far) {
        // The lookup reads on for the surface that begins before z_far.
        level.z_limit_m = end_of_surface(level, z_far);
    }
    // A level has all that those made from it need.
    for i in (1..levels.len()).rev() {
        let (source, limit) = (levels[i].source, end_of_surface(&levels[i], levels[i].z_limit_m));
        levels[source].z_limit_m = levels[source].z_limit_m.max(limit);
    }
}

/// How many lists all levels have.
pub(crate) fn list_count(levels: &[Level]) -> u32 {
    levels.iter().map(|level| level.size.element_product()).sum()
}

/// A level, and the filter that it is looked up for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rung {
    pub(crate) level: usize,
    /// Its width, in texels of the base, for one part of the light.
    pub(crate) filter: f32,
    /// How far from the receiver's place lookups for any part of the light read, in texels of the base.
    pub(crate) reach: f32,
}

/// One level for all depths, counted from 1; the last where there are fewer.
pub(crate) fn fixed_rung(levels: &[Level], count: u32) -> Rung {
    let level = (count.max(1) as usize).min(levels.len()) - 1;
    Rung { level, filter: 0.0, reach: levels[level].spacing + 0.5 * levels[level].kernel() }
}

/// What is looked up, from the receiver towards the light: every level for the filter that it is, and before them, where
/// parts of the light look past the receiver at one side, the base for none, just there.
pub(crate) fn rungs(levels: &[Level], in_parts: bool) -> Vec<Rung> {
    let rung = |i: usize, filter: f32| {
        // Parts look past the receiver by half their filters, lists lie up to a texel of the level away, and merge half a
        // kernel.
        let shift = if in_parts { 0.5 * filter } else { 0.0 };
        Rung { level: i, filter, reach: shift + levels[i].spacing + 0.5 * levels[i].kernel() }
    };
    let at_receiver = in_parts.then(|| rung(0, 0.0));
    let of_levels = levels.iter().enumerate().map(|(i, level)| rung(i, level.width));
    at_receiver.into_iter().chain(of_levels).collect()
}
