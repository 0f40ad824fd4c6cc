//! Points of a light, created once per image and laid out for testing many at a time.
//!
//! **Patterns.** A pattern is one set of light points. Neighbouring pixels must not share one, or the noise of the
//! reference would show as bands; but creating 1024 new points for every pixel costs more than tracing them. An image
//! therefore has a few dozen independent patterns ([`patterns_for`]), and a hash of a pixel's index and the seed selects
//! its pattern. Every pixel's estimate is then as good as with points of its own, independent of the order of work.
//!
//! **Order.** Within a pattern, points are sorted into compact groups of 64 ([`Tile`]), so that a triangle can be tested
//! against a group at once. Sorting halves the set repeatedly, at the median of its longer side.

use antumbra_light::{Light, LightFrame, LightPoint, LightShape, SampleSet, hash_u32};
use glam::{DVec3, Vec3};

use crate::lanes::Lanes;
use crate::planes::{END_MARGIN, RayFrame};
use crate::shaft::Shaft;
use crate::{ReferenceError, VisibilityOptions};

/// Number of points per tile.
pub(crate) const TILE: usize = 64;
/// Number of tiles per bundle, whose points share a walk through the tree.
pub(crate) const BUNDLE: usize = 16;
/// Largest number of light points per pixel, for reasons of memory.
const MAX_SAMPLES: u32 = 1 << 20;
/// Number of points of all patterns together: 64 patterns of 1024, a MiB, which stays in a core's L2 cache.
const PATTERN_POINTS: u32 = 1 << 16;
/// Smallest and largest number of patterns, whatever the number of points.
const PATTERNS: std::ops::RangeInclusive<u32> = 8..=1024;

/// Tile of 64 light points in the light's frame: right, up and axis coordinates about its centre, metres (for a distant
/// light, on its tangent plane).
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Tile {
    /// Coordinates, `[axis][point]`.
    pub(crate) at: [[f32; TILE]; 3],
    /// Relative emission.
    pub(crate) weight: [f32; TILE],
}

/// Bundle of up to 16 tiles, with their boxes in the light's frame.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Bundle {
    /// Centres of the tiles' boxes, `[axis][tile]`.
    pub(crate) middle: [[f32; BUNDLE]; 3],
    /// Half extents of the tiles' boxes, `[axis][tile]`.
    pub(crate) half: [[f32; BUNDLE]; 3],
    /// Largest absolute coordinate of any point, per axis.
    pub(crate) largest: [f32; 3],
    /// Centre of the box of all points.
    pub(crate) all_middle: [f32; 3],
    /// Half extents of the box of all points.
    pub(crate) all_half: [f32; 3],
    /// Bit k of entry i: point k of tile i is a point rather than padding.
    pub(crate) valid: [u64; BUNDLE],
    pub(crate) tiles: Vec<Tile>,
}

/// One set of light points.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub(crate) bundles: Vec<Bundle>,
    /// Index of each slot's point in the set's own order, tile after tile.
    pub(crate) order: Vec<u32>,
    /// Sum of the points' weights; for a uniform light, the number of points.
    pub(crate) total_weight: f64,
}

/// Light prepared for tracing: its frame and its patterns.
#[derive(Clone, Debug)]
pub struct SampledLight {
    pub(crate) light: Light,
    pub(crate) frame: LightFrame,
    pub(crate) patterns: Vec<Pattern>,
    /// Seed of each pattern's set.
    pattern_seeds: Vec<u32>,
    options: VisibilityOptions,
    /// Points per pattern.
    pub(crate) points: u32,
    /// Number of axes along which the light extends: 2, or 3 for one with volume.
    pub(crate) axes: usize,
    /// Whether points differ in weight.
    pub(crate) weighted: bool,
}

impl SampledLight {
    /// Samples `light` according to `options`.
    ///
    /// # Errors
    /// The light is invalid, or the number of samples is zero or beyond 2²⁰.
    pub fn new(light: &Light, options: &VisibilityOptions) -> Result<Self, ReferenceError> {
        light.validate()?;
        if !(1..=MAX_SAMPLES).contains(&options.samples) {
            return Err(ReferenceError::Samples { samples: options.samples, most: MAX_SAMPLES });
        }
        let listed = match &light.shape {
            LightShape::Points { positions_m } => Some(positions_m.len() as u32),
            _ => None,
        };
        let points = listed.unwrap_or(options.samples);
        let count = if options.same_set_for_all_pixels || listed.is_some() { 1 } else { patterns_for(points) };
        let pattern_seeds: Vec<u32> =
            (0..count).map(|k| if k == 0 { options.seed } else { hash_u32(hash_u32(options.seed) ^ k) }).collect();
        let mut sampled = Self {
            light: light.clone(),
            frame: light.frame(),
            patterns: Vec::new(),
            pattern_seeds,
            options: *options,
            points,
            axes: if matches!(light.shape, LightShape::Ellipsoid { .. } | LightShape::Points { .. }) { 3 } else { 2 },
            weighted: light.emission.is_some() && matches!(light.shape, LightShape::Rectangle { .. }),
        };
        sampled.patterns = (0..count as usize).map(|k| Pattern::new(sampled.local_points(k))).collect();
        Ok(sampled)
    }

    /// Number of light points tested per receiver.
    pub fn points_per_receiver(&self) -> u32 {
        self.points
    }

    /// Light points of the pixel or receiver with this index, in the order of the bits of
    /// [`Tracer::visible_mask`](crate::Tracer::visible_mask), as seen from the world position `seen_from`.
    pub fn points_for(&self, receiver_index: usize, seen_from: Vec3) -> Vec<LightPoint> {
        if let LightShape::Points { positions_m } = &self.light.shape {
            return positions_m.iter().map(|p| LightPoint { xyz: *p, w: 1.0, weight: 1.0 }).collect();
        }
        let points = self.unit_points(self.pattern_index(receiver_index));
        points.into_iter().map(|u| self.light.point(&self.frame, u, seen_from)).collect()
    }

    /// Index of the pattern of the receiver with this index.
    #[inline]
    pub(crate) fn pattern_index(&self, receiver_index: usize) -> usize {
        let count = self.patterns.len().max(1) as u64;
        let hash = hash_u32(hash_u32(receiver_index as u32) ^ self.options.seed);
        // Multiplies the count by the hash as a fraction of 2³².
        ((u64::from(hash) * count) >> 32) as usize
    }

    /// Points of a pattern in the unit cube.
    fn unit_points(&self, pattern: usize) -> Vec<Vec3> {
        let (set, seed) = (self.options.set, self.options.seed);
        if matches!(set, SampleSet::PoissonDisc | SampleSet::Relaxed) && pattern > 0 {
            // Some sets are slow to create but are about as good after any shift on a torus: shift one set instead.
            let shift_seed = self.pattern_seeds[pattern];
            let shift = [1, 2, 3].map(|axis| antumbra_light::unit_f32(hash_u32(shift_seed ^ hash_u32(axis))));
            let points = set.points(self.points, seed);
            return points
                .into_iter()
                .map(|u| (u + Vec3::from(shift)).fract_gl().min(Vec3::splat(1.0 - f32::EPSILON)))
                .collect();
        }
        set.points(self.points, self.pattern_seeds[pattern])
    }

    /// Points of a pattern in the light's frame, with their weights.
    fn local_points(&self, pattern: usize) -> Vec<(Vec3, f32)> {
        if let LightShape::Points { positions_m } = &self.light.shape {
            let axes = [self.frame.right, self.frame.up, self.frame.axis].map(Vec3::as_dvec3);
            let local = |p: &Vec3| {
                let offset = p.as_dvec3() - self.frame.center.as_dvec3();
                DVec3::from_array(axes.map(|e| offset.dot(e))).as_vec3()
            };
            return positions_m.iter().map(|p| (local(p), 1.0)).collect();
        }
        // In the identity frame, a light point equals its coordinates.
        let identity = LightFrame { center: Vec3::ZERO, right: Vec3::X, up: Vec3::Y, axis: Vec3::Z };
        // A sphere's disc faces the receiver: from +z, its right is −x and its up is +y (`facing_axes`).
        let is_sphere = matches!(self.light.shape, LightShape::Sphere { .. });
        let flip = if is_sphere { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
        let is_flat = self.axes == 2;
        self.unit_points(pattern)
            .into_iter()
            .map(|u| {
                let point = self.light.point(&identity, u, Vec3::Z);
                let local = point.xyz * flip;
                (if is_flat { local.truncate().extend(0.0) } else { local }, point.weight)
            })
            .collect()
    }

    /// Frame of the rays to this light from `origin`, on the receiver at `position`.
    #[inline]
    pub(crate) fn ray_frame(&self, origin: Vec3, position: Vec3) -> RayFrame {
        let frame = &self.frame;
        let doubles = |v: Vec3| v.as_dvec3().to_array();
        let distant = self.light.is_distant();
        let to_center = if distant { -frame.axis.as_dvec3() } else { frame.center.as_dvec3() - origin.as_dvec3() };
        let (right, up) = match self.light.shape {
            LightShape::Sphere { .. } => facing_axes(frame, position),
            _ => (frame.right, frame.up),
        };
        RayFrame {
            origin: origin.to_array(),
            to_center: to_center.to_array(),
            axes: [doubles(right), doubles(up), doubles(frame.axis)],
            inverse_end: if distant { 0.0 } else { 1.0 + END_MARGIN },
        }
    }
}

/// Axes of the disc that a sphere shows to a receiver; the same as in `antumbra_light::Light::point`.
fn facing_axes(frame: &LightFrame, seen_from: Vec3) -> (Vec3, Vec3) {
    let towards = (frame.center - seen_from).try_normalize().unwrap_or(-frame.axis);
    let right = frame.up.cross(towards).try_normalize().unwrap_or(frame.right);
    (right, towards.cross(right))
}

/// Number of patterns of an image with `points` light points per pixel.
fn patterns_for(points: u32) -> u32 {
    (PATTERN_POINTS / points).clamp(*PATTERNS.start(), *PATTERNS.end())
}

impl Pattern {
    fn new(points: Vec<(Vec3, f32)>) -> Self {
        let total_weight = points.iter().map(|p| f64::from(p.1)).sum();
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        halve(&points, &mut order);
        let bundles = order.chunks(TILE * BUNDLE).map(|slots| Bundle::new(&points, slots)).collect();
        Self { bundles, order, total_weight }
    }
}

/// Sorts indices of points so that every aligned run of 64 (and every run of 64·2ᵏ) is compact.
fn halve(points: &[(Vec3, f32)], order: &mut [u32]) {
    if order.len() <= TILE {
        return;
    }
    let at = |i: &u32| points[*i as usize].0;
    let (low, high) =
        order.iter().map(at).fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let axis = (high - low).max_position();
    // Whole tiles on the left, a power of two of them, so that the boundaries are also those of bundles.
    let tiles = order.len().div_ceil(TILE);
    let left = TILE * (tiles.next_power_of_two() / 2);
    order.select_nth_unstable_by(left - 1, |i, j| at(i)[axis].total_cmp(&at(j)[axis]).then(i.cmp(j)));
    let (first, second) = order.split_at_mut(left);
    halve(points, first);
    halve(points, second);
}

impl Bundle {
    fn new(points: &[(Vec3, f32)], slots: &[u32]) -> Self {
        let bounds = |slots: &[u32]| {
            let (low, high) = slots
                .iter()
                .map(|i| points[*i as usize].0)
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
            // Half the difference, rounded up, so that middle ± half contains both ends.
            let middle = 0.5 * (low + high);
            (middle, (high - middle).max(middle - low) * (1.0 + f32::EPSILON), low.abs().max(high.abs()))
        };
        let (all_middle, all_half, largest) = bounds(slots);
        let mut bundle = Self {
            middle: [[0.0; BUNDLE]; 3],
            half: [[0.0; BUNDLE]; 3],
            largest: largest.to_array(),
            all_middle: all_middle.to_array(),
            all_half: all_half.to_array(),
            valid: [0; BUNDLE],
            tiles: Vec::new(),
        };
        for (tile_index, slots) in slots.chunks(TILE).enumerate() {
            let (middle, half, _) = bounds(slots);
            let mut tile = Tile { at: [[0.0; TILE]; 3], weight: [0.0; TILE] };
            for axis in 0..3 {
                bundle.middle[axis][tile_index] = middle[axis];
                bundle.half[axis][tile_index] = half[axis];
                for (k, at) in tile.at[axis].iter_mut().enumerate() {
                    *at = points[slots[k.min(slots.len() - 1)] as usize].0[axis];
                }
            }
            for (weight, slot) in tile.weight.iter_mut().zip(slots) {
                *weight = points[*slot as usize].1;
            }
            bundle.valid[tile_index] = if slots.len() == TILE { u64::MAX } else { (1 << slots.len()) - 1 };
            bundle.tiles.push(tile);
        }
        bundle
    }

    /// Shaft from a receiver to all points of this bundle.
    pub(crate) fn shaft(&self, frame: &RayFrame) -> Shaft {
        let mut middle = [0.0; 3];
        let mut half = [0.0; 3];
        for axis in 0..3 {
            let (mut m, mut h) = (frame.to_center[axis], 0.0f64);
            for (k, e) in frame.axes.iter().enumerate() {
                m += e[axis] * f64::from(self.all_middle[k]);
                h += e[axis].abs() * f64::from(self.all_half[k]);
            }
            middle[axis] = m as f32;
            half[axis] = h as f32;
        }
        Shaft::new(frame.origin, middle, half, if frame.inverse_end == 0.0 { FAR } else { 1.0 })
    }
}

/// End of an endless segment: beyond any `t` of a finite scene.
pub(crate) const FAR: f32 = 1e30;

/// Loads eight coordinates of a tile's points.
#[inline(always)]
pub(crate) fn eight<L: Lanes>(values: &[f32], chunk: usize) -> L {
    let values: &[f32; 8] = values[8 * chunk..8 * chunk + 8].try_into().expect("eight values");
    L::load(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn lights() -> Vec<Light> {
        let (center, target) = (Vec3::new(1.0, 5.0, -2.0), Vec3::new(0.3, 0.0, 0.4));
        [
            LightShape::Rectangle { size_m: Vec2::new(1.0, 0.4) },
            LightShape::Disk { radius_m: 0.5 },
            LightShape::Sphere { radius_m: 0.5 },
            LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.3, 0.2) },
            LightShape::Sun { angular_diameter_rad: 0.1 },
            LightShape::Points { positions_m: vec![Vec3::new(1.0, 4.0, 2.0), Vec3::new(-3.0, 5.0, 2.0)] },
        ]
        .map(|shape| Light::new(shape, center, target))
        .into()
    }

    #[test]
    fn tiles_hold_the_lights_own_points() {
        for (i, light) in lights().into_iter().enumerate() {
            // Every set with one shape, and every shape with one set, because sets do not depend on shapes.
            for set in SampleSet::ALL.into_iter().filter(|set| i == 0 || *set == SampleSet::R2) {
                let options = VisibilityOptions { samples: 200, set, ..VisibilityOptions::default() };
                let sampled = SampledLight::new(&light, &options).unwrap();
                let x = Vec3::new(0.3, 0.1, 2.0);
                let frame = sampled.ray_frame(x, x);
                for index in [0, 5, 77] {
                    let want = sampled.points_for(index, x);
                    let pattern = &sampled.patterns[sampled.pattern_index(index)];
                    assert_eq!(pattern.order.len(), want.len());
                    let bundle = &pattern.bundles[0];
                    for (slot, &i) in pattern.order.iter().enumerate().take(TILE * BUNDLE) {
                        let (tile, k) = (slot / TILE, slot % TILE);
                        let at = [0, 1, 2].map(|axis| bundle.tiles[tile].at[axis][k]);
                        let d = (0..3).fold(DVec3::from(frame.to_center), |d, axis| {
                            d + DVec3::from(frame.axes[axis]) * f64::from(at[axis])
                        });
                        let want = want[i as usize];
                        assert!(d.as_vec3().abs_diff_eq(want.vector_from(x), 2e-6), "{light:?} {set}");
                        let within =
                            |axis: usize| (at[axis] - bundle.middle[axis][tile]).abs() <= bundle.half[axis][tile];
                        assert!((0..3).all(within));
                    }
                }
            }
        }
    }

    #[test]
    fn halving_makes_compact_tiles() {
        let light = &lights()[0];
        let sampled = SampledLight::new(light, &VisibilityOptions::default()).unwrap();
        let bundle = &sampled.patterns[3].bundles[0];
        assert_eq!(bundle.tiles.len(), 16);
        // A 1 × 0.4 m rectangle in 16 tiles of equal number: 0.025 m² each, up to the jitter at their edges.
        for tile in 0..16 {
            let area = 4.0 * bundle.half[0][tile] * bundle.half[1][tile];
            assert!(area < 0.04, "{area}");
        }
    }
}
