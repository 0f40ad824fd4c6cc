//! CPU reference of the depth pyramid.

use glam::UVec2;

use super::level_sizes;

/// Returns every level's (min, max), row by row.
pub(crate) fn build(map: &[f32], map_size: UVec2) -> Vec<Vec<[f32; 2]>> {
    let mut previous: Vec<[f32; 2]> = map.iter().map(|d| [*d, *d]).collect();
    let mut previous_size = map_size;
    level_sizes(map_size)
        .into_iter()
        .map(|size| {
            let level: Vec<[f32; 2]> = (0..size.y)
                .flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)))
                .map(|texel| {
                    let corners = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE];
                    corners.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], corner| {
                        let from = (2 * texel + corner).min(previous_size - 1);
                        let [a, b] = previous[(from.y * previous_size.x + from.x) as usize];
                        [low.min(a), high.max(b)]
                    })
                })
                .collect();
            (previous, previous_size) = (level.clone(), size);
            level
        })
        .collect()
}
