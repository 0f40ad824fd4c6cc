//! A light's cone and frustum in the image, with handles to drag.

use antumbra_light::{Cone, Light};
use antumbra_scene::Camera;
use glam::Vec3;

use crate::camera;

/// Length of the drawn edges, in scene diagonals.
const LENGTH_DIAGONALS: f32 = 0.2;
/// Number of corners of a cone's ring.
const RING_CORNERS: usize = 48;
/// Resolution of dragged angles, radians; the outer angle exceeds the inner one by at least this.
const STEP_RAD: f32 = 0.25 * std::f32::consts::PI / 180.0;
/// Largest half angle in steps: 89 degrees.
const MAX_STEPS: usize = 356;

/// A handle to drag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// Outer cone angle, beyond which nothing is lit.
    Outer,
    /// Inner cone angle, up to which everything is fully lit.
    Inner,
    /// Half of the frustum's angle.
    Frustum,
}

impl Handle {
    /// All handles.
    pub const ALL: [Self; 3] = [Self::Outer, Self::Inner, Self::Frustum];

    /// The handle's angle from the axis, radians; `None` if the light has no such limit.
    fn angle_rad(self, light: &Light) -> Option<f32> {
        match self {
            Self::Outer => light.cone.map(|cone| cone.outer_rad),
            Self::Inner => light.cone.map(|cone| cone.inner_rad),
            Self::Frustum => light.fov_rad.map(|fov_rad| 0.5 * fov_rad),
        }
        .filter(|_| !light.is_distant())
    }

    /// Position of the handle; `None` if the light has no such limit.
    pub fn place(self, light: &Light, camera: &Camera, diagonal_m: f32) -> Option<Vec3> {
        Some(self.at(light, camera, diagonal_m, self.angle_rad(light)?))
    }

    /// Position of the handle at another angle.
    fn at(self, light: &Light, camera: &Camera, diagonal_m: f32, angle_rad: f32) -> Vec3 {
        let frame = light.frame();
        // A cone is symmetric about its axis; across the view direction its angles are easiest to see.
        let across = frame.axis.cross(camera::axes(camera).forward).normalize_or(frame.right);
        let off_axis = match self {
            Self::Outer => across,
            Self::Inner => -across,
            Self::Frustum => frame.right,
        };
        let length_m = LENGTH_DIAGONALS * diagonal_m;
        frame.center + length_m * (frame.axis * angle_rad.cos() + off_axis * angle_rad.sin())
    }

    /// Sets the light's angle to the one whose handle is nearest to the pointer.
    pub fn drag(
        self,
        light: &mut Light,
        camera: &Camera,
        diagonal_m: f32,
        pointer: egui::Pos2,
        on_screen: impl Fn(Vec3) -> Option<egui::Pos2>,
    ) {
        let off = |angle_rad: f32| {
            on_screen(self.at(light, camera, diagonal_m, angle_rad)).map_or(f32::MAX, |place| place.distance(pointer))
        };
        let angles = (0..=MAX_STEPS).map(|step| step as f32 * STEP_RAD);
        let Some(angle_rad) = angles.min_by(|a, b| off(*a).total_cmp(&off(*b))) else { return };
        match (self, &mut light.cone, &mut light.fov_rad) {
            (Self::Outer, Some(cone), _) => cone.outer_rad = angle_rad.max(cone.inner_rad + STEP_RAD),
            (Self::Inner, Some(cone), _) => cone.inner_rad = angle_rad.min(cone.outer_rad - STEP_RAD).max(0.0),
            (Self::Frustum, _, Some(fov_rad)) => *fov_rad = 2.0 * angle_rad.max(STEP_RAD),
            _ => {}
        }
    }
}

/// Outlines of the light's limits: the cone's two rings and four edges, the frustum's pyramid.
pub fn lines(light: &Light, diagonal_m: f32) -> Vec<Vec<Vec3>> {
    if light.is_distant() {
        return Vec::new();
    }
    let frame = light.frame();
    let length_m = LENGTH_DIAGONALS * diagonal_m;
    let mut lines = Vec::new();
    if let Some(Cone { inner_rad, outer_rad }) = light.cone {
        for angle_rad in [inner_rad, outer_rad] {
            let corner = |i: usize| {
                let turn = std::f32::consts::TAU * i as f32 / RING_CORNERS as f32;
                let off_axis = frame.right * turn.cos() + frame.up * turn.sin();
                frame.center + length_m * (frame.axis * angle_rad.cos() + off_axis * angle_rad.sin())
            };
            lines.push((0..=RING_CORNERS).map(corner).collect());
            if angle_rad == outer_rad {
                lines.extend((0..4).map(|i| vec![frame.center, corner(i * RING_CORNERS / 4)]));
            }
        }
    }
    if let Some(fov_rad) = light.fov_rad {
        // The pyramid ends at the same depth as its handle.
        let (depth_m, half_m) = (length_m * (0.5 * fov_rad).cos(), length_m * (0.5 * fov_rad).sin());
        let corner = |x: f32, y: f32| frame.center + frame.axis * depth_m + half_m * (frame.right * x + frame.up * y);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        lines.push(corners.into_iter().chain([corners[0]]).collect());
        lines.extend(corners.map(|corner| vec![frame.center, corner]));
    }
    lines
}

#[cfg(test)]
mod tests {
    use antumbra_light::LightShape;
    use glam::{UVec2, Vec2};

    use super::*;

    const SIZE: UVec2 = UVec2::new(800, 400);

    fn camera() -> Camera {
        Camera {
            eye: Vec3::new(3.0, 2.0, 6.0),
            target: Vec3::new(0.0, 1.0, 0.0),
            up: Vec3::Y,
            fov_y_rad: 0.8,
            near_m: 0.05,
            far_m: 100.0,
            shadow_distance: None,
        }
    }

    fn on_screen(x: Vec3) -> Option<egui::Pos2> {
        let clip = camera().clip_from_view(SIZE) * camera().view_from_world() * x.extend(1.0);
        let unit = 0.5 * Vec2::new(clip.x, -clip.y) / clip.w + 0.5;
        (clip.w > 0.0).then(|| egui::pos2(unit.x * SIZE.x as f32, unit.y * SIZE.y as f32))
    }

    fn spot() -> Light {
        let mut light = Light::new(LightShape::Disk { radius_m: 0.1 }, Vec3::new(0.0, 3.0, 0.0), Vec3::ZERO);
        light.cone = Some(Cone { inner_rad: 0.3, outer_rad: 0.6 });
        light.fov_rad = Some(1.0);
        light
    }

    #[test]
    fn a_dragged_handle_stays_under_the_hand() {
        for handle in Handle::ALL {
            let mut light = spot();
            let before = on_screen(handle.place(&light, &camera(), 5.0).unwrap()).unwrap();
            // The target is the handle's position at a smaller angle.
            let target = on_screen(handle.at(&light, &camera(), 5.0, 0.45)).unwrap();
            assert!(before.distance(target) > 3.0, "{handle:?} does not move on the screen");
            handle.drag(&mut light, &camera(), 5.0, target, on_screen);
            let after = on_screen(handle.place(&light, &camera(), 5.0).unwrap()).unwrap();
            assert!(after.distance(target) < 1.0, "{handle:?}: {after:?} for {target:?}");
            assert!((handle.angle_rad(&light).unwrap() - 0.45).abs() < 0.01, "{handle:?}");
            light.validate().unwrap();
        }
    }

    #[test]
    fn dragged_handles_keep_the_light_valid() {
        for handle in Handle::ALL {
            for (x, y) in [(-5000.0, 10.0), (5000.0, 10.0), (400.0, -5000.0), (400.0, 5000.0), (400.0, 200.0)] {
                let mut light = spot();
                handle.drag(&mut light, &camera(), 5.0, egui::pos2(x, y), on_screen);
                light.validate().unwrap();
            }
        }
        let mut unheld = Light { cone: None, fov_rad: None, ..spot() };
        let before = unheld.clone();
        for handle in Handle::ALL {
            assert_eq!(handle.place(&unheld, &camera(), 5.0), None);
            handle.drag(&mut unheld, &camera(), 5.0, egui::pos2(0.0, 0.0), on_screen);
        }
        assert_eq!((unheld.clone(), lines(&unheld, 5.0).len()), (before, 0));
    }

    #[test]
    fn lines_lie_where_the_light_ends() {
        let light = Light { fov_rad: None, ..spot() };
        let frame = light.frame();
        for corner in lines(&light, 5.0)[1].iter() {
            let off_axis_rad = (*corner - frame.center).angle_between(frame.axis);
            assert!((off_axis_rad - 0.6).abs() < 1e-3, "{off_axis_rad}");
        }
    }
}
