//! Creates every pipeline of library, renderer and viewer on devices that draw nothing, for `cargo xtask web --shaders`,
//! `portability` and `gpu-cost`.

mod costs;
mod describe;
mod description;
mod device;
mod makings;
mod portability;
mod recorder;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Usage, for xtask, the only caller.
const USAGE: &str = "\
antumbra-programs describe FILE
antumbra-programs portability FOLDER [--dxc LIBRARY] [--spirv-val PROGRAM] [--only TEXT]
antumbra-programs dxil LIBRARY FILE ENTRY PROFILE
antumbra-programs costs FOLDER --driver LIBRARY --null-device LIBRARY [--page FILE --antumbra PROGRAM] [--diff TABLE]
antumbra-programs announce";

fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().skip(1).collect();
    match run(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("programs: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(words: &[OsString]) -> Result<(), String> {
    let Some((command, rest)) = words.split_first() else { return Err(USAGE.to_owned()) };
    match (command.to_str(), rest) {
        (Some("describe"), [file]) => {
            let [modules, pipelines] = describe::write(Path::new(file))?;
            eprintln!("programs: {modules} modules and {pipelines} pipelines");
            Ok(())
        }
        (Some("portability"), [folder, rest @ ..]) => {
            let [dxc, spirv_val, only] = options(rest, ["--dxc", "--spirv-val", "--only"])?;
            let only = only.map(|only| only.to_string_lossy().into_owned());
            portability::check(&portability::Options { folder: PathBuf::from(folder), dxc, spirv_val, only })
        }
        (Some(portability::DXIL), [library, file, entry, profile]) => {
            let [entry, profile] = [entry, profile].map(|word| word.to_string_lossy());
            match portability::compile_hlsl(library, Path::new(file), &entry, &profile)? {
                None => Ok(()),
                Some(message) => {
                    print!("{message}");
                    Err("DXC reports errors".to_owned())
                }
            }
        }
        (Some("costs"), [folder, rest @ ..]) => {
            let [driver, null_device, page, antumbra, earlier] =
                options(rest, ["--driver", "--null-device", "--page", "--antumbra", "--diff"])?;
            let (Some(driver), Some(null_device)) = (driver, null_device) else { return Err(USAGE.to_owned()) };
            let [page, antumbra, earlier] = [page, antumbra, earlier].map(|file| file.map(PathBuf::from));
            let page = page.zip(antumbra);
            costs::run(&costs::Options { folder: PathBuf::from(folder), driver, null_device, page, earlier })
        }
        (Some(costs::ANNOUNCE), []) => costs::announcement::announce_all(),
        _ => Err(USAGE.to_owned()),
    }
}

/// Returns the values of options, each given at most once.
///
/// # Errors
/// If there is another word.
fn options<const N: usize>(words: &[OsString], names: [&str; N]) -> Result<[Option<OsString>; N], String> {
    let mut values = [const { None }; N];
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let place = names.iter().position(|name| word.to_str() == Some(*name));
        let place = place.ok_or_else(|| format!("there is no option `{}`\n{USAGE}", word.display()))?;
        let value = words.next().ok_or_else(|| format!("`{}` needs a value", names[place]))?;
        values[place] = Some(value.clone());
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_have_values() {
        let words = |line: &str| line.split_whitespace().map(OsString::from).collect::<Vec<_>>();
        let found = options(&words("--b 2"), ["--a", "--b"]);
        assert_eq!(found, Ok([None, Some("2".into())]));
        assert!(options(&words("--c 2"), ["--a"]).is_err());
        assert!(options(&words("--a"), ["--a"]).is_err());
    }
}
