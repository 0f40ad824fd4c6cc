//! Kernels of separable blurs.

/// Symmetric kernel with unit sum.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kernel {
    /// `2 · radius + 1` weights.
    pub(crate) weights: Vec<f32>,
}

impl Kernel {
    /// Box of `width` texels; its outermost texels are weighted by the part that it covers.
    pub(crate) fn boxed(width: f32) -> Self {
        let half = f64::from(0.5 * width.max(1.0));
        let radius = (half - 0.5).ceil().max(0.0) as i32;
        Self::of(radius, |i| (half - (f64::from(i.abs()) - 0.5)).clamp(0.0, 1.0))
    }

    /// Gaussian with the standard deviation of a box of `width` texels, cut off at three standard deviations and
    /// integrated over each texel.
    pub(crate) fn gaussian(width: f32) -> Self {
        if width <= 1.0 {
            return Self::boxed(1.0);
        }
        let sigma = f64::from(width) / 12f64.sqrt();
        let radius = (3.0 * sigma).ceil() as i32;
        // Simpson's rule over the texel.
        let at = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
        Self::of(radius, |i| {
            let x = f64::from(i);
            (at(x - 0.5) + 4.0 * at(x) + at(x + 0.5)) / 6.0
        })
    }

    fn of(radius: i32, weight: impl Fn(i32) -> f64) -> Self {
        let weights: Vec<f64> = (-radius..=radius).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        Self { weights: weights.into_iter().map(|w| (w / sum) as f32).collect() }
    }

    /// Weights, then their running sums from 0 before the first to 1 at the last.
    pub(super) fn with_running_sums(&self) -> Vec<f32> {
        let mut sum = 0.0;
        let sums = self.weights.iter().map(|weight| {
            sum += f64::from(*weight);
            sum as f32
        });
        self.weights.iter().copied().chain([0.0]).chain(sums).collect()
    }

    /// Number of texels on each side of the centre.
    pub(crate) fn radius(&self) -> u32 {
        self.weights.len() as u32 / 2
    }
}
