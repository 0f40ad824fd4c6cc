//! Files and folders that appear completely or not at all.
//!
//! Everything is written under a temporary name beside its target, thus on the same file system, and renamed when it is complete. A list
//! of unfinished files lets a Ctrl-C handler remove them: see [`remove_unfinished`].

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
