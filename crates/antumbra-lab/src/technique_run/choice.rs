//! Choice of a technique: its quality, its settings, and passes beside its own; how it is named.

use antumbra::contract::{ParamSpec, SampleWeights};
use antumbra::{Quality, TechniqueKind};

/// A technique with the parameters that a user set.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniqueChoice {
    /// Which technique.
    pub kind: TechniqueKind,
    /// How much it may spend.
    pub quality: Quality,
    /// Keys and values as written, set after what the quality sets; later ones win.
    pub settings: Vec<(String, String)>,
    /// Passes beside its own.
    pub extras: Extras,
}

/// Passes that any technique can have beside its own: what its name ends with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Masks of half the width and height, interpolated: `+half`.
    pub is_half: bool,
    /// Masks made smooth over frames and pixels, as the library does by default where it is asked to: `+denoised`.
    pub is_denoised: bool,
}

impl Extras {
    const HALF: &str = "+half";
    const DENOISED: &str = "+denoised";

    /// Of masks that are made smooth, and nothing else.
    pub const fn denoised() -> Self {
        Self { is_half: false, is_denoised: true }
    }

    /// A technique's name without its ends, and what these say, in any case and order.
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

    /// What a name ends with.
    pub fn suffix(self) -> String {
        let ends = [(self.is_half, Self::HALF), (self.is_denoised, Self::DENOISED)];
        ends.into_iter().filter_map(|(is, end)| is.then_some(end)).collect()
    }
}

/// A name without an end in any case; `None` where it has another.
fn without_end<'n>(name: &'n str, end: &str) -> Option<&'n str> {
    let (head, tail) = name.split_at_checked(name.len().checked_sub(end.len())?)?;
    tail.eq_ignore_ascii_case(end).then_some(head)
}

impl TechniqueChoice {
    /// A technique at its defaults.
    pub fn default_of(kind: TechniqueKind) -> Self {
        Self::of_quality(kind, Quality::Balanced)
    }

    /// A technique that may spend so much.
    pub fn of_quality(kind: TechniqueKind, quality: Quality) -> Self {
        Self { kind, quality, settings: Vec::new(), extras: Extras::default() }
    }

    /// A technique at its defaults, with settings.
    pub fn with_settings(kind: TechniqueKind, settings: Vec<(String, String)>) -> Self {
        Self { settings, ..Self::default_of(kind) }
    }

    /// The same with passes beside its own.
    pub fn with_extras(self, extras: Extras) -> Self {
        Self { extras, ..self }
    }

    /// Name of the technique, with its quality where that is not the default, and its extras: `pcss`, `pcss:fast+half+denoised`.
    pub fn name(&self) -> String {
        let extras = self.extras.suffix();
        match self.quality {
            Quality::Balanced => format!("{}{extras}", self.kind),
            quality => format!("{}:{quality}{extras}", self.kind),
        }
    }

    /// The technique that [`name`](Self::name) names, in any case; `None` where there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        let (name, extras) = Extras::split(name);
        let (kind, quality) = name.split_once(':').map_or((name, None), |(kind, quality)| (kind, Some(quality)));
        let quality = quality.map_or(Some(Quality::default()), Quality::from_name)?;
        let kind = TechniqueKind::from_name(kind).filter(|kind| kind.has_quality(quality))?;
        Some(Self::of_quality(kind, quality).with_extras(extras))
    }

    /// The same technique with exact comparisons under its own kernel in its basis's place: the truth of techniques with
    /// a kernel of fixed width. `None` for the others.
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

    /// The same with masks for shading alone: the part of a light's own irradiance that arrives ([`SampleWeights::Irradiance`]), where the
    /// technique has it and no setting says otherwise.
    pub fn for_shading(&self) -> Self {
        let (key, irradiance) = (SampleWeights::KEY, SampleWeights::Irradiance.to_string());
        let is_set = self.settings.iter().any(|(set, _)| set == key);
        if is_set || !SampleWeights::is_parameter_of(self.kind.param_specs()) {
            return self.clone();
        }
        let weights = [(key.to_owned(), irradiance)];
        Self { settings: self.settings.iter().cloned().chain(weights).collect(), ..self.clone() }
    }

    /// The settings as they would be given to `compare` or `bench`: ` --set pcss.map_size=2048`.
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
