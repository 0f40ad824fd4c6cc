//! Receivers: points on surfaces, each with the side that is seen.
//!
//! **Ray offset.** A segment to the light must start off its own surface, on the side that the camera sees, or it
//! would meet that surface. The distance is derived as follows. The hit is rebuilt from the triangle's corners in double
//! precision and then rounded to single. It thus lies off the triangle's plane by at most half a unit in the last place per
//! axis: `2⁻²⁴ |x|`, whatever the distance to the camera and the size of the triangle. Adding the ray offset rounds once
//! more. The planes of the test are computed in double precision and add nothing (see `planes.rs`). Neighbouring triangles
//! of a tessellated plane are as flat as the rounding of their own corners, another `2⁻²⁴ |x|` each. Four such errors,
//! doubled:
//!
//! ```text
//! offset = 2⁻²¹ |x| + 2⁻⁴⁶ · largest |corner|
//! ```
//!
//! where the second term is the double-precision rounding of the corners' sum. The offset is 5 µm at 10 m from the world's
//! origin, and 5 mm at 10 km.

use glam::{UVec2, Vec3};

/// Surface point that may receive light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverPoint {
    /// World position, metres.
    pub position: Vec3,
    /// Unit geometric normal in world space, turned to the side that is seen.
    pub normal: Vec3,
    /// Ray offset: distance along the normal at which shadow rays start, metres.
    pub ray_offset_m: f32,
    /// Index into the scene's instances; `u32::MAX` if the point is not a hit.
    pub instance: u32,
    /// Triangle index within the instance's mesh; `u32::MAX` if the point is not a hit.
    pub triangle: u32,
}

/// Ray offset over the distance from the world's origin: 2⁻²¹; see the derivation above.
const RAY_OFFSET: f32 = 1.0 / (1 << 21) as f32;
/// Part of the ray offset over the largest corner: 2⁻⁴⁶, a few roundings of double precision's 2⁻⁵³.
const CORNER_RAY_OFFSET: f32 = 1.0 / (1u64 << 46) as f32;

impl ReceiverPoint {
    /// Creates a point whose position is exact to single precision. A less certain position, of a depth buffer for example,
    /// needs a larger [`ray_offset_m`](Self::ray_offset_m): raise it to the position's error.
    pub fn new(position: Vec3, normal: Vec3) -> Self {
        Self { position, normal, ray_offset_m: RAY_OFFSET * position.length(), instance: u32::MAX, triangle: u32::MAX }
    }

    /// [`Self::new`] for a point on a triangle whose corners lie up to `largest_corner_m` from the world's origin.
    pub(crate) fn on_triangle(position: Vec3, normal: Vec3, largest_corner_m: f32) -> Self {
        let point = Self::new(position, normal);
        Self { ray_offset_m: point.ray_offset_m + CORNER_RAY_OFFSET * largest_corner_m, ..point }
    }

    /// Start of shadow rays: the position plus the ray offset.
    pub fn origin(&self) -> Vec3 {
        self.position + self.normal * self.ray_offset_m
    }
}

/// Receivers of a camera: the first surface through each pixel's centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Receivers {
    /// Width and height in pixels.
    pub size_px: UVec2,
    /// Points, row by row from the top left; `None` is background.
    pub points: Vec<Option<ReceiverPoint>>,
}

impl Receivers {
    /// Receiver of pixel (`x`, `y`); `None` for the background.
    pub fn at(&self, x: u32, y: u32) -> Option<&ReceiverPoint> {
        self.points[(y * self.size_px.x + x) as usize].as_ref()
    }

    /// Number of pixels that show a surface.
    pub fn hits(&self) -> usize {
        self.points.iter().flatten().count()
    }
}
