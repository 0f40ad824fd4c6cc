//! Closed forms of the view's geometry.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::{FitTo, LightView, LightViewGpu, WindowShape, light_view_of_matrix};
use crate::contract::DepthConvention;

const MAP_SIZE: u32 = 512;

fn scene() -> (Light, Vec<Aabb>) {
    let light = Light::new(LightShape::Disk { radius_m: 0.25 }, Vec3::new(1.0, 5.0, 2.0), Vec3::new(0.2, 0.0, -0.3));
    let ground = Aabb { min: Vec3::new(-4.0, -0.1, -3.0), max: Vec3::new(4.0, 0.0, 3.0) };
    let block = Aabb { min: Vec3::new(-0.5, 0.0, -0.5), max: Vec3::new(0.5, 2.0, 0.5) };
    (light, vec![ground, block])
}

/// The shaders' formulas, on the CPU.
fn uv_and_depth(view: &LightViewGpu, x: Vec3) -> (Vec2, f32) {
    let p = x - view.origin_in_world;
    let z = p.dot(view.axis_in_world);
    let plane = Vec2::new(p.dot(view.right_in_world), p.dot(view.up_in_world));
    let (plane, depth) = if view.perspective == 1 {
        (plane / z, view.depth_scale / z + view.depth_offset)
    } else {
        (plane, view.depth_scale * z + view.depth_offset)
    };
    let m = view.uv_from_plane;
    let uv = view.uv_origin + Vec2::new(m[0], m[1]) * plane.x + Vec2::new(m[2], m[3]) * plane.y;
    (uv, depth)
}

fn square<'a>(casters: &'a [Aabb], receivers: &'a [Vec3]) -> FitTo<'a> {
    FitTo { casters, receivers, window: WindowShape::Square }
}

/// Perspective and orthographic, square and rolled.
fn views() -> Vec<LightView> {
    let (light, casters) = scene();
    let fit = |window| FitTo { casters: &casters, receivers: &[], window };
    let perspective = |window| LightView::fit_perspective(light.frame(), 0.25, None, &fit(window));
    let orthographic = |window| LightView::fit_orthographic(light.frame(), 0.01, &fit(window));
    let rolled = WindowShape::Rolled(Vec2::from_angle(0.4));
    vec![perspective(WindowShape::Square), orthographic(WindowShape::Square), perspective(rolled), orthographic(rolled)]
}

#[test]
fn every_corner_lies_in_the_fitted_view() {
    let (_, casters) = scene();
    for view in views() {
        for corner in casters.iter().flat_map(Aabb::corners) {
            let (uv, depth) = uv_and_depth(&view.to_gpu(MAP_SIZE), corner);
            assert!(uv.min_element() >= 0.0 && uv.max_element() <= 1.0, "{uv}");
            assert!((0.0..=1.0).contains(&depth), "{depth}");
        }
    }
}

#[test]
fn formulas_match_the_rasteriser_s_matrix() {
    for view in views() {
        for x in [Vec3::new(0.3, 0.0, 0.7), Vec3::new(-2.0, 1.0, 1.5)] {
            let ndc = view.clip_from_world().project_point3(x);
            let (uv, depth) = uv_and_depth(&view.to_gpu(MAP_SIZE), x);
            assert!(uv.abs_diff_eq(ndc.truncate() * Vec2::new(0.5, -0.5) + 0.5, 1e-5));
            assert!((depth - ndc.z).abs() < 1e-5, "{depth} {}", ndc.z);
        }
    }
}

#[test]
fn a_host_s_matrix_gives_the_same_view() {
    for view in views() {
        let own = view.to_gpu(MAP_SIZE);
        let size = Vec2::splat(MAP_SIZE as f32);
        let hosts =
            light_view_of_matrix(view.frame, view.perspective, view.clip_from_world(), DepthConvention::Reversed, size)
                .expect("our own matrix is one");
        for x in [Vec3::new(0.3, 0.0, 0.7), Vec3::new(-2.0, 1.0, 1.5)] {
            let ((uv, depth), (uv_host, depth_host)) = (uv_and_depth(&own, x), uv_and_depth(&hosts, x));
            assert!(uv.abs_diff_eq(uv_host, 1e-4) && (depth - depth_host).abs() < 1e-4);
        }
        assert!((hosts.near_m - own.near_m).abs() < 1e-2 * own.far_m.abs());
    }
    let (light, _) = scene();
    let sideways = Light::new(LightShape::Disk { radius_m: 0.25 }, light.center, light.center + Vec3::X);
    let matrix = views()[0].clip_from_world();
    let size = Vec2::splat(MAP_SIZE as f32);
    assert!(light_view_of_matrix(sideways.frame(), true, matrix, DepthConvention::Reversed, size).is_none());
}

#[test]
fn receivers_narrow_the_window_and_keep_the_light_s_margin() {
    let (light, casters) = scene();
    let receivers = Aabb { min: Vec3::new(0.0, 0.0, 0.0), max: Vec3::new(1.0, 0.1, 1.0) };
    let all = LightView::fit_perspective(light.frame(), 0.25, None, &square(&casters, &[]));
    let narrow = LightView::fit_perspective(light.frame(), 0.25, None, &square(&casters, &receivers.corners()));
    assert!(narrow.half_size.x < 0.6 * all.half_size.x);
    // A blocker at the near plane between a receiver's corner and the light's rim still lies in the map.
    let gpu = narrow.to_gpu(MAP_SIZE);
    for corner in receivers.corners() {
        for rim in [light.frame().right, -light.frame().right, light.frame().up, -light.frame().up] {
            let p = light.center + 0.25 * rim;
            let z = (corner - light.center).dot(light.axis);
            let on_near = corner.lerp(p, 1.0 - narrow.near_m / z);
            let (uv, _) = uv_and_depth(&gpu, on_near);
            assert!(uv.min_element() >= 0.0 && uv.max_element() <= 1.0, "{uv}");
        }
    }
}

#[test]
fn geometry_around_the_light_is_cut_not_lost() {
    let (light, _) = scene();
    let room = Aabb { min: Vec3::splat(-8.0), max: Vec3::splat(8.0) };
    let view = LightView::fit_perspective(light.frame(), 0.25, None, &square(&[room], &[]));
    assert!(view.half_size.x.is_finite() && view.half_size.x > 2.0 && view.near_m > 0.0);
    let empty = LightView::fit_perspective(light.frame(), 0.25, None, &square(&[], &[]));
    assert!(empty.clip_from_world().is_finite());
}

#[test]
fn a_light_s_own_frustum_narrows_the_window() {
    let (light, casters) = scene();
    let all = LightView::fit_perspective(light.frame(), 0.0, None, &square(&casters, &[]));
    let narrow = LightView::fit_perspective(light.frame(), 0.0, Some(0.3), &square(&casters, &[]));
    assert!(narrow.half_size.x < 0.31 && all.half_size.x > 0.5, "{} {}", narrow.half_size.x, all.half_size.x);
}

#[test]
fn the_best_roll_lies_along_a_tilted_wall() {
    let (light, _) = scene();
    let roll = 0.5_f32;
    let fit_wall = |window| {
        // Corners of a wall 10 by 1, turned about the light's axis.
        let frame = light.frame();
        let corners: Vec<Vec3> = [(5.0, 0.5), (-5.0, 0.5), (5.0, -0.5), (-5.0, -0.5)]
            .map(|(x, y)| {
                let p = Vec2::from_angle(roll).rotate(Vec2::new(x, y));
                frame.center + p.x * frame.right + p.y * frame.up + 8.0 * frame.axis
            })
            .to_vec();
        let casters = [Aabb::of(corners.iter().copied())];
        LightView::fit_perspective(frame, 0.0, None, &FitTo { casters: &casters, receivers: &corners, window })
    };
    let WindowShape::Rolled(found) = LightView::best_roll(fit_wall) else { panic!("a rolled window") };
    assert!(found.perp_dot(Vec2::from_angle(roll)).abs() < 0.06, "{found}");
    let fitted = fit_wall(WindowShape::Rolled(found)).half_size;
    assert!(fitted.max_element() < 0.66 && fitted.min_element() < 0.1, "{fitted}");
}
