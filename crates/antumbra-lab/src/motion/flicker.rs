//! Flicker: changes of masks from frame to frame, against those of the truth at the same pixels.
//!
//! With M_i the mask and V_i the truth of frame i, over the pixels that are judged in both frames:
//!
//! ```text
//! flicker      = rms over frames and pixels of (M_i − M_{i−1}) − (V_i − V_{i−1})
//! truth change = rms over frames and pixels of  V_i − V_{i−1}
//! ratio        = flicker / truth change
//! ```
//!
//! A mask that is wrong by the same amount at the same pixel in every frame does not flicker; one that stands still while
//! the truth moves has a ratio of one.
//!
//! **After the stop**, M_N, M_{N+1}, … are held against the last of them, the settled mask, over the pixels that the motion
//! touched: those at which some frame's truth is farther than [`SETTLED`] from the last one's. The lag is the number of
//! frames until they stay within [`SETTLED`] of it.
//!
//! Channels are samples, and values that are not finite count as the wrong end of [0, 1], as in [`crate::metrics`].

use crate::picture::{Visibility, pixel_count};

/// A mask this near to the settled one, as an rms, has settled; and what a motion changes by no more it has not touched.
pub const SETTLED: f64 = 0.02;

/// A frame's truth, as far as motion is judged by it.
#[derive(Clone, Debug)]
pub struct TrueFrame {
    /// Visibility of every pixel.
    pub visibility: Visibility,
    /// The pixels that are judged in this frame.
    pub judged: Vec<bool>,
}

/// What is known of a technique's changes so far.
#[derive(Clone, Debug)]
pub struct FlickerSums {
    /// Squared differences of change by pixel, summed over frames and channels, and their number.
    by_pixel: Vec<(f64, u32)>,
    truth_squared: f64,
}

/// A finite value as it is, another as the wrong end of [0, 1].
fn finite_or_wrong(value: f32, truth: f32) -> f64 {
    let wrong = if truth > 0.5 { 0.0 } else { 1.0 };
    if value.is_finite() { f64::from(value) } else { wrong }
}

impl FlickerSums {
    /// Of pictures with so many pixels.
    pub fn new(pixels: usize) -> Self {
        Self { by_pixel: vec![(0.0, 0); pixels], truth_squared: 0.0 }
    }

    /// Takes in a frame: truths and masks of the frame before and of this one, all of one size.
    pub fn add(&mut self, truths: [&TrueFrame; 2], masks: [&Visibility; 2]) {
        for (i, (squared, count)) in self.by_pixel.iter_mut().enumerate() {
            if truths.iter().any(|truth| !truth.judged[i]) {
                continue;
            }
            for channel in 0..channels(truths[0], masks[0]) {
                let [before, after] = [0, 1].map(|k| truths[k].visibility.at(i, channel));
                let true_change = f64::from(after) - f64::from(before);
                let change =
                    finite_or_wrong(masks[1].at(i, channel), after) - finite_or_wrong(masks[0].at(i, channel), before);
                *squared += (change - true_change).powi(2);
                *count += 1;
                self.truth_squared += true_change.powi(2);
            }
        }
    }

    fn samples(&self) -> u64 {
        self.by_pixel.iter().map(|(_, count)| u64::from(*count)).sum()
    }

    /// The flicker; `None` where no pixel was judged in two frames.
    pub fn flicker(&self) -> Option<f64> {
        let samples = self.samples();
        let squared: f64 = self.by_pixel.iter().map(|(squared, _)| squared).sum();
        (samples > 0).then(|| (squared / samples as f64).sqrt())
    }

    /// The truth's own change; `None` where no pixel was judged in two frames.
    pub fn truth_change(&self) -> Option<f64> {
        let samples = self.samples();
        (samples > 0).then(|| (self.truth_squared / samples as f64).sqrt())
    }

    /// The flicker over the truth's change; `None` where the truth does not change.
    pub fn ratio(&self) -> Option<f64> {
        let change = self.truth_change().filter(|change| *change > 0.0)?;
        Some(self.flicker()? / change)
    }

    /// Each pixel's own flicker; 0 where it was never judged.
    pub fn by_pixel(&self) -> Vec<f32> {
        self.by_pixel.iter().map(|(squared, count)| (squared / f64::from((*count).max(1))).sqrt() as f32).collect()
    }
}

fn channels(truth: &TrueFrame, mask: &Visibility) -> usize {
    truth.visibility.channel_count().max(mask.channel_count())
}

/// The judged pixels that a motion touched: where some frame's truth is farther than [`SETTLED`] from the last frame's.
///
/// # Panics
/// Where there is no frame.
pub fn touched_pixels(truths: &[TrueFrame]) -> Vec<usize> {
    let last = truths.last().expect("a motion has a frame at least");
    let differs = |frame: &TrueFrame, i: usize| {
        let change = |c| f64::from(frame.visibility.at(i, c) - last.visibility.at(i, c)).abs();
        frame.judged[i] && (0..last.visibility.channel_count()).any(|c| change(c) > SETTLED)
    };
    let is_touched = |i: &usize| last.judged[*i] && truths.iter().any(|frame| differs(frame, *i));
    (0..pixel_count(last.visibility.size_px)).filter(is_touched).collect()
}

/// How far the masks after the stop are from the last of them, as an rms over `pixels`, for each of them but the last;
/// empty where there is no pixel.
pub fn distances_to_settled(masks: &[Visibility], truth: &TrueFrame, pixels: &[usize]) -> Vec<f64> {
    let Some((settled, before)) = masks.split_last().filter(|_| !pixels.is_empty()) else { return Vec::new() };
    let channels = channels(truth, settled);
    let distance = |mask: &Visibility| {
        let squared = pixels.iter().flat_map(|i| (0..channels).map(move |c| (*i, c))).map(|(i, c)| {
            let value = |mask: &Visibility| finite_or_wrong(mask.at(i, c), truth.visibility.at(i, c));
            (value(mask) - value(settled)).powi(2)
        });
        (squared.sum::<f64>() / (pixels.len() * channels) as f64).sqrt()
    };
    before.iter().map(distance).collect()
}

/// Frames after the stop until the mask stays within [`SETTLED`] of the settled one, of the distances of
/// [`distances_to_settled`]: 0 where it is there in the very frame that stops, `None` where there are no distances or the
/// last of them is still too large, so that nothing says that the last mask is settled.
pub fn lag_frames(distances: &[f64]) -> Option<u32> {
    let last_far = distances.iter().rposition(|distance| *distance > SETTLED);
    match last_far {
        None if distances.is_empty() => None,
        None => Some(0),
        Some(last) if last + 1 == distances.len() => None,
        Some(last) => Some(last as u32 + 1),
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    /// A row of 32 pixels with an edge that has come so far: dark before it, lit behind it.
    fn edge(place: u32) -> Visibility {
        Visibility::one(UVec2::new(32, 1), (0..32).map(|x| if x < place { 0.0 } else { 1.0 }).collect())
    }

    fn truth(place: u32) -> TrueFrame {
        TrueFrame { visibility: edge(place), judged: (0..32).map(|x| x != 31).collect() }
    }

    fn sums(masks: &[Visibility], truths: &[TrueFrame]) -> FlickerSums {
        let mut sums = FlickerSums::new(32);
        for i in 1..masks.len() {
            sums.add([&truths[i - 1], &truths[i]], [&masks[i - 1], &masks[i]]);
        }
        sums
    }

    #[test]
    fn flicker_is_change_that_the_truth_has_not() {
        let truths: Vec<_> = (0..5).map(|i| truth(4 + 2 * i)).collect();
        let close = |got: Option<f64>, want: f64| (got.unwrap() - want).abs() < 1e-9;
        // Two of 31 judged pixels change in each frame.
        let change = (2.0_f64 / 31.0).sqrt();

        let right = sums(&truths.iter().map(|t| t.visibility.clone()).collect::<Vec<_>>(), &truths);
        assert!(close(right.flicker(), 0.0) && close(right.truth_change(), change) && close(right.ratio(), 0.0));

        let frozen = sums(&vec![edge(4); 5], &truths);
        assert!(close(frozen.flicker(), change) && close(frozen.ratio(), 1.0));

        // Always as wrong: no flicker. Wrong in every second frame: flicker, everywhere alike.
        let tinted = |amount: f32, place: u32| {
            Visibility::one(UVec2::new(32, 1), (0..32).map(|i| edge(place).at(i, 0) + amount).collect())
        };
        let steady: Vec<_> = (0..5).map(|i| tinted(0.25, 4 + 2 * i)).collect();
        assert!(close(sums(&steady, &truths).flicker(), 0.0));
        let blinking: Vec<_> = (0..5).map(|i| tinted(0.25 * (i % 2) as f32, 4 + 2 * i)).collect();
        let blinking = sums(&blinking, &truths);
        assert!(close(blinking.flicker(), 0.25));
        assert!(blinking.by_pixel()[..31].iter().all(|v| (v - 0.25).abs() < 1e-6));
        assert_eq!(blinking.by_pixel()[31], 0.0, "never judged");
    }

    #[test]
    fn a_still_truth_has_no_ratio_and_no_pixels_no_flicker() {
        let still = sums(&vec![edge(4); 3], &vec![truth(4); 3]);
        assert_eq!((still.flicker(), still.truth_change(), still.ratio()), (Some(0.0), Some(0.0), None));
        let unjudged = TrueFrame { judged: vec![false; 32], ..truth(4) };
        let nothing = sums(&vec![edge(4); 3], &vec![unjudged; 3]);
        assert_eq!((nothing.flicker(), nothing.ratio()), (None, None));
    }

    #[test]
    fn values_that_are_no_numbers_flicker() {
        let broken = Visibility::one(UVec2::new(32, 1), vec![f32::NAN; 32]);
        let sums = sums(&[edge(4), broken], &vec![truth(4); 2]);
        assert!((sums.flicker().unwrap() - 1.0).abs() < 1e-9, "each counts as the wrong end");
    }

    /// A ghost: masks that come some frames late.
    #[test]
    fn a_mask_that_lags_is_seen_to() {
        const STOP: u32 = 10;
        let truths: Vec<_> = (0..=STOP).map(truth).collect();
        let touched = touched_pixels(&truths);
        assert_eq!(touched, (0..10).collect::<Vec<_>>());
        for late in [0, 1, 3, 7] {
            let masks: Vec<_> = (STOP..STOP + 12).map(|frame| edge((frame - late).min(STOP))).collect();
            let distances = distances_to_settled(&masks, &truths[STOP as usize], &touched);
            assert_eq!(distances.len(), 11);
            assert!((distances[0] - (f64::from(late) / 10.0).sqrt()).abs() < 1e-9, "the share that the ghost holds");
            assert_eq!(lag_frames(&distances), Some(late), "{distances:?}");
        }
        // What never comes to rest is not called settled.
        let restless: Vec<_> = (0..12).map(|frame| edge(5 + frame % 2)).collect();
        assert_eq!(lag_frames(&distances_to_settled(&restless[..11], &truths[10], &touched)), None);
        assert_eq!(lag_frames(&distances_to_settled(&restless, &truths[10], &[])), None);
    }
}
