//! `cargo xtask cases`: measures the error of every technique on each small input that a report led to, into `bench/cases.md`.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::machine;
use crate::shell;

/// Environment variable with the folder of test scenes, next to which the cases are.
const SCENES: &str = "ANTUMBRA_SCENES";

/// Setup of cases without their own.
const SHARED_SETUP: &str = "card.toml";

/// Number of cases per table.
const ACROSS: usize = 8;

/// Errors above both limits are set in bold: an absolute one, and a multiple of the error of `hard`.
const MUCH: f64 = 0.02;
const TIMES_HARD: f64 = 1.2;

const HEAD: &str = "\
# Cases

Root mean square errors on small inputs that reports led to, by `cargo xtask cases`: covers, housings and shells about lamps, closed
rooms, grazing light, cameras inside solids, and materials of files. The inputs are in the folder `cases` beside the test scenes that
`ANTUMBRA_SCENES` names, with a description of each. Images are 240 × 135, the truth is of 144 rays a pixel, techniques have their
default settings. In **bold**: more than .02, and more than 1.2 times the error of `hard`.

";

/// Case with the techniques' errors.
#[derive(Clone, Debug, PartialEq)]
struct Case {
    name: String,
    /// Adapter that rendered it.
    adapter: String,
    /// Error by technique; `None` if it was skipped or no pixel is judged.
    errors: Vec<(String, Option<f64>)>,
}

impl Case {
    fn error_of(&self, technique: &str) -> Option<f64> {
        self.errors.iter().find(|(name, _)| name == technique).and_then(|(_, error)| *error)
    }
}

/// Compares all techniques on every case, or on those whose names begin with one of `names`. Only a complete run is written.
///
/// # Errors
/// The first step that failed.
pub fn run(names: &[String]) -> Result<(), String> {
    machine::set_up()?;
    let folder = folder()?;
    let binary = shell::built_of_workspace("antumbra")?;
    let all = scenes_in(&folder)?;
    let asked = all.iter().filter(|scene| names.is_empty() || names.iter().any(|name| stem(scene).starts_with(name)));
    let cases: Vec<Case> = asked.map(|scene| measure(&binary, scene)).collect::<Result<_, _>>()?;
    let tables = tables(&cases)?;
    if !names.is_empty() {
        println!("{tables}");
        return Ok(());
    }
    let origin = origin(&cases, &shell::output(Command::new(&binary).arg("--version"))?)?;
    let page = crate::root().join("bench/cases.md");
    std::fs::write(&page, format!("{HEAD}{origin}\n\n{tables}")).map_err(|error| format!("{}: {error}", page.display()))
}

/// Returns the folder of cases, next to that of scenes.
fn folder() -> Result<PathBuf, String> {
    let root = crate::root();
    let candidates = [
        std::env::var_os(SCENES).map(PathBuf::from),
        Some(root.join("../shared/scenes")),
        Some(root.join("shared/scenes")),
    ];
    let cases = candidates.into_iter().flatten().filter_map(|scenes| Some(scenes.parent()?.join("cases")));
    cases.into_iter().find(|folder| folder.is_dir()).ok_or_else(|| {
        format!("set {SCENES} to the folder of test scenes, next to which there is a folder named cases")
    })
}

/// Returns the scenes in a folder, sorted by name.
fn scenes_in(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut scenes: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|end| end == "glb")).collect();
    scenes.sort();
    if scenes.is_empty() { Err(format!("{}: no .glb files", folder.display())) } else { Ok(scenes) }
}

fn stem(scene: &Path) -> String {
    scene.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the errors of all techniques on a scene.
fn measure(binary: &Path, scene: &Path) -> Result<Case, String> {
    let name = stem(scene);
    let own = scene.with_extension("toml");
    let setup = if own.is_file() { own } else { scene.with_file_name(SHARED_SETUP) };
    let mut compare = Command::new(binary);
    compare.arg("compare").arg(scene).arg("--setup").arg(setup);
    compare.args(["--size", "240x135", "--samples", "144", "--frames", "1", "-o"]);
    compare.arg(crate::root().join("out/cases").join(&name));
    let printed = shell::output(&mut compare)?;
    let adapter = adapter_in(&printed).ok_or_else(|| format!("{name}: `antumbra compare` printed no adapter"))?;
    Ok(Case { errors: errors_in(&printed), adapter, name })
}

/// Returns the adapter that `antumbra compare` prints after the last semicolon of the line about the ground truth.
fn adapter_in(printed: &str) -> Option<String> {
    let line = printed.lines().find(|line| line.contains("; ground truth: "))?;
    line.rsplit("; ").next().map(str::to_owned)
}

/// Returns the origin of the figures: adapter and commit, from `antumbra --version`. Cases rendered by another adapter are named.
fn origin(cases: &[Case], version: &str) -> Result<String, String> {
    let commit = version.trim().strip_suffix(')').and_then(|text| text.rsplit_once("(commit "));
    let (_, commit) = commit.ok_or_else(|| format!("`antumbra --version` printed no commit: {version}"))?;
    let first = cases.first().ok_or("no cases were measured")?;
    let others = cases.iter().filter(|case| case.adapter != first.adapter);
    let others: String = others.map(|case| format!("; `{}` on {}", case.name, case.adapter)).collect();
    Ok(format!("{}, commit {commit}{others}.", first.adapter))
}

/// Returns the first two columns of the table that `antumbra compare` prints.
fn errors_in(printed: &str) -> Vec<(String, Option<f64>)> {
    let after_heading = printed.lines().skip_while(|line| !line.starts_with("TECHNIQUE ")).skip(1);
    let rows = after_heading.take_while(|line| !line.ends_with("index.html"));
    rows.filter_map(|row| {
        let mut cells = row.split_whitespace();
        Some((cells.next()?.to_owned(), cells.next()?.parse().ok()))
    })
    .collect()
}

/// Returns tables of techniques by cases, a few cases per table.
fn tables(cases: &[Case]) -> Result<String, String> {
    let techniques: Vec<&String> =
        cases.first().map(|case| case.errors.iter().map(|(name, _)| name).collect()).unwrap_or_default();
    if techniques.is_empty() {
        return Err("no errors were measured".into());
    }
    let table = |cases: &[Case]| {
        let mut text = String::from("| technique |");
        cases.iter().for_each(|case| write!(text, " `{}` |", case.name).expect("text"));
        text.push_str(&format!("\n|---|{}\n", "---:|".repeat(cases.len())));
        for technique in &techniques {
            let cells = cases.iter().map(|case| cell(case.error_of(technique), case.error_of("hard")));
            text.push_str(&format!("| `{technique}` |{}\n", cells.collect::<String>()));
        }
        text
    };
    Ok(cases.chunks(ACROSS).map(table).collect::<Vec<_>>().join("\n"))
}

fn cell(error: Option<f64>, of_hard: Option<f64>) -> String {
    let Some(error) = error else { return " – |".into() };
    let digits = format!("{error:.3}");
    let shown = digits.strip_prefix('0').unwrap_or(&digits);
    let is_worse = error > MUCH && of_hard.is_none_or(|hard| error > TIMES_HARD * hard);
    if is_worse { format!(" **{shown}** |") } else { format!(" {shown} |") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: &str = "\ncover: 12 triangles\n\nTECHNIQUE  RMSE    PENUMBRA RMSE\nhard       0.0100  –\n\
                           essm       0.9800  –\nray_traced skipped: no rays\n/tmp/out/index.html\n";

    fn case(name: &str, adapter: &str) -> Case {
        Case { name: name.into(), adapter: adapter.into(), errors: errors_in(PRINTED) }
    }

    #[test]
    fn the_page_names_adapter_and_commit() {
        let line =
            "\ncover: 12 triangles; ground truth: 144 light samples per pixel, 0.1 s, 3.0 M rays/s; NVIDIA H200\n";
        assert_eq!(adapter_in(line).as_deref(), Some("NVIDIA H200"));
        assert_eq!(adapter_in("TECHNIQUE  RMSE\nhard  0.1; a\n"), None);
        let version = "antumbra 0.1.0 (commit b5e93ddb8170)\n";
        let cases = [case("cover", "NVIDIA H200"), case("room", "NVIDIA H200"), case("webp", "llvmpipe")];
        assert_eq!(origin(&cases[..2], version).as_deref(), Ok("NVIDIA H200, commit b5e93ddb8170."));
        assert_eq!(origin(&cases, version).as_deref(), Ok("NVIDIA H200, commit b5e93ddb8170; `webp` on llvmpipe."));
        assert!(origin(&cases, "antumbra 0.1.0").is_err() && origin(&[], version).is_err());
    }

    #[test]
    fn errors_are_parsed_from_the_printed_table() {
        let expected = [("hard", Some(0.01)), ("essm", Some(0.98)), ("ray_traced", None)];
        assert_eq!(errors_in(PRINTED), expected.map(|(name, error)| (name.to_owned(), error)));
    }

    #[test]
    fn what_is_worse_than_hard_shadows_is_set_in_bold() {
        let case = case("cover", "card");
        let expected =
            "| technique | `cover` |\n|---|---:|\n| `hard` | .010 |\n| `essm` | **.980** |\n| `ray_traced` | – |\n";
        assert_eq!(tables(&[case]), Ok(expected.to_owned()));
        assert!(tables(&[]).is_err());
    }
}
