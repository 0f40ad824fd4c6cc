//! Windows of the light's map with straight edges, as rasterisation needs: one towards the receivers, or a cube about
//! the light.

use std::f32::consts::FRAC_1_SQRT_2;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3, Vec4};

use crate::contract::PreparedReceivers;

use super::light_points::{LocalPoint, box_along, box_of};

/// Windows as seen from the light's centre; see `windows.wesl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Windows {
    /// Number of windows: 1, or the 6 of a cube.
    pub(crate) count: u32,
    /// Right, up and depth axis of the first window, in the world.
    pub(crate) axes: [Vec3; 3],
    /// Box of the light's points along these axes, about the light's centre; for a sun, of directions.
    pub(crate) light: Aabb,
    /// Centre and semi-axes of an ellipsoid that contains the light, along these axes about its centre; for a sun, of directions.
    pub(crate) ellipsoid: [Vec4; 4],
}

/// Least semi-axis of a light's ellipsoid, relative to the largest.
const FLATTEST: f32 = 1e-3;

/// Largest tangent off its centre that one window covers: beyond, texels at its edge are far smaller than at its centre.
const MAX_TANGENT: f32 = 2.0;

impl Windows {
    pub(crate) fn towards(
        receivers: &PreparedReceivers<'_>,
        light: &Light,
        points: &[LocalPoint],
        is_turned: bool,
    ) -> Self {
        let frame = light.frame();
        let (count, axes) = if light.is_distant() {
            (1, [frame.right, frame.up, frame.axis])
        } else {
            match axis_to(receivers, frame.center) {
                Some(axis) => {
                    let (right, up) = axis.any_orthonormal_pair();
                    (1, [right, up, axis])
                }
                None => (6, [frame.right, frame.up, frame.axis]),
            }
        };
        let origin = if light.is_distant() { Vec3::ZERO } else { frame.center };
        let light_box = box_along(light, points, is_turned, axes, origin);
        Self { count, axes, light: light_box, ellipsoid: ellipsoid_along(light, points, axes) }
    }
}

/// Returns an ellipsoid that contains the light, which the paper takes for the light. The one of least volume about a box has
/// semi-axes of √3 times its half sides, the one of least area about a rectangle √2 times.
fn ellipsoid_along(light: &Light, points: &[LocalPoint], axes: [Vec3; 3]) -> [Vec4; 4] {
    let frame = light.frame();
    let along = |v: Vec3| Vec3::from(axes.map(|axis| axis.dot(v)));
    let (center, semi_axes_m) = match &light.shape {
        LightShape::Rectangle { size_m } => (Vec3::ZERO, (FRAC_1_SQRT_2 * *size_m).extend(0.0)),
        LightShape::Disk { radius_m } => (Vec3::ZERO, Vec3::new(*radius_m, *radius_m, 0.0)),
        LightShape::Sphere { radius_m } => (Vec3::ZERO, Vec3::splat(*radius_m)),
        LightShape::Ellipsoid { radii_m } => (Vec3::ZERO, *radii_m),
        LightShape::Sun { .. } => (-frame.axis, Vec2::splat(light.bounding_radius()).extend(0.0)),
        LightShape::Points { .. } => {
            let (middle, half) = box_of(points);
            let middle = frame.right * middle.x + frame.up * middle.y + frame.axis * middle.z;
            (middle, 3f32.sqrt() * half)
        }
    };
    // It must not be flat, because it is scaled to a sphere; the margin covers the points' single-precision rounding.
    let least = (FLATTEST * semi_axes_m.max_element()).max(f32::MIN_POSITIVE.sqrt());
    let semi_axes_m = (1.0 + 1e-5) * semi_axes_m.max(Vec3::splat(least));
    let frame_axes = [frame.right * semi_axes_m.x, frame.up * semi_axes_m.y, frame.axis * semi_axes_m.z];
    [center, frame_axes[0], frame_axes[1], frame_axes[2]].map(|v| along(v).extend(0.0))
}

/// Returns the mean direction from a point to all receivers, if one window can cover them.
fn axis_to(receivers: &PreparedReceivers<'_>, from: Vec3) -> Option<Vec3> {
    let corners = match receivers.bounds {
        _ if !receivers.hull.is_empty() => receivers.hull.to_vec(),
        Some(bounds) => bounds.corners().to_vec(),
        None => return None,
    };
    let directions: Vec<Vec3> = corners.iter().map(|corner| (corner - from).normalize_or_zero()).collect();
    let axis = directions.iter().sum::<Vec3>().try_normalize()?;
    let is_inside = |direction: &Vec3| {
        let depth = direction.dot(axis);
        depth > 0.0 && (direction - depth * axis).length() < MAX_TANGENT * depth
    };
    directions.iter().all(is_inside).then_some(axis)
}
