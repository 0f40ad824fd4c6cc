//! Tests of the CPU reference's properties, then of the GPU against it. The means are tested through `sample_based`.

use antumbra_light::hash_u32;

use super::cpu::fingerprint;
use super::{FINGERPRINT_GROUPS, FINGERPRINT_THREADS, Fingerprinted};
use crate::gpu::{Bindings, compute_pipeline};
use crate::shaders;
use crate::testing::{gpu, read_storage};

fn words(count: u32) -> Vec<u32> {
    (0..count).map(|i| hash_u32(i ^ 0x77)).collect()
}

#[test]
fn a_fingerprint_tells_values_and_places() {
    let mut changed = words(100);
    let before = fingerprint(&changed);
    changed.swap(3, 70);
    assert_ne!(fingerprint(&changed), before);
    changed.swap(3, 70);
    changed[99] ^= 1;
    assert_ne!(fingerprint(&changed), before);
}

#[test]
fn gpu_equals_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let layout = Fingerprinted::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test", shaders::ACCUMULATION_FINGERPRINT, &[&layout]);
    for count in [1, 2, 63, 256, 257, 4096, 16_384, 16_385, 200_000] {
        let words = words(count);
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let [buffer, state] = [u64::from(count) * 4, 12].map(|size| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("test"),
                size,
                usage,
                mapped_at_creation: false,
            })
        });
        gpu.queue().write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
        let group = Fingerprinted { words: &buffer, state: &state }.cached_group(gpu, &layout);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(count.div_ceil(FINGERPRINT_THREADS).min(FINGERPRINT_GROUPS), 1, 1);
        }
        gpu.queue().submit([encoder.finish()]);
        let got: Vec<u32> = read_storage(gpu, &state);
        assert_eq!(got[0], fingerprint(&words), "{count} words");
    }
}
