//! Comparison of results with another run: on another adapter, or of another commit.
//!
//! Rows are paired by name. Each pair has the ratio of times (here / there) and the differences of errors (here − there).

use std::path::Path;

use glam::UVec2;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::bench::{BenchOutcome, BenchRow, plain_name, rows_in};
use crate::error::LabError;
use crate::names::numbered;
use crate::output_files::{FileError, read_json};
use crate::reproduce::{ExhibitResult, Outcome as Reproduced};

/// Errors whose differences are printed. The JSON has all errors of the file.
pub const DIFFERENCES: [&str; 4] = ["rmse", "penumbra_rmse", "roughness", "flip"];

/// Command that wrote a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// `compare`, a `metrics.json`.
    Compare,
    /// `bench --json` or `bench --share`.
    Bench,
    /// `reproduce --json`.
    Reproduce,
}

impl Source {
    fn of(json: &Value) -> Option<Self> {
        match json["format"].as_str() {
            Some("antumbra-metrics") => Some(Self::Compare),
            Some("antumbra-bench" | "antumbra-share") => Some(Self::Bench),
            // Older files have no format name.
            None if json["antumbra"].is_string() && json["rows"].is_array() => Some(Self::Bench),
            None if json["exhibits"].is_array() => Some(Self::Reproduce),
            _ => None,
        }
    }

    /// Returns the remedy to print for a wrong file.
    fn wanted(self) -> &'static str {
        match self {
            Self::Compare => "give a metrics.json that `antumbra compare` wrote",
            Self::Bench => "give a file that `antumbra bench --json` or `--share` wrote",
            Self::Reproduce => "give a file that `antumbra reproduce --json` wrote",
        }
    }
}

/// Time and errors of one row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Name by which rows are paired.
    pub name: String,
    /// Median time, milliseconds.
    pub ms: Option<f64>,
    /// Errors by key.
    pub errors: Map<String, Value>,
}

/// Results of the other run.
#[derive(Clone, Debug, PartialEq)]
pub struct Baseline {
    /// Name of its adapter.
    pub adapter: String,
    /// Commit of its program.
    pub commit: String,
    rows: Vec<Figures>,
    json: Value,
}

/// Comparison of a run with another.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BaselineComparison {
    /// Adapter of the other run.
    pub adapter: String,
    /// Commit of the other run.
    pub commit: String,
    /// Rows that both runs have.
    pub rows: Vec<PairedRow>,
    /// Geometric mean of the time ratios.
    pub mean_ratio: Option<f64>,
    /// Names of rows that the other run lacks.
    pub not_there: Vec<String>,
}

/// A row paired with the other run's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairedRow {
    /// Name of the row.
    pub name: String,
    /// Time of this run, milliseconds.
    pub ms: Option<f64>,
    /// Time of the other run, milliseconds.
    pub baseline_ms: Option<f64>,
    /// Ratio of times, here / there: above 1, this run is slower.
    pub ratio: Option<f64>,
    /// Differences of errors, here − there, by key.
    pub differences: Map<String, Value>,
}

impl PairedRow {
    /// Returns the difference of one error; `None` unless both runs have it.
    pub fn difference(&self, key: &str) -> Option<f64> {
        self.differences.get(key).and_then(Value::as_f64)
    }
}

impl Baseline {
    /// Reads a file that the `source` command wrote.
    ///
    /// # Errors
    /// If the file cannot be read, or another command wrote it.
    pub fn read(path: &Path, source: Source) -> Result<Self, FileError> {
        let json: Value = read_json(path, source.wanted())?;
        let bad = |why: String| FileError::bad_content(path, why, source.wanted());
        if Source::of(&json) != Some(source) {
            return Err(bad("it was not written by this command".into()));
        }
        let rows = match source {
            Source::Compare => of_metrics(&json),
            Source::Bench => of_bench(&rows_in(path, &json)?),
            Source::Reproduce => of_exhibits(&json),
        };
        if rows.is_empty() {
            return Err(bad("it has no rows".into()));
        }
        let text = |value: &Value| value.as_str().unwrap_or("unknown").to_owned();
        let adapter = if source == Source::Compare { &json["adapter"]["name"] } else { &json["adapter"] };
        Ok(Self { adapter: text(adapter), commit: text(&json["commit"]), rows, json })
    }

    /// Checks that a `metrics.json` is of the same view, because errors and times of different views cannot be compared.
    ///
    /// # Errors
    /// A message that names the first difference.
    pub fn check_view(&self, path: &Path, report: &[(&str, Value)]) -> Result<(), LabError> {
        let there = |key: &str| if key == "size" { &self.json["size"] } else { &self.json["scene"][key] };
        let Some((key, here)) = report.iter().find(|(key, here)| there(key) != here) else { return Ok(()) };
        // A setup is a page of text, so its values are not printed.
        let what = if *key == "setup" {
            "its camera or lights differ from those of this run".to_owned()
        } else {
            format!("its {key} is {}, but this run has {here}", there(key))
        };
        Err(LabError::Request(format!("--baseline {}: {what}; give the metrics.json of the same view", path.display())))
    }

    /// Pairs rows with those of the same name.
    pub fn against(&self, rows: &[Figures]) -> BaselineComparison {
        let mut against = BaselineComparison {
            adapter: self.adapter.clone(),
            commit: self.commit.clone(),
            ..BaselineComparison::default()
        };
        for row in rows {
            match self.rows.iter().find(|other| other.name == row.name) {
                Some(other) => against.rows.push(paired(row, other)),
                None => against.not_there.push(row.name.clone()),
            }
        }
        let ratios: Vec<f64> = against.rows.iter().filter_map(|row| row.ratio).collect();
        let mean = ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64;
        against.mean_ratio = (!ratios.is_empty()).then(|| mean.exp());
        against
    }
}

fn paired(row: &Figures, other: &Figures) -> PairedRow {
    let ratio =
        row.ms.zip(other.ms).filter(|(here, there)| *here > 0.0 && *there > 0.0).map(|(here, there)| here / there);
    let difference = |(key, here): (&String, &Value)| {
        let there = other.errors.get(key)?.as_f64()?;
        Some((key.clone(), Value::from(here.as_f64()? - there)))
    };
    PairedRow {
        name: row.name.clone(),
        ms: row.ms,
        baseline_ms: other.ms,
        ratio,
        differences: row.errors.iter().filter_map(difference).collect(),
    }
}

impl BaselineComparison {
    /// Returns one line: the other run, the mean ratio of times, and missing rows.
    pub fn summary(&self) -> String {
        let mean = self.mean_ratio.map_or_else(String::new, |mean| {
            format!("; ratio of times to the baseline's, geometric mean over {}: {mean:.3}", self.timed())
        });
        let lacking = match self.not_there.len() {
            0 => String::new(),
            count => format!("; {count} not in the baseline: {}", self.not_there.join(", ")),
        };
        format!("Compared with {} (commit {}){mean}{lacking}", self.adapter, self.commit)
    }

    fn timed(&self) -> usize {
        self.rows.iter().filter(|row| row.ratio.is_some()).count()
    }

    /// Returns the rows of a table, heading first.
    pub fn table(&self) -> Vec<Vec<String>> {
        let has_errors = self.rows.iter().any(|row| !row.differences.is_empty());
        let keys: &[&str] = if has_errors { &DIFFERENCES } else { &[] };
        let heading = ["NAME", "MS", "BASELINE MS", "RATIO"].map(str::to_owned).into_iter();
        let differences = keys.iter().map(|key| format!("{} DIFFERENCE", key.replace('_', " ").to_uppercase()));
        let mut rows = vec![heading.chain(differences).collect::<Vec<_>>()];
        let number = |value: Option<f64>, digits| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}"));
        rows.extend(self.rows.iter().map(|row| {
            let times = [number(row.ms, 3), number(row.baseline_ms, 3), number(row.ratio, 3)];
            let differences =
                keys.iter().map(|key| row.difference(key).map_or_else(|| "–".to_owned(), |v| format!("{v:+.4}")));
            std::iter::once(row.name.clone()).chain(times).chain(differences).collect()
        }));
        rows
    }
}

fn of_metrics(json: &Value) -> Vec<Figures> {
    let rows = json["rows"].as_array().map_or(&[][..], Vec::as_slice);
    let techniques = rows.iter().map(|row| row["technique"].as_str().unwrap_or_default().to_owned());
    let figures = rows.iter().zip(numbered(techniques, "-")).filter_map(|(row, name)| {
        row["technique"].as_str()?;
        let errors = row["metrics"].as_object()?.clone();
        Some(Figures { name, ms: row["total_ms"].as_f64(), errors: numbers(errors) })
    });
    figures.collect()
}

/// Returns the figures of rows of `bench`.
pub fn of_bench(rows: &[BenchRow]) -> Vec<Figures> {
    // Older files have no row names.
    let plain = rows.iter().map(|row| plain_name(&row.scene, UVec2::from_array(row.size), &row.technique));
    let figures = rows.iter().zip(numbered(plain, ", ")).filter_map(|(row, name)| {
        let BenchOutcome::Ran { timings, .. } = &row.outcome else { return None };
        let name = if row.name.is_empty() { name } else { row.name.clone() };
        Some(Figures { name, ms: Some(timings.total_ms), errors: Map::new() })
    });
    figures.collect()
}

/// Returns the figures of measured rows of exhibits.
pub fn of_reproduced(results: &[ExhibitResult]) -> Vec<Figures> {
    let rows = results.iter().flat_map(|result| result.rows.iter().map(move |row| (result, row)));
    let figures = rows.filter_map(|(result, row)| match &row.outcome {
        Reproduced::Measured(measured) => {
            let measured = serde_json::to_value(measured).ok()?;
            Some(of_exhibit_row(&result.name, row.row.what, row.form.name(), &measured))
        }
        _ => None,
    });
    figures.collect()
}

fn of_exhibits(json: &Value) -> Vec<Figures> {
    let exhibits = json["exhibits"].as_array().into_iter().flatten();
    let rows = exhibits.flat_map(|exhibit| {
        let rows = exhibit["rows"].as_array().into_iter().flatten();
        rows.map(move |row| (exhibit["id"].as_str().unwrap_or_default(), row))
    });
    let figures = rows.filter_map(|(exhibit, row)| {
        let measured = row["here"].get("measured")?;
        Some(of_exhibit_row(exhibit, row["what"].as_str()?, row["form"].as_str()?, measured))
    });
    figures.collect()
}

fn of_exhibit_row(exhibit: &str, what: &str, form: &str, measured: &Value) -> Figures {
    let keys = ["rmse", "umbra_leak", "lit_loss", "noise"];
    let errors = keys.iter().filter_map(|key| Some(((*key).to_owned(), measured.get(*key)?.clone())));
    let name = format!("{exhibit}: {what}, {form}");
    Figures { name, ms: measured["ms"].as_f64(), errors: numbers(errors.collect()) }
}

/// Returns the entries that are numbers.
pub(crate) fn numbers(values: Map<String, Value>) -> Map<String, Value> {
    values.into_iter().filter(|(_, value)| value.is_number()).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read(json: &Value, source: Source) -> Result<Baseline, String> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("b.json");
        std::fs::write(&path, json.to_string()).unwrap();
        Baseline::read(&path, source).map_err(|error| error.to_string())
    }

    fn metrics() -> Value {
        let row = |technique: &str, ms: f64, rmse: f64| json!({ "technique": technique, "total_ms": ms, "metrics": { "rmse": rmse, "flip": null, "worst_tile_at": [0, 0] } });
        json!({
            "format": "antumbra-metrics", "adapter": { "name": "card" }, "commit": "abc", "size": [64, 36],
            "scene": { "name": "builtin:overlap", "setup": "[camera]" },
            "rows": [row("hard", 2.0, 0.25), row("pcss", 8.0, 0.125), row("pcss", 4.0, 0.5),
                { "technique": "vsm", "total_ms": null, "metrics": null }],
        })
    }

    #[test]
    fn ratios_and_differences_are_of_rows_of_one_name() {
        let baseline = read(&metrics(), Source::Compare).unwrap();
        assert_eq!((baseline.adapter.as_str(), baseline.commit.as_str()), ("card", "abc"));
        let figures = |name: &str, ms, rmse: f64| Figures {
            name: name.into(),
            ms,
            errors: json!({ "rmse": rmse, "flip": 0.5 }).as_object().unwrap().clone(),
        };
        let rows = [
            figures("hard", Some(1.0), 0.5),
            figures("pcss-2", Some(16.0), 0.25),
            figures("vsm", Some(1.0), 0.1),
            figures("pcss", None, 0.125),
        ];
        let against = baseline.against(&rows);
        let of = |i: usize| (against.rows[i].name.as_str(), against.rows[i].ratio, against.rows[i].difference("rmse"));
        assert_eq!(of(0), ("hard", Some(0.5), Some(0.25)));
        assert_eq!(of(1), ("pcss-2", Some(4.0), Some(-0.25)));
        assert_eq!(of(2), ("pcss", None, Some(0.0)));
        assert_eq!(against.rows[0].difference("flip"), None, "the baseline has none");
        assert_eq!((against.not_there.as_slice(), against.rows.len()), (&["vsm".to_owned()][..], 3));
        assert!((against.mean_ratio.unwrap() - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!(against.summary().contains(
            "Compared with card (commit abc); ratio of times to the baseline's, geometric mean over 2: 1.414; 1 not in"
        ));
        assert_eq!(against.table()[1][..5], ["hard", "1.000", "2.000", "0.500", "+0.2500"].map(str::to_owned));
    }

    #[test]
    fn every_command_reads_its_own_files_alone() {
        let timings = json!({ "passes": [], "total_ms": 3.0, "total_p10_ms": 3.0, "total_p90_ms": 3.0, "processor_ms": 0.1,
            "clock": "gpu_timestamps", "warm_up": 3, "frames": 5 });
        let row = json!({ "scene": "builtin:street", "triangles": 1, "light": "key", "size": [64, 36], "technique": "pcss", "parameters": {},
            "ran": { "timings": timings, "memory_bytes": 1 } });
        let bench = json!({ "antumbra": "0.1.0", "commit": "abc", "adapter": "card", "rows": [row] });
        let baseline = read(&bench, Source::Bench).unwrap();
        let here = [Figures { name: "builtin:street, 64x36, pcss".into(), ms: Some(6.0), errors: Map::new() }];
        assert_eq!(baseline.against(&here).rows[0].ratio, Some(2.0), "of a file from before rows had names");
        let paper = json!({ "adapter": "card", "commit": "abc", "exhibits": [{ "id": "x-1999/figure1", "rows": [
            { "what": "a", "form": "ours", "here": { "measured": { "ms": 2.0, "rmse": 0.5, "noise": null } } }, { "what": "b", "form": "ours", "here": "not_run" }] }] });
        let rows = read(&paper, Source::Reproduce).unwrap().rows;
        assert_eq!(
            (rows.len(), rows[0].name.as_str(), rows[0].ms, rows[0].errors.len()),
            (1, "x-1999/figure1: a, ours", Some(2.0), 1)
        );
        for (json, source) in [
            (&bench, Source::Compare),
            (&metrics(), Source::Bench),
            (&metrics(), Source::Reproduce),
            (&json!({}), Source::Bench),
        ] {
            let error = read(json, source).unwrap_err();
            assert!(error.contains("it was not written by this command; give a") && error.contains("wrote"), "{error}");
        }
        assert!(
            read(&json!({ "format": "antumbra-metrics", "rows": [] }), Source::Compare)
                .unwrap_err()
                .contains("no rows")
        );
    }

    #[test]
    fn another_view_is_refused() {
        let baseline = read(&metrics(), Source::Compare).unwrap();
        let check = |name: &str, size: [u32; 2], setup: &str| {
            let view = [("name", json!(name)), ("size", json!(size)), ("setup", json!(setup))];
            baseline.check_view(Path::new("m.json"), &view).map_err(|error| error.to_string())
        };
        assert_eq!(check("builtin:overlap", [64, 36], "[camera]"), Ok(()));
        let error = check("builtin:overlap", [128, 72], "[camera]").unwrap_err();
        assert_eq!(
            error,
            "--baseline m.json: its size is [64,36], but this run has [128,72]; give the metrics.json of the same view"
        );
        assert!(check("builtin:tree", [64, 36], "[camera]").unwrap_err().contains("its name is \"builtin:overlap\""));
        assert!(check("builtin:overlap", [64, 36], "[camera] ").unwrap_err().contains("camera or lights"));
    }
}
