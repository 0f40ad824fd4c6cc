//! Every shader module and layout of library, renderer and viewer, and if asked for every pipeline, made by a browser's compiler:
//! `xtask/programs` makes and describes them natively, and its page makes them again in a headless browser, within WebGPU's
//! default limits.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::browser::{self, Patience};
use crate::shell;

/// The page's own files, from `xtask/programs/page`.
const PAGE: [&str; 2] = ["index.html", "make.js"];

/// The page itself waits for no pipeline longer than twenty seconds.
const PATIENCE: Patience = Patience { silence: Duration::from_secs(300), all: Duration::from_secs(1800) };

/// How much the browser makes.
#[derive(Clone, Copy, PartialEq)]
pub enum Extent {
    /// What its own compiler reads and checks: seconds.
    ModulesAndLayouts,
    /// And what its driver makes of them: on a software driver many minutes, and more memory than some have.
    Pipelines,
}

/// Has a browser make them, where there is one or it can be installed.
///
/// # Errors
/// What the browser refuses, and why.
pub fn check(extent: Extent) -> Result<(), String> {
    match browser::get() {
        Ok(browser) => check_in(&browser, extent),
        Err(lack) => {
            eprintln!("xtask: SKIPPED shaders in a browser: {lack}");
            Ok(())
        }
    }
}

fn check_in(browser: &Path, extent: Extent) -> Result<(), String> {
    let began = Instant::now();
    let folder = crate::root().join("target/web-programs");
    let [page, profile] = ["page", "profile"].map(|name| folder.join(name));
    for old in [&page, &profile] {
        browser::make_anew(old)?;
    }
    for name in PAGE {
        let from = crate::root().join("xtask/programs/page").join(name);
        std::fs::copy(&from, page.join(name)).map_err(|error| format!("{}: {error}", from.display()))?;
    }
    let describer = shell::built_of_workspace("antumbra-programs")?;
    shell::run(Command::new(describer).arg("describe").arg(page.join("programs.json")))?;
    eprintln!("xtask: programs described after {} s", began.elapsed().as_secs());
    let log = folder.join("browser.log");
    let (address, posts) = browser::serve_aside(&page)?;
    let address = if extent == Extent::Pipelines { format!("{address}?pipelines") } else { address };
    let mut adapter = String::new();
    let running = browser::launch(browser, &profile, &log, &address)?;
    browser::follow(&posts, &PATIENCE, |path, body| {
        if path != "/adapter" {
            return Err(format!("the page posts to {path}"));
        }
        adapter = String::from_utf8_lossy(body).into_owned();
        Ok(())
    })?;
    drop(running);
    browser::clean_console(&log)?;
    let what = if extent == Extent::Pipelines { "shader and pipeline" } else { "shader" };
    eprintln!("xtask: every {what} is made by {adapter}; {} s", began.elapsed().as_secs());
    Ok(())
}
