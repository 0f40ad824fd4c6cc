//! Every shader module, layout and pipeline of library, renderer and viewer, made by a browser's compiler: `xtask/programs` makes
//! and describes them natively, and its page makes them again in a headless browser, within WebGPU's default limits.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use super::browser::{self, Patience};
use crate::shell::{self, cargo};

/// The page's own files, from `xtask/programs/page`.
const PAGE: [&str; 2] = ["index.html", "make.js"];

/// The page itself waits for no pipeline longer than twenty seconds.
const PATIENCE: Patience = Patience { silence: Duration::from_secs(300), all: Duration::from_secs(1800) };

/// Has a browser make all of them, where there is one or it can be installed.
///
/// # Errors
/// What the browser refuses, and why; or a linked shader that no pipeline is made of.
pub fn check() -> Result<(), String> {
    match browser::get() {
        Ok(browser) => check_in(&browser),
        Err(lack) => {
            eprintln!("xtask: SKIPPED shaders in a browser: {lack}");
            Ok(())
        }
    }
}

fn check_in(browser: &Path) -> Result<(), String> {
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
    shell::run(Command::new(describer()?).arg(page.join("programs.json")))?;
    eprintln!("xtask: programs described after {} s", began.elapsed().as_secs());
    let log = folder.join("browser.log");
    let (address, posts) = browser::serve_aside(&page)?;
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
    eprintln!("xtask: every shader and pipeline is made by {adapter}; {} s", began.elapsed().as_secs());
    Ok(())
}

/// The program that describes them. Built of the whole workspace, so that features are those of everything else.
fn describer() -> Result<PathBuf, String> {
    shell::run(cargo().args(["build", "--locked", "--workspace", "--bin", "antumbra-programs"]))?;
    let own = std::env::current_exe().map_err(|error| format!("cannot tell where this program lies: {error}"))?;
    Ok(own.with_file_name(format!("antumbra-programs{}", std::env::consts::EXE_SUFFIX)))
}
