//! Tests of triangle batches, of a triangle's planes over a box of light points against double precision, and of regions of
//! influence against closed forms. The rest is tested through the techniques.

use antumbra_light::{hash_u32, unit_f32};
use glam::{DVec3, Vec2, Vec3, Vec4};

use super::batches::{Surfaces, batches_of};
use crate::contract::{MeshCaster, Opacity, SurfaceCoverage};
use crate::gpu::{Bindings, Gpu, bindings, compute_pipeline};
use crate::shaders;
use crate::testing::{Case, RECTANGLE, gpu, read_storage};

#[test]
fn no_casters_make_one_empty_batch() {
    let batches = batches_of(&[], |_| false, 100, true);
    assert_eq!(batches.len(), 1);
    assert_eq!(batches[0].triangles(), 0);
}

#[test]
fn casters_that_hide_by_the_same_surface_share_a_batch() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let caster = || case.meshes[0].caster();
    let glass = |alpha, transmitted| MeshCaster {
        opacity: Opacity::Translucent { coverage: SurfaceCoverage::Alpha(alpha), transmitted, texture: None },
        ..caster()
    };
    let (gauze, red) = (|alpha| glass(alpha, Vec3::ZERO), || glass(0.5, Vec3::X));
    let casters = [gauze(0.5), caster(), gauze(0.25), red(), gauze(0.5), red()];
    let batches = batches_of(&casters, |_| false, 1000, true);
    let found: Vec<_> = (batches.iter())
        .map(|batch| (batch.surfaces, batch.runs.iter().map(|run| run.caster).collect::<Vec<_>>()))
        .collect();
    // Transmittances of several panes multiply, so each is a batch of its own.
    let want = [
        (Surfaces::Opaque, vec![1]),
        (Surfaces::Masked(0), vec![0, 4]),
        (Surfaces::Masked(2), vec![2]),
        (Surfaces::Tinted(3), vec![3]),
        (Surfaces::Tinted(5), vec![5]),
    ];
    assert_eq!(found, want);
}

/// Triangle as seen from the origin, and a box of light points about a centre.
#[derive(Clone, Copy, Debug)]
struct TriangleCase {
    corners: [Vec3; 3],
    is_closed: bool,
    inverse_end: f32,
    to_center: Vec3,
    middle: Vec3,
    half_box: Vec3,
}

impl TriangleCase {
    /// Returns a triangle about half way to a light 4 m away.
    fn random(i: u32, half_size_m: f32) -> Self {
        let random = |k: u32| 2.0 * unit_f32(hash_u32(i.wrapping_mul(193).wrapping_add(k * 7919))) - 1.0;
        let vector = |k: u32| Vec3::new(random(k), random(k + 1), random(k + 2));
        let to_center = Vec3::new(0.5, 4.0, -0.3) + 0.2 * vector(0);
        let corner = |k: u32| 0.5 * to_center + 1.5 * vector(k);
        Self {
            corners: [corner(3), corner(6), corner(9)],
            is_closed: i.is_multiple_of(4),
            inverse_end: 1.0,
            to_center,
            middle: half_size_m * vector(12),
            half_box: 0.5 * half_size_m * vector(15).abs(),
        }
    }

    fn packed(&self) -> [Vec4; 6] {
        let [a, b, c] = self.corners;
        [
            a.extend(f32::from(u8::from(self.is_closed))),
            b.extend(self.inverse_end),
            c.extend(0.0),
            self.to_center.extend(0.0),
            self.middle.extend(0.0),
            self.half_box.extend(0.0),
        ]
    }

    /// Returns the values of the edges' planes and the supporting plane at a light point, all positive if the triangle
    /// hides it, and the size of their terms.
    fn values(&self, point: DVec3) -> [(f64, f64); 4] {
        let [a, b, c] = self.corners.map(Vec3::as_dvec3);
        let d = self.to_center.as_dvec3() + point;
        let n = (b - a).cross(c - a);
        let side = self.height().signum();
        let edge = |p: DVec3, q: DVec3| {
            let normal = (p - q).cross(p + q);
            (side * normal.dot(d), normal.length() * d.length())
        };
        let support = side * (n.dot(d) - self.height() * f64::from(self.inverse_end));
        [edge(b, c), edge(c, a), edge(a, b), (support, n.length() * d.length())]
    }

    /// Returns the first corner's product with the triangle's normal, which is not normalised.
    fn height(&self) -> f64 {
        let [a, b, c] = self.corners.map(Vec3::as_dvec3);
        (b - a).cross(c - a).dot(a)
    }

    /// Returns the shader's `box_cover`: planes are affine, so that corners decide for the whole box. `None` where rounding decides.
    fn cover(&self) -> Option<u32> {
        // The segment leaves a closed mesh.
        if self.is_closed && self.height() > 0.0 {
            return Some(0);
        }
        let (mut least, mut most) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
        for corner in 0..8u32 {
            let sign = |axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let place = self.half_box.as_dvec3() * DVec3::new(sign(0), sign(1), sign(2));
            for (k, (value, scale)) in self.values(self.middle.as_dvec3() + place).into_iter().enumerate() {
                if value.abs() < 1e-5 * scale {
                    return None;
                }
                (least[k], most[k]) = (least[k].min(value), most[k].max(value));
            }
        }
        let is_beside = most.iter().any(|value| *value < 0.0);
        let is_inside = least.iter().all(|value| *value > 0.0);
        Some(if is_beside { 0 } else { 1 + u32::from(is_inside) })
    }
}

bindings! {
    struct TriangleProbe = "triangle probe", COMPUTE, group 0 of [LIGHT_BITS_TRIANGLE_PROBE] {
        0 cases: Storage,
        1 answers: ReadWrite,
    }
}

/// Returns a buffer of `count` vectors.
fn vectors(gpu: &Gpu, count: usize) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test triangles"),
        size: (size_of::<Vec4>() * count) as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Returns the shader's result for each case: (missed, cover, the supporting plane at the centre, its slack).
fn probe(gpu: &Gpu, cases: &[TriangleCase]) -> Vec<[f32; 4]> {
    let packed: Vec<Vec4> = cases.iter().flat_map(TriangleCase::packed).collect();
    let (input, output) = (vectors(gpu, packed.len()), vectors(gpu, cases.len()));
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(&packed));
    let layout = TriangleProbe::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test triangles", shaders::LIGHT_BITS_TRIANGLE_PROBE, &[&layout]);
    let group = TriangleProbe { cases: &input, answers: &output }.cached_group(gpu, &layout);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((cases.len() as u32).div_ceil(64), 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    read_storage(gpu, &output)
}

#[test]
fn boxes_of_light_points_are_covered_as_planes_say() {
    let Some(gpu) = gpu() else { return };
    let sizes = [0.02, 0.2, 0.8];
    let cases: Vec<_> = (0..6000).map(|i| TriangleCase::random(i, sizes[i as usize % 3])).collect();
    let mut counts = [0; 3];
    for (case, [missed, cover, ..]) in cases.iter().zip(probe(gpu, &cases)) {
        let Some(want) = case.cover() else { continue };
        assert_eq!(cover, want as f32, "{case:?}");
        assert!(missed == 0.0 || want == 0, "missed, but it hides some: {case:?}");
        counts[want as usize] += 1;
    }
    println!("none, some and all hidden: {counts:?}");
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
}

/// The terms of a plane through a small light almost cancel; what is left is rounding in proportion to each term, not to
/// the sum.
#[test]
fn planes_through_the_light_are_no_farther_off_than_their_slack() {
    let Some(gpu) = gpu() else { return };
    let cases: Vec<_> = (0..12_000)
        .map(|i| {
            let case = TriangleCase::random(i, 1e-5);
            let [a, b, _] = case.corners;
            let along = 0.5 + unit_f32(hash_u32(i ^ 0x51ac));
            // The third corner is in the plane of the other two and the light's centre.
            let corners = [a, b, a + along * (case.to_center - a) + 0.3 * (b - a)];
            TriangleCase { corners, is_closed: false, ..case }
        })
        // Slivers and triangles seen almost edge-on are excluded: their normal itself is rounding error.
        .filter(|case| {
            let [a, b, c] = case.corners;
            let n = (b - a).cross(c - a);
            n.length() > 0.5 * a.distance(b) * a.distance(c) && n.dot(a).abs() > 0.8 * n.length()
        })
        .collect();
    assert!(cases.len() > 500, "{} cases", cases.len());
    let mut worst = 0.0f64;
    for (case, [_, _, support, slack]) in cases.iter().zip(probe(gpu, &cases)) {
        let [_, _, _, (exact, _)] = case.values(case.middle.as_dvec3());
        // The shader's value is negative if the plane is within the segment.
        let off = (f64::from(support) + exact).abs();
        worst = worst.max(off / f64::from(slack));
        assert!(off <= f64::from(slack), "off by {off}, slack {slack}: {case:?}");
        // The ray tracer's 2⁻²⁰ of the height; the light's own terms are as small.
        let height = case.height().abs();
        assert!(f64::from(slack) <= 1.1 * height / 1_048_576.0, "slack {slack}, height {height}: {case:?}");
    }
    println!("{} planes, the worst is off by {worst:.3} of its slack", cases.len());
    assert!(worst > 0.02, "nothing is rounded");
}

/// Input of a region of influence.
#[derive(Clone, Copy, Debug)]
struct RegionCase {
    /// Centres of the corners' boxes, which are a texel wide.
    corners_texels: [Vec2; 3],
    /// Ends of the window, as directions.
    low: Vec2,
    high: Vec2,
    depth_m: f32,
    ray_offset: f32,
    is_sun: bool,
    /// A corner and the normal of a triangle of a closed mesh.
    corner: Vec3,
    normal: Vec3,
    /// Position whose shadow along the direction is computed, and the depth of the shadow.
    place: Vec3,
    shadow_depth_m: f32,
    direction: Vec3,
}

const WINDOW_SIDE: f32 = 64.0;

const REGION: RegionCase = RegionCase {
    corners_texels: [Vec2::ZERO, Vec2::new(10.0, 0.0), Vec2::new(0.0, 10.0)],
    low: Vec2::splat(-0.5),
    high: Vec2::splat(0.5),
    depth_m: 4.0,
    ray_offset: 0.0,
    is_sun: false,
    corner: Vec3::new(0.1, 0.2, 2.0),
    normal: Vec3::new(0.3, -0.2, 1.0),
    place: Vec3::new(1.0, 2.0, 3.0),
    shadow_depth_m: 7.0,
    direction: Vec3::new(0.3, -0.2, -0.5),
};

impl RegionCase {
    fn packed(&self) -> [Vec4; 9] {
        let [a, b, c] = self.corners_texels.map(|at| {
            let [low, high] = [at - 0.5, at + 0.5];
            Vec4::new(low.x, low.y, high.x, high.y)
        });
        [
            a,
            b,
            c,
            Vec4::new(self.low.x, self.low.y, self.high.x, self.high.y),
            Vec4::new(WINDOW_SIDE, self.depth_m, self.ray_offset, f32::from(u8::from(self.is_sun))),
            self.corner.extend(1.0),
            self.normal.extend(0.0),
            self.place.extend(self.shadow_depth_m),
            self.direction.extend(0.0),
        ]
    }
}

bindings! {
    struct RegionProbe = "region probe", COMPUTE, group 0 of [RASTER_PROBE] {
        0 cases: Storage,
        1 answers: ReadWrite,
    }
}

/// Result of the shader for a case.
#[derive(Debug)]
struct ProbedRegion {
    six_vertices: [Vec2; 6],
    texels_per_direction: Vec2,
    cut: Vec3,
    shadow: Vec2,
}

fn probe_region(gpu: &Gpu, case: &RegionCase) -> ProbedRegion {
    let packed = case.packed();
    let (input, output) = (vectors(gpu, packed.len()), vectors(gpu, 6));
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(&packed));
    let layout = RegionProbe::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test regions", shaders::RASTER_PROBE, &[&layout]);
    let group = RegionProbe { cases: &input, answers: &output }.cached_group(gpu, &layout);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    let answers: Vec<[Vec2; 2]> = read_storage(gpu, &output);
    let other = |i: usize| answers[i][1];
    ProbedRegion {
        six_vertices: std::array::from_fn(|i| answers[i][0]),
        texels_per_direction: other(0),
        cut: other(1).extend(other(2).x),
        shadow: other(3),
    }
}

/// Figure 4 of the 2008 paper, case by case, for a triangle with edges along the axes. For a normal along an axis, the corner
/// that the edge continues to counts.
#[test]
fn six_vertices_are_figure_4_s() {
    let Some(gpu) = gpu() else { return };
    let at = Vec2::new(4.0, 4.0);
    // Two corners, two, and three without the middle one.
    let expected = |legs: f32| {
        let slanted = std::f32::consts::SQRT_2 * Vec2::new(-1.0, 1.0);
        let [right, up] = [at + Vec2::new(legs, 0.0), at + Vec2::new(0.0, legs)];
        [
            at + Vec2::new(-0.5, -0.5),
            at + Vec2::new(0.5, -0.5),
            right + Vec2::new(0.5, -0.5),
            right + Vec2::new(0.5, 0.5),
            up + 0.5 * (Vec2::ONE + slanted),
            up + Vec2::new(-0.5, 0.5),
        ]
    };
    let of = |legs: f32| {
        let corners_texels = [at, at + Vec2::new(legs, 0.0), at + Vec2::new(0.0, legs)];
        probe_region(gpu, &RegionCase { corners_texels, ..REGION }).six_vertices
    };
    // Edges have a direction down to a 256th of a texel.
    for legs in [10.0, 1.0, 0.006] {
        for (got, want) in of(legs).into_iter().zip(expected(legs)) {
            assert!(got.distance(want) < 1e-3, "legs of {legs}: {:?}, figure 4 has {:?}", of(legs), expected(legs));
        }
    }
    // For shorter edges the boxes are merged.
    let [low, high] = [at - 0.5, at + 0.503];
    let of_box = [high, Vec2::new(low.x, high.y), low, Vec2::new(high.x, low.y)];
    let tiny = of(0.003);
    for (i, got) in tiny.into_iter().enumerate() {
        assert!(got.distance(of_box[i.min(3)]) < 1e-5, "{tiny:?}, a box has {of_box:?}");
    }
}

/// A sun's shadow continues along its direction.
#[test]
fn a_sun_s_shadow_is_the_place_carried_along() {
    let Some(gpu) = gpu() else { return };
    let RegionCase { place, shadow_depth_m, direction, .. } = REGION;
    let want = place + (shadow_depth_m - place.z) / direction.z * direction;
    let got = probe_region(gpu, &REGION).shadow;
    assert!(got.distance(want.truncate()) < 1e-5, "{got}, carried along {want}");
}

/// A window has a size even if all receivers are in one direction, or in a row: a ten-thousandth of their distance from its
/// centre.
#[test]
fn a_window_of_one_receiver_has_a_size() {
    let Some(gpu) = gpu() else { return };
    for reach in [0.25, 3.0] {
        let (low, high) = (Vec2::new(-reach, 0.1), Vec2::new(-reach, 0.2));
        let got = probe_region(gpu, &RegionCase { low, high, ..REGION }).texels_per_direction;
        let want = WINDOW_SIDE / Vec2::new(1e-4 * reach, 0.1);
        assert!((got / want - 1.0).abs().max_element() < 1e-5, "reach {reach}: {got}, not {want}");
    }
}

/// The cut leaves a margin for the ray offset, a direction, on both sides of the triangle's plane: its size at the farthest
/// receiver, along the normal; under a sun directions are positions.
#[test]
fn what_a_plane_cuts_off_leaves_room_for_the_ray_offset() {
    let Some(gpu) = gpu() else { return };
    let ray_offset = 0.01;
    for (is_sun, metres_per_direction) in [(false, REGION.depth_m), (true, 1.0)] {
        let of = |ray_offset: f32| probe_region(gpu, &RegionCase { is_sun, ray_offset, ..REGION }).cut;
        let room = of(ray_offset) - of(0.0);
        let want = Vec3::new(0.0, 0.0, 2.0 * ray_offset * metres_per_direction * REGION.normal.length());
        assert!(room.distance(want) < 1e-5, "sun {is_sun}: {room}, not {want}");
    }
}
