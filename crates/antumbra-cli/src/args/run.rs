//! Options of `bench`, `compare` and `reproduce` that end a run early, resume one, or compare it with another.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use antumbra_lab::limits::Limits;
use clap::Args;

use crate::values;

/// Limits of a run, and whether it resumes an earlier one.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// Time limit: starts no measurement that is not expected to end within it, lists what is missing and exits with code 4
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub deadline: Option<Duration>,
    /// Time limit for each technique on one scene and size: starts no further frames after it, and reports the cut
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub technique_limit: Option<Duration>,
    /// Resumes an earlier run of the same command line, even an interrupted one: measures only what is missing
    #[arg(long)]
    pub resume: bool,
    /// Results to compare with, from another adapter or commit: prints and writes ratios of times and differences of errors
    #[arg(long, value_name = "FILE")]
    pub baseline: Option<PathBuf>,
}

impl RunArgs {
    /// Returns the limits of a run that begins now.
    pub fn limits(&self) -> Limits {
        Limits { deadline: self.deadline.map(|after| Instant::now() + after), technique: self.technique_limit }
    }
}
