//! `cargo xtask figures`: the pictures of `docs/limits.md` and the README, made by the code that they explain.

use std::path::Path;
use std::process::Command;

use crate::machine;
use crate::shell::{self, cargo};

/// Each technique where it fails worst among the built-in scenes that one picture explains.
const WORST_CASES: &[(&str, &str)] = &[
    ("hard", "builtin:overlap"),
    ("pcf", "builtin:lantern-wall"),
    ("pcss", "builtin:window"),
    ("multi_view", "builtin:ring-in-grass"),
    ("multi_layer", "builtin:fence-geometry"),
    ("reprojection", "builtin:tree"),
    ("reprojection_layered", "builtin:tree"),
    ("alias_free", "builtin:columns"),
    ("sample_based", "builtin:stained-glass"),
    ("vsm", "builtin:overlap"),
    ("lvsm", "builtin:bench-under-tree"),
    ("evsm", "builtin:tree"),
    ("esm", "builtin:stacked-panels"),
    ("convolution", "builtin:leaning-plank"),
    ("moment", "builtin:lantern-wall"),
    ("pcss_anisotropic", "builtin:tree"),
    ("essm", "builtin:tree"),
    ("savsm", "builtin:overlap"),
    ("vssm", "builtin:overlap"),
    ("cssm", "builtin:leaning-plank"),
    ("evssm", "builtin:tree"),
    ("mssm", "builtin:tree"),
];

/// The pictures of `docs/lights.md`, by name.
const LIGHTS: [(&str, &str); 3] = [("lamp", "builtin:lamp-room"), ("hall", "builtin:hall"), ("sun", "builtin:town")];

/// The README's picture.
const HERO: (&str, &str) = ("pcss", "builtin:street");

/// Compares each technique with the truth on its worst case and keeps three pictures of it under `docs/figures`; then
/// draws what coherent shading is for, without it and with it, and the README's picture. Where techniques are named, their
/// pictures alone.
///
/// # Errors
/// The first step that failed, or a name that no technique has.
pub fn run(names: &[String]) -> Result<(), String> {
    if let Some(name) = names.iter().find(|name| WORST_CASES.iter().all(|(technique, _)| technique != name)) {
        let known: Vec<_> = WORST_CASES.iter().map(|(technique, _)| *technique).collect();
        return Err(format!("figures: there is no technique `{name}`; there are {}", known.join(", ")));
    }
    machine::set_up()?;
    shell::run(cargo().args(["build", "--locked", "--package", "antumbra-cli"]))?;
    let binary = shell::built_binary()?;
    let figures = crate::root().join("docs/figures");
    std::fs::create_dir_all(&figures).map_err(|error| format!("{}: {error}", figures.display()))?;
    let is_wanted = |technique: &str| names.is_empty() || names.iter().any(|name| name == technique);
    for &(technique, scene) in WORST_CASES.iter().filter(|(technique, _)| is_wanted(technique)) {
        let out = crate::root().join("out/figures").join(technique);
        let mut compare = Command::new(&binary);
        compare.args(["compare", scene, "--techniques", technique, "--size", "480x270", "-o"]).arg(&out);
        shell::run(&mut compare)?;
        for (from, to) in [
            ("reference_shaded.png".to_owned(), format!("{technique}_truth.png")),
            (format!("{technique}_shaded.png"), format!("{technique}.png")),
            (format!("{technique}_error.png"), format!("{technique}_error.png")),
        ] {
            copy(&out.join("images").join(from), &figures.join(to))?;
        }
    }
    if !names.is_empty() {
        return Ok(());
    }
    for (flags, name) in [(&[][..], "before"), (&["--coherent"], "after")] {
        let mut render = Command::new(&binary);
        render.args(["render", "builtin:spheres", "--technique", "sample_based", "--size", "480x270", "--setup"]);
        render.arg(figures.join("coherent.toml")).args(flags);
        render.arg("-o").arg(figures.join(format!("coherent_{name}.png")));
        shell::run(&mut render)?;
    }
    for (name, scene) in LIGHTS {
        let mut render = Command::new(&binary);
        render.args(["render", scene, "--technique", "pcss", "--size", "640x360", "-o"]);
        render.arg(figures.join(format!("lights_{name}.png")));
        shell::run(&mut render)?;
    }
    let (technique, scene) = HERO;
    let mut render = Command::new(&binary);
    render.args(["render", scene, "--technique", technique, "--size", "960x540", "-o"]).arg(figures.join("hero.png"));
    shell::run(&mut render)?;
    println!("Figures: {}", figures.display());
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    std::fs::copy(from, to).map(|_| ()).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))
}
