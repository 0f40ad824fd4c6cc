//! Scene builder of the built-in scenes: adds meshes, materials, a camera and lights to a [`Scene`]. Also a palette.

use antumbra_light::{Light, LightShape};
use glam::{Affine3A, Mat4, Vec2, Vec3, Vec4};

use super::shapes::MeshBuilder;
use crate::{Camera, Instance, Material, Scene};

/// Linear RGB of common surfaces.
pub(super) mod palette {
    use glam::Vec3;

    pub const SAND: Vec3 = Vec3::new(0.55, 0.47, 0.37);
    pub const PLASTER: Vec3 = Vec3::new(0.70, 0.62, 0.51);
    pub const STONE: Vec3 = Vec3::new(0.48, 0.46, 0.42);
    pub const MARBLE: Vec3 = Vec3::new(0.74, 0.71, 0.65);
    pub const WOOD: Vec3 = Vec3::new(0.40, 0.22, 0.10);
    pub const PALE_WOOD: Vec3 = Vec3::new(0.58, 0.40, 0.22);
    pub const DARK_WOOD: Vec3 = Vec3::new(0.16, 0.085, 0.045);
    pub const IRON: Vec3 = Vec3::new(0.09, 0.09, 0.10);
    pub const STEEL: Vec3 = Vec3::new(0.42, 0.43, 0.45);
    pub const RUST: Vec3 = Vec3::new(0.33, 0.13, 0.06);
    pub const TERRACOTTA: Vec3 = Vec3::new(0.50, 0.19, 0.10);
    pub const SLATE_BLUE: Vec3 = Vec3::new(0.14, 0.23, 0.34);
    pub const OCHRE: Vec3 = Vec3::new(0.58, 0.36, 0.10);
    pub const RED_PAINT: Vec3 = Vec3::new(0.45, 0.07, 0.05);
    pub const TEAL_PAINT: Vec3 = Vec3::new(0.08, 0.29, 0.28);
    pub const LEAF: Vec3 = Vec3::new(0.11, 0.26, 0.05);
    pub const GRASS: Vec3 = Vec3::new(0.17, 0.33, 0.07);
    pub const BARK: Vec3 = Vec3::new(0.20, 0.13, 0.08);
    pub const MEADOW: Vec3 = Vec3::new(0.27, 0.34, 0.15);
}

/// Thickness of ground slabs, metres.
const GROUND_THICKNESS_M: f32 = 0.1;

/// Scene builder.
pub(super) struct Stage {
    pub scene: Scene,
}

impl Stage {
    pub fn new(name: &str) -> Self {
        Self { scene: Scene { name: name.into(), ..Scene::default() } }
    }

    /// Adds an opaque dielectric; returns its index.
    pub fn material(&mut self, name: &str, base_color: Vec3, roughness: f32) -> usize {
        self.push_material(Material {
            name: name.into(),
            base_color: base_color.extend(1.0),
            roughness,
            ..Material::default()
        })
    }

    /// Adds an opaque metal; returns its index.
    pub fn metal(&mut self, name: &str, base_color: Vec3, roughness: f32) -> usize {
        self.push_material(Material {
            name: name.into(),
            base_color: base_color.extend(1.0),
            metallic: 1.0,
            roughness,
            ..Material::default()
        })
    }

    pub fn push_material(&mut self, material: Material) -> usize {
        self.scene.materials.push(material);
        self.scene.materials.len() - 1
    }

    /// Adds a mesh without placing it; returns its index.
    pub fn mesh(&mut self, name: &str, material: usize, builder: MeshBuilder) -> usize {
        let mut mesh = builder.build(name, material);
        // Tints may brighten, but glTF requires vertex colours within [0, 1]: the excess moves to the material.
        let brightest = mesh.colors.iter().fold(Vec4::ONE, |brightest, color| brightest.max(*color));
        if brightest != Vec4::ONE {
            assert!(self.scene.meshes.iter().all(|other| other.material != material), "`{name}` shares its material");
            mesh.colors.iter_mut().for_each(|color| *color /= brightest);
            self.scene.materials[material].base_color *= brightest;
        }
        self.scene.meshes.push(mesh);
        self.scene.meshes.len() - 1
    }

    /// Places a mesh.
    pub fn instance(&mut self, mesh: usize, world_from_object: Affine3A) {
        self.scene.instances.push(Instance { mesh, world_from_object: Mat4::from(world_from_object) });
    }

    /// Adds a mesh whose positions are world positions.
    pub fn add(&mut self, name: &str, material: usize, builder: MeshBuilder) {
        let mesh = self.mesh(name, material, builder);
        self.instance(mesh, Affine3A::IDENTITY);
    }

    /// A slab with its top at y = 0; 12 triangles.
    pub fn ground(&mut self, center_xz: Vec2, size_xz_m: Vec2, color: Vec3) {
        let material = self.material("ground", color, 0.95);
        let half = 0.5 * size_xz_m;
        let (low, high) = (center_xz - half, center_xz + half);
        let mut slab = MeshBuilder::new();
        slab.box_between(Vec3::new(low.x, -GROUND_THICKNESS_M, low.y), Vec3::new(high.x, 0.0, high.y));
        self.add("ground", material, slab);
    }

    pub fn camera(&mut self, eye: Vec3, target: Vec3, fov_y_deg: f32) {
        self.scene.cameras.push(Camera {
            eye,
            target,
            up: Vec3::Y,
            fov_y_rad: fov_y_deg.to_radians(),
            near_m: 0.05,
            far_m: 200.0,
            shadow_distance: None,
        });
    }

    /// Adds a slightly warm light; the first one is the key light.
    pub fn light(&mut self, shape: LightShape, center: Vec3, target: Vec3) {
        const WARM_WHITE: Vec3 = Vec3::new(1.0, 0.95, 0.87);
        let mut light = Light::new(shape, center, target);
        light.color = WARM_WHITE;
        self.scene.lights.push(light);
    }

    /// A square light of side `side_m`.
    pub fn square_light(&mut self, side_m: f32, center: Vec3, target: Vec3) {
        self.light(LightShape::Rectangle { size_m: Vec2::splat(side_m) }, center, target);
    }

    pub fn triangle_count(&self) -> usize {
        self.scene.triangle_count()
    }
}

/// Brightness factor that varies parts of one material, as of boards and stones; `unit` is in `[0, 1)`.
pub(super) fn shade(unit: f32, spread: f32) -> Vec3 {
    Vec3::splat(1.0 + spread * (2.0 * unit - 1.0))
}
