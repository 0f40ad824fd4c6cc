//! Textures of surfaces: a scene's images, products of several images, and a ramp of alphas for vertex colours.

use std::collections::HashMap;

use antumbra::Gpu;
use antumbra_scene::{Image, Scene, Wrap};
use glam::Vec2;

use super::mips::mip_chain;

/// Texture and its address modes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextureSlot {
    /// Index into [`GpuScene::textures`](super::GpuScene::textures).
    pub view: usize,
    pub wrap: [Wrap; 2],
}

/// White texture, which changes nothing.
pub(super) const WHITE: TextureSlot = TextureSlot { view: 0, wrap: [Wrap::Clamp; 2] };

/// Width of the alpha ramp: one texel for each 8-bit alpha.
const RAMP_TEXELS: u32 = 256;

/// Texture coordinates of `alpha` in the alpha ramp: texel 255 · alpha, at its centre.
pub(super) fn alpha_ramp_uv(alpha: f32) -> Vec2 {
    Vec2::new((255.0 * alpha + 0.5) / RAMP_TEXELS as f32, 0.5)
}

/// Textures of an upload, each created once.
pub(super) struct SurfaceTextures<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    /// Views, indexed by [`TextureSlot::view`].
    pub views: Vec<wgpu::TextureView>,
    images: HashMap<usize, TextureSlot>,
    /// Products of materials' images, by material and whether the mesh is closed.
    made: HashMap<(usize, bool), TextureSlot>,
    alpha_ramp: Option<TextureSlot>,
    /// Bytes of all textures with all levels.
    pub memory_bytes: u64,
}

impl<'a> SurfaceTextures<'a> {
    /// Creates only [`WHITE`].
    pub fn new(gpu: &'a Gpu, scene: &'a Scene) -> Self {
        let mut textures = Self {
            gpu,
            scene,
            views: Vec::new(),
            images: HashMap::new(),
            made: HashMap::new(),
            alpha_ramp: None,
            memory_bytes: 0,
        };
        let white = Image { width: 1, height: 1, rgba8: vec![[u8::MAX; 4]], wrap: WHITE.wrap };
        textures.add("white", &white);
        textures
    }

    /// Returns the texture of a scene's image.
    pub fn image(&mut self, image: usize) -> TextureSlot {
        if let Some(slot) = self.images.get(&image) {
            return *slot;
        }
        let slot = self.add(&format!("image {image}"), &self.scene.images[image]);
        self.images.insert(image, slot);
        slot
    }

    /// Returns the texture of the product of a material's images, for closed or for open meshes.
    pub fn made(&mut self, material: usize, is_closed: bool) -> TextureSlot {
        if let Some(slot) = self.made.get(&(material, is_closed)) {
            return *slot;
        }
        let picture = self.scene.transmitted_picture(material, is_closed);
        let slot = self.add(&format!("transmitted by material {material}"), &picture);
        self.made.insert((material, is_closed), slot);
        slot
    }

    /// Returns the alpha ramp: white with every alpha; see [`alpha_ramp_uv`].
    pub fn alpha_ramp(&mut self) -> TextureSlot {
        if let Some(slot) = self.alpha_ramp {
            return slot;
        }
        let rgba8 = (0..=u8::MAX).map(|alpha| [u8::MAX, u8::MAX, u8::MAX, alpha]).collect();
        let ramp = Image { width: RAMP_TEXELS, height: 1, rgba8, wrap: [Wrap::Clamp; 2] };
        let slot = self.add("alpha ramp", &ramp);
        self.alpha_ramp = Some(slot);
        slot
    }

    fn add(&mut self, label: &str, image: &Image) -> TextureSlot {
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
        self.views.push(texture.create_view(&wgpu::TextureViewDescriptor::default()));
        TextureSlot { view: self.views.len() - 1, wrap: image.wrap }
    }
}
