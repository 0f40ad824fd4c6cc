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

use antumbra_light::{Aabb, LightFrame};
use glam::{DMat4, DVec4, Mat2, Mat4, Vec2, Vec3};

use crate::contract::DepthConvention;
use crate::gpu::gpu_structs;

#[cfg(test)]
mod tests;

/// A view wider than this on one side (70 degrees off the axis) is cut: no planar map can hold a half-space, and the
/// texels that the last 20 degrees take are missed everywhere else (under a lamp in Sponza, `multi_view`'s rmse is .194
/// with a cut at 80 degrees and .175 at 70). Receivers beyond it are lit.
const MAX_TANGENT: f32 = 2.75;

/// The nearest depth a perspective view resolves, as a fraction of its farthest. With reversed 32-bit depth the
/// precision does not depend on it; it keeps the margin finite for lights that casters cross.
const MIN_NEAR_FRACTION: f32 = 1e-3;

/// A rectangular window is no longer than so many times its width.
const MAX_ASPECT: f32 = 16.0;

/// A view from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightView {
    /// Axes and origin.
    pub(crate) frame: LightFrame,
    /// Perspective, or orthographic along the axis.
    pub(crate) perspective: bool,
    /// Centre of the window in light-plane coordinates.
    pub(crate) center: Vec2,
    /// Half its sides.
    pub(crate) half_size: Vec2,
    /// The direction of the window's first side in light-plane coordinates, unit.
    pub(crate) roll: Vec2,
    /// Depth of the near plane, metres along the axis.
    pub(crate) near_m: f32,
    /// Depth of the far plane.
    pub(crate) far_m: f32,
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
}

impl LightView {
    /// A perspective view from `frame.center` that holds what matters of casters and receivers.
    ///
    /// Outside the casters' window nothing is occluded, and outside the receivers' nothing is asked; the window is
    /// where both meet, and the receivers' is widened by `margin_m`, the farthest that a light point lies from the
    /// origin, since the segments to it leave the receivers' window by as much as `margin_m · (1/near − 1/far)`.
    ///
    /// `reach_tangent` is the light's own frustum, where it has one: receivers outside it are not asked for either.
    pub(crate) fn fit_perspective(
        frame: LightFrame,
        margin_m: f32,
        reach_tangent: Option<f32>,
        fit: &FitTo<'_>,
    ) -> Self {
        let FitTo { casters, receivers, window } = *fit;
        let depth = |p: Vec3| (p - frame.center).dot(frame.axis);
        let (mut near, mut far) = (f32::INFINITY, 0.0f32);
        for corner in casters.iter().flat_map(Aabb::corners) {
            near = near.min(depth(corner));
            far = far.max(depth(corner));
        }
        far = receivers.iter().fold(far, |far, p| far.max(depth(*p)));
        // A light with nothing in front still has a view; its map stays empty.
        let far = if far > 0.0 { far * 1.001 } else { 1.0 };
        let near = (near * 0.999).clamp(far * MIN_NEAR_FRACTION, far * 0.99);

        let roll = window.roll();
        let casters = casters.iter().fold(PlaneWindow::EMPTY, |union, b| {
            union.union(PlaneWindow::of(tangents(&frame, &b.corners(), near), roll))
        });
        let asked = match receivers {
            [] => casters,
            _ => PlaneWindow::of(tangents(&frame, receivers, near), roll),
        };
        let reached = reach_tangent.map_or(asked, |t| {
            let corners = [Vec2::new(t, t), Vec2::new(-t, t), Vec2::new(t, -t), Vec2::new(-t, -t)];
            asked.intersection(PlaneWindow::of(corners, roll))
        });
        let margin = margin_m * (1.0 / near - 1.0 / far);
        let (center, half_size) = casters.intersection(reached.grown(margin)).sides(window);
        Self { frame, perspective: true, center, half_size, roll, near_m: near, far_m: far }
    }

    /// An orthographic view along the axis that holds what matters of casters and receivers. `margin` is the largest
    /// tangent between the axis and a direction of the light.
    pub(crate) fn fit_orthographic(frame: LightFrame, margin: f32, fit: &FitTo<'_>) -> Self {
        let FitTo { casters, receivers, window } = *fit;
        let seen = Aabb::of(receivers.iter().copied());
        let all = casters.iter().copied().fold(seen, Aabb::union);
        // The origin is the scene's centre, whatever the light's: small coordinates keep their bits.
        let origin = if all.is_empty() { frame.center } else { all.center() };
        let frame = LightFrame { center: origin, ..frame };
        let (mut near, mut far) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in all.corners().into_iter().filter(|_| !all.is_empty()) {
            let depth = (corner - origin).dot(frame.axis);
            near = near.min(depth);
            far = far.max(depth);
        }
        if near > far {
            (near, far) = (0.0, 1.0);
        }
        let pad = 1e-3 * (far - near).max(1e-3);
        let (near, far) = (near - pad, far + pad);
        let roll = window.roll();
        let of_points = |points: &[Vec3]| {
            let in_plane = |p: &Vec3| Vec2::new((p - origin).dot(frame.right), (p - origin).dot(frame.up));
            PlaneWindow::of(points.iter().map(in_plane), roll)
        };
        let casters = casters.iter().fold(PlaneWindow::EMPTY, |union, b| union.union(of_points(&b.corners())));
        let fitted = match receivers {
            [] => casters,
            _ => casters.intersection(of_points(receivers).grown(margin * (far - near))),
        };
        let (center, half_size) = fitted.sides(window);
        Self { frame, perspective: false, center, half_size, roll, near_m: near, far_m: far }
    }

    /// The roll that gives a rectangular window the shortest sides, by `fit`, which fits a window of a shape.
    pub(crate) fn best_roll(fit: impl Fn(WindowShape) -> Self) -> WindowShape {
        /// The last texels that a finer search finds are not worth its time.
        const ROLLS: u32 = 32;
        (0..ROLLS)
            .map(|i| WindowShape::Rolled(Vec2::from_angle(i as f32 * std::f32::consts::FRAC_PI_2 / ROLLS as f32)))
            .min_by(|a, b| {
                // The wider side of a texel blurs as much as the narrower helps: the sum, not the area.
                let sides = |shape: &WindowShape| fit(*shape).half_size.element_sum();
                sides(a).total_cmp(&sides(b))
            })
            .unwrap_or(WindowShape::Square)
    }

    /// `depth_scale` and `depth_offset` of the module's formula: reversed, 1 at the near plane, 0 at the far.
    fn depth_coefficients(&self) -> (f32, f32) {
        let (n, f) = (f64::from(self.near_m), f64::from(self.far_m));
        let (scale, offset) =
            if self.perspective { (n * f / (f - n), -n / (f - n)) } else { (-1.0 / (f - n), f / (f - n)) };
        (scale as f32, offset as f32)
    }

    /// The wider side of a texel in light-plane coordinates, for a map of `map_size` texels.
    pub(crate) fn texel_in_plane(&self, map_size: u32) -> f32 {
        2.0 * self.half_size.max_element() / map_size as f32
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
        // Rows of the window's own axes over its half sides: what is 1 at its edge.
        let (c, h, roll) = (self.center.as_dvec2(), self.half_size.as_dvec2(), self.roll.as_dvec2());
        let (across, along) = (roll / h.x, roll.perp() / h.y);
        let (n, f) = (f64::from(self.near_m), f64::from(self.far_m));
        let clip_from_light = if self.perspective {
            DMat4::from_cols(
                DVec4::new(across.x, along.x, 0.0, 0.0),
                DVec4::new(across.y, along.y, 0.0, 0.0),
                DVec4::new(-across.dot(c), -along.dot(c), -n / (f - n), 1.0),
                DVec4::new(0.0, 0.0, n * f / (f - n), 0.0),
            )
        } else {
            DMat4::from_cols(
                DVec4::new(across.x, along.x, 0.0, 0.0),
                DVec4::new(across.y, along.y, 0.0, 0.0),
                DVec4::new(0.0, 0.0, -1.0 / (f - n), 0.0),
                DVec4::new(-across.dot(c), -along.dot(c), f / (f - n), 1.0),
            )
        };
        clip_from_light * light_from_world
    }

    /// What the shaders need, for a square map of `map_size` texels.
    pub(crate) fn to_gpu(self, map_size: u32) -> LightViewGpu {
        let (depth_scale, depth_offset) = self.depth_coefficients();
        let scale = Vec2::new(0.5, -0.5) / self.half_size;
        let uv_from_plane = Mat2::from_diagonal(scale) * Mat2::from_cols(self.roll, self.roll.perp()).transpose();
        LightViewGpu::new(
            &self.frame,
            self.perspective,
            Vec2::splat(0.5) - uv_from_plane * self.center,
            uv_from_plane,
            (depth_scale, depth_offset),
            DepthConvention::Reversed,
            Vec2::splat(map_size as f32),
            (self.near_m, self.far_m),
        )
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
        /// The wider side of a texel in light-plane coordinates.
        texel_in_plane: f32,
        padding: f32,
    }
}

impl LightViewGpu {
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
            padding: 0.0,
        }
    }
}

impl WindowShape {
    fn roll(self) -> Vec2 {
        match self {
            Self::Square => Vec2::X,
            Self::Rolled(roll) => roll,
        }
    }
}

/// The tangents that span what lies beyond depth `near` of the convex hull of some points: those of the points there,
/// and of the places where the segments between them cross `near`.
fn tangents(frame: &LightFrame, points: &[Vec3], near: f32) -> Vec<Vec2> {
    let points: Vec<Vec3> = points
        .iter()
        .map(|point| {
            let p = point - frame.center;
            Vec3::new(p.dot(frame.right), p.dot(frame.up), p.dot(frame.axis))
        })
        .collect();
    let (beyond, before): (Vec<Vec3>, Vec<Vec3>) = points.into_iter().partition(|p| p.z >= near);
    let crossings = beyond.iter().flat_map(|p| before.iter().map(move |q| q.lerp(*p, (near - q.z) / (p.z - q.z))));
    let tangent = |p: Vec3| (p.truncate() / p.z).clamp(Vec2::splat(-MAX_TANGENT), Vec2::splat(MAX_TANGENT));
    beyond.iter().copied().chain(crossings).map(tangent).collect()
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

    /// Of two windows of one roll; an empty one has any.
    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max), roll: other.roll }
    }

    fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max), roll: other.roll }
    }

    fn grown(self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin, ..self }
    }

    /// Centre in light-plane coordinates, and half sides, of a shape that holds the window, a little more than it so
    /// that edges have texels on both sides; something harmless where the window is empty.
    fn sides(self, shape: WindowShape) -> (Vec2, Vec2) {
        if self.min.cmpgt(self.max).any() {
            return (Vec2::ZERO, Vec2::ONE);
        }
        let half = 0.5 * (self.max - self.min);
        let half = match shape {
            WindowShape::Square => Vec2::splat(half.max_element()),
            // A sliver would waste the map's other side, and texels have bounds to their precision.
            WindowShape::Rolled(_) => half.max(Vec2::splat(half.max_element() / MAX_ASPECT)),
        };
        let center = 0.5 * (self.min + self.max);
        (center.x * self.roll + center.y * self.roll.perp(), (1.005 * half).max(Vec2::splat(1e-6)))
    }
}
