//! 8-bit sRGB PNG.

use std::io::Write;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageReader, RgbImage};

use crate::output_files::{AtomicFile, FileError};

/// Writes an 8-bit sRGB image. [`Picture::to_srgb8`](crate::picture::Picture::to_srgb8) creates one from linear colours.
pub fn write_png(path: &Path, picture: &RgbImage) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    let png = encode_png(picture).map_err(|why| FileError::bad_path("write", path, why, "choose another size"))?;
    file.writer().write_all(&png).map_err(|error| FileError::from_write(path, &error))?;
    file.finish()
}

/// Returns the bytes of a PNG file: grey if every pixel is, else RGB. Fails with a message on an image without pixels.
pub fn encode_png(picture: &RgbImage) -> Result<Vec<u8>, String> {
    let is_gray = picture.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]);
    let (samples, color) = if is_gray {
        (picture.pixels().map(|p| p.0[0]).collect(), ExtendedColorType::L8)
    } else {
        (picture.as_raw().clone(), ExtendedColorType::Rgb8)
    };
    let mut png = Vec::new();
    let (width, height) = picture.dimensions();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(&samples, width, height, color)
        .map_err(|error| crate::output_files::one_line(&error.to_string()))?;
    Ok(png)
}

/// Reads a PNG (or JPEG) file as 8-bit RGB.
pub fn read_png(path: &Path) -> Result<RgbImage, FileError> {
    let reader = ImageReader::open(path).map_err(|error| FileError::from_read(path, &error))?;
    let image = reader.with_guessed_format().map_err(|error| FileError::from_read(path, &error))?.decode();
    let why = |error: image::ImageError| crate::output_files::one_line(&error.to_string());
    image.map(|image| image.into_rgb8()).map_err(|error| FileError::bad_content(path, why(error), "give a PNG image"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn pictures_come_back_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let color = RgbImage::from_fn(7, 5, |x, y| Rgb([x as u8 * 30, y as u8 * 50, 255]));
        let gray = RgbImage::from_fn(7, 5, |x, y| Rgb([(x * y) as u8; 3]));
        for picture in [color, gray] {
            let path = folder.path().join("a.png");
            write_png(&path, &picture).unwrap();
            assert_eq!(read_png(&path).unwrap(), picture);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_is_no_picture_is_said_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(read_png(&path).unwrap_err().to_string().ends_with("there is no such file; check the path"));
        std::fs::write(&path, "not a picture").unwrap();
        let error = read_png(&path).unwrap_err().to_string();
        assert!(error.ends_with("give a PNG image") && !error.contains('\n'), "{error}");
        assert!(write_png(&folder.path().join("b.png"), &RgbImage::new(0, 0)).is_err());
        assert!(!folder.path().join("b.png").exists());
    }
}
