//! A tile of blue noise, made once for a device: numbers whose low frequencies are as good as none, so that what they make of
//! neighbouring pixels differs as much as it can and small blurs remove it.
//!
//! By void and cluster (Ulichney 1993, "The void-and-cluster method for dither array generation"): each texel's rank is when it
//! is filled, and always the emptiest one is next; how full it is about a texel is told by a Gaussian over the texels that are
//! filled, around the tile's edges.

use std::sync::LazyLock;

use crate::gpu::{Gpu, shared_constants, texture_of};

shared_constants! {
    /// Texels along a side.
    const TILE_SIDE: u32 = 64, as in PCSS_RESOLVE;
}

const SIDE: usize = TILE_SIDE as usize;
const TEXELS: usize = SIDE * SIDE;

/// The Gaussian's standard deviation, texels: Ulichney's.
const DEVIATION_TEXELS: f32 = 1.5;
/// Beyond so many texels it is less than a float of a sum tells.
const REACH_TEXELS: usize = 9;
/// Of the texels, so many are filled before their ranks are told: the first are by chance, and moved until they lie well.
const FIRST_FILLED: usize = TEXELS / 10;

/// How full it is about each texel, and which are filled.
#[derive(Clone)]
struct Filling {
    is_filled: Vec<bool>,
    fullness: Vec<f32>,
    /// By distance along an axis.
    gaussian: [f32; REACH_TEXELS + 1],
}

impl Filling {
    fn new() -> Self {
        let gaussian = std::array::from_fn(|at| (-0.5 * (at as f32 / DEVIATION_TEXELS).powi(2)).exp());
        Self { is_filled: vec![false; TEXELS], fullness: vec![0.0; TEXELS], gaussian }
    }

    fn set(&mut self, texel: usize, is_filled: bool) {
        self.is_filled[texel] = is_filled;
        let sign = if is_filled { 1.0 } else { -1.0 };
        let (x, y) = (texel % SIDE, texel / SIDE);
        for dy in 0..=2 * REACH_TEXELS {
            let row = SIDE * ((y + SIDE + dy - REACH_TEXELS) % SIDE);
            let along_y = sign * self.gaussian[dy.abs_diff(REACH_TEXELS)];
            for dx in 0..=2 * REACH_TEXELS {
                let column = (x + SIDE + dx - REACH_TEXELS) % SIDE;
                self.fullness[row + column] += along_y * self.gaussian[dx.abs_diff(REACH_TEXELS)];
            }
        }
    }

    /// The filled texel with the most about it.
    fn cluster(&self) -> usize {
        self.extreme(true, |a, b| a > b)
    }

    /// The free texel with the least about it.
    fn void(&self) -> usize {
        self.extreme(false, |a, b| a < b)
    }

    fn extreme(&self, is_filled: bool, is_more: impl Fn(f32, f32) -> bool) -> usize {
        let candidates = (0..TEXELS).filter(|texel| self.is_filled[*texel] == is_filled);
        let further = |a: usize, b: usize| if is_more(self.fullness[b], self.fullness[a]) { b } else { a };
        candidates.reduce(further).expect("never all nor none are filled when asked")
    }
}

/// The tile's ranks: found once for a process, in 30 ms, and in half a second where nothing is optimised.
static RANKS: LazyLock<Vec<u16>> = LazyLock::new(ranks);

/// The order in which the texels are filled, row by row.
fn ranks() -> Vec<u16> {
    let mut first = Filling::new();
    // Any numbers will do: what is too close is moved.
    let mut chance = 1_u32;
    for _ in 0..FIRST_FILLED {
        let texel = loop {
            chance = chance.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let texel = (chance >> 16) as usize % TEXELS;
            if !first.is_filled[texel] {
                break texel;
            }
        };
        first.set(texel, true);
    }
    // Each move makes the whole more even, so that this ends; a bound all the same, since floats are rounded.
    for _ in 0..TEXELS {
        let cluster = first.cluster();
        first.set(cluster, false);
        let void = first.void();
        first.set(void, true);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0; TEXELS];
    let mut emptied = first.clone();
    for rank in (0..FIRST_FILLED).rev() {
        let cluster = emptied.cluster();
        emptied.set(cluster, false);
        ranks[cluster] = rank as u16;
    }
    for rank in FIRST_FILLED..TEXELS {
        let void = first.void();
        first.set(void, true);
        ranks[void] = rank as u16;
    }
    ranks
}

/// The device's tile.
pub(super) fn tile(gpu: &Gpu) -> &wgpu::TextureView {
    gpu.device.noise_tile(|| {
        let texels: Vec<u8> = RANKS.iter().map(|rank| (usize::from(*rank) * 256 / TEXELS) as u8).collect();
        texture_of(gpu, "antumbra blue noise", wgpu::TextureFormat::R8Unorm, TILE_SIDE, &texels)
    })
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::{RANKS, SIDE, TEXELS};
    use crate::gpu::shared_constants;

    shared_constants! {
        /// From a pixel's first value to its second, texels.
        const SECOND_TILE_X: u32 = 29, as in PCSS_RESOLVE;
        const SECOND_TILE_Y: u32 = 41, as in PCSS_RESOLVE;
    }

    /// Of values in [0, 1): how much of their variance frequencies of up to a tenth of the texels' have, of what they would have
    /// of as many numbers by chance.
    fn low_frequencies(values: &[f32]) -> f32 {
        const MOST: i32 = SIDE as i32 / 10;
        let mean = values.iter().sum::<f32>() / TEXELS as f32;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / TEXELS as f32;
        let mut sum = 0.0;
        let mut count = 0.0;
        for v in 0..=MOST {
            for u in -MOST..=MOST {
                if u * u + v * v > MOST * MOST || (v == 0 && u <= 0) {
                    continue;
                }
                let (mut cosine, mut sine) = (0.0, 0.0);
                for (at, value) in values.iter().enumerate() {
                    let turns = (u * (at % SIDE) as i32 + v * (at / SIDE) as i32).rem_euclid(SIDE as i32);
                    let phase = TAU * turns as f32 / SIDE as f32;
                    cosine += (value - mean) * phase.cos();
                    sine += (value - mean) * phase.sin();
                }
                sum += (cosine * cosine + sine * sine) / (TEXELS as f32 * variance);
                count += 1.0;
            }
        }
        sum / count
    }

    /// Each rank once, and of each threshold as of all values: next to nothing that a small blur would leave.
    #[test]
    fn what_is_next_is_far_and_nothing_is_low() {
        let mut sorted = RANKS.clone();
        sorted.sort_unstable();
        assert!((0..TEXELS as u16).eq(sorted), "each rank once");
        let values: Vec<f32> = RANKS.iter().map(|rank| f32::from(*rank) / TEXELS as f32).collect();
        let all = low_frequencies(&values);
        println!("values: {all:.4} of chance's");
        assert!(all < 0.02, "{all}");
        for threshold in [0.05, 0.25, 0.5, 0.75, 0.95] {
            let below: Vec<f32> = values.iter().map(|value| f32::from(u8::from(*value < threshold))).collect();
            let low = low_frequencies(&below);
            println!("below {threshold}: {low:.4} of chance's");
            assert!(low < 0.1, "below {threshold}: {low}");
        }
        // The measure tells: the same ranks in another order are as good as chance.
        let shuffled: Vec<f32> = (0..TEXELS).map(|at| values[at * 1237 % TEXELS]).collect();
        let low = low_frequencies(&shuffled);
        assert!(low > 0.2, "shuffled {low}");
    }

    /// The second value of a pixel is of another place in the tile: it tells nothing of the first, nor of its neighbours'.
    #[test]
    fn second_values_are_of_their_own() {
        let value = |x: usize, y: usize| f32::from(RANKS[x % SIDE + SIDE * (y % SIDE)]) / TEXELS as f32 - 0.5;
        let second = (SECOND_TILE_X as usize, SECOND_TILE_Y as usize);
        for (dx, dy) in [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)] {
            let (dx, dy) = (second.0.wrapping_add_signed(dx), second.1.wrapping_add_signed(dy));
            let products = (0..TEXELS).map(|at| value(at % SIDE, at / SIDE) * value(at % SIDE + dx, at / SIDE + dy));
            let correlation = 12.0 * products.sum::<f32>() / TEXELS as f32;
            assert!(correlation.abs() < 0.05, "{dx}, {dy}: {correlation}");
        }
    }
}
