//! Bevy without a window: renders a scene for some frames and reads the image back.
#![allow(dead_code)]

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use antumbra_scene::{AlphaMode as SceneAlphaMode, Scene};
use bevy::app::TerminalCtrlCHandlerPlugin;
use bevy::asset::RenderAssetUsages;
use bevy::camera::{Hdr, PerspectiveProjection, RenderTarget};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor};
use bevy::light::SunDisk;
use bevy::log::LogPlugin;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::texture::GpuImage;
use bevy::window::ExitCondition;
use bevy_antumbra::{AntumbraPlugin, NoSoftShadows, Patch, SoftShadows};

/// Lock for one app at a time, because software adapters use all cores of the machine.
static ONE: Mutex<()> = Mutex::new(());

/// App that renders into an image.
pub struct Headless {
    pub app: App,
    pub size_px: UVec2,
    target: Handle<Image>,
    _one: MutexGuard<'static, ()>,
}

/// Image in linear colours, row by row from the top left.
#[derive(Clone, Debug)]
pub struct Picture {
    pub size_px: UVec2,
    pub pixels: Vec<[f32; 3]>,
}

impl Headless {
    /// Creates an app with the plugin.
    pub fn new(size_px: UVec2, settings: SoftShadows) -> Self {
        let mut headless = Self::bare(size_px);
        headless.app.add_plugins(AntumbraPlugin { settings });
        headless.finish();
        headless
    }

    /// Creates an app without the plugin; the caller has to call [`finish`](Self::finish).
    pub fn bare(size_px: UVec2) -> Self {
        Self::reading(size_px, Path::new("assets"))
    }

    /// Creates an app without the plugin that reads assets from a folder.
    pub fn reading(size_px: UVec2, folder: &Path) -> Self {
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut app = App::new();
        let window = WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        let render = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
        let plugins = DefaultPlugins
            .set(window)
            .set(render)
            .set(AssetPlugin { file_path: folder.to_string_lossy().into(), ..default() })
            .disable::<PipelinedRenderingPlugin>()
            .disable::<TerminalCtrlCHandlerPlugin>();
        // The examples' window feature can be enabled.
        #[cfg(feature = "window")]
        let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
        // Only the first app of a process may install the log.
        static HAS_LOG: AtomicBool = AtomicBool::new(false);
        let log = LogPlugin { filter: "warn,bevy_light=error,bevy_render::renderer=error".into(), ..default() };
        app.add_plugins(if HAS_LOG.swap(true, Ordering::Relaxed) {
            plugins.disable::<LogPlugin>()
        } else {
            plugins.set(log)
        });
        app.insert_resource(GlobalAmbientLight::NONE).insert_resource(ClearColor(Color::BLACK));
        let mut image = Image::new_target_texture(size_px.x, size_px.y, TextureFormat::Rgba16Float, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        Self { app, size_px, target, _one: one }
    }

    pub fn finish(&mut self) {
        let start = Instant::now();
        while self.app.plugins_state() == bevy::app::PluginsState::Adding {
            assert!(start.elapsed() < Duration::from_secs(60), "the render device takes too long");
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        self.app.finish();
        self.app.cleanup();
    }

    /// Waits until the GPU has finished all submitted work.
    pub fn wait(&self) {
        let device = self.app.sub_app(RenderApp).world().resource::<RenderDevice>();
        device.wgpu_device().poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    }

    /// Returns the components of a camera that renders into the image.
    pub fn camera(&self, camera: &antumbra_scene::Camera) -> impl Bundle + use<> {
        (
            Camera3d::default(),
            RenderTarget::Image(self.target.clone().into()),
            Hdr,
            Tonemapping::None,
            DebandDither::Disabled,
            Projection::Perspective(PerspectiveProjection {
                fov: camera.fov_y_rad,
                near: camera.near_m,
                aspect_ratio: self.size_px.x as f32 / self.size_px.y as f32,
                ..default()
            }),
            Transform::from_translation(from(camera.eye)).looking_at(from(camera.target), from(camera.up)),
        )
    }

    /// Runs frames until the shader is patched, and then the given number of frames.
    pub fn run(&mut self, frames: u32) {
        let start = Instant::now();
        while self.app.world().get_resource::<Patch>() == Some(&Patch::Waiting) {
            assert!(start.elapsed() < Duration::from_secs(60), "Bevy's shader is never loaded");
            self.app.update();
            std::thread::sleep(Duration::from_millis(5));
        }
        for _ in 0..frames {
            self.app.update();
            assert!(self.app.should_exit().is_none(), "rendering failed: the log says how");
        }
    }

    /// Returns the image after some frames.
    pub fn picture(&mut self, frames: u32) -> Picture {
        self.run(frames);
        let world = self.app.sub_app(RenderApp).world();
        let (device, queue) = (world.resource::<RenderDevice>().wgpu_device(), world.resource::<RenderQueue>());
        let image = world.resource::<RenderAssets<GpuImage>>().get(&self.target).expect("the target is on the GPU");
        Picture { size_px: self.size_px, pixels: read_rgba16(device, queue, &image.texture) }
    }
}

/// Returns the largest difference of two images, relative to the brightest value of the first.
pub fn difference(a: &Picture, b: &Picture) -> f32 {
    let most = a.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    let values = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    values.fold(0.0f32, |most, (a, b)| most.max((a - b).abs())) / most
}

fn read_rgba16(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Vec<[f32; 3]> {
    let row_bytes = (8 * texture.width()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(row_bytes * texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let target = wgpu::TexelCopyBufferInfo { buffer: &readback, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapping for reading"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    let bytes = readback.get_mapped_range(..).expect("mapped");
    let half = |b: &[u8]| half_to_f32(u16::from_le_bytes([b[0], b[1]]));
    let pixel = |p: &[u8]| [half(&p[0..]), half(&p[2..]), half(&p[4..])];
    let row = |row: &[u8]| row[..8 * texture.width() as usize].chunks_exact(8).map(pixel).collect::<Vec<_>>();
    bytes.chunks_exact(row_bytes as usize).flat_map(row).collect()
}

fn half_to_f32(half: u16) -> f32 {
    let (sign, exponent, mantissa) = (half >> 15, half >> 10 & 31, half & 1023);
    let size = match exponent {
        0 => f32::from(mantissa) * 2f32.powi(-24),
        31 if mantissa == 0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + f32::from(mantissa) / 1024.0) * 2f32.powi(i32::from(exponent) - 15),
    };
    if sign == 1 { -size } else { size }
}

impl Picture {
    /// Writes the image if a folder is set: `ANTUMBRA_PICTURES=out cargo test`.
    pub fn save(&self, name: &str, exposure: f32) {
        let Ok(folder) = std::env::var("ANTUMBRA_PICTURES") else { return };
        let byte = |v: f32| (antumbra_scene::srgb_from_linear(v * exposure) * 255.0).round() as u8;
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|p| p.map(byte)).collect();
        std::fs::create_dir_all(&folder).expect("a folder for pictures");
        let path = format!("{folder}/{name}.png");
        image::save_buffer(path, &bytes, self.size_px.x, self.size_px.y, image::ColorType::Rgb8).expect("a picture");
    }

    /// Returns visibility: the ratio of shadowed to unshadowed light; `None` where the unshadowed image is too dark to judge.
    pub fn over(&self, unshadowed: &Self) -> Vec<Option<[f32; 3]>> {
        let most = unshadowed.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
        assert!(most > 0.0, "the picture without shadows is black");
        let ratio = |(with, without): (&[f32; 3], &[f32; 3])| {
            let is_lit = without.iter().all(|v| *v > 3e-4 * most);
            is_lit.then(|| [0, 1, 2].map(|i| with[i] / without[i]))
        };
        self.pixels.iter().zip(&unshadowed.pixels).map(ratio).collect()
    }
}

pub fn from(v: glam::Vec3) -> Vec3 {
    Vec3::from_array(v.to_array())
}

fn quat_looking(axis: glam::Vec3, up: glam::Vec3) -> Quat {
    Transform::IDENTITY.looking_to(from(axis), from(up)).rotation
}

/// Returns the transform of one of the library's lights in Bevy.
pub fn light_transform(light: &antumbra::light::Light) -> Transform {
    Transform::from_translation(from(light.center)).with_rotation(quat_looking(light.axis, light.up))
}

/// Spawns one of the library's lights in Bevy, with an arbitrary intensity.
pub fn spawn_light(app: &mut App, light: &antumbra::light::Light) -> Entity {
    use antumbra::light::LightShape;
    let transform = light_transform(light);
    let world = app.world_mut();
    let (intensity, range) = (4e6, 40.0);
    match (&light.shape, light.cone) {
        (LightShape::Rectangle { size_m }, _) => world
            .spawn((RectLight { width: size_m.x, height: size_m.y, intensity, range, ..default() }, transform))
            .id(),
        (LightShape::Disk { radius_m }, Some(cone)) => {
            let (inner_angle, outer_angle) = (cone.inner_rad, cone.outer_rad);
            let shadow_maps_enabled = true;
            let radius = *radius_m;
            let spot =
                SpotLight { intensity, range, radius, inner_angle, outer_angle, shadow_maps_enabled, ..default() };
            world.spawn((spot, transform)).id()
        }
        (LightShape::Sphere { radius_m }, _) => {
            let radius = *radius_m;
            let point = PointLight { intensity, range, radius, shadow_maps_enabled: true, ..default() };
            world.spawn((point, transform)).id()
        }
        (LightShape::Sun { angular_diameter_rad }, _) => {
            let sun = DirectionalLight { illuminance: 1e5, shadow_maps_enabled: true, ..default() };
            let disk = SunDisk { angular_size: *angular_diameter_rad, intensity: 1.0 };
            world.spawn((sun, disk, transform)).id()
        }
        other => panic!("Bevy has no light of {other:?}"),
    }
}

/// Turns a light's shadows on or off.
pub fn set_shadows(app: &mut App, light: Entity, are_on: bool) {
    let mut light = app.world_mut().entity_mut(light);
    if let Some(mut of) = light.get_mut::<PointLight>() {
        of.shadow_maps_enabled = are_on;
    } else if let Some(mut of) = light.get_mut::<SpotLight>() {
        of.shadow_maps_enabled = are_on;
    } else if let Some(mut of) = light.get_mut::<DirectionalLight>() {
        of.shadow_maps_enabled = are_on;
    } else if are_on {
        light.remove::<NoSoftShadows>();
    } else {
        light.insert(NoSoftShadows);
    }
}

/// Spawns a scene of the laboratory in Bevy. Returns the entity of each of its instances.
pub fn spawn_scene(app: &mut App, scene: &Scene) -> Vec<Entity> {
    let images: Vec<Handle<Image>> = scene.images.iter().map(|image| add_image(app, image)).collect();
    let materials: Vec<Handle<StandardMaterial>> = scene
        .materials
        .iter()
        .map(|material| {
            let color = material.base_color;
            app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial {
                base_color: Color::linear_rgba(color.x, color.y, color.z, color.w),
                base_color_texture: material.base_color_image.map(|i| images[i].clone()),
                alpha_mode: match material.alpha {
                    SceneAlphaMode::Opaque => AlphaMode::Opaque,
                    SceneAlphaMode::Mask { cutoff } => AlphaMode::Mask(cutoff),
                    SceneAlphaMode::Blend => AlphaMode::Blend,
                },
                specular_transmission: material.transmission,
                perceptual_roughness: 1.0,
                reflectance: 0.0,
                // Pixels are judged where the receiver faces the light, whichever side the camera sees.
                double_sided: true,
                cull_mode: None,
                ..default()
            })
        })
        .collect();
    let meshes: Vec<Handle<Mesh>> = scene.meshes.iter().map(|mesh| add_mesh(app, mesh)).collect();
    let spawn = |instance: &antumbra_scene::Instance| {
        let mesh = &scene.meshes[instance.mesh];
        let matrix = Mat4::from_cols_array(&instance.world_from_object.to_cols_array());
        app.world_mut()
            .spawn((
                Mesh3d(meshes[instance.mesh].clone()),
                MeshMaterial3d(materials[mesh.material].clone()),
                Transform::from_matrix(matrix),
            ))
            .id()
    };
    scene.instances.iter().map(spawn).collect()
}

fn add_mesh(app: &mut App, mesh: &antumbra_scene::Mesh) -> Handle<Mesh> {
    let floats = |v: &[glam::Vec3]| v.iter().map(|v| v.to_array()).collect::<Vec<_>>();
    let mut made = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, floats(&mesh.positions))
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, floats(&mesh.normals));
    if !mesh.uvs.is_empty() {
        let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|uv| uv.to_array()).collect();
        made.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    }
    made.insert_indices(if mesh.positions.len() <= usize::from(u16::MAX) {
        Indices::U16(mesh.indices.iter().map(|i| *i as u16).collect())
    } else {
        Indices::U32(mesh.indices.clone())
    });
    app.world_mut().resource_mut::<Assets<Mesh>>().add(made)
}

fn add_image(app: &mut App, image: &antumbra_scene::Image) -> Handle<Image> {
    let size = Extent3d { width: image.width, height: image.height, depth_or_array_layers: 1 };
    let bytes = image.rgba8.as_flattened().to_vec();
    let format = TextureFormat::Rgba8UnormSrgb;
    let mut made = Image::new(size, TextureDimension::D2, bytes, format, RenderAssetUsages::default());
    let mode = |wrap| match wrap {
        antumbra_scene::Wrap::Repeat => ImageAddressMode::Repeat,
        antumbra_scene::Wrap::Mirror => ImageAddressMode::MirrorRepeat,
        antumbra_scene::Wrap::Clamp => ImageAddressMode::ClampToEdge,
    };
    made.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: mode(image.wrap[0]),
        address_mode_v: mode(image.wrap[1]),
        ..ImageSamplerDescriptor::linear()
    });
    app.world_mut().resource_mut::<Assets<Image>>().add(made)
}
