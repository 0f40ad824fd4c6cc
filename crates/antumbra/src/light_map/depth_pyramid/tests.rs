//! The CPU reference against the definition, then the GPU against the CPU reference.

use antumbra_light::{Light, LightShape, hash_u32, unit_f32};
use glam::{UVec2, Vec2, Vec3};

use super::{DepthPyramid, cpu, level_sizes};
use crate::gpu::{Gpu, Lease, Recorder, Stage, create_uniform, write_uniform};
use crate::light_map::light_view::{LightView, LightViewGpu, Window};
use crate::testing::{float_texture, gpu, read_texture, view_of};

fn random_map(size: UVec2) -> Vec<f32> {
    (0..size.x * size.y).map(|i| unit_f32(hash_u32(i ^ 0x51ed))).collect()
}

#[test]
fn cpu_reference_matches_the_definition() {
    let size = UVec2::new(13, 6);
    let map = random_map(size);
    let levels = cpu::build(&map, size);
    assert_eq!(levels.last().map(Vec::len), Some(1));
    let all = levels.last().expect("has levels")[0];
    assert_eq!(all[0], map.iter().copied().fold(f32::INFINITY, f32::min));
    assert_eq!(all[1], map.iter().copied().fold(0.0, f32::max));
    // Level 1 covers squares of four; its texel (1, 0) the columns 4 to 7 of rows 0 to 3.
    let square = (0..4).flat_map(|y| (4..8).map(move |x| (y, x)));
    let high = square.map(|(y, x)| map[y * 13 + x]).fold(0.0, f32::max);
    assert_eq!(levels[1][1][1], high);
}

/// The pyramid of a map.
fn built(gpu: &Gpu, map: &[f32], size: UVec2, view: &wgpu::Buffer, light_half_extent_m: Vec2) -> DepthPyramid {
    let map = view_of(&float_texture(gpu, size, map));
    let mut pyramid = DepthPyramid::new(gpu);
    pyramid.prepare(&Stage::at_once(gpu), &Lease::new(&gpu.device, 0), &map, view, size, light_half_extent_m);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    pyramid.record(&mut Recorder::new(&mut encoder, None));
    gpu.queue().submit([encoder.finish()]);
    pyramid
}

/// Nearest depth of the last level, metres, for a 256² map that shows a wall at 10 m and a square of `speck` texels at 5 cm.
fn nearest_that_matters_m(gpu: &Gpu, speck: u32, light_half_extent_m: Vec2) -> f32 {
    const SIZE: u32 = 256;
    let frame = Light::new(LightShape::Disk { radius_m: 1.0 }, Vec3::ZERO, -Vec3::Y).frame();
    let window = Window {
        center: Vec2::ZERO,
        roll: Vec2::X,
        half_size: Vec2::ONE,
        warp: Vec2::ZERO,
        center_in_warp: Vec2::ZERO,
    };
    let view =
        LightView { frame, perspective: true, window, near_m: 0.01, far_m: 20.0, complete_from_m: 0.0 }.to_gpu(SIZE);
    let depth = |z: f32| view.depth_scale / z + view.depth_offset;
    let is_speck = |i: u32| i % SIZE < speck && i / SIZE < speck;
    let map: Vec<f32> = (0..SIZE * SIZE).map(|i| depth(if is_speck(i) { 0.05 } else { 10.0 })).collect();
    let uniform = create_uniform::<LightViewGpu>(gpu, "test view");
    write_uniform(&Stage::at_once(gpu), &uniform, &view);
    let pyramid = built(gpu, &map, UVec2::splat(SIZE), &uniform, light_half_extent_m);
    let levels = pyramid.levels.as_ref().expect("prepared");
    let last = read_texture(gpu, &levels.texture, levels.texture.mip_level_count() - 1, UVec2::ONE);
    let [_, nearest] = bytemuck::pod_read_unaligned::<[f32; 2]>(&last);
    view.depth_scale / (nearest - view.depth_offset)
}

#[test]
fn what_hides_next_to_nothing_of_the_light_does_not_matter() {
    let Some(gpu) = gpu() else { return };
    // A texel 5 cm in front of the light is 0.4 mm wide, too little of 2 m to count. The wall counts, up to its bin's eighth of
    // an octave.
    let alone = nearest_that_matters_m(gpu, 1, Vec2::ONE);
    assert!((9.0..=10.0).contains(&alone), "{alone} m");
    // The whole map at 5 cm is a 400th of the light's area, which counts.
    let all = nearest_that_matters_m(gpu, 256, Vec2::ONE);
    assert!((all - 0.05).abs() < 1e-3, "{all} m");
    // Of a light a centimetre wide the texel hides a six-hundredth, which counts. For points and suns everything counts.
    for half_extent in [Vec2::splat(0.005), Vec2::ZERO] {
        let near = nearest_that_matters_m(gpu, 1, half_extent);
        assert!((near - 0.05).abs() < 1e-3, "{half_extent}: {near} m");
    }
}

#[test]
fn gpu_equals_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    for size in [1, 2, 3, 7, 8, 9, 16, 17, 63, 64, 65, 255, 512, 520]
        .map(|n| UVec2::new(n, n))
        .into_iter()
        .chain([UVec2::new(1, 40), UVec2::new(129, 16)])
    {
        let map = random_map(size);
        // No warp.
        let view = create_uniform::<LightViewGpu>(gpu, "test view");
        let pyramid = built(gpu, &map, size, &view, Vec2::ZERO);
        let levels = pyramid.levels.as_ref().expect("prepared");
        for ((i, want), level_size) in (0..).zip(cpu::build(&map, size)).zip(level_sizes(size)) {
            let got = read_texture(gpu, &levels.texture, i, level_size);
            assert_eq!(bytemuck::cast_slice::<u8, [f32; 2]>(&got), want, "{size}, level {i}");
        }
        // Four levels per dispatch, including the last four.
        let dispatches = levels.steps.len() + 1;
        assert!(dispatches <= level_sizes(size).len().div_ceil(4), "{size}: {dispatches} dispatches");
    }
}
