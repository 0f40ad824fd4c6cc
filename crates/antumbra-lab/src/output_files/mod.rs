//! Files and folders that appear whole or not at all.
//!
//! Everything is built under a temporary name beside its target, so on the same file system, and renamed when it is
//! complete. A list of what is unfinished lets a Ctrl-C handler leave nothing behind: see [`remove_unfinished`].

mod atomic_file;
mod error;
mod json;
mod named;
mod output_dir;
mod unfinished;

pub use atomic_file::{AtomicFile, check_writable, write_atomically};
pub use error::FileError;
pub(crate) use error::one_line;
pub(crate) use json::read_json;
pub use named::{check_ending, check_json_path, check_named};
pub use output_dir::OutputDir;
pub use unfinished::remove_unfinished;
