//! CPU reference of a mesh's bounding volume hierarchy.

use glam::Vec3;

/// Axis-aligned box; empty if `low` exceeds `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box3 {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Box3 {
    pub(super) const EMPTY: Self = Self { low: Vec3::splat(3.0e38), high: Vec3::splat(-3.0e38) };

    pub(super) fn of(corners: [Vec3; 3]) -> Self {
        if !corners.into_iter().all(Vec3::is_finite) {
            return Self::EMPTY;
        }
        let [a, b, c] = corners;
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    pub(super) fn is_empty(self) -> bool {
        self.low.cmpgt(self.high).any()
    }
}

/// Node, in depth-first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) first: u32,
    pub(super) count: u32,
    /// Index of the node to continue with if the box is missed; `None` for a leaf.
    pub(super) skip: Option<u32>,
    pub(super) bounds: Box3,
}

/// Bounding volume hierarchy, built by recursion.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// Box of all items.
    pub(super) frame: Box3,
    /// Items by their position in the tree.
    pub(super) order: Vec<u32>,
    pub(super) nodes: Vec<Node>,
}

fn spread(value: u32) -> u32 {
    (0..10).map(|bit| (value >> bit & 1) << (3 * bit)).sum()
}

fn code_of(frame: Box3, bounds: Box3) -> u32 {
    if bounds.is_empty() {
        return 0;
    }
    let part = (0.5 * bounds.low + 0.5 * bounds.high - frame.low) / (frame.high - frame.low).max(Vec3::splat(1e-30));
    let cell = (part * 1024.0).clamp(Vec3::ZERO, Vec3::splat(1023.0)).as_uvec3();
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

impl Tree {
    pub(super) fn new(boxes: &[Box3]) -> Self {
        let frame = boxes.iter().fold(Box3::EMPTY, |all, one| all.union(*one));
        let frame = if frame.is_empty() { Box3 { low: Vec3::ZERO, high: Vec3::ZERO } } else { frame };
        let codes: Vec<u32> = boxes.iter().map(|bounds| code_of(frame, *bounds)).collect();
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        order.sort_by_key(|item| codes[*item as usize]);
        let keys: Vec<u64> =
            order.iter().zip(0_u64..).map(|(item, place)| u64::from(codes[*item as usize]) << 32 | place).collect();
        for most in [4, 16, 64] {
            let mut tree = Self { frame, order: order.clone(), nodes: Vec::new() };
            tree.add(boxes, &keys, 0, boxes.len(), most);
            if tree.nodes.len() <= boxes.len() || most == 64 {
                return tree;
            }
        }
        unreachable!("the largest size is always accepted")
    }

    /// Adds the nodes over the positions `first..end`.
    fn add(&mut self, boxes: &[Box3], keys: &[u64], first: usize, end: usize, most: usize) {
        let place = self.nodes.len();
        let bounds = self.bounds_of(boxes, first, end);
        self.nodes.push(Node { first: first as u32, count: (end - first) as u32, skip: None, bounds });
        if end - first <= most {
            return;
        }
        let highest = 1 << (63 - (keys[first] ^ keys[end - 1]).leading_zeros());
        let split = first + keys[first..end].partition_point(|key| key & highest == 0);
        self.add(boxes, keys, first, split, most);
        self.add(boxes, keys, split, end, most);
        self.nodes[place].skip = Some(self.nodes.len() as u32);
    }

    pub(super) fn bounds_of(&self, boxes: &[Box3], first: usize, end: usize) -> Box3 {
        self.order[first..end].iter().fold(Box3::EMPTY, |all, item| all.union(boxes[*item as usize]))
    }
}
