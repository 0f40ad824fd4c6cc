//! The page in a headless browser: it tests itself (`crates/antumbra-web/page/check.js`) and posts its results to its server.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::browser::{self, PageTimeouts, Posts};
use super::compare;
use crate::shell::{self, cargo};

/// Set of masks to draw.
#[derive(Clone, Copy, PartialEq)]
pub enum Extent {
    /// One mask per technique.
    Techniques,
    /// Also masks of alpha-tested and tinted casters, and with every choice and switch changed.
    Variants,
}

/// Time limits. A software adapter takes minutes for some masks.
const TIMEOUTS: PageTimeouts = PageTimeouts { silence: Duration::from_secs(600), all: Duration::from_secs(10_800) };

/// Draws all masks on the system's adapter, has the page test itself, and compares its masks with the system's.
///
/// # Errors
/// The page's first failure, the first line on its console, or a mask that differs.
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
    let mut posted = PostedState::default();
    loop {
        let from = posted.begun.map_or(0, |index| index + 1);
        let outcome = {
            let address = format!("{address}?test={test}&from={from}");
            let _running = browser::launch(program, &profile, &log, &address)?;
            follow(&posts, &web, &mut posted)
        };
        // The console of a browser that ended early may contain messages about its end.
        match outcome {
            Ok(()) => break browser::clean_console(&log)?,
            Err(why) if posted.begun.is_some_and(|index| index >= from) => {
                eprintln!("xtask: {why}; continuing after that mask in a new browser");
                while posts.try_recv().is_ok() {}
            }
            Err(why) => return Err(why),
        }
    }
    draw_natively(&native, extent, None)?;
    let mut natives = vec![native];
    // The browser's own driver without the browser: remaining differences are due to the browser or this library, not the rasteriser.
    if let Some(driver) = browser::software_driver(program) {
        draw_natively(&same, extent, Some(&driver))?;
        natives.insert(0, same);
    }
    compare::compare(&natives, &web, &posted.adapter, &folder.join("masks.md"))?;
    eprintln!("xtask: tested the page in {} s", began.elapsed().as_secs());
    Ok(())
}

/// Draws masks with the system's driver or another. The whole workspace is built, so that features are the same everywhere.
fn draw_natively(folder: &Path, extent: Extent, driver: Option<&Path>) -> Result<(), String> {
    shell::run(cargo().args(["build", "--locked", "--workspace", "--example", "masks"]))?;
    let own = std::env::current_exe().map_err(|error| format!("cannot find the path of this program: {error}"))?;
    let program = own.with_file_name("examples").join(format!("masks{}", std::env::consts::EXE_SUFFIX));
    let extent = if extent == Extent::Variants { "all" } else { "techniques" };
    let mut command = Command::new(program);
    if let Some(driver) = driver {
        // The variable's name depends on the version of the Vulkan loader.
        command.env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver);
    }
    shell::run(command.arg(folder).arg(extent))
}

/// State that the page has posted, from one browser after another.
#[derive(Debug, Default)]
struct PostedState {
    adapter: String,
    /// Index of the mask that it started last.
    begun: Option<usize>,
}

/// Writes the masks that arrive, and prints steps, until the page is done.
fn follow(posts: &Posts, folder: &Path, posted: &mut PostedState) -> Result<(), String> {
    browser::follow(posts, &TIMEOUTS, |path, body| {
        let text = || String::from_utf8_lossy(body).into_owned();
        match path {
            "/adapter" => posted.adapter = text(),
            "/begun" => posted.begun = text().parse().ok(),
            _ => {
                let index = path.strip_prefix("/mask/").and_then(|index| index.parse::<usize>().ok());
                let index = index.ok_or_else(|| format!("the page posted to an unknown path, {path}"))?;
                let file = folder.join(format!("{index}.f32"));
                std::fs::write(&file, body).map_err(|error| format!("{}: {error}", file.display()))?;
            }
        }
        Ok(())
    })
}
