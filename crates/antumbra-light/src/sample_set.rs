//! Sets of points in the unit cube. The first two coordinates are well distributed; the third serves the ellipsoid, the only shape
//! with volume.

use std::fmt;

use glam::{IVec2, Vec2, Vec3};

/// Distribution of a set of points over the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SampleSet {
    /// One jittered point in each cell of the squarest grid of `n` cells, and in each of `n` strips in both directions: Kensler's
    /// correlated multi-jittered points (2013).
    Stratified,
    /// The additive recurrence on the plastic number (Roberts 2018), shifted by the seed.
    #[default]
    R2,
    /// The first two dimensions of Sobol's sequence (1967), with the seed's random digital shift.
    Sobol,
    /// Mitchell's best-candidate points (1991) on the torus: no two are close.
    PoissonDisc,
    /// Sobol's points, moved to the centroids of their Voronoi cells (Lloyd 1982): the most even of all, and the least error where
    /// a light is seen through leaves.
    Relaxed,
}

impl SampleSet {
    /// Every set, in the order of the documentation.
    pub const ALL: [Self; 5] = [Self::Stratified, Self::R2, Self::Sobol, Self::PoissonDisc, Self::Relaxed];

    /// Name in parameters and setup files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stratified => "stratified",
            Self::R2 => "r2",
            Self::Sobol => "sobol",
            Self::PoissonDisc => "poisson",
            Self::Relaxed => "relaxed",
        }
    }

    /// Set of this name; case-insensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|set| set.name().eq_ignore_ascii_case(name))
    }

    /// Returns `n` points in `[0, 1)³`, the same for the same seed on every machine.
    pub fn points(self, n: u32, seed: u32) -> Vec<Vec3> {
        self.run(0, n, seed)
    }

    /// Returns the `run`-th set of `n` points for one seed, for use one after another; the first is [`Self::points`]. Together the
    /// sets are as well spread as possible: R2 and Sobol continue their sequence, relaxed points continue with Sobol's, stratified
    /// points have a new seed, and Poisson-disc points are shifted on the torus.
    pub fn run(self, run: u32, n: u32, seed: u32) -> Vec<Vec3> {
        let first = run.wrapping_mul(n);
        let indices = || (0..n).map(|i| first.wrapping_add(i));
        let z = |i: u32| unit_f32(hash_u32(hash_u32(i ^ 0x9e37_79b9) ^ seed));
        let points_2d: Vec<Vec2> = match self {
            Self::Stratified if run == 0 => stratified(n, seed),
            Self::Stratified => stratified(n, hash_u32(hash_u32(seed) ^ run)),
            Self::R2 => r2(indices(), seed),
            Self::Sobol => sobol(indices(), seed),
            Self::PoissonDisc => turned_about(best_candidate(n, seed), run),
            Self::Relaxed if run == 0 => relaxed(sobol(0..n, seed)),
            Self::Relaxed => sobol(indices(), seed),
        };
        points_2d.into_iter().zip(indices()).map(|(p, i)| p.extend(z(i))).collect()
    }
}

impl fmt::Display for SampleSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// PCG's output permutation as a hash (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering").
pub fn hash_u32(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Converts the top 24 bits to a float in `[0, 1)`.
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Columns and rows of the grid of `n` cells whose sides are closest: the largest divisor not above √n, by its cofactor.
fn squarest_grid(n: u32) -> (u32, u32) {
    let rows = (1..=n.isqrt()).rev().find(|d| n.is_multiple_of(*d)).unwrap_or(1);
    (n / rows, rows)
}

/// Kensler, "Correlated Multi-Jittered Sampling", Pixar technical memo 13-01, 2013: within its cell, a point's strip in x is given
/// by its row and its strip in y by its column, both shuffled once for all rows and columns. So no two points share a strip, and
/// neighbours keep apart.
fn stratified(n: u32, seed: u32) -> Vec<Vec2> {
    let (columns, rows) = squarest_grid(n.max(1));
    let strips_of_rows = shuffled(rows, hash_u32(seed ^ 0x68bc_21eb));
    let strips_of_columns = shuffled(columns, hash_u32(seed ^ 0x02e5_be93));
    (0..n)
        .map(|i| {
            let (column, row) = (i % columns, i / columns);
            let strip = [strips_of_rows[row as usize], strips_of_columns[column as usize]];
            let jitter = [2 * i, 2 * i + 1].map(|k| unit_f32(hash_u32(hash_u32(k) ^ seed)));
            let x = (column as f32 + (strip[0] as f32 + jitter[0]) / rows as f32) / columns as f32;
            let y = (row as f32 + (strip[1] as f32 + jitter[1]) / columns as f32) / rows as f32;
            Vec2::new(x, y).min(Vec2::splat(1.0 - f32::EPSILON))
        })
        .collect()
}

/// Numbers below `n`, shuffled by the seed.
fn shuffled(n: u32, seed: u32) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..n).collect();
    numbers.sort_by_key(|k| hash_u32(hash_u32(*k) ^ seed));
    numbers
}

/// Shifts a set on the torus, where every shift is as good; the shifts of different runs are far from each other.
fn turned_about(points: Vec<Vec2>, run: u32) -> Vec<Vec2> {
    let shift = R2_STEP.map(|step| step.wrapping_mul(run));
    let turned = |v: f32, shift: u32| unit_f32(((f64::from(v) * 4_294_967_296.0) as u32).wrapping_add(shift));
    points.into_iter().map(|p| Vec2::new(turned(p.x, shift[0]), turned(p.y, shift[1]))).collect()
}

/// Steps of the R2 sequence, 2³²/ρ and 2³²/ρ² for the plastic number ρ = 1.32471795724…: integer arithmetic wraps exactly.
const R2_STEP: [u32; 2] = [3_242_174_889, 2_447_445_414];

fn r2(indices: impl Iterator<Item = u32>, seed: u32) -> Vec<Vec2> {
    let start = if seed == 0 { [1 << 31; 2] } else { [hash_u32(seed), hash_u32(hash_u32(seed))] };
    indices
        .map(|i| {
            let at = |axis: usize| unit_f32(start[axis].wrapping_add(R2_STEP[axis].wrapping_mul(i)));
            Vec2::new(at(0), at(1))
        })
        .collect()
}

fn sobol(indices: impl Iterator<Item = u32>, seed: u32) -> Vec<Vec2> {
    let shift = if seed == 0 { [0, 0] } else { [hash_u32(seed), hash_u32(hash_u32(seed))] };
    indices
        .map(|i| {
            // Dimension one is van der Corput's; dimension two has the primitive polynomial x + 1, whose direction
            // numbers are v ← v ⊕ (v ≫ 1).
            let (mut x, mut y, mut v) = (0u32, 0u32, 1u32 << 31);
            for bit in 0..32 {
                if i >> bit & 1 == 1 {
                    x ^= 1 << (31 - bit);
                    y ^= v;
                }
                v ^= v >> 1;
            }
            Vec2::new(unit_f32(x ^ shift[0]), unit_f32(y ^ shift[1]))
        })
        .collect()
}

fn best_candidate(n: u32, seed: u32) -> Vec<Vec2> {
    let mut state = hash_u32(seed ^ 0x5bd1_e995);
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        unit_f32(hash_u32(state))
    };
    let torus_distance_squared = |a: Vec2, b: Vec2| {
        let d = (a - b).abs();
        d.min(1.0 - d).length_squared()
    };
    let mut points: Vec<Vec2> = Vec::with_capacity(n as usize);
    for i in 0..n {
        // Mitchell lets the number of candidates grow with the set; beyond 64 the gain is not visible.
        let candidates = (4 * (i + 1)).min(64);
        let mut best = (Vec2::ZERO, -1.0f32);
        for _ in 0..candidates {
            let p = Vec2::new(next(), next());
            let nearest = points.iter().map(|q| torus_distance_squared(p, *q)).fold(f32::INFINITY, f32::min);
            if nearest > best.1 {
                best = (p, nearest);
            }
        }
        points.push(best.0);
    }
    points
}

/// Number of relaxation rounds: after these no point moves by more than a few percent of its distance to the next.
const RELAXATIONS: u32 = 24;
/// Number of probes along a bin's side: 64 per point find its centroid to a percent.
const PROBES: u32 = 8;

/// Lloyd 1982, "Least squares quantization in PCM": each point moves repeatedly to the centroid of its Voronoi cell in the square.
fn relaxed(mut points: Vec<Vec2>) -> Vec<Vec2> {
    let bins = (points.len() as f32).sqrt().ceil().max(1.0) as i32;
    let bin_of = |p: Vec2| (p * bins as f32).as_ivec2().min(IVec2::splat(bins - 1));
    let probes = bins * PROBES as i32;
    for _ in 0..RELAXATIONS {
        let mut lists = vec![Vec::new(); (bins * bins) as usize];
        for (i, p) in points.iter().enumerate() {
            let bin = bin_of(*p);
            lists[(bin.y * bins + bin.x) as usize].push(i);
        }
        let nearest_to = |probe: Vec2| {
            let (middle, mut best) = (bin_of(probe), (f32::INFINITY, 0));
            // Points beyond a ring of bins are farther than that many bins' widths.
            for ring in 0..=bins {
                for y in (middle.y - ring).max(0)..=(middle.y + ring).min(bins - 1) {
                    // Rows between the ring's first and last have only its first and last column.
                    let step = if (y - middle.y).abs() == ring { 1 } else { (2 * ring).max(1) };
                    for x in (middle.x - ring..=middle.x + ring).step_by(step as usize) {
                        let list = if (0..bins).contains(&x) { &lists[(y * bins + x) as usize][..] } else { &[] };
                        for i in list {
                            let distance = points[*i].distance_squared(probe);
                            best = if distance < best.0 { (distance, *i) } else { best };
                        }
                    }
                }
                if best.0 <= (ring as f32 / bins as f32).powi(2) {
                    break;
                }
            }
            best.1
        };
        let mut sums = vec![(Vec2::ZERO, 0.0f32); points.len()];
        for i in 0..probes * probes {
            let probe = (IVec2::new(i % probes, i / probes).as_vec2() + 0.5) / probes as f32;
            let sum = &mut sums[nearest_to(probe)];
            *sum = (sum.0 + probe, sum.1 + 1.0);
        }
        for (point, (sum, count)) in points.iter_mut().zip(sums) {
            // A point that is nearest to no probe stays.
            *point = if count > 0.0 { sum / count } else { *point };
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_lies_in_the_cube_and_balances() {
        for set in SampleSet::ALL {
            for seed in [0, 1, 77] {
                let points = set.points(256, seed);
                assert_eq!(points.len(), 256);
                assert!(points.iter().all(|p| p.min_element() >= 0.0 && p.max_element() < 1.0), "{set}");
                let mean = points.iter().sum::<Vec3>() / 256.0;
                assert!((mean.truncate() - 0.5).abs().max_element() < 0.03, "{set} {seed}: {mean}");
                assert_eq!(points, set.points(256, seed));
            }
        }
    }

    #[test]
    fn sobol_is_a_zero_two_net() {
        // Each elementary interval of area 1/64 holds exactly one of the first 64 points.
        let points = SampleSet::Sobol.points(64, 5);
        for log_columns in 0..=6 {
            let (columns, rows) = (1u32 << log_columns, 64u32 >> log_columns);
            let mut counts = vec![0; 64];
            for p in &points {
                counts[((p.x * columns as f32) as u32 * rows + (p.y * rows as f32) as u32) as usize] += 1;
            }
            assert!(counts.iter().all(|c| *c == 1), "{columns} × {rows}");
        }
    }

    #[test]
    fn runs_of_a_sequence_are_the_sequence() {
        for set in [SampleSet::R2, SampleSet::Sobol] {
            let runs: Vec<Vec3> = (0..4).flat_map(|run| set.run(run, 16, 3)).collect();
            assert_eq!(runs, set.points(64, 3), "{set}");
        }
        for set in SampleSet::ALL {
            assert_eq!(set.run(0, 32, 5), set.points(32, 5));
            assert_ne!(set.run(1, 32, 5), set.points(32, 5));
        }
    }

    /// Relaxation lowers the mean square of the distance to the nearest point; a hexagonal grid has 0.1604 / n.
    #[test]
    fn relaxed_points_are_the_most_even() {
        let mean_square = |set: SampleSet| {
            let points = set.points(64, 1);
            let nearest =
                |probe: Vec2| points.iter().map(|p| p.truncate().distance_squared(probe)).fold(f32::INFINITY, f32::min);
            let probes = (0..4096).map(|i| (Vec2::new((i % 64) as f32, (i / 64) as f32) + 0.5) / 64.0);
            64.0 * probes.map(nearest).sum::<f32>() / 4096.0
        };
        let relaxed = mean_square(SampleSet::Relaxed);
        assert!((0.155..0.175).contains(&relaxed), "{relaxed}");
        for set in [SampleSet::Stratified, SampleSet::R2, SampleSet::Sobol, SampleSet::PoissonDisc] {
            assert!(mean_square(set) > 1.05 * relaxed, "{set}: {} against {relaxed}", mean_square(set));
        }
    }

    #[test]
    fn stratified_has_one_point_a_cell() {
        let mut counts = vec![0; 64];
        for p in SampleSet::Stratified.points(64, 9) {
            counts[((p.y * 8.0) as usize) * 8 + (p.x * 8.0) as usize] += 1;
        }
        assert!(counts.iter().all(|c| *c == 1));
        // And one in each of as many strips in both directions.
        for axis in 0..2 {
            let mut strips: Vec<u32> =
                SampleSet::Stratified.points(128, 9).iter().map(|p| (p[axis] * 128.0) as u32).collect();
            strips.sort_unstable();
            assert_eq!(strips, (0..128).collect::<Vec<_>>());
        }
        assert_eq!(squarest_grid(128), (16, 8));
        assert_eq!(squarest_grid(7), (7, 1));
    }

    #[test]
    fn poisson_points_keep_their_distance() {
        let points = SampleSet::PoissonDisc.points(64, 3);
        for (i, a) in points.iter().enumerate() {
            for b in &points[..i] {
                assert!(a.truncate().distance(b.truncate()) > 0.5 / 8.0, "{a} {b}");
            }
        }
    }
}
