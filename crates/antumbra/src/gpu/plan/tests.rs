//! Tests of the planned device itself. `antumbra-host-tests` tests that plans match real frames.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{MemoryPlan, PlannedResource};
use crate::Gpu;
use crate::testing::gpu;

fn texture(gpu: &Gpu) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test texture"),
        size: wgpu::Extent3d { width: 8, height: 4, depth_or_array_layers: 3 },
        mip_level_count: 2,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

fn buffer(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let label = Some("test buffer");
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
}

#[test]
fn resources_are_counted_while_they_are_held() {
    let Some(gpu) = gpu() else { return };
    let plan = MemoryPlan::new(gpu);
    let (first, second, texture) = (buffer(plan.gpu(), 100), buffer(plan.gpu(), 20), texture(plan.gpu()));
    let of = |label: &str, count, bytes| PlannedResource { label: label.into(), count, bytes };
    // Two levels with three layers each.
    let of_texture = of("test texture", 1, 16 * 3 * (8 * 4 + 4 * 2));
    assert_eq!(plan.resources(), [of_texture.clone(), of("test buffer", 2, 120)]);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    drop((first, texture));
    assert_eq!(plan.resources(), [of_texture, of("test buffer", 1, 20)]);
    drop((second, view));
    assert_eq!(plan.resources(), []);
}

#[test]
fn planned_objects_are_told_apart_and_commands_end() {
    let Some(gpu) = gpu() else { return };
    let plan = MemoryPlan::new(gpu);
    let planned = plan.gpu();
    assert_eq!(
        (planned.device().limits(), planned.device().features()),
        (gpu.device().limits(), gpu.device().features())
    );
    let (first, second) = (buffer(planned, 4), buffer(planned, 4));
    assert!(first != second && first == first.clone());
    assert_eq!(planned.validation_error(|| drop(buffer(planned, 1 << 50))), None);
    let mut encoder = planned.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(&first, 0, &second, 0, 4);
    let is_done = Arc::new(AtomicBool::new(false));
    let then = Arc::clone(&is_done);
    encoder.on_submitted_work_done(move || then.store(true, Ordering::Relaxed));
    planned.queue().submit([encoder.finish()]);
    assert!(is_done.load(Ordering::Relaxed));
}

#[test]
fn planned_lights_read_what_is_of_the_device_and_not_the_other_way_round() {
    let Some(gpu) = gpu() else { return };
    let plan = MemoryPlan::new(gpu);
    let other = Gpu::new(gpu.device(), gpu.queue());
    assert!(plan.gpu().reads_of(gpu) && plan.gpu().reads_of(plan.gpu()));
    assert!(!gpu.reads_of(plan.gpu()) && !plan.gpu().reads_of(&other));
    let beyond = MemoryPlan::new(plan.gpu());
    assert!(beyond.gpu().reads_of(gpu), "a plan of a plan");
}
