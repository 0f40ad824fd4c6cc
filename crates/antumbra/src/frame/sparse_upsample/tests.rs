//! Through a technique that uses it.

use antumbra_light::LightShape;
use glam::Vec2;

use crate::techniques::TechniqueKind;
use crate::testing::{Case, SIZE, gpu, half_plane_visibility, rmse as rmse_of, test_ground};

#[test]
fn known_pixels_stay_and_the_rest_come_near() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ONE });
    let all = case.run(gpu, TechniqueKind::MultiLayer, &[]);
    let sub = case.run(gpu, TechniqueKind::MultiLayer, &[("sub", "true")]);
    let mut squared = 0.0;
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let i = (y * SIZE.x + x) as usize;
            if x % 2 == 0 && y % 2 == 0 {
                assert_eq!(all[i], sub[i], "pixel {x}, {y}");
            }
            squared += (all[i] - sub[i]).powi(2);
        }
    }
    let rmse = (squared / all.len() as f32).sqrt();
    println!("interpolated against looked up: rmse {rmse:.4}");
    assert!(rmse < 0.0046, "{rmse}");
    // Two masks of one constant would be equal, too.
    let pixels = case.ground_pixels(test_ground);
    let from_truth = rmse_of(&pixels, &sub, |p| half_plane_visibility(p.x, 1.0));
    println!("interpolated against the closed form: rmse {from_truth:.4}");
    assert!(from_truth < 0.011, "{from_truth}");
}
