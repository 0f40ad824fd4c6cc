//! The tracer agrees with closed forms, with brute force, and with itself.

mod brute_force;
mod cases;
mod closed_forms;
mod robustness;
mod scenes;
mod surfaces;

use std::sync::atomic::AtomicBool;

use antumbra_light::{Light, hash_u32, unit_f32};
use antumbra_scene::{Camera, Instance, Material, Mesh, Scene};
use glam::{Mat4, UVec2, Vec2, Vec3};

use crate::{ReceiverPoint, Receivers, Tracer, VisibilityImage, VisibilityOptions};

/// A scene of bare triangles with one material.
fn scene_of(triangles: &[[Vec3; 3]]) -> Scene {
    let mut scene = Scene { name: "test".into(), ..Scene::default() };
    add_mesh(&mut scene, triangles, Material::default());
    scene
}

/// Adds an instance of bare triangles; returns the index of its mesh.
fn add_mesh(scene: &mut Scene, triangles: &[[Vec3; 3]], material: Material) -> usize {
    let positions: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    scene.materials.push(material);
    scene.meshes.push(Mesh {
        normals: vec![Vec3::Y; positions.len()],
        indices: (0..positions.len() as u32).collect(),
        positions,
        material: scene.materials.len() - 1,
        ..Mesh::default()
    });
    scene.instances.push(Instance { mesh: scene.meshes.len() - 1, world_from_object: Mat4::IDENTITY });
    scene.meshes.len() - 1
}

/// Two triangles over the parallelogram at `corner` with sides `u` and `v`.
fn parallelogram(corner: Vec3, u: Vec3, v: Vec3) -> Vec<[Vec3; 3]> {
    let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
    vec![[a, b, c], [a, c, d]]
}

/// A sphere of `2 · columns · rows` triangles.
fn sphere(center: Vec3, radius: f32, columns: u32, rows: u32) -> Vec<[Vec3; 3]> {
    let at = |i: u32, j: u32| {
        let (phi, theta) = (
            std::f32::consts::TAU * (i % columns) as f32 / columns as f32,
            std::f32::consts::PI * j as f32 / rows as f32,
        );
        // Each pole is one point rather than a ring of rounded zeros.
        let sin_theta = if j == 0 || j == rows { 0.0 } else { theta.sin() };
        center + radius * Vec3::new(sin_theta * phi.cos(), theta.cos(), sin_theta * phi.sin())
    };
    let quads = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A stream of numbers in [0, 1).
struct Random(u32);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = hash_u32(self.0.wrapping_add(0x9e37_79b9));
        unit_f32(self.0)
    }

    fn in_cube(&mut self, half: f32) -> Vec3 {
        half * (2.0 * Vec3::new(self.next(), self.next(), self.next()) - 1.0)
    }
}

fn soup(count: usize, half: f32, size: f32, seed: u32) -> Vec<[Vec3; 3]> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let at = random.in_cube(half);
            [0; 3].map(|_| at + random.in_cube(size))
        })
        .collect()
}

fn never() -> AtomicBool {
    AtomicBool::new(false)
}

fn visibility(tracer: &Tracer, receivers: &Receivers, light: &Light, options: &VisibilityOptions) -> VisibilityImage {
    tracer.visibility(receivers, light, options, &|_| {}, &never()).expect("a valid light")
}

/// Visibility at points with normal +y.
fn visibility_on_floor(tracer: &Tracer, light: &Light, points: &[Vec3]) -> Vec<f32> {
    let points: Vec<_> = points.iter().map(|p| ReceiverPoint::new(*p, Vec3::Y)).collect();
    let options = VisibilityOptions { samples: 4096, ..VisibilityOptions::default() };
    let image = tracer.visibility_at(&points, light, &options, &|_| {}, &never()).expect("a valid light");
    image.values.iter().map(|v| v[0]).collect()
}

fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera { eye, target, up: Vec3::Y, fov_y_rad: 0.8, near_m: 0.01, far_m: 1000.0, shadow_distance: None }
}

const SMALL: UVec2 = UVec2::new(48, 27);

fn rms(differences: impl IntoIterator<Item = f32>) -> f32 {
    let (sum, count) = differences.into_iter().fold((0.0f64, 0u32), |(s, n), d| (s + f64::from(d * d), n + 1));
    (sum / f64::from(count.max(1))).sqrt() as f32
}

fn offsets(count: usize, from: f32, to: f32) -> impl Iterator<Item = f32> {
    (0..count).map(move |i| from + (to - from) * i as f32 / (count - 1) as f32)
}

fn square(side: f32) -> antumbra_light::LightShape {
    antumbra_light::LightShape::Rectangle { size_m: Vec2::splat(side) }
}
