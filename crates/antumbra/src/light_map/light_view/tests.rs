//! Closed forms of the view's geometry.

use antumbra_light::{Aabb, Light, LightFrame, LightShape};
use glam::{Mat2, Vec2, Vec3};

use super::{
    FitTo, FollowedLight, LightView, LightViewGpu, MIDDLE_TANGENT, ViewFit, Window, WindowShape, light_view_of_matrix,
};
use crate::contract::{DepthConvention, SeenPoint};
use crate::light_map::occluding_bounds::OccludingBounds;

const MAP_SIZE: u32 = 512;

fn scene() -> (Light, Vec<Aabb>) {
    let light = Light::new(LightShape::Disk { radius_m: 0.25 }, Vec3::new(1.0, 5.0, 2.0), Vec3::new(0.2, 0.0, -0.3));
    let ground = Aabb { min: Vec3::new(-4.0, -0.1, -3.0), max: Vec3::new(4.0, 0.0, 3.0) };
    let block = Aabb { min: Vec3::new(-0.5, 0.0, -0.5), max: Vec3::new(0.5, 2.0, 0.5) };
    (light, vec![ground, block])
}

fn fit_perspective(frame: LightFrame, margin_m: f32, max_angle_tangent: Option<f32>, fit: &FitTo<'_>) -> LightView {
    fit_of_depth(frame, margin_m, 0.0, max_angle_tangent, fit)
}

fn fit_of_depth(
    frame: LightFrame,
    margin_m: f32,
    depth_m: f32,
    max_angle_tangent: Option<f32>,
    fit: &FitTo<'_>,
) -> LightView {
    let casters = OccludingBounds::of_known(fit.casters);
    ViewFit::perspective(frame, FollowedLight::Whole, margin_m, depth_m, max_angle_tangent, &casters, fit.receivers)
        .view(fit.window)
}

fn fit_orthographic(frame: LightFrame, margin: f32, fit: &FitTo<'_>) -> LightView {
    ViewFit::orthographic(frame, margin, &OccludingBounds::of_known(fit.casters), fit.receivers).view(fit.window)
}

/// The sides of a texel at `x` in a map of one texel, metres across the light's rays.
fn texel_widths_m(view: &LightView, x: Vec3) -> Vec2 {
    let from_origin = x - view.frame.center;
    let z = from_origin.dot(view.frame.axis);
    let across = Vec2::new(from_origin.dot(view.frame.right), from_origin.dot(view.frame.up));
    let plane = if view.perspective { across / z.max(view.near_m) } else { across };
    let Window { center, roll, half_size, warp, .. } = view.window;
    let from_center = plane - center;
    let w = (1.0 + warp.dot(from_center)).max(1e-3);
    // dplane/dq = w (1 + (plane − c) warpᵀ) w⁻¹ … per side: w (side + (plane − c) (warp · side)).
    let side = |axis: Vec2, half: f32| {
        let in_warp = 2.0 * half * axis;
        (w * (in_warp + from_center * warp.dot(in_warp))).length()
    };
    let widths = Vec2::new(side(roll, half_size.x), side(roll.perp(), half_size.y));
    if view.perspective { widths * z.max(view.near_m) } else { widths }
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
    let from_center = plane - view.plane_center;
    let divisor = 1.0 + view.warp.dot(from_center);
    let (plane, depth) = (from_center / divisor, depth / divisor);
    let m = view.uv_from_plane;
    let uv = view.uv_origin + Vec2::new(m[0], m[1]) * plane.x + Vec2::new(m[2], m[3]) * plane.y;
    (uv, depth)
}

fn square<'a>(casters: &'a [Aabb], receivers: &'a [Vec3]) -> FitTo<'a> {
    FitTo { casters, receivers, window: WindowShape::Square }
}

/// Views: perspective and orthographic; square, rolled, warped, and warped with shifted texels.
fn views() -> Vec<LightView> {
    let warped = warped_views();
    let shifted = warped.iter().map(|view| view.shifted(Vec2::new(0.4, -0.5), MAP_SIZE));
    plain_views().into_iter().chain(warped.clone()).chain(shifted).collect()
}

/// Warped views of three strengths; the receivers' corners are those of the casters.
fn warped_views() -> Vec<LightView> {
    let (light, casters) = scene();
    let receivers: Vec<Vec3> = casters.iter().flat_map(Aabb::corners).collect();
    let fit = |window| FitTo { casters: &casters, receivers: &receivers, window };
    let window = |turn: f32, strength| WindowShape::Warped { along: Vec2::from_angle(turn), strength };
    vec![
        fit_perspective(light.frame(), 0.0, None, &fit(window(0.4, 0.6))),
        fit_orthographic(light.frame(), 0.0, &fit(window(-2.0, 0.9))),
        // With a margin there is no hull to fit to.
        fit_perspective(light.frame(), 0.25, None, &fit(window(2.5, 0.3))),
    ]
}

fn plain_views() -> Vec<LightView> {
    let (light, casters) = scene();
    let fit = |window| FitTo { casters: &casters, receivers: &[], window };
    let perspective = |window| fit_perspective(light.frame(), 0.25, None, &fit(window));
    let orthographic = |window| fit_orthographic(light.frame(), 0.01, &fit(window));
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
    for view in plain_views() {
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
    let all = fit_perspective(light.frame(), 0.25, None, &square(&casters, &[]));
    let narrow = fit_perspective(light.frame(), 0.25, None, &square(&casters, &receivers.corners()));
    assert!(narrow.window.half_size.x < 0.6 * all.window.half_size.x);
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

/// In a room around a light that shines from a plane, receivers at the edge of the window have occluders beyond it.
#[test]
fn windows_hold_what_shades_receivers_at_their_edge() {
    let (light, _) = scene();
    let frame = light.frame();
    let room = Aabb { min: Vec3::splat(-8.0), max: Vec3::splat(8.0) };
    let at = |tangent: Vec2, z: f32| frame.center + z * (tangent.x * frame.right + tangent.y * frame.up + frame.axis);
    for radius_m in [0.02, 0.1, 0.5] {
        for tangent in [1.0, 2.0, MIDDLE_TANGENT, 4.0 * MIDDLE_TANGENT] {
            let sides = [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y].map(|side| tangent * side);
            let receivers: Vec<Vec3> = sides.iter().flat_map(|side| [at(*side, 0.5), at(*side, 2.0)]).collect();
            // A disc, then a sphere, whose rim as seen by the receiver lies behind its centre.
            for depth_m in [0.0, radius_m] {
                let view = fit_of_depth(frame, radius_m, depth_m, None, &square(&[room], &receivers));
                let gpu = view.to_gpu(MAP_SIZE);
                for side in sides {
                    let receiver = at(side, 2.0);
                    let outwards = (side.x * frame.right + side.y * frame.up) / tangent;
                    let lean = if depth_m > 0.0 { tangent } else { 0.0 };
                    let rim = frame.center + radius_m * (outwards - lean * frame.axis) / lean.hypot(1.0);
                    let z = |point: Vec3| (point - frame.center).dot(frame.axis);
                    let held_m = 1.001 * view.complete_from_m.max(view.near_m);
                    let blocker = receiver.lerp(rim, (2.0 - held_m) / (2.0 - z(rim)));
                    let (uv, _) = uv_and_depth(&gpu, blocker);
                    let is_held = uv.min_element() >= 0.0 && uv.max_element() <= 1.0;
                    assert!(is_held, "a light of {radius_m} m, {depth_m} m deep, a receiver at {side}: {uv}");
                }
            }
        }
    }
}

#[test]
fn geometry_around_the_light_is_cut_not_lost() {
    let (light, _) = scene();
    let room = Aabb { min: Vec3::splat(-8.0), max: Vec3::splat(8.0) };
    let view = fit_perspective(light.frame(), 0.25, None, &square(&[room], &[]));
    assert!(view.window.half_size.x.is_finite() && view.window.half_size.x > 2.0 && view.near_m > 0.0);
    let empty = fit_perspective(light.frame(), 0.25, None, &square(&[], &[]));
    assert!(empty.clip_from_world().is_finite());
}

#[test]
fn a_light_s_own_frustum_narrows_the_window() {
    let (light, casters) = scene();
    let all = fit_perspective(light.frame(), 0.0, None, &square(&casters, &[]));
    let narrow = fit_perspective(light.frame(), 0.0, Some(0.3), &square(&casters, &[]));
    assert!(
        narrow.window.half_size.x < 0.31 && all.window.half_size.x > 0.5,
        "{} {}",
        narrow.window.half_size.x,
        all.window.half_size.x
    );
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
        fit_perspective(frame, 0.0, None, &FitTo { casters: &casters, receivers: &corners, window })
    };
    let WindowShape::Rolled(found) = LightView::best_roll(fit_wall) else { panic!("a rolled window") };
    assert!(found.perp_dot(Vec2::from_angle(roll)).abs() < 0.06, "{found}");
    let fitted = fit_wall(WindowShape::Rolled(found)).window.half_size;
    assert!(fitted.max_element() < 0.66 && fitted.min_element() < 0.1, "{fitted}");
}

/// A texel's sides in the world, against differences of the projection itself.
#[test]
fn texels_are_as_wide_as_the_projection_says() {
    for view in views() {
        let gpu = view.to_gpu(MAP_SIZE);
        let frame = view.frame;
        for x in [Vec3::new(0.3, 0.0, 0.7), Vec3::new(-2.0, 1.0, 1.5)] {
            // uv by metres across the axis at the depth of x, by central differences, and its inverse.
            let step_m = 0.01;
            let by = |axis: Vec3| {
                (uv_and_depth(&gpu, x + step_m * axis).0 - uv_and_depth(&gpu, x - step_m * axis).0) / (2.0 * step_m)
            };
            let plane_from_uv = Mat2::from_cols(by(frame.right), by(frame.up)).inverse();
            let widths = texel_widths_m(&view, x);
            assert!((widths.x / plane_from_uv.x_axis.length() - 1.0).abs() < 2e-3, "{view:?}");
            assert!((widths.y / plane_from_uv.y_axis.length() - 1.0).abs() < 2e-3, "{view:?}");
        }
    }
}

/// The cost of a window is the weighted sum of squared texel sides over the seen points.
#[test]
fn windows_are_judged_by_their_texels() {
    let (light, casters) = scene();
    let seen: Vec<SeenPoint> = (0..19)
        .map(|i| SeenPoint {
            pos_in_world: Vec3::new(0.3 * i as f32 - 3.0, 0.1 * (i % 4) as f32, 0.2 * (i % 7) as f32),
            weight: 1.0 + 0.5 * (i % 3) as f32,
        })
        .collect();
    let windows = [
        WindowShape::Square,
        WindowShape::Rolled(Vec2::from_angle(0.4)),
        WindowShape::Warped { along: Vec2::from_angle(2.1), strength: 0.7 },
    ];
    for fit in [
        ViewFit::perspective(
            light.frame(),
            FollowedLight::Whole,
            0.25,
            0.0,
            None,
            &OccludingBounds::of_known(&casters),
            &[],
        ),
        ViewFit::orthographic(light.frame(), 0.0, &OccludingBounds::of_known(&casters), &[]),
    ] {
        let in_plane = fit.in_plane(&seen);
        for view in windows.map(|window| fit.view(window)) {
            let square = |point: &SeenPoint| point.weight * texel_widths_m(&view, point.pos_in_world).length_squared();
            let expected: f32 = seen.iter().map(square).sum();
            let sum = view.square_texels_m2(&in_plane);
            assert!((sum / expected - 1.0).abs() < 1e-4, "{sum} is not {expected} for {:?}", view.window);
        }
    }
}

/// The corners of a hull are input points, and windows around the hull equal windows around all points.
#[test]
fn hulls_have_the_windows_of_their_points() {
    let points: Vec<Vec2> = (0..200)
        .map(|i| Vec2::new((i * 37 % 101) as f32 / 50.0 - 1.0, (i * 61 % 97) as f32 / 48.0 - 1.0))
        .chain([Vec2::ZERO, Vec2::ZERO, Vec2::NAN])
        .collect();
    let hull = super::hull::convex_hull(points.clone());
    assert!(hull.len() >= 3 && hull.len() < 40 && hull.iter().all(|p| points.contains(p)), "{hull:?}");
    for turn in 0..16 {
        let roll = Vec2::from_angle(0.1 + 0.4 * turn as f32);
        let finite = points.iter().copied().filter(|p| p.is_finite());
        let (of_points, of_hull) =
            (super::window::PlaneWindow::of(finite, roll), super::window::PlaneWindow::of(hull.clone(), roll));
        assert!(of_points.min.abs_diff_eq(of_hull.min, 1e-6) && of_points.max.abs_diff_eq(of_hull.max, 1e-6));
    }
    for few in [vec![], vec![Vec2::X], vec![Vec2::X, Vec2::Y], vec![Vec2::X; 5], vec![Vec2::X; 100]] {
        let mut once = few.clone();
        once.sort_by(|a, b| a.x.total_cmp(&b.x));
        once.dedup();
        assert_eq!(super::hull::convex_hull(few), once);
    }
    let line: Vec<Vec2> = (0..9).map(|i| Vec2::splat(i as f32)).collect();
    assert_eq!(super::hull::convex_hull(line), [Vec2::ZERO, Vec2::splat(8.0)]);
}

#[test]
fn metres_are_told_from_what_a_map_holds() {
    let (_, casters) = scene();
    let mut warped = 0;
    for view in views().iter().map(|view| view.to_gpu(MAP_SIZE)) {
        warped += u32::from(view.warp != Vec2::ZERO);
        let [constant, by_u, by_v] = view.depth_warp();
        for corner in casters.iter().flat_map(Aabb::corners) {
            let (uv, stored) = uv_and_depth(&view, corner);
            let depth = stored / (constant + by_u * uv.x + by_v * uv.y);
            let along = (depth - view.depth_offset) / view.depth_scale;
            let metres = if view.perspective == 1 { along.recip() } else { along };
            let expected = (corner - view.origin_in_world).dot(view.axis_in_world);
            assert!((metres - expected).abs() < 2e-3 * expected.abs(), "{metres} m for {expected}, {view:?}");
        }
    }
    assert!(warped > 1, "{warped} are warped");
}

/// A plane of the world is one of (uv, depth), warped or not: the depths of any three of its points give all others.
#[test]
fn planes_stay_planes() {
    for view in views() {
        let gpu = view.to_gpu(MAP_SIZE);
        let on_plane = |i: f32, j: f32| {
            let (uv, depth) = uv_and_depth(&gpu, Vec3::new(-3.0 + 6.0 * i, 0.4 * i + 0.3 * j, -2.0 + 4.0 * j));
            Vec3::new(uv.x, uv.y, depth)
        };
        let (a, b, c) = (on_plane(0.0, 0.0), on_plane(1.0, 0.0), on_plane(0.0, 1.0));
        let normal = (b - a).cross(c - a).normalize();
        for p in [on_plane(1.0, 1.0), on_plane(0.3, 0.6), on_plane(0.9, 0.1)] {
            assert!((p - a).dot(normal).abs() < 1e-5, "{} in {view:?}", (p - a).dot(normal));
        }
    }
}

#[test]
fn a_road_to_the_horizon_is_warped_and_a_square_is_not() {
    let (light, _) = scene();
    let widest = |seen: &[SeenPoint], view: &LightView| {
        seen.iter().map(|point| texel_widths_m(view, point.pos_in_world).max_element()).fold(0.0, f32::max)
    };
    // Pixels thin out with the square of the distance along the road.
    let along = |length_m: f32| -> Vec<SeenPoint> {
        (0..100)
            .map(|i| {
                let z = length_m / (1.0 + i as f32);
                SeenPoint { pos_in_world: Vec3::new((i % 7) as f32 / 7.0, 0.0, z), weight: 1.0 }
            })
            .collect()
    };
    let window_of = |seen: &[SeenPoint], corners: &[Vec3]| {
        let bounds = [Aabb::of(corners.iter().copied())];
        let fit = ViewFit::orthographic(light.frame(), 0.0, &OccludingBounds::of_known(&bounds), corners);
        let window = LightView::best_window(&fit.in_plane(seen), |window| fit.view(window));
        let rolled = fit.view(LightView::best_roll(|window| fit.view(window)));
        (window, fit.view(window), rolled)
    };
    let road = along(80.0);
    let corners = Aabb { min: Vec3::new(0.0, -0.1, 0.0), max: Vec3::new(1.0, 0.0, 80.0) }.corners();
    let (window, view, rolled) = window_of(&road, &corners);
    assert!(matches!(window, WindowShape::Warped { .. }), "{window:?}");
    assert!(widest(&road[20..], &view) < 0.5 * widest(&road[20..], &rolled));
    // Pixels evenly over a square.
    let square: Vec<SeenPoint> = (0..100)
        .map(|i| SeenPoint { pos_in_world: Vec3::new((i % 10) as f32 / 9.0, 0.0, (i / 10) as f32 / 9.0), weight: 1.0 })
        .collect();
    let corners = Aabb { min: Vec3::new(0.0, -0.1, 0.0), max: Vec3::new(1.0, 0.0, 1.0) }.corners();
    assert!(matches!(window_of(&square, &corners).0, WindowShape::Rolled(_)));
}
