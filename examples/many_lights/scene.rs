//! Scene of the host: objects and their motion, lights and cameras.

use std::f32::consts::TAU;

use antumbra::light::{EmissionTexture, Light, LightShape};
use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Quat, Vec2, Vec3};

use super::meshes::{JOINT_LENGTH_M, JOINTS, Meshes, Part};

/// Part of a model, placed once or several times.
pub struct Object {
    pub part: Part,
    pub color: Vec3,
    /// Alpha of the leaf texture below which fragments are discarded; 0 without holes.
    pub alpha_cutoff: f32,
    pub motion: Motion,
    pub world_from_object: Vec<Mat4>,
}

/// Motion of an object.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Still,
    Sways,
    Tumbles,
    /// Moves around the centre, one after the other.
    Circles,
    /// Stays in place; its skin moves.
    Bends,
}

/// Camera with a finite far plane.
#[derive(Clone, Copy)]
pub struct Camera {
    pub eye: Vec3,
    pub target: Vec3,
    pub fov_y_rad: f32,
    pub near_m: f32,
    pub far_m: f32,
}

impl Camera {
    pub fn view_from_world(&self) -> Mat4 {
        look_at_mat4(self.eye, self.target, Vec3::Y)
    }

    /// Returns the projection; depth is 0 near and 1 far.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        perspective(self.fov_y_rad, aspect, self.near_m, self.far_m)
    }
}

pub struct Scene {
    pub meshes: Meshes,
    pub objects: Vec<Object>,
    /// Skinning matrices: from the undeformed model to its pose.
    pub joints: [Mat4; JOINTS],
    pub lights: [Light; 8],
    pub cameras: [Camera; 2],
}

impl Scene {
    pub fn new() -> Self {
        let mut meshes = Meshes::default();
        let mut objects = Vec::new();
        let mut add = |part, color: [f32; 3], motion, places: &[[f32; 3]]| {
            let world_from_object = places.iter().map(|place| Mat4::from_translation(Vec3::from(*place))).collect();
            objects.push(Object { part, color: Vec3::from(color), alpha_cutoff: 0.0, motion, world_from_object });
        };
        let [trunk, leaves] = meshes.add_tree();
        let tree_at = [[-1.5, 0.0, -0.5]];
        add(leaves, [0.3, 0.6, 0.15], Motion::Sways, &tree_at);
        add(trunk, [0.45, 0.3, 0.2], Motion::Sways, &tree_at);
        let ground = meshes.add_box(Vec3::new(-4.0, -0.3, -4.0), Vec3::new(4.0, 0.0, 4.0));
        add(ground, [0.7; 3], Motion::Still, &[[0.0; 3]]);
        let pillar = meshes.add_box(Vec3::new(-0.15, -0.1, -0.15), Vec3::new(0.15, 1.6, 0.15));
        add(pillar, [0.75, 0.7, 0.6], Motion::Still, &[[1.8, 0.0, -1.6], [0.2, 0.0, -2.2], [2.4, 0.0, 0.4]]);
        add(meshes.add_ring(), [0.8, 0.6, 0.25], Motion::Tumbles, &[[1.1, 0.7, 0.9]]);
        add(meshes.add_reed(), [0.45, 0.5, 0.75], Motion::Bends, &[[-0.5, -0.02, 1.1]]);
        let block = meshes.add_box(Vec3::splat(-0.14), Vec3::splat(0.14));
        add(block, [0.75, 0.35, 0.3], Motion::Circles, &[[0.0; 3]; 6]);
        objects[0].alpha_cutoff = 0.5;

        let camera = |eye, target| Camera { eye, target, fov_y_rad: 0.7, near_m: 0.2, far_m: 40.0 };
        let cameras = [
            camera(Vec3::new(-3.6, 3.4, 4.9), Vec3::new(-0.1, 0.4, 0.0)),
            camera(Vec3::new(4.4, 2.2, 3.6), Vec3::new(0.2, 0.5, -0.1)),
        ];
        let mut scene = Self { meshes, objects, joints: [Mat4::IDENTITY; JOINTS], lights: lights(), cameras };
        scene.move_to(0.0);
        scene
    }

    /// Returns the first index of an object's matrices in the instance buffer.
    pub fn first_instance(&self, object: usize) -> u32 {
        self.objects[..object].iter().map(|object| object.world_from_object.len() as u32).sum()
    }

    /// Moves everything to its place at a time in seconds.
    pub fn move_to(&mut self, time_s: f32) {
        for Object { motion, world_from_object, .. } in &mut self.objects {
            let count = world_from_object.len();
            for (i, matrix) in world_from_object.iter_mut().enumerate() {
                let place = matrix.w_axis.truncate();
                *matrix = match motion {
                    Motion::Still | Motion::Bends => continue,
                    Motion::Sways => {
                        let sway = Quat::from_rotation_z(0.12 * (1.3 * time_s).sin());
                        Mat4::from_rotation_translation(sway, place)
                    }
                    Motion::Tumbles => {
                        let turn = Quat::from_rotation_y(0.7 * time_s) * Quat::from_rotation_x(1.0 + 0.9 * time_s);
                        Mat4::from_rotation_translation(turn, place)
                    }
                    Motion::Circles => {
                        let angle = i as f32 / count as f32 * TAU + 0.5 * time_s;
                        let height = 0.45 + 0.3 * (3.0 * angle).sin();
                        let place = Vec3::new(3.1 * angle.cos(), height, 3.1 * angle.sin());
                        Mat4::from_rotation_translation(Quat::from_rotation_y(3.0 * angle), place)
                    }
                };
            }
        }
        // Each joint rotates relative to the one below, about its own base.
        let mut pose = Mat4::IDENTITY;
        for (j, joint) in self.joints.iter_mut().enumerate() {
            let foot = Mat4::from_translation(JOINT_LENGTH_M * j as f32 * Vec3::Y);
            let bend = Quat::from_rotation_y(0.5 * time_s) * Quat::from_rotation_z(0.35 + 0.15 * (1.7 * time_s).sin());
            let bend = if j == 0 { Quat::IDENTITY } else { bend };
            pose *= foot * Mat4::from_quat(bend) * foot.inverse();
            *joint = pose;
        }
        let round = Quat::from_rotation_y(0.4 * time_s);
        self.lights[2].center = Vec3::new(0.0, 2.9, 0.0) + round * Vec3::new(0.0, 0.0, -2.6);
    }
}

/// Returns lights of every shape. Each has its own size in metres, which alone determines the softness of its shadows.
fn lights() -> [Light; 8] {
    let light = |name: &str, shape, center, color| {
        let light = Light::new(shape, Vec3::from(center), Vec3::new(0.0, 0.2, 0.0));
        Light { name: name.into(), color: Vec3::from(color), ..light }
    };
    let bulb = |i: u32| {
        let (sin, cos) = (i as f32 / 6.0 * TAU).sin_cos();
        Vec3::new(-1.9 + 0.3 * cos, 3.3, -2.4 + 0.3 * sin)
    };
    // A window of four panes.
    let pane = |i: u32| if i % 9 == 4 || i / 9 == 4 { 0.0 } else { 1.0 };
    let panes = EmissionTexture::gray(9, 9, (0..81).map(pane).collect());
    let window = LightShape::Rectangle { size_m: Vec2::splat(0.8) };
    let mut lights = [
        light("panel", LightShape::Rectangle { size_m: Vec2::new(1.0, 0.5) }, [2.6, 4.2, 2.4], [15.0, 12.5, 10.0]),
        light("lamp", LightShape::Disk { radius_m: 0.2 }, [-3.0, 3.8, 2.2], [1.8, 2.2, 3.2]),
        light("globe", LightShape::Sphere { radius_m: 0.2 }, [0.0, 2.9, -2.6], [2.2, 1.3, 0.7]),
        light("tube", LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.12, 0.12) }, [3.4, 3.0, -2.2], [0.9, 2.2, 2.0]),
        light("sun", LightShape::Sun { angular_diameter_rad: 0.03 }, [2.0, 5.0, 5.0], [0.10, 0.09, 0.08]),
        light(
            "bulbs",
            LightShape::Points { positions_m: (0..6).map(bulb).collect() },
            [-1.9, 3.3, -2.4],
            [2.0, 1.0, 1.5],
        ),
        Light { emission: Some(panes), ..light("window", window, [-3.6, 3.0, 0.4], [2.2, 2.2, 1.7]) },
        light("spot", LightShape::Disk { radius_m: 0.08 }, [0.6, 4.0, 3.2], [6.0, 5.6, 2.2]),
    ];
    lights[7].fov_rad = Some(0.5);
    lights
}
