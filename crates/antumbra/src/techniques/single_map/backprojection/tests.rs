//! Tests of areas against closed forms: one surface, overlapping occluders, and edges of every slant.

use antumbra_light::{EmissionTexture, Light, LightShape};
use glam::{Vec2, Vec3};

use super::gpu_types::MAX_SQUARES;
use super::{BackprojectionParams, CUT_AND_EMPTY};
use crate::TechniqueKind;
use crate::contract::Params;
use crate::testing::{Case, Mesh, RECTANGLE, View, gpu, half_plane_visibility, rmse, test_ground};

const KIND: TechniqueKind = TechniqueKind::Backprojection;

/// Areas are exact: the remaining error is the map's resolution.
#[test]
fn one_surface_hides_its_area() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let pixels = case.ground_pixels(test_ground);
    for occluders in ["outlines", "patches"] {
        let settings = [("occluders", occluders), ("squares", "64"), ("map_size", "2048")];
        let error = rmse(&pixels, &case.run(gpu, KIND, &settings), |p| half_plane_visibility(p.x, 1.0));
        println!("{occluders}: rmse {error:.4}");
        assert!(error < 0.003, "{occluders}: rmse {error}");
    }
}

/// A sheet rises steeply towards the light, its texels at many depths: its outline hides each light point once, and patches that are
/// extended to their neighbours hide some twice.
#[test]
fn an_outline_counts_a_slanted_surface_once() {
    let Some(gpu) = gpu() else { return };
    let light = Light::new(RECTANGLE, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    let corners =
        [Vec3::new(0.3, 2.4, -4.0), Vec3::new(0.3, 2.4, 4.0), Vec3::new(-2.5, 0.6, 4.0), Vec3::new(-2.5, 0.6, -4.0)];
    let sheet = Mesh::new(gpu, &corners, &[0, 1, 2, 0, 2, 3]);
    let case = Case::new(gpu, light, view, vec![ground, sheet]);
    // The upper edge, at 2.4 m, hides light points up to x + (0.3 − x) · 4/2.4.
    let truth = |p: Vec3| (0.5 - (p.x + (0.3 - p.x) / 0.6)).clamp(0.0, 1.0);
    let pixels = case.ground_pixels(|p| (0.3..2.0).contains(&p.x) && p.z.abs() < 2.5);
    let partly = pixels.iter().filter(|(_, p)| (0.05..0.95).contains(&truth(*p))).count();
    assert!(partly > 100, "{partly} pixels in the penumbra");
    let error = |occluders: &str| {
        let settings = [("occluders", occluders), ("squares", "64"), ("map_size", "2048")];
        rmse(&pixels, &case.run(gpu, KIND, &settings), truth)
    };
    let (outlines, patches) = (error("outlines"), error("patches"));
    println!("rmse {outlines:.4} by outlines, {patches:.4} by patches");
    assert!(outlines < 0.006, "rmse {outlines}");
    assert!(patches > 1.5 * outlines, "rmse {patches} by patches");
}

/// Two occluders that touch in the map have one outline, and what both hide is hidden once.
#[test]
fn an_outline_goes_about_all_that_touches() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    // At 3 m; in the map it reaches up to the first occluder. Up to x = 8 cm the first one hides all that this one does.
    let pixels = case.ground_pixels(|p| (-2.0..0.08).contains(&p.x) && p.z.abs() < 2.5);
    case.meshes.push(Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(-0.1, 4.0), 3.0));
    let truth = |p: Vec3| half_plane_visibility(p.x, 1.0);
    let partly = pixels.iter().filter(|(_, p)| (0.05..0.95).contains(&truth(*p))).count();
    assert!(partly > 100, "{partly} pixels in the penumbra");
    let error = |occluders: &str| {
        let settings = [("occluders", occluders), ("squares", "64")];
        rmse(&pixels, &case.run(gpu, KIND, &settings), truth)
    };
    let (outlines, patches) = (error("outlines"), error("patches"));
    println!("rmse {outlines:.4} by outlines, {patches:.4} by patches");
    assert!(outlines < 0.005, "rmse {outlines}");
    assert!(patches > 5.0 * outlines, "rmse {patches} by patches");
}

/// Light of a case: name, shape, bound on rmse, fraction beyond a line by the line's offset and angle, and changes to the light.
type Lit<'a> = (&'a str, LightShape, f32, &'a dyn Fn(f32, f32) -> f32, &'a dyn Fn(&mut Light));

/// Edge of a half-plane, turned about the light's axis: Green's form of the square and of the disc for edges of every slant, and
/// points for lights without such a form.
#[test]
fn edges_of_every_slant_have_their_area() {
    let Some(gpu) = gpu() else { return };
    let square = |offset: f32, angle: f32| {
        // Fraction of the unit square beyond a line at a distance from its centre: its projection on the normal is a trapezium.
        let (a, b) = (0.5 * angle.cos().abs(), 0.5 * angle.sin().abs());
        let at = |d: f32| (offset + d).max(0.0).powi(2);
        (at(a + b) - at(a - b) - at(b - a) + at(-a - b)) / (8.0 * a * b)
    };
    let disc = |offset: f32, _angle: f32| {
        let c = (-offset / 0.5).clamp(-1.0, 1.0);
        (c.acos() - c * (1.0 - c * c).sqrt()) / std::f32::consts::PI
    };
    let even = |light: &mut Light| light.emission = Some(EmissionTexture::gray(3, 2, vec![0.7; 6]));
    let lights: [Lit<'_>; 4] = [
        ("rectangle", RECTANGLE, 0.004, &square, &|_| ()),
        ("disk", LightShape::Disk { radius_m: 0.5 }, 0.004, &disc, &|_| ()),
        ("sphere", LightShape::Sphere { radius_m: 0.5 }, 0.006, &disc, &|_| ()),
        ("even picture", RECTANGLE, 0.006, &square, &even),
    ];
    for (name, shape, bound, share, change) in lights {
        for angle in [0.3f32, 2.0, 3.9] {
            let mut case = Case::half_plane(gpu, shape.clone());
            change(&mut case.light);
            let (along, across) = (Vec2::from_angle(angle), Vec2::from_angle(angle).perp());
            let corner = |u: f32, v: f32| {
                let p = u * along + v * across;
                Vec3::new(p.x, 1.5, p.y)
            };
            // Covers what is below 0 along the normal.
            let corners = [corner(-4.0, -4.0), corner(-4.0, 4.0), corner(0.0, 4.0), corner(0.0, -4.0)];
            case.meshes = vec![case.meshes.remove(0), Mesh::new(gpu, &corners, &[0, 1, 2, 0, 2, 3])];
            let pixels = case.ground_pixels(test_ground);
            let truth = |p: Vec3| share(along.dot(Vec2::new(p.x, p.z)) * 0.625 / 0.375, angle).clamp(0.0, 1.0);
            let partly = pixels.iter().filter(|(_, p)| (0.05..0.95).contains(&truth(*p))).count();
            assert!(partly > 100, "{name} at {angle}: {partly} pixels in the penumbra");
            let settings = [("squares", "64"), ("samples", "256"), ("map_size", "2048")];
            let error = rmse(&pixels, &case.run(gpu, KIND, &settings), truth);
            println!("{name} at {angle}: rmse {error:.4}");
            assert!(error < bound, "{name} at {angle}: rmse {error} against {bound}");
        }
    }
}

/// A plate just below the light, where the light takes up the whole map at every scale: rings stay within the bounds of the loops. Half
/// of the plate leaves half of the light.
#[test]
fn a_cover_that_fills_the_map_hides_all() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    case.meshes[1] = Mesh::horizontal(gpu, Vec2::splat(-1.2), Vec2::splat(1.2), 3.9);
    let pixels = case.ground_pixels(|p| p.x.abs().max(p.z.abs()) < 2.5);
    for squares in ["4", "16", "64"] {
        let error = rmse(&pixels, &case.run(gpu, KIND, &[("squares", squares)]), |_| 0.0);
        println!("{squares} squares: rmse {error:.4}");
        assert!(error < 1e-3, "{squares} squares: rmse {error}");
    }
    case.meshes[1] = Mesh::horizontal(gpu, Vec2::splat(-1.2), Vec2::new(0.0, 1.2), 3.9);
    // The segment to the light point o is at x + (o − x) · 3.9/4 there.
    let truth = |p: Vec3| 0.5 + p.x * 0.1 / 3.9;
    let error = rmse(&pixels, &case.run(gpu, KIND, &[("squares", "64")]), truth);
    println!("half of it: rmse {error:.4}");
    assert!(error < 0.01, "half of it: rmse {error}");
}

#[test]
fn loops_hold_every_number_of_squares() {
    let spec = BackprojectionParams::specs().iter().find(|spec| spec.key == "squares").expect("a parameter");
    assert_eq!(spec.range, Some((4.0, f64::from(MAX_SQUARES - CUT_AND_EMPTY))));
}
