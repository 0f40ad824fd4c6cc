//! Pipeline part of `cargo xtask gpu-cost`: counts by Mesa's AMD compiler, on the null device of Mesa's RADV, which the driver in
//! `xtask/null-device` wraps.

pub mod announcement;
mod frames;
mod limits;
mod log;
mod null_device;
mod page;
mod table;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use limits::Exceptions;
use log::Log;
use null_device::NullDevice;
use page::Title;
use table::Table;

/// Family of devices.
struct Family {
    title: &'static str,
    /// Names in different versions of Mesa, the newest first.
    names: &'static [&'static str],
}

const FAMILIES: [Family; 2] = [
    Family { title: "RDNA 2, 2020", names: &["navi21"] },
    Family { title: "RDNA 3, 2022", names: &["navi31", "gfx1100"] },
];

/// Inputs and outputs of a run.
pub struct Options {
    /// Output folder of tables and the drivers' logs.
    pub folder: PathBuf,
    /// Library of Mesa's RADV.
    pub driver: OsString,
    /// Library of the driver that wraps RADV.
    pub null_device: OsString,
    /// Page to write, and the command `antumbra`, which draws the page's frames.
    pub page: Option<(PathBuf, PathBuf)>,
    /// Earlier table for comparison.
    pub earlier: Option<PathBuf>,
}

/// Counts the costs of every pipeline for each family and writes them to files. Fails beyond the limits unless a page is requested.
///
/// # Errors
/// If the driver cannot be used, a limit is exceeded, or an exception is not needed.
pub fn run(options: &Options) -> Result<(), String> {
    let exceptions = Exceptions::read()?;
    let earlier = options.earlier.as_deref().map(read_table).transpose()?;
    fs::create_dir_all(&options.folder).map_err(|error| format!("{}: {error}", options.folder.display()))?;
    let device = &NullDevice::new(options)?;
    let logs = std::thread::scope(|scope| {
        let runs = FAMILIES.map(|family| scope.spawn(move || measure(options, device, &family)));
        runs.map(|run| run.join().expect("runs do not panic")).into_iter().collect::<Result<Vec<_>, _>>()
    })?;
    let logs: Vec<(Title, Log)> = logs.into_iter().flatten().collect();
    for (_, log) in &logs {
        let file = options.folder.join(format!("{}.tsv", log.table.family.to_lowercase()));
        write(&file, &log.table.to_text())?;
        eprintln!(
            "programs: counted {} programs for {}, in {}",
            log.table.rows.len(),
            log.table.family,
            file.display()
        );
        if let Some(earlier) = earlier.as_ref().filter(|earlier| earlier.family == log.table.family) {
            print!("{}", log.table.difference(earlier));
        }
    }
    if let Some((file, antumbra)) = &options.page {
        let techniques: Vec<&str> = logs
            .first()
            .map_or_else(Vec::new, |(_, log)| log.techniques.iter().map(|(technique, _)| technique.as_str()).collect());
        let frames = frames::count(device, antumbra, FAMILIES[0].names[0], &options.folder, &techniques)?;
        write(file, &page::page(&logs, &frames, &exceptions)?)?;
    }
    judge(&exceptions, logs.into_iter().map(|(_, log)| log.table).collect(), options.page.is_none())
}

/// Compares tables with the limits.
///
/// # Errors
/// If `fails`, and a limit is exceeded or an exception is not needed.
fn judge(exceptions: &Exceptions, tables: Vec<Table>, fails: bool) -> Result<(), String> {
    if let Some(other) = tables.iter().find_map(|table| exceptions.are_for(table).err()) {
        eprintln!("programs: SKIPPED limits of registers and spills: {other}");
        return Ok(());
    }
    let faults = exceptions.judge(&tables);
    for fault in &faults {
        println!("{fault}");
    }
    match faults.len() {
        0 => Ok(()),
        count if fails => Err(format!("{count} limits are exceeded, or exceptions are not needed")),
        _ => Ok(()),
    }
}

/// Returns the driver's counts for a family. Prints a message and returns `None` if it does not know the family.
fn measure(options: &Options, device: &NullDevice<'_>, family: &Family) -> Result<Option<(Title, Log)>, String> {
    let mut problem = String::new();
    for name in family.names {
        let file = options.folder.join(format!("{name}.log"));
        let text = log_of(device, name)?;
        write(&file, &text)?;
        match Log::read(&text) {
            Ok(log) => return Ok(Some((Title(family.title), log))),
            Err(error) if error.contains("Unknown family") => problem = error,
            Err(error) => return Err(format!("{name}: {error}; the whole output is in {}", file.display())),
        }
    }
    eprintln!("programs: SKIPPED {}: this Mesa has no such family: {problem}", family.title);
    Ok(None)
}

/// Returns the standard error of this program on the null device.
fn log_of(device: &NullDevice<'_>, family: &str) -> Result<String, String> {
    let own = std::env::current_exe().map_err(|error| format!("cannot find the path of this program: {error}"))?;
    let mut command = device.command(&own, family);
    // Cached pipelines print nothing.
    command.arg(ANNOUNCE).env("RADV_DEBUG", "shaderstats,nocache").env("MESA_SHADER_CACHE_DISABLE", "true");
    let output = command.output().map_err(|error| format!("cannot run on the null device: {error}"))?;
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Argument with which this program announces pipelines.
pub const ANNOUNCE: &str = "announce";

fn read_table(file: &Path) -> Result<Table, String> {
    let text = fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    Table::of_text(&text).map_err(|error| format!("{}: {error}", file.display()))
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))
}
