//! What a table is made of: number format, tiles, algorithm, and the source of its values.

use crate::gpu::texels;

/// Number format of sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sums {
    /// `Rgba32Float`.
    Float,
    /// `Rgba32Uint`, wrapping.
    Integer,
}

impl Sums {
    /// Returns the format of source and table.
    pub(crate) fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Float => wgpu::TextureFormat::Rgba32Float,
            Self::Integer => wgpu::TextureFormat::Rgba32Uint,
        }
    }

    /// Converts the type of a binding that is declared for integers to this number format.
    pub(crate) fn adapt(self, ty: &mut wgpu::BindingType) {
        if self == Self::Integer {
            return;
        }
        match ty {
            wgpu::BindingType::Texture { sample_type, .. } if *sample_type == texels::UINT => {
                *sample_type = texels::FLOAT;
            }
            wgpu::BindingType::StorageTexture { format, .. } if *format == Self::Integer.format() => {
                *format = self.format();
            }
            _ => {}
        }
    }
}

/// Division of a table into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tiling {
    /// One tile for the whole table.
    Whole,
    /// Tiles with a power-of-two side, from 16 to [`MAX_TILE`](super::MAX_TILE) texels.
    Tiles,
    /// Tiles with the largest power-of-two side, from 16 to [`MAX_TILE`](super::MAX_TILE), in which every sum stays below 2³²;
    /// found on the GPU from integer values (Shen et al. 2013, section 6.1). With values below 2²⁴ a tile of 16 always fits.
    Chosen,
}

/// Algorithm that sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scan {
    /// Block scan: work is proportional to the number of texels.
    Blocks,
    /// Recursive doubling: the number of passes is proportional to the tile's logarithm.
    Doubling,
}

/// Key of a table's pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TableDesign {
    pub(crate) sums: Sums,
    pub(crate) scan: Scan,
    pub(crate) tiling: Tiling,
}

/// Source of the values.
pub(crate) enum Source<'a> {
    /// A texture of [`Sums::format`], given to `prepare`.
    Texture,
    /// Shader that encodes the values, with bind groups 0 to 2 of its own. Not for doubling.
    Encoded { wgsl: &'static str, constants: &'a [(&'a str, f64)], layouts: [&'a wgpu::BindGroupLayout; 3] },
}
