//! Command line declaration. All texts of `--help` are here and in the modules below, one per larger command.

mod advise;
mod bench;
mod common;
mod compare;
mod reference;
mod render;
mod reproduce;
mod run;
mod sweep;
mod view;

use std::path::PathBuf;

use antumbra::TechniqueKind;
use clap::{Args, Parser, Subcommand};

use crate::technique_text::techniques_help;
use crate::values;

pub use advise::AdviseArgs;
pub use bench::BenchArgs;
pub use common::{AdapterArgs, Ground, SceneArgs, ViewArgs};
pub use compare::{CompareArgs, MotionArgs};
pub use reference::ReferenceArgs;
pub use render::{RenderArgs, ShadingFactor};
pub use reproduce::ReproduceArgs;
pub use sweep::{SweepArgs, SweepCommand, SweepMergeArgs, SweepPlanArgs, SweepRunArgs};
pub use view::WindowArgs;

/// Version, and the commit that the program was built from.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (commit ", env!("ANTUMBRA_COMMIT"), ")");

/// Renders soft shadows by many techniques, and compares them with ray-traced ground truth
#[derive(Debug, Parser)]
#[command(name = "antumbra", version = VERSION, max_term_width = 110, disable_help_subcommand = true)]
#[command(after_help = "\
Start here:
  antumbra compare builtin:overlap -o out        compares techniques with ground truth
  antumbra advise scene.glb --budget 4ms         recommends a technique and its settings
  antumbra render scene.glb -o picture.png       renders an image with soft shadows
  antumbra view scene.glb                        opens a window: move lights, try techniques
  antumbra techniques pcss                       explains a technique's parameters
  antumbra doctor                                lists adapters and what techniques need

SCENE is a .glb or .gltf file, or builtin:NAME (`antumbra scenes` lists them). Names are not case-sensitive.

Exit codes: 0 success; 2 wrong arguments or input file; 3 no usable adapter or feature; 4 the deadline ended the run early; 130 \
interrupted; 1 any other error. Output files are written completely or not at all.")]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    /// Prints results and errors only, without progress and notes
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Render(RenderArgs),
    Reference(ReferenceArgs),
    View(WindowArgs),
    Compare(CompareArgs),
    Advise(AdviseArgs),
    Bench(BenchArgs),
    Sweep(SweepArgs),
    Techniques(TechniquesArgs),
    Scenes(ScenesArgs),
    Doctor(DoctorArgs),
    Reproduce(ReproduceArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Lists techniques, their uses and failures; with a name, its parameters with units, ranges and defaults
#[derive(Debug, Args)]
#[command(after_help = techniques_help())]
pub struct TechniquesArgs {
    /// Name of a technique
    #[arg(value_name = "NAME", value_parser = values::kind)]
    pub name: Option<TechniqueKind>,
    /// Prints JSON: every technique, or the named one, with parameters and qualities
    #[arg(long)]
    pub json: bool,
}

/// Lists the built-in scenes, or writes one as glTF
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra scenes
  antumbra scenes --export knot?triangles=100000 -o knot.glb
  antumbra scenes --export overlap -o overlap.gltf")]
pub struct ScenesArgs {
    /// Built-in scene to write
    #[arg(long, value_name = "NAME", requires = "output")]
    pub export: Option<String>,
    /// File to write: .glb, or .gltf with its buffer inside
    #[arg(short, long, value_name = "x.glb", requires = "export")]
    pub output: Option<PathBuf>,
    /// Prints the list as JSON
    #[arg(long, conflicts_with = "export")]
    pub json: bool,
}

/// Lists adapters, features and limits, and what each technique needs that is missing
#[derive(Debug, Args)]
pub struct DoctorArgs {
    #[command(flatten)]
    pub adapter: AdapterArgs,
    /// Prints JSON
    #[arg(long)]
    pub json: bool,
}

/// Prints completions for a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra completions bash > ~/.local/share/bash-completion/completions/antumbra
  antumbra completions zsh > \"${fpath[1]}/_antumbra\"
  antumbra completions fish > ~/.config/fish/completions/antumbra.fish")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL", value_enum, ignore_case = true)]
    pub shell: clap_complete::Shell,
}

/// Writes manual pages, one for each command
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra man -o ~/.local/share/man/man1        then: man antumbra-compare")]
pub struct ManArgs {
    /// Folder to write to; created if it does not exist
    #[arg(short, long, value_name = "man1")]
    pub output: PathBuf,
}
