//! Search space: techniques with parameter values, and the steps between values. It is derived entirely from the parameters' declarations.

use std::fmt;

use antumbra::contract::{ParamScale, ParamSpec, ParamValue};
use antumbra::{Quality, TechniqueKind};

use crate::technique_run::TechniqueChoice;

/// Qualities, cheapest first.
pub(super) const QUALITIES: [Quality; 4] = [Quality::Fast, Quality::Balanced, Quality::High, Quality::Best];

/// Parameters that are not searched: options for hosts or debugging (`show`, `resolve`, `keep_bits`, `count_tests`), choices among equals
/// (`seed`), those with another mask in each frame (`jitter`, `accumulate`, `splits_per_frame`) or on each run (`synchronized`), and those
/// whose masks are not visibility, by which masks are judged (`weights`).
const LEFT_ALONE: [&str; 10] = [
    "show",
    "resolve",
    "keep_bits",
    "count_tests",
    "seed",
    "jitter",
    "accumulate",
    "splits_per_frame",
    "synchronized",
    "weights",
];

/// A technique with the parameters that differ from its defaults, in the order of declaration.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Config {
    /// Technique.
    pub kind: TechniqueKind,
    /// Keys and values of the parameters.
    pub settings: Vec<(&'static str, String)>,
}

impl Config {
    /// Returns a technique with default parameters.
    pub fn default_of(kind: TechniqueKind) -> Self {
        Self { kind, settings: Vec::new() }
    }

    /// Returns a technique with the parameters of a quality.
    pub fn of_quality(kind: TechniqueKind, quality: Quality) -> Self {
        let settings = kind.quality_settings(quality);
        settings.into_iter().fold(Self::default_of(kind), |config, (key, value)| config.with(key, &value.to_string()))
    }

    /// Returns the configuration with a parameter set to a value.
    pub fn with(&self, key: &str, value: &str) -> Self {
        let specs = self.kind.param_specs();
        let settings = specs.iter().filter_map(|spec| {
            let value = if spec.key == key { value } else { self.get(spec.key)? };
            (value != spec.default.to_string()).then(|| (spec.key, value.to_owned()))
        });
        Self { kind: self.kind, settings: settings.collect() }
    }

    /// Returns the configuration with a parameter at its default.
    pub(super) fn without(&self, key: &str) -> Self {
        Self { kind: self.kind, settings: self.settings.iter().filter(|(set, _)| *set != key).cloned().collect() }
    }

    /// Returns a parameter's default as text.
    pub(super) fn default_of_key(&self, key: &str) -> String {
        let spec = self.kind.param_specs().iter().find(|spec| spec.key == key);
        spec.map_or_else(String::new, |spec| spec.default.to_string())
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.settings.iter().find(|(set, _)| *set == key).map(|(_, value)| value.as_str())
    }

    /// Returns a parameter's value as text.
    pub fn value(&self, spec: &ParamSpec) -> String {
        self.get(spec.key).map_or_else(|| spec.default.to_string(), str::to_owned)
    }

    /// Returns the quality with these parameters, if there is one.
    pub fn quality(&self) -> Option<Quality> {
        let is = |quality: &Quality| Self::of_quality(self.kind, *quality) == *self;
        std::iter::once(Quality::Balanced).chain(QUALITIES).find(is)
    }

    /// Returns the technique choice to run.
    pub fn choice(&self) -> TechniqueChoice {
        let settings = self.settings.iter().map(|(key, value)| ((*key).to_owned(), value.clone()));
        TechniqueChoice::with_settings(self.kind, settings.collect())
    }

    /// Returns the command-line arguments: `--technique pcss --set map_size=2048`.
    pub fn arguments(&self) -> String {
        let settings: String = self.settings.iter().map(|(key, value)| format!(" --set {key}={value}")).collect();
        format!("--technique {}{settings}", self.kind)
    }
}

impl fmt::Display for Config {
    /// Writes `pcss map_size=2048`, or `pcss:high` if the parameters are those of a quality.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(quality) = self.quality() {
            return f.write_str(&TechniqueChoice::of_quality(self.kind, quality).name());
        }
        write!(f, "{}", self.kind)?;
        self.settings.iter().try_for_each(|(key, value)| write!(f, " {key}={value}"))
    }
}

/// Returns the searched parameters of a technique.
pub(super) fn axes(kind: TechniqueKind) -> impl Iterator<Item = &'static ParamSpec> {
    let is_searched =
        |spec: &&ParamSpec| !LEFT_ALONE.contains(&spec.key) && !matches!(spec.default, ParamValue::List(_));
    kind.param_specs().iter().filter(is_searched)
}

/// Returns the parameters that a technique's qualities set to trade time for error, each with the values set.
pub(super) fn set_by_qualities(kind: TechniqueKind) -> Vec<(&'static ParamSpec, Vec<String>)> {
    let set = QUALITIES.map(|quality| kind.quality_settings(quality));
    let values_of = |spec: &ParamSpec| {
        let of_spec = set.iter().flatten().filter(|(key, _)| *key == spec.key);
        of_spec.map(|(_, value)| value.to_string()).collect::<Vec<_>>()
    };
    axes(kind).map(|spec| (spec, values_of(spec))).filter(|(_, values)| !values.is_empty()).collect()
}

/// Size of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepSize {
    Whole,
    /// Half a step, for numbers only: a choice has no half.
    Half,
}

/// Returns the neighbours of a value. For whole numbers on a logarithmic scale: half and double. For other numbers: two thirds and 1.5
/// times. For a choice: all other values. For a name in place of a number: numbers around the middle of the range.
pub(super) fn steps(spec: &ParamSpec, value: &str, stride: StepSize) -> Vec<String> {
    let Some((low, high)) = spec.range else {
        return match spec.default {
            _ if stride == StepSize::Half => Vec::new(),
            ParamValue::Bool(_) => vec![if value == "true" { "false" } else { "true" }.into()],
            ParamValue::Choice(_) => others(spec, value),
            _ => Vec::new(),
        };
    };
    let Ok(v) = value.parse::<f64>() else {
        let middle = (low.max(1.0) * high).sqrt();
        return if stride == StepSize::Half { Vec::new() } else { numbers(spec, &FACTORS.map(|f| f * middle), value) };
    };
    let ratio: f64 = if spec.scale == ParamScale::Log && spec.is_whole() { 2.0 } else { 1.5 };
    let ratio = if stride == StepSize::Half { ratio.sqrt() } else { ratio };
    let up = if v == 0.0 { (high - low) / 16.0 } else { v * ratio };
    let (down, up) =
        if spec.is_whole() { ((v / ratio).ceil().min(v - 1.0), up.floor().max(v + 1.0)) } else { (v / ratio, up) };
    numbers(spec, &[down, up], value)
}

/// Factors of a fine grid around a number.
const FACTORS: [f64; 4] = [0.25, 0.5, 2.0, 4.0];

/// Returns the grid values of a parameter: those of the qualities, and for numbers also the default, half and double of it, and with
/// `fine` a quarter and four times.
pub(super) fn ladder(spec: &ParamSpec, of_qualities: &[String], fine: bool) -> Vec<String> {
    let default = spec.default.to_string();
    let mut values = match (spec.range, default.parse::<f64>()) {
        (Some(_), Ok(v)) => {
            let factors = if fine { &FACTORS[..] } else { &FACTORS[1..3] };
            numbers(spec, &factors.iter().map(|factor| v * factor).collect::<Vec<_>>(), &default)
        }
        _ => Vec::new(),
    };
    values.extend(of_qualities.iter().chain([&default]).cloned());
    let number = |value: &String| value.parse::<f64>().unwrap_or(0.0);
    values.sort_by(|a, b| number(a).total_cmp(&number(b)).then_with(|| a.cmp(b)));
    values.dedup();
    values
}

fn others(spec: &ParamSpec, value: &str) -> Vec<String> {
    spec.choices.iter().filter(|choice| **choice != value).map(|choice| (*choice).to_owned()).collect()
}

/// Formats numbers to three figures, clamped to the range, without `but`.
fn numbers(spec: &ParamSpec, numbers: &[f64], but: &str) -> Vec<String> {
    let (low, high) = spec.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let text = |v: f64| match spec.is_whole() {
        true => format!("{}", v as u64),
        false => {
            let unit = if v == 0.0 { 1.0 } else { 10_f64.powf(v.abs().log10().floor() - 2.0) };
            ((((v / unit).round() * unit) * 1e6).round() / 1e6) as f32
        }
        .to_string(),
    };
    let mut texts: Vec<String> = numbers.iter().map(|v| text(v.clamp(low, high))).filter(|text| text != but).collect();
    texts.dedup();
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(kind: TechniqueKind, key: &str) -> &'static ParamSpec {
        kind.param_specs().iter().find(|spec| spec.key == key).unwrap()
    }

    #[test]
    fn a_config_holds_what_differs() {
        let fast = Config::of_quality(TechniqueKind::Pcss, Quality::Fast);
        assert_eq!(fast.settings[0], ("map_size", "640".to_owned()));
        assert_eq!((fast.quality(), fast.to_string()), (Some(Quality::Fast), "pcss:fast".into()));
        assert_eq!(fast.with("map_size", "1024").get("map_size"), None, "that is the default");
        let other = Config::default_of(TechniqueKind::Pcss).with("rotate", "false").with("map_size", "256");
        assert_eq!(other.to_string(), "pcss map_size=256 rotate=false");
        assert_eq!(other.arguments(), "--technique pcss --set map_size=256 --set rotate=false");
        assert_eq!(Config::default_of(TechniqueKind::Pcss).to_string(), "pcss");
    }

    #[test]
    fn steps_follow_the_declaration() {
        let pcss = TechniqueKind::Pcss;
        assert_eq!(steps(spec(pcss, "map_size"), "1024", StepSize::Whole), ["512", "2048"]);
        assert_eq!(steps(spec(pcss, "map_size"), "8192", StepSize::Whole), ["4096"]);
        assert_eq!(steps(spec(pcss, "map_size"), "1024", StepSize::Half), ["725", "1448"]);
        assert_eq!(steps(spec(pcss, "layers"), "2", StepSize::Half), ["1", "3"]);
        assert!(steps(spec(pcss, "rotate"), "true", StepSize::Half).is_empty());
        assert_eq!(steps(spec(pcss, "layers"), "1", StepSize::Whole), ["2"]);
        assert_eq!(steps(spec(pcss, "layers"), "3", StepSize::Whole), ["2", "4"]);
        assert_eq!(steps(spec(pcss, "rotate"), "true", StepSize::Whole), ["false"]);
        assert_eq!(steps(spec(pcss, "means"), "layers", StepSize::Whole), ["ranges"]);
        assert_eq!(steps(spec(pcss, "bias_scale"), "1", StepSize::Whole), ["0.667", "1.5"]);
        assert_eq!(steps(spec(TechniqueKind::Vsm, "bleeding_reduction"), "0", StepSize::Whole), ["0.0594"]);
    }

    /// Techniques accept every step of every parameter.
    #[test]
    fn all_steps_are_taken() {
        let mut taken = 0;
        for kind in TechniqueKind::ALL.iter().copied() {
            for config in QUALITIES.map(|quality| Config::of_quality(kind, quality)) {
                for spec in axes(kind) {
                    let value = config.value(spec);
                    for next in steps(spec, &value, StepSize::Whole).iter().chain(&ladder(spec, &[], true)) {
                        kind.check(spec.key, next).unwrap();
                        taken += 1;
                    }
                    assert!(!steps(spec, &value, StepSize::Whole).contains(&value), "{kind}.{}", spec.key);
                }
            }
        }
        assert!(taken > 1000);
    }

    #[test]
    fn ladders_hold_the_default_and_what_qualities_set() {
        let ladder = ladder(spec(TechniqueKind::Pcss, "samples"), &["1024".into(), "128".into()], false);
        assert_eq!(ladder, ["32", "64", "128", "1024"]);
    }
}
