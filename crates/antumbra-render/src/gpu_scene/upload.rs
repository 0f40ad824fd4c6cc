//! Upload of a scene: meshes and instances become geometries and draws.

use std::sync::atomic::{AtomicU64, Ordering};

use antumbra::contract::VertexFaces;
use antumbra::{Gpu, MeshVersion, SurfaceCoverage};
use antumbra_scene::{Aabb, Coverage, Mesh, Occluder, Scene, SurfacePicture, Translucency};
use glam::{Vec3, Vec4};
use wgpu::util::DeviceExt;

use super::geometry_buffers::JoinedGeometries;
use super::instances::{InstanceLists, instances_by_mesh, placed_at};
use super::samplers::SamplerSet;
use super::shaded_material::shaded;
use super::split::{MeshPart, split_mesh};
use super::surface_textures::{SurfaceTextures, TextureSlot, alpha_ramp_uv};
use super::{CasterSurface, Draw, GEOMETRY_USAGE, Geometry, GpuScene};

/// Version number of the next geometry of any scene.
static NEXT_GEOMETRY: AtomicU64 = AtomicU64::new(0);

/// Upload in progress.
pub(super) struct Upload<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    textures: SurfaceTextures<'a>,
    joined: JoinedGeometries,
    /// Bytes of the buffers that geometries do not share.
    buffer_bytes: u64,
    /// Whether the triangles around each vertex are uploaded for coherent shading.
    with_faces: bool,
}

impl<'a> Upload<'a> {
    pub fn new(gpu: &'a Gpu, scene: &'a Scene, with_faces: bool) -> Self {
        Self {
            gpu,
            scene,
            textures: SurfaceTextures::new(gpu, scene),
            joined: JoinedGeometries::new(binding_bytes(gpu)),
            buffer_bytes: 0,
            with_faces,
        }
    }

    pub fn run(mut self) -> GpuScene {
        let binding_bytes = binding_bytes(self.gpu);
        let mut geometries = Vec::new();
        let mut draws = Vec::new();
        let mut matrices = InstanceLists::new(binding_bytes);
        let instances_of_mesh = instances_by_mesh(self.scene);
        let occluders = self.scene.occluders();
        for ((mesh, occluder), instances) in self.scene.meshes.iter().zip(occluders).zip(&instances_of_mesh) {
            if mesh.indices.len() < 3 || instances.is_empty() {
                continue;
            }
            let parts = split_mesh(mesh, binding_bytes);
            let closed = mesh.closed && parts.len() == 1;
            for part in parts {
                let geometry = geometries.len();
                for mirrored in [false, true] {
                    let wound: Vec<_> = (instances.iter().copied())
                        .filter(|(_, instance)| (instance.world_from_object.determinant() < 0.0) == mirrored)
                        .collect();
                    let poses: Vec<_> = wound.iter().map(|(_, instance)| instance.world_from_object).collect();
                    let mut placed = placed_at(&part.positions, &wound).into_iter();
                    for (poses, list, first_instance) in matrices.push_all(&poses) {
                        let placed: Vec<_> = placed.by_ref().take(poses.len()).collect();
                        draws.push(Draw {
                            geometry,
                            instances: list,
                            first_instance,
                            instance_count: poses.len() as u32,
                            mirrored,
                            bounds: placed.iter().fold(Aabb::EMPTY, |bounds, one| bounds.union(one.bounds)),
                            placed,
                        });
                    }
                }
                geometries.push(self.geometry(mesh, part, closed, occluder));
            }
        }
        let instances: Vec<_> = matrices
            .lists
            .iter()
            .map(|list| self.buffer("instances", bytemuck::cast_slice(list), wgpu::BufferUsages::empty()))
            .collect();
        let (buffers, geometry_bytes) = self.joined.upload(self.gpu);
        let is_ground = |draw: &Draw| draw.placed.iter().any(|placed| Some(placed.instance) == self.scene.ground);
        GpuScene {
            ground: draws.iter().position(is_ground),
            geometries,
            buffers,
            instances,
            bounds: draws.iter().fold(Aabb::EMPTY, |bounds, draw| bounds.union(draw.bounds)),
            draws,
            materials: self.scene.materials.iter().map(|material| shaded(self.scene, material)).collect(),
            memory_bytes: self.buffer_bytes + geometry_bytes + self.textures.memory_bytes,
            textures: self.textures.views,
            samplers: SamplerSet::new(self.gpu.device()),
            triangle_count: self.scene.triangle_count(),
        }
    }

    fn geometry(&mut self, mesh: &Mesh, part: MeshPart<'_>, closed: bool, occluder: Occluder) -> Geometry {
        let material = &self.scene.materials[mesh.material];
        let texture =
            if mesh.uvs.is_empty() { None } else { material.base_color_image.map(|i| self.textures.image(i)) };
        let caster = match occluder {
            Occluder::Opaque => CasterSurface::Opaque,
            Occluder::Masked { cutoff } => self.masked(material.base_color.w, texture, cutoff, &part),
            Occluder::Translucent => self.translucent(mesh, &part),
        };
        let faces = self.faces(&mesh.name, &part);
        // Data indexed from the geometry's own first vertex needs vertex buffers of its own.
        let has_own_vertices = faces.is_some() || caster.has_uvs();
        Geometry {
            place: self.joined.push(&part, !has_own_vertices),
            index_count: part.indices.len() as u32,
            faces,
            material: mesh.material,
            texture,
            occluder,
            closed,
            caster,
            version: MeshVersion { mesh: NEXT_GEOMETRY.fetch_add(1, Ordering::Relaxed), vertices: 0 },
        }
    }

    /// Offsets of each vertex's first normal and of the end of the last one's, in words, then the normals.
    fn faces(&mut self, label: &str, part: &MeshPart<'_>) -> Option<wgpu::Buffer> {
        if !self.with_faces {
            return None;
        }
        let faces = VertexFaces::new(&part.positions, &part.normals, &part.indices);
        let first_normal = faces.first.len() as u32;
        let words: Vec<u32> = faces
            .first
            .iter()
            .map(|first| first_normal + 3 * first)
            .chain(faces.normals.iter().flat_map(|n| n.to_array().map(f32::to_bits)))
            .collect();
        let limit = self.gpu.device().limits().max_storage_buffer_binding_size;
        (size_of_val(words.as_slice()) as u64 <= limit)
            .then(|| self.buffer(label, bytemuck::cast_slice(&words), wgpu::BufferUsages::empty()))
    }

    fn masked(&mut self, factor: f32, texture: Option<TextureSlot>, cutoff: f32, part: &MeshPart<'_>) -> CasterSurface {
        if let Some(texture) = texture {
            return CasterSurface::Masked { texture, uvs: None, alpha_factor: factor * mean_color(part).w, cutoff };
        }
        let alphas = || part.colors.iter().map(|color| factor * color.w);
        if part.colors.is_empty() || alphas().all(|alpha| alpha >= cutoff) {
            return if factor >= cutoff || !part.colors.is_empty() {
                CasterSurface::Opaque
            } else {
                CasterSurface::Absent
            };
        }
        if alphas().all(|alpha| alpha < cutoff) {
            return CasterSurface::Absent;
        }
        CasterSurface::Masked {
            texture: self.textures.alpha_ramp(),
            uvs: self.ramp_uvs(part),
            alpha_factor: factor,
            cutoff,
        }
    }

    fn translucent(&mut self, mesh: &Mesh, part: &MeshPart<'_>) -> CasterSurface {
        let Translucency { coverage, factor, picture } = self.scene.translucency(mesh);
        let mut texture = match picture {
            SurfacePicture::White => None,
            SurfacePicture::Image(image) => Some(self.textures.image(image)),
            SurfacePicture::Made => Some(self.textures.made(mesh.material, mesh.closed)),
        };
        let mean = mean_color(part);
        let varies = part.colors.iter().any(|color| color.w != part.colors[0].w);
        let ramps = texture.is_none() && varies && coverage != Coverage::Whole;
        let (alpha, uvs) = if ramps {
            texture = Some(self.textures.alpha_ramp());
            (factor.w, self.ramp_uvs(part))
        } else {
            (factor.w * mean.w, None)
        };
        CasterSurface::Translucent {
            coverage: match coverage {
                Coverage::Whole => SurfaceCoverage::Whole,
                Coverage::Alpha if alpha <= 0.0 => return CasterSurface::Absent,
                Coverage::Alpha => SurfaceCoverage::Alpha(alpha),
                Coverage::Cutoff(cutoff) => SurfaceCoverage::Cutoff { alpha_factor: alpha, cutoff },
            },
            transmitted: (factor.truncate() * mean.truncate()).clamp(Vec3::ZERO, Vec3::ONE),
            texture,
            uvs,
        }
    }

    /// Texture coordinates of each vertex's alpha in the alpha ramp.
    fn ramp_uvs(&mut self, part: &MeshPart<'_>) -> Option<wgpu::Buffer> {
        let uvs: Vec<_> = part.colors.iter().map(|color| alpha_ramp_uv(color.w)).collect();
        self.optional_buffer("alpha ramp", bytemuck::cast_slice(&uvs))
    }

    fn buffer(&mut self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.buffer_bytes += contents.len() as u64;
        self.gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: GEOMETRY_USAGE | usage,
        })
    }

    fn optional_buffer(&mut self, label: &str, contents: &[u8]) -> Option<wgpu::Buffer> {
        (!contents.is_empty()).then(|| self.buffer(label, contents, wgpu::BufferUsages::empty()))
    }
}

/// Largest size of one binding of the scene's buffers, bytes.
pub(super) fn binding_bytes(gpu: &Gpu) -> u64 {
    let limits = gpu.device().limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// Mean of the vertex colours; white without any.
fn mean_color(part: &MeshPart<'_>) -> Vec4 {
    match part.colors.len() {
        0 => Vec4::ONE,
        n => part.colors.iter().sum::<Vec4>() / n as f32,
    }
}
