//! Files that a user names: what kind they are, their names say.

use std::io::Write;
use std::path::Path;

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;

use super::write_png;
use crate::output_files::{AtomicFile, FileError, check_ending, check_writable, one_line};

/// Of 100; at 92 no block shows beside a PNG of the same picture.
const JPEG_QUALITY: u8 = 92;

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Jpeg,
}

/// By the ending of a name.
fn kind_of(path: &Path) -> Result<Kind, FileError> {
    Ok(match check_ending(path, "a picture", &["png", "jpg", "jpeg"])? {
        "png" => Kind::Png,
        _ => Kind::Jpeg,
    })
}

/// Whether a picture can be written there, to be asked before long work. Nothing is left there.
///
/// # Errors
/// Where the name is that of another kind of file, or the place takes none.
pub fn check_picture_path(path: &Path) -> Result<(), FileError> {
    kind_of(path)?;
    check_writable(path)
}

/// Whether visibility can be written there, to be asked before long work. Nothing is left there.
///
/// # Errors
/// Where the name is not one of OpenEXR, or the place takes none.
pub fn check_visibility_path(path: &Path) -> Result<(), FileError> {
    check_ending(path, "visibility, 32-bit float OpenEXR,", &["exr"])?;
    check_writable(path)
}

/// Writes an 8-bit sRGB picture as its name says: `.png`, or `.jpg` and `.jpeg`.
///
/// # Errors
/// As [`check_picture_path`], or where writing fails.
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
        assert!(why.is_bad_input && why.to_string().contains("not written as .gif; name it .png or .jpg"), "{why}");
        assert!(check_picture_path(&folder.path().join("a")).is_err());
        assert!(write_picture(&gif, &RgbImage::new(1, 1)).is_err());
        assert!(check_visibility_path(&folder.path().join("v.png")).unwrap_err().to_string().ends_with("name it .exr"));
        check_visibility_path(&folder.path().join("v.exr")).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
