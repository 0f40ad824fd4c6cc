//! The techniques, by family: a folder holds the passes that its members share, and a folder each for the members. These have
//! the same files in the same order: `mod.rs` (what, why, source, limits, phases), `params.rs`, `gpu_types.rs`, the shaders,
//! `tests.rs`. A family is a feature of the crate: a host compiles those that it uses.

#[cfg(feature = "filterable")]
pub mod filterable;
#[cfg(feature = "light_views")]
pub mod light_views;
#[cfg(feature = "multi_layer")]
pub mod multi_layer;
#[cfg(feature = "ray_traced")]
pub mod ray_traced;
#[cfg(feature = "receiver_lists")]
pub mod receiver_lists;
#[cfg(feature = "single_map")]
pub mod single_map;
#[cfg(feature = "summed")]
pub mod summed;

pub(crate) mod technique;

pub use crate::light_partition::Coverage;
pub use technique::Technique;

#[cfg(test)]
pub(crate) mod tests;
