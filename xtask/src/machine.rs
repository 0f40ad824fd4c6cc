//! Requirements of the machine before anything is built: a C++ compiler and a Vulkan driver.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{find, run, succeeds};

/// Action if a check's requirement is not installed and cannot be.
#[derive(Clone, Copy, PartialEq)]
pub enum Missing {
    /// Reports that the check was skipped.
    Skip,
    /// Fails.
    Fail,
}

/// Requirement that a machine may lack.
pub struct Need {
    /// Name of the requirement, and what needs it.
    pub why: &'static str,
    /// Whether it is met.
    pub met: fn() -> bool,
    /// Debian packages that meet it.
    pub packages: &'static [&'static str],
    /// Instructions if those packages cannot be installed.
    pub otherwise: &'static str,
}

const NEEDS: [Need; 2] = [
    Need {
        why: "a C++ compiler, for the FLIP metric and the meshopt decoder",
        met: || ["c++", "g++", "clang++"].iter().any(|name| find(name).is_some()) || std::env::var_os("CXX").is_some(),
        packages: &["g++"],
        otherwise: "install a C++ compiler (gcc or clang) that is available as `c++`, or set CXX",
    },
    Need {
        why: "a Vulkan driver (Mesa's lavapipe runs on any CPU)",
        met: has_graphics,
        packages: &["mesa-vulkan-drivers", "libvulkan1"],
        otherwise: "install the Vulkan driver of your graphics card, or Mesa's software driver \
                    (Fedora: mesa-vulkan-drivers vulkan-loader; Arch: vulkan-swrast vulkan-icd-loader)",
    },
];

/// Installs what building and testing need, and reports it.
///
/// # Errors
/// Says what is missing and how to get it, if it cannot be installed from here.
pub fn set_up() -> Result<(), String> {
    install(&NEEDS)
}

/// Installs missing requirements, and reports them.
///
/// # Errors
/// Says what is missing and how to get it, if it cannot be installed from here.
pub fn install(needs: &[Need]) -> Result<(), String> {
    let missing: Vec<&Need> = needs.iter().filter(|need| !(need.met)()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    for need in &missing {
        eprintln!("xtask: this machine lacks {}", need.why);
    }
    if let Some(name) = DRIVER_VARIABLES.iter().find(|name| std::env::var_os(name).is_some())
        && !has_graphics()
        && driver_manifests().is_empty()
    {
        // With this variable the Vulkan loader looks nowhere else, whatever is installed.
        return Err(format!(
            "{name} hides every Vulkan driver, because it names no existing file; unset or correct it"
        ));
    }
    let packages: Vec<&str> = missing.iter().flat_map(|need| need.packages).copied().collect();
    let list = packages.join(" ");
    let by_hand = || {
        let remedies: Vec<&str> = missing.iter().map(|need| need.otherwise).collect();
        format!("it cannot be installed automatically: {}", remedies.join("; and "))
    };
    if find("apt-get").is_none() {
        return Err(by_hand());
    }
    let is_root = std::fs::metadata("/proc/self").is_ok_and(|own| owner(&own) == 0);
    // Only without a password, because a demo that asks for one would appear to hang in a script.
    let sudo = !is_root;
    if sudo && !succeeds(Command::new("sudo").args(["-n", "true"])) {
        return Err(format!(
            "installation needs root, and sudo asks for a password: run `sudo apt-get install {list}`, then repeat this command"
        ));
    }
    eprintln!("xtask: installing with apt-get: {list}");
    let apt_get = || {
        let mut command = Command::new(if sudo { "sudo" } else { "apt-get" });
        if sudo {
            command.args(["-n", "env", "DEBIAN_FRONTEND=noninteractive", "apt-get"]);
        } else {
            command.env("DEBIAN_FRONTEND", "noninteractive");
        }
        command.args(["-q", "-y"]);
        command
    };
    // Containers come without package lists. Outdated lists may still suffice.
    if let Err(problem) = run(apt_get().arg("update")) {
        eprintln!("xtask: {problem}; trying with the existing package lists");
    }
    run(apt_get().args(["install", "--no-install-recommends"]).args(&packages))?;
    match needs.iter().find(|need| !(need.met)()) {
        None => Ok(()),
        Some(need) => Err(format!("installed {list}, but still found no {}: {}", need.why, need.otherwise)),
    }
}

#[cfg(unix)]
fn owner(file: &std::fs::Metadata) -> u32 {
    std::os::unix::fs::MetadataExt::uid(file)
}

#[cfg(not(unix))]
fn owner(_: &std::fs::Metadata) -> u32 {
    u32::MAX
}

/// Whether wgpu has a driver. Metal and Direct3D are part of their systems. Linux needs the Vulkan loader and either a software driver,
/// or a card's driver together with a card: manifests alone prove nothing, because Mesa's package contains those of every vendor.
fn has_graphics() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let drivers = driver_manifests();
    let is_chosen = DRIVER_VARIABLES.iter().any(|name| std::env::var_os(name).is_some());
    let software = drivers.iter().any(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // A user who names a file is assumed to know it.
        is_chosen || name.starts_with("lvp_") || name.contains("swiftshader")
    });
    has_vulkan_loader() && (software || (has_card() && !drivers.is_empty()))
}

/// Whether there is a graphics card on Linux.
pub fn has_card() -> bool {
    Path::new("/dev/nvidia0").exists() || Path::new("/dev/dri/renderD128").exists()
}

/// Environment variables that replace the Vulkan loader's search for drivers by a list of files.
pub const DRIVER_VARIABLES: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

/// Returns the manifests of Vulkan drivers, from the folders in the loader's documentation.
fn driver_manifests() -> Vec<PathBuf> {
    for name in DRIVER_VARIABLES {
        if let Some(files) = std::env::var_os(name) {
            return std::env::split_paths(&files).filter(|file| file.is_file()).collect();
        }
    }
    let home = std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share/vulkan/icd.d"));
    ["/etc/vulkan/icd.d", "/usr/local/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/usr/share/vulkan/icd.d"]
        .map(PathBuf::from)
        .into_iter()
        .chain(home)
        .filter_map(|dir| std::fs::read_dir(dir).ok())
        .flat_map(|entries| entries.flatten())
        .map(|entry| entry.path())
        .filter(|file| file.extension().is_some_and(|ending| ending == "json"))
        .collect()
}

fn has_vulkan_loader() -> bool {
    const NAME: &str = "libvulkan.so.1";
    let usual = [
        "/usr/lib".into(),
        "/usr/lib64".into(),
        "/usr/local/lib".into(),
        format!("/usr/lib/{}-linux-gnu", std::env::consts::ARCH),
    ];
    let own = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    usual.iter().map(PathBuf::from).chain(std::env::split_paths(&own)).any(|dir| dir.join(NAME).exists())
        || Command::new("ldconfig")
            .arg("-p")
            .output()
            .is_ok_and(|known| String::from_utf8_lossy(&known.stdout).contains(NAME))
}
