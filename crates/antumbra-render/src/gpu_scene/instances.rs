//! Instances of a scene: their meshes, poses and bounds, and the lists of their matrices.

use antumbra_scene::{Aabb, Instance, Scene};
use glam::{Mat4, Vec3};

/// Instance as uploaded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Index into [`Scene::instances`](antumbra_scene::Scene::instances).
    pub instance: usize,
    pub world_from_object: Mat4,
    /// World-space bounding box.
    pub bounds: Aabb,
}

/// Largest number of vertex transforms per mesh for which world-space boxes are exact: a second's work on one core. Beyond
/// it, each instance's object-space box is transformed instead, which may be larger.
const EXACT_BOUNDS_WORK: usize = 1 << 24;

/// Instances of each mesh, with their indices in the scene.
pub(super) fn instances_by_mesh(scene: &Scene) -> Vec<Vec<(usize, &Instance)>> {
    let mut by_mesh = vec![Vec::new(); scene.meshes.len()];
    for (index, instance) in scene.instances.iter().enumerate() {
        by_mesh[instance.mesh].push((index, instance));
    }
    by_mesh
}

/// Lists of matrices that each fit a binding.
pub(super) struct InstanceLists {
    pub lists: Vec<Vec<Mat4>>,
    capacity: usize,
}

impl InstanceLists {
    pub fn new(binding_bytes: u64) -> Self {
        Self { lists: Vec::new(), capacity: binding_bytes as usize / size_of::<Mat4>() }
    }

    /// Adds poses; returns each contiguous run of them with its list and its position in the list.
    pub fn push_all<'p>(&mut self, mut poses: &'p [Mat4]) -> Vec<(&'p [Mat4], usize, u32)> {
        let mut runs = Vec::new();
        while !poses.is_empty() {
            if self.lists.last().is_none_or(|list| list.len() == self.capacity) {
                self.lists.push(Vec::new());
            }
            let index = self.lists.len() - 1;
            let list = &mut self.lists[index];
            let (run, rest) = poses.split_at(poses.len().min(self.capacity - list.len()));
            runs.push((run, index, list.len() as u32));
            list.extend_from_slice(run);
            poses = rest;
        }
        runs
    }
}

/// Returns each instance with its world-space bounding box.
pub(super) fn placed_at(positions: &[Vec3], instances: &[(usize, &Instance)]) -> Vec<Placed> {
    let object_box = Aabb::of(positions.iter().copied());
    let exact = positions.len().saturating_mul(instances.len()) <= EXACT_BOUNDS_WORK;
    let corners = object_box.corners();
    let points = if exact { positions } else { &corners };
    let place = |&(instance, &Instance { world_from_object, .. }): &(usize, &Instance)| {
        let bounds = Aabb::of(points.iter().map(|p| world_from_object.transform_point3(*p)));
        Placed { instance, world_from_object, bounds }
    };
    instances.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instance_lists_split_where_a_binding_ends() {
        let poses = [Mat4::IDENTITY; 5];
        let mut lists = InstanceLists::new(3 * size_of::<Mat4>() as u64);
        let runs = lists.push_all(&poses);
        assert_eq!(
            runs.iter().map(|(run, list, first)| (run.len(), *list, *first)).collect::<Vec<_>>(),
            [(3, 0, 0), (2, 1, 0)]
        );
    }
}
