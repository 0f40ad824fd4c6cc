//! Prepared frames: positions relative to an anchor near the light.
//!
//! Far from the world's origin 32-bit floats are a millimetre apart, so positions are taken relative to an anchor near the light or
//! the camera, matrices in double precision on the CPU. Unknown sides of boxes become finite.

use antumbra_light::{Aabb, Light, anchor_near};
use glam::{DVec3, Mat4, Vec3};

use super::frame::FrameRequest;
use crate::contract::{
    Camera, DepthMapCaster, MeshCaster, PreparedCasters, PreparedFrame, PreparedReceivers, Surfaces,
};
use crate::light_map::occluding_bounds::{KNOWN_REACH_M, is_known};

/// Maximum distance of a box's sides from the anchor, metres.
const MAX_REACH_M: f32 = 10.0 * KNOWN_REACH_M;

/// Assumed distance of receivers from the camera, metres, if the bounds of neither receivers nor casters are known.
const UNKNOWN_RECEIVERS_M: f32 = 1000.0;

/// Positions of a frame relative to an anchor.
#[derive(Debug)]
pub(super) struct Anchored<'a> {
    anchor: Vec3,
    light: Light,
    bounds: Option<Aabb>,
    hull: Vec<Vec3>,
    seen: Vec<Vec3>,
    /// `Some` if the casters are meshes.
    meshes: Option<Vec<MeshCaster<'a>>>,
}

/// Returns the anchor of a frame: near the light; for a sun, near the camera or the middle of the points' box, if known.
pub(super) fn anchor_of(request: &FrameRequest<'_>) -> Vec3 {
    let about = match request {
        _ if !request.light().is_distant() => request.light().center,
        FrameRequest::Mask(frame) => frame.receivers.camera().eye_in_world().as_vec3(),
        FrameRequest::Points(frame) => {
            let Aabb { min, max } = frame.receivers.bounds;
            let are_known = min.is_finite_mask() & max.is_finite_mask();
            Vec3::select(are_known, 0.5 * min + 0.5 * max, Vec3::ZERO)
        }
    };
    anchor_near(about)
}

impl<'a> Anchored<'a> {
    /// Whether a frame must be converted: its anchor is not the origin, or a box has unknown sides.
    pub(super) fn is_needed(anchor: Vec3, frame: &PreparedFrame<'_>, meshes: Option<&[MeshCaster<'_>]>) -> bool {
        let mut boxes = meshes.unwrap_or_default().iter().map(|mesh| mesh.bounds).chain(frame.receivers.bounds);
        anchor != Vec3::ZERO || boxes.any(|bounds| !bounds.is_empty() && !is_known(&bounds))
    }

    /// Converts a frame's positions.
    pub(super) fn new(anchor: Vec3, frame: &PreparedFrame<'_>, meshes: Option<&[MeshCaster<'a>]>) -> Self {
        let near = |points: &[Vec3]| points.iter().map(|x| *x - anchor).collect();
        let light = frame.light.relative_to(anchor);
        let mesh_near = |mesh: &MeshCaster<'a>| MeshCaster { bounds: finite(moved(mesh.bounds, anchor)), ..*mesh };
        let meshes: Option<Vec<_>> = meshes.map(|meshes| meshes.iter().map(mesh_near).collect());
        let given = frame.receivers.bounds.map(|bounds| moved(bounds, anchor));
        // Receivers with unknown bounds are assumed around the camera, or else around the anchor.
        let eye = frame.receivers.camera().map_or(anchor.as_dvec3(), Camera::eye_in_world);
        let eye = (eye - anchor.as_dvec3()).as_vec3();
        Self {
            anchor,
            light,
            bounds: bounds_of_receivers(given, meshes.as_deref().unwrap_or_default(), eye),
            hull: near(frame.receivers.hull),
            seen: near(frame.receivers.seen),
            meshes,
        }
    }

    /// Converted meshes; `None` if the casters are a depth map.
    pub(super) fn meshes(&self) -> Option<&[MeshCaster<'a>]> {
        self.meshes.as_deref()
    }

    /// Returns the converted frame; mask and depth buffer are unchanged.
    pub(super) fn frame<'f>(&'f self, frame: &PreparedFrame<'f>) -> PreparedFrame<'f> {
        let PreparedFrame { receivers, casters, .. } = frame;
        let casters = match casters {
            PreparedCasters::Draws(meshes) => PreparedCasters::Draws(self.meshes.as_deref().unwrap_or(meshes)),
            PreparedCasters::HostDepthMap(map) => PreparedCasters::HostDepthMap(DepthMapCaster {
                clip_from_world: from_anchor(map.clip_from_world, self.anchor),
                ..*map
            }),
        };
        let surfaces = match receivers.surfaces {
            Surfaces::Depth { depth, camera } => {
                let view_from_world = from_anchor(camera.view_from_world, self.anchor);
                Surfaces::Depth { depth, camera: Camera { view_from_world, ..camera } }
            }
            points @ Surfaces::Points { .. } => points,
        };
        let receivers =
            PreparedReceivers { surfaces, bounds: self.bounds, hull: &self.hull, seen: &self.seen, ..*receivers };
        PreparedFrame { light: &self.light, receivers, casters, ..*frame }
    }
}

/// Clamps a box to finite sides; an empty box is unchanged.
fn finite(bounds: Aabb) -> Aabb {
    if bounds.is_empty() {
        return bounds;
    }
    let most = Vec3::splat(MAX_REACH_M);
    Aabb { min: bounds.min.clamp(-most, most), max: bounds.max.clamp(-most, most) }
}

/// Returns the receivers' box: the host's, or the casters', with unknown sides replaced by sides near the camera. Returns `given`
/// if it is missing or empty and the casters' box is known.
fn bounds_of_receivers(given: Option<Aabb>, meshes: &[MeshCaster<'_>], eye: Vec3) -> Option<Aabb> {
    let known = |bounds: &Aabb| bounds.is_empty() || is_known(bounds);
    let of_casters = || meshes.iter().fold(Aabb::EMPTY, |all, mesh| all.union(mesh.bounds));
    let bounds = match given.filter(|bounds| !bounds.is_empty()) {
        Some(bounds) => bounds,
        None if known(&of_casters()) => return given,
        None => of_casters(),
    };
    if known(&bounds) {
        return Some(bounds);
    }
    let Aabb { min, max } = bounds;
    let [min_is_known, max_is_known] = [min, max].map(|side| side.abs().cmple(Vec3::splat(KNOWN_REACH_M)));
    Some(Aabb {
        min: Vec3::select(min_is_known, min, eye.min(Vec3::select(max_is_known, max, eye)) - UNKNOWN_RECEIVERS_M),
        max: Vec3::select(max_is_known, max, eye.max(Vec3::select(min_is_known, min, eye)) + UNKNOWN_RECEIVERS_M),
    })
}

fn moved(bounds: Aabb, anchor: Vec3) -> Aabb {
    Aabb { min: bounds.min - anchor, max: bounds.max - anchor }
}

/// Converts a matrix on world positions to one on positions relative to an anchor.
fn from_anchor(of_world: Mat4, anchor: Vec3) -> Mat4 {
    (of_world.as_dmat4() * glam::DMat4::from_translation(DVec3::from(anchor))).as_mat4()
}
