//! Layers against closed forms.

use glam::{UVec2, Vec2};

use super::behind::LayersBehind;
use super::{DepthLayers, LayersSize};
use crate::gpu::{Lease, Recorder, Stage};
use crate::light_map::light_view::{LightView, Window};
use crate::testing::{Mesh, f32_of_half, gpu, read_texture};

#[test]
fn layers_hold_one_plane_after_another() {
    let Some(gpu) = gpu() else { return };
    let frame = antumbra_light::LightFrame {
        center: glam::Vec3::new(0.0, 4.0, 0.0),
        right: glam::Vec3::X,
        up: glam::Vec3::NEG_Z,
        axis: glam::Vec3::NEG_Y,
    };
    let view = LightView {
        frame,
        perspective: true,
        window: Window::square(0.5),
        near_m: 1.0,
        far_m: 5.0,
        complete_from_m: 0.0,
    };
    // Depth is n (f − Z) / (Z (f − n)), reversed.
    let depth_of = |z: f32| (5.0 - z) / (4.0 * z);
    let heights = [2.0, 1.0, 0.0];
    let meshes = heights.map(|y| Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), y));
    // A plane that rises along +x passes through height 3 above the origin.
    let slanted = Mesh::new(
        gpu,
        &[(-1.0, -2.0), (-1.0, 2.0), (1.0, 2.0), (1.0, -2.0)].map(|(x, z)| glam::Vec3::new(x, 2.5 + 0.5 * x, z)),
        &[0, 1, 2, 0, 2, 3],
    );
    let casters: Vec<_> = meshes.iter().chain([&slanted]).map(Mesh::caster).collect();
    let mut layers = DepthLayers::new(gpu);
    let of = LayersSize { size: 32, views: 1, layers: 4, with_gradients: true };
    layers.prepare(&Stage::at_once(gpu), &[view.clip_from_world()], &casters, of);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    layers.record(&mut Recorder::new(&mut encoder, None), "test layers", 0..1, &casters);
    gpu.queue.submit([encoder.finish()]);
    let [depth, gradient] = layers.textures();
    let slice = |texture: &wgpu::Texture, layer: u32| -> Vec<f32> {
        bytemuck::pod_collect_to_vec(&crate::testing::read_layer(gpu, texture, layer))
    };
    let center = 16 * 32 + 16;
    // In light coordinates the slanted plane is Z = 1.5 − X/2: 1/Z = (1 + tx/2) / 1.5, and depth is 5/4 · 1/Z − 1/4.
    let t = (16.5 / 32.0 - 0.5) as f32;
    assert!((slice(depth, 0)[center] - (1.25 * (1.0 + 0.5 * t) / 1.5 - 0.25)).abs() < 1e-5);
    let slopes_of = |layer| -> Vec<f32> {
        let halves: Vec<u16> = bytemuck::pod_collect_to_vec(&crate::testing::read_layer(gpu, gradient, layer));
        halves.into_iter().map(|half| f32_of_half(half) / 1024.0).collect()
    };
    let slope = slopes_of(0);
    let expected = 1.25 * 0.5 / 1.5 / 32.0;
    assert!((slope[2 * center] - expected).abs() < 1e-5 && slope[2 * center + 1].abs() < 1e-6, "{}", slope[2 * center]);
    for (layer, y) in heights.into_iter().enumerate() {
        let (depths, slopes) = (slice(depth, layer as u32 + 1), slopes_of(layer as u32 + 1));
        assert!((depths[center] - depth_of(4.0 - y)).abs() < 1e-6, "height {y}: {}", depths[center]);
        assert!(slopes[2 * center].abs() < 1e-6);
    }
    assert_eq!(read_texture(gpu, depth, 0, UVec2::splat(32)).len(), 32 * 32 * 4);

    // Layers behind a map that was drawn elsewhere are the same to the bit.
    let mut behind = LayersBehind::new(gpu, layers.casters());
    behind.prepare(&Stage::at_once(gpu), &Lease::new(&gpu.device, 0), &layers.depth_slices()[0], 32, 3);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    behind.record(&mut Recorder::new(&mut encoder, None), layers.casters(), &casters);
    gpu.queue.submit([encoder.finish()]);
    for layer in 0..3 {
        assert_eq!(slice(behind.texture(), layer), slice(depth, layer + 1), "layer {layer}");
    }
}
