//! Stochastic coverage thresholds (`thresholds.wesl`): CPU reference, and tests of both.

use glam::{Vec2, Vec3};

use crate::gpu::{Bindings, bindings, compute_pipeline};
use crate::shaders;
use crate::testing::{gpu, read_storage};

fn hash_combine(seed: u32, value: u32) -> u32 {
    seed ^ value.wrapping_add(seed << 6).wrapping_add(seed >> 2)
}

fn hash(value: u32) -> u32 {
    let mut x = value;
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

fn hash_of_position(seed: u32, position: Vec3) -> u32 {
    position.to_array().map(f32::to_bits).into_iter().fold(seed, |seed, bits| hash(hash_combine(seed, bits)))
}

fn laine_karras_permutation(value: u32, seed: u32) -> u32 {
    let x = value.wrapping_add(seed);
    let factors = [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6];
    factors.into_iter().fold(x, |x: u32, factor| x ^ x.wrapping_mul(factor))
}

fn stochastic_threshold(point: u32, seed: u32) -> f32 {
    let shuffled = laine_karras_permutation(point.reverse_bits(), hash(seed)).reverse_bits();
    let scrambled = laine_karras_permutation(shuffled, hash(seed ^ 0x9e37_79b9)).reverse_bits();
    ((scrambled >> 8) as f32 + 0.5) / 16_777_216.0
}

#[test]
fn every_aligned_run_of_points_is_stratified() {
    for seed in 0..50 {
        for (first, count) in [(0u32, 64u32), (0, 256), (64, 64), (32, 32), (192, 16), (4, 4)] {
            let mut is_taken = vec![false; count as usize];
            for point in first..first + count {
                let u = stochastic_threshold(point, seed);
                assert!(u > 0.0 && u <= 1.0, "{u}");
                let stratum = ((u * count as f32) as usize).min(count as usize - 1);
                assert!(!std::mem::replace(&mut is_taken[stratum], true), "seed {seed}, {first} + {count}");
            }
        }
    }
    // Other numbers of points are nearly stratified.
    for (seed, share) in (0..200).zip((0..10).map(|i| 0.1 * i as f32).cycle()) {
        let covered = (0..100).filter(|point| stochastic_threshold(*point, seed) < share).count();
        assert!((covered as f32 - 100.0 * share).abs() < 6.0, "{covered} of 100 below {share}");
    }
}

#[test]
fn surfaces_in_a_row_multiply() {
    let seeds: Vec<u32> = (0..400).map(|i| hash_of_position(0, Vec3::new(i as f32, 0.5, -1.0))).collect();
    for [a, b] in [[0.5f32, 0.5], [0.25, 0.75], [0.9, 0.9]] {
        let errors = seeds.windows(2).map(|seeds| {
            let passes =
                |point: u32| stochastic_threshold(point, seeds[0]) >= a && stochastic_threshold(point, seeds[1]) >= b;
            (0..256).filter(|point| passes(*point)).count() as f32 / 256.0 - (1.0 - a) * (1.0 - b)
        });
        let errors: Vec<f32> = errors.collect();
        let mean = errors.iter().sum::<f32>() / errors.len() as f32;
        let deviation = (errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32).sqrt();
        // Independent points would have √(p (1 − p) / 256), stratified ones less.
        let p = (1.0 - a) * (1.0 - b);
        let independent = (p * (1.0 - p) / 256.0).sqrt();
        assert!(mean.abs() < 0.3 * independent, "{a} {b}: mean error {mean}, {independent} for one pair");
        assert!(deviation < independent, "{a} {b}: deviation {deviation} against {independent}");
        assert!(deviation > 0.1 * independent, "{a} {b}: no chance at all");
    }
}

bindings! {
    struct Probe = "stochastic probe", COMPUTE, group 0 of [STOCHASTIC_PROBE] {
        0 inputs: Storage,
        1 outputs: ReadWrite,
    }
}

#[test]
fn the_shader_equals_its_reference() {
    let Some(gpu) = gpu() else { return };
    let inputs: Vec<(u32, u32, Vec2)> =
        (0..4096u32).map(|i| (i % 300, i / 7, Vec2::new(i as f32 * 0.37 - 5.0, -0.0 - (i % 3) as f32))).collect();
    let words: Vec<[u32; 4]> =
        inputs.iter().map(|(point, seed, at)| [*point, *seed, at.x.to_bits(), at.y.to_bits()]).collect();
    let buffer = |size: usize, usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test probe"),
            size: size as u64,
            usage: usage | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    };
    let input = buffer(size_of_val(&words[..]), wgpu::BufferUsages::COPY_DST);
    let output = buffer(4 * words.len(), wgpu::BufferUsages::COPY_SRC);
    gpu.queue().write_buffer(&input, 0, bytemuck::cast_slice(&words));
    let layout = Probe::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test probe", shaders::STOCHASTIC_PROBE, &[&layout]);
    let group = Probe { inputs: &input, outputs: &output }.cached_group(gpu, &layout);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(words.len() as u32 / 64, 1, 1);
    drop(pass);
    gpu.queue().submit([encoder.finish()]);
    let outputs: Vec<f32> = read_storage(gpu, &output);
    for ((point, seed, at), output) in inputs.into_iter().zip(outputs) {
        let want = stochastic_threshold(point, hash_of_position(seed, at.extend(1.0)));
        assert_eq!(output, want, "{point} {seed} {at}");
    }
}
