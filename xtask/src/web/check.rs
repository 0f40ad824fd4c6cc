//! The page in a headless browser: it tries itself (`crates/antumbra-web/page/check.js`) and posts what it finds to the
//! server that it came from.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::build::Built;
use super::compare;
use super::server::Server;
use crate::machine::{self, Need};
use crate::shell::{self, cargo, find};
use crate::wasm;

/// Names that browsers with WebGPU's software adapter go by.
const BROWSERS: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge"];

/// Where their files lie when what is on the path is a script.
const BROWSER_FOLDERS: [&str; 4] =
    ["/usr/lib/chromium", "/usr/lib/chromium-browser", "/opt/google/chrome", "/opt/microsoft/msedge"];

const BROWSER: [Need; 1] = [Need {
    why: "a browser with WebGPU, to try the page in",
    met: || browser().is_some(),
    packages: &["chromium"],
    otherwise: "install Chromium or Chrome",
}];

/// Which masks are drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Extent {
    /// One of each technique.
    Techniques,
    /// And on casters with holes, on tinted ones, with every choice and switch turned.
    Variants,
}

/// The page posts a step at least so often, or it hangs: software draws some masks for minutes.
const SILENCE: Duration = Duration::from_secs(600);
/// All of it takes less, or something is wrong.
const LONGEST: Duration = Duration::from_secs(10_800);

fn browser() -> Option<PathBuf> {
    BROWSERS.iter().find_map(|name| find(name))
}

/// The browser; installed where it can be, as what the page is built with.
///
/// # Errors
/// What is missing and what would bring it.
pub fn tools() -> Result<PathBuf, String> {
    wasm::compiler(&[])?;
    machine::install(&BROWSER)?;
    browser().ok_or_else(|| "no browser".into())
}

/// Draws all masks on the system's adapter, has the page try itself, and holds its masks against the system's.
///
/// # Errors
/// The first thing that the page could not do, the first word on its console, or a mask that differs.
pub fn check(built: &Built, browser: &Path, extent: Extent) -> Result<(), String> {
    let began = Instant::now();
    let test = if extent == Extent::Variants { "all" } else { "" };
    let folder = crate::root().join("target/web-check");
    let [native, same, web, profile] = ["native", "same", "web", "profile"].map(|name| folder.join(name));
    for old in [&native, &same, &web, &profile] {
        if old.exists() {
            std::fs::remove_dir_all(old).map_err(|error| format!("{}: {error}", old.display()))?;
        }
        std::fs::create_dir_all(old).map_err(|error| format!("{}: {error}", old.display()))?;
    }
    let log = folder.join("browser.log");
    let server = Server::new(&built.folder, 0)?;
    let address = server.address()?;
    let (sender, posts) = channel();
    thread::spawn(move || {
        // After the last step nobody listens any more.
        server.run(Arc::new(move |path, body| drop(sender.send((path.to_owned(), body)))));
    });
    let mut told = Told::default();
    loop {
        let from = told.begun.map_or(0, |index| index + 1);
        let outcome = {
            let address = format!("{address}?test={test}&from={from}");
            let _running = Running(launch(browser, &profile, &log, &address)?);
            follow(&posts, &web, &mut told)
        };
        // Of what a browser that has ended said on its console, its end may be a part.
        match outcome {
            Ok(()) => break clean_console(&log)?,
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
    if let Some(driver) = software_driver(browser) {
        draw_natively(&same, extent, Some(&driver))?;
        natives.insert(0, same);
    }
    compare::compare(&natives, &web, &told.adapter, &folder.join("masks.md"))?;
    eprintln!("xtask: the page tried in {} s", began.elapsed().as_secs());
    Ok(())
}

/// The Vulkan driver in software that lies beside a browser.
fn software_driver(browser: &Path) -> Option<PathBuf> {
    let own = browser.canonicalize().ok().and_then(|browser| browser.parent().map(Path::to_path_buf));
    let folders = own.into_iter().chain(BROWSER_FOLDERS.map(PathBuf::from));
    folders.map(|folder| folder.join("vk_swiftshader_icd.json")).find(|driver| driver.is_file())
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

/// A browser that ends with this value.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn launch(browser: &Path, profile: &Path, log: &Path, address: &str) -> Result<Child, String> {
    let file = std::fs::File::create(log).map_err(|error| format!("{}: {error}", log.display()))?;
    // Chromium takes its options' values in the same word.
    let mut profile_option = OsString::from("--user-data-dir=");
    profile_option.push(profile);
    Command::new(browser)
        // Containers have no sandbox to offer, and the page is ours.
        .args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run"])
        .args(["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-logging=stderr"])
        // Without these, software draws no canvas that WebGPU has drawn on, and long passes are taken for a hang.
        .args(["--use-gl=angle", "--use-angle=swiftshader", "--use-vulkan=swiftshader", "--enable-features=Vulkan"])
        .args(["--ignore-gpu-blocklist", "--disable-gpu-watchdog"])
        // The picture beside the panel is small: software draws it.
        .arg("--window-size=640,360")
        .arg(profile_option)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(file)
        .spawn()
        .map_err(|error| format!("{} cannot be run: {error}", browser.display()))
}

/// What the page has told of itself, in one browser after another.
#[derive(Debug, Default)]
struct Told {
    adapter: String,
    /// The mask that it began last.
    begun: Option<usize>,
}

/// Writes the masks that come, and tells of steps, until the page is done.
fn follow(posts: &Receiver<(String, Vec<u8>)>, folder: &Path, told: &mut Told) -> Result<(), String> {
    let began = Instant::now();
    let mut last = "nothing yet".to_owned();
    while began.elapsed() < LONGEST {
        let (path, body) = match posts.recv_timeout(SILENCE) {
            Ok(post) => post,
            Err(RecvTimeoutError::Timeout) => {
                return Err(format!("the page says nothing for {} s; last: {last}", SILENCE.as_secs()));
            }
            Err(RecvTimeoutError::Disconnected) => return Err("the server has ended".into()),
        };
        let text = || String::from_utf8_lossy(&body).into_owned();
        match path.as_str() {
            "/done" if body.is_empty() => return Ok(()),
            "/done" => return Err(format!("the page: {}", text())),
            "/step" => {
                last = text();
                eprintln!("xtask: {last}");
            }
            "/adapter" => told.adapter = text(),
            "/begun" => told.begun = text().parse().ok(),
            _ => {
                let index = path.strip_prefix("/mask/").and_then(|index| index.parse::<usize>().ok());
                let index = index.ok_or_else(|| format!("the page posts to {path}"))?;
                let file = folder.join(format!("{index}.f32"));
                std::fs::write(&file, &body).map_err(|error| format!("{}: {error}", file.display()))?;
            }
        }
    }
    Err(format!("the page is not done after {} s; last: {last}", LONGEST.as_secs()))
}

/// Nothing may stand on the page's console.
fn clean_console(log: &Path) -> Result<(), String> {
    let bytes = std::fs::read(log).map_err(|error| format!("{}: {error}", log.display()))?;
    let text = String::from_utf8_lossy(&bytes);
    let words: Vec<&str> = text.lines().filter(|line| line.contains("CONSOLE")).collect();
    match words.first() {
        Some(first) => Err(format!("{} words on the page's console, the first: {first}", words.len())),
        None => Ok(()),
    }
}
