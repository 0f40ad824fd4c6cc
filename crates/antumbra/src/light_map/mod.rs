//! A light's view of its casters, and the maps drawn in it: depth, layers of depth, lists, triangles.

pub(crate) mod caster_depth;
pub(crate) mod caster_surface;
#[cfg(any(feature = "light_views", feature = "receiver_lists"))]
pub(crate) mod caster_triangles;
pub(crate) mod central_view;
pub(crate) mod depth_layers;
pub(crate) mod depth_pyramid;
pub(crate) mod hosts_map;
pub(crate) mod light_spread;
pub(crate) mod light_view;
pub(crate) mod map;
pub(crate) mod map_texels;
pub(crate) mod occluding_bounds;
#[cfg(any(feature = "light_views", feature = "ray_traced", feature = "receiver_lists"))]
pub(crate) mod readable_meshes;
pub(crate) mod stable_fit;
pub(crate) mod swept_volume;
#[cfg(feature = "multi_layer")]
pub(crate) mod texel_lists;
