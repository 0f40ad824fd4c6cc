//! Exhibits run one after the other, with what has been measured in a folder, so that work that was stopped goes on.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::exhibit::{Exhibit, Measure, Paper, Row};
use super::form::Form;
use super::outcome::Outcome;
use super::run::{Bench, Pictures, Ran, RunOptions};
use super::verdict::{Judged, Outcomes, Ruling, Verdict, judge};
use super::{PAPERS, exhibit_name, views};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::image_io::write_png;
use crate::output_files::{FileError, write_atomically};
use crate::progress::Progress;
use crate::store::{Kind, Store};

/// The file with all measurements in a folder of reproductions.
pub const REPRODUCED_NAME: &str = "reproduced.json";

const KIND: Kind = Kind { format: "antumbra-reproduced", version: 3 };

/// Pictures of a row, as paths relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureFiles {
    /// Shaded with the technique's mask, or a debug view.
    pub picture: String,
    /// Shaded with what it is held against.
    pub reference: Option<String>,
    /// The signed error.
    pub error: Option<String>,
}

/// What is kept of a row.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Kept {
    /// What was run: another row of the same name is run anew.
    row: Value,
    outcome: Outcome,
    pictures: Option<PictureFiles>,
}

/// A row in one form, and what came of it.
#[derive(Clone, Debug)]
pub struct RowResult {
    /// The row.
    pub row: &'static Row,
    /// As published, or ours.
    pub form: Form,
    /// What came of it.
    pub outcome: Outcome,
    /// Its pictures, where there are.
    pub pictures: Option<PictureFiles>,
}

/// An exhibit, and what came of it.
#[derive(Clone, Debug)]
pub struct ExhibitResult {
    /// `marrs-2014/figure3`.
    pub name: String,
    /// Whose it is.
    pub paper: &'static Paper,
    /// The exhibit.
    pub exhibit: &'static Exhibit,
    /// Its rows, in their order, each as published and then, where it has one, in our form.
    pub rows: Vec<RowResult>,
    /// Its claims, decided.
    pub judged: Vec<Judged>,
}

/// How many claims of some exhibits hold, are contradicted, and are not shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VerdictCount {
    /// Every rule is met.
    pub holds: usize,
    /// A rule is not.
    pub contradicted: usize,
    /// Nothing can be said.
    pub undecided: usize,
}

impl VerdictCount {
    /// Of all claims of these exhibits: as published, and by our form of those that have one.
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

/// Runs exhibits.
#[derive(Debug)]
pub struct Session<'a> {
    bench: Bench<'a>,
    options: RunOptions,
    is_software: bool,
    dir: Option<PathBuf>,
    store: Store<Kept>,
}

impl<'a> Session<'a> {
    /// Begins or goes on in a folder, which is made where it is not there; without one nothing is kept.
    ///
    /// # Errors
    /// Where the folder's measurements are of another commit, adapter or way of running, or cannot be read or written.
    pub fn open(lab: &'a LabDevice, options: RunOptions, dir: Option<&Path>, commit: &str) -> Result<Self, LabError> {
        let about = json!({
            "commit": commit,
            "adapter": lab.adapter.name,
            "driver": lab.adapter.driver_and_version(),
            "frames": options.frames,
            "size": options.size_px.map(|size_px| size_px.to_array()),
            "samples": options.samples,
        });
        dir.map(make).transpose()?;
        let store = Store::open(dir.map(|dir| dir.join(REPRODUCED_NAME)), KIND, about)?;
        if let Some(dir) = dir {
            make(&dir.join("images"))?;
            make(&dir.join("views"))?;
            for (name, text) in views::VIEWS {
                write_atomically(&dir.join("views").join(format!("{name}.toml")), text.as_bytes())?;
            }
        }
        let is_software = lab.adapter.is_software();
        Ok(Self { bench: Bench::new(lab, options), options, is_software, dir: dir.map(Path::to_path_buf), store })
    }

    /// Runs those of an exhibit's rows that have no result yet. `begun` of `all` rows come before it, for progress.
    ///
    /// # Errors
    /// Where the device fails, or a file cannot be written. What goes wrong with one row is its outcome.
    pub fn run(
        &mut self,
        paper: &'static Paper,
        exhibit: &'static Exhibit,
        progress: &dyn Progress,
        (begun, all): (usize, usize),
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
            let ran = match self.bench.run(row, form, with_pictures) {
                // Nothing can be run any more.
                Err(error @ LabError::Device(_)) => return Err(error),
                Err(error) => Ran { outcome: Outcome::Failed(error.to_string()), pictures: None },
                Ok(ran) => ran,
            };
            let pictures = match (&self.dir, ran.pictures) {
                (Some(dir), Some(pictures)) => Some(write(dir, &pictures, &file_name(&name, i, form), row)?),
                _ => None,
            };
            let kept = Kept { row: described(row, form, &self.options), outcome: ran.outcome, pictures };
            self.store.insert(key(&name, row, form), kept)?;
        }
        self.store.write()?;
        progress.end();
        Ok(self.result(paper, exhibit))
    }

    /// All that this and earlier runs know of an exhibit.
    pub fn result(&self, paper: &'static Paper, exhibit: &'static Exhibit) -> ExhibitResult {
        let name = exhibit_name(paper, exhibit);
        let result = |row: &'static Row, form: Form| match self.store.get(&key(&name, row, form)) {
            Some(kept) if kept.row == described(row, form, &self.options) => {
                RowResult { row, form, outcome: kept.outcome.clone(), pictures: kept.pictures.clone() }
            }
            _ => RowResult { row, form, outcome: Outcome::NotRun, pictures: None },
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

    /// The same of every exhibit, paper by paper.
    pub fn results(&self) -> Vec<(&'static Paper, Vec<ExhibitResult>)> {
        let of = |paper: &'static Paper| paper.exhibits.iter().map(|exhibit| self.result(paper, exhibit)).collect();
        PAPERS.iter().map(|paper| (paper, of(paper))).collect()
    }

    /// How many rows this session has run itself.
    pub fn ran(&self) -> usize {
        self.store.fresh
    }

    /// What a row has from before, where that still says all: what was not there then may be there now.
    fn kept(&self, name: &str, row: &Row, form: Form) -> Option<&Kept> {
        let kept = self.store.get(&key(name, row, form))?;
        let is_final = matches!(kept.outcome, Outcome::Measured(_) | Outcome::Skipped(_));
        (is_final && kept.row == described(row, form, &self.options)).then_some(kept)
    }
}

/// What a row's pictures are called: `marrs-2014-figure4-1`, `marrs-2014-figure4-1-ours`.
fn file_name(name: &str, i: usize, form: Form) -> String {
    let end = if form == Form::Ours { "-ours" } else { "" };
    format!("{}-{}{end}", name.replace('/', "-"), i + 1)
}

/// Writes a row's pictures into the folder `dir`, under this name.
fn write(dir: &Path, pictures: &Pictures, own: &str, row: &Row) -> Result<PictureFiles, LabError> {
    let put = |file: String, picture| -> Result<String, LabError> {
        let path = format!("images/{file}.png");
        write_png(&dir.join(&path), picture)?;
        Ok(path)
    };
    let picture = put(own.to_owned(), &pictures.picture)?;
    let Some([reference, error]) = &pictures.beside else {
        return Ok(PictureFiles { picture, reference: None, error: None });
    };
    // Rows that look at one truth share its picture.
    let named = if row.measure == Measure::Error { truth_name(row) } else { format!("{own}-reference") };
    let (reference, error) = (put(named, reference)?, put(format!("{own}-error"), error)?);
    Ok(PictureFiles { picture, reference: Some(reference), error: Some(error) })
}

fn make(dir: &Path) -> Result<(), LabError> {
    Ok(fs::create_dir_all(dir).map_err(|error| FileError::from_write(dir, &error))?)
}

fn key(name: &str, row: &Row, form: Form) -> String {
    format!("{name}: {}, {form}", row.what)
}

/// All that a row's result hangs on.
fn described(row: &Row, form: Form, options: &RunOptions) -> Value {
    let Row { scene, view, technique, light_scale, frames, measure, .. } = row;
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
    })
}

fn truth_name(row: &Row) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
    let text = format!("{} {} {}", row.scene, row.view.unwrap_or("own"), row.light_scale);
    let (width, height) = row.size_px;
    format!("truth-{}-{width}x{height}", text.chars().map(plain).collect::<String>())
}

/// Whether a row's picture is to be shown: where pictures are compared, and for tables once for each scene.
fn shows_picture(exhibit: &Exhibit, i: usize) -> bool {
    let row = &exhibit.rows[i];
    let is_same = |other: &Row| (other.scene, other.view) == (row.scene, row.view) && !other.technique.is_empty();
    row.measure.is_error() || row.measure == Measure::Colors || !exhibit.rows[..i].iter().any(is_same)
}

#[cfg(test)]
mod tests {
    use super::super::exhibit::{Reported, error, ms};
    use super::*;
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;
    use glam::UVec2;

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

    /// Whatever a row measures, it runs without a folder, and its pictures are kept where there is one.
    #[test]
    fn every_kind_of_row_runs_with_and_without_a_folder() {
        use super::super::exhibit::{colors, difference, filtered_error, fps, scene_ms};
        const SMALL: super::super::exhibit::Settings = &[("map_size", "64")];
        const ROWS: &[Row] = &[
            ms("time", "builtin:overlap", "hard", "", Reported::Drawn).with(SMALL),
            fps("frames a second", "builtin:overlap", "hard", 1.0).with(SMALL),
            scene_ms("the scene", "builtin:overlap", 1.0),
            error("error", "builtin:overlap", "hard").with(SMALL),
            filtered_error("filtered error", "builtin:overlap", "vsm").with(SMALL),
            difference("difference", "builtin:overlap", "hard", ("pcf", SMALL)).with(SMALL),
            colors("colours", "builtin:overlap", "lvsm").with(&[("show", "layers"), ("map_size", "64")]),
        ];
        const KINDS: Exhibit = Exhibit { rows: ROWS, ..EXHIBIT };
        static PAPER: Paper =
            Paper { id: "nobody-1998", citation: "", hardware: "", bandwidth_gb_s: 1.0, own: &[], exhibits: &[KINDS] };
        let Some(lab) = lab_or_skip() else { return };
        let dir = tempfile::tempdir().unwrap();
        let options = RunOptions { size_px: Some(UVec2::new(32, 18)), samples: 4, ..RunOptions::for_device(lab, 1) };
        for dir in [None, Some(dir.path())] {
            let mut session = Session::open(lab, options, dir, "abc").unwrap();
            let result = session.run(&PAPER, &PAPER.exhibits[0], &Silent, (0, ROWS.len())).unwrap();
            for RowResult { row, outcome, pictures, .. } in &result.rows {
                let Outcome::Measured(measured) = outcome else { panic!("{}: {outcome:?}", row.what) };
                let is_timed = row.measure.is_timed() || matches!(row.measure, Measure::SceneMs { .. });
                assert_eq!((measured.ms.is_some(), measured.count.is_some()), (is_timed, is_timed), "{}", row.what);
                // The very first frame never counts.
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
        let run = |options| {
            let mut session = Session::open(lab, options, Some(dir.path()), "abc").unwrap();
            let result = session.run(&PAPER, exhibit, &Silent, (0, 4)).unwrap();
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

        // Only what was not there or went wrong is tried again, and the rest is as it was.
        let (ran, again) = run(options);
        let timed = |result: &ExhibitResult| match &result.rows[1].outcome {
            Outcome::Measured(measured) => measured.clone(),
            other => panic!("{other:?}"),
        };
        let (timed, read) = (timed(&first), timed(&again));
        assert_eq!((ran, read.size_px, read.count), (2, timed.size_px, timed.count));
        // Text does not keep the last bit.
        assert!((read.ms.unwrap() - timed.ms.unwrap()).abs() <= 1e-9 * timed.ms.unwrap());
        let other = Session::open(lab, options, Some(dir.path()), "def").unwrap_err().to_string();
        assert!(other.contains("its commit is"), "{other}");
        let other = RunOptions { samples: 16, ..options };
        assert!(Session::open(lab, other, Some(dir.path()), "abc").is_err());
    }
}
