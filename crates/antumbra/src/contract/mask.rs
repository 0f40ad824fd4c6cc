//! Visibility mask, the output, of the receivers' size.

use glam::UVec2;

use super::Error;

/// The visibility mask: 1 lit, 0 umbra. Every pixel is written once per light; the host multiplies.
///
/// It lies in a texture of its own, or in [a part](MaskPlace) of a host's: in layers of an array, in a rectangle of an atlas, in
/// one component of four. Techniques write and accumulate in `R32Float`, the one format that every WebGPU adapter can read and
/// write in compute. A mask of [another format](Mask::FORMATS) is drawn from one of that format, which belongs to the device and
/// serves all lights of like size: a pass more, of 4 bytes read and 1 to 8 written a pixel.
#[derive(Clone, Debug)]
pub struct Mask {
    texture: wgpu::Texture,
    place: MaskPlace,
    channels: MaskChannels,
    first_view: wgpu::TextureView,
    layers_view: wgpu::TextureView,
}

/// Where in a host's texture a mask lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaskPlace {
    /// The layer of the first channel.
    pub layer: u32,
    /// The corner of its rectangle.
    pub origin_px: UVec2,
    /// The rectangle's size: the receivers'.
    pub size_px: UVec2,
    /// In formats of four components, which of them a mask of one channel goes to: 0 to 3, red to alpha. The others stay as
    /// they are, and so does alpha under a mask of three channels.
    pub component: u32,
}

impl MaskPlace {
    /// All of a layer.
    pub fn layer(texture: &wgpu::Texture, layer: u32) -> Self {
        let size_px = UVec2::new(texture.width(), texture.height());
        Self { layer, origin_px: UVec2::ZERO, size_px, component: 0 }
    }
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
    /// The format that techniques write themselves.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

    /// The formats that a mask may have: 32 bits, 16, 8, alone or as components of four.
    pub const FORMATS: [wgpu::TextureFormat; 5] = [
        Self::FORMAT,
        wgpu::TextureFormat::R16Float,
        wgpu::TextureFormat::R8Unorm,
        wgpu::TextureFormat::Rgba16Float,
        wgpu::TextureFormat::Rgba8Unorm,
    ];

    /// A mask of `size_px` pixels and one channel.
    pub fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        Self::with_channels(device, size_px, MaskChannels::One)
    }

    /// A mask of `size_px` pixels. [`Casters::mask_channels`](super::Casters::mask_channels) says how many channels
    /// the casters have a use for.
    pub fn with_channels(device: &wgpu::Device, size_px: UVec2, channels: MaskChannels) -> Self {
        Self::with_format(device, size_px, channels, Self::FORMAT)
    }

    /// A mask of `size_px` pixels in one of the [`FORMATS`](Self::FORMATS).
    ///
    /// # Panics
    /// Where the format is another one.
    pub fn with_format(
        device: &wgpu::Device,
        size_px: UVec2,
        channels: MaskChannels,
        format: wgpu::TextureFormat,
    ) -> Self {
        let texture = texture_of_layers(device, size_px, format, layers_of(format, channels));
        Self::of_own_layers(&texture, 0, channels)
    }

    /// A mask in the host's own texture array: its layers from `first_layer` on, as many as there are channels; in formats of
    /// four components one.
    ///
    /// # Errors
    /// As [`within`](Self::within).
    pub fn of_layers(texture: &wgpu::Texture, first_layer: u32, channels: MaskChannels) -> Result<Self, Error> {
        Self::within(texture, MaskPlace::layer(texture, first_layer), channels)
    }

    /// A mask in part of a host's texture, which has one of the [`FORMATS`](Self::FORMATS) and its [`usages`](Self::usages).
    ///
    /// # Errors
    /// [`Error::BadFrame`] if the texture has another format, lacks a usage, or does not hold the place.
    pub fn within(texture: &wgpu::Texture, place: MaskPlace, channels: MaskChannels) -> Result<Self, Error> {
        let bad = |what, had: String, needed: String| Err(Error::BadFrame { technique: "mask", what, had, needed });
        let format = texture.format();
        if !Self::FORMATS.contains(&format) {
            return bad("the texture's format", format!("{format:?}"), format!("one of {:?}", Self::FORMATS));
        }
        let (had, needed) = (texture.usage(), Self::usages(format));
        if !had.contains(needed) {
            return bad("the texture's usage", format!("{had:?}"), format!("{needed:?} at least"));
        }
        let (layers, count) = (texture.depth_or_array_layers(), layers_of(format, channels));
        let layer_end = place.layer.saturating_add(count);
        if layer_end > layers {
            return bad(
                "the mask's last layer",
                (layer_end - 1).to_string(),
                format!("below {layers}, as the texture's"),
            );
        }
        let end_px = place.origin_px.saturating_add(place.size_px);
        let size_px = UVec2::new(texture.width(), texture.height());
        if end_px.cmpgt(size_px).any() {
            return bad("the mask's far corner", end_px.to_string(), format!("within the texture's {size_px}"));
        }
        let components = u32::from(format.components());
        if place.component >= components {
            return bad("the mask's component", place.component.to_string(), format!("below {components}"));
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

    /// Masks of so many lights in one texture array, so that a host's shader binds one texture. In formats of four components masks of one
    /// channel lie in the components of a layer: that of light `i` is in component `i % 4` of layer `i / 4`. All others have layers of their
    /// own, one after the other, as many as a mask takes.
    ///
    /// # Panics
    /// Where the format is not one of the [`FORMATS`](Self::FORMATS), or the count is zero.
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

    /// Whether both write some texel's component.
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

    /// The usages that a mask's texture needs: to be read, and written by compute or drawn to.
    pub fn usages(format: wgpu::TextureFormat) -> wgpu::TextureUsages {
        let written = if format == Self::FORMAT {
            wgpu::TextureUsages::STORAGE_BINDING
        } else {
            wgpu::TextureUsages::RENDER_ATTACHMENT
        };
        wgpu::TextureUsages::TEXTURE_BINDING | written
    }

    /// Size in pixels.
    pub fn size_px(&self) -> UVec2 {
        self.place.size_px
    }

    /// How many channels it has.
    pub fn channels(&self) -> MaskChannels {
        self.channels
    }

    /// The texture, for copies.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// Where in the texture it lies.
    pub fn place(&self) -> MaskPlace {
        self.place
    }

    /// The first channel's layer, for shaders: `texture_2d<f32>`, read by `textureLoad` from the [place](Self::place) on.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.first_view
    }

    /// All of its layers, for shaders: `texture_2d_array<f32>`, read by `textureLoad`.
    pub fn layers_view(&self) -> &wgpu::TextureView {
        &self.layers_view
    }
}

/// The layers that a mask takes.
fn layers_of(format: wgpu::TextureFormat, channels: MaskChannels) -> u32 {
    if format.components() == 1 { channels.count() } else { 1 }
}

/// A texture for masks, which may be copied from.
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
