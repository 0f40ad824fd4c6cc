//! CPU reference: a rasteriser with WebGPU's rules, exact in fixed point, and lists sorted as on the GPU.

use glam::{DVec3, UVec2, Vec3};

use super::options::DepthTolerance;
use crate::light_map::light_view::LightView;

/// Triangles of one surface, for the CPU reference.
pub(crate) struct ReferenceMesh<'a> {
    pub(crate) positions: &'a [Vec3],
    pub(crate) indices: &'a [u32],
    /// Whether the mesh is closed, counter-clockwise from outside: front faces are then culled.
    pub(crate) closed: bool,
    pub(crate) opacity: f32,
}

/// Fragment with one channel of opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReferenceFragment {
    pub(crate) z_m: f32,
    pub(crate) opacity: f32,
    /// Overlap, as in `fragments.wesl`.
    pub(crate) overlap: f32,
}

/// Subpixels along a side of a texel, to which rasterisers snap vertices.
const SUBPIXELS: f64 = 256.0;

/// Sample positions in a texel, in subpixels: the centre, or the four positions that WebGPU fixes.
const ONE_SAMPLE: [(f64, f64); 1] = [(128.0, 128.0)];
const FOUR_SAMPLES: [(f64, f64); 4] = [(96.0, 32.0), (224.0, 96.0), (32.0, 160.0), (160.0, 224.0)];

/// Gathered fragment with the samples that it covers, one bit each.
#[derive(Clone, Copy, Debug)]
struct Gathered {
    fragment: ReferenceFragment,
    samples: u32,
}

/// Returns every texel's list, row by row, sorted by depth and then by opacity.
pub(crate) fn lists(view: &LightView, map_size: UVec2, meshes: &[ReferenceMesh<'_>]) -> Vec<Vec<ReferenceFragment>> {
    gathered(view, map_size, &ONE_SAMPLE, meshes)
        .into_iter()
        .map(|list| list.into_iter().map(|gathered| gathered.fragment).collect())
        .collect()
}

/// [`lists`] with four samples per texel: opacities are scaled by coverage, and fragments within `adjoin` in depth are merged.
pub(crate) fn covered_lists(
    view: &LightView,
    map_size: UVec2,
    meshes: &[ReferenceMesh<'_>],
    adjoin: DepthTolerance,
) -> Vec<Vec<ReferenceFragment>> {
    gathered(view, map_size, &FOUR_SAMPLES, meshes).iter().map(|list| covered(list, adjoin)).collect()
}

/// Merges fragments that are near in depth: each sample takes the opacity of its nearest fragment.
fn covered(mut list: &[Gathered], adjoin: DepthTolerance) -> Vec<ReferenceFragment> {
    let mut covered: Vec<ReferenceFragment> = Vec::new();
    let mut samples_covered = 0;
    while let Some((first, mut rest)) = list.split_first() {
        let limit = first.fragment.z_m + adjoin.slope * first.fragment.z_m + adjoin.m;
        let mut samples = 0;
        let (mut z_sum, mut opacity, mut count) = (0.0, 0.0, 0.0);
        let mut take = |gathered: &Gathered| {
            let share = (gathered.samples & !samples).count_ones() as f32;
            z_sum += share * gathered.fragment.z_m;
            opacity += share * gathered.fragment.opacity;
            count += share;
            samples |= gathered.samples;
            samples
        };
        let mut taken = take(first);
        while let Some((next, after)) = rest.split_first().filter(|(next, _)| taken != 15 && next.fragment.z_m <= limit)
        {
            taken = take(next);
            rest = after;
        }
        let overlap = match samples_covered {
            0 => 1.0,
            _ => {
                4.0 * ((taken & samples_covered).count_ones() as f32)
                    / (taken.count_ones() * u32::count_ones(samples_covered)) as f32
            }
        };
        samples_covered |= taken;
        covered.push(ReferenceFragment { z_m: z_sum / count, opacity: 0.25 * opacity, overlap });
        list = rest;
    }
    covered.sort_by(|a, b| a.z_m.total_cmp(&b.z_m));
    covered
}

fn gathered(
    view: &LightView,
    map_size: UVec2,
    samples: &[(f64, f64)],
    meshes: &[ReferenceMesh<'_>],
) -> Vec<Vec<Gathered>> {
    let mut lists = vec![Vec::new(); map_size.element_product() as usize];
    for mesh in meshes {
        for triangle in mesh.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|i| mesh.positions[triangle[i] as usize]);
            rasterise(view, map_size, samples, corners, mesh.closed, |texel, z_m, samples| {
                lists[texel].push(Gathered {
                    fragment: ReferenceFragment { z_m, opacity: mesh.opacity, overlap: 1.0 },
                    samples,
                });
            });
        }
    }
    for list in &mut lists {
        let key = |gathered: &Gathered| (gathered.fragment.z_m, gathered.fragment.opacity.to_bits(), gathered.samples);
        list.sort_by(|a: &Gathered, b| key(a).partial_cmp(&key(b)).expect("depths are numbers"));
    }
    lists
}

/// Calls `put` for each texel of which the triangle covers a sample, with the axis depth of the triangle's plane at the texel's
/// centre, clamped to the triangle's own depths, and the covered samples. The triangle must lie beyond the near plane.
fn rasterise(
    view: &LightView,
    map_size: UVec2,
    samples: &[(f64, f64)],
    corners: [Vec3; 3],
    culls_front: bool,
    mut put: impl FnMut(usize, f32, u32),
) {
    let clip_from_world = view.clip_from_world();
    let half = 0.5 * map_size.as_dvec2();
    // Snapped (x, y), and the quantity that is linear in the image: 1/z or z.
    let points = corners.map(|corner| {
        let clip = (clip_from_world * corner.extend(1.0)).as_dvec4();
        let z = f64::from((corner - view.frame.center).dot(view.frame.axis));
        let x = ((clip.x / clip.w + 1.0) * half.x * SUBPIXELS).round();
        let y = ((1.0 - clip.y / clip.w) * half.y * SUBPIXELS).round();
        DVec3::new(x, y, if view.perspective { 1.0 / z } else { z })
    });
    let depths = corners.map(|corner| f64::from((corner - view.frame.center).dot(view.frame.axis)));
    let nearest = depths.into_iter().fold(f64::INFINITY, f64::min);
    let farthest = depths.into_iter().fold(f64::NEG_INFINITY, f64::max);
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
    let range = |low: f64, high: f64, texels: u32| {
        let first = (low / SUBPIXELS).floor().max(0.0) as u32;
        let end = ((high / SUBPIXELS).floor() + 1.0).clamp(0.0, f64::from(texels)) as u32;
        first..end
    };
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    for y in range(low.y, high.y, map_size.y) {
        for x in range(low.x, high.x, map_size.x) {
            let at = |(in_x, in_y): (f64, f64)| {
                let p = (f64::from(x) * SUBPIXELS + in_x, f64::from(y) * SUBPIXELS + in_y);
                [edge(b, c, p), edge(c, a, p), edge(a, b, p)]
            };
            let own = [owns(b, c), owns(c, a), owns(a, b)];
            let is_covered =
                |sample: &(f64, f64)| at(*sample).iter().zip(own).all(|(w, own)| *w > 0.0 || (*w == 0.0 && own));
            let mask = (0..).zip(samples).fold(0, |mask, (i, sample)| mask | u32::from(is_covered(sample)) << i);
            if mask != 0 {
                let weights = at(ONE_SAMPLE[0]);
                let value = (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) / area;
                let z = if view.perspective { 1.0 / value } else { value };
                put((y * map_size.x + x) as usize, z.clamp(nearest, farthest) as f32, mask);
            }
        }
    }
}
