//! What others get: the packages that would be published, and a program of theirs.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::shell::{self, cargo, find, succeeds};

/// The published crates, each after those that it depends on.
const PUBLISHED: [&str; 8] = [
    "antumbra-light",
    "antumbra-scene",
    "antumbra-reference",
    "antumbra",
    "antumbra-render",
    "antumbra-lab",
    "antumbra-viewer",
    "antumbra-cli",
];

/// What each package has to hold beside its code.
const IN_EACH: [&str; 3] = ["README.md", "LICENSE-MIT", "LICENSE-APACHE"];

/// The program of someone who uses the library. It runs on machines without graphics, and so makes no device; what makes
/// a technique is linked all the same.
const PROGRAM: &str = r#"
use antumbra::{AnyShadow, Error, Gpu, TechniqueKind};

fn create(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<AnyShadow, Error> {
    TechniqueKind::Pcss.create(&Gpu::new(device, queue))
}

fn main() {
    std::hint::black_box(create as fn(&wgpu::Device, &wgpu::Queue) -> _);
    for kind in TechniqueKind::ALL {
        println!("{}", kind.name());
    }
}
"#;

/// Its manifest. The patch stands for the registry that would have the light; nothing is optimised, since it hardly runs.
const MANIFEST: &str = r#"[package]
name = "outside"
version = "0.0.0"
edition = "2024"

[dependencies]
antumbra = { path = "antumbra" }
wgpu = { version = "30", default-features = false, features = ["std", "wgsl"] }

[patch.crates-io]
antumbra-light = { path = "antumbra-light" }

[profile.dev]
debug = false
"#;

/// Packages every published crate, then checks that a program outside the repository compiles with the packaged library: with the newest
/// versions that this toolchain can take of everything that the library depends on, since a user has no lock file of ours.
///
/// # Errors
/// Says which package lacks what, or what of the program does not compile.
pub fn check() -> Result<(), String> {
    check_program(cargo(), "ours", &unpacked_program()?.0)
}

/// Builds and runs the same program, then checks that it compiles with nightly, where that is installed: with versions that need a newer
/// compiler than ours.
///
/// # Errors
/// As [`check`], or what of the program fails when it runs.
pub fn run() -> Result<(), String> {
    let folder = unpacked_program()?;
    run_program(&folder.0)?;
    let nightly = || {
        let mut command = Command::new("rustup");
        command.args(["run", "nightly", "cargo"]);
        command
    };
    if find("rustup").is_some() && succeeds(nightly().arg("--version")) {
        check_program(nightly(), "nightly", &folder.0)
    } else {
        eprintln!(
            "xtask: SKIPPED a program outside with nightly: it is not installed (`rustup toolchain add nightly`)"
        );
        Ok(())
    }
}

/// The program beside the packages of every published crate, unpacked.
fn unpacked_program() -> Result<Folder, String> {
    let began = Instant::now();
    let mut package = cargo();
    // Building each as packaged would build everything again; what packaging can break for the library, the program
    // finds. What is checked is the tree as it is, committed or not.
    package.args(["package", "--quiet", "--locked", "--no-verify", "--allow-dirty"]);
    for name in PUBLISHED {
        package.args(["--package", name]);
    }
    shell::run(&mut package)?;

    // Outside, or cargo would find our workspace and our settings in the folders above.
    let folder = Folder::new()?;
    for name in PUBLISHED {
        let unpacked = unpack(name, &folder.0)?;
        if let Some(file) = IN_EACH.iter().find(|file| !unpacked.join(file).is_file()) {
            return Err(format!("the package {name} lacks {file}: give crates/{name} one"));
        }
    }
    if folder.0.join("antumbra/linked/test").exists() {
        return Err("the package antumbra holds linked/test: its Cargo.toml has to exclude it".to_owned());
    }
    write(&folder.0.join("Cargo.toml"), MANIFEST)?;
    write(&folder.0.join("src/main.rs"), PROGRAM)?;
    eprintln!("xtask: {} crates packaged after {} s", PUBLISHED.len(), began.elapsed().as_secs());
    Ok(folder)
}

/// The command of cargo for the program, with one toolchain, which keeps what it builds from run to run.
fn of_program(mut cargo: Command, toolchain: &str, folder: &Path) -> Command {
    // A toolchain chooses its own versions.
    let _ = std::fs::remove_file(folder.join("Cargo.lock"));
    cargo.current_dir(folder).env("CARGO_TARGET_DIR", crate::root().join("target/outside").join(toolchain));
    cargo
}

/// Whether the program compiles with a toolchain; links and runs nothing.
fn check_program(cargo: Command, toolchain: &str, folder: &Path) -> Result<(), String> {
    let began = Instant::now();
    shell::run(of_program(cargo, toolchain, folder).args(["check", "--quiet"]))?;
    eprintln!("xtask: a program outside compiles with {toolchain}; {} s", began.elapsed().as_secs());
    Ok(())
}

/// Builds and runs the program with the toolchain that runs us.
fn run_program(folder: &Path) -> Result<(), String> {
    let began = Instant::now();
    let mut cargo = of_program(cargo(), "ours", folder);
    cargo.args(["run", "--quiet"]);
    let techniques = shell::output(&mut cargo)?;
    if !techniques.lines().any(|name| name == "pcss") {
        return Err(format!("a program outside should print the techniques' names, and printed `{techniques}`"));
    }
    let count = techniques.lines().count();
    let seconds = began.elapsed().as_secs();
    eprintln!("xtask: a program outside built and ran in {seconds} s and knows {count} techniques");
    Ok(())
}

/// Unpacks a packaged crate to a folder of its name.
fn unpack(name: &str, to: &Path) -> Result<PathBuf, String> {
    let versioned = format!("{name}-{}", env!("CARGO_PKG_VERSION"));
    let archive = crate::root().join("target/package").join(format!("{versioned}.crate"));
    shell::run(Command::new("tar").arg("-xzf").arg(archive).arg("-C").arg(to))?;
    let unpacked = to.join(name);
    std::fs::rename(to.join(versioned), &unpacked)
        .map_err(|error| format!("{}: cannot be made: {error}", unpacked.display()))?;
    Ok(unpacked)
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    file.parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(file, text))
        .map_err(|error| format!("{}: cannot write it: {error}", file.display()))
}

/// A new folder, gone when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("antumbra-outside-{}", std::process::id()));
        std::fs::create_dir(&path).map_err(|error| format!("{}: cannot make it: {error}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Left in the system's folder for such things, it harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
