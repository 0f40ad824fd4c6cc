//! Instances of a caster: matrices known on the CPU, or a buffer of the host.

use antumbra_light::Aabb;
use glam::{Mat4, Vec3};

use super::pack::InstanceSource;
use super::{Instances, bad, check_box};
use crate::contract::Error;

/// Validated instances.
pub(super) struct PlacedInstances<'a> {
    pub(super) count: u32,
    pub(super) matrices: Option<&'a [Mat4]>,
    pub(super) source: Option<InstanceSource>,
    pub(super) bounds: Aabb,
    pub(super) is_mirrored: bool,
}

impl<'a> PlacedInstances<'a> {
    /// Validates instances of a mesh with an object-space box.
    ///
    /// # Errors
    /// If matrices are not finite, or a buffer is not readable.
    pub(super) fn new(instances: &Instances<'a>, mesh: Aabb) -> Result<Self, Error> {
        match instances {
            Instances::Matrices(matrices) => {
                if let Some(i) = matrices.iter().position(|matrix| !matrix.is_finite()) {
                    return Err(bad("the caster's matrix", format!("not finite (instance {i})"), "finite".into()));
                }
                Ok(Self {
                    count: matrices.len() as u32,
                    matrices: Some(matrices),
                    source: None,
                    bounds: world_bounds(mesh, matrices),
                    is_mirrored: matrices.iter().any(|matrix| matrix.determinant() < 0.0),
                })
            }
            Instances::Buffer(buffer) => {
                check_box("the instances' bounding box", buffer.bounds.unwrap_or(Aabb::EVERYTHING), buffer.count > 0)?;
                Ok(Self {
                    count: buffer.count,
                    matrices: None,
                    source: Some(InstanceSource::new(buffer)?),
                    bounds: buffer.bounds.unwrap_or(Aabb::EVERYTHING),
                    // Unknown. Assuming a mirrored instance makes the mesh count as open, which is always correct.
                    is_mirrored: true,
                })
            }
        }
    }
}

/// World-space box of an object-space box under each matrix. It bounds the transformed box, so it may be larger than the
/// box of the transformed content.
pub(super) fn world_bounds(mesh: Aabb, matrices: &[Mat4]) -> Aabb {
    if mesh.is_empty() {
        return Aabb::EMPTY;
    }
    if !(mesh.min.is_finite() && mesh.max.is_finite()) {
        return Aabb::EVERYTHING;
    }
    let (middle, half) = (mesh.center(), 0.5 * (mesh.max - mesh.min));
    matrices.iter().fold(Aabb::EMPTY, |all, matrix| {
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().abs());
        let (middle, half): (Vec3, Vec3) = (matrix.transform_point3(middle), x * half.x + y * half.y + z * half.z);
        all.union(Aabb { min: middle - half, max: middle + half })
    })
}
