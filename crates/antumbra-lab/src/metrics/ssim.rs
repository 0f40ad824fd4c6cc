//! Structural similarity of two masked images.

use glam::UVec2;

use super::Mean;
use super::gaussian::Gaussian;

/// Radius of the window of Wang et al.: side 11 = 2 · 5 + 1.
const SSIM_RADIUS: usize = 5;
const SSIM_SIGMA_PX: f64 = 1.5;
/// Constants (K₁ L)² and (K₂ L)² with L = 1.
const SSIM_C1: f64 = 0.01 * 0.01;
const SSIM_C2: f64 = 0.03 * 0.03;

/// Adds the structural similarity at every judged pixel. `x` and `y` must be 0 at pixels that are not judged.
///
/// With m the mask and G the Gaussian, the masked window mean of f is (G ∗ m f) / (G ∗ m).
pub(super) fn add_ssim(mean: &mut Mean, size_px: UVec2, x: &[f64], y: &[f64], judged: &[bool]) {
    let zip = |f: fn(f64, f64) -> f64| -> Vec<f64> { x.iter().zip(y).map(|(&x, &y)| f(x, y)).collect() };
    let mask: Vec<f64> = judged.iter().map(|&judged| if judged { 1.0 } else { 0.0 }).collect();
    let gaussian = Gaussian::new(SSIM_SIGMA_PX, SSIM_RADIUS);
    let [weight, sum_x, sum_y, sum_xx, sum_yy, sum_xy] =
        [mask, x.to_vec(), y.to_vec(), zip(|x, _| x * x), zip(|_, y| y * y), zip(|x, y| x * y)]
            .map(|plane| gaussian.window_sums(size_px, &plane));
    for i in (0..x.len()).filter(|&i| judged[i]) {
        let [mean_x, mean_y, mean_xx, mean_yy, mean_xy] =
            [&sum_x, &sum_y, &sum_xx, &sum_yy, &sum_xy].map(|sum| sum[i] / weight[i]);
        // Rounding errors can make differences of moments negative.
        let variance_x = (mean_xx - mean_x * mean_x).max(0.0);
        let variance_y = (mean_yy - mean_y * mean_y).max(0.0);
        let covariance = mean_xy - mean_x * mean_y;
        let luminance = (2.0 * mean_x * mean_y + SSIM_C1) / (mean_x * mean_x + mean_y * mean_y + SSIM_C1);
        let structure = (2.0 * covariance + SSIM_C2) / (variance_x + variance_y + SSIM_C2);
        mean.add(luminance * structure);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::compare_visibility;
    use crate::metrics::tests::assert_close;
    use crate::picture::Visibility;

    /// Flat images have no structure, so SSIM is its luminance term.
    #[test]
    fn ssim_of_flat_images_is_the_luminance_term() {
        let size = UVec2::new(17, 13);
        let flat = |v: f32| Visibility::one(size, vec![v; 17 * 13]);
        let judged = vec![true; 17 * 13];
        let m = compare_visibility(&flat(0.25), &flat(0.75), &judged).unwrap();
        assert_close("ssim", m.ssim, (2.0 * 0.1875 + 1e-4) / (0.0625 + 0.5625 + 1e-4));
        assert_close("ssim", compare_visibility(&flat(0.3), &flat(0.3), &judged).unwrap().ssim, 1.0);
    }

    /// SSIM equals its definition at every window, with a ragged mask and invalid values outside it.
    #[test]
    fn ssim_matches_its_definition_window_by_window() {
        let (width, height) = (19_usize, 14_usize);
        let size = UVec2::new(width as u32, height as u32);
        let judged: Vec<bool> = (0..width * height).map(|i| (i * 7919) % 11 > 2).collect();
        let wave = |i: usize, f: f32| 0.5 + 0.5 * (i as f32 * f).sin();
        let x: Vec<f32> = (0..width * height).map(|i| if judged[i] { wave(i, 0.37) } else { f32::INFINITY }).collect();
        let y: Vec<f32> = (0..width * height).map(|i| if judged[i] { wave(i, 0.41) } else { f32::NAN }).collect();

        let mut by_hand = Mean::default();
        for centre in (0..width * height).filter(|&i| judged[i]) {
            let (cx, cy) = ((centre % width) as f64, (centre / width) as f64);
            let window: Vec<(f64, f64, f64)> = (0..width * height)
                .filter(|&i| judged[i])
                .map(|i| ((i % width) as f64 - cx, (i / width) as f64 - cy, f64::from(x[i]), f64::from(y[i])))
                .filter(|(dx, dy, ..)| dx.abs() <= 5.0 && dy.abs() <= 5.0)
                .map(|(dx, dy, x, y)| ((-(dx * dx + dy * dy) / (2.0 * 1.5 * 1.5)).exp(), x, y))
                .collect();
            let total: f64 = window.iter().map(|w| w.0).sum();
            let mean = |f: &dyn Fn(f64, f64) -> f64| window.iter().map(|&(w, x, y)| w * f(x, y)).sum::<f64>() / total;
            let (mx, my) = (mean(&|x, _| x), mean(&|_, y| y));
            let (vx, vy) = (mean(&|x, _| (x - mx).powi(2)), mean(&|_, y| (y - my).powi(2)));
            let cov = mean(&|x, y| (x - mx) * (y - my));
            by_hand.add((2.0 * mx * my + 1e-4) * (2.0 * cov + 9e-4) / ((mx * mx + my * my + 1e-4) * (vx + vy + 9e-4)));
        }
        let m = compare_visibility(&Visibility::one(size, x), &Visibility::one(size, y), &judged).unwrap();
        assert_close("ssim", m.ssim, by_hand.mean().unwrap());
    }
}
