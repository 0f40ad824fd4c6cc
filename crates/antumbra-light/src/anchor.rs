//! Anchor: the origin of positions far from the world's origin.

use glam::Vec3;

/// Distance from the world's origin along each axis up to which the anchor is the origin, metres: 32-bit floats are 4 µm apart
/// there.
const AT_ORIGIN_M: f32 = 64.0;
/// Spacing of the grid of anchors elsewhere, metres, so that an anchor rarely changes while its position moves. A power of two, so
/// that relative positions lose no precision.
const STEP_M: f32 = 16.0;

/// Returns the anchor near a world position: relative to it, 32-bit floats are as fine there as at the world's origin. The anchor
/// is the origin itself within 64 m of it, and for positions that are not finite.
pub fn anchor_near(place: Vec3) -> Vec3 {
    if !place.is_finite() || place.abs().max_element() <= AT_ORIGIN_M {
        return Vec3::ZERO;
    }
    (place / STEP_M).round() * STEP_M
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_near_and_stay() {
        for place in [Vec3::new(64.1, 0.0, 3.0), Vec3::new(-10_000.3, 12.0, 7_300.1), Vec3::splat(1e5)] {
            let anchor = anchor_near(place);
            assert!((place - anchor).abs().max_element() <= 0.5 * STEP_M, "{place}: {anchor}");
            assert_eq!(anchor_near(anchor + 0.4 * STEP_M), anchor, "{place}");
        }
        for place in [Vec3::ZERO, Vec3::splat(-64.0), Vec3::new(f32::NAN, 0.0, 0.0), Vec3::splat(f32::INFINITY)] {
            assert_eq!(anchor_near(place), Vec3::ZERO, "{place}");
        }
    }
}
