//! CPU reference against the definition, then GPU against CPU reference.

use antumbra_light::hash_u32;

use super::{PrefixScan, cpu, level_counts};
use crate::gpu::{Recorder, Stage};
use crate::testing::{gpu, read_storage};

#[test]
fn cpu_reference_matches_the_definition() {
    assert_eq!(cpu::scan(&[3, 0, 5, 1]), (vec![0, 3, 3, 8], 9));
    assert_eq!(cpu::scan(&[u32::MAX, 2]), (vec![0, u32::MAX], 1));
}

#[test]
fn scan_levels_end_in_one_block() {
    assert_eq!(level_counts(1), [1]);
    assert_eq!(level_counts(2048), [1]);
    assert_eq!(level_counts(2049), [2, 1]);
    assert_eq!(level_counts(2048 * 2048 + 1), [2049, 2, 1]);
}

#[test]
fn gpu_equals_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let mut scan = PrefixScan::new(gpu);
    for count in [1, 2, 7, 8, 9, 255, 256, 257, 2047, 2048, 2049, 4096, 100_000, 2048 * 2048 + 3] {
        // One item more than is scanned; it must not change.
        let items: Vec<u32> = (0..=count).map(|i| hash_u32(i ^ count) >> 20).collect();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test items"),
            size: items.len() as u64 * 4,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        gpu.queue().write_buffer(&buffer, 0, bytemuck::cast_slice(&items));
        scan.prepare(&Stage::at_once(gpu), &buffer, count);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        scan.record(&mut Recorder::new(&mut encoder, None), "scan");
        gpu.queue().submit([encoder.finish()]);

        let had: Vec<u32> = read_storage(gpu, &buffer);
        let had_total: Vec<u32> = read_storage(gpu, scan.total().expect("prepared"));
        let (want, want_total) = cpu::scan(&items[..count as usize]);
        assert!(had[..count as usize] == want, "{count} items");
        assert_eq!(had[count as usize], items[count as usize], "{count} items: one too many was scanned");
        assert_eq!(had_total, [want_total], "{count} items");
    }
}
