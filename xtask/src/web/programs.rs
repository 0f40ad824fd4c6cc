//! Compiles every shader module and layout of library, renderer and viewer, and optionally every pipeline, with a browser's compiler.
//! `xtask/programs` creates and describes them natively; its page creates them again in a headless browser, within WebGPU's
//! default limits.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::browser::{self, PageTimeouts};
use crate::shell;

/// Files of the page, from `xtask/programs/page`.
const PAGE: [&str; 2] = ["index.html", "make.js"];

/// Time limits. The page itself waits at most twenty seconds for a pipeline.
const TIMEOUTS: PageTimeouts = PageTimeouts { silence: Duration::from_secs(300), all: Duration::from_secs(1800) };

/// Extent of what the browser creates.
#[derive(Clone, Copy, PartialEq)]
pub enum Extent {
    /// Modules and layouts, which the browser's own compiler checks: seconds.
    ModulesAndLayouts,
    /// Also pipelines, which its driver compiles: many minutes on a software driver, and more memory than some have.
    Pipelines,
}

/// Creates them in a browser, if there is one or it can be installed.
///
/// # Errors
/// What the browser rejects, and why.
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
    eprintln!("xtask: described programs after {} s", began.elapsed().as_secs());
    let log = folder.join("browser.log");
    let (address, posts) = browser::serve_aside(&page)?;
    let address = if extent == Extent::Pipelines { format!("{address}?pipelines") } else { address };
    let mut adapter = String::new();
    let running = browser::launch(browser, &profile, &log, &address)?;
    browser::follow(&posts, &TIMEOUTS, |path, body| {
        if path != "/adapter" {
            return Err(format!("the page posted to an unknown path, {path}"));
        }
        adapter = String::from_utf8_lossy(body).into_owned();
        Ok(())
    })?;
    drop(running);
    browser::clean_console(&log)?;
    let what = if extent == Extent::Pipelines { "shader and pipeline" } else { "shader" };
    eprintln!("xtask: {adapter} created every {what}; {} s", began.elapsed().as_secs());
    Ok(())
}
