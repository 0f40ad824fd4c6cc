//! Node graph: the nodes that the scene shows, and their transforms.
//!
//! Source: glTF 2.0, section 3.5; KHR_node_visibility. The graph is walked with lists rather than by recursion, because the file
//! determines the depth but the stack is limited.

use glam::{Mat4, Quat, Vec3, Vec4};
use gltf::json::scene::Node;

use super::animation::Driven;
use super::fault::{Fault, Result};
use super::numbers::{LARGEST_COORDINATE_M, unit_quaternion};
use super::source::Source;

/// Nodes of a document at one time.
pub(super) struct Graph {
    /// World transform of each node; `None` if it is not finite.
    pub world_from_node: Vec<Option<Mat4>>,
    /// Nodes of the scene, parents before children.
    pub reached: Vec<usize>,
    /// Whether the contents of each node are visible: neither it nor an ancestor is hidden. Cameras ignore this.
    pub is_visible: Vec<bool>,
}

impl Graph {
    /// Walks the default scene; without one, the first scene; without any scene, all roots.
    pub(super) fn new(source: &Source, driven: &[Driven]) -> Result<Self> {
        let nodes = &source.root.nodes;
        let order = topological_order(nodes)?;

        let mut world_from_node = vec![None; nodes.len()];
        let mut is_visible = vec![false; nodes.len()];
        for &(index, parent) in &order {
            is_visible[index] = parent.is_none_or(|parent| is_visible[parent]) && !is_hidden(source, index);
            let world_from_parent = match parent {
                Some(parent) => world_from_node[parent],
                None => Some(Mat4::IDENTITY),
            };
            let Some(world_from_parent) = world_from_parent else { continue };
            let world = world_from_parent * local_transform(source, &nodes[index], index, &driven[index]);
            if world.to_cols_array().iter().all(|v| v.abs() <= LARGEST_COORDINATE_M) {
                world_from_node[index] = Some(world);
            } else {
                let label = Source::label(nodes[index].name.as_ref(), "nodes", index);
                source.warn(format!("{label}: its transform is not finite; it and its children are ignored"));
            }
        }

        let mut reached = vec![false; nodes.len()];
        let mut stack = scene_roots(source, &order)?;
        while let Some(index) = stack.pop() {
            if !std::mem::replace(&mut reached[index], true) {
                stack.extend(children(&nodes[index]));
            }
        }
        let reached = order.into_iter().map(|(index, _)| index).filter(|&i| reached[i]).collect();
        Ok(Self { world_from_node, reached, is_visible })
    }
}

/// Whether KHR_node_visibility hides the node itself.
fn is_hidden(source: &Source, index: usize) -> bool {
    let node = &source.root.nodes[index];
    let extension = node.extensions.as_ref().and_then(|e| e.others.get("KHR_node_visibility"));
    let Some(visible) = extension.and_then(|e| e.get("visible")) else { return false };
    visible.as_bool().map_or_else(
        || {
            let label = Source::label(node.name.as_ref(), "nodes", index);
            source.warn(format!("{label}: its `visible` is neither true nor false; true is used"));
            false
        },
        |visible| !visible,
    )
}

fn children(node: &Node) -> impl Iterator<Item = usize> + '_ {
    node.children.iter().flatten().map(|child| child.value())
}

/// Every node with its parent, parents first.
fn topological_order(nodes: &[Node]) -> Result<Vec<(usize, Option<usize>)>> {
    let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in children(node) {
            let place = format!("nodes[{index}].children");
            let Some(parent) = parents.get_mut(child) else {
                return Err(Fault::unresolved(place, "nodes", child, nodes.len()));
            };
            if let Some(other) = parent.replace(index) {
                return Err(Fault::new(
                    place,
                    format!("nodes[{child}] is already a child of nodes[{other}]"),
                    "a node must have at most one parent, and occur once among its children",
                ));
            }
        }
    }
    let mut order: Vec<(usize, Option<usize>)> =
        (0..nodes.len()).filter(|&i| parents[i].is_none()).map(|i| (i, None)).collect();
    let mut next = 0;
    while let Some(&(index, _)) = order.get(next) {
        order.extend(children(&nodes[index]).map(|child| (child, Some(index))));
        next += 1;
    }
    if order.len() < nodes.len() {
        let mut ordered = vec![false; nodes.len()];
        order.iter().for_each(|&(i, _)| ordered[i] = true);
        let stuck = ordered.iter().position(|done| !done).unwrap_or_default();
        return Err(Fault::new(
            format!("nodes[{stuck}]"),
            "is its own ancestor, or a descendant of a node that is",
            "nodes must form trees: break the loop in `children`",
        ));
    }
    Ok(order)
}

fn scene_roots(source: &Source, order: &[(usize, Option<usize>)]) -> Result<Vec<usize>> {
    let root = &source.root;
    let scene = match root.scene {
        Some(scene) => {
            let index = scene.value();
            Some(root.scenes.get(index).ok_or_else(|| Fault::unresolved("scene", "scenes", index, root.scenes.len()))?)
        }
        None => root.scenes.first(),
    };
    let Some(scene) = scene else {
        return Ok(order.iter().filter(|(_, parent)| parent.is_none()).map(|&(i, _)| i).collect());
    };
    scene
        .nodes
        .iter()
        .map(|node| match node.value() {
            index if index < root.nodes.len() => Ok(index),
            index => Err(Fault::unresolved("scenes.nodes", "nodes", index, root.nodes.len())),
        })
        .collect()
}

fn local_transform(source: &Source, node: &Node, index: usize, driven: &Driven) -> Mat4 {
    let matrix = node.matrix.map(|m| Mat4::from_cols_array(&m));
    if let Some(matrix) = matrix
        && !driven.moves()
    {
        return Mat4::from_cols(
            affine_column(matrix.x_axis, 0.0),
            affine_column(matrix.y_axis, 0.0),
            affine_column(matrix.z_axis, 0.0),
            affine_column(matrix.w_axis, 1.0),
        );
    }
    // A node with a matrix must not be animated. If one is, its matrix gives the resting values.
    let (scale, rotation, translation) = match matrix {
        Some(matrix) => matrix.to_scale_rotation_translation(),
        None => (
            node.scale.map_or(Vec3::ONE, Vec3::from_array),
            node.rotation.map_or(Quat::IDENTITY, |q| Quat::from_array(q.0)),
            node.translation.map_or(Vec3::ZERO, Vec3::from_array),
        ),
    };
    let rotation = unit_quaternion(driven.rotation.unwrap_or(rotation)).unwrap_or_else(|| {
        let label = Source::label(node.name.as_ref(), "nodes", index);
        source.warn(format!("{label}: its rotation is a quaternion of zero length; no rotation is used"));
        Quat::IDENTITY
    });
    Mat4::from_scale_rotation_translation(
        driven.scale.unwrap_or(scale),
        rotation,
        driven.translation.unwrap_or(translation),
    )
}

/// Node matrices are affine; a last row other than 0 0 0 1 has no meaning (section 3.5.2).
fn affine_column(column: Vec4, w: f32) -> Vec4 {
    column.truncate().extend(w)
}
