//! Reproducible randomness for the built-in scenes: a counter through a hash, and smooth noise from the same hash.

use std::f32::consts::TAU;

use antumbra_light::{hash_u32, unit_f32};
use glam::{Vec2, Vec3};

/// A stream of random numbers, the same for the same seed on every machine.
#[derive(Clone, Debug)]
pub(super) struct Random {
    seed: u32,
    counter: u32,
}

impl Random {
    pub fn new(seed: u32) -> Self {
        Self { seed: hash_u32(seed), counter: 0 }
    }

    /// 32 random bits.
    pub fn bits(&mut self) -> u32 {
        self.counter = self.counter.wrapping_add(1);
        hash_u32(hash_u32(self.counter) ^ self.seed)
    }

    /// Uniform random number in `[0, 1)`.
    pub fn unit(&mut self) -> f32 {
        unit_f32(self.bits())
    }

    /// Uniform random number in `[low, high)`.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Uniform random number in `[-half_width, half_width)`.
    pub fn around_zero(&mut self, half_width: f32) -> f32 {
        self.range(-half_width, half_width)
    }

    /// Random index below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f32) as usize).min(n - 1)
    }

    /// Random point, uniform in the unit disc.
    pub fn in_disc(&mut self) -> Vec2 {
        let radius = self.unit().sqrt();
        Vec2::from_angle(self.range(0.0, TAU)) * radius
    }

    /// Random direction, uniform over the unit sphere (Archimedes: height and azimuth are uniform).
    pub fn direction(&mut self) -> Vec3 {
        let y = self.range(-1.0, 1.0);
        let horizontal = Vec2::from_angle(self.range(0.0, TAU)) * (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(horizontal.x, y, horizontal.y)
    }
}

/// Value noise in `[-1, 1]` with features about one unit wide, continuous to the second derivative (Perlin 2002's
/// quintic fade).
pub(super) fn value_noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let t = p - cell;
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let base = cell.as_ivec3();
    let corner = |dx: i32, dy: i32, dz: i32| {
        let [x, y, z] = [base.x + dx, base.y + dy, base.z + dz].map(i32::cast_unsigned);
        2.0 * unit_f32(hash_u32(x ^ hash_u32(y ^ hash_u32(z)))) - 1.0
    };
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |dy: i32, dz: i32| lerp(corner(0, dy, dz), corner(1, dy, dz), fade.x);
    let along_xy = |dz: i32| lerp(along_x(0, dz), along_x(1, dz), fade.y);
    lerp(along_xy(0), along_xy(1), fade.z)
}
