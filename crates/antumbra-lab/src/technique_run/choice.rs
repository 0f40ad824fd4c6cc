//! Choice of a technique: quality, settings, additional passes, and its name.

use antumbra::contract::{ParamSpec, SampleWeights};
use antumbra::{Quality, TechniqueKind};

/// A technique with the parameters that a user set.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniqueChoice {
    /// Technique.
    pub kind: TechniqueKind,
    /// Quality preset.
    pub quality: Quality,
    /// Keys and values as written, set after those of the quality; later ones take precedence.
    pub settings: Vec<(String, String)>,
    /// Additional passes.
    pub extras: Extras,
}

/// Additional passes that any technique can have, as suffixes of its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Whether masks have half the width and height and are interpolated: `+half`.
    pub is_half: bool,
    /// Whether masks are denoised over frames and pixels, with the library's defaults: `+denoised`.
    pub is_denoised: bool,
}

impl Extras {
    const HALF: &str = "+half";
    const DENOISED: &str = "+denoised";

    /// Returns denoising as the only additional pass.
    pub const fn denoised() -> Self {
        Self { is_half: false, is_denoised: true }
    }

    /// Splits a technique's name into base name and suffixes, in any case and order.
    pub fn split(name: &str) -> (&str, Self) {
        let (mut name, mut extras) = (name, Self::default());
        loop {
            if let Some(head) = without_end(name, Self::HALF).filter(|_| !extras.is_half) {
                (name, extras.is_half) = (head, true);
            } else if let Some(head) = without_end(name, Self::DENOISED).filter(|_| !extras.is_denoised) {
                (name, extras.is_denoised) = (head, true);
            } else {
                return (name, extras);
            }
        }
    }

    /// Returns the suffix of a name.
    pub fn suffix(self) -> String {
        let ends = [(self.is_half, Self::HALF), (self.is_denoised, Self::DENOISED)];
        ends.into_iter().filter_map(|(is, end)| is.then_some(end)).collect()
    }
}

/// Removes a suffix in any case; `None` if the name does not end with it.
fn without_end<'n>(name: &'n str, end: &str) -> Option<&'n str> {
    let (head, tail) = name.split_at_checked(name.len().checked_sub(end.len())?)?;
    tail.eq_ignore_ascii_case(end).then_some(head)
}

impl TechniqueChoice {
    /// Returns a technique with its defaults.
    pub fn default_of(kind: TechniqueKind) -> Self {
        Self::of_quality(kind, Quality::Balanced)
    }

    /// Returns a technique with a quality.
    pub fn of_quality(kind: TechniqueKind, quality: Quality) -> Self {
        Self { kind, quality, settings: Vec::new(), extras: Extras::default() }
    }

    /// Returns a technique with its defaults and settings.
    pub fn with_settings(kind: TechniqueKind, settings: Vec<(String, String)>) -> Self {
        Self { settings, ..Self::default_of(kind) }
    }

    /// Returns the choice with additional passes.
    pub fn with_extras(self, extras: Extras) -> Self {
        Self { extras, ..self }
    }

    /// Returns the name of the technique, with its quality unless it is the default, and suffixes: `pcss`, `pcss:fast+half+denoised`.
    pub fn name(&self) -> String {
        let extras = self.extras.suffix();
        match self.quality {
            Quality::Balanced => format!("{}{extras}", self.kind),
            quality => format!("{}:{quality}{extras}", self.kind),
        }
    }

    /// Returns the technique of a [`name`](Self::name), in any case; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        let (name, extras) = Extras::split(name);
        let (kind, quality) = name.split_once(':').map_or((name, None), |(kind, quality)| (kind, Some(quality)));
        let quality = quality.map_or(Some(Quality::default()), Quality::from_name)?;
        let kind = TechniqueKind::from_name(kind).filter(|kind| kind.has_quality(quality))?;
        Some(Self::of_quality(kind, quality).with_extras(extras))
    }

    /// Returns the same technique with exact comparisons under its own kernel instead of its basis: the reference of techniques with a
    /// kernel of fixed width. `None` for others.
    pub fn filtered_truth(&self) -> Option<Self> {
        let is_exact = |spec: &&ParamSpec| spec.key == "resolve" && spec.choices.contains(&"exact");
        self.kind.param_specs().iter().find(is_exact)?;
        let exact = [("resolve".to_owned(), "exact".to_owned())];
        Some(Self {
            kind: self.kind,
            quality: self.quality,
            settings: self.settings.iter().cloned().chain(exact).collect(),
            extras: Extras::default(),
        })
    }

    /// Returns the choice with masks for shading only: the arriving fraction of a light's irradiance ([`SampleWeights::Irradiance`]), if
    /// the technique has it and no setting overrides it.
    pub fn for_shading(&self) -> Self {
        let (key, irradiance) = (SampleWeights::KEY, SampleWeights::Irradiance.to_string());
        let is_set = self.settings.iter().any(|(set, _)| set == key);
        if is_set || !SampleWeights::is_parameter_of(self.kind.param_specs()) {
            return self.clone();
        }
        let weights = [(key.to_owned(), irradiance)];
        Self { settings: self.settings.iter().cloned().chain(weights).collect(), ..self.clone() }
    }

    /// Returns the settings as arguments of `compare` or `bench`: ` --set pcss.map_size=2048`.
    pub fn as_arguments(&self) -> String {
        self.settings.iter().map(|(key, value)| format!(" --set {}.{key}={value}", self.name())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for kind in TechniqueKind::ALL.iter().copied() {
            for quality in Quality::ALL.into_iter().filter(|quality| kind.has_quality(*quality)) {
                for (is_half, is_denoised) in [(false, false), (true, false), (false, true), (true, true)] {
                    let extras = Extras { is_half, is_denoised };
                    let choice = TechniqueChoice::of_quality(kind, quality).with_extras(extras);
                    assert_eq!(TechniqueChoice::from_name(&choice.name()), Some(choice.clone()));
                    assert_eq!(TechniqueChoice::from_name(&choice.name().to_uppercase()), Some(choice));
                }
            }
        }
        let both = Extras { is_half: true, is_denoised: true };
        assert_eq!(Extras::split("pcss+denoised+half"), ("pcss", both));
        assert_eq!(
            ["pscs", "pcss:", "pcss:quick", "+denoised", "+half", "pcss+half+half", "pcss:paper", ""]
                .map(TechniqueChoice::from_name),
            [const { None }; 8]
        );
    }

    #[test]
    fn masks_for_shading_are_by_irradiance_unless_someone_says_otherwise() {
        let irradiance = [("weights".to_owned(), "irradiance".to_owned())];
        for kind in TechniqueKind::ALL.iter().copied() {
            let choice = TechniqueChoice::default_of(kind);
            let has_it = matches!(kind, TechniqueKind::RayTraced | TechniqueKind::SampleBased | TechniqueKind::Smrt);
            assert_eq!(choice.for_shading().settings, &irradiance[..usize::from(has_it)], "{kind}");
        }
        let settings = [("samples", "8"), ("weights", "emission")].map(|(key, value)| (key.into(), value.into()));
        let set = TechniqueChoice::with_settings(TechniqueKind::Smrt, settings.to_vec());
        assert_eq!(set.for_shading(), set);
    }
}
