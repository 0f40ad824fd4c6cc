//! Metrics for readers: names, meanings, which direction is better. Declared once, for tables, tooltips and the glossary.

use crate::metrics::Metrics;

/// Description of a metric for readers.
pub(super) struct MetricInfo {
    /// Key in `metrics.json`.
    pub(super) key: &'static str,
    /// Name in a table's head.
    pub(super) label: &'static str,
    /// Meaning, in one or two sentences.
    pub(super) meaning: &'static str,
    /// Whether larger values are better.
    pub(super) higher_is_better: bool,
    /// Accessor of the value.
    pub(super) value: fn(&Metrics) -> Option<f64>,
}

impl MetricInfo {
    /// Describes which direction is better.
    pub(super) fn direction(&self) -> &'static str {
        if self.higher_is_better { "higher is better; 1 is perfect" } else { "lower is better; 0 is perfect" }
    }

    /// Returns whether `a` is better than `b`.
    pub(super) fn is_better(&self, a: f64, b: f64) -> bool {
        if self.higher_is_better { a > b } else { a < b }
    }

    /// Returns index and value of the best row; the first of equals.
    pub(super) fn best<'a>(&self, rows: impl Iterator<Item = &'a Metrics>) -> Option<(usize, f64)> {
        rows.enumerate().filter_map(|(i, metrics)| Some((i, (self.value)(metrics)?))).fold(None, |best, (i, v)| {
            match best {
                Some((_, best_v)) if !self.is_better(v, best_v) => best,
                _ => Some((i, v)),
            }
        })
    }
}

/// All metrics, in the order of tables.
pub(super) const METRICS: [MetricInfo; 13] = [
    MetricInfo {
        key: "rmse",
        label: "rmse",
        meaning: "Root mean square error of visibility, the main measure for ranking. Large errors weigh most.",
        higher_is_better: false,
        value: |m| m.rmse,
    },
    MetricInfo {
        key: "mae",
        label: "mae",
        meaning: "Mean absolute error of visibility. Large faint errors count as much as small strong ones.",
        higher_is_better: false,
        value: |m| m.mae,
    },
    MetricInfo {
        key: "p99",
        label: "p99",
        meaning: "99th percentile of the absolute error: the minimum error of the worst hundredth of the pixels.",
        higher_is_better: false,
        value: |m| m.p99,
    },
    MetricInfo {
        key: "leak",
        label: "leak",
        meaning: "Mean of max(0, V − V_ref): too much light. Red in the error map.",
        higher_is_better: false,
        value: |m| m.leak,
    },
    MetricInfo {
        key: "overshadow",
        label: "overshadow",
        meaning: "Mean of max(0, V_ref − V): too much shadow. Blue in the error map.",
        higher_is_better: false,
        value: |m| m.overshadow,
    },
    MetricInfo {
        key: "penumbra_rmse",
        label: "penumbra",
        meaning: "Root mean square error in the penumbra only, where 0.01 < V_ref < 0.99: faults of width and shape.",
        higher_is_better: false,
        value: |m| m.penumbra_rmse,
    },
    MetricInfo {
        key: "umbra_leak",
        label: "umbra leak",
        meaning: "Mean visibility where the truth is full shadow (V_ref < 0.01): light bleeding, detached contacts.",
        higher_is_better: false,
        value: |m| m.umbra_leak,
    },
    MetricInfo {
        key: "lit_loss",
        label: "lit loss",
        meaning: "Mean of 1 − V where the truth is fully lit (V_ref > 0.99): acne, shadows that are too wide.",
        higher_is_better: false,
        value: |m| m.lit_loss,
    },
    MetricInfo {
        key: "ssim",
        label: "ssim",
        meaning: "Structural similarity of the visibility images (Wang et al. 2004), over windows of 11 × 11 pixels.",
        higher_is_better: true,
        value: |m| m.ssim,
    },
    MetricInfo {
        key: "flip",
        label: "flip",
        meaning: "Mean FLIP of the shaded images (Andersson et al. 2020) at 67 pixels per degree: the difference that is \
             visible when alternating between image and truth.",
        higher_is_better: false,
        value: |m| m.flip,
    },
    MetricInfo {
        key: "roughness",
        label: "roughness",
        meaning: "Visible artefacts such as specks, torn edges, acne and noise: rms of what a blur of two pixels removes from \
             the error where the truth is smooth (changes by less than 0.02 per pixel within three pixels).",
        higher_is_better: false,
        value: |m| m.roughness,
    },
    MetricInfo {
        key: "worst_tile",
        label: "worst tile",
        meaning: "Roughness of the worst 32 × 32 pixels; 0 where the truth is not smooth. The error map outlines them.",
        higher_is_better: false,
        value: |m| m.worst_tile,
    },
    MetricInfo {
        key: "worst_tile_flip",
        label: "worst tile's flip",
        meaning: "Mean FLIP of the shaded images over the worst tile: whether its artefacts are visible.",
        higher_is_better: false,
        value: |m| m.worst_tile_flip,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number of `metrics.json`, except counts and the tile's position, has a description under its key.
    #[test]
    fn every_metric_is_declared() {
        let all = Metrics {
            rmse: Some(0.0),
            mae: Some(1.0),
            p99: Some(2.0),
            leak: Some(3.0),
            overshadow: Some(4.0),
            penumbra_rmse: Some(5.0),
            umbra_leak: Some(6.0),
            lit_loss: Some(7.0),
            ssim: Some(8.0),
            flip: Some(9.0),
            roughness: Some(10.0),
            worst_tile: Some(11.0),
            worst_tile_flip: Some(12.0),
            worst_tile_at: Some([13, 14]),
            pixels: 0,
            non_finite: 0,
        };
        let json = serde_json::to_value(&all).unwrap();
        for info in &METRICS {
            assert_eq!(json[info.key].as_f64(), (info.value)(&all), "{}", info.key);
        }
        assert_eq!(json.as_object().unwrap().len(), METRICS.len() + 3);
    }

    #[test]
    fn the_best_is_lowest_or_highest() {
        let with = |v| Metrics { rmse: v, ssim: v, ..Metrics::default() };
        let rows = [with(Some(0.3)), with(None), with(Some(0.2)), with(Some(0.9))];
        let by_key = |key: &str| METRICS.iter().find(|info| info.key == key).unwrap().best(rows.iter());
        assert_eq!(by_key("rmse"), Some((2, 0.2)));
        assert_eq!(by_key("ssim"), Some((3, 0.9)));
        assert_eq!(by_key("flip"), None);
    }
}
