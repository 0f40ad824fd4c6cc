//! Radiance by the plain product and by the ratio estimator, against ray-traced radiance.
//!
//! Analytic irradiance of an area light times a mask is what a renderer shows of a white diffuse surface. With `weights=irradiance`
//! masks hold the part of the light's irradiance that arrives, and otherwise the part of the light that is seen (Heitz, Hill, McGuire,
//! "Combining Analytic Direct Illumination and Stochastic Shadows", I3D 2018). This prints, for each scene and technique, the root
//! mean square error of both products over all pixels that show a surface, as parts of the mean unshadowed irradiance:
//!
//! ```text
//! cargo run --release --package antumbra-lab --example ratio
//! cargo run --release --package antumbra-lab --example ratio -- builtin:hall builtin:overlap
//! ```

use antumbra::TechniqueKind;
use antumbra_lab::device::{DeviceOptions, LabDevice};
use antumbra_lab::irradiance::{analytic, traced};
use antumbra_lab::picture::VisibilityValues;
use antumbra_lab::technique_run::TechniqueChoice;
use antumbra_lab::view::View;
use antumbra_reference::{ReceiverPoint, Receivers, Tracer, VisibilityOptions};
use antumbra_scene::{LoadOptions, Setup, load};
use glam::{UVec2, Vec3};

const SCENES: [&str; 7] = [
    "builtin:overlap",
    "builtin:window",
    "builtin:columns",
    "builtin:hall",
    "builtin:staircase",
    "builtin:leaning-plank",
    "builtin:fence-geometry",
];
const SIZE: UVec2 = UVec2::new(240, 135);
/// Rays to the light from each pixel, for the truth.
const TRUTH: VisibilityOptions = VisibilityOptions {
    samples: 4096,
    set: antumbra_light::SampleSet::Stratified,
    seed: 0,
    same_set_for_all_pixels: false,
};
const TECHNIQUES: [TechniqueKind; 3] = [TechniqueKind::RayTraced, TechniqueKind::SampleBased, TechniqueKind::Smrt];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let scenes = if given.is_empty() { SCENES.map(str::to_owned).into() } else { given };
    let lab = LabDevice::new(&DeviceOptions { adapter: None, wanted_features: antumbra::Gpu::WANTED_FEATURES })?;
    println!(
        "| scene | pixels | exact V × E | {} |",
        TECHNIQUES.map(|kind| format!("{kind}: V × E | R × E")).join(" | ")
    );
    for spec in scenes {
        let scene = load(&spec, &LoadOptions::default())?;
        let setup = Setup::for_scene(&scene);
        let view = View::new(&lab, &scene, &setup, SIZE)?;
        let tracer = Tracer::new(&scene)?;
        // Rays start where the camera's rays meet surfaces; what shows another surface in the depth buffer is left out.
        let mut receivers = tracer.primary(&setup.camera, SIZE);
        for (hit, drawn) in receivers.points.iter_mut().zip(view.surface_points()?) {
            let is_same = |hit: &ReceiverPoint| {
                drawn.is_some_and(|drawn| is_near(hit, drawn.position, drawn.normal, setup.camera.eye))
            };
            *hit = hit.filter(is_same);
        }
        let light = &setup.lights[0];
        let truth = traced(&tracer, &receivers, light, &TRUTH)?;
        let unshadowed = unshadowed(&lab, light, &receivers)?;
        let mean = unshadowed.iter().sum::<f64>() / receivers.hits() as f64;
        let error = |factor: &dyn Fn(usize) -> f64| {
            let squares = truth
                .iter()
                .enumerate()
                .filter_map(|(i, truth)| truth.map(|truth| (factor(i) * unshadowed[i] - truth.arriving).powi(2)));
            (squares.sum::<f64>() / receivers.hits() as f64).sqrt() / mean
        };
        let mut line = format!("| `{spec}` | {} ", receivers.hits());
        line += &format!("| {:.4} ", error(&|i| truth[i].map_or(0.0, |truth| truth.visibility)));
        for kind in TECHNIQUES {
            for weights in ["emission", "irradiance"] {
                let choice = TechniqueChoice::with_settings(kind, vec![("weights".into(), weights.into())]);
                let drawn = view.draw(&mut view.create(&choice)?, 0, 1)?;
                let mask: Vec<f64> = match drawn.visibility.values {
                    VisibilityValues::One(values) => values.into_iter().map(f64::from).collect(),
                    VisibilityValues::Three(values) => values.into_iter().map(|v| f64::from(v.y)).collect(),
                };
                line += &format!("| {:.4} ", error(&|i| mask[i]));
            }
        }
        println!("{line}|");
    }
    Ok(())
}

/// Whether the ray tracer's camera ray and the depth buffer show the same face at a pixel.
fn is_near(hit: &ReceiverPoint, position: Vec3, normal: Vec3, eye: Vec3) -> bool {
    hit.position.distance(position) <= 2e-3 * hit.position.distance(eye) && hit.normal.dot(normal) >= 0.99
}

/// Analytic irradiance by pixel; 0 for background, and where the light does not reach.
fn unshadowed(
    lab: &LabDevice,
    light: &antumbra_light::Light,
    receivers: &Receivers,
) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let places: Vec<_> =
        receivers.points.iter().map(|point| point.map_or((Vec3::ZERO, Vec3::Y), |p| (p.position, p.normal))).collect();
    let frame = light.frame();
    let values = analytic(lab, light, &places)?.into_iter().zip(&receivers.points);
    let reached = |point: &Option<ReceiverPoint>| point.is_some_and(|point| light.reaches(&frame, point.position));
    Ok(values.map(|(value, point)| if reached(point) { f64::from(value) } else { 0.0 }).collect())
}
