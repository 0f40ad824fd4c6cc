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
        shared map_size, more "Sharper contacts and finer occluders; memory and the time of the table grow with the square of the size.";
        /// Number of parts along each side of a kernel.
        subdivisions: u32 = 5, in 1..=16,
            more "Each part contains fewer depths, which the basis separates better; time grows with the square of the number.";
        /// Number of scales at which blockers are searched.
        search_scales: u32 = 4, in 1..=16,
            more "More stable penumbra widths among occluders at many depths; time grows in proportion.";
        /// Search blockers once more if their mean lies much nearer to the receiver than the nearest caster.
        second_look: bool = true,
            more "More accurate penumbrae under occluders at many depths; there, the search takes twice the time.";
        /// Exponent of the positive warp.
        exponent: f32 = 5.0, in 0.5..=40.0,
            more "Less light bleeding, but more noise, and foliage becomes too dark.";
        /// Exponent of the negative warp.
        negative_exponent: f32 = 5.0, in 0.5..=40.0,
            more "Fewer errors on non-planar receivers, but more noise.";
        /// Filter of the moments.
        table: EvssmTable = EvssmTable::Integer,
            more "integer loses only the bits that sums over the largest part take; float loses those of sums over the whole \
                 map; mips allows larger exponents, but filters squares.";
        /// Visibility up to this value becomes 0; the rest is rescaled to [0, 1].
        bleeding_reduction: f32 = 0.0, in 0.0..=0.9,
            more "Less light bleeding, but narrower penumbrae.";
        shared edge_goes_on;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), subdivisions: 3, search_scales: 2, }
    High { map_size: MapSize::Texels(2048), subdivisions: 7, search_scales: 5, }
    Best { map_size: MapSize::Texels(4096), subdivisions: 9, search_scales: 8, }
}
