//! Every file that `broken/expected.tsv` lists has one of the outcomes given there, without panic, hang or a scene that
//! would put a NaN into the frame.

use std::time::Duration;

use super::{guarded, scenes_folder, unsound};
use crate::gltf::{Limits, Pose, load_file};

/// Permitted outcomes of a file.
#[derive(Debug, PartialEq)]
struct Wanted {
    may_load: bool,
    may_fail: bool,
    empty: bool,
}

/// Parses the third column: it names the wanted outcome first, and alternatives after `or`.
fn wanted(text: &str) -> Wanted {
    let alternative = text.contains(" or ") || text.contains(", or ");
    let or_fails = ["or error", "or refused"].iter().any(|s| text.contains(s));
    let fails_first = text.starts_with("error");
    assert!(fails_first || text.starts_with("loads"), "{text}");
    Wanted {
        may_load: !fails_first || alternative,
        may_fail: fails_first || or_fails,
        empty: text.starts_with("loads as empty") && !alternative,
    }
}

#[test]
fn expectations_are_understood() {
    let of = |may_load, may_fail, empty| Wanted { may_load, may_fail, empty };
    assert_eq!(wanted("error, no crash"), of(false, true, false));
    assert_eq!(wanted("error or repair, no crash"), of(true, true, false));
    assert_eq!(wanted("loads"), of(true, false, false));
    assert_eq!(wanted("loads as empty"), of(true, false, true));
    assert_eq!(wanted("loads; the bad part is dropped or repaired, never NaN in the frame"), of(true, false, false));
    assert_eq!(wanted("loads with a placeholder, or error"), of(true, true, false));
}

#[test]
fn every_broken_file_does_what_is_wanted() {
    let Some(scenes) = scenes_folder() else { return };
    let folder = scenes.join("broken");
    let table = std::fs::read_to_string(folder.join("expected.tsv")).unwrap();
    let mut failures = Vec::new();
    let mut files = 0;
    for row in table.lines().skip(1) {
        let columns: Vec<&str> = row.split('\t').collect();
        let (name, wanted) = (columns[0], wanted(columns[2]));
        files += 1;
        let path = folder.join(name);
        // Times at the start of the clips, within them and after them.
        for time_s in [0.0, 0.3, 1e9] {
            let path = path.clone();
            let outcome = guarded(Duration::from_secs(20), move || {
                load_file(&path, Pose::At(time_s), Limits::GENEROUS)
                    .map(|loaded| (loaded.scene.triangle_count(), unsound(&loaded.scene)))
            });
            let failure = match outcome {
                Err(crash) => Some(format!("crashed: {crash}")),
                Ok(Ok((_, Some(problem)))) => Some(format!("loads unsound: {problem}")),
                Ok(Ok((n, None))) if wanted.empty && n > 0 => Some(format!("has {n} triangles")),
                Ok(Ok(_)) if !wanted.may_load => Some("loads".into()),
                Ok(Err(e)) if !wanted.may_fail => Some(format!("fails: {e}")),
                Ok(Err(e)) if e.to_string().contains('\n') => Some(format!("says more than a line: {e}")),
                Ok(_) => None,
            };
            if let Some(failure) = failure {
                failures.push(format!("{name} (wanted: {}): {failure}", columns[2]));
                break;
            }
        }
    }
    assert!(failures.is_empty(), "{} of {files} files:\n{}", failures.len(), failures.join("\n"));
    println!("{files} files do what is wanted");
}
