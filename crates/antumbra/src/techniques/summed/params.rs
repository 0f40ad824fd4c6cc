use crate::contract::param_choice;
use crate::techniques::summed::summed_area_table::Sums;

param_choice! {
    /// Number format of a summed-area table.
    pub enum TableSums {
        /// 32-bit integers that wrap: differences are exact.
        Integer = "integer",
        /// 32-bit floats.
        Float = "float",
    }
}

impl TableSums {
    pub(crate) fn sums(self) -> Sums {
        match self {
            Self::Integer => Sums::Integer,
            Self::Float => Sums::Float,
        }
    }
}

/// Maps the parameters that `vssm`, `cssm`, `evssm` and `mssm` share to settings; `subdivisions` may be given.
macro_rules! shared_settings {
    ($params:expr) => {
        $crate::techniques::summed::shared_settings!($params, subdivisions = $params.subdivisions)
    };
    ($params:expr, subdivisions = $subdivisions:expr) => {
        $crate::techniques::summed::SoftSettings {
            map_size: $params.map_size,
            bias_scale: $params.bias_scale,
            subdivisions: $subdivisions,
            search_scales: $params.search_scales,
            second_look: $params.second_look,
            bleeding_reduction: $params.bleeding_reduction,
            edge_goes_on: $params.edge_goes_on,
            is_sparse: $params.sub,
            ..$crate::techniques::summed::SoftSettings::default()
        }
    };
}
pub(crate) use shared_settings;

/// Declares the parameters of a technique with one table of a basis, and their mapping to passes.
macro_rules! table_params {
    ($(#[$outer:meta])* pub struct $name:ident: $technique:literal of $basis:ident, subdivisions = $subdivisions:literal, search_scales = $search_scales:literal,
     second_look = $second_look:literal $(; $($paper:tt)+ )?) => {
        $crate::contract::params! {
            $(#[$outer])*
            pub struct $name {
                shared map_size, more "Sharper contacts and finer occluders; memory and table time grow with the square of the size.";
                /// Number of parts along each side of a kernel.
                subdivisions: u32 = $subdivisions, in 1..=16,
                    more "Each part contains fewer depths, which the basis separates better; time grows with the square of the number.";
                /// Number of scales at which blockers are searched.
                search_scales: u32 = $search_scales, in 1..=16,
                    more "More stable penumbra widths among occluders at many depths; time grows in proportion.";
                /// Search blockers once more if their mean lies much nearer to the receiver than the nearest caster.
                second_look: bool = $second_look,
                    more "More accurate penumbrae under occluders at many depths; there, the search takes twice the time.";
                /// Number format of the summed-area table.
                table: $crate::techniques::summed::TableSums = $crate::techniques::summed::TableSums::Integer,
                    more "integer loses only the bits that sums over the largest part take; float loses those of sums over the whole map.";
                /// Visibility up to this value becomes 0; the rest is rescaled to [0, 1].
                bleeding_reduction: f32 = 0.0, in 0.0..=0.9,
                    more "Less light bleeding, but narrower penumbrae.";
                shared edge_goes_on;
                shared sub;
                shared bias_scale;
            }
            Fast { map_size: $crate::contract::MapSize::Texels(512), search_scales: 2, }
            High { map_size: $crate::contract::MapSize::Texels(2048), subdivisions: 5, search_scales: 5, }
            Best { map_size: $crate::contract::MapSize::Texels(4096), subdivisions: 8, search_scales: 8, }
            $( $($paper)+ )?
        }

        impl $crate::techniques::summed::SoftParams for $name {
            const NAME: &'static str = $technique;

            fn design(&self) -> $crate::techniques::summed::SoftDesign {
                use $crate::techniques::summed::{Basis, SoftDesign};
                SoftDesign::one_table(Basis::$basis, self.table.sums())
            }

            fn settings(&self) -> $crate::techniques::summed::SoftSettings {
                $crate::techniques::summed::shared_settings!(self)
            }
        }
    };
}
pub(crate) use table_params;
