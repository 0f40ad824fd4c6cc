//! Colour maps: diverging for signed errors, sequential for magnitudes.
//!
//! **Signed error** e = V − V_ref has the fixed range ±0.5, so that images of different techniques are comparable: deep red = leak (at
//! least 0.5 too bright), white = correct, deep blue = overshadow (at least 0.5 too dark). The map is ColorBrewer's *RdBu*, which is
//! legible with the common kinds of colour blindness. Pixels that are not judged (background, or facing away from the light) are a flat
//! dark grey, which the map does not contain. Values that are not finite are magenta.

use image::RgbImage;

use crate::picture::{Visibility, rgb_image};

/// Absolute error at which [`signed_error_color`] saturates.
pub const SIGNED_ERROR_RANGE: f32 = 0.5;

/// Colour of pixels that are not judged.
pub const NOT_JUDGED_COLOR: [u8; 3] = [52, 55, 60];

/// Colour of NaN and infinities.
pub const NON_FINITE_COLOR: [u8; 3] = [255, 0, 255];

/// Returns the colour of a signed error: red above zero, blue below, saturating at ±[`SIGNED_ERROR_RANGE`].
pub fn signed_error_color(error: f32) -> [u8; 3] {
    if !error.is_finite() {
        return NON_FINITE_COLOR;
    }
    let unit = (0.5 - 0.5 * f64::from(error / SIGNED_ERROR_RANGE)).clamp(0.0, 1.0);
    colorous::RED_BLUE.eval_continuous(unit).into_array()
}

/// Returns the colour of a magnitude in `[0, 1]`, dark to bright (matplotlib's *viridis*). It saturates outside.
pub fn magnitude_color(unit: f32) -> [u8; 3] {
    if !unit.is_finite() {
        return NON_FINITE_COLOR;
    }
    colorous::VIRIDIS.eval_continuous(f64::from(unit.clamp(0.0, 1.0))).into_array()
}

/// Returns the signed error of every pixel. Coloured visibility shows the channel with the largest error. All images must have one size.
pub fn signed_error_map(reference: &Visibility, tested: &Visibility, judged: &[bool]) -> RgbImage {
    assert_eq!(reference.size_px, tested.size_px, "compared images must have equal sizes");
    let channels = reference.channel_count().max(tested.channel_count());
    rgb_image(reference.size_px, |i| {
        if !judged[i] {
            return NOT_JUDGED_COLOR;
        }
        let errors = (0..channels).map(|c| tested.at(i, c) - reference.at(i, c));
        // This order by magnitude makes NaN the largest, so that it is visible.
        errors.max_by(|a, b| a.abs().total_cmp(&b.abs())).map_or(NOT_JUDGED_COLOR, signed_error_color)
    })
}

/// Returns the magnitudes from 0 to `max`, the brightest; pixels outside `shown` are flat grey.
pub fn magnitude_map(size_px: glam::UVec2, values: &[f32], max: f32, shown: &[bool]) -> RgbImage {
    rgb_image(size_px, |i| if shown[i] { magnitude_color(values[i] / max) } else { NOT_JUDGED_COLOR })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec3};

    #[test]
    fn red_is_leak_blue_is_overshadow_white_is_right() {
        let [r, _, b] = signed_error_color(0.4);
        assert!(r > b + 80, "too bright is red");
        let [r, _, b] = signed_error_color(-0.4);
        assert!(b > r + 80, "too dark is blue");
        assert!(signed_error_color(0.0).iter().all(|&c| c > 230), "right is near white");
        assert_eq!(signed_error_color(0.5), signed_error_color(7.0));
        assert_eq!(signed_error_color(-0.5), signed_error_color(-7.0));
        assert_eq!(signed_error_color(f32::NAN), NON_FINITE_COLOR);
    }

    #[test]
    fn grey_and_magenta_are_not_on_the_map() {
        let distance = |a: [u8; 3], b: [u8; 3]| (0..3).map(|c| a[c].abs_diff(b[c]) as u32).sum::<u32>();
        for i in 0..=100 {
            let color = signed_error_color(i as f32 / 100.0 - 0.5);
            assert!(distance(color, NOT_JUDGED_COLOR) > 60 && distance(color, NON_FINITE_COLOR) > 60, "{color:?}");
        }
    }

    #[test]
    fn the_worst_channel_shows() {
        let size = UVec2::new(3, 1);
        let reference = Visibility::three(size, vec![Vec3::splat(0.5); 3]);
        let tested = Visibility::three(size, vec![Vec3::new(0.6, 0.1, 0.5), Vec3::new(0.5, f32::NAN, 0.5), Vec3::ONE]);
        let map = signed_error_map(&reference, &tested, &[true, true, false]);
        assert_eq!(map.get_pixel(0, 0).0, signed_error_color(-0.4));
        assert_eq!(map.get_pixel(1, 0).0, NON_FINITE_COLOR);
        assert_eq!(map.get_pixel(2, 0).0, NOT_JUDGED_COLOR);
    }

    #[test]
    fn magnitudes_grow_brighter() {
        let luma = |unit| magnitude_color(unit).iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!(luma(0.0) < luma(0.5) && luma(0.5) < luma(1.0));
        let map = magnitude_map(UVec2::new(2, 1), &[2.0, 2.0], 2.0, &[true, false]);
        assert_eq!(map.get_pixel(0, 0).0, magnitude_color(1.0));
        assert_eq!(map.get_pixel(1, 0).0, NOT_JUDGED_COLOR);
    }
}
