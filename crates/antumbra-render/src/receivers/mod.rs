//! Receivers of a camera: depth, exact normals and surface of the first hit at each pixel's centre.
//!
//! A small deferred pass (Saito and Takahashi, "Comprehensible Rendering of 3-D Shapes", SIGGRAPH 1990): geometry is drawn
//! once, for any number of lights and techniques over the same images. As in the definition of visibility, there is one
//! sample per pixel, both faces of every triangle count, masked texels are left out, and translucent surfaces are first
//! hits. For scenes with translucent surfaces, a second layer holds what lies behind them; only shading uses it.

use antumbra::{DepthConvention, Gpu, Receivers, programs};
use antumbra_light::{ShadowDistance, enclosing_corners};
use antumbra_scene::{Aabb, AlphaMode, Camera};
use glam::{DMat4, DVec4, Mat4, UVec2, Vec2, Vec3};
use wgpu::util::DeviceExt;

use crate::gpu_scene::{Draw, Geometry, GpuScene};
use crate::{buffer_entry, drawn_texture, texture_entry};

/// Approximate number of visible points in [`ReceiverImages::seen`]: enough to weight the texels of a map.
const SEEN_POINTS: usize = 512;

/// Layer of surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Every surface.
    FirstHits,
    /// All surfaces but the translucent ones, through which the others show.
    BehindTranslucent,
}

/// Images of one layer, each of `size_px`.
#[derive(Clone, Debug)]
pub struct ReceiverImages {
    /// Width and height, pixels.
    pub size_px: UVec2,
    /// Depth, `Depth32Float`: reversed with an infinite far plane; 0 for background.
    pub depth: wgpu::Texture,
    /// Geometric normal, `Rgba32Float`: unit, in world space, on the camera's side; w is 1 where there is geometry.
    pub geometric_normal: wgpu::Texture,
    /// Surface, `Rgba32Uint`: base colour, shading normal, emission, metallic, roughness and transmission, packed by
    /// `pack_surface` of the shader.
    pub surface: wgpu::Texture,
    pub(crate) depth_view: wgpu::TextureView,
    pub(crate) geometric_normal_view: wgpu::TextureView,
    pub(crate) surface_view: wgpu::TextureView,
    /// World position of the camera, metres.
    pub eye: Vec3,
    /// View matrix of the camera.
    pub view_from_world: Mat4,
    /// Projection of the camera.
    pub clip_from_view: Mat4,
    /// Shadow distance from the eye; `None` for no limit.
    pub shadow_distance: Option<ShadowDistance>,
    /// World-space bounding box of all visible points; `None` if there are none.
    pub bounds: Option<Aabb>,
    /// World-space points whose convex hull contains all visible points; empty if there are none.
    pub hull: Vec<Vec3>,
    /// Some of the visible points, evenly distributed over the pixels.
    pub seen: Vec<Vec3>,
}

impl ReceiverImages {
    /// Creates images of `size_px` for [`ReceiverPass::record`] to draw to. The size must be positive and within the device's
    /// largest texture.
    pub fn new(device: &wgpu::Device, camera: &Camera, size_px: UVec2) -> Self {
        let texture = |label, format| drawn_texture(device, label, format, size_px);
        let depth = texture("receivers: depth", DEPTH_FORMAT);
        let geometric_normal = texture("receivers: geometric normal", NORMAL_FORMAT);
        let surface = texture("receivers: surface", SURFACE_FORMAT);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self {
            size_px,
            depth_view: view(&depth),
            geometric_normal_view: view(&geometric_normal),
            surface_view: view(&surface),
            depth,
            geometric_normal,
            surface,
            eye: camera.eye,
            view_from_world: camera.view_from_world(),
            clip_from_view: camera.clip_from_view(size_px),
            shadow_distance: camera.shadow_distance,
            bounds: None,
            hull: Vec::new(),
            seen: Vec::new(),
        }
    }

    /// Shifts the projection by a fraction of a pixel: each pixel shows the point `offset_px` to the right of its centre and below it.
    pub fn shift(&mut self, offset_px: Vec2) {
        let ndc = 2.0 * offset_px / self.size_px.as_vec2();
        self.clip_from_view = Mat4::from_translation(Vec3::new(-ndc.x, ndc.y, 0.0)) * self.clip_from_view;
    }

    /// World positions per pixel, in single precision with exactly the operations of the library's shaders; `None` for
    /// background. `depths` are the values of [`depth`](Self::depth).
    pub fn shader_positions(&self, depths: &[f32]) -> Vec<Option<Vec3>> {
        let view_from_clip = self.clip_from_view.as_dmat4().inverse().as_mat4();
        let world_from_view = self.view_from_world.as_dmat4().inverse().as_mat4();
        let position = |(i, depth): (u32, &f32)| {
            let pixel = UVec2::new(i % self.size_px.x, i / self.size_px.x).as_vec2();
            let ndc = (pixel + 0.5) / self.size_px.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
            let view = view_from_clip * ndc.extend(*depth).extend(1.0);
            (*depth > 0.0).then(|| (world_from_view * (view.truncate() / view.w).extend(1.0)).truncate())
        };
        (0..).zip(depths).map(position).collect()
    }

    /// Returns the receivers as input of the library's techniques.
    pub fn receivers(&self) -> Receivers<'_> {
        let camera = antumbra::Camera {
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            depth_convention: DepthConvention::Reversed,
        };
        Receivers::new(&self.depth_view, self.size_px, camera)
            .with_normals(&self.geometric_normal_view)
            .with_bounds(self.bounds)
            .with_hull(&self.hull)
            .with_seen(&self.seen)
            .with_shadow_distance(self.shadow_distance)
    }

    /// World positions per pixel, reconstructed from `depths`, the values of [`depth`](Self::depth); `None` for background.
    /// There are `width · height` of them.
    pub fn positions(&self, depths: &[f32]) -> Vec<Option<Vec3>> {
        let world_from_clip = self.world_from_clip();
        let pixel = |i: u32| UVec2::new(i % self.size_px.x, i / self.size_px.x);
        (0..).zip(depths).map(|(i, depth)| self.position(world_from_clip, pixel(i), *depth)).collect()
    }

    /// World position of one pixel with this depth; see [`positions`](Self::positions).
    pub fn position_at(&self, pixel: UVec2, depth: f32) -> Option<Vec3> {
        self.position(self.world_from_clip(), pixel, depth)
    }

    /// World from view, and view from clip, in double precision, so that the only error is the rounding of the depth buffer.
    fn world_from_clip(&self) -> [DMat4; 2] {
        [self.view_from_world, self.clip_from_view].map(|matrix| matrix.as_dmat4().inverse())
    }

    fn position(&self, [world_from_view, view_from_clip]: [DMat4; 2], pixel: UVec2, depth: f32) -> Option<Vec3> {
        let unit = (pixel.as_dvec2() + 0.5) / self.size_px.as_dvec2();
        let view = view_from_clip * DVec4::new(unit.x * 2.0 - 1.0, 1.0 - unit.y * 2.0, f64::from(depth), 1.0);
        (depth > 0.0).then(|| world_from_view.transform_point3(view.truncate() / view.w).as_vec3())
    }

    /// Sets all visible points, so that light maps can be fitted to them.
    pub fn note_seen(&mut self, seen: &[Vec3]) {
        self.bounds = visible_bounds(seen);
        self.hull = enclosing_corners(seen);
        self.seen = seen.iter().copied().step_by((seen.len() / SEEN_POINTS) | 1).collect();
    }

    /// Changes the camera; the images must be drawn again. Visible points are forgotten, and their box becomes the scene's, `bounds`.
    pub fn look_from(&mut self, camera: &Camera, bounds: Option<Aabb>) {
        self.eye = camera.eye;
        self.view_from_world = camera.view_from_world();
        self.clip_from_view = camera.clip_from_view(self.size_px);
        self.shadow_distance = camera.shadow_distance;
        self.bounds = bounds;
        self.hull.clear();
        self.seen.clear();
    }
}

/// Pass that draws [`ReceiverImages`].
#[derive(Debug)]
pub struct ReceiverPass {
    pub(crate) view_layout: wgpu::BindGroupLayout,
    pub(crate) draw_layout: wgpu::BindGroupLayout,
    solid: wgpu::RenderPipeline,
    masked: wgpu::RenderPipeline,
    /// Placeholder for attributes that a mesh lacks, because a binding may not be empty.
    absent_attribute: wgpu::Buffer,
}

/// Bind groups of a scene's draws.
#[derive(Debug)]
pub struct DrawGroups(Vec<wgpu::BindGroup>);

/// Uniform `View` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct ViewUniform {
    view_from_world: [[f32; 4]; 4],
    clip_from_view: [[f32; 4]; 4],
    eye_in_world: [f32; 3],
    padding: f32,
}

/// Uniform `Material` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct MaterialUniform {
    base_color: [f32; 4],
    emissive: [f32; 3],
    metallic: f32,
    roughness: f32,
    alpha_cutoff: f32,
    transmission: f32,
    flags: u32,
}

/// Bits of `flags`, as in the shader.
const HAS_UVS: u32 = 1;
const HAS_COLORS: u32 = 2;
const IS_BLENDED: u32 = 4;

/// Shader of the passes, of vertex pulling and of the alpha test.
pub(crate) const RECEIVERS_WGSL: &str = include_str!("receivers.wgsl");

pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const SURFACE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

impl ReceiverPass {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let device = gpu.device();
        let view_layout = programs::create_bind_group_layout(
            device,
            &wgpu::BindGroupLayoutDescriptor {
                label: Some("receivers: view"),
                entries: &[buffer_entry(0, wgpu::ShaderStages::VERTEX, wgpu::BufferBindingType::Uniform)],
            },
        );
        let draw_layout = draw_layout(device);
        let layout = programs::create_pipeline_layout(
            device,
            &wgpu::PipelineLayoutDescriptor {
                label: Some("receivers"),
                bind_group_layouts: &[Some(&view_layout), Some(&draw_layout)],
                immediate_size: 0,
            },
        );
        let module = programs::create_shader_module(device, "receivers", RECEIVERS_WGSL.into());
        let targets = [Some(NORMAL_FORMAT.into()), Some(SURFACE_FORMAT.into())];
        let pipeline = |fragment| draw_pipeline(device, &layout, &module, "vertex_pull", fragment, &targets);
        Self {
            solid: pipeline("fragment_solid"),
            masked: pipeline("fragment_masked"),
            absent_attribute: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("absent attribute"),
                size: size_of::<[f32; 4]>() as u64,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            view_layout,
            draw_layout,
        }
    }

    /// Creates the bind groups of the draws of `scene`, once for all its frames.
    pub fn draw_groups(&self, gpu: &Gpu, scene: &GpuScene) -> DrawGroups {
        DrawGroups(scene.draws.iter().map(|draw| self.draw_group(gpu, scene, draw)).collect())
    }

    /// Records the drawing of a layer of `scene` to `images`. `groups` must be those of the same scene.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        groups: &DrawGroups,
        images: &ReceiverImages,
        layer: Layer,
    ) {
        let view_group = self.view_group(gpu, images);
        let draws = scene
            .draws
            .iter()
            .zip(&groups.0)
            .filter(|(draw, _)| layer == Layer::FirstHits || !scene.is_translucent(draw));
        let color = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("receivers"),
            color_attachments: &[color(&images.geometric_normal_view), color(&images.surface_view)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &images.depth_view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(DepthConvention::Reversed.background()),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &view_group, &[]);
        for (draw, group) in draws {
            pass.set_pipeline(if scene.is_masked(draw) { &self.masked } else { &self.solid });
            pass.set_bind_group(1, group, &[]);
            let instances = draw.first_instance..draw.first_instance + draw.instance_count;
            pass.draw(scene.geometries[draw.geometry].corners(), instances);
        }
    }

    pub(crate) fn view_group(&self, gpu: &Gpu, images: &ReceiverImages) -> wgpu::BindGroup {
        let uniform = ViewUniform {
            view_from_world: images.view_from_world.to_cols_array_2d(),
            clip_from_view: images.clip_from_view.to_cols_array_2d(),
            eye_in_world: images.eye.to_array(),
            padding: 0.0,
        };
        let buffer = uniform_buffer(gpu.device(), "receivers: view", bytemuck::bytes_of(&uniform));
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("receivers: view"),
            layout: &self.view_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        })
    }

    pub(crate) fn draw_group(&self, gpu: &Gpu, scene: &GpuScene, draw: &Draw) -> wgpu::BindGroup {
        let geometry = &scene.geometries[draw.geometry];
        let uniform = material_uniform(scene, geometry);
        let material = uniform_buffer(gpu.device(), "receivers: material", bytemuck::bytes_of(&uniform));
        let (view, level_0, smooth) = scene.texture_of(geometry);
        let or_absent = |buffer: &Option<wgpu::Buffer>| buffer.clone().unwrap_or_else(|| self.absent_attribute.clone());
        let buffers = scene.buffers_of(geometry);
        let (uvs, colors) = (or_absent(&buffers.uvs), or_absent(&buffers.colors));
        let resources = [
            buffers.positions.as_entire_binding(),
            buffers.normals.as_entire_binding(),
            uvs.as_entire_binding(),
            colors.as_entire_binding(),
            buffers.indices.as_entire_binding(),
            scene.instances[draw.instances].as_entire_binding(),
            material.as_entire_binding(),
            wgpu::BindingResource::TextureView(view),
            wgpu::BindingResource::Sampler(level_0),
            wgpu::BindingResource::Sampler(smooth),
        ];
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("receivers: draw"),
            layout: &self.draw_layout,
            entries: &entries,
        })
    }
}

/// Layout of the group of a draw: vertex data, uniforms, texture and samplers.
fn draw_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let vertex_data = |binding| {
        buffer_entry(binding, wgpu::ShaderStages::VERTEX, wgpu::BufferBindingType::Storage { read_only: true })
    };
    let sampler = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        count: None,
    };
    let texture = texture_entry(7, wgpu::TextureSampleType::Float { filterable: true });
    programs::create_bind_group_layout(
        device,
        &wgpu::BindGroupLayoutDescriptor {
            label: Some("receivers: draw"),
            entries: &[
                vertex_data(0),
                vertex_data(1),
                vertex_data(2),
                vertex_data(3),
                vertex_data(4),
                vertex_data(5),
                buffer_entry(6, wgpu::ShaderStages::VERTEX_FRAGMENT, wgpu::BufferBindingType::Uniform),
                texture,
                sampler(8),
                sampler(9),
            ],
        },
    )
}

fn material_uniform(scene: &GpuScene, geometry: &Geometry) -> MaterialUniform {
    let material = &scene.materials[geometry.material];
    let alpha_cutoff = match material.alpha {
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.0,
    };
    let buffers = scene.buffers_of(geometry);
    let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
    MaterialUniform {
        base_color: material.base_color.to_array(),
        emissive: material.emissive.to_array(),
        metallic: material.metallic,
        roughness: material.roughness,
        alpha_cutoff,
        transmission: material.transmission,
        flags: flag(buffers.uvs.is_some(), HAS_UVS)
            | flag(buffers.colors.is_some(), HAS_COLORS)
            | flag(material.alpha == AlphaMode::Blend, IS_BLENDED),
    }
}

/// Bounding box of the visible points, grown by their rounding, because a light map fitted to it must contain them all.
fn visible_bounds(positions: &[Vec3]) -> Option<Aabb> {
    let bounds = Aabb::of(positions.iter().copied());
    // Single precision resolves 6e-8 of a coordinate; a hundred times that is still far below any texel.
    const ROUNDING: f32 = 6e-6;
    let margin = Vec3::splat(ROUNDING * (bounds.diagonal() + bounds.min.abs().max(bounds.max.abs()).max_element()));
    (!bounds.is_empty()).then(|| Aabb { min: bounds.min - margin, max: bounds.max + margin })
}

/// Creates a pipeline with vertex pulling from storage buffers that keeps the nearest surface.
pub(crate) fn draw_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    vertex: &str,
    fragment: &str,
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    programs::create_render_pipeline(
        device,
        &wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        },
    )
}

pub(crate) fn storage_buffer(device: &wgpu::Device, label: &str, contents: &[u8]) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents,
        usage: wgpu::BufferUsages::STORAGE,
    })
}

pub(crate) fn uniform_buffer(device: &wgpu::Device, label: &str, contents: &[u8]) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents,
        usage: wgpu::BufferUsages::UNIFORM,
    })
}
