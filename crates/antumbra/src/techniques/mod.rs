//! The techniques, one folder each with the same files in the same order: `mod.rs` (what, why, source, limits,
//! phases), `params.rs`, `gpu_types.rs`, the shaders, `tests.rs`.

pub mod alias_free;
pub mod convolution;
pub mod cssm;
pub mod esm;
pub mod essm;
pub mod evsm;
pub mod evssm;
pub mod filterable;
pub mod hard;
pub mod lvsm;
pub(crate) mod map_resolve;
pub mod moment;
pub mod mssm;
pub mod multi_layer;
pub mod multi_view;
pub mod pcf;
pub mod pcss;
pub mod pcss_anisotropic;
pub mod reprojection;
pub mod reprojection_layered;
pub mod sample_based;
mod sample_views;
pub mod savsm;
mod soft_filter;
mod view_samples;
#[cfg(test)]
pub(crate) use view_samples::MOST_RUNS as VIEW_SAMPLES_MOST_RUNS;
pub mod vsm;
pub mod vssm;

mod kind;
mod technique;

pub use kind::TechniqueKind;
pub use technique::Technique;

#[cfg(test)]
pub(crate) mod tests;
