//! Check of the packages for publication, with a program that uses them.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::shell::{self, cargo, find, succeeds};

/// Published crates, in order of dependency.
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

/// Files that each package must contain beside its code.
const IN_EACH: [&str; 3] = ["README.md", "LICENSE-MIT", "LICENSE-APACHE"];

/// Program of a library user. It runs on machines without graphics and therefore creates no device, but links technique creation.
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

/// Manifest of the program. The patch replaces the registry's `antumbra-light`; nothing is optimised, because it hardly runs.
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

/// Packages every published crate, then checks that a program outside the repository compiles with the packaged library. It uses the
/// newest versions of all dependencies that this toolchain supports, because users do not have this repository's lock file.
///
/// # Errors
/// The package that lacks something, or the program's compile error.
pub fn check() -> Result<(), String> {
    check_program(cargo(), "ours", &unpacked_program()?.0)
}

/// Builds and runs the same program. If nightly is installed, also checks that the program compiles with it, and so with dependency
/// versions that need a newer compiler.
///
/// # Errors
/// As [`check`], or the program's failure at run time.
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
            "xtask: SKIPPED the program outside the repository with nightly, which is not installed (`rustup toolchain add nightly`)"
        );
        Ok(())
    }
}

/// Returns the folder of the program with the unpacked packages of every published crate.
fn unpacked_program() -> Result<Folder, String> {
    let began = Instant::now();
    let mut package = cargo();
    // Verifying each package would build everything again; the program detects what packaging can break for the library. The
    // working tree is packaged as it is, committed or not.
    package.args(["package", "--quiet", "--locked", "--no-verify", "--allow-dirty"]);
    for name in PUBLISHED {
        package.args(["--package", name]);
    }
    shell::run(&mut package)?;

    // Outside the repository, because cargo would find its workspace and settings in parent folders.
    let folder = Folder::new()?;
    for name in PUBLISHED {
        let unpacked = unpack(name, &folder.0)?;
        if let Some(file) = IN_EACH.iter().find(|file| !unpacked.join(file).is_file()) {
            return Err(format!("the package {name} lacks {file}: add it to crates/{name}"));
        }
    }
    if folder.0.join("antumbra/linked/test").exists() {
        return Err("the package antumbra contains linked/test: exclude it in Cargo.toml".to_owned());
    }
    write(&folder.0.join("Cargo.toml"), MANIFEST)?;
    write(&folder.0.join("src/main.rs"), PROGRAM)?;
    eprintln!("xtask: packaged {} crates after {} s", PUBLISHED.len(), began.elapsed().as_secs());
    Ok(folder)
}

/// Returns the cargo command for the program with one toolchain. Builds are reused between runs.
fn of_program(mut cargo: Command, toolchain: &str, folder: &Path) -> Command {
    // Each toolchain resolves its own versions.
    let _ = std::fs::remove_file(folder.join("Cargo.lock"));
    cargo.current_dir(folder).env("CARGO_TARGET_DIR", crate::root().join("target/outside").join(toolchain));
    cargo
}

/// Checks that the program compiles with a toolchain; links and runs nothing.
fn check_program(cargo: Command, toolchain: &str, folder: &Path) -> Result<(), String> {
    let began = Instant::now();
    shell::run(of_program(cargo, toolchain, folder).args(["check", "--quiet"]))?;
    eprintln!("xtask: the program outside the repository compiles with {toolchain}; {} s", began.elapsed().as_secs());
    Ok(())
}

/// Builds and runs the program with the toolchain that runs xtask.
fn run_program(folder: &Path) -> Result<(), String> {
    let began = Instant::now();
    let mut cargo = of_program(cargo(), "ours", folder);
    cargo.args(["run", "--quiet"]);
    let techniques = shell::output(&mut cargo)?;
    if !techniques.lines().any(|name| name == "pcss") {
        return Err(format!(
            "the program outside the repository should print the techniques' names, but printed `{techniques}`"
        ));
    }
    let count = techniques.lines().count();
    let seconds = began.elapsed().as_secs();
    eprintln!("xtask: the program outside the repository was built and run in {seconds} s, and has {count} techniques");
    Ok(())
}

/// Unpacks a packaged crate into a folder of its name.
fn unpack(name: &str, to: &Path) -> Result<PathBuf, String> {
    let versioned = format!("{name}-{}", env!("CARGO_PKG_VERSION"));
    let archive = crate::root().join("target/package").join(format!("{versioned}.crate"));
    shell::run(Command::new("tar").arg("-xzf").arg(archive).arg("-C").arg(to))?;
    let unpacked = to.join(name);
    std::fs::rename(to.join(versioned), &unpacked)
        .map_err(|error| format!("cannot create {}: {error}", unpacked.display()))?;
    Ok(unpacked)
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    file.parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(file, text))
        .map_err(|error| format!("cannot write {}: {error}", file.display()))
}

/// New folder, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("antumbra-outside-{}", std::process::id()));
        std::fs::create_dir(&path).map_err(|error| format!("cannot create {}: {error}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A remaining folder is harmless: it is in the system's temporary folder.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
