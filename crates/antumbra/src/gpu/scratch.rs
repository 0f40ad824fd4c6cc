//! Uses of scratch resources, which one light's commands fill and read before another's do. Lights share one per use and size.

use glam::UVec2;

/// Use of a scratch resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scratch {
    /// 32-bit mask from which a host's mask of another format is drawn.
    WideMask,
    /// Mask before it is denoised.
    NoisyMask,
    /// Visibility before spatial noise reduction.
    NoisyVisibility,
    /// Depth of receivers at half resolution.
    HalfDepth,
    /// Normals of receivers at half resolution.
    HalfNormals,
    /// Mask at half resolution.
    HalfMask,
    /// Mask of one part of a light (cube face, ring or cascade).
    PartMask,
    /// Depth of the receivers of one part of a light.
    PartDepth,
    /// Normals of the receivers of one part of a light.
    PartNormals,
    /// Positions of points.
    PointPositions,
    /// Normals of points.
    PointNormals,
    /// Mask of points.
    PointMask,
    /// Light map of depths.
    LightMap,
    /// Layers of casters behind a light map.
    LayersBehind,
    /// Pyramid of a light map.
    DepthPyramid,
    /// Map after the first of two blur passes.
    BlurredRows,
    /// Cursors of lists per texel.
    ListCursors,
    /// Fragments of lists per texel.
    ListFragments,
    /// Lists per texel.
    Lists,
    /// Counters of lists per texel.
    ListCounters,
    /// Linked fragments of lists per texel.
    LinkedFragments,
    /// Links between the linked fragments.
    Links,
    /// Nearest depths of squares of texels with lists.
    NearestSquares,
    /// Depth layers of several views.
    DepthLayers,
    /// Gradients of depth layers.
    LayerGradients,
    /// Depths of triangle maps.
    TriangleDepths,
    /// Triangle indices of triangle maps.
    TriangleIds,
    /// Maps of a light's points, as words in a buffer.
    ReprojectedMaps,
    /// Maps of a light's points, as textures.
    FilterableMaps,
    /// Texel positions of surfels, packed.
    SurfelNames,
    /// Planes of tiles of a depth basis.
    TilePlanes,
    /// Depth basis from which summed-area tables or mip levels are computed.
    DepthBasis,
    /// Summed-area table of a part of a depth basis.
    SummedTable(u8),
    /// Texture that recursive doubling alternates with its table.
    DoubledTable,
    /// Sums along one of three borders of a table's blocks.
    TableBorders(u8),
    /// Largest sums of a table's tiles.
    LargestSums,
    /// Indirect dispatch arguments of the late steps of recursive doubling.
    LateDoubling,
    /// Pixels that cannot be interpolated.
    MissingPixels,
    /// Indirect dispatch arguments for the missing pixels.
    MissingDispatch,
    /// Depth attachment without content.
    NoDepth,
}

/// Key of a scratch texture; lights with equal keys share it.
#[derive(Debug, PartialEq)]
pub(super) struct ScratchTextureKey {
    scratch: Scratch,
    size: wgpu::Extent3d,
    mip_level_count: u32,
    sample_count: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
}

impl ScratchTextureKey {
    pub(super) fn new(scratch: Scratch, descriptor: &wgpu::TextureDescriptor<'_>) -> Self {
        Self {
            scratch,
            size: descriptor.size,
            mip_level_count: descriptor.mip_level_count,
            sample_count: descriptor.sample_count,
            format: descriptor.format,
            usage: descriptor.usage,
        }
    }
}

/// Descriptor of a texture with `layers` layers that one pass writes as storage and another reads.
pub(crate) fn passed_texture(
    label: &'static str,
    format: wgpu::TextureFormat,
    size_px: UVec2,
    layers: u32,
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    }
}

#[cfg(test)]
mod tests {
    use super::Scratch;
    use crate::testing::gpu;

    #[test]
    fn textures_are_shared_by_use_and_description() {
        let Some(gpu) = gpu() else { return };
        let texture = |scratch, mip_level_count, format| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some("test scratch"),
                size: wgpu::Extent3d { width: 4, height: 4, depth_or_array_layers: 1 },
                mip_level_count,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            gpu.device.scratch_texture(scratch, &descriptor)
        };
        let float = wgpu::TextureFormat::R32Float;
        let first = texture(Scratch::DepthBasis, 1, float);
        assert_eq!(first, texture(Scratch::DepthBasis, 1, float));
        for other in [
            texture(Scratch::DepthBasis, 3, float),
            texture(Scratch::DepthBasis, 1, wgpu::TextureFormat::R32Uint),
            texture(Scratch::SummedTable(0), 1, float),
        ] {
            assert_ne!(first, other);
        }
    }
}
