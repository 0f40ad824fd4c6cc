//! Casters whose bounds are not known: finite boxes in place of theirs, which hold what may shade a frame's receivers.

use antumbra_light::Aabb;
use glam::Vec3;

use crate::contract::{Casters, Frame, MeshCaster};

/// How far from the camera receivers are looked for, metres, where neither they nor the casters are known to lie anywhere.
const UNKNOWN_RECEIVERS_M: f32 = 1000.0;

/// How far before what receives casters under a sun are looked for, metres, or as far as that reaches: what may stand farther blurs
/// over the wider a margin of the map.
const UNKNOWN_CASTERS_M: f32 = 100.0;

/// The frame's meshes with finite boxes; `None` where all have such.
pub(super) fn with_finite_bounds<'a>(
    frame: &Frame<'a>,
    meshes: Option<&[MeshCaster<'a>]>,
) -> Option<Vec<MeshCaster<'a>>> {
    let given = if let Casters::Meshes(given) = frame.casters { given } else { &[] };
    let meshes = meshes.unwrap_or(given);
    let is_known = |bounds: &Aabb| bounds.is_empty() || (bounds.min.is_finite() && bounds.max.is_finite());
    if meshes.iter().all(|mesh| is_known(&mesh.bounds)) {
        return None;
    }
    let region = region_of(frame);
    let finite = |mesh: &MeshCaster<'a>| MeshCaster { bounds: finite(mesh.bounds, region), ..*mesh };
    Some(meshes.iter().map(finite).collect())
}

/// Box that casters have to meet to shade a receiver.
fn region_of(frame: &Frame<'_>) -> Aabb {
    let finite = frame.receivers.corners().into_iter().filter(|corner| corner.is_finite());
    let mut receivers = Aabb::of(finite);
    if receivers.is_empty() {
        let eye = frame.receivers.eye_in_world().as_vec3();
        receivers = Aabb { min: eye - UNKNOWN_RECEIVERS_M, max: eye + UNKNOWN_RECEIVERS_M };
    }
    if frame.light.is_distant() {
        // Before them alone: what lies on the light's far side of all receivers shades none.
        let towards = -UNKNOWN_CASTERS_M.max(receivers.diagonal()) * frame.light.frame().axis;
        return receivers.union(Aabb { min: receivers.min + towards, max: receivers.max + towards });
    }
    let radius = Vec3::splat(frame.light.bounding_radius());
    receivers.union(Aabb { min: frame.light.center - radius, max: frame.light.center + radius })
}

/// A box with the region's sides in place of those that are not known.
fn finite(bounds: Aabb, region: Aabb) -> Aabb {
    if bounds.is_empty() {
        return bounds;
    }
    let sides = |of_box: Vec3, of_region: Vec3| Vec3::select(of_box.is_finite_mask(), of_box, of_region);
    let (min, max) = (sides(bounds.min, region.min), sides(bounds.max, region.max));
    Aabb { min: min.min(max), max: max.max(min) }
}
