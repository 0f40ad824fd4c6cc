//! Why a recommendation is what it is: from what was measured of the scene, and of the techniques.

use antumbra::TechniqueKind;

use super::finalists::Setting;
use super::{Advice, Config};
use crate::scene_facts::{PenumbraFacts, percent};

/// What a technique assumes of the occluders between a receiver and the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Assumes {
    /// Nothing of their size or depth: shadows are sharp, or blurred by one width.
    OneWidth,
    /// One mean depth.
    OneDepth,
    /// A few depths.
    SeveralDepths,
    /// Nothing: the light's points are asked one by one.
    Nothing,
}

impl Assumes {
    fn of(config: &Config) -> Self {
        use TechniqueKind as Kind;
        let has = |key: &str, value: &str| config.settings.iter().any(|(set, to)| *set == key && to == value);
        match config.kind {
            Kind::Pcss if has("layers", "1") || has("attach_contacts", "false") => Self::OneDepth,
            Kind::Pcss | Kind::MultiLayer => Self::SeveralDepths,
            Kind::MultiView | Kind::Reprojection | Kind::ReprojectionLayered | Kind::SampleBased => Self::Nothing,
            Kind::PcssAnisotropic | Kind::Essm | Kind::Savsm | Kind::Vssm | Kind::Cssm | Kind::Evssm | Kind::Mssm => {
                Self::OneDepth
            }
            _ => Self::OneWidth,
        }
    }
}

/// Above such a share several depths count as a feature of the scene.
const MANY: f64 = 0.15;
/// Penumbrae whose upper end is so many times their middle vary.
const VARIES: f64 = 1.6;
/// And below so many pixels nobody sees by how much.
const NARROW_PX: f64 = 2.5;
/// A setting is worth words from this change of error or time on.
const WORTH: f64 = 0.03;

/// The reasons, the weightiest first.
pub(super) fn reasons(advice: &Advice, settings: &[Setting]) -> Vec<String> {
    let mut reasons = Vec::new();
    let best = &advice.best;
    let assumes = Assumes::of(&best.config);
    if !advice.keeps_budget {
        reasons.push("nothing that was measured keeps the budget; this comes nearest".into());
    }
    if let Some(penumbra) = worst_penumbra(advice) {
        let several = penumbra.two_depths + penumbra.more_depths;
        let (median, p90) = (penumbra.width_px.median, penumbra.width_px.p90);
        let layered = format!("two or more depths of occluders in {} of the penumbra", percent(several));
        match assumes {
            Assumes::Nothing if several > MANY => {
                reasons.push(format!("{layered}: it asks the light's points one by one and assumes no mean depth"));
            }
            Assumes::Nothing => reasons.push("the budget is enough to ask the light's points one by one".into()),
            Assumes::SeveralDepths if several > MANY => {
                reasons.push(format!("{layered}: one mean depth is not enough, and it keeps several"));
            }
            Assumes::SeveralDepths | Assumes::OneDepth if several <= MANY => reasons.push(format!(
                "one depth of occluders in {} of the penumbra: a mean depth is enough",
                percent(penumbra.one_depth)
            )),
            Assumes::OneDepth | Assumes::SeveralDepths => {
                reasons.push(format!("{layered}, which one mean depth misses; what does not miss it errs more in this time"));
            }
            Assumes::OneWidth if p90 < VARIES * median || p90 < NARROW_PX => reasons.push(format!(
                "penumbrae are alike, {median:.1} px wide and nine of ten below {p90:.1}: one width of blur does"
            )),
            Assumes::OneWidth => reasons.push(format!(
                "penumbrae vary, {median:.1} px wide and one in ten beyond {p90:.1}, but what follows them takes longer or errs more"
            )),
        }
        if assumes != Assumes::OneWidth && p90 >= VARIES * median && p90 >= NARROW_PX {
            reasons.push(format!(
                "penumbrae are {median:.1} px wide and one in ten beyond {p90:.1}: a blur of one width misses them"
            ));
        }
        if penumbra.thin > MANY {
            reasons.push(format!(
                "{} of what blocks is narrower than a texel of a map of 1024: errors hang on the map's resolution",
                percent(penumbra.thin)
            ));
        }
        if penumbra.tinted > 0.0 {
            reasons.push(format!("{} of what blocks lets some light through", percent(penumbra.tinted)));
        }
    }
    if let Some(next) = advice.runners_up.first() {
        reasons.push(format!(
            "{}, the next technique within the budget, errs by {:.4} for {:.4}",
            next.name,
            next.objective(),
            best.objective()
        ));
    }
    reasons.extend(settings.iter().filter_map(setting_words));
    if advice.is_too_noisy_to_tell && advice.keeps_budget {
        let [low, high] = best.worst_spread_ms();
        reasons.push(format!(
            "whether it keeps the budget is too noisy to tell: its times run from {low:.2} to {high:.2} ms; time it on an idle machine"
        ));
    }
    reasons
}

/// The penumbra of the view with most depths.
fn worst_penumbra(advice: &Advice) -> Option<PenumbraFacts> {
    let penumbrae = advice.facts.iter().filter_map(|facts| facts.penumbra);
    penumbrae.min_by(|a, b| a.one_depth.total_cmp(&b.one_depth))
}

/// `map_size 512 rather than 1024: 32 % less time, 2 % more error`.
fn setting_words(setting: &Setting) -> Option<String> {
    let change = |ratio: f64, what: &str| {
        let percent = 100.0 * (ratio - 1.0).abs();
        let direction = if ratio < 1.0 { "less" } else { "more" };
        ((ratio - 1.0).abs() >= WORTH).then(|| format!("{percent:.0} % {direction} {what}"))
    };
    let changes: Vec<String> =
        [change(setting.error, "error"), change(setting.time, "time")].into_iter().flatten().collect();
    let Setting { key, value, default, .. } = setting;
    (!changes.is_empty()).then(|| format!("{key} {value} rather than {default}: {}", changes.join(", ")))
}
