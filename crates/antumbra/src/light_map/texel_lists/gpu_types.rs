//! Uniforms and bind groups that Rust and the shaders of lists share.

use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::gpu::{bindings, gpu_structs, samples, texels};

gpu_structs! {
    /// View parameters of `raster.wesl`.
    pub(crate) struct ListView {
        clip_from_world: Mat4,
        origin_in_world: Vec3,
        capacity: u32,
        axis_in_world: Vec3,
        colored: u32,
        map_size: UVec2,
        open_slope: f32,
        open_m: f32,
        near_m: f32,
        far_m: f32,
        padding_0: u32,
        padding_1: u32,
        anchor_in_world: Vec3,
        padding_2: u32,
    }

    /// Parameters of a surface that lets some light through.
    pub(crate) struct ListSurface {
        /// Factor of the surface; this, `cutoff` and `coverage` are [`SurfaceValues`].
        factor: Vec4,
        size_texels: Vec2,
        cutoff: f32,
        coverage: u32,
        mip_count: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }

    /// Parameters of `sort.wesl`.
    pub(crate) struct ListSort {
        map_size: UVec2,
        capacity: u32,
        layers: u32,
        join_slope: f32,
        join_m: f32,
        adjoin_slope: f32,
        adjoin_m: f32,
    }
}

bindings! {
    pub(super) struct Gathered = "list raster", FRAGMENT, group 0 of [TEXEL_LISTS_RASTER] {
        0 list_view: Uniform in VERTEX_FRAGMENT,
        1 cursors: ReadWrite,
        /// Fragments of arrays; linked lists have a buffer of their own.
        2 fragments: ReadWrite,
        3 counters: ReadWrite,
        4 links: ReadWrite,
    }

    pub(super) struct Triangles = "list triangles", VERTEX, group 1 of [TEXEL_LISTS_RASTER] {
        0 caster_positions: Storage,
        1 caster_indices: Storage,
    }

    /// Surface of a caster. In place of mip levels that a texture lacks, its first one is bound.
    pub(super) struct Surface = "list surface", FRAGMENT, group 2 of [TEXEL_LISTS_RASTER] {
        0 surface: Uniform,
        1 surface_sampler: Sampler(samples::FILTERS),
        2 surface_texture: Texture(texels::FILTERED),
        3 surface_mip_1: Texture(texels::FILTERED),
        4 surface_mip_2: Texture(texels::FILTERED),
        5 surface_mip_3: Texture(texels::FILTERED),
        6 surface_mip_4: Texture(texels::FILTERED),
        7 surface_mip_5: Texture(texels::FILTERED),
        8 surface_mip_6: Texture(texels::FILTERED),
    }

    pub(super) struct Sorted = "list sort", COMPUTE, group 0 of [TEXEL_LISTS_SORT] {
        0 list_sort: Uniform,
        1 cursors: Storage,
        2 fragments: ReadWrite,
        3 lists: ReadWrite,
        4 counters: ReadWrite,
        5 nodes: Storage,
        6 links: Storage,
    }
}
