//! Batches of triangles, and what a triangle's planes say of a box of light points, against double precision; the rest is
//! tested through the techniques.

use antumbra_light::{hash_u32, unit_f32};
use glam::{DVec3, Vec3, Vec4};

use super::batches::batches_of;
use crate::gpu::{Bindings, Gpu, bindings, compute_pipeline};
use crate::shaders;
use crate::testing::{gpu, read_storage};

#[test]
fn no_casters_make_one_empty_batch() {
    let batches = batches_of(&[], 100);
    assert_eq!(batches.len(), 1);
    assert_eq!(batches[0].triangles(), 0);
}

/// A triangle, seen from the origin, and a box of light points about a centre.
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
    /// A triangle about half way to a light 4 m away.
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

    /// The edges' planes and the supporting one at a light point, all positive where the triangle hides it, and how large
    /// their terms are.
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

    /// The first corner along the triangle's normal, which is as long as its edges make it.
    fn height(&self) -> f64 {
        let [a, b, c] = self.corners.map(Vec3::as_dvec3);
        (b - a).cross(c - a).dot(a)
    }

    /// As the shader's `box_cover`: planes are affine, so that corners tell of the whole box. `None` where rounding decides.
    fn cover(&self) -> Option<u32> {
        // Out of a closed mesh.
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
    struct TriangleProbe = "triangle probe", COMPUTE, group 0 of [VIEW_SAMPLES_TRIANGLE_PROBE] {
        0 cases: Storage,
        1 answers: ReadWrite,
    }
}

/// What the shader says of each: (missed, cover, the supporting plane at the middle, its slack).
fn probe(gpu: &Gpu, cases: &[TriangleCase]) -> Vec<[f32; 4]> {
    let packed: Vec<Vec4> = cases.iter().flat_map(TriangleCase::packed).collect();
    let buffer = |size: usize| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test triangles"),
            size: size as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let (input, output) = (buffer(size_of_val(&packed[..])), buffer(16 * cases.len()));
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(&packed));
    let layout = TriangleProbe::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test triangles", shaders::VIEW_SAMPLES_TRIANGLE_PROBE, &[&layout]);
    let group = TriangleProbe { cases: &input, answers: &output }.kept_group(gpu, &layout);
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

/// Of a plane through a small light its terms all but cancel, and what is left is rounding: of each term's size, not of the
/// sum's.
#[test]
fn planes_through_the_light_are_no_farther_off_than_their_slack() {
    let Some(gpu) = gpu() else { return };
    let cases: Vec<_> = (0..12_000)
        .map(|i| {
            let case = TriangleCase::random(i, 1e-5);
            let [a, b, _] = case.corners;
            let along = 0.5 + unit_f32(hash_u32(i ^ 0x51ac));
            // The third corner in the plane of two and the light's centre.
            let corners = [a, b, a + along * (case.to_center - a) + 0.3 * (b - a)];
            TriangleCase { corners, is_closed: false, ..case }
        })
        // No slivers, nor any seen all but edge-on: there the normal itself is rounding.
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
        // The shader's is negative where the plane lies within the segment.
        let off = (f64::from(support) + exact).abs();
        worst = worst.max(off / f64::from(slack));
        assert!(off <= f64::from(slack), "off by {off}, slack {slack}: {case:?}");
        // The ray tracer's 2⁻²⁰ of the height; the light's own terms are as small as it.
        let height = case.height().abs();
        assert!(f64::from(slack) <= 1.1 * height / 1_048_576.0, "slack {slack}, height {height}: {case:?}");
    }
    println!("{} planes, the worst is off by {worst:.3} of its slack", cases.len());
    assert!(worst > 0.02, "nothing is rounded");
}
