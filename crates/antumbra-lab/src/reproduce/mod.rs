//! Papers' tables and figures beside our own.
//!
//! [`PAPERS`] is the catalogue: each exhibit with its rows to run and the paper's figures. Rows of techniques that the library lacks state
//! so, and run as soon as the technique exists. To add an exhibit or a row, add an entry in `papers/`. Statements of the paper are claims
//! beside the rows, with the rules that decide them; [`Session`] runs rows and decides claims.

mod claim;
mod exhibit;
mod figure;
mod form;
mod motion_row;
mod outcome;
mod papers;
mod preset;
mod run;
mod session;
mod verdict;
mod views;

pub use claim::{Claim, Rule};
pub use exhibit::{Exhibit, Measure, Paper, Plotted, Reported, Row, Settings};
pub use figure::Figure;
pub use form::Form;
pub use outcome::{Measured, Outcome};
pub use papers::PAPERS;
pub use preset::{PRESETS, Preset};
pub use run::{Bench, Pictures, RunOptions, RunResult};
pub use session::{ExhibitResult, PictureFiles, REPRODUCED_NAME, RowResult, Session, VerdictCount};
pub use verdict::{Judged, Outcomes, Ruling, Verdict, judge};
pub use views::VIEWS;

/// Environment variable with the folder of scene files.
pub const SCENES_VARIABLE: &str = "ANTUMBRA_SCENES";

/// Source of the scene files.
pub const SCENES_HINT: &str = "sponza.glb is Khronos' sample model Sponza (github.com/KhronosGroup/glTF-Sample-Assets, \
     Models/Sponza) as one binary glTF file; all other scenes are built in";

/// Returns an exhibit's name, `marrs-2014/figure3`.
fn exhibit_name(paper: &Paper, exhibit: &Exhibit) -> String {
    format!("{}/{}", paper.id, exhibit.id)
}

/// Availability of an exhibit.
#[derive(Clone, Debug, PartialEq)]
pub enum Readiness {
    /// A drawing without anything to run.
    Drawing,
    /// All rows can run.
    Ready,
    /// Some rows can run; the others lack these techniques or scene files.
    Partly(Vec<&'static str>),
    /// No row can run; these techniques or scene files are missing.
    NotYet(Vec<&'static str>),
}

impl Exhibit {
    /// Returns whether the exhibit can run.
    pub fn readiness(&self) -> Readiness {
        let lacks = |row: &Row| row.missing_technique().or((!row.is_ready()).then_some(row.scene));
        let mut missing: Vec<&'static str> = Vec::new();
        for lacking in self.rows.iter().filter_map(lacks) {
            if !missing.contains(&lacking) {
                missing.push(lacking);
            }
        }
        match (self.rows.is_empty(), missing.is_empty()) {
            (true, _) => Readiness::Drawing,
            (false, true) => Readiness::Ready,
            _ if self.rows.iter().any(|row| lacks(row).is_none()) => Readiness::Partly(missing),
            _ => Readiness::NotYet(missing),
        }
    }
}

/// Returns all exhibits with their full names, `marrs-2014/figure3`.
pub fn exhibits() -> impl Iterator<Item = (String, &'static Paper, &'static Exhibit)> {
    PAPERS
        .iter()
        .flat_map(|paper| paper.exhibits.iter().map(move |exhibit| (exhibit_name(paper, exhibit), paper, exhibit)))
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn rows_with_filtered_errors_have_exact_filtering() {
        let mut held = 0;
        for (name, _, exhibit) in exhibits() {
            for row in exhibit.rows.iter().filter(|row| matches!(row.measure, Measure::FilteredError)) {
                let choice = row.choice(Form::Published).unwrap();
                assert!(choice.filtered_truth().is_some(), "{name}: {}", row.what);
                held += 1;
            }
        }
        assert!(held > 10, "{held}");
    }

    #[test]
    fn views_are_setups_and_rows_name_them() {
        for (name, text) in VIEWS {
            let setup = antumbra_scene::Setup::from_toml(text, std::path::Path::new(name)).unwrap();
            assert_eq!(setup.lights.len(), 1, "{name}");
        }
        for (name, _, exhibit) in exhibits() {
            for view in exhibit.rows.iter().filter_map(|row| row.view) {
                assert!(VIEWS.iter().any(|(known, _)| *known == view), "{name}: there is no view {view}");
            }
        }
    }

    /// Rules name existing rows, and figures that these rows measure.
    #[test]
    fn rules_refer_to_measured_rows() {
        for (name, _, exhibit) in exhibits() {
            for (i, row) in exhibit.rows.iter().enumerate() {
                assert!(exhibit.rows[..i].iter().all(|other| other.what != row.what), "{name}: {} twice", row.what);
            }
            for claim in exhibit.claims {
                assert!(!claim.says.is_empty() && claim.rules.is_empty() != claim.needs.is_empty(), "{name}");
                for rule in claim.rules {
                    for what in rule.rows() {
                        let row = exhibit.rows.iter().find(|row| row.what == what);
                        let row = row.unwrap_or_else(|| panic!("{name}: a rule refers to {what}, which is no row"));
                        let is_measured = match rule.figure() {
                            Figure::Flicker => matches!(row.measure, Measure::Motion(_)),
                            Figure::Ms => row.measure.is_timed() || matches!(row.measure, Measure::SceneMs { .. }),
                            figure => !figure.is_of_images() || row.measure.is_error(),
                        };
                        assert!(is_measured, "{name}: {what} has no {}", rule.figure());
                    }
                }
            }
            assert!(
                exhibit.rows.is_empty() || !exhibit.claims.is_empty() || !exhibit.note.is_empty(),
                "{name} has neither claims nor a note why"
            );
        }
    }

    /// Timed rows have one frame, and plots have one axis and lines of several points.
    #[test]
    fn rows_of_plots_can_be_drawn() {
        for (name, _, exhibit) in exhibits() {
            for row in exhibit.rows {
                assert!(!row.is_timed_too || (row.measure.is_error() && row.frames == 1), "{name}: {}", row.what);
            }
            let points: Vec<Plotted> = exhibit.rows.iter().filter_map(|row| row.plotted).collect();
            assert!(points.iter().all(|point| point.axis == points[0].axis && point.at > 0.0), "{name}");
            for point in &points {
                let of_line = points.iter().filter(|other| other.line == point.line).count();
                assert!(of_line > 1, "{name}: {} has one point", point.line);
            }
        }
    }

    /// Returns the settings of rows, and of the techniques that rows are compared with.
    fn all_settings() -> impl Iterator<Item = (String, &'static str, Settings)> {
        exhibits().flat_map(|(name, _, exhibit)| {
            exhibit.rows.iter().flat_map(move |row| {
                let other = match row.measure {
                    Measure::Difference { from, settings } => Some((name.clone(), from, settings)),
                    _ => None,
                };
                let of_row = [row.settings, row.ours];
                of_row
                    .into_iter()
                    .map(|settings| (name.clone(), row.technique, settings))
                    .chain(other)
                    .collect::<Vec<_>>()
            })
        })
    }

    /// Techniques accept the parameters that their rows set.
    #[test]
    fn settings_fit_their_techniques() {
        for (name, technique, settings) in all_settings() {
            let Some(kind) = antumbra::TechniqueKind::from_name(technique) else { continue };
            for (key, value) in settings {
                kind.check(key, value).unwrap_or_else(|error| panic!("{name}: {error}"));
            }
        }
    }
}
