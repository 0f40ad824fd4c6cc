//! `antumbra man -o FOLDER`.

use std::fs;

use antumbra_lab::output_files::write_atomically;
use clap::CommandFactory;
use clap_mangen::Man;

use crate::args::{Cli, ManArgs};
use crate::failure::Failure;
use crate::stdout::say;

/// Writes a manual page for the program and one per command.
pub fn man(args: &ManArgs) -> Result<(), Failure> {
    let folder = &args.output;
    fs::create_dir_all(folder)
        .map_err(|error| Failure::Input(format!("cannot create {}: {error}", folder.display())))?;
    let mut program = Cli::command();
    program.build();
    let mut commands = vec![program];
    let mut pages = 0;
    while let Some(command) = commands.pop() {
        commands.extend(command.get_subcommands().cloned());
        // For example, `antumbra sweep plan` has the page antumbra-sweep-plan(1).
        let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
        let mut page = Vec::new();
        Man::new(command).render(&mut page).expect("writing to memory does not fail");
        write_atomically(&folder.join(format!("{name}.1")), &page)?;
        pages += 1;
    }
    say!("wrote {pages} pages to {}", folder.display());
    Ok(())
}
