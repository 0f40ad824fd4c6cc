//! Update of an uploaded scene to another time: what moved is written again, everything else stays as uploaded.

use std::collections::HashMap;

use antumbra::Gpu;
use antumbra_scene::{Aabb, Mesh, Scene};
use glam::Vec3;

use super::GpuScene;
use super::instances::{instances_by_mesh, placed_at};
use super::split::{MeshPart, split_mesh};
use super::upload::binding_bytes;

impl GpuScene {
    /// Turns this upload of `before` into one of `after` by writing the vertices and poses that differ. The queue copies before the
    /// next submission. Images are not compared.
    ///
    /// Returns false and changes nothing if meshes, triangles, materials or instances differ, or if the scene was uploaded by
    /// [`upload_with_faces`](Self::upload_with_faces): then upload anew.
    pub fn repose(&mut self, gpu: &Gpu, before: &Scene, after: &Scene) -> bool {
        if self.geometries.iter().any(|geometry| geometry.faces.is_some()) || !are_built_alike(before, after) {
            return false;
        }
        let binding_bytes = binding_bytes(gpu);
        let mut draws_of_geometry: HashMap<usize, Vec<usize>> = HashMap::new();
        for (index, draw) in self.draws.iter().enumerate() {
            draws_of_geometry.entry(draw.geometry).or_default().push(index);
        }
        let is_posed_anew = |index: &(usize, _)| {
            before.instances[index.0].world_from_object != after.instances[index.0].world_from_object
        };
        let mut geometry = 0;
        for ((mesh, old), instances) in after.meshes.iter().zip(&before.meshes).zip(instances_by_mesh(after)) {
            if mesh.indices.len() < 3 || instances.is_empty() {
                continue;
            }
            let is_bent = mesh.positions != old.positions || mesh.normals != old.normals;
            let is_moved = is_bent || instances.iter().any(is_posed_anew);
            for part in split_mesh(mesh, binding_bytes) {
                if is_bent {
                    self.write_vertices(gpu, geometry, &part);
                }
                for draw in draws_of_geometry.get(&geometry).into_iter().flatten().filter(|_| is_moved) {
                    self.write_poses(gpu, *draw, &part, after);
                }
                geometry += 1;
            }
        }
        self.bounds = self.draws.iter().fold(Aabb::EMPTY, |bounds, draw| bounds.union(draw.bounds));
        true
    }

    fn write_vertices(&mut self, gpu: &Gpu, geometry: usize, part: &MeshPart<'_>) {
        let geometry = &mut self.geometries[geometry];
        geometry.version.vertices += 1;
        let buffers = &self.buffers[geometry.place.buffers];
        let place = u64::from(geometry.place.first_vertex) * size_of::<Vec3>() as u64;
        gpu.queue().write_buffer(&buffers.positions, place, bytemuck::cast_slice(&part.positions));
        gpu.queue().write_buffer(&buffers.normals, place, bytemuck::cast_slice(&part.normals));
    }

    fn write_poses(&mut self, gpu: &Gpu, draw: usize, part: &MeshPart<'_>, scene: &Scene) {
        let draw = &mut self.draws[draw];
        let instances: Vec<_> =
            draw.placed.iter().map(|placed| (placed.instance, &scene.instances[placed.instance])).collect();
        let poses: Vec<_> = instances.iter().map(|(_, instance)| instance.world_from_object).collect();
        let place = u64::from(draw.first_instance) * size_of_val(&poses[0]) as u64;
        gpu.queue().write_buffer(&self.instances[draw.instances], place, bytemuck::cast_slice(&poses));
        draw.placed = placed_at(&part.positions, &instances);
        draw.bounds = draw.placed.iter().fold(Aabb::EMPTY, |bounds, one| bounds.union(one.bounds));
    }
}

/// Whether two scenes have the same triangles, materials and instances, apart from positions and poses.
fn are_built_alike(a: &Scene, b: &Scene) -> bool {
    let are_alike = |a: &Mesh, b: &Mesh| {
        let lengths = |mesh: &Mesh| [mesh.positions.len(), mesh.normals.len()];
        (lengths(a), a.material, a.closed) == (lengths(b), b.material, b.closed)
            && (&a.indices, &a.uvs, &a.colors) == (&b.indices, &b.uvs, &b.colors)
    };
    // Mirrored instances are drawn separately.
    let is_mirrored = |instance: &antumbra_scene::Instance| instance.world_from_object.determinant() < 0.0;
    let sizes = |scene: &Scene| [scene.meshes.len(), scene.instances.len()];
    sizes(a) == sizes(b)
        && a.materials == b.materials
        && a.meshes.iter().zip(&b.meshes).all(|(a, b)| are_alike(a, b))
        && a.instances.iter().zip(&b.instances).all(|(a, b)| a.mesh == b.mesh && is_mirrored(a) == is_mirrored(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{gpu_or_skip, quad};
    use antumbra_scene::{Instance, Material};
    use glam::Mat4;

    fn two_quads() -> Scene {
        let at = |mesh, x: f32| Instance { mesh, world_from_object: Mat4::from_translation(Vec3::X * x) };
        Scene {
            meshes: vec![quad(1.0), Mesh::default(), quad(2.0)],
            materials: vec![Material::default()],
            instances: vec![at(0, 0.0), at(2, 5.0), at(0, 10.0)],
            ..Scene::default()
        }
    }

    #[test]
    fn what_moves_takes_its_bounds_along() {
        let Some(gpu) = gpu_or_skip() else { return };
        let before = two_quads();
        let mut uploaded = GpuScene::upload(gpu, &before);
        let mut after = before.clone();
        after.instances[2].world_from_object = Mat4::from_translation(Vec3::new(20.0, 1.0, 0.0));
        after.meshes[2].positions.iter_mut().for_each(|p| *p += 3.0 * Vec3::Y);
        assert!(uploaded.repose(gpu, &before, &after));
        assert_eq!(uploaded.bounds, after.bounds());
        let bounds_of = |scene: &GpuScene| scene.casters().iter().map(|caster| caster.bounds).collect::<Vec<_>>();
        assert_eq!(bounds_of(&uploaded), bounds_of(&GpuScene::upload(gpu, &after)));
        // Moved instances are placed relative to the new pose.
        uploaded.offset_instances(gpu, &[2], Vec3::ZERO);
        assert_eq!(uploaded.bounds, after.bounds());
    }

    #[test]
    fn what_is_built_otherwise_is_refused() {
        let Some(gpu) = gpu_or_skip() else { return };
        let before = two_quads();
        let mut uploaded = GpuScene::upload(gpu, &before);
        let at_rest = uploaded.bounds;
        let changes: [fn(&mut Scene); 5] = [
            |scene| scene.instances.truncate(2),
            |scene| scene.meshes[0].indices.truncate(3),
            |scene| scene.materials[0].metallic = 0.5,
            |scene| scene.instances[1].mesh = 0,
            |scene| scene.instances[1].world_from_object = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)),
        ];
        for change in changes {
            let mut after = before.clone();
            change(&mut after);
            assert!(!uploaded.repose(gpu, &before, &after));
            assert_eq!(uploaded.bounds, at_rest);
        }
        assert!(!GpuScene::upload_with_faces(gpu, &before).repose(gpu, &before, &before));
    }
}
