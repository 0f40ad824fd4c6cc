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
mod mips;
mod repose;
mod split;

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use antumbra::contract::VertexFaces;
use antumbra::{Gpu, MeshCaster, MeshVersion, Opacity, SurfaceCoverage, SurfaceTexture};
use antumbra_scene::{
    Aabb, AlphaMode, Coverage, Image, Instance, Material, Mesh, Occluder, Scene, SurfacePicture, Translucency, Wrap,
};
use glam::{Mat4, Vec2, Vec3, Vec4};
use wgpu::util::DeviceExt;

use geometry_buffers::{GeometryBuffers, JoinedGeometries, Place};
pub use ground::CastersOfLights;
use mips::mip_chain;
use split::{MeshPart, split_mesh};

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

/// The number of the next geometry of any scene.
static NEXT_GEOMETRY: AtomicU64 = AtomicU64::new(0);

/// A texture and how it is sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextureSlot {
    /// Index into [`GpuScene::textures`].
    view: usize,
    wrap: [Wrap; 2],
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

/// An instance as it was uploaded.
#[derive(Clone, Copy, Debug)]
struct Placed {
    /// Index into [`Scene::instances`].
    instance: usize,
    world_from_object: Mat4,
    /// World-space box.
    bounds: Aabb,
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

/// Samplers for each way to wrap: level 0 alone, as the definition of visibility has it, and all levels for looks.
#[derive(Debug)]
struct SamplerSet {
    level_0: HashMap<[Wrap; 2], wgpu::Sampler>,
    smooth: HashMap<[Wrap; 2], wgpu::Sampler>,
}

/// What techniques may do with geometry: draw it, or read it in compute.
const GEOMETRY_USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::VERTEX.union(wgpu::BufferUsages::STORAGE).union(wgpu::BufferUsages::COPY_DST);

/// Up to this many vertex transforms a mesh, its world boxes are exact; past it, each instance's box is turned instead,
/// which may be larger. A second's work on one core.
const EXACT_BOUNDS_WORK: usize = 1 << 24;

impl Geometry {
    /// Its corners of triangles, counted from the first of its buffers.
    pub(crate) fn corners(&self) -> std::ops::Range<u32> {
        self.place.first_index..self.place.first_index + self.index_count
    }
}

impl GpuScene {
    /// Uploads a scene. The queue copies before the next submission.
    pub fn upload(gpu: &Gpu, scene: &Scene) -> Self {
        Upload::new(gpu, scene).run()
    }

    /// The same, with what coherent shading needs to know of the triangles around each vertex.
    pub fn upload_with_faces(gpu: &Gpu, scene: &Scene) -> Self {
        Upload { with_faces: true, ..Upload::new(gpu, scene) }.run()
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
        Some(MeshCaster {
            positions: &buffers.positions,
            indices: &buffers.indices,
            first_triangle: geometry.place.first_index / 3,
            index_count: geometry.index_count,
            instances: &self.instances[draw.instances],
            first_instance: draw.first_instance,
            instance_count: draw.instance_count,
            closed: geometry.closed && !draw.mirrored,
            opacity,
            bounds: draw.bounds,
            version: Some(geometry.version),
        })
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

/// The texture that changes nothing.
const WHITE: TextureSlot = TextureSlot { view: 0, wrap: [Wrap::Clamp; 2] };

struct Upload<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    textures: Vec<wgpu::TextureView>,
    slots: HashMap<usize, TextureSlot>,
    /// What materials' images make on closed and on open meshes.
    made: HashMap<(usize, bool), TextureSlot>,
    alpha_ramp: Option<TextureSlot>,
    joined: JoinedGeometries,
    memory_bytes: u64,
    with_faces: bool,
}

impl<'a> Upload<'a> {
    fn new(gpu: &'a Gpu, scene: &'a Scene) -> Self {
        let mut upload = Self {
            gpu,
            scene,
            textures: Vec::new(),
            slots: HashMap::new(),
            made: HashMap::new(),
            alpha_ramp: None,
            joined: JoinedGeometries::new(binding_bytes(gpu)),
            memory_bytes: 0,
            with_faces: false,
        };
        let white = Image { width: 1, height: 1, rgba8: vec![[u8::MAX; 4]], wrap: [Wrap::Clamp; 2] };
        upload.add_texture("white", &white);
        upload
    }

    fn run(mut self) -> GpuScene {
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
            textures: self.textures,
            samplers: SamplerSet::new(self.gpu.device()),
            triangle_count: self.scene.triangle_count(),
            memory_bytes: self.memory_bytes + geometry_bytes,
        }
    }

    fn geometry(&mut self, mesh: &Mesh, part: MeshPart<'_>, closed: bool, occluder: Occluder) -> Geometry {
        let material = &self.scene.materials[mesh.material];
        let texture = if mesh.uvs.is_empty() { None } else { material.base_color_image.map(|i| self.texture(i)) };
        let caster = match occluder {
            Occluder::Opaque => CasterSurface::Opaque,
            Occluder::Masked { cutoff } => self.masked(material.base_color.w, texture, cutoff, &part),
            Occluder::Translucent => self.translucent(mesh, &part),
        };
        let faces = self.faces(&mesh.name, &part);
        // What counts vertices from the geometry's own first lies beside vertices of its own.
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

    /// Where each vertex's normals begin and the last ones end, in words, then the normals.
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
        CasterSurface::Masked { texture: self.alpha_ramp(), uvs: self.ramp_uvs(part), alpha_factor: factor, cutoff }
    }

    fn translucent(&mut self, mesh: &Mesh, part: &MeshPart<'_>) -> CasterSurface {
        let Translucency { coverage, factor, picture } = self.scene.translucency(mesh);
        let mut texture = match picture {
            SurfacePicture::White => None,
            SurfacePicture::Image(image) => Some(self.texture(image)),
            SurfacePicture::Made => Some(self.made(mesh.material, mesh.closed)),
        };
        let mean = mean_color(part);
        let varies = part.colors.iter().any(|color| color.w != part.colors[0].w);
        let ramps = texture.is_none() && varies && coverage != Coverage::Whole;
        let (alpha, uvs) = if ramps {
            texture = Some(self.alpha_ramp());
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

    /// What a material's images make, on closed meshes or on open ones.
    fn made(&mut self, material: usize, is_closed: bool) -> TextureSlot {
        if let Some(slot) = self.made.get(&(material, is_closed)) {
            return *slot;
        }
        let picture = self.scene.transmitted_picture(material, is_closed);
        let slot = self.add_texture(&format!("transmitted by material {material}"), &picture);
        self.made.insert((material, is_closed), slot);
        slot
    }

    /// Where the alpha ramp holds each vertex's alpha.
    fn ramp_uvs(&mut self, part: &MeshPart<'_>) -> Option<wgpu::Buffer> {
        let uvs: Vec<_> = part.colors.iter().map(|color| alpha_ramp_uv(color.w)).collect();
        self.optional_buffer("alpha ramp", bytemuck::cast_slice(&uvs))
    }

    fn texture(&mut self, image: usize) -> TextureSlot {
        if let Some(slot) = self.slots.get(&image) {
            return *slot;
        }
        let slot = self.add_texture(&format!("image {image}"), &self.scene.images[image]);
        self.slots.insert(image, slot);
        slot
    }

    fn alpha_ramp(&mut self) -> TextureSlot {
        if let Some(slot) = self.alpha_ramp {
            return slot;
        }
        let rgba8 = (0..=u8::MAX).map(|alpha| [u8::MAX, u8::MAX, u8::MAX, alpha]).collect();
        let ramp = Image { width: RAMP_TEXELS, height: 1, rgba8, wrap: [Wrap::Clamp; 2] };
        let slot = self.add_texture("alpha ramp", &ramp);
        self.alpha_ramp = Some(slot);
        slot
    }

    fn add_texture(&mut self, label: &str, image: &Image) -> TextureSlot {
        let levels = mip_chain(image, self.gpu.device().limits().max_texture_dimension_2d);
        let texture = self.gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: levels[0].width, height: levels[0].height, depth_or_array_layers: 1 },
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (level, mip_level) in levels.iter().zip(0..) {
            let texels: &[u8] = bytemuck::cast_slice(&level.rgba8);
            self.memory_bytes += texels.len() as u64;
            self.gpu.queue().write_texture(
                wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() },
                texels,
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * level.width), rows_per_image: None },
                wgpu::Extent3d { width: level.width, height: level.height, depth_or_array_layers: 1 },
            );
        }
        self.textures.push(texture.create_view(&wgpu::TextureViewDescriptor::default()));
        TextureSlot { view: self.textures.len() - 1, wrap: image.wrap }
    }

    fn buffer(&mut self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.memory_bytes += contents.len() as u64;
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

/// Bytes that one binding of the scene's buffers may have.
fn binding_bytes(gpu: &Gpu) -> u64 {
    let limits = gpu.device().limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// The mean of the vertices' colours.
fn mean_color(part: &MeshPart<'_>) -> Vec4 {
    match part.colors.len() {
        0 => Vec4::ONE,
        n => part.colors.iter().sum::<Vec4>() / n as f32,
    }
}

/// A material with the means of its images in its factors, but for the base colour's.
fn shaded(scene: &Scene, material: &Material) -> Material {
    let mean = |image: Option<usize>, channel: usize| {
        image.map_or(1.0, |image| {
            let texels = &scene.images[image].rgba8;
            let sum: f64 = texels.iter().map(|texel| f64::from(texel[channel])).sum();
            (sum / (255.0 * texels.len().max(1) as f64)) as f32
        })
    };
    let metallic = material.metallic * mean(material.metallic_roughness_image, 2);
    let transmission = material.transmission * mean(material.transmission_image, 0) * (1.0 - metallic);
    let absorbed = material.volume.as_ref().map_or(Vec3::ONE, |volume| {
        Vec3::ONE.lerp(volume.attenuation(mean(volume.thickness_image, 1), false), transmission)
    });
    Material {
        base_color: material.base_color * absorbed.extend(1.0),
        transmission,
        transmission_image: None,
        metallic,
        roughness: material.roughness * mean(material.metallic_roughness_image, 1),
        metallic_roughness_image: None,
        volume: None,
        ..material.clone()
    }
}

/// One texel for each 8-bit alpha.
const RAMP_TEXELS: u32 = 256;

/// Where the alpha ramp holds `alpha`: texel 255 · alpha, at its centre.
fn alpha_ramp_uv(alpha: f32) -> Vec2 {
    Vec2::new((255.0 * alpha + 0.5) / RAMP_TEXELS as f32, 0.5)
}

/// The instances of each mesh, with their indices in the scene.
fn instances_by_mesh(scene: &Scene) -> Vec<Vec<(usize, &Instance)>> {
    let mut by_mesh = vec![Vec::new(); scene.meshes.len()];
    for (index, instance) in scene.instances.iter().enumerate() {
        by_mesh[instance.mesh].push((index, instance));
    }
    by_mesh
}

/// Matrices in lists that each fit a binding.
struct InstanceLists {
    lists: Vec<Vec<Mat4>>,
    capacity: usize,
}

impl InstanceLists {
    fn new(binding_bytes: u64) -> Self {
        Self { lists: Vec::new(), capacity: binding_bytes as usize / size_of::<Mat4>() }
    }

    /// Adds poses; gives each run of them with its list and its place there.
    fn push_all<'p>(&mut self, mut poses: &'p [Mat4]) -> Vec<(&'p [Mat4], usize, u32)> {
        let mut runs = Vec::new();
        while !poses.is_empty() {
            if self.lists.last().is_none_or(|list| list.len() == self.capacity) {
                self.lists.push(Vec::new());
            }
            let index = self.lists.len() - 1;
            let list = &mut self.lists[index];
            let (run, rest) = poses.split_at(poses.len().min(self.capacity - list.len()));
            runs.push((run, index, list.len() as u32));
            list.extend_from_slice(run);
            poses = rest;
        }
        runs
    }
}

/// Each instance with its world-space box.
fn placed_at(positions: &[Vec3], instances: &[(usize, &Instance)]) -> Vec<Placed> {
    let object_box = Aabb::of(positions.iter().copied());
    let exact = positions.len().saturating_mul(instances.len()) <= EXACT_BOUNDS_WORK;
    let corners = object_box.corners();
    let points = if exact { positions } else { &corners };
    let place = |&(instance, &Instance { world_from_object, .. }): &(usize, &Instance)| {
        let bounds = Aabb::of(points.iter().map(|p| world_from_object.transform_point3(*p)));
        Placed { instance, world_from_object, bounds }
    };
    instances.iter().map(place).collect()
}

impl SamplerSet {
    fn new(device: &wgpu::Device) -> Self {
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        let pairs = || wraps.into_iter().flat_map(|u| wraps.into_iter().map(move |v| [u, v]));
        let address = |wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
            Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
        };
        let sampler = |wrap: [Wrap; 2], label, lod_max_clamp, anisotropy_clamp| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: address(wrap[0]),
                address_mode_v: address(wrap[1]),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                lod_max_clamp,
                anisotropy_clamp,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        Self {
            level_0: pairs().map(|wrap| (wrap, sampler(wrap, "level 0", 0.0, 1))).collect(),
            smooth: pairs().map(|wrap| (wrap, sampler(wrap, "smooth", f32::MAX, SMOOTH_ANISOTROPY))).collect(),
        }
    }
}

/// Samples along a stretched footprint: floors stay sharp a few metres out, and every adapter can do it.
const SMOOTH_ANISOTROPY: u16 = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{gpu_or_skip, quad};
    use antumbra_scene::Volume;

    fn scene(mesh: Mesh, material: Material) -> Scene {
        let instance = Instance { mesh: 0, world_from_object: Mat4::from_translation(Vec3::Y) };
        Scene { meshes: vec![mesh], materials: vec![material], instances: vec![instance], ..Scene::default() }
    }

    fn masked(cutoff: f32) -> Material {
        Material { alpha: AlphaMode::Mask { cutoff }, ..Material::default() }
    }

    #[test]
    fn casters_follow_the_occluder() {
        let Some(gpu) = gpu_or_skip() else { return };
        let caster_count = |mesh: &Mesh, material: Material| {
            let scene = GpuScene::upload(gpu, &scene(mesh.clone(), material));
            let kinds = scene.casters().iter().map(|caster| format!("{:?}", caster.opacity)).collect::<String>();
            (scene.casters().len(), kinds)
        };
        let plain = quad(1.0);
        assert_eq!(caster_count(&plain, Material::default()), (1, "Opaque".into()));
        assert_eq!(caster_count(&plain, masked(0.5)), (1, "Opaque".into()));
        let faint = Material { base_color: Vec4::new(1.0, 1.0, 1.0, 0.4), ..masked(0.5) };
        assert_eq!(caster_count(&plain, faint).0, 0);
        let faded =
            Mesh { colors: [0.0, 0.0, 1.0, 1.0].map(|a| Vec4::new(1.0, 1.0, 1.0, a)).to_vec(), ..plain.clone() };
        assert!(caster_count(&faded, masked(0.5)).1.starts_with("Masked"));
    }

    #[test]
    fn translucent_surfaces_are_as_their_material_says() {
        let Some(gpu) = gpu_or_skip() else { return };
        let of = |mesh: Mesh, material: Material, images: Vec<Image>| {
            let scene = Scene { images, ..scene(mesh, material) };
            let uploaded = GpuScene::upload(gpu, &scene);
            let opacity = uploaded.casters()[0].opacity;
            let (is_textured, channels) = match opacity {
                Opacity::Translucent { texture, .. } => (texture.is_some(), if opacity.tints() { 3 } else { 1 }),
                _ => (false, 1),
            };
            let kind = match opacity {
                Opacity::Opaque => None,
                Opacity::Translucent { coverage, transmitted, .. } => Some((coverage, transmitted)),
                Opacity::Masked { .. } => panic!("masked"),
            };
            (kind, is_textured, channels, uploaded.has_translucent_surfaces())
        };
        let blend = |alpha| Material {
            alpha: AlphaMode::Blend,
            base_color: Vec4::new(1.0, 0.5, 0.0, alpha),
            ..Material::default()
        };
        let plain = || quad(1.0);
        assert_eq!(of(plain(), blend(1.0), Vec::new()), (None, false, 1, false));
        let half = SurfaceCoverage::Alpha(0.5);
        assert_eq!(of(plain(), blend(0.5), Vec::new()), (Some((half, Vec3::ZERO)), false, 1, true));
        // Alpha that varies from vertex to vertex is kept.
        let faded = Mesh { colors: [0.0, 0.0, 1.0, 1.0].map(|a| Vec4::new(1.0, 1.0, 1.0, a)).to_vec(), ..plain() };
        assert_eq!(of(faded, blend(0.5), Vec::new()), (Some((half, Vec3::ZERO)), true, 1, true));
        let glass = Material { transmission: 0.5, ..blend(0.5) };
        assert_eq!(of(plain(), glass.clone(), Vec::new()), (Some((half, Vec3::new(0.5, 0.25, 0.0))), false, 3, true));
        let whole = Material { alpha: AlphaMode::Opaque, metallic: 0.5, ..glass.clone() };
        let transmitted = Vec3::new(0.25, 0.125, 0.0);
        assert_eq!(
            of(plain(), whole.clone(), Vec::new()),
            (Some((SurfaceCoverage::Whole, transmitted)), false, 3, true)
        );
        assert_eq!(of(plain(), Material { metallic: 1.0, ..whole }, Vec::new()), (None, false, 1, false));
        let masked = Material { alpha: AlphaMode::Mask { cutoff: 0.25 }, ..glass };
        let cutoff = SurfaceCoverage::Cutoff { alpha_factor: 0.5, cutoff: 0.25 };
        assert_eq!(
            of(plain(), masked.clone(), Vec::new()),
            (Some((cutoff, Vec3::new(0.5, 0.25, 0.0))), false, 3, true)
        );
        // What has an image of its own has a texture; where a mesh has no coordinates it has none.
        let image = Image { width: 1, height: 1, rgba8: vec![[128; 4]], wrap: [Wrap::Clamp; 2] };
        let textured = Material { transmission_image: Some(0), ..masked };
        let mapped = Mesh { uvs: vec![Vec2::ZERO; 4], ..plain() };
        assert!(of(mapped, textured.clone(), vec![image.clone()]).1);
        let unmapped = Mesh { uvs: Vec::new(), ..plain() };
        assert!(!of(unmapped, textured, vec![image]).1);
    }

    #[test]
    fn shading_has_the_means_of_images() {
        let image =
            Image { width: 2, height: 1, rgba8: vec![[255, 255, 51, 0], [51, 0, 51, 0]], wrap: [Wrap::Clamp; 2] };
        let volume = Volume {
            thickness_m: 2.0,
            thickness_image: Some(0),
            attenuation_color: Vec3::new(1.0, 0.5, 0.25),
            attenuation_distance_m: 1.0,
        };
        let material = Material {
            transmission: 1.0,
            transmission_image: Some(0),
            metallic: 0.0,
            roughness: 0.5,
            metallic_roughness_image: Some(0),
            volume: Some(volume),
            ..Material::default()
        };
        let scene = Scene { images: vec![image], ..scene(quad(1.0), material.clone()) };
        let of = |material: &Material| {
            let Material { transmission, metallic, roughness, base_color, .. } = shaded(&scene, material);
            (transmission, metallic, roughness, base_color)
        };
        let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
        let (transmission, metallic, roughness, base_color) = of(&material);
        assert!(near(transmission, 0.6) && metallic == 0.0 && near(roughness, 0.25));
        assert!(base_color.truncate().abs_diff_eq(Vec3::new(1.0, 0.7, 0.55), 1e-6), "{base_color}");
        let (transmission, metallic, ..) = of(&Material { metallic: 1.0, ..material });
        assert!(near(metallic, 0.2) && near(transmission, 0.48));
    }

    #[test]
    fn nothing_is_nothing() {
        let Some(gpu) = gpu_or_skip() else { return };
        let empty = GpuScene::upload(gpu, &scene(Mesh::default(), Material::default()));
        assert!(empty.casters().is_empty() && empty.bounds.is_empty());
        assert!(GpuScene::upload(gpu, &Scene::default()).casters().is_empty());
    }

    #[test]
    fn bounds_are_the_instances() {
        let Some(gpu) = gpu_or_skip() else { return };
        let mut scene = scene(Mesh { closed: true, ..quad(1.0) }, Material::default());
        let mirror =
            Mat4::from_scale_rotation_translation(Vec3::new(-1.0, 1.0, 1.0), Default::default(), Vec3::X * 5.0);
        scene.instances.push(Instance { mesh: 0, world_from_object: mirror });
        let uploaded = GpuScene::upload(gpu, &scene);
        assert_eq!(uploaded.bounds, scene.bounds());
        let closed: Vec<_> = uploaded.casters().iter().map(|caster| caster.closed).collect();
        assert_eq!(closed, [true, false], "mirrored instances wind the other way");
    }

    #[test]
    fn what_is_moved_takes_its_bounds_along_and_comes_back() {
        let Some(gpu) = gpu_or_skip() else { return };
        let mut scene = scene(quad(1.0), Material::default());
        scene.instances.push(Instance { mesh: 0, world_from_object: Mat4::from_translation(Vec3::X * 5.0) });
        let mut uploaded = GpuScene::upload(gpu, &scene);
        let at_rest = uploaded.bounds;
        uploaded.offset_instances(gpu, &[1], Vec3::X * 2.0);
        scene.instances[1].world_from_object = Mat4::from_translation(Vec3::X * 7.0);
        assert_eq!(uploaded.bounds, scene.bounds());
        assert_eq!(uploaded.casters()[0].bounds, scene.bounds());
        uploaded.offset_instances(gpu, &[1], Vec3::ZERO);
        assert_eq!(uploaded.bounds, at_rest);
    }

    #[test]
    fn instance_lists_split_where_a_binding_ends() {
        let poses = [Mat4::IDENTITY; 5];
        let mut lists = InstanceLists::new(3 * size_of::<Mat4>() as u64);
        let runs = lists.push_all(&poses);
        assert_eq!(
            runs.iter().map(|(run, list, first)| (run.len(), *list, *first)).collect::<Vec<_>>(),
            [(3, 0, 0), (2, 1, 0)]
        );
    }
}
