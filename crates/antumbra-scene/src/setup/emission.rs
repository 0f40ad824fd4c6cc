//! A rectangle light's texture: an image file or a data URI.

use std::io::Cursor;
use std::path::Path;

use antumbra_light::EmissionTexture;
use glam::Vec3;
use image::{DynamicImage, ImageBuffer, ImageReader};

use crate::{base64, srgb_from_linear};

/// Largest side of a texture, texels: more than a light needs, but a bound on memory if the path is wrong.
const LARGEST_SIDE: u32 = 4096;
const DATA_URI_HEAD: &str = "data:image/png;base64,";

/// Reads `texture`, a data URI or a path relative to `folder`. The error says what is wrong, but not where.
pub(super) fn read(texture: &str, folder: &Path) -> Result<EmissionTexture, String> {
    let bytes = match texture.strip_prefix(DATA_URI_HEAD) {
        Some(data) => base64::decode(data.as_bytes()).ok_or("the data URI is not base64")?,
        None if texture.starts_with("data:") => return Err(format!("a data URI must begin with `{DATA_URI_HEAD}`")),
        None => {
            let path = folder.join(texture);
            let is_file = std::fs::metadata(&path).map(|m| m.is_file()).map_err(|e| e.to_string())?;
            if !is_file {
                return Err("it is not a file".into());
            }
            std::fs::read(&path).map_err(|e| e.to_string())?
        }
    };
    let mut reader = ImageReader::new(Cursor::new(&bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| e.to_string().replace('\n', " "))?.into_rgb32f();
    let (width, height) = picture.dimensions();
    let rgb: Vec<Vec3> = picture.pixels().map(|p| Vec3::from(p.0.map(linear_from_encoded))).collect();
    Ok(EmissionTexture::from_rgb(width, height, &rgb))
}

/// Encodes a texture as a data URI that [`read`] restores within 16 bits. Only ratios matter, so values are scaled if the brightest
/// channel of any texel exceeds 1.
pub(super) fn data_uri(emission: &EmissionTexture) -> Option<String> {
    let EmissionTexture { width, height, .. } = *emission;
    let scale = emission.colors().map(Vec3::max_element).fold(1.0, f32::max).recip();
    let encoded = |v: f32| (srgb_from_linear(v * scale) * 65535.0).round() as u16;
    let picture = if emission.tint.is_some() {
        let texels = emission.colors().flat_map(|color| color.to_array().map(encoded)).collect();
        DynamicImage::ImageRgb16(ImageBuffer::from_raw(width, height, texels)?)
    } else {
        let texels = emission.luminance.iter().copied().map(encoded).collect();
        DynamicImage::ImageLuma16(ImageBuffer::from_raw(width, height, texels)?)
    };
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).ok()?;
    Some(format!("{DATA_URI_HEAD}{}", base64::encode(png.get_ref())))
}

/// Decodes sRGB (IEC 61966-2-1) of any depth.
fn linear_from_encoded(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}
