//! Through the technique that writes noisy visibility, against closed forms.

use antumbra_light::LightShape;
use glam::{UVec2, Vec3};

use crate::TechniqueKind;
use crate::gpu::Gpu;
use crate::testing::{Case, RECTANGLE, SIZE, gpu, half_plane_visibility, rmse, test_ground};

const FEW: (&str, &str) = ("samples", "16");

fn mask(gpu: &Gpu, case: &Case, smooth: &str) -> Vec<f32> {
    case.run(gpu, TechniqueKind::Smrt, &[FEW, ("smooth", smooth)])
}

fn error_of(case: &Case, mask: &[f32]) -> f32 {
    rmse(&case.ground_pixels(test_ground), mask, |p| half_plane_visibility(p.x, 1.0))
}

/// In a wide penumbra means of 16 rays come nearer to the truth than the rays.
#[test]
fn means_are_nearer_to_the_truth() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let [raw, smooth] = ["false", "true"].map(|on| error_of(&case, &mask(gpu, &case, on)));
    println!("16 rays {raw:.4}, their means {smooth:.4}");
    assert!(smooth < 0.6 * raw, "{raw} {smooth}");
}

/// Where a pixel and all that its mean reaches are lit, or all are dark, it stays as it is.
#[test]
fn what_is_lit_or_dark_all_about_stays_so() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let [raw, smooth] = ["false", "true"].map(|on| mask(gpu, &case, on));
    let mut seen = [0; 2];
    for y in 3..SIZE.y - 3 {
        for x in 3..SIZE.x - 3 {
            let at = |dx: u32, dy: u32| raw[((y + dy - 3) * SIZE.x + x + dx - 3) as usize];
            let own = at(3, 3);
            if (own == 0.0 || own == 1.0) && (0..49).all(|i| at(i % 7, i / 7) == own) {
                assert_eq!(smooth[(y * SIZE.x + x) as usize], own, "{}", UVec2::new(x, y));
                seen[usize::from(own == 1.0)] += 1;
            }
        }
    }
    assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
}

/// A penumbra far narrower than a pixel is not widened: what is stored are halves, which is all that differs.
#[test]
fn sharp_edges_stay_sharp() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Disk { radius_m: 1e-4 });
    let [raw, smooth] = ["false", "true"].map(|on| mask(gpu, &case, on));
    assert!(raw.contains(&0.0) && raw.contains(&1.0));
    let most = raw.iter().zip(&smooth).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(most <= 1.0 / 2048.0, "{most}");
}

/// A list of points throws several hard shadows, whose steps are no noise.
#[test]
fn steps_of_lists_of_points_stay() {
    let Some(gpu) = gpu() else { return };
    let positions_m = [-0.3, 0.0, 0.3].map(|x| Vec3::new(x, 4.0, 0.0)).to_vec();
    let case = Case::half_plane(gpu, LightShape::Points { positions_m });
    assert!(mask(gpu, &case, "true") == mask(gpu, &case, "false"));
}
