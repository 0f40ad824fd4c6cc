//! Helpers of GPU tests: a shared device, and small scenes.

use std::sync::OnceLock;

use antumbra_scene::{Camera, Mesh};
use glam::{Vec2, Vec3};

use crate::device::{DeviceError, DeviceOptions, LabDevice};

/// Returns the device, or `None` with a message if this machine has no adapter and none is required. An
/// adapter without a device is a failure.
pub(crate) fn lab_or_skip() -> Option<&'static LabDevice> {
    static LAB: OnceLock<Option<LabDevice>> = OnceLock::new();
    let lab = LAB.get_or_init(|| {
        let wanted_features = antumbra::Gpu::WANTED_FEATURES;
        match LabDevice::new(&DeviceOptions { adapter: None, wanted_features }) {
            Ok(lab) => Some(lab),
            Err(DeviceError::NoAdapter) => None,
            Err(error) => panic!("{error}"),
        }
    });
    if lab.is_none() {
        antumbra_testing::skip_without_adapter();
    }
    lab.as_ref()
}

/// Returns a square in the xz plane centred at the origin, facing up, with texture coordinates over it.
pub(crate) fn quad(half_side_m: f32) -> Mesh {
    let corners = [Vec2::new(-1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, -1.0)];
    Mesh {
        name: "quad".into(),
        positions: corners.map(|c| Vec3::new(c.x, 0.0, c.y) * half_side_m).to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: corners.map(|c| 0.5 * c + 0.5).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}

/// Returns a camera that looks from `eye` to the origin.
pub(crate) fn camera_at(eye: Vec3) -> Camera {
    Camera { eye, target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.8, near_m: 0.05, far_m: 200.0, shadow_distance: None }
}
