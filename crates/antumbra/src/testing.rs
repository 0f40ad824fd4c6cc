//! Helpers of the library's tests: one device, small meshes, a camera, test scenes with closed forms.

use std::f32::consts::FRAC_PI_4;
use std::sync::OnceLock;
use std::time::Instant;

use antumbra_light::{Aabb, Light, LightShape};
use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_at_mat4};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3};

use crate::TechniqueKind;
use crate::contract::{DepthConvention, Error, Mask, MeshCaster, Opacity, PreparedCasters, PreparedFrame, Receivers};
use crate::gpu::{Gpu, PassTimer, Recorder, Span, Stage};
use crate::light_map::caster_depth::CasterDepth;
use crate::shadow::AnyShadow;
use crate::shadow::{Casters, Frame};

/// Returns the device of the whole test binary; `None` if there is no adapter and none is required. An adapter without a device is
/// a failure.
pub(crate) fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| gpu_with(|_| wgpu::Limits::default()));
    if gpu.is_none() {
        antumbra_testing::skip_without_adapter();
    }
    gpu.as_ref()
}

/// Creates a device whose storage bindings hold at most `bytes` bytes.
pub(crate) fn gpu_with_bindings_of(bytes: u64) -> Option<Gpu> {
    gpu_with(|_| wgpu::Limits { max_storage_buffer_binding_size: bytes, ..wgpu::Limits::default() })
}

/// Creates a device with the required limits; `None` if there is no adapter.
pub(crate) fn gpu_with(required_limits: impl FnOnce(&wgpu::Adapter) -> wgpu::Limits) -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions::default();
    let adapter = match pollster::block_on(instance.request_adapter(&options)) {
        Ok(adapter) => adapter,
        Err(wgpu::RequestAdapterError::NotFound { .. }) => return None,
        Err(error) => panic!("the graphics driver fails: {error}"),
    };
    let descriptor = wgpu::DeviceDescriptor {
        required_features: adapter.features() & Gpu::WANTED_FEATURES,
        required_limits: required_limits(&adapter),
        ..wgpu::DeviceDescriptor::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
        .unwrap_or_else(|error| panic!("{} gives no device: {error}", adapter.get_info().name));
    Some(Gpu::new(&device, &queue))
}

/// Whether the device is a software renderer, whose arithmetic is that of the CPU references to the last bit.
pub(crate) fn is_software(gpu: &Gpu) -> bool {
    gpu.device().adapter_info().device_type == wgpu::DeviceType::Cpu
}

/// Converts a 16-bit float to a 32-bit one.
pub(crate) fn f32_of_half(half: u16) -> f32 {
    let (exponent, fraction) = (i32::from(half >> 10 & 31), f32::from(half & 1023) / 1024.0);
    let size = if exponent == 0 { fraction * 2.0f32.powi(-14) } else { (1.0 + fraction) * 2.0f32.powi(exponent - 15) };
    if half >> 15 == 1 { -size } else { size }
}

pub(crate) const SIZE: UVec2 = UVec2::new(96, 96);

pub(crate) mod snapping;

/// A mesh on the GPU.
pub(crate) struct Mesh {
    pub(crate) positions: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) instances: wgpu::Buffer,
    pub(crate) index_count: u32,
    pub(crate) bounds: Aabb,
}

impl Mesh {
    pub(crate) fn new(gpu: &Gpu, positions: &[Vec3], indices: &[u32]) -> Self {
        let buffer = |bytes: &[u8], usage| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("test mesh"),
                size: bytes.len() as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        Self {
            positions: buffer(
                bytemuck::cast_slice(positions),
                wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE,
            ),
            indices: buffer(bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX | wgpu::BufferUsages::STORAGE),
            instances: buffer(
                bytemuck::bytes_of(&Mat4::IDENTITY),
                wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE,
            ),
            index_count: indices.len() as u32,
            bounds: Aabb::of(positions.iter().copied()),
        }
    }

    /// Creates a rectangle in a horizontal plane.
    pub(crate) fn horizontal(gpu: &Gpu, min: Vec2, max: Vec2, height: f32) -> Self {
        let corners =
            [Vec2::new(min.x, min.y), Vec2::new(min.x, max.y), Vec2::new(max.x, max.y), Vec2::new(max.x, min.y)];
        Self::new(gpu, &corners.map(|c| Vec3::new(c.x, height, c.y)), &[0, 1, 2, 0, 2, 3])
    }

    pub(crate) fn caster(&self) -> MeshCaster<'_> {
        MeshCaster {
            positions: &self.positions,
            indices: &self.indices,
            first_triangle: 0,
            index_count: self.index_count,
            instances: &self.instances,
            first_instance: 0,
            instance_count: 1,
            closed: false,
            opacity: Opacity::Opaque,
            bounds: self.bounds,
            version: None,
        }
    }
}

/// Creates the buffer of one instance, translated by `away`.
pub(crate) fn instances_at(gpu: &Gpu, away: Vec3) -> wgpu::Buffer {
    let instances = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test instances"),
        size: size_of::<Mat4>() as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&instances, 0, bytemuck::bytes_of(&Mat4::from_translation(away)));
    instances
}

/// Camera of a test.
pub(crate) struct View {
    pub(crate) view_from_world: Mat4,
    pub(crate) clip_from_view: Mat4,
}

impl View {
    pub(crate) fn new(eye: Vec3, target: Vec3) -> Self {
        Self {
            view_from_world: look_at_mat4(eye, target, Vec3::Y),
            clip_from_view: perspective_infinite_reverse(FRAC_PI_4, 1.0, 0.1),
        }
    }

    /// World position on the plane y = 0 behind a pixel's centre.
    pub(crate) fn ground_at(&self, pixel: UVec2) -> Vec3 {
        let ndc = (pixel.as_vec2() + 0.5) / SIZE.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
        let world_from_clip = (self.clip_from_view * self.view_from_world).inverse();
        let near = world_from_clip.project_point3(ndc.extend(1.0));
        let far = world_from_clip.project_point3(ndc.extend(0.01));
        near + (far - near) * (near.y / (near.y - far.y))
    }
}

/// Creates a texture of 32-bit floats that holds `texels`, row by row.
pub(crate) fn float_texture(gpu: &Gpu, size: UVec2, texels: &[f32]) -> wgpu::Texture {
    texture_of(gpu, size, wgpu::TextureFormat::R32Float, texels)
}

/// Creates a texture that holds `texels`, each of them one texel of the format, row by row.
pub(crate) fn texture_of<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    size: UVec2,
    format: wgpu::TextureFormat,
    texels: &[T],
) -> wgpu::Texture {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test texels"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let bytes_per_row = Some(size_of::<T>() as u32 * size.x);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(texels), layout, texture.size());
    texture
}

/// Renders `meshes` from `clip_from_world` into a depth texture with the library's own caster pass.
pub(crate) fn draw_depth(gpu: &Gpu, size: UVec2, clip_from_world: Mat4, meshes: &[MeshCaster<'_>]) -> wgpu::Texture {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test depth"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: CasterDepth::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let mut casters = CasterDepth::new(gpu);
    casters.prepare(&Stage::at_once(gpu), &[clip_from_world], meshes);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut recorder = Recorder::new(&mut encoder, None);
    recorder.depth_pass("test depth", Span::Only, &view_of(&texture), CasterDepth::CLEAR_DEPTH, |pass| {
        casters.draw(pass, 0, meshes);
    });
    gpu.queue.submit([encoder.finish()]);
    texture
}

pub(crate) fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Maps a buffer and copies it out.
pub(crate) fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: u64) -> Vec<u8> {
    buffer.map_async(wgpu::MapMode::Read, 0..bytes, |result| result.expect("mapping for reading"));
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
    let copy = buffer.get_mapped_range(0..bytes).expect("mapped above").to_vec();
    buffer.unmap();
    copy
}

/// Reads the values of a buffer with usage `COPY_SRC`, after all that was submitted.
pub(crate) fn read_storage<T: bytemuck::Pod>(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<T> {
    let readback = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test readback"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &readback, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&read_buffer(gpu, &readback, buffer.size()))
}

/// Reads one mip level of a texture, its rows packed tightly.
pub(crate) fn read_texture(gpu: &Gpu, texture: &wgpu::Texture, level: u32, size: UVec2) -> Vec<u8> {
    read_slice(gpu, wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() }, size)
}

/// Reads one layer of an array texture, its rows packed tightly.
pub(crate) fn read_layer(gpu: &Gpu, texture: &wgpu::Texture, layer: u32) -> Vec<u8> {
    let origin = wgpu::Origin3d { z: layer, ..wgpu::Origin3d::ZERO };
    let size = UVec2::new(texture.width(), texture.height());
    read_slice(gpu, wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() }, size)
}

pub(crate) fn read_slice(gpu: &Gpu, source: wgpu::TexelCopyTextureInfo<'_>, size: UVec2) -> Vec<u8> {
    let texture = source.texture;
    let texel_bytes = texture.format().block_copy_size(None).expect("a colour format");
    let row_bytes = (size.x * texel_bytes).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let readback = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test readback"),
        size: u64::from(row_bytes * size.y),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        source,
        wgpu::TexelCopyBufferInfo {
            buffer: &readback,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None },
        },
        wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = read_buffer(gpu, &readback, u64::from(row_bytes * size.y));
    let row = (size.x * texel_bytes) as usize;
    bytes.chunks_exact(row_bytes as usize).flat_map(|padded| &padded[..row]).copied().collect()
}

/// Runs a technique and reads the mask, row by row.
pub(crate) fn run(gpu: &Gpu, technique: &mut AnyShadow, frame: &Frame<'_>) -> Result<Vec<f32>, Error> {
    let work = technique.prepare(frame)?;
    let mut timer = PassTimer::new(gpu);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    work.record(&mut Recorder::new(&mut encoder, timer.as_mut()));
    if let Some(timer) = &timer {
        timer.resolve(&mut encoder);
    }
    let submitted = Instant::now();
    gpu.queue.submit([encoder.finish()]);
    if let Some(timer) = &timer {
        let times = timer.read(&read_buffer(gpu, timer.readback(), timer.readback_bytes()));
        // No pass takes longer than the wait for all, even if the driver compiles meanwhile.
        let waited_ms = 1e3 * submitted.elapsed().as_secs_f64();
        let is_within = |ms: f64| ms >= 0.0 && ms <= waited_ms + 1.0;
        assert!(!times.is_empty() && times.iter().all(|time| is_within(time.ms)), "{times:?} in {waited_ms} ms");
    }
    let bytes = read_texture(gpu, frame.mask.texture(), 0, frame.mask.size_px());
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}

/// Creates a depth buffer without geometry.
pub(crate) fn empty_depth(gpu: &Gpu, size: UVec2) -> wgpu::TextureView {
    view_of(&draw_depth(gpu, size, Mat4::IDENTITY, &[]))
}

/// Receivers of a depth buffer, seen from the tests' camera.
pub(crate) fn test_receivers(size_px: UVec2, depth: &wgpu::TextureView) -> Receivers<'_> {
    let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    Receivers {
        size_px,
        origin_px: UVec2::ZERO,
        depth,
        depth_convention: DepthConvention::Reversed,
        view_from_world: view.view_from_world,
        clip_from_view: view.clip_from_view,
        normals: None,
        bounds: None,
        hull: &[],
        seen: &[],
        shadow_distance: None,
        version: None,
    }
}

/// Test scene: meshes under a light, seen by a camera.
pub(crate) struct Case {
    pub(crate) light: Light,
    pub(crate) view: View,
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) depth: wgpu::TextureView,
    pub(crate) mask: Mask,
}

impl Case {
    pub(crate) fn new(gpu: &Gpu, light: Light, view: View, meshes: Vec<Mesh>) -> Self {
        let casters: Vec<_> = meshes.iter().map(Mesh::caster).collect();
        let depth = view_of(&draw_depth(gpu, SIZE, view.clip_from_view * view.view_from_world, &casters));
        Self { light, view, meshes, depth, mask: Mask::new(gpu.device(), SIZE) }
    }

    /// Creates a 12 m ground and a half-plane (x < 0) at height 1.5 under a light at height 4.
    pub(crate) fn half_plane(gpu: &Gpu, shape: LightShape) -> Self {
        let light = Light::new(shape, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
        // The occluder lies outside of the camera's view of the ground x > −1.
        let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
        let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
        let occluder = Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 1.5);
        Self::new(gpu, light, view, vec![ground, occluder])
    }

    pub(crate) fn run(&self, gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)]) -> Vec<f32> {
        let casters: Vec<_> = self.meshes.iter().map(Mesh::caster).collect();
        self.run_with(gpu, kind, settings, Casters::Meshes(&casters)).expect("a good frame")
    }

    pub(crate) fn run_with(
        &self,
        gpu: &Gpu,
        kind: TechniqueKind,
        settings: &[(&str, &str)],
        casters: Casters<'_>,
    ) -> Result<Vec<f32>, Error> {
        let mut technique = kind.create(gpu)?;
        for (key, value) in settings {
            technique.set(key, value)?;
        }
        self.with_frame(casters, |frame| run(gpu, &mut technique, frame))
    }

    /// Calls `run` with the scene as a frame.
    pub(crate) fn with_frame<T>(&self, casters: Casters<'_>, run: impl FnOnce(&Frame<'_>) -> T) -> T {
        let receivers = Receivers {
            size_px: SIZE,
            origin_px: UVec2::ZERO,
            depth: &self.depth,
            depth_convention: DepthConvention::Reversed,
            view_from_world: self.view.view_from_world,
            clip_from_view: self.view.clip_from_view,
            normals: None,
            bounds: None,
            hull: &[],
            seen: &[],
            shadow_distance: None,
            version: None,
        };
        run(&Frame { light: &self.light, casters, receivers, mask: &self.mask })
    }

    /// Calls `run` with the scene as a frame that techniques receive.
    pub(crate) fn with_prepared<T>(&self, meshes: &[MeshCaster<'_>], run: impl FnOnce(&PreparedFrame<'_>) -> T) -> T {
        self.with_frame(Casters::Meshes(meshes), |&Frame { light, receivers, mask, .. }| {
            run(&PreparedFrame {
                light,
                casters: PreparedCasters::Draws(meshes),
                receivers: receivers.into(),
                mask,
                noisy: None,
            })
        })
    }

    /// Pixels that see the `visible` ground: index, and the point seen.
    pub(crate) fn ground_pixels(&self, visible: impl Fn(Vec3) -> bool) -> Vec<(usize, Vec3)> {
        (0..SIZE.y)
            .flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)))
            .map(|pixel| ((pixel.y * SIZE.x + pixel.x) as usize, self.view.ground_at(pixel)))
            .filter(|(_, p)| visible(*p))
            .collect()
    }
}

/// Root mean square of the differences at some pixels.
pub(crate) fn rmse(pixels: &[(usize, Vec3)], visibility: &[f32], truth: impl Fn(Vec3) -> f32) -> f32 {
    assert!(pixels.len() > 500, "only {} pixels", pixels.len());
    let sum: f32 = pixels.iter().map(|(i, p)| (visibility[*i] - truth(*p)).powi(2)).sum();
    (sum / pixels.len() as f32).sqrt()
}

/// Visibility under a rectangle light of width `w` at height 4 behind the half-plane's edge at height 1.5: the segment to the
/// light point `o` crosses height 1.5 at x + (o − x) · 1.5/4, and is blocked where that is below 0.
pub(crate) fn half_plane_visibility(x: f32, w: f32) -> f32 {
    let first_visible = -x * (1.0 - 0.375) / 0.375;
    if w == 0.0 {
        return if first_visible < 0.0 { 1.0 } else { 0.0 };
    }
    ((0.5 * w - first_visible) / w).clamp(0.0, 1.0)
}

/// Irradiance of a point of the ground from a rectangle of unit radiance that faces straight down, by Lambert's formula over its
/// edges: Σ θᵢ Γᵢ · n / 2π.
pub(crate) fn lambert_irradiance(p: DVec3, height: f64, [x0, x1]: [f64; 2], [z0, z1]: [f64; 2]) -> f64 {
    if x0 >= x1 {
        return 0.0;
    }
    let corners = [(x0, z0), (x1, z0), (x1, z1), (x0, z1)].map(|(x, z)| (DVec3::new(x, height, z) - p).normalize());
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        a.dot(b).acos() * a.cross(b).normalize().y
    };
    ((0..4).map(edge).sum::<f64>() / std::f64::consts::TAU).abs()
}

/// Root-mean-square errors of a technique's masks, weighted by irradiance and by emission, against the fraction of a wide light's
/// irradiance that the half-plane leaves. The light is as wide as it is high above the ground.
pub(crate) fn half_plane_ratio_errors(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)]) -> [f64; 2] {
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::splat(4.0) });
    let pixels = case.ground_pixels(|p| p.x.abs() < 2.0 && p.z.abs() < 1.2);
    assert!(pixels.len() > 500);
    ["irradiance", "emission"].map(|weights| {
        let mask = case.run(gpu, kind, &[settings, &[("weights", weights)]].concat());
        let square = |(i, p): &(usize, Vec3)| {
            let first_seen = f64::from(-p.x) * (1.0 - 0.375) / 0.375;
            let of = |from: f64| lambert_irradiance(p.as_dvec3(), 4.0, [from.max(-2.0), 2.0], [-2.0, 2.0]);
            (f64::from(mask[*i]) - of(first_seen) / of(-2.0)).powi(2)
        };
        (pixels.iter().map(square).sum::<f64>() / pixels.len() as f64).sqrt()
    })
}

pub(crate) const RECTANGLE: LightShape = LightShape::Rectangle { size_m: Vec2::new(1.0, 1.0) };

/// Whether a ground point is in front of the occluder, far from its sides and from the ground's own edge.
pub(crate) fn test_ground(p: Vec3) -> bool {
    p.x.abs() < 2.0 && p.z.abs() < 1.5
}
