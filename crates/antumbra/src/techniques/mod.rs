//! The techniques, one folder each with the same files in the same order: `mod.rs` (what, why, source, limits,
//! phases), `params.rs`, `gpu_types.rs`, the shaders, `tests.rs`.

pub mod alias_free;
pub mod convolution;
pub mod esm;
pub mod evsm;
pub mod filterable;
pub mod hard;
pub mod lvsm;
pub(crate) mod map_resolve;
pub mod moment;
pub mod multi_layer;
pub mod multi_view;
pub mod pcf;
pub mod pcss;
pub mod reprojection;
pub mod reprojection_layered;
pub mod sample_based;
mod sample_views;
mod view_samples;
pub mod vsm;

#[cfg(test)]
pub(crate) mod tests;
