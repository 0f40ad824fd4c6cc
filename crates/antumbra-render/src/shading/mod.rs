//! Shading of the image: analytic irradiance of each light times visibility, GGX highlights, a little ambient, a tone curve.
//!
//! Visibility comes from any source, such as a technique's mask or the reference's image. Everything else is the same, so
//! that two images differ only where visibility does.
//!
//! **Exposure.** One for all lights: without shadows, lights of intensity 1 light the better lit of the visible points sensibly.
//! `exposure` says how lights add up.
//!
//! **Coherence.** Smooth normals light triangles that lie in their own shadow, and exact visibility cuts that light off
//! along the triangles' edges. [`Shading::bend_normals`] makes the light fade out before these edges.
//!
//! # Limits
//! Surfaces behind translucent ones are lit with the visibility of the surface in front. An emission texture changes only
//! visibility, and does not dim the light itself.

use antumbra::contract::COHERENT_WGSL;
use antumbra::{Gpu, Mask, MaskChannels, programs};
use antumbra_light::Light;
use glam::{Mat4, UVec2, Vec3};
use wgpu::util::DeviceExt;

use crate::gpu_scene::GpuScene;
use crate::picture::{Visibility, VisibilityValues};
use crate::receivers::{ReceiverImages, storage_buffer};
use crate::{buffer_entry, drawn_texture, screen_pipeline, texture_entry};

mod bent;
mod exposure;
mod light_buffers;

pub use exposure::exposed_radiances;
pub use light_buffers::LightBuffers;

/// Shader of the passes.
const SHADING_WGSL: &str = include_str!("shading.wgsl");
/// Shader function `irradiance` of a light at a surface, and its helpers.
pub const IRRADIANCE_WGSL: &str = include_str!("irradiance.wgsl");

/// Source of a light's visibility.
#[derive(Clone, Copy, Debug)]
pub enum VisibilitySource<'a> {
    /// No shadow: visibility is 1.
    Lit,
    /// A visibility image of the shaded image's size.
    Image(&'a Visibility),
    /// A technique's mask of the shaded image's size. Three channels are used if the mask has three and its format has four
    /// components, else only the first.
    Mask(&'a Mask),
    /// A texture of unfilterable floats of the shaded image's size, and whether three channels count rather than the first only.
    Texture(&'a wgpu::TextureView, bool),
}

/// Shading of one view under one set of lights, for any number of visibilities.
#[derive(Debug)]
pub struct Shading {
    programs: ShadingPrograms,
    frame_storage: wgpu::Buffer,
    view_from_world: Mat4,
    size_px: UVec2,
    /// Layer behind translucent surfaces; `None` if the scene has none.
    behind: Option<ReceiverImages>,
    lights: Vec<LightBuffers>,
}

/// Pipelines of shading, created once per device.
#[derive(Clone, Debug)]
pub struct ShadingPrograms {
    receivers_layout: wgpu::BindGroupLayout,
    light_layout: wgpu::BindGroupLayout,
    layers_layout: wgpu::BindGroupLayout,
    light: wgpu::RenderPipeline,
    picture: wgpu::RenderPipeline,
}

/// Render targets of a shaded image.
#[derive(Debug)]
pub struct PictureTargets {
    /// The finished image, `Rgba32Float` in linear display values; it can be read and copied.
    pub picture: wgpu::Texture,
    direct: wgpu::Texture,
    behind_direct: wgpu::Texture,
}

impl PictureTargets {
    /// Creates targets of `size_px`.
    pub fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        let target = |label, format| drawn_texture(device, label, format, size_px);
        Self {
            picture: target("shading: picture", PICTURE_FORMAT),
            direct: target("shading: direct", DIRECT_FORMAT),
            behind_direct: target("shading: direct behind", DIRECT_FORMAT),
        }
    }
}

/// Storage buffer `frame` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct FrameUniform {
    view_from_clip: [[f32; 4]; 4],
    world_from_view: [[f32; 4]; 4],
    eye_in_world: [f32; 3],
    has_layer_behind: u32,
}

/// Format of lit radiance, which is summed over lights: every adapter can blend it.
const DIRECT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of the finished image, which is linear.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

impl Shading {
    /// Prepares shading of `images` under `lights`. `behind` is the layer behind translucent surfaces if the scene has any; `seen` are
    /// visible points, which determine the exposure.
    pub fn new(
        gpu: &Gpu,
        programs: &ShadingPrograms,
        images: &ReceiverImages,
        behind: Option<ReceiverImages>,
        lights: &[Light],
        seen: &[Vec3],
    ) -> Self {
        let radiances = exposed_radiances(lights, seen);
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
            lights: lights.iter().zip(radiances).map(|(light, l)| LightBuffers::new(gpu.device(), light, l)).collect(),
        }
    }

    /// Enables coherent shading: triangles that face away from all of a light are black, and the shading falls off towards
    /// them whatever their smooth normals (Sintorn, Eisemann, Assarsson 2008, section 4.3; see
    /// [`antumbra::contract::VertexFaces`]). `scene` must come from [`GpuScene::upload_with_faces`]; others have no faces to bend
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

    /// Records the shading of the same `images`, with one visibility per light.
    ///
    /// # Panics
    /// The numbers of visibilities and lights differ, or a visibility has another size than the image.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        images: &ReceiverImages,
        visibilities: &[VisibilitySource<'_>],
        targets: &PictureTargets,
    ) {
        assert_eq!(self.lights.len(), visibilities.len(), "each light needs a visibility");
        assert_eq!(
            (self.size_px, self.view_from_world),
            (images.size_px, images.view_from_world),
            "the view must be the prepared one"
        );
        // Normals of the layer behind translucent surfaces are not bent.
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
            VisibilitySource::Texture(_, is_tinted) => *is_tinted,
        };
        let uniform = light.tinted(is_tinted);
        let uniform = storage_buffer(gpu.device(), "shading: light", bytemuck::bytes_of(&uniform));
        let view = match visibility {
            VisibilitySource::Lit => upload(gpu, &Visibility::one(UVec2::ONE, vec![1.0])),
            VisibilitySource::Image(image) => {
                assert_eq!(image.size_px, self.size_px, "the visibility must have the size of the image");
                upload(gpu, image)
            }
            VisibilitySource::Mask(mask) => {
                assert_eq!(mask.size_px(), self.size_px, "the mask must have the size of the image");
                mask.view().clone()
            }
            VisibilitySource::Texture(view, _) => (*view).clone(),
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

/// Uploads a visibility image as `R32Float`, or as `Rgba32Float` if it has three channels.
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
    /// Creates the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let depth = wgpu::TextureSampleType::Depth;
        let uint = wgpu::TextureSampleType::Uint;
        let buffer = |binding, ty| buffer_entry(binding, wgpu::ShaderStages::FRAGMENT, ty);
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let group_layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            programs::create_bind_group_layout(device, &wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let receivers_layout =
            group_layout("shading: receivers", &[buffer(0, storage), texture_entry(1, depth), texture_entry(2, uint)]);
        let light_layout = group_layout(
            "shading: light",
            &[buffer(0, storage), buffer(1, storage), texture_entry(2, float), texture_entry(3, float)],
        );
        let layers_layout = group_layout(
            "shading: layers",
            &[texture_entry(0, depth), texture_entry(1, uint), texture_entry(2, float), texture_entry(3, float)],
        );
        let module = programs::create_shader_module(
            device,
            "shading",
            [IRRADIANCE_WGSL, COHERENT_WGSL, SHADING_WGSL].concat().into(),
        );
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
