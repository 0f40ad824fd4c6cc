//! Size of tiles and bits of their values, from the widest piece of a kernel that light and casters allow.

use super::{Basis, SoftDesign, SoftSettings};
use crate::gpu::shared_constants;
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::PreparedMap;
use crate::techniques::summed::summed_area_table::{BLOCK, MAX_TILE, Sums, Tiling};

shared_constants! {
    /// Factor by which the search extends beyond the light's rim.
    pub(super) const RIM: f32 = 1.25, as in SUMMED_RESOLVE;
}

/// Smallest tile with a plane of its own, texels: smaller ones would cut most pieces.
pub(super) const MIN_TILE: u32 = 32;

/// Minimum number of tiles along a side of a map, so that enough workgroups sum them.
const MIN_TILES: u32 = 8;

/// Minimum bits of a value in a table over the whole map, for kernels that are cut: a kernel too wide for them gets more
/// pieces. With two bits fewer the error of `evssm` is half as large again on `builtin:hall`.
const MIN_BITS: u32 = 16;

/// Largest value for which a tile of [`BLOCK`]² texels sums to less than 2³².
const MAX_OF_A_TILE: u32 = u32::MAX / (BLOCK * BLOCK);

/// Parameters of a frame's tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TableFit {
    /// Side of the tiles of [`Tiling::Tiles`], texels; 0 for other tilings.
    pub(super) tile_side: u32,
    /// Log2 of the tile side, as in `SoftUniform`.
    pub(super) tile_log2: u32,
    /// Stored value that represents 1.
    pub(super) value_scale: f32,
    /// Exponent, in the units that the basis takes.
    pub(super) exponent: f32,
    /// Maximum number of texels of a piece whose sum fits.
    pub(super) max_part_texels: f32,
}

impl TableFit {
    pub(super) fn of(design: SoftDesign, settings: &SoftSettings, light: &LightSpread, map: &PreparedMap) -> Self {
        let part_texels = widest_part_texels(settings, light, map);
        let tiling = design.tiling();
        let tile_side = match tiling {
            Tiling::Tiles => {
                let most = (map.size_px.min_element() / MIN_TILES).max(1).next_power_of_two();
                (part_texels as u32).next_power_of_two().min(most).clamp(MIN_TILE, MAX_TILE)
            }
            Tiling::Whole | Tiling::Chosen => 0,
        };
        let (tile_log2, summed_log2) = match tiling {
            Tiling::Tiles => (tile_side.ilog2(), 2 * tile_side.ilog2()),
            // Shifts by 31 would reach the sign bit.
            Tiling::Whole => (30, (part_texels * part_texels).log2().ceil() as u32),
            Tiling::Chosen => (0, (part_texels * part_texels).log2().ceil() as u32),
        };
        let is_cut = matches!(tiling, Tiling::Whole) && settings.subdivisions > 1;
        let min_bits = if is_cut { MIN_BITS } else { 8 };
        let bits = settings.value_bits.unwrap_or(32u32.saturating_sub(summed_log2).max(min_bits)).clamp(8, 24);
        let is_float = design.sums() == Sums::Float;
        // As published, 1 is stored as 2^μ. A piece of nothing but ones must still fit when sums wrap, and the smallest tile of
        // nothing but ones must sum to less than 2³².
        let value_scale = match (is_float, settings.value_bits) {
            (true, _) => 1.0,
            (false, Some(_)) => (1u32 << bits).min(MAX_OF_A_TILE) as f32,
            (false, None) => ((1u32 << bits) - 1) as f32,
        };
        let is_per_texel = design.basis == Basis::Tiles;
        let exponent = if is_per_texel { settings.exponent / map.view.texel_in_plane } else { settings.exponent };
        // Wrapped sums are unambiguous up to this; tiles and floats do not wrap.
        let max_part_texels = match (is_float, tiling) {
            (false, Tiling::Whole) => (1u64 << (32 - bits)) as f32,
            _ => f32::MAX,
        };
        Self { tile_side, tile_log2, value_scale, exponent, max_part_texels }
    }
}

/// Returns the side of the widest piece, texels: of the light's shape at the nearest depth, as the farthest receiver sees it.
fn widest_part_texels(settings: &SoftSettings, light: &LightSpread, map: &PreparedMap) -> f32 {
    let view = &map.view;
    let g =
        if view.perspective == 1 { 1.0 / view.near_m.max(1e-6) - 1.0 / view.far_m } else { view.far_m - view.near_m };
    let reach = light.extent.max_element() + light.extent_axis;
    let map_texels = map.size_px.max_element() as f32;
    let kernel_texels = (2.0 * RIM * reach * g / view.texel_in_plane).min(map_texels).max(1.0);
    kernel_texels / settings.subdivisions as f32 + 2.0
}
