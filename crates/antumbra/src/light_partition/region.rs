//! Convex region of space about a light, bounded by a few planes.

use std::sync::Arc;

use antumbra_light::{Aabb, Polytope, enclosing_planes};
use glam::{DVec4, Vec3, Vec4};

use crate::contract::{MeshCaster, PreparedReceivers};
use crate::gpu::{SharedValues, gpu_structs};

/// Largest number of a region's planes, as in `light_partition/region.wesl`.
const MAX_PLANES: usize = 6;

gpu_structs! {
    /// [`Region`] for the shaders.
    pub(crate) struct RegionGpu {
        origin_in_world: Vec3,
        plane_count: u32,
        planes: [Vec4; MAX_PLANES],
    }
}

/// Region of points x with `plane · (x − origin, 1) ≥ 0` for all planes.
///
/// Two regions that share a side have its plane with opposite signs, to the bit: whatever the rounding, every point is inside
/// at least one of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Region {
    origin: Vec3,
    planes: Vec<Vec4>,
}

impl Region {
    /// Region in front of planes through the origin with these normals, of any length.
    pub(crate) fn cone(origin: Vec3, normals: &[Vec3]) -> Self {
        debug_assert!(normals.len() <= MAX_PLANES, "{} planes", normals.len());
        Self { origin, planes: normals.iter().map(|normal| normal.extend(0.0)).collect() }
    }

    /// Region in front of planes given relative to the origin.
    pub(crate) fn of_planes(origin: Vec3, planes: Vec<Vec4>) -> Self {
        debug_assert!(planes.len() <= MAX_PLANES, "{} planes", planes.len());
        Self { origin, planes }
    }

    /// Cuts off what is behind a world-space plane.
    pub(crate) fn add(&mut self, plane: DVec4) {
        debug_assert!(self.planes.len() < MAX_PLANES, "{} planes and one more", self.planes.len());
        let normal = plane.truncate();
        self.planes.push(normal.as_vec3().extend((plane.w + normal.dot(self.origin.as_dvec3())) as f32));
    }

    pub(crate) fn to_gpu(&self) -> RegionGpu {
        let mut planes = [Vec4::ZERO; MAX_PLANES];
        for (to, plane) in planes.iter_mut().zip(&self.planes) {
            *to = *plane;
        }
        RegionGpu { origin_in_world: self.origin, plane_count: self.planes.len() as u32, planes }
    }

    fn in_world(&self, plane: Vec4) -> DVec4 {
        let (normal, offset) = (plane.truncate().as_dvec3(), f64::from(plane.w));
        normal.extend(offset - normal.dot(self.origin.as_dvec3()))
    }

    pub(crate) fn holds(&self, x: Vec3) -> bool {
        self.planes.iter().all(|plane| plane.truncate().dot(x - self.origin) + plane.w >= 0.0)
    }

    /// Returns the corners of the part of `body` inside the region and in front of the plane `more`, which is relative to the
    /// origin; empty if there is no such part.
    pub(crate) fn corners_within(&self, body: &Body, more: Vec4) -> Vec<Vec3> {
        let of_region = self.planes.iter().chain([&more]).map(|plane| self.in_world(*plane));
        body.polytope.corners_within(&of_region.collect::<Vec<_>>())
    }

    /// Returns the casters that may lie between points inside and a light of radius `radius_m` about the origin.
    pub(crate) fn casters_of<'a>(&self, casters: &[MeshCaster<'a>], radius_m: f32) -> Vec<MeshCaster<'a>> {
        // Receivers are in front of each plane, and light points at most by the radius farther behind it than the
        // origin; the same holds for all points between them.
        let least = |plane: &Vec4| (plane.w - radius_m * plane.truncate().length()).min(0.0);
        let planes: Vec<(Vec4, f32)> = self.planes.iter().map(|plane| (*plane, least(plane))).collect();
        let may_shade = |caster: &&MeshCaster<'a>| {
            let Aabb { min, max } = caster.bounds;
            planes.iter().all(|(plane, least)| {
                let normal = plane.truncate();
                let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), max, min) - self.origin;
                let in_front = normal.dot(farthest) + plane.w;
                // A box with NaN may be anywhere.
                in_front.is_nan() || in_front >= *least
            })
        };
        let mut found = Vec::with_capacity(casters.len());
        found.extend(casters.iter().filter(may_shade));
        found
    }
}

/// Convex body that contains every receiver.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// Polytope of only those planes that bound the body, so that cuts have few corners to compute.
    polytope: Polytope,
    corners: Vec<Vec3>,
}

/// Cache key of a body: points, and the planes between which the camera sees.
type BodyKey = (Vec<Vec3>, Vec<DVec4>);

impl Body {
    /// Returns a body that contains what the camera sees of the convex hull of some corners, up to the shadow distance. Lights with
    /// the same receivers share it.
    pub(crate) fn of(
        receivers: &PreparedReceivers<'_>,
        corners: Vec<Vec3>,
        shared: &SharedValues,
    ) -> Arc<(BodyKey, Self)> {
        let mut planes: Vec<DVec4> = receivers.frustum_planes().into_iter().flatten().collect();
        planes.extend(receivers.shadow_end_plane());
        shared.get_or_make((corners, planes), |(corners, planes)| Self::between(corners, planes))
    }

    fn between(points: &[Vec3], seen_between: &[DVec4]) -> Self {
        let size_m = f64::from(Aabb::of(points.iter().copied()).diagonal());
        let mut planes = enclosing_planes(points);
        planes.extend(seen_between);
        let corners = Polytope::new(&planes, size_m).corners().to_vec();
        let touches = |plane: &DVec4| {
            let room = 1e-3 * size_m * plane.truncate().length();
            corners.iter().any(|corner| plane.dot(corner.as_dvec3().extend(1.0)).abs() <= room)
        };
        planes.retain(touches);
        Self { polytope: Polytope::new(&planes, size_m), corners }
    }

    /// Corners, each repeated several times.
    pub(crate) fn corners(&self) -> &[Vec3] {
        &self.corners
    }
}
