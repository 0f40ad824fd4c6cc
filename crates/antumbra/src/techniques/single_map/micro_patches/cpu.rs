//! CPU reference of the patches: rays through the corners of squares, in space.

use glam::{Vec2, Vec3};

/// A rectangle on the light's plane, in texels of the map at g = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    pub(crate) low: Vec2,
    pub(crate) high: Vec2,
}

/// Point of the light's plane, z = 0, that a point of the map at `texel` and depth `z_m` hides from a receiver at `receiver_m`. The map
/// shows tangents about the light's centre, `texels_per_tangent` texels for each.
pub(crate) fn hidden_point(receiver_m: Vec3, texel: Vec2, z_m: f32, texels_per_tangent: f32) -> Vec2 {
    let point = (texel / texels_per_tangent * z_m).extend(z_m);
    let along = receiver_m.z / (receiver_m.z - z_m);
    (receiver_m + along * (point - receiver_m)).truncate() * texels_per_tangent
}

/// Squares of the map with the depths that they show; `None` if a square hides nothing.
pub(crate) struct Squares<'a> {
    pub(crate) receiver_m: Vec3,
    pub(crate) texels_per_tangent: f32,
    pub(crate) depth_m: &'a dyn Fn(i32, i32) -> Option<f32>,
}

impl Squares<'_> {
    fn corners(&self, x: i32, y: i32, z_m: f32) -> [Vec2; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, up)| {
            let texel = Vec2::new((x + right) as f32, (y + up) as f32);
            hidden_point(self.receiver_m, texel, z_m, self.texels_per_tangent)
        })
    }

    /// Patch of a square that hides something.
    pub(crate) fn alone(&self, x: i32, y: i32) -> Patch {
        let z_m = (self.depth_m)(x, y).expect("a depth");
        box_of(&self.corners(x, y, z_m))
    }

    /// Patch extended outwards to where its eight neighbours begin, at the sides and corners that it shares with them.
    pub(crate) fn joined(&self, x: i32, y: i32) -> Patch {
        let mut patch = self.alone(x, y);
        for (beside, above) in (-1..=1).flat_map(|beside| (-1..=1).map(move |above| (beside, above))) {
            let Some(z_m) = (self.depth_m)(x + beside, y + above) else { continue };
            let there = box_of(&self.corners(x, y, z_m));
            match beside {
                -1 => patch.low.x = patch.low.x.min(there.low.x),
                1 => patch.high.x = patch.high.x.max(there.high.x),
                _ => {}
            }
            match above {
                -1 => patch.low.y = patch.low.y.min(there.low.y),
                1 => patch.high.y = patch.high.y.max(there.high.y),
                _ => {}
            }
        }
        patch
    }

    /// Intersection of a square's patches at two depths and at all depths between.
    pub(crate) fn innermost(&self, x: i32, y: i32, ends_m: [f32; 2]) -> Patch {
        const STEPS: i32 = 64;
        let depths_m = (0..=STEPS).map(|i| ends_m[0] + (ends_m[1] - ends_m[0]) * i as f32 / STEPS as f32);
        let patches = depths_m.map(|z_m| box_of(&self.corners(x, y, z_m)));
        patches.reduce(|a, b| Patch { low: a.low.max(b.low), high: a.high.min(b.high) }).expect("two depths or more")
    }
}

fn box_of(points: &[Vec2]) -> Patch {
    let low = points.iter().copied().fold(Vec2::INFINITY, Vec2::min);
    let high = points.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max);
    Patch { low, high }
}
