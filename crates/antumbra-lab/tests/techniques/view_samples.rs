//! Work of `alias_free` and `sample_based`, and its growth.

use antumbra::techniques::receiver_lists::sample_based::{
    RegionOfInfluence, SampleBased, SampleBasedParams, Traversal,
};
use antumbra::{Casters, Frame, Mask, Recorder, Shadow, TechniqueKind};
use antumbra_lab::device::LabDevice;
use antumbra_lab::gpu_scene::GpuScene;
use antumbra_lab::readback::read_buffer;
use antumbra_lab::receivers::{Layer, ReceiverPass};
use antumbra_light::{Light, LightShape};
use antumbra_scene::{LoadOptions, Setup, load};
use glam::UVec2;

use crate::common::{Judged, lab};
use crate::sample_based::Change;

/// Numbers of tests in a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts {
    boxes: u32,
    triangles: u32,
    pairs: u32,
    pairs_near: u32,
    words: u32,
    points: u32,
}

impl Counts {
    pub(crate) fn all(self) -> [u32; 6] {
        [self.boxes, self.triangles, self.pairs, self.pairs_near, self.words, self.points]
    }
}

pub(crate) fn counts(
    lab: &LabDevice,
    spec: &str,
    size: UVec2,
    params: &SampleBasedParams,
    change: impl FnOnce(&mut Light),
) -> Counts {
    let scene = load(spec, &LoadOptions::default()).expect("a scene that is there");
    let mut setup = Setup::for_scene(&scene);
    change(&mut setup.lights[0]);
    let gpu_scene = GpuScene::upload(lab, &scene);
    let images = ReceiverPass::new(lab)
        .render(lab, &gpu_scene, &setup.camera, size, Layer::FirstHits)
        .expect("a scene that can be seen");
    let gpu = lab.gpu();
    let params = SampleBasedParams { count_tests: true, ..*params };
    let mut shadow = Shadow::<SampleBased>::with_params(&gpu, params).expect("a device with WebGPU's limits");
    let mask = Mask::new(&lab.device, size);
    let casters = gpu_scene.casters();
    let frame = Frame {
        light: &setup.lights[0],
        casters: Casters::Meshes(&casters),
        receivers: images.receivers(),
        mask: &mask,
    };
    let work = shadow.prepare(&frame).expect("a good frame");
    let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    work.record(&mut Recorder::new(&mut encoder, None));
    lab.queue.submit([encoder.finish()]);
    let counts = shadow.technique().test_counts().expect("tests are counted");
    let c: Vec<u32> = read_buffer(lab, counts, 8).expect("a device that works");
    Counts { boxes: c[2], triangles: c[3], pairs: c[4], pairs_near: c[5], words: c[6], points: c[7] }
}

/// Multiplications of all tests: eighteen planes per box and per vertex of a triangle; a pair projects its vertices to the light; a near
/// pair computes four planes, which are tested against the box of a word of light samples, or against a sample.
fn tests(c: Counts) -> f64 {
    let of_each = [18 * 3, 18 * 9, 9 * 3 + 12, 9 * 9 + 4 * 12, 4 * 6, 4 * 3];
    c.all().into_iter().zip(of_each).map(|(count, each)| f64::from(count) * f64::from(each)).sum()
}

/// Counts without tests against boxes and groups.
fn of_receivers(c: Counts) -> Counts {
    Counts { boxes: 0, triangles: 0, ..c }
}

const SMALL: UVec2 = UVec2::new(64, 36);

#[test]
fn tests_grow_at_most_as_triangles_do() {
    let Some(lab) = lab() else { return };
    let params = SampleBasedParams::default();
    let of = |triangles: u32| counts(lab, &format!("builtin:knot?triangles={triangles}"), SMALL, &params, |_| {});
    let (few, many) = (of(10_000), of(100_000));
    println!("10 000: {few:?}\n100 000: {many:?}");
    assert!(tests(many) <= 10.0 * tests(few), "{}", tests(many) / tests(few));
}

#[test]
fn tests_grow_at_most_as_the_light_s_radius_does() {
    let Some(lab) = lab() else { return };
    let params = SampleBasedParams::default();
    let of = |radius_m: f32| {
        let change = |light: &mut Light| light.shape = LightShape::Disk { radius_m };
        counts(lab, "builtin:knot?triangles=6000", SMALL, &params, change)
    };
    let all = [0.1, 0.2, 0.4, 0.8].map(|radius| (radius, of(radius)));
    for pair in all.windows(2) {
        println!("{} m: {:?}\n{} m: {:?}", pair[0].0, pair[0].1, pair[1].0, pair[1].1);
        assert!(tests(pair[1].1) <= 2.0 * tests(pair[0].1), "{}", tests(pair[1].1) / tests(pair[0].1));
    }
}

/// More light samples than are tested together with alpha-tested or tinted casters, and more than one batch of triangles.
#[test]
fn holes_and_tint_take_any_number_of_points() {
    let Some(lab) = lab() else { return };
    for (scene, bound) in [("stained-glass", 0.0068), ("fence-alpha", 0.0067)] {
        let judged = Judged::of_size(UVec2::new(64, 36), &format!("builtin:{scene}"), |_| {});
        let rmse = |samples: &str| {
            let settings = [("samples", samples), ("sample_set", "sobol")];
            judged
                .metrics(&judged.run(lab, TechniqueKind::SampleBased, &settings))
                .rmse
                .expect("pixels that face the light")
        };
        let (few, many) = (rmse("256"), rmse("1024"));
        println!("{scene}: rmse {few:.4} with 256, {many:.4} with 1024");
        assert!(many <= bound && many <= few + 0.002, "{scene}: rmse {few} with 256, {many} with 1024");
    }
}

/// Triangles are drawn if few receivers share a texel and walked if many do; only walking tests boxes.
#[test]
fn the_device_chooses_by_how_crowded_lists_are() {
    let Some(lab) = lab() else { return };
    let of = |map_size: u32| {
        let params =
            SampleBasedParams { traversal: Traversal::Chosen, samples: 32, map_size, ..SampleBasedParams::default() };
        counts(lab, "builtin:columns", UVec2::new(256, 144), &params, |_| {})
    };
    let (spread, crowded) = (of(512), of(16));
    println!("spread: {spread:?}\ncrowded: {crowded:?}");
    assert!(spread.boxes == 0 && spread.triangles > 0, "{spread:?}");
    assert!(crowded.boxes > 0 && crowded.pairs > 0, "{crowded:?}");
}

/// Savings of section 4.3; another test checks that no bit changes.
#[test]
fn every_switch_saves_tests() {
    let Some(lab) = lab() else { return };
    let on = SampleBasedParams { penumbra_only: true, ..SampleBasedParams::default() };
    for scene in ["columns", "knot?triangles=20000"] {
        let of = |params: &SampleBasedParams| counts(lab, &format!("builtin:{scene}"), SMALL, params, |_| {});
        let with = of(&on);
        let all = tests(with);
        for (name, off) in [
            ("stop_when_occluded", SampleBasedParams { stop_when_occluded: false, ..on }),
            ("penumbra_only", SampleBasedParams { penumbra_only: false, ..on }),
            ("cut_by_plane", SampleBasedParams { cut_by_plane: false, ..on }),
            ("cull_facing", SampleBasedParams { cull_facing: false, ..on }),
        ] {
            let without = of(&off);
            println!("{scene} without {name}: {:.2} times the tests, {without:?}", tests(without) / all);
            // Each search for silhouettes may succeed, and is no test of receivers.
            let (without, all) =
                if name == "penumbra_only" { (of_receivers(without), of_receivers(with)) } else { (without, with) };
            assert!(tests(without) >= 0.99 * tests(all), "{scene}: {name} costs tests");
        }
        let drawn = SampleBasedParams { traversal: Traversal::Raster, ..on };
        // Early termination depends on the order of fragments, so the other switches are compared without it.
        let unstopped = SampleBasedParams { stop_when_occluded: false, ..drawn };
        for (name, on, off) in [
            ("stop_when_occluded", drawn, unstopped),
            ("penumbra_only", unstopped, SampleBasedParams { penumbra_only: false, ..unstopped }),
            ("cut_by_plane", unstopped, SampleBasedParams { cut_by_plane: false, ..unstopped }),
            ("cull_facing", unstopped, SampleBasedParams { cull_facing: false, ..unstopped }),
        ] {
            let (with, without) = (tests(of(&on)), of(&off));
            println!("{scene}, drawn, without {name}: {:.3} times the tests, {without:?}", tests(without) / with);
            assert!(tests(without) >= with, "{scene}: {name} costs tests");
        }
    }
}

/// Under a small light, most texels in shadow are far from all silhouettes.
#[test]
fn silhouettes_save_tests_where_umbrae_are_wide() {
    let Some(lab) = lab() else { return };
    let drawn = SampleBasedParams { traversal: Traversal::Raster, penumbra_only: true, ..SampleBasedParams::default() };
    let small = |light: &mut Light| light.shape = LightShape::Disk { radius_m: 0.02 };
    for scene in ["overlap", "columns"] {
        let of = |params: &SampleBasedParams| counts(lab, &format!("builtin:{scene}"), SMALL, params, small);
        let (with, without) = (of(&drawn), of(&SampleBasedParams { penumbra_only: false, ..drawn }));
        println!("{scene}: {:.2} times the tests without; {with:?}, {without:?}", tests(without) / tests(with));
        assert!(without.words > with.words && tests(without) > tests(with), "{scene}: {with:?}, {without:?}");
    }
}

/// Hexagons around a sphere fit more tightly than boxes; an ellipsoid around a rectangle is √2 times as wide.
#[test]
fn hexagons_hold_about_as_many_receivers_as_boxes() {
    let Some(lab) = lab() else { return };
    let boxes = SampleBasedParams { traversal: Traversal::Raster, ..SampleBasedParams::default() };
    let hexagons = SampleBasedParams { region: RegionOfInfluence::Hexagons, ..boxes };
    let sphere = |light: &mut Light| light.shape = LightShape::Sphere { radius_m: 0.3 };
    let sun = |light: &mut Light| light.shape = LightShape::Sun { angular_diameter_rad: 0.1 };
    let none = |_: &mut Light| {};
    let cases: [(&str, f64, Change<'_>); 3] =
        [("rectangle", 1.2, &none), ("sphere", 1.05, &sphere), ("sun", 1.05, &sun)];
    for (name, bound, change) in cases {
        let of = |params: &SampleBasedParams| counts(lab, "builtin:columns", SMALL, params, change);
        let (boxes, hexagons) = (of(&boxes), of(&hexagons));
        let times = f64::from(hexagons.pairs) / f64::from(boxes.pairs);
        println!("{name}: {times:.2} times the pairs; {boxes:?}, {hexagons:?}");
        assert!((0.5..bound).contains(&times), "{name}: {times}");
    }
}

#[test]
fn the_stencil_drops_fragments_over_empty_lists() {
    let Some(lab) = lab() else { return };
    let without = SampleBasedParams { traversal: Traversal::Raster, ..SampleBasedParams::default() };
    let of = |params: &SampleBasedParams| counts(lab, "builtin:columns", SMALL, params, |_| {});
    let (with, without) = (of(&SampleBasedParams { stencil: true, ..without }), of(&without));
    println!("with {with:?}, without {without:?}");
    assert_eq!(with.pairs, without.pairs);
    if lab.device.features().contains(wgpu::Features::SHADER_EARLY_DEPTH_TEST) {
        assert!(with.triangles * 4 < without.triangles, "{with:?}, {without:?}");
    }
}

/// Tests that the paper's method would need: every receiver in a texel of a triangle's region.
#[test]
#[ignore = "prints a table for the documentation"]
fn tests_of_rasterised_regions() {
    let Some(lab) = lab() else { return };
    let groups = SampleBasedParams::default();
    let raster = SampleBasedParams { traversal: Traversal::Raster, ..groups };
    for scene in ["columns", "knot?triangles=20000", "hairball"] {
        let of = |params: &SampleBasedParams| counts(lab, &format!("builtin:{scene}"), SMALL, params, |_| {});
        let hexagons = of(&SampleBasedParams { region: RegionOfInfluence::Hexagons, ..raster });
        let (groups, raster) = (of(&groups), of(&raster));
        let times = f64::from(raster.pairs) / f64::from(groups.pairs);
        println!(
            "{scene}: {times:.1} times the pairs; groups {groups:?}, rasterised {raster:?}, hexagons {hexagons:?}"
        );
    }
}
