//! Cameras of the asset.
//!
//! Source: glTF 2.0, section 3.10. A camera looks down its node's −z with +y up. Orthographic ones are left out, because
//! the laboratory has only pinhole cameras.

use glam::{Mat4, Vec3};

use super::extras;
use super::fault::{Fault, Result};
use super::materials::floats;
use super::source::Source;
use crate::Camera;

/// Far plane if the file gives an infinite one, metres: the default of setup files.
const FAR_M: f32 = 200.0;

/// Reads the camera of a node; `None`, with a warning, if it gives no pinhole camera.
pub(super) fn read(source: &Source, index: usize, world_from_node: Mat4) -> Result<Option<Camera>> {
    let cameras = &source.root.cameras;
    let Some(json) = cameras.get(index) else {
        return Err(Fault::unresolved("camera", "cameras", index, cameras.len()));
    };
    let label = Source::label(json.name.as_ref(), "cameras", index);
    let Some(perspective) = &json.perspective else {
        source.warn(format!("{label}: only perspective cameras are supported; it is ignored"));
        return Ok(None);
    };
    let eye = world_from_node.w_axis.truncate();
    let forward = -world_from_node.z_axis.truncate().normalize_or_zero();
    // Exported cameras give the distance of their target; others get one metre.
    let distance_m = floats(extras::of(&json.extras).get("target_distance")).map_or(1.0, |[d]| d);
    let near_m = perspective.znear;
    let camera = Camera {
        eye,
        target: eye + forward * distance_m,
        up: world_from_node.y_axis.truncate().normalize_or(Vec3::Y),
        fov_y_rad: perspective.yfov,
        near_m,
        far_m: perspective.zfar.unwrap_or(FAR_M.max(2.0 * near_m)),
        shadow_distance: None,
    };
    match crate::setup::check_camera(&camera) {
        Ok(()) => Ok(Some(camera)),
        Err(problem) => {
            source.warn(format!("{label}: {problem}; it is ignored"));
            Ok(None)
        }
    }
}
