//! A sun over a world: what the camera sees, in slices along its view, each of which has maps of its own.
//!
//! A map of all that a camera sees has texels as wide as the farthest receivers want them, which is far too wide for what
//! is near. In a slice from depth `a` to depth `b` a map's texel covers about `b / a` times as many pixels at the near end
//! as at the far one, so ends that grow by one ratio waste the least (Zhang, Sun, Xu, Lun, "Parallel-split shadow maps for
//! large-scale virtual environments", VRCIA 2006; Lloyd, Govindaraju, Quammen, Molnar, Manocha, "Logarithmic perspective
//! shadow maps", TOG 27(4), 2008), and where they begin is best taken from what is seen (Lauritzen, Salvi, Lefohn, "Sample
//! distribution shadow maps", I3D 2011).

use antumbra_light::Light;
use glam::{Vec2, Vec3, Vec4};

use super::region::Region;
use crate::contract::Receivers;

/// Depths within this ratio need no slices.
const WORTH_SLICES: f32 = 16.0;

/// How much deeper a slice ends than it begins, at most.
const SLICE_RATIO: f32 = 4.0;

const MOST_SLICES: u32 = 6;

/// What is nearer than this part of the farthest receiver is in the first slice.
const NEAREST_SHARE: f32 = 1.0 / 512.0;

/// Where nothing is known of what is seen, little is taken to be nearer than this, metres.
const USUALLY_NEAREST_M: f32 = 0.5;

/// The part of the points seen that may be nearer than where slices begin.
const LEFT_NEARER: f32 = 0.01;

/// A map of usual size has so many texels along a side.
const USUAL_TEXELS: f32 = 1024.0;

/// Texels of one map are small enough where they are no wider than so many pixels at the end of the first slice.
const FINE_PIXELS: f32 = 2.0;

/// The regions of slices, from near to far; none where one map does as well. `corners` span all receivers.
pub(super) fn slices_of(sun: &Light, receivers: &Receivers<'_>, corners: &[Vec3]) -> Vec<Region> {
    let eye = receivers.eye_in_world().as_vec3();
    // The camera looks along −z, and its matrix is rigid.
    let forward = -receivers.view_from_world.row(2).truncate().normalize_or_zero();
    let is_perspective = receivers.clip_from_view.row(3).w == 0.0;
    if !is_perspective || forward == Vec3::ZERO {
        return Vec::new();
    }
    let depth = |x: &Vec3| (*x - eye).dot(forward);
    let (nearest, farthest) =
        corners.iter().map(depth).fold((f32::INFINITY, 0.0f32), |(low, high), depth| (low.min(depth), high.max(depth)));
    let mut seen: Vec<f32> = receivers.seen.iter().map(depth).collect();
    seen.sort_unstable_by(f32::total_cmp);
    let first_seen = seen.get((LEFT_NEARER * seen.len() as f32) as usize).copied();
    let from = first_seen.unwrap_or(nearest.max(USUALLY_NEAREST_M)).max(NEAREST_SHARE * farthest);
    let ratio = farthest / from;
    if !(ratio > WORTH_SLICES && ratio.is_finite()) {
        return Vec::new();
    }
    let count = (ratio.log2() / SLICE_RATIO.log2()).ceil().clamp(2.0, MOST_SLICES as f32);
    let pixel_at_1m = 2.0 / (receivers.clip_from_view.y_axis.y.abs() * receivers.size_px.y as f32);
    let first_end = from * ratio.powf(1.0 / count);
    if width_across(sun, corners) / USUAL_TEXELS <= FINE_PIXELS * pixel_at_1m * first_end {
        return Vec::new();
    }
    let ends: Vec<f32> = (1..count as u32).map(|i| from * ratio.powf(i as f32 / count)).collect();
    let beyond = |end: f32| forward.extend(-end);
    // The first holds all that is nearer, the last all that is farther.
    let first = ends.first().map(|end| vec![-beyond(*end)]);
    let between = ends.windows(2).map(|pair| vec![beyond(pair[0]), -beyond(pair[1])]);
    let last = ends.last().map(|end| vec![beyond(*end)]);
    let planes: Vec<Vec<Vec4>> = first.into_iter().chain(between).chain(last).collect();
    planes.into_iter().map(|planes| Region::of_planes(eye, planes)).collect()
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
