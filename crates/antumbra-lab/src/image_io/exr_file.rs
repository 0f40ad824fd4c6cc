//! Visibility as 32-bit float OpenEXR: one channel `V`, or `V.R`, `V.G` and `V.B`, of exactly the image's size.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, ReadChannels, ReadLayers, SmallVec,
    WritableImage, read,
};
use glam::{UVec2, Vec3};

use crate::output_files::{AtomicFile, FileError, one_line};
use crate::picture::{Visibility, VisibilityValues};

/// Writes visibility with lossless compression.
pub fn write_visibility_exr(path: &Path, visibility: &Visibility) -> Result<(), FileError> {
    let channel = |name: &str, samples: Vec<f32>| AnyChannel::new(name, FlatSamples::F32(samples));
    let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = match &visibility.values {
        VisibilityValues::One(values) => [channel("V", values.clone())].into_iter().collect(),
        VisibilityValues::Three(values) => {
            let plane = |c: usize| values.iter().map(|v| v[c]).collect();
            [channel("V.R", plane(0)), channel("V.G", plane(1)), channel("V.B", plane(2))].into_iter().collect()
        }
    };
    let size = (visibility.size_px.x as usize, visibility.size_px.y as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));

    let mut file = AtomicFile::create(path)?;
    Image::from_layer(layer).write().non_parallel().to_buffered(file.writer()).map_err(|error| match error {
        exr::error::Error::Io(error) => FileError::from_write(path, &error),
        error => FileError::bad_path("write", path, one_line(&error.to_string()), "choose another size"),
    })?;
    file.finish()
}

/// Reads visibility from the channel `V`, or `V.R`, `V.G` and `V.B`. Half floats are widened; other channels are ignored.
pub fn read_visibility_exr(path: &Path) -> Result<Visibility, FileError> {
    const REMEDY: &str = "give an OpenEXR file with the channel V, or V.R, V.G and V.B";
    let file = File::open(path).map_err(|error| FileError::from_read(path, &error))?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(BufReader::new(file))
        .map_err(|error| FileError::bad_content(path, one_line(&error.to_string()), REMEDY))?;

    let layer = image.layer_data;
    let size_px = UVec2::new(layer.size.0 as u32, layer.size.1 as u32);
    let plane = |name: &str| -> Option<Vec<f32>> {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name))?;
        Some(channel.sample_data.values_as_f32().collect())
    };
    if let Some(values) = plane("V") {
        return Ok(Visibility::one(size_px, values));
    }
    match (plane("V.R"), plane("V.G"), plane("V.B")) {
        (Some(r), Some(g), Some(b)) => {
            let values = r.into_iter().zip(g).zip(b).map(|((r, g), b)| Vec3::new(r, g, b)).collect();
            Ok(Visibility::three(size_px, values))
        }
        _ => {
            let names: Vec<String> = layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
            Err(FileError::bad_content(path, format!("its channels are {}", names.join(", ")), REMEDY))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.exr");
        let size_px = UVec2::new(37, 21);
        let values: Vec<f32> = (0..37 * 21).map(|i| (i as f32 * 0.1).sin()).collect();
        let one = Visibility::one(size_px, values.clone());
        let three = Visibility::three(size_px, values.iter().map(|&v| Vec3::new(v, v * v, 1.0 / 3.0)).collect());
        for visibility in [one, three] {
            write_visibility_exr(&path, &visibility).unwrap();
            assert_eq!(read_visibility_exr(&path).unwrap(), visibility);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Channel names in the file's header are those that other programs expect, in the order of the format.
    #[test]
    fn channels_are_named_as_agreed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.exr");
        write_visibility_exr(&path, &Visibility::three(UVec2::new(2, 1), vec![Vec3::ONE, Vec3::ZERO])).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let position = |name: &[u8]| bytes.windows(name.len()).position(|w| w == name);
        let found = [b"\0V.B\0", b"V.G\0\x02", b"V.R\0\x02"].map(|name| position(name).expect("a channel of f32"));
        assert!(found.is_sorted());
    }

    #[test]
    fn what_is_no_visibility_is_said_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.exr");
        std::fs::write(&path, "not an image").unwrap();
        let error = read_visibility_exr(&path).unwrap_err().to_string();
        assert!(error.contains("v.exr") && error.contains("the channel V") && !error.contains('\n'), "{error}");
    }
}
