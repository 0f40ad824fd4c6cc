//! Meshes with a skeleton: a compute pass bends each into a buffer of its own, in world space, from which the library's set
//! packs it.
//!
//! Bevy bends in its vertex shaders, for each view again and into nothing that could be read.

use bevy::mesh::{Mesh, VertexFormat};

use super::mesh::MeshPlace;

/// Uniform `Layout` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
struct Layout {
    first: u32,
    stride: u32,
    position: u32,
    joints: u32,
    weights: u32,
    weights_are_packed: u32,
    vertex_count: u32,
    joint_count: u32,
}

/// The pass, once a device.
pub struct Skinner {
    device: wgpu::Device,
    pipeline: wgpu::ComputePipeline,
}

/// A bent mesh: what the pass reads and writes.
pub struct Skin {
    /// Three 32-bit floats a vertex, in world space.
    pub positions: wgpu::Buffer,
    pub vertex_count: u32,
    layout: Layout,
    layout_buffer: wgpu::Buffer,
    joints: wgpu::Buffer,
    vertices: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Skinner {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bevy_antumbra skin"),
            source: wgpu::ShaderSource::Wgsl(include_str!("skin.wgsl").into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("bevy_antumbra skin"),
            layout: None,
            module: &module,
            entry_point: Some("skin"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { device: device.clone(), pipeline }
    }

    /// Makes a skin ready for a mesh where it lies now; `None` where its vertices are not written as the pass reads them.
    pub fn prepare(&self, kept: Option<Skin>, place: &MeshPlace<'_>, joint_count: u32) -> Option<Skin> {
        let words = |bytes: u64| u32::try_from(bytes / 4).ok();
        let (position, VertexFormat::Float32x3) = place.attribute(Mesh::ATTRIBUTE_POSITION)? else { return None };
        let (joints, VertexFormat::Uint16x4) = place.attribute(Mesh::ATTRIBUTE_JOINT_INDEX)? else { return None };
        let (weights, weight_format) = place.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT)?;
        let weights_are_packed = match weight_format {
            VertexFormat::Float32x4 => 0,
            VertexFormat::Unorm16x4 => 1,
            _ => return None,
        };
        // Bindings begin at multiples of the alignment; the rest of the way is counted in the shader.
        let alignment = u64::from(self.device.limits().min_storage_buffer_offset_alignment);
        let bound_from = place.first / alignment * alignment;
        let layout = Layout {
            first: words(place.first - bound_from)?,
            stride: words(place.stride)?,
            position: words(position)?,
            joints: words(joints)?,
            weights: words(weights)?,
            weights_are_packed,
            vertex_count: place.vertex_count,
            joint_count,
        };
        if let Some(kept) = kept
            && kept.layout == layout
            && kept.vertices == *place.vertices
        {
            return Some(kept);
        }
        let buffer = |label, size: u64, usage| {
            let size = size.max(16);
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let layout_buffer =
            buffer("bevy_antumbra skin layout", size_of::<Layout>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let joints = buffer("bevy_antumbra joints", 64 * u64::from(joint_count), Usage::STORAGE | Usage::COPY_DST);
        let positions = buffer("bevy_antumbra bent positions", 12 * u64::from(place.vertex_count), Usage::STORAGE);
        let bytes = (place.first - bound_from) + u64::from(place.vertex_count) * place.stride;
        let vertices = wgpu::BufferBinding {
            buffer: place.vertices,
            offset: bound_from,
            size: std::num::NonZeroU64::new(bytes.next_multiple_of(4).min(place.vertices.size() - bound_from)),
        };
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("bevy_antumbra skin"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, layout_buffer.as_entire_binding()),
                entry(1, wgpu::BindingResource::Buffer(vertices)),
                entry(2, joints.as_entire_binding()),
                entry(3, positions.as_entire_binding()),
            ],
        });
        let (vertices, vertex_count) = (place.vertices.clone(), place.vertex_count);
        Some(Skin { positions, vertex_count, layout, layout_buffer, joints, vertices, group })
    }

    /// Records the pass for all skins.
    pub fn record<'a>(&self, encoder: &mut wgpu::CommandEncoder, skins: impl Iterator<Item = &'a Skin>) {
        let mut skins = skins.peekable();
        if skins.peek().is_none() {
            return;
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("bevy_antumbra skin"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        for skin in skins {
            pass.set_bind_group(0, &skin.group, &[]);
            // A dispatch has at most 65 535 workgroups a side.
            let groups = skin.vertex_count.div_ceil(64);
            pass.dispatch_workgroups(groups.min(65_535), groups.div_ceil(65_535), 1);
        }
    }
}

impl Skin {
    /// Brings the pose.
    pub fn write(&self, queue: &wgpu::Queue, joints: &[glam::Mat4]) {
        let joints = &joints[..joints.len().min(self.layout.joint_count as usize)];
        queue.write_buffer(&self.layout_buffer, 0, bytemuck::bytes_of(&self.layout));
        queue.write_buffer(&self.joints, 0, bytemuck::cast_slice(joints));
    }
}
