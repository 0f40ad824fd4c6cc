//! Scenes far from the world's origin, where 32-bit floats are a millimetre apart. Coordinates are made relative to an anchor
//! near the camera, so that computations round as they do at the origin.
//!
//! The distance may be in a mesh's vertices or in its instances. Both are removed: a mesh whose vertices lie far from their own
//! origin gets an anchor as well, without losing any of the bits that the distance left. Products of matrices are computed in
//! double precision.

use antumbra_light::anchor_near;
use glam::{DMat4, DVec3, Vec3};

use crate::{Aabb, Camera, Scene, Setup};

impl Camera {
    /// Anchor near this camera, a world position; see [`anchor_near`].
    pub fn anchor(&self) -> Vec3 {
        anchor_near(self.eye)
    }

    /// Returns the camera in coordinates relative to `anchor`.
    pub fn relative_to(self, anchor: Vec3) -> Self {
        Self { eye: self.eye - anchor, target: self.target - anchor, ..self }
    }
}

impl Setup {
    /// Returns the setup in coordinates relative to `anchor`.
    pub fn relative_to(&self, anchor: Vec3) -> Self {
        Self {
            camera: self.camera.relative_to(anchor),
            lights: self.lights.iter().map(|light| light.relative_to(anchor)).collect(),
        }
    }
}

impl Scene {
    /// Makes the coordinates of the scene, its cameras and its lights relative to `anchor`.
    pub fn count_from(&mut self, anchor: Vec3) {
        if anchor == Vec3::ZERO {
            return;
        }
        let mesh_anchors: Vec<Vec3> = (self.meshes.iter_mut())
            .map(|mesh| {
                let bounds = Aabb::of(mesh.positions.iter().copied());
                let anchor = if mesh.positions.is_empty() { Vec3::ZERO } else { anchor_near(bounds.center()) };
                mesh.positions.iter_mut().for_each(|position| *position -= anchor);
                anchor
            })
            .collect();
        for instance in &mut self.instances {
            let moved = |by: Vec3| DMat4::from_translation(DVec3::from(by));
            let world_from_object = instance.world_from_object.as_dmat4();
            instance.world_from_object =
                (moved(-anchor) * world_from_object * moved(mesh_anchors[instance.mesh])).as_mat4();
        }
        self.cameras.iter_mut().for_each(|camera| *camera = camera.relative_to(anchor));
        self.lights.iter_mut().for_each(|light| *light = light.relative_to(anchor));
    }
}

#[cfg(test)]
mod tests {
    use antumbra_light::LightShape;

    use super::*;
    use crate::{LoadOptions, load};

    /// Ten kilometres away, between points of the anchors' grid.
    const AWAY: Vec3 = Vec3::new(10_000.0, 0.0, -7_300.0);

    /// Largest distance from an anchor in these tests, metres.
    const NEAR_M: f32 = 64.0;

    fn corners(scene: &Scene) -> Vec<Vec3> {
        let of = |instance: &crate::Instance| {
            let to_world = instance.world_from_object;
            scene.meshes[instance.mesh].positions.iter().map(move |p| to_world.transform_point3(*p)).collect::<Vec<_>>()
        };
        scene.instances.iter().flat_map(of).collect()
    }

    #[test]
    fn near_scenes_are_not_shifted() {
        let mut scene = load("builtin:columns", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        let before = corners(&scene);
        assert_eq!(setup.camera.anchor(), Vec3::ZERO);
        scene.count_from(setup.camera.anchor());
        assert_eq!(corners(&scene), before);
        assert_eq!(setup.relative_to(Vec3::ZERO), setup);
    }

    /// A far scene, whether its vertices or its instances are far away, equals the scene at the origin within the precision
    /// that the distance left.
    #[test]
    fn far_scenes_are_relative_to_their_camera() {
        let scene = load("builtin:columns", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        let (mut in_corners, mut in_instances) = (scene.clone(), scene.clone());
        for mesh in &mut in_corners.meshes {
            mesh.positions.iter_mut().for_each(|p| *p += AWAY);
        }
        for instance in &mut in_corners.instances {
            let moved = |by: Vec3| DMat4::from_translation(DVec3::from(by));
            let turned = moved(AWAY) * instance.world_from_object.as_dmat4() * moved(-AWAY);
            instance.world_from_object = turned.as_mat4();
        }
        for instance in &mut in_instances.instances {
            instance.world_from_object.w_axis += AWAY.extend(0.0);
        }
        let far = setup.relative_to(-AWAY);
        let anchor = far.camera.anchor();
        assert!(anchor.distance(AWAY) < NEAR_M, "{anchor}");
        for mut moved in [in_corners, in_instances] {
            moved.count_from(anchor);
            let furthest = (corners(&moved).iter().zip(corners(&scene)))
                .map(|(moved, at_origin)| (*moved + anchor - AWAY).distance(at_origin))
                .fold(0.0, f32::max);
            assert!(furthest < 0.003, "{furthest} m");
            let largest = moved.meshes.iter().flat_map(|mesh| &mesh.positions).map(|p| p.abs().max_element());
            assert!(largest.fold(0.0, f32::max) < NEAR_M, "corners stay near their mesh's origin");
        }
        let near = far.relative_to(anchor);
        assert!((near.camera.eye + anchor - AWAY).distance(setup.camera.eye) < 0.001);
        assert!((near.lights[0].center + anchor - AWAY).distance(setup.lights[0].center) < 0.001);
    }

    #[test]
    fn points_of_a_light_move_with_it() {
        let mut light = Setup::for_scene(&load("builtin:overlap", &LoadOptions::default()).unwrap()).lights.remove(0);
        light.shape = LightShape::Points { positions_m: vec![AWAY, AWAY + Vec3::X] };
        let LightShape::Points { positions_m } = light.relative_to(AWAY).shape else { unreachable!() };
        assert_eq!(positions_m, [Vec3::ZERO, Vec3::X]);
    }
}
