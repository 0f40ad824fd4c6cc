//! The command `antumbra`: scenes in; pictures, truth, comparisons and times out.
//!
//! What each command does is the laboratory's business; here are arguments, messages, exit codes and progress.

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
use failure::{Failure, Kept};
use progress::Bars;

fn main() -> ExitCode {
    keep_wayland_quiet();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return report_usage(&error),
    };
    if let Err(error) = ctrlc::set_handler(stop) {
        tell(&format_args!("Ctrl-C will stop without cleaning up: {error}"));
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

/// Mesa's device-select layer asks the Wayland session which GPU it runs on, and where there is no session libwayland
/// complains on stderr, once for every question. There is nobody to ask then, so the layer is left out.
fn keep_wayland_quiet() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread has been started yet, so nobody else looks at the environment.
        #[expect(unsafe_code, reason = "the Vulkan loader takes this from the environment alone")]
        unsafe {
            std::env::set_var("NODEVICE_SELECT", "1");
        }
    }
}

/// The handler of Ctrl-C: no half-written file stays, and the exit code says so.
fn stop() {
    antumbra_lab::output_files::remove_unfinished();
    match &*KEPT.lock().unwrap_or_else(PoisonError::into_inner) {
        Some(path) => tell(&format_args!("interrupted; {}", Kept::ToResume(path))),
        None => tell(&"interrupted; nothing half-written is left"),
    }
    leave_at_once(INTERRUPTED);
}

/// Where results are that an interruption leaves; none before the first is written.
static KEPT: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Says where results are, should the user interrupt.
fn keep(path: &Path) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some(path.to_path_buf());
}

/// 128 + SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// Ends the process without the destructors of libraries: a driver's threads still draw by what those would take away.
fn leave_at_once(code: i32) -> ! {
    #[cfg(unix)]
    // SAFETY: `_exit` takes any number, returns never and touches no memory of this process.
    #[expect(unsafe_code, reason = "the standard library ends a process only with its destructors, or by an abort")]
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// Help and version as clap writes them; a mistake as one line, like every other error.
fn report_usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A reader that closed the pipe has read enough.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => match given_command() {
            Some(_) => refused("one of its commands is missing"),
            None => {
                let _ = error.print();
                ExitCode::from(2)
            }
        },
        _ => {
            let text = error.to_string();
            // Everything before the usage: what is wrong, where, and clap's tips.
            let end = text.find("\n\nUsage:").or_else(|| text.find("\n\nFor more information")).unwrap_or(text.len());
            let message = text[..end].trim_start_matches("error: ").replace("\n\n  tip: ", "; ");
            refused(&message)
        }
    }
}

/// Says in one line what is wrong with the arguments.
fn refused(message: &str) -> ExitCode {
    let help = given_command().map_or_else(|| "antumbra --help".to_owned(), |word| format!("antumbra {word} --help"));
    let failure = Failure::Input(format!("{message}; see `{help}`"));
    tell(&failure);
    failure.exit_code()
}

/// A line on stderr, which may be closed or full.
fn tell(what: &dyn std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "antumbra: {what}");
}

/// The command that the arguments begin with. Arguments need not be Unicode.
fn given_command() -> Option<String> {
    let first = std::env::args_os().nth(1)?.into_string().ok()?;
    is_command(&first).then_some(first)
}

fn is_command(word: &str) -> bool {
    <Cli as clap::CommandFactory>::command().get_subcommands().any(|command| command.get_name() == word)
}
