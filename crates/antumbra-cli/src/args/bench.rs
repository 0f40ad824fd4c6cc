//! Options of `bench`.

use std::path::PathBuf;

use antumbra_lab::suite::Part;
use clap::Args;
use glam::UVec2;

use super::common::{AdapterArgs, SceneArgs};
use super::run::RunArgs;
use crate::values::{self, Setting};

/// Measures the time of every pass
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra bench
  antumbra bench builtin:street scene.glb --techniques pcss --sizes 1280x720,1920x1080 --frames 100 --json times.json
  antumbra bench scene.glb --setup evening.toml --light lamp --minutes 60

  antumbra bench builtin:street --deadline 60 --json times.json --resume
  antumbra bench builtin:street --baseline other.json
  antumbra bench --share card.json

Prints medians, with the numbers of timed frames and of warm-up frames, in which pipelines are compiled and lists grow. --minutes is \
divided equally among the measurements: slow ones time fewer frames, and those without time are reported as skipped. The JSON also has \
adapter, driver and commit. It is updated after each measurement, and --resume continues it.

--share measures columns and street at 1920x1080, unless scenes and sizes are given, and writes one file for bench/cards: adapter, \
driver, versions and times, but no paths and no user names. --cards prints the page of all such files.

  antumbra bench --suite results.json --minutes 7
  antumbra bench --suite results.json --minutes 7 --parts times,growth
  antumbra bench --tables results.json > BENCHMARKS.md

--suite measures everything in BENCHMARKS.md, for --minutes, into one file; run the same command again to continue. --tables prints the \
page.")]
pub struct BenchArgs {
    /// Scenes: .glb or .gltf files, or builtin:NAME; default: overlap, knot and street
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Light to measure, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Image sizes, separated by commas; default: 1280x720, or 480x270 on a software adapter
    #[arg(long, value_name = "WxH,...", value_delimiter = ',', value_parser = values::size)]
    pub sizes: Vec<UVec2>,
    /// Number of timed frames for each technique, scene and size
    #[arg(long, value_name = "N", default_value = "20", value_parser = values::frames)]
    pub frames: u32,
    /// Minimum number of warm-up frames; at least one is drawn, and more until two take about as long
    #[arg(long, value_name = "N", default_value = "3", value_parser = values::warm_up)]
    pub warm_up: u32,
    /// Time limit in minutes; a running measurement is completed. Default: 10, or until --deadline
    #[arg(long, value_name = "N", value_parser = values::minutes)]
    pub minutes: Option<u32>,
    /// Also writes all results as JSON
    #[arg(long, value_name = "out.json")]
    pub json: Option<PathBuf>,
    /// Also writes a file to share: adapter, driver, versions, and times on built-in scenes
    #[arg(long, value_name = "card.json", conflicts_with_all = ["setup", "light"])]
    pub share: Option<PathBuf>,
    /// Measures the entries of BENCHMARKS.md that this file lacks, within --minutes
    #[arg(long, value_name = "results.json", conflicts_with_all = NOT_OF_A_SUITE)]
    pub suite: Option<PathBuf>,
    /// Tables of the suite to measure, separated by commas; default: all
    #[arg(long, value_name = "TABLE,...", value_delimiter = ',', requires = "suite", value_parser = values::suite_part)]
    pub parts: Vec<Part>,
    /// Prints the results file of a suite as a Markdown page
    #[arg(long, value_name = "results.json", conflicts_with_all = NOT_OF_A_SUITE, conflicts_with = "suite")]
    pub tables: Option<PathBuf>,
    /// Prints a folder of shared results as a page
    #[arg(long, value_name = "DIR", conflicts_with_all = NOT_OF_A_SUITE, conflicts_with_all = ["suite", "tables"])]
    pub cards: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Options that select measurements; a suite makes its own selection.
const NOT_OF_A_SUITE: [&str; 16] = [
    "scenes",
    "setup",
    "time",
    "ground",
    "light",
    "techniques",
    "settings",
    "sizes",
    "frames",
    "warm_up",
    "json",
    "share",
    "deadline",
    "technique_limit",
    "resume",
    "baseline",
];
