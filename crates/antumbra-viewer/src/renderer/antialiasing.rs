//! Antialiasing of a static image.
//!
//! Masks have one sample per pixel. An image that changes is shaded at pixel centres; once it is static, each frame adds a
//! subpixel offset, and after all [`OFFSETS_PX`] the image is antialiased. As in the laboratory's images, a sample on the
//! surface of its pixel's centre takes the centre's colour, so that noise and steps of a mask are neither blurred nor
//! hidden. A sample on another surface is shaded with the mask value of a neighbour on that surface.

use antumbra::{Gpu, Mask, MaskChannels, programs};
use antumbra_light::Light;
use antumbra_render::antialiasing::{ALIKE, NORMALS_COUNT, OFFSETS_PX};
use antumbra_render::gpu_scene::GpuScene;
use antumbra_render::receivers::{DrawGroups, Layer, ReceiverImages, ReceiverPass};
use antumbra_render::shading::{PictureTargets, Shading, ShadingPrograms, VisibilitySource};
use antumbra_render::{buffer_entry, drawn_texture, screen_pipeline, texture_entry};
use antumbra_scene::Camera;
use glam::{UVec2, Vec2, Vec3};
use wgpu::util::DeviceExt;

/// Format of the accumulated images; every adapter can blend it.
const SUM_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Storage buffer `samples` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct SamplesUniform {
    view_from_clip: [[f32; 4]; 4],
    shifted_view_from_clip: [[f32; 4]; 4],
    world_from_view: [[f32; 4]; 4],
    eye_in_world: [f32; 3],
    pixel_at_1_m: f32,
    offset_px: [f32; 2],
    weight: f32,
    padding: f32,
}

/// Pipelines of a device.
#[derive(Debug)]
pub struct Antialiasing {
    samples_layout: wgpu::BindGroupLayout,
    values_layout: wgpu::BindGroupLayout,
    gather: [wgpu::RenderPipeline; 2],
    add: wgpu::RenderPipeline,
}

/// Textures of the image's size, created when the image first becomes static.
#[derive(Debug)]
pub struct Smoothed {
    shifted: ReceiverImages,
    behind: Option<ReceiverImages>,
    targets: PictureTargets,
    /// Accumulated images: the left or only side's, and the right side's.
    sums: [wgpu::Texture; 2],
    /// Version of the accumulated images and the number of offsets that they contain.
    progress: Option<(u64, usize)>,
}

/// Inputs that are redrawn for each offset.
#[derive(Clone, Copy, Debug)]
pub struct Still<'a> {
    pub receivers: &'a ReceiverPass,
    pub programs: &'a ShadingPrograms,
    pub scene: &'a GpuScene,
    pub groups: &'a DrawGroups,
    pub images: &'a ReceiverImages,
    pub camera: &'a Camera,
    pub lights: &'a [Light],
    pub exposure: &'a [Vec3],
    /// Version number, different whenever any input or a side's mask differs.
    pub version: u64,
}

/// A side's masks, one per light, and its image sampled at pixel centres.
#[derive(Clone, Copy, Debug)]
pub struct StillSide<'a> {
    pub masks: &'a [Mask],
    pub picture: &'a wgpu::Texture,
}

impl Smoothed {
    /// Creates empty textures for images of `size_px`.
    pub fn new(gpu: &Gpu, camera: &Camera, size_px: UVec2, has_layer_behind: bool) -> Self {
        let device = gpu.device();
        let sum = || drawn_texture(device, "viewer: antialiased", SUM_FORMAT, size_px);
        let images = || ReceiverImages::new(device, camera, size_px);
        Self {
            shifted: images(),
            behind: has_layer_behind.then(images),
            targets: PictureTargets::new(device, size_px),
            sums: [sum(), sum()],
            progress: None,
        }
    }

    /// A side's antialiased image; `None` until it is complete for `version`.
    pub fn picture(&self, side: usize, version: u64) -> Option<&wgpu::Texture> {
        (self.progress == Some((version, OFFSETS_PX.len()))).then(|| &self.sums[side])
    }
}

impl Antialiasing {
    /// Creates the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let depth = wgpu::TextureSampleType::Depth;
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let samples = buffer_entry(0, wgpu::ShaderStages::FRAGMENT, storage);
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            programs::create_bind_group_layout(device, &wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let samples_layout = layout(
            "antialiasing: samples",
            &[
                samples,
                texture_entry(1, depth),
                texture_entry(2, float),
                texture_entry(3, depth),
                texture_entry(4, float),
            ],
        );
        let values_layout = layout("antialiasing: values", &[texture_entry(0, float), texture_entry(1, float)]);
        let source = format!(
            "const NORMALS_COUNT = {NORMALS_COUNT:?};\nconst ALIKE = {ALIKE:?};\n{}",
            include_str!("antialiasing.wgsl")
        );
        let module = programs::create_shader_module(device, "antialiasing", source.into());
        let pipeline = |fragment: &str, target: wgpu::ColorTargetState| {
            screen_pipeline(device, &module, fragment, &[Some(&samples_layout), Some(&values_layout)], target)
        };
        let sum = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = Some(wgpu::BlendState { color: sum, alpha: sum });
        Self {
            gather: MASK_FORMATS.map(|format| pipeline("fragment_gather", format.into())),
            add: pipeline("fragment_add", wgpu::ColorTargetState { blend, ..SUM_FORMAT.into() }),
            samples_layout,
            values_layout,
        }
    }

    /// Adds the next offset; returns `false` if all have been added.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        smoothed: &mut Smoothed,
        still: &Still<'_>,
        sides: &[StillSide<'_>],
    ) -> bool {
        let done = smoothed.progress.filter(|(version, _)| *version == still.version).map_or(0, |(_, done)| done);
        let Some(&offset_px) = OFFSETS_PX.get(done) else { return false };
        let behind = smoothed.behind.as_mut();
        for (images, layer) in [(Some(&mut smoothed.shifted), Layer::FirstHits), (behind, Layer::BehindTranslucent)] {
            let Some(images) = images else { continue };
            images.look_from(still.camera, still.images.bounds);
            images.shift(offset_px);
            still.receivers.record(gpu, encoder, still.scene, still.groups, images, layer);
        }
        let shading =
            Shading::new(gpu, still.programs, &smoothed.shifted, smoothed.behind.clone(), still.lights, still.exposure);
        let samples = self.samples_group(gpu, still, &smoothed.shifted, offset_px);
        for (side, sum) in sides.iter().zip(&smoothed.sums) {
            let gathered: Vec<_> = side.masks.iter().map(|mask| self.gather(gpu, encoder, &samples, mask)).collect();
            let sources: Vec<_> =
                gathered.iter().map(|(view, is_tinted)| VisibilitySource::Texture(view, *is_tinted)).collect();
            shading.record(gpu, encoder, &smoothed.shifted, &sources, &smoothed.targets);
            let values = self.values_group(gpu, &view_of(side.picture), &view_of(&smoothed.targets.picture));
            draw(encoder, "antialiasing: add", &self.add, &samples, &values, &view_of(sum), done == 0);
        }
        smoothed.progress = Some((still.version, done + 1));
        true
    }

    /// Resamples a mask at the shifted image's samples. Also returns whether the mask has three channels.
    fn gather(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        samples: &wgpu::BindGroup,
        mask: &Mask,
    ) -> (wgpu::TextureView, bool) {
        let format = mask.texture().format();
        let texture = drawn_texture(gpu.device(), "viewer: gathered mask", format, mask.size_px());
        let values = self.values_group(gpu, mask.view(), mask.view());
        let place = MASK_FORMATS.iter().position(|known| *known == format).expect("a format of the viewer's masks");
        let view = view_of(&texture);
        draw(encoder, "antialiasing: gather", &self.gather[place], samples, &values, &view, true);
        (view, mask.channels() == MaskChannels::Three)
    }

    fn samples_group(
        &self,
        gpu: &Gpu,
        still: &Still<'_>,
        shifted: &ReceiverImages,
        offset_px: Vec2,
    ) -> wgpu::BindGroup {
        let Still { images, camera, .. } = still;
        let uniform = SamplesUniform {
            view_from_clip: images.clip_from_view.inverse().to_cols_array_2d(),
            shifted_view_from_clip: shifted.clip_from_view.inverse().to_cols_array_2d(),
            world_from_view: images.view_from_world.inverse().to_cols_array_2d(),
            eye_in_world: images.eye.to_array(),
            pixel_at_1_m: 2.0 * (0.5 * camera.fov_y_rad).tan() / images.size_px.y as f32,
            offset_px: offset_px.to_array(),
            weight: 1.0 / OFFSETS_PX.len() as f32,
            padding: 0.0,
        };
        let buffer = gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("antialiasing"),
            contents: bytemuck::bytes_of(&uniform),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let views = [&images.depth, &images.geometric_normal, &shifted.depth, &shifted.geometric_normal].map(view_of);
        let entries: Vec<_> = std::iter::once(buffer.as_entire_binding())
            .chain(views.iter().map(wgpu::BindingResource::TextureView))
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antialiasing: samples"),
            layout: &self.samples_layout,
            entries: &entries,
        })
    }

    fn values_group(&self, gpu: &Gpu, values: &wgpu::TextureView, shifted: &wgpu::TextureView) -> wgpu::BindGroup {
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antialiasing: values"),
            layout: &self.values_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(values) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(shifted) },
            ],
        })
    }
}

/// Formats of the viewer's masks of one channel and of three.
const MASK_FORMATS: [wgpu::TextureFormat; 2] = [mask_format(MaskChannels::One), mask_format(MaskChannels::Three)];

/// Format of the viewer's masks. Three channels share a texel, so that shading reads them at once.
pub const fn mask_format(channels: MaskChannels) -> wgpu::TextureFormat {
    match channels {
        MaskChannels::One => Mask::FORMAT,
        MaskChannels::Three => wgpu::TextureFormat::Rgba16Float,
    }
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Draws a full-screen pass; a first pass clears the target.
fn draw(
    encoder: &mut wgpu::CommandEncoder,
    label: &str,
    pipeline: &wgpu::RenderPipeline,
    samples: &wgpu::BindGroup,
    values: &wgpu::BindGroup,
    target: &wgpu::TextureView,
    is_first: bool,
) {
    let load = if is_first { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, samples, &[]);
    pass.set_bind_group(1, values, &[]);
    pass.draw(0..3, 0..1);
}
