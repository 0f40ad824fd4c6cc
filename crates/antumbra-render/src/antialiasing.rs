//! Antialiasing of images whose masks have one sample per pixel. The laboratory applies these rules on the CPU, the viewer on the GPU.

use glam::Vec2;

/// Sample positions within a pixel, relative to its centre: the standard pattern of eight samples of Direct3D 11, in sixteenths. No two
/// share a column or row, so that edges of all directions get eight steps.
pub const OFFSETS_PX: [Vec2; 8] = {
    const fn at(x: f32, y: f32) -> Vec2 {
        Vec2::new(x / 16.0, y / 16.0)
    }
    [
        at(1.0, -3.0),
        at(-1.0, 3.0),
        at(5.0, 1.0),
        at(-3.0, -5.0),
        at(-5.0, 5.0),
        at(-7.0, -1.0),
        at(3.0, 7.0),
        at(7.0, -7.0),
    ]
};

/// Weight of the difference of normals against that of positions in pixels. Faces that meet at a right angle differ by more than any
/// neighbours of a pixel, whose squared distances from a position within it are at most 4.5.
pub const NORMALS_COUNT: f32 = 5.0;

/// Difference below which a position beside a pixel's centre shows the surface that is seen at the centre.
pub const ALIKE: f32 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_spread_over_the_pixel() {
        let mean: Vec2 = OFFSETS_PX.iter().sum::<Vec2>() / 8.0;
        assert!(mean.abs().max_element() < 0.01, "{mean}");
        for (i, a) in OFFSETS_PX.iter().enumerate() {
            assert!(a.abs().max_element() < 0.5);
            assert!(OFFSETS_PX[..i].iter().all(|b| a.x != b.x && a.y != b.y));
        }
    }
}
