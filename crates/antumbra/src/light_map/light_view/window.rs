//! A view's window in the light plane, and what it may be.

use glam::Vec2;

/// A rectangular window is no longer than so many times its width.
const MAX_ASPECT: f32 = 16.0;

/// A view's window in the light plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Its centre in light-plane coordinates; of a warped window, where the warp leaves coordinates as they are.
    pub(crate) center: Vec2,
    /// The direction of its first side in light-plane coordinates, unit.
    pub(crate) roll: Vec2,
    /// Half its sides, after the warp.
    pub(crate) half_size: Vec2,
    /// What divides coordinates about `center` grows by this; along `roll`, and zero for windows without a warp.
    pub(crate) warp: Vec2,
    /// Its centre after the warp, relative to `center`.
    pub(crate) center_in_warp: Vec2,
}

/// What a window may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum WindowShape {
    /// A square along the light's right and up, for kernels that lie along them.
    Square,
    /// A rectangle whose first side lies along this unit vector, for maps that are only compared with.
    Rolled(Vec2),
    /// A trapezoid whose texels widen along this unit vector, by the factor `(1 + strength) / (1 − strength)` across
    /// it and by the square of that along it, for maps that are only compared with. Strengths are below 1.
    Warped {
        /// The direction.
        along: Vec2,
        /// How much.
        strength: f32,
    },
}

impl Window {
    /// A square about the axis, along the light's right and up.
    pub(crate) fn square(half_size: f32) -> Self {
        Self {
            center: Vec2::ZERO,
            roll: Vec2::X,
            half_size: Vec2::splat(half_size),
            warp: Vec2::ZERO,
            center_in_warp: Vec2::ZERO,
        }
    }

    /// The least divisor in the window: what warped depths are largest by.
    pub(super) fn least_divisor(&self) -> f64 {
        let farthest = self.warp.dot(self.center_in_warp) - (self.half_size * self.warp.dot(self.roll)).x.abs();
        1.0 / (1.0 - f64::from(farthest))
    }
}

impl WindowShape {
    /// The direction of its first side.
    pub(super) fn roll(self) -> Vec2 {
        match self {
            Self::Square => Vec2::X,
            Self::Rolled(roll) => roll,
            Self::Warped { along, .. } => along,
        }
    }
}

/// A rectangle in the light plane, its coordinates along `roll` and across; empty where `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaneWindow {
    pub(super) min: Vec2,
    pub(super) max: Vec2,
    roll: Vec2,
}

impl PlaneWindow {
    const EMPTY: Self = Self { min: Vec2::INFINITY, max: Vec2::NEG_INFINITY, roll: Vec2::X };

    /// The smallest around some points in light-plane coordinates.
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

    /// A window of a shape that holds this one, a little more than it so that edges have texels on both sides; something
    /// harmless where this one is empty. Where `hull` holds points, what lies outside their convex hull is not needed.
    pub(super) fn place(self, shape: WindowShape, hull: &[Vec2]) -> Window {
        let roll = shape.roll();
        let still = Window { roll, ..Window::square(1.0) };
        if self.min.cmpgt(self.max).any() {
            return still;
        }
        let half = 0.5 * (self.max - self.min);
        let middle = 0.5 * (self.min + self.max);
        let center = middle.x * roll + middle.y * roll.perp();
        // A sliver would waste the map's other side, and texels have bounds to their precision.
        let roomy = |half: Vec2| {
            let no_sliver = half.max(Vec2::splat(half.max_element() / MAX_ASPECT));
            (1.005 * no_sliver).max(Vec2::splat(1e-6))
        };
        match shape {
            WindowShape::Square => Window { center, half_size: roomy(Vec2::splat(half.max_element())), ..still },
            WindowShape::Rolled(_) => Window { center, half_size: roomy(half), ..still },
            WindowShape::Warped { strength, .. } => {
                let warp = strength / half.x.max(1e-6);
                // About the centre, along the roll and across: warped, and what it was divided by.
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
