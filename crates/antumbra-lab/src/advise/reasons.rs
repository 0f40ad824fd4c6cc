//! Reasons of a recommendation, from measurements of the scene and of the techniques.

use std::fmt;

use antumbra::TechniqueKind;
use serde::{Serialize, Serializer};

use super::simplify::Setting;
use super::{Advice, Config};
use crate::scene_facts::{DEFAULT_MAP_TEXELS, PenumbraFacts, percent};

/// What a technique assumes of the occluders between a receiver and the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Assumes {
    /// That they cast no penumbra.
    NoWidth,
    /// That all penumbrae are as wide as its kernel.
    OneWidth,
    /// One mean depth.
    OneDepth,
    /// A few depths.
    SeveralDepths,
    /// Nothing: the light's points are asked one by one.
    Nothing,
}

impl Assumes {
    /// `None` of a technique of which nothing is known here: nothing is said of it.
    fn of(config: &Config) -> Option<Self> {
        use TechniqueKind as Kind;
        let has = |key: &str, value: &str| config.settings.iter().any(|(set, to)| *set == key && to == value);
        Some(match config.kind {
            Kind::Hard | Kind::AliasFree => Self::NoWidth,
            Kind::Pcf | Kind::Vsm | Kind::Lvsm | Kind::Evsm | Kind::Esm | Kind::Convolution | Kind::Moment => {
                Self::OneWidth
            }
            Kind::Pcss if has("layers", "1") || has("attach_contacts", "false") => Self::OneDepth,
            Kind::Pcss | Kind::MultiLayer => Self::SeveralDepths,
            Kind::Smrt
            | Kind::Bitmask
            | Kind::Backprojection
            | Kind::MultiView
            | Kind::Reprojection
            | Kind::ReprojectionLayered
            | Kind::RayTraced
            | Kind::SampleBased => Self::Nothing,
            Kind::PcssAnisotropic | Kind::Essm | Kind::Savsm | Kind::Vssm | Kind::Cssm | Kind::Evssm | Kind::Mssm => {
                Self::OneDepth
            }
            _ => return None,
        })
    }
}

/// Whether a technique looks occluders up in texels of a map.
fn looks_into_a_map(kind: TechniqueKind) -> bool {
    !matches!(kind, TechniqueKind::RayTraced | TechniqueKind::AliasFree | TechniqueKind::SampleBased)
}

/// Above such a share several depths count as a feature of the scene.
const MANY: f64 = 0.15;
/// Penumbrae whose upper end is so many times their middle vary.
const VARIES: f64 = 1.6;
/// And below so many pixels nobody sees by how much.
const NARROW_PX: f64 = 2.5;
/// A setting is worth words from this change of error or time on.
const WORTH: f64 = 0.03;

/// A reason, as facts; it reads as a line.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the lines say what they are")]
pub enum Reason {
    /// Nothing that was measured keeps the budget.
    OverBudget,
    /// The light's points are asked one by one, where a share of the penumbra has several depths.
    PointsForDepths { several: f64 },
    /// The light's points are asked one by one, since there is time.
    Points,
    /// Several depths are kept, which a share of the penumbra has.
    SeveralDepths { several: f64 },
    /// One mean depth is enough for a share of the penumbra.
    OneDepthIsEnough { one: f64 },
    /// One mean depth misses what a share of the penumbra has.
    OneDepthMisses { several: f64 },
    /// One width of blur fits penumbrae that are alike.
    OneWidthFits { median_px: f64, p90_px: f64 },
    /// One width of blur does not fit, and what does is out of reach.
    OneWidthAnyway { median_px: f64, p90_px: f64 },
    /// One width of blur would miss widths that vary, and the technique follows them.
    WidthsAreFollowed { median_px: f64, p90_px: f64 },
    /// Sharp edges, where penumbrae are too narrow to be seen.
    SharpFits { p90_px: f64 },
    /// Sharp edges, since what draws penumbrae is out of reach.
    SharpAnyway { median_px: f64, p90_px: f64 },
    /// A share of what blocks is narrower than a texel.
    Thin { share: f64 },
    /// A share of what blocks lets some light through.
    Tinted { share: f64 },
    /// The next technique errs more.
    NextBest { name: String, errs: f64, best_errs: f64 },
    /// What a setting does, as parts of the error and of the time; what does not change, or cannot be told, is `None`.
    Pays { key: &'static str, value: String, default: String, error: Option<f64>, time: Option<f64> },
    /// Its times run across the budget.
    TooNoisyToTell { low_ms: f64, high_ms: f64 },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let layered = |several: f64| format!("two or more depths of occluders in {} of the penumbra", percent(several));
        match self {
            Self::OverBudget => {
                f.write_str("nothing that was measured keeps the budget and the limits; this comes nearest")
            }
            Self::PointsForDepths { several } => {
                write!(f, "{}: it tests light samples one by one and needs no mean depth", layered(*several))
            }
            Self::Points => f.write_str("the budget is enough to test light samples one by one"),
            Self::SeveralDepths { several } => {
                write!(f, "{}: one mean depth is not enough, and it uses several", layered(*several))
            }
            Self::OneDepthIsEnough { one } => {
                write!(f, "one depth of occluders in {} of the penumbra: a mean depth is enough", percent(*one))
            }
            Self::OneDepthMisses { several } => write!(
                f,
                "{}, which one mean depth cannot represent; techniques that can take longer or have more error",
                layered(*several)
            ),
            Self::OneWidthFits { median_px, p90_px } => write!(
                f,
                "penumbrae have similar widths (median {median_px:.1} px, 90th percentile {p90_px:.1}): one width of blur is enough"
            ),
            Self::OneWidthAnyway { median_px, p90_px } => write!(
                f,
                "penumbrae vary in width (median {median_px:.1} px, 90th percentile {p90_px:.1}), but techniques that follow them take \
                 longer or have more error than one width of blur"
            ),
            Self::WidthsAreFollowed { median_px, p90_px } => write!(
                f,
                "penumbrae vary in width (median {median_px:.1} px, 90th percentile {p90_px:.1}): a blur of one width does not fit"
            ),
            Self::SharpFits { p90_px } => {
                write!(f, "90 % of penumbrae are narrower than {p90_px:.1} px: sharp edges are enough")
            }
            Self::SharpAnyway { median_px, p90_px } => write!(
                f,
                "penumbrae are wide (median {median_px:.1} px, 90th percentile {p90_px:.1}), and it draws sharp edges: techniques that \
                 draw them take longer or have more error"
            ),
            Self::Thin { share } => write!(
                f,
                "{} of the occluders are narrower than a texel of a {DEFAULT_MAP_TEXELS}² map: the error depends on the map's resolution",
                percent(*share)
            ),
            Self::Tinted { share } => write!(f, "{} of the occluders let some light through", percent(*share)),
            Self::NextBest { name, errs, best_errs } => {
                write!(
                    f,
                    "{name}, the next best technique within the budget, has an error of {errs:.4}, this one {best_errs:.4}"
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
                write!(f, "{key} {value} instead of {default}: {}", changes.join(", "))
            }
            Self::TooNoisyToTell { low_ms, high_ms } => write!(
                f,
                "times are too noisy to tell whether it keeps the budget: from {low_ms:.2} to {high_ms:.2} ms; measure on an idle machine"
            ),
        }
    }
}

/// As the line that it reads as.
impl Serialize for Reason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The reasons, the weightiest first.
pub(super) fn reasons(advice: &Advice, settings: &[Setting]) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let best = &advice.best;
    if !advice.keeps_budget {
        reasons.push(Reason::OverBudget);
    }
    if let Some((penumbra, assumes)) = worst_penumbra(advice).zip(Assumes::of(&best.config)) {
        reasons.extend(of_penumbra(assumes, looks_into_a_map(best.config.kind), &penumbra));
    }
    let next_best = |name: &str, errs: f64, best_errs: f64| {
        // What reads alike is no reason.
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

/// What the penumbra has to do with what a technique assumes.
fn of_penumbra(assumes: Assumes, looks_into_a_map: bool, penumbra: &PenumbraFacts) -> Vec<Reason> {
    let several = penumbra.two_depths + penumbra.more_depths;
    let (median_px, p90_px) = (penumbra.width_px.median, penumbra.width_px.p90);
    let (is_narrow, varies) = (p90_px < NARROW_PX, p90_px >= VARIES * median_px);
    let mut reasons = vec![match assumes {
        Assumes::NoWidth if is_narrow => Reason::SharpFits { p90_px },
        Assumes::NoWidth => Reason::SharpAnyway { median_px, p90_px },
        Assumes::OneWidth if is_narrow || !varies => Reason::OneWidthFits { median_px, p90_px },
        Assumes::OneWidth => Reason::OneWidthAnyway { median_px, p90_px },
        Assumes::OneDepth | Assumes::SeveralDepths if several <= MANY => {
            Reason::OneDepthIsEnough { one: penumbra.one_depth }
        }
        Assumes::OneDepth => Reason::OneDepthMisses { several },
        Assumes::SeveralDepths => Reason::SeveralDepths { several },
        Assumes::Nothing if several > MANY => Reason::PointsForDepths { several },
        Assumes::Nothing => Reason::Points,
    }];
    let follows = !matches!(assumes, Assumes::NoWidth | Assumes::OneWidth);
    if follows && varies && !is_narrow {
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

/// The penumbra of the view with most depths.
fn worst_penumbra(advice: &Advice) -> Option<PenumbraFacts> {
    let penumbrae = advice.facts.iter().filter_map(|facts| facts.penumbra);
    penumbrae.min_by(|a, b| a.one_depth.total_cmp(&b.one_depth))
}

/// What a setting changes, as far as that is worth words.
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

    /// What is said of a technique is what it declares.
    #[test]
    fn what_is_assumed_is_what_techniques_declare() {
        for kind in TechniqueKind::ALL.iter().copied() {
            let declared = match kind.facts().penumbra {
                "none" => Some(Assumes::NoWidth),
                "of one width" => Some(Assumes::OneWidth),
                _ => None,
            };
            for config in QUALITIES.map(|quality| Config::of_quality(kind, quality)) {
                let assumes = Assumes::of(&config).unwrap_or_else(|| panic!("nothing is known of {kind}"));
                let is_fixed = matches!(assumes, Assumes::NoWidth | Assumes::OneWidth);
                assert_eq!(is_fixed.then_some(assumes), declared, "{config}: {}", kind.facts().penumbra);
            }
            let is_exact = kind.facts().light_maps == "none" || looks_into_a_map(kind);
            assert!(is_exact, "{kind}: {}", kind.facts().light_maps);
        }
        let pcss = Config::default_of(TechniqueKind::Pcss);
        assert_eq!(Assumes::of(&pcss), Some(Assumes::SeveralDepths));
        assert_eq!(Assumes::of(&pcss.with("attach_contacts", "false")), Some(Assumes::OneDepth));
    }

    fn penumbra(median: f64, p90: f64, several: f64) -> PenumbraFacts {
        let (width_px, one_depth) = (Spread { median, p90 }, 1.0 - several);
        PenumbraFacts { width_px, one_depth, two_depths: several, thin: 0.5, ..PenumbraFacts::default() }
    }

    const ALL: [Assumes; 5] =
        [Assumes::NoWidth, Assumes::OneWidth, Assumes::OneDepth, Assumes::SeveralDepths, Assumes::Nothing];

    /// No technique is praised for what it does not do, whatever the scene is like.
    #[test]
    fn reasons_fit_techniques_and_scenes() {
        for (median, p90) in [(0.5, 1.0), (4.0, 5.0), (4.0, 12.0)] {
            for several in [0.0, 0.5] {
                let penumbra = penumbra(median, p90, several);
                for assumes in ALL {
                    for reason in of_penumbra(assumes, true, &penumbra) {
                        let fits = match &reason {
                            Reason::SharpFits { p90_px } => assumes == Assumes::NoWidth && *p90_px < NARROW_PX,
                            Reason::SharpAnyway { .. } => assumes == Assumes::NoWidth && p90 >= NARROW_PX,
                            Reason::OneWidthFits { .. } => assumes == Assumes::OneWidth && p90 < 3.0 * median,
                            Reason::OneWidthAnyway { .. } => assumes == Assumes::OneWidth && p90 == 3.0 * median,
                            Reason::WidthsAreFollowed { .. } => {
                                p90 == 3.0 * median && !matches!(assumes, Assumes::NoWidth | Assumes::OneWidth)
                            }
                            Reason::OneDepthIsEnough { one } => {
                                *one == 1.0 && matches!(assumes, Assumes::OneDepth | Assumes::SeveralDepths)
                            }
                            Reason::OneDepthMisses { several } => assumes == Assumes::OneDepth && *several == 0.5,
                            Reason::SeveralDepths { several } => assumes == Assumes::SeveralDepths && *several == 0.5,
                            Reason::PointsForDepths { several } => assumes == Assumes::Nothing && *several == 0.5,
                            Reason::Points => assumes == Assumes::Nothing && several == 0.0,
                            Reason::Thin { share } => *share == 0.5,
                            _ => false,
                        };
                        assert!(fits, "{assumes:?}, {penumbra:?}: {reason}");
                    }
                }
            }
        }
        let lists = of_penumbra(Assumes::Nothing, false, &penumbra(4.0, 5.0, 0.0));
        assert_eq!(lists, [Reason::Points], "lists of receivers have no texels");
    }

    fn setting(error: f64, time: Option<f64>) -> Setting {
        Setting { key: "samples", value: "128".into(), default: "64".into(), error, time }
    }

    /// What cannot be told from noise, or is too little to be seen, is no reason; what is one has the figures that were measured.
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
