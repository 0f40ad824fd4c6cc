//! Images: fetched, recognised by their first bytes, decoded within limits.
//!
//! Source: glTF 2.0, section 3.8; EXT_texture_webp, whose image is preferred to the texture's own, a fallback for readers
//! without the extension.
//!
//! An unreadable image is left out with a warning, so that a scene with one broken texture still loads. A reference to an
//! image that the document does not have is an error.

use std::collections::HashMap;
use std::io::Cursor;

use glam::Vec4;
use gltf::json::texture::{Texture, WrappingMode};
use gltf::json::validation::Checked;
use image::{DynamicImage, ImageDecoder, ImageReader};

use super::fault::{Fault, Result, quoted};
use super::source::Source;
use crate::{Image, Wrap, linear_from_srgb};

/// Images of a scene so far. An image that is used with two address modes is there twice.
#[derive(Clone, Debug, Default)]
pub(super) struct Images {
    /// Decoded images, except those that [`Self::take_loaded`] removed.
    pub loaded: Vec<Image>,
    by_use: HashMap<(usize, [Wrap; 2]), Option<usize>>,
    means: HashMap<usize, Option<Means>>,
}

/// Mean of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means {
    /// Mean of the stored fractions.
    pub stored: Vec4,
    /// Mean of the colour decoded from sRGB.
    pub linear: Vec4,
}

impl Images {
    /// Moves the decoded images out. Their indices in the scene stay known, so that none is decoded again.
    pub(super) fn take_loaded(&mut self) -> Vec<Image> {
        std::mem::take(&mut self.loaded)
    }

    /// Index in the scene of a texture's image; `None` if no image is readable.
    pub(super) fn of_texture(&mut self, source: &Source, texture: usize, place: &str) -> Result<Option<usize>> {
        let wrap = wrap_of_texture(source, texture, place)?;
        for Candidate { image, otherwise } in images_of(source, texture, place)? {
            if let Some(index) = self.of_image(source, image, wrap, otherwise) {
                return Ok(Some(index));
            }
        }
        Ok(None)
    }

    /// Index in the scene of one image; `otherwise` tells, in a warning, what replaces an unreadable one.
    fn of_image(&mut self, source: &Source, image: usize, wrap: [Wrap; 2], otherwise: &str) -> Option<usize> {
        if let Some(known) = self.by_use.get(&(image, wrap)) {
            return *known;
        }
        let index = decode(source, image, otherwise).map(|picture| {
            let rgba = picture.into_rgba8();
            let (width, height) = rgba.dimensions();
            let rgba8 = rgba.as_raw().chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]]).collect();
            self.loaded.push(Image { width, height, rgba8, wrap });
            self.loaded.len() - 1
        });
        self.by_use.insert((image, wrap), index);
        index
    }

    /// Mean of a texture, for materials that keep one value instead of an image.
    pub(super) fn mean_of_texture(&mut self, source: &Source, texture: usize, place: &str) -> Result<Option<Means>> {
        for Candidate { image, otherwise } in images_of(source, texture, place)? {
            let mean = self.means.entry(image).or_insert_with(|| Some(Means::of(&decode(source, image, otherwise)?)));
            if mean.is_some() {
                return Ok(*mean);
            }
        }
        Ok(None)
    }
}

impl Means {
    fn of(picture: &DynamicImage) -> Self {
        let rgba = picture.to_rgba8();
        let (mut stored, mut linear) = (glam::DVec4::ZERO, glam::DVec4::ZERO);
        for texel in rgba.pixels() {
            let [r, g, b, a] = texel.0;
            let fraction = |byte: u8| f64::from(byte) / 255.0;
            stored += glam::DVec4::new(fraction(r), fraction(g), fraction(b), fraction(a));
            linear += glam::DVec4::new(
                f64::from(linear_from_srgb(r)),
                f64::from(linear_from_srgb(g)),
                f64::from(linear_from_srgb(b)),
                fraction(a),
            );
        }
        let texels = f64::from(rgba.width()) * f64::from(rgba.height());
        Self { stored: (stored / texels).as_vec4(), linear: (linear / texels).as_vec4() }
    }
}

/// Image of a texture, and the words of a warning for what replaces an unreadable one.
struct Candidate {
    image: usize,
    otherwise: &'static str,
}

/// Words of a warning for a missing image.
const WHITE: &str = "white is used instead";

/// Images of a texture, the preferred one first; empty if the texture has no readable one.
fn images_of(source: &Source, texture: usize, place: &str) -> Result<Vec<Candidate>> {
    let found = texture_of(source, texture, place)?;
    let checked = |image: usize, key: &str| {
        let images = source.root.images.len();
        if image < images {
            return Ok(image);
        }
        Err(Fault::unresolved(format!("textures[{texture}].{key}"), "images", image, images))
    };
    // The document type has no better way to say that `source` is absent.
    let own = Some(found.source.value()).filter(|image| *image != u32::MAX as usize);
    let own = own.map(|image| checked(image, "source")).transpose()?;
    let extension = found.extensions.as_ref().and_then(|e| e.others.get("EXT_texture_webp"));
    let webp = extension.and_then(|webp| webp.get("source")?.as_u64());
    let webp = webp.map(|image| checked(image as usize, "EXT_texture_webp.source")).transpose()?;
    let otherwise = if own.is_some() { "the texture's other image is used" } else { WHITE };
    let webp = webp.map(|image| Candidate { image, otherwise });
    let images: Vec<_> = webp.into_iter().chain(own.map(|image| Candidate { image, otherwise: WHITE })).collect();
    if images.is_empty() {
        source.warn(format!("textures[{texture}]: has no image that can be read; {WHITE}"));
    }
    Ok(images)
}

fn texture_of<'s>(source: &'s Source, texture: usize, place: &str) -> Result<&'s Texture> {
    let textures = &source.root.textures;
    textures.get(texture).ok_or_else(|| Fault::unresolved(place, "textures", texture, textures.len()))
}

/// Address modes of a texture's sampler.
pub(super) fn wrap_of_texture(source: &Source, texture: usize, place: &str) -> Result<[Wrap; 2]> {
    let Some(index) = texture_of(source, texture, place)?.sampler else { return Ok([Wrap::Repeat; 2]) };
    let samplers = &source.root.samplers;
    let Some(sampler) = samplers.get(index.value()) else {
        return Err(Fault::unresolved(place, "samplers", index.value(), samplers.len()));
    };
    Ok([sampler.wrap_s, sampler.wrap_t].map(|wrap| match wrap {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }))
}

/// Decodes an image of the document; a failure becomes a warning that ends with `otherwise`.
fn decode(source: &Source, index: usize, otherwise: &str) -> Option<DynamicImage> {
    let place = Source::label(source.root.images[index].name.as_ref(), "images", index);
    match try_decode(source, index, &place) {
        Ok(picture) => Some(picture),
        Err(fault) => {
            source.warn(fault.as_warning(otherwise));
            None
        }
    }
}

fn try_decode(source: &Source, index: usize, place: &str) -> Result<DynamicImage> {
    let image = &source.root.images[index];
    let fetched;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            fetched = source.read_uri(uri, place)?;
            &fetched[..]
        }
        (None, Some(view)) => source.view(view.value())?.bytes,
        (None, None) => return Err(Fault::new(place, "has neither `uri` nor `bufferView`", "expected one of them")),
    };
    let bad = |problem: String| Fault::new(place, problem, "expected a PNG, JPEG or WebP image");
    let unreadable = |e: image::ImageError| bad(quoted(&e.to_string()));
    let mut reader = ImageReader::new(Cursor::new(bytes));
    reader = reader.with_guessed_format().map_err(|e| bad(e.to_string()))?;
    let limits = &source.budget.limits;
    let mut decode_limits = image::Limits::default();
    decode_limits.max_image_width = Some(limits.image_side);
    decode_limits.max_image_height = Some(limits.image_side);
    decode_limits.max_alloc = Some(limits.texels as u64 * 8);
    reader.limits(decode_limits);
    let png = reader.format() == Some(image::ImageFormat::Png);
    let decoder = reader.into_decoder().map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 || width.max(height) > limits.image_side {
        return Err(bad(format!("has {width} x {height} texels; 1 to {} per side are supported", limits.image_side)));
    }
    /// Largest expansion of deflate (RFC 1951: 258 bytes from 2 bits); an image that claims more is truncated or a bomb.
    const DEFLATE_EXPANSION: u64 = 1032;
    if png && decoder.total_bytes() / DEFLATE_EXPANSION > bytes.len() as u64 {
        return Err(bad(format!("states {width} x {height} texels, which is impossible in {} bytes", bytes.len())));
    }
    source.budget.take_texels(width as usize * height as usize, place)?;
    DynamicImage::from_decoder(decoder).map_err(unreadable)
}
