//! Building blocks independent of light and shadow, each tested against a CPU reference.

#[cfg(test)]
pub(crate) mod depth_basis;
#[cfg(feature = "filterable")]
pub(crate) mod lloyd;
#[cfg(feature = "filterable")]
pub(crate) mod packed_map;
#[cfg(any(feature = "multi_layer", feature = "ray_traced", feature = "receiver_lists"))]
pub(crate) mod prefix_scan;
#[cfg(test)]
mod stochastic;
