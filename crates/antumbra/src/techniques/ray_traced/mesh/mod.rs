//! The lower level: a tree over each mesh's triangles, in the mesh's own space, kept from frame to frame.
//!
//! A mesh's triangles are copied, in the tree's order, so that a leaf's lie side by side and meshes of any buffers are read in one pass.
//! A triangle takes 48 bytes of them (64 where a texture is asked for) and 16 of nodes: less than twice the 36 of its corners.
//!
//! A mesh that tells its [`version`](MeshCaster::version) is made once, and fitted anew where its vertices changed. One that does not is fitted
//! in each frame: right whatever has changed, but made for what it was at first.

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
    struct Kept = "kept triangles", COMPUTE, group 0 of [RAY_GATHER, RAY_PLACE, RAY_RECALL] {
        0 shape: Uniform,
        1 segments: Storage,
        2 items: ReadWrite,
        3 order: ReadWrite,
        4 triangles: ReadWrite,
    }

    struct Source = "mesh source", COMPUTE, group 1 of [RAY_GATHER, RAY_PLACE] {
        0 source_range: Uniform,
        1 mesh_positions: Storage,
        2 mesh_indices: Storage,
        3 mesh_uvs: Storage,
    }
}

shared_constants! {
    /// The last place that a leaf can name.
    const FIRST_MASK: u32 = 0x1ff_ffff, as in RAY_TRACE;
}

/// Bytes of a vector, of which nodes and triangles are made.
const VECTOR_BYTES: u64 = 16;

/// Where a mesh's tree is, in vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MeshPlace {
    /// Its box, then its nodes.
    pub(super) first_node: u32,
    pub(super) first_triangle: u32,
    pub(super) triangle_stride: u32,
}

/// What tells a mesh from others.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum MeshKey {
    /// That tells its version; with texture coordinates or without.
    Versioned { mesh: u64, has_uvs: bool },
    /// By where it lies.
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
    /// What its boxes are of.
    vertices: Option<u64>,
    /// The last frame that asked for it.
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

/// Programs of the passes over meshes.
#[derive(Debug)]
struct Programs {
    kept_layout: wgpu::BindGroupLayout,
    source_layout: wgpu::BindGroupLayout,
    gather: wgpu::ComputePipeline,
    place: wgpu::ComputePipeline,
    recall: wgpu::ComputePipeline,
}

/// Meshes' trees.
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

/// A buffer of vectors, and which of them are taken.
#[derive(Debug)]
struct Room {
    label: &'static str,
    buffer: Option<wgpu::Buffer>,
    ranges: RangeAllocator<u64>,
}

/// Trees that are made, or fitted, in a frame.
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

    /// Forgets what it holds; has room for so many vectors, which are no more than a binding holds.
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

/// A mesh that a frame asks for, and a caster of it.
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

    /// Vectors of nodes and of triangles.
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
                gather: program(shaders::RAY_GATHER, &[&kept, &source]),
                place: program(shaders::RAY_PLACE, &[&kept, &source]),
                recall: program(shaders::RAY_RECALL, &[&kept]),
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

    /// Makes ready for the meshes of some casters, which have triangles each: where each caster's is.
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
                // Of another size it is another mesh, whatever it says.
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

    /// Takes room for a mesh, in the place of those that the frame does not ask for if need be.
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

    /// Room for all that a frame asks for, where what there was is too small: just as much at first, and half as much again later.
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
        let most_bytes = stage.device.limits().max_storage_buffer_binding_size;
        let needed =
            asked.iter().map(Asked::vectors).fold([0; 2], |[a, b], [nodes, triangles]| [a + nodes, b + triangles]);
        for (room, needed) in [&mut self.nodes, &mut self.triangles].into_iter().zip(needed) {
            if needed * VECTOR_BYTES > most_bytes {
                let count: u64 = asked.iter().map(|mesh| u64::from(mesh.triangle_count())).sum();
                return Err(Error::Unsupported {
                    technique,
                    needed: format!("{} bytes for the trees of {count} triangles", needed * VECTOR_BYTES),
                    had: format!("at most {most_bytes} bytes a binding"),
                    remedy: "cast with fewer or coarser meshes, or ask for a larger max_storage_buffer_binding_size",
                });
            }
            let with_more = if is_first { needed } else { needed + needed / 2 };
            room.renew(stage, with_more.min(most_bytes / VECTOR_BYTES).max(u64::from(FRAME_VECTORS)));
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
                // Where there are none nothing reads them.
                mesh_uvs: uvs.unwrap_or(mesh_positions),
            };
            sources.push((source.group(stage, &self.programs.source_layout), count));
            first_item += count;
        }
        Some(Work { forest, kept, sources })
    }

    /// Makes and fits what is to be.
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

    /// Whether a frame that is as the one before finds all trees as they are.
    #[cfg(test)]
    pub(super) fn is_idle(&self) -> bool {
        self.made.is_none() && self.fitted.is_none()
    }

    /// Bytes of trees, apart from those of their making.
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

/// Positions, indices and, where a texture is asked for, its coordinates.
fn buffers_of<'a>(mesh: &MeshCaster<'a>) -> (&'a wgpu::Buffer, &'a wgpu::Buffer, Option<&'a wgpu::Buffer>) {
    (mesh.positions, mesh.indices, mesh.opacity.texture().map(|texture| texture.uvs))
}
