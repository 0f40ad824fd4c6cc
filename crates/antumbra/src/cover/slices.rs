//! A sun over a world: what the camera sees, in slices along its view, each of which has maps of its own.
//!
//! A map of all that a camera sees has texels as wide as the farthest receivers want them, which is far too wide for what
//! is near. In a slice from depth `a` to depth `b` a map's texel covers about `b / a` times as many pixels at the near end
//! as at the far one, so ends that grow by one ratio waste the least (Zhang, Sun, Xu, Lun, "Parallel-split shadow maps for
//! large-scale virtual environments", VRCIA 2006; Lloyd, Govindaraju, Quammen, Molnar, Manocha, "Logarithmic perspective
//! shadow maps", TOG 27(4), 2008), and where they begin is best taken from what is seen (Lauritzen, Salvi, Lefohn, "Sample
//! distribution shadow maps", I3D 2011).
//!
//! Ends that followed what is seen to the centimetre would lie elsewhere in every frame of a walk. They are
//! [`ONE_END_M`] times the powers of [`SLICE_RATIO`], and what is seen says which of them there are: so an end never moves
//! along the view, and one that comes or goes does so at one end of what is seen, where hardly any pixel is. Those that were
//! there in the frame before are left out a little later than others are taken in.

use antumbra_light::Light;
use glam::{Vec2, Vec3};

use super::region::Region;
use crate::contract::PreparedReceivers;

/// Depths within this ratio need no slices.
const WORTH_SLICES: f32 = 16.0;

/// How much deeper a slice ends than it begins. Less gives more slices, whose far ends have no finer texels.
pub(super) const SLICE_RATIO: f32 = 2.5;

/// Where one of the slices ends, metres: others at 9.1, 23, 143, 356.
pub(super) const ONE_END_M: f32 = 57.0;

/// What is nearer than this part of the farthest receiver is in the first slice: there are eight of them at most within two
/// kilometres.
const NEAREST_SHARE: f32 = 1.0 / 512.0;

/// But the first slice begins no farther than this, metres: a world's bounds may reach anywhere, and what is seen of it is near.
const FARTHEST_BEGIN_M: f32 = 4.0;

/// Where nothing is known of what is seen, little is taken to be nearer than this, metres.
const USUALLY_NEAREST_M: f32 = 0.5;

/// The part of the points seen that may be nearer than where slices begin.
const LEFT_NEARER: f32 = 0.01;

/// A map of usual size has so many texels along a side.
const USUAL_TEXELS: f32 = 1024.0;

/// Texels of one map are small enough where they are no wider than so many pixels at the end of a slice that began at the
/// nearest that is seen.
const FINE_PIXELS: f32 = 2.0;

/// What there was in the frame before stays until what asks for it has changed by this factor.
const STAYS_FOR: f32 = 1.25;

/// Where slices end: at the powers of [`SLICE_RATIO`] from `first` to `last`, times [`ONE_END_M`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SliceEnds {
    first: i32,
    last: i32,
}

impl SliceEnds {
    /// Whether there is one at this power.
    fn has(self, power: i32) -> bool {
        (self.first..=self.last).contains(&power)
    }

    /// The ends between two depths; `None` where there is none. Those of the frame before are kept as long as they lie
    /// between, others are taken once they do by far.
    fn between(from: f32, to: f32, before: Option<Self>) -> Option<Self> {
        let is_between = |power: &i32| {
            let end = end_m(*power);
            let room = if before.is_some_and(|before| before.has(*power)) { 1.0 } else { STAYS_FOR };
            from * room < end && end * room < to
        };
        let power = |depth: f32| (depth / ONE_END_M).log(SLICE_RATIO).floor() as i32;
        let mut powers = (power(from)..=power(to)).filter(is_between);
        let first = powers.next()?;
        Some(Self { first, last: powers.next_back().unwrap_or(first) })
    }
}

/// A slice.
#[derive(Clone, Debug)]
pub(super) struct Slice {
    /// The same for what lies between the same depths.
    pub(super) id: u32,
    pub(super) region: Region,
}

/// The slices, from near to far; none where one map does as well. `corners` span all receivers, `ends` are those of the
/// frame before, and then of this one. Points, which no camera sees, have none.
pub(super) fn slices_of(
    sun: &Light,
    receivers: &PreparedReceivers<'_>,
    corners: &[Vec3],
    ends: &mut Option<SliceEnds>,
) -> Vec<Slice> {
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
    let Some(found) = SliceEnds::between(from, to, before) else { return Vec::new() };
    let pixel_at_1m = 2.0 / (camera.clip_from_view.y_axis.y.abs() * receivers.size_px.y as f32);
    let pixels_m = FINE_PIXELS * pixel_at_1m * SLICE_RATIO * from;
    if width_across(sun, corners) * stays_for / USUAL_TEXELS <= pixels_m {
        return Vec::new();
    }
    *ends = Some(found);
    let beyond = |power: i32| forward.extend(-end_m(power));
    // The first holds all that is nearer, the last all that is farther.
    let slice = |power: i32| {
        let begins = found.has(power).then(|| beyond(power));
        let ends = found.has(power + 1).then(|| -beyond(power + 1));
        let planes = begins.into_iter().chain(ends).collect();
        Slice { id: (power - LEAST_POWER) as u32, region: Region::of_planes(eye, planes) }
    };
    (found.first - 1..=found.last).map(slice).collect()
}

/// Where the slices of a power end.
fn end_m(power: i32) -> f32 {
    ONE_END_M * SLICE_RATIO.powi(power)
}

/// Below the power of any depth in single precision.
const LEAST_POWER: i32 = -128;

/// From which depth to which there are receivers, but for few that are nearer. `corners` span them all.
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

/// The longer side of a map that holds some points.
fn width_across(sun: &Light, points: &[Vec3]) -> f32 {
    let frame = sun.frame();
    let (min, max) = points.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), x| {
        let at = Vec2::new(x.dot(frame.right), x.dot(frame.up));
        (min.min(at), max.max(at))
    });
    (max - min).max_element()
}
