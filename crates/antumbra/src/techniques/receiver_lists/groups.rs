//! Bind groups of the passes.

use super::buffers::BufferSet;
use crate::gpu::{Bindings, Gpu, Stage, bindings, samples, texels};
use crate::light_map::caster_triangles::runs::RunBindings;

/// Format of the lookup table.
pub(super) const TABLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

bindings! {
    struct Cleared = "view-sample clear", COMPUTE, group 0 of [RECEIVER_LISTS_CLEAR] {
        0 items: ReadWrite,
    }

    struct Lists = "view-sample lists", COMPUTE,
        group 1 of [LISTS_BOUNDS, LISTS_COUNT, LISTS_CHOOSE, LISTS_SCATTER]
    {
        0 settings: Uniform,
        1 state: ReadWrite,
        2 counts: ReadWrite,
        3 places: ReadWrite,
        4 list: ReadWrite,
        5 shaft: ReadWrite,
        /// Box of all points.
        6 light_points: Storage,
        7 positions: ReadWrite,
        14 snapped_texels: Uniform,
    }

    struct Arguments = "view-sample arguments", COMPUTE, group 0 of [LISTS_ARGUMENTS] {
        0 settings: Uniform,
        1 counts: Storage,
        2 cells: Storage,
        3 totals: ReadWrite,
    }

    struct Passes = "view-sample passes", COMPUTE, group 0 of [EVALUATION_BEGIN, EVALUATION_ADVANCE] {
        0 totals: ReadWrite,
        1 dispatches: ReadWrite,
        2 work: ReadWrite,
    }

    struct SortedCasters = "view-sample casters", COMPUTE,
        group 0 of [TRIANGLES_COUNT, TRIANGLES_SCATTER, TRIANGLES_EDGE_FACES]
    {
        0 settings: Uniform,
        1 shaft: Uniform,
        2 cells: ReadWrite,
        3 triangle_places: ReadWrite,
        4 triangles: ReadWrite,
        5 edges: ReadWrite,
    }

    /// Runs of triangles in the same buffers.
    pub(super) struct Meshes = "view-sample mesh", COMPUTE,
        group 1 of [TRIANGLES_COUNT, TRIANGLES_SCATTER, TRIANGLES_EDGE_FACES],
        with runs: RunBindings
    {
        5 mesh_uvs: Storage,
    }

    struct Boxes = "view-sample boxes", COMPUTE,
        group 0 of [TRIANGLES_CLUSTER_BOXES, TRIANGLES_SUPER_BOXES]
    {
        0 settings: Uniform,
        1 totals: Storage,
        2 triangles: Storage,
        3 boxes: ReadWrite,
    }

    pub(super) struct Evaluated = "view-sample evaluate", COMPUTE,
        group 1 of [EVALUATION_EVALUATE, RASTER_OPEN_POINTS, RASTER_SUM_VISIBLE]
    {
        0 settings: Uniform,
        1 list: Storage,
        2 triangles: Storage,
        3 boxes: Storage,
        4 light_words: Uniform,
        5 bits: ReadWrite,
        6 totals: Storage,
        7 lookup: Texture3d(texels::UINT),
        8 work: ReadWrite,
        9 light_cells: Storage,
        14 snapped_texels: Uniform,
    }

    /// Surface of a batch, also for rasterised triangles.
    pub(super) struct Surface = "view-sample surface", COMPUTE | FRAGMENT,
        group 2 of [EVALUATION_EVALUATE, RASTER_DRAW, RASTER_DRAW_BY_LIGHT_PLANES]
    {
        0 surface: Uniform,
        1 surface_texture: Texture(texels::FILTERED),
        2 surface_sampler: Sampler(samples::FILTERS),
    }

    pub(super) struct MadeTable = "view-sample table", COMPUTE, group 0 of [LIGHT_BITS_MAKE_LOOKUP] {
        0 settings: Uniform,
        1 light_words: Uniform,
        2 table: WrittenTexture3d(TABLE_FORMAT),
    }

    pub(super) struct DrawArguments = "view-sample raster arguments", COMPUTE,
        group 0 of [RASTER_ARGUMENTS]
    {
        0 settings: Uniform,
        1 state: Storage,
        2 totals: Storage,
        3 draw: ReadWrite,
    }

    pub(super) struct RegionHulls = "view-sample region hulls", COMPUTE, group 1 of [RASTER_HULLS] {
        0 settings: Uniform,
        2 triangles: Storage,
        3 state: Storage,
        9 totals: Storage,
        12 hulls: ReadWrite,
        /// Ellipsoid that contains the light: centre and semi-axes.
        13 ellipsoid: Storage,
    }

    pub(super) struct Window = "view-sample raster", FRAGMENT,
        group 1 of [
            RASTER_DRAW, RASTER_DRAW_BY_LIGHT_PLANES, RASTER_SILHOUETTES, RASTER_STENCIL
        ]
    {
        0 settings: Uniform in VERTEX_FRAGMENT,
        1 list: Storage,
        2 triangles: Storage in VERTEX_FRAGMENT,
        3 state: Storage in VERTEX,
        4 light_words: Uniform,
        5 bits: ReadWrite,
        /// Start of each list.
        6 firsts: Storage,
        7 lookup: Texture3d(texels::UINT),
        8 work: ReadWrite,
        9 totals: Storage in VERTEX,
        /// Positions of the listed receivers, if lists store them.
        10 positions: Storage,
        /// Texels that penumbrae can reach.
        11 penumbrae: ReadWrite,
        /// Hulls of hexagons, if regions are made of these.
        12 hulls: Storage in VERTEX,
        14 snapped_texels: Uniform,
    }
}

#[derive(Debug)]
pub(super) struct Layouts {
    pub(super) clear: wgpu::BindGroupLayout,
    pub(super) lists: wgpu::BindGroupLayout,
    pub(super) arguments: wgpu::BindGroupLayout,
    pub(super) passes: wgpu::BindGroupLayout,
    pub(super) casters: wgpu::BindGroupLayout,
    pub(super) mesh: wgpu::BindGroupLayout,
    pub(super) boxes: wgpu::BindGroupLayout,
    pub(super) evaluate: wgpu::BindGroupLayout,
    pub(super) surface: wgpu::BindGroupLayout,
    pub(super) make_lookup: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            clear: Cleared::layout(gpu),
            lists: Lists::layout(gpu),
            arguments: Arguments::layout(gpu),
            passes: Passes::layout(gpu),
            casters: SortedCasters::layout(gpu),
            mesh: Meshes::layout(gpu),
            boxes: Boxes::layout(gpu),
            evaluate: Evaluated::layout(gpu),
            surface: Surface::layout(gpu),
            make_lookup: MadeTable::layout(gpu),
        }
    }
}

/// Creates the bind groups of a frame's buffers.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameGroups<'a> {
    pub(super) stage: &'a Stage<'a>,
    pub(super) layouts: &'a Layouts,
    pub(super) buffers: BufferSet<'a>,
}

impl FrameGroups<'_> {
    /// Returns the group that clears a buffer.
    pub(super) fn clear(&self, items: &wgpu::Buffer) -> wgpu::BindGroup {
        Cleared { items }.group(self.stage, &self.layouts.clear)
    }

    pub(super) fn lists(&self, settings: &wgpu::Buffer) -> wgpu::BindGroup {
        let BufferSet { state, counts, places, list, shaft, whole_light, positions, .. } = self.buffers;
        let (light_points, snapped_texels) = (whole_light, self.stage.snapped_texels());
        let lists = Lists { settings, state, counts, places, list, shaft, light_points, positions, snapped_texels };
        lists.group(self.stage, &self.layouts.lists)
    }

    pub(super) fn casters(&self, settings: &wgpu::Buffer) -> wgpu::BindGroup {
        let BufferSet { shaft, cells, triangle_places, triangles, edges, .. } = self.buffers;
        let casters = SortedCasters { settings, shaft, cells, triangle_places, triangles, edges };
        casters.group(self.stage, &self.layouts.casters)
    }

    pub(super) fn arguments(&self, settings: &wgpu::Buffer) -> wgpu::BindGroup {
        let BufferSet { counts, cells, totals, .. } = self.buffers;
        Arguments { settings, counts, cells, totals }.group(self.stage, &self.layouts.arguments)
    }

    pub(super) fn boxes(&self, settings: &wgpu::Buffer) -> wgpu::BindGroup {
        let BufferSet { totals, triangles, boxes, .. } = self.buffers;
        Boxes { settings, totals, triangles, boxes }.group(self.stage, &self.layouts.boxes)
    }

    pub(super) fn passes(&self) -> wgpu::BindGroup {
        let BufferSet { totals, dispatches, work, .. } = self.buffers;
        Passes { totals, dispatches, work }.group(self.stage, &self.layouts.passes)
    }
}
