//! Packing of hosts' vertices and matrices into the set's own buffers by compute passes.

use glam::{Vec2, Vec3};

use super::mesh::{Indices, InstanceBuffer, InstanceLayout, Mesh, PositionFormat, Positions, TextureCoordinateFormat};
use crate::contract::Error;
use crate::gpu::{Bindings, Gpu, Stage, bindings, compute_pipeline, dispatch_threads, gpu_structs, shared_constants};
use crate::shaders;

gpu_structs! {
    /// Description of a mesh to pack.
    pub(crate) struct PackMesh {
        position_scale: Vec3,
        vertex_count: u32,
        position_offset: Vec3,
        index_count: u32,
        uv_x: Vec2,
        uv_y: Vec2,
        uv_offset: Vec2,
        position_first: u32,
        position_stride: u32,
        uv_first: u32,
        uv_stride: u32,
        index_first: u32,
        base_vertex: i32,
        position_format: u32,
        uv_format: u32,
        index_format: u32,
        first_vertex: u32,
        first_index: u32,
        is_strip: u32,
        padding_0: u32,
        padding_1: u32,
    }

    /// Description of matrices to pack.
    pub(crate) struct PackInstances {
        first: u32,
        stride: u32,
        count: u32,
        is_rows: u32,
        first_instance: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

bindings! {
    struct PackedMesh = "pack mesh", COMPUTE, group 0 of [CASTERS_PACK] {
        0 pack: Uniform,
        1 host_positions: StoragePart,
        2 host_uvs: StoragePart,
        3 host_indices: StoragePart,
        4 positions: ReadWrite,
        5 uvs: ReadWrite,
        6 indices: ReadWrite,
    }

    struct PackedInstances = "pack instances", COMPUTE, group 0 of [CASTERS_PACK_INSTANCES] {
        0 pack: Uniform,
        1 host_instances: StoragePart,
        2 instances: ReadWrite,
    }
}

shared_constants! {
    /// Formats of positions and texture coordinates.
    const FLOAT_32: u32 = 0, as in CASTERS_PACK;
    const SNORM_16: u32 = 1, as in CASTERS_PACK;
    const UNORM_16: u32 = 2, as in CASTERS_PACK;
    const FLOAT_16: u32 = 3, as in CASTERS_PACK;
    /// Value of `uv_format` for meshes without texture coordinates.
    const NO_UVS: u32 = 4, as in CASTERS_PACK;
    /// Formats of indices.
    const NO_INDICES: u32 = 0, as in CASTERS_PACK;
    const INDICES_16: u32 = 1, as in CASTERS_PACK;
}

/// Format of 32-bit indices; the shader does not compare with it.
const INDICES_32: u32 = 2;

/// Name in errors, in place of a technique's.
const ERROR_SOURCE: &str = "casters";

/// Part of a host's buffer, read as 32-bit words.
#[derive(Clone, Debug)]
pub(super) struct Words {
    buffer: wgpu::Buffer,
    /// Offset, bytes, a multiple of four.
    offset: u64,
    bytes: u64,
}

impl Words {
    /// Words of `count` items, `stride` bytes apart. Refuses ranges beyond the buffer and unreadable buffers.
    fn of_items(
        what: &'static str,
        buffer: &wgpu::Buffer,
        [offset, stride, item_bytes]: [u64; 3],
        count: u32,
    ) -> Result<Self, Error> {
        if !offset.is_multiple_of(4) || !stride.is_multiple_of(4) || stride < item_bytes {
            return Err(bad(
                what,
                format!("at an offset of {offset} and a stride of {stride} bytes"),
                format!("at multiples of 4 bytes, with a stride of at least {item_bytes}"),
            ));
        }
        let bytes = if count == 0 { 0 } else { u64::from(count - 1) * stride + item_bytes };
        Self::new(what, buffer, offset, bytes)
    }

    fn new(what: &'static str, buffer: &wgpu::Buffer, offset: u64, bytes: u64) -> Result<Self, Error> {
        if offset + bytes > buffer.size() {
            return Err(bad(
                what,
                format!("read up to byte {} of a buffer of {} bytes", offset + bytes, buffer.size()),
                "within the buffer".into(),
            ));
        }
        let is_read = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        if !buffer.usage().intersects(is_read) {
            return Err(bad(
                what,
                format!("in a buffer with the usage {:?}", buffer.usage()),
                "in a readable buffer: add BufferUsages::COPY_SRC or BufferUsages::STORAGE".into(),
            ));
        }
        Ok(Self { buffer: buffer.clone(), offset, bytes: bytes.next_multiple_of(4).min(buffer.size() - offset) })
    }

    /// Returns buffer, offset, size and the index of the first word within that range: the buffer itself if shaders can
    /// read it, otherwise a copy.
    fn bind(&self, stage: &Stage<'_>, encoder: &mut wgpu::CommandEncoder) -> (wgpu::Buffer, u64, u64, u32) {
        let alignment = u64::from(stage.device.limits().min_storage_buffer_offset_alignment);
        let begin = self.offset / alignment * alignment;
        let bytes = (self.offset + self.bytes - begin).max(4);
        if self.buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return (self.buffer.clone(), begin, bytes, ((self.offset - begin) / 4) as u32);
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let size = self.bytes.max(4).next_power_of_two();
        let copy = stage.frame_buffer("antumbra caster source", usage, size);
        encoder.copy_buffer_to_buffer(&self.buffer, self.offset, &copy, 0, self.bytes);
        (copy, 0, size, 0)
    }
}

fn bad(what: &'static str, had: String, needed: String) -> Error {
    Error::BadFrame { technique: ERROR_SOURCE, what, had, needed }
}

/// Source of a mesh's vertices and indices for packing.
#[derive(Clone, Debug)]
pub(super) struct MeshSource {
    positions: Words,
    uvs: Option<Words>,
    indices: Option<Words>,
    /// Uniform, without start positions in source and target.
    pack: PackMesh,
}

impl MeshSource {
    pub(super) fn new(mesh: &Mesh<'_>) -> Result<Self, Error> {
        let Mesh { vertex_count, positions, texture_coordinates, indices, topology, .. } = mesh;
        let (vertex_count, uvs, indices) = (*vertex_count, texture_coordinates.as_ref(), indices.as_ref());
        let Positions { buffer, offset, stride, format } = *positions;
        let corner_count = indices.map_or(vertex_count, |indices| indices.count);
        let index_count = index_count_of(*topology, corner_count)?;
        let (position_format, position_scale, position_offset) = match format {
            PositionFormat::Float32x3 => (FLOAT_32, Vec3::ONE, Vec3::ZERO),
            PositionFormat::Snorm16x4 { scale, offset } => (SNORM_16, scale, offset),
            PositionFormat::Unorm16x4 { scale, offset } => (UNORM_16, scale, offset),
        };
        let of_positions =
            Words::of_items("the position data", buffer, [offset, stride, format.bytes()], vertex_count)?;
        let of_uvs = uvs
            .map(|uvs| {
                let layout = [uvs.offset, uvs.stride, uvs.format.bytes()];
                Words::of_items("the texture coordinate data", uvs.buffer, layout, vertex_count)
            })
            .transpose()?;
        let of_indices = indices.map(index_words).transpose()?;
        let transform = uvs.map_or(glam::Affine2::IDENTITY, |uvs| uvs.transform);
        let pack = PackMesh {
            position_scale,
            vertex_count,
            position_offset,
            index_count,
            uv_x: transform.matrix2.x_axis,
            uv_y: transform.matrix2.y_axis,
            uv_offset: transform.translation,
            position_stride: (stride / 4) as u32,
            uv_stride: uvs.map_or(0, |uvs| (uvs.stride / 4) as u32),
            index_first: indices.map_or(0, |indices| match indices.format {
                wgpu::IndexFormat::Uint16 => indices.first_index % 2,
                wgpu::IndexFormat::Uint32 => 0,
            }),
            base_vertex: indices.map_or(0, |indices| indices.base_vertex),
            position_format,
            uv_format: uvs.map_or(NO_UVS, |uvs| match uvs.format {
                TextureCoordinateFormat::Float32x2 => FLOAT_32,
                TextureCoordinateFormat::Snorm16x2 => SNORM_16,
                TextureCoordinateFormat::Unorm16x2 => UNORM_16,
                TextureCoordinateFormat::Float16x2 => FLOAT_16,
            }),
            index_format: indices.map_or(NO_INDICES, |indices| match indices.format {
                wgpu::IndexFormat::Uint16 => INDICES_16,
                wgpu::IndexFormat::Uint32 => INDICES_32,
            }),
            is_strip: (*topology == wgpu::PrimitiveTopology::TriangleStrip).into(),
            ..PackMesh::default()
        };
        Ok(Self { positions: of_positions, uvs: of_uvs, indices: of_indices, pack })
    }

    pub(super) fn vertex_count(&self) -> u32 {
        self.pack.vertex_count
    }

    pub(super) fn index_count(&self) -> u32 {
        self.pack.index_count
    }

    pub(super) fn has_uvs(&self) -> bool {
        self.uvs.is_some()
    }
}

/// Returns the number of indices of the packed triangles of `corner_count` corners.
fn index_count_of(topology: wgpu::PrimitiveTopology, corner_count: u32) -> Result<u32, Error> {
    match topology {
        wgpu::PrimitiveTopology::TriangleList if corner_count.is_multiple_of(3) => Ok(corner_count),
        wgpu::PrimitiveTopology::TriangleList => {
            Err(bad("the number of indices", corner_count.to_string(), "a multiple of three".into()))
        }
        wgpu::PrimitiveTopology::TriangleStrip => corner_count.saturating_sub(2).checked_mul(3).ok_or_else(|| {
            bad("the number of indices", corner_count.to_string(), "less than 2³² / 3 in a strip".into())
        }),
        other => Err(bad("the mesh's topology", format!("{other:?}"), "TriangleList or TriangleStrip".into())),
    }
}

/// Words that contain the indices; 16-bit indices may start in the middle of a word.
fn index_words(indices: &Indices<'_>) -> Result<Words, Error> {
    let size = match indices.format {
        wgpu::IndexFormat::Uint16 => 2,
        wgpu::IndexFormat::Uint32 => 4,
    };
    let begin = u64::from(indices.first_index) * size / 4 * 4;
    let end = (u64::from(indices.first_index) + u64::from(indices.count)) * size;
    Words::new("the index data", indices.buffer, begin, end - begin.min(end))
}

/// Target of a packed mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct PackTargets<'a> {
    pub(super) positions: &'a wgpu::Buffer,
    /// Any buffer if the mesh has no texture coordinates.
    pub(super) uvs: &'a wgpu::Buffer,
    pub(super) indices: &'a wgpu::Buffer,
    pub(super) first_vertex: u32,
    pub(super) first_index: u32,
}

/// Prepared dispatch, to be recorded in a pass.
#[derive(Debug)]
pub(super) struct PackDispatch {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    threads: u32,
}

impl PackDispatch {
    pub(super) fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        dispatch_threads(pass, self.threads);
    }
}

/// Pipelines for packing.
#[derive(Debug)]
pub(super) struct Packer {
    mesh_layout: wgpu::BindGroupLayout,
    mesh: wgpu::ComputePipeline,
    instances_layout: wgpu::BindGroupLayout,
    instances: wgpu::ComputePipeline,
}

impl Packer {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let (mesh_layout, instances_layout) = (PackedMesh::layout(gpu), PackedInstances::layout(gpu));
        Self {
            mesh: compute_pipeline(gpu, "pack mesh", shaders::CASTERS_PACK, &[&mesh_layout]),
            mesh_layout,
            instances: compute_pipeline(gpu, "pack instances", shaders::CASTERS_PACK_INSTANCES, &[&instances_layout]),
            instances_layout,
        }
    }

    /// Prepares the packing of a mesh.
    pub(super) fn mesh(
        &self,
        stage: &Stage<'_>,
        encoder: &mut wgpu::CommandEncoder,
        source: &MeshSource,
        targets: &PackTargets<'_>,
    ) -> PackDispatch {
        let mut part = |words: &Words| words.bind(stage, encoder);
        let positions = part(&source.positions);
        let uvs = source.uvs.as_ref().map(&mut part);
        let indices = source.indices.as_ref().map(&mut part);
        let pack = PackMesh {
            position_first: positions.3,
            uv_first: uvs.as_ref().map_or(0, |uvs| uvs.3),
            index_first: source.pack.index_first
                + indices.as_ref().map_or(0, |indices| indices.3 * if source.pack.index_format == 1 { 2 } else { 1 }),
            first_vertex: targets.first_vertex,
            first_index: targets.first_index,
            ..source.pack
        };
        let uniform = stage.uniform("antumbra pack mesh", &pack);
        // Placeholders, not read by the shader.
        let uvs = uvs.as_ref().unwrap_or(&positions);
        let indices = indices.as_ref().unwrap_or(&positions);
        let packed = PackedMesh {
            pack: &uniform,
            host_positions: binding(&positions),
            host_uvs: binding(uvs),
            host_indices: binding(indices),
            positions: targets.positions,
            uvs: targets.uvs,
            indices: targets.indices,
        };
        PackDispatch {
            pipeline: self.mesh.clone(),
            group: packed.group(stage, &self.mesh_layout),
            threads: pack.vertex_count.max(pack.index_count),
        }
    }

    /// Prepares the packing of matrices.
    pub(super) fn instances(
        &self,
        stage: &Stage<'_>,
        encoder: &mut wgpu::CommandEncoder,
        source: &InstanceSource,
        target: &wgpu::Buffer,
        first_instance: u32,
    ) -> PackDispatch {
        let words = source.words.bind(stage, encoder);
        let pack = PackInstances {
            first: words.3,
            stride: source.stride_words,
            count: source.count,
            is_rows: source.is_rows.into(),
            first_instance,
            ..PackInstances::default()
        };
        let uniform = stage.uniform("antumbra pack instances", &pack);
        let packed = PackedInstances { pack: &uniform, host_instances: binding(&words), instances: target };
        PackDispatch {
            pipeline: self.instances.clone(),
            group: packed.group(stage, &self.instances_layout),
            threads: pack.count,
        }
    }
}

fn binding((buffer, offset, bytes, _): &(wgpu::Buffer, u64, u64, u32)) -> wgpu::BufferBinding<'_> {
    wgpu::BufferBinding { buffer, offset: *offset, size: std::num::NonZeroU64::new(*bytes) }
}

/// Source of a host's matrices for packing.
#[derive(Clone, Debug)]
pub(super) struct InstanceSource {
    words: Words,
    stride_words: u32,
    is_rows: bool,
    count: u32,
}

impl InstanceSource {
    pub(super) fn new(instances: &InstanceBuffer<'_>) -> Result<Self, Error> {
        let InstanceBuffer { buffer, offset, stride, layout, count, .. } = *instances;
        Ok(Self {
            words: Words::of_items("the instance data", buffer, [offset, stride, layout.bytes()], count)?,
            stride_words: (stride / 4) as u32,
            is_rows: layout == InstanceLayout::Rows3x4,
            count,
        })
    }

    pub(super) fn count(&self) -> u32 {
        self.count
    }
}
