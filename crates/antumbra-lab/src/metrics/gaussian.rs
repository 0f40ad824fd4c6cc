//! Sums under a Gaussian window.

use glam::UVec2;

/// Truncated Gaussian whose taps sum to one.
pub(super) struct Gaussian {
    /// Weights at offsets from −radius to radius.
    pub(super) taps: Vec<f64>,
}

impl Gaussian {
    pub(super) fn new(sigma_px: f64, radius_px: usize) -> Self {
        let tap = |at: usize| (-0.5 * (at.abs_diff(radius_px) as f64 / sigma_px).powi(2)).exp();
        let taps: Vec<f64> = (0..=2 * radius_px).map(tap).collect();
        let total: f64 = taps.iter().sum();
        Self { taps: taps.into_iter().map(|tap| tap / total).collect() }
    }

    /// Returns the sum under the window at each pixel, by rows and then columns; zero outside the image.
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
        // Row by row for contiguous memory access.
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
