//! What comes out: a visibility mask the size of the receivers.

use glam::UVec2;

/// The visibility mask: 1 lit, 0 umbra. Every pixel is written once per light; the host multiplies.
///
/// A texture array of `R32Float`, since that is the one format that every WebGPU adapter can write and accumulate in
/// compute: one layer, or three — red, green, blue — where casters tint.
#[derive(Clone, Debug)]
pub struct Mask {
    texture: wgpu::Texture,
    first_layer: u32,
    channels: MaskChannels,
    first_view: wgpu::TextureView,
    layers_view: wgpu::TextureView,
}

/// How many channels a mask has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskChannels {
    /// Visibility alone. Techniques that know colour write its luminance.
    One,
    /// Red, green and blue. Techniques that know no colour write the same to all.
    Three,
}

impl MaskChannels {
    /// 1 or 3.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Three => 3,
        }
    }
}

impl Mask {
    /// The mask's format.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

    /// A mask of `size_px` pixels and one channel.
    pub fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        Self::with_channels(device, size_px, MaskChannels::One)
    }

    /// A mask of `size_px` pixels. [`Casters::mask_channels`](super::Casters::mask_channels) says how many channels
    /// the casters have a use for.
    pub fn with_channels(device: &wgpu::Device, size_px: UVec2, channels: MaskChannels) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra mask"),
            size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: channels.count() },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self::of_layers(&texture, 0, channels)
    }

    /// A mask in the host's own texture array: its layers from `first_layer` on, as many as there are channels. The texture has
    /// the format [`FORMAT`](Self::FORMAT) and the usages `STORAGE_BINDING` and `TEXTURE_BINDING`.
    ///
    /// # Panics
    /// Where the texture has another format, lacks a usage, or has not so many layers.
    pub fn of_layers(texture: &wgpu::Texture, first_layer: u32, channels: MaskChannels) -> Self {
        let usages = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        assert_eq!(texture.format(), Self::FORMAT, "a mask's format");
        assert!(texture.usage().contains(usages), "a mask's usages {usages:?}, and not {:?}", texture.usage());
        let layers = texture.depth_or_array_layers();
        assert!(first_layer + channels.count() <= layers, "layers {first_layer} and on of {layers}");
        let view = |dimension, layers| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("antumbra mask"),
                dimension: Some(dimension),
                mip_level_count: Some(1),
                base_array_layer: first_layer,
                array_layer_count: Some(layers),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let first_view = view(wgpu::TextureViewDimension::D2, 1);
        let layers_view = view(wgpu::TextureViewDimension::D2Array, channels.count());
        Self { texture: texture.clone(), first_layer, channels, first_view, layers_view }
    }

    /// Size in pixels.
    pub fn size_px(&self) -> UVec2 {
        UVec2::new(self.texture.width(), self.texture.height())
    }

    /// How many channels it has.
    pub fn channels(&self) -> MaskChannels {
        self.channels
    }

    /// The texture, for copies: one layer a channel, from [`first_layer`](Self::first_layer) on.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// The layer of the first channel.
    pub fn first_layer(&self) -> u32 {
        self.first_layer
    }

    /// The first channel, for shaders: `texture_2d<f32>`, read by `textureLoad`.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.first_view
    }

    /// All channels, for shaders: `texture_2d_array<f32>`, read by `textureLoad`.
    pub fn layers_view(&self) -> &wgpu::TextureView {
        &self.layers_view
    }
}
