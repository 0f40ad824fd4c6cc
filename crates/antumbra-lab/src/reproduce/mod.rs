//! The papers' tables and figures beside our own.
//!
//! [`PAPERS`] is the catalogue: each exhibit with the rows to run for it and the paper's own figure. A row whose
//! technique is not in the library yet says so; nothing else has to be done when the technique arrives. To add an
//! exhibit or a row, add an entry in `papers/`.

mod exhibit;
mod papers;
mod preset;
mod run;

pub use exhibit::{Exhibit, Measure, Paper, Reported, Row};
pub use papers::PAPERS;
pub use preset::{PRESETS, Preset};
pub use run::{Outcome, run_row};

use antumbra::TechniqueKind;

/// Whether an exhibit can be run today.
#[derive(Clone, Debug, PartialEq)]
pub enum Readiness {
    /// A drawing: nothing to run.
    Drawing,
    /// Every row can be run.
    Ready,
    /// Some rows can; the others need these techniques.
    Partly(Vec<&'static str>),
    /// No row can before these techniques are there.
    NotYet(Vec<&'static str>),
}

impl Exhibit {
    /// Whether it can be run today.
    pub fn readiness(&self) -> Readiness {
        let mut missing: Vec<&'static str> = Vec::new();
        for row in self.rows.iter().filter(|row| row.kind().is_none()) {
            if !missing.contains(&row.technique) {
                missing.push(row.technique);
            }
        }
        match (self.rows.is_empty(), missing.is_empty()) {
            (true, _) => Readiness::Drawing,
            (false, true) => Readiness::Ready,
            _ if self.rows.iter().any(|row| row.kind().is_some()) => Readiness::Partly(missing),
            _ => Readiness::NotYet(missing),
        }
    }
}

impl Row {
    /// The technique, where the library has it.
    pub fn kind(&self) -> Option<TechniqueKind> {
        TechniqueKind::from_name(self.technique)
    }
}

/// Every exhibit with its full name, `marrs-2014/figure3`.
pub fn exhibits() -> impl Iterator<Item = (String, &'static Paper, &'static Exhibit)> {
    PAPERS.iter().flat_map(|paper| {
        paper.exhibits.iter().map(move |exhibit| (format!("{}/{}", paper.id, exhibit.id), paper, exhibit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra::contract::ParamValue;

    #[test]
    fn names_are_unique() {
        let mut names: Vec<String> = exhibits().map(|(name, ..)| name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn built_in_scenes_exist() {
        for (name, _, exhibit) in exhibits() {
            for spec in exhibit.rows.iter().filter_map(|row| row.scene.strip_prefix("builtin:")) {
                let base = spec.split('?').next().unwrap_or_default();
                let known = antumbra_scene::builtin::NAMES.iter().any(|info| info.name == base);
                assert!(known, "{name}: there is no built-in scene {base}");
            }
        }
    }

    /// A technique that arrives must have the parameters that its rows set.
    #[test]
    fn settings_fit_their_techniques() {
        for (name, _, exhibit) in exhibits() {
            for row in exhibit.rows {
                let Some(kind) = row.kind() else { continue };
                for (key, value) in row.settings {
                    let spec = kind.param_specs().iter().find(|spec| spec.key == *key);
                    let spec = spec.unwrap_or_else(|| panic!("{name}: {kind} has no parameter {key}"));
                    match spec.default {
                        ParamValue::Choice(_) => assert!(spec.choices.contains(value), "{name}: {key}={value}"),
                        ParamValue::Bool(_) => assert!(value.parse::<bool>().is_ok(), "{name}: {key}={value}"),
                        _ => {
                            let number: f64 = value.parse().unwrap();
                            let (low, high) = spec.range.unwrap();
                            assert!((low..=high).contains(&number), "{name}: {key}={value}");
                        }
                    }
                }
            }
        }
    }
}
