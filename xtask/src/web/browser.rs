//! Browser with WebGPU on a software adapter: finding and launching it, and receiving what its pages post.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::server::Server;
use crate::machine::{self, Need};
use crate::shell::find;

/// Program names of browsers with WebGPU's software adapter.
const BROWSERS: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge"];

/// Folders of their files, if the program on the path is a script.
const BROWSER_FOLDERS: [&str; 4] =
    ["/usr/lib/chromium", "/usr/lib/chromium-browser", "/opt/google/chrome", "/opt/microsoft/msedge"];

const BROWSER: [Need; 1] = [Need {
    why: "a browser with WebGPU, in which the page is tested",
    met: || browser().is_some(),
    packages: &["chromium"],
    otherwise: "install Chromium or Chrome",
}];

/// Returns the browser, installed if possible.
///
/// # Errors
/// What is missing and how to get it.
pub fn get() -> Result<PathBuf, String> {
    machine::install(&BROWSER)?;
    browser().ok_or_else(|| "no browser".into())
}

fn browser() -> Option<PathBuf> {
    BROWSERS.iter().find_map(|name| find(name))
}

/// Returns the software Vulkan driver that comes with a browser.
pub fn software_driver(browser: &Path) -> Option<PathBuf> {
    let own = browser.canonicalize().ok().and_then(|browser| browser.parent().map(Path::to_path_buf));
    let folders = own.into_iter().chain(BROWSER_FOLDERS.map(PathBuf::from));
    folders.map(|folder| folder.join("vk_swiftshader_icd.json")).find(|driver| driver.is_file())
}

/// Browser process, killed when dropped.
pub struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // The process may already have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Opens an address in a separate browser, whose console goes to `log`.
///
/// # Errors
/// If it cannot be run.
pub fn launch(browser: &Path, profile: &Path, log: &Path, address: &str) -> Result<Running, String> {
    let file = std::fs::File::create(log).map_err(|error| format!("{}: {error}", log.display()))?;
    // Chromium requires option and value in one word.
    let mut profile_option = OsString::from("--user-data-dir=");
    profile_option.push(profile);
    Command::new(browser)
        // Containers have no sandbox, and the page is trusted.
        .args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run"])
        .args(["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-logging=stderr"])
        // Without these, the software adapter draws no WebGPU canvas, and long passes count as a hang.
        .args(["--use-gl=angle", "--use-angle=swiftshader", "--use-vulkan=swiftshader", "--enable-features=Vulkan"])
        .args(["--ignore-gpu-blocklist", "--disable-gpu-watchdog"])
        // The image beside the panel is small, because it is rendered in software.
        .arg("--window-size=640,360")
        .arg(profile_option)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(file)
        .spawn()
        .map(Running)
        .map_err(|error| format!("cannot run {}: {error}", browser.display()))
}

/// Posts of pages: path and body.
pub type Posts = Receiver<(String, Vec<u8>)>;

/// Serves a folder until this program ends. Returns its address, and the posts of its pages.
///
/// # Errors
/// If no port is available.
pub fn serve_aside(folder: &Path) -> Result<(String, Posts), String> {
    run_aside(Server::new(folder, 0)?)
}

/// Like [`serve_aside`], with another folder below a path such as `a/b/`.
///
/// # Errors
/// If no port is available.
pub fn serve_both_aside(folder: &Path, path: &str, below: &Path) -> Result<(String, Posts), String> {
    let mut server = Server::new(folder, 0)?;
    server.mount(path, below);
    run_aside(server)
}

fn run_aside(server: Server) -> Result<(String, Posts), String> {
    let address = server.address()?;
    let (sender, posts) = channel();
    thread::spawn(move || {
        // After the last step there is no receiver.
        server.run(Arc::new(move |path, body| drop(sender.send((path.to_owned(), body)))));
    });
    Ok((address, posts))
}

/// Creates an empty folder, replacing an older one.
///
/// # Errors
/// If it cannot be created.
pub fn make_anew(folder: &Path) -> Result<(), String> {
    let outcome = if folder.exists() { std::fs::remove_dir_all(folder) } else { Ok(()) }
        .and_then(|()| std::fs::create_dir_all(folder));
    outcome.map_err(|error| format!("{}: {error}", folder.display()))
}

/// Time limits of a page.
pub struct PageTimeouts {
    /// Maximum time between two posts of the page.
    pub silence: Duration,
    /// Maximum total time.
    pub all: Duration,
}

/// Prints a page's steps until it is done; `take` receives its other posts.
///
/// # Errors
/// The failure that the page reports, or a time limit.
pub fn follow(
    posts: &Posts,
    timeouts: &PageTimeouts,
    mut take: impl FnMut(&str, &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    let began = Instant::now();
    let mut last = "nothing yet".to_owned();
    while began.elapsed() < timeouts.all {
        let (path, body) = match posts.recv_timeout(timeouts.silence) {
            Ok(post) => post,
            Err(RecvTimeoutError::Timeout) => {
                return Err(format!(
                    "the page reported nothing for {} s; last report: {last}",
                    timeouts.silence.as_secs()
                ));
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
            _ => take(&path, &body)?,
        }
    }
    Err(format!("the page is not finished after {} s; last report: {last}", timeouts.all.as_secs()))
}

/// Checks that the page's console is empty.
///
/// # Errors
/// The first line on the console.
pub fn clean_console(log: &Path) -> Result<(), String> {
    let bytes = std::fs::read(log).map_err(|error| format!("{}: {error}", log.display()))?;
    let text = String::from_utf8_lossy(&bytes);
    let words: Vec<&str> = text.lines().filter(|line| line.contains("CONSOLE")).collect();
    match words.first() {
        Some(first) => Err(format!("{} messages on the page's console; the first is: {first}", words.len())),
        None => Ok(()),
    }
}
