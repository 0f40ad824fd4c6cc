//! The twin against the definition, then the GPU against the twin.

use antumbra_light::{hash_u32, unit_f32};
use glam::UVec2;

use super::{DepthPyramid, cpu};
use crate::gpu::{Recorder, Stage, create_uniform};
use crate::light_map::light_view::LightViewGpu;
use crate::testing::{gpu, read_texture};

fn random_map(size: UVec2) -> Vec<f32> {
    (0..size.x * size.y).map(|i| unit_f32(hash_u32(i ^ 0x51ed))).collect()
}

#[test]
fn twin_matches_the_definition() {
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

#[test]
fn gpu_equals_twin_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    for size in [1, 2, 3, 7, 8, 9, 16, 17, 63, 64, 65, 255]
        .map(|n| UVec2::new(n, n))
        .into_iter()
        .chain([UVec2::new(1, 40), UVec2::new(129, 16)])
    {
        let map = random_map(size);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("test map"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        gpu.queue().write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&map),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.x * 4), rows_per_image: None },
            texture.size(),
        );
        let mut pyramid = DepthPyramid::new(gpu);
        // No warp.
        let view = create_uniform::<LightViewGpu>(gpu, "test view");
        pyramid.prepare(
            &Stage::at_once(gpu),
            &texture.create_view(&wgpu::TextureViewDescriptor::default()),
            &view,
            size,
        );
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        pyramid.record(&mut Recorder::new(&mut encoder, None));
        gpu.queue().submit([encoder.finish()]);
        let levels = pyramid.levels.as_ref().expect("prepared");
        for (i, want) in cpu::build(&map, size).into_iter().enumerate() {
            let got = read_texture(gpu, &levels.texture, i as u32, levels.steps[i].size);
            assert_eq!(bytemuck::cast_slice::<u8, [f32; 2]>(&got), want, "{size}, level {i}");
        }
    }
}
