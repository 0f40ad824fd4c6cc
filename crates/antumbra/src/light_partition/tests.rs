use antumbra_light::{Aabb, Light, LightShape, ShadowDistance, hash_u32, unit_f32};
use glam::camera::rh::view::look_at_mat4;
use glam::{Vec2, Vec3};

use super::*;
use crate::contract::{Mask, Receivers};
use crate::testing::{Mesh, SIZE, empty_depth, gpu, test_receivers};

fn light(shape: LightShape) -> Light {
    Light::new(shape, Vec3::new(0.4, 2.0, -0.3), Vec3::new(0.0, 0.0, 1.0))
}

fn unit(i: u32) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|k| unit_f32(hash_u32(3 * i + k)) * 2.0 - 1.0))
}

/// All sectors that a light may have.
fn all_parts(light: &Light) -> Vec<Sector> {
    let frame = middle_frame(light);
    if light.is_omnidirectional() { cube_of(light, &frame) } else { rings_of(light, &frame) }
}

#[test]
fn every_place_that_is_reached_is_in_a_part_that_reaches_it() {
    let sphere = LightShape::Sphere { radius_m: 0.2 };
    let square = LightShape::Rectangle { size_m: Vec2::ONE };
    let wide = Light { fov_rad: Some(170f32.to_radians()), ..light(sphere.clone()) };
    for light in [light(sphere), light(square), wide] {
        let frame = light.frame();
        let parts = all_parts(&light);
        for i in 0..20_000 {
            // Every other point is close to the light's plane.
            let p = unit(i);
            let height = if i % 2 == 0 { 1.0 } else { 0.02 };
            let x = frame.center + 5.0 * (p.x * frame.right + p.y * frame.up + height * p.z * frame.axis);
            if !light.reaches(&frame, x) {
                continue;
            }
            let holders: Vec<_> = parts.iter().filter(|part| part.region.holds(x)).collect();
            assert_eq!(holders.len(), 1, "{x} of {light:?}");
            let of_part = &holders[0].light;
            assert!(of_part.reaches(&of_part.frame(), x), "{x} of {of_part:?}");
        }
        // On an edge a place may be in several parts, and must be in one.
        for (a, b) in [(1.0, 1.0), (1.0, 0.0), (-1.0, 0.3), (1.0, -1.0), (0.2, 1.0)] {
            let x = frame.center + 3.0 * (frame.axis + a * frame.right + b * frame.up);
            assert!(parts.iter().any(|part| part.region.holds(x)), "{x}");
        }
    }
}

/// A turned ellipsoid is the same body.
#[test]
fn an_ellipsoid_keeps_its_shape_in_every_part() {
    let light = light(LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.3, 0.1) });
    let variance_along = |light: &Light, direction: Vec3| {
        let (frame, moments) = (light.frame(), light.moments());
        let along = Vec3::new(direction.dot(frame.right), direction.dot(frame.up), direction.dot(frame.axis));
        moments.variance.dot(along * along)
    };
    for Sector { light: part, .. } in all_parts(&light) {
        for direction in (0..20).map(|i| unit(i).normalize()) {
            let (is, was) = (variance_along(&part, direction), variance_along(&light, direction));
            assert!((is - was).abs() < 1e-5, "{is} against {was}");
        }
    }
}

/// All casters between a part's receiver and a light point are drawn for the part.
#[test]
fn no_caster_is_left_out_that_shades_a_part() {
    let Some(gpu) = gpu() else { return };
    let light = light(LightShape::Sphere { radius_m: 0.4 });
    let meshes: Vec<Mesh> = (0..60)
        .map(|i| {
            let at = light.center + 4.0 * unit(1000 + i);
            Mesh::new(gpu, &[at, at + 0.5 * unit(2000 + i), at + 0.5 * unit(3000 + i)], &[0, 1, 2])
        })
        .collect();
    let casters: Vec<_> = meshes.iter().map(Mesh::caster).collect();
    let (mut kept, mut met) = (0, 0);
    for Sector { light: of_part, region, .. } in all_parts(&light) {
        let part = Part { id: 0, light: of_part, region, hull: Vec::new(), seen: Vec::new(), stable_box: None };
        let of_part = part.casters_of(&casters);
        kept += of_part.len();
        for i in 0..4000 {
            let receiver = light.center + 6.0 * unit(i);
            if !part.region.holds(receiver) {
                continue;
            }
            let on_light = light.center + 0.4 * unit(i + 7777).normalize();
            for caster in &casters {
                let between = (0..32).map(|k| receiver.lerp(on_light, (k as f32 + 0.5) / 32.0));
                let Aabb { min, max } = caster.bounds;
                if between.clone().any(|p| p.cmpge(min).all() && p.cmple(max).all()) {
                    met += 1;
                    assert!(of_part.iter().any(|kept| kept.bounds == caster.bounds), "{:?}", caster.bounds);
                }
            }
        }
    }
    assert!(met > 300, "only {met} casters are met");
    assert!(kept < 4 * meshes.len(), "{kept} of {} are drawn", 6 * meshes.len());
}

/// A light whose receivers lie in front of it is not divided; parts without receivers are omitted.
#[test]
fn there_are_parts_where_there_are_receivers_and_no_others() {
    let Some(gpu) = gpu() else { return };
    let mesh = Mesh::horizontal(gpu, Vec2::splat(-9.0), Vec2::splat(9.0), 0.0);
    let casters = [mesh.caster()];
    let depth = empty_depth(gpu, SIZE);
    let mask = Mask::new(gpu.device(), SIZE);
    let parts_with = |casters: &[MeshCaster<'_>], light: &Light, hull: &[Vec3], coverage| {
        // From high enough to see all of it.
        let view_from_world = look_at_mat4(Vec3::new(0.0, 150.0, 1.0), Vec3::ZERO, Vec3::Y);
        let receivers = Receivers { hull, view_from_world, ..test_receivers(SIZE, &depth) };
        let frame = PreparedFrame {
            light,
            casters: PreparedCasters::Draws(casters),
            receivers: receivers.into(),
            mask: &mask,
            noisy: None,
        };
        parts_of(&frame, coverage, Vec3::ZERO, &mut StableBoxes::default(), &SharedValues::default())
    };
    let parts = |light: &Light, hull: &[Vec3], coverage| parts_with(&casters, light, hull, coverage);
    let lamp = Light::new(LightShape::Sphere { radius_m: 0.1 }, 2.0 * Vec3::Y, Vec3::ZERO);
    let floor = |half: f32| Aabb { min: Vec3::new(-half, -0.1, -half), max: Vec3::new(half, 0.0, half) }.corners();
    assert!(parts(&lamp, &floor(3.0), Coverage::Window).is_empty(), "within 70 degrees");
    assert!(parts(&lamp, &floor(9.0), Coverage::Everything).is_empty(), "covered by the technique");
    let wide = parts(&lamp, &floor(9.0), Coverage::Window);
    assert_eq!(wide.len(), 5, "down and to four sides, not up");
    for part in &wide {
        assert!(part.hull.iter().all(|x| (-0.2..=0.1).contains(&x.y)), "{:?}", part.hull);
    }
    let square = Light { shape: LightShape::Rectangle { size_m: Vec2::ONE }, ..lamp.clone() };
    assert!(parts(&square, &floor(9.0), Coverage::HalfSpace).is_empty(), "before the light is all that it reaches");
    let rings = parts(&square, &floor(9.0), Coverage::Window);
    assert_eq!(rings.len(), 5, "the middle and a ring");
    assert_eq!(parts(&square, &floor(30.0), Coverage::Window).len(), 9, "and another");
    // Without casters beyond the middle's edge, one view suffices.
    let small = Mesh::horizontal(gpu, Vec2::splat(-0.5), Vec2::splat(0.5), 0.5);
    let only_small = |light: &Light| parts_with(&[small.caster()], light, &floor(9.0), Coverage::Window).len();
    assert_eq!(only_small(&square), 0, "no ring has casters");
    assert_eq!(only_small(&lamp), 5, "a light that shines all around has no view of all");
    // Behind the light there is nothing to draw.
    let ceiling = floor(9.0).map(|x| x + 5.0 * Vec3::Y);
    assert!(parts(&square, &ceiling, Coverage::Window).is_empty());
    assert_eq!(parts(&lamp, &ceiling, Coverage::Window).len(), 5, "all but down");
}

/// A sun, and the corners of a world's bounds around a camera in a street.
fn world(half_m: f32) -> (Light, [Vec3; 8]) {
    let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.0093 }, Vec3::ZERO, Vec3::new(0.7, -0.4, -0.3));
    (sun, Aabb { min: Vec3::new(-half_m, -0.1, -half_m), max: Vec3::new(half_m, 12.0, half_m) }.corners())
}

#[test]
fn a_sun_has_cascades_where_one_map_is_too_coarse() {
    let Some(gpu) = gpu() else { return };
    let depth = empty_depth(gpu, SIZE);
    let (sun, far) = world(1000.0);
    let receivers = Receivers { hull: &far, ..test_receivers(SIZE, &depth) };
    let body = Body::of(&receivers.into(), far.to_vec(), &SharedValues::default());
    let cascades = cascades::cascades_of(&sun, &receivers.into(), body.1.corners(), &mut None);
    assert!((3..=8).contains(&cascades.len()), "{} cascades", cascades.len());
    let world_from_view = receivers.view_from_world.inverse();
    let mut held = vec![0; cascades.len()];
    for i in 0..4000 {
        // Evenly over the logarithm of depth, up to the corners, and behind the camera.
        let p = unit(i);
        let depth_m = 1400f32.powf(p.z) - 0.5;
        let x = world_from_view.transform_point3(Vec3::new(p.x, p.y, -1.0) * depth_m);
        let holders: Vec<usize> = (0..cascades.len()).filter(|k| cascades[*k].region.holds(x)).collect();
        assert_eq!(holders.len(), 1, "{x} at {depth_m} m");
        held[holders[0]] += 1;
    }
    assert!(held.iter().all(|count| *count > 50), "{held:?}");
    // If seen points are known, cascades begin at them.
    let seen: Vec<Vec3> = (0..500).map(|i| world_from_view.transform_point3(Vec3::Z * -(200.0 + i as f32))).collect();
    let receivers = Receivers { seen: &seen, ..receivers };
    assert!(cascades::cascades_of(&sun, &receivers.into(), &far, &mut None).is_empty(), "all that is seen is far");
    let (_, near) = world(3.0);
    let receivers = Receivers { hull: &near, ..test_receivers(SIZE, &depth) };
    assert!(
        cascades::cascades_of(&sun, &receivers.into(), &near, &mut None).is_empty(),
        "one map does for a few metres"
    );
}

/// The sweep contains everything between a body and the sun, and little more of a large ground.
#[test]
fn a_sweep_holds_what_shades_a_body() {
    let (sun, _) = world(1.0);
    let body: Vec<Vec3> = (0..12).map(|i| 3.0 * unit(i)).collect();
    let sweep = Sweep::of(&sun, &body);
    let frame = sun.frame();
    for i in 0..2000 {
        let receiver = body[i as usize % 12].lerp(body[(i as usize + 5) % 12], 0.5);
        let on_disc = 0.00465 * unit(i + 500);
        let way = -frame.axis + on_disc.x * frame.right.normalize() * 0.7 + on_disc.y * frame.up * 0.7;
        let at = receiver + 200.0 * unit(i + 900).x.abs() * way;
        let half = 0.1 + unit(i + 1300).abs() * if i % 3 == 0 { 300.0 } else { 1.0 };
        let bounds = Aabb { min: at - half, max: at + half };
        let part = sweep.part_of(&bounds).unwrap_or_else(|| panic!("{at} is left out"));
        assert!(part.min.cmple(at + 0.01).all() && part.max.cmpge(at - 0.01).all(), "{at} of {part:?}");
    }
    let ground = Aabb { min: Vec3::new(-1000.0, -0.1, -1000.0), max: Vec3::new(1000.0, 6.0, 1000.0) };
    let part = sweep.part_of(&ground).expect("it is below");
    assert!(part.diagonal() < 60.0, "{part:?}");
    let behind = Aabb { min: 50.0 * frame.axis - 1.0, max: 50.0 * frame.axis + 1.0 };
    assert_eq!(sweep.part_of(&behind), None);
}

/// While a camera walks along a street and sees a little more or less in each frame, cascades keep their ends, and boxes stay
/// in place as long as they contain the receivers.
#[test]
fn cascades_stay_while_a_camera_walks() {
    let Some(gpu) = gpu() else { return };
    let depth = empty_depth(gpu, SIZE);
    let mesh = Mesh::horizontal(gpu, Vec2::splat(-900.0), Vec2::splat(900.0), 0.0);
    let casters = [mesh.caster()];
    let mask = Mask::new(gpu.device(), SIZE);
    let (sun, _) = world(1.0);
    let mut stable_boxes = StableBoxes::default();
    let mut boxes: Vec<(u32, [Vec3; 8])> = Vec::new();
    let mut moves = 0;
    const FRAMES: u32 = 60;
    for frame in 0..FRAMES {
        let eye = Vec3::new(0.02 * frame as f32, 1.7, 0.03 * frame as f32);
        let view_from_world = look_at_mat4(eye, eye + Vec3::new(-1.0, -0.05, -0.3), Vec3::Y);
        let world_from_view = view_from_world.inverse();
        // The nearest seen depth varies by a tenth around an end of cascades.
        let nearest_m = cascades::ONE_END_M / cascades::CASCADE_RATIO.powi(2) * (1.0 + 0.1 * unit(frame).x);
        let seen: Vec<Vec3> =
            (0..200).map(|i| world_from_view.transform_point3(Vec3::Z * -(nearest_m + 3.0 * i as f32))).collect();
        // The world's extent varies.
        let far = 700.0 * (1.0 + 0.02 * unit(1000 + frame).y);
        let hull = Aabb { min: Vec3::new(-far, -0.1, -far), max: Vec3::new(40.0, 9.0, 40.0) }.corners();
        let receivers = Receivers { hull: &hull, seen: &seen, view_from_world, ..test_receivers(SIZE, &depth) };
        let frame = PreparedFrame {
            light: &sun,
            casters: PreparedCasters::Draws(&casters),
            receivers: receivers.into(),
            mask: &mask,
            noisy: None,
        };
        let parts = parts_of(&frame, Coverage::Window, Vec3::ZERO, &mut stable_boxes, &SharedValues::default());
        let now: Vec<_> = parts.iter().map(|part| (part.id, part.stable_box.expect("a cascade"))).collect();
        for (part, (_, corners)) in parts.iter().zip(&now) {
            let body = Sweep::of(&sun, corners);
            let of_hull = Sweep::of(&sun, &part.hull);
            assert!(body.holds(&of_hull), "{body:?} does not hold {of_hull:?}");
            assert!(body.width() < 1.4 * of_hull.width(), "{body:?} is far wider than {of_hull:?}");
        }
        if !boxes.is_empty() {
            let ids = |boxes: &[(u32, [Vec3; 8])]| boxes.iter().map(|(id, _)| *id).collect::<Vec<_>>();
            assert_eq!(ids(&now), ids(&boxes), "cascades come and go");
            moves += now.iter().zip(&boxes).filter(|(now, before)| now != before).count();
        }
        boxes = now;
    }
    assert!(boxes.len() >= 3, "{} cascades", boxes.len());
    // The first box is some metres wide, and the camera walks two metres.
    assert!((1..12).contains(&moves), "{moves} boxes moved in {FRAMES} frames");
}

/// Boxes do not depend on the anchor.
#[test]
fn boxes_know_no_anchor() {
    let (sun, _) = world(1.0);
    let points: Vec<Vec3> = (0..20).map(|i| 30.0 * unit(i)).collect();
    let anchor = Vec3::new(512.0, 0.0, -256.0);
    let mut stable_boxes = StableBoxes::default();
    stable_boxes.begin(&sun);
    let here = stable_boxes.hold(7, &points, Vec3::ZERO);
    let moved: Vec<Vec3> = points.iter().map(|x| *x + Vec3::splat(0.3) - anchor).collect();
    let there = stable_boxes.hold(7, &moved, anchor);
    for (here, there) in here.iter().zip(there) {
        assert!(here.distance(there + anchor) < 1e-3, "{here} and {}", there + anchor);
    }
    // Another sun has other boxes.
    stable_boxes.begin(&Light { axis: Vec3::new(0.6, -0.8, 0.0), ..sun.clone() });
    let turned = stable_boxes.hold(7, &points, Vec3::ZERO);
    assert!(turned[0].distance(here[0]) > 1.0);
}

/// Under a sun and under lamps, no part has receivers beyond the shadow distance, or casters that shade nothing nearer; if
/// one map suffices, there is one part.
#[test]
fn parts_end_where_shadows_do() {
    let Some(gpu) = gpu() else { return };
    let depth = empty_depth(gpu, SIZE);
    let mask = Mask::new(gpu.device(), SIZE);
    let (sun, far) = world(1000.0);
    let lamp = Light::new(LightShape::Sphere { radius_m: 0.1 }, Vec3::new(0.5, 2.0, 0.0), Vec3::ZERO);
    let spot = Light { fov_rad: Some(1.0), ..lamp.clone() };
    let slab = |x: f32| Mesh::horizontal(gpu, Vec2::new(x - 2.0, -2.0), Vec2::new(x + 2.0, 2.0), 1.0);
    let meshes = [slab(0.0), slab(-700.0)];
    let casters: Vec<_> = meshes.iter().map(Mesh::caster).collect();
    let receivers = Receivers { hull: &far, ..test_receivers(SIZE, &depth) };
    let eye = receivers.camera().eye_in_world().as_vec3();
    let forward = -receivers.view_from_world.row(2).truncate();
    let parts = |light: &Light, end_m: Option<f32>| {
        let receivers = Receivers { shadow_distance: end_m.map(ShadowDistance::new), ..receivers };
        let frame = PreparedFrame {
            light,
            casters: PreparedCasters::Draws(&casters),
            receivers: receivers.into(),
            mask: &mask,
            noisy: None,
        };
        parts_of(&frame, Coverage::Window, Vec3::ZERO, &mut StableBoxes::default(), &SharedValues::default())
    };
    for (light, end_m) in [(&sun, 150.0), (&sun, 20.0), (&lamp, 30.0), (&spot, 30.0)] {
        let near = parts(light, Some(end_m));
        let all = parts(light, None);
        assert!(!near.is_empty() && near.len() <= all.len().max(1), "{} of {} parts", near.len(), all.len());
        for part in &near {
            let farthest = part.hull.iter().map(|x| (*x - eye).dot(forward)).fold(0.0, f32::max);
            assert!(farthest < 1.001 * end_m, "{farthest} m of {end_m} m: {light:?}");
            assert!(!part.hull.is_empty());
            assert!(part.region.holds(eye + 0.5 * end_m * forward) || near.len() > 1);
            assert!(!part.region.holds(eye + 1.01 * end_m * forward), "{light:?}");
            let casters = part.casters_of(&casters);
            if light.is_distant() {
                assert!(casters.iter().all(|caster| caster.bounds.max.x > -100.0), "what is far is drawn");
            }
        }
        assert!(near.iter().any(|part| !part.casters_of(&casters).is_empty()), "nothing is drawn");
    }
    assert!(parts(&sun, Some(20.0)).len() < parts(&sun, None).len());
    assert_eq!((parts(&spot, Some(30.0)).len(), parts(&spot, None).len()), (1, 0));
}
