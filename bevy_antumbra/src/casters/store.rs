//! The library's caster set, synchronised with the world.

use std::collections::{HashMap, HashSet};
use std::time::Instant;

use antumbra::casters::{Caster, CasterId, CasterSet, Instances, MeshId, Surface};
use antumbra::light::Aabb;
use antumbra::{Error, Recorder};
use bevy::asset::AssetId;
use bevy::pbr::RenderMaterialInstances;
use bevy::prelude::*;
use bevy::render::mesh::RenderMesh;
use bevy::render::mesh::allocator::MeshAllocator;
use bevy::render::render_asset::{ExtractedAssets, RenderAssets};
use bevy::render::renderer::{RenderContext, RenderQueue};
use bevy::render::sync_world::MainEntity;
use bevy::render::texture::GpuImage;

use super::bend::{Bender, Bent};
use super::extract::{ExtractedBend, ExtractedCaster, ExtractedCasters};
use super::mesh::{MeshError, MeshPlace};
use super::surface::{CasterSurface, SurfaceTexture};
use crate::counts::ShadowCounts;
use crate::warnings::Warnings;

/// Casters of the world: one set for all lights and views.
#[derive(Resource)]
pub struct CasterStore {
    pub set: CasterSet,
    bender: Bender,
    meshes: HashMap<MeshKey, KeptMesh>,
    casters: HashMap<Entity, KeptCaster>,
    bent: HashMap<Entity, Bent>,
    /// Frame counter, which identifies casters that were not extracted in the last frame.
    frame: u64,
    /// World-space box of all possible receivers.
    pub receivers: Aabb,
}

/// Key of a packed mesh: a mesh with the texture coordinates of its material; deformed meshes are packed per entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct MeshKey {
    mesh: AssetId<Mesh>,
    uvs: Option<(bool, [u32; 6])>,
    bent_for: Option<Entity>,
}

struct KeptMesh {
    id: MeshId,
    users: u32,
}

struct KeptCaster {
    id: CasterId,
    mesh: MeshKey,
    world_from_object: glam::Mat4,
    layers: u32,
    /// Surface as its material describes it.
    described: CasterSurface,
    /// Surface in the set. Its texture can change although the asset stays the same.
    surface: Surface,
    seen: u64,
}

impl MeshKey {
    fn new(caster: &ExtractedCaster, surface: &CasterSurface) -> Self {
        let uvs = |texture: &SurfaceTexture| (texture.second_uvs, texture.uv_transform.map(f32::to_bits));
        let bent_for = caster.bend.as_ref().map(|_| caster.entity);
        Self { mesh: caster.mesh, uvs: surface.texture().map(uvs), bent_for }
    }
}

/// Render-world resources that casters consist of.
struct Sources<'a> {
    meshes: &'a RenderAssets<RenderMesh>,
    allocator: &'a MeshAllocator,
    images: &'a RenderAssets<GpuImage>,
    queue: &'a RenderQueue,
    /// Whether images were added, modified or removed in this frame.
    have_images_changed: bool,
}

/// Reason why a caster is not in the set.
#[derive(Debug, thiserror::Error)]
enum CasterError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Library(#[from] Error),
}

impl KeptCaster {
    /// Whether the extracted caster has the same mesh and material and is not deformed. Its transform may differ.
    fn is_of(&self, caster: &ExtractedCaster) -> bool {
        let is_bent = caster.bend.is_some() || self.mesh.bent_for.is_some();
        !is_bent && self.mesh.mesh == caster.mesh && self.described == caster.surface
    }

    /// Updates the caster's transform and layers in the set.
    fn place(&mut self, set: &mut CasterSet, world_from_object: glam::Mat4, layers: u32) -> Result<(), CasterError> {
        if self.world_from_object != world_from_object {
            set.set_instances(self.id, Instances::Matrices(&[world_from_object]))?;
            self.world_from_object = world_from_object;
        }
        if self.layers != layers {
            set.set_layers(self.id, layers)?;
            self.layers = layers;
        }
        Ok(())
    }
}

impl CasterStore {
    pub fn new(gpu: &antumbra::Gpu) -> Self {
        Self {
            set: CasterSet::new(gpu),
            bender: Bender::new(gpu.device()),
            meshes: HashMap::new(),
            casters: HashMap::new(),
            bent: HashMap::new(),
            frame: 0,
            receivers: Aabb::EMPTY,
        }
    }

    /// Synchronises one caster: adds it, or applies its changes to the set.
    fn bring(&mut self, caster: &ExtractedCaster, sources: &Sources<'_>) -> Result<(), CasterError> {
        if let Some(kept) = self.casters.get_mut(&caster.entity)
            && !sources.have_images_changed
            && kept.is_of(caster)
        {
            return kept.place(&mut self.set, caster.world_from_object, caster.layers);
        }
        let mesh = sources.meshes.get(caster.mesh).ok_or(MeshError::NotThere)?;
        let place = MeshPlace::new(caster.mesh, mesh, sources.allocator, caster.boxes)?;
        let surface = match caster.surface.texture() {
            Some(texture) if place.uvs(texture).is_none() => caster.surface.without_texture(),
            _ => caster.surface.clone(),
        };
        let key = MeshKey::new(caster, &surface);
        if self.casters.get(&caster.entity).is_some_and(|kept| kept.mesh != key) {
            self.remove(caster.entity)?;
        }
        let is_in_world = caster.bend.as_ref().is_some_and(|bend| !bend.joints.is_empty());
        let world_from_object = if is_in_world { glam::Mat4::IDENTITY } else { caster.world_from_object };
        if let Some(bend) = &caster.bend {
            self.bend(caster, bend, &surface, &place, key, sources)?;
        }
        let Some(kept) = self.casters.get_mut(&caster.entity) else {
            return self.add(caster, surface, key, world_from_object, &place, sources);
        };
        kept.place(&mut self.set, world_from_object, caster.layers)?;
        kept.described = caster.surface.clone();
        if let Some(surface) = surface.of_library(sources.images)
            && kept.surface != surface
        {
            self.set.set_surface(kept.id, surface.clone())?;
            kept.surface = surface;
        }
        Ok(())
    }

    fn add(
        &mut self,
        caster: &ExtractedCaster,
        surface: CasterSurface,
        key: MeshKey,
        world_from_object: glam::Mat4,
        place: &MeshPlace<'_>,
        sources: &Sources<'_>,
    ) -> Result<(), CasterError> {
        let of_library = surface.of_library(sources.images).ok_or(MeshError::NotThere)?;
        let mesh = match self.meshes.get(&key) {
            Some(kept) => kept.id,
            None => {
                let of_library = match (&caster.bend, self.bent.get(&caster.entity)) {
                    (Some(bend), Some(bent)) => {
                        bent.of_library(caster.mesh, place, sources.allocator, &surface, bend.bounds)?
                    }
                    _ => place.of_library(caster.mesh, sources.allocator, surface.texture())?,
                };
                let id = self.set.add_mesh(&of_library)?;
                self.meshes.insert(key, KeptMesh { id, users: 0 });
                id
            }
        };
        let layers = caster.layers;
        let instances = Instances::Matrices(&[world_from_object]);
        let added = self.set.add(&Caster { mesh, instances, surface: of_library.clone(), layers });
        let kept = self.meshes.get_mut(&key);
        match (added, kept) {
            (Ok(id), Some(kept)) => {
                kept.users += 1;
                let (described, surface) = (caster.surface.clone(), of_library);
                let kept =
                    KeptCaster { id, mesh: key, world_from_object, layers, described, surface, seen: self.frame };
                self.casters.insert(caster.entity, kept);
                Ok(())
            }
            (Err(error), Some(kept)) if kept.users == 0 => {
                self.meshes.remove(&key);
                self.set.remove_mesh(mesh)?;
                Err(error.into())
            }
            (added, _) => added.map(|_| ()).map_err(CasterError::from),
        }
    }

    /// Uploads a mesh's pose. If it has changed and the mesh is in the set, marks the mesh as changed.
    fn bend(
        &mut self,
        caster: &ExtractedCaster,
        bend: &ExtractedBend,
        surface: &CasterSurface,
        place: &MeshPlace<'_>,
        key: MeshKey,
        sources: &Sources<'_>,
    ) -> Result<(), CasterError> {
        let kept = self.bent.remove(&caster.entity);
        let (id, boxes) = (caster.mesh, caster.boxes);
        let mut bent = self.bender.prepare(kept, id, place, sources.allocator, bend, boxes.positions)?;
        let has_changed = bent.bring(sources.queue, bend);
        if let Some(mesh) = self.meshes.get(&key).filter(|_| has_changed) {
            let of_library = bent.of_library(id, place, sources.allocator, surface, bend.bounds)?;
            self.set.mesh_changed(mesh.id, &of_library)?;
        }
        self.bent.insert(caster.entity, bent);
        Ok(())
    }

    /// Removes a caster, and its mesh if no other caster uses it.
    fn remove(&mut self, entity: Entity) -> Result<(), Error> {
        let Some(kept) = self.casters.remove(&entity) else { return Ok(()) };
        self.set.remove(kept.id)?;
        self.bent.remove(&entity);
        if let Some(mesh) = self.meshes.get_mut(&kept.mesh) {
            mesh.users -= 1;
            if mesh.users == 0 {
                let id = mesh.id;
                self.meshes.remove(&kept.mesh);
                self.set.remove_mesh(id)?;
            }
        }
        Ok(())
    }

    /// Removes all casters for which `is_gone` returns true.
    fn remove_where(&mut self, is_gone: impl Fn(&KeptCaster) -> bool) -> Result<(), Error> {
        let gone: Vec<Entity> =
            self.casters.iter().filter(|(_, kept)| is_gone(kept)).map(|(entity, _)| *entity).collect();
        gone.into_iter().try_for_each(|entity| self.remove(entity))
    }
}

/// Synchronises the set with the extracted casters. Runs after meshes and images are on the GPU.
pub fn sync_casters(
    mut store: ResMut<CasterStore>,
    extracted: Res<ExtractedCasters>,
    changed: Res<ExtractedAssets<RenderMesh>>,
    meshes: Res<RenderAssets<RenderMesh>>,
    allocator: Res<MeshAllocator>,
    (images, changed_images): (Res<RenderAssets<GpuImage>>, Res<ExtractedAssets<GpuImage>>),
    materials: Res<RenderMaterialInstances>,
    queue: Res<RenderQueue>,
    counts: Res<ShadowCounts>,
    mut warnings: ResMut<Warnings>,
) {
    let began = Instant::now();
    counts.begin();
    let store = &mut *store;
    store.frame += 1;
    store.receivers = extracted.receivers;
    let have_images_changed = !(changed_images.extracted.is_empty() && changed_images.removed.is_empty());
    let sources =
        Sources { meshes: &meshes, allocator: &allocator, images: &images, queue: &queue, have_images_changed };
    let changed: HashSet<AssetId<Mesh>> = changed.modified.iter().copied().collect();
    if !changed.is_empty() {
        // The set cannot change a mesh's size, so a modified mesh is removed and added again.
        warnings.of(store.remove_where(|kept| changed.contains(&kept.mesh.mesh)));
    }
    for caster in &extracted.casters {
        if caster.has_other_material && !materials.instances.contains_key(&MainEntity::from(caster.entity)) {
            continue;
        }
        match store.bring(caster, &sources) {
            Ok(()) | Err(CasterError::Mesh(MeshError::NotThere)) => {}
            Err(error) => warnings.say(error),
        }
        if let Some(kept) = store.casters.get_mut(&caster.entity) {
            kept.seen = store.frame;
        }
    }
    let frame = store.frame;
    warnings.of(store.remove_where(|kept| kept.seen != frame));
    counts.spend(began);
}

/// Records mesh deformation and the set's own packing, once per frame and before any view.
pub fn update_casters(
    mut context: RenderContext,
    store: Option<ResMut<CasterStore>>,
    counts: Res<ShadowCounts>,
    mut warnings: ResMut<Warnings>,
) {
    let Some(mut store) = store else { return };
    let began = Instant::now();
    let encoder = context.command_encoder();
    let store = &mut *store;
    store.bender.record(encoder, store.bent.values_mut());
    let updated = store.set.update(&mut Recorder::new(encoder, None));
    warnings.of(updated);
    counts.spend(began);
}
