//! Growth of times with image size, per pass.

use std::collections::BTreeMap;

use crate::advise::store::Measured;

/// Growth of a technique's time from a smaller size to full size, measured with one of its configurations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Growth {
    by_pass: BTreeMap<String, f64>,
    /// Growth of the whole frame, also used for time outside passes.
    whole: f64,
}

impl Growth {
    /// Returns the growth, or `None` if a time is zero. The growth of a pass is clamped to the range from 1 to the ratio of pixels,
    /// because software renderers report zero for some passes.
    pub(super) fn between(small: &Measured, full: &Measured, budget_ms: &[f64], pixels: f64) -> Option<Self> {
        let (load, load_full) = (small.load(budget_ms), full.load(budget_ms));
        if !(load > 0.0 && load_full > 0.0) {
            return None;
        }
        let whole = (load_full / load).max(1.0);
        let of_pass = |(label, full_ms): (&String, &f64)| {
            let small_ms = small.pass_ms.get(label).copied().unwrap_or(0.0);
            (label.clone(), if small_ms > 0.0 { (full_ms / small_ms).clamp(1.0, pixels.max(1.0)) } else { whole })
        };
        Some(Self { by_pass: full.pass_ms.iter().map(of_pass).collect(), whole })
    }

    /// Returns the growth of a configuration measured at the smaller size.
    pub(super) fn of(&self, measured: &Measured) -> f64 {
        let passes_ms: f64 = measured.pass_ms.values().sum();
        // Time between passes, which timestamps do not cover.
        let rest_ms = (measured.ms.iter().sum::<f64>() - passes_ms).max(0.0);
        let all_ms = passes_ms + rest_ms;
        if all_ms <= 0.0 {
            return self.whole;
        }
        let grown = |(label, ms): (&String, &f64)| ms * self.by_pass.get(label).unwrap_or(&self.whole);
        (measured.pass_ms.iter().map(grown).sum::<f64>() + rest_ms * self.whole) / all_ms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time of a map is independent of image size, so its savings stay constant while savings of taps grow.
    #[test]
    fn passes_grow_each_by_itself() {
        let measured = |map_ms: f64, resolve_ms: f64, rest_ms: f64| Measured {
            ms: vec![map_ms + resolve_ms + rest_ms],
            pass_ms: [("map".to_owned(), map_ms), ("resolve".to_owned(), resolve_ms)].into(),
            ..Measured::default()
        };
        let (small, full) = (measured(4.0, 1.0, 0.0), measured(4.0, 16.0, 0.0));
        let growth = Growth::between(&small, &full, &[10.0], 16.0).unwrap();
        assert_eq!(growth.of(&small), 4.0);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} for {b}");
        close(growth.of(&measured(1.0, 1.0, 0.0)) * 2.0, 17.0);
        close(growth.of(&measured(4.0, 0.5, 0.0)) * 4.5, 12.0);
        // Time outside passes grows as the whole does; so does a pass that is missing or reported as zero.
        close(growth.of(&measured(0.0, 0.0, 3.0)), 4.0);
        let late = Growth::between(&measured(4.0, 0.0, 1.0), &full, &[10.0], 16.0).unwrap();
        assert_eq!(late.by_pass["resolve"], 4.0);
        // No pass grows faster than the image or shrinks.
        let odd = Growth::between(&measured(4.0, 0.01, 1.0), &measured(3.0, 16.0, 1.0), &[10.0], 16.0).unwrap();
        assert_eq!((odd.by_pass["map"], odd.by_pass["resolve"]), (1.0, 16.0));
        assert_eq!(Growth::between(&Measured::default(), &full, &[10.0], 16.0), None);
    }
}
