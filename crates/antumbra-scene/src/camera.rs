//! A pinhole camera.

use antumbra_light::ShadowDistance;
use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_at_mat4};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// A pinhole camera that looks from `eye` to `target`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World position of the pinhole, metres.
    pub eye: Vec3,
    /// World position at the image centre.
    pub target: Vec3,
    /// Up hint.
    pub up: Vec3,
    /// Vertical field of view, full angle, radians.
    pub fov_y_rad: f32,
    /// Distance of the near plane, metres.
    pub near_m: f32,
    /// Distance of the far plane, metres.
    pub far_m: f32,
    /// Shadow distance of techniques, from the eye; `None` for no limit. The ray tracer ignores it.
    pub shadow_distance: Option<ShadowDistance>,
}

impl Camera {
    /// View matrix: the camera is at the origin of view space and looks down −z, with +y up.
    pub fn view_from_world(&self) -> Mat4 {
        look_at_mat4(self.eye, self.target, self.up)
    }

    /// Projection with reversed depth and an infinite far plane: 1 at `near_m`, 0 at infinity, equal relative precision everywhere.
    pub fn clip_from_view(&self, size_px: UVec2) -> Mat4 {
        let aspect = size_px.x as f32 / size_px.y as f32;
        perspective_infinite_reverse(self.fov_y_rad, aspect, self.near_m)
    }

    /// Unit direction from the eye through a point of the image, in pixels from the top left corner. The centre of pixel
    /// (i, j) is (i + ½, j + ½).
    pub fn ray_direction(&self, size_px: UVec2, pos_px: Vec2) -> Vec3 {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        let up = right.cross(forward);
        let half_height = (0.5 * self.fov_y_rad).tan();
        let half_width = half_height * size_px.x as f32 / size_px.y as f32;
        let ndc = pos_px / size_px.as_vec2() * 2.0 - 1.0;
        (forward + right * (ndc.x * half_width) - up * (ndc.y * half_height)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_and_matrices_agree() {
        let camera = Camera {
            eye: Vec3::new(4.0, 3.0, 6.0),
            target: Vec3::new(0.0, 0.5, 0.0),
            up: Vec3::Y,
            fov_y_rad: 0.8,
            near_m: 0.05,
            far_m: 200.0,
            shadow_distance: None,
        };
        let size = UVec2::new(160, 90);
        let pos_px = Vec2::new(31.5, 12.5);
        let x = camera.eye + 7.0 * camera.ray_direction(size, pos_px);
        let ndc = (camera.clip_from_view(size) * camera.view_from_world()).project_point3(x);
        let back = (Vec2::new(ndc.x, -ndc.y) * 0.5 + 0.5) * size.as_vec2();
        assert!(back.abs_diff_eq(pos_px, 1e-3), "{back}");
    }
}
