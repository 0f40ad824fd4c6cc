//! Meshes of the host, in its vertex and index buffers.

use std::f32::consts::TAU;
use std::ops::Range;

use antumbra::light::Aabb;
use glam::{Vec2, Vec3};

/// Vertex of most meshes, interleaved: 40 bytes.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    pub position: Vec3,
    pub normal: Vec3,
    pub uv: Vec2,
    /// Joints of the skin, if the mesh has one.
    pub joints: [u8; 4],
    /// Joint weights in 255ths; they sum to 255.
    pub weights: [u8; 4],
}

/// Packed vertex: 12 bytes. Its position is [`PACKED_OFFSET`] plus a fraction of [`PACKED_SCALE`].
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PackedVertex {
    pub position: [i16; 4],
    pub normal: [i8; 4],
}

/// Vertex buffer of a mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum VertexBuffer {
    Plain,
    Packed,
    /// Output of the skinning pass.
    Skinned,
}

/// Part of a model, drawn with one surface. Parts of one model share its vertices.
#[derive(Clone)]
pub struct Part {
    pub buffer: VertexBuffer,
    /// Vertices of the whole model.
    pub vertices: Range<u32>,
    /// Base of the part's indices, relative to the model's first vertex.
    pub base_vertex: u32,
    /// Range in the shared index buffer.
    pub indices: Range<u32>,
    pub is_closed: bool,
    /// Bounds in object space, for every pose.
    pub bounds: Aabb,
}

/// Vertices and indices of the host.
#[derive(Default)]
pub struct Meshes {
    pub vertices: Vec<Vertex>,
    /// Undeformed vertices of meshes with a skin.
    pub skin_vertices: Vec<Vertex>,
    pub packed_vertices: Vec<PackedVertex>,
    pub indices: Vec<u16>,
}

/// Half extents and centre of the ring.
pub const PACKED_SCALE: Vec3 = Vec3::new(RING_RADIUS_M + RING_TUBE_M, RING_TUBE_M, RING_RADIUS_M + RING_TUBE_M);
pub const PACKED_OFFSET: Vec3 = Vec3::new(0.0, RING_TUBE_M, 0.0);
const RING_RADIUS_M: f32 = 0.5;
const RING_TUBE_M: f32 = 0.12;

/// Number of joints of the skin, one above the other.
pub const JOINTS: usize = 4;
pub const JOINT_LENGTH_M: f32 = 0.4;

impl Meshes {
    /// Adds a box of 24 vertices.
    pub fn add_box(&mut self, min: Vec3, max: Vec3) -> Part {
        let first = (self.vertices.len() as u32, self.indices.len() as u32);
        self.push_box(min, max);
        self.part_of(first, VertexBuffer::Plain, Aabb { min, max })
    }

    /// Adds a tree: its trunk, and leaves as single triangles with an alpha-tested texture.
    pub fn add_tree(&mut self) -> [Part; 2] {
        let first = (self.vertices.len() as u32, self.indices.len() as u32);
        let trunk_box = Aabb { min: Vec3::new(-0.06, -0.1, -0.06), max: Vec3::new(0.06, 1.3, 0.06) };
        self.push_box(trunk_box.min, trunk_box.max);
        let trunk = self.part_of(first, VertexBuffer::Plain, trunk_box);
        let leaf_vertices = self.vertices.len();
        for i in 0..9 {
            let turn = i as f32 * 0.382 * TAU;
            let outward = Vec3::new(turn.cos(), 0.0, turn.sin());
            let along = (outward + Vec3::Y * (0.5 - 0.12 * i as f32)).normalize();
            let across = outward.cross(Vec3::Y);
            let middle = Vec3::new(0.0, 1.0 + 0.05 * i as f32, 0.0) + 0.34 * along;
            // The triangle circumscribes the leaf.
            for (corner, angle) in [0.0, TAU / 3.0, 2.0 * TAU / 3.0].into_iter().enumerate() {
                let (v, u) = f32::sin_cos(angle);
                self.vertices.push(Vertex {
                    position: middle + 0.64 * (along * u + across * v),
                    normal: along.cross(across),
                    uv: LEAF_MIDDLE + LEAF_RADIUS * Vec2::new(u, v),
                    joints: [0; 4],
                    weights: [255, 0, 0, 0],
                });
                self.indices.push(3 * i + corner as u16);
            }
        }
        let positions = self.vertices[leaf_vertices..].iter().map(|vertex| vertex.position);
        let bounds = Aabb::of(positions);
        let model = self.part_of((first.0, trunk.indices.end), VertexBuffer::Plain, bounds);
        let trunk = Part { vertices: model.vertices.clone(), ..trunk };
        [trunk, Part { base_vertex: leaf_vertices as u32 - first.0, is_closed: false, ..model }]
    }

    /// Adds a reed with a skin of [`JOINTS`] joints.
    pub fn add_reed(&mut self) -> Part {
        const SIDES: u16 = 9;
        const RINGS: u16 = 13;
        let first = (self.skin_vertices.len() as u32, self.indices.len() as u32);
        for ring in 0..RINGS {
            let along = f32::from(ring) / f32::from(RINGS - 1);
            // Joint j moves everything above it; within half a joint of it, two joints blend.
            let above = (along * JOINTS as f32 - 0.5).clamp(0.0, (JOINTS - 1) as f32);
            let (joint, share) = (above as u8, (255.0 * above.fract()).round() as u8);
            let y = along * JOINTS as f32 * JOINT_LENGTH_M;
            let radius = 0.13 - 0.09 * along;
            for side in 0..SIDES {
                let (sin, cos) = (f32::from(side) / f32::from(SIDES) * TAU).sin_cos();
                self.skin_vertices.push(Vertex {
                    position: Vec3::new(radius * cos, y, radius * sin),
                    normal: Vec3::new(cos, 0.0, sin),
                    uv: Vec2::ZERO,
                    joints: [joint, (joint + 1).min(JOINTS as u8 - 1), 0, 0],
                    weights: [255 - share, share, 0, 0],
                });
            }
        }
        for ring in 0..RINGS - 1 {
            for side in 0..SIDES {
                let [a, b] = [side, (side + 1) % SIDES].map(|side| ring * SIDES + side);
                self.indices.extend([a, a + SIDES, b, b, a + SIDES, b + SIDES]);
            }
        }
        let top = (RINGS - 1) * SIDES;
        for side in 1..SIDES - 1 {
            self.indices.extend([0, side, side + 1, top, top + side + 1, top + side]);
        }
        let reach = JOINTS as f32 * JOINT_LENGTH_M + 0.1;
        let bounds = Aabb { min: Vec3::new(-reach, -0.2, -reach), max: Vec3::splat(reach) };
        self.part_of(first, VertexBuffer::Skinned, bounds)
    }

    /// Adds a ring that lies on the ground, of packed vertices.
    pub fn add_ring(&mut self) -> Part {
        const AROUND: u16 = 40;
        const SIDES: u16 = 16;
        let first = (self.packed_vertices.len() as u32, self.indices.len() as u32);
        for i in 0..AROUND * SIDES {
            let (sin, cos) = (f32::from(i / SIDES) / f32::from(AROUND) * TAU).sin_cos();
            let (up, out) = (f32::from(i % SIDES) / f32::from(SIDES) * TAU).sin_cos();
            let radius = RING_RADIUS_M + RING_TUBE_M * out;
            let position = Vec3::new(radius * cos, RING_TUBE_M + RING_TUBE_M * up, radius * sin);
            let [x, y, z] = ((position - PACKED_OFFSET) / PACKED_SCALE * 32767.0).round().to_array();
            let [nx, ny, nz] = (Vec3::new(out * cos, up, out * sin) * 127.0).round().to_array();
            self.packed_vertices.push(PackedVertex {
                position: [x as i16, y as i16, z as i16, 0],
                normal: [nx as i8, ny as i8, nz as i8, 0],
            });
        }
        for i in 0..AROUND {
            for side in 0..SIDES {
                let at = |i: u16, side: u16| i % AROUND * SIDES + side % SIDES;
                let [a, b, c, d] = [at(i, side), at(i + 1, side), at(i + 1, side + 1), at(i, side + 1)];
                self.indices.extend([a, d, b, b, d, c]);
            }
        }
        let bounds = Aabb { min: PACKED_OFFSET - PACKED_SCALE, max: PACKED_OFFSET + PACKED_SCALE };
        self.part_of(first, VertexBuffer::Packed, bounds)
    }

    fn push_box(&mut self, min: Vec3, max: Vec3) {
        let (middle, half) = (0.5 * (min + max), 0.5 * (max - min));
        let first = self.vertices.len();
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for normal in [axis, -axis] {
                // Right-handed: counter-clockwise from outside.
                let (right, up) = (Vec3::new(axis.z, axis.x, axis.y), normal.cross(Vec3::new(axis.z, axis.x, axis.y)));
                let corner = self.vertices.len() - first;
                for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    self.vertices.push(Vertex {
                        position: middle + half * (normal + u * right + v * up),
                        normal,
                        uv: Vec2::ZERO,
                        joints: [0; 4],
                        weights: [255, 0, 0, 0],
                    });
                }
                self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| (corner + i) as u16));
            }
        }
    }

    /// Returns everything added since the given numbers of vertices and indices, as a closed mesh.
    fn part_of(&self, first: (u32, u32), buffer: VertexBuffer, bounds: Aabb) -> Part {
        let count = match buffer {
            VertexBuffer::Plain => self.vertices.len(),
            VertexBuffer::Packed => self.packed_vertices.len(),
            VertexBuffer::Skinned => self.skin_vertices.len(),
        };
        let (vertices, indices) = (first.0..count as u32, first.1..self.indices.len() as u32);
        Part { buffer, vertices, base_vertex: 0, indices, is_closed: true, bounds }
    }
}

/// Side of the leaf texture, texels.
pub const LEAF_SIZE: u32 = 128;
/// Centre and radius of the circumcircle of the triangle in the texture, whose sides are one.
const LEAF_MIDDLE: Vec2 = Vec2::new(0.5 * LEAF_RADIUS, 0.5);
const LEAF_RADIUS: f32 = 0.577_35;

/// Returns the leaf texture: a disc with five holes, linear RGBA.
pub fn leaf_texels() -> Vec<[u8; 4]> {
    let alpha = |i: u32| {
        let uv = (Vec2::new((i % LEAF_SIZE) as f32, (i / LEAF_SIZE) as f32) + 0.5) / LEAF_SIZE as f32;
        let p = uv - LEAF_MIDDLE;
        let hole = |k: u32| {
            let (sin, cos) = (k as f32 / 5.0 * TAU).sin_cos();
            p.distance(0.26 * LEAF_RADIUS * Vec2::new(cos, sin)) - 0.1 * LEAF_RADIUS
        };
        // Signed distance inside the leaf, then a ramp two texels wide around its edge.
        let inside = (0..5).map(hole).fold(0.46 * LEAF_RADIUS - p.length(), f32::min);
        (inside * LEAF_SIZE as f32 / 2.0 + 0.5).clamp(0.0, 1.0)
    };
    (0..LEAF_SIZE * LEAF_SIZE).map(|i| [255, 255, 255, (255.0 * alpha(i)).round() as u8]).collect()
}
