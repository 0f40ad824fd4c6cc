//! Prepared frames: positions relative to an anchor near the light.
//!
//! Far from the world's origin 32-bit floats are a millimetre apart: places are counted from an anchor near what the frame is
//! about, in double precision on the processor. And boxes whose sides are not known have finite sides all the same.

use antumbra_light::{Aabb, Light, anchor_near};
use glam::{DVec3, Mat4, Vec3};

use super::frame::Asked;
use crate::contract::{
    Camera, DepthMapCaster, MeshCaster, PreparedCasters, PreparedFrame, PreparedReceivers, Surfaces,
};
use crate::light_map::occluding_bounds::{KNOWN_REACH_M, is_known};

/// Sides of boxes are no farther from the anchor than this, metres.
const MOST_REACH_M: f32 = 10.0 * KNOWN_REACH_M;

/// How far from the camera receivers are looked for, metres, where neither they nor the casters are known to lie anywhere.
const UNKNOWN_RECEIVERS_M: f32 = 1000.0;

/// A frame's places counted from an anchor.
#[derive(Debug)]
pub(super) struct Anchored<'a> {
    anchor: Vec3,
    light: Light,
    bounds: Option<Aabb>,
    hull: Vec<Vec3>,
    seen: Vec<Vec3>,
    /// Where the casters are meshes.
    meshes: Option<Vec<MeshCaster<'a>>>,
}

/// Near the light; of a sun near the camera, or in the middle of points where that is known.
pub(super) fn anchor_of(asked: &Asked<'_>) -> Vec3 {
    let about = match asked {
        _ if !asked.light().is_distant() => asked.light().center,
        Asked::Mask(frame) => frame.receivers.camera().eye_in_world().as_vec3(),
        Asked::Points(frame) => {
            let Aabb { min, max } = frame.receivers.bounds;
            let are_known = min.is_finite_mask() & max.is_finite_mask();
            Vec3::select(are_known, 0.5 * min + 0.5 * max, Vec3::ZERO)
        }
    };
    anchor_near(about)
}

impl<'a> Anchored<'a> {
    /// Whether a frame has to be said otherwise.
    pub(super) fn is_needed(anchor: Vec3, frame: &PreparedFrame<'_>, meshes: Option<&[MeshCaster<'_>]>) -> bool {
        let mut boxes = meshes.unwrap_or_default().iter().map(|mesh| mesh.bounds).chain(frame.receivers.bounds);
        anchor != Vec3::ZERO || boxes.any(|bounds| !bounds.is_empty() && !is_known(&bounds))
    }

    /// What of the frame has to be said otherwise.
    pub(super) fn new(anchor: Vec3, frame: &PreparedFrame<'_>, meshes: Option<&[MeshCaster<'a>]>) -> Self {
        let near = |points: &[Vec3]| points.iter().map(|x| *x - anchor).collect();
        let light = frame.light.counted_from(anchor);
        let mesh_near = |mesh: &MeshCaster<'a>| MeshCaster { bounds: finite(moved(mesh.bounds, anchor)), ..*mesh };
        let meshes: Option<Vec<_>> = meshes.map(|meshes| meshes.iter().map(mesh_near).collect());
        let given = frame.receivers.bounds.map(|bounds| moved(bounds, anchor));
        // Where receivers are looked for: about the camera, else about what is anchored.
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

    /// The casters' meshes, where they are such.
    pub(super) fn meshes(&self) -> Option<&[MeshCaster<'a>]> {
        self.meshes.as_deref()
    }

    /// The frame, with its mask and depth as they are.
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

/// A box with finite sides; an empty one as it is.
fn finite(bounds: Aabb) -> Aabb {
    if bounds.is_empty() {
        return bounds;
    }
    let most = Vec3::splat(MOST_REACH_M);
    Aabb { min: bounds.min.clamp(-most, most), max: bounds.max.clamp(-most, most) }
}

/// The box of what receives: the host's, or the casters', with sides near the camera in place of those that are not known. `None`
/// where the host has none and the casters' are all known.
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

/// A matrix on places in the world, on places counted from an anchor.
fn from_anchor(of_world: Mat4, anchor: Vec3) -> Mat4 {
    (of_world.as_dmat4() * glam::DMat4::from_translation(DVec3::from(anchor))).as_mat4()
}
