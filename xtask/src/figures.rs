//! `cargo xtask figures`: renders the images of the book and the README with the code that they explain.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::machine;
use crate::shell;

/// Page whose generated headings name each technique and the scene on which it fails worst.
const WORST_CASES: &str = "docs/limits.md";

/// Techniques that `docs/choose.md` shows side by side.
const CHOICES: [&str; 6] = ["hard", "moment", "pcss", "smrt", "multi_layer", "sample_based"];
const CHOICES_SCENE: &str = "builtin:bench-under-tree";

/// Images of `docs/lights.md`, by name.
const LIGHTS: [(&str, &str); 3] = [("lamp", "builtin:lamp-room"), ("hall", "builtin:hall"), ("sun", "builtin:town")];

/// Images of the README, side by side with the truth.
const HERO_SCENE: &str = "builtin:shanty";
const HERO: [&str; 2] = ["hard", "smrt"];

/// Animation of the README: the light circles above the scene.
const MOVING_SCENE: &str = "builtin:bench-under-tree";
const MOVING_FRAMES: u32 = 12;
const MOVING_MILLISECONDS: &str = "150";

/// Compares each technique with the truth on its worst case and copies three images to `docs/figures`; then renders the other images
/// of the book. With names, renders only the images of these techniques.
///
/// # Errors
/// The first step that failed, or a name that no technique has.
pub fn run(names: &[String]) -> Result<(), String> {
    let page =
        std::fs::read_to_string(crate::root().join(WORST_CASES)).map_err(|error| format!("{WORST_CASES}: {error}"))?;
    let worst_cases = worst_cases(&page);
    if let Some(name) = names.iter().find(|name| worst_cases.iter().all(|(technique, _)| technique != name)) {
        let known: Vec<_> = worst_cases.iter().map(|(technique, _)| *technique).collect();
        return Err(format!("figures: there is no technique `{name}`; available: {}", known.join(", ")));
    }
    machine::set_up()?;
    let binary = shell::built_of_workspace("antumbra")?;
    let figures = crate::root().join("docs/figures");
    std::fs::create_dir_all(&figures).map_err(|error| format!("{}: {error}", figures.display()))?;
    let is_wanted = |technique: &str| names.is_empty() || names.iter().any(|name| name == technique);
    for (technique, scene) in worst_cases.into_iter().filter(|(technique, _)| is_wanted(technique)) {
        let from = compare(&binary, scene, technique, "480x270", technique)?;
        copy(&from.join("reference_shaded.png"), &figures.join(format!("{technique}_truth.png")))?;
        copy(&from.join(format!("{technique}_shaded.png")), &figures.join(format!("{technique}.png")))?;
        copy(&from.join(format!("{technique}_error.png")), &figures.join(format!("{technique}_error.png")))?;
    }
    if !names.is_empty() {
        return Ok(());
    }
    let from = compare(&binary, CHOICES_SCENE, &CHOICES.join(","), "320x180", "choose")?;
    for technique in CHOICES {
        copy(&from.join(format!("{technique}_shaded.png")), &figures.join(format!("choose_{technique}.png")))?;
        copy(&from.join(format!("{technique}_error.png")), &figures.join(format!("choose_{technique}_error.png")))?;
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
    let from = compare(&binary, HERO_SCENE, &HERO.join(","), "640x360", "hero")?;
    for name in HERO.into_iter().chain(["reference"]) {
        copy(&from.join(format!("{name}_shaded.png")), &figures.join(format!("hero_{name}.png")))?;
    }
    animate(&binary, &figures.join("moving.png"))?;
    println!("Figures: {}", figures.display());
    Ok(())
}

/// Renders the frames of the README's animation and joins them.
fn animate(binary: &Path, to: &Path) -> Result<(), String> {
    let folder = crate::root().join("out/figures/moving");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut frames = Vec::new();
    for frame in 0..MOVING_FRAMES {
        let setup = folder.join(format!("{frame}.toml"));
        let image = folder.join(format!("{frame}.png"));
        std::fs::write(&setup, moving_setup(frame)).map_err(|error| format!("{}: {error}", setup.display()))?;
        let mut render = Command::new(binary);
        render.args(["render", MOVING_SCENE, "--size", "320x180", "--setup"]).arg(&setup).arg("-o").arg(&image);
        shell::run(&mut render)?;
        frames.push(image);
    }
    let mut join = Command::new(shell::built_of_workspace("antumbra-animate")?);
    shell::run(join.arg(to).arg(MOVING_MILLISECONDS).args(frames))
}

/// Returns camera and light of a frame. The light's path is closed, so that the animation repeats without a jump.
fn moving_setup(frame: u32) -> String {
    let (sin, cos) = (std::f32::consts::TAU * frame as f32 / MOVING_FRAMES as f32).sin_cos();
    let (x, z) = (2.2 * cos - 1.2, 1.6 * sin - 1.6);
    format!(
        "[camera]\neye = [2.5, 1.9, 4.3]\ntarget = [0.25, 0.55, 0.15]\nfov_y = 40.0\n\n\
         [[light]]\nshape = \"rectangle\"\ncenter = [{x:.3}, 7.6, {z:.3}]\ntarget = [0.0, 0.5, 0.0]\n\
         size = [0.5, 0.5]\ncolor = [1.0, 0.95, 0.87]\n"
    )
}

/// Returns techniques and scenes of the headings `` ### `NAME` on `SCENE` ``, which are generated from the techniques' declarations.
fn worst_cases(page: &str) -> Vec<(&str, &str)> {
    page.lines().filter_map(|line| line.strip_prefix("### `")?.strip_suffix('`')?.split_once("` on `")).collect()
}

/// Compares with the truth, and returns the folder of the images.
fn compare(binary: &Path, scene: &str, techniques: &str, size: &str, name: &str) -> Result<PathBuf, String> {
    let out = crate::root().join("out/figures").join(name);
    let mut compare = Command::new(binary);
    compare.args(["compare", scene, "--techniques", techniques, "--size", size, "-o"]).arg(&out);
    shell::run(&mut compare)?;
    Ok(out.join("images"))
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    std::fs::copy(from, to).map(|_| ()).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))
}

#[cfg(test)]
mod tests {
    use super::worst_cases;

    #[test]
    fn techniques_and_scenes_are_read_off_the_page() {
        let page = include_str!("../../docs/limits.md");
        let rows = worst_cases(page);
        assert!(rows.len() > 20 && rows.contains(&("hard", "builtin:overlap")), "{rows:?}");
        assert!(rows.iter().all(|(name, scene)| !name.contains(' ') && scene.starts_with("builtin:")), "{rows:?}");
    }
}
