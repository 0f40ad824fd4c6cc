use crate::blocks::summed_area_table::Sums;
use crate::contract::param_choice;

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
