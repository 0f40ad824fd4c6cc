//! Choice of the Vulkan driver: the installed one; or, on Debian 12 without a graphics card, a newer software driver that is
//! installed in `target/` and leaves the system unchanged.
//!
//! Debian 12 installs Mesa 22.3. The library has special shaders for its software driver (`gpu/uniforms.rs`), which compiles again in
//! every process. Debian's backports have Mesa 25, which uses the same shaders as graphics cards.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::machine::{self, DRIVER_VARIABLES};
use crate::shell::{self, find};

/// Command-line option and environment variable of the choice.
const OPTION: &str = "--driver";
const VARIABLE: &str = "ANTUMBRA_DRIVER";

/// Packages to unpack, and the one of them with the driver.
const PACKAGES: [&str; 3] = [DRIVER_PACKAGE, "libdrm2", "libdrm-amdgpu1"];
const DRIVER_PACKAGE: &str = "mesa-vulkan-drivers";

/// Release of Debian with the old driver, and its suite with the newer one.
const RELEASE: &str = "bookworm";
const BACKPORTS: &str = "bookworm-backports";

/// Requested driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriverChoice {
    /// The driver of a graphics card, or one chosen by the loader's own variables; else the newer one if available; else the installed
    /// one.
    Default,
    /// The installed driver, or the one chosen by the loader's own variables.
    Installed,
    /// The newer driver, or an error.
    Newer,
}

/// Removes the option from a command's arguments; without it, the variable decides.
///
/// # Errors
/// If there is no such driver.
pub fn option(args: &[String]) -> Result<(DriverChoice, Vec<String>), String> {
    let (mut value, mut rest) = (std::env::var(VARIABLE).ok().filter(|value| !value.is_empty()), Vec::new());
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        match arg.strip_prefix(OPTION) {
            Some("") => value = Some(args.next().cloned().unwrap_or_default()),
            Some(after) if after.starts_with('=') => value = Some(after[1..].to_owned()),
            _ => rest.push(arg.clone()),
        }
    }
    let wanted = match value.as_deref() {
        None | Some("default") => DriverChoice::Default,
        Some("installed") => DriverChoice::Installed,
        Some("newer") => DriverChoice::Newer,
        Some(other) => {
            return Err(format!("there is no driver `{other}`; {OPTION} must be default, installed or newer"));
        }
    };
    Ok((wanted, rest))
}

/// Driver, as environment variables of the programs that use it.
pub struct Driver {
    variables: Vec<(&'static str, OsString)>,
}

impl Driver {
    /// Chooses a driver, installs it if necessary, and reports it.
    ///
    /// # Errors
    /// If the newer driver is requested and unavailable, with the reason.
    pub fn choose(wanted: DriverChoice) -> Result<Self, String> {
        let chosen = DRIVER_VARIABLES.iter().find(|name| std::env::var_os(name).is_some());
        let why = match (wanted, chosen) {
            (DriverChoice::Newer, _) => return Self::newer(),
            (_, Some(name)) => format!("chosen by {name}"),
            (DriverChoice::Installed, None) => "as requested".to_owned(),
            (DriverChoice::Default, None) if !cfg!(target_os = "linux") => "the system's driver".to_owned(),
            (DriverChoice::Default, None) if machine::has_card() => "for a graphics card".to_owned(),
            (DriverChoice::Default, None) => match Self::newer() {
                Ok(newer) => return Ok(newer),
                Err(reason) => format!("because {reason}"),
            },
        };
        eprintln!("xtask: using the installed driver, {why}");
        Ok(Self { variables: Vec::new() })
    }

    /// Returns the newer driver, installed first if necessary.
    fn newer() -> Result<Self, String> {
        let folder = newer_folder();
        let Library { file: library, searched } = newer_library("libvulkan_lvp")?;
        let manifest = the_file(&folder.join("unpacked/usr/share/vulkan/icd.d"), "lvp_icd", ".json")
            .and_then(|manifest| with_library(&std::fs::read_to_string(manifest).ok()?, &library))
            .ok_or_else(|| lacking("its manifest"))?;
        // Written every time, because it contains the absolute path, and folders move.
        let file = folder.join("lvp_icd.json");
        std::fs::write(&file, manifest).map_err(|error| format!("{}: {error}", file.display()))?;
        let version = version_in(&folder).unwrap_or_else(|| "of unknown version".to_owned());
        eprintln!("xtask: using the newer software driver, Mesa {version}, in {}", folder.display());
        Ok(Self { variables: vec![("VK_DRIVER_FILES", file.into()), ("LD_LIBRARY_PATH", searched)] })
    }

    /// Returns the environment variables.
    pub fn variables(&self) -> impl Iterator<Item = (&str, &OsString)> {
        self.variables.iter().map(|(name, value)| (*name, value))
    }
}

/// Library of a driver.
pub struct Library {
    /// Path of the library.
    pub file: PathBuf,
    /// Value of `LD_LIBRARY_PATH` with which its dependencies are found.
    pub searched: OsString,
}

/// Returns Mesa's AMD driver: the newer one if available, else the installed one.
///
/// # Errors
/// If there is neither.
pub fn for_amd() -> Result<Library, String> {
    const NAME: &str = "libvulkan_radeon";
    let problem = match newer_library(NAME) {
        Ok(library) => return Ok(library),
        Err(problem) => problem,
    };
    let folders = [format!("/usr/lib/{}-linux-gnu", std::env::consts::ARCH), "/usr/lib64".into(), "/usr/lib".into()];
    let installed = folders.map(|folder| Path::new(&folder).join(NAME).with_extension("so"));
    let file = installed
        .into_iter()
        .find(|file| file.is_file())
        .ok_or_else(|| format!("Mesa's driver for AMD is not installed (Debian: {DRIVER_PACKAGE}): {problem}"))?;
    eprintln!("xtask: using the installed {NAME}, because {problem}");
    Ok(Library { file, searched: std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default() })
}

fn newer_folder() -> PathBuf {
    crate::root().join("target/newer-mesa")
}

fn lacking(what: &str) -> String {
    format!("{} lacks {what}; delete it, and it will be installed again", newer_folder().display())
}

/// Returns a library of the newer Mesa, installed first if necessary.
fn newer_library(name: &str) -> Result<Library, String> {
    let folder = newer_folder();
    let unpacked = folder.join("unpacked");
    if !unpacked.exists() {
        bring(&folder).map_err(|problem| format!("the newer Mesa cannot be installed: {problem}"))?;
    }
    let file = the_file(&unpacked.join("usr/lib"), name, ".so").ok_or_else(|| lacking("the driver"))?;
    let libraries = file.parent().map(Path::to_owned).unwrap_or_default();
    let path = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let searched = std::iter::once(libraries).chain(std::env::split_paths(&path));
    let searched = std::env::join_paths(searched).map_err(|error| error.to_string())?;
    match missing_libraries(&file, &searched) {
        Some(missing) => Err(format!("the newer Mesa cannot be loaded on this system: {missing}")),
        None => Ok(Library { file, searched }),
    }
}

/// Downloads and unpacks the packages with an apt that only knows Debian's backports and has its own lists.
fn bring(folder: &Path) -> Result<(), String> {
    let system = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    if !is_the_release(&system) {
        return Err(format!("it is a backport for Debian's {RELEASE}, which this system is not"));
    }
    if let Some(program) = ["apt-get", "dpkg"].into_iter().find(|name| find(name).is_none()) {
        return Err(format!("there is no {program}"));
    }
    let targets = ["indextargets", "--no-release-info", "--format", "$(RELEASE) $(COMPONENT) $(REPO_URI)"];
    let targets = shell::output(Command::new("apt-get").args(targets))?;
    let mirrors = mirrors(&targets);
    if mirrors.is_empty() {
        return Err(format!("apt has no mirror for {RELEASE}"));
    }
    eprintln!("xtask: downloading a newer software driver from Debian's backports to {}", folder.display());
    let mut problem = String::new();
    let unfinished = folder.join(format!("unfinished-{}", std::process::id()));
    for mirror in mirrors {
        let outcome = bring_from(mirror, folder, &unfinished);
        // Left over from a failed attempt, or from one that another process overtook.
        let _ = std::fs::remove_dir_all(&unfinished);
        match outcome {
            Ok(()) => return Ok(()),
            Err(error) => problem = error,
        }
    }
    Err(problem)
}

fn bring_from(mirror: &str, folder: &Path, unfinished: &Path) -> Result<(), String> {
    let apt = folder.join("apt");
    for new in [&apt.join("lists/partial"), &apt.join("cache/archives/partial"), unfinished] {
        std::fs::create_dir_all(new).map_err(|error| format!("cannot create {}: {error}", new.display()))?;
    }
    let write = |name: &str, text: String| {
        let file = apt.join(name);
        std::fs::write(&file, text).map_err(|error| format!("cannot write {}: {error}", file.display()))
    };
    write("newer.sources", source(mirror))?;
    write("apt.conf", settings(&apt))?;
    let apt_get = || {
        let mut command = Command::new("apt-get");
        command.arg("-q").arg("-c").arg(apt.join("apt.conf")).current_dir(folder);
        command
    };
    shell::run(apt_get().arg("update"))?;
    shell::run(apt_get().arg("download").args(PACKAGES))?;
    for package in PACKAGES {
        let archive = the_file(folder, &format!("{package}_"), ".deb")
            .ok_or_else(|| format!("apt-get did not download {package}"))?;
        shell::run(Command::new("dpkg").arg("-x").arg(archive).arg(unfinished))?;
    }
    // The rename is atomic. If another process was faster, its result is equivalent.
    let unpacked = folder.join("unpacked");
    match std::fs::rename(unfinished, &unpacked) {
        Err(error) if !unpacked.exists() => Err(format!("cannot create {}: {error}", unpacked.display())),
        _ => Ok(()),
    }
}

/// Returns the only package source.
fn source(mirror: &str) -> String {
    let mut source = format!("Types: deb\nURIs: {mirror}\nSuites: {BACKPORTS}\nComponents: main\nTargets: Packages\n");
    // Without this file, apt uses all keys that it trusts.
    const KEYS: &str = "/usr/share/keyrings/debian-archive-keyring.gpg";
    if Path::new(KEYS).is_file() {
        source += &format!("Signed-By: {KEYS}\n");
    }
    source
}

/// Returns apt settings in addition to the system's own, such as proxies: its files are in this folder, nothing counts as installed, root
/// is not required, and timeouts are short.
fn settings(apt: &Path) -> String {
    let apt = apt.display();
    format!(
        r##"Dir::Etc::sourcelist "{apt}/newer.sources";
Dir::Etc::sourceparts "/dev/null";
Dir::Etc::preferences "/dev/null";
Dir::Etc::preferencesparts "/dev/null";
Dir::State::lists "{apt}/lists";
Dir::State::status "/dev/null";
Dir::Cache "{apt}/cache";
Acquire::Languages "none";
Acquire::Retries "1";
Acquire::http::Timeout "20";
Acquire::https::Timeout "20";
APT::Sandbox::User "root";
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
"##
    )
}

/// Whether a system is the release with the old driver, by its `os-release`.
fn is_the_release(system: &str) -> bool {
    let says = |line: &str| system.lines().any(|own| own.replace('"', "") == line);
    says("ID=debian") && says(&format!("VERSION_CODENAME={RELEASE}"))
}

/// Returns the mirrors of the system's packages, from lines with a release, a component and a URI. There may be several, because other
/// archives may have a release of the same name.
fn mirrors(targets: &str) -> Vec<&str> {
    let mut mirrors = Vec::new();
    for line in targets.lines() {
        if let [RELEASE, "main", mirror] = line.split_whitespace().collect::<Vec<_>>()[..]
            && !mirrors.contains(&mirror)
        {
            mirrors.push(mirror);
        }
    }
    mirrors
}

/// Returns the first file in a folder, or below it, whose name has this prefix and suffix.
fn the_file(folder: &Path, begin: &str, end: &str) -> Option<PathBuf> {
    let mut inside: Vec<PathBuf> = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
    inside.sort();
    let is_it = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(begin) && name.ends_with(end)
    };
    let found = inside.iter().find(|path| is_it(path)).cloned();
    found.or_else(|| inside.iter().filter(|path| path.is_dir()).find_map(|folder| the_file(folder, begin, end)))
}

/// Returns a driver's manifest with the absolute path of its library in place of the name.
fn with_library(manifest: &str, library: &Path) -> Option<String> {
    const KEY: &str = "\"library_path\"";
    let after_key = manifest.find(KEY)? + KEY.len();
    let begin = after_key + manifest[after_key..].find('"')? + 1;
    let end = begin + manifest[begin..].find('"')?;
    let path = library.to_str()?.replace('\\', "\\\\").replace('"', "\\\"");
    Some(format!("{}{path}{}", &manifest[..begin], &manifest[end..]))
}

/// Returns the dependencies of a library that the loader does not find; `None` if there are none or `ldd` cannot run.
fn missing_libraries(library: &Path, searched: &OsString) -> Option<String> {
    let listed = Command::new("ldd").arg(library).env("LD_LIBRARY_PATH", searched).output().ok()?;
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    let missing: Vec<&str> = listed.lines().map(str::trim).filter(|line| line.ends_with("not found")).collect();
    (!missing.is_empty()).then(|| missing.join(", "))
}

/// Returns the version in the name of the downloaded package.
fn version_in(folder: &Path) -> Option<String> {
    let archive = the_file(folder, &format!("{DRIVER_PACKAGE}_"), ".deb")?;
    archive.file_name()?.to_str()?.split('_').nth(1).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<String> {
        line.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn the_option_is_taken_from_anywhere() {
        assert_eq!(option(&words("pcss --driver newer kept")), Ok((DriverChoice::Newer, words("pcss kept"))));
        assert_eq!(option(&words("--driver=installed")), Ok((DriverChoice::Installed, Vec::new())));
    }

    #[test]
    fn another_driver_is_refused_with_those_there_are() {
        for line in ["--driver other", "--driver", "--driver="] {
            let error = option(&words(line)).expect_err(line);
            assert!(error.contains("default, installed or newer"), "{error}");
        }
    }

    #[test]
    fn the_mirror_is_where_the_system_has_its_packages_from() {
        let targets = "bookworm main https://mirror.example/debian/\nbookworm main https://mirror.example/debian/\n\
                       bookworm-security main https://mirror.example/security/\nbookworm stable https://other.example/\n";
        assert_eq!(mirrors(targets), ["https://mirror.example/debian/"]);
        assert!(mirrors("").is_empty());
    }

    #[test]
    fn only_the_release_with_the_old_driver_asks_its_backports() {
        assert!(is_the_release(
            "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nVERSION_CODENAME=bookworm\nID=debian\n"
        ));
        assert!(!is_the_release("VERSION_CODENAME=trixie\nID=debian\n"));
        assert!(!is_the_release("VERSION_CODENAME=bookworm\nID=other\n"));
    }

    #[test]
    fn a_manifest_has_the_whole_path_wherever_its_key_stands() {
        let last = "{\"ICD\": {\"api_version\": \"1.4\", \"library_path\": \"libvulkan_lvp.so\"\n}}";
        let whole = "{\"ICD\": {\"api_version\": \"1.4\", \"library_path\": \"/a/libvulkan_lvp.so\"\n}}";
        assert_eq!(with_library(last, Path::new("/a/libvulkan_lvp.so")).as_deref(), Some(whole));
        assert_eq!(with_library("{}", Path::new("/a")), None);
    }
}
