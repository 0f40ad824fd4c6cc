//! Axis-aligned box in world space.

use glam::{BVec3, DVec3, DVec4, Vec3};

/// Axis-aligned box; empty if `min > max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// Empty box.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Infinite box, for objects that may lie anywhere.
    pub const EVERYTHING: Self = Self { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };

    /// Bounding box of some points.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Smallest box that contains both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Intersection of both; `None` if it is empty.
    pub fn intersection(self, other: Self) -> Option<Self> {
        let both = Self { min: self.min.max(other.min), max: self.max.min(other.max) };
        (!both.is_empty()).then_some(both)
    }

    /// Whether the box is empty.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Reason why the box cannot bound an object: it is empty or has NaNs. `None` if it can. Sides may be infinite.
    pub fn problem(&self) -> Option<&'static str> {
        if self.min.is_nan() || self.max.is_nan() {
            return Some("not a number");
        }
        let is_beyond = self.min.cmpeq(Vec3::INFINITY).any() || self.max.cmpeq(Vec3::NEG_INFINITY).any();
        (self.is_empty() || is_beyond).then_some("empty")
    }

    /// Eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| Vec3::select(BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), self.max, self.min))
    }

    /// Planes of the six faces: `plane · (x, 1) ≥ 0` inside.
    pub fn planes(&self) -> [DVec4; 6] {
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        let [x, y, z] = DVec3::AXES;
        [
            x.extend(-min.x),
            y.extend(-min.y),
            z.extend(-min.z),
            (-x).extend(max.x),
            (-y).extend(max.y),
            (-z).extend(max.z),
        ]
    }

    /// Centre.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Length of the diagonal; 0 for an empty box.
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.min.distance(self.max) }
    }
}
