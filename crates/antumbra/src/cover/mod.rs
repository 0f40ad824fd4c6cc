//! How one light's state covers what the light reaches, where that is more than a planar map holds.
//!
//! A planar map holds less than a half-space, and the texels that its outer degrees take are missed in its middle. So what
//! receives is cut into *parts*, each a convex region about the light with a view that suits it; the technique runs for
//! each part as if it were a light of its own, on receivers of which all others are background; and what it gives goes into
//! the light's mask. No technique knows of it. Each pixel is in one part, by planes whose signs alone differ between
//! neighbours, and each part's maps hold all that shades its receivers: so there is no seam to see but in what the maps'
//! own texels are.
//!
//! | light | parts |
//! |---|---|
//! | that is held to 70° of its axis, or whose receivers lie there | one: the light as it is, and no pass more |
//! | that shines all around | the faces of a cube about it; a technique sees six lights of 90° |
//! | a sun, whose receivers' depths differ much | slices along the camera's view: [`slices`] |
//! | before its plane | its middle, [`MIDDLE_TANGENT`] wide, and about it square rings to the horizon, four sides each, in the same light plane |
//!
//! Parts without receivers are left out, and casters that shade none of a part's receivers are not drawn for it.
//!
//! ```text
//! receivers ─► pick ─► receivers of a part ─► technique ─► join ─► mask
//!     part by part: light, hull, casters ───────┘
//! ```
//!
//! # Limits
//! Receivers nearer to the light than it is large lie beside some of its points: what such a point sees of them may be in
//! another part's maps. Beyond the last ring, within a degree of the light's plane, texels of a map that is cut there are
//! missed: [`HORIZON_TANGENT`]. Under a sun what is so far before a slice that it blurs over more than all of it may lie
//! beside its map. What a technique gets wrong by its map's texels is another thing on the two sides of an edge: `hard`,
//! `pcss` and `multi_view` err as little across edges as beside them, `essm` twice as much (`builtin:lamp-room`, 160 × 90).

use std::f32::consts::FRAC_PI_2;

use antumbra_light::{Light, LightFrame, LightShape};
use glam::{Vec3, Vec4};

use crate::contract::{Casters, Frame, MeshCaster, Receivers};
use crate::light_map::central_view::central_reach;
use crate::light_map::light_view::{HORIZON_TANGENT, MIDDLE_TANGENT};

pub(crate) mod pictures;
pub(crate) mod region;
mod slices;
mod sweep;
#[cfg(test)]
mod tests;

use region::{Body, Region};
use sweep::Sweep;

/// How much of what a light reaches a state of a technique covers by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coverage {
    /// What one planar map holds.
    Window,
    /// All that is before the light's plane.
    HalfSpace,
    /// All around the light.
    Everything,
}

/// A part of what a light reaches.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// Which of the parts that there may be: the same from frame to frame.
    pub(crate) id: u32,
    /// The light as this part's receivers see it.
    pub(crate) light: Light,
    /// What its receivers lie in.
    pub(crate) region: Region,
    /// Corners of a convex body that holds them.
    pub(crate) hull: Vec<Vec3>,
    /// Those of the points that the camera is known to see.
    pub(crate) seen: Vec<Vec3>,
}

/// How far rings reach, as a multiple of the ring inside: each map's texels then differ about as much as the middle's.
const RING_RATIO: f32 = 4.0;

/// A cube's faces reach so much farther than their regions, as tangents: no receiver at an edge is left out by rounding.
const FACE_OVERLAP: f32 = 1e-3;

/// The parts of a frame; none where the light as it is does for all of them.
pub(crate) fn parts_of(frame: &Frame<'_>, coverage: Coverage) -> Vec<Part> {
    let Frame { light, receivers, casters, .. } = frame;
    let Casters::Meshes(meshes) = casters else { return Vec::new() };
    let is_open = light.shines_all_around() || light.is_distant();
    let enough = if is_open { Coverage::Everything } else { Coverage::HalfSpace };
    if coverage >= enough || light.validate().is_err() {
        return Vec::new();
    }
    let frame = middle_frame(light);
    let reaches_no_farther = light.reach_tangent().is_some_and(|tangent| tangent <= MIDDLE_TANGENT);
    let is_held =
        |corners: &[Vec3]| !light.is_distant() && (reaches_no_farther || is_within(corners, &frame, MIDDLE_TANGENT));
    let corners = corners_of(receivers, meshes);
    if is_held(&corners) {
        return Vec::new();
    }
    let body = Body::of(receivers, &corners);
    let parts = if light.is_distant() {
        let slices = slices::slices_of(light, receivers, body.corners()).into_iter();
        slices.map(|region| Sector { light: (*light).clone(), region, along: Vec3::ZERO }).collect()
    } else if is_held(body.corners()) {
        Vec::new()
    } else if light.shines_all_around() {
        cube_of(light, &frame)
    } else {
        rings_of(light, &frame)
    };
    let radius_m = central_reach(light);
    let with_receivers = parts.into_iter().zip(0..).filter_map(|(Sector { light, region, along }, id)| {
        // Those that are nearer than the light is large, if there are others, are in the region and not in the hull: seen
        // from the light's rim they lie in any direction, and a view that held them would hold little else.
        let beyond_light = along.extend(-radius_m);
        let mut hull = if radius_m > 0.0 { region.corners_within(&body, beyond_light) } else { Vec::new() };
        if hull.is_empty() {
            hull = region.corners_within(&body, Vec4::ZERO);
        }
        let seen = receivers.seen.iter().copied().filter(|x| region.holds(*x)).collect();
        (!hull.is_empty()).then_some(Part { id, light, region, hull, seen })
    });
    with_receivers.collect()
}

/// A part that there may be.
#[derive(Clone, Debug, PartialEq)]
struct Sector {
    light: Light,
    region: Region,
    /// The unit vector from the light into the region's middle; zero where there is no such.
    along: Vec3,
}

impl Part {
    /// The casters that may shade the part's receivers, with the bounds of what of them may.
    pub(crate) fn casters_of<'a>(&self, casters: &[MeshCaster<'a>]) -> Vec<MeshCaster<'a>> {
        if self.light.is_distant() {
            let sweep = Sweep::of(&self.light, &self.hull);
            let of_part =
                |caster: &MeshCaster<'a>| Some(MeshCaster { bounds: sweep.part_of(&caster.bounds)?, ..*caster });
            return casters.iter().filter_map(of_part).collect();
        }
        let radius_m = self.light.bounding_radius();
        casters.iter().filter(|caster| self.region.may_be_shaded_by(caster, radius_m)).copied().collect()
    }
}

/// Points whose convex hull holds every receiver: of the casters' boxes where nothing more is known.
fn corners_of(receivers: &Receivers<'_>, meshes: &[MeshCaster<'_>]) -> Vec<Vec3> {
    let mut corners = receivers.corners();
    if corners.is_empty() {
        corners = meshes.iter().flat_map(|mesh| mesh.bounds.corners()).collect();
    }
    corners.retain(|corner| corner.is_finite());
    corners
}

/// The light's axes about where it is seen from: its centre, or the mean of its points.
fn middle_frame(light: &Light) -> LightFrame {
    let frame = light.frame();
    match light.shape {
        LightShape::Points { .. } => LightFrame { center: light.moments().mean_in_world(&frame), ..frame },
        _ => frame,
    }
}

/// Whether all points lie within a tangent off the axis, along right and up.
fn is_within(points: &[Vec3], frame: &LightFrame, tangent: f32) -> bool {
    points.iter().all(|point| {
        let p = *point - frame.center;
        let half = p.dot(frame.axis) * tangent;
        p.dot(frame.right).abs() <= half && p.dot(frame.up).abs() <= half
    })
}

/// The light as it looks along each of its axes and their opposites, held to a frustum of 90 degrees.
fn cube_of(light: &Light, frame: &LightFrame) -> Vec<Sector> {
    let LightFrame { center, right, up, axis } = *frame;
    // Axis, up, right: the same vectors, to the bit, on both sides of an edge.
    let faces = [
        [axis, up, right],
        [right, up, -axis],
        [-right, up, axis],
        [up, -axis, right],
        [-up, axis, right],
        [-axis, up, -right],
    ];
    let of_face = |[axis, up, right]: [Vec3; 3]| {
        let region = Region::cone(center, &[axis - right, axis + right, axis - up, axis + up]);
        let fov_rad = Some(FRAC_PI_2 + FACE_OVERLAP);
        let shape = shape_along(light, [right, up, axis]);
        Sector { light: Light { shape, center, axis, up, fov_rad, ..light.clone() }, region, along: axis }
    };
    faces.into_iter().map(of_face).collect()
}

/// The light's shape as said along other axes of its own.
fn shape_along(light: &Light, axes: [Vec3; 3]) -> LightShape {
    match &light.shape {
        LightShape::Ellipsoid { radii_m } => {
            let frame = light.frame();
            let radius = |along: Vec3| {
                radii_m.dot(Vec3::new(along.dot(frame.right), along.dot(frame.up), along.dot(frame.axis)).abs())
            };
            LightShape::Ellipsoid { radii_m: Vec3::from_array(axes.map(radius)) }
        }
        shape => shape.clone(),
    }
}

/// The middle of what is before the light, and square rings about it, up to the frustum that it is held to.
fn rings_of(light: &Light, frame: &LightFrame) -> Vec<Sector> {
    let LightFrame { center, right, up, axis } = *frame;
    // In front of these is what is farther off the axis than a tangent, along a direction.
    let beyond = |tangent: f32, along: Vec3| along - tangent * axis;
    let reach = light.reach_tangent().unwrap_or(f32::INFINITY);
    let sides = [right, up, -right, -up];
    let mut regions = vec![(Region::cone(center, &sides.map(|side| -beyond(MIDDLE_TANGENT, side))), axis)];
    let mut from = MIDDLE_TANGENT;
    while from < reach.min(HORIZON_TANGENT) {
        let to = RING_RATIO * from;
        let is_last = to >= reach.min(HORIZON_TANGENT);
        for (i, side) in sides.into_iter().enumerate() {
            let next = sides[(i + 1) % 4];
            let outer = if is_last { axis } else { -beyond(to, side) };
            // Corners belong to the side that is farther off.
            regions.push((Region::cone(center, &[beyond(from, side), outer, side - next, side + next]), side));
        }
        from = to;
    }
    regions.into_iter().map(|(region, along)| Sector { light: light.clone(), region, along }).collect()
}
