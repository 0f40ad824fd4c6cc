//! Sums under a Gaussian window.

use glam::UVec2;

/// A Gaussian, cut off at a radius, whose taps sum to one.
pub(super) struct Gaussian {
    /// At offsets of −radius to radius.
    pub(super) taps: Vec<f64>,
}

impl Gaussian {
    pub(super) fn new(sigma_px: f64, radius_px: usize) -> Self {
        let tap = |at: usize| (-0.5 * (at.abs_diff(radius_px) as f64 / sigma_px).powi(2)).exp();
        let taps: Vec<f64> = (0..=2 * radius_px).map(tap).collect();
        let total: f64 = taps.iter().sum();
        Self { taps: taps.into_iter().map(|tap| tap / total).collect() }
    }

    /// Sums under the window about each pixel, rows then columns; outside the image lies zero.
    pub(super) fn window_sums(&self, size_px: UVec2, plane: &[f64]) -> Vec<f64> {
        let (width, height) = (size_px.x as usize, size_px.y as usize);
        let radius = self.taps.len() / 2;
        let window = |at: usize, length: usize| at.saturating_sub(radius)..(at + radius + 1).min(length);
        let mut rows = vec![0.0; plane.len()];
        for (row, sums) in rows.chunks_exact_mut(width.max(1)).enumerate() {
            let line = &plane[row * width..][..width];
            for (column, sum) in sums.iter_mut().enumerate() {
                *sum = window(column, width).map(|k| self.taps[k + radius - column] * line[k]).sum();
            }
        }
        // Line by line, so that memory is read in its order.
        let mut both = vec![0.0; plane.len()];
        for (row, sums) in both.chunks_exact_mut(width.max(1)).enumerate() {
            for k in window(row, height) {
                let tap = self.taps[k + radius - row];
                sums.iter_mut().zip(&rows[k * width..][..width]).for_each(|(sum, value)| *sum += tap * value);
            }
        }
        both
    }
}
