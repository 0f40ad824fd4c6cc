//! Partition of a light's receivers into parts, if one planar map cannot hold them.
//!
//! A planar map holds less than a half-space, and the texels of its outer degrees are missing in its middle. So the receivers
//! are divided into *parts*, each a convex region about the light with a view that suits it. The technique runs for each
//! part as if it were a light of its own, with all other receivers as background, and its result is copied to the light's
//! mask. Techniques know nothing of parts. Each pixel is in exactly one part, since neighbours share planes that differ only
//! in sign, and each part's maps hold all casters that shade its receivers. So seams show only as far as the texels of two
//! maps differ.
//!
//! | light | parts |
//! |---|---|
//! | limited to 70° off its axis, or with all receivers there | one: the undivided light, without further passes |
//! | shines all around | the faces of a cube about it; a technique sees six lights of 90° |
//! | a sun with receivers at very different depths | [`cascades`] along the camera's view that stay in place ([`stable_boxes`]) |
//! | shines from one side of a plane | its middle up to [`MIDDLE_TANGENT`], and square rings up to the horizon, of four sides each |
//!
//! If shadows end at a distance from the camera, parts end there, too, and an undivided light is one part. Receivers beyond
//! are in no part and lit, and shadows fade towards that distance when they are written to the mask.
//!
//! Parts without receivers are omitted, and casters that shade none of a part's receivers are not drawn for it. A part
//! without casters has the smallest maps. If at most one of the middle and rings has casters, the light is not divided.
//!
//! ```text
//! receivers ─► pick ─► receivers of a part ─► technique ─► join ─► mask
//!     part by part: light, hull, casters ───────┘
//! ```
//!
//! # Limits
//! Receivers nearer to the light than its radius lie beside some of its points: their blockers towards such a point may be in
//! another part's maps. Beyond the last ring, within a degree of the light's plane, maps are cut and texels are missing:
//! [`HORIZON_TANGENT`]. Under a sun, casters so far in front of a cascade that they blur over more than all of it may lie
//! outside its map. Errors from a map's texels differ on the two sides of a part's edge: `hard`, `pcss` and `multi_view`
//! have errors as small across edges as beside them, `essm` twice as large (`builtin:lamp-room`, 160 × 90).

use std::f32::consts::FRAC_PI_2;

use antumbra_light::{Light, LightFrame, LightShape};
use glam::{Vec3, Vec4};

use crate::contract::{MeshCaster, PreparedCasters, PreparedFrame, PreparedReceivers};
use crate::gpu::SharedValues;
use crate::light_map::central_view::central_reach;
use crate::light_map::light_view::{HORIZON_TANGENT, MIDDLE_TANGENT};
use crate::light_map::swept_volume::Sweep;

mod cascades;
pub(crate) mod part_images;
pub(crate) mod region;
pub(crate) mod stable_boxes;
#[cfg(test)]
mod tests;

use region::{Body, Region};
use stable_boxes::StableBoxes;

/// Directions around a light that a technique covers without a partition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coverage {
    /// Directions that one planar map holds.
    Window,
    /// Half-space in front of the light's plane.
    HalfSpace,
    /// All directions.
    Everything,
}

/// Part of a light: a cube face, a ring's side, a cascade, or the whole light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// Identifier of the part, stable from frame to frame.
    pub(crate) id: u32,
    /// Light as this part's receivers see it.
    pub(crate) light: Light,
    /// Region that contains the part's receivers.
    pub(crate) region: Region,
    /// Corners of a convex body that contains these receivers.
    pub(crate) hull: Vec<Vec3>,
    /// Seen points of the frame that lie in the region.
    pub(crate) seen: Vec<Vec3>,
    /// Corners of a box that contains the hull and rarely changes; `None` unless the light is a sun.
    pub(crate) stable_box: Option<[Vec3; 8]>,
}

/// Ratio of a ring's outer to its inner tangent: texels then vary about as much in each map as in the middle's.
const RING_RATIO: f32 = 4.0;

/// Tangent by which views of cube faces exceed their regions, so that rounding loses no receiver at an edge.
const FACE_OVERLAP: f32 = 1e-3;

/// Identifier of the part that is the whole light.
const WHOLE: u32 = u32::MAX;

/// Returns the parts of a frame with positions relative to `anchor`; none if the undivided light suffices. `stable_boxes` persist
/// from frame to frame, `shared` has values found for other lights.
pub(crate) fn parts_of(
    frame: &PreparedFrame<'_>,
    coverage: Coverage,
    anchor: Vec3,
    stable_boxes: &mut StableBoxes,
    shared: &SharedValues,
) -> Vec<Part> {
    let PreparedFrame { light, receivers, casters, .. } = frame;
    let meshes = if let PreparedCasters::Draws(meshes) = casters { meshes } else { &[][..] };
    let end = receivers.shadow_end_plane();
    let corners = corners_of(receivers, meshes);
    let does = undivided_light_suffices(frame, coverage, &corners);
    if does && end.is_none() {
        return Vec::new();
    }
    let shared_body = Body::of(receivers, corners, shared);
    let (_, body) = &*shared_body;
    if light.is_distant() {
        stable_boxes.begin(light);
    }
    let mut sectors = if does { Vec::new() } else { sectors_of(light, receivers, body, stable_boxes) };
    if let Some(end) = end {
        if sectors.is_empty() {
            sectors.push((WHOLE, Sector::whole(light)));
        }
        sectors.iter_mut().for_each(|(_, sector)| sector.region.add(end));
    }
    let radius_m = central_reach(light);
    let with_receivers = sectors.into_iter().filter_map(|(id, Sector { light, region, along })| {
        // Receivers nearer than the light's radius are in the region but, if there are others, not in the hull: seen from
        // the light's rim they lie in any direction, and a view that held them would hold little else.
        let beyond_light = along.extend(-radius_m);
        let mut hull = if radius_m > 0.0 { region.corners_within(body, beyond_light) } else { Vec::new() };
        if hull.is_empty() {
            hull = region.corners_within(body, Vec4::ZERO);
        }
        let seen = receivers.seen.iter().copied().filter(|x| region.holds(*x)).collect();
        let stable_box = (light.is_distant() && !hull.is_empty()).then(|| stable_boxes.hold(id, &hull, anchor));
        // The whole light is a part even without receivers: an empty list would mean the undivided light.
        (!hull.is_empty() || id == WHOLE).then_some(Part { id, light, region, hull, seen, stable_box })
    });
    let parts: Vec<Part> = with_receivers.collect();
    if end.is_none() && one_view_suffices(light, &parts, meshes) {
        return Vec::new();
    }
    stable_boxes.keep(|id| parts.iter().any(|part| part.id == id));
    parts
}

/// Whether the undivided light suffices for all receivers, whose convex hull these corners span. Does not consider which
/// receivers the camera sees.
fn undivided_light_suffices(frame: &PreparedFrame<'_>, coverage: Coverage, corners: &[Vec3]) -> bool {
    let light = frame.light;
    let is_open = light.is_omnidirectional() || light.is_distant();
    let enough = if is_open { Coverage::Everything } else { Coverage::HalfSpace };
    let is_hosts_map = !matches!(frame.casters, PreparedCasters::Draws(_));
    is_hosts_map || coverage >= enough || light.validate().is_err() || one_map_holds(light, corners)
}

/// Whether at most one part has casters, for a light whose own view holds all of its parts: its map then contains these
/// casters, and receivers outside the map are lit.
fn one_view_suffices(light: &Light, parts: &[Part], meshes: &[MeshCaster<'_>]) -> bool {
    let has_casters = |part: &&Part| !part.casters_of(meshes).is_empty();
    !light.is_distant() && !light.is_omnidirectional() && parts.iter().filter(has_casters).count() <= 1
}

/// Whether one map holds all that a lamp reaches of the hull of some corners; `false` for suns.
fn one_map_holds(light: &Light, corners: &[Vec3]) -> bool {
    let reaches_no_farther = light.max_angle_tangent().is_some_and(|tangent| tangent <= MIDDLE_TANGENT);
    !light.is_distant() && (reaches_no_farther || is_within(corners, &middle_frame(light), MIDDLE_TANGENT))
}

/// Divides the light's reach into sectors that one map holds each, with identifiers stable from frame to frame; none if one map
/// holds all of the body.
fn sectors_of(
    light: &Light,
    receivers: &PreparedReceivers<'_>,
    body: &Body,
    stable_boxes: &mut StableBoxes,
) -> Vec<(u32, Sector)> {
    if light.is_distant() {
        let cascades = cascades::cascades_of(light, receivers, body.corners(), &mut stable_boxes.ends).into_iter();
        let sector = |region| Sector { region, ..Sector::whole(light) };
        cascades.map(|cascade| (cascade.id, sector(cascade.region))).collect()
    } else if one_map_holds(light, body.corners()) {
        Vec::new()
    } else if light.is_omnidirectional() {
        (0..).zip(cube_of(light, &middle_frame(light))).collect()
    } else {
        (0..).zip(rings_of(light, &middle_frame(light))).collect()
    }
}

/// Candidate for a part: it becomes one if it has receivers.
#[derive(Clone, Debug, PartialEq)]
struct Sector {
    light: Light,
    region: Region,
    /// Unit vector from the light into the region's middle; zero if there is none.
    along: Vec3,
}

impl Sector {
    /// Sector of all that a light reaches.
    fn whole(light: &Light) -> Self {
        Self { light: light.clone(), region: Region::of_planes(light.center, Vec::new()), along: Vec3::ZERO }
    }
}

impl Part {
    /// Returns the casters that may shade the part's receivers, for suns with bounds cut to the part that may.
    pub(crate) fn casters_of<'a>(&self, casters: &[MeshCaster<'a>]) -> Vec<MeshCaster<'a>> {
        if self.light.is_distant() && !self.hull.is_empty() {
            let held = self.stable_box.as_ref().map_or(&self.hull[..], |corners| &corners[..]);
            let sweep = Sweep::of(&self.light, held);
            let of_part =
                |caster: &MeshCaster<'a>| Some(MeshCaster { bounds: sweep.part_of(&caster.bounds)?, ..*caster });
            return casters.iter().filter_map(of_part).collect();
        }
        self.region.casters_of(casters, self.light.bounding_radius())
    }
}

/// Returns points whose convex hull contains all receivers: corners of the casters' boxes if nothing more is known.
fn corners_of(receivers: &PreparedReceivers<'_>, meshes: &[MeshCaster<'_>]) -> Vec<Vec3> {
    let mut corners = receivers.corners();
    if corners.is_empty() {
        corners = meshes.iter().flat_map(|mesh| mesh.bounds.corners()).collect();
    }
    corners.retain(|corner| corner.is_finite());
    corners
}

/// Light's axes about the origin of its views: its centre, or the mean of its points.
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

/// Returns the light turned along each of its axes and their opposites, limited to a frustum of 90 degrees.
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

/// Returns the light's shape in terms of other axes of its own.
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

/// Returns the middle sector in front of the light, and square rings around it, up to the light's own frustum.
fn rings_of(light: &Light, frame: &LightFrame) -> Vec<Sector> {
    let LightFrame { center, right, up, axis } = *frame;
    // Plane in front of which points are farther off the axis than a tangent, along a direction.
    let beyond = |tangent: f32, along: Vec3| along - tangent * axis;
    let reach = light.max_angle_tangent().unwrap_or(f32::INFINITY);
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
