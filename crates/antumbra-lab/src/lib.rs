//! The laboratory of Antumbra compares shadow techniques with ray-traced ground truth and reports the results.
//!
//! Modules, in the order of the data flow:
//!
//! - [`picture`] — images and visibility masks: plain data on the CPU.
//! - [`metrics`] — errors of a visibility mask, as the project's file formats define them.
//! - [`color_maps`] — signed errors and magnitudes as colours.
//! - [`image_io`] — reading and writing of PNG and OpenEXR.
//! - [`output_files`] — files and folders that appear completely or not at all.
//! - [`report`] — a folder for a browser: images, errors, times, and the command that reproduces them.
//!
//! None of these uses the GPU. These do:
//!
//! - [`device`] — the adapter, and a device that records errors.
//! - [`gpu_scene`] — a scene on the GPU: re-exported from `antumbra-render`, as is [`picture`].
//! - [`receivers`], [`shading`] — that crate's passes, with waiting for their results.
//! - [`readback`] — copies of textures on the CPU.
//! - [`irradiance`] — irradiance of surfaces: traced, and by the image's shader.
//!
//! And these implement the commands:
//!
//! - [`truth`] — ground truth of every light of a setup.
//! - [`scene_facts`] — properties of a scene that matter for shadows.
//! - [`technique_run`] — one technique on one view for one light, timed once frame times have settled (`stopwatch`).
//! - [`view`] — a scene seen by one camera, ready for techniques.
//! - [`compare`] — techniques against the ground truth, as a report.
//! - [`motion`] — techniques while camera, light or a caster moves.
//! - [`bench`](mod@bench) — scenes × sizes × techniques.
//! - [`suite`] — all measurements of BENCHMARKS, in slices.
//! - [`advise`](mod@advise) — the best technique and settings for a scene and a budget.
//! - [`preset`] — files with a technique and its parameters.
//! - [`sweep`] — scenes × sizes × settings as jobs in files, for many machines.
//! - [`reproduce`] — the papers' tables and figures beside ours.
//! - [`limits`], [`identity`] — when a run ends, and which file it may resume: shared by all of these.
//! - [`baseline`], [`share`] — comparison with results of another adapter.
//! - [`progress`], [`error`] — progress messages and errors.

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
