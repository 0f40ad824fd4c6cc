//! Tests of a subset of the view-samples with reconstruction, against all of them.

use glam::UVec2;

use super::super::{SampleBased, SampleBasedParams, Traversal};
use crate::gpu::{Gpu, Recorder};
use crate::shadow::{Casters, Shadow};
use crate::testing::{Case, Mesh, RECTANGLE, SIZE, gpu, read_storage, read_texture};

/// Returns a case's mask, and its number of tests.
fn mask(gpu: &Gpu, case: &Case, params: SampleBasedParams) -> (Vec<f32>, u64) {
    let params = SampleBasedParams { count_tests: true, ..params };
    let mut shadow = Shadow::<SampleBased>::with_params(gpu, params).expect("a device with WebGPU's limits");
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    case.with_frame(Casters::Meshes(&casters), |frame| {
        let work = shadow.prepare(frame).expect("a good frame");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        work.record(&mut Recorder::new(&mut encoder, None));
        gpu.queue.submit([encoder.finish()]);
    });
    let counts: Vec<u32> = read_storage(gpu, shadow.technique().test_counts().expect("they are counted"));
    let mask = bytemuck::pod_collect_to_vec(&read_texture(gpu, case.mask.texture(), 0, SIZE));
    (mask, u64::from(counts[5]))
}

/// Every other pixel, and those that interpolation would get wrong, have the exact bits; the others are as close as promised.
/// In a penumbra a pixel's four neighbours differ by little, so few pixels remain for the second round.
#[test]
fn a_subset_has_the_bits_where_it_looks_and_less_to_test() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    for traversal in [Traversal::Groups, Traversal::Raster, Traversal::Chosen] {
        let params = SampleBasedParams { traversal, samples: 256, ..SampleBasedParams::default() };
        let (whole, tests_of_whole) = mask(gpu, &case, params);
        let (subset, tests) = mask(gpu, &case, SampleBasedParams { sub: true, ..params });
        let mut interpolated = 0;
        let mut sum = 0.0;
        for y in 0..SIZE.y {
            for x in 0..SIZE.x {
                let i = (y * SIZE.x + x) as usize;
                let off = (whole[i] - subset[i]).abs();
                let is_known = UVec2::new(x, y) % 2 == UVec2::ZERO;
                assert!(!is_known || off == 0.0, "{traversal:?}: {x}, {y} is off by {off}");
                assert!(off <= 0.25, "{traversal:?}: {x}, {y} is off by {off}");
                interpolated += usize::from(off > 0.0);
                sum += off * off;
            }
        }
        let rmse = (sum / SIZE.element_product() as f32).sqrt();
        println!("{traversal:?}: rmse {rmse:.4}, {interpolated} interpolated; {tests} of {tests_of_whole} tests");
        assert!(rmse < 0.008 && interpolated > 200, "{traversal:?}: rmse {rmse}, {interpolated} interpolated");
        assert!(tests > 0 && 2 * tests < tests_of_whole, "{traversal:?}: {tests} of {tests_of_whole} tests");
    }
}
