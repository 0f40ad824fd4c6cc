//! Session: exhibits run one after the other, with results in a folder, from which an interrupted session resumes.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::UVec2;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::exhibit::{Exhibit, Measure, Paper, Row};
use super::form::Form;
use super::outcome::Outcome;
use super::run::{Bench, Pictures, RunOptions, RunResult};
use super::verdict::{Judged, Outcomes, Ruling, Verdict, judge};
use super::{PAPERS, exhibit_name, views};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::image_io::write_png;
use crate::limits::{Limits, Pace, Planned};
use crate::output_files::{FileError, write_atomically};
use crate::progress::Progress;
use crate::store::{Kind, Store};

/// Name of the file with all measurements in a folder of reproductions.
pub const REPRODUCED_NAME: &str = "reproduced.json";

const KIND: Kind = Kind { format: "antumbra-reproduced", version: 3 };

/// Images of a row, as paths relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureFiles {
    /// Image shaded with the technique's mask, or a debug view.
    pub picture: String,
    /// Image shaded with the reference.
    pub reference: Option<String>,
    /// Signed error.
    pub error: Option<String>,
}

/// Stored result of a row.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StoredResult {
    /// Description of the run; if it differs, the row is run again.
    row: Value,
    outcome: Outcome,
    pictures: Option<PictureFiles>,
    /// Time limit that cut the measurement short, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cut_short_s: Option<f64>,
    /// Duration of the run, seconds.
    #[serde(default)]
    seconds: f64,
}

/// Result of a row in one form.
#[derive(Clone, Debug)]
pub struct RowResult {
    /// Row.
    pub row: &'static Row,
    /// Form: as published, or ours.
    pub form: Form,
    /// Outcome of the row.
    pub outcome: Outcome,
    /// Images, if there are any.
    pub pictures: Option<PictureFiles>,
    /// Time limit that cut the measurement short, seconds.
    pub cut_short_s: Option<f64>,
}

/// Results of an exhibit.
#[derive(Clone, Debug)]
pub struct ExhibitResult {
    /// Name: `marrs-2014/figure3`.
    pub name: String,
    /// Paper of the exhibit.
    pub paper: &'static Paper,
    /// Exhibit.
    pub exhibit: &'static Exhibit,
    /// Rows in order, each as published and then, if it has one, in our form.
    pub rows: Vec<RowResult>,
    /// Verdicts on its claims.
    pub judged: Vec<Judged>,
}

/// Numbers of claims that hold, are contradicted, and are undecided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VerdictCount {
    /// Claims with all rules met.
    pub holds: usize,
    /// Claims with a rule that is not met.
    pub contradicted: usize,
    /// Undecided claims.
    pub undecided: usize,
}

impl VerdictCount {
    /// Counts the claims of exhibits: as published, or in our form for those that have one.
    pub fn of<'a>(exhibits: impl IntoIterator<Item = &'a ExhibitResult>, form: Form) -> Self {
        let of_form = |judged: &'a Judged| match form {
            Form::Published => Some(&judged.published),
            Form::Ours => judged.ours.as_ref(),
        };
        Self::of_rulings(exhibits.into_iter().flat_map(|exhibit| &exhibit.judged).filter_map(of_form))
    }

    fn of_rulings<'a>(rulings: impl Iterator<Item = &'a Ruling>) -> Self {
        let mut count = Self::default();
        for ruling in rulings {
            match ruling.verdict {
                Verdict::Holds => count.holds += 1,
                Verdict::Contradicted => count.contradicted += 1,
                Verdict::Undecided(_) => count.undecided += 1,
            }
        }
        count
    }
}

impl fmt::Display for VerdictCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { holds, contradicted, undecided } = self;
        write!(f, "{holds} claims hold, {contradicted} are contradicted, {undecided} cannot be shown here")
    }
}

/// Session that runs exhibits.
#[derive(Debug)]
pub struct Session<'a> {
    bench: Bench<'a>,
    options: RunOptions,
    is_software: bool,
    dir: Option<PathBuf>,
    store: Store<StoredResult>,
    pace: Pace,
    missing: Vec<String>,
}

impl<'a> Session<'a> {
    /// Opens a session in a folder, which is created if needed and resumed if it has results. Without a folder, nothing is stored.
    ///
    /// # Errors
    /// If the folder's measurements have another commit, adapter or options, or cannot be read or written.
    pub fn open(
        lab: &'a LabDevice,
        options: RunOptions,
        limits: Limits,
        dir: Option<&Path>,
        commit: &str,
    ) -> Result<Self, LabError> {
        let about = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "commit": commit,
            "adapter": lab.adapter.name,
            "driver": lab.adapter.driver_and_version(),
            "frames": options.frames,
            "size": options.size_px.map(|size_px| size_px.to_array()),
            "samples": options.samples,
        });
        dir.map(make).transpose()?;
        let store: Store<StoredResult> = Store::open(dir.map(|dir| dir.join(REPRODUCED_NAME)), KIND, about)?;
        if let Some(dir) = dir {
            make(&dir.join("images"))?;
            make(&dir.join("views"))?;
            for (name, text) in views::VIEWS {
                write_atomically(&dir.join("views").join(format!("{name}.toml")), text.as_bytes())?;
            }
        }
        let is_software = lab.adapter.is_software();
        let bench = Bench::new(lab, options).until(limits.deadline);
        let (dir, mut pace) = (dir.map(Path::to_path_buf), Pace::new(limits));
        for kept in store.rows() {
            if let (Some(technique), Ok(size)) =
                (kept.row["technique"].as_str(), serde_json::from_value(kept.row["size"].clone()))
            {
                pace.took(Planned::new(technique, UVec2::from_array(size)), kept.seconds);
            }
        }
        Ok(Self { bench, options, is_software, dir, store, pace, missing: Vec::new() })
    }

    /// Runs those of an exhibit's rows that have no result yet, and calls `each` after every one. For progress, `begun` of `all` rows
    /// precede it. A row that is not expected to end before the deadline is [missing](Self::missing).
    ///
    /// # Errors
    /// If the device fails, or a file cannot be written. The failure of one row is its outcome.
    pub fn run(
        &mut self,
        paper: &'static Paper,
        exhibit: &'static Exhibit,
        progress: &dyn Progress,
        (begun, all): (usize, usize),
        each: &mut dyn FnMut(&Self) -> Result<(), LabError>,
    ) -> Result<ExhibitResult, LabError> {
        let name = exhibit_name(paper, exhibit);
        progress.begin(&name, all as u64);
        let runs = exhibit
            .rows
            .iter()
            .enumerate()
            .flat_map(|(i, row)| row.forms(paper).iter().map(move |form| (i, row, *form)));
        for (done, (i, row, form)) in runs.enumerate() {
            progress.reach((begun + done) as u64);
            if self.kept(&name, row, form).is_some() {
                continue;
            }
            let with_pictures = self.dir.is_some() && shows_picture(exhibit, i);
            let planned = Planned::new(row.technique, self.options.size_of(row));
            let began = Instant::now();
            let (pace, bench) = (&mut self.pace, &mut self.bench);
            let ran = match pace.measure(planned, |end| bench.run(row, form, with_pictures, end)) {
                Ok(None) => {
                    self.missing.push(key(&name, row, form));
                    continue;
                }
                // The device is lost for all rows.
                Err(error @ LabError::Device(_)) => return Err(error),
                Err(error) => {
                    RunResult { outcome: Outcome::Failed(error.to_string()), pictures: None, cut_short_s: None }
                }
                Ok(Some(ran)) => ran,
            };
            let pictures = match (&self.dir, ran.pictures) {
                (Some(dir), Some(pictures)) => Some(write(dir, &pictures, &file_name(&name, i, form), row)?),
                _ => None,
            };
            let seconds = began.elapsed().as_secs_f64();
            let (row_json, cut_short_s) = (described(row, form, &self.options), ran.cut_short_s);
            let kept = StoredResult { row: row_json, outcome: ran.outcome, pictures, cut_short_s, seconds };
            self.store.insert(key(&name, row, form), kept)?;
            // Results survive however this run ends.
            self.store.write()?;
            each(self)?;
        }
        progress.end();
        Ok(self.result(paper, exhibit))
    }

    /// Returns the results of an exhibit from this and earlier runs.
    pub fn result(&self, paper: &'static Paper, exhibit: &'static Exhibit) -> ExhibitResult {
        let name = exhibit_name(paper, exhibit);
        let result = |row: &'static Row, form: Form| match self.store.get(&key(&name, row, form)) {
            Some(kept) if kept.row == described(row, form, &self.options) => RowResult {
                row,
                form,
                outcome: kept.outcome.clone(),
                pictures: kept.pictures.clone(),
                cut_short_s: kept.cut_short_s,
            },
            _ => RowResult { row, form, outcome: Outcome::NotRun, pictures: None, cut_short_s: None },
        };
        let rows: Vec<RowResult> = exhibit
            .rows
            .iter()
            .flat_map(|row| row.forms(paper).iter().map(move |form| (row, *form)))
            .map(|(row, form)| result(row, form))
            .collect();
        let of = |form: Form, row: &Row| {
            rows.iter().find(|one| one.form == form && one.row.what == row.what).map(|one| one.outcome.clone())
        };
        let published: Vec<Outcome> =
            exhibit.rows.iter().map(|row| of(Form::Published, row).unwrap_or(Outcome::NotRun)).collect();
        let ours: Vec<Option<Outcome>> = exhibit.rows.iter().map(|row| of(Form::Ours, row)).collect();
        let judged = judge(exhibit, Outcomes { published: &published, ours: &ours }, self.is_software);
        ExhibitResult { name, paper, exhibit, rows, judged }
    }

    /// Returns the results of every exhibit, by paper.
    pub fn results(&self) -> Vec<(&'static Paper, Vec<ExhibitResult>)> {
        let of = |paper: &'static Paper| paper.exhibits.iter().map(|exhibit| self.result(paper, exhibit)).collect();
        PAPERS.iter().map(|paper| (paper, of(paper))).collect()
    }

    /// Returns the names of the rows that the deadline left out: `marrs-2014/figure1: row, as published`.
    pub fn missing(&self) -> &[String] {
        &self.missing
    }

    /// Returns the number of rows that this session has run.
    pub fn ran(&self) -> usize {
        self.store.fresh
    }

    /// Returns a row's stored result if it is final. A missing technique or scene may be available by now.
    fn kept(&self, name: &str, row: &Row, form: Form) -> Option<&StoredResult> {
        let kept = self.store.get(&key(name, row, form))?;
        let is_final = matches!(kept.outcome, Outcome::Measured(_) | Outcome::Skipped(_));
        let is_cut = self.pace.is_longer_than(kept.cut_short_s);
        (is_final && !is_cut && kept.row == described(row, form, &self.options)).then_some(kept)
    }
}

/// Returns the file name of a row's images: `marrs-2014-figure4-1`, `marrs-2014-figure4-1-ours`.
fn file_name(name: &str, i: usize, form: Form) -> String {
    let end = if form == Form::Ours { "-ours" } else { "" };
    format!("{}-{}{end}", name.replace('/', "-"), i + 1)
}

/// Writes a row's images into the folder `dir`, under the name `own`.
fn write(dir: &Path, pictures: &Pictures, own: &str, row: &Row) -> Result<PictureFiles, LabError> {
    let put = |file: String, picture| -> Result<String, LabError> {
        let path = format!("images/{file}.png");
        write_png(&dir.join(&path), picture)?;
        Ok(path)
    };
    let picture = put(own.to_owned(), &pictures.picture)?;
    // Rows with the same ground truth share its image.
    let named = if row.measure == Measure::Error { truth_name(row) } else { format!("{own}-reference") };
    let reference = pictures.reference.as_ref().map(|reference| put(named, reference)).transpose()?;
    let error = pictures.error.as_ref().map(|error| put(format!("{own}-error"), error)).transpose()?;
    Ok(PictureFiles { picture, reference, error })
}

fn make(dir: &Path) -> Result<(), LabError> {
    Ok(fs::create_dir_all(dir).map_err(|error| FileError::from_write(dir, &error))?)
}

fn key(name: &str, row: &Row, form: Form) -> String {
    format!("{name}: {}, {form}", row.what)
}

/// Returns everything that a row's result depends on.
fn described(row: &Row, form: Form, options: &RunOptions) -> Value {
    let Row { scene, view, technique, light_scale, frames, measure, is_timed_too, .. } = row;
    let settings: Vec<String> = row.settings_of(form).map(|(key, value)| format!("{key}={value}")).collect();
    json!({
        "scene": scene,
        "view": view,
        "technique": technique,
        "form": form.name(),
        "settings": settings,
        "size": options.size_of(row).to_array(),
        "light_scale": light_scale.to_string(),
        "frames": frames,
        "measure": format!("{measure:?}"),
        "is_timed_too": is_timed_too,
    })
}

fn truth_name(row: &Row) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
    let text = format!("{} {} {}", row.scene, row.view.unwrap_or("own"), row.light_scale);
    let (width, height) = row.size_px;
    format!("truth-{}-{width}x{height}", text.chars().map(plain).collect::<String>())
}

/// Returns whether to show a row's image: if images are compared, and otherwise once per scene.
fn shows_picture(exhibit: &Exhibit, i: usize) -> bool {
    let row = &exhibit.rows[i];
    let is_same = |other: &Row| (other.scene, other.view) == (row.scene, row.view) && !other.technique.is_empty();
    row.measure.is_error()
        || matches!(row.measure, Measure::Colors | Measure::Motion(_))
        || !exhibit.rows[..i].iter().any(is_same)
}

#[cfg(test)]
mod tests {
    use super::super::exhibit::{Reported, error, ms};
    use super::*;
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;

    const EXHIBIT: Exhibit = Exhibit {
        id: "figure1",
        shows: "two techniques",
        rows: &[
            error("hard", "builtin:overlap", "hard").with(&[("map_size", "64")]),
            ms("pcf", "builtin:overlap", "pcf", "", Reported::Drawn).with(&[("map_size", "64")]),
            error("elsewhere", "no-such-hall.glb", "hard"),
            error("wrongly", "builtin:overlap", "hard").with(&[("no_such", "1")]),
        ],
        claims: &[],
        note: "",
    };
    static PAPER: Paper =
        Paper { id: "nobody-1999", citation: "", hardware: "", bandwidth_gb_s: 1.0, own: &[], exhibits: &[EXHIBIT] };

    #[test]
    fn pictures_are_of_what_is_compared_and_once_of_each_scene() {
        let row = ms("", "builtin:overlap", "pcf", "", Reported::Drawn);
        const NONE: Exhibit = Exhibit { rows: &[], ..EXHIBIT };
        let rows: &'static [Row] = Box::leak(Box::new([row, row, Row { scene: "builtin:tree", ..row }]));
        let exhibit = Exhibit { rows, ..NONE };
        assert_eq!([0, 1, 2].map(|i| shows_picture(&exhibit, i)), [true, false, true]);
        assert!(shows_picture(&EXHIBIT, 0) && shows_picture(&EXHIBIT, 2));
    }

    /// Every kind of row runs without a folder, and stores its images if there is one.
    #[test]
    fn every_kind_of_row_runs_with_and_without_a_folder() {
        use super::super::exhibit::{colors, difference, filtered_error, fps, in_motion, scene_ms};
        const SMALL: super::super::exhibit::Settings = &[("map_size", "64")];
        const ROWS: &[Row] = &[
            ms("time", "builtin:overlap", "hard", "", Reported::Drawn).with(SMALL),
            fps("frames a second", "builtin:overlap", "hard", 1.0).with(SMALL),
            scene_ms("the scene", "builtin:overlap", 1.0),
            error("error", "builtin:overlap", "hard").with(SMALL),
            filtered_error("filtered error", "builtin:overlap", "vsm").with(SMALL),
            difference("difference", "builtin:overlap", "hard", ("pcf", SMALL)).with(SMALL),
            colors("colours", "builtin:overlap", "lvsm").with(&[("show", "layers"), ("map_size", "64")]),
            error("error and time", "builtin:overlap", "hard").with(SMALL).timed(),
            in_motion("motion", "builtin:overlap", "hard", crate::motion::Motion::Light).with(SMALL),
        ];
        const KINDS: Exhibit = Exhibit { rows: ROWS, ..EXHIBIT };
        static PAPER: Paper =
            Paper { id: "nobody-1998", citation: "", hardware: "", bandwidth_gb_s: 1.0, own: &[], exhibits: &[KINDS] };
        let Some(lab) = lab_or_skip() else { return };
        let dir = tempfile::tempdir().unwrap();
        let options = RunOptions { size_px: Some(UVec2::new(32, 18)), samples: 4, ..RunOptions::for_device(lab, 1) };
        for dir in [None, Some(dir.path())] {
            let mut session = Session::open(lab, options, Limits::default(), dir, "abc").unwrap();
            let rows = (0, ROWS.len());
            let result = session.run(&PAPER, &PAPER.exhibits[0], &Silent, rows, &mut |_| Ok(())).unwrap();
            for RowResult { row, outcome, pictures, .. } in &result.rows {
                let Outcome::Measured(measured) = outcome else { panic!("{}: {outcome:?}", row.what) };
                let is_timed =
                    row.measure.is_timed() || row.is_timed_too || matches!(row.measure, Measure::SceneMs { .. });
                let moves = matches!(row.measure, Measure::Motion(_));
                assert_eq!(measured.flicker.is_some_and(|flicker| flicker > 0.0), moves, "{}", row.what);
                assert_eq!(measured.still_flicker.is_some_and(|change| change > 0.0), moves, "{}", row.what);
                assert_eq!((measured.ms.is_some(), measured.count.is_some()), (is_timed, is_timed), "{}", row.what);
                // The first frame never counts.
                assert!(measured.count.is_none_or(|count| count.frames >= 1 && count.warm_up >= 1), "{measured:?}");
                let text = outcome.text(&row.measure);
                assert_eq!(text.contains(" after "), is_timed, "{text}");
                assert_eq!(
                    pictures.is_some(),
                    dir.is_some() && !row.technique.is_empty() && row.measure != ROWS[1].measure
                );
            }
        }
    }

    #[test]
    fn what_was_measured_is_not_measured_again() {
        let Some(lab) = lab_or_skip() else { return };
        let dir = tempfile::tempdir().unwrap();
        let options = RunOptions { size_px: Some(UVec2::new(32, 18)), samples: 4, ..RunOptions::for_device(lab, 1) };
        let exhibit = &PAPER.exhibits[0];
        let open = |options, limits| Session::open(lab, options, limits, Some(dir.path()), "abc");
        let run = |options| {
            let mut session = open(options, Limits::default()).unwrap();
            let result = session.run(&PAPER, exhibit, &Silent, (0, 4), &mut |_| Ok(())).unwrap();
            (session.ran(), result)
        };
        let (ran, first) = run(options);
        assert_eq!(ran, 4);
        let Outcome::Measured(measured) = &first.rows[0].outcome else { panic!("{first:?}") };
        assert!(measured.rmse.unwrap() > 0.0 && measured.flat_rmse.unwrap() > 0.0 && measured.size_px == [32, 18]);
        assert!(matches!(&first.rows[1].outcome, Outcome::Measured(measured) if measured.ms.unwrap() > 0.0));
        assert_eq!(first.rows[2].outcome, Outcome::NotReady("no-such-hall.glb".into()));
        assert!(matches!(&first.rows[3].outcome, Outcome::Failed(why) if why.contains("no_such")), "{first:?}");
        let files = first.rows[0].pictures.clone().unwrap();
        assert_eq!(files.reference.as_deref(), Some("images/truth-builtin-overlap-own-1-1280x720.png"));
        for file in [Some(files.picture), files.reference, files.error] {
            assert!(dir.path().join(file.unwrap()).is_file());
        }

        // Only missing and failed rows are tried again; the others are unchanged.
        let (ran, again) = run(options);
        let timed = |result: &ExhibitResult| match &result.rows[1].outcome {
            Outcome::Measured(measured) => measured.clone(),
            other => panic!("{other:?}"),
        };
        let (timed, read) = (timed(&first), timed(&again));
        assert_eq!((ran, read.size_px, read.count), (2, timed.size_px, timed.count));
        assert_eq!(read.ms, timed.ms);
        let other = Session::open(lab, options, Limits::default(), Some(dir.path()), "def").unwrap_err().to_string();
        assert!(other.contains("its commit is"), "{other}");
        let other = RunOptions { samples: 16, ..options };
        assert!(open(other, Limits::default()).is_err());
    }

    /// The deadline's missing rows are named, and measured by the next run.
    #[test]
    fn a_deadline_leaves_rows_out() {
        let Some(lab) = lab_or_skip() else { return };
        let dir = tempfile::tempdir().unwrap();
        let options = RunOptions { size_px: Some(UVec2::new(32, 18)), samples: 4, ..RunOptions::for_device(lab, 1) };
        let run = |limits| {
            let mut session = Session::open(lab, options, limits, Some(dir.path()), "abc").unwrap();
            let mut calls = 0;
            let each: &mut dyn FnMut(&Session<'_>) -> Result<(), LabError> = &mut |_| {
                calls += 1;
                Ok(())
            };
            let result = session.run(&PAPER, &PAPER.exhibits[0], &Silent, (0, 4), each).unwrap();
            (session.ran(), calls, session.missing().to_vec(), result)
        };
        let over = Limits { deadline: Some(Instant::now()), technique: None };
        let (ran, calls, missing, result) = run(over);
        assert_eq!((ran, calls, missing.len()), (0, 0, 4));
        assert!(missing[0].starts_with("nobody-1999/figure1: hard, "), "{missing:?}");
        assert!(result.rows.iter().all(|row| row.outcome == Outcome::NotRun));
        let limit = |seconds| Limits { deadline: None, technique: Some(std::time::Duration::from_secs(seconds)) };
        let (ran, calls, missing, result) = run(limit(0));
        assert_eq!((ran, calls, missing.len()), (4, 4, 0));
        let cut = |row: &RowResult| matches!(&row.outcome, Outcome::Skipped(why) if why.contains("cut short by the limit of 0 s"));
        assert!(result.rows[..2].iter().all(|row| cut(row) && row.cut_short_s == Some(0.0)), "{result:?}");
        // A longer limit repeats measurements that were cut short, and the two that are never final.
        let (ran, _, _, result) = run(limit(60));
        assert_eq!(ran, 4);
        assert!(result.rows[..2].iter().all(|row| matches!(row.outcome, Outcome::Measured(_))), "{result:?}");
    }
}
