//! One side of the image: a technique with parameters that are validated as they are set.

use antumbra::contract::{ParamSpec, ParamValue, SampleWeights};
use antumbra::{Quality, TechniqueKind};

/// A technique with its quality and the value of every parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    kind: TechniqueKind,
    quality: Quality,
    values: Vec<ParamValue>,
    /// Key of the last invalid setting, and the reason; cleared by the next valid one.
    refused: Option<(&'static str, String)>,
}

impl Side {
    /// Creates a side with a technique's defaults.
    pub fn new(kind: TechniqueKind) -> Self {
        Self { kind, quality: Quality::default(), values: values_of(kind, Quality::default()), refused: None }
    }

    /// Parses a technique's name with an optional quality after a colon: `pcss`, `pcss:fast`.
    pub fn from_name(name: &str) -> Option<Self> {
        let (kind, quality) = name.split_once(':').unwrap_or((name, Quality::default().name()));
        let (kind, quality) = (TechniqueKind::from_name(kind)?, Quality::from_name(quality)?);
        let mut side = Self::new(kind);
        side.set_quality(quality);
        kind.has_quality(quality).then_some(side)
    }

    /// The technique.
    pub fn kind(&self) -> TechniqueKind {
        self.kind
    }

    /// The quality.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Changes the technique and keeps the quality if the new technique has it.
    pub fn set_kind(&mut self, kind: TechniqueKind) {
        if kind != self.kind {
            let quality = self.quality;
            *self = Self::new(kind);
            self.set_quality(quality);
        }
    }

    /// Changes the quality and resets every parameter; uses the default quality if the technique lacks this one.
    pub fn set_quality(&mut self, quality: Quality) {
        self.quality = if self.kind.has_quality(quality) { quality } else { Quality::default() };
        self.reset();
    }

    /// Resets every parameter to the quality's value.
    pub fn reset(&mut self) {
        self.values = values_of(self.kind, self.quality);
        self.refused = None;
    }

    /// Iterates over every parameter and its value, in the documentation's order.
    pub fn params(&self) -> impl Iterator<Item = (&'static ParamSpec, ParamValue)> + '_ {
        self.kind.param_specs().iter().zip(self.values.iter().copied())
    }

    /// Value of a parameter in the current quality.
    pub fn usual(&self, spec: &ParamSpec) -> ParamValue {
        usual(self.kind, self.quality, spec)
    }

    /// Sets a parameter from text. An invalid text changes nothing, and [`refusal`](Self::refusal) returns the reason.
    pub fn set(&mut self, key: &str, text: &str) {
        let specs = self.kind.param_specs();
        let Some(index) = specs.iter().position(|spec| spec.key.eq_ignore_ascii_case(key)) else { return };
        match self.kind.read(key, text) {
            Ok((_, value)) => {
                self.values[index] = value;
                self.refused = None;
            }
            Err(error) => self.refused = Some((specs[index].key, error.to_string())),
        }
    }

    /// Reason why the last setting of a key was refused.
    pub fn refusal(&self, key: &str) -> Option<&str> {
        self.refused.as_ref().filter(|(refused, _)| *refused == key).map(|(_, why)| why.as_str())
    }

    /// Name with quality: `pcss`, or `pcss:fast` if the quality is not the default.
    pub fn name(&self) -> String {
        match self.quality {
            Quality::Balanced => self.kind.name().into(),
            quality => format!("{}:{quality}", self.kind.name()),
        }
    }

    /// Returns the side with masks for shading: the visible fraction of a light's irradiance
    /// ([`SampleWeights::Irradiance`]), if the technique supports it.
    pub fn for_shading(&self) -> Self {
        let mut side = self.clone();
        if SampleWeights::is_parameter_of(self.kind.param_specs()) {
            side.set(SampleWeights::KEY, &SampleWeights::Irradiance.to_string());
        }
        side
    }

    /// Parameters that differ from the quality's values, as text.
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        let differs = |(spec, value): &(&'static ParamSpec, ParamValue)| *value != self.usual(spec);
        self.params().filter(differs).map(|(spec, value)| (spec.key, value.to_string())).collect()
    }
}

fn values_of(kind: TechniqueKind, quality: Quality) -> Vec<ParamValue> {
    kind.param_specs().iter().map(|spec| usual(kind, quality, spec)).collect()
}

fn usual(kind: TechniqueKind, quality: Quality, spec: &ParamSpec) -> ParamValue {
    let settings = kind.quality_settings(quality);
    settings.into_iter().find(|(key, _)| *key == spec.key).map_or(spec.default, |(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_every_technique_reads_back() {
        for &kind in TechniqueKind::ALL {
            for quality in Quality::ALL {
                let mut side = Side::new(kind);
                side.set_quality(quality);
                assert_eq!(Side::from_name(&side.name()), Some(side.clone()));
                let before = side.clone();
                for (spec, value) in before.params() {
                    side.set(spec.key, &value.to_string());
                    assert_eq!(side.refusal(spec.key), None);
                }
                assert_eq!(side, before);
                assert_eq!(side.settings(), []);
            }
        }
    }

    #[test]
    fn a_refused_value_says_why_and_changes_nothing() {
        let mut side = Side::new(TechniqueKind::Pcss);
        let before = side.params().map(|(_, value)| value).collect::<Vec<_>>();
        side.set("map_size", "7");
        assert!(side.refusal("map_size").is_some_and(|why| why.contains("map_size")));
        assert_eq!(side.params().map(|(_, value)| value).collect::<Vec<_>>(), before);
        side.set("map_size", "512");
        assert_eq!(side.refusal("map_size"), None);
        assert_eq!(side.settings(), [("map_size", "512".to_owned())]);
        side.reset();
        assert_eq!(side.settings(), []);
    }
}
