//! Paths of camera, light and caster: their poses in each frame.
//!
//! Every motion *arrives*: in its last frame, everything is at the place that setup and scene give it. So the masks after it are those of
//! a still comparison, and a caster ends at its own place. Earlier frames are one step further back for each frame to come:
//!
//! ```text
//! frame          0 ........ i ........ N = N + 1 = …
//! from its place −N·step    −(N − i)·step      0
//! ```
//!
//! along the camera's right, where motion is most visible.

use antumbra_light::{Light, LightShape};
use antumbra_scene::{Camera, Setup};
use glam::{Quat, Vec3};

use super::Motion;

/// Assumed distance of a sun when a step in metres is converted to an angle: that of a lamp above a street, whose shadows move as fast.
const SUN_DISTANCE_M: f32 = 10.0;

/// Motion and its parameters.
#[derive(Clone, Debug)]
pub(super) struct Trajectory<'a> {
    pub(super) setup: &'a Setup,
    /// Index of the light in the setup.
    pub(super) light: usize,
    pub(super) motion: Motion,
    /// Number of moving frames, N.
    pub(super) frames: u32,
    /// Metres per frame.
    pub(super) step_m: f32,
    /// Cameras passed at even intervals before the setup's; if empty, the camera moves sideways.
    pub(super) path: &'a [Camera],
}

/// Camera, light and caster in one frame.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    pub(super) camera: Camera,
    pub(super) light: Light,
    /// Offset of the moving caster from its place, metres in world space.
    pub(super) caster_offset_m: Vec3,
}

impl Trajectory<'_> {
    /// Returns the pose in a frame; at rest from frame N on.
    pub(super) fn at(&self, frame: u32) -> Pose {
        let Setup { camera, lights } = self.setup;
        let to_come = self.frames.saturating_sub(frame);
        let offset_m = -self.step_m * to_come as f32 * right_of(camera);
        let mut pose = Pose { camera: *camera, light: lights[self.light].clone(), caster_offset_m: Vec3::ZERO };
        // Adding zero would turn −0 into 0, and the last pose must equal the setup's to the bit.
        if to_come > 0 {
            match self.motion {
                Motion::Camera if self.path.is_empty() => {
                    pose.camera.eye += offset_m;
                    pose.camera.target += offset_m;
                }
                Motion::Camera => pose.camera = self.on_path(frame),
                Motion::Light => move_light(&mut pose.light, offset_m),
                Motion::Caster => pose.caster_offset_m = offset_m,
            }
        }
        pose
    }

    /// Interpolates the camera between two neighbours of the path.
    fn on_path(&self, frame: u32) -> Camera {
        let place = |i: usize| self.path.get(i).copied().unwrap_or(self.setup.camera);
        let along = frame as f32 / self.frames as f32 * self.path.len() as f32;
        let before = (along as usize).min(self.path.len() - 1);
        let (from, to, t) = (place(before), place(before + 1), along - before as f32);
        Camera {
            eye: from.eye.lerp(to.eye, t),
            target: from.target.lerp(to.target, t),
            up: from.up.lerp(to.up, t),
            fov_y_rad: from.fov_y_rad + (to.fov_y_rad - from.fov_y_rad) * t,
            ..to
        }
    }
}

/// Returns the camera's right as a unit vector.
fn right_of(camera: &Camera) -> Vec3 {
    (camera.target - camera.eye).cross(camera.up).normalize()
}

/// Translates a lamp, or turns a sun about the axis perpendicular to its movement.
fn move_light(light: &mut Light, offset_m: Vec3) {
    match &mut light.shape {
        LightShape::Sun { .. } => {
            // Direction to the sun, and the part of the offset perpendicular to it.
            let towards = -light.axis;
            let across = offset_m - towards * towards.dot(offset_m);
            let turn = towards.cross(across).normalize_or_zero();
            if turn != Vec3::ZERO {
                let angle_rad = offset_m.length() / SUN_DISTANCE_M;
                light.axis = (Quat::from_axis_angle(turn, angle_rad) * light.axis).normalize();
            }
        }
        LightShape::Points { positions_m } => {
            positions_m.iter_mut().for_each(|position| *position += offset_m);
            light.center += offset_m;
        }
        _ => light.center += offset_m,
    }
}

#[cfg(test)]
mod tests {
    use antumbra_light::LightShape;
    use glam::Vec2;

    use super::*;

    fn setup(shape: LightShape) -> Setup {
        let camera = Camera {
            eye: Vec3::new(0.0, 2.0, 5.0),
            target: Vec3::new(0.0, 2.0, 0.0),
            up: Vec3::Y,
            fov_y_rad: 0.8,
            near_m: 0.05,
            far_m: 100.0,
            shadow_distance: None,
        };
        Setup { camera, lights: vec![Light::new(shape, Vec3::Y * 5.0, Vec3::ZERO)] }
    }

    fn trajectory(setup: &Setup, motion: Motion) -> Trajectory<'_> {
        Trajectory { setup, light: 0, motion, frames: 4, step_m: 0.5, path: &[] }
    }

    #[test]
    fn each_motion_moves_one_thing_and_arrives() {
        let setup = setup(LightShape::Rectangle { size_m: Vec2::ONE });
        let back = Vec3::X * -2.0;
        for motion in Motion::ALL {
            let trajectory = trajectory(&setup, motion);
            let [first, last, after] = [0, 4, 9].map(|frame| trajectory.at(frame));
            for rest in [last, after] {
                assert_eq!(
                    (rest.camera, rest.light, rest.caster_offset_m),
                    (setup.camera, setup.lights[0].clone(), Vec3::ZERO)
                );
            }
            let moved = [
                first.camera.eye - setup.camera.eye,
                first.light.center - setup.lights[0].center,
                first.caster_offset_m,
            ];
            for (what, moved) in Motion::ALL.into_iter().zip(moved) {
                let expected = if what == motion { back } else { Vec3::ZERO };
                assert!(moved.abs_diff_eq(expected, 1e-6), "{motion:?} moves {what:?} by {moved}");
            }
        }
    }

    #[test]
    fn a_sun_turns_by_the_step_at_ten_metres() {
        let setup = setup(LightShape::Sun { angular_diameter_rad: 0.01 });
        let trajectory = trajectory(&setup, Motion::Light);
        let angle = trajectory.at(3).light.axis.angle_between(setup.lights[0].axis);
        assert!((angle - 0.05).abs() < 1e-4, "{angle}");
        // It comes from the camera's left.
        assert!((-trajectory.at(3).light.axis).x < 0.0);
    }

    #[test]
    fn a_path_passes_its_places_and_ends_at_the_setup() {
        let setup = setup(LightShape::Sphere { radius_m: 0.1 });
        let place = |x: f32| Camera { eye: Vec3::new(x, 2.0, 5.0), ..setup.camera };
        let path = [place(-4.0), place(-1.0)];
        let trajectory = Trajectory { path: &path, ..trajectory(&setup, Motion::Camera) };
        let eyes: Vec<f32> = (0..=5).map(|frame| trajectory.at(frame).camera.eye.x).collect();
        assert_eq!(eyes, [-4.0, -2.5, -1.0, -0.5, 0.0, 0.0]);
    }
}
