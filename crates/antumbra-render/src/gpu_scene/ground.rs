//! Ground that a scene was put on, which blocks light only if some light comes from below it.
//!
//! The ground is four of the scene's diagonals wide. As a caster it would fill most of a light map and take its texels from the scene. It
//! is always a receiver, and rays hit it as they hit everything else. If nothing lies beneath it and the light is above, no segment from a
//! receiver to the light crosses it, so that truth and masks agree.

use antumbra::MeshCaster;
use antumbra_light::{Light, LightShape};

use super::{Draw, GpuScene};

/// Tolerance of heights over the scene's diagonal, a few roundings of an f32: the ground is computed from the same corners as the box of a
/// mesh, but relative to another anchor.
const ROUNDING: f32 = 1e-6;

impl GpuScene {
    /// Casters that can block some of a light: all [`casters`](Self::casters), except for the ground that the scene was put on if nothing
    /// lies beneath it and the light is above.
    pub fn casters_for(&self, light: &Light) -> Vec<MeshCaster<'_>> {
        self.casters_of_lights().of(light).to_vec()
    }

    /// Casters for any number of lights, collected once.
    pub fn casters_of_lights(&self) -> CastersOfLights<'_> {
        let draws = self.draws.iter().enumerate().filter(|(draw, _)| Some(*draw) != self.ground);
        let mut casters: Vec<_> = draws.filter_map(|(_, draw)| self.caster(draw)).collect();
        let ground = self.ground.and_then(|ground| self.caster(&self.draws[ground]));
        casters.extend(ground);
        CastersOfLights { scene: self, casters, ends_with_ground: ground.is_some() }
    }

    fn stops_nothing(&self, ground: &Draw, light: &Light) -> bool {
        let height_m = ground.bounds.max.y;
        let lowest_m = height_m - ROUNDING * self.bounds.diagonal();
        self.draws.iter().all(|draw| draw.bounds.min.y >= lowest_m) && lies_above(light, height_m)
    }
}

/// Casters of a scene, for any of its lights.
#[derive(Debug)]
pub struct CastersOfLights<'a> {
    scene: &'a GpuScene,
    /// Casters; the ground that the scene was put on is the last.
    casters: Vec<MeshCaster<'a>>,
    ends_with_ground: bool,
}

impl<'a> CastersOfLights<'a> {
    /// All casters.
    pub fn all(&self) -> &[MeshCaster<'a>] {
        &self.casters
    }

    /// Casters of one light; see [`GpuScene::casters_for`].
    pub fn of(&self, light: &Light) -> &[MeshCaster<'a>] {
        let stops_nothing = |ground: usize| self.scene.stops_nothing(&self.scene.draws[ground], light);
        let is_idle = self.ends_with_ground && self.scene.ground.is_some_and(stops_nothing);
        &self.casters[..self.casters.len() - usize::from(is_idle)]
    }
}

/// Whether all points of a light, or all directions to a sun, are above a level plane.
fn lies_above(light: &Light, height_m: f32) -> bool {
    let radius = light.bounding_radius();
    match light.shape {
        // Directions to the sun: the reversed axis, and the disc about its end.
        LightShape::Sun { .. } => -light.axis.y > radius * light.axis.with_y(0.0).length(),
        _ => light.center.y - radius > height_m,
    }
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{Material, Scene};
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::test_support::{gpu_or_skip, quad};

    fn on_ground() -> Scene {
        let mut scene = Scene {
            meshes: vec![quad(1.0)],
            materials: vec![Material::default()],
            instances: vec![antumbra_scene::Instance { mesh: 0, world_from_object: glam::Mat4::from_rotation_x(0.7) }],
            ..Scene::default()
        };
        scene.add_ground();
        scene
    }

    #[test]
    fn a_ground_casts_only_where_light_comes_from_below_or_something_lies_there() {
        let Some(gpu) = gpu_or_skip() else { return };
        let scene = on_ground();
        let mut uploaded = GpuScene::upload(gpu, &scene);
        let level_m = scene.bounds().min.y;
        let rectangle = LightShape::Rectangle { size_m: Vec2::splat(0.2) };
        let at = |y: f32| Light::new(rectangle.clone(), Vec3::new(0.3, level_m + y, 0.2), Vec3::new(5.0, 0.0, 0.0));
        let sun =
            |y: f32| Light::new(LightShape::Sun { angular_diameter_rad: 0.2 }, Vec3::ZERO, Vec3::new(1.0, y, 0.0));
        let counts = [at(2.0), at(0.1), at(-2.0), sun(-1.0), sun(-0.05), sun(0.3)];
        let counts = counts.map(|light| uploaded.casters_for(&light).len());
        assert_eq!(counts, [1, 2, 2, 1, 2, 2]);
        assert_eq!(uploaded.casters().len(), 2);
        // An object that is moved beneath the ground is shadowed by it.
        uploaded.offset_instances(gpu, &[0], Vec3::NEG_Y);
        assert_eq!(uploaded.casters_for(&at(2.0)).len(), 2);
        uploaded.offset_instances(gpu, &[0], Vec3::Y);
        assert_eq!(uploaded.casters_for(&at(2.0)).len(), 1);
        // A scene far from the origin, relative to an anchor there.
        let mut far = scene;
        far.count_from(Vec3::new(1.0e4, 3.0, -7.0e3));
        let far = GpuScene::upload(gpu, &far);
        assert_eq!(far.casters_for(&at(2.0).relative_to(Vec3::new(1.0e4, 3.0, -7.0e3))).len(), 1);
    }

    /// A ground that belongs to the scene is an ordinary caster.
    #[test]
    fn grounds_of_scenes_are_left_as_they_are() {
        let Some(gpu) = gpu_or_skip() else { return };
        let scene = Scene { ground: None, ..on_ground() };
        let light = Light::new(LightShape::Sphere { radius_m: 0.1 }, Vec3::Y * 3.0, Vec3::ZERO);
        assert_eq!(GpuScene::upload(gpu, &scene).casters_for(&light).len(), 2);
    }
}
