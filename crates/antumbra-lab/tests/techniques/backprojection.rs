//! `backprojection` against the ray tracer: scenes, every kind of light, and its two papers.

use antumbra::TechniqueKind;
use antumbra_lab::metrics::Metrics;
use antumbra_light::{EmissionTexture, Light, LightShape};
use glam::{Vec2, Vec3};

use crate::common::{Judged, lab};

const KIND: TechniqueKind = TechniqueKind::Backprojection;

fn metrics_of(judged: &Judged, settings: &[(&str, &str)]) -> Metrics {
    judged.metrics(&judged.run(lab().expect("asked for before"), KIND, settings))
}

fn rmse_of(judged: &Judged, settings: &[(&str, &str)]) -> f64 {
    metrics_of(judged, settings).rmse.expect("judged pixels")
}

#[test]
fn backprojection_keeps_its_figures() {
    if lab().is_none() {
        return;
    }
    // Bounds on rmse and on the light in umbrae.
    for (spec, bound, leak_bound) in [
        ("builtin:overlap", 0.0168, 0.0088),
        ("builtin:leaning-plank", 0.0062, 0.0004),
        ("builtin:lantern-wall", 0.025, 0.0057),
        ("builtin:columns", 0.0105, 0.0013),
        ("builtin:window", 0.0358, 0.0045),
        ("builtin:tree", 0.064, 0.039),
    ] {
        let metrics = metrics_of(&Judged::new(spec, |_| {}), &[]);
        let (rmse, leak) = (metrics.rmse.expect("judged pixels"), metrics.umbra_leak.unwrap_or(0.0));
        println!("{spec}: rmse {rmse:.4}, umbra leak {leak:.4}");
        assert!(rmse <= bound, "{spec}: rmse {rmse} against {bound}");
        assert!(leak <= leak_bound, "{spec}: umbra leak {leak} against {leak_bound}");
    }
}

/// A light with its name, and a bound on rmse.
type Lit<'a> = (&'a str, f64, &'a dyn Fn(&mut Light));

#[test]
fn every_kind_of_light_is_known() {
    if lab().is_none() {
        return;
    }
    let all_around = |light: &mut Light, shape: LightShape| {
        (light.shape, light.fov_rad, light.cone) = (shape, None, None);
    };
    let lights: [Lit<'_>; 7] = [
        ("disk", 0.013, &|light| light.shape = LightShape::Disk { radius_m: 0.4 }),
        ("sphere", 0.012, &|light| all_around(light, LightShape::Sphere { radius_m: 0.3 })),
        ("ellipsoid", 0.0216, &|light| all_around(light, LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) })),
        ("sun", 0.0115, &|light| all_around(light, LightShape::Sun { angular_diameter_rad: 0.05 })),
        ("points", 0.053, &|light| {
            let across = 0.2 * Vec3::Y.cross(light.axis).normalize_or(Vec3::X);
            let positions_m = [-across, across, 0.2 * Vec3::Y].map(|offset| light.center + offset).to_vec();
            all_around(light, LightShape::Points { positions_m });
        }),
        ("picture", 0.0273, &|light| {
            light.shape = LightShape::Rectangle { size_m: Vec2::new(0.8, 0.5) };
            let luminance = (0..12).map(|i| (i % 5) as f32).collect();
            light.emission = Some(EmissionTexture::gray(4, 3, luminance));
        }),
        ("tube", 0.039, &|light| light.shape = LightShape::Rectangle { size_m: Vec2::new(0.8, 1e-4) }),
    ];
    for (name, bound, change) in lights {
        let rmse = rmse_of(&Judged::with_truth_of("builtin:columns", 256, change), &[]);
        println!("{name}: rmse {rmse:.4}");
        assert!(rmse <= bound, "{name}: rmse {rmse} against {bound}");
    }
}

/// Leaves at many depths: what each texel hides, added up, is more than they hide.
#[test]
fn outlines_do_not_add_up_what_is_hidden_twice() {
    if lab().is_none() {
        return;
    }
    let judged = Judged::new("builtin:tree", |_| {});
    let (outlines, patches) = (rmse_of(&judged, &[]), rmse_of(&judged, &[("occluders", "patches")]));
    println!("rmse {outlines:.4} by outlines, {patches:.4} by patches");
    assert!(outlines < 0.75 * patches, "{outlines} by outlines, {patches} by patches");
}
