//! Triangles, cameras and the base scene.

use antumbra::light::{Aabb, Light, LightShape};
use glam::camera::rh::{proj::directx, view::look_at_mat4};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// A mesh.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Object-space positions.
    pub positions: Vec<Vec3>,
    /// Three indices per triangle, counter-clockwise from outside.
    pub indices: Vec<u16>,
    /// Whether the mesh is watertight.
    pub closed: bool,
}

impl Mesh {
    /// A box.
    pub fn cuboid(min: Vec3, max: Vec3) -> Self {
        let corner =
            |i: u32| Vec3::new(pick(i & 1, min.x, max.x), pick(i & 2, min.y, max.y), pick(i & 4, min.z, max.z));
        let quads: [[u16; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let indices = quads.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
        Self { positions: (0..8).map(corner).collect(), indices, closed: true }
    }

    /// A horizontal square of ±`half_m` at height 0, seen from above.
    pub fn ground(half_m: f32) -> Self {
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
        Self {
            positions: corners.iter().map(|(x, z)| half_m * Vec3::new(*x, 0.0, *z)).collect(),
            indices: vec![0, 1, 2, 0, 2, 3],
            closed: false,
        }
    }

    /// Object-space bounding box.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.positions.iter().copied())
    }
}

fn pick(bit: u32, min: f32, max: f32) -> f32 {
    if bit == 0 { min } else { max }
}

/// A mesh with a transform.
#[derive(Clone, Debug)]
pub struct Object {
    /// The mesh.
    pub mesh: Mesh,
    /// World-from-object matrix.
    pub world_from_object: Mat4,
}

impl Object {
    /// Creates an object with the identity transform.
    pub fn of(mesh: Mesh) -> Self {
        Self { mesh, world_from_object: Mat4::IDENTITY }
    }

    /// World-space vertices of each triangle.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        let corner = |i: u16| self.world_from_object.transform_point3(self.mesh.positions[usize::from(i)]);
        self.mesh.indices.chunks_exact(3).map(move |t| [corner(t[0]), corner(t[1]), corner(t[2])])
    }
}

/// Objects that cast and receive.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// All objects.
    pub objects: Vec<Object>,
}

impl Scene {
    /// World-space vertices of every triangle.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        self.objects.iter().flat_map(Object::triangles).collect()
    }

    /// World-space bounding box of all triangles.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.triangles().into_iter().flatten())
    }

    /// The base scene: a ground of ±`ground_half_m` that casts, and four boxes.
    pub fn base(ground_half_m: f32) -> Self {
        let mut objects = vec![Object::of(Mesh::ground(ground_half_m))];
        let unit = Mesh::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5));
        for (place, size, turn) in [
            (Vec3::new(-1.6, 0.0, 0.3), Vec3::new(0.8, 1.5, 0.8), 0.4),
            (Vec3::new(0.2, 0.0, -1.1), Vec3::new(1.2, 0.7, 0.6), -0.3),
            (Vec3::new(1.5, 0.0, 0.9), Vec3::new(0.5, 2.2, 0.5), 0.9),
            (Vec3::new(-0.3, 1.3, 1.2), Vec3::new(1.4, 0.1, 0.7), 0.2),
        ] {
            let matrix = Mat4::from_translation(place) * Mat4::from_rotation_y(turn) * Mat4::from_scale(size);
            objects.push(Object { mesh: unit.clone(), world_from_object: matrix });
        }
        Self { objects }
    }
}

/// A camera with its image size.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Position, metres.
    pub eye: Vec3,
    /// Target position, metres.
    pub target: Vec3,
    /// Full vertical angle of a perspective camera, radians.
    pub fov_y_rad: f32,
    /// Height of an orthographic camera's view, metres; `None` for a perspective camera.
    pub height_m: Option<f32>,
    /// Near plane, metres.
    pub near_m: f32,
    /// Far plane, metres; `None` is infinite.
    pub far_m: Option<f32>,
    /// Whether depth is reversed: 1 at the near plane.
    pub is_reversed: bool,
    /// Width and height, pixels.
    pub size_px: UVec2,
}

impl Camera {
    /// The base scene's camera: 160 × 90 pixels, reversed infinite depth from 10 cm on.
    pub fn base() -> Self {
        Self {
            eye: Vec3::new(4.0, 5.0, 8.0),
            target: Vec3::new(0.0, 0.6, 0.0),
            fov_y_rad: 0.8,
            height_m: None,
            near_m: 0.1,
            far_m: None,
            is_reversed: true,
            size_px: UVec2::new(160, 90),
        }
    }

    /// View matrix.
    pub fn view_from_world(&self) -> Mat4 {
        look_at_mat4(self.eye, self.target, Vec3::Y)
    }

    /// Projection matrix.
    ///
    /// # Panics
    /// Panics if an orthographic camera has no far plane.
    pub fn clip_from_view(&self) -> Mat4 {
        let aspect = self.size_px.x as f32 / self.size_px.y as f32;
        if let Some(height_m) = self.height_m {
            let up = 0.5 * height_m;
            let far_m = self.far_m.expect("an orthographic camera ends somewhere");
            let (nearer, farther) = if self.is_reversed { (far_m, self.near_m) } else { (self.near_m, far_m) };
            return directx::orthographic(-up * aspect, up * aspect, -up, up, nearer, farther);
        }
        match (self.far_m, self.is_reversed) {
            (None, true) => directx::perspective_infinite_reverse(self.fov_y_rad, aspect, self.near_m),
            (Some(far_m), false) => directx::perspective(self.fov_y_rad, aspect, self.near_m, far_m),
            // Exchanging near and far plane reverses depth.
            (Some(far_m), true) => directx::perspective(self.fov_y_rad, aspect, far_m, self.near_m),
            (None, false) => directx::perspective_infinite(self.fov_y_rad, aspect, self.near_m),
        }
    }

    /// Clear value of the depth buffer.
    pub fn background_depth(&self) -> f32 {
        if self.is_reversed { 0.0 } else { 1.0 }
    }
}

/// The base scene's light: a rectangle of 1.2 × .8 m.
pub fn base_light() -> Light {
    base_light_of(LightShape::Rectangle { size_m: Vec2::new(1.2, 0.8) })
}

/// A light of another shape at the base light's position.
pub fn base_light_of(shape: LightShape) -> Light {
    Light::new(shape, Vec3::new(-3.0, 6.0, 3.0), Vec3::ZERO)
}
