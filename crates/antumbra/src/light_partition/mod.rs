//! Partition of a light's receivers into parts, where one planar map cannot hold them.
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
//! | a sun, whose receivers' depths differ much | cascades along the camera's view: [`cascades`], that stay where they are: [`stable_boxes`] |
//! | before its plane | its middle, [`MIDDLE_TANGENT`] wide, and about it square rings to the horizon, four sides each, in the same light plane |
//!
//! Where shadows end at a distance from the camera, parts end there too, and a light without parts is one part; what lies
//! beyond is in none and lit, and before it shadows fade on their way into the mask.
//!
//! Parts without receivers are left out, and casters that shade none of a part's receivers are not drawn for it. A part
//! without casters has the smallest maps; and where no more than one of a light's rings has any, the light is one part.
//!
//! ```text
//! receivers ─► pick ─► receivers of a part ─► technique ─► join ─► mask
//!     part by part: light, hull, casters ───────┘
//! ```
//!
//! # Limits
//! Receivers nearer to the light than it is large lie beside some of its points: what such a point sees of them may be in
//! another part's maps. Beyond the last ring, within a degree of the light's plane, texels of a map that is cut there are
//! missed: [`HORIZON_TANGENT`]. Under a sun what is so far before a cascade that it blurs over more than all of it may lie
//! beside its map. What a technique gets wrong by its map's texels is another thing on the two sides of an edge: `hard`,
//! `pcss` and `multi_view` err as little across edges as beside them, `essm` twice as much (`builtin:lamp-room`, 160 × 90).

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
    /// Corners of a box that holds the hull and mostly stays where it is; of a sun's cascade.
    pub(crate) stable_box: Option<[Vec3; 8]>,
}

/// How far rings reach, as a multiple of the ring inside: each map's texels then differ about as much as the middle's.
const RING_RATIO: f32 = 4.0;

/// A cube's faces reach so much farther than their regions, as tangents: no receiver at an edge is left out by rounding.
const FACE_OVERLAP: f32 = 1e-3;

/// The number of the part that is all there is.
const WHOLE: u32 = u32::MAX;

/// The parts of a frame whose places are counted from an anchor; none where the light as it is does for all of them. `still`
/// is what the frames before left, `shared` what other lights have found.
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
    let does = does_as_it_is(frame, coverage, &corners);
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
        // Those that are nearer than the light is large, if there are others, are in the region and not in the hull: seen
        // from the light's rim they lie in any direction, and a view that held them would hold little else.
        let beyond_light = along.extend(-radius_m);
        let mut hull = if radius_m > 0.0 { region.corners_within(body, beyond_light) } else { Vec::new() };
        if hull.is_empty() {
            hull = region.corners_within(body, Vec4::ZERO);
        }
        let seen = receivers.seen.iter().copied().filter(|x| region.holds(*x)).collect();
        let stable_box = (light.is_distant() && !hull.is_empty()).then(|| stable_boxes.hold(id, &hull, anchor));
        // Without receivers the whole is still a part: where nothing is near enough, that is what has to be known.
        (!hull.is_empty() || id == WHOLE).then_some(Part { id, light, region, hull, seen, stable_box })
    });
    let parts: Vec<Part> = with_receivers.collect();
    if end.is_none() && one_view_suffices(light, &parts, meshes) {
        return Vec::new();
    }
    stable_boxes.keep(|id| parts.iter().any(|part| part.id == id));
    parts
}

/// Whether the light as it is does for all receivers, whose convex hull these corners span, as far as that is told without
/// looking at what the camera sees of them.
fn does_as_it_is(frame: &PreparedFrame<'_>, coverage: Coverage, corners: &[Vec3]) -> bool {
    let light = frame.light;
    let is_open = light.shines_all_around() || light.is_distant();
    let enough = if is_open { Coverage::Everything } else { Coverage::HalfSpace };
    let is_hosts_map = !matches!(frame.casters, PreparedCasters::Draws(_));
    is_hosts_map || coverage >= enough || light.validate().is_err() || one_map_holds(light, corners)
}

/// Whether receivers of one part alone have casters, of a light whose view is that of all of its parts: its map holds those
/// casters, and what lies beside it is lit.
fn one_view_suffices(light: &Light, parts: &[Part], meshes: &[MeshCaster<'_>]) -> bool {
    let has_casters = |part: &&Part| !part.casters_of(meshes).is_empty();
    !light.is_distant() && !light.shines_all_around() && parts.iter().filter(has_casters).count() <= 1
}

/// Whether one map holds all of some corners' hull that a lamp reaches; of a sun that is another question.
fn one_map_holds(light: &Light, corners: &[Vec3]) -> bool {
    let reaches_no_farther = light.reach_tangent().is_some_and(|tangent| tangent <= MIDDLE_TANGENT);
    !light.is_distant() && (reaches_no_farther || is_within(corners, &middle_frame(light), MIDDLE_TANGENT))
}

/// What the light reaches, cut into what one map holds each, with numbers that are the same from frame to frame; none where
/// one does for all of the body.
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
    } else if light.shines_all_around() {
        (0..).zip(cube_of(light, &middle_frame(light))).collect()
    } else {
        (0..).zip(rings_of(light, &middle_frame(light))).collect()
    }
}

/// A part that there may be.
#[derive(Clone, Debug, PartialEq)]
struct Sector {
    light: Light,
    region: Region,
    /// The unit vector from the light into the region's middle; zero where there is no such.
    along: Vec3,
}

impl Sector {
    /// All that a light reaches.
    fn whole(light: &Light) -> Self {
        Self { light: light.clone(), region: Region::of_planes(light.center, Vec::new()), along: Vec3::ZERO }
    }
}

impl Part {
    /// The casters that may shade the part's receivers, with the bounds of what of them may.
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

/// Points whose convex hull holds every receiver: of the casters' boxes where nothing more is known.
fn corners_of(receivers: &PreparedReceivers<'_>, meshes: &[MeshCaster<'_>]) -> Vec<Vec3> {
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
