//! Options of `reproduce`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;

use super::common::AdapterArgs;
use super::run::RunArgs;
use crate::values;

/// Lists or runs tables and figures of papers, and judges whether the papers' claims hold here
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra reproduce                             lists all entries, and which can be run
  antumbra reproduce marrs-2014/figure1          runs one figure: the paper's numbers beside ours
  antumbra reproduce --all -o reproduced         runs everything; run again to continue
  antumbra reproduce selgrad-2014 -o reproduced --dear
  antumbra reproduce --all --deadline 300 --technique-limit 20

Scene files are read from the folder in the environment variable ANTUMBRA_SCENES. Rows whose scene file is missing are not ready.")]
pub struct ReproduceArgs {
    /// Entries such as marrs-2014/figure1, papers such as marrs-2014, or `all`; without any, lists them
    #[arg(value_name = "ID")]
    pub ids: Vec<String>,
    /// Runs everything, into the folder `reproduced` unless -o names another
    #[arg(long, conflicts_with = "ids")]
    pub all: bool,
    /// Folder for pages with images, verdicts and numbers; keeps results of an earlier run of the same commit on the same adapter
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Number of timed frames for each measurement, unless they take longer than 20 s (2 s on a software renderer)
    #[arg(long, value_name = "N", default_value = "10", value_parser = values::frames)]
    pub frames: u32,
    /// Image size instead of the paper's, for a quick look; on a software renderer all images have about 37 000 pixels
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<UVec2>,
    /// Light samples per pixel of the ground truth; default: 1024, or 256 on a software renderer
    #[arg(long, value_name = "N", value_parser = values::samples)]
    pub samples: Option<u32>,
    /// Also runs entries that take too long on a software renderer
    #[arg(long)]
    pub dear: bool,
    /// Memory bandwidth of this adapter, in GB/s: times are then also compared at equal bandwidth
    #[arg(long, value_name = "GB/S", value_parser = values::bandwidth)]
    pub bandwidth: Option<f64>,
    /// Also writes all results of this run as JSON
    #[arg(long, value_name = "out.json")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}
