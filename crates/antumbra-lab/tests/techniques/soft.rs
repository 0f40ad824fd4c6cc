//! The pre-filtered soft family against the ray tracer, and `essm` against its brute-force twin, `pcss` with many taps.

use antumbra::TechniqueKind;
use antumbra_lab::progress::Silent;
use antumbra_lab::truth::trace;
use antumbra_reference::{Tracer, VisibilityOptions};
use glam::{UVec2, Vec3};

use crate::common::{Judged, SIZE, lab, mean_at};

/// Enough taps that more change nothing.
const MANY: [(&str, &str); 2] = [("samples", "1024"), ("search_samples", "1024")];

#[test]
fn essm_stays_with_its_brute_force_twin() {
    let Some(lab) = lab() else { return };
    for (spec, from_twin) in [
        ("builtin:leaning-plank", 0.006),
        ("builtin:tree", 0.04),
        ("builtin:window", 0.04),
        ("builtin:overlap", 0.02),
        ("builtin:columns", 0.012),
    ] {
        let judged = Judged::new(spec, |_| {});
        let twin = judged.run(lab, TechniqueKind::Pcss, &MANY);
        // The twin knows no footprint.
        let essm = judged.run(lab, TechniqueKind::Essm, &[("kernel", "isotropic")]);
        let apart = rmse_between(&judged, &twin, &essm);
        let (twin, essm) = (judged.metrics(&twin), judged.metrics(&essm));
        let (twin_rmse, essm_rmse) = (twin.rmse.expect("judged pixels"), essm.rmse.expect("judged pixels"));
        let leaks = (twin.umbra_leak.unwrap_or(0.0), essm.umbra_leak.unwrap_or(0.0));
        println!("{spec}: apart {apart:.4}, rmse pcss {twin_rmse:.4}, essm {essm_rmse:.4}, umbra_leak {leaks:.4?}");
        assert!(apart <= from_twin, "{spec}: {apart} from pcss");
        assert!(essm_rmse <= twin_rmse + 0.02, "{spec}: rmse {essm_rmse} against pcss' {twin_rmse}");
        if spec == "builtin:overlap" {
            assert!(leaks.1 <= leaks.0 + 0.003, "{spec}: umbra_leak {leaks:?}");
        }
    }
}

fn rmse_between(judged: &Judged, a: &antumbra_lab::picture::Visibility, b: &antumbra_lab::picture::Visibility) -> f64 {
    let pixels: Vec<usize> = (0..judged.truth.judged.len()).filter(|i| judged.truth.judged[*i]).collect();
    let sum: f64 = pixels.iter().map(|i| f64::from(a.at(*i, 0) - b.at(*i, 0)).powi(2)).sum();
    (sum / pixels.len() as f64).sqrt()
}

#[test]
fn the_family_keeps_its_figures() {
    let Some(lab) = lab() else { return };
    // Bounds on rmse for leaning-plank, overlap, lantern-wall.
    for (kind, bounds) in [
        (TechniqueKind::PcssAnisotropic, [0.02, 0.06, 0.06]),
        (TechniqueKind::Essm, [0.02, 0.06, 0.06]),
        (TechniqueKind::Savsm, [0.02, 0.08, 0.08]),
        (TechniqueKind::Vssm, [0.014, 0.058, 0.06]),
        (TechniqueKind::Cssm, [0.11, 0.18, 0.18]),
        (TechniqueKind::Evssm, [0.018, 0.05, 0.06]),
        (TechniqueKind::Mssm, [0.014, 0.04, 0.06]),
    ] {
        for (spec, bound) in ["builtin:leaning-plank", "builtin:overlap", "builtin:lantern-wall"].iter().zip(bounds) {
            let judged = Judged::new(spec, |_| {});
            let metrics = judged.metrics(&judged.run(lab, kind, &[]));
            let rmse = metrics.rmse.expect("judged pixels");
            println!("{spec}: {kind}: rmse {rmse:.4}, umbra_leak {:.4}", metrics.umbra_leak.unwrap_or(0.0));
            assert!(rmse < bound, "{spec}: {kind}: rmse {rmse} against {bound}");
        }
    }
}

#[test]
fn essm_keeps_contacts() {
    let Some(lab) = lab() else { return };
    // Large enough for the last five centimetres to have pixels.
    const FINE: UVec2 = UVec2::new(640, 360);
    let judged = Judged::of_size(FINE, "builtin:leaning-plank", |_| {});
    let tracer = Tracer::new(&judged.scene).expect("built-in scenes can be traced");
    let receivers = tracer.primary(&judged.setup.camera, FINE);
    let light = &judged.setup.lights[0];
    const CONTACT_M: f32 = 0.05;
    let contact: Vec<usize> = (0..receivers.points.len())
        .filter(|i| judged.truth.judged[*i] && judged.truth.visibility.at(*i, 0) < 0.01)
        .filter(|i| {
            let Some(point) = &receivers.points[*i] else { return false };
            let origin = point.origin();
            tracer.occluded(origin, origin + CONTACT_M * (light.center - origin).normalize())
        })
        .collect();
    let leak_of = |kernel| mean_at(&judged.run(lab, TechniqueKind::Essm, &[("kernel", kernel)]), &contact);
    let (leak, with_footprint) = (leak_of("isotropic"), leak_of("light"));
    println!(
        "umbra_leak within 5 cm of contact: {leak:.4}, with the pixel's footprint {with_footprint:.4}, in {} pixels",
        contact.len()
    );
    assert!(contact.len() >= 30, "too few pixels: {}", contact.len());
    assert!(leak <= 0.06, "umbra_leak {leak}");
}

#[test]
fn essm_is_continuous_in_the_light_s_size() {
    let Some(lab) = lab() else { return };
    let at = |size_m: f32, kind, settings: &[(&str, &str)]| {
        let judged = Judged::new("builtin:leaning-plank", |light| {
            let own = light.bounding_radius() * std::f32::consts::SQRT_2;
            *light = light.scaled(size_m / own);
        });
        let visibility = judged.run(lab, kind, settings);
        (judged, visibility)
    };
    for size_m in [0.0, 0.02, 0.1, 0.3, 0.6, 1.0] {
        let (judged, a) = at(size_m, TechniqueKind::Essm, &[]);
        let (_, b) = at(size_m + 0.002, TechniqueKind::Essm, &[]);
        let step = rmse_between(&judged, &a, &b);
        println!("{size_m} m to {} m: rmse {step:.5}", size_m + 0.002);
        assert!(step < 0.006, "{size_m} m: {step}");
    }
    let (judged, essm) = at(0.0, TechniqueKind::Essm, &[("kernel", "isotropic")]);
    let (_, pcss) = at(0.0, TechniqueKind::Pcss, &[]);
    let apart = rmse_between(&judged, &essm, &pcss);
    println!("zero size: essm {apart:.5} from pcss");
    assert!(apart < 0.02, "zero size: {apart}");
}

#[test]
fn footprints_take_away_what_aliases() {
    let Some(lab) = lab() else { return };
    const SPEC: &str = "builtin:checker-far";
    const SIDE: u32 = 4;
    let judged = Judged::new(SPEC, |_| {});
    // 16 rays a pixel, and only pixels that see nothing but the ground: what a pixel sees besides is no filter's affair.
    let options = VisibilityOptions { samples: 64, ..VisibilityOptions::default() };
    let fine =
        trace(&judged.scene, &judged.setup, SIDE * SIZE, &options, &Silent).expect("can be traced").swap_remove(0);
    let tracer = Tracer::new(&judged.scene).expect("built-in scenes can be traced");
    let points = tracer.primary(&judged.setup.camera, SIDE * SIZE).points;
    let is_ground = |position: Vec3| position.y.abs() < 1e-3;
    let mut truth = Vec::new();
    for i in 0..SIZE.x * SIZE.y {
        let inside: Vec<usize> = (0..SIDE * SIDE)
            .map(|s| {
                let (x, y) = (i % SIZE.x * SIDE + s % SIDE, i / SIZE.x * SIDE + s / SIDE);
                (y * SIDE * SIZE.x + x) as usize
            })
            .collect();
        let all_ground = inside.iter().all(|j| points[*j].as_ref().is_some_and(|point| is_ground(point.position)));
        if all_ground && judged.truth.judged[i as usize] {
            truth.push((i as usize, mean_at(&fine.visibility, &inside)));
        }
    }
    let map = ("map_size", "4096");
    let error = |kind, settings: &[(&str, &str)]| {
        let visibility = judged.run(lab, kind, settings);
        let sum: f64 = truth.iter().map(|(i, v)| (f64::from(visibility.at(*i, 0)) - v).powi(2)).sum();
        (sum / truth.len() as f64).sqrt()
    };
    let pcss = error(TechniqueKind::Pcss, &[map]);
    let anisotropic = error(TechniqueKind::PcssAnisotropic, &[map]);
    let essm = error(TechniqueKind::Essm, &[map]);
    println!("{} pixels: pcss {pcss:.4}, pcss_anisotropic {anisotropic:.4}, essm {essm:.4}", truth.len());
    assert!(3.0 * essm <= pcss, "essm {essm} against pcss {pcss}");
    assert!(2.0 * anisotropic <= pcss, "pcss_anisotropic {anisotropic} against pcss {pcss}");
}
