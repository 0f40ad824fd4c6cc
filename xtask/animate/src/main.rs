//! `antumbra-animate OUT.png MILLISECONDS FRAME.png...`: creates a looping animated PNG from frames of one size.
//!
//! Each frame after the first stores the rectangle in which it differs from the previous one, so a still background costs
//! nothing.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::process::ExitCode;

use png::{BitDepth, BlendOp, ColorType, DisposeOp};

const USAGE: &str = "usage: antumbra-animate OUT.png MILLISECONDS FRAME.png...";

/// Image with three bytes per pixel, rows from the top.
#[derive(Debug, PartialEq)]
struct Image {
    width: u32,
    height: u32,
    rgb: Vec<u8>,
}

/// Rectangle of pixels: corner and size.
#[derive(Debug, PartialEq, Eq, Clone, Copy)]
struct Area {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("antumbra-animate: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(args: &[String]) -> Result<(), String> {
    let [out, delay, frames @ ..] = args else { return Err(USAGE.into()) };
    let delay_ms = delay.parse().map_err(|error| format!("{delay}: {error}; {USAGE}"))?;
    let frames: Vec<Image> = frames.iter().map(|path| load(path)).collect::<Result<_, _>>()?;
    save(out, &frames, delay_ms)
}

/// Reads an image of eight bits per channel. Alpha is dropped.
fn load(path: &str) -> Result<Image, String> {
    let file = File::open(path).map_err(|error| format!("{path}: {error}"))?;
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(|error| format!("{path}: {error}"))?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or_else(|| format!("{path}: too large"))?];
    let info = reader.next_frame(&mut bytes).map_err(|error| format!("{path}: {error}"))?;
    let rgb = match (info.bit_depth, info.color_type) {
        (BitDepth::Eight, ColorType::Rgb) => bytes,
        (BitDepth::Eight, ColorType::Rgba) => {
            bytes.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
        }
        other => return Err(format!("{path}: has the format {other:?}; expected RGB or RGBA with 8 bits per channel")),
    };
    Ok(Image { width: info.width, height: info.height, rgb })
}

fn save(path: &str, frames: &[Image], delay_ms: u16) -> Result<(), String> {
    let first = frames.first().ok_or(USAGE)?;
    if let Some(other) = frames.iter().find(|frame| (frame.width, frame.height) != (first.width, first.height)) {
        let (w, h) = (first.width, first.height);
        return Err(format!(
            "frames have different sizes, {w} × {h} and {} × {}; give frames of equal size",
            other.width, other.height
        ));
    }
    let file = File::create(path).map_err(|error| format!("{path}: {error}"))?;
    encode(BufWriter::new(file), frames, delay_ms).map_err(|error| format!("{path}: {error}"))
}

fn encode(to: impl std::io::Write, frames: &[Image], delay_ms: u16) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(to, frames[0].width, frames[0].height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(delay_ms, 1000)?;
    encoder.set_dispose_op(DisposeOp::None)?;
    encoder.set_blend_op(BlendOp::Source)?;
    let mut writer = encoder.write_header()?;
    for (i, frame) in frames.iter().enumerate() {
        let whole = Area { x: 0, y: 0, width: frame.width, height: frame.height };
        let area = if i == 0 { whole } else { changed(&frames[i - 1], frame) };
        if i > 0 {
            // The setters check size and position against each other.
            writer.reset_frame_position()?;
            writer.set_frame_dimension(area.width, area.height)?;
            writer.set_frame_position(area.x, area.y)?;
        }
        writer.write_image_data(&cut(frame, area))?;
    }
    writer.finish()
}

/// Returns the smallest rectangle with all differing pixels; one pixel if none differs, because a frame may not be empty.
fn changed(before: &Image, after: &Image) -> Area {
    let width = after.width as usize;
    let pixels = before.rgb.chunks_exact(3).zip(after.rgb.chunks_exact(3));
    let mut bounds: Option<[usize; 4]> = None;
    for (i, _) in pixels.enumerate().filter(|(_, (a, b))| a != b) {
        let (x, y) = (i % width, i / width);
        let [left, top, right, bottom] = bounds.unwrap_or([x, y, x, y]);
        bounds = Some([left.min(x), top.min(y), right.max(x), bottom.max(y)]);
    }
    let [left, top, right, bottom] = bounds.unwrap_or_default().map(|place| place as u32);
    Area { x: left, y: top, width: right - left + 1, height: bottom - top + 1 }
}

/// Returns the pixels of a rectangle.
fn cut(image: &Image, area: Area) -> Vec<u8> {
    let stride = 3 * image.width as usize;
    let columns = 3 * area.x as usize..3 * (area.x + area.width) as usize;
    let rows = image.rgb.chunks_exact(stride).skip(area.y as usize).take(area.height as usize);
    rows.flat_map(|row| row[columns.clone()].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(fill: u8) -> Image {
        Image { width: 4, height: 3, rgb: vec![fill; 36] }
    }

    #[test]
    fn frames_come_back_as_they_were() {
        let mut frames = [image(9), image(9), image(9)];
        frames[1].rgb[3 * (4 + 2)] = 200;
        frames[2].rgb[0] = 7;
        let mut bytes = Vec::new();
        encode(&mut bytes, &frames, 80).expect("frames of equal size");

        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        assert_eq!(reader.info().animation_control().map(|control| control.num_frames), Some(3));
        let mut canvas = image(0);
        for frame in &frames {
            let mut pixels = vec![0; 36];
            let shown = reader.next_frame(&mut pixels).expect("a frame");
            let control = *reader.info().frame_control().expect("a frame's control");
            assert_eq!((control.delay_num, control.delay_den), (80, 1000));
            let row_bytes = 3 * shown.width as usize;
            for (row, pixels) in pixels.chunks_exact(row_bytes).take(shown.height as usize).enumerate() {
                let at = 3 * ((control.y_offset as usize + row) * 4 + control.x_offset as usize);
                canvas.rgb[at..at + row_bytes].copy_from_slice(pixels);
            }
            assert_eq!(canvas, *frame);
        }
    }

    #[test]
    fn a_frame_stores_what_differs() {
        let (before, mut after) = (image(1), image(1));
        assert_eq!(changed(&before, &after), Area { x: 0, y: 0, width: 1, height: 1 });
        after.rgb[3 * (4 + 1)] = 2;
        after.rgb[3 * (8 + 3) + 2] = 2;
        let area = changed(&before, &after);
        assert_eq!(area, Area { x: 1, y: 1, width: 3, height: 2 });
        assert_eq!(cut(&after, area), [2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2]);
    }

    #[test]
    fn frames_of_two_sizes_are_refused() {
        let frames = [image(0), Image { width: 2, height: 6, rgb: vec![0; 36] }];
        let error = save("never-written.png", &frames, 80).expect_err("two sizes");
        assert!(error.contains("4 × 3") && error.contains("2 × 6"), "{error}");
    }
}
