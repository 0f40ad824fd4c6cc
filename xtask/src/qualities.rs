//! `cargo xtask qualities`: measures time and error of each technique at each quality, into `bench/qualities.md`.

use std::process::Command;

use crate::machine;
use crate::shell;

/// Scenes with near and far occluders, thin ones and foliage. A software adapter renders them in a quarter of an hour.
const SCENES: &[&str] = &["builtin:overlap", "builtin:lantern-wall", "builtin:columns", "builtin:tree"];

/// All techniques at all qualities except `best`, whose maps of 4096 texels per side take a software adapter seconds per frame, and with
/// `reprojection_layered` minutes.
const TECHNIQUES: &str = "all:fast,all,all:high";

const HEAD: &str = "\
# Qualities

Error and time of each technique at its qualities `fast`, `balanced` (the default) and `high`, by `cargo xtask qualities`. `best` is for stills,
and takes a software adapter seconds to minutes a frame. `antumbra techniques NAME` lists what each quality sets. Compare these times only
with one another; `antumbra compare SCENE... --techniques pcss:fast,pcss,pcss:high -o out` measures your scenes on your adapter.

";

/// Compares every quality on a few built-in scenes, and writes the summary.
///
/// # Errors
/// The first step that failed.
pub fn run() -> Result<(), String> {
    machine::set_up()?;
    let binary = shell::built_of_workspace("antumbra")?;
    let out = crate::root().join("out/qualities");
    let mut compare = Command::new(binary);
    compare.arg("compare").args(SCENES).args([
        "--techniques",
        TECHNIQUES,
        "--size",
        "320x180",
        "--samples",
        "256",
        "-o",
    ]);
    shell::run(compare.arg(&out))?;
    let summary = out.join("summary.md");
    let text = std::fs::read_to_string(&summary).map_err(|error| format!("{}: {error}", summary.display()))?;
    let page = crate::root().join("bench/qualities.md");
    std::fs::write(&page, format!("{HEAD}{text}")).map_err(|error| format!("{}: {error}", page.display()))
}
