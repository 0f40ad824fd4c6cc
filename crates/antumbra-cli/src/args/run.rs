//! Options of `bench`, `compare` and `reproduce` that end a run early, resume one, or compare it with another.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use antumbra_lab::limits::Limits;
use clap::Args;

use crate::values;

/// Limits of a run, and whether it resumes an earlier one.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// Ends in time: nothing begins that is not expected to end within these seconds. What is missing is named, and the exit code is 4
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub deadline: Option<Duration>,
    /// Cuts a technique short that takes longer on one scene and size, and says so; further frames are not begun
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub technique_limit: Option<Duration>,
    /// Resumes what an earlier run of the same line wrote, which may have been stopped: measures only what is missing
    #[arg(long)]
    pub resume: bool,
    /// Results of the same measurements by another adapter or commit: prints and writes ratios of time and differences of error
    #[arg(long, value_name = "FILE")]
    pub baseline: Option<PathBuf>,
}

impl RunArgs {
    /// Limits of a run that begins now.
    pub fn limits(&self) -> Limits {
        Limits { deadline: self.deadline.map(|after| Instant::now() + after), technique: self.technique_limit }
    }
}
