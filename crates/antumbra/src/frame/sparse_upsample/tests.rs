//! Through the techniques that use it.

use antumbra_light::LightShape;
use glam::Vec2;

use crate::techniques::TechniqueKind;
use crate::testing::{Case, SIZE, gpu, half_plane_visibility, rmse as rmse_of, test_ground};

/// How far a mask may be from that of every pixel: noise is interpolated, too.
fn most_of_difference(kind: TechniqueKind) -> f32 {
    match kind {
        TechniqueKind::MultiLayer => 0.0046,
        _ => 0.0075,
    }
}

/// How far an interpolated mask may be from the closed form: two masks of one constant would be near one another, too.
fn most_from_truth(kind: TechniqueKind) -> f32 {
    match kind {
        TechniqueKind::MultiLayer => 0.011,
        _ => 0.015,
    }
}

/// What a straight line between pixels two apart misses of the closed form at a penumbra's ends, some twelve pixels from one to
/// the other here.
const MOST_OF_ENDS: f32 = 0.007;

#[test]
fn known_pixels_stay_and_the_rest_come_near() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ONE });
    let pixels = case.ground_pixels(test_ground);
    let from_truth = |mask: &[f32]| rmse_of(&pixels, mask, |p| half_plane_visibility(p.x, 1.0));
    let has_sub = |kind: &TechniqueKind| kind.param_specs().iter().any(|spec| spec.key == "sub");
    assert_eq!(TechniqueKind::ALL.iter().filter(|kind| has_sub(kind)).count(), 9);
    // One of each shader.
    let kinds = [TechniqueKind::Pcss, TechniqueKind::PcssAnisotropic, TechniqueKind::Essm, TechniqueKind::MultiLayer];
    for kind in kinds {
        let all = case.run(gpu, kind, &[]);
        let sub = case.run(gpu, kind, &[("sub", "true")]);
        let is_known = |i: usize| (i as u32 % SIZE.x).is_multiple_of(2) && (i as u32 / SIZE.x).is_multiple_of(2);
        for i in (0..all.len()).filter(|i| is_known(*i)) {
            assert_eq!(all[i], sub[i], "{}: pixel {i}", kind.name());
        }
        let squared: f32 = all.iter().zip(&sub).map(|(a, b)| (a - b).powi(2)).sum();
        let rmse = (squared / all.len() as f32).sqrt();
        let (all, sub) = (from_truth(&all), from_truth(&sub));
        println!("{}: {rmse:.4} apart; from the closed form {all:.4}, interpolated {sub:.4}", kind.name());
        assert!(rmse > 0.0, "{}: nothing was interpolated", kind.name());
        assert!(rmse < most_of_difference(kind), "{}: {rmse}", kind.name());
        assert!(sub < most_from_truth(kind), "{}: {sub}", kind.name());
        assert!(sub < all + MOST_OF_ENDS, "{}: {sub} for {all}", kind.name());
    }
}
