use super::DepthAxis;
use crate::contract::{MapSize, param_choice};
use crate::primitives::packed_map::{Kernel, Packing};

param_choice! {
    /// Kernel with which a filterable map is blurred.
    pub enum FilterKernel {
        /// Equal weights within a square.
        Box = "box",
        /// Gaussian with the box's standard deviation.
        Gaussian = "gaussian",
    }
}

param_choice! {
    /// Number of samples per texel of the light map.
    pub enum Multisampling {
        /// One sample.
        One = "1",
        /// Two samples; needs a native feature.
        Two = "2",
        /// Four samples.
        Four = "4",
        /// Eight samples; needs a native feature.
        Eight = "8",
    }
}

impl Multisampling {
    /// Returns the number of samples.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

param_choice! {
    /// Source of visibility.
    pub enum ResolveBy {
        /// Filtered basis of the technique.
        Basis = "basis",
        /// Comparisons of every texel under the same kernel: the slow reference that the basis approximates.
        Exact = "exact",
    }
}

param_choice! {
    /// Storage format of two moments.
    pub enum MomentStorage {
        /// 32-bit float.
        Float32 = "float32",
        /// 16-bit float.
        Float16 = "float16",
        /// 16-bit fixed point.
        Unorm16 = "unorm16",
    }
}

impl From<MomentStorage> for Packing {
    fn from(storage: MomentStorage) -> Self {
        match storage {
            MomentStorage::Float32 => Self::Float32,
            MomentStorage::Float16 => Self::Float16,
            MomentStorage::Unorm16 => Self::Unorm16,
        }
    }
}

param_choice! {
    /// Storage format of warped depths. Fixed point cannot hold exponentials.
    pub enum FloatStorage {
        /// 32-bit float.
        Float32 = "float32",
        /// 16-bit float.
        Float16 = "float16",
    }
}

impl From<FloatStorage> for Packing {
    fn from(storage: FloatStorage) -> Self {
        match storage {
            FloatStorage::Float32 => Self::Float32,
            FloatStorage::Float16 => Self::Float16,
        }
    }
}

/// Parameters that every filterable technique has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilterSettings {
    pub(crate) map_size: MapSize,
    pub(crate) msaa: Multisampling,
    pub(crate) filter: FilterKernel,
    pub(crate) kernel_size: f32,
    pub(crate) mips: bool,
    pub(crate) anisotropy: u32,
    pub(crate) resolve: ResolveBy,
    pub(crate) depth_axis: DepthAxis,
    pub(crate) bias_scale: f32,
}

impl FilterSettings {
    pub(crate) fn kernel(&self) -> Kernel {
        match self.filter {
            FilterKernel::Box => Kernel::boxed(self.kernel_size),
            FilterKernel::Gaussian => Kernel::gaussian(self.kernel_size),
        }
    }
}

/// Declares the parameters of a filterable technique: the shared ones, then its own.
macro_rules! filterable_params {
    ($(#[$outer:meta])* pub struct $name:ident { $($own:tt)* } $( => $($paper:tt)+ )?) => {
        $crate::contract::params! {
            $(#[$outer])*
            pub struct $name {
                shared map_size, more "Sharper edges and a narrower blur; memory and time grow with the square of the size.";
                /// Number of samples per texel of the shadow map, averaged after encoding.
                msaa: $crate::techniques::filterable::Multisampling =
                    $crate::techniques::filterable::Multisampling::One,
                    more "Smoother edges if the kernel is narrow; 2 and 8 need native features.";
                /// Kernel of the blur.
                filter: $crate::techniques::filterable::FilterKernel =
                    $crate::techniques::filterable::FilterKernel::Gaussian,
                    more "gaussian shows no corners of the kernel; box ends exactly at its width.";
                /// Width of the kernel; a Gaussian has the standard deviation of the box of this width.
                kernel_size: f32 = 7.0, in 1.0..=127.0, unit "texels", scale Log,
                    more "Blurs all shadow edges more, regardless of the light's size; the time of the blur grows in proportion.";
                /// Mip chain of the map, with trilinear lookups.
                mips: bool = true,
                    more "true filters distant receivers over their pixel's footprint and takes three eighths more memory.";
                /// Maximum number of probes along a pixel's footprint; needs `mips`.
                anisotropy: u32 = 8, in 1..=16,
                    more "Sharper shadows on surfaces seen at a grazing angle; 1 is plain trilinear filtering.";
                $($own)*
                /// Direction in which depth is measured.
                depth_axis: $crate::techniques::filterable::DepthAxis = $crate::techniques::filterable::DepthAxis::World,
                    more "world gives each floor a constant depth under a slanted light, which reduces light bleeding; light \
                         suits scenes that are not aligned with an axis; distance is measured along each ray, as by Lauritzen \
                         and McCool 2008, and curves the depth of floors.";
                /// Source of visibility.
                resolve: $crate::techniques::filterable::ResolveBy =
                    $crate::techniques::filterable::ResolveBy::Basis,
                    more "exact compares every texel under the kernel: slow, the reference that the technique approximates.";
                shared bias_scale;
            }
            // The blur has the same width in the world at every quality.
            Fast { map_size: $crate::contract::MapSize::Texels(512), kernel_size: 3.5, anisotropy: 4, }
            High { map_size: $crate::contract::MapSize::Texels(2048), kernel_size: 14.0, }
            Best { map_size: $crate::contract::MapSize::Texels(4096), kernel_size: 28.0, }
            $( => $($paper)+ )?
        }

        impl $name {
            pub(crate) fn settings(&self) -> $crate::techniques::filterable::FilterSettings {
                $crate::techniques::filterable::FilterSettings {
                    map_size: self.map_size,
                    msaa: self.msaa,
                    filter: self.filter,
                    kernel_size: self.kernel_size,
                    mips: self.mips,
                    anisotropy: self.anisotropy,
                    resolve: self.resolve,
                    depth_axis: self.depth_axis,
                    bias_scale: self.bias_scale,
                }
            }
        }
    };
}
pub(crate) use filterable_params;
