//! CPU reference of summed-area tables: the definition, row by row.

use std::ops::Add;

use glam::UVec2;

/// Returns for each texel the sum over the texels of its tile that are neither to its right nor below it.
pub(crate) fn build<T: Copy + Default + Add<Output = T>>(values: &[T], size: UVec2, tile: u32) -> Vec<T> {
    let mut table = values.to_vec();
    let at = |x: u32, y: u32| (y * size.x + x) as usize;
    for y in 0..size.y {
        let mut row = T::default();
        for x in 0..size.x {
            row = if x % tile == 0 { table[at(x, y)] } else { row + table[at(x, y)] };
            table[at(x, y)] = if y % tile == 0 { row } else { row + table[at(x, y - 1)] };
        }
    }
    table
}

/// Returns the largest power-of-two tile, 16 to 256 texels, in which every sum is below 2³².
pub(crate) fn chosen_tile(values: &[[u32; 4]], size: UVec2) -> u32 {
    let mut tile = 16;
    while tile < size.max_element().next_power_of_two().min(super::MAX_TILE) {
        let next = 2 * tile;
        let tiles = size.map(|n| n.div_ceil(next));
        let mut sums = vec![[0u64; 4]; (tiles.x * tiles.y) as usize];
        for (i, value) in (0u32..).zip(values) {
            let at = UVec2::new(i % size.x, i / size.x) / next;
            for (sum, v) in sums[(at.y * tiles.x + at.x) as usize].iter_mut().zip(value) {
                *sum += u64::from(*v);
            }
        }
        if sums.iter().flatten().any(|sum| *sum >= 1 << 32) {
            break;
        }
        tile = next;
    }
    tile
}
