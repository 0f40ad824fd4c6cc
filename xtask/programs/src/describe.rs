//! Descriptions of every shader module, layout and pipeline as JSON, for the page in `page/`, which creates them in a browser:
//! the native half of `cargo xtask web --shaders` and `--pipelines`.
//!
//! The descriptors passed to wgpu are recorded, so no list has to be maintained. Linked shaders without a pipeline are described as
//! modules, and reported.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::description::{Entry, Programs};
use crate::device;

/// Writes all descriptions to a file. Returns the number of modules and of pipelines.
///
/// # Errors
/// If something is rejected, or a file cannot be read or written.
pub fn write(file: &Path) -> Result<[usize; 2], String> {
    let programs = Arc::new(Mutex::new(Programs::default()));
    let kept = programs.clone();
    antumbra::programs::listen(move |made| kept.lock().unwrap_or_else(PoisonError::into_inner).add(made));
    device::make_all_variants()?;
    let mut programs = std::mem::take(&mut *programs.lock().unwrap_or_else(PoisonError::into_inner));
    add_linked(&mut programs, &linked_folder())?;
    let counts = programs.counts();
    std::fs::write(file, programs.into_json().to_string()).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(counts)
}

/// Adds the linked shaders without a pipeline, and reports them.
///
/// # Errors
/// If one cannot be read.
fn add_linked(programs: &mut Programs, folder: &Path) -> Result<(), String> {
    let mut missing = Vec::new();
    for file in linked_files(folder)? {
        let wgsl = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let name = file.strip_prefix(folder).unwrap_or(&file).display().to_string();
        programs.add_module(&name, &wgsl);
        let module = programs.place_of_text(&wgsl).expect("added where it was not there");
        let entries = entry_points(&wgsl);
        assert!(!entries.is_empty(), "{name} has no entry point");
        let is_missing =
            |(stage, entry): &(&str, &str)| !programs.has_pipeline_of(Entry { module, stage, name: Some(entry) });
        missing.extend(entries.into_iter().filter(is_missing).map(|(_, entry)| format!("{name}: {entry}")));
    }
    if !missing.is_empty() {
        eprintln!("programs: no pipeline was created for the modules of:\n{}", missing.join("\n"));
    }
    Ok(())
}

/// Returns the folder of linked shaders.
pub fn linked_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/antumbra/linked")
}

/// Returns the linked shaders, except those of tests.
///
/// # Errors
/// If a folder cannot be read.
pub fn linked_files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for path in entries.flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                if path.file_name().is_some_and(|name| name != "test") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|ending| ending == "wgsl") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Returns stage and name of each entry point of a linked shader.
fn entry_points(wgsl: &str) -> Vec<(&str, &str)> {
    let mut entries = Vec::new();
    for stage in ["compute", "vertex", "fragment"] {
        let attribute = format!("@{stage}");
        for (place, _) in wgsl.match_indices(&attribute) {
            let after = wgsl[place..].split_once("fn ").map(|(_, after)| after);
            let name = after.and_then(|after| after.split(|c: char| !c.is_alphanumeric() && c != '_').next());
            entries.extend(name.map(|name| (&wgsl[place + 1..place + attribute.len()], name)));
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entry_points_are_found() {
        let wgsl = "@vertex\nfn vertex_screen() {}\nfn helper() {}\n@fragment fn draw() {}\n\
                    @compute @workgroup_size(8, 8)\nfn count(@builtin(global_invocation_id) id: vec3u) {}";
        assert_eq!(entry_points(wgsl), [("compute", "count"), ("vertex", "vertex_screen"), ("fragment", "draw")]);
    }

    #[test]
    fn linked_shaders_are_found() {
        let files = linked_files(&linked_folder()).unwrap();
        assert!(files.len() > 90, "{}", files.len());
        assert!(files.iter().all(|file| file.extension().is_some_and(|ending| ending == "wgsl")));
    }
}
