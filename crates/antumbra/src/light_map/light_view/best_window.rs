//! Search for the window in which texels on seen receivers are smallest.

use antumbra_light::LightFrame;
use glam::Vec2;

use super::{LightView, ViewFit, Window, WindowShape};
use crate::contract::SeenPoint;

/// Largest ratio of the widest to the narrowest texel of a warped window, in octaves across the warp; along the warp it is
/// twice as many.
const WARP_OCTAVES: u32 = 5;

/// Factor by which a warp must lower the cost to be used, since texels of equal size are an advantage, too.
const WARP_MUST_GAIN: f32 = 0.95;

/// Number of points summed in parallel.
const LANES: usize = 8;

/// Seen points in the light plane of views with the same frame; see [`ViewFit::in_plane`].
#[derive(Clone, Debug)]
pub(crate) struct SeenInPlane {
    x: Vec<[f32; LANES]>,
    y: Vec<[f32; LANES]>,
    /// Weight of the point, times the square of the metres per unit of plane coordinate there; 0 in unused lanes.
    weight: Vec<[f32; LANES]>,
}

impl LightView {
    /// Returns the roll that gives a rectangular window the shortest sides. `fit` fits a window of a given shape.
    pub(crate) fn best_roll(fit: impl Fn(WindowShape) -> Self) -> WindowShape {
        /// Number of rolls tried; a finer search gains too little for its time.
        const ROLLS: u32 = 32;
        (0..ROLLS)
            .map(|i| WindowShape::Rolled(Vec2::from_angle(i as f32 * std::f32::consts::FRAC_PI_2 / ROLLS as f32)))
            .min_by(|a, b| {
                // The sum, not the area: the wider side of a texel blurs as much as the narrower side sharpens.
                let sides = |shape: &WindowShape| fit(*shape).window.half_size.element_sum();
                sides(a).total_cmp(&sides(b))
            })
            .unwrap_or(WindowShape::Square)
    }

    /// Returns the window, rolled or warped, in which texels on `seen` are smallest in the world. `fit` fits a window of a
    /// given shape. The cost is the mean square of texel widths over pixels: an edge is blurred over a band as wide as a
    /// texel, and the more if it is narrower than that. (On `checker-far`, 320 × 180, 64 views, minimising the mean width
    /// gives rmse .038, the mean square .028, no warp .073.)
    pub(crate) fn best_window(seen: &SeenInPlane, fit: impl Fn(WindowShape) -> Self) -> WindowShape {
        let rolled = Self::best_roll(&fit);
        if seen.x.is_empty() {
            return rolled;
        }
        let width = |shape: WindowShape| fit(shape).square_texels_m2(seen);
        let warped = |turn: f32, ratio_log2: f32| {
            let ratio = ratio_log2.exp2();
            WindowShape::Warped { along: Vec2::from_angle(turn), strength: (ratio - 1.0) / (ratio + 1.0) }
        };
        let best = |candidates: &mut dyn Iterator<Item = (f32, f32)>| {
            candidates
                .map(|(turn, ratio_log2)| (width(warped(turn, ratio_log2)), turn, ratio_log2))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f32::INFINITY, 0.0, 0.0))
        };
        // From coarse to fine: a full turn, then the neighbourhood of the best, three times.
        const TURNS: u32 = 16;
        let turn_step = std::f32::consts::TAU / TURNS as f32;
        let mut found =
            best(&mut (0..TURNS).flat_map(|i| (1..=WARP_OCTAVES).map(move |j| (i as f32 * turn_step, j as f32))));
        for i in 1..=3 {
            let step = 0.5f32.powi(i);
            let (_, turn, ratio_log2) = found;
            let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x as f32 * step, y as f32 * step)));
            found = best(
                &mut around.map(|(x, y)| (turn + x * turn_step, (ratio_log2 + y).clamp(0.1, WARP_OCTAVES as f32))),
            );
        }
        if found.0 < WARP_MUST_GAIN * width(rolled) { warped(found.1, found.2) } else { rolled }
    }

    /// Weighted sum over `seen` of the squared widths of texels, both sides added, for a map of one texel; m².
    pub(crate) fn square_texels_m2(&self, seen: &SeenInPlane) -> f32 {
        let Window { center, roll, half_size, warp, .. } = self.window;
        // With plane coordinates p about the centre and w = 1 + warp · p, a step s in the window's own coordinates is
        // w (s + p (warp · s)) in the plane; the warp lies along the roll, so that across it the second part is 0.
        let step = 2.0 * half_size;
        let (along, bend) = (step.x * roll, warp.dot(roll) * step.x);
        let across = step.y * step.y;
        let mut sums = [0.0f32; LANES];
        let SeenInPlane { x, y, weight } = seen;
        for ((x, y), weight) in x.iter().zip(y).zip(weight) {
            for i in 0..LANES {
                let (px, py) = (x[i] - center.x, y[i] - center.y);
                let w = (1.0 + warp.x * px + warp.y * py).max(1e-3);
                let (sx, sy) = (along.x + px * bend, along.y + py * bend);
                sums[i] += weight[i] * (w * w * (sx * sx + sy * sy + across));
            }
        }
        sums.iter().sum()
    }
}

impl ViewFit {
    /// Projects seen points into the light plane of the fit's views.
    pub(crate) fn in_plane(&self, seen: &[SeenPoint]) -> SeenInPlane {
        let LightFrame { center, right, up, axis } = self.frame;
        let mut in_plane = SeenInPlane { x: Vec::new(), y: Vec::new(), weight: Vec::new() };
        for points in seen.chunks(LANES) {
            let (mut x, mut y, mut weight) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for (i, point) in points.iter().enumerate() {
                let p = point.pos_in_world - center;
                let z = if self.perspective { p.dot(axis).max(self.near_m) } else { 1.0 };
                (x[i], y[i], weight[i]) = (p.dot(right) / z, p.dot(up) / z, point.weight * z * z);
            }
            in_plane.x.push(x);
            in_plane.y.push(y);
            in_plane.weight.push(weight);
        }
        in_plane
    }
}
