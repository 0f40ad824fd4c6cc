//! Standard output, which may be a pipe that nobody reads any more, or a file on a full disk.

use std::fmt;
use std::io::{self, ErrorKind, Write};

/// `println!` for whoever still listens.
macro_rules! say {
    ($($text:tt)*) => {
        $crate::stdout::write(format_args!("{}\n", format_args!($($text)*)))
    };
}
pub(crate) use say;

/// Writes `text`. A reader that closed the pipe has read enough: the command goes on with what it makes. What could not
/// be written for another reason is an error in one line.
pub fn write(text: fmt::Arguments<'_>) {
    let mut stdout = io::stdout().lock();
    match stdout.write_fmt(text).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            antumbra_lab::output_files::remove_unfinished();
            crate::tell(&format_args!("cannot write to standard output: {error}"));
            std::process::exit(1);
        }
        _ => {}
    }
}
