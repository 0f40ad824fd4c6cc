//! Small inputs that public reports led to, each with what is right: a card 1 m up and a light above it.

use std::path::PathBuf;

use antumbra_scene::{AlphaMode, LoadOptions, Setup, load};
use glam::Vec3;

use super::*;

/// The folder of cases, where this machine has one: `cases` beside `ANTUMBRA_SCENES`, or `shared/cases` beside the
/// workspace.
fn cases_folder() -> Option<PathBuf> {
    let workspace = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates = [
        std::env::var_os("ANTUMBRA_SCENES").map(|scenes| PathBuf::from(scenes).join("../cases")),
        Some(workspace.join("../shared/cases")),
        Some(workspace.join("shared/cases")),
    ];
    let found = candidates.into_iter().flatten().find(|folder| folder.join("README.md").is_file());
    if found.is_none() {
        antumbra_testing::skip("set ANTUMBRA_SCENES to the folder of test scenes, with the folder of cases beside it");
    }
    found
}

/// The visibility at points of the floor.
fn at(folder: &std::path::Path, case: &str, points: &[Vec3]) -> Vec<Vec3> {
    let scene = load(&folder.join(format!("{case}.glb")).display().to_string(), &LoadOptions::default()).unwrap();
    assert!(scene.warnings.is_empty(), "{case}: {:?}", scene.warnings);
    let light = &Setup::from_file(&folder.join("card.toml")).unwrap().lights[0];
    let points: Vec<_> = points.iter().map(|p| ReceiverPoint::new(*p, Vec3::Y)).collect();
    let tracer = Tracer::new(&scene).unwrap();
    let image = tracer.visibility_at(&points, light, &VisibilityOptions::default(), &|_| {}, &never()).unwrap();
    image.values.into_iter().map(Vec3::from).collect()
}

#[test]
fn cards_let_through_what_they_should() {
    let Some(folder) = cases_folder() else { return };
    let middle = [Vec3::new(0.03, 0.0, 0.01)];
    for (case, want, slack) in [
        ("blend_a1_1", Vec3::ZERO, 0.0),
        ("blend_0.5", Vec3::splat(0.5), 1e-5),
        ("node_visibility_used", Vec3::ONE, 0.0),
        ("node_visibility_required", Vec3::ONE, 0.0),
        ("transmission_metal_1.0", Vec3::ZERO, 0.0),
        ("transmissionTexture_at_0", Vec3::ZERO, 0.0),
        ("volume_red_10cm", Vec3::new(1.0, 0.1, 0.1), 1e-4),
    ] {
        let v = at(&folder, case, &middle)[0];
        assert!(v.abs_diff_eq(want, slack), "{case}: {v} where {want} is right");
    }
}

#[test]
fn cut_outs_in_webp_are_cut_out() {
    let Some(folder) = cases_folder() else { return };
    // Where the card's shadow falls, end to end.
    let points: Vec<_> =
        (0..400).map(|i| Vec3::new((i % 20) as f32 - 9.5, 0.0, (i / 20) as f32 - 9.5) * 0.06).collect();
    let values: Vec<_> = ["webp_used_no_fallback", "webp_required"].map(|case| at(&folder, case, &points)).into();
    assert_eq!(values[0], values[1]);
    let lit = values[0].iter().filter(|v| v.x > 0.9).count();
    assert!((40..360).contains(&lit), "{lit} of 400 points are lit: a solid card, or none");
}

#[test]
fn blended_cubes_cast_as_their_opaque_twins() {
    let Some(folder) = cases_folder() else { return };
    let blended = load(&folder.join("blend_cubes.glb").display().to_string(), &LoadOptions::default()).unwrap();
    let setup = Setup::from_file(&folder.join("blend_cubes.toml")).unwrap();
    let mut opaque = blended.clone();
    opaque
        .materials
        .iter_mut()
        .filter(|material| material.base_color.w == 1.0)
        .for_each(|m| m.alpha = AlphaMode::Opaque);
    let seen = |scene: &Scene| {
        let tracer = Tracer::new(scene).unwrap();
        let receivers = tracer.primary(&setup.camera, UVec2::new(64, 36));
        visibility(&tracer, &receivers, &setup.lights[0], &VisibilityOptions::default())
    };
    let [blended, opaque] = [blended, opaque].map(|scene| seen(&scene));
    assert_eq!((blended.channels, opaque.channels), (1, 1));
    assert!(blended.values == opaque.values);
    // Behind both faces of the cube that covers half.
    assert!(blended.values.iter().any(|v| (v[0] - 0.25).abs() < 1e-3));
}
