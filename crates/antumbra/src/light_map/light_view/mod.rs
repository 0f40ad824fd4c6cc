//! A view from the light: where a light map's texels lie in the world, and the frustum that fits what matters.
//!
//! Light space is the light's (right, up, axis) about the view's origin: a point `x` has `P = (X, Y, Z)` with
//! `Z` the depth along the axis. The *light plane* coordinates of `P` are its tangents `(X/Z, Y/Z)` for a perspective
//! view, its metres `(X, Y)` for an orthographic one. Everything a light map does is affine in them:
//!
//! ```text
//! uv    = uv_origin + uv_from_plane · plane
//! depth = depth_scale / Z + depth_offset      (perspective)
//! depth = depth_scale · Z + depth_offset      (orthographic)
//! ```
//!
//! so that a plane in the world is a plane in (uv, depth), which is what the receiver-plane comparison rests on.
//!
//! # Warped windows
//! A map that is only compared with may spend its texels where the camera looks. Its plane coordinates are divided
//! about the window's centre `c`, and depth with them:
//!
//! ```text
//! w = 1 + warp · (plane − c),   q = (plane − c) / w,   uv = uv_origin + uv_from_plane · q,   depth / w
//! ```
//!
//! Since `1/w = 1 − warp · q`, depth / w is affine in q, and everything above holds in q: the rasteriser's `w` is the
//! one of the view times this one, and triangles stay triangles. Texels are smallest where w is. This is the trapezoid
//! of Martin and Tan, "Anti-aliasing and Continuity with Trapezoidal Shadow Maps", EGSR 2004, about each light point;
//! with its direction and strength found by the receivers' texels rather than by a rule.

use antumbra_light::{Aabb, LightFrame};
use glam::{DMat4, DVec2, DVec4, Mat2, Mat4, UVec2, Vec2, Vec3};

use super::between::Between;
use crate::contract::{DepthConvention, DrawnMap, SeenPoint};
use crate::gpu::gpu_structs;

#[cfg(test)]
mod tests;

/// What one view holds off its axis where receivers lie all around it (70 degrees): the texels that the last 20 degrees
/// take are missed everywhere else (under a lamp in Sponza, `multi_view`'s rmse was .194 with all of 80 degrees in one view
/// and .175 of 70). What lies beyond has views of its own: `cover`.
pub(crate) const MIDDLE_TANGENT: f32 = 2.75;

/// A view is cut so far off its axis (89 degrees): no planar map can hold a half-space. Receivers beyond are lit.
pub(crate) const HORIZON_TANGENT: f32 = 64.0;

/// A window is widened by this factor at the most for the sake of segments that leave it, of receivers farthest off its axis:
/// its texels are missed in its middle. What shades those from so near to the light that it lies beyond, the map's edge stands
/// for.
const MOST_WIDENED: f32 = 1.15;

/// The nearest depth a perspective view resolves, as a fraction of its farthest. With reversed 32-bit depth the
/// precision does not depend on it; it keeps the margin finite for lights that casters cross.
const MIN_NEAR_FRACTION: f32 = 1e-3;

/// But a view resolves depths from here on, metres, however far it reaches.
const MOST_LEAST_NEAR_M: f32 = 0.05;

/// The widest texels of a warped window are at most so many octaves wider than the narrowest, across the warp; along it
/// twice as many.
const WARP_OCTAVES: u32 = 5;

/// A warp is taken where texels become smaller by this factor: texels of one size are worth something too.
const WARP_MUST_GAIN: f32 = 0.95;

/// A rectangular window is no longer than so many times its width.
const MAX_ASPECT: f32 = 16.0;

/// What of receivers' segments to the light a technique follows in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Followed {
    /// Those to all of it: they leave the window of the receivers farthest off its axis.
    All,
    /// Those to its middle, and what a kernel of fixed width takes for others.
    Middle,
}

/// A view from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightView {
    /// Axes and origin.
    pub(crate) frame: LightFrame,
    /// Perspective, or orthographic along the axis.
    pub(crate) perspective: bool,
    /// Where the window lies in the light plane.
    pub(crate) window: Window,
    /// Depth of the near plane, metres along the axis.
    pub(crate) near_m: f32,
    /// Depth of the far plane.
    pub(crate) far_m: f32,
    /// Depth from which on the window holds the segments from its receivers to all of the light; casters nearer than that may
    /// lie outside it. 0 where the window holds them all.
    pub(crate) held_from_m: f32,
}

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

/// What a view is fitted to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitTo<'a> {
    /// World-space boxes of what casts.
    pub(crate) casters: &'a [Aabb],
    /// World-space points whose convex hull holds what receives; none where that is unknown.
    pub(crate) receivers: &'a [Vec3],
    /// What the window may be.
    pub(crate) window: WindowShape,
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

/// Points summed side by side.
const LANES: usize = 8;

/// What is seen, as it lies in the light plane of views that share their frame: see [`ViewFit::in_plane`].
#[derive(Clone, Debug)]
pub(crate) struct SeenInPlane {
    x: Vec<[f32; LANES]>,
    y: Vec<[f32; LANES]>,
    /// Times the square of what a plane coordinate of 1 is there in metres; 0 where there is no point.
    weight: Vec<[f32; LANES]>,
}

impl LightView {
    /// The roll that gives a rectangular window the shortest sides, by `fit`, which fits a window of a shape.
    pub(crate) fn best_roll(fit: impl Fn(WindowShape) -> Self) -> WindowShape {
        /// The last texels that a finer search finds are not worth its time.
        const ROLLS: u32 = 32;
        (0..ROLLS)
            .map(|i| WindowShape::Rolled(Vec2::from_angle(i as f32 * std::f32::consts::FRAC_PI_2 / ROLLS as f32)))
            .min_by(|a, b| {
                // The wider side of a texel blurs as much as the narrower helps: the sum, not the area.
                let sides = |shape: &WindowShape| fit(*shape).window.half_size.element_sum();
                sides(a).total_cmp(&sides(b))
            })
            .unwrap_or(WindowShape::Square)
    }

    /// The window, rolled or warped, in which the texels that fall on `seen` are smallest in the world, by `fit`, which
    /// fits a window of a shape. What is least is the mean square of their widths over pixels: an edge is blurred over a
    /// band as wide as a texel, and the more where it is narrower than that. (On `checker-far`, 320 × 180, 64 views, the
    /// mean width gave rmse .038, its square .028, no warp .073.)
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
        // From coarse to fine: a turn all round, then the neighbourhood of the best, twice.
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

    /// The squared widths of the texels that fall on what is seen, both sides together, summed by weight: for a map of
    /// one texel, m².
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

    /// The view with its texels moved by a part of one, for a map of `map_size`; still holds what it held.
    pub(crate) fn shifted(self, texels: Vec2, map_size: u32) -> Self {
        let Window { roll, half_size, .. } = self.window;
        let step = 2.0 * half_size / map_size as f32 * texels;
        let step = step.x * roll + step.y * roll.perp();
        let half_size = half_size + half_size * texels.abs() * (2.0 / map_size as f32);
        let moved = if self.window.warp == Vec2::ZERO {
            Window { center: self.window.center + step, half_size, ..self.window }
        } else {
            Window { center_in_warp: self.window.center_in_warp + step, half_size, ..self.window }
        };
        Self { window: moved, ..self }
    }

    /// `depth_scale` and `depth_offset` of the module's formula: reversed, 1 at the near plane, 0 at the far; of a warped
    /// window 1 at the near plane's largest.
    fn depth_coefficients(&self) -> (f32, f32) {
        let (scale, offset) = self.depth_coefficients_f64();
        (scale as f32, offset as f32)
    }

    fn depth_coefficients_f64(&self) -> (f64, f64) {
        let (n, f) = (f64::from(self.near_m), f64::from(self.far_m));
        let (scale, offset) =
            if self.perspective { (n * f / (f - n), -n / (f - n)) } else { (-1.0 / (f - n), f / (f - n)) };
        let least = self.window.least_divisor();
        (scale * least, offset * least)
    }

    /// The wider side of a texel in light-plane coordinates, for a map of `map_size` texels.
    pub(crate) fn texel_in_plane(&self, map_size: u32) -> f32 {
        debug_assert_eq!(self.window.warp, Vec2::ZERO, "texels of a warped window differ");
        2.0 * self.window.half_size.max_element() / map_size as f32
    }

    /// How much depth changes over a texel of a surface that falls `slope` metres a metre across the light, as (a, b)
    /// of `a · depth + b`: |ds/dZ| · slope · texel width, where depth = s/Z + c and the width is t Z, or depth = s Z + c
    /// and the width is t.
    pub(crate) fn depth_per_texel(&self, map_size: u32, slope: f32) -> (f32, f32) {
        let (scale, offset) = self.depth_coefficients();
        let step = slope * self.texel_in_plane(map_size);
        if self.perspective { (step, -offset * step) } else { (0.0, scale.abs() * step) }
    }

    /// The matrix on (x, y, depth, 1) that moves depth away from the light: Z by the factor `1 + bias` where rays
    /// spread, by `bias` metres where they are parallel.
    pub(crate) fn depth_moved_away(&self, bias: f32) -> DMat4 {
        let (scale, offset) = self.depth_coefficients();
        let (scale, offset, bias) = (f64::from(scale), f64::from(offset), f64::from(bias));
        let (of_depth, constant) = if self.perspective {
            let shrink = 1.0 / (1.0 + bias);
            (shrink, offset * (1.0 - shrink))
        } else {
            (1.0, scale * bias)
        };
        DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::Z * of_depth, DVec4::new(0.0, 0.0, constant, 1.0))
    }

    /// The projection for the rasteriser, with reversed depth.
    pub(crate) fn clip_from_world(&self) -> Mat4 {
        self.clip_from_world_f64().as_mat4()
    }

    /// [`clip_from_world`](Self::clip_from_world) before rounding, for products with inverses.
    pub(crate) fn clip_from_world_f64(&self) -> DMat4 {
        let (r, u, a) = (self.frame.right.as_dvec3(), self.frame.up.as_dvec3(), self.frame.axis.as_dvec3());
        let o = self.frame.center.as_dvec3();
        let light_from_world = DMat4::from_cols(
            DVec4::new(r.x, u.x, a.x, 0.0),
            DVec4::new(r.y, u.y, a.y, 0.0),
            DVec4::new(r.z, u.z, a.z, 0.0),
            DVec4::new(-r.dot(o), -u.dot(o), -a.dot(o), 1.0),
        );
        // With P = (X, Y, Z) and h = Z (perspective) or 1: the divisor is D = h + warp · (XY − c h), the window's own
        // coordinates are (XY − c h) / D, and depth is (scale + offset Z) / D, or (scale Z + offset) / D.
        let Window { center, roll, half_size, warp, center_in_warp } = self.window;
        let (c, q, k) = (center.as_dvec2(), center_in_warp.as_dvec2(), warp.as_dvec2());
        let (roll, half) = (roll.as_dvec2(), half_size.as_dvec2());
        // Rows of the window's own axes over its half sides: what is 1 at its edge.
        let (across, along) = (roll / half.x, roll.perp() / half.y);
        let (scale, offset) = self.depth_coefficients_f64();
        let of_h = 1.0 - k.dot(c);
        let row = |axis: DVec2| {
            let from_divisor = axis.dot(q);
            (axis - k * from_divisor, -axis.dot(c) - of_h * from_divisor)
        };
        let ((x, x_h), (y, y_h)) = (row(across), row(along));
        let of_h = DVec4::new(x_h, y_h, 0.0, of_h);
        let of_xy = |i: usize| DVec4::new(x[i], y[i], 0.0, k[i]);
        let (of_z, constant) = if self.perspective {
            (of_h + DVec4::Z * offset, DVec4::Z * scale)
        } else {
            (DVec4::Z * scale, of_h + DVec4::Z * offset)
        };
        let clip_from_light = DMat4::from_cols(of_xy(0), of_xy(1), of_z, constant);
        clip_from_light * light_from_world
    }

    /// What the shaders need, for a square map of `map_size` texels.
    pub(crate) fn to_gpu(self, map_size: u32) -> LightViewGpu {
        self.to_gpu_of(UVec2::splat(map_size))
    }

    /// What the shaders need, for a map of `map_size` texels.
    pub(crate) fn to_gpu_of(self, map_size: UVec2) -> LightViewGpu {
        let (depth_scale, depth_offset) = self.depth_coefficients();
        let Window { center, roll, half_size, warp, center_in_warp } = self.window;
        let scale = Vec2::new(0.5, -0.5) / half_size;
        let uv_from_plane = Mat2::from_diagonal(scale) * Mat2::from_cols(roll, roll.perp()).transpose();
        // Without a warp, coordinates are the light plane's own.
        let (center, center_in_warp) =
            if warp == Vec2::ZERO { (Vec2::ZERO, center + center_in_warp) } else { (center, center_in_warp) };
        let view = LightViewGpu::new(
            &self.frame,
            self.perspective,
            Vec2::splat(0.5) - uv_from_plane * center_in_warp,
            uv_from_plane,
            (depth_scale, depth_offset),
            DepthConvention::Reversed,
            map_size.as_vec2(),
            (self.near_m, self.far_m),
        );
        LightViewGpu { warp, plane_center: center, held_from_m: self.held_from_m, ..view }
    }
}

/// What a view is fitted to, as it lies in the light plane: the same for every window that may be tried.
#[derive(Clone, Debug)]
pub(crate) struct ViewFit {
    frame: LightFrame,
    perspective: bool,
    near_m: f32,
    far_m: f32,
    held_from_m: f32,
    /// Points whose convex hull is that of what casts: of all its boxes' corners, or the hull's own corners.
    casters: Vec<Vec2>,
    /// Corners of the convex hull of what receives; `None` where that is unknown.
    receivers: Option<Vec<Vec2>>,
    /// How far segments to the light leave the receivers' window.
    margin: f32,
    /// The light's own frustum, where it has one: receivers outside it are not asked for.
    reach_tangent: Option<f32>,
}

impl ViewFit {
    /// For a perspective view from `frame.center` that holds what matters of casters and receivers.
    ///
    /// Outside the casters' window nothing is occluded, and outside the receivers' nothing is asked; the window is
    /// where both meet, and the receivers' is widened by `margin_m`, the farthest that a light point lies from the
    /// origin, since the segments to it leave the receivers' window by as much as `margin_m · (1/near − 1/far)`.
    ///
    /// `reach_tangent` is the light's own frustum, where it has one: receivers outside it are not asked for either.
    pub(crate) fn perspective(
        frame: LightFrame,
        followed: Followed,
        margin_m: f32,
        reach_tangent: Option<f32>,
        casters: &Between,
        receivers: &[Vec3],
    ) -> Self {
        let in_light = |point: Vec3| {
            let p = point - frame.center;
            Vec3::new(p.dot(frame.right), p.dot(frame.up), p.dot(frame.axis))
        };
        let boxes: Vec<[Vec3; 8]> = casters.all().map(|bounds| bounds.corners().map(in_light)).collect();
        let receivers: Vec<Vec3> = receivers.iter().copied().map(in_light).collect();
        let (mut near, mut far) = (f32::INFINITY, 0.0f32);
        for corner in boxes.iter().flatten() {
            near = near.min(corner.z);
            far = far.max(corner.z);
        }
        far = receivers.iter().fold(far, |far, p| far.max(p.z));
        // A light with nothing in front still has a view; its map stays empty.
        let far = if far > 0.0 { far * 1.001 } else { 1.0 };
        let near = (near * 0.999).clamp((far * MIN_NEAR_FRACTION).min(MOST_LEAST_NEAR_M), far * 0.99);
        let mut of_receivers = Vec::new();
        add_tangents(&mut of_receivers, &receivers, near, HORIZON_TANGENT);
        // Casters farther off than all receivers and what their segments leave the window by shade them only where they are
        // close to the light.
        let held_from_m = margin_depth(near, far, margin_m);
        let asked = of_receivers.iter().fold(0.0f32, |farthest, p| farthest.max(p.abs().max_element()));
        let needed = asked + margin_m * (1.0 / held_from_m - 1.0 / far);
        let (farthest, held_from_m) = match followed {
            Followed::Middle => (asked.max(MIDDLE_TANGENT), held_from_m),
            Followed::All => {
                let widest = MOST_WIDENED * asked.max(MIDDLE_TANGENT);
                let held_by_widest = margin_m / (widest - asked + margin_m / far);
                (needed.clamp(MIDDLE_TANGENT, widest), if needed > widest { held_by_widest } else { held_from_m })
            }
        };
        let mut of_casters = Vec::with_capacity(8 * boxes.len());
        for corners in &boxes {
            add_tangents(&mut of_casters, corners, near, farthest);
        }
        of_casters.retain(|p| p.is_finite());
        Self {
            frame,
            perspective: true,
            near_m: near,
            far_m: far,
            held_from_m: if held_from_m > near { held_from_m } else { 0.0 },
            casters: of_casters,
            receivers: (!receivers.is_empty()).then(|| convex_hull(of_receivers)),
            margin: margin_m * (1.0 / held_from_m - 1.0 / far),
            reach_tangent,
        }
    }

    /// For an orthographic view along the axis that holds what matters of casters and receivers. `margin` is the largest
    /// tangent between the axis and a direction of the light.
    ///
    /// Where casters may be anywhere, depth ends with what receives. Reversed, it is the finest there, however far before it casters
    /// begin: it takes the bits of a float from the far plane.
    pub(crate) fn orthographic(frame: LightFrame, margin: f32, casters: &Between, receivers: &[Vec3]) -> Self {
        let seen = Aabb::of(receivers.iter().copied());
        let is_by_receivers = casters.unknown.is_some() && !receivers.is_empty();
        let asked = if is_by_receivers { seen } else { casters.all().fold(seen, Aabb::union) };
        // The origin is their centre, whatever the light's: small coordinates keep their bits.
        let origin = if asked.is_empty() { frame.center } else { asked.center() };
        let frame = LightFrame { center: origin, ..frame };
        let depth = |x: &Vec3| (*x - origin).dot(frame.axis);
        let corners = asked.corners();
        let of_asked = if is_by_receivers { receivers } else { &corners[..] };
        let (near, far) = of_asked
            .iter()
            .map(depth)
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(near, far), depth| (near.min(depth), far.max(depth)));
        let (near, far) = if near.is_finite() && far.is_finite() { (near, far) } else { (0.0, 1.0) };
        let nearest_of = |bounds: Aabb| bounds.corners().iter().map(depth).fold(near, f32::min);
        let near_of_known = casters.known.iter().map(|bounds| nearest_of(*bounds)).fold(near, f32::min);
        let near = casters.unknown.map_or(near_of_known, |bounds| nearest_of(bounds).min(near_of_known));
        let pad = 1e-3 * (far - near_of_known).max(1e-3);
        let (near, near_of_known, far) = (near - pad, near_of_known - pad, far + pad);
        let in_plane = |p: &Vec3| Vec2::new((p - origin).dot(frame.right), (p - origin).dot(frame.up));
        let of_casters = casters.all().flat_map(|bounds| bounds.corners().map(|corner| in_plane(&corner)));
        let asked = PlaneWindow::of(receivers.iter().map(in_plane), Vec2::X);
        // Shadows of what is so far off that they blur over more than all that is asked for may be cut.
        let most = if receivers.is_empty() { f32::INFINITY } else { 0.5 * (asked.max - asked.min).max_element() };
        Self {
            frame,
            perspective: false,
            near_m: near,
            far_m: far,
            held_from_m: 0.0,
            casters: of_casters.filter(|p| p.is_finite()).collect(),
            receivers: (!receivers.is_empty()).then(|| convex_hull(receivers.iter().map(in_plane).collect())),
            // Unknown casters may stand anywhere; no window can hold all that they blur.
            margin: (margin * (far - near_of_known)).min(most),
            reach_tangent: None,
        }
    }

    /// The same from a depth on.
    pub(crate) fn beginning_at(self, near_m: f32) -> Self {
        Self { near_m: self.near_m.max(near_m), ..self }
    }

    /// The same, with less to look at in every window: worth its time where many are tried.
    pub(crate) fn for_many_windows(self) -> Self {
        Self { casters: convex_hull(self.casters), ..self }
    }

    /// What is seen in the plane of the fit's views.
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

    /// The view in a window of this shape.
    pub(crate) fn view(&self, window: WindowShape) -> LightView {
        let roll = window.roll();
        let casters = PlaneWindow::of(self.casters.iter().copied(), roll);
        let asked = self.receivers.as_ref().map(|points| PlaneWindow::of(points.iter().copied(), roll));
        let needed = if self.perspective {
            let asked = asked.unwrap_or(casters);
            let reached = self.reach_tangent.map_or(asked, |t| {
                let corners = [Vec2::new(t, t), Vec2::new(-t, t), Vec2::new(t, -t), Vec2::new(-t, -t)];
                asked.intersection(PlaneWindow::of(corners, roll))
            });
            casters.intersection(reached.grown(self.margin))
        } else {
            asked.map_or(casters, |asked| casters.intersection(asked.grown(self.margin)))
        };
        let hull = self.receivers.as_deref().filter(|_| self.margin == 0.0).unwrap_or_default();
        let window = needed.place(window, hull);
        let Self { frame, perspective, near_m, far_m, held_from_m, .. } = *self;
        LightView { frame, perspective, window, near_m, far_m, held_from_m }
    }
}

/// From which depth on casters are taken to leave the receivers' window. Where a caster's box holds the light, as a room's
/// does, nothing is known of how near its triangles are; a window that held all segments to the light's rim up to the near
/// plane would be hundreds of times as wide as what is asked for. What is nearer than the light is large is left to those
/// receivers before whose window it stands.
fn margin_depth(near: f32, far: f32, light_radius_m: f32) -> f32 {
    /// Of lights as large as the way to their receivers.
    const MOST_OF_FAR: f32 = 1.0 / 8.0;
    near.max(light_radius_m.min(MOST_OF_FAR * far))
}

/// Leaves out what lies inside the polygon of the points that are farthest along eight directions (Akl and Toussaint, "A
/// fast convex hull algorithm", 1978): most of many points, which then need no sorting.
fn leave_out_inner(points: &mut Vec<Vec2>) {
    /// Fewer are sorted as fast.
    const WORTH_IT: usize = 64;
    if points.len() < WORTH_IT {
        return;
    }
    let along = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (-1.0, 0.0), (-1.0, -1.0), (0.0, -1.0), (1.0, -1.0)];
    let mut farthest = [(f32::NEG_INFINITY, Vec2::ZERO); 8];
    for p in &*points {
        for ((x, y), (most, place)) in along.iter().zip(&mut farthest) {
            let reach = x * p.x + y * p.y;
            if reach > *most {
                (*most, *place) = (reach, *p);
            }
        }
    }
    let corners = farthest.map(|(_, place)| place);
    // Strictly inside every side, by more than rounding; sides of no length leave nothing out.
    let size = (farthest[0].0 + farthest[4].0).max(farthest[2].0 + farthest[6].0);
    let sides: Vec<(Vec2, Vec2)> = (0..8)
        .map(|i| (corners[i], corners[(i + 1) % 8] - corners[i]))
        .filter(|(_, side)| side.length_squared() > 0.0)
        .collect();
    points.retain(|p| !sides.iter().all(|(corner, side)| side.perp_dot(*p - *corner) > 1e-5 * size * side.length()));
}

/// The corners of the convex hull of some points, all round (Andrew's monotone chain, 1979); windows about the points are
/// those about the hull. Points that are no numbers are left out.
fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.retain(|p| p.is_finite());
    leave_out_inner(&mut points);
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns_left = |a: Vec2, b: Vec2, c: Vec2| {
        let [a, b, c] = [a, b, c].map(Vec2::as_dvec2);
        (b - a).perp_dot(c - a) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if turns_left(a, b, p) {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
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
    fn least_divisor(&self) -> f64 {
        let farthest = self.warp.dot(self.center_in_warp) - (self.half_size * self.warp.dot(self.roll)).x.abs();
        1.0 / (1.0 - f64::from(farthest))
    }
}

/// Derives the shaders' view from the matrix of a map that the host has rendered; see
/// [`DepthMapCaster`](crate::contract::DepthMapCaster) for what it may be. `None` where it is not such a matrix.
pub(crate) fn light_view_of_matrix(
    frame: LightFrame,
    perspective: bool,
    clip_from_world: Mat4,
    convention: DepthConvention,
    map_size: Vec2,
) -> Option<LightViewGpu> {
    // An orthographic map has no origin of its own: take the light's.
    let m = clip_from_world.as_dmat4();
    let o = frame.center.as_dvec3();
    let at = |right: f64, up: f64, depth: f64| {
        let p = o + frame.right.as_dvec3() * right + frame.up.as_dvec3() * up + frame.axis.as_dvec3() * depth;
        let clip = m * p.extend(1.0);
        (clip.truncate() / clip.w, clip.w)
    };
    let (ndc, w) = at(0.0, 0.0, 1.0);
    let (ndc_right, w_right) = at(1.0, 0.0, 1.0);
    let (ndc_up, w_up) = at(0.0, 1.0, 1.0);
    let (ndc_deep, w_deep) = at(0.0, 0.0, 2.0);
    let uv = |ndc: glam::DVec3| (ndc.truncate() * glam::DVec2::new(0.5, -0.5) + 0.5).as_vec2();
    let uv_from_plane = Mat2::from_cols(uv(ndc_right) - uv(ndc), uv(ndc_up) - uv(ndc));
    // depth(1) = s + c, depth(2) = s/2 + c, or 2s + c.
    let scale = if perspective { 2.0 * (ndc.z - ndc_deep.z) } else { ndc_deep.z - ndc.z };
    let offset = ndc.z - scale;
    // Centre and axis must project to one place at every depth, and w must be the depth (or constant) and the same
    // across the axis.
    let on_axis = (ndc.truncate() - ndc_deep.truncate()).length() < 1e-3
        && (w_right / w - 1.0).abs() < 1e-3
        && (w_up / w - 1.0).abs() < 1e-3;
    let w_fits = if perspective { (w_deep / w - 2.0).abs() < 1e-3 } else { (w_deep / w - 1.0).abs() < 1e-3 };
    let sane = uv_from_plane.determinant().abs() > 1e-12 && scale.abs() > 1e-12 && offset.is_finite();
    if !(on_axis && w_fits && sane) {
        return None;
    }
    // Depths at which the map's depth is 1 and 0; an infinite far plane gives an infinity, which is what it is.
    let depth_at = |d: f64| if perspective { scale / (d - offset) } else { (d - offset) / scale };
    let (a, b) = (depth_at(0.0), depth_at(1.0));
    let (near, far) = if convention == DepthConvention::Reversed { (b, a) } else { (a, b) };
    let far = if far.is_finite() && far > near { far } else { f64::from(f32::MAX) };
    Some(LightViewGpu::new(
        &frame,
        perspective,
        uv(ndc),
        uv_from_plane,
        (scale as f32, offset as f32),
        convention,
        map_size,
        (near as f32, far as f32),
    ))
}

gpu_structs! {
    /// A light map's place in the world, for the shaders; see the module's formulas.
    pub(crate) struct LightViewGpu {
        origin_in_world: Vec3,
        perspective: u32,
        right_in_world: Vec3,
        depth_scale: f32,
        up_in_world: Vec3,
        depth_offset: f32,
        axis_in_world: Vec3,
        /// +1 where nearer is larger, −1 where nearer is smaller.
        depth_sign: f32,
        /// Columns: light-plane right, up.
        uv_from_plane: [f32; 4],
        plane_from_uv: [f32; 4],
        uv_origin: Vec2,
        map_size: Vec2,
        near_m: f32,
        far_m: f32,
        /// The wider side of a texel in light-plane coordinates; of a warped window where its divisor is 1.
        texel_in_plane: f32,
        /// [`LightView::held_from_m`]; 0 where the window holds all.
        held_from_m: f32,
        /// Of a warped window: see the module. Zero for all others.
        warp: Vec2,
        /// Where a warped window's coordinates start; zero for all others.
        plane_center: Vec2,
    }
}

impl LightViewGpu {
    /// A map of this view, for whoever wants to look at it.
    pub(crate) fn drawn_map(&self, depth: &wgpu::TextureView, sample_count: u32, empty_depth: f32) -> DrawnMap {
        DrawnMap {
            depth: depth.clone(),
            size_px: self.map_size.as_uvec2(),
            sample_count,
            empty_depth,
            range_m: [self.near_m, self.far_m],
            is_perspective: self.perspective == 1,
            depth_scale: self.depth_scale,
            depth_offset: self.depth_offset,
            depth_warp: self.depth_warp(),
            light_point: None,
            layers_behind: Vec::new(),
            levels: Vec::new(),
        }
    }

    /// 1 / w of the module's formula over a warped window, affine in uv.
    fn depth_warp(&self) -> [f32; 3] {
        let [a, b, c, d] = self.plane_from_uv;
        let by_uv = -Vec2::new(self.warp.dot(Vec2::new(a, b)), self.warp.dot(Vec2::new(c, d)));
        [1.0 - by_uv.dot(self.uv_origin), by_uv.x, by_uv.y]
    }

    #[expect(clippy::too_many_arguments, reason = "the struct's members, in order")]
    fn new(
        frame: &LightFrame,
        perspective: bool,
        uv_origin: Vec2,
        uv_from_plane: Mat2,
        (depth_scale, depth_offset): (f32, f32),
        convention: DepthConvention,
        map_size: Vec2,
        (near_m, far_m): (f32, f32),
    ) -> Self {
        let plane_from_uv = uv_from_plane.inverse();
        let texel = Mat2::from_cols(plane_from_uv.x_axis / map_size.x, plane_from_uv.y_axis / map_size.y);
        Self {
            origin_in_world: frame.center,
            perspective: perspective.into(),
            right_in_world: frame.right,
            depth_scale,
            up_in_world: frame.up,
            depth_offset,
            axis_in_world: frame.axis,
            depth_sign: if convention == DepthConvention::Reversed { 1.0 } else { -1.0 },
            uv_from_plane: uv_from_plane.to_cols_array(),
            plane_from_uv: plane_from_uv.to_cols_array(),
            uv_origin,
            map_size,
            near_m,
            far_m,
            texel_in_plane: texel.x_axis.length().max(texel.y_axis.length()),
            held_from_m: 0.0,
            warp: Vec2::ZERO,
            plane_center: Vec2::ZERO,
        }
    }
}

impl WindowShape {
    fn roll(self) -> Vec2 {
        match self {
            Self::Square => Vec2::X,
            Self::Rolled(roll) => roll,
            Self::Warped { along, .. } => along,
        }
    }
}

/// Adds the tangents that span what lies beyond depth `near` of the convex hull of some points in light space: those of the
/// points there, and of the places where the segments between them cross `near`. None is larger than `most`.
fn add_tangents(tangents: &mut Vec<Vec2>, points: &[Vec3], near: f32, most: f32) {
    let tangent = |p: Vec3| (p.truncate() / p.z).clamp(Vec2::splat(-most), Vec2::splat(most));
    for p in points {
        if p.z >= near {
            tangents.push(tangent(*p));
        } else {
            let beyond = points.iter().filter(|q| q.z >= near);
            tangents.extend(beyond.map(|q| tangent(p.lerp(*q, (near - p.z) / (q.z - p.z)))));
        }
    }
}

/// A rectangle in the light plane, its coordinates along `roll` and across; empty where `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PlaneWindow {
    min: Vec2,
    max: Vec2,
    roll: Vec2,
}

impl PlaneWindow {
    const EMPTY: Self = Self { min: Vec2::INFINITY, max: Vec2::NEG_INFINITY, roll: Vec2::X };

    /// The smallest around some points in light-plane coordinates.
    fn of(points: impl IntoIterator<Item = Vec2>, roll: Vec2) -> Self {
        points.into_iter().fold(Self { roll, ..Self::EMPTY }, |window, p| {
            let along = Vec2::new(p.dot(roll), p.dot(roll.perp()));
            Self { min: window.min.min(along), max: window.max.max(along), roll }
        })
    }

    fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max), roll: other.roll }
    }

    fn grown(self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin, ..self }
    }

    /// A window of a shape that holds this one, a little more than it so that edges have texels on both sides; something
    /// harmless where this one is empty. Where `hull` holds points, what lies outside their convex hull is not needed.
    fn place(self, shape: WindowShape, hull: &[Vec2]) -> Window {
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
