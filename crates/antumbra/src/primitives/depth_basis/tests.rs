//! CPU references against closed forms and exact comparison, then shaders against CPU references.

use antumbra_light::{hash_u32, unit_f32};
use glam::{Vec2, Vec4};

use super::cpu::{self, Decoded};
use crate::gpu::{Bindings, Gpu, bindings, compute_pipeline, gpu_structs};
use crate::shaders;
use crate::testing::{gpu, read_buffer};

/// Exact lit weight, and mean depth of the blockers.
fn exact(depths: cpu::Depths<'_>, t: f64) -> (f64, f64) {
    let lit: f64 = depths.iter().filter(|(z, _)| *z >= t).map(|(_, w)| w).sum();
    let blocked: f64 = depths.iter().filter(|(z, _)| *z < t).map(|(z, w)| z * w).sum();
    (lit, if lit < 1.0 { blocked / (1.0 - lit) } else { t })
}

fn assert_close(what: &str, got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance, "{what}: {got}, closed form {want}");
}

#[test]
fn one_occluder_over_a_planar_receiver_is_exact_in_every_variance_basis() {
    // Donnelly and Lauritzen 2006: with two depths, the nearer one in front of the receiver, Chebyshev's bound is attained.
    for lit in [0.1, 0.25, 0.5, 0.9] {
        let (near, t) = (0.35, 0.8);
        let depths = [(near, 1.0 - lit), (t, lit)];
        let mut all = vec![cpu::variance(&depths, t, 0.0), cpu::layered(&depths, t, &[0.0, 0.6, 1.0], 0.0)];
        all.extend(cpu::exponential_variance(&depths, t, [10.0, 10.0], 0.0));
        for (i, decoded) in all.iter().enumerate() {
            assert_close(&format!("visibility {i}"), decoded.visibility, lit, 1e-9);
            assert_close(&format!("blocker {i}"), decoded.blocker_depth, near, 1e-6);
        }
        for decoded in cpu::moment(&depths, t, 1e-9) {
            assert_close("moment visibility", decoded.visibility, lit, 1e-3);
            assert_close("moment blocker", decoded.blocker_depth, near, 1e-3);
        }
    }
}

#[test]
fn variance_bleeds_by_equation_4() {
    // Lauritzen and McCool 2008, eq. 4: depths a and b with half the weight each, receiver c.
    let (a, b, c) = (0.1, 0.7, 0.8);
    let (dx, dy) = (b - a, c - b);
    let depths = [(a, 0.5), (b, 0.5)];
    let bleeding = 0.25 * dx * dx / (0.5 * dx * dx + dx * dy + dy * dy);
    assert_close("eq. 4", cpu::variance(&depths, c, 0.0).visibility, bleeding, 1e-12);
    // Eq. 6: a layer that starts between b and c contains one depth, and is exact.
    assert_close("a split behind b", cpu::layered(&depths, c, &[0.0, 0.75, 1.0], 0.0).visibility, 0.0, 1e-12);
    // A split between a and b clamps a, and so reduces the bleeding.
    let between = cpu::layered(&depths, c, &[0.0, 0.5, 1.0], 0.0).visibility;
    assert!(between < bleeding && between > 0.0, "{between}");
    // One layer equals the variance basis.
    let one = cpu::layered(&depths, c, &[0.0, 1.0], 1e-5);
    assert_close("one layer", one.visibility, cpu::variance(&depths, c, 1e-5).visibility, 1e-12);
}

/// Checks whether a layer with Chebyshev's bound is "at least as good" as one map (section 3.2). It is in umbrae, where all
/// depths lie in front of the receiver. If a quarter lies behind it, at n = .1, the bound
/// 1 − (a m − (1 − a) n)² / (a m² + (1 − a) n²) rises when the layer clamps depths m = .4 in front of the receiver to m = .1.
#[test]
fn a_layer_is_as_good_as_one_map_in_umbrae_and_not_where_depths_lie_behind() {
    let bounds = |depths: &[(f64, f64)]| {
        [[0.0, 1.0].as_slice(), &[0.0, 0.6, 1.0]].map(|splits| cpu::layered_as_published(depths, 0.7, splits, 0.0, 0.0))
    };
    let [one_map, layer] = bounds(&[(0.3, 0.75), (0.8, 0.25)]);
    assert_close("one map", one_map, 1.0 - 0.275f64.powi(2) / 0.1225, 1e-9);
    assert_close("a layer", layer, 0.75, 1e-9);
    for share in [0.1, 0.5, 0.9] {
        let [one_map, layer] = bounds(&[(0.1, share), (0.65, 1.0 - share)]);
        assert!(layer < one_map, "umbra, {share}: {layer} and {one_map}");
    }
}

#[test]
fn a_layer_knows_that_no_depth_lies_before_it() {
    // Depths nearer than the layer give black for any minimum variance: Markov's bound of mean 0.
    let clamped = [(0.1, 0.5), (0.3, 0.5)];
    for least_variance in [0.0, 1e-4, 1e-2, 1.0] {
        let dark = cpu::layered(&clamped, 0.7, &[0.0, 0.5, 1.0], least_variance);
        assert_close("held at the near end", dark.visibility, 0.0, 1e-12);
    }
    // Light on background far behind the receiver keeps its exact fraction; Chebyshev's bound gives .1 / (.4)² and more.
    for lit in [0.01, 0.1, 0.3] {
        let depths = [(0.1, 1.0 - lit), (1.0, lit)];
        assert_close("background", cpu::layered(&depths, 0.7, &[0.0, 0.5, 1.0], 1e-6).visibility, lit, 1e-12);
    }
    // The closed form is the largest share beyond t of all distributions on a fine grid with these moments. Extreme
    // distributions have three depths, so triples suffice.
    let grid: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
    for (mean, second, t) in [(0.2, 0.12, 0.5), (0.3, 0.1, 0.75), (0.05, 0.04, 0.9), (0.5, 0.3, 0.75), (0.1, 0.02, 0.4)]
    {
        let mut most = 0.0f64;
        for a in &grid {
            for b in grid.iter().filter(|b| *b > a) {
                for c in grid.iter().filter(|c| *c > b) {
                    // Weights by Lagrange polynomials.
                    let weight = |x: f64, y: f64, z: f64| (second - (y + z) * mean + y * z) / ((x - y) * (x - z));
                    let weights = [(*a, weight(*a, *b, *c)), (*b, weight(*b, *a, *c)), (*c, weight(*c, *a, *b))];
                    if weights.iter().all(|(_, w)| *w >= -1e-9) {
                        most = most.max(weights.iter().filter(|(x, _)| *x >= t).map(|(_, w)| w).sum());
                    }
                }
            }
        }
        let bound = cpu::bounded(mean, second - mean * mean, 0.0, t);
        assert!(most <= bound + 1e-9 && most >= bound - 0.02, "{mean} {second} {t}: {bound}, search {most}");
    }
}

#[test]
fn the_least_variance_bears_a_slope_and_its_storage() {
    for (slope, quantum) in [([3e-3, 4e-3], 0.0), ([0.0, 0.0], 1e-4), ([-3e-3, 4e-3], 1e-4)] {
        let least = cpu::minimum_variance(slope, quantum);
        let step = f64::hypot(slope[0], slope[1]);
        // Half a step between texels and eight storage steps are independent standard deviations.
        assert_close("its root", least.sqrt(), f64::hypot(0.5 * step, 8.0 * quantum), 1e-12);
        // A receiver half a storage step behind the mean stays lit except for 0.4 %.
        let lit = cpu::variance(&[(0.5, 1.0)], 0.5 + 0.5 * quantum, least).visibility;
        assert!(quantum == 0.0 || lit >= 1.0 - 0.0039, "{lit} at {slope:?}, {quantum}");
    }
}

#[test]
fn exponential_forms_are_their_definitions() {
    let depths = [(0.2, 0.5), (0.6, 0.5)];
    let decoded = cpu::exponential(&depths, 0.8, 20.0);
    assert_close("e^{-c(t-z)}", decoded.visibility, 0.5 * ((-12f64).exp() + (-4f64).exp()), 1e-12);
    assert_close("mean blocker", decoded.blocker_depth, 0.4, 0.005);
    // Larger exponents reduce bleeding more.
    let bleeding = |c| cpu::exponential_variance(&[(0.1, 0.5), (0.7, 0.5)], 0.8, [c, c], 0.0)[1].visibility;
    assert!(bleeding(20.0) < 0.5 * bleeding(5.0), "{} {}", bleeding(20.0), bleeding(5.0));
}

#[test]
fn the_series_is_a_step_of_its_width() {
    // The first maximum of the series lies 1/(2M) behind the step, and is 0.5 + Si(π)/π = 1.0895, clamped.
    for terms in [4, 16] {
        let width = 0.5 / f64::from(terms);
        assert_close("half at the step", cpu::convolution(&[(0.5, 1.0)], 0.5, terms).visibility, 0.5, 1e-12);
        assert_close("lit", cpu::convolution(&[(0.5, 1.0)], 0.5 - width, terms).visibility, 1.0, 1e-12);
        assert_close("dark", cpu::convolution(&[(0.5, 1.0)], 0.5 + width, terms).visibility, 0.0, 1e-12);
    }
    // Two depths, a quarter period in front of the receiver and behind it.
    let decoded = cpu::convolution(&[(0.25, 0.5), (0.75, 0.5)], 0.5, 64);
    assert_close("half", decoded.visibility, 0.5, 1e-9);
    assert_close("blocker", decoded.blocker_depth, 0.25, 0.01);
}

#[test]
fn moments_solve_three_depths() {
    // A distribution of three depths, one of them the receiver's, is determined by four moments.
    let t = 0.7;
    let depths = [(0.1, 0.3), (0.5, 0.3), (t, 0.4)];
    for decoded in cpu::moment(&depths, t, 0.0) {
        assert_close("visibility", decoded.visibility, 0.4, 1e-6);
        assert_close("blocker", decoded.blocker_depth, 0.3, 1e-6);
    }
}

#[test]
fn bounds_bound_from_above() {
    for i in 0..2000u32 {
        let depths = random_depths(i);
        let t = f64::from(unit_f32(hash_u32(i ^ 0x77aa)));
        let (lit, _) = exact(&depths, t);
        let mut all = vec![cpu::variance(&depths, t, 0.0), cpu::layered(&depths, t, &[0.0, 0.4, 1.0], 0.0)];
        all.extend(cpu::exponential_variance(&depths, t, [10.0, 5.0], 0.0));
        let moments = cpu::moment(&depths, t, 1e-9);
        all.extend(moments);
        for (k, decoded) in all.iter().enumerate() {
            assert!(
                decoded.visibility >= lit - 1e-4,
                "basis {k}: {} below {lit} for {depths:?} at {t}",
                decoded.visibility
            );
            assert!((0.0..=t).contains(&decoded.blocker_depth), "basis {k}: {decoded:?}");
        }
        // Known limits of depth can only tighten the bound.
        assert!(moments[1].visibility <= moments[0].visibility + 1e-4, "{moments:?}");
    }
}

#[test]
fn quantised_moments_fill_the_unit_cube() {
    let mut low = [f64::INFINITY; 4];
    let mut high = [f64::NEG_INFINITY; 4];
    for i in 0..=1000 {
        let q = cpu::quantize_moments(cpu::encode_moments(f64::from(i) / 1000.0));
        for k in 0..4 {
            (low[k], high[k]) = (low[k].min(q[k]), high[k].max(q[k]));
        }
    }
    for k in 0..4 {
        assert_close("least", low[k], 0.0, 1e-4);
        assert_close("greatest", high[k], 1.0, 1e-4);
    }
}

/// Four depths with weights.
fn random_depths(seed: u32) -> [(f64, f64); 4] {
    let random = |i: u32| f64::from(unit_f32(hash_u32(seed.wrapping_mul(31).wrapping_add(i * 7919))));
    let weights: [f64; 4] = std::array::from_fn(|i| 0.02 + random(10 + i as u32));
    let total: f64 = weights.iter().sum();
    std::array::from_fn(|i| (random(i as u32), weights[i] / total))
}

gpu_structs! {
    /// Test case of the shader `probe`.
    pub(crate) struct ProbeInput {
        z: Vec4,
        weights: Vec4,
        t: f32,
        least_variance: f32,
        exponent: f32,
        split: f32,
        moment_bias: f32,
        term_count: u32,
        t_per_texel: Vec2,
        quantum: f32,
        padding_x: f32,
        padding_y: f32,
        padding_z: f32,
    }
}

/// Results of the CPU references for a test case, in the shader's order.
fn cpu_references(input: &ProbeInput) -> [Decoded; 8] {
    let depths: Vec<(f64, f64)> = (0..4).map(|i| (f64::from(input.z[i]), f64::from(input.weights[i]))).collect();
    let t = f64::from(input.t);
    let least_variance = f64::from(input.least_variance);
    let c = f64::from(input.exponent);
    let [two, four] = cpu::exponential_variance(&depths, t, [c, 0.5 * c], least_variance);
    let [whole_line, interval] = cpu::moment(&depths, t, f64::from(input.moment_bias));
    [
        cpu::variance(&depths, t, least_variance),
        cpu::layered_of_step(&depths, t, &[0.0, f64::from(input.split), 1.0], least_variance, input.quantum.into()),
        two,
        four,
        cpu::exponential(&depths, t, c),
        cpu::convolution(&depths, t, input.term_count),
        whole_line,
        interval,
    ]
}

#[test]
fn shaders_equal_their_cpu_references() {
    let Some(gpu) = gpu() else { return };
    let inputs: Vec<ProbeInput> = (0..3000u32)
        .map(|i| {
            let random = |k: u32| unit_f32(hash_u32(i.wrapping_mul(101).wrapping_add(k * 7)));
            let depths = random_depths(i);
            ProbeInput {
                z: Vec4::from_array(depths.map(|(z, _)| z as f32)),
                weights: Vec4::from_array(depths.map(|(_, w)| w as f32)),
                t: random(1),
                least_variance: 1e-4 * random(2),
                exponent: 2.0 + 18.0 * random(3),
                split: 0.1 + 0.8 * random(4),
                moment_bias: 1e-4,
                term_count: 1 + i % 16,
                t_per_texel: 0.01 * Vec2::new(random(5), -random(6)),
                quantum: 1e-3 * random(7),
                ..bytemuck::Zeroable::zeroed()
            }
        })
        .collect();
    let outputs = run_probe(gpu, &inputs);
    // (tolerance of visibility, of blocker depth if more than a twentieth is blocked). Moments are ill-conditioned: their
    // tolerances allow for single precision.
    let tolerances = [
        (2e-4, 2e-4),
        (2e-4, 2e-4),
        (2e-4, 2e-3),
        (2e-4, 2e-3),
        (1e-4, 1e-3),
        (1e-4, 1e-3),
        (0.01, 0.01),
        (0.01, 0.01),
    ];
    let mut worst = [(0.0f64, 0.0f64); 8];
    for (input, output) in inputs.iter().zip(&outputs) {
        for (k, (got, want)) in output.iter().zip(cpu_references(input)).enumerate() {
            assert!(got[0].is_finite() && got[1].is_finite(), "basis {k}: {got:?} for {input:?}");
            let visibility = (f64::from(got[0]) - want.visibility).abs();
            let depth = (f64::from(got[1]) - want.blocker_depth).abs();
            worst[k].0 = worst[k].0.max(visibility);
            // If everything is lit, the blocker depth is the receiver's own.
            let all_lit = want.visibility == 1.0 && got[0] == 1.0;
            if want.visibility < 0.95 || all_lit {
                worst[k].1 = worst[k].1.max(depth);
            }
        }
        let [slope_x, slope_y] = input.t_per_texel.as_dvec2().to_array();
        let least = cpu::minimum_variance([slope_x, slope_y], f64::from(input.quantum));
        assert_close("least variance, of its own size", f64::from(output[8][0]) / least, 1.0, 1e-5);
        let depths: Vec<(f64, f64)> = (0..4).map(|i| (f64::from(input.z[i]), f64::from(input.weights[i]))).collect();
        let splits = [0.0, f64::from(input.split), 1.0];
        let (least, quantum) = (f64::from(input.least_variance), f64::from(input.quantum));
        let printed = cpu::layered_as_published(&depths, f64::from(input.t), &splits, least, quantum);
        assert_close("a layer as printed", f64::from(output[8][1]), printed, 2e-4);
    }
    println!("worst differences: {worst:?}");
    for (k, (worst, tolerance)) in worst.iter().zip(tolerances).enumerate() {
        assert!(worst.0 <= tolerance.0 && worst.1 <= tolerance.1, "basis {k}: {worst:?} against {tolerance:?}");
    }
}

bindings! {
    struct Probe = "depth basis probe", COMPUTE, group 0 of [DEPTH_BASIS_PROBE] {
        0 inputs: Storage,
        1 outputs: ReadWrite,
    }
}

fn run_probe(gpu: &Gpu, inputs: &[ProbeInput]) -> Vec<[[f32; 2]; 9]> {
    let layout = Probe::layout(gpu);
    let pipeline = compute_pipeline(gpu, "test probe", shaders::DEPTH_BASIS_PROBE, &[&layout]);
    let buffer = |bytes: u64, usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test probe"),
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    };
    let input_bytes: &[u8] = bytemuck::cast_slice(inputs);
    let output_bytes = inputs.len() as u64 * 72;
    let input = buffer(input_bytes.len() as u64, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
    gpu.queue.write_buffer(&input, 0, input_bytes);
    let output = buffer(output_bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = buffer(output_bytes, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
    let bind_group = Probe { inputs: &input, outputs: &output }.cached_group(gpu, &layout);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.dispatch_workgroups((inputs.len() as u32).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, output_bytes);
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&read_buffer(gpu, &readback, output_bytes))
}
