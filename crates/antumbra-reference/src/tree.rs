//! Bounding volume hierarchy: nodes of eight children, leaves of up to eight triangles.
//!
//! obvhs builds a binary tree: PLOC (Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume
//! Hierarchy Construction", TVCG 2018) over boxes of pre-split triangles, then optimised by reinsertion (the same,
//! "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", Eurographics 2018). This module widens it: a node
//! takes the grandchildren of its largest child until it has eight children (Wald, Benthin and Boulos, "Getting Rid of
//! Packets", RT 2008, sec. 3), so that one instruction tests eight boxes.

use std::ops::Range;

use glam::Vec3A;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::{BvhBuildParams, triangle};

use crate::geometry::Triangle;
use crate::planes::{Block, LANES};

/// Inner node: the boxes of up to eight children.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Smallest corners, `[axis][child]`, metres.
    pub(crate) low: [[f32; LANES]; 3],
    /// Largest corners, `[axis][child]`, metres.
    pub(crate) high: [[f32; LANES]; 3],
    /// Children.
    pub(crate) children: [Child; LANES],
    /// Bit k: child k exists.
    pub(crate) present: u32,
}

/// Index of a node or of a block of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    pub(crate) const ROOT: Self = Self(0);

    /// Returns the block if this child is a leaf, else the node.
    #[inline(always)]
    pub(crate) fn target(self) -> Target {
        if self.0 & Self::LEAF != 0 {
            Target::Block((self.0 & !Self::LEAF) as usize)
        } else {
            Target::Node(self.0 as usize)
        }
    }
}

/// Target of a [`Child`].
pub(crate) enum Target {
    /// Index into [`Tree::nodes`].
    Node(usize),
    /// Index into [`Tree::blocks`].
    Block(usize),
}

/// Bounding volume hierarchy.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    /// Nodes, root first; empty if there are no triangles.
    pub(crate) nodes: Vec<Node>,
    /// Leaves.
    pub(crate) blocks: Vec<Block>,
    /// Upper bound of the stack of a depth-first walk, entries.
    pub(crate) stack_size: usize,
}

impl Tree {
    /// Builds the tree of some triangles. With `split`, a large triangle may be in several leaves.
    pub(crate) fn new(triangles: &[Triangle], split: bool) -> Self {
        if triangles.is_empty() {
            return Self::default();
        }
        let corners: Vec<triangle::Triangle> = triangles
            .iter()
            .map(|t| triangle::Triangle {
                v0: Vec3A::from(t.corners[0]),
                v1: Vec3A::from(t.corners[1]),
                v2: Vec3A::from(t.corners[2]),
            })
            .collect();
        let params =
            BvhBuildParams { pre_split: split, max_prims_per_leaf: LANES as u32, ..BvhBuildParams::slow_build() };
        let binary = build_bvh2_from_tris(&corners, params, &mut std::time::Duration::default());
        let mut tree = Self::default();
        Widener { binary: &binary, triangles, tree: &mut tree }.widen();
        tree
    }
}

/// Turns a binary tree into a wide one.
struct Widener<'a> {
    binary: &'a Bvh2,
    triangles: &'a [Triangle],
    tree: &'a mut Tree,
}

impl Widener<'_> {
    fn widen(mut self) {
        // A single leaf has no inner node: it gets a root with one child.
        let mut depth = 1;
        let children = if self.is_leaf(0) { vec![0] } else { self.open(0) };
        self.tree.nodes.push(self.node_of(&children));
        // Depth first, so that a subtree is contiguous. An entry has the wide node and its children in the binary tree.
        let mut waiting = vec![(0usize, children, 1usize)];
        while let Some((node, children, level)) = waiting.pop() {
            depth = depth.max(level);
            for (lane, &child) in children.iter().enumerate() {
                let target = if self.is_leaf(child) {
                    Child::LEAF | self.push_block(child)
                } else {
                    let grandchildren = self.open(child);
                    self.tree.nodes.push(self.node_of(&grandchildren));
                    let index = self.tree.nodes.len() - 1;
                    waiting.push((index, grandchildren, level + 1));
                    index as u32
                };
                self.tree.nodes[node].children[lane] = Child(target);
            }
        }
        // Each level leaves at most seven siblings waiting.
        self.tree.stack_size = depth * (LANES - 1) + 2;
    }

    fn is_leaf(&self, binary: usize) -> bool {
        self.binary.nodes[binary].prim_count > 0
    }

    /// Binary nodes that become the children of a wide one.
    fn open(&self, binary: usize) -> Vec<usize> {
        let pair = |i: usize| {
            let first = self.binary.nodes[i].first_index as usize;
            [first, first + 1]
        };
        let mut children = pair(binary).to_vec();
        while children.len() < LANES {
            let area = |i: usize| self.binary.nodes[i].aabb.half_area();
            let largest = (0..children.len())
                .filter(|k| !self.is_leaf(children[*k]))
                .max_by(|j, k| area(children[*j]).total_cmp(&area(children[*k])));
            let Some(largest) = largest else { break };
            let [first, second] = pair(children[largest]);
            children[largest] = first;
            children.push(second);
        }
        children
    }

    fn node_of(&self, children: &[usize]) -> Node {
        let mut node = Node {
            low: [[0.0; LANES]; 3],
            high: [[0.0; LANES]; 3],
            children: [Child::ROOT; LANES],
            present: (1 << children.len()) - 1,
        };
        for (lane, &child) in children.iter().enumerate() {
            let aabb = self.binary.nodes[child].aabb;
            for axis in 0..3 {
                // Splitting rounds the boxes of triangles: a few units in the last place cover that.
                let slack = 4.0 * f32::EPSILON * aabb.min[axis].abs().max(aabb.max[axis].abs());
                node.low[axis][lane] = aabb.min[axis] - slack;
                node.high[axis][lane] = aabb.max[axis] + slack;
            }
        }
        node
    }

    fn triangles_of(&self, leaf: usize) -> impl Iterator<Item = u32> + '_ {
        let node = &self.binary.nodes[leaf];
        let range: Range<usize> = node.first_index as usize..(node.first_index + node.prim_count) as usize;
        self.binary.primitive_indices[range].iter().copied()
    }

    fn push_block(&mut self, leaf: usize) -> u32 {
        let members: Vec<u32> = self.triangles_of(leaf).collect();
        self.tree.blocks.push(Block::new(self.triangles, &members));
        self.tree.blocks.len() as u32 - 1
    }
}

impl Block {
    /// Creates a block of one to eight triangles, given by index.
    pub(crate) fn new(triangles: &[Triangle], members: &[u32]) -> Self {
        let mut block = Self {
            corners: [[[0.0; LANES]; 3]; 3],
            triangle: [members[0]; LANES],
            extent: [0.0; LANES],
            count: members.len() as u32,
        };
        for lane in 0..LANES {
            let index = members.get(lane).copied().unwrap_or(members[0]);
            let corners = triangles[index as usize].corners;
            let [a, b, c] = corners;
            block.triangle[lane] = index;
            block.extent[lane] = (b - a).abs().max((c - a).abs()).max((c - b).abs()).max_element();
            for (corner, position) in corners.into_iter().enumerate() {
                for axis in 0..3 {
                    block.corners[corner][axis][lane] = position[axis];
                }
            }
        }
        block
    }

    /// Indices of its triangles.
    pub(crate) fn triangles(&self) -> &[u32] {
        &self.triangle[..self.count as usize]
    }
}
