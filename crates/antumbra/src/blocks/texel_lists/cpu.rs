//! The twin on the CPU: a rasteriser as WebGPU's, exact in its fixed point, and lists sorted as the GPU's.

use glam::{DVec3, Vec3};

use crate::blocks::light_view::LightView;

/// Triangles of one surface, for the twin.
pub(crate) struct TwinMesh<'a> {
    pub(crate) positions: &'a [Vec3],
    pub(crate) indices: &'a [u32],
    /// Counter-clockwise from outside: front faces are left out.
    pub(crate) closed: bool,
    pub(crate) opacity: f32,
}

/// A fragment of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TwinFragment {
    pub(crate) z_m: f32,
    pub(crate) opacity: f32,
}

/// Subpixels along a side of a texel, to which rasterisers snap vertices.
const SUBPIXELS: f64 = 256.0;

/// Every texel's list, row by row, sorted by depth and then by opacity.
pub(crate) fn lists(view: &LightView, map_size: u32, meshes: &[TwinMesh<'_>]) -> Vec<Vec<TwinFragment>> {
    let mut lists = vec![Vec::new(); (map_size * map_size) as usize];
    for mesh in meshes {
        for triangle in mesh.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|i| mesh.positions[triangle[i] as usize]);
            rasterise(view, map_size, corners, mesh.closed, |texel, z_m| {
                lists[texel].push(TwinFragment { z_m, opacity: mesh.opacity });
            });
        }
    }
    for list in &mut lists {
        list.sort_by(|a: &TwinFragment, b| a.z_m.total_cmp(&b.z_m).then(a.opacity.to_bits().cmp(&b.opacity.to_bits())));
    }
    lists
}

/// Calls `put` with each texel whose centre the triangle covers, and the depth along the axis there. The triangle lies
/// beyond the near plane.
fn rasterise(view: &LightView, map_size: u32, corners: [Vec3; 3], culls_front: bool, mut put: impl FnMut(usize, f32)) {
    let clip_from_world = view.clip_from_world();
    let half = 0.5 * f64::from(map_size);
    // (x, y) snapped, and what interpolates linearly in the picture: 1/z or z.
    let points = corners.map(|corner| {
        let clip = (clip_from_world * corner.extend(1.0)).as_dvec4();
        let z = f64::from((corner - view.frame.center).dot(view.frame.axis));
        let x = ((clip.x / clip.w + 1.0) * half * SUBPIXELS).round();
        let y = ((1.0 - clip.y / clip.w) * half * SUBPIXELS).round();
        DVec3::new(x, y, if view.perspective { 1.0 / z } else { z })
    });
    let edge = |a: DVec3, b: DVec3, p: (f64, f64)| (b.x - a.x) * (p.1 - a.y) - (b.y - a.y) * (p.0 - a.x);
    // y runs down: counter-clockwise in space is a negative area here.
    let area = edge(points[0], points[1], (points[2].x, points[2].y));
    if area == 0.0 || (culls_front && area < 0.0) {
        return;
    }
    let [a, b, c] = if area > 0.0 { points } else { [points[0], points[2], points[1]] };
    let area = area.abs();
    // Top and left edges own what lies on them.
    let owns = |a: DVec3, b: DVec3| (a.y == b.y && b.x > a.x) || b.y < a.y;
    let range = |low: f64, high: f64| {
        let first = (low / SUBPIXELS - 0.5).ceil().max(0.0) as u32;
        let end = ((high / SUBPIXELS - 0.5).floor() + 1.0).clamp(0.0, f64::from(map_size)) as u32;
        first..end
    };
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    for y in range(low.y, high.y) {
        for x in range(low.x, high.x) {
            let p = ((f64::from(x) + 0.5) * SUBPIXELS, (f64::from(y) + 0.5) * SUBPIXELS);
            let weights = [edge(b, c, p), edge(c, a, p), edge(a, b, p)];
            let own = [owns(b, c), owns(c, a), owns(a, b)];
            if weights.iter().zip(own).all(|(w, own)| *w > 0.0 || (*w == 0.0 && own)) {
                let value = (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) / area;
                let z = if view.perspective { 1.0 / value } else { value };
                put((y * map_size + x) as usize, z as f32);
            }
        }
    }
}
