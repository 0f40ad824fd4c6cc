//! Extraction of this frame's casters and receivers from the main world.

use antumbra::light::Aabb;
use bevy::asset::AssetId;
use bevy::camera::primitives::Aabb as EntityAabb;
use bevy::camera::visibility::RenderLayers;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy::render::Extract;

use super::mesh::MeshBoxes;
use super::morph::MorphBoxes;
use super::surface::{CasterSurface, OwnSurfaces, is_seen_without_mask};
use crate::convert::{affine, mat4, moved, vec3};
use crate::layers::layer_bits;
use crate::patch::Patch;

/// Caster of this frame.
#[derive(Clone, Debug)]
pub struct ExtractedCaster {
    /// Entity in the main world.
    pub entity: Entity,
    pub mesh: AssetId<Mesh>,
    pub world_from_object: glam::Mat4,
    /// Boxes of the undeformed mesh.
    pub boxes: MeshBoxes,
    pub layers: u32,
    pub surface: CasterSurface,
    /// Whether the material is not the standard one. Only the render world knows whether there is a material at all.
    pub has_other_material: bool,
    pub bend: Option<ExtractedBend>,
}

/// Pose of a mesh with a skeleton, morph targets or both.
#[derive(Clone, Debug)]
pub struct ExtractedBend {
    /// World-from-object matrix of each joint; empty without a skeleton.
    pub joints: Vec<glam::Mat4>,
    /// Weight of each morph target; empty without targets.
    pub weights: Vec<f32>,
    /// Conservative bounds of the deformed mesh: in world space with a skeleton, else in object space.
    pub bounds: Aabb,
}

/// Casters and receivers of a frame.
#[derive(Resource)]
pub struct ExtractedCasters {
    pub casters: Vec<ExtractedCaster>,
    /// World-space box of every mesh, casting or not.
    pub receivers: Aabb,
    /// Whether some receiving surfaces have no mask.
    pub some_have_no_mask: bool,
}

impl Default for ExtractedCasters {
    fn default() -> Self {
        Self { casters: Vec::new(), receivers: Aabb::EMPTY, some_have_no_mask: false }
    }
}

/// Assets of the main world that describe casters.
#[derive(bevy::ecs::system::SystemParam)]
pub struct CasterAssets<'w, 's> {
    meshes: Extract<'w, 's, Res<'static, Assets<Mesh>>>,
    materials: Extract<'w, 's, Res<'static, Assets<StandardMaterial>>>,
    bindposes: Extract<'w, 's, Res<'static, Assets<SkinnedMeshInverseBindposes>>>,
    morph_boxes: Extract<'w, 's, Res<'static, MorphBoxes>>,
}

/// Other entities of the main world that deform meshes.
#[derive(bevy::ecs::system::SystemParam)]
pub struct Poses<'w, 's> {
    transforms: Extract<'w, 's, Query<'static, 'static, &'static GlobalTransform>>,
    weights: Extract<'w, 's, Query<'static, 'static, &'static MorphWeights>>,
}

/// Extracts all casters that Bevy would draw: visible or off screen, but neither hidden nor `NotShadowCaster`.
pub fn extract_casters(
    patch: Extract<Res<Patch>>,
    mut extracted: ResMut<ExtractedCasters>,
    mut own_surfaces: ResMut<OwnSurfaces>,
    meshes: Extract<
        Query<(
            Entity,
            &Mesh3d,
            &GlobalTransform,
            &InheritedVisibility,
            (Has<NotShadowCaster>, Has<NotShadowReceiver>),
            Option<&RenderLayers>,
            Option<&MeshMaterial3d<StandardMaterial>>,
            Option<&EntityAabb>,
            (Option<&SkinnedMesh>, Option<&MeshMorphWeights>),
        )>,
    >,
    assets: CasterAssets,
    poses: Poses,
) {
    let extracted = &mut *extracted;
    extracted.casters.clear();
    extracted.receivers = Aabb::EMPTY;
    extracted.some_have_no_mask = false;
    let own_surfaces = std::mem::take(&mut own_surfaces.0);
    if **patch != Patch::Applied {
        return;
    }
    for (entity, mesh, transform, visibility, (casts_none, receives_none), layers, material, aabb, (skin, morph)) in
        &meshes
    {
        if !visibility.get() {
            continue;
        }
        let Some(boxes) = boxes_of(aabb, mesh, &assets.meshes) else { continue };
        let world_from_object = affine(&transform.affine());
        let bend = bend_of((skin, morph), mesh, boxes.positions, &assets, &poses);
        let in_world = match &bend {
            Some(bend) if !bend.joints.is_empty() => bend.bounds,
            Some(bend) => moved(bend.bounds, &world_from_object),
            None => moved(boxes.positions, &world_from_object),
        };
        // Bevy's box is larger if a material's shader moves vertices.
        let culled = aabb.map_or(Aabb::EMPTY, |aabb| moved(box_of(aabb), &world_from_object));
        extracted.receivers = extracted.receivers.union(in_world).union(culled);
        let standard = material.and_then(|material| assets.materials.get(material));
        let own = own_surfaces.get(&entity);
        if !receives_none {
            extracted.some_have_no_mask |=
                standard.is_some_and(is_seen_without_mask) || own.is_some_and(|own| own.is_transparent);
        }
        if casts_none {
            continue;
        }
        let surface = match (material, own) {
            // A material that is still loading casts nothing yet.
            (Some(_), _) => standard.and_then(CasterSurface::of_standard),
            (None, Some(own)) => own.casts.clone(),
            (None, None) => Some(CasterSurface::Opaque),
        };
        let Some(surface) = surface else { continue };
        extracted.casters.push(ExtractedCaster {
            entity,
            mesh: mesh.id(),
            world_from_object,
            boxes,
            layers: layers.map_or(1, layer_bits),
            surface,
            has_other_material: material.is_none(),
            bend,
        });
    }
}

fn box_of(aabb: &EntityAabb) -> Aabb {
    let (center, half) = (aabb.center.to_array(), aabb.half_extents.to_array());
    let (center, half) = (glam::Vec3::from_array(center), glam::Vec3::from_array(half));
    Aabb { min: center - half, max: center + half }
}

/// Returns the mesh's boxes. Until the mesh is loaded, Bevy's culling box replaces its own; for skeletons that follows the pose.
fn boxes_of(aabb: Option<&EntityAabb>, mesh: &Mesh3d, meshes: &Assets<Mesh>) -> Option<MeshBoxes> {
    let mesh = meshes.get(&mesh.0);
    let of_mesh = mesh.and_then(|mesh| mesh.final_aabb);
    let of_mesh = of_mesh.map(|aabb| Aabb { min: vec3(aabb.min.into()), max: vec3(aabb.max.into()) });
    let uvs = mesh.map_or([None; 2], |mesh| {
        let vec2 = |v: Vec2| glam::Vec2::from_array(v.to_array());
        mesh.final_uv_ranges.map(|range| range.map(|range| [vec2(range.min), vec2(range.max - range.min)]))
    });
    Some(MeshBoxes { positions: of_mesh.or_else(|| aabb.map(box_of))?, uvs })
}

/// Returns the pose of a mesh; `None` if it is undeformed. A skinned vertex is a weighted mean of its positions by each joint
/// alone, so the union of the joints' boxes contains it.
fn bend_of(
    (skin, morph): (Option<&SkinnedMesh>, Option<&MeshMorphWeights>),
    mesh: &Mesh3d,
    bounds: Aabb,
    assets: &CasterAssets,
    poses: &Poses,
) -> Option<ExtractedBend> {
    let weights = match morph {
        Some(MeshMorphWeights::Value { weights }) => weights.as_slice(),
        Some(MeshMorphWeights::Reference(entity)) => poses.weights.get(*entity).map_or(&[][..], MorphWeights::weights),
        None => &[],
    };
    let target_count = assets.morph_boxes.target_count(mesh.id());
    let weights = weights[..weights.len().min(target_count)].to_vec();
    let morphed = assets.morph_boxes.morphed(mesh.id(), bounds, &weights);
    let joints = skin.map_or_else(Vec::new, |skin| joints_of(skin, assets, poses));
    if weights.is_empty() && joints.is_empty() {
        return None;
    }
    let of_joints = joints.iter().fold(Aabb::EMPTY, |all, joint| all.union(moved(morphed, joint)));
    let bounds = if joints.is_empty() { morphed } else { of_joints };
    Some(ExtractedBend { joints, weights, bounds })
}

/// Returns the world-from-object matrix of each joint of a skeleton.
fn joints_of(skin: &SkinnedMesh, assets: &CasterAssets, poses: &Poses) -> Vec<glam::Mat4> {
    let Some(bindposes) = assets.bindposes.get(&skin.inverse_bindposes) else { return Vec::new() };
    let world_from_object = |(joint, bindpose): (&Entity, &Mat4)| {
        let world = poses.transforms.get(*joint).map_or(glam::Mat4::IDENTITY, |joint| affine(&joint.affine()));
        world * mat4(bindpose)
    };
    skin.joints.iter().zip(bindposes.iter()).map(world_from_object).collect()
}
