//! Building blocks: they know nothing of shadows. Each folder has its Rust side, its shaders and its tests.

pub(crate) mod accumulation;
pub(crate) mod caster_depth;
pub(crate) mod caster_triangles;
pub(crate) mod depth_basis;
pub(crate) mod depth_layers;
pub(crate) mod depth_pyramid;
pub(crate) mod frame_inputs;
pub(crate) mod light_view;
pub(crate) mod lloyd;
pub(crate) mod packed_map;
pub(crate) mod prefix_scan;
pub(crate) mod sparse_upsample;
#[allow(dead_code, reason = "recursive doubling is there to be measured against, by the tests")]
pub(crate) mod summed_area_table;
pub(crate) mod texel_lists;
