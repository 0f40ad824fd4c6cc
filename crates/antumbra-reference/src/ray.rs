//! Single rays: the nearest surface that a ray meets, or whether it meets any.
//!
//! Uses the planes of bundles (`planes.rs`), with the ray itself in place of the light's centre, so that a single segment
//! and the same segment among a thousand agree.

use crate::geometry::{Geometry, Triangle};
use crate::lanes::{Kernel, Lanes};
use crate::planes::{LANES, Planes, RayFrame};
use crate::shaft::Shaft;
use crate::surface::Surface;
use crate::tree::{Child, Node, Target, Tree};
use crate::walk::normalized;

/// Bit mask of the triangles that a ray meets.
#[inline(always)]
pub(crate) fn hits_of<L: Lanes>(planes: &Planes) -> u32 {
    let value = |plane: usize| L::load(&planes.coefficients[plane][0]);
    let outside = value(0).or(value(1)).or(value(2)).signs();
    value(3).signs() & !outside & ((1 << LANES) - 1)
}

/// Whether the surface exists at the intersection: masked surfaces have holes.
#[inline(always)]
fn is_solid(geometry: &Geometry, triangle: &Triangle, planes: &Planes, lane: usize) -> bool {
    let weights = || normalized([0, 1, 2].map(|plane| planes.coefficients[plane][0][lane]));
    match triangle.surface {
        Surface::Opaque => true,
        Surface::Masked(mask) => {
            geometry.surfaces.masked[mask as usize].is_solid_at(&geometry.surfaces.alpha_images, weights())
        }
        Surface::Translucent(i) => {
            geometry.surfaces.translucent[i as usize].is_there_at(&geometry.surfaces.pictures, weights())
        }
    }
}

/// Pushes the children that a ray meets, the nearest on top, because the ray most likely ends there.
#[inline(always)]
fn push_nearest_last(stack: &mut Vec<(f32, Child)>, node: &Node, mut met: u32, near: &[f32; LANES]) {
    let first = stack.len();
    while met != 0 {
        let lane = met.trailing_zeros() as usize;
        met &= met - 1;
        stack.push((near[lane], node.children[lane]));
        // Insertion sort, because a ray usually meets two or three of eight children.
        let mut i = stack.len() - 1;
        while i > first && stack[i - 1].0 < stack[i].0 {
            stack.swap(i - 1, i);
            i -= 1;
        }
    }
}

/// Kernel that tests whether a segment is blocked.
pub(crate) struct AnyHit<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tree: &'a Tree,
    pub(crate) frame: RayFrame,
    pub(crate) shaft: Shaft,
    pub(crate) stack: &'a mut Vec<(f32, Child)>,
}

impl Kernel for AnyHit<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        let Self { geometry, tree, frame, shaft, stack } = self;
        if tree.nodes.is_empty() {
            return false;
        }
        let mut planes = Planes::ZERO;
        let vector = frame.to_center.map(|v| v as f32);
        stack.clear();
        stack.push((0.0, Child::ROOT));
        while let Some((_, child)) = stack.pop() {
            match child.target() {
                Target::Node(index) => {
                    let node = &tree.nodes[index];
                    let (met, near) = shaft.meets::<L>(node);
                    push_nearest_last(stack, node, met, &near);
                }
                Target::Block(index) => {
                    let block = &tree.blocks[index];
                    let candidates = block.may_meet::<L>(&frame.origin, &vector);
                    if candidates == 0 {
                        continue;
                    }
                    planes.set::<L, 0>(block, &frame);
                    let mut hits = hits_of::<L>(&planes) & candidates;
                    while hits != 0 {
                        let lane = hits.trailing_zeros() as usize;
                        hits &= hits - 1;
                        let triangle = block.triangle[lane];
                        if is_solid(geometry, &geometry.blockers[triangle as usize], &planes, lane) {
                            return true;
                        }
                    }
                }
            }
        }
        false
    }
}

/// Kernel that finds the nearest surface along a ray.
pub(crate) struct ClosestHit<'a> {
    pub(crate) geometry: &'a Geometry,
    /// Triangles of `tree`.
    pub(crate) triangles: &'a [Triangle],
    pub(crate) tree: &'a Tree,
    pub(crate) frame: RayFrame,
    pub(crate) shaft: Shaft,
    /// Smallest distance of a hit, in multiples of the ray's vector.
    pub(crate) t_min: f64,
    pub(crate) best: Option<Hit>,
    pub(crate) stack: &'a mut Vec<(f32, Child)>,
}

/// Intersection of a ray and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Distance, in multiples of the ray's vector.
    pub(crate) t: f64,
    /// Index into the list of triangles.
    pub(crate) triangle: u32,
    /// Barycentric weights of the corners.
    pub(crate) weights: [f64; 3],
    /// Whether `triangle` is an index into the list of translucent triangles.
    pub(crate) translucent: bool,
}

impl Kernel for ClosestHit<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<Hit> {
        let Self { geometry, triangles, tree, frame, mut shaft, t_min, mut best, stack } = self;
        if tree.nodes.is_empty() {
            return best;
        }
        let mut planes = Planes::ZERO;
        let vector = frame.to_center.map(|v| v as f32);
        if let Some(hit) = best {
            shaft.shorten(hit.t as f32);
        }
        stack.clear();
        stack.push((0.0, Child::ROOT));
        while let Some((near, child)) = stack.pop() {
            if near > shaft.end() {
                continue;
            }
            match child.target() {
                Target::Node(index) => {
                    let node = &tree.nodes[index];
                    let (met, near) = shaft.meets::<L>(node);
                    push_nearest_last(stack, node, met, &near);
                }
                Target::Block(index) => {
                    let block = &tree.blocks[index];
                    let candidates = block.may_meet::<L>(&frame.origin, &vector);
                    if candidates == 0 {
                        continue;
                    }
                    planes.set::<L, 0>(block, &frame);
                    let mut hits = hits_of::<L>(&planes) & candidates;
                    while hits != 0 {
                        let lane = hits.trailing_zeros() as usize;
                        hits &= hits - 1;
                        let index = block.triangle[lane];
                        let triangle = &triangles[index as usize];
                        let (t, weights) = locate(triangle, &frame);
                        let translucent = matches!(triangle.surface, Surface::Translucent(_));
                        // Of two surfaces at one distance, the first in the scene's order is seen, whatever the tree.
                        let nearer = best
                            .is_none_or(|b| t < b.t || t == b.t && (translucent, index) < (b.translucent, b.triangle));
                        if t >= t_min && nearer && is_solid(geometry, triangle, &planes, lane) {
                            best = Some(Hit { t, triangle: index, weights, translucent });
                            shaft.shorten(t as f32);
                        }
                    }
                }
            }
        }
        best
    }
}

/// Distance of the triangle's plane along the ray, and barycentric weights there, in double precision.
fn locate(triangle: &Triangle, frame: &RayFrame) -> (f64, [f64; 3]) {
    let origin = glam::DVec3::from(frame.origin.map(f64::from));
    let d = glam::DVec3::from(frame.to_center);
    let [a, b, c] = triangle.corners.map(|p| p.as_dvec3() - origin);
    let n = (b - a).cross(c - a);
    let t = a.dot(n) / d.dot(n);
    let weights = [(b - c).cross(b + c).dot(d), (c - a).cross(c + a).dot(d), (a - b).cross(a + b).dot(d)];
    let sum: f64 = weights.iter().sum();
    let weights = if sum == 0.0 { [1.0, 0.0, 0.0] } else { weights.map(|w| (w / sum).clamp(0.0, 1.0)) };
    (t, weights)
}
