//! Casters in the host's own buffers, frames, and masks as arrays.

use antumbra::casters::{
    Caster, CasterId, Indices, InstanceBuffer, InstanceLayout, Instances, Mesh as LibraryMesh, MeshId, PositionFormat,
    Positions,
};
use antumbra::light::{Aabb, Light};
use antumbra::{
    AnyShadow, CasterSet, Casters, Error, Frame, Gpu, Mask, MaskChannels, Receivers, Recorder, TechniqueKind,
};
use glam::Mat4;

use crate::device::Device;
use crate::scene::{Mesh, Object, Scene};

/// Interleaved vertex: position, and a colour that the library ignores.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Vertex {
    position: [f32; 3],
    color: u32,
}

/// A caster set with the handles of its objects.
#[derive(Debug)]
pub struct HostCasters {
    /// The library's caster set.
    pub set: CasterSet,
    /// Handles of each object.
    pub ids: Vec<(MeshId, CasterId)>,
}

impl HostCasters {
    /// Adds the objects of a scene, with matrices from the CPU, and uploads them.
    ///
    /// # Panics
    /// Panics if the library refuses them.
    pub fn new(device: &Device, scene: &Scene) -> Self {
        Self::with(device, scene, |_, _| None)
    }

    /// Adds the objects of a scene to a set of another handle of the device.
    ///
    /// # Panics
    /// Panics if the library refuses them.
    pub fn for_gpu(device: &Device, gpu: &Gpu, scene: &Scene) -> Self {
        Self::of_set(device, CasterSet::new(gpu), scene, |_, _| None)
    }

    /// Adds the objects of a scene, some with matrices in GPU buffers: `instances` returns the buffer for an object's index
    /// and the object.
    ///
    /// # Panics
    /// Panics if the library refuses them.
    pub fn with<'b>(
        device: &Device,
        scene: &Scene,
        instances: impl Fn(usize, &Object) -> Option<InstanceBuffer<'b>>,
    ) -> Self {
        Self::of_set(device, CasterSet::new(&device.gpu), scene, instances)
    }

    fn of_set<'b>(
        device: &Device,
        mut set: CasterSet,
        scene: &Scene,
        instances: impl Fn(usize, &Object) -> Option<InstanceBuffer<'b>>,
    ) -> Self {
        let mut ids = Vec::new();
        for (i, object) in scene.objects.iter().enumerate() {
            let mesh = add_mesh(device, &mut set, &object.mesh);
            let matrices = [object.world_from_object];
            let instances = instances(i, object).map_or(Instances::Matrices(&matrices), Instances::Buffer);
            ids.push((mesh, set.add(&Caster::new(mesh, instances)).expect("a good caster")));
        }
        let mut casters = Self { set, ids };
        casters.update(device);
        casters
    }

    /// Sets an object's matrix.
    ///
    /// # Panics
    /// Panics if the library refuses the matrix.
    pub fn set_matrix(&mut self, object: usize, matrix: Mat4) {
        self.set.set_instances(self.ids[object].1, Instances::Matrices(&[matrix])).expect("a good matrix");
    }

    /// Uploads changes.
    ///
    /// # Panics
    /// Panics if the library refuses them.
    pub fn update(&mut self, device: &Device) {
        let mut encoder = device.encoder();
        self.set.update(&mut Recorder::new(&mut encoder, None)).expect("a good set");
        device.queue().submit([encoder.finish()]);
    }

    /// All casters, for a frame.
    pub fn all(&self) -> Casters<'_> {
        Casters::Set { set: &self.set, layers: u32::MAX }
    }
}

/// Adds a mesh with interleaved vertices and 16-bit indices.
///
/// # Panics
/// Panics if the library refuses it.
pub fn add_mesh(device: &Device, set: &mut CasterSet, mesh: &Mesh) -> MeshId {
    let vertices: Vec<Vertex> =
        mesh.positions.iter().map(|p| Vertex { position: p.to_array(), color: u32::MAX }).collect();
    let usage = wgpu::BufferUsages::COPY_SRC;
    let vertex_buffer = device.buffer(bytemuck::cast_slice(&vertices), usage | wgpu::BufferUsages::VERTEX);
    let index_buffer = device.buffer(bytemuck::cast_slice(&mesh.indices), usage | wgpu::BufferUsages::INDEX);
    set.add_mesh(&LibraryMesh {
        vertex_count: mesh.positions.len() as u32,
        positions: Positions { buffer: &vertex_buffer, offset: 0, stride: 16, format: PositionFormat::Float32x3 },
        texture_coordinates: None,
        indices: Some(Indices {
            buffer: &index_buffer,
            format: wgpu::IndexFormat::Uint16,
            first_index: 0,
            count: mesh.indices.len() as u32,
            base_vertex: 0,
        }),
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed: mesh.closed,
        bounds: mesh.bounds(),
    })
    .expect("a good mesh")
}

/// Creates a buffer of matrices, as GPU-driven hosts have.
pub fn matrix_buffer(device: &Device, matrices: &[Mat4]) -> wgpu::Buffer {
    device.buffer(bytemuck::cast_slice(matrices), wgpu::BufferUsages::STORAGE)
}

/// Describes `count` matrices of such a buffer from index `first`, with bounds that may be unknown.
pub fn in_buffer(buffer: &wgpu::Buffer, first: u64, count: u32, bounds: Option<Aabb>) -> InstanceBuffer<'_> {
    InstanceBuffer { buffer, offset: 64 * first, stride: 64, layout: InstanceLayout::Columns4x4, count, bounds }
}

/// Creates a technique with settings; settings without a parameter are ignored.
///
/// # Panics
/// Panics if the device lacks a feature, or a value is out of range.
pub fn shadow_with(device: &Device, kind: TechniqueKind, settings: &[(&str, &str)]) -> AnyShadow {
    let mut shadow = kind.create(&device.gpu).unwrap_or_else(|error| panic!("{error}"));
    for (key, value) in settings {
        if kind.param_specs().iter().any(|spec| spec.key == *key) {
            shadow.set(key, value).unwrap_or_else(|error| panic!("{error}"));
        }
    }
    shadow
}

/// Creates a technique at minimal cost, for tests of the recorded work rather than of quality.
pub fn small_shadow(device: &Device, kind: TechniqueKind) -> AnyShadow {
    let settings = [("map_size", "64"), ("view_size", "32"), ("samples", "4"), ("search_samples", "4")];
    shadow_with(device, kind, &settings)
}

/// Returns the technique of a name.
///
/// # Panics
/// Panics if there is none.
pub fn kind_of(name: &str) -> TechniqueKind {
    TechniqueKind::from_name(name).unwrap_or_else(|| panic!("no technique is called {name}"))
}

/// Prepares and records one frame, submits it, and waits.
///
/// # Errors
/// Fails if the library refuses the frame.
pub fn draw(device: &Device, shadow: &mut AnyShadow, frame: &Frame<'_>) -> Result<(), Error> {
    let mut encoder = device.encoder();
    shadow.prepare(frame)?.record(&mut Recorder::new(&mut encoder, None));
    device.queue().submit([encoder.finish()]);
    device.wait();
    Ok(())
}

/// Draws a frame and reads its mask of one 32-bit channel.
///
/// # Panics
/// Panics if the library refuses the frame, or on a validation message.
pub fn mask_of(
    device: &Device,
    shadow: &mut AnyShadow,
    light: &Light,
    casters: Casters<'_>,
    receivers: Receivers<'_>,
) -> Vec<f32> {
    let mask = Mask::with_channels(device.wgpu(), receivers.size_px, MaskChannels::One);
    let frame = Frame { light, casters, receivers, mask: &mask };
    let name = shadow.kind().name();
    device.validated(name, || draw(device, shadow, &frame)).unwrap_or_else(|error| panic!("{error}"));
    device.read_layer(mask.texture(), 0)
}
