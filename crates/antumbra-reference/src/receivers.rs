//! Where light is asked for: points on surfaces, each with the side that is seen.
//!
//! **The hair.** A segment to the light must start off its own surface, on the side that the camera sees, or it would
//! meet that surface. How far? The hit is rebuilt from the triangle's corners in double precision and then rounded to
//! single, so it lies off the triangle's plane by at most half a unit in the last place per axis: `2⁻²⁴ |x|`, whatever
//! the distance to the camera and the size of the triangle. Adding the ray offset rounds once more. The planes of the test
//! itself are made in double precision and add nothing (see `planes.rs`). Neighbouring triangles of a tessellated
//! plane are as flat as their own corners' rounding, another `2⁻²⁴ |x|` each. Four such errors, doubled:
//!
//! ```text
//! hair = 2⁻²¹ |x| + 2⁻⁴⁶ · largest |corner|
//! ```
//!
//! where the second term is the double-precision rounding of the corners' sum. At 10 m from the world's origin the offset
//! is 5 µm; at 10 km, 5 mm.

use glam::{UVec2, Vec3};

/// A point of a surface that light may reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverPoint {
    /// World position, metres.
    pub position: Vec3,
    /// Unit geometric normal in world space, turned to the side that is seen.
    pub normal: Vec3,
    /// How far along the normal shadow rays start, metres.
    pub hair_m: f32,
    /// Index into the scene's instances; `u32::MAX` where the point is no hit.
    pub instance: u32,
    /// Which triangle of the instance's mesh; `u32::MAX` where the point is no hit.
    pub triangle: u32,
}

/// 2⁻²¹; see the derivation above.
const HAIR: f32 = 1.0 / (1 << 21) as f32;
/// 2⁻⁴⁶: double precision's 2⁻⁵³, a few operations long.
const CORNER_HAIR: f32 = 1.0 / (1u64 << 46) as f32;

impl ReceiverPoint {
    /// A point that is known to single precision. A position from elsewhere, a depth buffer say, is less certain:
    /// raise [`hair_m`](Self::hair_m) to its error.
    pub fn new(position: Vec3, normal: Vec3) -> Self {
        Self { position, normal, hair_m: HAIR * position.length(), instance: u32::MAX, triangle: u32::MAX }
    }

    /// The same, on a triangle whose corners lie up to `largest_corner_m` from the world's origin.
    pub(crate) fn on_triangle(position: Vec3, normal: Vec3, largest_corner_m: f32) -> Self {
        let point = Self::new(position, normal);
        Self { hair_m: point.hair_m + CORNER_HAIR * largest_corner_m, ..point }
    }

    /// Where shadow rays start: a hair off the surface.
    pub fn origin(&self) -> Vec3 {
        self.position + self.normal * self.hair_m
    }
}

/// What a camera sees: the first surface through each pixel's centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Receivers {
    /// Width and height in pixels.
    pub size_px: UVec2,
    /// Row by row from the top left; `None` is background.
    pub points: Vec<Option<ReceiverPoint>>,
}

impl Receivers {
    /// The receiver of pixel (`x`, `y`), or `None` where it shows the background.
    pub fn at(&self, x: u32, y: u32) -> Option<&ReceiverPoint> {
        self.points[(y * self.size_px.x + x) as usize].as_ref()
    }

    /// How many pixels show a surface.
    pub fn hits(&self) -> usize {
        self.points.iter().flatten().count()
    }
}
