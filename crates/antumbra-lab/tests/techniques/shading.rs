//! Shaded images: analytic irradiance times a mask, against traced irradiance.

use antumbra::TechniqueKind;
use antumbra_lab::irradiance::IrradianceTruth;
use antumbra_lab::technique_run::TechniqueChoice;
use antumbra_lab::view::View;
use antumbra_scene::{LoadOptions, Setup, load};
use glam::UVec2;

use crate::common::lab;

const SIZE: UVec2 = UVec2::new(80, 45);
const RAYS: u32 = 1024;

/// If casters or the horizon hide a part of a nearby light, exact visibility has an error and the ratio almost none.
/// Techniques with small errors are more accurate with the ratio.
#[test]
fn the_ratio_shades_no_worse_than_visibility_and_better_close_to_lights() {
    let Some(lab) = lab() else { return };
    // Each entry: scene, minimum error of the product with exact visibility, and maximum error of `smrt` by the ratio relative to that by
    // visibility. On `staircase` most of it is leakage of its map onto the treads beside the panel, which the product happens to darken.
    let cases = [("builtin:columns", 0.004, 1.0), ("builtin:hall", 0.006, 1.0), ("builtin:staircase", 0.05, 1.2)];
    for (spec, exact_errs_by, smrt_share) in cases {
        let scene = load(spec, &LoadOptions::default()).expect("a scene that is there");
        let setup = Setup::for_scene(&scene);
        let truth = IrradianceTruth::new(lab, &scene, &setup, SIZE, 0, RAYS).expect("a scene that can be traced");
        let view = View::new(lab, &scene, &setup, SIZE).expect("a scene that can be seen");
        assert!(truth.count() > 1000);
        let (exact, points) = (truth.rmse_of_visibility(), truth.rmse_of_ratio());
        println!("{spec}: exact visibility {exact:.4}, exact ratio {points:.4}");
        assert!(exact > exact_errs_by && points < 0.3 * exact, "{spec}: {exact}, {points}");
        for (kind, share) in
            [(TechniqueKind::RayTraced, 0.9), (TechniqueKind::SampleBased, 0.6), (TechniqueKind::Smrt, smrt_share)]
        {
            let product = TechniqueChoice::default_of(kind);
            let [product, ratio] = [&product, &product.for_shading()].map(|choice| {
                let mut technique = view.create(choice).expect("a device that has what it takes");
                truth.rmse(&view.draw(&mut technique, 0, 1).expect("a good frame").visibility)
            });
            println!("{spec}: {kind} {product:.4} by visibility, {ratio:.4} by the ratio");
            assert!(ratio < share * product, "{spec}: {kind} {ratio} against {product}");
        }
    }
}
