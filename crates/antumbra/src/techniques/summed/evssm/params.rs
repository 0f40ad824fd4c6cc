use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Filter of the moments.
    pub enum EvssmTable {
        /// Summed-area table of 32-bit integers that wrap: differences are exact.
        Integer = "integer",
        /// Summed-area table of 32-bit floats.
        Float = "float",
        /// Mip chain of 32-bit floats, interpolated between texels and levels.
        Mips = "mips",
    }
}

params! {
    /// Parameters of [`Evssm`](super::Evssm).
    pub struct EvssmParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and the table's time grow with the square.";
        /// Number of parts along each side of a kernel.
        subdivisions: u32 = 5, in 1..=16,
            more "Each part holds fewer depths, which the basis tells apart better; time grows with the square.";
        /// Number of scales at which blockers are searched.
        search_scales: u32 = 4, in 1..=16,
            more "Steadier penumbra widths among occluders of many depths; time grows in proportion.";
        /// Search blockers once more if their mean lies much nearer to the receiver than the nearest caster.
        second_look: bool = true,
            more "Truer penumbrae under occluders of many depths; there the search takes twice the time.";
        /// Exponent of the positive warp.
        exponent: f32 = 5.0, in 0.5..=40.0,
            more "Less light bleeding; more noise, and in foliage darkness.";
        /// Exponent of the negative warp.
        negative_exponent: f32 = 5.0, in 0.5..=40.0,
            more "Fewer wrong answers on receivers that are not planar; more noise.";
        /// Filter of the moments.
        table: EvssmTable = EvssmTable::Integer,
            more "integer keeps as many bits as the largest part leaves; float loses what sums over the whole map take; mips bear larger exponents, in squares.";
        /// Visibility up to this value becomes 0; the rest is rescaled to [0, 1].
        bleeding_reduction: f32 = 0.0, in 0.0..=0.9,
            more "Less light bleeding, and thinner penumbrae.";
        shared edge_goes_on;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), subdivisions: 3, search_scales: 2, }
    High { map_size: MapSize::Texels(2048), subdivisions: 7, search_scales: 5, }
    Best { map_size: MapSize::Texels(4096), subdivisions: 9, search_scales: 8, }
}
