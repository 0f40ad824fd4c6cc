//! Views from the light's middle, fitted to casters and receivers.

use antumbra_light::{Aabb, Light, LightShape};
use glam::Vec3;

use super::light_spread::LightSpread;
use super::light_view::{FitTo, Followed, LightView, ViewFit, WindowShape};
use super::occluding_bounds::Between;
use crate::contract::SeenPoint;

/// The light's view, fitted in a square window to casters' boxes and receivers' corners.
pub(crate) fn fit_light_view(light: &Light, casters: &[Aabb], receivers: &[Vec3]) -> LightView {
    let fit = FitTo { casters, receivers, window: WindowShape::Square };
    fit_central_view_within(light, Followed::Middle, central_reach(light), &fit)
}

/// How far the light reaches from where it is seen from: its centre, or of a list of points their mean, whatever centre it was
/// given.
pub(crate) fn central_reach(light: &Light) -> f32 {
    match &light.shape {
        LightShape::Points { .. } => light.moments().radius,
        _ => light.bounding_radius(),
    }
}

/// What views from the light's middle are fitted to, whatever their windows.
pub(crate) fn central_fit(
    light: &Light,
    followed: Followed,
    reach: f32,
    casters: &[Aabb],
    receivers: &[Vec3],
) -> ViewFit {
    let casters = &Between::new(light, casters, receivers);
    if light.is_distant() {
        ViewFit::orthographic(light.frame(), reach, casters, receivers)
    } else {
        let mut frame = light.frame();
        if matches!(light.shape, LightShape::Points { .. }) {
            frame.center = light.moments().mean_in_world(&frame);
        }
        let depth_m = LightSpread::of(light).extent_axis;
        ViewFit::perspective(frame, followed, reach, depth_m, light.reach_tangent(), casters, receivers)
    }
}

/// The same where the light reaches no farther than `reach` from its middle along either of the window's axes: metres,
/// for a sun a tangent.
pub(crate) fn fit_central_view_within(light: &Light, followed: Followed, reach: f32, fit: &FitTo<'_>) -> LightView {
    central_fit(light, followed, reach, fit.casters, fit.receivers).view(fit.window)
}

/// A map's window may be warped where what is seen has texels of at most this width for it: half as wide. Texels of one
/// size are steadier when the camera moves, and filters about them exact.
const SEEN_MUST_GAIN: f32 = 0.5;

/// The central view in the window, of any shape, that gives what is seen the smallest texels; in a square one where that
/// gains little.
pub(crate) fn fit_seen_view(fit: &ViewFit, seen: &[SeenPoint]) -> LightView {
    let seen = fit.in_plane(seen);
    let square = fit.view(WindowShape::Square);
    let shaped = fit.view(LightView::best_window(&seen, |shape| fit.view(shape)));
    let width = |view: &LightView| view.square_texels_m2(&seen).sqrt();
    if width(&shaped) < SEEN_MUST_GAIN * width(&square) { shaped } else { square }
}
