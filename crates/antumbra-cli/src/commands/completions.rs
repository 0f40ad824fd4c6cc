//! `antumbra completions SHELL`.

use clap::CommandFactory;

use crate::args::{Cli, CompletionsArgs};
use crate::failure::Failure;
use crate::stdout;

/// Prints completions for a shell.
pub fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "antumbra", &mut script);
    stdout::write(format_args!("{}", String::from_utf8_lossy(&script)));
    Ok(())
}
