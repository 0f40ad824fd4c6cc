//! Options of `reproduce`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;

use super::common::AdapterArgs;
use super::run::RunArgs;
use crate::values;

/// Lists the papers' tables and figures, runs them, and says for each of the papers' claims whether it holds here
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra reproduce                             every entry, and which can be run
  antumbra reproduce marrs-2014/figure1          that figure: the paper's numbers beside ours
  antumbra reproduce --all -o reproduced         everything, as a page for each paper; started again, it goes on
  antumbra reproduce selgrad-2014 -o reproduced --dear
  antumbra reproduce --all --deadline 300 --technique-limit 20

Scenes that are files lie in the folder that the environment variable ANTUMBRA_SCENES names; rows whose scene is not
there are not ready.")]
pub struct ReproduceArgs {
    /// Entries such as marrs-2014/figure1, papers such as marrs-2014, or `all`; none lists them
    #[arg(value_name = "ID")]
    pub ids: Vec<String>,
    /// Everything; goes into the folder `reproduced` unless -o says otherwise
    #[arg(long, conflicts_with = "ids")]
    pub all: bool,
    /// A folder for pages with pictures, verdicts and numbers; what it holds from an earlier run of the same commit on the
    /// same adapter is not run again
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Timed frames for each measurement, where they take no longer than 20 s (2 s on a software renderer)
    #[arg(long, value_name = "N", default_value = "10", value_parser = values::frames)]
    pub frames: u32,
    /// Another size of picture than the paper's, for a quick look; on a software renderer all have some 37 000 pixels
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<UVec2>,
    /// Light points a pixel of the truth: 1024, or 256 on a software renderer
    #[arg(long, value_name = "N", value_parser = values::samples)]
    pub samples: Option<u32>,
    /// Also runs what takes a software renderer too long
    #[arg(long)]
    pub dear: bool,
    /// This adapter's memory bandwidth, GB/s: times are then compared at equal bandwidth too
    #[arg(long, value_name = "GB/S", value_parser = values::bandwidth)]
    pub bandwidth: Option<f64>,
    /// Also writes everything that is run as JSON
    #[arg(long, value_name = "out.json")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}
