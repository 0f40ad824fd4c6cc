use crate::contract::param_choice;
use crate::techniques::summed::summed_area_table::Sums;

param_choice! {
    /// What a summed-area table is made of.
    pub enum TableSums {
        /// 32-bit integers that wrap: exact differences.
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

/// The settings of parameters that have what all of `vssm`, `cssm`, `evssm` and `mssm` have, or all but `subdivisions`.
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

/// Declares the parameters of a technique that is one table of a basis, and what they ask of the passes.
macro_rules! table_params {
    ($(#[$outer:meta])* pub struct $name:ident: $technique:literal of $basis:ident, subdivisions = $subdivisions:literal, search_scales = $search_scales:literal,
     second_look = $second_look:literal $(; $($paper:tt)+ )?) => {
        $crate::contract::params! {
            $(#[$outer])*
            pub struct $name {
                shared map_size, more "Sharper contacts and finer occluders; memory and the table's time grow with the square.";
                /// Parts along each side of a kernel.
                subdivisions: u32 = $subdivisions, in 1..=16,
                    more "Each part holds fewer depths, which the basis tells apart better; time grows with the square.";
                /// Scales at which blockers are searched.
                search_scales: u32 = $search_scales, in 1..=16,
                    more "Steadier penumbra widths among occluders of many depths; time grows in proportion.";
                /// Search blockers once more where their mean lies much nearer the receiver than the nearest caster.
                second_look: bool = $second_look,
                    more "Truer penumbrae under occluders of many depths; there the search takes twice the time.";
                /// What the summed-area table is made of.
                table: $crate::techniques::summed::TableSums = $crate::techniques::summed::TableSums::Integer,
                    more "integer keeps as many bits as the largest part leaves; float loses what sums over the whole map take.";
                /// Visibility up to this is taken for none, and the rest is stretched.
                bleeding_reduction: f32 = 0.0, in 0.0..=0.9,
                    more "Less light bleeding, and thinner penumbrae.";
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
