//! Unusual scenes, lights and images: every technique draws a mask in [0, 1], or fails with one line.

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;
use antumbra_lab::progress::Silent;
use antumbra_lab::technique_run::{TechniqueChoice, create};
use antumbra_lab::truth::{LightTruth, trace};
use antumbra_lab::view::View;
use antumbra_light::{Light, LightShape};
use antumbra_reference::VisibilityOptions;
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::{Mat4, UVec2, Vec2, Vec3};

use crate::common::lab;

/// Image size that is not a multiple of any workgroup size.
const SIZE: UVec2 = UVec2::new(31, 17);

/// Settings that reduce the work: these tests check validity rather than quality.
const QUICK: [(&str, &str); 6] = [
    ("map_size", "128"),
    ("view_size", "128"),
    ("samples", "8"),
    ("search_samples", "8"),
    ("kernel_size", "3"),
    ("central_scale", "1"),
];

fn plank() -> (Scene, Setup) {
    let scene = load("builtin:leaning-plank", &LoadOptions::default()).expect("a built-in scene");
    let setup = Setup::for_scene(&scene);
    (scene, setup)
}

fn quick(kind: TechniqueKind) -> TechniqueChoice {
    let has = |key: &str| kind.param_specs().iter().any(|spec: &ParamSpec| spec.key == key);
    let settings = QUICK.iter().filter(|(key, _)| has(key)).map(|(k, v)| (k.to_string(), v.to_string())).collect();
    TechniqueChoice::with_settings(kind, settings)
}

/// Draws every technique's masks of some cases; `None` for a case that the technique refuses.
fn masks_of(cases: &[(&str, Scene, Setup, UVec2)]) -> Vec<(TechniqueKind, Vec<Option<Vec<f32>>>)> {
    let Some(lab) = lab() else { return Vec::new() };
    let views: Vec<_> = cases
        .iter()
        .map(|(name, scene, setup, size_px)| {
            let view = View::new(lab, scene, setup, *size_px).unwrap_or_else(|e| panic!("{name}: {e}"));
            lab.check().unwrap_or_else(|e| panic!("{name}: {e}"));
            view
        })
        .collect();
    let masks_of_technique = |kind: TechniqueKind| {
        // One state draws all cases, so data of one case would show in the next.
        let mut technique = create(&lab.gpu(), &quick(kind)).expect("good settings");
        let masks = cases.iter().zip(&views).map(|((name, _, _, size_px), view)| {
            let run = match view.draw(&mut technique, 0, 1) {
                Ok(run) => run,
                Err(error) => {
                    let line = error.to_string();
                    println!("{kind}, {name}: {line}");
                    assert!(!line.contains('\n') && line.starts_with(kind.name()), "{kind}, {name}: {line}");
                    return None;
                }
            };
            lab.check().unwrap_or_else(|error| panic!("{kind}, {name}: {error}"));
            let pixels = size_px.element_product() as usize;
            let mask: Vec<f32> = (0..pixels).map(|i| run.visibility.at(i, 0)).collect();
            // NaN is in no range, so it fails, too.
            let odd = mask.iter().position(|v| !(0.0..=1.0).contains(v));
            assert!(odd.is_none(), "{kind}, {name}: {:?} at pixel {odd:?}", odd.map(|i| mask[i]));
            Some(mask)
        });
        (kind, masks.collect())
    };
    TechniqueKind::ALL.iter().map(|kind| masks_of_technique(*kind)).collect()
}

fn rms(a: &[f32], b: &[f32]) -> f32 {
    let square: f32 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (square / a.len() as f32).sqrt()
}

/// The plank scene with another light.
fn lit_by(name: &str, light: Light) -> (&str, Scene, Setup, UVec2) {
    let (scene, mut setup) = plank();
    setup.lights[0] = light;
    (name, scene, setup, SIZE)
}

#[test]
fn every_light_is_taken() {
    let (_, setup) = plank();
    let key = &setup.lights[0];
    let with = |shape: LightShape| Light { shape, ..key.clone() };
    let moved = |shape: LightShape, center: Vec3, target: Vec3| Light::new(shape, center, target);
    let square = LightShape::Rectangle { size_m: Vec2::splat(0.5) };
    let cases = [
        lit_by("zero rectangle", with(LightShape::Rectangle { size_m: Vec2::ZERO })),
        lit_by("rectangle without width", with(LightShape::Rectangle { size_m: Vec2::new(0.0, 0.5) })),
        lit_by("zero sphere", with(LightShape::Sphere { radius_m: 0.0 })),
        lit_by("sphere", with(LightShape::Sphere { radius_m: 0.3 })),
        lit_by("ellipsoid", with(LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.1, 0.2) })),
        lit_by("sun", with(LightShape::Sun { angular_diameter_rad: 0.02 })),
        lit_by("sun without width", with(LightShape::Sun { angular_diameter_rad: 0.0 })),
        lit_by("one point", with(LightShape::Points { positions_m: vec![key.center] })),
        lit_by("a light as large as the scene", with(LightShape::Sphere { radius_m: 4.0 })),
        lit_by("in the casters' bounds", moved(square.clone(), Vec3::new(0.0, 0.4, 0.0), Vec3::new(0.2, 0.0, 0.1))),
        lit_by("sphere in the casters' bounds", moved(LightShape::Sphere { radius_m: 0.2 }, Vec3::Y, Vec3::ZERO)),
        lit_by("in the ground's plane", moved(square.clone(), Vec3::new(3.0, 0.0, 0.0), Vec3::ZERO)),
        lit_by("sun along the ground", moved(LightShape::Sun { angular_diameter_rad: 0.01 }, Vec3::X, Vec3::ZERO)),
        lit_by("below the ground", moved(square.clone(), Vec3::new(0.0, -3.0, 0.0), Vec3::ZERO)),
        lit_by("away from the scene", moved(square.clone(), Vec3::new(0.0, 9.0, 0.0), Vec3::new(0.0, 20.0, 0.0))),
        lit_by("wide frustum", Light { fov_rad: Some(3.1), ..key.clone() }),
    ];
    let options = VisibilityOptions { samples: 256, ..VisibilityOptions::default() };
    let truths = cases.each_ref().map(|(name, scene, setup, size_px)| {
        let traced = trace(scene, setup, *size_px, &options, &Silent).unwrap_or_else(|error| panic!("{name}: {error}"));
        traced.into_iter().next().expect("one light")
    });
    for (kind, masks) in masks_of(&cases) {
        let mut worst_without_bound = 0.0f32;
        for (((name, ..), mask), truth) in cases.iter().zip(masks).zip(&truths) {
            let mask = mask.unwrap_or_else(|| panic!("{kind}, {name}: every light of the setup file is taken"));
            let Some(rmse) = rmse_at(&mask, truth) else {
                assert!(NOT_JUDGED.contains(name), "{name}: no pixel is judged");
                continue;
            };
            println!("{kind}, {name}: rmse {rmse:.3}");
            let odd = ODD_LIGHTS.iter().find(|(odd, _)| odd == name).map(|(_, bound)| *bound);
            let odd = if (kind, *name) == CSSM_AT_AN_EDGE.0 { Some(CSSM_AT_AN_EDGE.1) } else { odd };
            match odd.or(usual_bound(kind)) {
                Some(bound) => assert!(rmse <= bound, "{kind}, {name}: rmse {rmse} against {bound}"),
                None => worst_without_bound = worst_without_bound.max(rmse),
            }
        }
        let is_bounded = usual_bound(kind).is_some();
        assert!(
            is_bounded,
            "{kind} has an rmse of up to {worst_without_bound:.3}: add a bound just above that to `usual_bound`"
        );
    }
}

/// Bound for a blocker that ends beyond a cube face's map, where its edge is extended as under covers (`edge_goes_on`):
/// four terms place it too near the lamp. At 160 × 90 and 1024² the error is .200 instead of .184; without the extension
/// the error of `cssm` is .99 under a cover.
const CSSM_AT_AN_EDGE: ((TechniqueKind, &str), f32) = ((TechniqueKind::Cssm, "sphere in the casters' bounds"), 0.26);

/// Lights that no judged pixel of the image faces.
const NOT_JUDGED: [&str; 3] = ["in the ground's plane", "sun along the ground", "away from the scene"];

/// Lights that violate the techniques' assumptions, with bounds on RMSE for all techniques.
const ODD_LIGHTS: [(&str, f32); 3] =
    [("a light as large as the scene", 0.365), ("sphere in the casters' bounds", 0.24), ("below the ground", 0.202)];

/// Bound on a technique's RMSE under any other light, with a map of 128² and 8 samples. Under most of these lights the
/// error of a white mask is at least .37, that of a black mask .9. `None` for a technique that is not listed yet.
pub(crate) fn usual_bound(kind: TechniqueKind) -> Option<f32> {
    Some(match kind {
        TechniqueKind::Hard => 0.101,
        TechniqueKind::Pcf => 0.088,
        TechniqueKind::Pcss => 0.044,
        TechniqueKind::Smrt => 0.078,
        TechniqueKind::Bitmask => 0.06,
        TechniqueKind::Backprojection => 0.059,
        TechniqueKind::MultiView => 0.036,
        TechniqueKind::Vsm => 0.149,
        TechniqueKind::Lvsm | TechniqueKind::Evsm => 0.15,
        TechniqueKind::Esm => 0.293,
        TechniqueKind::Convolution => 0.16,
        TechniqueKind::Moment => 0.148,
        TechniqueKind::PcssAnisotropic => 0.13,
        TechniqueKind::Essm => 0.127,
        TechniqueKind::Savsm => 0.241,
        TechniqueKind::Vssm | TechniqueKind::Evssm => 0.069,
        TechniqueKind::Cssm | TechniqueKind::Mssm => 0.246,
        TechniqueKind::MultiLayer => 0.064,
        TechniqueKind::Reprojection => 0.134,
        TechniqueKind::ReprojectionLayered => 0.121,
        TechniqueKind::RayTraced => 0.1,
        TechniqueKind::AliasFree => 0.096,
        TechniqueKind::SampleBased => 0.023,
        _ => return None,
    })
}

/// Root-mean-square error over the judged pixels; `None` if there are none.
fn rmse_at(mask: &[f32], truth: &LightTruth) -> Option<f32> {
    let judged = (0..mask.len()).filter(|i| truth.judged[*i]);
    let squares: Vec<f32> = judged.map(|i| (mask[i] - truth.visibility.at(i, 0)).powi(2)).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f32>() / squares.len() as f32).sqrt())
}

#[test]
fn every_scene_and_picture_is_taken() {
    let (scene, setup) = plank();
    let mut nothing = scene.clone();
    nothing.instances.clear();
    let mut sky = setup.clone();
    sky.camera.target = sky.camera.eye + Vec3::Y;
    sky.camera.up = Vec3::Z;
    let mut flat = scene.clone();
    for instance in &mut flat.instances {
        instance.world_from_object = Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)) * instance.world_from_object;
    }
    let mut degenerate = scene.clone();
    for mesh in &mut degenerate.meshes {
        let last = mesh.positions.len() as u32 - 1;
        mesh.indices.extend([0, 0, 0, 0, last, last, last, 0, last]);
    }
    let cases = [
        ("as it is", scene.clone(), setup.clone(), SIZE),
        ("no scene", nothing, setup.clone(), SIZE),
        ("sky alone", scene.clone(), sky, SIZE),
        ("one pixel", scene.clone(), setup.clone(), UVec2::ONE),
        ("one row", scene.clone(), setup.clone(), UVec2::new(65, 1)),
        ("one column", scene.clone(), setup.clone(), UVec2::new(1, 33)),
        ("flattened", flat, setup.clone(), SIZE),
        ("degenerate triangles", degenerate, setup.clone(), SIZE),
        ("as it is, again", scene, setup, SIZE),
    ];
    for (kind, masks) in masks_of(&cases) {
        let mask = |name: &str| {
            let i = cases.iter().position(|case| case.0 == name).expect("a case");
            masks[i].as_ref().unwrap_or_else(|| panic!("{kind}, {name}: no mask"))
        };
        assert!(mask("no scene").iter().all(|v| *v == 1.0), "{kind}: no scene casts a shadow");
        assert!(mask("sky alone").iter().all(|v| *v == 1.0), "{kind}: the sky is in shadow");
        // The layers of `lvsm` move from frame to frame, even in a static scene.
        let allowed = if kind == TechniqueKind::Lvsm { 0.02 } else { 0.0 };
        for other in ["degenerate triangles", "as it is, again"] {
            let rms = rms(mask("as it is"), mask(other));
            assert!(rms <= allowed, "{kind}, {other}: {rms} from the scene as it is");
        }
        assert!(mask("as it is").iter().any(|v| *v < 0.5), "{kind}: the plank casts no shadow");
    }
}

#[test]
fn scenes_of_any_size_have_the_same_shadows() {
    let (scene, setup) = plank();
    let scaled = |factor: f32| {
        let (mut scene, mut setup) = (scene.clone(), setup.clone());
        for instance in &mut scene.instances {
            instance.world_from_object = Mat4::from_scale(Vec3::splat(factor)) * instance.world_from_object;
        }
        let light = setup.lights[0].scaled(factor);
        setup.lights[0] = Light { center: light.center * factor, ..light };
        let camera = &mut setup.camera;
        (camera.eye, camera.target) = (camera.eye * factor, camera.target * factor);
        (camera.near_m, camera.far_m) = (camera.near_m * factor, camera.far_m * factor);
        (scene, setup)
    };
    let case = |name, factor| {
        let (scene, setup) = scaled(factor);
        (name, scene, setup, SIZE)
    };
    let cases = [case("metres", 1.0), case("millimetres", 1e-3), case("kilometres", 1e3)];
    for (kind, masks) in masks_of(&cases) {
        let [Some(as_is), others @ ..] = &masks[..] else { panic!("{kind}: no mask") };
        for ((name, ..), mask) in cases[1..].iter().zip(others) {
            let mask = mask.as_ref().unwrap_or_else(|| panic!("{kind}, {name}: no mask"));
            let rms = rms(as_is, mask);
            println!("{kind}, {name}: rms {rms:.5}");
            assert!(rms < 0.01, "{kind}, {name}: {rms} from the same scene in metres");
        }
    }
}
