//! A ground for scenes that have none.

use glam::{Mat4, Vec3, Vec4};

use crate::{Instance, Material, Mesh, Scene};

/// Side of the ground over the scene's diagonal: shadows of a light that stands half as high as the default's still end on
/// it.
const SIDE_DIAGONALS: f32 = 4.0;
/// Linear: paper in shade, so that neither light nor dark things vanish before it.
const GRAY: f32 = 0.5;

impl Scene {
    /// Puts a square under the scene, as high as the lowest point of its box and four of the box's diagonals wide. It is a
    /// mesh like all others and called `ground`. A scene without a triangle stays as it is.
    pub fn stand_on_ground(&mut self) {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return;
        }
        let half_m = 0.5 * SIDE_DIAGONALS * bounds.diagonal();
        let middle = bounds.center().with_y(bounds.min.y);
        let corner = |x: f32, z: f32| middle + half_m * Vec3::new(x, 0.0, z);
        let material = self.materials.len();
        self.materials.push(Material {
            name: "ground".into(),
            base_color: Vec4::new(GRAY, GRAY, GRAY, 1.0),
            roughness: 0.95,
            ..Material::default()
        });
        self.instances.push(Instance { mesh: self.meshes.len(), world_from_object: Mat4::IDENTITY });
        self.meshes.push(Mesh {
            name: "ground".into(),
            positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
            normals: vec![Vec3::Y; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            material,
            ..Mesh::default()
        });
    }
}

#[cfg(test)]
mod tests {
    use crate::{LoadOptions, Scene, load};

    #[test]
    fn the_ground_lies_under_all_and_faces_up() {
        let mut scene = load("builtin:knot?triangles=1000", &LoadOptions::default()).unwrap();
        let (before, triangles) = (scene.bounds(), scene.triangle_count());
        scene.stand_on_ground();
        let after = scene.bounds();
        assert_eq!((after.min.y, after.max.y, scene.triangle_count()), (before.min.y, before.max.y, triangles + 2));
        assert!((after.max.x - after.min.x - 4.0 * before.diagonal()).abs() < 1e-3);
        for triangle in
            scene.world_triangles().filter(|triangle| triangle.instance as usize == scene.instances.len() - 1)
        {
            let [a, b, c] = triangle.positions;
            assert!((b - a).cross(c - a).normalize().y > 0.999);
        }
        let mut nothing = Scene::default();
        nothing.stand_on_ground();
        assert!(nothing.meshes.is_empty());
    }
}
