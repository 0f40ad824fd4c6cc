//! Stable views under a sun: texels stay in place in the world while the camera moves.
//!
//! Such a map is fitted not to the receivers but to a box around them that rarely changes ([`Stage::stable_box`]). When the box
//! changes, the new map's texels coincide with the old one's: window sides are quantised, so that texels mostly keep their
//! width, and windows lie at whole texels from the world's origin. Near and far plane are quantised, too, since filtered
//! depths are fractions of the range between them.

use antumbra_light::LightFrame;
use glam::{DVec2, DVec3, UVec2, Vec2, Vec3};

use super::light_view::{LightView, Window};
use crate::contract::PreparedReceivers;
use crate::gpu::Stage;

/// Number of window sides per octave: a few percent of the texels are unused.
const SIDES_IN_OCTAVE: f64 = 32.0;

/// Number of steps in the range between near and far plane to which both are rounded.
const DEPTH_STEPS: f64 = 32.0;

/// Returns points whose convex hull contains the receivers, to which maps with a window along the light's axes are fitted.
pub(crate) fn corners_to_hold(stage: &Stage<'_>, receivers: &PreparedReceivers<'_>) -> Vec<Vec3> {
    stage.stable_box().map_or_else(|| receivers.corners(), |corners| corners.to_vec())
}

/// Returns a view that contains `view` and has stable texels in a map of `map_size` texels, or `view` if it needs no stable texels.
pub(crate) fn in_whole_texels(stage: &Stage<'_>, view: LightView, map_size: UVec2) -> LightView {
    let is_level = view.window.warp == Vec2::ZERO && view.window.roll == Vec2::X;
    if stage.stable_box().is_none() || view.perspective || !is_level {
        return view;
    }
    laid_in_texels(view, map_size, stage.anchor())
}

fn laid_in_texels(view: LightView, map_size: UVec2, anchor: Vec3) -> LightView {
    let LightFrame { center, right, up, axis } = view.frame;
    let axes = [right, up, axis].map(Vec3::as_dvec3);
    // Coordinates of the window's centre, from the world's origin.
    let origin = center.as_dvec3() + anchor.as_dvec3();
    let [x, y, z] = axes.map(|axis| axis.dot(origin));
    let middle = DVec2::new(x, y) + view.window.center.as_dvec2();
    // One texel more, since rounding moves the centre by up to half a texel.
    let sides = 2.0 * view.window.half_size.as_dvec2();
    let least = sides.max_element() * (1.0 + 1.0 / f64::from(map_size.min_element()));
    let longer = ((least.log2() * SIDES_IN_OCTAVE).ceil() / SIDES_IN_OCTAVE).exp2();
    let sides = sides * (longer / sides.max_element());
    let texel = sides / map_size.as_dvec2();
    let middle = (middle / texel).round() * texel;
    let (near, far) = (z + f64::from(view.near_m), z + f64::from(view.far_m));
    let step = (far - near).log2().ceil().exp2() / DEPTH_STEPS;
    let (near, far) = ((near / step).floor() * step, (far / step).ceil() * step);
    let along: DVec3 = middle.x * axes[0] + middle.y * axes[1] + 0.5 * (near + far) * axes[2];
    let half_range_m = (0.5 * (far - near)) as f32;
    LightView {
        frame: LightFrame { center: (along - anchor.as_dvec3()).as_vec3(), ..view.frame },
        window: Window { half_size: (0.5 * sides).as_vec2(), center: Vec2::ZERO, ..view.window },
        near_m: -half_range_m,
        far_m: half_range_m,
        ..view
    }
}

#[cfg(test)]
mod tests {
    use antumbra_light::{Light, LightShape};

    use super::*;

    const MAP_SIZE: UVec2 = UVec2::new(1000, 640);

    /// View with a window of the given centre and half size, and the given depth range.
    fn view(center: Vec2, half_size: f32, [near_m, far_m]: [f32; 2], origin: Vec3) -> LightView {
        let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.01 }, Vec3::ZERO, Vec3::new(0.5, -0.4, 0.3));
        let frame = LightFrame { center: origin, ..sun.frame() };
        let half_size = half_size * Vec2::new(1.0, 0.64);
        let window = Window { center, half_size, ..Window::square(1.0) };
        LightView { frame, perspective: false, window, near_m, far_m, complete_from_m: 0.0 }
    }

    /// Position of `x` in the view's map, in texels.
    fn texel_of(view: LightView, x: Vec3) -> Vec2 {
        let at = view.clip_from_world_f64().project_point3(x.as_dvec3()).truncate() * DVec2::new(0.5, -0.5) + 0.5;
        (at * MAP_SIZE.as_dvec2()).as_vec2()
    }

    /// If a window moves by fractions of a texel and its depth range changes slightly, points keep their position within texels,
    /// the depth range is the same, and the map contains the requested window.
    #[test]
    fn texels_stay_where_they_are() {
        let x = Vec3::new(3.0, 1.0, -2.0);
        let origin = Vec3::new(1.0, 2.0, 3.0);
        let at_first = view(Vec2::new(0.4, -0.7), 9.7, [-30.0, 50.0], origin);
        let first = laid_in_texels(at_first, MAP_SIZE, Vec3::ZERO);
        let side_m = 2.0 * first.window.half_size.x;
        assert!(side_m < 1.03 * 2.0 * 9.7, "{side_m} m for {} m", 2.0 * 9.7);
        let texel = texel_of(first, x);
        for i in 1..50 {
            let drift = 0.013 * i as f32;
            let moved = view(Vec2::new(0.4 + drift, -0.7 - 0.5 * drift), 9.7 + 1e-3 * drift, [-30.1, 50.2], origin);
            let laid = laid_in_texels(moved, MAP_SIZE, Vec3::ZERO);
            assert!(laid.window.half_size.abs_diff_eq(first.window.half_size, 1e-5), "{:?}", laid.window);
            let range = |view: &LightView| view.far_m - view.near_m;
            assert_eq!(range(&laid), range(&first));
            let moved_texels = texel_of(laid, x) - texel;
            let off = (moved_texels - moved_texels.round()).abs().max_element();
            assert!(off < 0.02, "frame {i}: {moved_texels} texels");
            // Corners of the requested view are inside.
            for corner in [Vec2::ONE, -Vec2::ONE, Vec2::new(1.0, -1.0)] {
                let LightFrame { center, right, up, axis } = moved.frame;
                let at = moved.window.center + moved.window.half_size * corner;
                for depth in [moved.near_m, moved.far_m] {
                    let x = center + at.x * right + at.y * up + depth * axis;
                    let clip = laid.clip_from_world().project_point3(x);
                    assert!(clip.x.abs() <= 1.0 && clip.y.abs() <= 1.0, "{clip}");
                    assert!((-1e-4..=1.0 + 1e-4).contains(&clip.z), "{clip}");
                }
            }
        }
    }

    /// Texels do not depend on the anchor.
    #[test]
    fn anchors_leave_texels_where_they_are() {
        let x = Vec3::new(3.0, 1.0, -2.0);
        let anchor = Vec3::new(256.0, 0.0, -512.0);
        let here = laid_in_texels(view(Vec2::new(0.4, -0.7), 9.7, [-30.0, 50.0], x), MAP_SIZE, Vec3::ZERO);
        let moved = view(Vec2::new(0.43, -0.7), 9.7, [-30.0, 50.0], x - anchor);
        let there = laid_in_texels(moved, MAP_SIZE, anchor);
        let texels = texel_of(there, x - anchor) - texel_of(here, x);
        assert!((texels - texels.round()).abs().max_element() < 0.02, "{texels}");
    }
}
