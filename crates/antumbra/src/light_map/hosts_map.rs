//! Light view of a depth map that the host has rendered.
//!
//! Casters behind the farthest receiver shade none. So the map's range ends there, even if its far plane is farther or at
//! infinity. For techniques that divide the range, empty texels are then no farther away than the receivers they are compared with.

use super::light_view::{LightViewGpu, light_view_of_matrix};
use crate::contract::{DepthMapCaster, Error, PreparedFrame};

/// Smallest range of a map, as a fraction of its near plane's distance, if no receiver lies beyond the near plane.
const MIN_RANGE: f32 = 1e-3;

/// Returns the view of `map`. Its range ends with the receivers; if these are unknown, at the matrix's far plane, or at
/// [`f32::MAX`] if that is at infinity.
pub(crate) fn view_of_hosts_map(
    technique: &'static str,
    frame: &PreparedFrame<'_>,
    map: &DepthMapCaster<'_>,
) -> Result<LightViewGpu, Error> {
    let is_perspective = !frame.light.is_distant();
    let size = map.size_px.as_vec2();
    let view =
        light_view_of_matrix(frame.light.frame(), is_perspective, map.clip_from_world, map.depth_convention, size)
            .ok_or_else(|| Error::BadFrame {
                technique,
                what: "the depth map's matrix",
                had: "not a view from the light's centre along the light's axis".into(),
                needed:
                    "a perspective projection from the light's centre along its axis, or an orthographic projection along the axis of a sun"
                        .into(),
            })?;
    let along = (frame.receivers.corners().iter())
        .map(|corner| (*corner - view.origin_in_world).dot(view.axis_in_world))
        .fold(f32::NEG_INFINITY, f32::max);
    if along == f32::NEG_INFINITY {
        return Ok(view);
    }
    let farthest = along.max(view.near_m + MIN_RANGE * view.near_m.abs());
    Ok(LightViewGpu { far_m: view.far_m.min(farthest + MIN_RANGE * (farthest - view.near_m)), ..view })
}
