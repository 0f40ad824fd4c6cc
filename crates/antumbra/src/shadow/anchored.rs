//! Frames far from the world's origin, where 32-bit floats are a millimetre apart: their places are counted from an anchor
//! near what they are about, in double precision on the processor, before any technique sees them.

use antumbra_light::{Aabb, Light, anchor_near};
use glam::{DVec3, Mat4, Vec3};

use crate::contract::{Casters, DepthMapCaster, Frame, MeshCaster, Receivers};

/// A frame's places counted from an anchor.
#[derive(Debug)]
pub(super) struct Anchored<'a> {
    anchor: Vec3,
    light: Light,
    hull: Vec<Vec3>,
    seen: Vec<Vec3>,
    /// Where the casters are meshes.
    meshes: Option<Vec<MeshCaster<'a>>>,
}

/// Near the light; of a sun near the camera.
pub(super) fn anchor_of(frame: &Frame<'_>) -> Vec3 {
    let about = if frame.light.is_distant() { frame.receivers.eye_in_world().as_vec3() } else { frame.light.center };
    anchor_near(about)
}

impl<'a> Anchored<'a> {
    /// What of the frame has to be counted anew.
    pub(super) fn new(anchor: Vec3, frame: &Frame<'_>, meshes: Option<&[MeshCaster<'a>]>) -> Self {
        let near = |points: &[Vec3]| points.iter().map(|x| *x - anchor).collect();
        let light = frame.light.counted_from(anchor);
        let mesh_near = |mesh: &MeshCaster<'a>| MeshCaster { bounds: moved(mesh.bounds, anchor), ..*mesh };
        Self {
            anchor,
            light,
            hull: near(frame.receivers.hull),
            seen: near(frame.receivers.seen),
            meshes: meshes.map(|meshes| meshes.iter().map(mesh_near).collect()),
        }
    }

    /// The casters' meshes, where they are such.
    pub(super) fn meshes(&self) -> Option<&[MeshCaster<'a>]> {
        self.meshes.as_deref()
    }

    /// The frame, with its mask and depth as they are.
    pub(super) fn frame<'f>(&'f self, frame: &Frame<'f>) -> Frame<'f> {
        let Frame { receivers, casters, .. } = frame;
        let casters = match (casters, &self.meshes) {
            (_, Some(meshes)) => Casters::Meshes(meshes),
            (Casters::DepthMap(map), None) => Casters::DepthMap(DepthMapCaster {
                clip_from_world: from_anchor(map.clip_from_world, self.anchor),
                ..*map
            }),
            (other, None) => *other,
        };
        let receivers = Receivers {
            view_from_world: from_anchor(receivers.view_from_world, self.anchor),
            bounds: receivers.bounds.map(|bounds| moved(bounds, self.anchor)),
            hull: &self.hull,
            seen: &self.seen,
            ..*receivers
        };
        Frame { light: &self.light, receivers, casters, ..*frame }
    }
}

fn moved(bounds: Aabb, anchor: Vec3) -> Aabb {
    Aabb { min: bounds.min - anchor, max: bounds.max - anchor }
}

/// A matrix on places in the world, on places counted from an anchor.
fn from_anchor(of_world: Mat4, anchor: Vec3) -> Mat4 {
    (of_world.as_dmat4() * glam::DMat4::from_translation(DVec3::from(anchor))).as_mat4()
}
