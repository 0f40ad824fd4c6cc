//! What a file's numbers must be before they take part in a scene.

use glam::Quat;

/// No coordinate beyond this takes part in a scene, metres: squares and products of two stay finite in an f32.
pub(super) const LARGEST_COORDINATE_M: f32 = 1e18;

/// Normalised, in double precision so that long ones do not overflow; `None` where there is no direction.
pub(super) fn unit_quaternion(q: Quat) -> Option<Quat> {
    let q = q.as_dquat();
    let length = q.length();
    (length.is_finite() && length > 0.0).then(|| (q / length).as_quat())
}
