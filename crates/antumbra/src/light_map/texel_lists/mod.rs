//! Every fragment of casters from a light's view, in lists: one a texel, sorted by depth, tightly packed.
//!
//! Two ways to gather, as Selgrad, Dachsbacher, Meyer and Stamminger 2014 (section 7) measure them: *arrays* count each
//! texel's fragments in one pass over the geometry, turn counts into places by a prefix sum, and collect in a second
//! pass; *linked* lists (Yang et al. 2010) take one pass over the geometry and are packed after. Both end in the same
//! arrays, which can be searched by halving.
//!
//! A fragment is 8 bytes (`fragments.wesl`): depth along the axis in metres, and opacity, of one channel or of three.
//! A list's entry is 8 bytes: first fragment, count. Closed opaque meshes leave their back faces alone, which for what
//! lies outside of them stop the same light; other surfaces leave every face.
//!
//! With four samples a texel, a fragment's opacity counts the share of the texel that its surface covers. The parts of a
//! surface that meet in a texel become one fragment again, and so do the two sides of a thin thing: of what lies near
//! in depth, each sample stops what its nearest stops.
//!
//! Where `capacity` is too small, the fragments that come last are left out, and [`TexelLists::counters`] say how many
//! there were.

use std::sync::Arc;

use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::contract::{MeshCaster, Opacity, SurfaceTexture};
use crate::gpu::{
    Bindings, Cached, DrawPipeline, Gpu, Lease, NoDepth, Recorder, Scratch, Span, Stage, bindings, compute_entry,
    create_uniform, gpu_structs, samples, texels, white_texture, write_uniform,
};
use crate::light_map::caster_depth::{Bound, INSTANCES, POSITIONS, UVS, ViewSides, caster_primitives, make_no_uvs};
use crate::light_map::caster_surface::SurfaceValues;
use crate::light_map::light_view::LightView;
use crate::primitives::prefix_scan::PrefixScan;
use crate::shaders;

#[cfg(test)]
pub(crate) mod cpu;
#[cfg(test)]
pub(crate) mod tests;

gpu_structs! {
    /// The view of `raster.wesl`.
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

    /// A surface that lets some light through.
    pub(crate) struct ListSurface {
        /// This, `cutoff` and `coverage`: [`SurfaceValues`].
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
    struct Gathered = "list raster", FRAGMENT, group 0 of [TEXEL_LISTS_RASTER] {
        0 list_view: Uniform in VERTEX_FRAGMENT,
        1 cursors: ReadWrite,
        /// Those that are to be linked have their own.
        2 fragments: ReadWrite,
        3 counters: ReadWrite,
        4 links: ReadWrite,
    }

    struct Triangles = "list triangles", VERTEX, group 1 of [TEXEL_LISTS_RASTER] {
        0 caster_positions: Storage,
        1 caster_indices: Storage,
    }

    /// Levels that a texture lacks are its first.
    struct Surface = "list surface", FRAGMENT, group 2 of [TEXEL_LISTS_RASTER] {
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

    struct Sorted = "list sort", COMPUTE, group 0 of [TEXEL_LISTS_SORT] {
        0 list_sort: Uniform,
        1 cursors: Storage,
        2 fragments: ReadWrite,
        3 lists: ReadWrite,
        4 counters: ReadWrite,
        5 nodes: Storage,
        6 links: Storage,
    }
}

/// Bytes of a fragment, and of a list's entry.
pub(crate) const FRAGMENT_BYTES: u64 = 8;

/// Samples of a texel where coverage counts: as many as every device has.
pub(crate) const COVERAGE_SAMPLES: u32 = 4;

/// Threads along each side of a workgroup.
const TILE: u32 = 8;

/// Mip levels of a mask that the fragment stage can reach.
const MIP_LEVELS: u32 = 7;

/// How opacities at one place come together; the numbers of `fragments.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accumulation {
    /// Their sum: they do not overlap.
    Add = 0,
    /// The product of transmittances: they overlap at random.
    Multiply = 1,
    /// The largest: they cover one another.
    Max = 2,
}

/// A distance in depth: `slope · z + m`, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DepthTolerance {
    /// For perspective views.
    pub(crate) slope: f32,
    /// For orthographic views.
    pub(crate) m: f32,
}

/// How the fragments come into their lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gather {
    /// Count, scan, collect.
    Arrays,
    /// Link, pack.
    Linked,
}

/// What lists to make.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ListOptions {
    /// Texels along each side.
    pub(crate) map_size: UVec2,
    /// Texels that a map has at most, whatever its sides: there is room for as many.
    pub(crate) most_texels: u32,
    /// Fragments to have room for.
    pub(crate) capacity: u32,
    /// Entries of [`TexelLists::lists`]: one a texel, and what the owner adds behind them.
    pub(crate) list_count: u32,
    /// Bytes of what the owner makes of the lists: they are the light's own where those are.
    pub(crate) owners_bytes: u64,
    /// Three channels of opacity.
    pub(crate) colored: bool,
    /// Fragments to keep of each list, from the nearest; 0 keeps all.
    pub(crate) layers: u32,
    /// Joins neighbours in a list that are at least this near, at their mean depth.
    pub(crate) join: Option<DepthTolerance>,
    /// Closed opaque meshes leave every face, too.
    pub(crate) all_faces: bool,
    /// How much farther than they are to store the fragments of surfaces that leave both faces, so that they do not
    /// shade themselves.
    pub(crate) open_offset: DepthTolerance,
    /// How joined opacities come together.
    pub(crate) accumulation: Accumulation,
    /// How to gather.
    pub(crate) gather: Gather,
    /// Samples of a texel, 1 or [`COVERAGE_SAMPLES`]: with those a fragment's opacity counts the share of the texel that
    /// it covers, where the caster is opaque and its buffers have the usage `STORAGE`.
    pub(crate) samples: u32,
    /// How near to one another fragments that cover different samples must be to count as one surface.
    pub(crate) adjoin: DepthTolerance,
}

/// What lists are sorted by: what is not asked for is no code at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SortDesign {
    gather: Gather,
    colored: bool,
    accumulation: Accumulation,
    joins: bool,
}

impl SortDesign {
    fn of(options: &ListOptions) -> Self {
        let ListOptions { gather, colored, accumulation, .. } = *options;
        Self { gather, colored, accumulation, joins: options.join.is_some() }
    }

    fn compiled(self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
        let entry = match self.gather {
            Gather::Arrays => "sort_lists",
            Gather::Linked => "pack_lists",
        };
        let constants = [
            ("COLORED", f64::from(u8::from(self.colored))),
            ("ACCUMULATION", f64::from(self.accumulation as u32)),
            ("JOINS", f64::from(u8::from(self.joins))),
        ];
        compute_entry(gpu, entry, shaders::TEXEL_LISTS_SORT, Some(entry), &constants, &[layout])
    }
}

/// Makes lists.
#[derive(Debug)]
pub(crate) struct TexelLists {
    raster_layout: wgpu::BindGroupLayout,
    surface_layout: wgpu::BindGroupLayout,
    sort_layout: wgpu::BindGroupLayout,
    covered_layout: wgpu::BindGroupLayout,
    /// By [`Pass`], how the caster is drawn, closed or not.
    rasters: [[[wgpu::RenderPipeline; 2]; 3]; 3],
    sort: Cached<SortDesign, wgpu::ComputePipeline>,
    scan: PrefixScan,
    view_uniform: wgpu::Buffer,
    sort_uniform: wgpu::Buffer,
    white: wgpu::TextureView,
    sampler: wgpu::Sampler,
    no_uvs: Option<wgpu::Buffer>,
    /// One a caster: its surface, or its triangles where they are drawn with coverage.
    caster_groups: Vec<(Draw, Option<wgpu::BindGroup>)>,
    /// One a caster.
    is_in_view: Vec<bool>,
    storage: Option<Storage>,
}

/// The lists of one frame, and the passes that fill them.
#[derive(Debug)]
pub(crate) struct PreparedLists {
    /// (first, count) of each texel's list, row by row, then the owner's.
    pub(crate) lists: Arc<wgpu::Buffer>,
    /// The fragments: `array<vec2u>`.
    pub(crate) fragments: Arc<wgpu::Buffer>,
    /// `ListCounters`: how many fragments the casters have, and where the room behind the stored ones begins.
    pub(crate) counters: Arc<wgpu::Buffer>,
    /// The right to the buffers, which those that the owner makes of them share.
    pub(crate) lease: Arc<Lease>,
    groups: BindGroups,
    sort: wgpu::ComputePipeline,
}

/// How a caster is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Draw {
    /// Opaque, a sample a texel.
    Opaque = 0,
    /// With its texture or colour, a sample a texel.
    Surface = 1,
    /// Opaque, with coverage.
    Covered = 2,
}

/// What a geometry pass does with a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    Count = 0,
    Collect = 1,
    Link = 2,
}

/// The buffers, for their sizes.
#[derive(Debug)]
struct Storage {
    options: ListOptions,
    lease: Arc<Lease>,
    cursors: Arc<wgpu::Buffer>,
    fragments: Arc<wgpu::Buffer>,
    lists: Arc<wgpu::Buffer>,
    counters: Arc<wgpu::Buffer>,
    /// Linked fragments and their links; of the least size for arrays.
    nodes: Arc<wgpu::Buffer>,
    links: Arc<wgpu::Buffer>,
    /// Of one sample, and of four.
    no_depth: NoDepth,
    no_covered_depth: Option<NoDepth>,
}

#[derive(Debug)]
struct BindGroups {
    raster: wgpu::BindGroup,
    sort: wgpu::BindGroup,
}

impl TexelLists {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let raster_layout = Gathered::layout(gpu);
        let covered_layout = Triangles::layout(gpu);
        let surface_layout = Surface::layout(gpu);
        let sort_layout = Sorted::layout(gpu);
        let layouts = [&raster_layout, &covered_layout, &surface_layout];
        Self {
            rasters: [Pass::Count, Pass::Collect, Pass::Link].map(|pass| {
                [Draw::Opaque, Draw::Surface, Draw::Covered]
                    .map(|draw| [false, true].map(|closed| raster_pipeline(gpu, layouts, pass, draw, closed)))
            }),
            sort: Cached::default(),
            scan: PrefixScan::new(gpu),
            raster_layout,
            covered_layout,
            surface_layout,
            sort_layout,
            view_uniform: create_uniform::<ListView>(gpu, "antumbra list view"),
            sort_uniform: create_uniform::<ListSort>(gpu, "antumbra list sort"),
            white: white_texture(gpu),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
            no_uvs: None,
            caster_groups: Vec::new(),
            is_in_view: Vec::new(),
            storage: None,
        }
    }

    /// Allocates and uploads. The buffers stay where neither the map's size nor the room needed grows.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        view: &LightView,
        casters: &[MeshCaster<'_>],
        options: &ListOptions,
    ) -> PreparedLists {
        if self.storage.as_ref().is_none_or(|storage| !storage.fits(options)) {
            // What it has goes back before more is taken.
            self.storage = None;
            self.storage = Some(Storage::new(stage, options));
        }
        let storage = self.storage.as_mut().expect("made above where it was missing");
        storage.options = *options;
        storage.widen(stage);
        write_uniform(stage, &self.view_uniform, &list_view(view, options, stage.anchor()));
        write_uniform(stage, &self.sort_uniform, &list_sort(options));
        let design = SortDesign::of(options);
        let sort = self.sort.get_or_make(design, || design.compiled(stage, &self.sort_layout)).clone();
        self.scan.prepare(stage, &storage.cursors, options.most_texels);
        let Storage { cursors, fragments, lists, counters, nodes, links, .. } = &*storage;
        let is_linked = options.gather == Gather::Linked;
        let gathered = if is_linked { nodes } else { fragments };
        let raster = Gathered { list_view: &self.view_uniform, cursors, fragments: gathered, counters, links };
        let sorted = Sorted { list_sort: &self.sort_uniform, cursors, fragments, lists, counters, nodes, links };
        let prepared = PreparedLists {
            lists: Arc::clone(lists),
            fragments: Arc::clone(fragments),
            counters: Arc::clone(counters),
            lease: Arc::clone(&storage.lease),
            groups: BindGroups {
                raster: raster.group(stage, &self.raster_layout),
                sort: sorted.group(stage, &self.sort_layout),
            },
            sort,
        };
        self.caster_groups = self.caster_groups(stage, casters, options.samples);
        let clip_from_world = view.clip_from_world();
        self.is_in_view.clear();
        let sides = ViewSides::of(&clip_from_world);
        self.is_in_view.extend(casters.iter().map(|caster| sides.may_hold(&caster.bounds)));
        make_no_uvs(stage, &mut self.no_uvs, casters);
        prepared
    }

    /// How each caster is drawn, and what that needs.
    fn caster_groups(
        &self,
        stage: &Stage<'_>,
        casters: &[MeshCaster<'_>],
        samples: u32,
    ) -> Vec<(Draw, Option<wgpu::BindGroup>)> {
        // Casters of a set have their triangles in the same buffers.
        let mut covered: Option<([&wgpu::Buffer; 2], wgpu::BindGroup)> = None;
        (casters.iter())
            .map(|caster| {
                let buffers = [caster.positions, caster.indices];
                let known = covered.as_ref().filter(|(of, _)| *of == buffers).map(|(_, group)| group);
                let (draw, group) = self.caster_group(stage, caster, samples, known);
                if let (Draw::Covered, Some(group)) = (draw, &group) {
                    covered = Some((buffers, group.clone()));
                }
                (draw, group)
            })
            .collect()
    }

    /// How a caster is drawn, and what that needs. Coverage needs triangles that shaders can read; `known` is the group of
    /// this caster's.
    fn caster_group(
        &self,
        stage: &Stage<'_>,
        caster: &MeshCaster<'_>,
        samples: u32,
        known: Option<&wgpu::BindGroup>,
    ) -> (Draw, Option<wgpu::BindGroup>) {
        if let Some(surface) = self.surface(stage, &caster.opacity) {
            return (Draw::Surface, Some(surface));
        }
        let buffers = [caster.positions, caster.indices];
        if samples == 1 || !buffers.iter().all(|buffer| buffer.usage().contains(wgpu::BufferUsages::STORAGE)) {
            return (Draw::Opaque, None);
        }
        let [caster_positions, caster_indices] = buffers;
        let make = || Triangles { caster_positions, caster_indices }.group(stage, &self.covered_layout);
        (Draw::Covered, Some(known.cloned().unwrap_or_else(make)))
    }

    fn surface(&self, stage: &Stage<'_>, opacity: &Opacity<'_>) -> Option<wgpu::BindGroup> {
        let SurfaceValues { factor, cutoff, coverage } = SurfaceValues::of(opacity)?;
        let texture = opacity.texture();
        let mips = texture.map_or_else(Vec::new, |texture| mip_views(stage, texture));
        let size_texels =
            texture.map_or(Vec2::ONE, |t| Vec2::new(t.view.texture().width() as f32, t.view.texture().height() as f32));
        let mip_count = 1 + mips.len() as u32;
        let surface = ListSurface { factor, size_texels, cutoff, coverage, mip_count, ..ListSurface::default() };
        let uniform = stage.uniform("antumbra list surface", &surface);
        let first = texture.map_or(&self.white, |t| t.view);
        let mip = |level: usize| mips.get(level - 1).unwrap_or(first);
        let surface = Surface {
            surface: &uniform,
            surface_sampler: texture.map_or(&self.sampler, |t| t.sampler),
            surface_texture: first,
            surface_mip_1: mip(1),
            surface_mip_2: mip(2),
            surface_mip_3: mip(3),
            surface_mip_4: mip(4),
            surface_mip_5: mip(5),
            surface_mip_6: mip(6),
        };
        Some(surface.group(stage, &self.surface_layout))
    }

    /// Records the passes that fill the lists: `count`, `scan`, `collect`, `sort`, or `link`, `sort`.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, casters: &[MeshCaster<'_>], prepared: &PreparedLists) {
        let Some(storage) = &self.storage else { return };
        recorder.clear_buffer(&storage.cursors);
        recorder.clear_buffer(&storage.counters);
        // Casters with coverage have their own pass, of more samples.
        let of_covered = |covered: bool| {
            self.caster_groups.iter().any(|(draw, _)| (*draw == Draw::Covered) == covered)
                && (!covered || storage.no_covered_depth.is_some())
        };
        let raster = |recorder: &mut Recorder<'_>, label, pass: Pass| {
            let parts: Vec<bool> = [false, true].into_iter().filter(|covered| of_covered(*covered)).collect();
            for (i, covered) in parts.iter().enumerate() {
                let no_depth = storage.no_covered_depth.as_ref().filter(|_| *covered).unwrap_or(&storage.no_depth);
                recorder.render_pass(label, Span::of(i, parts.len()), &[], no_depth.view(), None, |render| {
                    let UVec2 { x, y } = storage.options.map_size;
                    render.set_viewport(0.0, 0.0, x as f32, y as f32, 0.0, 1.0);
                    render.set_scissor_rect(0, 0, x, y);
                    render.set_bind_group(0, &prepared.groups.raster, &[]);
                    self.draw(render, storage, pass, *covered, casters);
                });
            }
        };
        let linked = storage.options.gather == Gather::Linked;
        if linked {
            raster(recorder, "link", Pass::Link);
        } else {
            raster(recorder, "count", Pass::Count);
            self.scan.record(recorder, "scan");
            raster(recorder, "collect", Pass::Collect);
        }
        recorder.compute("sort", Span::Only, |pass| {
            pass.set_pipeline(&prepared.sort);
            pass.set_bind_group(0, &prepared.groups.sort, &[]);
            let groups = storage.options.map_size.map(|texels| texels.div_ceil(TILE));
            pass.dispatch_workgroups(groups.x, groups.y, 1);
        });
    }

    fn draw(
        &self,
        render: &mut wgpu::RenderPass<'_>,
        storage: &Storage,
        pass: Pass,
        covered: bool,
        casters: &[MeshCaster<'_>],
    ) {
        let mut bound = Bound::default();
        let mut bound_group = None;
        for ((caster, (draw, group)), is_in_view) in casters.iter().zip(&self.caster_groups).zip(&self.is_in_view) {
            let is_empty = caster.index_count == 0 || caster.instance_count == 0;
            if is_empty || !is_in_view || covered != (*draw == Draw::Covered) {
                continue;
            }
            let closed = caster.closed && *draw != Draw::Surface && !storage.options.all_faces;
            bound.pipeline(render, &self.rasters[pass as usize][*draw as usize][usize::from(closed)]);
            if covered {
                if bound_group.replace(group) != Some(group) {
                    render.set_bind_group(1, group, &[]);
                }
                bound.vertices(render, 0, caster.instances);
                render.draw(caster.index_range(), caster.instance_range());
                continue;
            }
            bound.vertices(render, 0, caster.instances);
            bound.vertices(render, 1, caster.positions);
            if *draw == Draw::Surface {
                render.set_bind_group(2, group, &[]);
                let uvs = match caster.opacity.texture() {
                    Some(texture) => texture.uvs,
                    _ => self.no_uvs.as_ref().expect("made by prepare for casters like this"),
                };
                bound.vertices(render, 2, uvs);
            }
            bound.indices(render, caster.indices);
            render.draw_indexed(caster.index_range(), 0, caster.instance_range());
        }
    }

    /// Bytes of all buffers that are the light's own.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.storage.as_ref().map_or(0, |storage| storage.lease.own_bytes() + self.scan.memory_bytes())
    }
}

impl Storage {
    fn new(gpu: &Gpu, options: &ListOptions) -> Self {
        let texels = u64::from(options.most_texels);
        let node_count = if options.gather == Gather::Linked { u64::from(options.capacity) } else { 0 };
        let limits = gpu.device.limits();
        let most_bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let bytes = [
            texels * 4,
            u64::from(options.capacity) * FRAGMENT_BYTES,
            // Levels have a few more or fewer lists as the map's sides change.
            (u64::from(options.list_count) * FRAGMENT_BYTES * 5 / 4).next_multiple_of(FRAGMENT_BYTES).min(most_bytes),
            8,
            node_count * FRAGMENT_BYTES,
            node_count * 4,
        ];
        let lease = Arc::new(Lease::new(&gpu.device, bytes.iter().sum::<u64>() + options.owners_bytes));
        // Lights share buffers of a few sizes.
        let rounded = |bytes: u64| if lease.is_own() { bytes } else { bytes.next_power_of_two().min(most_bytes) };
        let buffer = |scratch, label, bytes: u64| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            let descriptor = wgpu::BufferDescriptor {
                label: Some(label),
                size: rounded(bytes).max(16),
                usage,
                mapped_at_creation: false,
            };
            lease.buffer(&gpu.device, scratch, &descriptor)
        };
        let no_depth = |sample_count| NoDepth::at_least(gpu, options.map_size, sample_count);
        let [cursors, fragments, lists, counters, nodes, links] = bytes;
        Self {
            options: *options,
            cursors: buffer(Scratch::ListCursors, "antumbra list cursors", cursors),
            fragments: buffer(Scratch::ListFragments, "antumbra fragments", fragments),
            lists: buffer(Scratch::Lists, "antumbra lists", lists),
            counters: buffer(Scratch::ListCounters, "antumbra list counters", counters),
            nodes: buffer(Scratch::LinkedFragments, "antumbra linked fragments", nodes),
            links: buffer(Scratch::Links, "antumbra links", links),
            no_depth: no_depth(1),
            no_covered_depth: (options.samples > 1).then(|| no_depth(options.samples)),
            lease,
        }
    }

    /// Whether other options can use these buffers.
    fn fits(&self, options: &ListOptions) -> bool {
        self.options.most_texels == options.most_texels
            && self.options.gather == options.gather
            && self.options.samples == options.samples
            && self.options.capacity == options.capacity
            && self.options.owners_bytes == options.owners_bytes
            && self.lists.size() >= u64::from(options.list_count) * FRAGMENT_BYTES
    }

    /// Makes attachments wide and high enough for the options' map.
    fn widen(&mut self, gpu: &Gpu) {
        for no_depth in std::iter::once(&mut self.no_depth).chain(&mut self.no_covered_depth) {
            let needed = no_depth.size().max(self.options.map_size);
            if needed != no_depth.size() {
                *no_depth = NoDepth::at_least(gpu, needed, no_depth.sample_count());
            }
        }
    }
}

/// The texture's mip levels from 1, a view each. Only where the host's view is of the whole plain texture: there the
/// levels are the view's.
fn mip_views(stage: &Stage<'_>, texture: &SurfaceTexture<'_>) -> Vec<wgpu::TextureView> {
    let whole = texture.view.texture();
    if whole.dimension() != wgpu::TextureDimension::D2 || whole.depth_or_array_layers() != 1 {
        return Vec::new();
    }
    (1..whole.mip_level_count().min(MIP_LEVELS))
        .map(|level| {
            stage.create_view(
                whole,
                &wgpu::TextureViewDescriptor {
                    base_mip_level: level,
                    mip_level_count: Some(1),
                    ..wgpu::TextureViewDescriptor::default()
                },
            )
        })
        .collect()
}

fn list_view(view: &LightView, options: &ListOptions, anchor_in_world: Vec3) -> ListView {
    ListView {
        clip_from_world: view.clip_from_world(),
        origin_in_world: view.frame.center,
        capacity: options.capacity,
        axis_in_world: view.frame.axis,
        colored: options.colored.into(),
        map_size: options.map_size,
        open_slope: options.open_offset.slope,
        open_m: options.open_offset.m,
        near_m: view.near_m,
        far_m: view.far_m,
        anchor_in_world,
        ..ListView::default()
    }
}

fn list_sort(options: &ListOptions) -> ListSort {
    let join = options.join.unwrap_or_default();
    ListSort {
        map_size: options.map_size,
        capacity: options.capacity,
        layers: options.layers,
        join_slope: join.slope,
        join_m: join.m,
        adjoin_slope: options.adjoin.slope,
        adjoin_m: options.adjoin.m,
    }
}

/// `layouts` are of groups 0, 1 and 2.
fn raster_pipeline(
    gpu: &Gpu,
    layouts: [&wgpu::BindGroupLayout; 3],
    pass: Pass,
    draw: Draw,
    closed: bool,
) -> wgpu::RenderPipeline {
    let [raster, covered, surface] = layouts.map(Some);
    let (layouts, vertex_buffers): (&[_], &[_]) = match draw {
        Draw::Opaque => (&[raster], &[Some(INSTANCES), Some(POSITIONS)]),
        Draw::Covered => (&[raster, covered], &[Some(INSTANCES)]),
        Draw::Surface => (&[raster, None, surface], &[Some(INSTANCES), Some(POSITIONS), Some(UVS)]),
    };
    let vertex = match (draw, closed) {
        (Draw::Surface, _) => "vertex_surface",
        (Draw::Opaque, true) => "vertex_closed",
        (Draw::Opaque, false) => "vertex_open",
        (Draw::Covered, true) => "vertex_covered_closed",
        (Draw::Covered, false) => "vertex_covered_open",
    };
    let fragment = match (pass, draw) {
        (Pass::Count, Draw::Opaque) => "count_opaque",
        (Pass::Count, Draw::Surface) => "count_surface",
        (Pass::Count, Draw::Covered) => "count_covered",
        (Pass::Collect, Draw::Opaque) => "collect_opaque",
        (Pass::Collect, Draw::Surface) => "collect_surface",
        (Pass::Collect, Draw::Covered) => "collect_covered",
        (Pass::Link, Draw::Opaque) => "link_opaque",
        (Pass::Link, Draw::Surface) => "link_surface",
        (Pass::Link, Draw::Covered) => "link_covered",
    };
    DrawPipeline {
        label: "antumbra list raster",
        wgsl: shaders::TEXEL_LISTS_RASTER,
        layouts,
        vertex,
        vertex_buffers,
        fragment: Some(fragment),
        // Counter-clockwise from outside: what is left is what faces away from the light.
        primitive: caster_primitives(gpu, closed.then_some(wgpu::Face::Front)),
        depth: Some(NoDepth::state()),
        sample_count: if draw == Draw::Covered { COVERAGE_SAMPLES } else { 1 },
        ..DrawPipeline::default()
    }
    .create(gpu)
}
