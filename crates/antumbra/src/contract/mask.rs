//! Visibility mask: the output, of the receivers' size.

use glam::UVec2;

use super::Error;

/// The visibility mask: 1 lit, 0 umbra. Every pixel is written once per light; the host multiplies.
///
/// It has a texture of its own, or [a part](MaskPlace) of a host's texture: layers of an array, a rectangle of an atlas, one
/// component of four. Techniques write and accumulate in `R32Float`, the only format that every WebGPU adapter can read and write
/// in compute. A mask of [another format](Mask::FORMATS) is converted from an `R32Float` mask, which belongs to the device and
/// serves all lights of the same size. The conversion is one more pass, with 4 bytes read and 1 to 8 written per pixel.
#[derive(Clone, Debug)]
pub struct Mask {
    texture: wgpu::Texture,
    place: MaskPlace,
    channels: MaskChannels,
    first_view: wgpu::TextureView,
    layers_view: wgpu::TextureView,
}

/// Location of a mask in a host's texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaskPlace {
    /// Layer of the first channel.
    pub layer: u32,
    /// Corner of the rectangle, pixels.
    pub origin_px: UVec2,
    /// Size of the rectangle, pixels: the receivers' size.
    pub size_px: UVec2,
    /// Component of a mask of one channel in a format of four components: 0 to 3, red to alpha. The other components keep their
    /// values, as does alpha under a mask of three channels.
    pub component: u32,
}

impl MaskPlace {
    /// Creates the location of a whole layer.
    pub fn layer(texture: &wgpu::Texture, layer: u32) -> Self {
        let size_px = UVec2::new(texture.width(), texture.height());
        Self { layer, origin_px: UVec2::ZERO, size_px, component: 0 }
    }
}

/// Number of channels of a mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskChannels {
    /// Visibility alone. Techniques that compute colour write its luminance.
    One,
    /// Red, green and blue. Techniques that compute no colour write the same value to all.
    Three,
}

impl MaskChannels {
    /// Number of channels: 1 or 3.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Three => 3,
        }
    }
}

impl Mask {
    /// Format that techniques write directly.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

    /// Formats that a mask can have: one component of 32, 16 or 8 bits, or four of 16 or 8 bits.
    pub const FORMATS: [wgpu::TextureFormat; 5] = [
        Self::FORMAT,
        wgpu::TextureFormat::R16Float,
        wgpu::TextureFormat::R8Unorm,
        wgpu::TextureFormat::Rgba16Float,
        wgpu::TextureFormat::Rgba8Unorm,
    ];

    /// Creates a mask of `size_px` pixels and one channel.
    pub fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        Self::with_channels(device, size_px, MaskChannels::One)
    }

    /// Creates a mask of `size_px` pixels. [`Casters::mask_channels`](crate::Casters::mask_channels) returns the number of channels
    /// that the casters need.
    pub fn with_channels(device: &wgpu::Device, size_px: UVec2, channels: MaskChannels) -> Self {
        Self::with_format(device, size_px, channels, Self::FORMAT)
    }

    /// Creates a mask of `size_px` pixels in one of the [`FORMATS`](Self::FORMATS).
    ///
    /// # Panics
    /// If the format is another one.
    pub fn with_format(
        device: &wgpu::Device,
        size_px: UVec2,
        channels: MaskChannels,
        format: wgpu::TextureFormat,
    ) -> Self {
        let texture = texture_of_layers(device, size_px, format, layers_of(format, channels));
        Self::of_own_layers(&texture, 0, channels)
    }

    /// Creates a mask in the host's own texture array, from layer `first_layer` on: one layer per channel, or one layer in formats
    /// of four components.
    ///
    /// # Errors
    /// As [`within`](Self::within).
    pub fn of_layers(texture: &wgpu::Texture, first_layer: u32, channels: MaskChannels) -> Result<Self, Error> {
        Self::within(texture, MaskPlace::layer(texture, first_layer), channels)
    }

    /// Creates a mask in part of a host's texture, which has one of the [`FORMATS`](Self::FORMATS) and its
    /// [`usages`](Self::usages).
    ///
    /// # Errors
    /// [`Error::BadFrame`] if the texture has another format, lacks a usage, or does not contain the place.
    pub fn within(texture: &wgpu::Texture, place: MaskPlace, channels: MaskChannels) -> Result<Self, Error> {
        let bad = |what, had: String, needed: String| Err(Error::BadFrame { technique: "mask", what, had, needed });
        let format = texture.format();
        if !Self::FORMATS.contains(&format) {
            return bad("the texture's format", format!("{format:?}"), format!("one of {:?}", Self::FORMATS));
        }
        let (had, needed) = (texture.usage(), Self::usages(format));
        if !had.contains(needed) {
            return bad("the texture's usage", format!("{had:?}"), format!("at least {needed:?}"));
        }
        let (layers, count) = (texture.depth_or_array_layers(), layers_of(format, channels));
        let layer_end = place.layer.saturating_add(count);
        if layer_end > layers {
            return bad(
                "the mask's last layer",
                (layer_end - 1).to_string(),
                format!("below the texture's number of layers, {layers}"),
            );
        }
        let end_px = place.origin_px.saturating_add(place.size_px);
        let size_px = UVec2::new(texture.width(), texture.height());
        if end_px.cmpgt(size_px).any() {
            return bad("the mask's far corner", end_px.to_string(), format!("within the texture's size, {size_px}"));
        }
        let components = u32::from(format.components());
        if place.component >= components {
            return bad(
                "the mask's component",
                place.component.to_string(),
                format!("below the number of components, {components}"),
            );
        }
        Ok(Self::at(texture, place, channels))
    }

    /// Mask in the layers of a texture that the library has made for it.
    pub(crate) fn of_own_layers(texture: &wgpu::Texture, first_layer: u32, channels: MaskChannels) -> Self {
        Self::at(texture, MaskPlace::layer(texture, first_layer), channels)
    }

    /// Mask at a place that the texture holds.
    fn at(texture: &wgpu::Texture, place: MaskPlace, channels: MaskChannels) -> Self {
        let count = layers_of(texture.format(), channels);
        let view = |dimension, layers| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("antumbra mask"),
                dimension: Some(dimension),
                mip_level_count: Some(1),
                base_array_layer: place.layer,
                array_layer_count: Some(layers),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let first_view = view(wgpu::TextureViewDimension::D2, 1);
        let layers_view = view(wgpu::TextureViewDimension::D2Array, count);
        Self { texture: texture.clone(), place, channels, first_view, layers_view }
    }

    /// Creates masks of `count` lights in one texture array, so that a host's shader binds one texture. In formats of four
    /// components, masks of one channel share layers: light `i` has component `i % 4` of layer `i / 4`. All other masks have
    /// consecutive layers of their own.
    ///
    /// # Panics
    /// If the format is not one of the [`FORMATS`](Self::FORMATS), or the count is zero.
    pub fn packed(
        device: &wgpu::Device,
        size_px: UVec2,
        channels: MaskChannels,
        format: wgpu::TextureFormat,
        count: usize,
    ) -> Vec<Self> {
        assert!(count > 0, "masks of no light");
        let in_layer = if channels == MaskChannels::One { u32::from(format.components()) } else { 1 };
        let (count, layers_each) = (count as u32, layers_of(format, channels));
        let texture = texture_of_layers(device, size_px, format, count.div_ceil(in_layer) * layers_each);
        let of_light = |i: u32| {
            let place = MaskPlace::layer(&texture, i / in_layer * layers_each);
            Self::at(&texture, MaskPlace { component: i % in_layer, ..place }, channels)
        };
        (0..count).map(of_light).collect()
    }

    /// Whether two masks share a component of a texel.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let layers = |mask: &Self| {
            let first = mask.place.layer;
            first..first + layers_of(mask.texture.format(), mask.channels)
        };
        let components = |mask: &Self| match mask.channels {
            MaskChannels::Three if mask.texture.format().components() > 1 => 0..3,
            MaskChannels::One | MaskChannels::Three => mask.place.component..mask.place.component + 1,
        };
        let meet = |a: std::ops::Range<u32>, b: std::ops::Range<u32>| a.start < b.end && b.start < a.end;
        let is_before = |a: &MaskPlace, b: &MaskPlace| a.origin_px.cmplt(b.origin_px + b.size_px).all();
        self.texture == other.texture
            && meet(layers(self), layers(other))
            && meet(components(self), components(other))
            && is_before(&self.place, &other.place)
            && is_before(&other.place, &self.place)
    }

    /// Usages that a mask's texture needs: reading, and writing in compute or as a render target.
    pub fn usages(format: wgpu::TextureFormat) -> wgpu::TextureUsages {
        let written = if format == Self::FORMAT {
            wgpu::TextureUsages::STORAGE_BINDING
        } else {
            wgpu::TextureUsages::RENDER_ATTACHMENT
        };
        wgpu::TextureUsages::TEXTURE_BINDING | written
    }

    /// Size, pixels.
    pub fn size_px(&self) -> UVec2 {
        self.place.size_px
    }

    /// Number of channels.
    pub fn channels(&self) -> MaskChannels {
        self.channels
    }

    /// Texture, for copies.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// Location in the texture.
    pub fn place(&self) -> MaskPlace {
        self.place
    }

    /// View of the first channel's layer, for shaders: `texture_2d<f32>`, read by `textureLoad` from the [place](Self::place) on.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.first_view
    }

    /// View of all layers, for shaders: `texture_2d_array<f32>`, read by `textureLoad`.
    pub fn layers_view(&self) -> &wgpu::TextureView {
        &self.layers_view
    }
}

/// Number of layers that a mask occupies.
fn layers_of(format: wgpu::TextureFormat, channels: MaskChannels) -> u32 {
    if format.components() == 1 { channels.count() } else { 1 }
}

/// Creates a texture for masks, with `COPY_SRC`.
fn texture_of_layers(
    device: &wgpu::Device,
    size_px: UVec2,
    format: wgpu::TextureFormat,
    depth_or_array_layers: u32,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("antumbra mask"),
        size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: Mask::usages(format) | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}
