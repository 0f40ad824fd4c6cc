//! An added ground receives the scene's shadow and does not change the scene's own shadows.

use antumbra::TechniqueKind;
use antumbra_lab::metrics::compare_visibility;
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Silent;
use antumbra_lab::technique_run::{TechniqueChoice, create};
use antumbra_lab::truth::{LightTruth, trace};
use antumbra_lab::view::View;
use antumbra_reference::VisibilityOptions;
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::UVec2;

use crate::common::{lab, scene_file};

const SIZE: UVec2 = UVec2::new(320, 180);

#[test]
fn a_ground_changes_no_shadow_of_what_stands_on_it() {
    let Some(lab) = lab() else { return };
    let Some(spec) = scene_file("lantern.glb") else { return };
    let bare = load(&spec, &LoadOptions::default()).expect("a good scene");
    let setup = Setup::assumed_for(&bare, 16.0 / 9.0).setup;
    let mut on_ground = bare.clone();
    on_ground.add_ground();
    let options = VisibilityOptions { samples: 256, ..VisibilityOptions::default() };
    let truth_of = |scene: &Scene| -> LightTruth {
        trace(scene, &setup, SIZE, &options, &Silent).expect("a good scene").swap_remove(0)
    };
    let (truth, with_ground) = (truth_of(&bare), truth_of(&on_ground));
    // The lantern's own pixels.
    let judged: Vec<bool> = truth.judged.iter().zip(&with_ground.judged).map(|(a, b)| *a && *b).collect();
    assert!(judged.iter().filter(|judged| **judged).count() > 2000);
    assert!((0..judged.len()).all(|i| !judged[i] || truth.visibility.at(i, 0) == with_ground.visibility.at(i, 0)));
    for kind in [TechniqueKind::Pcf, TechniqueKind::Pcss, TechniqueKind::Essm, TechniqueKind::MultiLayer] {
        let draw = |scene: &Scene| -> Visibility {
            let view = View::new(lab, scene, &setup, SIZE).expect("a good scene");
            let mut technique = create(&lab.gpu(), &TechniqueChoice::default_of(kind)).expect("good settings");
            view.draw(&mut technique, 0, 1).expect("a good frame").visibility
        };
        let (alone, standing) = (draw(&bare), draw(&on_ground));
        let metrics = |mask: &Visibility| compare_visibility(&truth.visibility, mask, &judged).expect("one size");
        let rmse = |mask: &Visibility| metrics(mask).rmse.expect("judged pixels");
        let apart = compare_visibility(&alone, &standing, &judged).expect("one size").mae.expect("judged pixels");
        let (without, with) = (rmse(&alone), rmse(&standing));
        println!("lantern: {kind}: rmse {without:.4} without a ground, {with:.4} on it, {apart:.4} apart");
        // A ground that casts would use up the map's texels: errors of .038, .023, .038 and .022 become .078, .079, .075
        // and .063, and masks differ by .013 and more.
        assert!(with <= without + 0.01, "{kind}: rmse {with} on a ground, {without} without");
        assert!(apart <= 0.01, "{kind}: {apart} apart");
    }
}
