//! The filterable techniques against exact filtering of the same map, in the case that they solve exactly and at the ends
//! of what numbers hold.

use antumbra_light::Light;
use glam::{Vec2, Vec3};

use crate::contract::TechniqueKind;
use crate::techniques::tests::{Case, Mesh, RECTANGLE, View, gpu, test_ground};

const ALL: [TechniqueKind; 6] = [
    TechniqueKind::Vsm,
    TechniqueKind::Lvsm,
    TechniqueKind::Evsm,
    TechniqueKind::Esm,
    TechniqueKind::Convolution,
    TechniqueKind::Moment,
];

/// A wide kernel on a small map: half a metre of the ground.
const WIDE: [(&str, &str); 3] = [("map_size", "256"), ("kernel_size", "11"), ("mips", "false")];

fn with<'a>(settings: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a str)> {
    WIDE.iter().chain(settings).copied().collect()
}

/// Root mean square and greatest of the differences.
fn difference(pixels: &[usize], a: &[f32], b: &[f32]) -> (f32, f32) {
    let squares: f32 = pixels.iter().map(|i| (a[*i] - b[*i]).powi(2)).sum();
    let most = pixels.iter().map(|i| (a[*i] - b[*i]).abs()).fold(0.0, f32::max);
    ((squares / pixels.len() as f32).sqrt(), most)
}

#[test]
fn one_planar_occluder_over_a_planar_receiver_is_exact() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let pixels: Vec<usize> = case.ground_pixels(test_ground).into_iter().map(|(i, _)| i).collect();
    let exact = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact")]));
    let penumbra = pixels.iter().filter(|i| exact[**i] > 0.05 && exact[**i] < 0.95).count();
    assert!(penumbra > 150, "the kernel is not wide: {penumbra} pixels of penumbra");
    let against_exact = |kind: TechniqueKind, settings: &[(&str, &str)]| {
        let (rmse, most) = difference(&pixels, &exact, &case.run(gpu, kind, &with(settings)));
        println!("{kind} {settings:?}: rmse {rmse:.5}, most {most:.4}");
        (rmse, most)
    };
    for placement in ["uniform", "lloyd"] {
        for layers in ["1", "2", "3", "4"] {
            let (rmse, _) = against_exact(TechniqueKind::Lvsm, &[("layers", layers), ("placement", placement)]);
            assert!(rmse <= 0.004, "{placement}, {layers}: {rmse}");
        }
    }
    assert!(against_exact(TechniqueKind::Vsm, &[]).0 <= 0.004);
    assert!(against_exact(TechniqueKind::Evsm, &[]).0 <= 0.004);
    assert!(against_exact(TechniqueKind::Moment, &[]).0 <= 0.004);
    // Figure 4: a split lies on the receiver, at 4 m, and there is no seam.
    let split = [("layers", "2"), ("placement", "manual"), ("split_depths", "4.0")];
    let (rmse, most) = against_exact(TechniqueKind::Lvsm, &split);
    assert!(rmse <= 0.02 && most <= 0.12, "a split on the receiver: {rmse}, {most}");
    // Multisampled maps mean the same.
    let (rmse, most) = against_exact(TechniqueKind::Lvsm, &[("msaa", "4")]);
    assert!(rmse <= 0.02 && most <= 0.1, "four samples: {rmse}, {most}");
    let exact_4 = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact"), ("msaa", "4")]));
    assert!(difference(&pixels, &exact, &exact_4).0 <= 0.02);
}

#[test]
fn manual_splits_say_what_they_need() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    for depths in ["", "3", "3,2"] {
        let settings = with(&[("layers", "3"), ("placement", "manual"), ("split_depths", depths)]);
        let casters = crate::contract::Casters::Meshes(&casters);
        let error = case.run_with(gpu, TechniqueKind::Lvsm, &settings, casters).unwrap_err().to_string();
        assert!(error.contains("2 ascending depths in metres for 3 layers"), "{error}");
    }
}

#[test]
fn ranges_from_a_metre_to_ten_kilometres_hold() {
    let Some(gpu) = gpu() else { return };
    for scale in [0.25, 2500.0] {
        let light = Light::new(RECTANGLE, Vec3::new(0.0, 4.0 * scale, 0.0), Vec3::ZERO);
        let view = View::new(scale * Vec3::new(2.0, 1.2, 5.0), scale * Vec3::new(0.6, 0.0, 0.0));
        let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0 * scale), Vec2::splat(6.0 * scale), 0.0);
        let occluder = Mesh::horizontal(gpu, scale * Vec2::new(-4.0, -4.0), scale * Vec2::new(0.0, 4.0), 1.5 * scale);
        let case = Case::new(gpu, light, view, vec![ground, occluder]);
        let pixels: Vec<usize> = case.ground_pixels(|p| test_ground(p / scale)).into_iter().map(|(i, _)| i).collect();
        let exact = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact")]));
        for kind in ALL {
            let mask = case.run(gpu, kind, &with(&[]));
            assert!(mask.iter().all(|v| (0.0..=1.0).contains(v)), "{kind} at {scale}");
            let (rmse, _) = difference(&pixels, &exact, &mask);
            println!("{kind}, {} m: rmse {rmse:.4}", 4.0 * scale);
            // Scale changes nothing.
            let bound = match kind {
                TechniqueKind::Esm => 0.11,
                TechniqueKind::Convolution => 0.01,
                _ => 0.004,
            };
            assert!(rmse <= bound, "{kind} at {scale}: {rmse}");
        }
    }
}
