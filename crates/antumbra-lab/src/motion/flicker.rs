//! Flicker: changes of masks between frames, compared with those of the ground truth at the same pixels.
//!
//! M_i is the mask and V_i the truth of frame i, over the pixels that are judged in both frames:
//!
//! ```text
//! flicker      = rms over frames and pixels of (M_i − M_{i−1}) − (V_i − V_{i−1})
//! truth change = rms over frames and pixels of  V_i − V_{i−1}
//! ratio        = flicker / truth change
//! ```
//!
//! A mask with the same error at the same pixel in every frame does not flicker. A mask that stays constant while
//! the truth changes has a ratio of one.
//!
//! **After the stop**, M_N, M_{N+1}, … are compared with the last of them, the settled mask, over the pixels that the motion touched:
//! those at which some frame's truth differs from the last frame's by more than [`SETTLED`]. The lag is the number of frames until the
//! masks stay within [`SETTLED`] of the settled one.
//!
//! Channels are samples, and values that are not finite count as the wrong end of [0, 1], as in [`crate::metrics`].

use crate::picture::{Visibility, pixel_count};

/// Threshold of settling: maximum rms distance to the settled mask, and maximum change of a pixel that a motion has not touched.
pub const SETTLED: f64 = 0.02;

/// Ground truth of one frame.
#[derive(Clone, Debug)]
pub struct TrueFrame {
    /// Visibility of every pixel.
    pub visibility: Visibility,
    /// Whether each pixel is judged in this frame.
    pub judged: Vec<bool>,
}

/// Sums over the frames of a technique.
#[derive(Clone, Debug)]
pub struct FlickerSums {
    /// Squared differences of change, summed over frames and channels, and their number, for each pixel.
    by_pixel: Vec<(f64, u32)>,
    truth_squared: f64,
}

/// Returns a finite value unchanged, and the wrong end of [0, 1] for any other.
fn finite_or_wrong(value: f32, truth: f32) -> f64 {
    let wrong = if truth > 0.5 { 0.0 } else { 1.0 };
    if value.is_finite() { f64::from(value) } else { wrong }
}

impl FlickerSums {
    /// Creates empty sums for images with `pixels` pixels.
    pub fn new(pixels: usize) -> Self {
        Self { by_pixel: vec![(0.0, 0); pixels], truth_squared: 0.0 }
    }

    /// Adds a frame: truths and masks of the previous and the current frame, all of one size.
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

    /// Returns the flicker; `None` if no pixel was judged in two consecutive frames.
    pub fn flicker(&self) -> Option<f64> {
        let samples = self.samples();
        let squared: f64 = self.by_pixel.iter().map(|(squared, _)| squared).sum();
        (samples > 0).then(|| (squared / samples as f64).sqrt())
    }

    /// Returns the truth's own change; `None` if no pixel was judged in two consecutive frames.
    pub fn truth_change(&self) -> Option<f64> {
        let samples = self.samples();
        (samples > 0).then(|| (self.truth_squared / samples as f64).sqrt())
    }

    /// Returns the ratio of flicker to the truth's change; `None` if the truth does not change.
    pub fn ratio(&self) -> Option<f64> {
        let change = self.truth_change().filter(|change| *change > 0.0)?;
        Some(self.flicker()? / change)
    }

    /// Returns each pixel's flicker; 0 if it was never judged.
    pub fn by_pixel(&self) -> Vec<f32> {
        self.by_pixel.iter().map(|(squared, count)| (squared / f64::from((*count).max(1))).sqrt() as f32).collect()
    }
}

fn channels(truth: &TrueFrame, mask: &Visibility) -> usize {
    truth.visibility.channel_count().max(mask.channel_count())
}

/// Returns the judged pixels that a motion touched: some frame's truth differs from the last frame's by more than [`SETTLED`].
///
/// # Panics
/// If there is no frame.
pub fn touched_pixels(truths: &[TrueFrame]) -> Vec<usize> {
    let last = truths.last().expect("a motion has at least one frame");
    let differs = |frame: &TrueFrame, i: usize| {
        let change = |c| f64::from(frame.visibility.at(i, c) - last.visibility.at(i, c)).abs();
        frame.judged[i] && (0..last.visibility.channel_count()).any(|c| change(c) > SETTLED)
    };
    let is_touched = |i: &usize| last.judged[*i] && truths.iter().any(|frame| differs(frame, *i));
    (0..pixel_count(last.visibility.size_px)).filter(is_touched).collect()
}

/// Returns the rms distance over `pixels` of each mask after the stop, except the last, to the last one; empty if there are no pixels.
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

/// Returns the number of frames after the stop until the mask stays within [`SETTLED`] of the settled one, from
/// [`distances_to_settled`]: 0 if the frame that stops is already there. `None` if there are no distances, or the last one is still too
/// large, because then the last mask may not be settled.
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

    /// Returns a row of 32 pixels with an edge at `place`: dark before it, lit behind it.
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
        // Two of the 31 judged pixels change in each frame.
        let change = (2.0_f64 / 31.0).sqrt();

        let right = sums(&truths.iter().map(|t| t.visibility.clone()).collect::<Vec<_>>(), &truths);
        assert!(close(right.flicker(), 0.0) && close(right.truth_change(), change) && close(right.ratio(), 0.0));

        let frozen = sums(&vec![edge(4); 5], &truths);
        assert!(close(frozen.flicker(), change) && close(frozen.ratio(), 1.0));

        // A constant error does not flicker; an error in every second frame flickers equally everywhere.
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

    /// Masks that lag some frames behind, as ghosting does.
    #[test]
    fn lag_is_measured_by_the_distance_to_the_settled_mask() {
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
        // Masks that never settle have no lag.
        let restless: Vec<_> = (0..12).map(|frame| edge(5 + frame % 2)).collect();
        assert_eq!(lag_frames(&distances_to_settled(&restless[..11], &truths[10], &touched)), None);
        assert_eq!(lag_frames(&distances_to_settled(&restless, &truths[10], &[])), None);
    }
}
