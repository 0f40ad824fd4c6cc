//! `cargo xtask portability`: checks the programs of every pipeline with the compilers of Direct3D 12, Metal and Vulkan.
//!
//! `xtask/programs` translates and validates. This module installs the compilers: spirv-val from Debian's spirv-tools, and DXC's library
//! from a Python package, because Debian has none.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::machine::{self, Need};
use crate::shell::{self, find};

const VALIDATOR: [Need; 1] = [Need {
    why: "spirv-val, which validates SPIR-V",
    met: || find("spirv-val").is_some(),
    packages: &["spirv-tools"],
    otherwise: "install SPIRV-Tools",
}];

const PIP: [Need; 1] = [Need {
    why: "pip, which downloads DXC",
    met: || pip().is_some(),
    packages: &["python3-pip"],
    otherwise: "install pip for Python 3",
}];

/// Environment variable with the path of a DXC library to use.
const VARIABLE: &str = "ANTUMBRA_DXC";

/// DXC's library, and the Python package that contains it: a binding of DXC for Linux on x86-64.
const LIBRARY: &str = "libdxcompiler.so";
const PACKAGE: &str = "coalpy==0.55";

/// Checks every program; with `--only TEXT`, those whose label, module or entry point contains it.
///
/// # Errors
/// The number of programs that fail, or an unknown argument.
pub fn run(arguments: &[String]) -> Result<(), String> {
    match arguments {
        [] => {}
        [option, _] if option == "--only" => {}
        _ => return Err("`cargo xtask portability` takes only `--only TEXT`".into()),
    }
    let began = Instant::now();
    let mut command = Command::new(shell::built_of_workspace("antumbra-programs")?);
    command.arg("portability").arg(crate::root().join("target/portability")).args(arguments);
    match dxc() {
        Ok(library) => drop(command.arg("--dxc").arg(library)),
        Err(lack) => eprintln!("xtask: SKIPPED DXC: {lack}"),
    }
    match machine::install(&VALIDATOR).map(|()| find("spirv-val")) {
        Ok(Some(validator)) => drop(command.arg("--spirv-val").arg(validator)),
        Ok(None) => eprintln!("xtask: SKIPPED spirv-val: it is not in PATH"),
        Err(lack) => eprintln!("xtask: SKIPPED spirv-val: {lack}"),
    }
    shell::run(&mut command)?;
    eprintln!("xtask: checked programs for other systems in {} s", began.elapsed().as_secs());
    Ok(())
}

/// Returns DXC's library: the one named by the variable, else a copy in `target/tools`, downloaded if necessary.
fn dxc() -> Result<PathBuf, String> {
    if let Some(named) = std::env::var_os(VARIABLE).map(PathBuf::from) {
        return if named.is_file() {
            Ok(named)
        } else {
            Err(format!("{VARIABLE} does not name a file: {}", named.display()))
        };
    }
    let folder = crate::root().join("target/tools/dxc");
    let library = folder.join(LIBRARY);
    if library.is_file() {
        return Ok(library);
    }
    let by_hand = format!("set {VARIABLE} to the path of a {LIBRARY} from a release of DirectXShaderCompiler");
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return Err(format!("there is no package of DXC for this system: {by_hand}"));
    }
    let unfinished = folder.join(format!("unfinished-{}", std::process::id()));
    let outcome = bring(&unfinished, &library);
    // Removes the files of a failed attempt, too.
    let _ = std::fs::remove_dir_all(&unfinished);
    outcome.map(|()| library).map_err(|problem| format!("{problem}; {by_hand}"))
}

/// Downloads the package and extracts the library.
fn bring(unfinished: &Path, library: &Path) -> Result<(), String> {
    machine::install(&PIP)?;
    let mut pip = pip().ok_or("pip is missing")?;
    eprintln!("xtask: downloading DXC (30 MB) to {}", library.display());
    let unpacked = unfinished.join("unpacked");
    std::fs::create_dir_all(&unpacked).map_err(|error| format!("{}: {error}", unpacked.display()))?;
    shell::run(
        pip.args(["download", "--quiet", "--no-deps", "--only-binary=:all:", PACKAGE, "--dest"]).arg(unfinished),
    )?;
    let package = file_in(unfinished, |name| name.ends_with(".whl")).ok_or("pip downloaded no wheel")?;
    // A wheel is a zip archive, which Python can extract.
    shell::run(python().args(["-m", "zipfile", "-e"]).args([&package, &unpacked]))?;
    let found = file_in(&unpacked, |name| name == LIBRARY).ok_or_else(|| format!("{PACKAGE} has no {LIBRARY}"))?;
    // The rename is atomic. If another process was faster, its result is equivalent.
    std::fs::rename(found, library).map_err(|error| format!("cannot create {}: {error}", library.display()))
}

fn python() -> Command {
    Command::new("python3")
}

/// Returns the command pip, if Python has it.
fn pip() -> Option<Command> {
    let pip = || {
        let mut command = python();
        command.args(["-m", "pip"]);
        command
    };
    shell::succeeds(pip().arg("--version")).then(pip)
}

/// Returns the first file in a folder or below it whose name is wanted.
fn file_in(folder: &Path, is_wanted: impl Fn(&str) -> bool + Copy) -> Option<PathBuf> {
    let mut inside: Vec<PathBuf> = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
    inside.sort();
    let is_it =
        |path: &&PathBuf| path.is_file() && path.file_name().and_then(|name| name.to_str()).is_some_and(is_wanted);
    let found = inside.iter().find(is_it).cloned();
    found.or_else(|| inside.iter().filter(|path| path.is_dir()).find_map(|folder| file_in(folder, is_wanted)))
}
