//! Where the light's map has straight edges, as rasterised triangles need: one window towards the receivers, or a cube
//! about the light.

use antumbra_light::{Aabb, Light};
use glam::Vec3;

use crate::contract::Receivers;

use super::light_points::{LocalPoint, box_along};

/// Windows from the light's centre; see `windows.wesl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Windows {
    /// 1, or the 6 of a cube.
    pub(crate) count: u32,
    /// Right, up and depth of the first, in the world.
    pub(crate) axes: [Vec3; 3],
    /// Box of the light's points along these, about the light's centre; of a sun's directions.
    pub(crate) light: Aabb,
}

/// What one window holds, as the tangent off its middle: beyond, texels on its edge are far smaller than in its middle.
const MOST_TANGENT: f32 = 2.0;

impl Windows {
    pub(crate) fn towards(receivers: &Receivers<'_>, light: &Light, points: &[LocalPoint], is_turned: bool) -> Self {
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
        Self { count, axes, light: box_along(light, points, is_turned, axes, origin) }
    }
}

/// The middle of the directions from a point to all receivers, where one window holds them.
fn axis_to(receivers: &Receivers<'_>, from: Vec3) -> Option<Vec3> {
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
