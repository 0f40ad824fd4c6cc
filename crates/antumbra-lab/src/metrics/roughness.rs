//! Roughness: high-frequency error where the ground truth is smooth, which the eye perceives as artefacts:
//! torn edges, specks, acne, seams, noise.
//!
//! ```text
//! D = V − V_ref             over judged pixels
//! H = D − (G ∗ D) / (G ∗ 1)  over judged pixels, with G a Gaussian of σ = 2 px
//! ```
//!
//! `roughness` is the rms of H over *smooth* pixels: judged ones around which, within 3 px, V_ref changes by less than .02 between judged
//! neighbours in a row or column. A penumbra of the wrong width or depth has a D that varies slowly, which the high-pass filter removes. A
//! truth edge that is off by half a pixel is masked by the edge itself, because its neighbourhood is not smooth.
//!
//! The worst tile is the window of 32 × 32 pixels, anywhere in the image, with the largest rms of H. Pixels that are not smooth count as
//! 0: the sum of squares is divided by all 1024, so slivers of a few pixels do not decide.
//!
//! With coloured visibility, each channel of each pixel is one sample with its own smoothness.

use glam::UVec2;
use serde::{Deserialize, Serialize};

use super::gaussian::Gaussian;

/// Standard deviation of the Gaussian, pixels. Detail is the part that its blur removes.
const DETAIL_SIGMA_PX: f64 = 2.0;
/// Radius of the Gaussian: three standard deviations.
const DETAIL_RADIUS_PX: usize = 6;
/// Maximum change between neighbouring pixels where the truth is smooth: 50 pixels from umbra to light.
const SMOOTH_STEP: f64 = 0.02;
/// Radius within which the truth must be smooth.
const SMOOTH_RADIUS_PX: usize = 3;
/// Side of the worst tile, pixels.
pub const TILE_PX: u32 = 32;

/// Tile with the largest roughness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorstTile {
    /// Column and row of the upper left pixel.
    pub at_px: [u32; 2],
    /// Rms of H over the 32 × 32 pixels; pixels that are not smooth count as 0.
    pub rms: f64,
}

/// Sums of H² over the channels.
pub(super) struct Roughness<'a> {
    size_px: UVec2,
    judged: &'a [bool],
    gaussian: Gaussian,
    /// Values of G ∗ 1 over judged pixels.
    weights: Vec<f64>,
    /// Sum over the channels of H² at smooth pixels.
    squares: Vec<f64>,
    smooth: u64,
    channels: u32,
}

impl<'a> Roughness<'a> {
    pub(super) fn new(size_px: UVec2, judged: &'a [bool]) -> Self {
        let gaussian = Gaussian::new(DETAIL_SIGMA_PX, DETAIL_RADIUS_PX);
        let ones: Vec<f64> = judged.iter().map(|&judged| f64::from(u8::from(judged))).collect();
        let weights = gaussian.window_sums(size_px, &ones);
        Self { size_px, judged, gaussian, weights, squares: vec![0.0; judged.len()], smooth: 0, channels: 0 }
    }

    /// Adds a channel. Both planes must be 0 at pixels that are not judged.
    pub(super) fn add(&mut self, truth: &[f64], value: &[f64]) {
        let errors: Vec<f64> = truth.iter().zip(value).map(|(truth, value)| value - truth).collect();
        let sums = self.gaussian.window_sums(self.size_px, &errors);
        for (i, _) in smooth(self.size_px, truth, self.judged).iter().enumerate().filter(|(_, smooth)| **smooth) {
            let detail = errors[i] - sums[i] / self.weights[i];
            self.squares[i] += detail * detail;
            self.smooth += 1;
        }
        self.channels += 1;
    }

    /// Returns the rms over the smooth pixels; `None` if there are none.
    pub(super) fn rms(&self) -> Option<f64> {
        (self.smooth > 0).then(|| (self.squares.iter().sum::<f64>() / self.smooth as f64).sqrt())
    }

    /// Returns the worst tile, the first of equals; `None` without smooth pixels. An image smaller than a tile is one tile.
    pub(super) fn worst_tile(&self) -> Option<WorstTile> {
        let (width, height) = (self.size_px.x as usize, self.size_px.y as usize);
        let side = TILE_PX as usize;
        let mut worst: Option<WorstTile> = None;
        for top in 0..=height.saturating_sub(side) {
            let rows = top..(top + side).min(height);
            let columns: Vec<f64> =
                (0..width).map(|column| rows.clone().map(|row| self.squares[row * width + column]).sum()).collect();
            for left in 0..=width.saturating_sub(side) {
                let sum: f64 = columns[left..(left + side).min(width)].iter().sum();
                let rms = (sum / f64::from(TILE_PX * TILE_PX * self.channels.max(1))).sqrt();
                if worst.is_none_or(|worst| rms > worst.rms) {
                    worst = Some(WorstTile { at_px: [left as u32, top as u32], rms });
                }
            }
        }
        worst.filter(|_| self.smooth > 0)
    }
}

/// Returns, for each pixel, whether it is judged and the truth around it is smooth.
fn smooth(size_px: UVec2, truth: &[f64], judged: &[bool]) -> Vec<bool> {
    let (width, height) = (size_px.x as usize, size_px.y as usize);
    let is_step = |a: usize, b: usize| judged[a] && judged[b] && (truth[a] - truth[b]).abs() >= SMOOTH_STEP;
    let mut steps = vec![false; truth.len()];
    for i in 0..truth.len() {
        let next_in_row = (i % width + 1 < width).then_some(i + 1);
        let next_in_column = (i / width + 1 < height).then_some(i + width);
        for next in next_in_row.into_iter().chain(next_in_column).filter(|&next| is_step(i, next)) {
            (steps[i], steps[next]) = (true, true);
        }
    }
    // A square with side 7, by rows and then columns.
    let near = |steps: &[bool], length: usize, at: usize, index: &dyn Fn(usize) -> usize| {
        (at.saturating_sub(SMOOTH_RADIUS_PX)..(at + SMOOTH_RADIUS_PX + 1).min(length)).any(|k| steps[index(k)])
    };
    let rows: Vec<bool> = (0..truth.len()).map(|i| near(&steps, width, i % width, &|k| i - i % width + k)).collect();
    (0..truth.len()).map(|i| judged[i] && !near(&rows, height, i / width, &|k| k * width + i % width)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: UVec2 = UVec2::new(80, 64);
    const WIDTH: usize = SIZE.x as usize;
    const PIXELS: usize = (SIZE.x * SIZE.y) as usize;

    fn of(truth: &[f64], error: impl Fn(usize, usize) -> f64, judged: &[bool]) -> (Option<f64>, Option<WorstTile>) {
        let plane = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..truth.len()).map(|i| if judged[i] { f(i) } else { 0.0 }).collect()
        };
        let truth_plane = plane(&|i| truth[i]);
        let value = plane(&|i| truth[i] + error(i % WIDTH, i / WIDTH));
        let mut roughness = Roughness::new(SIZE, judged);
        roughness.add(&truth_plane, &value);
        (roughness.rms(), roughness.worst_tile())
    }

    /// Returns the sum of squares of an impulse's detail, δ − G, far from all borders.
    fn impulse_squares() -> f64 {
        let taps = Gaussian::new(DETAIL_SIGMA_PX, DETAIL_RADIUS_PX).taps;
        let middle = taps[DETAIL_RADIUS_PX].powi(2);
        let squares = taps.iter().map(|tap| tap * tap).sum::<f64>().powi(2);
        1.0 - 2.0 * middle + squares
    }

    fn assert_close(got: Option<f64>, want: f64) {
        let got = got.expect("smooth pixels");
        assert!((got - want).abs() < 1e-9, "{got}, in closed form {want}");
    }

    #[test]
    fn one_wrong_pixel_is_rough_by_its_detail() {
        let (rms, worst) = of(&[0.5; PIXELS], |x, y| if (x, y) == (40, 30) { 0.3 } else { 0.0 }, &[true; PIXELS]);
        assert_close(rms, (0.09 * impulse_squares() / PIXELS as f64).sqrt());
        let worst = worst.expect("smooth pixels");
        assert_close(Some(worst.rms), (0.09 * impulse_squares() / 1024.0).sqrt());
        let [left, top] = worst.at_px.map(|at| at as usize);
        assert!((left..left + 32).contains(&40) && (top..top + 32).contains(&30), "{worst:?}");
    }

    /// The blur is normalised over judged pixels, so a constant error has no detail.
    #[test]
    fn a_shift_in_brightness_is_not_rough() {
        let judged: Vec<bool> = (0..PIXELS).map(|i| (i * 7919) % 11 > 2).collect();
        let (rms, worst) = of(&[0.5; PIXELS], |_, _| 0.25, &judged);
        assert_close(rms, 0.0);
        assert!(worst.is_some_and(|worst| worst.rms < 1e-9));
    }

    /// A symmetric blur does not change a slope, except where the image border truncates it.
    #[test]
    fn a_slow_error_is_rough_at_the_border_alone() {
        let slope = |x: usize, _: usize| 0.01 * x as f64;
        let mut roughness = Roughness::new(SIZE, &[true; PIXELS]);
        let value: Vec<f64> = (0..PIXELS).map(|i| slope(i % WIDTH, i / WIDTH)).collect();
        roughness.add(&vec![0.0; PIXELS], &value);
        for (i, square) in roughness.squares.iter().enumerate() {
            let column = i % WIDTH;
            let is_inside = (DETAIL_RADIUS_PX..WIDTH - DETAIL_RADIUS_PX).contains(&column);
            assert_eq!(*square < 1e-20, is_inside, "column {column}: {square}");
        }
    }

    /// A chequered error is pure detail; the blur multiplies it by the squared alternating sum of the taps.
    #[test]
    fn a_chequered_error_is_rough_by_its_size() {
        let sign = |x: usize, y: usize| if (x + y).is_multiple_of(2) { 0.1 } else { -0.1 };
        let mut roughness = Roughness::new(SIZE, &[true; PIXELS]);
        let value: Vec<f64> = (0..PIXELS).map(|i| 0.5 + sign(i % WIDTH, i / WIDTH)).collect();
        roughness.add(&vec![0.5; PIXELS], &value);
        let taps = Gaussian::new(DETAIL_SIGMA_PX, DETAIL_RADIUS_PX).taps;
        let alternating: f64 = taps.iter().enumerate().map(|(k, tap)| if k % 2 == 0 { *tap } else { -tap }).sum();
        let expected = 0.1 * (1.0 - alternating * alternating);
        let inside = roughness.squares[32 * WIDTH + 40].sqrt();
        assert!((inside - expected).abs() < 1e-12, "{inside}, in closed form {expected}");
    }

    /// An edge of the truth masks pixels within three pixels; a slope of less than .02 per pixel masks none.
    #[test]
    fn edges_of_the_truth_hide_and_slopes_do_not() {
        let count = |truth: Vec<f64>| smooth(SIZE, &truth, &[true; PIXELS]).iter().filter(|smooth| **smooth).count();
        let by_column = |f: &dyn Fn(usize) -> f64| (0..PIXELS).map(|i| f(i % WIDTH)).collect::<Vec<_>>();
        // The two columns of the step, and three on either side.
        assert_eq!(count(by_column(&|x| f64::from(u8::from(x >= 40)))), PIXELS - 8 * 64);
        assert_eq!(count(by_column(&|x| 0.019 * (x % 50) as f64).into_iter().take(PIXELS).collect()), PIXELS - 8 * 64);
        assert_eq!(count(by_column(&|x| 0.021 * (x % 48) as f64)), 0);
        // A step to a pixel that is not judged does not count.
        let truth = by_column(&|x| f64::from(u8::from(x >= 40)));
        let judged: Vec<bool> = (0..PIXELS).map(|i| i % WIDTH < 40).collect();
        assert_eq!(smooth(SIZE, &truth, &judged), judged);
    }

    #[test]
    fn what_is_not_smooth_has_no_roughness() {
        let chequered: Vec<f64> = (0..PIXELS).map(|i| ((i % WIDTH + i / WIDTH) % 2) as f64).collect();
        assert_eq!(of(&chequered, |_, _| 0.2, &[true; PIXELS]), (None, None));
        assert_eq!(of(&[0.5; PIXELS], |_, _| 0.2, &[false; PIXELS]), (None, None));
        let none = Roughness::new(UVec2::ZERO, &[]);
        assert_eq!((none.rms(), none.worst_tile()), (None, None));
    }

    /// An image smaller than a tile is divided by the pixels of a whole tile.
    #[test]
    fn small_images_are_one_tile() {
        let size_px = UVec2::new(20, 17);
        let mut truth = vec![0.0; 340];
        let mut roughness = Roughness::new(size_px, &[true; 340]);
        let zeros = truth.clone();
        truth[170] = 0.5;
        roughness.add(&zeros, &truth);
        let worst = roughness.worst_tile().expect("smooth pixels");
        assert_eq!(worst.at_px, [0, 0]);
        let rms = roughness.rms().expect("smooth pixels");
        assert!((worst.rms - rms * (340.0_f64 / 1024.0).sqrt()).abs() < 1e-12);
    }

    /// Channels are samples: an error in one of three contributes a third of the mean square.
    #[test]
    fn channels_are_samples() {
        let zeros = vec![0.5; PIXELS];
        let mut wrong = zeros.clone();
        wrong[30 * WIDTH + 40] += 0.3;
        let mut roughness = Roughness::new(SIZE, &[true; PIXELS]);
        for value in [&wrong, &zeros, &zeros] {
            roughness.add(&zeros, value);
        }
        assert_close(roughness.rms(), (0.09 * impulse_squares() / (3 * PIXELS) as f64).sqrt());
        let worst = roughness.worst_tile().expect("smooth pixels");
        assert_close(Some(worst.rms), (0.09 * impulse_squares() / 3072.0).sqrt());
    }
}
