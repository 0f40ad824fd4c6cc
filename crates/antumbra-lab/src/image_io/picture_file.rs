//! Image files named by the user. The extension determines the format.

use std::io::Write;
use std::path::Path;

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;

use super::write_png;
use crate::output_files::{AtomicFile, FileError, check_ending, check_writable, one_line};

/// JPEG quality, out of 100. At 92, no blocks are visible beside a PNG of the same image.
const JPEG_QUALITY: u8 = 92;

/// Format of an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Jpeg,
}

/// Returns the format of a file extension.
fn kind_of(path: &Path) -> Result<Kind, FileError> {
    Ok(match check_ending(path, "an image", &["png", "jpg", "jpeg"])? {
        "png" => Kind::Png,
        _ => Kind::Jpeg,
    })
}

/// Checks that an image can be written to a path, before long work. Leaves no file.
///
/// # Errors
/// If the extension is not that of an image, or the path is not writable.
pub fn check_picture_path(path: &Path) -> Result<(), FileError> {
    kind_of(path)?;
    check_writable(path)
}

/// Checks that visibility can be written to a path, before long work. Leaves no file.
///
/// # Errors
/// If the extension is not that of OpenEXR, or the path is not writable.
pub fn check_visibility_path(path: &Path) -> Result<(), FileError> {
    check_ending(path, "visibility (32-bit float OpenEXR)", &["exr"])?;
    check_writable(path)
}

/// Writes an 8-bit sRGB image in the format of its extension: `.png`, `.jpg` or `.jpeg`.
///
/// # Errors
/// As [`check_picture_path`], or if writing fails.
pub fn write_picture(path: &Path, picture: &RgbImage) -> Result<(), FileError> {
    if kind_of(path)? == Kind::Png {
        return write_png(path, picture);
    }
    let mut file = AtomicFile::create(path)?;
    let mut jpeg = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
    picture
        .write_with_encoder(encoder)
        .map_err(|error| FileError::bad_path("write", path, one_line(&error.to_string()), "write it as .png"))?;
    file.writer().write_all(&jpeg).map_err(|error| FileError::from_write(path, &error))?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;
    use crate::image_io::read_png;

    #[test]
    fn names_say_what_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let picture = RgbImage::from_fn(64, 48, |x, y| Rgb([4 * x as u8, 5 * y as u8, 128]));
        for (name, head) in
            [("a.png", &b"\x89PNG"[..]), ("a.jpg", b"\xff\xd8\xff"), ("b.JPEG", b"\xff\xd8\xff"), ("b.Png", b"\x89PNG")]
        {
            let path = folder.path().join(name);
            check_picture_path(&path).unwrap();
            write_picture(&path, &picture).unwrap();
            assert!(std::fs::read(&path).unwrap().starts_with(head), "{name}");
            let back = read_png(&path).unwrap();
            let worst = back.as_raw().iter().zip(picture.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(worst.unwrap() < 16, "{name}: {worst:?}");
        }
    }

    #[test]
    fn other_names_are_refused_before_anything_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let gif = folder.path().join("a.gif");
        let why = check_picture_path(&gif).unwrap_err();
        assert!(
            why.is_bad_input && why.to_string().contains("an image cannot be written as .gif; name it .png or .jpg"),
            "{why}"
        );
        assert!(check_picture_path(&folder.path().join("a")).is_err());
        assert!(write_picture(&gif, &RgbImage::new(1, 1)).is_err());
        assert!(check_visibility_path(&folder.path().join("v.png")).unwrap_err().to_string().ends_with("name it .exr"));
        check_visibility_path(&folder.path().join("v.exr")).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
