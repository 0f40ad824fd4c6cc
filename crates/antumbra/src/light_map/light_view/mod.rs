//! View from the light: the mapping from the world to a light map's texels, and the fitted frustum.
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
//! so that a plane in the world is a plane in (uv, depth). The receiver-plane comparison depends on this.
//!
//! # Warped windows
//! A map used only in depth comparisons may spend its texels where the camera looks. Its plane coordinates about the
//! window's centre `c` are divided, and depth with them:
//!
//! ```text
//! w = 1 + warp · (plane − c),   q = (plane − c) / w,   uv = uv_origin + uv_from_plane · q,   depth / w
//! ```
//!
//! Since `1/w = 1 − warp · q`, depth / w is affine in q, and everything above holds in q: the rasteriser's `w` is the
//! one of the view times this one, and triangles stay triangles. Texels are smallest where w is. This is the trapezoid
//! of Martin and Tan, "Anti-aliasing and Continuity with Trapezoidal Shadow Maps", EGSR 2004, for each light point;
//! its direction and strength minimise the receivers' texels instead of following a rule.

use antumbra_light::LightFrame;
use glam::{DMat4, DVec2, DVec4, Mat2, Mat4, UVec2, Vec2};

use crate::contract::DepthConvention;

mod best_window;
mod fit;
mod gpu_view;
mod hull;
#[cfg(test)]
mod tests;
mod window;

pub(crate) use fit::{FitTo, FollowedLight, HORIZON_TANGENT, MIDDLE_TANGENT, ViewFit};
pub(crate) use gpu_view::{LightViewGpu, light_view_of_matrix};
pub(crate) use window::{Window, WindowShape};

/// View from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightView {
    /// Axes and origin of light space.
    pub(crate) frame: LightFrame,
    /// Whether the view is perspective; otherwise it is orthographic along the axis.
    pub(crate) perspective: bool,
    /// Window in the light plane.
    pub(crate) window: Window,
    /// Depth of the near plane, metres along the axis.
    pub(crate) near_m: f32,
    /// Depth of the far plane, metres along the axis.
    pub(crate) far_m: f32,
    /// Depth beyond which the window contains the segments from its receivers to the whole light, metres; nearer casters may lie
    /// outside the window. 0 if the window contains all segments.
    pub(crate) complete_from_m: f32,
}

impl LightView {
    /// Returns the view with its texels shifted by a fraction of a texel, for a map of `map_size`; it contains the old window.
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

    /// `depth_scale` and `depth_offset` of the module's formula: reversed, 1 at the near plane, 0 at the far plane. In a warped
    /// window, 1 is the largest depth on the near plane.
    fn depth_coefficients(&self) -> (f32, f32) {
        let (scale, offset) = self.depth_coefficients_f64();
        (scale as f32, offset as f32)
    }

    fn depth_coefficients_f64(&self) -> (f64, f64) {
        let (n, f) = (f64::from(self.near_m), f64::from(self.far_m));
        let (scale, offset) =
            if self.perspective { (n * f / (f - n), -n / (f - n)) } else { (-1.0 / (f - n), f / (f - n)) };
        let least = self.window.min_divisor();
        (scale * least, offset * least)
    }

    /// Wider side of a texel in light-plane coordinates, for a map of `map_size` texels.
    pub(crate) fn texel_in_plane(&self, map_size: u32) -> f32 {
        debug_assert_eq!(self.window.warp, Vec2::ZERO, "texels of a warped window differ");
        2.0 * self.window.half_size.max_element() / map_size as f32
    }

    /// Depth change per texel on a surface that falls `slope` metres per metre across the light, as (a, b) of
    /// `a · depth + b`: |d depth/dZ| · slope · texel width, where depth = s/Z + c and the width is t Z, or depth = s Z + c
    /// and the width is t.
    pub(crate) fn depth_per_texel(&self, map_size: u32, slope: f32) -> (f32, f32) {
        let (scale, offset) = self.depth_coefficients();
        let step = slope * self.texel_in_plane(map_size);
        if self.perspective { (step, -offset * step) } else { (0.0, scale.abs() * step) }
    }

    /// Matrix on (x, y, depth, 1) that moves depth away from the light: Z by the factor `1 + bias` in perspective views, by
    /// `bias` metres in orthographic ones.
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

    /// Projection for the rasteriser, with reversed depth.
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
        // Rows of the window's own axes over its half sides, so that its edge is at 1.
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

    /// Shaders' form of the view, for a square map of `map_size`² texels.
    pub(crate) fn to_gpu(self, map_size: u32) -> LightViewGpu {
        self.to_gpu_of(UVec2::splat(map_size))
    }

    /// Shaders' form of the view, for a map of `map_size` texels.
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
        LightViewGpu { warp, plane_center: center, complete_from_m: self.complete_from_m, ..view }
    }
}
