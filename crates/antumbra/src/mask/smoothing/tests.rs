//! Tests through the technique that writes noisy visibility, against closed forms.

use antumbra_light::{Light, LightShape};
use glam::{UVec2, Vec3};

use crate::gpu::Gpu;
use crate::testing::{Case, Mesh, RECTANGLE, SIZE, View, gpu, half_plane_visibility, rmse, run, test_ground};
use crate::{Casters, TechniqueKind};

const FEW: (&str, &str) = ("samples", "16");

fn mask(gpu: &Gpu, case: &Case, smooth: &str) -> Vec<f32> {
    case.run(gpu, TechniqueKind::Smrt, &[FEW, ("smooth", smooth)])
}

fn error_of(case: &Case, mask: &[f32]) -> f32 {
    rmse(&case.ground_pixels(test_ground), mask, |p| half_plane_visibility(p.x, 1.0))
}

/// In a wide penumbra, means of 16 rays are nearer to the truth than the rays.
#[test]
fn means_are_nearer_to_the_truth() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let [raw, smooth] = ["false", "true"].map(|on| error_of(&case, &mask(gpu, &case, on)));
    println!("16 rays {raw:.4}, their means {smooth:.4}");
    assert!(smooth < 0.6 * raw, "{raw} {smooth}");
}

/// A pixel is unchanged if all pixels in its reach are fully lit, or all are dark.
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

/// A penumbra far narrower than a pixel is not widened; masks differ only by the rounding to half floats.
#[test]
fn sharp_edges_stay_sharp() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Disk { radius_m: 1e-4 });
    let [raw, smooth] = ["false", "true"].map(|on| mask(gpu, &case, on));
    assert!(raw.contains(&0.0) && raw.contains(&1.0));
    let most = raw.iter().zip(&smooth).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(most <= 1.0 / 2048.0, "{most}");
}

/// A list of points casts several hard shadows, whose steps are not noise.
#[test]
fn steps_of_lists_of_points_stay() {
    let Some(gpu) = gpu() else { return };
    let positions_m = [-0.3, 0.0, 0.3].map(|x| Vec3::new(x, 4.0, 0.0)).to_vec();
    let case = Case::half_plane(gpu, LightShape::Points { positions_m });
    assert!(mask(gpu, &case, "true") == mask(gpu, &case, "false"));
}

/// Returns the fraction of a disk on one side of a line, given the line's distance from the centre as a fraction of the radius.
fn disk_share(distance: f32) -> f32 {
    let d = distance.clamp(-1.0, 1.0);
    ((-d).acos() + d * (1.0 - d * d).sqrt()) / std::f32::consts::PI
}

/// Means extend across the seam where two parts of a light meet in a penumbra.
#[test]
fn means_go_on_where_parts_meet() {
    let Some(gpu) = gpu() else { return };
    let half_plane = Case::half_plane(gpu, LightShape::Sphere { radius_m: 0.5 });
    // Two cube faces meet in the plane z = 0. The axis is tilted so that one map does not cover both.
    let (axis, up) = (Vec3::X, Vec3::new(0.0, -1.0, 1.0).normalize());
    let light = Light { axis, up, ..half_plane.light };
    let case = Case::new(gpu, light, View::new(Vec3::new(0.4, 1.0, 0.9), Vec3::ZERO), half_plane.meshes);
    let mut shadow = TechniqueKind::Smrt.create(gpu).expect("default limits");
    shadow.set(FEW.0, FEW.1).expect("a count");
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let mask = case.with_frame(Casters::Meshes(&casters), |frame| run(gpu, &mut shadow, frame)).expect("a good frame");
    assert!(shadow.drawn_maps().len() > 1, "the light is in parts");
    let in_penumbra = |p: Vec3| p.x.abs() < 0.25 && p.z.abs() < 0.6;
    let (beside, elsewhere): (Vec<_>, Vec<_>) =
        case.ground_pixels(in_penumbra).into_iter().partition(|(_, p)| p.z.abs() < 0.02);
    assert!(beside.len() > 90 && elsewhere.len() > 900, "{} {}", beside.len(), elsewhere.len());
    let square = |(i, p): &(usize, Vec3)| (mask[*i] - disk_share(p.x * (1.0 - 0.375) / 0.375 / 0.5)).powi(2);
    let [beside, elsewhere] =
        [beside, elsewhere].map(|pixels| (pixels.iter().map(square).sum::<f32>() / pixels.len() as f32).sqrt());
    println!("{beside:.4} where parts meet, {elsewhere:.4} elsewhere");
    assert!(beside < 1.3 * elsewhere, "{beside} {elsewhere}");
}
