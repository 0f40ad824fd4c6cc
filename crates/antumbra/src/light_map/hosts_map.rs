//! A light depth map that the host has rendered, as a view of ours.
//!
//! What lies behind the farthest receiver shades none of them. So a map ends there, however deep, even infinitely, it was
//! rendered, for techniques that divide its range: its empty texels are then no farther away than what they are compared with.

use super::light_view::{LightViewGpu, light_view_of_matrix};
use crate::contract::{DepthMapCaster, Error, PreparedFrame};

/// Of a map beyond whose nearest depth there is no receiver, so much is its range, as a part of that depth's distance.
const LEAST_RANGE: f32 = 1e-3;

/// The view that `map` was rendered in. Its range ends with the receivers, or where nothing is known of these where the matrix
/// says: at [`f32::MAX`] where that is infinite.
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
                had: "not a view from the light's centre along its axis".into(),
                needed:
                    "a perspective from the light's centre along its axis, or for a sun an orthographic projection \
                         along it"
                        .into(),
            })?;
    let along = (frame.receivers.corners().iter())
        .map(|corner| (*corner - view.origin_in_world).dot(view.axis_in_world))
        .fold(f32::NEG_INFINITY, f32::max);
    if along == f32::NEG_INFINITY {
        return Ok(view);
    }
    let farthest = along.max(view.near_m + LEAST_RANGE * view.near_m.abs());
    Ok(LightViewGpu { far_m: view.far_m.min(farthest + LEAST_RANGE * (farthest - view.near_m)), ..view })
}
