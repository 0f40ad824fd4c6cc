//! Results that owners of graphics cards can send: one file each for `bench/cards`, and the page of all cards.
//!
//! A file has data about the device and measurements, but nothing about the machine's owner, host name or folders. Therefore only built-in
//! scenes are measured, and every key is written explicitly.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use antumbra::TechniqueKind;
use antumbra_scene::builtin;
use serde::{Deserialize, Serialize};

use crate::bench::{BenchOutcome, BenchRow, BenchRows, Frames};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::output_files::{FileError, read_json};
use crate::report::utc_now;

const FORMAT: &str = "antumbra-share";
const VERSION: u32 = 1;

/// Maximum number of cards side by side in one table.
const ACROSS: usize = 6;

/// Results of one adapter with one version of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SharedFile {
    format: String,
    version: u32,
    /// Version of the program.
    pub antumbra: String,
    /// Commit of the program.
    pub commit: String,
    /// Day of the measurement: `2026-11-27`.
    pub date: String,
    /// Operating system and processor architecture: `linux x86_64`.
    pub system: String,
    /// Name reported by the driver.
    pub adapter: String,
    /// Driver and version.
    pub driver: String,
    /// Graphics API: Vulkan, Metal, …
    pub backend: String,
    /// Whether the adapter is a software renderer.
    pub software: bool,
    /// Requested number of warm-up frames.
    pub warm_up: u32,
    /// Requested number of timed frames.
    pub frames: u32,
    /// Measurements.
    pub rows: Vec<BenchRow>,
}

impl SharedFile {
    /// Creates the file of a run.
    pub fn new(lab: &LabDevice, commit: &str, frames: Frames, rows: &BenchRows) -> Self {
        let adapter = &lab.adapter;
        Self {
            format: FORMAT.into(),
            version: VERSION,
            antumbra: env!("CARGO_PKG_VERSION").into(),
            commit: commit.into(),
            date: utc_now().split('T').next().unwrap_or_default().into(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            adapter: adapter.name.clone(),
            driver: adapter.driver_and_version(),
            backend: adapter.backend.to_string(),
            software: adapter.is_software(),
            warm_up: frames.warm_up,
            frames: frames.timed,
            rows: rows.rows.clone(),
        }
    }

    /// Reads a shared file.
    ///
    /// # Errors
    /// If the file cannot be read or has other content.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        const REMEDY: &str = "give files that `antumbra bench --share` wrote";
        let file: Self = read_json(path, REMEDY)?;
        if file.format != FORMAT || file.version != VERSION {
            return Err(FileError::bad_content(path, "it contains no shared results of this version", REMEDY));
        }
        Ok(file)
    }

    /// Returns the title of a column: adapter and commit.
    fn title(&self) -> String {
        format!("{}, {}", self.adapter, self.commit)
    }
}

/// Rejects scenes from files, because file names are private.
///
/// # Errors
/// A line with the first such scene.
pub fn check_scenes(specs: &[String]) -> Result<(), LabError> {
    match specs.iter().find(|spec| builtin::spec_of(spec).is_none()) {
        Some(spec) => Err(LabError::Request(format!(
            "--share: {spec} is a file, whose name would be in the shared file; name built-in scenes (`antumbra scenes` lists them)"
        ))),
        None => Ok(()),
    }
}

/// Reads all files of a folder, in order of adapters and dates.
///
/// # Errors
/// If the folder has none, or one cannot be read.
pub fn read_folder(dir: &Path) -> Result<Vec<SharedFile>, FileError> {
    let entries = std::fs::read_dir(dir).map_err(|error| FileError::from_read(dir, &error))?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<_> = paths.filter(|path| path.extension().is_some_and(|ending| ending == "json")).collect();
    paths.sort();
    if paths.is_empty() {
        return Err(FileError::bad_content(dir, "it has no .json files", "give the folder of shared results"));
    }
    let mut files = paths.iter().map(|path| SharedFile::read(path)).collect::<Result<Vec<_>, _>>()?;
    files.sort_by(|a, b| (&a.adapter, &a.date, &a.commit).cmp(&(&b.adapter, &b.date, &b.commit)));
    Ok(files)
}

/// Returns the page of all cards: a list, and a table of times per scene and size.
pub fn markdown(files: &[SharedFile]) -> String {
    let mut text = "# Times by graphics card\n\n\
        Times of techniques at their default settings on graphics cards, one file for each card in `bench/cards`. To add yours:\n\n\
        ```sh\nantumbra bench --share card.json\n```\n\n\
        and send the file. It holds the names of adapter, driver and operating system, version and commit of the program, the day, and the \
        times: no paths, no host, no user. Put it into `bench/cards`, and print this page by `antumbra bench --cards bench/cards`.\n\n\
        Compare only within one row of a table; commits differ.\n\n\
        | adapter | driver | backend | system | version | commit | date |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    for file in files {
        let SharedFile { adapter, driver, backend, system, antumbra, commit, date, .. } = file;
        let cells = [adapter, driver, backend, system, antumbra, commit, date].map(|cell| cell.replace('|', "/"));
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    for ((scene, size), of_scene) in by_scene(files) {
        for cards in of_scene.chunks(ACROSS) {
            text += &table(&scene, size, cards);
        }
    }
    text
}

type Card<'a> = (&'a SharedFile, Vec<&'a BenchRow>);

/// Groups the rows by scene and size, and then by card.
fn by_scene(files: &[SharedFile]) -> BTreeMap<(String, [u32; 2]), Vec<Card<'_>>> {
    let mut scenes: BTreeMap<_, Vec<Card<'_>>> = BTreeMap::new();
    for file in files {
        let mut own: BTreeMap<_, Vec<&BenchRow>> = BTreeMap::new();
        for row in &file.rows {
            own.entry((row.scene.clone(), row.size)).or_default().push(row);
        }
        own.into_iter().for_each(|(place, rows)| scenes.entry(place).or_default().push((file, rows)));
    }
    scenes
}

fn table(scene: &str, [width, height]: [u32; 2], cards: &[Card<'_>]) -> String {
    let name = builtin::spec_of(scene).unwrap_or(scene);
    let titles: Vec<String> = cards.iter().map(|(file, _)| file.title().replace('|', "/")).collect();
    let mut text = format!(
        "\n## `{name}`, {width} × {height}\n\n| ms | {} |\n|---|{}\n",
        titles.join(" | "),
        "---:|".repeat(cards.len())
    );
    // Techniques in the library's order, then qualities and techniques of other versions.
    let mut techniques: Vec<String> = TechniqueKind::ALL.iter().map(|kind| kind.name().to_owned()).collect();
    for row in cards.iter().flat_map(|(_, rows)| rows) {
        if !techniques.contains(&row.technique) {
            techniques.push(row.technique.clone());
        }
    }
    for technique in techniques {
        let cells: Vec<String> = cards.iter().map(|(_, rows)| cell(rows, &technique)).collect();
        if cells.iter().any(|cell| !cell.is_empty()) {
            let _ = writeln!(text, "| `{technique}` | {} |", cells.join(" | "));
        }
    }
    text
}

/// Formats milliseconds; a dash if the adapter cannot run the technique, empty if not measured.
fn cell(rows: &[&BenchRow], technique: &str) -> String {
    match rows.iter().find(|row| row.technique == technique).map(|row| &row.outcome) {
        None => String::new(),
        Some(BenchOutcome::Ran { timings, .. }) => format!("{:.2}", timings.total_ms),
        Some(BenchOutcome::Skipped(_)) => "–".into(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Map, Value, json};

    use super::*;

    fn row(scene: &str, technique: &str, outcome: Value) -> Value {
        let mut row = json!({ "scene": scene, "triangles": 1, "light": "key", "size": [64, 36], "technique": technique,
            "parameters": Map::new() });
        row.as_object_mut().unwrap().extend(outcome.as_object().unwrap().clone());
        row
    }

    fn ran(ms: f64) -> Value {
        json!({ "ran": { "memory_bytes": 1, "timings": { "passes": [], "total_ms": ms, "total_p10_ms": ms, "total_p90_ms": ms,
            "processor_ms": 0.1, "clock": "gpu_timestamps", "warm_up": 3, "frames": 5 } } })
    }

    fn file(adapter: &str, rows: Vec<Value>) -> SharedFile {
        let json = json!({ "format": FORMAT, "version": VERSION, "antumbra": "0.1.0", "commit": "abc", "date": "2026-11-27",
            "system": "linux x86_64", "adapter": adapter, "driver": "d 1", "backend": "vulkan", "software": false, "warm_up": 3,
            "frames": 5, "rows": rows });
        serde_json::from_value(json).unwrap()
    }

    #[test]
    fn cards_are_columns_of_a_table_for_each_scene() {
        let files = [
            file("card A", vec![row("builtin:street", "pcf", ran(1.5)), row("builtin:street", "pcss:fast", ran(2.0))]),
            file(
                "card B",
                vec![
                    row("builtin:street", "pcf", json!({ "skipped": "it lacks something" })),
                    row("builtin:columns", "hard", ran(0.25)),
                ],
            ),
        ];
        let text = markdown(&files);
        for line in [
            "| card A | d 1 | vulkan | linux x86_64 | 0.1.0 | abc | 2026-11-27 |",
            "| ms | card A, abc | card B, abc |",
            "| `pcf` | 1.50 | – |",
            "| `pcss:fast` | 2.00 |  |",
            "| ms | card B, abc |",
            "| `hard` | 0.25 |",
        ] {
            assert!(text.contains(line), "no `{line}` in\n{text}");
        }
        assert!(!text.contains("`vsm`"), "nobody measured it");
    }

    #[test]
    fn other_files_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        assert!(read_folder(dir.path()).unwrap_err().to_string().contains("no .json files"));
        for text in ["", "{}", r#"{"format":"antumbra-share","version":99}"#] {
            std::fs::write(dir.path().join("a.json"), text).unwrap();
            let error = read_folder(dir.path()).unwrap_err().to_string();
            assert!(error.ends_with("give files that `antumbra bench --share` wrote"), "{error}");
        }
        let error = check_scenes(&["builtin:street".into(), "home/me.glb".into()]).unwrap_err().to_string();
        assert!(error.contains("home/me.glb is a file"), "{error}");
        assert!(check_scenes(&["builtin:knot?triangles=1000".into()]).is_ok());
    }

    /// The page of cards is up to date with the files.
    #[test]
    fn the_page_of_cards_is_what_the_files_say() {
        let bench = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bench");
        let files = read_folder(&bench.join("cards")).unwrap();
        let page = std::fs::read_to_string(bench.join("cards.md")).unwrap();
        assert!(
            page.trim_end() == markdown(&files).trim_end(),
            "regenerate the page: antumbra bench --cards bench/cards > bench/cards.md"
        );
        assert!(files.iter().any(|file| file.adapter.contains("H200")));
        let personal = |file: &SharedFile| file.rows.iter().any(|row| builtin::spec_of(&row.scene).is_none());
        assert!(!files.iter().any(personal));
    }
}
