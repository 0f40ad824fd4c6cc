//! Walk through the tree for all segments from one receiver to one bundle of light points.
//!
//! 1024 segments leave one point and end on one small light, so they meet nearly the same nodes. The walk follows their
//! common shaft (`shaft.rs`). Each triangle met is turned into planes once (`planes.rs`). The planes decide whole tiles of
//! 64 light points if possible, as a hierarchical rasteriser does (Greene, "Hierarchical Polygon Tiling with Coverage
//! Masks", SIGGRAPH 1996); only tiles that a silhouette crosses are tested point by point. A bit per light point records
//! what is blocked; when all are, the walk ends.
//!
//! The result depends neither on the order of the walk nor on the triangles that are skipped as certain misses: it is
//! bit for bit that of testing every triangle against every light point, as the tests do.

use crate::geometry::Geometry;
use crate::lanes::{Kernel, Lanes};
use crate::planes::{Block, LANES, Planes, RayFrame};
use crate::sampled_light::{BUNDLE, Bundle, TILE, Tile, eight};
use crate::surface::Surface;
use crate::tree::{Child, Target, Tree};

/// One bit per light point of a bundle, 64 per tile.
pub(crate) type Bits = [u64; BUNDLE];

/// Relative slack of a plane's largest terms, 2⁻²⁰: more than twice the three roundings of 2⁻²⁴ each with which the centre
/// of a tile and each of its points are evaluated.
const PLANE_SLACK: f32 = 1.0 / (1 << 20) as f32;

/// State that a worker keeps between receivers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    stack: Vec<Child>,
    /// Blocks that recently blocked something, most recent first: they are likely to block the next receiver too.
    recent: [Option<u32>; RECENT],
    /// Translucent triangles met, with the light points of the segments that cross them.
    crossings: Vec<Crossing>,
}

/// Translucent triangle that some segments cross.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    triangle: u32,
    block: u32,
    lane: u8,
    bits: Bits,
}

/// Number of recent blocks: a large occluder is a block or two, so a few suffice.
const RECENT: usize = 4;

/// Kernel that finds the blocked segments of a bundle.
pub(crate) struct BlockedWalk<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tree: &'a Tree,
    pub(crate) frame: RayFrame,
    pub(crate) bundle: &'a Bundle,
    /// Number of axes along which the light extends.
    pub(crate) axes: usize,
    /// Block that is tested first.
    pub(crate) first: Option<u32>,
    pub(crate) scratch: &'a mut Scratch,
}

/// Result of a walk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocked {
    /// Bits of the blocked segments.
    pub(crate) bits: Bits,
    /// Whether `first` and the recent blocks decided everything, and no node was visited.
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

/// Whether no bit is set. (Comparing arrays would call `bcmp`.)
#[inline(always)]
fn all_closed(open: &Bits) -> bool {
    let mut any = 0;
    for bits in open {
        any |= bits;
    }
    any == 0
}

/// Moves a block to the front of the recent blocks.
#[inline(always)]
fn remember(recent: &mut [Option<u32>; RECENT], block: u32) {
    let last = recent.iter().position(|r| *r == Some(block)).unwrap_or(RECENT - 1);
    recent[..=last].rotate_right(1);
    recent[0] = Some(block);
}

/// Closes the open segments that a block's triangles block; returns whether there were any.
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

/// Bits for which `keep` returns true.
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

/// Bit mask of the triangles of a block that may hide a point of the bundle's box.
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
            // Negative everywhere: outside this edge.
            middle.add(reach).signs()
        } else {
            // Negative nowhere: the plane is never within a segment.
            !middle.sub(reach).signs()
        };
    }
    !missed & ((1 << LANES) - 1)
}

/// Calls `found` with each tile and those of its open segments that a triangle meets.
#[inline(always)]
fn for_each_hit<L: Lanes, const AXES: usize>(
    planes: &Planes,
    lane: usize,
    bundle: &Bundle,
    open: &mut Bits,
    mut found: impl FnMut(usize, u64, &mut Bits),
) {
    // Bit masks of tiles: possibly hit somewhere; certainly hit everywhere.
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
            // Negative nowhere; negative everywhere.
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

/// Bit mask of the points of a tile whose segments meet a triangle.
#[inline(always)]
fn tile_hits<L: Lanes, const AXES: usize>(planes: &Planes, lane: usize, tile: &Tile) -> u64 {
    // Plain loops and no closures, because code that is not inlined here is not compiled for the instruction set.
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

/// Barycentric weights of the intersection with a triangle on the way to point `k` of a tile.
#[inline(always)]
fn weights_at<const AXES: usize>(planes: &Planes, lane: usize, tile: &Tile, k: usize) -> [f32; 3] {
    let values = [0, 1, 2].map(|plane| {
        (0..AXES).fold(planes.coefficients[plane][0][lane], |sum, axis| {
            planes.coefficients[plane][1 + axis][lane].mul_add(tile.at[axis][k], sum)
        })
    });
    normalized(values)
}

/// Scales non-negative numbers to sum to one.
#[inline(always)]
pub(crate) fn normalized(values: [f32; 3]) -> [f32; 3] {
    let sum = values[0] + values[1] + values[2];
    // All three are zero only if a triangle is seen edge-on, which the test of its plane excludes except for underflow. Any
    // point of the triangle is then right.
    if sum > 0.0 { values.map(|v| v / sum) } else { [1.0, 0.0, 0.0] }
}

/// Kernel that finds the transmittance of the translucent triangles on the way to each open light point of a bundle.
pub(crate) struct TranslucentWalk<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tree: &'a Tree,
    pub(crate) frame: RayFrame,
    pub(crate) bundle: &'a Bundle,
    pub(crate) axes: usize,
    pub(crate) scratch: &'a mut Scratch,
    /// Segments that no blocker blocks.
    pub(crate) open: Bits,
    /// Transmittance per slot of the bundle, which is multiplied by that of each translucent triangle.
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
        // Products are rounded, so the result depends on their order: the scene's is used, whatever the tree.
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
