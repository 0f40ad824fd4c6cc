//! Compute pass that deforms meshes with a skeleton or morph targets. It writes each mesh to its own buffer, from which the
//! library's caster set packs it: in world space with a skeleton, else in object space.
//!
//! Bevy deforms meshes in its vertex shaders, once per view, and does not store the result.

use antumbra::casters::{Mesh as CasterMesh, PositionFormat, Positions};
use antumbra::light::Aabb;
use bevy::asset::AssetId;
use bevy::mesh::{Mesh, VertexFormat};
use bevy::render::mesh::allocator::MeshAllocator;

use super::extract::ExtractedBend;
use super::mesh::{MeshError, MeshPlace};
use super::surface::CasterSurface;

/// Uniform `Layout` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Layout {
    first: u32,
    stride: u32,
    position: u32,
    positions_are_packed: u32,
    joints: u32,
    weights: u32,
    weights_are_packed: u32,
    vertex_count: u32,
    joint_count: u32,
    first_target: u32,
    target_count: u32,
    padding: u32,
    half_extents: glam::Vec4,
    center: glam::Vec4,
}

/// Deformation pass, one per device.
pub struct Bender {
    device: wgpu::Device,
    pipeline: wgpu::ComputePipeline,
}

/// Deformed mesh: inputs and outputs of the pass.
pub struct Bent {
    /// Deformed positions: three 32-bit floats per vertex.
    positions: wgpu::Buffer,
    layout: Layout,
    layout_buffer: wgpu::Buffer,
    joints: wgpu::Buffer,
    target_weights: wgpu::Buffer,
    /// Source buffers: vertices, and morph targets if there are any.
    sources: (wgpu::Buffer, Option<wgpu::Buffer>),
    group: wgpu::BindGroup,
    /// Last uploaded pose; `None` before the first upload.
    pose: Option<ExtractedBend>,
    /// Whether the pass has to be recorded.
    is_stale: bool,
}

/// Bound range of a slab. Binding offsets are multiples of the device's alignment; the shader adds the remainder.
struct Bound<'a> {
    binding: wgpu::BufferBinding<'a>,
    first_word: u32,
}

impl<'a> Bound<'a> {
    fn new(buffer: &'a wgpu::Buffer, first: u64, size: u64, alignment: u64) -> Option<Self> {
        let offset = first / alignment * alignment;
        let bytes = (first - offset + size).next_multiple_of(4).min(buffer.size() - offset);
        let binding = wgpu::BufferBinding { buffer, offset, size: std::num::NonZeroU64::new(bytes) };
        Some(Self { binding, first_word: u32::try_from((first - offset) / 4).ok()? })
    }
}

impl Bender {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bevy_antumbra bend"),
            source: wgpu::ShaderSource::Wgsl(include_str!("bend.wgsl").into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("bevy_antumbra bend"),
            layout: None,
            module: &module,
            entry_point: Some("bend"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { device: device.clone(), pipeline }
    }

    /// Returns the resources for a mesh at its current place in the slabs, reusing `kept` if it still fits. `box_of_mesh`
    /// decodes compressed positions.
    ///
    /// # Errors
    /// If the pass cannot read the mesh's vertex format.
    pub fn prepare(
        &self,
        kept: Option<Bent>,
        id: AssetId<Mesh>,
        place: &MeshPlace<'_>,
        allocator: &MeshAllocator,
        bend: &ExtractedBend,
        box_of_mesh: Aabb,
    ) -> Result<Bent, MeshError> {
        let alignment = u64::from(self.device.limits().min_storage_buffer_offset_alignment);
        let too_far = MeshError::TooFar;
        let bytes = u64::from(place.vertex_count) * place.stride;
        let vertices = Bound::new(place.vertices, place.first, bytes, alignment).ok_or(too_far.clone())?;
        let targets = match bend.weights.is_empty() {
            true => None,
            false => {
                let (buffer, first) = place.morph_targets(id, allocator)?;
                let bytes = (bend.weights.len() * place.vertex_count as usize) as u64 * MeshPlace::TARGET_BYTES;
                Some(Bound::new(buffer, first, bytes, alignment).ok_or(too_far)?)
            }
        };
        let layout = Layout {
            first: vertices.first_word,
            first_target: targets.as_ref().map_or(0, |targets| targets.first_word),
            target_count: bend.weights.len() as u32,
            ..layout_of(place, bend.joints.len() as u32, box_of_mesh)?
        };
        let sources = (place.vertices.clone(), targets.as_ref().map(|targets| targets.binding.buffer.clone()));
        match kept {
            Some(kept) if kept.layout == layout && kept.sources == sources => Ok(kept),
            _ => Ok(self.make(layout, vertices, targets, sources)),
        }
    }

    fn make(
        &self,
        layout: Layout,
        vertices: Bound<'_>,
        targets: Option<Bound<'_>>,
        sources: (wgpu::Buffer, Option<wgpu::Buffer>),
    ) -> Bent {
        let buffer = |label, size: u64, usage| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let layout_buffer =
            buffer("bevy_antumbra bend layout", size_of::<Layout>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        // At least one element each, because unused buffers are bound, too.
        let joint_bytes = 64 * u64::from(layout.joint_count.max(1));
        let joints = buffer("bevy_antumbra joints", joint_bytes, Usage::STORAGE | Usage::COPY_DST);
        let weight_bytes = 4 * u64::from(layout.target_count.max(1));
        let target_weights = buffer("bevy_antumbra morph weights", weight_bytes, Usage::STORAGE | Usage::COPY_DST);
        let positions = buffer("bevy_antumbra bent positions", 12 * u64::from(layout.vertex_count), Usage::STORAGE);
        let targets = targets.map_or_else(|| target_weights.as_entire_buffer_binding(), |targets| targets.binding);
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("bevy_antumbra bend"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, layout_buffer.as_entire_binding()),
                entry(1, wgpu::BindingResource::Buffer(vertices.binding)),
                entry(2, joints.as_entire_binding()),
                entry(3, positions.as_entire_binding()),
                entry(4, wgpu::BindingResource::Buffer(targets)),
                entry(5, target_weights.as_entire_binding()),
            ],
        });
        Bent { positions, layout, layout_buffer, joints, target_weights, sources, group, pose: None, is_stale: false }
    }

    /// Records the pass for all meshes whose pose has changed.
    pub fn record<'a>(&self, encoder: &mut wgpu::CommandEncoder, bent: impl Iterator<Item = &'a mut Bent>) {
        let mut stale = bent.filter_map(|bent| std::mem::take(&mut bent.is_stale).then_some(&*bent)).peekable();
        if stale.peek().is_none() {
            return;
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("bevy_antumbra bend"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        for bent in stale {
            pass.set_bind_group(0, &bent.group, &[]);
            // A dispatch has at most 65 535 workgroups per dimension.
            let groups = bent.layout.vertex_count.div_ceil(64);
            pass.dispatch_workgroups(groups.min(65_535), groups.div_ceil(65_535), 1);
        }
    }
}

/// Returns the vertex layout of a mesh, without the offsets of the first vertex and the first target.
fn layout_of(place: &MeshPlace<'_>, joint_count: u32, box_of_mesh: Aabb) -> Result<Layout, MeshError> {
    let words = |bytes: u64| u32::try_from(bytes / 4).map_err(|_| MeshError::TooFar);
    let of = |attribute| match place.attribute(attribute) {
        Some((offset, format)) => Ok((words(offset)?, Some(format))),
        None => Ok((0, None)),
    };
    let (position, position_format) = of(Mesh::ATTRIBUTE_POSITION)?;
    let positions_are_packed = match position_format {
        Some(VertexFormat::Float32x3) => 0,
        Some(VertexFormat::Snorm16x4) => 1,
        other => return Err(MeshError::Positions(other)),
    };
    let (joints, joint_format) = of(Mesh::ATTRIBUTE_JOINT_INDEX)?;
    let (weights, weight_format) = of(Mesh::ATTRIBUTE_JOINT_WEIGHT)?;
    let weights_are_packed = match (joint_count, joint_format, weight_format) {
        (0, ..) => 0,
        (_, Some(VertexFormat::Uint16x4), Some(VertexFormat::Float32x4)) => 0,
        (_, Some(VertexFormat::Uint16x4), Some(VertexFormat::Unorm16x4)) => 1,
        (_, joints, weights) => return Err(MeshError::Joints(joints, weights)),
    };
    Ok(Layout {
        first: 0,
        stride: words(place.stride)?,
        position,
        positions_are_packed,
        joints,
        weights,
        weights_are_packed,
        vertex_count: place.vertex_count,
        joint_count,
        first_target: 0,
        target_count: 0,
        padding: 0,
        half_extents: (0.5 * (box_of_mesh.max - box_of_mesh.min)).extend(0.0),
        center: box_of_mesh.center().extend(0.0),
    })
}

impl Bent {
    /// Uploads the pose. Returns whether it differs from the last one.
    pub fn bring(&mut self, queue: &wgpu::Queue, bend: &ExtractedBend) -> bool {
        let is_same = |pose: &ExtractedBend| pose.joints == bend.joints && pose.weights == bend.weights;
        if self.pose.as_ref().is_some_and(is_same) {
            return false;
        }
        queue.write_buffer(&self.layout_buffer, 0, bytemuck::bytes_of(&self.layout));
        if !bend.joints.is_empty() {
            queue.write_buffer(&self.joints, 0, bytemuck::cast_slice(&bend.joints));
        }
        if !bend.weights.is_empty() {
            queue.write_buffer(&self.target_weights, 0, bytemuck::cast_slice(&bend.weights));
        }
        self.pose = Some(bend.clone());
        self.is_stale = true;
        true
    }

    /// Returns the deformed mesh as the library describes meshes.
    ///
    /// # Errors
    /// If its indices are not on the GPU.
    pub fn of_library<'a>(
        &'a self,
        id: AssetId<Mesh>,
        place: &MeshPlace<'a>,
        allocator: &'a MeshAllocator,
        surface: &CasterSurface,
        bounds: Aabb,
    ) -> Result<CasterMesh<'a>, MeshError> {
        Ok(CasterMesh {
            vertex_count: self.layout.vertex_count,
            positions: Positions { buffer: &self.positions, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
            texture_coordinates: surface.texture().and_then(|texture| place.uvs(texture)),
            indices: place.indices(id, allocator)?,
            topology: wgpu::PrimitiveTopology::TriangleList,
            closed: false,
            bounds,
        })
    }
}
