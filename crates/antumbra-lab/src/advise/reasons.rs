//! Reasons of a recommendation, from measurements of the scene and the techniques.

use std::fmt;

use antumbra::{OccluderModel, TechniqueKind};
use serde::{Serialize, Serializer};

use super::simplify::Setting;
use super::{Advice, Config};
use crate::scene_facts::{DEFAULT_MAP_TEXELS, PenumbraFacts, percent};

/// Returns the assumption of a configuration about occluders: the technique's, except where a setting changes it.
fn assumed(config: &Config) -> OccluderModel {
    let has = |key: &str, value: &str| config.settings.iter().any(|(set, to)| *set == key && to == value);
    let is_plain_pcss = config.kind == TechniqueKind::Pcss && (has("layers", "1") || has("attach_contacts", "false"));
    if is_plain_pcss { OccluderModel::OneDepth } else { config.kind.facts().occluders }
}

/// Returns whether a technique looks up blockers in texels of a shadow map.
fn looks_into_a_map(kind: TechniqueKind) -> bool {
    kind.facts().light_maps != "none"
}

/// Share of the penumbra above which several depths count as a feature of the scene.
const MANY: f64 = 0.15;
/// Ratio of 90th percentile to median width above which penumbrae vary.
const VARIES: f64 = 1.6;
/// Width in pixels below which penumbrae are too narrow for their variation to be visible.
const NARROW_PX: f64 = 2.5;
/// Minimum change of error or time for a setting to be mentioned.
const WORTH: f64 = 0.03;

/// A reason with its figures. Its `Display` is one line of text.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the lines say what they are")]
pub enum Reason {
    /// No measured candidate keeps the budget.
    OverBudget,
    /// Light samples are tested one by one, and a share of the penumbra has several depths.
    PointsForDepths { several: f64 },
    /// Light samples are tested one by one, because the budget allows it.
    Points,
    /// Several depths are used, and a share of the penumbra has them.
    SeveralDepths { several: f64 },
    /// One mean depth is enough for a share of the penumbra.
    OneDepthIsEnough { one: f64 },
    /// One mean depth ignores the several depths of a share of the penumbra.
    OneDepthMisses { several: f64 },
    /// One blur width fits, because penumbrae are alike.
    OneWidthFits { median_px: f64, p90_px: f64 },
    /// One blur width does not fit, but techniques with variable width exceed the budget.
    OneWidthAnyway { median_px: f64, p90_px: f64 },
    /// Penumbra widths vary, and the technique follows them.
    WidthsAreFollowed { median_px: f64, p90_px: f64 },
    /// Sharp edges fit, because penumbrae are too narrow to be visible.
    SharpFits { p90_px: f64 },
    /// Sharp edges, because techniques with penumbrae exceed the budget.
    SharpAnyway { median_px: f64, p90_px: f64 },
    /// A share of the blockers is narrower than a texel.
    Thin { share: f64 },
    /// A share of the blockers lets some light through.
    Tinted { share: f64 },
    /// The next best technique has a larger error.
    NextBest { name: String, errs: f64, best_errs: f64 },
    /// Effect of a setting as ratios of error and of time; `None` if unchanged or not distinguishable.
    Pays { key: &'static str, value: String, default: String, error: Option<f64>, time: Option<f64> },
    /// The spread of the recommendation's times crosses the budget.
    TooNoisyToTell { low_ms: f64, high_ms: f64 },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let layered = |several: f64| format!("two or more depths of occluders in {} of the penumbra", percent(several));
        match self {
            Self::OverBudget => {
                f.write_str("no measured configuration keeps the budget and the limits; this one is closest")
            }
            Self::PointsForDepths { several } => {
                write!(f, "{}: this technique tests each light sample and needs no mean depth", layered(*several))
            }
            Self::Points => f.write_str("the budget is large enough to test each light sample"),
            Self::SeveralDepths { several } => {
                write!(f, "{}: one mean depth is not enough, and this technique uses several", layered(*several))
            }
            Self::OneDepthIsEnough { one } => {
                write!(f, "one depth of occluders in {} of the penumbra: a mean depth is enough", percent(*one))
            }
            Self::OneDepthMisses { several } => write!(
                f,
                "{}, which one mean depth cannot represent; techniques that represent several take longer or have more error",
                layered(*several)
            ),
            Self::OneWidthFits { median_px, p90_px } => write!(
                f,
                "penumbrae have similar widths (median {median_px:.1} px, 90th percentile {p90_px:.1}): a constant blur is enough"
            ),
            Self::OneWidthAnyway { median_px, p90_px } => write!(
                f,
                "penumbrae vary in width (median {median_px:.1} px, 90th percentile {p90_px:.1}), but techniques that adapt to \
                 the width take longer or have more error than a constant blur"
            ),
            Self::WidthsAreFollowed { median_px, p90_px } => write!(
                f,
                "penumbrae vary in width (median {median_px:.1} px, 90th percentile {p90_px:.1}): a constant blur does not match them"
            ),
            Self::SharpFits { p90_px } => {
                write!(f, "90 % of penumbrae are narrower than {p90_px:.1} px: hard edges are enough")
            }
            Self::SharpAnyway { median_px, p90_px } => write!(
                f,
                "penumbrae are wide (median {median_px:.1} px, 90th percentile {p90_px:.1}), but this technique draws hard \
                 edges: techniques with penumbrae take longer or have more error"
            ),
            Self::Thin { share } => write!(
                f,
                "{} of the occluders are narrower than a texel of a {DEFAULT_MAP_TEXELS}² map: the error depends on the map's resolution",
                percent(*share)
            ),
            Self::Tinted { share } => write!(f, "{} of the occluders are partly transparent", percent(*share)),
            Self::NextBest { name, errs, best_errs } => {
                write!(
                    f,
                    "the next best technique within the budget, {name}, has an error of {errs:.4}; this one has {best_errs:.4}"
                )
            }
            Self::Pays { key, value, default, error, time } => {
                let change = |ratio: f64, what: &str| {
                    let direction = if ratio < 1.0 { "less" } else { "more" };
                    format!("{:.0} % {direction} {what}", 100.0 * (ratio - 1.0).abs())
                };
                let changes: Vec<String> =
                    [error.map(|ratio| change(ratio, "error")), time.map(|ratio| change(ratio, "time"))]
                        .into_iter()
                        .flatten()
                        .collect();
                write!(f, "{key} = {value} instead of {default}: {}", changes.join(", "))
            }
            Self::TooNoisyToTell { low_ms, high_ms } => write!(
                f,
                "times vary too much to decide whether it keeps the budget, from {low_ms:.2} to {high_ms:.2} ms; measure on an idle machine"
            ),
        }
    }
}

/// Serialises as the line of text.
impl Serialize for Reason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Returns the reasons, most important first.
pub(super) fn reasons(advice: &Advice, settings: &[Setting]) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let best = &advice.best;
    if !advice.keeps_budget {
        reasons.push(Reason::OverBudget);
    }
    if let Some(penumbra) = worst_penumbra(advice) {
        reasons.extend(of_penumbra(assumed(&best.config), looks_into_a_map(best.config.kind), &penumbra));
    }
    let next_best = |name: &str, errs: f64, best_errs: f64| {
        // Errors that print alike are no reason.
        (format!("{errs:.4}") != format!("{best_errs:.4}")).then(|| Reason::NextBest {
            name: name.to_owned(),
            errs,
            best_errs,
        })
    };
    let next = advice.runners_up.first();
    reasons.extend(next.and_then(|next| next_best(&next.name, next.objective(), best.objective())));
    reasons.extend(settings.iter().filter_map(of_setting));
    if advice.is_too_noisy_to_tell && advice.keeps_budget {
        let [low_ms, high_ms] = best.worst_spread_ms();
        reasons.push(Reason::TooNoisyToTell { low_ms, high_ms });
    }
    reasons
}

/// Returns the reasons that follow from the penumbra and the technique's assumption.
fn of_penumbra(assumes: OccluderModel, looks_into_a_map: bool, penumbra: &PenumbraFacts) -> Vec<Reason> {
    let several = penumbra.two_depths + penumbra.more_depths;
    let (median_px, p90_px) = (penumbra.width_px.median, penumbra.width_px.p90);
    let (is_narrow, varies) = (p90_px < NARROW_PX, p90_px >= VARIES * median_px);
    let mut reasons = vec![match assumes {
        OccluderModel::NoPenumbra if is_narrow => Reason::SharpFits { p90_px },
        OccluderModel::NoPenumbra => Reason::SharpAnyway { median_px, p90_px },
        OccluderModel::OneWidth if is_narrow || !varies => Reason::OneWidthFits { median_px, p90_px },
        OccluderModel::OneWidth => Reason::OneWidthAnyway { median_px, p90_px },
        OccluderModel::OneDepth | OccluderModel::SeveralDepths if several <= MANY => {
            Reason::OneDepthIsEnough { one: penumbra.one_depth }
        }
        OccluderModel::OneDepth => Reason::OneDepthMisses { several },
        OccluderModel::SeveralDepths => Reason::SeveralDepths { several },
        OccluderModel::Any if several > MANY => Reason::PointsForDepths { several },
        OccluderModel::Any => Reason::Points,
    }];
    if !assumes.has_fixed_width() && varies && !is_narrow {
        reasons.push(Reason::WidthsAreFollowed { median_px, p90_px });
    }
    if looks_into_a_map && penumbra.thin > MANY {
        reasons.push(Reason::Thin { share: penumbra.thin });
    }
    if penumbra.tinted > 0.0 {
        reasons.push(Reason::Tinted { share: penumbra.tinted });
    }
    reasons
}

/// Returns the penumbra of the view with the smallest share of single-depth pixels.
fn worst_penumbra(advice: &Advice) -> Option<PenumbraFacts> {
    let penumbrae = advice.facts.iter().filter_map(|facts| facts.penumbra);
    penumbrae.min_by(|a, b| a.one_depth.total_cmp(&b.one_depth))
}

/// Returns the effect of a setting, if large enough to mention.
fn of_setting(setting: &Setting) -> Option<Reason> {
    let worth = |ratio: f64| ((ratio - 1.0).abs() >= WORTH).then_some(ratio);
    let (error, time) = (worth(setting.error), setting.time.and_then(worth));
    let Setting { key, value, default, .. } = setting.clone();
    (error.is_some() || time.is_some()).then_some(Reason::Pays { key, value, default, error, time })
}

#[cfg(test)]
mod tests {
    use super::super::space::QUALITIES;
    use super::*;
    use crate::scene_facts::Spread;

    /// Declared assumptions agree with the texts beside them.
    #[test]
    fn what_is_assumed_is_what_techniques_describe() {
        for kind in TechniqueKind::ALL.iter().copied() {
            let described = match kind.facts().penumbra {
                "none" => Some(OccluderModel::NoPenumbra),
                "constant width" => Some(OccluderModel::OneWidth),
                _ => None,
            };
            for config in QUALITIES.map(|quality| Config::of_quality(kind, quality)) {
                let assumes = assumed(&config);
                let fixed = assumes.has_fixed_width().then_some(assumes);
                assert_eq!(fixed, described, "{config}: {}", kind.facts().penumbra);
            }
        }
        let pcss = Config::default_of(TechniqueKind::Pcss);
        assert_eq!(assumed(&pcss), OccluderModel::SeveralDepths);
        assert_eq!(assumed(&pcss.with("attach_contacts", "false")), OccluderModel::OneDepth);
        assert!(looks_into_a_map(TechniqueKind::Pcss) && !looks_into_a_map(TechniqueKind::SampleBased));
    }

    fn penumbra(median: f64, p90: f64, several: f64) -> PenumbraFacts {
        let (width_px, one_depth) = (Spread { median, p90 }, 1.0 - several);
        PenumbraFacts { width_px, one_depth, two_depths: several, thin: 0.5, ..PenumbraFacts::default() }
    }

    const ALL: [OccluderModel; 5] = [
        OccluderModel::NoPenumbra,
        OccluderModel::OneWidth,
        OccluderModel::OneDepth,
        OccluderModel::SeveralDepths,
        OccluderModel::Any,
    ];

    /// Reasons match technique and scene: no technique is credited with something it does not do.
    #[test]
    fn reasons_fit_techniques_and_scenes() {
        for (median, p90) in [(0.5, 1.0), (4.0, 5.0), (4.0, 12.0)] {
            for several in [0.0, 0.5] {
                let penumbra = penumbra(median, p90, several);
                for assumes in ALL {
                    for reason in of_penumbra(assumes, true, &penumbra) {
                        let fits = match &reason {
                            Reason::SharpFits { p90_px } => assumes == OccluderModel::NoPenumbra && *p90_px < NARROW_PX,
                            Reason::SharpAnyway { .. } => assumes == OccluderModel::NoPenumbra && p90 >= NARROW_PX,
                            Reason::OneWidthFits { .. } => assumes == OccluderModel::OneWidth && p90 < 3.0 * median,
                            Reason::OneWidthAnyway { .. } => assumes == OccluderModel::OneWidth && p90 == 3.0 * median,
                            Reason::WidthsAreFollowed { .. } => p90 == 3.0 * median && !assumes.has_fixed_width(),
                            Reason::OneDepthIsEnough { one } => {
                                *one == 1.0 && matches!(assumes, OccluderModel::OneDepth | OccluderModel::SeveralDepths)
                            }
                            Reason::OneDepthMisses { several } => assumes == OccluderModel::OneDepth && *several == 0.5,
                            Reason::SeveralDepths { several } => {
                                assumes == OccluderModel::SeveralDepths && *several == 0.5
                            }
                            Reason::PointsForDepths { several } => assumes == OccluderModel::Any && *several == 0.5,
                            Reason::Points => assumes == OccluderModel::Any && several == 0.0,
                            Reason::Thin { share } => *share == 0.5,
                            _ => false,
                        };
                        assert!(fits, "{assumes:?}, {penumbra:?}: {reason}");
                    }
                }
            }
        }
        let lists = of_penumbra(OccluderModel::Any, false, &penumbra(4.0, 5.0, 0.0));
        assert_eq!(lists, [Reason::Points], "lists of receivers have no texels");
    }

    fn setting(error: f64, time: Option<f64>) -> Setting {
        Setting { key: "samples", value: "128".into(), default: "64".into(), error, time }
    }

    /// Effects that are noise or invisibly small are no reason; the others state the measured figures.
    #[test]
    fn settings_are_reasons_by_what_they_measurably_do() {
        assert_eq!(of_setting(&setting(0.99, None)), None);
        assert_eq!(of_setting(&setting(1.0, Some(0.98))), None);
        let line = |error, time| of_setting(&setting(error, time)).unwrap().to_string();
        let slower = line(0.9, Some(1.5));
        assert!(slower.contains("128") && slower.contains("64"), "{slower}");
        assert!(slower.contains("10 % less error") && slower.contains("50 % more time"), "{slower}");
        assert!(!line(0.9, None).contains("time") && !line(1.0, Some(0.5)).contains("error"));
    }
}
