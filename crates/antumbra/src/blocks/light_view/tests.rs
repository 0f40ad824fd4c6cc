//! Closed forms of the view's geometry.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::{LightView, LightViewGpu, light_view_of_matrix};
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

fn both_views() -> [LightView; 2] {
    let (light, casters) = scene();
    [
        LightView::fit_perspective(light.frame(), 0.25, None, &casters, None),
        LightView::fit_orthographic(light.frame(), 0.01, &casters, None),
    ]
}

#[test]
fn every_corner_lies_in_the_fitted_view() {
    let (_, casters) = scene();
    for view in both_views() {
        for corner in casters.iter().flat_map(Aabb::corners) {
            let (uv, depth) = uv_and_depth(&view.to_gpu(MAP_SIZE), corner);
            assert!(uv.min_element() >= 0.0 && uv.max_element() <= 1.0, "{uv}");
            assert!((0.0..=1.0).contains(&depth), "{depth}");
        }
    }
}

#[test]
fn formulas_match_the_rasteriser_s_matrix() {
    for view in both_views() {
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
    for view in both_views() {
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
    let matrix = both_views()[0].clip_from_world();
    let size = Vec2::splat(MAP_SIZE as f32);
    assert!(light_view_of_matrix(sideways.frame(), true, matrix, DepthConvention::Reversed, size).is_none());
}

#[test]
fn receivers_narrow_the_window_and_keep_the_light_s_margin() {
    let (light, casters) = scene();
    let receivers = Aabb { min: Vec3::new(0.0, 0.0, 0.0), max: Vec3::new(1.0, 0.1, 1.0) };
    let all = LightView::fit_perspective(light.frame(), 0.25, None, &casters, None);
    let narrow = LightView::fit_perspective(light.frame(), 0.25, None, &casters, Some(receivers));
    assert!(narrow.half_size < 0.6 * all.half_size);
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
    let view = LightView::fit_perspective(light.frame(), 0.25, None, &[room], None);
    assert!(view.half_size.is_finite() && view.half_size > 2.0 && view.near_m > 0.0);
    let empty = LightView::fit_perspective(light.frame(), 0.25, None, &[], None);
    assert!(empty.clip_from_world().is_finite());
}

#[test]
fn a_light_s_own_frustum_narrows_the_window() {
    let (light, casters) = scene();
    let all = LightView::fit_perspective(light.frame(), 0.0, None, &casters, None);
    let narrow = LightView::fit_perspective(light.frame(), 0.0, Some(0.3), &casters, None);
    assert!(narrow.half_size < 0.31 && all.half_size > 0.5, "{} {}", narrow.half_size, all.half_size);
}
