//! Rule of antialiased pictures of masks that have one sample a pixel: for the laboratory's on the processor and the viewer's on the device.

use glam::Vec2;

/// Places within a pixel, from its centre: the standard pattern of eight samples of Direct3D 11, in sixteenths. No two are in one column or
/// row, so that edges of all directions get eight steps.
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

/// Weight of the difference of normals against that of places in pixels: faces that meet at a right angle differ by more than any of a
/// pixel's neighbours, whose squared distances from a place within it are at most 4.5.
pub const NORMALS_COUNT: f32 = 5.0;

/// Unlikeness below which a place beside a pixel's centre shows the surface that is seen there.
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
