//! Mip chains, computed on the CPU in linear light and weighted by alpha, so that colours in a mask's holes do not bleed
//! into its edges.

use antumbra_scene::{Image, linear_from_srgb, srgb_from_linear};
use glam::Vec4;

/// Returns the image and its halvings down to one texel. An image wider or higher than `max_side` starts at the first
/// halving that fits.
pub(crate) fn mip_chain(image: &Image, max_side: u32) -> Vec<Image> {
    let mut levels = vec![image.clone()];
    while let Some(last) = levels.last()
        && (last.width > 1 || last.height > 1)
    {
        levels.push(halved(last));
    }
    levels.retain(|level| level.width.max(level.height) <= max_side);
    levels
}

/// Halves an image: each texel is the mean of the two to three source texels that it covers along each axis.
fn halved(image: &Image) -> Image {
    let (width, height) = ((image.width / 2).max(1), (image.height / 2).max(1));
    let source_range = |i: u32, n: u32, source_n: u32| i * source_n / n..((i + 1) * source_n).div_ceil(n);
    let mut rgba8 = Vec::with_capacity((width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            let texels = source_range(y, height, image.height).flat_map(|source_y| {
                source_range(x, width, image.width).map(move |source_x| source_y * image.width + source_x)
            });
            rgba8.push(mean_texel(texels.map(|i| image.rgba8[i as usize])));
        }
    }
    Image { width, height, rgba8, wrap: image.wrap }
}

fn mean_texel(texels: impl Iterator<Item = [u8; 4]>) -> [u8; 4] {
    let mut premultiplied = Vec4::ZERO;
    let mut plain = Vec4::ZERO;
    let mut count = 0.0;
    for [r, g, b, a] in texels {
        let alpha = f32::from(a) / 255.0;
        let color = Vec4::new(linear_from_srgb(r), linear_from_srgb(g), linear_from_srgb(b), 1.0);
        premultiplied += color * alpha;
        plain += color;
        count += 1.0;
    }
    let color = if premultiplied.w > 0.0 { premultiplied / premultiplied.w } else { plain / count };
    let byte = |v: f32| (255.0 * v).round() as u8;
    let [r, g, b] = color.truncate().to_array().map(|v| byte(srgb_from_linear(v)));
    [r, g, b, byte(premultiplied.w / count)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_do_not_bleed() {
        let image = Image { width: 2, height: 1, rgba8: vec![[200, 10, 10, 255], [0, 255, 0, 0]], ..Image::default() };
        let levels = mip_chain(&image, 8192);
        assert_eq!(levels.len(), 2);
        assert_eq!(levels[1].rgba8, [[200, 10, 10, 128]]);
    }

    #[test]
    fn odd_sizes_keep_every_texel() {
        let image = Image { width: 3, height: 1, rgba8: vec![[0; 4], [0; 4], [255; 4]], ..Image::default() };
        assert_eq!(mip_chain(&image, 8192)[1].rgba8[0][3], 85);
        assert_eq!(mip_chain(&image, 2)[0].width, 1);
    }
}
