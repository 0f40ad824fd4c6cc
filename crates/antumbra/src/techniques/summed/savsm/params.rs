use crate::contract::{MapSize, params};
use crate::techniques::summed::TableSums;

params! {
    /// Parameters of [`Savsm`](super::Savsm).
    pub struct SavsmParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and the time of the table grow with the square of the size.";
        /// Number of taps of the blocker search.
        search_samples: u32 = 64, in 1..=4096, scale Log,
            more "Fewer thin occluders are missed; time grows in proportion.";
        /// Number of scales at which blockers are searched.
        search_scales: u32 = 4, in 1..=16,
            more "More stable penumbra widths among occluders at many depths; time grows in proportion.";
        /// Search blockers once more if their mean lies much nearer to the receiver than the nearest caster.
        second_look: bool = true,
            more "More accurate penumbrae under occluders at many depths; there, the search takes twice the time.";
        /// Number format of the summed-area table.
        table: TableSums = TableSums::Integer,
            more "integer loses only the bits that sums over the largest part take; float loses those of sums over the whole map.";
        /// Visibility up to this value becomes 0; the rest is rescaled to [0, 1].
        bleeding_reduction: f32 = 0.0, in 0.0..=0.9,
            more "Less light bleeding, but narrower penumbrae.";
        shared edge_goes_on;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), search_samples: 16, }
    High { map_size: MapSize::Texels(2048), search_samples: 128, }
    Best { map_size: MapSize::Texels(4096), search_samples: 512, search_scales: 8, }
}
