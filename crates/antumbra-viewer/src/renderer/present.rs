//! The pass that composes the output image from the two sides, and the colours of the error view.

use antumbra::{Gpu, Mask, MaskChannels, programs};
use antumbra_render::{buffer_entry, screen_pipeline, texture_entry};
use glam::UVec2;
use wgpu::util::DeviceExt;

use crate::state::Show;

/// Texture format that egui samples: values are display values.
pub const OUTPUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Absolute error at either end of the colour map.
pub const ERROR_RANGE: f32 = 0.5;

/// ColorBrewer's *RdBu* of eleven classes (Brewer 2002), reversed, as in the laboratory's reports: blue is too dark, white
/// exact, red too bright.
pub const ERROR_RAMP: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

/// Colour of pixels that are not judged: background, or turned away from the light.
pub const NOT_JUDGED_COLOR: [u8; 3] = [52, 55, 60];

/// Uniform `Present` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct PresentUniform {
    ramp: [[f32; 4]; 11],
    not_judged: [f32; 4],
    divider_px: u32,
    show: u32,
    tinted: u32,
    error_range: f32,
}

/// View and layout of the output image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// First column of the right side.
    pub divider_px: u32,
    /// The view.
    pub show: Show,
}

/// Images of one side.
#[derive(Clone, Copy, Debug)]
pub struct SideImages<'a> {
    /// Shaded image, linear display values.
    pub picture: &'a wgpu::Texture,
    /// Mask of the selected light.
    pub mask: &'a Mask,
}

/// The pass that composes the output image.
#[derive(Debug)]
pub struct Present {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

impl Present {
    /// Creates the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = |binding| texture_entry(binding, wgpu::TextureSampleType::Float { filterable: false });
        let uniform = buffer_entry(0, wgpu::ShaderStages::FRAGMENT, wgpu::BufferBindingType::Uniform);
        let layout = programs::create_bind_group_layout(
            device,
            &wgpu::BindGroupLayoutDescriptor {
                label: Some("present"),
                entries: &[uniform, texture(1), texture(2), texture(3), texture(4), texture(5)],
            },
        );
        let module = programs::create_shader_module(device, "present", include_str!("present.wgsl").into());
        let pipeline = screen_pipeline(device, &module, "fragment_present", &[Some(&layout)], OUTPUT_FORMAT.into());
        Self { layout, pipeline }
    }

    /// Records the pass to `output`, which has the sides' size.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        shown: Shown,
        sides: [SideImages<'_>; 2],
        truth: &wgpu::TextureView,
        output: &wgpu::TextureView,
    ) {
        let unit = |color: [u8; 3]| {
            let [r, g, b] = color.map(|v| f32::from(v) / 255.0);
            [r, g, b, 1.0]
        };
        let is_tinted = |side: &SideImages<'_>| u32::from(side.mask.channels() == MaskChannels::Three);
        let uniform = PresentUniform {
            ramp: ERROR_RAMP.map(unit),
            not_judged: unit(NOT_JUDGED_COLOR),
            divider_px: shown.divider_px,
            show: shown.show as u32,
            tinted: is_tinted(&sides[0]) | is_tinted(&sides[1]) << 1,
            error_range: ERROR_RANGE,
        };
        let uniform = gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("present"),
            contents: bytemuck::bytes_of(&uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let pictures = sides.map(|side| side.picture.create_view(&wgpu::TextureViewDescriptor::default()));
        let resources = [
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&pictures[0]),
            wgpu::BindingResource::TextureView(&pictures[1]),
            wgpu::BindingResource::TextureView(sides[0].mask.view()),
            wgpu::BindingResource::TextureView(sides[1].mask.view()),
            wgpu::BindingResource::TextureView(truth),
        ];
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("present"),
            layout: &self.layout,
            entries: &entries,
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: output,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Uploads values by pixel as a texture of 32-bit floats.
pub fn upload_f32(gpu: &Gpu, label: &str, size_px: UVec2, values: &[f32]) -> wgpu::TextureView {
    let texture = gpu.device().create_texture_with_data(
        gpu.queue(),
        &wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(values),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
