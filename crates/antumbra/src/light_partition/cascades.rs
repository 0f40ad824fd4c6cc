//! Cascades of a sun: ranges of depth along the camera's view, each with maps of its own.
//!
//! A single map of all that a camera sees has texels as wide as the farthest receivers need, which is far too wide for near
//! ones. In a cascade from depth `a` to depth `b` a map's texel covers about `b / a` times as many pixels at the near end
//! as at the far one, so ends with a constant ratio waste the least (Zhang, Sun, Xu, Lun, "Parallel-split shadow maps for
//! large-scale virtual environments", VRCIA 2006; Lloyd, Govindaraju, Quammen, Molnar, Manocha, "Logarithmic perspective
//! shadow maps", TOG 27(4), 2008). Their first depth is best taken from the seen points (Lauritzen, Salvi, Lefohn, "Sample
//! distribution shadow maps", I3D 2011).
//!
//! Ends that followed the seen points exactly would move in every frame of a walk. Instead, ends are [`ONE_END_M`] times
//! the powers of [`CASCADE_RATIO`], and the seen points only select the powers: an end never moves along the view, and it
//! appears or disappears only at the nearest or farthest seen depth, where there are hardly any pixels. With hysteresis,
//! ends of the previous frame are dropped later than new ones are added.

use antumbra_light::Light;
use glam::{Vec2, Vec3};

use super::region::Region;
use crate::contract::PreparedReceivers;

/// Ratio of the farthest to the nearest depth up to which there are no cascades.
const WORTH_SLICES: f32 = 16.0;

/// Ratio of a cascade's far to its near depth. A smaller one gives more cascades, without finer texels at their far ends.
pub(super) const CASCADE_RATIO: f32 = 2.5;

/// Depth of one end of cascades, metres; others are at 9.1, 23, 143, 356.
pub(super) const ONE_END_M: f32 = 57.0;

/// Depth, as a fraction of the farthest receiver's, below which everything is in the first cascade: so there are at most eight
/// within two kilometres.
const NEAREST_SHARE: f32 = 1.0 / 512.0;

/// Upper limit of that depth, metres: a world's bounds may be arbitrarily large while the receivers that are seen are near.
const FARTHEST_BEGIN_M: f32 = 4.0;

/// Assumed nearest depth if no seen points are known, metres.
const USUALLY_NEAREST_M: f32 = 0.5;

/// Fraction of the seen points that may be nearer than the nearest depth of cascades.
const LEFT_NEARER: f32 = 0.01;

/// Texels along a side of a map of usual size.
const USUAL_TEXELS: f32 = 1024.0;

/// Largest texel width for which a single map suffices, in pixels at the far end of a cascade that begins at the nearest seen
/// depth.
const FINE_PIXELS: f32 = 2.0;

/// Hysteresis: cascades and ends of the previous frame are kept until the quantity that requires them has changed by this factor.
const STAYS_FOR: f32 = 1.25;

/// Ends of cascades: the powers of [`CASCADE_RATIO`] from `first` to `last`, times [`ONE_END_M`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CascadeEnds {
    first: i32,
    last: i32,
}

impl CascadeEnds {
    /// Whether there is an end at this power.
    fn has(self, power: i32) -> bool {
        (self.first..=self.last).contains(&power)
    }

    /// Returns the ends between two depths, or `None` if there are none. Ends of the previous frame are kept while they lie
    /// between the depths; new ones must do so by the factor [`STAYS_FOR`].
    fn between(from: f32, to: f32, before: Option<Self>) -> Option<Self> {
        let is_between = |power: &i32| {
            let end = end_m(*power);
            let room = if before.is_some_and(|before| before.has(*power)) { 1.0 } else { STAYS_FOR };
            from * room < end && end * room < to
        };
        let power = |depth: f32| (depth / ONE_END_M).log(CASCADE_RATIO).floor() as i32;
        let mut powers = (power(from)..=power(to)).filter(is_between);
        let first = powers.next()?;
        Some(Self { first, last: powers.next_back().unwrap_or(first) })
    }
}

/// One cascade.
#[derive(Clone, Debug)]
pub(super) struct Cascade {
    /// Identifier, which depends only on the depth range.
    pub(super) id: u32,
    pub(super) region: Region,
}

/// Returns the cascades from near to far; none if a single map suffices, or for points without a camera. `corners` span all
/// receivers. `ends` are those of the previous frame, and are replaced by this frame's.
pub(super) fn cascades_of(
    sun: &Light,
    receivers: &PreparedReceivers<'_>,
    corners: &[Vec3],
    ends: &mut Option<CascadeEnds>,
) -> Vec<Cascade> {
    let before = ends.take();
    let Some(camera) = receivers.camera() else { return Vec::new() };
    let eye = camera.eye_in_world().as_vec3();
    // The camera looks along −z, and its matrix is rigid.
    let forward = -camera.view_from_world.row(2).truncate().normalize_or_zero();
    let is_perspective = camera.clip_from_view.row(3).w == 0.0;
    if !is_perspective || forward == Vec3::ZERO {
        return Vec::new();
    }
    let (from, to) = depths_of(receivers, corners, eye, forward);
    let ratio = to / from;
    let stays_for = if before.is_some() { STAYS_FOR } else { 1.0 };
    if !(ratio * stays_for > WORTH_SLICES && ratio.is_finite()) {
        return Vec::new();
    }
    let Some(found) = CascadeEnds::between(from, to, before) else { return Vec::new() };
    let pixel_at_1m = 2.0 / (camera.clip_from_view.y_axis.y.abs() * receivers.size_px.y as f32);
    let pixels_m = FINE_PIXELS * pixel_at_1m * CASCADE_RATIO * from;
    if width_across(sun, corners) * stays_for / USUAL_TEXELS <= pixels_m {
        return Vec::new();
    }
    *ends = Some(found);
    let beyond = |power: i32| forward.extend(-end_m(power));
    // The first cascade also contains all that is nearer, the last all that is farther.
    let cascade = |power: i32| {
        let begins = found.has(power).then(|| beyond(power));
        let ends = found.has(power + 1).then(|| -beyond(power + 1));
        let planes = begins.into_iter().chain(ends).collect();
        Cascade { id: (power - MIN_POWER) as u32, region: Region::of_planes(eye, planes) }
    };
    (found.first - 1..=found.last).map(cascade).collect()
}

/// Depth of the end at a power, metres.
fn end_m(power: i32) -> f32 {
    ONE_END_M * CASCADE_RATIO.powi(power)
}

/// Power below that of any depth in single precision.
const MIN_POWER: i32 = -128;

/// Returns the nearest and farthest depth of receivers, metres, without a few nearer ones. `corners` span all receivers.
fn depths_of(receivers: &PreparedReceivers<'_>, corners: &[Vec3], eye: Vec3, forward: Vec3) -> (f32, f32) {
    let depth = |x: &Vec3| (*x - eye).dot(forward);
    let (nearest, farthest) =
        corners.iter().map(depth).fold((f32::INFINITY, 0.0f32), |(low, high), depth| (low.min(depth), high.max(depth)));
    let mut seen: Vec<f32> = receivers.seen.iter().map(depth).collect();
    seen.sort_unstable_by(f32::total_cmp);
    let least = (NEAREST_SHARE * farthest).min(FARTHEST_BEGIN_M);
    let first_seen = seen.get((LEFT_NEARER * seen.len() as f32) as usize).copied();
    (first_seen.unwrap_or(nearest.max(USUALLY_NEAREST_M)).max(least), farthest)
}

/// Longer side of a map that contains `points`, metres.
fn width_across(sun: &Light, points: &[Vec3]) -> f32 {
    let frame = sun.frame();
    let (min, max) = points.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), x| {
        let at = Vec2::new(x.dot(frame.right), x.dot(frame.up));
        (min.min(at), max.max(at))
    });
    (max - min).max_element()
}
