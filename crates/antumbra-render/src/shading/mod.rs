//! The picture: analytic irradiance of each light times visibility, GGX highlights, a little ambient, a tone curve.
//!
//! Visibility comes from anywhere: a technique's mask, the reference's image. All else is the same for all, so that two
//! pictures differ where visibility does.
//!
//! **Exposure.** A light's intensity is a scale of its radiant exitance, and 1 exposes sensibly whatever its size and
//! distance: each light's radiance is divided by the irradiance that it would give, unshadowed, to the better lit of
//! the points in view (`exposed_radiance`). So lights of intensity 1 are about equally strong in the picture.
//!
//! **Coherence.** Smooth normals light triangles that lie in their own shadow, and exact visibility cuts that light off
//! along the triangles' edges. [`Shading::bend_normals`] lets the light fade out before them.
//!
//! # Limits
//! What shows through tinted surfaces is lit with the visibility of the surface in front of it. An emission texture
//! dims nothing by itself: it shapes visibility alone.

use antumbra::contract::COHERENT_WGSL;
use antumbra::{Gpu, Mask, MaskChannels};
use antumbra_light::{Light, LightShape, SampleSet};
use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};
use wgpu::util::DeviceExt;

use crate::drawn_texture;
use crate::gpu_scene::GpuScene;
use crate::picture::{Visibility, VisibilityValues};
use crate::receivers::{ReceiverImages, buffer_entry, storage_buffer};

mod bent;

/// The passes, and the irradiance of lights that they use.
const SHADING_WGSL: &str = include_str!("shading.wgsl");
/// `irradiance` of a light at a surface, and what it takes.
pub const IRRADIANCE_WGSL: &str = include_str!("irradiance.wgsl");

/// Where a light's visibility comes from.
#[derive(Clone, Copy, Debug)]
pub enum VisibilitySource<'a> {
    /// Nothing is in shadow.
    Lit,
    /// An image of the picture's size.
    Image(&'a Visibility),
    /// A technique's mask of the picture's size. Of three channels in a format of four components all count; in others the
    /// first.
    Mask(&'a Mask),
}

/// Shades one view under one set of lights, as often as there are visibilities to see.
#[derive(Debug)]
pub struct Shading {
    programs: ShadingPrograms,
    frame_storage: wgpu::Buffer,
    view_from_world: Mat4,
    size_px: UVec2,
    /// What lies behind tinted surfaces; `None` where the scene has none.
    behind: Option<ReceiverImages>,
    lights: Vec<LightBuffers>,
}

/// A light's uniform and its list of points.
#[derive(Debug)]
pub struct LightBuffers {
    uniform: LightUniform,
    /// Storage `light_points` of the shader.
    pub points: wgpu::Buffer,
    /// See [`Shading::bend_normals`].
    bent: Option<wgpu::TextureView>,
}

/// The pipelines of the picture, made once for a device.
#[derive(Clone, Debug)]
pub struct ShadingPrograms {
    receivers_layout: wgpu::BindGroupLayout,
    light_layout: wgpu::BindGroupLayout,
    layers_layout: wgpu::BindGroupLayout,
    light: wgpu::RenderPipeline,
    picture: wgpu::RenderPipeline,
}

/// What a picture is drawn to.
#[derive(Debug)]
pub struct PictureTargets {
    /// `Rgba32Float`: the finished picture in linear display values, and usages to be read and copied.
    pub picture: wgpu::Texture,
    direct: wgpu::Texture,
    behind_direct: wgpu::Texture,
}

impl PictureTargets {
    /// Targets of `size_px`.
    pub fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        let target = |label, format| drawn_texture(device, label, format, size_px);
        Self {
            picture: target("shading: picture", PICTURE_FORMAT),
            direct: target("shading: direct", DIRECT_FORMAT),
            behind_direct: target("shading: direct behind", DIRECT_FORMAT),
        }
    }
}

/// Storage `frame` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct FrameUniform {
    view_from_clip: [[f32; 4]; 4],
    world_from_view: [[f32; 4]; 4],
    eye_in_world: [f32; 3],
    has_layer_behind: u32,
}

/// Uniform `Light` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct LightUniform {
    center: [f32; 3],
    kind: u32,
    right: [f32; 3],
    half_width: f32,
    up: [f32; 3],
    half_height: f32,
    axis: [f32; 3],
    half_depth: f32,
    radiance: [f32; 3],
    point_count: u32,
    is_tinted: u32,
    /// Cosines of a spot's inner and outer angle; −2 and −3 where there is no cone.
    cone_cosines: [f32; 2],
    padding: u32,
}

/// Lit radiance, added up light by light: a format that every adapter can blend.
const DIRECT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// The finished picture, linear.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

impl Shading {
    /// Makes ready to shade what `images` show under `lights`. `behind` is what lies behind tinted surfaces, where the scene
    /// has any; `seen` are points in view, to which lights are exposed.
    pub fn new(
        gpu: &Gpu,
        programs: &ShadingPrograms,
        images: &ReceiverImages,
        behind: Option<ReceiverImages>,
        lights: &[Light],
        seen: &[Vec3],
    ) -> Self {
        let seen: Vec<Vec3> = seen.iter().copied().step_by(seen.len().div_ceil(EXPOSURE_POINTS).max(1)).collect();
        let frame = FrameUniform {
            view_from_clip: images.clip_from_view.inverse().to_cols_array_2d(),
            world_from_view: images.view_from_world.inverse().to_cols_array_2d(),
            eye_in_world: images.eye.to_array(),
            has_layer_behind: behind.is_some().into(),
        };
        Self {
            programs: programs.clone(),
            frame_storage: storage_buffer(gpu.device(), "shading: frame", bytemuck::bytes_of(&frame)),
            view_from_world: images.view_from_world,
            size_px: images.size_px,
            behind,
            lights: lights.iter().map(|light| LightBuffers::new(gpu.device(), light, &seen)).collect(),
        }
    }

    /// Shades coherently from now on: triangles that face away from all of a light are black, and the shading falls off
    /// towards them, whatever their smooth normals say (Sintorn, Eisemann, Assarsson 2008, section 4.3; see
    /// [`antumbra::contract::VertexFaces`]). `scene` is of [`GpuScene::upload_with_faces`]; any other has no faces to bend
    /// normals by, and nothing changes.
    pub fn bend_normals(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        images: &ReceiverImages,
    ) {
        let views = bent::bent_images(gpu, encoder, scene, images, &self.lights);
        for (light, view) in self.lights.iter_mut().zip(views) {
            light.bent = Some(view);
        }
    }

    /// Records the picture of the same `images`, each light seen through its visibility.
    ///
    /// # Panics
    /// Where there are not as many visibilities as lights, or one is of another size than the picture.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        images: &ReceiverImages,
        visibilities: &[VisibilitySource<'_>],
        targets: &PictureTargets,
    ) {
        assert_eq!(self.lights.len(), visibilities.len(), "each light needs its visibility");
        assert_eq!((self.size_px, self.view_from_world), (images.size_px, images.view_from_world), "another view");
        // What lies behind tinted surfaces is not bent.
        let nothing_bent = upload(gpu, &Visibility::one(UVec2::ONE, vec![1.0]));
        let light_groups: Vec<_> = self
            .lights
            .iter()
            .zip(visibilities)
            .map(|(light, visibility)| {
                let bent = light.bent.clone().unwrap_or_else(|| nothing_bent.clone());
                [bent, nothing_bent.clone()].map(|bent| self.light_group(gpu, light, visibility, &bent))
            })
            .collect();
        let behind = self.behind.as_ref().unwrap_or(images);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let [direct_view, behind_direct_view, picture_view] =
            [&targets.direct, &targets.behind_direct, &targets.picture].map(view);
        let layers = [(images, &direct_view), (behind, &behind_direct_view)];
        for (i, (layer, target)) in layers[..if self.behind.is_some() { 2 } else { 1 }].iter().enumerate() {
            let receivers = self.receivers_group(gpu, layer);
            let mut pass = begin_pass(encoder, "shading: lights", target);
            pass.set_pipeline(&self.programs.light);
            pass.set_bind_group(0, &receivers, &[]);
            for light in &light_groups {
                pass.set_bind_group(1, &light[i], &[]);
                pass.draw(0..3, 0..1);
            }
        }
        let receivers = self.receivers_group(gpu, images);
        let layers = self.layers_group(gpu, behind, &direct_view, &behind_direct_view);
        let mut pass = begin_pass(encoder, "shading: picture", &picture_view);
        pass.set_pipeline(&self.programs.picture);
        pass.set_bind_group(0, &receivers, &[]);
        pass.set_bind_group(2, &layers, &[]);
        pass.draw(0..3, 0..1);
    }

    fn receivers_group(&self, gpu: &Gpu, images: &ReceiverImages) -> wgpu::BindGroup {
        bind_group(
            gpu,
            "shading: receivers",
            &self.programs.receivers_layout,
            [
                self.frame_storage.as_entire_binding(),
                wgpu::BindingResource::TextureView(&images.depth_view),
                wgpu::BindingResource::TextureView(&images.surface_view),
            ],
        )
    }

    fn light_group(
        &self,
        gpu: &Gpu,
        light: &LightBuffers,
        visibility: &VisibilitySource<'_>,
        bent: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let is_tinted = match visibility {
            VisibilitySource::Lit => false,
            VisibilitySource::Image(image) => image.channel_count() == 3,
            VisibilitySource::Mask(mask) => {
                mask.channels() == MaskChannels::Three && mask.texture().format().components() == 4
            }
        };
        let uniform = LightUniform { is_tinted: is_tinted.into(), ..light.uniform };
        let uniform = storage_buffer(gpu.device(), "shading: light", bytemuck::bytes_of(&uniform));
        let view = match visibility {
            VisibilitySource::Lit => upload(gpu, &Visibility::one(UVec2::ONE, vec![1.0])),
            VisibilitySource::Image(image) => {
                assert_eq!(image.size_px, self.size_px, "visibility of another size than the picture");
                upload(gpu, image)
            }
            VisibilitySource::Mask(mask) => {
                assert_eq!(mask.size_px(), self.size_px, "a mask of another size than the picture");
                mask.view().clone()
            }
        };
        bind_group(
            gpu,
            "shading: light",
            &self.programs.light_layout,
            [
                uniform.as_entire_binding(),
                light.points.as_entire_binding(),
                wgpu::BindingResource::TextureView(&view),
                wgpu::BindingResource::TextureView(bent),
            ],
        )
    }

    fn layers_group(
        &self,
        gpu: &Gpu,
        behind: &ReceiverImages,
        direct: &wgpu::TextureView,
        behind_direct: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        bind_group(
            gpu,
            "shading: layers",
            &self.programs.layers_layout,
            [
                wgpu::BindingResource::TextureView(&behind.depth_view),
                wgpu::BindingResource::TextureView(&behind.surface_view),
                wgpu::BindingResource::TextureView(direct),
                wgpu::BindingResource::TextureView(behind_direct),
            ],
        )
    }
}

fn begin_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    target: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })],
        ..wgpu::RenderPassDescriptor::default()
    })
}

fn bind_group<const N: usize>(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let mut binding = 0;
    let entries = resources.map(|resource| {
        binding += 1;
        wgpu::BindGroupEntry { binding: binding - 1, resource }
    });
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// A visibility image as `R32Float`, or `Rgba32Float` where it has three channels.
fn upload(gpu: &Gpu, visibility: &Visibility) -> wgpu::TextureView {
    let texels;
    let (format, bytes): (_, &[u8]) = match &visibility.values {
        VisibilityValues::One(values) => (wgpu::TextureFormat::R32Float, bytemuck::cast_slice(values)),
        VisibilityValues::Three(values) => {
            texels = values.iter().map(|v| v.extend(1.0)).collect::<Vec<_>>();
            (wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(&texels))
        }
    };
    let texture = gpu.device().create_texture_with_data(
        gpu.queue(),
        &wgpu::TextureDescriptor {
            label: Some("shading: visibility"),
            size: wgpu::Extent3d {
                width: visibility.size_px.x,
                height: visibility.size_px.y,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytes,
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

impl ShadingPrograms {
    /// Makes the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let depth = wgpu::TextureSampleType::Depth;
        let uint = wgpu::TextureSampleType::Uint;
        let buffer = |binding, ty| buffer_entry(binding, wgpu::ShaderStages::FRAGMENT, ty);
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let group_layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let receivers_layout =
            group_layout("shading: receivers", &[buffer(0, storage), texture(1, depth), texture(2, uint)]);
        let light_layout = group_layout(
            "shading: light",
            &[buffer(0, storage), buffer(1, storage), texture(2, float), texture(3, float)],
        );
        let layers_layout = group_layout(
            "shading: layers",
            &[texture(0, depth), texture(1, uint), texture(2, float), texture(3, float)],
        );
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("shading"),
            source: wgpu::ShaderSource::Wgsl([IRRADIANCE_WGSL, COHERENT_WGSL, SHADING_WGSL].concat().into()),
        });
        let pipeline = |fragment: &str, groups: &[Option<&wgpu::BindGroupLayout>], target: wgpu::ColorTargetState| {
            screen_pipeline(device, &module, fragment, groups, target)
        };
        let sum = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let add = wgpu::BlendState { color: sum, alpha: sum };
        Self {
            light: pipeline(
                "fragment_light",
                &[Some(&receivers_layout), Some(&light_layout)],
                wgpu::ColorTargetState { blend: Some(add), ..DIRECT_FORMAT.into() },
            ),
            picture: pipeline(
                "fragment_picture",
                &[Some(&receivers_layout), None, Some(&layers_layout)],
                PICTURE_FORMAT.into(),
            ),
            receivers_layout,
            light_layout,
            layers_layout,
        }
    }
}

/// Draws a triangle over the whole picture by the fragment stage of that name.
fn screen_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    fragment: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
    target: wgpu::ColorTargetState,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(fragment),
        bind_group_layouts: groups,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex_screen"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(target)],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Kinds of light, as in the shader.
const RECTANGLE: u32 = 0;
const DISK: u32 = 1;
const SPHERE: u32 = 2;
const ELLIPSOID: u32 = 3;
const SUN: u32 = 4;
const POINTS: u32 = 5;

/// A light without size shines as one of this half-width, metres; far below what a picture shows.
const LEAST_HALF_WIDTH_M: f32 = 1e-3;
/// And a sun, as the tangent of half its angle.
const LEAST_TANGENT: f32 = 1e-4;

impl LightBuffers {
    /// A light, exposed to the points `seen`; without any, of no radiance.
    pub fn new(device: &wgpu::Device, light: &Light, seen: &[Vec3]) -> Self {
        let points: Vec<Vec4> = match &light.shape {
            LightShape::Points { positions_m } => positions_m.iter().map(|p| p.extend(0.0)).collect(),
            _ => vec![Vec4::ZERO],
        };
        Self {
            uniform: light_uniform(light, exposed_radiance(light, seen)),
            points: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("shading: light points"),
                contents: bytemuck::cast_slice(&points),
                usage: wgpu::BufferUsages::STORAGE,
            }),
            bent: None,
        }
    }

    /// Uniform `Light` of the shader.
    pub fn uniform_bytes(&self) -> &[u8] {
        bytemuck::bytes_of(&self.uniform)
    }
}

fn light_uniform(light: &Light, radiance: Vec3) -> LightUniform {
    let frame = light.frame();
    let (kind, half_size) = kind_and_half_size(&light.shape);
    LightUniform {
        center: frame.center.to_array(),
        kind,
        right: frame.right.to_array(),
        half_width: half_size.x,
        up: frame.up.to_array(),
        half_height: half_size.y,
        axis: frame.axis.to_array(),
        half_depth: half_size.z,
        radiance: radiance.to_array(),
        point_count: match &light.shape {
            LightShape::Points { positions_m } => positions_m.len() as u32,
            _ => 0,
        },
        is_tinted: 0,
        cone_cosines: light.cone.map_or([-2.0, -3.0], |cone| [cone.inner_rad.cos(), cone.outer_rad.cos()]),
        padding: 0,
    }
}

fn kind_and_half_size(shape: &LightShape) -> (u32, Vec3) {
    let at_least = |v: Vec3| v.max(Vec3::splat(LEAST_HALF_WIDTH_M));
    match shape {
        LightShape::Rectangle { size_m } => (RECTANGLE, at_least(0.5 * size_m.extend(0.0))),
        LightShape::Disk { radius_m } => (DISK, at_least(Vec3::splat(*radius_m))),
        LightShape::Sphere { radius_m } => (SPHERE, at_least(Vec3::splat(*radius_m))),
        LightShape::Ellipsoid { radii_m } => (ELLIPSOID, at_least(*radii_m)),
        LightShape::Sun { angular_diameter_rad } => {
            (SUN, Vec3::splat((0.5 * angular_diameter_rad).tan().max(LEAST_TANGENT)))
        }
        LightShape::Points { .. } => (POINTS, Vec3::ZERO),
    }
}

/// Points in view that exposure looks at, at most.
const EXPOSURE_POINTS: usize = 2048;
/// Light points for each of them.
const EXPOSURE_LIGHT_POINTS: u32 = 16;
/// Which of the points in view, sorted by irradiance, gets the full exposure: most of the picture is then no brighter,
/// and what is close to a lamp may be.
const EXPOSED_QUANTILE: f32 = 0.75;
/// Irradiance there: a white diffuse surface that faces the light has the radiance 2.5. Chosen by eye on the built-in
/// scenes, so that a lit grey floor is bright and a white wall keeps its texture.
const EXPOSED_IRRADIANCE: f32 = 2.5 * std::f32::consts::PI;

/// The radiance (of points: the radiant intensity) with which a light of intensity 1 exposes the points `seen`
/// sensibly, times its intensity and colour.
fn exposed_radiance(light: &Light, seen: &[Vec3]) -> Vec3 {
    let points = SampleSet::Stratified.points(EXPOSURE_LIGHT_POINTS, 0);
    let mut irradiances: Vec<f32> =
        seen.iter().map(|x| facing_irradiance(light, &points, *x)).filter(|e| e.is_finite() && *e > 0.0).collect();
    irradiances.sort_unstable_by(f32::total_cmp);
    let exposed = (irradiances.len() as f32 * EXPOSED_QUANTILE) as usize;
    match irradiances.get(exposed) {
        Some(irradiance) => light.color * (light.intensity * EXPOSED_IRRADIANCE / irradiance),
        // The light reaches nothing that is seen.
        None => Vec3::ZERO,
    }
}

/// The unshadowed irradiance, at unit radiance, of a surface at `x` that faces the light: summed over points of the
/// light, given in the unit cube.
fn facing_irradiance(light: &Light, points: &[Vec3], x: Vec3) -> f32 {
    let frame = light.frame();
    if !light.reaches(&frame, x) {
        return 0.0;
    }
    let cosine = (x - light.center).normalize_or_zero().dot(light.axis);
    let strength = light.cone.map_or(1.0, |cone| cone.strength(cosine));
    let (kind, half_size) = kind_and_half_size(&light.shape);
    let Vec2 { x: half_width, y: half_height } = half_size.truncate();
    let disk_area = std::f32::consts::PI * half_width * half_width;
    match kind {
        SUN => return disk_area,
        POINTS => {
            let LightShape::Points { positions_m } = &light.shape else { return 0.0 };
            let sum: f32 = positions_m.iter().map(|p| 1.0 / p.distance_squared(x)).sum();
            return strength * sum / positions_m.len() as f32;
        }
        _ => {}
    }
    let emits_to_all_sides = matches!(kind, SPHERE | ELLIPSOID);
    let area = match kind {
        RECTANGLE => 4.0 * half_width * half_height,
        ELLIPSOID => std::f32::consts::PI * half_size.element_product().powf(2.0 / 3.0),
        _ => disk_area,
    };
    let towards = (light.center - x).normalize_or_zero();
    let sum: f32 = points
        .iter()
        .map(|u| {
            let segment = light.point(&frame, *u, x).vector_from(x);
            let distance = segment.length().max(LEAST_HALF_WIDTH_M);
            let direction = segment / distance;
            let emitted = if emits_to_all_sides { 1.0 } else { (-direction.dot(light.axis)).max(0.0) };
            emitted * direction.dot(towards).max(0.0) / (distance * distance)
        })
        .sum();
    strength * area * sum / points.len() as f32
}
