//! Which meshes' trees are kept from frame to frame, and where in the two buffers of all trees.

use std::collections::HashMap;
use std::ops::Range;

use range_alloc::RangeAllocator;

use super::super::tree::FRAME_VECTORS;
use super::FIRST_MASK;
use crate::contract::{Error, MeshCaster};
use crate::gpu::{Gpu, Stage};

/// Size of a vector, the unit of nodes and triangles, bytes.
const VECTOR_BYTES: u64 = 16;

/// Position of a mesh's tree, in vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MeshPlace {
    /// Its box, then its nodes.
    pub(crate) first_node: u32,
    pub(crate) first_triangle: u32,
    pub(crate) triangle_stride: u32,
}

/// Identity of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum MeshKey {
    /// Mesh with a version, with or without texture coordinates.
    Versioned { mesh: u64, has_uvs: bool },
    /// Mesh identified by its buffers.
    Buffers { positions: wgpu::Buffer, indices: wgpu::Buffer, uvs: Option<wgpu::Buffer>, first: u32, count: u32 },
}

impl MeshKey {
    pub(super) fn of(caster: &MeshCaster<'_>) -> Self {
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

/// Buffer of vectors, and which of them are allocated.
#[derive(Debug)]
pub(super) struct VectorPool {
    label: &'static str,
    buffer: Option<wgpu::Buffer>,
    ranges: RangeAllocator<u64>,
}

impl VectorPool {
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

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        self.buffer.as_ref().expect("prepare comes before use")
    }

    fn bytes(&self) -> u64 {
        self.buffer.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

/// Mesh that a frame uses, and one of its casters.
pub(super) struct UsedMesh<'a, 'c> {
    pub(super) key: MeshKey,
    pub(super) caster: &'a MeshCaster<'c>,
}

impl UsedMesh<'_, '_> {
    pub(super) fn triangle_count(&self) -> u32 {
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

/// Meshes of a frame whose trees are not up to date.
pub(super) struct Outdated<'k, 'a, 'c> {
    /// Meshes without a tree.
    pub(super) to_build: Vec<&'k UsedMesh<'a, 'c>>,
    /// Meshes whose vertices may have moved.
    pub(super) to_fit: Vec<&'k UsedMesh<'a, 'c>>,
}

/// Trees of meshes, kept while they fit.
#[derive(Debug)]
pub(super) struct KeptMeshes {
    kept: HashMap<MeshKey, KeptMesh>,
    frame: u64,
    pub(super) nodes: VectorPool,
    pub(super) triangles: VectorPool,
}

impl KeptMeshes {
    pub(super) fn new() -> Self {
        Self {
            kept: HashMap::new(),
            frame: 0,
            nodes: VectorPool::new("antumbra mesh nodes"),
            triangles: VectorPool::new("antumbra mesh triangles"),
        }
    }

    /// Allocates space for each mesh of the next frame that has none. Returns the meshes that must be built or refitted.
    pub(super) fn keep<'k, 'a, 'c>(
        &mut self,
        stage: &Stage<'_>,
        technique: &'static str,
        used: &'k [UsedMesh<'a, 'c>],
    ) -> Result<Outdated<'k, 'a, 'c>, Error> {
        self.frame += 1;
        for mesh in used {
            if let Some(kept) = self.kept.get_mut(&mesh.key) {
                // A different size means a different mesh, whatever its version.
                let is_it = kept.triangle_count == mesh.triangle_count();
                kept.frame = if is_it { self.frame } else { 0 };
            }
        }
        let is_kept = |mesh: &UsedMesh<'_, '_>| self.kept.get(&mesh.key).is_some_and(|kept| kept.frame == self.frame);
        let mut are_new: Vec<bool> = used.iter().map(|mesh| !is_kept(mesh)).collect();
        let mut new = used.iter().zip(&are_new).filter(|(_, is_new)| **is_new);
        if self.nodes.buffer.is_none() || !new.all(|(mesh, _)| self.take(mesh)) {
            self.renew(stage, technique, used)?;
            are_new.fill(true);
        }
        let (mut to_build, mut to_fit) = (Vec::new(), Vec::new());
        for (mesh, is_new) in used.iter().zip(are_new) {
            let vertices = mesh.caster.version.map(|version| version.vertices);
            let kept = self.kept.get_mut(&mesh.key).expect("inserted above");
            if is_new {
                to_build.push(mesh);
            } else if vertices.is_none() || kept.vertices != vertices {
                to_fit.push(mesh);
            }
            kept.vertices = vertices;
        }
        Ok(Outdated { to_build, to_fit })
    }

    /// Returns the position of a mesh of the frame.
    pub(super) fn place(&self, key: &MeshKey) -> MeshPlace {
        self.kept[key].place()
    }

    /// Size of the trees, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.nodes.bytes() + self.triangles.bytes()
    }

    /// Allocates space for a mesh, replacing meshes that the frame does not use if necessary. Returns whether there is space.
    fn take(&mut self, mesh: &UsedMesh<'_, '_>) -> bool {
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

    fn try_take(&mut self, mesh: &UsedMesh<'_, '_>) -> Option<[Range<u64>; 2]> {
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
    fn renew(&mut self, stage: &Stage<'_>, technique: &'static str, used: &[UsedMesh<'_, '_>]) -> Result<(), Error> {
        if let Some(mesh) = used.iter().find(|mesh| mesh.triangle_count() > FIRST_MASK) {
            return Err(Error::Unsupported {
                technique,
                needed: format!("a tree over a mesh with {} triangles", mesh.triangle_count()),
                had: format!("a limit of {FIRST_MASK} per tree"),
                remedy: "split the mesh",
            });
        }
        let is_first = self.nodes.buffer.is_none();
        let max_bytes = stage.device.limits().max_storage_buffer_binding_size;
        let needed =
            used.iter().map(UsedMesh::vectors).fold([0; 2], |[a, b], [nodes, triangles]| [a + nodes, b + triangles]);
        for (room, needed) in [&mut self.nodes, &mut self.triangles].into_iter().zip(needed) {
            if needed * VECTOR_BYTES > max_bytes {
                let count: u64 = used.iter().map(|mesh| u64::from(mesh.triangle_count())).sum();
                return Err(Error::Unsupported {
                    technique,
                    needed: format!("{} bytes for the trees of {count} triangles", needed * VECTOR_BYTES),
                    had: format!("at most {max_bytes} bytes per binding"),
                    remedy: "use fewer or coarser meshes, or request a larger max_storage_buffer_binding_size",
                });
            }
            let with_more = if is_first { needed } else { needed + needed / 2 };
            room.renew(stage, with_more.min(max_bytes / VECTOR_BYTES).max(u64::from(FRAME_VECTORS)));
        }
        self.kept.clear();
        for mesh in used {
            let is_taken = self.take(mesh);
            debug_assert!(is_taken, "there is room for all");
        }
        Ok(())
    }
}
