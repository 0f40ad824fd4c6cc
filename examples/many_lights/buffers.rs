//! Buffers of the host, and their updates in each frame.

use glam::{Mat4, Vec4};

use super::meshes::{JOINTS, VertexBuffer};
use super::scene::{Object, Scene};

/// Element of the instance buffer: one placement of an object.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Instance {
    /// World-from-object matrix, 3 × 4.
    rows: [Vec4; 3],
    /// Linear RGB, and the alpha below which fragments are discarded.
    color: Vec4,
}

/// Uniform `Light` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct LightUniform {
    place: Vec4,
    color: Vec4,
}

/// Buffers of the host. Those that casters are packed from need the usage `COPY_SRC` or `STORAGE`.
pub struct Buffers {
    plain: wgpu::Buffer,
    packed: wgpu::Buffer,
    /// Undeformed vertices of meshes with a skin.
    pub modelled: wgpu::Buffer,
    /// Deformed vertices of these meshes.
    pub skinned: wgpu::Buffer,
    /// Indices, 16 bits each.
    pub indices: wgpu::Buffer,
    /// Array of [`Instance`]s.
    pub instances: wgpu::Buffer,
    /// Joint matrices of the skin.
    pub joints: wgpu::Buffer,
    /// Array of [`LightUniform`]s.
    pub lights: wgpu::Buffer,
}

impl Buffers {
    pub fn vertices(&self, which: VertexBuffer) -> &wgpu::Buffer {
        match which {
            VertexBuffer::Plain => &self.plain,
            VertexBuffer::Packed => &self.packed,
            VertexBuffer::Skinned => &self.skinned,
        }
    }

    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene) -> Self {
        use wgpu::BufferUsages as Usage;
        let empty = |label, size, usage| {
            let usage = usage | Usage::COPY_DST;
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        let filled = |label, bytes: &[u8], usage| {
            // Copies need a multiple of four bytes.
            let mut bytes = bytes.to_vec();
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            let buffer = empty(label, bytes.len() as u64, usage);
            queue.write_buffer(&buffer, 0, &bytes);
            buffer
        };
        let (meshes, vertex) = (&scene.meshes, Usage::VERTEX);
        let instance_bytes = u64::from(scene.first_instance(scene.objects.len())) * size_of::<Instance>() as u64;
        let skin_bytes = size_of_val(&meshes.skin_vertices[..]) as u64;
        Self {
            plain: filled("vertices", bytemuck::cast_slice(&meshes.vertices), vertex | Usage::COPY_SRC),
            packed: filled("packed vertices", bytemuck::cast_slice(&meshes.packed_vertices), vertex | Usage::COPY_SRC),
            modelled: filled("modelled vertices", bytemuck::cast_slice(&meshes.skin_vertices), Usage::STORAGE),
            skinned: empty("skinned vertices", skin_bytes, vertex | Usage::STORAGE),
            indices: filled("indices", bytemuck::cast_slice(&meshes.indices), Usage::INDEX | Usage::COPY_SRC),
            instances: empty("instances", instance_bytes, vertex | Usage::COPY_SRC),
            joints: empty("joints", size_of::<[Mat4; JOINTS]>() as u64, Usage::UNIFORM),
            lights: empty("lights", size_of::<[LightUniform; 8]>() as u64, Usage::UNIFORM),
        }
    }

    /// Uploads everything that moves, except skinned vertices, which the skinning pass writes.
    pub fn write(&self, queue: &wgpu::Queue, scene: &Scene) {
        let instances = scene.objects.iter().flat_map(|object| {
            let Object { color, alpha_cutoff, world_from_object, .. } = object;
            world_from_object.iter().map(|matrix| {
                let rows = [0, 1, 2].map(|i| matrix.row(i));
                Instance { rows, color: color.extend(*alpha_cutoff) }
            })
        });
        let instances: Vec<Instance> = instances.collect();
        queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&instances));
        queue.write_buffer(&self.joints, 0, bytemuck::cast_slice(&scene.joints));
        let lights = scene.lights.each_ref().map(|light| {
            let place = if light.is_distant() { (-light.axis).extend(0.0) } else { light.center.extend(1.0) };
            LightUniform { place, color: (light.color * light.intensity).extend(1.0) }
        });
        queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&lights));
    }
}
