//! Light view in the shaders' form, for maps rendered here and for a host's map, given its matrix.

use antumbra_light::LightFrame;
use glam::{Mat2, Mat4, Vec2, Vec3};

use crate::contract::{DepthConvention, DrawnMap};
use crate::gpu::gpu_structs;

/// Derives the shaders' view from the matrix of a map that the host has rendered; see
/// [`DepthMapCaster`](crate::contract::DepthMapCaster) for valid matrices. Returns `None` for others.
pub(crate) fn light_view_of_matrix(
    frame: LightFrame,
    perspective: bool,
    clip_from_world: Mat4,
    convention: DepthConvention,
    map_size: Vec2,
) -> Option<LightViewGpu> {
    // An orthographic map has no origin of its own: use the light's.
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
    // Distances at which the map's depth is 0 and 1; an infinite far plane gives infinity.
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
    /// Light view for the shaders; see the module's formulas.
    pub(crate) struct LightViewGpu {
        origin_in_world: Vec3,
        perspective: u32,
        right_in_world: Vec3,
        depth_scale: f32,
        up_in_world: Vec3,
        depth_offset: f32,
        axis_in_world: Vec3,
        /// +1 if nearer depths are larger, −1 if they are smaller.
        depth_sign: f32,
        /// Columns: light-plane right, up.
        uv_from_plane: [f32; 4],
        plane_from_uv: [f32; 4],
        uv_origin: Vec2,
        map_size: Vec2,
        near_m: f32,
        far_m: f32,
        /// Wider side of a texel in light-plane coordinates; in a warped window, where the divisor is 1.
        texel_in_plane: f32,
        /// [`LightView::complete_from_m`]; 0 if the window holds all.
        complete_from_m: f32,
        /// Warp of the window, see the module; zero if it is not warped.
        warp: Vec2,
        /// Light-plane origin of a warped window's coordinates; zero if it is not warped.
        plane_center: Vec2,
    }
}

impl LightViewGpu {
    /// Describes a map of this view, for inspection.
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

    /// Coefficients (constant, by u, by v) of the module's 1 / w, which is affine in uv.
    pub(super) fn depth_warp(&self) -> [f32; 3] {
        let [a, b, c, d] = self.plane_from_uv;
        let by_uv = -Vec2::new(self.warp.dot(Vec2::new(a, b)), self.warp.dot(Vec2::new(c, d)));
        [1.0 - by_uv.dot(self.uv_origin), by_uv.x, by_uv.y]
    }

    #[expect(clippy::too_many_arguments, reason = "the struct's members, in order")]
    pub(super) fn new(
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
            complete_from_m: 0.0,
            warp: Vec2::ZERO,
            plane_center: Vec2::ZERO,
        }
    }
}
