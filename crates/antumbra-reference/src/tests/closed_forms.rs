//! Shadows with closed forms. 4096 stratified points have an rms error below 0.002 on a straight edge; most bounds here
//! are three times that, or the noise derived at the test.

use std::f32::consts::{FRAC_PI_2, PI};

use antumbra_light::{EmissionTexture, Light, LightShape};
use glam::{Vec2, Vec3};

use super::*;

/// A large opaque half-plane `x ≥ edge` at height `height`.
fn half_plane(edge: f32, height: f32) -> Tracer {
    Tracer::new(&scene_of(&parallelogram(Vec3::new(edge, height, -500.0), Vec3::X * 1000.0, Vec3::Z * 1000.0))).unwrap()
}

fn down(shape: LightShape, height: f32) -> Light {
    Light::new(shape, Vec3::Y * height, Vec3::ZERO)
}

/// Fraction of a disc of radius `r` on the near side of a line at signed distance `d` from its centre (`d = r`: all).
fn disc_part(d: f32, r: f32) -> f32 {
    let k = (d / r).clamp(-1.0, 1.0);
    1.0 - (k.acos() - k * (1.0 - k * k).sqrt()) / PI
}

#[test]
fn half_plane_under_a_rectangle() {
    // From x, the edge at (e, h) projects onto the light's plane at p = x + (e − x)·H/h; the light is visible left of it:
    // V = (p + w/2) / w.
    let (height, edge_height, edge, width) = (4.0, 1.5, 0.2, 1.2);
    let tracer = half_plane(edge, edge_height);
    let light = down(LightShape::Rectangle { size_m: Vec2::new(width, 0.7) }, height);
    assert!(light.frame().right.x.abs() > 0.99, "the width runs along x");
    let points: Vec<Vec3> = offsets(41, -0.8, 1.2).map(|x| Vec3::new(x, 0.0, 0.3)).collect();
    for (v, p) in visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points) {
        let projected = p.x + (edge - p.x) * height / edge_height;
        let want = ((projected + 0.5 * width) / width).clamp(0.0, 1.0);
        assert!((v - want).abs() < 0.006, "{p}: {v} against {want}");
    }
}

#[test]
fn half_plane_under_a_disk_and_a_sun() {
    let (height, edge_height, edge, radius) = (4.0, 1.5, 0.2, 0.6);
    let tracer = half_plane(edge, edge_height);
    let disk = down(LightShape::Disk { radius_m: radius }, height);
    let points: Vec<Vec3> = offsets(41, -0.8, 1.2).map(|x| Vec3::new(x, 0.0, 0.3)).collect();
    for (v, p) in visibility_on_floor(&tracer, &disk, &points).into_iter().zip(&points) {
        let want = disc_part(p.x + (edge - p.x) * height / edge_height, radius);
        assert!((v - want).abs() < 0.006, "{p}: {v} against {want}");
    }
    // A sun straight above: the tangent disc of radius tan(α/2), and the edge at tangent (e − x)/h.
    let angle = 0.3f32;
    let sun = down(LightShape::Sun { angular_diameter_rad: angle }, height);
    for (v, p) in visibility_on_floor(&tracer, &sun, &points).into_iter().zip(&points) {
        let want = disc_part((edge - p.x) / edge_height, (0.5 * angle).tan());
        assert!((v - want).abs() < 0.006, "{p}: {v} against {want}");
    }
}

#[test]
fn half_plane_before_a_sphere() {
    // In the plane z = 0 through the light's centre, the plane through x and the edge cuts the facing disc along a line at
    // distance D·sin(angle between the edge's direction and the centre's), measured at the disc: D·tan.
    let (height, edge_height, edge, radius) = (4.0, 1.5, 0.2, 0.6);
    let tracer = half_plane(edge, edge_height);
    let points: Vec<Vec3> = offsets(41, -0.8, 1.2).map(|x| Vec3::new(x, 0.0, 0.0)).collect();
    // The light shines in all directions: the floor lies before it, beside it and behind it.
    for axis in ALL_AROUND {
        let light = looking_along(axis, LightShape::Sphere { radius_m: radius }, height);
        for (v, p) in visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points) {
            let distance = light.center.distance(*p);
            let to_edge = (edge - p.x).atan2(edge_height);
            let to_center = (-p.x).atan2(height);
            let want = disc_part(distance * (to_edge - to_center).tan(), radius);
            assert!((v - want).abs() < 0.006, "{p}, along {axis}: {v} against {want}");
        }
    }
}

/// Axes of lights above a floor.
const ALL_AROUND: [Vec3; 5] = [Vec3::NEG_Y, Vec3::Y, Vec3::X, Vec3::new(-0.6, 0.0, 0.8), Vec3::new(0.48, 0.6, -0.64)];

/// A light above the floor's centre with any axis.
fn looking_along(axis: Vec3, shape: LightShape, height: f32) -> Light {
    let center = Vec3::Y * height;
    Light::new(shape, center, center + axis)
}

#[test]
fn disc_under_a_disk() {
    // A disc occluder of radius r at height h projects from the floor point x onto the light's plane as a disc of radius
    // r·H/h about x·(1 − H/h): the hidden part is a lens of two circles.
    let (height, occluder_height, occluder, radius) = (4.0f32, 2.0f32, 0.3f32, 0.5f32);
    let corners = 512;
    let at = |i: u32| {
        let angle = std::f32::consts::TAU * i as f32 / corners as f32;
        Vec3::new(occluder * angle.cos(), occluder_height, occluder * angle.sin())
    };
    let fan: Vec<[Vec3; 3]> = (0..corners).map(|i| [Vec3::Y * occluder_height, at(i), at((i + 1) % corners)]).collect();
    let tracer = Tracer::new(&scene_of(&fan)).unwrap();
    let light = down(LightShape::Disk { radius_m: radius }, height);
    let points: Vec<Vec3> = offsets(51, -1.2, 1.2).map(|x| Vec3::new(0.8 * x, 0.0, 0.6 * x)).collect();
    for (v, p) in visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points) {
        let d = p.length() * (height / occluder_height - 1.0);
        let want = 1.0 - lens(d, radius, occluder * height / occluder_height) / (PI * radius * radius);
        assert!((v - want).abs() < 0.006, "{p}: {v} against {want}");
    }
}

/// Area common to two discs of radii `a` and `b` at distance `d`.
fn lens(d: f32, a: f32, b: f32) -> f32 {
    if d >= a + b {
        return 0.0;
    }
    if d <= (a - b).abs() {
        return PI * a.min(b).powi(2);
    }
    let part = |r: f32, s: f32| r * r * ((d * d + r * r - s * s) / (2.0 * d * r)).clamp(-1.0, 1.0).acos();
    let kite = ((-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b)).max(0.0).sqrt();
    part(a, b) + part(b, a) - 0.5 * kite
}

#[test]
fn half_plane_under_an_ellipsoid() {
    // The plane through the floor line x = e (so the receiver lies under the edge) is vertical and halves the
    // ellipsoid's volume at the receiver; elsewhere it cuts off a cap: by the affine map to the unit ball, the part
    // below signed distance k is (2 + 3k − k³)/4.
    let (height, edge_height, edge) = (4.0f32, 1.5f32, 0.0f32);
    let radii = Vec3::new(0.6, 0.3, 0.5);
    let tracer = half_plane(edge, edge_height);
    let points: Vec<Vec3> = offsets(31, -0.4, 0.4).map(|x| Vec3::new(x, 0.0, 0.0)).collect();
    for axis in ALL_AROUND {
        let light = looking_along(axis, LightShape::Ellipsoid { radii_m: radii }, height);
        let frame = light.frame();
        for (v, p) in visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points) {
            // The plane through p and the edge: normal n = (h, −(e − x), 0), offset n·p.
            let n = Vec3::new(edge_height, -(edge - p.x), 0.0).normalize();
            let along = Vec3::new(n.dot(frame.right), n.dot(frame.up), n.dot(frame.axis));
            let k = (n.dot(*p - light.center) / (along * radii).length()).clamp(-1.0, 1.0);
            let want = (2.0 + 3.0 * k - k * k * k) / 4.0;
            assert!((v - want).abs() < 0.015, "{p}, along {axis}: {v} against {want}");
        }
    }
}

#[test]
fn points_count_once_each() {
    // Five points, of which the half-plane hides those with x beyond the projected edge.
    let tracer = half_plane(0.0, 1.0);
    let positions_m: Vec<Vec3> = (0..5).map(|i| Vec3::new(i as f32 - 2.0, 2.0, 0.3)).collect();
    let points: Vec<Vec3> = [-1.2, -0.7, -0.2, 0.3, 0.8, 1.3].map(|x| Vec3::new(x, 0.0, 0.0)).into();
    for axis in ALL_AROUND {
        let light = looking_along(axis, LightShape::Points { positions_m: positions_m.clone() }, 2.0);
        for (v, p) in visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points) {
            let seen = (0..5).filter(|i| (*i as f32 - 2.0) < p.x + (0.0 - p.x) * 2.0).count();
            assert_eq!(v, seen as f32 / 5.0, "{p}, along {axis}");
        }
    }
}

#[test]
fn texture_weights_its_area() {
    // An annulus painted on a square: luminance 1 between radii 16 and 32 of 64 texels, else 0. With the edge straight
    // above the receiver, half of it is seen; elsewhere the difference of two disc parts.
    let n = 64u32;
    let luminance: Vec<f32> = (0..n * n)
        .map(|i| {
            let p = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) - 0.5 * n as f32;
            f32::from((16.0..32.0).contains(&p.length()))
        })
        .collect();
    let (height, edge_height, side) = (4.0, 1.5, 1.2);
    let tracer = half_plane(0.1, edge_height);
    let mut light = down(square(side), height);
    light.emission = Some(EmissionTexture::gray(n, n, luminance));
    let points: Vec<Vec3> = offsets(31, -0.6, 0.8).map(|x| Vec3::new(x, 0.0, 0.3)).collect();
    let (outer, inner) = (0.5 * side, 0.25 * side);
    let differences = visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points).map(|(v, p)| {
        let d = p.x + (0.1 - p.x) * height / edge_height;
        let want = (disc_part(d, outer) * outer * outer - disc_part(d, inner) * inner * inner)
            / (outer * outer - inner * inner);
        // The staircase of texels causes up to 1 % of the area, the silhouette of the texture the rest.
        assert!((v - want).abs() < 0.025, "{p}: {v} against {want}");
        v - want
    });
    assert!(rms(differences) < 0.01);
}

#[test]
fn one_lit_texel_is_a_small_light() {
    let (height, edge_height, side) = (4.0, 2.0, 1.0);
    let tracer = half_plane(0.0, edge_height);
    let mut light = down(square(side), height);
    let mut luminance = vec![0.0; 16];
    // Row 1 from the top, column 3 from −right: x from 0.25 to 0.5.
    luminance[7] = 3.0;
    light.emission = Some(EmissionTexture::gray(4, 4, luminance));
    let right = light.frame().right.x;
    for x in [-0.6, -0.45, -0.3, -0.2, 0.0, 0.2] {
        let v = visibility_on_floor(&tracer, &light, &[Vec3::new(x, 0.0, 0.0)])[0];
        // The edge seen from x lies at −x on the light.
        let (low, high) = if right > 0.0 { (0.25, 0.5) } else { (-0.5, -0.25) };
        let want = ((-x - low) / (high - low)).clamp(0.0, 1.0);
        assert!((v - want).abs() < 0.02, "{x}: {v} against {want}");
    }
}

#[test]
fn reach_bounds_the_light() {
    let tracer = Tracer::new(&antumbra_scene::Scene::default()).unwrap();
    let mut light = down(square(0.5), 2.0);
    let points = [Vec3::ZERO, Vec3::Y * 3.0, Vec3::X * 1.9, Vec3::X * 2.1];
    assert_eq!(visibility_on_floor(&tracer, &light, &points), [1.0, 0.0, 1.0, 1.0]);
    light.fov_rad = Some(FRAC_PI_2);
    assert_eq!(visibility_on_floor(&tracer, &light, &points), [1.0, 0.0, 1.0, 0.0]);
}

#[test]
fn a_light_of_no_size_is_a_hard_shadow() {
    let tracer = half_plane(0.0, 1.0);
    for shape in [
        square(0.0),
        LightShape::Disk { radius_m: 0.0 },
        LightShape::Sphere { radius_m: 0.0 },
        LightShape::Ellipsoid { radii_m: Vec3::ZERO },
        LightShape::Sun { angular_diameter_rad: 0.0 },
    ] {
        let light = down(shape, 2.0);
        let points: Vec<Vec3> = offsets(10, -0.9, 0.9).map(|x| Vec3::new(x, 0.0, 0.1)).collect();
        for (v, p) in visibility_on_floor(&tracer, &light, &points).into_iter().zip(&points) {
            // Under a near light the projected edge is at −x; under a sun straight above at 0: the same sides.
            assert_eq!(v, if p.x < 0.0 { 1.0 } else { 0.0 }, "{light:?} {p}");
        }
    }
}
