//! Where the light's map has straight edges, as rasterised triangles need: one window towards the receivers, or a cube
//! about the light.

use std::f32::consts::FRAC_1_SQRT_2;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3, Vec4};

use crate::contract::PreparedReceivers;

use super::light_points::{LocalPoint, box_along, box_of};

/// Windows from the light's centre; see `windows.wesl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Windows {
    /// 1, or the 6 of a cube.
    pub(crate) count: u32,
    /// Right, up and depth of the first, in the world.
    pub(crate) axes: [Vec3; 3],
    /// Box of the light's points along these, about the light's centre; of a sun's directions.
    pub(crate) light: Aabb,
    /// Centre and semi-axes along these, about the light's centre, of an ellipsoid that holds it; of a sun's directions.
    pub(crate) ellipsoid: [Vec4; 4],
}

/// The least semi-axis of a light's ellipsoid, as a part of the largest.
const FLATTEST: f32 = 1e-3;

/// What one window holds, as the tangent off its middle: beyond, texels on its edge are far smaller than in its middle.
const MOST_TANGENT: f32 = 2.0;

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

/// What the paper takes for a light: an ellipsoid that holds it. That of least volume about a box has √3 times its halves for
/// semi-axes, that of least area about a rectangle √2 times.
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
    // Scaled to a sphere it must not be flat; and what single precision may have moved the points.
    let least = (FLATTEST * semi_axes_m.max_element()).max(f32::MIN_POSITIVE.sqrt());
    let semi_axes_m = (1.0 + 1e-5) * semi_axes_m.max(Vec3::splat(least));
    let frame_axes = [frame.right * semi_axes_m.x, frame.up * semi_axes_m.y, frame.axis * semi_axes_m.z];
    [center, frame_axes[0], frame_axes[1], frame_axes[2]].map(|v| along(v).extend(0.0))
}

/// The middle of the directions from a point to all receivers, where one window holds them.
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
        depth > 0.0 && (direction - depth * axis).length() < MOST_TANGENT * depth
    };
    directions.iter().all(is_inside).then_some(axis)
}
