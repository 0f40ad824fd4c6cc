//! The laboratory of Antumbra: it holds shadow techniques against ray-traced truth and says what it saw.
//!
//! The rooms, in the order in which data flows through them:
//!
//! - [`picture`] — what a picture and a visibility image are here; plain data on the CPU.
//! - [`metrics`] — how far a visibility image is from the truth, in the terms of the project's file formats.
//! - [`color_maps`] — signed errors and magnitudes as colours.
//! - [`image_io`] — PNG and OpenEXR, written and read.
//! - [`output_files`] — files and folders that appear whole or not at all.
//! - [`report`] — a folder that opens in a browser: pictures, numbers, milliseconds, and how to get them again.
//!
//! None of those knows the GPU. These do:
//!
//! - [`device`] — which adapter, and a device whose errors are kept.
//! - [`gpu_scene`] — a scene on the GPU: the room of that name in `antumbra-render`, as [`picture`] is.
//! - [`receivers`], [`shading`] — that crate's passes, waited for.
//! - [`readback`] — textures back on the CPU.
//! - [`irradiance`] — what a light gives surfaces: traced, and by the picture's own shader.
//!
//! And these are what the commands do:
//!
//! - [`truth`] — every light of a setup, traced.
//! - [`scene_facts`] — what a scene is like for shadows.
//! - [`technique_run`] — one technique on one view for one light, timed once frames are alike (`stopwatch`).
//! - [`view`] — a scene as one camera sees it, ready for techniques.
//! - [`compare`] — techniques against the truth, as a report.
//! - [`motion`] — techniques while camera, light or a caster moves.
//! - [`bench`](mod@bench) — scenes × sizes × techniques.
//! - [`suite`] — everything that BENCHMARKS shows, in slices.
//! - [`advise`](mod@advise) — which technique, with what settings, for a scene and a budget.
//! - [`preset`] — a technique with its parameters as a file.
//! - [`sweep`] — scenes × sizes × settings as jobs in files, for many machines.
//! - [`reproduce`] — the papers' tables and figures beside ours.
//! - [`limits`], [`identity`] — when a run ends, and which file it may resume: shared by all of these.
//! - [`baseline`], [`share`] — results beside those of another adapter.
//! - [`progress`], [`error`] — what they tell while they work, and when they cannot.

mod adapter_info;
pub mod advise;
mod antialiasing;
pub mod baseline;
pub mod bench;
pub mod color_maps;
pub mod compare;
pub mod cut_short;
mod date;
pub mod device;
pub mod error;
pub mod identity;
pub mod image_io;
pub mod irradiance;
pub mod limits;
pub mod metrics;
pub mod motion;
mod names;
pub mod output_files;
pub mod preset;
pub mod progress;
pub mod readback;
pub mod receivers;
pub mod report;
pub mod reproduce;
pub mod scene_facts;
pub mod shading;
pub mod share;
mod stopwatch;
mod store;
pub mod suite;
pub mod sweep;
pub mod technique_run;
#[cfg(test)]
mod test_support;
pub mod truth;
pub mod view;

pub use antumbra_render::{gpu_scene, picture};
