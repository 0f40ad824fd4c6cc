//! Two forms in which a paper's technique is run: as published, and ours.

use std::fmt;

use antumbra::{Quality, TechniqueKind};

use super::exhibit::{Paper, Row};
use crate::error::LabError;
use crate::technique_run::TechniqueChoice;

/// A form of a paper's technique.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// Algorithm of the paper: all departures are off that a parameter can switch off. Verdicts are on this form.
    Published,
    /// Technique with this library's defaults.
    Ours,
}

impl Form {
    /// Returns the name for tables and pages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Published => "as published",
            Self::Ours => "ours",
        }
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Row {
    /// Returns the forms in which the row runs: both if the technique is the paper's own and ours departs from it, else the published one.
    /// Techniques that the paper compares with run as published only, which stands for both forms.
    pub fn forms(&self, paper: &Paper) -> &'static [Form] {
        let kind = TechniqueKind::from_name(self.technique);
        let is_own = paper.own.contains(&self.technique);
        let departs = kind.is_some_and(|kind| kind.published().is_some());
        if is_own && departs && !self.is_published_alone { &[Form::Published, Form::Ours] } else { &[Form::Published] }
    }

    /// Returns the parameters set after the preset's: those of both forms, then the additional ones of ours.
    pub fn settings_of(&self, form: Form) -> impl Iterator<Item = &'static (&'static str, &'static str)> {
        let own = if form == Form::Ours { self.ours } else { &[] };
        self.settings.iter().chain(own)
    }

    /// Returns the technique in a form.
    ///
    /// # Errors
    /// If there is no such technique.
    pub(super) fn choice(&self, form: Form) -> Result<TechniqueChoice, LabError> {
        choice_with(self.technique, form, self.settings_of(form))
    }
}

/// Returns a technique in a form, with settings.
pub(super) fn choice_with(
    technique: &str,
    form: Form,
    settings: impl IntoIterator<Item = &'static (&'static str, &'static str)>,
) -> Result<TechniqueChoice, LabError> {
    let settings = settings.into_iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Ok(TechniqueChoice { settings, ..choice_of_form(technique, form)? })
}

/// Returns the preset of a form: for the published form, `:paper` if the technique has it.
fn choice_of_form(technique: &str, form: Form) -> Result<TechniqueChoice, LabError> {
    let kind = TechniqueKind::from_name(technique)
        .ok_or_else(|| LabError::Request(format!("there is no technique `{technique}`")))?;
    let quality = match form {
        Form::Published if kind.published().is_some() => Quality::Paper,
        _ => Quality::Balanced,
    };
    Ok(TechniqueChoice::of_quality(kind, quality))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use antumbra::contract::ParamValue;

    use super::super::exhibit::error;
    use super::super::papers::PAPERS;
    use super::*;

    /// A paper's own techniques run twice, as published first; others run once, as their own paper publishes them.
    #[test]
    fn own_techniques_have_two_forms() {
        let shen = PAPERS.iter().find(|paper| paper.id == "shen-2013").unwrap();
        let own = error("", "builtin:overlap", "essm").with(&[("map_size", "512")]).ours(&[("table", "tiles")]);
        assert_eq!(own.forms(shen), [Form::Published, Form::Ours]);
        let names = [Form::Published, Form::Ours].map(|form| own.choice(form).unwrap());
        assert_eq!(names.each_ref().map(TechniqueChoice::name), ["essm:paper", "essm"]);
        assert_eq!(names.map(|choice| choice.settings.len()), [1, 2]);
        for (technique, name) in [("vssm", "vssm:paper"), ("pcss", "pcss")] {
            let row = error("", "builtin:overlap", technique);
            assert_eq!(row.forms(shen), [Form::Published]);
            assert_eq!(row.choice(Form::Published).unwrap().name(), name);
        }
    }

    /// Every technique of a paper has a preset with its published form.
    #[test]
    fn own_techniques_have_a_published_preset() {
        for paper in &PAPERS {
            for technique in paper.own {
                let kind = TechniqueKind::from_name(technique).unwrap();
                assert!(kind.published().is_some(), "{}: {technique} has no preset `paper`", paper.id);
            }
        }
    }

    /// Returns all parameters of a row: defaults, then the preset's, then the row's own.
    fn parameters(row: &Row, form: Form) -> BTreeMap<&'static str, ParamValue> {
        let TechniqueChoice { kind, quality, settings, .. } = row.choice(form).unwrap();
        let mut values: BTreeMap<_, _> = kind.param_specs().iter().map(|spec| (spec.key, spec.default)).collect();
        values.extend(kind.quality_settings(quality));
        for (key, value) in &settings {
            let (spec, value) = kind.read(key, value).unwrap();
            values.insert(spec.key, value);
        }
        values
    }

    /// Returns whether two rows run the same measurement, whatever their names and spelling of parameters.
    fn are_one(paper: &Paper, a: &Row, b: &Row) -> bool {
        *a == Row { what: a.what, settings: a.settings, ours: a.ours, ..*b }
            && a.forms(paper).iter().all(|form| parameters(a, *form) == parameters(b, *form))
    }

    /// Any two rows of an exhibit differ in at least one form, so no preset makes them equal.
    #[test]
    fn rows_with_two_names_run_two_things() {
        for paper in &PAPERS {
            for exhibit in paper.exhibits {
                let rows: Vec<&Row> = exhibit.rows.iter().filter(|row| !row.technique.is_empty()).collect();
                for (i, a) in rows.iter().enumerate() {
                    let equal_row = rows[..i].iter().find(|b| are_one(paper, a, b)).map(|b| b.what);
                    assert_eq!(equal_row, None, "{}/{}: `{}` runs the same", paper.id, exhibit.id, a.what);
                }
            }
        }
    }
}
