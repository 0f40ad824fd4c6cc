//! Views from the light's centre, fitted to casters and receivers.

use antumbra_light::{Aabb, Light, LightShape};
use glam::Vec3;

use super::light_spread::LightSpread;
use super::light_view::{FitTo, FollowedLight, LightView, ViewFit, WindowShape};
use super::occluding_bounds::OccludingBounds;
use crate::contract::SeenPoint;

/// Returns the light's view with a square window, fitted to casters' boxes and receivers' corners.
pub(crate) fn fit_light_view(light: &Light, casters: &[Aabb], receivers: &[Vec3]) -> LightView {
    let fit = FitTo { casters, receivers, window: WindowShape::Square };
    fit_central_view_within(light, FollowedLight::Center, central_reach(light), &fit)
}

/// Radius of the light about the origin of its views, metres, for a sun a tangent. The origin is the light's centre, or the mean
/// of a list of points.
pub(crate) fn central_reach(light: &Light) -> f32 {
    match &light.shape {
        LightShape::Points { .. } => light.moments().radius,
        _ => light.bounding_radius(),
    }
}

/// Fit target of views from the light's centre, for any window; `reach` as in [`fit_central_view_within`].
pub(crate) fn central_fit(
    light: &Light,
    followed: FollowedLight,
    reach: f32,
    casters: &[Aabb],
    receivers: &[Vec3],
) -> ViewFit {
    let casters = &OccludingBounds::new(light, casters, receivers);
    if light.is_distant() {
        ViewFit::orthographic(light.frame(), reach, casters, receivers)
    } else {
        let mut frame = light.frame();
        if matches!(light.shape, LightShape::Points { .. }) {
            frame.center = light.moments().mean_in_world(&frame);
        }
        let depth_m = LightSpread::of(light).extent_axis;
        ViewFit::perspective(frame, followed, reach, depth_m, light.max_angle_tangent(), casters, receivers)
    }
}

/// Returns the view from the centre of a light that extends at most `reach` from it along either of the window's axes:
/// metres, for a sun a tangent.
pub(crate) fn fit_central_view_within(
    light: &Light,
    followed: FollowedLight,
    reach: f32,
    fit: &FitTo<'_>,
) -> LightView {
    central_fit(light, followed, reach, fit.casters, fit.receivers).view(fit.window)
}

/// Largest texel width on seen receivers, relative to a square window, for which another window is used. Texels of equal
/// size are more stable when the camera moves, and filters over them are exact.
const SEEN_MUST_GAIN: f32 = 0.5;

/// Returns the central view with the window of any shape that gives seen receivers the smallest texels, or with a square
/// window if that gains little.
pub(crate) fn fit_seen_view(fit: &ViewFit, seen: &[SeenPoint]) -> LightView {
    let seen = fit.in_plane(seen);
    let square = fit.view(WindowShape::Square);
    let shaped = fit.view(LightView::best_window(&seen, |shape| fit.view(shape)));
    let width = |view: &LightView| view.square_texels_m2(&seen).sqrt();
    if width(&shaped) < SEEN_MUST_GAIN * width(&square) { shaped } else { square }
}
