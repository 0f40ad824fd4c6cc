//! The page in a headless browser: it tries itself (`crates/antumbra-web/page/check.js`) and posts what it finds to the
//! server that it came from.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::browser::{self, Patience, Posts};
use super::compare;
use crate::shell::{self, cargo};

/// Which masks are drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Extent {
    /// One of each technique.
    Techniques,
    /// And on casters with holes, on tinted ones, with every choice and switch turned.
    Variants,
}

/// Software draws some masks for minutes.
const PATIENCE: Patience = Patience { silence: Duration::from_secs(600), all: Duration::from_secs(10_800) };

/// Draws all masks on the system's adapter, has the page try itself, and holds its masks against the system's.
///
/// # Errors
/// The first thing that the page could not do, the first word on its console, or a mask that differs.
pub fn check(page: &Path, program: &Path, extent: Extent) -> Result<(), String> {
    let began = Instant::now();
    let test = if extent == Extent::Variants { "all" } else { "" };
    let folder = crate::root().join("target/web-check");
    let [native, same, web, profile] = ["native", "same", "web", "profile"].map(|name| folder.join(name));
    for old in [&native, &same, &web, &profile] {
        browser::make_anew(old)?;
    }
    let log = folder.join("browser.log");
    let (address, posts) = browser::serve_aside(page)?;
    let mut told = Told::default();
    loop {
        let from = told.begun.map_or(0, |index| index + 1);
        let outcome = {
            let address = format!("{address}?test={test}&from={from}");
            let _running = browser::launch(program, &profile, &log, &address)?;
            follow(&posts, &web, &mut told)
        };
        // Of what a browser that has ended said on its console, its end may be a part.
        match outcome {
            Ok(()) => break browser::clean_console(&log)?,
            Err(why) if told.begun.is_some_and(|index| index >= from) => {
                eprintln!("xtask: {why}; another browser goes on after that mask");
                while posts.try_recv().is_ok() {}
            }
            Err(why) => return Err(why),
        }
    }
    draw_natively(&native, extent, None)?;
    let mut natives = vec![native];
    // The browser's own driver, without the browser: what differs there is the browser's or ours, not the rasteriser's.
    if let Some(driver) = browser::software_driver(program) {
        draw_natively(&same, extent, Some(&driver))?;
        natives.insert(0, same);
    }
    compare::compare(&natives, &web, &told.adapter, &folder.join("masks.md"))?;
    eprintln!("xtask: the page tried in {} s", began.elapsed().as_secs());
    Ok(())
}

/// By the system's driver or another. Built of the whole workspace, so that features are those of everything else.
fn draw_natively(folder: &Path, extent: Extent, driver: Option<&Path>) -> Result<(), String> {
    shell::run(cargo().args(["build", "--locked", "--workspace", "--example", "masks"]))?;
    let own = std::env::current_exe().map_err(|error| format!("cannot tell where this program lies: {error}"))?;
    let program = own.with_file_name("examples").join(format!("masks{}", std::env::consts::EXE_SUFFIX));
    let extent = if extent == Extent::Variants { "all" } else { "techniques" };
    let mut command = Command::new(program);
    if let Some(driver) = driver {
        // Vulkan's loader has gone by both names.
        command.env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver);
    }
    shell::run(command.arg(folder).arg(extent))
}

/// What the page has told of itself, in one browser after another.
#[derive(Debug, Default)]
struct Told {
    adapter: String,
    /// The mask that it began last.
    begun: Option<usize>,
}

/// Writes the masks that come, and tells of steps, until the page is done.
fn follow(posts: &Posts, folder: &Path, told: &mut Told) -> Result<(), String> {
    browser::follow(posts, &PATIENCE, |path, body| {
        let text = || String::from_utf8_lossy(body).into_owned();
        match path {
            "/adapter" => told.adapter = text(),
            "/begun" => told.begun = text().parse().ok(),
            _ => {
                let index = path.strip_prefix("/mask/").and_then(|index| index.parse::<usize>().ok());
                let index = index.ok_or_else(|| format!("the page posts to {path}"))?;
                let file = folder.join(format!("{index}.f32"));
                std::fs::write(&file, body).map_err(|error| format!("{}: {error}", file.display()))?;
            }
        }
        Ok(())
    })
}
