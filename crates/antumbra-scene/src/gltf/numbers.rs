//! Limits and repairs of numbers in a file.

use glam::Quat;

/// Largest coordinate in a scene, metres: its square and products of two stay finite in an f32.
pub(super) const LARGEST_COORDINATE_M: f32 = 1e18;

/// Normalises in double precision, so that long quaternions do not overflow; `None` if there is no direction.
pub(super) fn unit_quaternion(q: Quat) -> Option<Quat> {
    let q = q.as_dquat();
    let length = q.length();
    (length.is_finite() && length > 0.0).then(|| (q / length).as_quat())
}
