//! Bounds of morph targets.
//!
//! A light's map is fitted to casters' bounds. A morphed mesh can leave its undeformed bounds, and Bevy stores no others.

use std::collections::HashMap;

use antumbra::light::Aabb;
use bevy::asset::{AssetEvent, AssetId};
use bevy::prelude::*;

use crate::convert::vec3;

/// For each mesh, the bounds of each morph target's position differences. A resource of the main world.
#[derive(Resource, Default)]
pub struct MorphBoxes(HashMap<AssetId<Mesh>, Vec<Aabb>>);

impl MorphBoxes {
    /// Returns the bounds of a morphed mesh; `bounds` are its undeformed ones.
    pub fn morphed(&self, mesh: AssetId<Mesh>, bounds: Aabb, weights: &[f32]) -> Aabb {
        let Some(boxes) = self.0.get(&mesh) else { return bounds };
        boxes.iter().zip(weights).fold(bounds, |all, (of_target, weight)| {
            let (a, b) = (*weight * of_target.min, *weight * of_target.max);
            Aabb { min: all.min + a.min(b), max: all.max + a.max(b) }
        })
    }

    /// Returns the number of morph targets of a mesh.
    pub fn target_count(&self, mesh: AssetId<Mesh>) -> usize {
        self.0.get(&mesh).map_or(0, Vec::len)
    }
}

/// Measures meshes when they are added: some leave the main world in the same frame.
pub fn measure_morphs(
    mut boxes: ResMut<MorphBoxes>,
    mut events: MessageReader<AssetEvent<Mesh>>,
    meshes: Res<Assets<Mesh>>,
) {
    for event in events.read() {
        match event {
            AssetEvent::Added { id } | AssetEvent::Modified { id } => {
                let Some(mesh) = meshes.get(*id) else { continue };
                // A mesh that is in the render world alone was measured when it was added.
                let Ok(is_morphed) = mesh.try_has_morph_targets() else { continue };
                let targets = is_morphed.then(|| mesh.get_morph_targets()).flatten();
                match targets {
                    Some(targets) => {
                        boxes.0.insert(*id, boxes_of(targets, mesh.count_vertices()));
                    }
                    None => {
                        boxes.0.remove(id);
                    }
                }
            }
            AssetEvent::Removed { id } => {
                boxes.0.remove(id);
            }
            _ => {}
        }
    }
}

fn boxes_of(targets: &[bevy::mesh::morph::MorphAttributes], vertex_count: usize) -> Vec<Aabb> {
    let of_target =
        |vertices: &[bevy::mesh::morph::MorphAttributes]| Aabb::of(vertices.iter().map(|vertex| vec3(vertex.position)));
    targets.chunks_exact(vertex_count.max(1)).map(of_target).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_grows_by_what_its_targets_weigh() {
        let id = AssetId::default();
        let of_target = Aabb { min: glam::Vec3::new(-1.0, 0.0, 0.0), max: glam::Vec3::new(0.0, 2.0, 0.0) };
        let boxes = MorphBoxes(HashMap::from([(id, vec![of_target])]));
        let bounds = Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::ONE };
        let up = boxes.morphed(id, bounds, &[0.5]);
        assert_eq!((up.min, up.max), (glam::Vec3::new(-0.5, 0.0, 0.0), glam::Vec3::new(1.0, 2.0, 1.0)));
        let down = boxes.morphed(id, bounds, &[-1.0]);
        assert_eq!((down.min, down.max), (glam::Vec3::new(0.0, -2.0, 0.0), glam::Vec3::new(2.0, 1.0, 1.0)));
    }
}
