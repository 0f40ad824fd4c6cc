//! The tracer has no acne and no leaks, and it handles degenerate input.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use antumbra_light::{Light, LightShape, SampleSet};
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::*;
use crate::{ReferenceError, SampledLight};

/// A tilted plane of `n × n` quads of side `side`, far from the world's origin.
fn tessellated_plane(n: u32, side: f32, at: Vec3, u: Vec3, v: Vec3) -> Vec<[Vec3; 3]> {
    let corner =
        |i: u32, j: u32| at + u * (side * (i as f32 - 0.5 * n as f32)) + v * (side * (j as f32 - 0.5 * n as f32));
    (0..n * n)
        .flat_map(|k| {
            let (i, j) = (k % n, k / n);
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

#[test]
fn a_lit_plane_has_no_acne_at_any_scale() {
    for scale in [0.01, 1.0, 100.0, 10_000.0] {
        for (n, shift) in [(1, 0.0), (24, 0.0), (24, 3.0)] {
            for normal in [Vec3::Y, Vec3::new(0.3, 0.9, -0.2).normalize(), Vec3::new(0.6, 0.1, 0.7).normalize()] {
                let u = normal.any_orthonormal_vector();
                let v = normal.cross(u);
                let at = shift * scale * Vec3::new(0.7, -0.4, 0.5);
                let plane = tessellated_plane(n, scale / n as f32, at, u, v);
                let tracer = Tracer::new(&scene_of(&plane)).unwrap();
                let eye = at + scale * (0.9 * normal + 0.8 * u);
                let camera = Camera { near_m: 1e-4 * scale, up: normal, ..camera(eye, at) };
                let receivers = tracer.primary(&camera, SMALL);
                assert!(receivers.hits() > 200);
                // Overhead light and grazing light.
                for (height, aside) in [(1.0, 0.0), (0.1, 2.0)] {
                    let center = at + scale * (height * normal + aside * v);
                    let light = Light::new(LightShape::Disk { radius_m: 0.05 * scale }, center, at);
                    let options = VisibilityOptions { samples: 64, ..VisibilityOptions::default() };
                    let image = visibility(&tracer, &receivers, &light, &options);
                    for (i, point) in receivers.points.iter().enumerate().filter(|(_, p)| p.is_some()) {
                        assert_eq!(image.values[i][0], 1.0, "scale {scale}, {n}, normal {normal}: {point:?}");
                        assert!(image.faces_light_center[i]);
                    }
                    // A light behind the plane is fully shadowed by the plane.
                    let behind =
                        Light { center: at - scale * (height * normal + aside * v), axis: -light.axis, ..light };
                    let image = visibility(&tracer, &receivers, &behind, &options);
                    for (i, point) in receivers.points.iter().enumerate().filter(|(_, p)| p.is_some()) {
                        assert_eq!(image.values[i][0], 0.0, "scale {scale}, {n}, normal {normal}: {point:?}");
                        assert!(!image.faces_light_center[i]);
                    }
                }
            }
        }
    }
}

#[test]
fn no_light_leaks_into_a_closed_sphere() {
    // Random segments from inside to outside, and from a light inside, at four scales and off the origin.
    for scale in [0.01, 1.0, 100.0, 10_000.0] {
        let center = scale * Vec3::new(0.3, -2.0, 1.1);
        let tracer = Tracer::new(&scene_of(&sphere(center, scale, 96, 48))).unwrap();
        let mut random = Random(17);
        for _ in 0..20_000 {
            let inside = center + scale * random.in_cube(0.5);
            let outside = center + scale * 3.0 * (random.in_cube(1.0).normalize());
            assert!(tracer.occluded(inside, outside), "{inside} {outside}");
            assert!(tracer.occluded(outside, inside), "{inside} {outside}");
            assert!(tracer.occluded_towards(inside, outside - inside), "{inside} {outside}");
        }
        let light = Light::new(LightShape::Disk { radius_m: scale }, center + 3.0 * scale * Vec3::Y, center);
        let points: Vec<_> =
            (0..300).map(|_| ReceiverPoint::new(center + scale * random.in_cube(0.5), Vec3::Y)).collect();
        let options = VisibilityOptions::default();
        let image = tracer.visibility_at(&points, &light, &options, &|_| {}, &never()).unwrap();
        assert!(image.values.iter().all(|v| *v == [0.0; 3]), "scale {scale}");
    }
}

#[test]
fn rays_aimed_at_edges_and_corners_do_not_slip_through() {
    let triangles = sphere(Vec3::new(0.1, 0.2, 0.3), 1.0, 24, 12);
    let tracer = Tracer::new(&scene_of(&triangles)).unwrap();
    let mut random = Random(8);
    for triangle in &triangles {
        for _ in 0..20 {
            let inside = Vec3::new(0.1, 0.2, 0.3) + random.in_cube(0.4);
            let t = random.next();
            for target in [triangle[0], triangle[0].lerp(triangle[1], t), triangle[1].lerp(triangle[2], t)] {
                assert!(tracer.occluded(inside, inside + 2.5 * (target - inside)), "{inside} {target}");
            }
        }
    }
}

#[test]
fn contact_shadows_touch() {
    // A box on a floor: directly above points just inside its footprint all is dark, just outside half is visible.
    let mut triangles = parallelogram(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    for (corner, u, v) in [
        (Vec3::ZERO, Vec3::X, Vec3::Y),
        (Vec3::Z, Vec3::X, Vec3::Y),
        (Vec3::ZERO, Vec3::Z, Vec3::Y),
        (Vec3::X, Vec3::Z, Vec3::Y),
        (Vec3::Y, Vec3::X, Vec3::Z),
    ] {
        triangles.extend(parallelogram(corner, u, v));
    }
    let tracer = Tracer::new(&scene_of(&triangles)).unwrap();
    let light = Light::new(LightShape::Sun { angular_diameter_rad: 0.5 }, Vec3::Y, Vec3::ZERO);
    for gap in [1e-5, 1e-4, 1e-3] {
        let v = visibility_on_floor(&tracer, &light, &[Vec3::new(-gap, 0.0, 0.5), Vec3::new(gap, 0.0, 0.5)]);
        assert!((v[0] - 0.5).abs() < 0.01 && v[1] == 0.0, "{gap}: {v:?}");
    }
}

#[test]
fn a_panel_in_the_plane_of_the_light_does_not_hide_it() {
    let panel = parallelogram(Vec3::new(-0.5, 2.0, -0.5), Vec3::X, Vec3::Z);
    let tilted: Vec<[Vec3; 3]> = panel
        .iter()
        .map(|t| t.map(|p| Mat4::from_rotation_z(0.3).transform_point3(p) + Vec3::new(3.0, 1.0, -7.0)))
        .collect();
    let center = Mat4::from_rotation_z(0.3).transform_point3(Vec3::Y * 2.0) + Vec3::new(3.0, 1.0, -7.0);
    let tracer = Tracer::new(&scene_of(&tilted)).unwrap();
    let axis = -Mat4::from_rotation_z(0.3).transform_vector3(Vec3::Y);
    let light = Light::new(square(0.9), center, center + axis);
    let mut random = Random(2);
    let points: Vec<Vec3> = (0..100).map(|_| center + axis * 2.0 + random.in_cube(1.0)).collect();
    assert!(visibility_on_floor(&tracer, &light, &points).iter().all(|v| *v == 1.0));
}

/// A floor with random triangles over it, and a camera on it.
fn busy() -> (Tracer, Receivers) {
    let mut triangles = soup(400, 1.0, 0.25, 11);
    triangles.extend(parallelogram(Vec3::new(-4.0, -1.2, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0));
    let tracer = Tracer::new(&scene_of(&triangles)).unwrap();
    let receivers = tracer.primary(&camera(Vec3::new(2.5, 1.5, 3.0), Vec3::ZERO), SMALL);
    (tracer, receivers)
}

fn light() -> Light {
    Light::new(LightShape::Disk { radius_m: 0.4 }, Vec3::new(0.5, 4.0, 0.2), Vec3::ZERO)
}

#[test]
fn the_same_for_any_number_of_threads_and_any_instructions() {
    let (tracer, receivers) = busy();
    for set in SampleSet::ALL {
        let options = VisibilityOptions { samples: 28, set, ..VisibilityOptions::default() };
        let on = |tracer: &Tracer, threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| visibility(tracer, &receivers, &light(), &options)).values
        };
        let one = on(&tracer, 1);
        assert_eq!(one, on(&tracer, 3), "{set}");
        assert_eq!(one, on(&tracer.portable(), 2), "{set}");
    }
    let portable = tracer.portable().primary(&camera(Vec3::new(2.5, 1.5, 3.0), Vec3::ZERO), SMALL);
    assert_eq!(receivers, portable);
}

#[test]
fn seeds_change_noise_and_nothing_else() {
    let (tracer, receivers) = busy();
    let image = |samples: u32, seed: u32, same: bool| {
        let options =
            VisibilityOptions { samples, seed, same_set_for_all_pixels: same, ..VisibilityOptions::default() };
        visibility(&tracer, &receivers, &light(), &options)
    };
    let truth = image(16384, 0, false);
    let penumbra = truth.values.iter().filter(|v| v[0] > 0.01 && v[0] < 0.99).count();
    assert!(penumbra > 150, "{penumbra}");
    for same in [false, true] {
        let (a, b) = (image(1024, 1, same), image(1024, 2, same));
        assert_ne!(a.values, b.values);
        assert_eq!(a.values, image(1024, 1, same).values);
        // 32 × 32 stratified points have an rms error of .0036 at most over images (bench/measurements.md, sample sets), and of
        // about 0.005 over their penumbrae.
        for image in [&a, &b] {
            let error = rms(image.values.iter().zip(&truth.values).map(|(a, b)| a[0] - b[0]));
            assert!(error < 0.005, "{error}");
        }
    }
}

#[test]
fn one_set_for_all_is_the_set_itself() {
    let options = VisibilityOptions { samples: 77, set: SampleSet::R2, seed: 5, same_set_for_all_pixels: true };
    let light = light();
    let sampled = SampledLight::new(&light, &options).unwrap();
    let x = Vec3::new(0.2, 0.0, 0.1);
    let want: Vec<_> = SampleSet::R2.points(77, 5).into_iter().map(|u| light.point(&light.frame(), u, x)).collect();
    for index in [0, 1, 99] {
        assert_eq!(sampled.points_for(index, x), want);
    }
    // Each bit of the mask belongs to the light point of its index.
    let (tracer, receivers) = busy();
    for (index, point) in receivers.points.iter().enumerate().step_by(31) {
        let Some(point) = point else { continue };
        let mask = tracer.visible_mask(&sampled, index, point);
        let mut seen = 0;
        for (i, light_point) in sampled.points_for(index, point.position).iter().enumerate() {
            let visible = mask[i / 64] >> (i % 64) & 1 == 1;
            assert_eq!(visible, !tracer.occluded(point.origin(), light_point.xyz), "{index} {i}");
            seen += u32::from(visible);
        }
        let image = tracer.visibility_at(&[*point], &light, &options, &|_| {}, &never()).unwrap();
        assert_eq!(image.values[0][0], (f64::from(seen) / 77.0) as f32);
    }
}

#[test]
fn larger_occluders_never_brighten() {
    let (_, receivers) = busy();
    let options = VisibilityOptions::default();
    let mut last: Option<Vec<[f32; 3]>> = None;
    for size in [0.1, 0.3, 0.6, 1.2] {
        let mut triangles = parallelogram(Vec3::new(-size, 0.5, -size), Vec3::X * 2.0 * size, Vec3::Z * 2.0 * size);
        triangles.extend(parallelogram(Vec3::new(-4.0, -1.2, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0));
        let tracer = Tracer::new(&scene_of(&triangles)).unwrap();
        let values = visibility(&tracer, &receivers, &light(), &options).values;
        assert!(values.iter().flatten().all(|v| (0.0..=1.0).contains(v)));
        if let Some(last) = last {
            assert!(values.iter().zip(&last).all(|(now, before)| now[0] <= before[0]));
        }
        last = Some(values);
    }
}

#[test]
fn hard_visibility_is_the_centre_alone() {
    let (tracer, receivers) = busy();
    let light = light();
    let image = tracer.hard_visibility(&receivers, &light, &|_| {}, &never()).unwrap();
    for (point, v) in receivers.points.iter().zip(&image.values) {
        let want = point.is_none_or(|p| !tracer.occluded(p.origin(), light.center));
        assert_eq!(v[0], f32::from(want));
    }
}

#[test]
fn progress_rises_to_one_and_cancel_stops() {
    let (tracer, receivers) = busy();
    let seen = Mutex::new(Vec::new());
    let options = VisibilityOptions { samples: 64, ..VisibilityOptions::default() };
    let progress = |f: f32| seen.lock().unwrap().push(f);
    let image = tracer.visibility(&receivers, &light(), &options, &progress, &never()).unwrap();
    let seen = seen.into_inner().unwrap();
    assert!(seen.windows(2).all(|w| w[0] < w[1]) && seen.last() == Some(&1.0), "{seen:?}");
    assert!(image.rays > 0 && image.rays_without_walk <= image.rays && image.rays_per_second() > 0.0);

    let cancel = AtomicBool::new(false);
    let calls = AtomicUsize::new(0);
    let stop = |_: f32| {
        calls.fetch_add(1, Ordering::Relaxed);
        cancel.store(true, Ordering::Relaxed);
    };
    let result = tracer.visibility(&receivers, &light(), &options, &stop, &cancel);
    assert_eq!(result, Err(ReferenceError::Cancelled));
    assert!(calls.into_inner() < seen.len());
}

#[test]
fn degenerate_scenes_are_no_trouble() {
    let nothing = Tracer::new(&antumbra_scene::Scene::default()).unwrap();
    let receivers = nothing.primary(&camera(Vec3::ONE, Vec3::ZERO), UVec2::new(5, 3));
    assert_eq!(receivers.hits(), 0);
    let image = visibility(&nothing, &receivers, &light(), &VisibilityOptions::default());
    assert!(image.values.iter().all(|v| *v == [1.0; 3]) && image.rays == 0);

    // Points, lines and a proper triangle in one mesh.
    let p = Vec3::new(0.1, 0.5, 0.1);
    let triangles = [[p; 3], [p, p + Vec3::X, p + 2.0 * Vec3::X], [p, p + Vec3::Z, p + Vec3::X]];
    let tracer = Tracer::new(&scene_of(&triangles)).unwrap();
    assert_eq!(tracer.triangle_count(), 1);
    assert!(tracer.occluded(Vec3::new(0.3, 0.0, 0.3), Vec3::new(0.3, 1.0, 0.3)));

    // A receiver at the light, in a corner of a triangle, and in its plane.
    let light = Light::new(square(0.5), p, p - Vec3::Y);
    let v = visibility_on_floor(&tracer, &light, &[p, p + Vec3::X, p - Vec3::Y, p + Vec3::X * 0.2]);
    assert!(v.iter().all(|v| (0.0..=1.0).contains(v)), "{v:?}");
}

#[test]
fn errors_say_what_and_where() {
    let mut scene = scene_of(&[[Vec3::ZERO, Vec3::X, Vec3::new(0.0, f32::NAN, 1.0)]]);
    assert!(matches!(Tracer::new(&scene), Err(ReferenceError::NotFinite { instance: 0, .. })));
    scene.meshes[0].indices[2] = 3;
    let message = Tracer::new(&scene).unwrap_err().to_string();
    assert!(message.contains("vertex 3") && message.contains("there are 3"), "{message}");
    let options = VisibilityOptions { samples: 0, ..VisibilityOptions::default() };
    assert!(matches!(SampledLight::new(&light(), &options), Err(ReferenceError::Samples { .. })));
    let bad = Light::new(LightShape::Rectangle { size_m: Vec2::new(-1.0, 1.0) }, Vec3::Y, Vec3::ZERO);
    assert!(matches!(SampledLight::new(&bad, &VisibilityOptions::default()), Err(ReferenceError::Light(_))));
}

#[test]
fn receivers_lie_on_what_they_show() {
    let (tracer, receivers) = busy();
    for point in receivers.points.iter().flatten() {
        assert!((point.normal.length() - 1.0).abs() < 1e-6 && point.position.is_finite());
        let camera = Vec3::new(2.5, 1.5, 3.0);
        assert!(point.normal.dot(camera - point.position) > 0.0);
        let t = tracer.geometry().blockers.iter().find(|t| t.index == point.triangle).unwrap();
        let n = (t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]).normalize();
        assert!((point.position - t.corners[0]).dot(n).abs() < 1e-6);
        assert!(!tracer.occluded(camera, point.origin()));
    }
}
