//! Scene on the GPU: geometry, textures and instances, as casters for the techniques and as draws for the receivers.
//!
//! Everything fits WebGPU's default limits: a mesh too large for one binding becomes several (`split`), a list of
//! instances too long becomes several draws. Meshes without triangles or instances are skipped.
//!
//! **Loss in casters.** The library's casters have one colour and one alpha factor per draw, but meshes have a colour per
//! vertex. A mesh with varying vertex alpha and no texture keeps its alpha exactly, by a ramp texture indexed by alpha;
//! otherwise vertex colours are replaced by their mean over the mesh. The reference tracer and the receivers here use the
//! vertex colours themselves.
//!
//! **Loss in shading.** Images other than the base colour's are replaced by their means, and the absorption of volumes is
//! included in the base colour. Casters have both per texel.

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

/// Scene on the GPU.
#[derive(Debug)]
pub struct GpuScene {
    /// Geometries, indexed by [`Draw::geometry`].
    pub(crate) geometries: Vec<Geometry>,
    /// Buffers of vertices and triangles, indexed by [`Place::buffers`].
    pub(crate) buffers: Vec<GeometryBuffers>,
    /// Lists of world-from-object matrices, indexed by [`Draw::instances`].
    pub(crate) instances: Vec<wgpu::Buffer>,
    /// Draws.
    pub(crate) draws: Vec<Draw>,
    /// Materials for shading, indexed as [`Scene::materials`].
    pub(crate) materials: Vec<Material>,
    /// Index into `draws` of the ground that the scene was put on; `None` without one.
    ground: Option<usize>,
    textures: Vec<wgpu::TextureView>,
    samplers: SamplerSet,
    /// World-space bounding box of all triangles.
    pub bounds: Aabb,
    /// Number of triangles of all instances.
    pub triangle_count: usize,
    /// Bytes of GPU memory for geometry and textures.
    pub memory_bytes: u64,
}

/// Indexed triangles of one material in object space.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub place: Place,
    pub index_count: u32,
    /// Normals of the triangles around each vertex, as `shading/bent.wgsl` reads them; `None` if not requested, or if they do
    /// not fit a binding.
    pub faces: Option<wgpu::Buffer>,
    /// Index into [`GpuScene::materials`].
    pub material: usize,
    /// Base colour texture; `None` if the material has none or the mesh has no texture coordinates.
    pub texture: Option<TextureSlot>,
    /// Effect of the surface on light.
    pub occluder: Occluder,
    closed: bool,
    caster: CasterSurface,
    /// Version, which changes with the vertices.
    version: MeshVersion,
}

/// Instances of one geometry, drawn together.
#[derive(Debug)]
pub(crate) struct Draw {
    pub geometry: usize,
    pub instances: usize,
    pub first_instance: u32,
    pub instance_count: u32,
    /// Whether the instances mirror: counter-clockwise triangles of the mesh are clockwise in the world.
    mirrored: bool,
    bounds: Aabb,
    /// Instances in order, as uploaded.
    placed: Vec<Placed>,
}

/// [`Opacity`] with indices in place of references.
#[derive(Debug)]
enum CasterSurface {
    Opaque,
    /// Nothing: the surface is a hole everywhere.
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
    /// Whether the caster has texture coordinates that the geometry lacks.
    fn has_uvs(&self) -> bool {
        matches!(self, Self::Masked { uvs: Some(_), .. } | Self::Translucent { uvs: Some(_), .. })
    }
}

/// Usages of geometry buffers: techniques draw them, or read them in compute.
const GEOMETRY_USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::VERTEX.union(wgpu::BufferUsages::STORAGE).union(wgpu::BufferUsages::COPY_DST);

impl Geometry {
    /// Range of triangle corners, counted from the first index of its buffers.
    pub(crate) fn corners(&self) -> std::ops::Range<u32> {
        self.place.first_index..self.place.first_index + self.index_count
    }
}

impl GpuScene {
    /// Uploads a scene. The queue copies before the next submission.
    pub fn upload(gpu: &Gpu, scene: &Scene) -> Self {
        Upload::new(gpu, scene, false).run()
    }

    /// Uploads a scene with the triangles around each vertex, which coherent shading needs.
    pub fn upload_with_faces(gpu: &Gpu, scene: &Scene) -> Self {
        Upload::new(gpu, scene, true).run()
    }

    /// Casters: one for each draw that can block light. [`casters_for`](Self::casters_for) omits those that block none of one light.
    pub fn casters(&self) -> Vec<MeshCaster<'_>> {
        self.draws.iter().filter_map(|draw| self.caster(draw)).collect()
    }

    /// Moves instances, given by their indices in [`Scene::instances`], to `offset_m` metres from where they were
    /// uploaded; zero restores them exactly. The queue copies before the next submission.
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

    /// Buffers of a geometry, which others may share.
    pub(crate) fn buffers_of(&self, geometry: &Geometry) -> &GeometryBuffers {
        &self.buffers[geometry.place.buffers]
    }

    fn caster_texture<'a>(&'a self, slot: TextureSlot, uvs: &'a wgpu::Buffer) -> SurfaceTexture<'a> {
        SurfaceTexture { uvs, view: &self.textures[slot.view], sampler: &self.samplers.level_0[&slot.wrap] }
    }

    /// Whether any surface is translucent, so that shading needs more than the first hit.
    pub fn has_translucent_surfaces(&self) -> bool {
        self.draws.iter().any(|draw| self.is_translucent(draw))
    }

    /// Whether a draw's surface is translucent.
    pub(crate) fn is_translucent(&self, draw: &Draw) -> bool {
        self.geometries[draw.geometry].occluder == Occluder::Translucent
    }

    /// Whether a draw's surface is alpha-tested.
    pub(crate) fn is_masked(&self, draw: &Draw) -> bool {
        matches!(self.materials[self.geometries[draw.geometry].material].alpha, AlphaMode::Mask { .. })
    }

    /// Texture of a geometry, or a white one, with its samplers: level 0, and smooth.
    pub(crate) fn texture_of(&self, geometry: &Geometry) -> (&wgpu::TextureView, &wgpu::Sampler, &wgpu::Sampler) {
        let slot = geometry.texture.unwrap_or(WHITE);
        (&self.textures[slot.view], &self.samplers.level_0[&slot.wrap], &self.samplers.smooth[&slot.wrap])
    }
}

#[cfg(test)]
mod tests;
