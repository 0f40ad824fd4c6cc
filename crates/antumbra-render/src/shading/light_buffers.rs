//! Lights as the shaders read them.

use antumbra_light::{Light, LightShape};
use glam::{Vec3, Vec4};
use wgpu::util::DeviceExt;

/// Kinds of light, as in the shader.
pub(super) const RECTANGLE: u32 = 0;
const DISK: u32 = 1;
pub(super) const SPHERE: u32 = 2;
pub(super) const ELLIPSOID: u32 = 3;
pub(super) const SUN: u32 = 4;
pub(super) const POINTS: u32 = 5;

/// Half width of a light without size, metres: too small to be visible in an image.
pub(super) const MIN_HALF_WIDTH_M: f32 = 1e-3;
/// Tangent of half the angle of a sun without size.
const MIN_TANGENT: f32 = 1e-4;

/// Uniform and list of points of a light.
#[derive(Debug)]
pub struct LightBuffers {
    uniform: LightUniform,
    /// Storage buffer `light_points` of the shader.
    pub points: wgpu::Buffer,
    /// See [`Shading::bend_normals`].
    pub(super) bent: Option<wgpu::TextureView>,
}

/// Uniform `Light` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct LightUniform {
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
    /// Cosines of a spot light's inner and outer angle; −2 and −3 without a cone.
    cone_cosines: [f32; 2],
    padding: u32,
}

impl LightBuffers {
    /// Creates the buffers of a light of some radiance (radiant intensity for points).
    pub fn new(device: &wgpu::Device, light: &Light, radiance: Vec3) -> Self {
        let points: Vec<Vec4> = match &light.shape {
            LightShape::Points { positions_m } => positions_m.iter().map(|p| p.extend(0.0)).collect(),
            _ => vec![Vec4::ZERO],
        };
        Self {
            uniform: light_uniform(light, radiance),
            points: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("shading: light points"),
                contents: bytemuck::cast_slice(&points),
                usage: wgpu::BufferUsages::STORAGE,
            }),
            bent: None,
        }
    }

    /// Uniform `Light` of the shader under visibility of one channel, or of three.
    pub(super) fn tinted(&self, is_tinted: bool) -> LightUniform {
        LightUniform { is_tinted: is_tinted.into(), ..self.uniform }
    }

    /// Contents of the uniform `Light` of the shader.
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

pub(super) fn kind_and_half_size(shape: &LightShape) -> (u32, Vec3) {
    let at_least = |v: Vec3| v.max(Vec3::splat(MIN_HALF_WIDTH_M));
    match shape {
        LightShape::Rectangle { size_m } => (RECTANGLE, at_least(0.5 * size_m.extend(0.0))),
        LightShape::Disk { radius_m } => (DISK, at_least(Vec3::splat(*radius_m))),
        LightShape::Sphere { radius_m } => (SPHERE, at_least(Vec3::splat(*radius_m))),
        LightShape::Ellipsoid { radii_m } => (ELLIPSOID, at_least(*radii_m)),
        LightShape::Sun { angular_diameter_rad } => {
            (SUN, Vec3::splat((0.5 * angular_diameter_rad).tan().max(MIN_TANGENT)))
        }
        LightShape::Points { .. } => (POINTS, Vec3::ZERO),
    }
}
