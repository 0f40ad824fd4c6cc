use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Kernel of [`Pcf`](super::Pcf).
    pub enum PcfKernel {
        /// Every texel of a square, weighted by its overlap: exact.
        Box = "box",
        /// Best-candidate points in a disc.
        Poisson = "poisson",
        /// Vogel's spiral in a disc.
        Vogel = "vogel",
    }
}

params! {
    /// Parameters of [`Pcf`](super::Pcf).
    pub struct PcfParams {
        shared map_size, more "Finer edges and a narrower blur; memory and fill cost grow with the square of the size.";
        /// Shape and samples of the kernel.
        kernel: PcfKernel = PcfKernel::Box,
            more "box is exact and takes time in proportion to its area; poisson and vogel in proportion to `samples`, whatever the width.";
        /// Width of the kernel.
        kernel_size: f32 = 3.0, in 1.0..=127.0, unit "texels", scale Log,
            more "Blurs all shadow edges more, regardless of the light's size.";
        /// Number of samples of the poisson and vogel kernels.
        samples: u32 = 32, in 1..=1024, scale Log,
            more "Less banding or noise; time grows in proportion.";
        /// Rotation of the poisson and vogel kernels by a random angle per pixel.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        /// Narrower kernel where the blocker is near the receiver.
        attach_contacts: bool = true,
            more "false, as published, blurs contacts as much as all other edges.";
        shared seed;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), kernel_size: 2.0, }
    High { map_size: MapSize::Texels(2048), kernel_size: 6.0, }
    Best { map_size: MapSize::Texels(4096), kernel_size: 12.0, }
}
