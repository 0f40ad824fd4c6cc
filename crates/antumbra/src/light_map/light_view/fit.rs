//! Fitting of light views to the casters and receivers that matter.

use antumbra_light::{Aabb, LightFrame};
use glam::{Vec2, Vec3};

use super::hull::convex_hull;
use super::window::PlaneWindow;
use super::{LightView, WindowShape};
use crate::light_map::occluding_bounds::OccludingBounds;

/// Tangent of the largest angle off its axis that one view holds if receivers lie all around it (70 degrees): the texels of
/// the last 20 degrees would be missing everywhere else. (Under a lamp in Sponza, `multi_view` has rmse .194 with 80 degrees
/// in one view and .175 with 70.) What lies beyond has views of its own: `light_partition`.
pub(crate) const MIDDLE_TANGENT: f32 = 2.75;

/// Tangent of the angle off its axis at which a view ends (89 degrees): no planar map holds a half-space. Receivers beyond are lit.
pub(crate) const HORIZON_TANGENT: f32 = 64.0;

/// Largest factor by which a window is widened to hold the segments that leave it, from receivers farthest off its axis: a wider
/// window would lack texels in its middle. The map's edge represents blockers beyond it, which are close to the light.
const MAX_WIDENED: f32 = 1.15;

/// Nearest depth of a perspective view, as a fraction of its farthest. With reversed 32-bit depth the
/// precision does not depend on it; it keeps the margin finite for lights that casters cross.
const MIN_NEAR_FRACTION: f32 = 1e-3;

/// Upper limit of that nearest depth, metres, however far the view reaches.
const MAX_NEAR_M: f32 = 0.05;

/// Receiver-to-light segments that a technique follows in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FollowedLight {
    /// Segments to the whole light; those of receivers farthest off the axis leave the receivers' window.
    Whole,
    /// Segments to the light's centre; a kernel of fixed width stands for the others.
    Center,
}

/// Geometry and window shape to which a view is fitted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitTo<'a> {
    /// World-space bounding boxes of the casters.
    pub(crate) casters: &'a [Aabb],
    /// World-space points whose convex hull contains the receivers; empty if unknown.
    pub(crate) receivers: &'a [Vec3],
    /// Shape of the window.
    pub(crate) window: WindowShape,
}

/// Fit target of a view, in the light plane; the same for every window shape that is tried.
#[derive(Clone, Debug)]
pub(crate) struct ViewFit {
    pub(super) frame: LightFrame,
    pub(super) perspective: bool,
    pub(super) near_m: f32,
    far_m: f32,
    complete_from_m: f32,
    /// Light-plane points with the convex hull of the casters: the corners of all boxes, or of the hull.
    casters: Vec<Vec2>,
    /// Light-plane points with the convex hull of the receivers; `None` if unknown.
    receivers: Option<Vec<Vec2>>,
    /// Distance by which segments to the light leave the receivers' window, in light-plane coordinates.
    margin: f32,
    /// Tangent of the light's own frustum, if it has one; receivers outside it do not count.
    max_angle_tangent: Option<f32>,
}

impl ViewFit {
    /// Fits a perspective view from `frame.center` to the casters and receivers that matter.
    ///
    /// Outside the casters' window nothing is occluded, and outside the receivers' nothing is shaded; the view's window is
    /// their intersection. First the receivers' window is widened for `margin_m`, the largest distance of a light point from
    /// the origin: segments to that point leave the receivers' window by up to `margin_m · (1/near − 1/far)`.
    ///
    /// `depth_m` is the largest distance of a light point from the light's plane. Seen from the side, such points lie farther
    /// out, so for these lights the margin holds segments only from a larger depth on than for flat lights.
    ///
    /// `max_angle_tangent` is the tangent of the light's own frustum, if it has one: receivers outside it do not count.
    pub(crate) fn perspective(
        frame: LightFrame,
        followed: FollowedLight,
        margin_m: f32,
        depth_m: f32,
        max_angle_tangent: Option<f32>,
        casters: &OccludingBounds,
        receivers: &[Vec3],
    ) -> Self {
        let in_light = |point: Vec3| {
            let p = point - frame.center;
            Vec3::new(p.dot(frame.right), p.dot(frame.up), p.dot(frame.axis))
        };
        let boxes: Vec<[Vec3; 8]> = casters.all().map(|bounds| bounds.corners().map(in_light)).collect();
        let receivers: Vec<Vec3> = receivers.iter().copied().map(in_light).collect();
        let (near, far) = depth_range(&boxes, &receivers);
        let mut of_receivers = Vec::new();
        add_tangents(&mut of_receivers, &receivers, near, HORIZON_TANGENT);
        // Casters outside the receivers' window and its margin shade receivers only if they are close to the light.
        let complete_from_m = margin_depth(near, far, margin_m);
        let asked = of_receivers.iter().fold(0.0f32, |farthest, p| farthest.max(p.abs().max_element()));
        let needed = asked + margin_m * (1.0 / complete_from_m - 1.0 / far);
        let (farthest, complete_from_m) = match followed {
            FollowedLight::Center => (asked.max(MIDDLE_TANGENT), complete_from_m),
            FollowedLight::Whole => {
                let widest = MAX_WIDENED * asked.max(MIDDLE_TANGENT);
                let held_by_widest = margin_m / (widest - asked + margin_m / far);
                (needed.clamp(MIDDLE_TANGENT, widest), if needed > widest { held_by_widest } else { complete_from_m })
            }
        };
        let margin = margin_m * (1.0 / complete_from_m - 1.0 / far);
        let complete_from_m = if complete_from_m > near {
            // A point `depth_m` behind the plane appears on it farther out by depth_m · tan θ; no point of an ellipsoid is both
            // that deep and at its rim.
            let seen_m = margin_m.hypot(depth_m * asked);
            1.0 / (margin / seen_m + 1.0 / far)
        } else {
            0.0
        };
        let mut of_casters = Vec::with_capacity(8 * boxes.len());
        for corners in &boxes {
            add_tangents(&mut of_casters, corners, near, farthest);
        }
        of_casters.retain(|p| p.is_finite());
        of_receivers.retain(|p| p.is_finite());
        Self {
            frame,
            perspective: true,
            near_m: near,
            far_m: far,
            complete_from_m,
            casters: of_casters,
            receivers: (!receivers.is_empty()).then_some(of_receivers),
            margin,
            max_angle_tangent,
        }
    }

    /// Fits an orthographic view along the axis to the casters and receivers that matter. `margin` is the tangent of the
    /// largest angle between the axis and a direction of the light.
    ///
    /// If casters may be anywhere, the far plane is at the farthest receiver. Reversed float depth is finest there, however far in front
    /// of it casters begin, since floats are densest near 0.
    pub(crate) fn orthographic(frame: LightFrame, margin: f32, casters: &OccludingBounds, receivers: &[Vec3]) -> Self {
        let seen = Aabb::of(receivers.iter().copied());
        let is_by_receivers = casters.unknown.is_some() && !receivers.is_empty();
        let asked = if is_by_receivers { seen } else { casters.all().fold(seen, Aabb::union) };
        // The origin is the centre of that box, not the light's: small coordinates keep their bits.
        let origin = if asked.is_empty() { frame.center } else { asked.center() };
        let frame = LightFrame { center: origin, ..frame };
        let depth = |x: &Vec3| (*x - origin).dot(frame.axis);
        let corners = asked.corners();
        let of_asked = if is_by_receivers { receivers } else { &corners[..] };
        let (near, far) = of_asked
            .iter()
            .map(depth)
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(near, far), depth| (near.min(depth), far.max(depth)));
        let (near, far) = if near.is_finite() && far.is_finite() { (near, far) } else { (0.0, 1.0) };
        let nearest_of = |bounds: Aabb| bounds.corners().iter().map(depth).fold(near, f32::min);
        let near_of_known = casters.known.iter().map(|bounds| nearest_of(*bounds)).fold(near, f32::min);
        let near = casters.unknown.map_or(near_of_known, |bounds| nearest_of(bounds).min(near_of_known));
        let pad = 1e-3 * (far - near_of_known).max(1e-3);
        let (near, near_of_known, far) = (near - pad, near_of_known - pad, far + pad);
        let in_plane = |p: &Vec3| Vec2::new((p - origin).dot(frame.right), (p - origin).dot(frame.up));
        let of_casters = casters.all().flat_map(|bounds| bounds.corners().map(|corner| in_plane(&corner)));
        let asked = PlaneWindow::of(receivers.iter().map(in_plane), Vec2::X);
        // Shadows of casters so far off that they blur over more than the receivers' window may be cut.
        let most = if receivers.is_empty() { f32::INFINITY } else { 0.5 * (asked.max - asked.min).max_element() };
        Self {
            frame,
            perspective: false,
            near_m: near,
            far_m: far,
            complete_from_m: 0.0,
            casters: of_casters.filter(|p| p.is_finite()).collect(),
            receivers: (!receivers.is_empty())
                .then(|| receivers.iter().map(in_plane).filter(|p| p.is_finite()).collect()),
            // Unknown casters may be anywhere; no window can hold all that they blur.
            margin: (margin * (far - near_of_known)).min(most),
            max_angle_tangent: None,
        }
    }

    /// Moves the near plane to at least `near_m`.
    pub(crate) fn beginning_at(self, near_m: f32) -> Self {
        Self { near_m: self.near_m.max(near_m), ..self }
    }

    /// Reduces all points to their convex hulls, which pays off if many windows are tried.
    pub(crate) fn for_many_windows(self) -> Self {
        Self { casters: convex_hull(self.casters), receivers: self.receivers.map(convex_hull), ..self }
    }

    /// Returns the view with a window of this shape.
    pub(crate) fn view(&self, window: WindowShape) -> LightView {
        let roll = window.roll();
        let casters = PlaneWindow::of(self.casters.iter().copied(), roll);
        let asked = self.receivers.as_ref().map(|points| PlaneWindow::of(points.iter().copied(), roll));
        let needed = if self.perspective {
            let asked = asked.unwrap_or(casters);
            let reached = self.max_angle_tangent.map_or(asked, |t| {
                let corners = [Vec2::new(t, t), Vec2::new(-t, t), Vec2::new(t, -t), Vec2::new(-t, -t)];
                asked.intersection(PlaneWindow::of(corners, roll))
            });
            casters.intersection(reached.grown(self.margin))
        } else {
            asked.map_or(casters, |asked| casters.intersection(asked.grown(self.margin)))
        };
        let hull = self.receivers.as_deref().filter(|_| self.margin == 0.0).unwrap_or_default();
        let window = needed.place(window, hull);
        let Self { frame, perspective, near_m, far_m, complete_from_m, .. } = *self;
        LightView { frame, perspective, window, near_m, far_m, complete_from_m }
    }
}

/// Returns the near and far plane of a perspective view of light-space boxes of casters and points of receivers, metres.
fn depth_range(boxes: &[[Vec3; 8]], receivers: &[Vec3]) -> (f32, f32) {
    let (mut near, mut far) = (f32::INFINITY, 0.0f32);
    for corner in boxes.iter().flatten() {
        near = near.min(corner.z);
        far = far.max(corner.z);
    }
    far = receivers.iter().fold(far, |far, p| far.max(p.z));
    // A light with nothing in front still has a view; its map stays empty.
    let far = if far > 0.0 { far * 1.001 } else { 1.0 };
    let near = (near * 0.999).clamp((far * MIN_NEAR_FRACTION).min(MAX_NEAR_M), far * 0.99);
    (near, far)
}

/// Smallest caster depth for which the margin widens the receivers' window, metres. If a caster's box contains the light, as a
/// room's does, its triangles may be at any depth; a window that held all segments to the light's rim up to the near plane
/// would be hundreds of times as wide as the receivers' window. Casters nearer than the light's radius shade only receivers in
/// whose window they lie.
fn margin_depth(near: f32, far: f32, light_radius_m: f32) -> f32 {
    /// Upper limit as a fraction of `far`, for lights as large as the distance to their receivers.
    const MAX_OF_FAR: f32 = 1.0 / 8.0;
    near.max(light_radius_m.min(MAX_OF_FAR * far))
}

/// Adds the tangents that span the part beyond depth `near` of the convex hull of light-space points: those of the points
/// there, and those where segments between the points cross `near`. Tangents are clamped to ±`most`.
fn add_tangents(tangents: &mut Vec<Vec2>, points: &[Vec3], near: f32, most: f32) {
    let tangent = |p: Vec3| (p.truncate() / p.z).clamp(Vec2::splat(-most), Vec2::splat(most));
    for p in points {
        if p.z >= near {
            tangents.push(tangent(*p));
        } else {
            let beyond = points.iter().filter(|q| q.z >= near);
            tangents.extend(beyond.map(|q| tangent(p.lerp(*q, (near - p.z) / (q.z - p.z)))));
        }
    }
}
