//! CPU reference of `splat.wesl` and of `hides_nothing` in `surfels.wesl`: the same operations on 32-bit floats in the same order.

use glam::{Mat4, Vec2, Vec3Swizzles, Vec4, Vec4Swizzles};

use super::gpu_types::SplatBatch;

/// Batch of square maps, as depth bits; 0 in texels without a fragment.
#[derive(Debug)]
pub(crate) struct Targets {
    pub(crate) view_size: u32,
    pub(crate) texels: Vec<u32>,
}

/// Maximum texels of a surfel to each side, as in `splat.wesl`.
const MAX_TEXELS: f32 = 16.0;

/// Maximum difference of slopes within a flat piece, as in `surfels.wesl`.
const FLAT: f32 = 0.0625;

/// Square of the central image, and the plane that it lies in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surfel {
    pub(crate) pos: Vec2,
    pub(crate) depth: f32,
    /// Depth per central texel.
    pub(crate) gradient: Vec2,
    /// Half the square's side, central texels.
    pub(crate) reach: f32,
}

/// Surfels of 2 × 2 fragments: one if they are a flat piece, otherwise one for each; `widths` is a texel's width as a
/// difference in depth, (a, b) of a · depth + b.
pub(crate) fn surfels_of(quad: &[Surfel; 4], widths: (f32, f32)) -> Vec<Surfel> {
    let d = quad.map(|fragment| fragment.depth);
    let middle = 0.25 * ((d[0] + d[1]) + (d[2] + d[3]));
    let rise = 0.5 * Vec2::new((d[1] - d[0]) + (d[3] - d[2]), (d[2] - d[0]) + (d[3] - d[1]));
    let slack = FLAT * (widths.0 * middle + widths.1);
    let off = quad.iter().fold(((d[0] + d[3]) - (d[1] + d[2])).abs(), |off, fragment| {
        off.max((fragment.gradient - rise).abs().max_element())
    });
    if d.iter().all(|d| *d > 0.0) && off <= slack {
        return vec![Surfel { pos: quad[0].pos + 0.5, depth: middle, gradient: rise, reach: quad[0].reach + 0.5 }];
    }
    quad.iter().copied().filter(|fragment| fragment.depth > 0.0).collect()
}

/// Tolerance for receivers behind a plane, as in `surfels.wesl`.
const ROOM_TEXELS: f32 = 0.125;

/// Whether a surfel's plane has every receiver on the light's side.
pub(crate) fn hides_nothing(batch: &SplatBatch, surfel: &Surfel) -> bool {
    let Surfel { pos, depth, gradient: g, .. } = *surfel;
    let (reach, axis) = (Vec4::from(batch.light_reach), Vec4::from(batch.light_axis));
    let at_origin = depth - g.dot(pos);
    let on_axis = at_origin + g.dot(axis.xy()) - axis.z;
    let across = g.dot(reach.xy()).abs() + g.dot(reach.zw()).abs();
    let is_before = |corner: Vec4| {
        let behind = at_origin * corner.w + g.dot(corner.xy()) - corner.z;
        behind <= ROOM_TEXELS * (batch.width_of_depth * corner.z + batch.width * corner.w).max(0.0)
    };
    batch.has_receivers == 1
        && across + (on_axis * axis.w).abs() < 1.0
        && batch.receivers.iter().all(|corner| is_before((*corner).into()))
}

impl Targets {
    pub(crate) fn new(view_size: u32, map_count: u32) -> Self {
        Self { view_size, texels: vec![0; (view_size * view_size * map_count) as usize] }
    }

    /// Keeps the nearest depth: reversed depths are positive, and their bits have the same order.
    fn keep(&mut self, map: usize, x: f32, y: f32, depth: f32) {
        let size = self.view_size as usize;
        let texel = &mut self.texels[(map * size + y as usize) * size + x as usize];
        *texel = (*texel).max(depth.min(1.0).to_bits());
    }

    /// Stores a fragment in the texel that it falls in, of each target (its index, its matrix), if it is within `reach`
    /// texels of the texel's centre.
    pub(crate) fn scatter_point(
        &mut self,
        target_from_central: &[(usize, Mat4)],
        pos: Vec2,
        depth: f32,
        reach: Option<f32>,
    ) {
        let size = self.view_size as f32;
        for (map, m) in target_from_central {
            let h = project(m, pos, depth);
            let p = h.xyz() / h.w;
            let is_inside = p.x >= 0.0 && p.y >= 0.0 && p.x < size && p.y < size && p.z > 0.0;
            if h.w <= 0.0 || !is_inside {
                continue;
            }
            let off_centre = (p.xy() - p.xy().floor() - 0.5).abs().max_element();
            if reach.is_none_or(|reach| off_centre <= reach) {
                self.keep(*map, p.x.floor(), p.y.floor(), p.z);
            }
        }
    }

    /// Stores a surfel in every texel whose centre it covers.
    pub(crate) fn scatter_surfel(&mut self, target_from_central: &[(usize, Mat4)], surfel: &Surfel) {
        let Surfel { pos, depth, gradient, reach } = *surfel;
        let last = self.view_size as f32 - 1.0;
        for (map, m) in target_from_central {
            let h = project(m, pos, depth);
            if h.w <= 0.0 {
                continue;
            }
            let a = m.x_axis + m.z_axis * gradient.x;
            let b = m.y_axis + m.z_axis * gradient.y;
            let p = h.xy() / h.w;
            let half_extent =
                (((a.xy() - p * a.w).abs() + (b.xy() - p * b.w).abs()) * (reach / h.w)).min(Vec2::splat(MAX_TEXELS));
            let low = (p - half_extent - 0.5).ceil().max(Vec2::ZERO);
            let high = (p + half_extent - 0.5).floor().min(Vec2::splat(last));
            let mut y = low.y;
            while y <= high.y {
                let mut x = low.x;
                while x <= high.x {
                    let c = Vec2::new(x, y) + 0.5;
                    let (ac, bc, hc) = (a.xy() - c * a.w, b.xy() - c * b.w, c * h.w - h.xy());
                    let e =
                        Vec2::new(hc.x * bc.y - hc.y * bc.x, ac.x * hc.y - ac.y * hc.x) / (ac.x * bc.y - ac.y * bc.x);
                    let w = h.w + (a.w * e.x + b.w * e.y);
                    let z = (h.z + (a.z * e.x + b.z * e.y)) / w;
                    if e.x.abs() <= reach && e.y.abs() <= reach && w > 0.0 && z > 0.0 {
                        self.keep(*map, x, y, z);
                    }
                    x += 1.0;
                }
                y += 1.0;
            }
        }
    }
}

fn project(m: &Mat4, pos: Vec2, depth: f32) -> Vec4 {
    m.x_axis * pos.x + (m.y_axis * pos.y + (m.z_axis * depth + m.w_axis))
}
