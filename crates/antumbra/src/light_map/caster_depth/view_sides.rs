//! Culling of bounding boxes against the sides of a light view.

use antumbra_light::Aabb;
use glam::{Mat4, Vec3, Vec4};

/// Sides of a view's frustum, against which bounding boxes are culled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ViewSides {
    clip_from_world: Mat4,
    /// Clip-space plane of each side, negative inside, and its largest change per half extent of a box along the world's axes.
    sides: [(Vec4, Vec3); 6],
}

impl ViewSides {
    pub(crate) fn of(clip_from_world: &Mat4) -> Self {
        // Beyond x = w, x = −w, y = w, y = −w, behind the light, and beyond the far plane, where depth is 0.
        let sides = [
            Vec4::new(1.0, 0.0, 0.0, -1.0),
            Vec4::new(-1.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 1.0, 0.0, -1.0),
            Vec4::new(0.0, -1.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, -1.0, 0.0),
        ];
        let Mat4 { x_axis, y_axis, z_axis, .. } = *clip_from_world;
        let sides = sides.map(|side| (side, Vec3::new(side.dot(x_axis), side.dot(y_axis), side.dot(z_axis)).abs()));
        Self { clip_from_world: *clip_from_world, sides }
    }

    /// Whether any part of a box may be where the view has texels. A box wholly beyond one side draws nothing, since sides are
    /// planes in homogeneous coordinates.
    pub(crate) fn may_hold(&self, bounds: &Aabb) -> bool {
        let (middle, half) = (0.5 * bounds.min + 0.5 * bounds.max, 0.5 * bounds.max - 0.5 * bounds.min);
        let Mat4 { x_axis, y_axis, z_axis, w_axis } = self.clip_from_world;
        let middle = x_axis * middle.x + y_axis * middle.y + z_axis * middle.z + w_axis;
        let reach = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
        // The rasteriser's own rounding, at the corner where it is largest.
        let slack = 1e-4 * (middle.abs() + reach).max_element();
        !self.sides.iter().any(|(side, of_half)| side.dot(middle) - of_half.dot(half) > slack)
    }
}

#[cfg(test)]
mod tests {
    use antumbra_light::{hash_u32, unit_f32};

    use super::*;

    /// A box partly inside a view is never culled; most boxes whose corners all lie beyond one side are.
    #[test]
    fn views_leave_out_boxes_beside_them_alone() {
        let unit = |i: u32| unit_f32(hash_u32(i)) * 2.0 - 1.0;
        let place = |i: u32| Vec3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2));
        let projections = [
            glam::camera::rh::proj::directx::perspective(1.2, 1.3, 40.0, 0.2),
            glam::camera::rh::proj::directx::orthographic(-3.0, 3.0, -2.0, 2.0, 20.0, 0.1),
        ];
        let (mut held, mut beside, mut left_out) = (0, 0, 0);
        for case in 0..4000 {
            let first = 50 * case;
            let pose = glam::camera::rh::view::look_at_mat4(4.0 * place(first), place(first + 1), Vec3::Y);
            let clip_from_world = projections[case as usize % 2] * pose;
            let (middle, half) = (8.0 * place(first + 2), place(first + 3).abs() * 1.5);
            let bounds = Aabb { min: middle - half, max: middle + half };
            let may_hold = ViewSides::of(&clip_from_world).may_hold(&bounds);
            // The near plane clips nothing: nearer geometry is drawn at it.
            let is_inside = |x: Vec3| {
                let clip = clip_from_world * x.extend(1.0);
                clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z >= 0.0
            };
            let corners = bounds.corners().map(|x| clip_from_world * x.extend(1.0));
            if (4..40).any(|i| is_inside(middle + half * place(first + i))) {
                held += 1;
                assert!(may_hold, "case {case}: {bounds:?}");
            }
            let sides: [fn(Vec4) -> f32; 4] = [|c| c.x - c.w, |c| -c.x - c.w, |c| c.y - c.w, |c| -c.y - c.w];
            if sides.iter().any(|side| corners.iter().all(|clip| side(*clip) > 1e-3 * clip.abs().max_element())) {
                beside += 1;
                left_out += u32::from(!may_hold);
            }
        }
        assert!(
            held > 400 && beside > 1000 && 100 * left_out > 95 * beside,
            "{held} held, {left_out} of {beside} left out"
        );
    }
}
