//! A scene on the GPU: geometry, textures and instances, as casters for the techniques and as draws for the receivers.
//!
//! Everything fits WebGPU's default limits: a mesh too large for one binding becomes several (`split`), a list of
//! instances too long several draws. Meshes without triangles or instances take no part.
//!
//! **What a caster loses.** The library's casters have one colour and one alpha factor a draw, the scene's meshes a
//! colour a vertex. A mesh with varying vertex alpha and no texture keeps its alpha exactly, as a ramp texture looked
//! up by alpha; everywhere else the mean over the mesh's vertices stands for vertex colours. The reference tracer and
//! the receivers here use the colours themselves.
//!
//! **What shading loses.** Images other than the base colour's are replaced by their means, and what a volume absorbs is
//! taken into the base colour. Casters have them texel by texel.

mod geometry_buffers;
mod ground;
mod instances;
mod mips;
mod repose;
mod samplers;
mod shaded_material;
mod split;
mod surface_textures;
mod upload;

use antumbra::{Gpu, MeshCaster, MeshVersion, Opacity, SurfaceCoverage, SurfaceTexture};
use antumbra_scene::{Aabb, AlphaMode, Material, Occluder, Scene};
use glam::{Mat4, Vec3};

use geometry_buffers::{GeometryBuffers, Place};
pub use ground::CastersOfLights;
use instances::Placed;
use samplers::SamplerSet;
use surface_textures::{TextureSlot, WHITE};
use upload::Upload;

/// A scene on the GPU.
#[derive(Debug)]
pub struct GpuScene {
    /// Geometry, by index from [`Draw::geometry`].
    pub(crate) geometries: Vec<Geometry>,
    /// Their vertices and triangles, by index from [`Place::buffers`].
    pub(crate) buffers: Vec<GeometryBuffers>,
    /// Lists of world-from-object matrices, by index from [`Draw::instances`].
    pub(crate) instances: Vec<wgpu::Buffer>,
    /// What to draw.
    pub(crate) draws: Vec<Draw>,
    /// Surfaces as they are shaded, by index as in [`Scene::materials`].
    pub(crate) materials: Vec<Material>,
    /// The ground that the scene was put on, by index into `draws`.
    ground: Option<usize>,
    textures: Vec<wgpu::TextureView>,
    samplers: SamplerSet,
    /// World-space box of all triangles.
    pub bounds: Aabb,
    /// Triangles as drawn: every instance included.
    pub triangle_count: usize,
    /// Bytes of GPU memory for geometry and textures.
    pub memory_bytes: u64,
}

/// Indexed triangles of one surface in object space.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub place: Place,
    pub index_count: u32,
    /// The triangles around each vertex, as `shading/bent.wgsl` reads them; `None` where nobody asked for them, or where
    /// they do not fit a binding.
    pub faces: Option<wgpu::Buffer>,
    /// Index into [`GpuScene::materials`].
    pub material: usize,
    /// The base colour's image with the way it wraps; `None` where the material has none or the mesh no coordinates.
    pub texture: Option<TextureSlot>,
    /// What the surface does to light.
    pub occluder: Occluder,
    closed: bool,
    caster: CasterSurface,
    /// Another for each pose.
    version: MeshVersion,
}

/// Instances of one geometry, drawn together.
#[derive(Debug)]
pub(crate) struct Draw {
    pub geometry: usize,
    pub instances: usize,
    pub first_instance: u32,
    pub instance_count: u32,
    /// The instances mirror: what winds counter-clockwise in the mesh winds clockwise in the world.
    mirrored: bool,
    bounds: Aabb,
    /// Its instances in their order, as they were uploaded.
    placed: Vec<Placed>,
}

/// [`Opacity`] with what it refers to by index.
#[derive(Debug)]
enum CasterSurface {
    Opaque,
    /// Nowhere there.
    Absent,
    Masked {
        texture: TextureSlot,
        uvs: Option<wgpu::Buffer>,
        alpha_factor: f32,
        cutoff: f32,
    },
    Translucent {
        coverage: SurfaceCoverage,
        transmitted: Vec3,
        texture: Option<TextureSlot>,
        uvs: Option<wgpu::Buffer>,
    },
}

impl CasterSurface {
    /// Whether it has texture coordinates that the geometry has not.
    fn has_uvs(&self) -> bool {
        matches!(self, Self::Masked { uvs: Some(_), .. } | Self::Translucent { uvs: Some(_), .. })
    }
}

/// What techniques may do with geometry: draw it, or read it in compute.
const GEOMETRY_USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::VERTEX.union(wgpu::BufferUsages::STORAGE).union(wgpu::BufferUsages::COPY_DST);

impl Geometry {
    /// Its corners of triangles, counted from the first of its buffers.
    pub(crate) fn corners(&self) -> std::ops::Range<u32> {
        self.place.first_index..self.place.first_index + self.index_count
    }
}

impl GpuScene {
    /// Uploads a scene. The queue copies before the next submission.
    pub fn upload(gpu: &Gpu, scene: &Scene) -> Self {
        Upload::new(gpu, scene, false).run()
    }

    /// The same, with what coherent shading needs to know of the triangles around each vertex.
    pub fn upload_with_faces(gpu: &Gpu, scene: &Scene) -> Self {
        Upload::new(gpu, scene, true).run()
    }

    /// The casters: one for each draw that can stop light. [`casters_for`](Self::casters_for) leaves out what stops none of one light.
    pub fn casters(&self) -> Vec<MeshCaster<'_>> {
        self.draws.iter().filter_map(|draw| self.caster(draw)).collect()
    }

    /// Moves instances, given by their indices in [`Scene::instances`], to `offset_m` metres from where they were
    /// uploaded; zero brings them back to the bit. The queue copies before the next submission.
    pub fn offset_instances(&mut self, gpu: &Gpu, instances: &[usize], offset_m: Vec3) {
        let offset = Mat4::from_translation(offset_m);
        for draw in &mut self.draws {
            let is_moved = |placed: &Placed| instances.contains(&placed.instance);
            for (slot, placed) in (draw.first_instance..).zip(&draw.placed).filter(|(_, placed)| is_moved(placed)) {
                let pose =
                    if offset_m == Vec3::ZERO { placed.world_from_object } else { offset * placed.world_from_object };
                let place = u64::from(slot) * size_of::<Mat4>() as u64;
                gpu.queue().write_buffer(&self.instances[draw.instances], place, bytemuck::bytes_of(&pose));
            }
            draw.bounds = (draw.placed.iter()).fold(Aabb::EMPTY, |bounds, placed| {
                let Aabb { min, max } = placed.bounds;
                let moved = Aabb { min: min + offset_m, max: max + offset_m };
                bounds.union(if is_moved(placed) { moved } else { placed.bounds })
            });
        }
        self.bounds = self.draws.iter().fold(Aabb::EMPTY, |bounds, draw| bounds.union(draw.bounds));
    }

    fn caster(&self, draw: &Draw) -> Option<MeshCaster<'_>> {
        let geometry = &self.geometries[draw.geometry];
        let buffers = self.buffers_of(geometry);
        let opacity = match &geometry.caster {
            CasterSurface::Absent => return None,
            CasterSurface::Opaque => Opacity::Opaque,
            CasterSurface::Masked { texture, uvs, alpha_factor, cutoff } => Opacity::Masked {
                texture: self.caster_texture(*texture, uvs.as_ref().or(buffers.uvs.as_ref())?),
                alpha_factor: *alpha_factor,
                cutoff: *cutoff,
            },
            CasterSurface::Translucent { coverage, transmitted, texture, uvs } => Opacity::Translucent {
                coverage: *coverage,
                transmitted: *transmitted,
                texture: match (texture, uvs.as_ref().or(buffers.uvs.as_ref())) {
                    (Some(texture), Some(uvs)) => Some(self.caster_texture(*texture, uvs)),
                    _ => None,
                },
            },
        };
        let instances = &self.instances[draw.instances];
        let mesh = MeshCaster::new(&buffers.positions, &buffers.indices, geometry.index_count, instances)
            .with_first_triangle(geometry.place.first_index / 3)
            .with_instances(draw.first_instance..draw.first_instance + draw.instance_count)
            .with_closed(geometry.closed && !draw.mirrored)
            .with_opacity(opacity)
            .with_bounds(draw.bounds)
            .with_version(geometry.version);
        Some(mesh)
    }

    /// A geometry's buffers, which it may share with others.
    pub(crate) fn buffers_of(&self, geometry: &Geometry) -> &GeometryBuffers {
        &self.buffers[geometry.place.buffers]
    }

    fn caster_texture<'a>(&'a self, slot: TextureSlot, uvs: &'a wgpu::Buffer) -> SurfaceTexture<'a> {
        SurfaceTexture { uvs, view: &self.textures[slot.view], sampler: &self.samplers.level_0[&slot.wrap] }
    }

    /// Whether any surface is translucent, and so more than the first hit counts for the picture.
    pub fn has_translucent_surfaces(&self) -> bool {
        self.draws.iter().any(|draw| self.is_translucent(draw))
    }

    /// Whether a draw's surface lets some light through.
    pub(crate) fn is_translucent(&self, draw: &Draw) -> bool {
        self.geometries[draw.geometry].occluder == Occluder::Translucent
    }

    /// Whether a draw's surface has holes.
    pub(crate) fn is_masked(&self, draw: &Draw) -> bool {
        matches!(self.materials[self.geometries[draw.geometry].material].alpha, AlphaMode::Mask { .. })
    }

    /// A geometry's texture, or a white one, with its samplers: level 0, and smooth.
    pub(crate) fn texture_of(&self, geometry: &Geometry) -> (&wgpu::TextureView, &wgpu::Sampler, &wgpu::Sampler) {
        let slot = geometry.texture.unwrap_or(WHITE);
        (&self.textures[slot.view], &self.samplers.level_0[&slot.wrap], &self.samplers.smooth[&slot.wrap])
    }
}

#[cfg(test)]
mod tests;
