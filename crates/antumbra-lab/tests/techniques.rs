//! The techniques against the ray tracer, on the built-in scenes. Bounds are what was measured on a software adapter,
//! with a little room; they may be tightened, never loosened.
//!
//! One device serves the whole binary. Where there is no adapter every test says *skipped*.

use std::sync::OnceLock;
use std::time::Duration;

use antumbra::{Gpu, TechniqueKind};
use antumbra_lab::device::{DeviceOptions, LabDevice};
use antumbra_lab::metrics::{Metrics, compare_visibility};
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Silent;
use antumbra_lab::technique_run::{TechniqueChoice, Timing, create};
use antumbra_lab::truth::{LightTruth, trace};
use antumbra_lab::view::View;
use antumbra_light::Light;
use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::{UVec2, Vec3};

const SIZE: UVec2 = UVec2::new(256, 144);
const ONCE: Timing = Timing { warm_up: 0, frames: 1, at_most: Duration::ZERO };

fn lab() -> Option<&'static LabDevice> {
    static LAB: OnceLock<Option<LabDevice>> = OnceLock::new();
    LAB.get_or_init(|| {
        let lab = LabDevice::new(&DeviceOptions { adapter: None, wanted_features: Gpu::WANTED_FEATURES });
        lab.inspect_err(|error| println!("skipped: {error}")).ok()
    })
    .as_ref()
}

/// A scene with its truth.
struct Judged {
    spec: String,
    scene: Scene,
    setup: Setup,
    truth: LightTruth,
}

impl Judged {
    fn new(spec: &str, change: impl FnOnce(&mut Light)) -> Self {
        let scene = load(spec, &LoadOptions::default()).expect("a built-in scene");
        let mut setup = Setup::for_scene(&scene);
        change(&mut setup.lights[0]);
        let truth = trace(&scene, &setup, SIZE, &VisibilityOptions::default(), &Silent)
            .expect("built-in scenes can be traced")
            .swap_remove(0);
        Self { spec: spec.into(), scene, setup, truth }
    }

    /// The mask of a technique.
    fn run(&self, lab: &LabDevice, kind: TechniqueKind, settings: &[(&str, &str)]) -> Visibility {
        let settings = settings.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        let mut technique = create(&lab.gpu(), &TechniqueChoice { kind, settings }).expect("good settings");
        let view = View::new(lab, &self.scene, &self.setup, SIZE).expect("built-in scenes can be seen");
        view.run(&mut technique, 0, &ONCE).expect("built-in scenes can be run").visibility
    }

    fn metrics(&self, visibility: &Visibility) -> Metrics {
        compare_visibility(&self.truth.visibility, visibility, &self.truth.judged).expect("images of one size")
    }
}

#[test]
fn multi_view_converges_to_the_truth() {
    let Some(lab) = lab() else { return };
    for (spec, bound) in [
        ("builtin:overlap", 0.006),
        ("builtin:columns", 0.008),
        ("builtin:leaning-plank", 0.005),
        ("builtin:stacked-panels", 0.008),
        ("builtin:lantern-wall", 0.009),
        ("builtin:window", 0.013),
        ("builtin:tilted-planes", 0.018),
        ("builtin:spheres", 0.008),
    ] {
        let judged = Judged::new(spec, |_| {});
        let error = |samples: &str| {
            let settings = [("samples", samples), ("sample_set", "stratified")];
            judged.metrics(&judged.run(lab, TechniqueKind::MultiView, &settings)).rmse.expect("judged pixels")
        };
        let (few, many) = (error("16"), error("256"));
        println!("{spec}: rmse {few:.4} with 16 views, {many:.4} with 256");
        assert!(many < bound, "{spec}: rmse {many} against {bound}");
        assert!(many <= few + 0.001, "{spec}: more views made it worse: {few} to {many}");
    }
}

#[test]
fn pcss_keeps_its_figures() {
    let Some(lab) = lab() else { return };
    for (spec, bound) in [
        ("builtin:overlap", 0.052),
        ("builtin:columns", 0.024),
        ("builtin:leaning-plank", 0.012),
        ("builtin:lantern-wall", 0.046),
        ("builtin:stacked-panels", 0.045),
        ("builtin:window", 0.072),
    ] {
        let judged = Judged::new(spec, |_| {});
        let pcss = judged.metrics(&judged.run(lab, TechniqueKind::Pcss, &[])).rmse.expect("judged pixels");
        let pcf = judged.metrics(&judged.run(lab, TechniqueKind::Pcf, &[])).rmse.expect("judged pixels");
        println!("{spec}: rmse pcss {pcss:.4}, pcf {pcf:.4}");
        assert!(pcss < bound, "{spec}: rmse {pcss} against {bound}");
        assert!(pcss < pcf, "{spec}: a fixed kernel beats the light's own: {pcss} against {pcf}");
    }
}

#[test]
fn nothing_needs_a_bias_tuned_down_to_grazing_light() {
    let Some(lab) = lab() else { return };
    for scene in ["tilted-planes", "spheres"] {
        for elevation in [5, 10, 20, 40, 90] {
            let judged = Judged::new(&format!("builtin:{scene}?light_elevation_deg={elevation}"), |_| {});
            let contact = contact_umbra(&judged);
            for kind in [TechniqueKind::Hard, TechniqueKind::Pcf, TechniqueKind::Pcss, TechniqueKind::MultiView] {
                let visibility = judged.run(lab, kind, &[]);
                let lit_loss = judged.metrics(&visibility).lit_loss.expect("lit pixels");
                let leak = mean_at(&visibility, &contact);
                println!(
                    "{}: {kind}: lit_loss {lit_loss:.4}, umbra_leak {leak:.4} in {} pixels at contacts",
                    judged.spec,
                    contact.len()
                );
                let (most_lit_loss, most_leak) = grazing_bounds(kind, elevation);
                assert!(lit_loss <= most_lit_loss, "{}: {kind}: lit_loss {lit_loss}", judged.spec);
                assert!(leak <= most_leak, "{}: {kind}: umbra_leak {leak} at contacts", judged.spec);
            }
        }
    }
}

/// The most lit_loss, and the most umbra_leak within five texels of a contact.
///
/// The bias itself costs 0.005 and 0.03 at the most, which `hard` and `multi_view` keep at every angle. `pcf` blurs its
/// own three texels into the five; `pcss` averages the blockers that a grazing segment passes, and so leaks at contacts
/// below 20 degrees: faults of the methods, held where they are.
fn grazing_bounds(kind: TechniqueKind, elevation_deg: u32) -> (f64, f64) {
    match (kind, elevation_deg) {
        (TechniqueKind::Pcf, _) => (0.005, 0.075),
        (TechniqueKind::Pcss, 5) => (0.005, 0.075),
        (TechniqueKind::Pcss, 10) => (0.005, 0.045),
        (TechniqueKind::Pcss, 20) => (0.005, 0.035),
        _ => (0.005, 0.03),
    }
}

/// Umbra pixels within five texels of a contact: what blocks the way to the light's centre is nearer than that.
fn contact_umbra(judged: &Judged) -> Vec<usize> {
    const TEXELS: f32 = 5.0;
    let tracer = Tracer::new(&judged.scene).expect("built-in scenes can be traced");
    let receivers = tracer.primary(&judged.setup.camera, SIZE);
    let light = &judged.setup.lights[0];
    let frame = light.frame();
    // The map's window in tangents, as a square about the scene's box.
    let corners = judged.scene.bounds().corners();
    let tangents = corners.map(|c| {
        let p = c - frame.center;
        Vec3::new(p.dot(frame.right), p.dot(frame.up), p.dot(frame.axis))
    });
    let extent = |axis: fn(&Vec3) -> f32| {
        let values = tangents.iter().filter(|p| p.z > 0.1).map(axis);
        values.clone().fold(f32::NEG_INFINITY, f32::max) - values.fold(f32::INFINITY, f32::min)
    };
    let window = extent(|p| p.x / p.z).max(extent(|p| p.y / p.z)).min(2.0 * 5.67);
    (0..receivers.points.len())
        .filter(|i| judged.truth.judged[*i] && judged.truth.visibility.at(*i, 0) < 0.01)
        .filter(|i| {
            let Some(point) = &receivers.points[*i] else { return false };
            let origin = point.origin();
            let texel_m = window / 1024.0 * (origin - frame.center).dot(frame.axis);
            let towards = (light.center - origin).normalize();
            tracer.occluded(origin, origin + TEXELS * texel_m * towards)
        })
        .collect()
}

fn mean_at(visibility: &Visibility, pixels: &[usize]) -> f64 {
    let sum: f64 = pixels.iter().map(|i| f64::from(visibility.at(*i, 0))).sum();
    if pixels.is_empty() { 0.0 } else { sum / pixels.len() as f64 }
}

#[test]
fn a_zero_size_light_gives_the_traced_hard_shadow() {
    let Some(lab) = lab() else { return };
    let judged = Judged::new("builtin:columns", |light| *light = light.scaled(0.0));
    for (kind, bound) in [(TechniqueKind::Hard, 0.06), (TechniqueKind::Pcss, 0.05), (TechniqueKind::MultiView, 0.05)] {
        let error = judged.metrics(&judged.run(lab, kind, &[])).rmse.expect("judged pixels");
        println!("{kind}, zero-size light: rmse {error:.4}");
        assert!(error < bound, "{kind}: rmse {error} against {bound}");
    }
}

#[test]
fn real_scenes_stay_in_range() {
    let Some(lab) = lab() else { return };
    let scenes = std::env::var_os("ANTUMBRA_SCENES").map_or_else(
        || concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes").into(),
        std::path::PathBuf::from,
    );
    for name in ["sponza.glb", "tree-oak-masked.glb", "cesium-man.glb", "stained-glass-window.glb"] {
        let path = scenes.join(name);
        if !path.exists() {
            println!("skipped: {} is not there", path.display());
            continue;
        }
        let spec = path.to_str().expect("a path in UTF-8");
        let scene = load(spec, &LoadOptions::default()).expect("a good scene");
        let setup = Setup::for_scene(&scene);
        let view = View::new(lab, &scene, &setup, UVec2::new(96, 54)).expect("a good scene");
        for kind in [TechniqueKind::Hard, TechniqueKind::Pcf, TechniqueKind::Pcss, TechniqueKind::MultiView] {
            let mut technique = create(&lab.gpu(), &TechniqueChoice::default_of(kind)).expect("default settings");
            if kind == TechniqueKind::MultiView {
                technique.set("samples", "4").expect("in range");
            }
            let mask = view.run(&mut technique, 0, &ONCE).expect("a good frame").visibility;
            let pixels = 96 * 54;
            assert!((0..pixels).all(|i| (0.0..=1.0).contains(&mask.at(i, 0))), "{name}, {kind}");
        }
        lab.check().expect("no validation error");
    }
}
