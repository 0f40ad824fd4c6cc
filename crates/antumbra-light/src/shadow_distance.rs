//! Shadow distance: the maximum distance of shadows from a camera.

/// Maximum distance of shadows from the camera's eye, with a fade before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowDistance {
    /// Distance from which on all receivers are lit, metres.
    pub end_m: f32,
    /// Length of the fade that ends there, metres: 0 (no fade) to [`end_m`](Self::end_m).
    pub fade_m: f32,
}

impl ShadowDistance {
    /// Default length of the fade, as a fraction of the distance.
    const USUAL_FADE: f32 = 0.2;

    /// Creates a shadow distance whose last fifth is the fade.
    pub fn new(end_m: f32) -> Self {
        Self { end_m, fade_m: Self::USUAL_FADE * end_m }
    }

    /// Name of the first invalid field, and its valid range; `None` if both are valid.
    pub fn problem(&self) -> Option<(&'static str, &'static str)> {
        if !(self.end_m > 0.0 && self.end_m.is_finite()) {
            return Some(("end_m", "positive and finite"));
        }
        let is_good = (0.0..=self.end_m).contains(&self.fade_m);
        (!is_good).then_some(("fade_m", "from 0 to the distance"))
    }

    /// Fraction of shadow that is lit at a distance from the eye: a smooth step from 0, where the fade begins, to 1 at its end.
    /// Visibility V becomes V + (1 − V) times this.
    pub fn lit_share(&self, distance_m: f32) -> f32 {
        let [begin_m, length_m] = self.fade_span_m();
        let s = ((distance_m - begin_m) / length_m).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    }

    /// Start and length of the fade, metres. The length is never 0, so that it can be divided by.
    pub fn fade_span_m(&self) -> [f32; 2] {
        /// Minimum length, as a fraction of the distance: less than a pixel.
        const MIN_FADE: f32 = 1e-6;
        [self.end_m - self.fade_m, self.fade_m.max(MIN_FADE * self.end_m)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadows_fade_over_the_last_part() {
        let distance = ShadowDistance::new(100.0);
        assert_eq!(distance.fade_m, 20.0);
        assert_eq!([0.0, 50.0, 80.0].map(|d| distance.lit_share(d)), [0.0; 3]);
        assert!((distance.lit_share(90.0) - 0.5).abs() < 1e-6, "half way");
        assert_eq!([100.0, 150.0, 1e9].map(|d| distance.lit_share(d)), [1.0; 3]);
        let shares: Vec<f32> = (0..=20).map(|i| distance.lit_share(80.0 + i as f32)).collect();
        assert!(shares.windows(2).all(|pair| pair[0] < pair[1]), "{shares:?}");
        assert!(shares[1] < 0.01 && shares[19] > 0.99, "flat at both ends: {shares:?}");
        let at_once = ShadowDistance { fade_m: 0.0, ..distance };
        assert_eq!([99.99, 100.01].map(|d| at_once.lit_share(d)), [0.0, 1.0]);
    }

    #[test]
    fn distances_have_bounds() {
        assert_eq!(ShadowDistance::new(50.0).problem(), None);
        for end_m in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(ShadowDistance { end_m, fade_m: 0.0 }.problem().map(|(what, _)| what), Some("end_m"));
        }
        for fade_m in [-1.0, 51.0, f32::NAN] {
            assert_eq!(ShadowDistance { end_m: 50.0, fade_m }.problem().map(|(what, _)| what), Some("fade_m"));
        }
    }
}
