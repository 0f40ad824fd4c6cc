//! Window of a view in the light plane, and its shapes.

use glam::Vec2;

/// Largest ratio of a rectangular window's sides.
const MAX_ASPECT: f32 = 16.0;

/// Window of a view in the light plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Centre in light-plane coordinates; of a warped window, the point where the divisor is 1.
    pub(crate) center: Vec2,
    /// Unit direction of the first side in light-plane coordinates.
    pub(crate) roll: Vec2,
    /// Half the sides, after the warp.
    pub(crate) half_size: Vec2,
    /// Gradient of the divisor of coordinates about `center`; along `roll`, and zero for windows without a warp.
    pub(crate) warp: Vec2,
    /// Centre after the warp, relative to `center`.
    pub(crate) center_in_warp: Vec2,
}

/// Shape of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum WindowShape {
    /// Square along the light's right and up axes, for kernels that lie along them.
    Square,
    /// Rectangle whose first side lies along this unit vector, for maps used only in depth comparisons.
    Rolled(Vec2),
    /// Trapezoid whose texels widen along `along`, by the factor `(1 + strength) / (1 − strength)` across it and by the
    /// square of that along it, for maps used only in depth comparisons.
    Warped {
        /// Unit direction in which texels widen.
        along: Vec2,
        /// Strength of the warp, below 1.
        strength: f32,
    },
}

impl Window {
    /// Square about the axis, along the light's right and up axes.
    pub(crate) fn square(half_size: f32) -> Self {
        Self {
            center: Vec2::ZERO,
            roll: Vec2::X,
            half_size: Vec2::splat(half_size),
            warp: Vec2::ZERO,
            center_in_warp: Vec2::ZERO,
        }
    }

    /// Smallest divisor in the window, where warped depths are largest.
    pub(super) fn min_divisor(&self) -> f64 {
        let farthest = self.warp.dot(self.center_in_warp) - (self.half_size * self.warp.dot(self.roll)).x.abs();
        1.0 / (1.0 - f64::from(farthest))
    }
}

impl WindowShape {
    /// Unit direction of the first side.
    pub(super) fn roll(self) -> Vec2 {
        match self {
            Self::Square => Vec2::X,
            Self::Rolled(roll) => roll,
            Self::Warped { along, .. } => along,
        }
    }
}

/// Rectangle in the light plane, in coordinates along and across `roll`; empty if `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaneWindow {
    pub(super) min: Vec2,
    pub(super) max: Vec2,
    roll: Vec2,
}

impl PlaneWindow {
    const EMPTY: Self = Self { min: Vec2::INFINITY, max: Vec2::NEG_INFINITY, roll: Vec2::X };

    /// Smallest rectangle around points in light-plane coordinates.
    pub(super) fn of(points: impl IntoIterator<Item = Vec2>, roll: Vec2) -> Self {
        points.into_iter().fold(Self { roll, ..Self::EMPTY }, |window, p| {
            let along = Vec2::new(p.dot(roll), p.dot(roll.perp()));
            Self { min: window.min.min(along), max: window.max.max(along), roll }
        })
    }

    pub(super) fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max), roll: other.roll }
    }

    pub(super) fn grown(self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin, ..self }
    }

    /// Returns a window of a shape that contains this rectangle, slightly enlarged so that edges have texels on both sides. An
    /// empty rectangle gives an arbitrary valid window. If `hull` has points, only their convex hull must be contained.
    pub(super) fn place(self, shape: WindowShape, hull: &[Vec2]) -> Window {
        let roll = shape.roll();
        let still = Window { roll, ..Window::square(1.0) };
        if self.min.cmpgt(self.max).any() {
            return still;
        }
        let half = 0.5 * (self.max - self.min);
        let middle = 0.5 * (self.min + self.max);
        let center = middle.x * roll + middle.y * roll.perp();
        // A sliver would waste the map's other side, and the precision of texels is limited.
        let roomy = |half: Vec2| {
            let no_sliver = half.max(Vec2::splat(half.max_element() / MAX_ASPECT));
            (1.005 * no_sliver).max(Vec2::splat(1e-6))
        };
        match shape {
            WindowShape::Square => Window { center, half_size: roomy(Vec2::splat(half.max_element())), ..still },
            WindowShape::Rolled(_) => Window { center, half_size: roomy(half), ..still },
            WindowShape::Warped { strength, .. } => {
                let warp = strength / half.x.max(1e-6);
                // Coordinates about the centre, along the roll and across: warped, and their divisor.
                let warped = |p: Vec2| {
                    let w = 1.0 + warp * p.x;
                    (p / w, w)
                };
                let corners =
                    [half, Vec2::new(-half.x, half.y), Vec2::new(half.x, -half.y), -half].map(|p| warped(p).0);
                let corners = Self::of(corners, Vec2::X);
                let hull: Vec<(Vec2, f32)> = hull
                    .iter()
                    .map(|p| warped(Vec2::new((p - center).dot(roll), (p - center).dot(roll.perp()))))
                    .collect();
                // A point at or behind the warp's horizon makes its hull unbounded.
                let is_bounded = !hull.is_empty() && hull.iter().all(|(_, w)| *w > 1e-3);
                let needed = if is_bounded {
                    corners.intersection(Self::of(hull.into_iter().map(|(p, _)| p), Vec2::X))
                } else {
                    corners
                };
                if needed.min.cmpgt(needed.max).any() {
                    return Window { center, half_size: roomy(half), ..still };
                }
                let middle = 0.5 * (needed.min + needed.max);
                Window {
                    center,
                    roll,
                    half_size: roomy(0.5 * (needed.max - needed.min)),
                    warp: warp * roll,
                    center_in_warp: middle.x * roll + middle.y * roll.perp(),
                }
            }
        }
    }
}
