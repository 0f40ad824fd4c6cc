//! CPU reference on known clusters, then GPU against CPU reference.

use antumbra_light::{hash_u32, unit_f32};

use super::{BIN_COUNT, Lloyd, LloydUniform, MAX_MEANS, Relaxation, Teleport, cpu, pipeline_of};
use crate::gpu::{Gpu, Recorder, Span, Stage};
use crate::testing::{gpu, read_buffer};

const PLAIN: Relaxation =
    Relaxation { iterations: 30, moved_count: 15, shift: 0.0, min_gap: 0.01, teleport: Teleport::Inertia };

/// Histogram of bumps with the given centres and weights, a hundredth wide.
fn bumps(middles: &[(f64, u32)]) -> Vec<u32> {
    let mut histogram = vec![0; BIN_COUNT as usize];
    for (middle, weight) in middles {
        for i in -20i32..=20 {
            let bin = (middle * f64::from(BIN_COUNT)) as i32 + i;
            histogram[bin as usize] += weight * (21 - i.unsigned_abs());
        }
    }
    histogram
}

fn evenly(count: usize) -> Vec<f64> {
    (0..count).map(|i| (i as f64 + 1.0) / (count as f64 + 1.0)).collect()
}

#[test]
fn cpu_reference_finds_what_is_there_within_thirty_iterations() {
    // All lie in the lower quarter: even starts leave two means without weight, which must teleport.
    let middles = [(0.05, 10), (0.12, 3), (0.2, 40)];
    let mut means = evenly(3);
    let splits = cpu::relax(&bumps(&middles), &mut means, 0, &PLAIN);
    for (split, (middle, _)) in splits.iter().zip(middles) {
        assert!((split - middle).abs() < 0.002, "{splits:?}");
    }
    // By weight no mean stays without weight, but two share the heaviest bump, and one represents the others.
    let mut means = evenly(3);
    let by_weight = Relaxation { teleport: Teleport::Weight, ..PLAIN };
    let splits = cpu::relax(&bumps(&middles), &mut means, 0, &by_weight);
    assert!(splits.iter().all(|split| (0.04..0.22).contains(split)) && splits[2] - splits[1] < 0.02, "{splits:?}");
    // Moving two at a time converges, too.
    let mut means = evenly(3);
    let two = cpu::relax(&bumps(&middles), &mut means, 0, &Relaxation { moved_count: 2, ..PLAIN });
    assert!((two[1] - 0.12).abs() < 0.002, "{two:?}");
}

#[test]
fn cpu_reference_keeps_gaps_and_shifts() {
    let mut means = evenly(4);
    let how = Relaxation { shift: 0.05, min_gap: 0.1, ..PLAIN };
    let splits = cpu::relax(&bumps(&[(0.9, 1)]), &mut means, 0, &how);
    assert!(splits[0] >= 0.1 - 1e-6 && splits[3] <= 0.9 + 1e-6, "{splits:?}");
    assert!(splits.windows(2).all(|s| s[1] - s[0] >= 0.1 - 1e-6), "{splits:?}");
}

fn run(gpu: &Gpu, lloyd: &mut Lloyd, histogram: &[u32], uniform: &LloydUniform) -> Vec<f32> {
    lloyd.write(&Stage::at_once(gpu), uniform);
    read_splits(gpu, lloyd, histogram, uniform.cluster_count)
}

/// Returns the splits after the prepared update.
fn read_splits(gpu: &Gpu, lloyd: &Lloyd, histogram: &[u32], count: u32) -> Vec<f32> {
    gpu.queue.write_buffer(&lloyd.histogram, 0, bytemuck::cast_slice(histogram));
    let bytes = 4 * MAX_MEANS as u64;
    let readback = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test splits"),
        size: bytes,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    lloyd.record(&mut Recorder::new(&mut encoder, None), "test", Span::Only);
    encoder.copy_buffer_to_buffer(lloyd.splits(), 0, &readback, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    let splits: Vec<f32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, &readback, bytes));
    splits[..count as usize].to_vec()
}

#[test]
fn gpu_equals_cpu_reference_iteration_by_iteration() {
    let Some(gpu) = gpu() else { return };
    let runs = [(1u32, 1usize), (2, 2), (3, 3), (4, 7), (5, 15)];
    let all = runs.map(|run| (run, Teleport::Inertia)).into_iter().chain(runs.map(|run| (run, Teleport::Weight)));
    for ((seed, count), teleport) in all {
        let random = |i: u32| unit_f32(hash_u32(seed * 977 + i));
        let middles: Vec<_> = (0..count as u32 + 2)
            .map(|i| (0.05 + 0.9 * f64::from(random(i)), 1 + (random(i + 50) * 9.0) as u32))
            .collect();
        let histogram = bumps(&middles);
        let moved_count = 2.min(count as u32);
        let how = Relaxation { iterations: 1, moved_count, shift: 0.01, min_gap: 0.02, teleport };
        let (mut lloyd, mut means) = (Lloyd::new(gpu), evenly(count));
        lloyd.pipeline = (teleport, pipeline_of(gpu, &lloyd.layout, teleport));
        for frame in 0..30u32 {
            let moved_first = frame * how.moved_count % count as u32;
            let uniform = LloydUniform {
                cluster_count: count as u32,
                iterations: 1,
                moved_count: how.moved_count,
                moved_first,
                begins: (frame == 0).into(),
                shift: how.shift,
                min_gap: how.min_gap,
                glide: 1.0,
            };
            let got = run(gpu, &mut lloyd, &histogram, &uniform);
            let want = cpu::relax(&histogram, &mut means, moved_first, &how);
            for (got, want) in got.iter().zip(&want) {
                assert!((f64::from(*got) - want).abs() < 2.0 / f64::from(BIN_COUNT), "{count}, {frame}: {got}, {want}");
            }
        }
    }
}

#[test]
fn splits_glide_to_their_places_within_thirty_frames() {
    let Some(gpu) = gpu() else { return };
    let mut lloyd = Lloyd::new(gpu);
    let how = Relaxation { iterations: 1, ..PLAIN };
    let (left, right) = (bumps(&[(0.1, 10), (0.2, 10), (0.3, 10)]), bumps(&[(0.6, 10), (0.7, 10), (0.95, 10)]));
    let frame = |lloyd: &mut Lloyd, histogram: &[u32]| {
        lloyd.prepare(&Stage::at_once(gpu), 3, &how);
        read_splits(gpu, lloyd, histogram, 3)
    };
    let mut before = frame(&mut lloyd, &left);
    for i in 0..30 {
        let now = frame(&mut lloyd, &right);
        // From .1, .2, .3 to .6, .7, .95: no split moves more than a quarter of the way per frame.
        for (before, now) in before.iter().zip(&now) {
            assert!((now - before).abs() < 0.25 * 0.66, "frame {i}: {before} to {now}");
        }
        before = now;
    }
    for (split, middle) in before.iter().zip([0.6, 0.7, 0.95]) {
        assert!((split - middle).abs() < 0.002, "{before:?}");
    }
}

#[test]
fn the_first_frame_has_converged() {
    let Some(gpu) = gpu() else { return };
    let histogram = bumps(&[(0.05, 10), (0.12, 3), (0.2, 40), (0.5, 5)]);
    let mut lloyd = Lloyd::new(gpu);
    let how = Relaxation { iterations: 1, ..PLAIN };
    lloyd.prepare(&Stage::at_once(gpu), 4, &how);
    let uniform = LloydUniform {
        cluster_count: 4,
        iterations: 32,
        moved_count: 4,
        moved_first: 0,
        begins: 1,
        shift: 0.0,
        min_gap: 0.01,
        glide: 1.0,
    };
    let first = run(gpu, &mut lloyd, &histogram, &uniform);
    let later = run(gpu, &mut lloyd, &histogram, &LloydUniform { iterations: 30, begins: 0, ..uniform });
    for (first, later) in first.iter().zip(&later) {
        assert!((first - later).abs() < 2.0 / BIN_COUNT as f32, "{first} became {later}");
    }
}
