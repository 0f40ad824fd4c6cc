//! `cargo xtask demo`: builds everything and creates a report.

use std::process::Command;
use std::time::Instant;

use crate::driver::{self, Driver};
use crate::machine;
use crate::shell::{self, find};

/// Built-in scenes of the demo: light bleeding where one averaged blocker represents several; one occluder from contact to far; a
/// close and a distant occluder over one wall; leaves far above, boards close by.
const SCENES: [&str; 4] =
    ["builtin:overlap", "builtin:leaning-plank", "builtin:lantern-wall", "builtin:bench-under-tree"];

/// Techniques of the demo: recommended ones of every family, and baselines. All techniques would take a software renderer half an hour.
const TECHNIQUES: &str = "hard,pcf,pcss,smrt,lvsm,moment,multi_layer,reprojection_layered,sample_based,multi_view";

/// Sets up, builds, compares, and opens the report if there is a display.
///
/// # Errors
/// The first step that failed.
pub fn run(args: &[String]) -> Result<(), String> {
    let began = Instant::now();
    let (wanted, args) = driver::option(args)?;
    let (flags, given): (Vec<&String>, Vec<&String>) = args.iter().partition(|arg| arg.starts_with('-'));
    if let Some(unknown) = flags.iter().find(|flag| **flag != "--no-open") {
        return Err(format!("demo has no option `{unknown}`; it has --no-open and --driver"));
    }
    machine::set_up()?;
    let driver = Driver::choose(wanted)?;
    eprintln!("xtask: building the command `antumbra` (about six minutes on two cores the first time)");
    let binary = shell::built_of_workspace("antumbra")?;
    eprintln!("xtask: built in {} s", began.elapsed().as_secs());

    // The user's own scenes come first. Their paths are relative to the current directory.
    let out = crate::root().join("out/demo");
    let mut compare = Command::new(binary);
    compare
        .envs(driver.variables())
        .arg("compare")
        .args(given)
        .args(SCENES)
        .args(["--techniques", TECHNIQUES, "--size", "640x360", "-o"])
        .arg(&out);
    shell::run(&mut compare)?;
    eprintln!("xtask: done after {} s", began.elapsed().as_secs());

    let index = out.join("index.html");
    println!("Report: {}", index.display());
    println!("Viewer: cargo run --bin antumbra -- view   (or `view path/to/scene.glb`)");
    let has_display = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if flags.is_empty() && has_display && find("xdg-open").is_some() {
        // The path is already printed, so failing to open the report is not an error.
        let _ = shell::run(Command::new("xdg-open").arg(&index));
    }
    Ok(())
}
