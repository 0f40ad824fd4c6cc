//! Shared tests of techniques that project a map's texels onto the light: scenes and kinds of light, with a bound for each.

use antumbra::TechniqueKind;
use antumbra_light::LightShape;
use glam::Vec2;

use crate::common::{Judged, lab};
use crate::lights::{Change, LIGHTS};

pub(crate) fn rmse_of(judged: &Judged, kind: TechniqueKind, settings: &[(&str, &str)]) -> f64 {
    let mask = judged.run(lab().expect("asked for before"), kind, settings);
    judged.metrics(&mask).rmse.expect("judged pixels")
}

/// Checks a technique against bounds on RMSE and umbra leak, by scene.
pub(crate) fn keeps_its_figures(kind: TechniqueKind, bounds: &[(&str, f64, f64)]) {
    let Some(lab) = lab() else { return };
    for (spec, bound, leak_bound) in bounds {
        let judged = Judged::new(spec, |_| {});
        let metrics = judged.metrics(&judged.run(lab, kind, &[]));
        let (rmse, leak) = (metrics.rmse.expect("judged pixels"), metrics.umbra_leak.unwrap_or(0.0));
        println!("{spec}: rmse {rmse:.4}, umbra leak {leak:.4}");
        assert!(rmse <= *bound, "{spec}: rmse {rmse} against {bound}");
        assert!(leak <= *leak_bound, "{spec}: umbra leak {leak} against {leak_bound}");
    }
}

/// Checks bounds on RMSE under every kind of light: a disk, a sphere, an ellipsoid, a sun, points, an emission texture, a tube.
pub(crate) fn knows_every_light(kind: TechniqueKind, bounds: [f64; 7]) {
    if lab().is_none() {
        return;
    }
    let tube: Change = ("tube", |light| light.shape = LightShape::Rectangle { size_m: Vec2::new(0.8, 1e-4) });
    for ((name, change), bound) in LIGHTS.into_iter().chain([tube]).zip(bounds) {
        let rmse = rmse_of(&Judged::with_truth_of("builtin:columns", 256, change), kind, &[]);
        println!("{name}: rmse {rmse:.4}");
        assert!(rmse <= bound, "{name}: rmse {rmse} against {bound}");
    }
}
