//! Error metrics of a visibility mask against the ground truth, as `metrics.json` defines them.
//!
//! All except [`flip`](Metrics::flip) are over *judged* pixels: those with geometry that faces the light's centre, given as a mask.
//! Details that the definitions leave open:
//!
//! - **Coloured visibility.** Each channel of each judged pixel is one sample, so a mean is over pixels and channels, and the sets
//!   `penumbra`, `umbra` and `lit` are chosen per channel. A one-channel mask compared with a coloured one represents all three channels.
//! - **NaN and infinities** in the tested mask are never dropped. Each counts as the wrong end of [0, 1] (0 where the truth is above ½,
//!   else 1), so as an error of at least ½, and [`Metrics::non_finite`] counts them. A reference that is not finite is an error.
//! - **Finite values outside [0, 1]** are not clamped.
//! - **The 99th percentile** interpolates between the two nearest order statistics at rank 0.99·(n − 1).
//! - **SSIM** (Wang, Bovik, Sheikh and Simoncelli, *Image Quality Assessment: From Error Visibility to Structural Similarity*, IEEE
//!   Transactions on Image Processing, 2004), with its 11 × 11 Gaussian window of σ = 1.5, K₁ = 0.01, K₂ = 0.03 and L = 1, is masked. A
//!   window's weights are zero at pixels that are not judged or lie outside the image, and are normalised again. There is a window at
//!   every judged pixel, and the result is their mean. So no unjudged pixel affects a window. An image that is judged everywhere gets the
//!   paper's values, except that the paper's implementation omits windows that overlap the border.
//! - **Roughness** has its own module, `metrics/roughness.rs`.
//! - **Empty sets** have no mean: `None`, which JSON writes as null.

mod flip;
mod gaussian;
mod roughness;
mod ssim;

use glam::UVec2;
use serde::{Deserialize, Serialize};

use crate::picture::{Visibility, pixel_count};
pub use flip::FlipMap;
use roughness::Roughness;
pub use roughness::TILE_PX;
use ssim::add_ssim;

/// Thresholds of the reference: umbra below the first, lit above the second, penumbra strictly between them.
pub(crate) const UMBRA_BELOW: f32 = 0.01;
pub(crate) const LIT_ABOVE: f32 = 0.99;

/// Errors of a technique. Visibility is a fraction, so all except `ssim` and the counts are fractions
/// too. The best value is 0, for `ssim` 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Root mean square error.
    pub rmse: Option<f64>,
    /// Mean absolute error.
    pub mae: Option<f64>,
    /// 99th percentile of the absolute error.
    pub p99: Option<f64>,
    /// Mean of `max(0, V − V_ref)`: too much light.
    pub leak: Option<f64>,
    /// Mean of `max(0, V_ref − V)`: too much shadow.
    pub overshadow: Option<f64>,
    /// Root mean square error where `0.01 < V_ref < 0.99`.
    pub penumbra_rmse: Option<f64>,
    /// Mean `V` where `V_ref < 0.01`.
    pub umbra_leak: Option<f64>,
    /// Mean `1 − V` where `V_ref > 0.99`.
    pub lit_loss: Option<f64>,
    /// Mean structural similarity of the visibility masks; 1 if they are equal.
    pub ssim: Option<f64>,
    /// Mean FLIP of the shaded images, over the whole image, at 67 pixels per degree; see [`FlipMap`].
    pub flip: Option<f64>,
    /// Visible artefacts: root mean square of the error's detail where the truth is smooth.
    pub roughness: Option<f64>,
    /// Roughness of the worst tile of 32 × 32 pixels; 0 where the truth is not smooth.
    pub worst_tile: Option<f64>,
    /// Mean FLIP of the shaded images over that tile: whether its error is visible.
    pub worst_tile_flip: Option<f64>,
    /// Column and row of that tile's upper left pixel.
    pub worst_tile_at: Option<[u32; 2]>,
    /// Number of judged pixels: with geometry that faces the light's centre.
    pub pixels: u64,
    /// Number of NaN and infinite samples of judged pixels.
    pub non_finite: u64,
}

/// Reason why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricsError {
    /// The images differ in size.
    #[error(
        "the images differ in size: the reference has {reference}, the tested image {tested}; render both at the same size"
    )]
    Sizes {
        /// Size of the reference, pixels.
        reference: UVec2,
        /// Size of the tested image, pixels.
        tested: UVec2,
    },
    /// The mask of judged pixels has another size than the image.
    #[error("the mask has {mask} pixels, but the image has {image}")]
    Mask {
        /// Number of pixels of the mask.
        mask: usize,
        /// Number of pixels of the image.
        image: usize,
    },
    /// The reference contains NaN or an infinity.
    #[error("the reference is {value} at pixel ({x}, {y}), which is not a visibility; trace it again")]
    Reference {
        /// Column of the pixel.
        x: usize,
        /// Row of the pixel, from the top.
        y: usize,
        /// Value of the pixel.
        value: f32,
    },
}

/// Compares a visibility mask with the ground truth over the pixels where `judged` is true. FLIP values
/// are `None` until [`Metrics::add_flip`].
pub fn compare_visibility(
    reference: &Visibility,
    tested: &Visibility,
    judged: &[bool],
) -> Result<Metrics, MetricsError> {
    let (pixels, channels) = checked(reference, tested, judged)?;
    let mut sums = Sums::default();
    let mut ssim = Mean::default();
    let mut roughness = Roughness::new(reference.size_px, judged);
    for channel in 0..channels {
        let mut truth = vec![0.0; pixels];
        let mut value = vec![0.0; pixels];
        for i in (0..pixels).filter(|&i| judged[i]) {
            let (v_ref, v) = sample(reference, tested, i, channel)?;
            sums.non_finite += u64::from(!tested.at(i, channel).is_finite());
            sums.add(v_ref, v);
            (truth[i], value[i]) = (f64::from(v_ref), f64::from(v));
        }
        add_ssim(&mut ssim, reference.size_px, &truth, &value, judged);
        roughness.add(&truth, &value);
    }
    let worst_tile = roughness.worst_tile();

    Ok(Metrics {
        rmse: sums.squared.mean().map(f64::sqrt),
        mae: sums.absolute.mean(),
        p99: percentile(&mut sums.absolutes, 0.99),
        leak: sums.leak.mean(),
        overshadow: sums.overshadow.mean(),
        penumbra_rmse: sums.penumbra_squared.mean().map(f64::sqrt),
        umbra_leak: sums.umbra.mean(),
        lit_loss: sums.lit_loss.mean(),
        ssim: ssim.mean(),
        flip: None,
        roughness: roughness.rms(),
        worst_tile: worst_tile.map(|tile| tile.rms),
        worst_tile_flip: None,
        worst_tile_at: worst_tile.map(|tile| tile.at_px),
        pixels: judged.iter().filter(|&&judged| judged).count() as u64,
        non_finite: sums.non_finite,
    })
}

/// Computes only `rmse` and `roughness`, bit-identical to [`compare_visibility`], for frequent calls.
pub fn visibility_errors(
    reference: &Visibility,
    tested: &Visibility,
    judged: &[bool],
) -> Result<VisibilityErrors, MetricsError> {
    let (pixels, channels) = checked(reference, tested, judged)?;
    let mut squared = Mean::default();
    let mut roughness = Roughness::new(reference.size_px, judged);
    for channel in 0..channels {
        let mut truth = vec![0.0; pixels];
        let mut value = vec![0.0; pixels];
        for i in (0..pixels).filter(|&i| judged[i]) {
            let (v_ref, v) = sample(reference, tested, i, channel)?;
            (truth[i], value[i]) = (f64::from(v_ref), f64::from(v));
            squared.add((value[i] - truth[i]).powi(2));
        }
        roughness.add(&truth, &value);
    }
    Ok(VisibilityErrors { rmse: squared.mean().map(f64::sqrt), roughness: roughness.rms() })
}

/// Subset of the [`Metrics`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VisibilityErrors {
    /// Root mean square error.
    pub rmse: Option<f64>,
    /// Visible artefacts.
    pub roughness: Option<f64>,
}

/// Checks that images match. Returns the numbers of pixels and channels.
fn checked(reference: &Visibility, tested: &Visibility, judged: &[bool]) -> Result<(usize, usize), MetricsError> {
    if reference.size_px != tested.size_px {
        return Err(MetricsError::Sizes { reference: reference.size_px, tested: tested.size_px });
    }
    let pixels = pixel_count(reference.size_px);
    if judged.len() != pixels {
        return Err(MetricsError::Mask { mask: judged.len(), image: pixels });
    }
    Ok((pixels, reference.channel_count().max(tested.channel_count())))
}

/// Returns reference and tested value of a pixel; a tested value that is not finite is replaced by the wrong end of [0, 1].
fn sample(reference: &Visibility, tested: &Visibility, i: usize, channel: usize) -> Result<(f32, f32), MetricsError> {
    let v_ref = reference.at(i, channel);
    if !v_ref.is_finite() {
        let width = reference.size_px.x as usize;
        return Err(MetricsError::Reference { x: i % width, y: i / width, value: v_ref });
    }
    let v = tested.at(i, channel);
    let wrong = if v_ref > 0.5 { 0.0 } else { 1.0 };
    Ok((v_ref, if v.is_finite() { v } else { wrong }))
}

/// Mean that is `None` when empty.
#[derive(Default)]
struct Mean {
    sum: f64,
    count: u64,
}

impl Mean {
    fn add(&mut self, v: f64) {
        self.sum += v;
        self.count += 1;
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// Sums over all samples.
#[derive(Default)]
struct Sums {
    squared: Mean,
    absolute: Mean,
    absolutes: Vec<f64>,
    leak: Mean,
    overshadow: Mean,
    penumbra_squared: Mean,
    umbra: Mean,
    lit_loss: Mean,
    non_finite: u64,
}

impl Sums {
    fn add(&mut self, v_ref: f32, v: f32) {
        let (truth, value) = (f64::from(v_ref), f64::from(v));
        let error = value - truth;
        self.squared.add(error * error);
        self.absolute.add(error.abs());
        self.absolutes.push(error.abs());
        self.leak.add(error.max(0.0));
        self.overshadow.add((-error).max(0.0));
        if v_ref < UMBRA_BELOW {
            self.umbra.add(value);
        } else if v_ref > LIT_ABOVE {
            self.lit_loss.add(1.0 - value);
        }
        if v_ref > UMBRA_BELOW && v_ref < LIT_ABOVE {
            self.penumbra_squared.add(error * error);
        }
    }
}

/// Returns the value at rank `fraction · (n − 1)` of the sorted values, interpolated between its neighbours. Reorders `values`.
fn percentile(values: &mut [f64], fraction: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let rank = fraction * last as f64;
    let below = rank.floor() as usize;
    let (_, &mut lower, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let upper = above.iter().copied().min_by(f64::total_cmp).unwrap_or(lower);
    Some(lower + (upper - lower) * (rank - below as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn image(values: &[f32]) -> Visibility {
        Visibility::one(UVec2::new(values.len() as u32, 1), values.to_vec())
    }

    pub(super) fn assert_close(name: &str, got: Option<f64>, want: f64) {
        let got = got.unwrap_or_else(|| panic!("{name} is missing"));
        assert!((got - want).abs() < 1e-7, "{name}: {got}, by hand {want}");
    }

    #[test]
    fn every_metric_matches_hand_computation() {
        // Errors +0.2, −0.1, +0.5, −0.3, and one pixel that is not judged.
        let reference = image(&[0.0, 1.0, 0.5, 0.5, 0.3]);
        let tested = image(&[0.2, 0.9, 1.0, 0.2, 9.0]);
        let m = compare_visibility(&reference, &tested, &[true, true, true, true, false]).unwrap();
        assert_close("rmse", m.rmse, ((0.04 + 0.01 + 0.25 + 0.09) / 4.0_f64).sqrt());
        assert_close("mae", m.mae, 1.1 / 4.0);
        // Sorted 0.1 0.2 0.3 0.5, rank 2.97.
        assert_close("p99", m.p99, 0.3 + 0.97 * 0.2);
        assert_close("leak", m.leak, 0.7 / 4.0);
        assert_close("overshadow", m.overshadow, 0.4 / 4.0);
        assert_close("penumbra_rmse", m.penumbra_rmse, (0.34 / 2.0_f64).sqrt());
        assert_close("umbra_leak", m.umbra_leak, 0.2);
        assert_close("lit_loss", m.lit_loss, 0.1);
        assert_eq!((m.pixels, m.non_finite, m.flip), (4, 0, None));
    }

    #[test]
    fn thresholds_are_strict() {
        // Exactly 0.01 and 0.99 belong to none of umbra, penumbra and lit.
        let m = compare_visibility(&image(&[0.01, 0.99]), &image(&[0.5, 0.5]), &[true; 2]).unwrap();
        assert_eq!((m.umbra_leak, m.penumbra_rmse, m.lit_loss), (None, None, None));
    }

    #[test]
    fn nothing_judged_gives_null_not_zero() {
        let m = compare_visibility(&image(&[0.5]), &image(&[0.7]), &[false]).unwrap();
        assert_eq!(m, Metrics::default());
        let json = serde_json::to_value(&m).unwrap();
        assert!(json["rmse"].is_null() && json["ssim"].is_null());
    }

    #[test]
    fn what_is_not_finite_counts_as_wrong() {
        let reference = image(&[1.0, 0.0, 0.25]);
        let tested = image(&[f32::NAN, f32::NEG_INFINITY, f32::INFINITY]);
        let m = compare_visibility(&reference, &tested, &[true; 3]).unwrap();
        assert_eq!(m.non_finite, 3);
        let errors = visibility_errors(&reference, &tested, &[true; 3]).unwrap();
        assert_eq!((errors.rmse, errors.roughness), (m.rmse, m.roughness));
        assert_close("lit_loss", m.lit_loss, 1.0);
        assert_close("umbra_leak", m.umbra_leak, 1.0);
        assert_close("penumbra_rmse", m.penumbra_rmse, 0.75);
        let json = serde_json::to_string(&m).unwrap();
        assert!(json.contains("\"non_finite\":3"));

        let broken = compare_visibility(&image(&[0.0, f32::NAN]), &image(&[0.0, 0.0]), &[true; 2]);
        assert!(matches!(broken, Err(MetricsError::Reference { x: 1, y: 0, .. })));
        // Pixels that are not judged may have any reference value.
        assert!(compare_visibility(&image(&[0.0, f32::NAN]), &image(&[0.0, 0.0]), &[true, false]).is_ok());
    }

    #[test]
    fn channels_are_samples() {
        let size = UVec2::new(1, 1);
        let reference = Visibility::three(size, vec![Vec3::new(0.0, 0.5, 1.0)]);
        let gray = Visibility::one(size, vec![0.5]);
        let m = compare_visibility(&reference, &gray, &[true]).unwrap();
        assert_close("rmse", m.rmse, (0.5_f64 / 3.0).sqrt());
        assert_close("leak", m.leak, 0.5 / 3.0);
        assert_close("umbra_leak", m.umbra_leak, 0.5);
        assert_close("penumbra_rmse", m.penumbra_rmse, 0.0);
        assert_eq!(m.pixels, 1);
    }

    #[test]
    fn sizes_must_agree() {
        let m = compare_visibility(&image(&[0.0]), &image(&[0.0, 1.0]), &[true]);
        assert!(m.unwrap_err().to_string().contains("differ in size"));
        assert!(matches!(
            compare_visibility(&image(&[0.0]), &image(&[0.0]), &[]),
            Err(MetricsError::Mask { mask: 0, image: 1 })
        ));
    }

    #[test]
    fn percentile_interpolates() {
        let mut ramp: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        assert_eq!(percentile(&mut ramp, 0.99), Some(99.0));
        assert_eq!(percentile(&mut [3.0], 0.99), Some(3.0));
        assert_eq!(percentile(&mut [], 0.99), None);
    }
}
