//! The command `antumbra`: reads scenes; writes images, ground truth, comparisons and times.
//!
//! The laboratory implements the commands; this crate adds arguments, messages, exit codes and progress.

mod args;
mod commands;
mod failure;
mod progress;
mod stdout;
mod suggest;
mod table;
mod technique_text;
mod values;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use clap::Parser;
use clap::error::ErrorKind;

use args::{Cli, Command};
use failure::{Failure, SavedResults};
use progress::Bars;

fn main() -> ExitCode {
    keep_wayland_quiet();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return report_usage(&error),
    };
    if let Err(error) = ctrlc::set_handler(stop) {
        tell(&format_args!("cannot handle Ctrl-C, which will leave unfinished files behind: {error}"));
    }
    let bars = Bars::new(cli.quiet);
    let outcome = match cli.command {
        Command::Render(args) => commands::render(&args, &bars),
        Command::Reference(args) => commands::reference(&args, &bars),
        Command::View(args) => commands::view(args),
        Command::Compare(args) => commands::compare(&args, &bars),
        Command::Advise(args) => commands::advise(&args, &bars),
        Command::Bench(args) => commands::bench(&args, &bars),
        Command::Sweep(args) => commands::sweep(&args, &bars),
        Command::Techniques(args) => commands::techniques(&args),
        Command::Scenes(args) => commands::scenes(&args),
        Command::Doctor(args) => commands::doctor(&args),
        Command::Reproduce(args) => commands::reproduce(&args, &bars),
        Command::Completions(args) => commands::completions(&args),
        Command::Man(args) => commands::man(&args),
    };
    antumbra_lab::progress::Progress::end(&bars);
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            tell(&failure);
            failure.exit_code()
        }
    }
}

/// Disables Mesa's device-select layer without a Wayland session. The layer asks the session which GPU it uses, and
/// libwayland prints an error for each question if there is none.
fn keep_wayland_quiet() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread has been started yet, so no other code reads the environment.
        #[expect(unsafe_code, reason = "the Vulkan loader reads this only from the environment")]
        unsafe {
            std::env::set_var("NODEVICE_SELECT", "1");
        }
    }
}

/// Handler of Ctrl-C: removes unfinished files and exits with [`INTERRUPTED`].
fn stop() {
    antumbra_lab::output_files::remove_unfinished();
    match &*KEPT.lock().unwrap_or_else(PoisonError::into_inner) {
        Some(path) => tell(&format_args!("interrupted; {}", SavedResults::Resumable(path))),
        None => tell(&"interrupted; no unfinished file was left"),
    }
    leave_at_once(INTERRUPTED);
}

/// Path of the results that remain after an interruption; `None` before the first is written.
static KEPT: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Sets the path of the results that remain after an interruption.
fn keep(path: &Path) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some(path.to_path_buf());
}

/// Exit code 128 + SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// Ends the process without the destructors of libraries, because a driver's threads may still use what they would free.
fn leave_at_once(code: i32) -> ! {
    #[cfg(unix)]
    // SAFETY: `_exit` accepts any number, never returns and touches no memory of this process.
    #[expect(unsafe_code, reason = "the standard library ends a process only with destructors or by an abort")]
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// Prints help and version as clap formats them, and an error in one line.
fn report_usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A closed pipe is no error.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => match given_command() {
            Some(_) => refused("every command is in the list"),
            None => {
                let _ = error.print();
                ExitCode::from(2)
            }
        },
        _ => {
            let text = error.to_string();
            // The text before the usage has the error, its place and clap's tips.
            let end = text.find("\n\nUsage:").or_else(|| text.find("\n\nFor more information")).unwrap_or(text.len());
            let message = text[..end].trim_start_matches("error: ").replace("\n\n  tip: ", "; ");
            refused(&message)
        }
    }
}

/// Reports invalid arguments in one line.
fn refused(message: &str) -> ExitCode {
    let help = given_command().map_or_else(|| "antumbra --help".to_owned(), |word| format!("antumbra {word} --help"));
    let failure = Failure::Input(format!("{message}; see `{help}`"));
    tell(&failure);
    failure.exit_code()
}

/// Prints a line to stderr; ignores errors, because stderr may be closed or full.
fn tell(what: &dyn std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "antumbra: {what}");
}

/// The command at the start of the arguments, which need not be Unicode.
fn given_command() -> Option<String> {
    let first = std::env::args_os().nth(1)?.into_string().ok()?;
    is_command(&first).then_some(first)
}

fn is_command(word: &str) -> bool {
    <Cli as clap::CommandFactory>::command().get_subcommands().any(|command| command.get_name() == word)
}
