//! Options of `sweep`, and of its parts `plan`, `run` and `merge`.

use std::path::PathBuf;

use antumbra_lab::sweep::Shard;
use clap::{Args, Subcommand};
use glam::UVec2;

use super::common::{AdapterArgs, SceneArgs};
use crate::values::{self, Setting};

/// Runs many comparisons as independent jobs, on one machine or many
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra sweep plan builtin:tree builtin:street --techniques pcf,pcss --vary map_size=512,1024,2048 -o sweep
  antumbra sweep run sweep --shard 1/4
  antumbra sweep merge sweep -o results.json

A shard runs those of its jobs that have no result yet: if it was stopped, run the same command again. Errors equal those of `compare`. \
docs/sweep.md has recipes for Slurm, GNU parallel and Kubernetes.")]
pub struct SweepArgs {
    #[command(subcommand)]
    pub command: SweepCommand,
}

#[derive(Debug, Subcommand)]
pub enum SweepCommand {
    Plan(SweepPlanArgs),
    Run(SweepRunArgs),
    Merge(SweepMergeArgs),
}

/// Writes the plan: every scene at every size with every technique and every value of --vary
#[derive(Debug, Args)]
pub struct SweepPlanArgs {
    /// .glb or .gltf files, at paths that the shards can read, or builtin:NAME
    #[arg(value_name = "SCENE", required = true, value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Light to compare and time, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Runs a technique, or every technique that has the parameter, with each value; may be given several times
    #[arg(long, value_name = "NAME.KEY=V,W,...", value_parser = values::setting)]
    pub vary: Vec<Setting>,
    /// Image sizes, separated by commas
    #[arg(long, value_name = "WxH,...", default_value = "1280x720", value_delimiter = ',', value_parser = values::size)]
    pub sizes: Vec<UVec2>,
    /// Light samples per pixel of the ground truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Number of timed frames for each job after warm-up, as in `compare`
    #[arg(long, value_name = "N", default_value = "5", value_parser = values::frames)]
    pub frames: u32,
    /// Folder for the plan and its results
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Runs a shard of a plan
#[derive(Debug, Args)]
pub struct SweepRunArgs {
    /// Folder written by `antumbra sweep plan`
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Shard, and number of shards: 1/4 to 4/4
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = values::shard)]
    pub shard: Shard,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Collects all results of a plan in one file
#[derive(Debug, Args)]
pub struct SweepMergeArgs {
    /// Folder of the sweep, or its copies from several machines
    #[arg(value_name = "DIR", required = true)]
    pub dirs: Vec<PathBuf>,
    /// File for the results
    #[arg(short, long, value_name = "results.json")]
    pub output: PathBuf,
}
