//! Standard output with error handling: a closed pipe, a full disk.

use std::fmt;
use std::io::{self, ErrorKind, Write};

/// Like `println!`, but a closed pipe is no error.
macro_rules! say {
    ($($text:tt)*) => {
        $crate::stdout::write(format_args!("{}\n", format_args!($($text)*)))
    };
}
pub(crate) use say;

/// Writes `text`. A closed pipe is ignored, so the command still writes its files. Any other error is reported in one line
/// and ends the process.
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
