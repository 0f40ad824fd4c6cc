//! Caster set: casters that lights share. Meshes and casters are added, moved, changed and removed by handle.
//!
//! Hosts' vertices come in many formats, and every technique reads every caster, many of them in compute. So the set packs
//! each mesh once into its own buffers: positions as three floats, texture coordinates as two, 32-bit indices, 4 × 4
//! matrices. Passes then draw all casters from a few buffers with one command each, or read them in one dispatch. This
//! costs 12 bytes per vertex (20 with texture coordinates), 4 per index and 64 per instance.
//!
//! ```no_run
//! # use antumbra::casters::*; use antumbra::*; use glam::*;
//! # fn example(gpu: &Gpu, mesh: &Mesh<'_>, recorder: &mut Recorder<'_>) -> Result<(), Error> {
//! // Once.
//! let mut casters = CasterSet::new(gpu);
//! let crate_mesh = casters.add_mesh(mesh)?;
//! let a_crate = casters.add(&Caster::new(crate_mesh, Instances::Matrices(&[Mat4::IDENTITY])))?;
//! // Each frame, before lights are prepared.
//! casters.set_instances(a_crate, Instances::Matrices(&[Mat4::from_translation(Vec3::X)]))?;
//! casters.update(recorder)?;
//! # Ok(()) }
//! ```

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use antumbra_light::Aabb;
use glam::Mat4;
use slotmap::SlotMap;

use crate::contract::{Error, MeshVersion};
use crate::gpu::{Commands, Gpu, RetainedState};

mod arena;
mod ball;
mod drawn;
mod mesh;
pub(crate) mod pack;
mod placed_instances;
mod surface;
#[cfg(test)]
pub(crate) mod tests;
mod update;

use arena::Arena;
pub(crate) use ball::Ball;
pub use mesh::{
    Indices, InstanceBuffer, InstanceLayout, Instances, Mesh, PositionFormat, Positions, TextureCoordinateFormat,
    TextureCoordinates,
};
use pack::{InstanceSource, MeshSource, Packer};
use placed_instances::{PlacedInstances, world_bounds};
use surface::check_surface;
pub use surface::{Surface, Texture};

slotmap::new_key_type! {
    /// Handle of a mesh in a [`CasterSet`].
    pub struct MeshId;
    /// Handle of a caster in a [`CasterSet`].
    pub struct CasterId;
}

/// Description of a caster: one or more instances of a mesh, with one surface.
#[derive(Clone, Debug)]
pub struct Caster<'a> {
    /// Mesh.
    pub mesh: MeshId,
    /// World transforms.
    pub instances: Instances<'a>,
    /// Surface.
    pub surface: Surface,
    /// Layer mask: one bit per layer that contains the caster. Lights see casters of the layers that
    /// [`Casters::Set`](crate::Casters::Set) names.
    pub layers: u32,
}

impl<'a> Caster<'a> {
    /// Creates an opaque caster in all layers.
    pub fn new(mesh: MeshId, instances: Instances<'a>) -> Self {
        Self { mesh, instances, surface: Surface::Opaque, layers: u32::MAX }
    }
}

/// Set of casters shared by all lights; see the module.
#[derive(Debug)]
pub struct CasterSet {
    gpu: Gpu,
    packer: Packer,
    meshes: SlotMap<MeshId, MeshEntry>,
    casters: SlotMap<CasterId, CasterEntry>,
    /// Vertices of meshes without texture coordinates, and with them.
    vertices: [Arena; 2],
    indices: Arena,
    instances: Arena,
    /// Matrices of all casters whose matrices are known on the CPU, at their places.
    matrices: Vec<Mat4>,
    /// Casters in drawing order: by vertex buffer, then by mesh.
    order: Vec<CasterId>,
    /// Whether `order` is up to date with the casters.
    is_sorted: bool,
    keep: RetainedState,
    /// Unique number of the set.
    number: u64,
    /// Number of changes.
    version: u64,
    /// Version that the last update uploaded.
    updated: Option<u64>,
    /// Commands of the updates, to detect any that were never submitted.
    commands: Commands,
}

#[derive(Debug)]
struct MeshEntry {
    source: MeshSource,
    vertices: Range<u32>,
    indices: Range<u32>,
    closed: bool,
    bounds: Aabb,
    /// Whether the next update packs the mesh.
    is_changed: bool,
    version: MeshVersion,
    users: u32,
}

#[derive(Debug)]
struct CasterEntry {
    mesh: MeshId,
    /// Places of the instances in the arena.
    places: Range<u32>,
    /// Source of the matrices if they come from a GPU buffer.
    source: Option<InstanceSource>,
    surface: Surface,
    layers: u32,
    bounds: Aabb,
    /// Whether an instance mirrors the mesh.
    is_mirrored: bool,
    /// Whether the next update uploads or packs the matrices.
    is_moved: bool,
    /// Version of the set with the last change of this caster.
    version: u64,
}

/// Name in errors, in place of a technique's.
const ERROR_SOURCE: &str = "casters";

/// Number of the next set.
static NEXT_SET: AtomicU64 = AtomicU64::new(0);
/// Number of the next mesh of any set.
static NEXT_MESH: AtomicU64 = AtomicU64::new(0);

impl CasterSet {
    /// Creates an empty set.
    pub fn new(gpu: &Gpu) -> Self {
        let columns = [("antumbra caster positions", 12), ("antumbra caster texture coordinates", 8)];
        let vertices = |columns| Arena::new(columns, wgpu::BufferUsages::VERTEX);
        Self {
            gpu: gpu.clone(),
            packer: Packer::new(gpu),
            meshes: SlotMap::with_key(),
            casters: SlotMap::with_key(),
            vertices: [vertices(&columns[..1]), vertices(&columns)],
            // One item holds the three indices of a triangle.
            indices: Arena::new(&[("antumbra caster indices", 12)], wgpu::BufferUsages::INDEX),
            instances: Arena::new(&[("antumbra caster instances", 64)], wgpu::BufferUsages::VERTEX),
            matrices: Vec::new(),
            order: Vec::new(),
            is_sorted: true,
            keep: RetainedState::default(),
            number: NEXT_SET.fetch_add(1, Ordering::Relaxed),
            version: 0,
            updated: None,
            commands: Commands::default(),
        }
    }

    /// Handle of the device that the set was created with.
    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Adds a mesh. Its buffers are read once, with the next [`update`](Self::update), and again after
    /// [`mesh_changed`](Self::mesh_changed).
    ///
    /// # Errors
    /// If buffers are too short or unreadable, or all meshes together exceed the size of a binding.
    pub fn add_mesh(&mut self, mesh: &Mesh<'_>) -> Result<MeshId, Error> {
        let source = source_of(mesh)?;
        let max_bytes = self.gpu.device.limits().max_storage_buffer_binding_size;
        let arena = &mut self.vertices[usize::from(source.has_uvs())];
        let vertices = room(arena.take(source.vertex_count().into(), max_bytes), max_bytes)?;
        let triangles = match room(self.indices.take(u64::from(source.index_count()) / 3, max_bytes), max_bytes) {
            Ok(triangles) => triangles,
            Err(error) => {
                arena.give_back(&vertices);
                return Err(error);
            }
        };
        self.version += 1;
        Ok(self.meshes.insert(MeshEntry {
            source,
            vertices,
            indices: triangles,
            closed: is_closed(mesh),
            bounds: mesh.bounds,
            is_changed: true,
            version: MeshVersion { mesh: NEXT_MESH.fetch_add(1, Ordering::Relaxed), vertices: 0 },
            users: 0,
        }))
    }

    /// Notifies the set that a mesh's content or buffers have changed: skinned, morphed, rebuilt. The numbers of vertices
    /// and indices must stay the same.
    ///
    /// # Errors
    /// If there is no such mesh, [`add_mesh`](Self::add_mesh) would refuse the new one, or its size differs.
    pub fn mesh_changed(&mut self, id: MeshId, mesh: &Mesh<'_>) -> Result<(), Error> {
        let source = source_of(mesh)?;
        let entry = self.meshes.get_mut(id).ok_or_else(|| gone("the mesh"))?;
        let size = |source: &MeshSource| (source.vertex_count(), source.index_count(), source.has_uvs());
        if size(&source) != size(&entry.source) {
            return Err(bad(
                "the new content of a mesh",
                format!("{} vertices and {} indices", source.vertex_count(), source.index_count()),
                format!(
                    "{} vertices and {} indices, with texture coordinates if the mesh had them; add another mesh for other sizes",
                    entry.source.vertex_count(),
                    entry.source.index_count()
                ),
            ));
        }
        let has_new_bounds = entry.bounds != mesh.bounds;
        (entry.source, entry.closed, entry.bounds, entry.is_changed) = (source, is_closed(mesh), mesh.bounds, true);
        entry.version.vertices += 1;
        self.version += 1;
        if has_new_bounds {
            for caster in self.casters.values_mut().filter(|caster| caster.mesh == id && caster.source.is_none()) {
                let places = caster.places.start as usize..caster.places.end as usize;
                caster.bounds = world_bounds(mesh.bounds, &self.matrices[places]);
            }
        }
        Ok(())
    }

    /// Removes a mesh.
    ///
    /// # Errors
    /// If there is no such mesh, or casters still use it.
    pub fn remove_mesh(&mut self, id: MeshId) -> Result<(), Error> {
        let users = self.meshes.get(id).ok_or_else(|| gone("the mesh"))?.users;
        if users > 0 {
            return Err(bad(
                "the mesh to remove",
                format!("used by {users} casters"),
                "unused: remove these casters first".into(),
            ));
        }
        if let Some(entry) = self.meshes.remove(id) {
            self.vertices[usize::from(entry.source.has_uvs())].give_back(&entry.vertices);
            self.indices.give_back(&entry.indices);
            self.version += 1;
        }
        Ok(())
    }

    /// Adds a caster.
    ///
    /// # Errors
    /// If there is no such mesh, the surface has a texture and the mesh no texture coordinates, or matrices are not finite
    /// or not readable.
    pub fn add(&mut self, caster: &Caster<'_>) -> Result<CasterId, Error> {
        let mesh = self.meshes.get(caster.mesh).ok_or_else(|| gone("the caster's mesh"))?;
        check_surface(&self.gpu, &caster.surface, mesh)?;
        let of_instances = PlacedInstances::new(&caster.instances, mesh.bounds)?;
        let max_bytes = self.gpu.device.limits().max_storage_buffer_binding_size;
        let places = room(self.instances.take(of_instances.count.into(), max_bytes), max_bytes)?;
        let mut entry = CasterEntry {
            mesh: caster.mesh,
            places,
            source: None,
            surface: caster.surface.clone(),
            layers: caster.layers,
            bounds: Aabb::EMPTY,
            is_mirrored: false,
            is_moved: true,
            version: self.version + 1,
        };
        entry.place(of_instances, &mut self.matrices);
        self.meshes[caster.mesh].users += 1;
        self.version += 1;
        self.is_sorted = false;
        Ok(self.casters.insert(entry))
    }

    /// Moves a caster. Its instances get another place in the buffer if their number changes.
    ///
    /// # Errors
    /// If there is no such caster, or matrices are not finite or not readable.
    pub fn set_instances(&mut self, id: CasterId, instances: Instances<'_>) -> Result<(), Error> {
        let entry = self.casters.get_mut(id).ok_or_else(|| gone("the caster"))?;
        let of_instances = PlacedInstances::new(&instances, self.meshes[entry.mesh].bounds)?;
        if of_instances.count != entry.places.end - entry.places.start {
            let max_bytes = self.gpu.device.limits().max_storage_buffer_binding_size;
            let places = room(self.instances.take(of_instances.count.into(), max_bytes), max_bytes)?;
            self.instances.give_back(&std::mem::replace(&mut entry.places, places));
            self.is_sorted = false;
        }
        entry.place(of_instances, &mut self.matrices);
        self.version += 1;
        entry.version = self.version;
        Ok(())
    }

    /// Changes a caster's surface.
    ///
    /// # Errors
    /// If there is no such caster, or the surface has a texture and the mesh no texture coordinates.
    pub fn set_surface(&mut self, id: CasterId, surface: Surface) -> Result<(), Error> {
        let entry = self.casters.get_mut(id).ok_or_else(|| gone("the caster"))?;
        check_surface(&self.gpu, &surface, &self.meshes[entry.mesh])?;
        entry.surface = surface;
        self.version += 1;
        entry.version = self.version;
        Ok(())
    }

    /// Changes a caster's layers.
    ///
    /// # Errors
    /// If there is no such caster.
    pub fn set_layers(&mut self, id: CasterId, layers: u32) -> Result<(), Error> {
        let entry = self.casters.get_mut(id).ok_or_else(|| gone("the caster"))?;
        entry.layers = layers;
        self.version += 1;
        entry.version = self.version;
        Ok(())
    }

    /// Removes a caster.
    ///
    /// # Errors
    /// If there is no such caster.
    pub fn remove(&mut self, id: CasterId) -> Result<(), Error> {
        let entry = self.casters.remove(id).ok_or_else(|| gone("the caster"))?;
        self.instances.give_back(&entry.places);
        self.meshes[entry.mesh].users -= 1;
        self.version += 1;
        self.is_sorted = false;
        Ok(())
    }

    /// Number of casters.
    pub fn len(&self) -> usize {
        self.casters.len()
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty()
    }

    /// World-space box of a caster's instances; `None` if there is no such caster.
    pub fn bounds(&self, id: CasterId) -> Option<Aabb> {
        self.casters.get(id).map(|caster| caster.bounds)
    }

    /// GPU memory of the set, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let vertices: u64 = self.vertices.iter().map(Arena::memory_bytes).sum();
        vertices + self.indices.memory_bytes() + self.instances.memory_bytes()
    }
}

impl CasterEntry {
    /// Stores instances at the places of the entry.
    fn place(&mut self, instances: PlacedInstances<'_>, matrices: &mut Vec<Mat4>) {
        let PlacedInstances { count, matrices: known, source, bounds, is_mirrored } = instances;
        debug_assert_eq!(count, self.places.end - self.places.start, "one slot per instance");
        if let Some(known) = known {
            let end = self.places.end as usize;
            if matrices.len() < end {
                matrices.resize(end, Mat4::IDENTITY);
            }
            matrices[self.places.start as usize..end].copy_from_slice(known);
        }
        (self.source, self.bounds, self.is_mirrored, self.is_moved) = (source, bounds, is_mirrored, true);
    }
}

fn source_of(mesh: &Mesh<'_>) -> Result<MeshSource, Error> {
    let source = MeshSource::new(mesh)?;
    check_box("the mesh's bounding box", mesh.bounds, source.index_count() > 0)?;
    Ok(source)
}

/// Whether the triangles are known to bound a solid. A strip's triangles may have either winding.
fn is_closed(mesh: &Mesh<'_>) -> bool {
    mesh.closed && mesh.topology == wgpu::PrimitiveTopology::TriangleList
}

/// Refuses an invalid box of a mesh or instances that are not empty.
fn check_box(what: &'static str, bounds: Aabb, holds_any: bool) -> Result<(), Error> {
    let problem = bounds.problem().filter(|_| holds_any);
    problem.map_or(Ok(()), |problem| {
        Err(bad(
            what,
            problem.into(),
            "a box whose first corner is the minimum; use infinite bounds if they are unknown".into(),
        ))
    })
}

/// Returns the allocated range, or an error with the bytes that would be needed.
fn room(range: Result<Range<u32>, u64>, max_bytes: u64) -> Result<Range<u32>, Error> {
    range.map_err(|bytes| Error::Unsupported {
        technique: ERROR_SOURCE,
        needed: format!("{bytes} bytes in one buffer for all casters of a set"),
        had: format!("at most {max_bytes} bytes per binding"),
        remedy: "use fewer or coarser meshes, or request a larger max_storage_buffer_binding_size",
    })
}

fn gone(what: &'static str) -> Error {
    bad(what, "not in this set".into(), "one that was added to this set and not removed".into())
}

fn bad(what: &'static str, had: String, needed: String) -> Error {
    Error::BadFrame { technique: ERROR_SOURCE, what, had, needed }
}
