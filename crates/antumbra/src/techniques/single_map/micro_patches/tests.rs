//! Tests of patches against rays in space.

use antumbra_light::{hash_u32, unit_f32};
use glam::{Vec2, Vec3};

use super::cpu::{Patch, Squares, hidden_point};
use crate::gpu::{Bindings, Gpu, bindings, compute_pipeline};
use crate::shaders;
use crate::testing::{gpu, read_storage};

/// Pseudorandom number in [0, 1).
fn random(i: u32, of: u32) -> f32 {
    unit_f32(hash_u32(i ^ hash_u32(of + 0x51ed)))
}

#[test]
fn the_reference_hides_what_lies_on_the_segment() {
    // Halfway up, an occluder hides the point that mirrors the receiver in it.
    let hidden = hidden_point(Vec3::new(0.5, 0.0, 4.0), Vec2::new(100.0, 0.0), 2.0, 100.0);
    assert!((hidden - Vec2::new(350.0, 0.0)).length() < 1e-3, "{hidden}");
}

bindings! {
    struct Probe = "patch probe", COMPUTE, group 0 of [MICRO_PATCHES_PROBE] {
        0 inputs: Storage,
        1 outputs: ReadWrite,
    }
}

/// `ProbedSquare` of the shader, as words.
type ProbedSquare = [f32; 16];

/// Patches of squares, computed by the shader: alone, joined, and the intersection of those at two depths.
fn probed(gpu: &Gpu, squares: &[ProbedSquare]) -> Vec<[Patch; 3]> {
    let buffer = |bytes: usize, usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test probe"),
            size: bytes as u64,
            usage: usage | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    };
    let input = buffer(size_of_val(squares), wgpu::BufferUsages::COPY_DST);
    let output = buffer(48 * squares.len(), wgpu::BufferUsages::COPY_SRC);
    gpu.queue().write_buffer(&input, 0, bytemuck::cast_slice(squares));
    let layout = Probe::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test probe", shaders::MICRO_PATCHES_PROBE, &[&layout]);
    let group = Probe { inputs: &input, outputs: &output }.cached_group(gpu, &layout);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(squares.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    gpu.queue().submit([encoder.finish()]);
    let patch = |v: &[f32]| Patch { low: Vec2::new(v[0], v[1]), high: Vec2::new(v[2], v[3]) };
    read_storage::<[f32; 12]>(gpu, &output).iter().map(|v| [0, 4, 8].map(|i| patch(&v[i..]))).collect()
}

#[test]
fn patches_are_what_rays_through_their_corners_hit() {
    let Some(gpu) = gpu() else { return };
    const TEXELS_PER_TANGENT: f32 = 512.0;
    let scene = |i: u32| {
        let receiver_m = Vec3::new(2.0 * random(i, 0) - 1.0, 2.0 * random(i, 1) - 1.0, 5.0 + random(i, 2));
        let depth_m = move |x: i32, y: i32| {
            let square = hash_u32(i ^ hash_u32((x + 3) as u32 ^ ((y + 3) as u32) << 8));
            // A quarter of the neighbours hides nothing.
            let hides = (x, y) == (0, 0) || unit_f32(hash_u32(square)) > 0.25;
            hides.then(|| 1.0 + 3.0 * unit_f32(square))
        };
        // Second depth of a surface that is nearly parallel to the map.
        let tilted_m = depth_m(0, 0).expect("it hides") * (0.995 + 0.01 * random(i, 3));
        (receiver_m, depth_m, tilted_m)
    };
    let square = |i: u32| {
        let (receiver_m, depth_m, tilted_m) = scene(i);
        let center = TEXELS_PER_TANGENT * receiver_m.truncate() / receiver_m.z;
        let scale_of = |z_m: f32| 1.0 / (1.0 / z_m - 1.0 / receiver_m.z);
        let scale = |x, y| depth_m(x, y).map_or(0.0, scale_of);
        let (low, high) = (-center, Vec2::ONE - center);
        [
            [low.x, low.y, high.x, high.y],
            [scale(-1, -1), scale(0, -1), scale(1, -1), scale(0, 0)],
            [scale(-1, 1), scale(0, 1), scale(1, 1), 0.0],
            [scale(-1, 0), scale(1, 0), scale(0, 0), scale_of(tilted_m)],
        ]
        .concat()
        .try_into()
        .expect("sixteen words")
    };
    let squares: Vec<ProbedSquare> = (0..4096).map(square).collect();
    let (mut wider, mut whole) = (0, 0);
    for (i, [alone, joined, innermost]) in (0..).zip(probed(gpu, &squares)) {
        let (receiver_m, depth_m, tilted_m) = scene(i);
        let squares = Squares { receiver_m, texels_per_tangent: TEXELS_PER_TANGENT, depth_m: &depth_m };
        let common = squares.innermost(0, 0, [depth_m(0, 0).expect("it hides"), tilted_m]);
        for (is, of) in [(alone, squares.alone(0, 0)), (joined, squares.joined(0, 0)), (innermost, common)] {
            let off = (is.low - of.low).abs().max((is.high - of.high).abs()).max_element();
            assert!(off < 0.02, "square {i}: {is:?}, and {of:?} by rays");
        }
        wider += usize::from(joined != alone);
        whole += usize::from(innermost.low.cmplt(innermost.high).all());
    }
    assert!(wider > 2000, "{wider} squares have gaps beside them");
    assert!((500..4090).contains(&whole), "{whole} squares hide a part of the light at all depths between two");
}
