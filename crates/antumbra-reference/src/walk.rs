//! All the segments from one receiver to one bundle of light points, in one walk through the tree.
//!
//! 1024 segments leave one point and end on one small light, so they meet nearly the same nodes. The walk follows
//! their common shaft (`shaft.rs`). Each triangle met is turned into planes once (`planes.rs`); these settle whole
//! tiles of 64 light points where they can, as a hierarchical rasteriser does (Greene, "Hierarchical Polygon Tiling
//! with Coverage Masks", SIGGRAPH 1996), and test point by point only the tiles that a silhouette crosses. A bit per
//! light point remembers what is blocked; when all are, the walk ends.
//!
//! The answer does not depend on the order of the walk, nor on which triangles are skipped as certain misses: it is
//! bit for bit what testing every triangle against every light point gives, which the tests do.

use crate::geometry::Geometry;
use crate::lanes::{Kernel, Lanes};
use crate::planes::{Block, LANES, Planes, RayFrame};
use crate::sampled_light::{BUNDLE, Bundle, TILE, Tile, eight};
use crate::surface::Surface;
use crate::tree::{Child, Target, Tree};

/// One bit per light point of a bundle, 64 to a tile.
pub(crate) type Bits = [u64; BUNDLE];

/// 2⁻²⁰ of a plane's largest terms: the middle of a tile and each of its points are evaluated with three roundings of
/// 2⁻²⁴ each; this is more than twice their sum.
const PLANE_SLACK: f32 = 1.0 / (1 << 20) as f32;

/// What a worker keeps between receivers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    stack: Vec<Child>,
    /// Blocks that lately blocked something: likely to do so for the next receiver too. Most recent first.
    recent: [Option<u32>; RECENT],
    /// Translucent triangles met, with the light points whose segments they cross.
    crossings: Vec<Crossing>,
}

/// A translucent triangle in the way of some segments.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    triangle: u32,
    block: u32,
    lane: u8,
    bits: Bits,
}

/// Recent blocks remembered: a big occluder is a block or two, so a few suffice.
const RECENT: usize = 4;

/// Which segments of a bundle are blocked.
pub(crate) struct BlockedWalk<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tree: &'a Tree,
    pub(crate) frame: RayFrame,
    pub(crate) bundle: &'a Bundle,
    /// Axes along which the light extends.
    pub(crate) axes: usize,
    /// A block to try before all others.
    pub(crate) first: Option<u32>,
    pub(crate) scratch: &'a mut Scratch,
}

/// What a walk found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocked {
    /// Set where the segment is blocked.
    pub(crate) bits: Bits,
    /// The blocks of the receiver before settled everything: no node was visited.
    pub(crate) without_walk: bool,
}

impl Kernel for BlockedWalk<'_> {
    type Output = Blocked;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Blocked {
        if self.axes == 2 { self.walk::<L, 2>() } else { self.walk::<L, 3>() }
    }
}

impl BlockedWalk<'_> {
    #[inline(always)]
    fn walk<L: Lanes, const AXES: usize>(self) -> Blocked {
        let Self { geometry, tree, frame, bundle, first, scratch, .. } = self;
        let mut open = bundle.valid;
        let mut planes = Planes::ZERO;
        let result = |open: &Bits, without_walk| Blocked {
            bits: std::array::from_fn(|i| bundle.valid[i] & !open[i]),
            without_walk,
        };
        if tree.nodes.is_empty() {
            return result(&open, true);
        }
        for block in first.into_iter().chain(scratch.recent.into_iter().flatten()) {
            test_block::<L, AXES>(geometry, &tree.blocks[block as usize], &frame, bundle, &mut planes, &mut open);
        }
        if all_closed(&open) {
            return result(&open, true);
        }
        let shaft = bundle.shaft(&frame);
        let stack = &mut scratch.stack;
        stack.clear();
        stack.reserve(tree.stack_size);
        stack.push(Child::ROOT);
        while let Some(child) = stack.pop() {
            match child.target() {
                Target::Node(index) => {
                    let node = &tree.nodes[index];
                    let (mut met, _) = shaft.meets::<L>(node);
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize;
                        met &= met - 1;
                        stack.push(node.children[lane]);
                    }
                }
                Target::Block(index) => {
                    let blocked =
                        test_block::<L, AXES>(geometry, &tree.blocks[index], &frame, bundle, &mut planes, &mut open);
                    if blocked {
                        remember(&mut scratch.recent, index as u32);
                        if all_closed(&open) {
                            break;
                        }
                    }
                }
            }
        }
        result(&open, false)
    }
}

/// Whether no bit is left. (Comparing arrays would call `bcmp`.)
#[inline(always)]
fn all_closed(open: &Bits) -> bool {
    let mut any = 0;
    for bits in open {
        any |= bits;
    }
    any == 0
}

/// Moves a block to the front of the recent ones.
#[inline(always)]
fn remember(recent: &mut [Option<u32>; RECENT], block: u32) {
    let last = recent.iter().position(|r| *r == Some(block)).unwrap_or(RECENT - 1);
    recent[..=last].rotate_right(1);
    recent[0] = Some(block);
}

/// Closes the open segments that a block's triangles are in the way of; returns whether there were any.
#[inline(always)]
fn test_block<L: Lanes, const AXES: usize>(
    geometry: &Geometry,
    block: &Block,
    frame: &RayFrame,
    bundle: &Bundle,
    planes: &mut Planes,
    open: &mut Bits,
) -> bool {
    planes.set::<L, AXES>(block, frame);
    let mut candidates = may_hit::<L, AXES>(planes, bundle) & block.present();
    let mut blocked = false;
    while candidates != 0 {
        let lane = candidates.trailing_zeros() as usize;
        candidates &= candidates - 1;
        let triangle = block.triangle[lane];
        let surface = geometry.blockers[triangle as usize].surface;
        for_each_hit::<L, AXES>(planes, lane, bundle, open, |tile_index, hits, open| {
            let hits = match surface {
                Surface::Masked(mask) => {
                    let mask = &geometry.surfaces.masked[mask as usize];
                    let tile = &bundle.tiles[tile_index];
                    retain(hits, |k| {
                        mask.is_solid_at(&geometry.surfaces.alpha_images, weights_at::<AXES>(planes, lane, tile, k))
                    })
                }
                _ => hits,
            };
            blocked |= hits != 0;
            open[tile_index] &= !hits;
        });
    }
    blocked
}

/// The bits for which `keep` says so.
#[inline(always)]
fn retain(mut bits: u64, mut keep: impl FnMut(usize) -> bool) -> u64 {
    let mut kept = 0;
    while bits != 0 {
        let k = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        kept |= u64::from(keep(k)) << k;
    }
    kept
}

/// The triangles of a block that any point of the bundle's box may be hidden by, as bits.
#[inline(always)]
fn may_hit<L: Lanes, const AXES: usize>(planes: &Planes, bundle: &Bundle) -> u32 {
    let mut missed = 0;
    for (plane, terms) in planes.coefficients.iter().enumerate() {
        let mut middle = L::load(&terms[0]);
        let mut slack = middle.abs();
        let mut reach = L::splat(0.0);
        for axis in 0..AXES {
            let slope = L::load(&terms[1 + axis]);
            middle = slope.mul_add(L::splat(bundle.all_middle[axis]), middle);
            reach = slope.abs().mul_add(L::splat(bundle.all_half[axis]), reach);
            slack = slope.abs().mul_add(L::splat(bundle.largest[axis]), slack);
        }
        let reach = slack.mul_add(L::splat(PLANE_SLACK), reach);
        missed |= if plane < 3 {
            // Negative all over: outside this edge.
            middle.add(reach).signs()
        } else {
            // Not negative anywhere: the plane is never within a segment.
            !middle.sub(reach).signs()
        };
    }
    !missed & ((1 << LANES) - 1)
}

/// Calls `found` with each tile and those of its open segments that meet a triangle.
#[inline(always)]
fn for_each_hit<L: Lanes, const AXES: usize>(
    planes: &Planes,
    lane: usize,
    bundle: &Bundle,
    open: &mut Bits,
    mut found: impl FnMut(usize, u64, &mut Bits),
) {
    // Bits of tiles: somewhere possibly hit; everywhere certainly hit.
    let (mut some, mut all) = (u32::MAX, u32::MAX);
    for plane in 0..4 {
        let terms = &planes.coefficients[plane];
        let mut slack = terms[0][lane].abs();
        for axis in 0..AXES {
            slack += terms[1 + axis][lane].abs() * bundle.largest[axis];
        }
        let slack = slack * PLANE_SLACK;
        let (mut above, mut below) = (0, 0);
        for chunk in 0..BUNDLE / LANES {
            let mut middle = L::splat(terms[0][lane]);
            let mut reach = L::splat(slack);
            for axis in 0..AXES {
                let slope = L::splat(terms[1 + axis][lane]);
                middle = slope.mul_add(eight::<L>(&bundle.middle[axis], chunk), middle);
                reach = slope.abs().mul_add(eight::<L>(&bundle.half[axis], chunk), reach);
            }
            // Not negative anywhere; negative everywhere.
            above |= (!middle.sub(reach).signs() & 0xff) << (LANES * chunk);
            below |= middle.add(reach).signs() << (LANES * chunk);
        }
        if plane < 3 {
            some &= !below;
            all &= above;
        } else {
            some &= !above;
            all &= below;
        }
    }
    let mut tiles = some & ((1 << bundle.tiles.len()) - 1);
    while tiles != 0 {
        let i = tiles.trailing_zeros() as usize;
        tiles &= tiles - 1;
        if open[i] == 0 {
            continue;
        }
        let hits = if all >> i & 1 == 1 { u64::MAX } else { tile_hits::<L, AXES>(planes, lane, &bundle.tiles[i]) };
        let hits = hits & open[i];
        if hits != 0 {
            found(i, hits, open);
        }
    }
}

/// The points of a tile whose segments meet a triangle.
#[inline(always)]
fn tile_hits<L: Lanes, const AXES: usize>(planes: &Planes, lane: usize, tile: &Tile) -> u64 {
    // Plain loops and no closures: what is not inlined here does not see the instruction set.
    let mut terms = [[L::splat(0.0); 4]; 4];
    for (terms, coefficients) in terms.iter_mut().zip(&planes.coefficients) {
        for (term, coefficient) in terms.iter_mut().zip(coefficients).take(1 + AXES) {
            *term = L::splat(coefficient[lane]);
        }
    }
    let mut hits = 0;
    for chunk in 0..TILE / LANES {
        let mut values = [terms[0][0], terms[1][0], terms[2][0], terms[3][0]];
        for axis in 0..AXES {
            let at = eight::<L>(&tile.at[axis], chunk);
            for (value, terms) in values.iter_mut().zip(&terms) {
                *value = terms[1 + axis].mul_add(at, *value);
            }
        }
        let outside = values[0].or(values[1]).or(values[2]).signs();
        let within = values[3].signs();
        hits |= u64::from(within & !outside) << (LANES * chunk);
    }
    hits
}

/// The barycentric weights of the point where a triangle is met on the way to point `k` of a tile.
#[inline(always)]
fn weights_at<const AXES: usize>(planes: &Planes, lane: usize, tile: &Tile, k: usize) -> [f32; 3] {
    let values = [0, 1, 2].map(|plane| {
        (0..AXES).fold(planes.coefficients[plane][0][lane], |sum, axis| {
            planes.coefficients[plane][1 + axis][lane].mul_add(tile.at[axis][k], sum)
        })
    });
    normalized(values)
}

/// Non-negative numbers scaled to sum to one.
#[inline(always)]
pub(crate) fn normalized(values: [f32; 3]) -> [f32; 3] {
    let sum = values[0] + values[1] + values[2];
    // All three are zero only where a triangle is seen edge-on, which the plane's own test has excluded but for
    // underflow; any point of it will do.
    if sum > 0.0 { values.map(|v| v / sum) } else { [1.0, 0.0, 0.0] }
}

/// What passes the translucent triangles on the way to each open light point of a bundle.
pub(crate) struct TranslucentWalk<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tree: &'a Tree,
    pub(crate) frame: RayFrame,
    pub(crate) bundle: &'a Bundle,
    pub(crate) axes: usize,
    pub(crate) scratch: &'a mut Scratch,
    /// Segments that nothing blocks.
    pub(crate) open: Bits,
    /// Multiplied by the transmittance of each translucent triangle, per slot of the bundle.
    pub(crate) transmittance: &'a mut [glam::Vec3],
}

impl Kernel for TranslucentWalk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        if self.axes == 2 { self.walk::<L, 2>() } else { self.walk::<L, 3>() }
    }
}

impl TranslucentWalk<'_> {
    #[inline(always)]
    fn walk<L: Lanes, const AXES: usize>(self) {
        let Self { geometry, tree, frame, bundle, scratch, mut open, transmittance, .. } = self;
        if tree.nodes.is_empty() || all_closed(&open) {
            return;
        }
        let mut planes = Planes::ZERO;
        let shaft = bundle.shaft(&frame);
        let Scratch { stack, crossings, .. } = scratch;
        crossings.clear();
        stack.clear();
        stack.push(Child::ROOT);
        while let Some(child) = stack.pop() {
            match child.target() {
                Target::Node(index) => {
                    let node = &tree.nodes[index];
                    let (mut met, _) = shaft.meets::<L>(node);
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize;
                        met &= met - 1;
                        stack.push(node.children[lane]);
                    }
                }
                Target::Block(index) => {
                    let block = &tree.blocks[index];
                    planes.set::<L, AXES>(block, &frame);
                    let mut candidates = may_hit::<L, AXES>(&planes, bundle) & block.present();
                    while candidates != 0 {
                        let lane = candidates.trailing_zeros() as usize;
                        candidates &= candidates - 1;
                        let triangle = block.triangle[lane];
                        let mut bits = [0; BUNDLE];
                        for_each_hit::<L, AXES>(&planes, lane, bundle, &mut open, |tile, hits, _| bits[tile] = hits);
                        if !all_closed(&bits) {
                            crossings.push(Crossing { triangle, block: index as u32, lane: lane as u8, bits });
                        }
                    }
                }
            }
        }
        // Products are rounded, so their order is part of the answer: the scene's, whatever the tree.
        crossings.sort_unstable_by_key(|c| c.triangle);
        for crossing in crossings.iter() {
            let Surface::Translucent(i) = geometry.translucents[crossing.triangle as usize].surface else { continue };
            let triangle = &geometry.surfaces.translucent[i as usize];
            planes.set::<L, AXES>(&tree.blocks[crossing.block as usize], &frame);
            for (i, bits) in crossing.bits.iter().enumerate() {
                retain(*bits, |k| {
                    let weights = weights_at::<AXES>(&planes, crossing.lane as usize, &bundle.tiles[i], k);
                    transmittance[TILE * i + k] *= triangle.passes_at(&geometry.surfaces.pictures, weights);
                    true
                });
            }
        }
    }
}
