//! CPU references against closed forms, then GPU against CPU references.

use antumbra_light::{hash_u32, unit_f32};
use glam::UVec2;

use super::mips::{MipStep, full_level_count, level_origin, level_size, mip_steps, mips_size};
use super::{Kernel, PackedMap, Packing, cpu};
use crate::contract::MapLevel;
use crate::gpu::{Recorder, Stage};
use crate::testing::{gpu, read_slice};

fn random_map(size: UVec2) -> Vec<f32> {
    (0..size.x * size.y).map(|i| unit_f32(hash_u32(i ^ 0x2b1d))).collect()
}

#[test]
fn kernels_have_unit_sum_and_the_deviation_that_they_say() {
    for width in [1.0, 1.5, 2.0, 3.0, 7.3, 15.0, 127.0] {
        for kernel in [Kernel::boxed(width), Kernel::gaussian(width)] {
            let sum: f32 = kernel.weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "{width}: {sum}");
            let radius = kernel.radius() as f64;
            let variance: f64 =
                kernel.weights.iter().enumerate().map(|(i, w)| f64::from(*w) * (i as f64 - radius).powi(2)).sum();
            // The kernel treats texels as points: a box's partly covered outermost texels count at their centres.
            let want = (f64::from(width).powi(2) - 1.0) / 12.0;
            assert!((variance - want).abs() < 0.03 * want + 0.25, "{width}: {variance}, want {want}");
        }
    }
    assert_eq!(Kernel::boxed(3.0).weights, [1.0 / 3.0; 3]);
    assert_eq!(Kernel::boxed(2.0).weights, [0.25, 0.5, 0.25]);
    assert_eq!(Kernel::gaussian(1.0).weights, [1.0]);
}

#[test]
fn cpu_references_keep_means_and_planes() {
    let size = UVec2::new(21, 17);
    let plane: Vec<f32> = (0..size.x * size.y).map(|i| (i % 21) as f32 * 0.02 + (i / 21) as f32 * 0.01).collect();
    let blurred = cpu::blur(&plane, size, &Kernel::gaussian(5.0));
    // In the middle, beyond the kernel's distance from the edges.
    assert!((blurred[8 * 21 + 10] - plane[8 * 21 + 10]).abs() < 1e-6);
    let (half, half_size) = cpu::halve(&plane, size);
    assert_eq!(half_size, UVec2::new(10, 8));
    let mean = |map: &[f32]| map.iter().sum::<f32>() / map.len() as f32;
    assert!((mean(&half) - mean(&plane)).abs() < 1e-5);
}

#[test]
fn every_level_is_made_and_several_at_once_where_sizes_allow() {
    for size in
        [1, 2, 5, 16, 48, 64, 100, 1024, 1448, 2048, 4096].map(UVec2::splat).into_iter().chain([UVec2::new(32, 80)])
    {
        let mut made = 0;
        for MipStep { before, count } in mip_steps(size, full_level_count(size)) {
            assert_eq!(before, made, "{size}");
            assert!(count == 1 || level_size(size, before) % (1 << count) == UVec2::ZERO, "{size}: {count} at once");
            made += count;
        }
        assert_eq!(made + 1, full_level_count(size), "{size}");
    }
    for (texels, dispatches) in [(64, 1), (256, 2), (1024, 2), (4096, 2), (100, 4)] {
        let size = UVec2::splat(texels);
        assert_eq!(mip_steps(size, full_level_count(size)).count(), dispatches, "{texels}");
    }
}

#[test]
fn levels_lie_beside_each_other() {
    for size in [2, 3, 5, 100, 255, 1024].map(UVec2::splat).into_iter().chain([UVec2::new(32, 80), UVec2::new(7, 129)])
    {
        let levels = (1..full_level_count(size)).map(|level| (level_origin(size, level), level_size(size, level)));
        let levels: Vec<_> = levels.collect();
        let room = mips_size(size);
        for (i, (corner, extent)) in levels.iter().enumerate() {
            let end = corner + extent;
            assert!(extent.min_element() > 0 && end.cmple(room).all(), "{size}: {corner} to {end} of {room}");
            for (other, other_extent) in &levels[..i] {
                let apart = corner.cmpge(other + other_extent) | other.cmpge(end);
                assert!(apart.any(), "{size}: {corner} and {other}");
            }
        }
    }
}

#[test]
fn gpu_equals_cpu_references_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let kernels = [Kernel::boxed(1.0), Kernel::boxed(4.5), Kernel::gaussian(9.0)];
    let packings = [Packing::Float32, Packing::Float16, Packing::Unorm16, Packing::Unorm8];
    let sizes = [1, 2, 3, 7, 8, 9, 15, 16, 17, 63, 64, 65, 255].map(|n| UVec2::new(n, n));
    for (i, size) in sizes.into_iter().chain([UVec2::new(1, 40), UVec2::new(129, 16)]).enumerate() {
        let (kernel, packing) = (&kernels[i % 3], packings[i % 4]);
        let (map, words) = (random_map(size), 2);
        let mut packed = PackedMap::new(gpu);
        let prepared = packed.prepare(&Stage::at_once(gpu), size, words, packing, kernel, true);
        // Fill the first channel of the second word; everything else stays 0.
        let bits: Vec<u32> = map.iter().map(|v| pack(*v, packing)).collect();
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y: 0, z: 1 },
                ..packed.texture().as_image_copy()
            },
            bytemuck::cast_slice(&bits),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.x * 4), rows_per_image: None },
            wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        );
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        prepared.record(&mut Recorder::new(&mut encoder, None));
        gpu.queue().submit([encoder.finish()]);

        let stored: Vec<f32> = bits.iter().map(|word| unpack(*word, packing)).collect();
        let (mut want, mut level_size) = (cpu::blur(&stored, size, kernel), size);
        for (level, map_level) in (0..).zip(packed.drawn()) {
            assert_eq!(map_level.size_px, level_size);
            let got: Vec<f32> = read_level(gpu, &map_level).iter().map(|word| unpack(*word, packing)).collect();
            // Each level, and each direction of the blur, rounds once.
            let tolerance = 1e-5 + (level + 2) as f32 * packing.step();
            for (k, (got, want)) in got.iter().zip(&want).enumerate() {
                assert!(
                    (got - want).abs() <= tolerance,
                    "{size}, {packing:?}, level {level}, texel {k}: {got}, {want}"
                );
            }
            (want, level_size) = cpu::halve(&want, level_size);
        }
    }
}

/// Reads the second word of a level.
fn read_level(gpu: &crate::Gpu, level: &MapLevel) -> Vec<u32> {
    let UVec2 { x, y } = level.origin_px;
    let source =
        wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x, y, z: 1 }, ..level.view.texture().as_image_copy() };
    bytemuck::pod_collect_to_vec(&read_slice(gpu, source, level.size_px))
}

fn pack(value: f32, packing: Packing) -> u32 {
    match packing {
        Packing::Float32 => value.to_bits(),
        // Exact for the multiples of 2⁻¹⁰ in [0, 1) that are generated here: sign 0, exponent by hand.
        Packing::Float16 => half_bits((value * 1024.0).floor() / 1024.0),
        Packing::Unorm16 => (value * 65535.0).round() as u32,
        Packing::Unorm8 => (value * 255.0).round() as u32,
    }
}

fn half_bits(value: f32) -> u32 {
    if value == 0.0 {
        return 0;
    }
    let bits = value.to_bits();
    let exponent = (bits >> 23) as i32 - 127 + 15;
    ((exponent as u32) << 10) | ((bits >> 13) & 0x3ff)
}

fn unpack(word: u32, packing: Packing) -> f32 {
    cpu::unpack_word(word, packing)[0]
}
