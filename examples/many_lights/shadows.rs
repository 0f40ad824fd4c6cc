//! Shadows in the host: one caster set for all lights, and a state and a mask for each light and view.

use std::collections::HashSet;

use antumbra::casters::{
    Caster, CasterId, CasterSet, Indices, InstanceBuffer, InstanceLayout, Instances, Mesh, MeshId, PositionFormat,
    Positions, Surface, Texture, TextureCoordinateFormat, TextureCoordinates,
};
use antumbra::light::{Aabb, Light, LightShape};
use antumbra::{
    AnyShadow, Camera, Casters, DepthConvention, Error, Frame, Gpu, Mask, MaskChannels, Receivers, Recorder,
    TechniqueKind, WarmUp,
};
use glam::{Affine2, Mat4, UVec2};

use super::buffers::{Buffers, Instance};
use super::meshes::{PACKED_OFFSET, PACKED_SCALE, PackedVertex, Part, Vertex, VertexBuffer};
use super::scene::{Motion, Object, Scene};

/// Shadows of all lights in all views.
pub struct Shadows {
    gpu: Gpu,
    casters: CasterSet,
    /// Mesh and caster of each object of the scene.
    ids: Vec<(MeshId, CasterId)>,
    views: Vec<ViewShadows>,
}

/// Shadows that one camera sees.
struct ViewShadows {
    /// Masks: `R32Float`, of the view's size, one layer per light.
    masks: wgpu::Texture,
    of_lights: Vec<(AnyShadow, Mask)>,
}

/// Depth buffer of a camera: its part of the window, and the matrices that its depth was drawn with.
#[derive(Clone, Copy)]
pub struct ViewDepth<'a> {
    pub depth: &'a wgpu::TextureView,
    pub normals: &'a wgpu::TextureView,
    pub origin_px: UVec2,
    pub view_from_world: Mat4,
    pub clip_from_view: Mat4,
}

impl Shadows {
    /// Adds all casters, and compiles the pipelines that frames need.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        buffers: &Buffers,
        leaf: &Texture,
        view_size_px: UVec2,
    ) -> Result<Self, Error> {
        let mut casters = CasterSet::new(gpu);
        let mut ids = Vec::new();
        for (i, object) in scene.objects.iter().enumerate() {
            let mesh = casters.add_mesh(&mesh_of(&object.part, buffers))?;
            let surface = if object.alpha_cutoff > 0.0 {
                Surface::Masked { texture: leaf.clone(), alpha_factor: 1.0, cutoff: object.alpha_cutoff }
            } else {
                Surface::Opaque
            };
            let instances = instances_of(scene, i, buffers);
            ids.push((mesh, casters.add(&Caster { surface, ..Caster::new(mesh, instances) })?));
        }
        let views = scene
            .cameras
            .iter()
            .map(|_| ViewShadows::new(gpu, &scene.lights, view_size_px))
            .collect::<Result<Vec<_>, _>>()?;
        // Pipelines are shared by the device, so one state of each technique is enough.
        let mut warm = HashSet::new();
        for (shadow, _) in &views[0].of_lights {
            if warm.insert(shadow.kind()) {
                shadow.warm_up(WarmUp { masked: true, tinted: false })?;
            }
        }
        Ok(Self { gpu: gpu.clone(), casters, ids, views })
    }

    /// Returns the masks of a view: an array with one layer per light.
    pub fn masks(&self, view: usize) -> &wgpu::Texture {
        &self.views[view].masks
    }

    /// Returns a light's state in a view.
    pub fn of_light(&self, view: usize, light: usize) -> &AnyShadow {
        &self.views[view].of_lights[light].0
    }

    /// Returns the library's handle of the device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Updates the moving casters and records their upload. Call it after skinning and before [`record`](Self::record).
    pub fn update_casters(
        &mut self,
        scene: &Scene,
        buffers: &Buffers,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Error> {
        for (i, (object, (mesh, caster))) in scene.objects.iter().zip(&self.ids).enumerate() {
            match object.motion {
                Motion::Still => {}
                Motion::Bends => self.casters.mesh_changed(*mesh, &mesh_of(&object.part, buffers))?,
                Motion::Sways | Motion::Tumbles | Motion::Circles => {
                    self.casters.set_instances(*caster, instances_of(scene, i, buffers))?;
                }
            }
        }
        self.casters.update(recorder)
    }

    /// Records the masks of a view. Call it after the view's depth and before its colour.
    pub fn record(
        &mut self,
        view: usize,
        lights: &[Light],
        seen: &ViewDepth<'_>,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Error> {
        for (light, (shadow, mask)) in lights.iter().zip(&mut self.views[view].of_lights) {
            let camera = Camera {
                view_from_world: seen.view_from_world,
                clip_from_view: seen.clip_from_view,
                depth_convention: DepthConvention::Standard,
            };
            // No version is set, because something moves in every frame.
            let receivers = Receivers::new(seen.depth, mask.size_px(), camera)
                .with_origin_px(seen.origin_px)
                .with_normals(seen.normals);
            let casters = Casters::Set { set: &self.casters, layers: u32::MAX };
            shadow.prepare(&Frame { light, casters, receivers, mask })?.record(recorder);
        }
        Ok(())
    }
}

impl ViewShadows {
    fn new(gpu: &Gpu, lights: &[Light], size_px: UVec2) -> Result<Self, Error> {
        let masks = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("masks"),
            size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: lights.len() as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Mask::FORMAT,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let of_light = |(light, layer)| {
            let mask = Mask::of_layers(&masks, layer, MaskChannels::One)?;
            Ok((shadow_of(gpu, light)?, mask))
        };
        let of_lights = lights.iter().zip(0..).map(of_light).collect::<Result<Vec<_>, Error>>()?;
        Ok(Self { masks, of_lights })
    }
}

/// Creates a state for a light, with a technique that suits it.
fn shadow_of(gpu: &Gpu, light: &Light) -> Result<AnyShadow, Error> {
    let (kind, settings): (_, &[_]) = match (&light.shape, &light.emission) {
        // Uneven emission needs its own light samples, each of which this technique evaluates exactly.
        (_, Some(_)) | (LightShape::Points { .. }, _) => (TechniqueKind::SampleBased, &[]),
        // Large lights see one caster behind another.
        (LightShape::Rectangle { .. } | LightShape::Ellipsoid { .. }, _) => {
            (TechniqueKind::MultiLayer, &[("map_size", "512")])
        }
        // Small lights get the cheapest of the three.
        (LightShape::Disk { .. } | LightShape::Sphere { .. } | LightShape::Sun { .. }, _) => {
            (TechniqueKind::Pcss, &[("map_size", "1024")])
        }
    };
    let mut shadow = kind.create(gpu)?;
    for (key, value) in settings {
        shadow.set(key, value)?;
    }
    Ok(shadow)
}

/// Describes a part of a model in the host's buffers. Offsets point to the model's own vertices, so that no others are packed
/// with them; the base vertex is relative to these offsets.
fn mesh_of<'a>(part: &Part, buffers: &'a Buffers) -> Mesh<'a> {
    let is_packed = part.buffer == VertexBuffer::Packed;
    let stride = if is_packed { size_of::<PackedVertex>() } else { size_of::<Vertex>() } as u64;
    let first = u64::from(part.vertices.start) * stride;
    let buffer = buffers.vertices(part.buffer);
    let format = if is_packed {
        PositionFormat::Snorm16x4 { scale: PACKED_SCALE, offset: PACKED_OFFSET }
    } else {
        PositionFormat::Float32x3
    };
    // Packed vertices have no texture coordinates, and none of their objects has holes.
    let texture_coordinates = (!is_packed).then_some(TextureCoordinates {
        buffer,
        offset: first + std::mem::offset_of!(Vertex, uv) as u64,
        stride,
        format: TextureCoordinateFormat::Float32x2,
        transform: Affine2::IDENTITY,
    });
    Mesh {
        vertex_count: part.vertices.len() as u32,
        positions: Positions { buffer, offset: first, stride, format },
        texture_coordinates: texture_coordinates.filter(|_| !part.is_closed),
        indices: Some(Indices {
            buffer: &buffers.indices,
            format: wgpu::IndexFormat::Uint16,
            first_index: part.indices.start,
            count: part.indices.len() as u32,
            base_vertex: part.base_vertex as i32,
        }),
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed: part.is_closed,
        bounds: part.bounds,
    }
}

/// Returns the instances of an object. The matrices of the many blocks are read from the host's instance buffer, as if a
/// compute pass had written them.
fn instances_of<'a>(scene: &'a Scene, object: usize, buffers: &'a Buffers) -> Instances<'a> {
    let Object { motion, world_from_object, part, .. } = &scene.objects[object];
    if *motion != Motion::Circles {
        return Instances::Matrices(world_from_object);
    }
    let corners = world_from_object.iter().flat_map(|m| part.bounds.corners().map(|corner| m.transform_point3(corner)));
    let stride = size_of::<Instance>() as u64;
    Instances::Buffer(InstanceBuffer {
        buffer: &buffers.instances,
        offset: u64::from(scene.first_instance(object)) * stride,
        stride,
        layout: InstanceLayout::Rows3x4,
        count: world_from_object.len() as u32,
        bounds: Some(Aabb::of(corners)),
    })
}
