//! The module of docs/start.md, as a reader pastes it.

use antumbra::light::{Aabb, Light, LightShape};
use antumbra::{
    AnyShadow, Camera, Casters, DepthConvention, Error, Frame, Gpu, Mask, MeshCaster, Receivers, Recorder,
    TechniqueKind,
};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// A light and what its shadows need. Create it once.
pub struct SoftLight {
    pub light: Light,
    shadow: AnyShadow,
    /// Bind `mask.view()` in your shading pass.
    pub mask: Mask,
}

/// A mesh in your buffers, with usage `VERTEX` or `INDEX`. A few techniques also need `STORAGE`.
pub struct Model {
    pub positions: wgpu::Buffer, // [f32; 3] for each vertex
    pub indices: wgpu::Buffer,   // u32, three for each triangle
    pub index_count: u32,
    pub instances: wgpu::Buffer, // one world-from-object Mat4
    pub bounds: Aabb,            // world-space box
}

/// Your camera and the depth buffer that you have drawn with it.
pub struct View {
    pub size_px: UVec2,
    pub depth: wgpu::TextureView,
    pub view_from_world: Mat4,
    pub clip_from_view: Mat4,
}

impl SoftLight {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size_px: UVec2) -> Result<Self, Error> {
        let gpu = Gpu::new(device, queue);
        let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) };
        Ok(Self {
            light: Light::new(shape, Vec3::new(1.5, 4.5, 2.5), Vec3::ZERO), // position and target, metres
            shadow: TechniqueKind::Smrt.create(&gpu)?,
            mask: Mask::new(device, size_px),
        })
    }

    /// Records the shadow passes. Call it after your depth pass and before shading.
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, model: &Model, view: &View) -> Result<(), Error> {
        let mesh = MeshCaster::new(&model.positions, &model.indices, model.index_count, &model.instances)
            .with_bounds(model.bounds)
            .with_closed(true); // watertight
        let casters = [mesh];
        let camera = Camera {
            view_from_world: view.view_from_world,
            clip_from_view: view.clip_from_view,
            depth_convention: DepthConvention::Reversed,
        };
        let receivers = Receivers::new(&view.depth, view.size_px, camera);
        let frame = Frame { light: &self.light, casters: Casters::Meshes(&casters), receivers, mask: &self.mask };
        self.shadow.prepare(&frame)?.record(&mut Recorder::new(encoder, None));
        Ok(())
    }
}
