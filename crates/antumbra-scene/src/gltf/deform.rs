//! Morph targets and skins, applied once on the CPU for the scene's time.
//!
//! Source: glTF 2.0, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).

use glam::{Mat3, Mat4};

use super::accessors::Allowed;
use super::fault::{Fault, Result};
use super::geometry::{Geometry, cofactor};
use super::nodes::Graph;
use super::source::Source;

/// Displaces the vertices by the weighted sum of the targets. Missing weights are 0, surplus ones are ignored.
pub(super) fn morph(geometry: &mut Geometry, weights: &[f32]) {
    for (target, &weight) in geometry.targets.iter().zip(weights) {
        if weight == 0.0 || !weight.is_finite() {
            continue;
        }
        geometry.positions.iter_mut().zip(&target.positions).for_each(|(p, d)| *p += *d * weight);
        geometry.normals.iter_mut().zip(&target.normals).for_each(|(n, d)| *n += *d * weight);
    }
}

/// Skeleton at one time: `world_from_bind` of each joint.
pub(super) struct Skeleton {
    joints: Vec<Mat4>,
}

impl Skeleton {
    pub(super) fn new(source: &Source, skin: usize, graph: &Graph) -> Result<Self> {
        let skins = &source.root.skins;
        let Some(json) = skins.get(skin) else {
            return Err(Fault::unresolved("skin", "skins", skin, skins.len()));
        };
        let place = format!("skins[{skin}]");
        let inverse_binds: Vec<[f32; 16]> = match json.inverse_bind_matrices {
            Some(accessor) => {
                source.read_floats::<16>(accessor.value(), Allowed::Floats, &format!("{place}.inverseBindMatrices"))?
            }
            None => vec![Mat4::IDENTITY.to_cols_array(); json.joints.len()],
        };
        if inverse_binds.len() < json.joints.len() {
            return Err(Fault::new(
                format!("{place}.inverseBindMatrices"),
                format!("{} matrices for {} joints", inverse_binds.len(), json.joints.len()),
                "expected one matrix per joint",
            ));
        }
        let mut joints = Vec::with_capacity(json.joints.len());
        for (joint, inverse_bind) in json.joints.iter().zip(inverse_binds) {
            let Some(world_from_joint) = graph.world_from_node.get(joint.value()) else {
                let place = format!("{place}.joints");
                return Err(Fault::unresolved(place, "nodes", joint.value(), graph.world_from_node.len()));
            };
            let joint_from_bind = Mat4::from_cols_array(&inverse_bind);
            if !joint_from_bind.is_finite() {
                source.warn(format!("{place}: an inverse bind matrix is not finite; the identity is used"));
            }
            let joint_from_bind = if joint_from_bind.is_finite() { joint_from_bind } else { Mat4::IDENTITY };
            joints.push(world_from_joint.unwrap_or(Mat4::IDENTITY) * joint_from_bind);
        }
        Ok(Self { joints })
    }

    /// Moves a geometry into world space; the transform of the node that carries it has no effect (section 3.7.3.3).
    pub(super) fn skin(&self, source: &Source, geometry: &mut Geometry, place: &str) {
        let mut stray = 0usize;
        let mut mirrored = 0usize;
        for v in 0..geometry.positions.len() {
            let mut sum = Mat4::ZERO;
            let mut total = 0.0;
            for set in &geometry.influences {
                for (joint, weight) in set.joints[v].into_iter().zip(set.weights[v]) {
                    // Weights should sum to 1 and joints exist. Invalid influences are left out and the others rescaled.
                    if weight.is_finite() && weight > 0.0 {
                        match self.joints.get(joint as usize) {
                            Some(world_from_bind) => {
                                sum += *world_from_bind * weight;
                                total += weight;
                            }
                            None => stray += 1,
                        }
                    }
                }
            }
            let world_from_bind = if total > 0.0 {
                sum * (1.0 / total)
            } else {
                // A vertex without influences follows the first joint that it names, or the skeleton's first.
                let named = geometry.influences.first().and_then(|set| self.joints.get(set.joints[v][0] as usize));
                named.or(self.joints.first()).copied().unwrap_or(Mat4::IDENTITY)
            };
            let linear = Mat3::from_mat4(world_from_bind);
            mirrored += usize::from(linear.determinant() < 0.0);
            geometry.positions[v] = world_from_bind.transform_point3(geometry.positions[v]);
            if let Some(normal) = geometry.normals.get_mut(v) {
                *normal = cofactor(linear) * *normal;
            }
        }
        if stray > 0 {
            source.warn(format!("{place}: {stray} weights belong to joints that do not exist; they are ignored"));
        }
        // A skeleton that mirrors reverses the winding of the whole mesh.
        if 2 * mirrored > geometry.positions.len() {
            geometry.flip();
        }
    }
}

/// Morph weights of a node, by precedence: animated, the node's own, the mesh's (section 3.7.4).
pub(super) fn morph_weights<'w>(
    driven: Option<&'w [f32]>,
    node: Option<&'w [f32]>,
    mesh: Option<&'w [f32]>,
) -> &'w [f32] {
    driven.or(node).or(mesh).unwrap_or_default()
}
