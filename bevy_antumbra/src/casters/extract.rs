//! What casts and what receives in this frame, as the main world has it.

use antumbra::light::Aabb;
use bevy::asset::AssetId;
use bevy::camera::primitives::Aabb as EntityAabb;
use bevy::camera::visibility::RenderLayers;
use bevy::light::NotShadowCaster;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy::render::Extract;

use super::surface::CasterSurface;
use crate::convert::{affine, mat4, moved, vec3};
use crate::layers::layer_bits;
use crate::patch::Patch;

/// A mesh that casts.
#[derive(Clone, Debug)]
pub struct ExtractedCaster {
    /// In the main world.
    pub entity: Entity,
    pub mesh: AssetId<Mesh>,
    pub world_from_object: glam::Mat4,
    /// Of the mesh as it was modelled.
    pub bounds: Aabb,
    pub layers: u32,
    pub surface: CasterSurface,
    /// A material other than the standard one; whether there is one at all, the render world knows.
    pub has_other_material: bool,
    pub skin: Option<ExtractedSkin>,
}

/// How a mesh with a skeleton stands.
#[derive(Clone, Debug)]
pub struct ExtractedSkin {
    /// World-from-object of each joint.
    pub joints: Vec<glam::Mat4>,
    /// World-space box of the mesh as it stands, or a larger one.
    pub bounds: Aabb,
}

/// All of a frame.
#[derive(Resource)]
pub struct ExtractedCasters {
    pub casters: Vec<ExtractedCaster>,
    /// World-space box of every mesh, casting or not.
    pub receivers: Aabb,
}

impl Default for ExtractedCasters {
    fn default() -> Self {
        Self { casters: Vec::new(), receivers: Aabb::EMPTY }
    }
}

/// Everything that Bevy would have cast: visible or off screen, but not hidden and not marked.
pub fn extract_casters(
    patch: Extract<Res<Patch>>,
    mut extracted: ResMut<ExtractedCasters>,
    meshes: Extract<
        Query<(
            Entity,
            &Mesh3d,
            &GlobalTransform,
            &InheritedVisibility,
            Has<NotShadowCaster>,
            Option<&RenderLayers>,
            Option<&MeshMaterial3d<StandardMaterial>>,
            Option<&EntityAabb>,
            Option<&SkinnedMesh>,
        )>,
    >,
    mesh_assets: Extract<Res<Assets<Mesh>>>,
    materials: Extract<Res<Assets<StandardMaterial>>>,
    bindposes: Extract<Res<Assets<SkinnedMeshInverseBindposes>>>,
    transforms: Extract<Query<&GlobalTransform>>,
) {
    let extracted = &mut *extracted;
    extracted.casters.clear();
    extracted.receivers = Aabb::EMPTY;
    if **patch != Patch::Applied {
        return;
    }
    for (entity, mesh, transform, visibility, is_no_caster, layers, material, aabb, skin) in &meshes {
        if !visibility.get() {
            continue;
        }
        let Some(bounds) = bounds_of(aabb, mesh, &mesh_assets) else { continue };
        let world_from_object = affine(&transform.affine());
        let skin = skin.and_then(|skin| skin_of(skin, bounds, &bindposes, &transforms));
        let world_bounds = skin.as_ref().map_or_else(|| moved(bounds, &world_from_object), |skin| skin.bounds);
        extracted.receivers = extracted.receivers.union(world_bounds);
        if is_no_caster {
            continue;
        }
        let surface = match material {
            Some(material) => match materials.get(material).map(CasterSurface::of_standard) {
                Some(Some(surface)) => surface,
                Some(None) => continue,
                // On its way.
                None => continue,
            },
            None => CasterSurface::Opaque,
        };
        extracted.casters.push(ExtractedCaster {
            entity,
            mesh: mesh.id(),
            world_from_object,
            bounds,
            layers: layers.map_or(1, layer_bits),
            surface,
            has_other_material: material.is_none(),
            skin,
        });
    }
}

/// The box that Bevy culls by, or the mesh's own where it does not.
fn bounds_of(aabb: Option<&EntityAabb>, mesh: &Mesh3d, meshes: &Assets<Mesh>) -> Option<Aabb> {
    if let Some(aabb) = aabb {
        let (center, half) = (aabb.center.to_array(), aabb.half_extents.to_array());
        let (center, half) = (glam::Vec3::from_array(center), glam::Vec3::from_array(half));
        return Some(Aabb { min: center - half, max: center + half });
    }
    let aabb = meshes.get(&mesh.0)?.final_aabb?;
    Some(Aabb { min: vec3(aabb.min.into()), max: vec3(aabb.max.into()) })
}

/// A skin's pose. A bent vertex lies between its places by each joint alone, so that their boxes hold it.
fn skin_of(
    skin: &SkinnedMesh,
    bounds: Aabb,
    bindposes: &Assets<SkinnedMeshInverseBindposes>,
    transforms: &Query<&GlobalTransform>,
) -> Option<ExtractedSkin> {
    let bindposes = bindposes.get(&skin.inverse_bindposes)?;
    let joints: Vec<glam::Mat4> = skin
        .joints
        .iter()
        .zip(bindposes.iter())
        .map(|(joint, bindpose)| {
            let world = transforms.get(*joint).map_or(glam::Mat4::IDENTITY, |joint| affine(&joint.affine()));
            world * mat4(bindpose)
        })
        .collect();
    let bounds = joints.iter().fold(Aabb::EMPTY, |all, joint| all.union(moved(bounds, joint)));
    (!joints.is_empty()).then_some(ExtractedSkin { joints, bounds })
}
