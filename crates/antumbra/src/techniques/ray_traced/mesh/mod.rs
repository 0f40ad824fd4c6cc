//! Bottom level: a tree over each mesh's triangles in object space, kept from frame to frame.
//!
//! A mesh's triangles are copied in the tree's order, so that a leaf's are adjacent and one pass reads meshes of any buffers. A triangle
//! takes 48 bytes (64 with texture coordinates) and 16 of nodes: less than twice the 36 of its corners.
//!
//! A mesh with a [`version`](MeshCaster::version) is built once, and refitted where its vertices changed. A mesh without one is refitted in
//! each frame: correct after any change, but with the hierarchy of its first frame.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use range_alloc::RangeAllocator;

use super::gpu_types::{Segment, SourceRange};
use super::tree::{FRAME_VECTORS, Forest, Level, TreePrograms};
use crate::contract::{Error, MeshCaster};
use crate::gpu::{
    Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, dispatch_threads, shared_constants,
};
use crate::shaders;

bindings! {
    struct Kept = "kept triangles", COMPUTE, group 0 of [MESH_GATHER, MESH_PLACE, MESH_RECALL] {
        0 shape: Uniform,
        1 segments: Storage,
        2 items: ReadWrite,
        3 order: ReadWrite,
        4 triangles: ReadWrite,
    }

    struct Source = "mesh source", COMPUTE, group 1 of [MESH_GATHER, MESH_PLACE] {
        0 source_range: Uniform,
        1 mesh_positions: Storage,
        2 mesh_indices: Storage,
        3 mesh_uvs: Storage,
    }
}

shared_constants! {
    /// Largest position that a leaf can encode.
    const FIRST_MASK: u32 = 0x1ff_ffff, as in RAY_TRACED_TRACE;
}

/// Size of a vector, the unit of nodes and triangles, bytes.
const VECTOR_BYTES: u64 = 16;

/// Position of a mesh's tree, in vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MeshPlace {
    /// Its box, then its nodes.
    pub(super) first_node: u32,
    pub(super) first_triangle: u32,
    pub(super) triangle_stride: u32,
}

/// Identity of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum MeshKey {
    /// Mesh with a version, with or without texture coordinates.
    Versioned { mesh: u64, has_uvs: bool },
    /// Mesh identified by its buffers.
    Buffers { positions: wgpu::Buffer, indices: wgpu::Buffer, uvs: Option<wgpu::Buffer>, first: u32, count: u32 },
}

impl MeshKey {
    fn of(caster: &MeshCaster<'_>) -> Self {
        let uvs = caster.opacity.texture().map(|texture| texture.uvs);
        match caster.version {
            Some(version) => Self::Versioned { mesh: version.mesh, has_uvs: uvs.is_some() },
            None => Self::Buffers {
                positions: caster.positions.clone(),
                indices: caster.indices.clone(),
                uvs: uvs.cloned(),
                first: caster.first_triangle,
                count: caster.index_count,
            },
        }
    }
}

#[derive(Debug)]
struct KeptMesh {
    nodes: Range<u64>,
    triangles: Range<u64>,
    triangle_count: u32,
    triangle_stride: u32,
    /// Version of the vertices that the boxes contain.
    vertices: Option<u64>,
    /// Last frame that used the mesh.
    frame: u64,
}

impl KeptMesh {
    fn place(&self) -> MeshPlace {
        MeshPlace {
            first_node: self.nodes.start as u32,
            first_triangle: self.triangles.start as u32,
            triangle_stride: self.triangle_stride,
        }
    }
}

/// Pipelines of the passes over meshes.
#[derive(Debug)]
struct Programs {
    kept_layout: wgpu::BindGroupLayout,
    source_layout: wgpu::BindGroupLayout,
    gather: wgpu::ComputePipeline,
    place: wgpu::ComputePipeline,
    recall: wgpu::ComputePipeline,
}

/// Trees of meshes.
#[derive(Debug)]
pub(super) struct Meshes {
    programs: Programs,
    kept: HashMap<MeshKey, KeptMesh>,
    frame: u64,
    nodes: Room,
    triangles: Room,
    made: Option<Work>,
    fitted: Option<Work>,
}

/// Buffer of vectors, and which of them are allocated.
#[derive(Debug)]
struct Room {
    label: &'static str,
    buffer: Option<wgpu::Buffer>,
    ranges: RangeAllocator<u64>,
}

/// Trees that are built, or refitted, in a frame.
#[derive(Debug)]
struct Work {
    forest: Forest,
    kept: wgpu::BindGroup,
    sources: Vec<(wgpu::BindGroup, u32)>,
}

impl Room {
    fn new(label: &'static str) -> Self {
        Self { label, buffer: None, ranges: RangeAllocator::new(0..0) }
    }

    /// Discards the content and allocates space for `vectors`, at most what a binding can hold.
    fn renew(&mut self, gpu: &Gpu, vectors: u64) {
        self.ranges = RangeAllocator::new(0..vectors);
        self.buffer = Some(gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(self.label),
            size: VECTOR_BYTES * vectors,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        }));
    }

    fn buffer(&self) -> &wgpu::Buffer {
        self.buffer.as_ref().expect("prepare comes before use")
    }
}

/// Mesh that a frame uses, and one of its casters.
struct Asked<'a, 'c> {
    key: MeshKey,
    caster: &'a MeshCaster<'c>,
}

impl Asked<'_, '_> {
    fn triangle_count(&self) -> u32 {
        self.caster.index_count / 3
    }

    fn triangle_stride(&self) -> u32 {
        if self.caster.opacity.texture().is_some() { 4 } else { 3 }
    }

    /// Returns the number of vectors for nodes and for triangles.
    fn vectors(&self) -> [u64; 2] {
        let count = u64::from(self.triangle_count());
        [count + u64::from(FRAME_VECTORS), count * u64::from(self.triangle_stride())]
    }
}

impl Meshes {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let (kept, source) = (Kept::layout(gpu), Source::layout(gpu));
        let program = |wgsl, layouts: &[&wgpu::BindGroupLayout]| compute_pipeline(gpu, "kept triangles", wgsl, layouts);
        Self {
            programs: Programs {
                gather: program(shaders::MESH_GATHER, &[&kept, &source]),
                place: program(shaders::MESH_PLACE, &[&kept, &source]),
                recall: program(shaders::MESH_RECALL, &[&kept]),
                kept_layout: kept,
                source_layout: source,
            },
            kept: HashMap::new(),
            frame: 0,
            nodes: Room::new("antumbra mesh nodes"),
            triangles: Room::new("antumbra mesh triangles"),
            made: None,
            fitted: None,
        }
    }

    /// Prepares the meshes of casters with at least one triangle each. Returns the position of each caster's mesh.
    #[expect(clippy::mutable_key_type, reason = "a buffer is hashed by which one it is, and that never changes")]
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        trees: &TreePrograms,
        technique: &'static str,
        casters: &[&MeshCaster<'_>],
    ) -> Result<Vec<MeshPlace>, Error> {
        self.frame += 1;
        let keys: Vec<MeshKey> = casters.iter().map(|caster| MeshKey::of(caster)).collect();
        let mut asked: Vec<Asked<'_, '_>> = Vec::new();
        let mut is_asked = HashSet::new();
        for (key, caster) in keys.iter().zip(casters) {
            if is_asked.insert(key) {
                asked.push(Asked { key: key.clone(), caster });
            }
        }
        for mesh in &asked {
            if let Some(kept) = self.kept.get_mut(&mesh.key) {
                // A different size means a different mesh, whatever its version.
                let is_it = kept.triangle_count == mesh.triangle_count();
                kept.frame = if is_it { self.frame } else { 0 };
            }
        }
        let frame = self.frame;
        let is_here = |kept: &HashMap<MeshKey, KeptMesh>, mesh: &Asked<'_, '_>| {
            kept.get(&mesh.key).is_some_and(|kept| kept.frame == frame)
        };
        let mut to_make: Vec<&Asked<'_, '_>> = asked.iter().filter(|mesh| !is_here(&self.kept, mesh)).collect();
        if !(self.nodes.buffer.is_some() && to_make.iter().all(|mesh| self.take(mesh))) {
            self.renew(stage, technique, &asked)?;
            to_make = asked.iter().collect();
        }
        let made: HashSet<&MeshKey> = to_make.iter().map(|mesh| &mesh.key).collect();
        let mut to_fit: Vec<&Asked<'_, '_>> = Vec::new();
        for mesh in &asked {
            let vertices = mesh.caster.version.map(|version| version.vertices);
            let kept = self.kept.get_mut(&mesh.key).expect("made room for above");
            if !made.contains(&mesh.key) && (vertices.is_none() || kept.vertices != vertices) {
                to_fit.push(mesh);
            }
            kept.vertices = vertices;
        }
        self.made = self.work(stage, trees, true, &to_make);
        self.fitted = self.work(stage, trees, false, &to_fit);
        Ok(keys.iter().map(|key| self.kept[key].place()).collect())
    }

    /// Allocates space for a mesh, replacing meshes that the frame does not use if necessary. Returns whether there is space.
    fn take(&mut self, mesh: &Asked<'_, '_>) -> bool {
        if let Some(old) = self.kept.remove(&mesh.key) {
            self.give_back(&old);
        }
        let taken = self.try_take(mesh).or_else(|| {
            let frame = self.frame;
            let gone: Vec<KeptMesh> =
                self.kept.extract_if(|_, kept| kept.frame != frame).map(|(_, kept)| kept).collect();
            gone.iter().for_each(|kept| self.give_back(kept));
            self.try_take(mesh)
        });
        let Some([nodes, triangles]) = taken else { return false };
        let (triangle_count, triangle_stride, frame) = (mesh.triangle_count(), mesh.triangle_stride(), self.frame);
        let kept = KeptMesh { nodes, triangles, triangle_count, triangle_stride, vertices: None, frame };
        self.kept.insert(mesh.key.clone(), kept);
        true
    }

    fn try_take(&mut self, mesh: &Asked<'_, '_>) -> Option<[Range<u64>; 2]> {
        let [nodes, triangles] = mesh.vectors();
        let nodes = self.nodes.ranges.allocate_range(nodes).ok()?;
        match self.triangles.ranges.allocate_range(triangles) {
            Ok(triangles) => Some([nodes, triangles]),
            Err(_) => {
                self.nodes.ranges.free_range(nodes);
                None
            }
        }
    }

    fn give_back(&mut self, kept: &KeptMesh) {
        self.nodes.ranges.free_range(kept.nodes.clone());
        self.triangles.ranges.free_range(kept.triangles.clone());
    }

    /// Allocates space for all meshes of a frame if it is too small: exactly at first, with half as much again later.
    fn renew(&mut self, stage: &Stage<'_>, technique: &'static str, asked: &[Asked<'_, '_>]) -> Result<(), Error> {
        if let Some(mesh) = asked.iter().find(|mesh| mesh.triangle_count() > FIRST_MASK) {
            return Err(Error::Unsupported {
                technique,
                needed: format!("a tree over a mesh of {} triangles", mesh.triangle_count()),
                had: format!("trees over at most {FIRST_MASK}"),
                remedy: "cut the mesh into several",
            });
        }
        let is_first = self.nodes.buffer.is_none();
        let max_bytes = stage.device.limits().max_storage_buffer_binding_size;
        let needed =
            asked.iter().map(Asked::vectors).fold([0; 2], |[a, b], [nodes, triangles]| [a + nodes, b + triangles]);
        for (room, needed) in [&mut self.nodes, &mut self.triangles].into_iter().zip(needed) {
            if needed * VECTOR_BYTES > max_bytes {
                let count: u64 = asked.iter().map(|mesh| u64::from(mesh.triangle_count())).sum();
                return Err(Error::Unsupported {
                    technique,
                    needed: format!("{} bytes for the trees of {count} triangles", needed * VECTOR_BYTES),
                    had: format!("at most {max_bytes} bytes a binding"),
                    remedy: "cast with fewer or coarser meshes, or ask for a larger max_storage_buffer_binding_size",
                });
            }
            let with_more = if is_first { needed } else { needed + needed / 2 };
            room.renew(stage, with_more.min(max_bytes / VECTOR_BYTES).max(u64::from(FRAME_VECTORS)));
        }
        self.kept.clear();
        for mesh in asked {
            let is_taken = self.take(mesh);
            debug_assert!(is_taken, "there is room for all");
        }
        Ok(())
    }

    fn work(
        &mut self,
        stage: &Stage<'_>,
        trees: &TreePrograms,
        makes: bool,
        meshes: &[&Asked<'_, '_>],
    ) -> Option<Work> {
        let before = if makes { self.made.take() } else { self.fitted.take() };
        if meshes.is_empty() {
            return None;
        }
        let mut forest = before.map_or_else(|| Forest::new(stage), |work| work.forest);
        let segment = |mesh: &&Asked<'_, '_>| {
            let place = self.kept[&mesh.key].place();
            Segment {
                item_count: mesh.triangle_count(),
                first_node: place.first_node,
                first_triangle: place.first_triangle,
                triangle_stride: place.triangle_stride,
                source_triangle: mesh.caster.first_triangle,
                ..Segment::default()
            }
        };
        let mut segments: Vec<Segment> = meshes.iter().map(segment).collect();
        forest.prepare(stage, trees, Level::Triangles, makes, &mut segments, self.nodes.buffer());
        let (shape, table) = forest.shape();
        let kept = Kept {
            shape,
            segments: table,
            items: forest.items(),
            order: forest.order(),
            triangles: self.triangles.buffer(),
        };
        let kept = kept.group(stage, &self.programs.kept_layout);
        let mut sources = Vec::new();
        let mut first_item = 0;
        for meshes in meshes.chunk_by(|a, b| buffers_of(a.caster) == buffers_of(b.caster)) {
            let count: u32 = meshes.iter().map(|mesh| mesh.triangle_count()).sum();
            let range = SourceRange { first_item, end_item: first_item + count, ..SourceRange::default() };
            let (mesh_positions, mesh_indices, uvs) = buffers_of(meshes[0].caster);
            let source = Source {
                source_range: &stage.uniform("antumbra mesh source", &range),
                mesh_positions,
                mesh_indices,
                // A placeholder that no shader reads.
                mesh_uvs: uvs.unwrap_or(mesh_positions),
            };
            sources.push((source.group(stage, &self.programs.source_layout), count));
            first_item += count;
        }
        Some(Work { forest, kept, sources })
    }

    /// Records the builds and refits.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, trees: &TreePrograms) {
        let Programs { gather, place, recall, .. } = &self.programs;
        if let Some(work) = &self.made {
            work.forest.clear(recorder);
            recorder.compute("make mesh trees", Span::Only, |pass| {
                work.over_sources(pass, gather);
                work.forest.sort(pass, trees);
                work.over_sources(pass, place);
                work.forest.link(pass, trees);
                work.forest.fit(pass, trees);
            });
        }
        if let Some(work) = &self.fitted {
            recorder.compute("fit mesh trees", Span::Only, |pass| {
                pass.set_pipeline(recall);
                pass.set_bind_group(0, &work.kept, &[]);
                dispatch_threads(pass, work.forest.item_count());
                work.over_sources(pass, gather);
                work.over_sources(pass, place);
                work.forest.fit(pass, trees);
            });
        }
    }

    /// `array<vec4u>`: see `tree/nodes.wesl`.
    pub(super) fn nodes(&self) -> &wgpu::Buffer {
        self.nodes.buffer()
    }

    /// `array<vec4u>`: see `mesh/source.wesl`.
    pub(super) fn triangles(&self) -> &wgpu::Buffer {
        self.triangles.buffer()
    }

    /// Whether no tree was built or refitted in the last frame.
    #[cfg(test)]
    pub(super) fn is_idle(&self) -> bool {
        self.made.is_none() && self.fitted.is_none()
    }

    /// Size of the trees without the buffers for building them, bytes.
    pub(super) fn kept_bytes(&self) -> u64 {
        [&self.nodes, &self.triangles].into_iter().filter_map(|room| room.buffer.as_ref()).map(wgpu::Buffer::size).sum()
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        let work = [&self.made, &self.fitted].into_iter().flatten().map(|work| work.forest.memory_bytes()).sum::<u64>();
        self.kept_bytes() + work
    }
}

impl Work {
    fn over_sources(&self, pass: &mut wgpu::ComputePass<'_>, program: &wgpu::ComputePipeline) {
        pass.set_pipeline(program);
        pass.set_bind_group(0, &self.kept, &[]);
        for (group, triangles) in &self.sources {
            pass.set_bind_group(1, group, &[]);
            dispatch_threads(pass, *triangles);
        }
    }
}

/// Returns positions, indices and, for textured casters, texture coordinates.
fn buffers_of<'a>(mesh: &MeshCaster<'a>) -> (&'a wgpu::Buffer, &'a wgpu::Buffer, Option<&'a wgpu::Buffer>) {
    (mesh.positions, mesh.indices, mesh.opacity.texture().map(|texture| texture.uvs))
}
