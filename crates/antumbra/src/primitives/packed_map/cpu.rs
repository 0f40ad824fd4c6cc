//! CPU references; filters have one channel.

use glam::UVec2;

use super::{Kernel, Packing};

/// Channels of a word; those beyond its number of channels are 0.
pub(crate) fn unpack_word(word: u32, packing: Packing) -> [f32; 4] {
    let half = |bits: u32| {
        let (exponent, mantissa) = ((bits >> 10) & 0x1f, bits & 0x3ff);
        let scale = if exponent == 0 { 2f32.powi(-14) } else { 2f32.powi(exponent as i32 - 15) };
        let magnitude = scale * (mantissa as f32 / 1024.0 + if exponent == 0 { 0.0 } else { 1.0 });
        if bits & 0x8000 == 0 { magnitude } else { -magnitude }
    };
    match packing {
        Packing::Float32 => [f32::from_bits(word), 0.0, 0.0, 0.0],
        Packing::Float16 => [half(word), half(word >> 16), 0.0, 0.0],
        Packing::Unorm16 => [(word & 0xffff) as f32 / 65535.0, (word >> 16) as f32 / 65535.0, 0.0, 0.0],
        Packing::Unorm8 => [0, 8, 16, 24].map(|shift| ((word >> shift) & 0xff) as f32 / 255.0),
    }
}

/// Blurs in both directions, with edges repeated.
pub(crate) fn blur(map: &[f32], size: UVec2, kernel: &Kernel) -> Vec<f32> {
    let line = |from: &[f32], at: &dyn Fn(i32, i32, i32) -> (i32, i32)| -> Vec<f32> {
        (0..size.y as i32)
            .flat_map(|y| (0..size.x as i32).map(move |x| (x, y)))
            .map(|(x, y)| {
                let tap = |(k, weight): (usize, &f32)| {
                    let (x, y) = at(x, y, k as i32 - kernel.radius() as i32);
                    let (x, y) = (x.clamp(0, size.x as i32 - 1), y.clamp(0, size.y as i32 - 1));
                    f64::from(*weight) * f64::from(from[(y * size.x as i32 + x) as usize])
                };
                kernel.weights.iter().enumerate().map(tap).sum::<f64>() as f32
            })
            .collect()
    };
    let rows = line(map, &|x, y, k| (x + k, y));
    line(&rows, &|x, y, k| (x, y + k))
}

/// Computes a level from the previous one.
pub(crate) fn halve(map: &[f32], size: UVec2) -> (Vec<f32>, UVec2) {
    let half = (size / 2).max(UVec2::ONE);
    let overlap = |n: u32, h: u32, to: u32, from: u32| {
        let scale = f64::from(n) / f64::from(h);
        let (low, high) = (f64::from(to) * scale, f64::from(to + 1) * scale);
        ((high.min(f64::from(from + 1)) - low.max(f64::from(from))) / scale).max(0.0)
    };
    let level = (0..half.y)
        .flat_map(|y| (0..half.x).map(move |x| (x, y)))
        .map(|(x, y)| {
            let mut sum = 0.0;
            for row in 0..size.y {
                let height = overlap(size.y, half.y, y, row);
                if height > 0.0 {
                    for column in 0..size.x {
                        let width = overlap(size.x, half.x, x, column);
                        sum += height * width * f64::from(map[(row * size.x + column) as usize]);
                    }
                }
            }
            sum as f32
        })
        .collect();
    (level, half)
}
