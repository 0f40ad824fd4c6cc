//! The site in a headless browser, served below a path. A crawler page (`xtask/site/crawl.js`) opens every page in a frame and posts the
//! faults that it finds: broken links and anchors, images without a text, pages wider than a small screen, late images.

use std::path::Path;
use std::time::Duration;

use crate::web::browser::{self, PageTimeouts};

/// Folder of the crawler page, below the root of the workspace.
const CRAWLER: &str = "xtask/site";

/// Path below which the site is served: not the root, so that absolute links fail.
const PATH: &str = "some/path/";

/// Time limits. A software adapter compiles the viewer's shaders slowly.
const TIMEOUTS: PageTimeouts = PageTimeouts { silence: Duration::from_secs(400), all: Duration::from_secs(1800) };

/// Crawls the site, if there is a browser or one can be installed.
///
/// # Errors
/// Every fault, and the first message on the console.
pub fn check(site: &Path) -> Result<(), String> {
    match browser::get() {
        Ok(program) => check_in(&program, site),
        Err(lack) => {
            eprintln!("xtask: SKIPPED the site in a browser: {lack}");
            Ok(())
        }
    }
}

fn check_in(program: &Path, site: &Path) -> Result<(), String> {
    let folder = crate::root().join("target/site-check");
    let profile = folder.join("profile");
    browser::make_anew(&profile)?;
    let log = folder.join("browser.log");
    let (address, posts) = browser::serve_both_aside(&crate::root().join(CRAWLER), PATH, site)?;
    let running = browser::launch(program, &profile, &log, &format!("{address}crawl.html?{PATH}"))?;
    let mut faults = Vec::new();
    browser::follow(&posts, &TIMEOUTS, |path, body| {
        if path != "/fault" {
            return Err(format!("the page posted to an unknown path, {path}"));
        }
        let fault = String::from_utf8_lossy(body).into_owned();
        eprintln!("xtask: FAULT {fault}");
        faults.push(fault);
        Ok(())
    })?;
    drop(running);
    match faults.first() {
        Some(first) => Err(format!("the site has {} faults; the first is: {first}", faults.len())),
        None => browser::clean_console(&log),
    }
}
