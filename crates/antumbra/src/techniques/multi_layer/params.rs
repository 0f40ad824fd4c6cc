use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Method by which [`MultiLayer`](super::MultiLayer) gathers fragments.
    pub enum MultiLayerGather {
        /// Two passes over the geometry: count, collect.
        Arrays = "arrays",
        /// One pass over the geometry, into linked lists, which are packed afterwards.
        Linked = "linked",
    }
}

param_choice! {
    /// Faces of closed opaque meshes that cast.
    pub enum MultiLayerFaces {
        /// Back faces, turned away from the light: they never receive.
        Back = "back",
        /// All faces: twice the fragments, and sides of solids finer than a texel cast too.
        All = "all",
    }
}

param_choice! {
    /// Hierarchy of levels of [`MultiLayer`](super::MultiLayer).
    pub enum MultiLayerHierarchy {
        /// Y-map with a level between each two kernels of the stack, which halves again once kernels are four texels wide.
        FineYMap = "fine_y_map",
        /// Y-map: halves down to `stack_size`, then keeps that size while kernels grow and overlap.
        YMap = "y_map",
        /// MIP-map: halves down to one texel.
        MipMap = "mip_map",
    }
}

param_choice! {
    /// Accumulation of opacities at one place.
    pub enum MultiLayerListAccumulation {
        /// Sum of opacities, which assumes no overlap.
        Add = "add",
        /// Product of transmittances, which assumes random overlap.
        Multiply = "multiply",
        /// Largest opacity, which assumes full overlap.
        Max = "max",
        /// Overlap of each fragment with nearer ones, computed when lists are merged.
        Overlap = "overlap",
    }
}

param_choice! {
    /// Accumulation of [`MultiLayer`](super::MultiLayer)'s levels at a receiver.
    pub enum MultiLayerLevelAccumulation {
        /// Two neighbouring levels, which see the same surfaces, mix. Such pairs are accumulated by the directions of their
        /// edges: aligned ones hide one another, opposite ones adjoin, unrelated ones overlap at random.
        Correlated = "correlated",
        /// Two neighbouring levels mix; transmittances of such pairs multiply.
        Pairs = "pairs",
        /// All opacities add.
        Add = "add",
        /// All transmittances multiply.
        Multiply = "multiply",
        /// The pair with the largest opacity counts.
        Max = "max",
    }
}

param_choice! {
    /// Number of parts of the light that [`MultiLayer`](super::MultiLayer) looks up one by one.
    pub enum MultiLayerLightParts {
        /// The whole light at once.
        One = "1",
        /// Quarters of the light.
        Four = "4",
    }
}

impl MultiLayerLightParts {
    /// Returns the number of parts.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}

param_choice! {
    /// Growth factor of ε per level.
    pub enum MultiLayerEpsilonGrowth {
        /// √2 per level.
        Sqrt2 = "sqrt2",
        /// 2 per level, like the levels' texels.
        Double = "double",
    }
}

param_choice! {
    /// Number of samples per texel of [`MultiLayer`](super::MultiLayer)'s base.
    pub enum MultiLayerSamples {
        /// One sample: a texel is covered or not.
        One = "1",
        /// Four samples: opacity is the covered fraction.
        Four = "4",
    }
}

impl MultiLayerSamples {
    /// Returns the number of samples.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}

param_choice! {
    /// Shape of [`MultiLayer`](super::MultiLayer)'s base.
    pub enum MultiLayerMapShape {
        /// The window's aspect ratio, with texels of the light's aspect ratio.
        Fitted = "fitted",
        /// A square with square texels.
        Square = "square",
    }
}

param_choice! {
    /// Weights by which [`MultiLayer`](super::MultiLayer) divides a depth between two levels.
    pub enum MultiLayerLevelWeights {
        /// Linear in the square of the filter's width: the mixture of two levels has the required variance.
        Variance = "variance",
        /// Linear in depth: the paper's hat.
        Depth = "depth",
        /// No division: the finer level counts alone, up to the coarser one's own depth.
        None = "none",
    }
}

param_choice! {
    /// Quantity that [`MultiLayer`](super::MultiLayer) weights where two levels share a depth.
    pub enum MultiLayerHat {
        /// Accumulated opacity of each level.
        Levels = "levels",
        /// Opacity of every fragment before accumulation: the paper's.
        Fragments = "fragments",
    }
}

param_choice! {
    /// Filter width for which a level of [`MultiLayer`](super::MultiLayer) is looked up.
    pub enum MultiLayerFilterWidths {
        /// Width of the box that blurs as much as the level's lookup.
        Effective = "effective",
        /// Width of the texels that its lists merge.
        Merged = "merged",
    }
}

param_choice! {
    /// Depth of a merged fragment.
    pub enum MultiLayerDepthAverage {
        /// Mean depth, weighted by opacity.
        Opacity = "opacity",
        /// Unweighted mean depth.
        Count = "count",
    }
}

param_choice! {
    /// Lookup of the four lists around a receiver.
    pub enum MultiLayerLists {
        /// As one list: fragments within ε in any of them are one surface.
        Together = "together",
        /// One by one; their results are interpolated.
        Apart = "apart",
    }
}

param_choice! {
    /// Output of [`MultiLayer`](super::MultiLayer).
    pub enum MultiLayerShow {
        /// Visibility.
        Visibility = "visibility",
        /// Levels that hide the light from each receiver in colours, mixed by the hat's weights and darker in shadow; a mask of
        /// one channel gets their luminance.
        Levels = "levels",
    }
}

params! {
    /// Parameters of [`MultiLayer`](super::MultiLayer).
    pub struct MultiLayerParams {
        /// Side of the base if it is square; otherwise the base has as many texels in the window's shape. `auto` makes a texel
        /// about half as wide as a pixel where receivers are seen.
        map_size: MapSize = MapSize::Texels(1024), in 16..=4096, unit "texels", scale Log,
            more "Sharper contacts and finer occluders; memory and filter time grow with the square of the size.";
        /// Shape of the base.
        map_shape: MultiLayerMapShape = MultiLayerMapShape::Fitted,
            more "square, the paper's, makes kernels finer in one direction and coarser in the other if the light or the \
                 window is elongated.";
        /// Number of samples per texel of the base.
        msaa: MultiLayerSamples = MultiLayerSamples::Four,
            more "4 preserves the area of occluders thinner than a texel; 1, the paper's, has fewer fragments at edges.";
        /// Maximum number of fragments in each texel's list, counted from the light; 0 keeps all.
        layers: u32 = 0, in 0..=1024, unit "fragments",
            more "Fewer occluders behind others are missed; 16 include nearly all. With faces=all a solid counts twice.";
        /// Faces of closed opaque meshes that cast.
        faces: MultiLayerFaces = MultiLayerFaces::All,
            more "back, the paper's, has half the fragments, but leaks light at grooves and contacts finer than a texel.";
        /// Depth difference within which fragments merge, in texel widths at their depth.
        epsilon: f32 = 10.0, in 0.0..=1000.0, unit "texel widths", scale Log,
            more "Shorter lists and less time; far above the default, surfaces far apart merge.";
        /// Growth factor of ε per level.
        epsilon_growth: MultiLayerEpsilonGrowth = MultiLayerEpsilonGrowth::Sqrt2,
            more "double is the paper's, with epsilon=2; sqrt2 keeps surfaces separate in coarse levels.";
        /// Joins fragments of the base within ε.
        join_base: bool = false,
            more "true shortens lists where surfaces are within ε of each other.";
        /// Number of levels, including the base, which bounds the width of penumbrae; at most what the map allows.
        levels: u32 = 11, in 1..=14,
            more "Wider penumbrae: each level doubles the maximum width; filter and lookup time grow in proportion.";
        /// Hierarchy: halving throughout, or down to a size.
        hierarchy: MultiLayerHierarchy = MultiLayerHierarchy::FineYMap,
            more "fine_y_map matches the required blur best; y_map is the paper's; mip_map shows texels in wide penumbrae.";
        /// Size at which a Y-map stops halving.
        stack_size: u32 = 128, in 8..=512, unit "texels", scale Log,
            more "Finer sampling of wide penumbrae; filter time grows with the square of the size.";
        /// Number of first filter steps that keep one of four lists instead of merging them.
        subsampled_steps: u32 = 0, in 0..=4,
            more "Less filter time for large maps; only contacts have the full resolution.";
        /// Accumulation of opacities in one list.
        list_accumulation: MultiLayerListAccumulation = MultiLayerListAccumulation::Overlap,
            more "add makes stacked occluders too dark; max leaks light where occluders do not overlap; multiply leaks light \
                 through slanted surfaces.";
        /// Accumulation of levels.
        level_accumulation: MultiLayerLevelAccumulation = MultiLayerLevelAccumulation::Correlated,
            more "add makes overlapping occluders too dark; multiply leaks light through occluders that span two levels.";
        /// Weights by which a depth is divided between the two levels whose filters it lies between.
        level_weights: MultiLayerLevelWeights = MultiLayerLevelWeights::Variance,
            more "depth, the paper's, is slightly too sharp between levels; none shows seams between levels.";
        /// Quantity that is weighted where two levels share a depth.
        hat: MultiLayerHat = MultiLayerHat::Levels,
            more "With fragments, the paper's, two opaque surfaces half-way between two levels hide 1 − (½)⁴ by \
                 multiplication; with levels they hide 1 − (½)². With fragments, correlated and pairs multiply.";
        /// Filter width for which a level is looked up.
        filter_widths: MultiLayerFilterWidths = MultiLayerFilterWidths::Effective,
            more "merged, the paper's, makes penumbrae too wide by the blur of interpolation.";
        /// Level for all lookups, 1 for the base; 0 looks each depth up in the level that matches its filter width.
        fixed_level: u32 = 0, in 0..=24,
            more "A wider blur of constant width, regardless of the light, as in the paper's figures 5 and 6.";
        /// Depth of merged fragments.
        depth_average: MultiLayerDepthAverage = MultiLayerDepthAverage::Opacity,
            more "With count, the paper's, a sliver displaces the surface it merges with.";
        /// Lookup of the four lists around a receiver.
        lists: MultiLayerLists = MultiLayerLists::Together,
            more "With apart, the paper's, lists are not compared, so a surface that is in two of them counts twice.";
        /// Whether levels omit what no receiver looks up in them.
        prune: bool = true,
            more "false, the paper's, gives the same shadow, but takes more time and memory.";
        /// Whether fragments are compared with the receiver's plane, and the light's part below it counts as hidden.
        planes: bool = true,
            more "false, the paper's, compares fragments with the receiver's depth only, so tilted receivers shadow themselves.";
        /// Number of parts of the light that are looked up one by one.
        light_parts: MultiLayerLightParts = MultiLayerLightParts::Four,
            more "4 separates occluders that hide different quarters of the light, and takes four times the lookups; 1 is the paper's.";
        /// Method that gathers fragments.
        gather: MultiLayerGather = MultiLayerGather::Arrays,
            more "linked draws the casters once instead of twice, but packs lists with scattered reads.";
        shared sub;
        /// Minimum blur at a receiver, for anti-aliasing.
        footprint: f32 = 0.0, in 0.0..=4.0, unit "pixels",
            more "Smoother edges of shadows finer than a pixel.";
        shared bias_scale;
        /// Content of the mask.
        show: MultiLayerShow = MultiLayerShow::Visibility,
            more "levels colours each receiver by the levels that hide the light from it, as in the paper's figure 14.";
    }
    Fast { map_size: MapSize::Texels(512), light_parts: MultiLayerLightParts::One, gather: MultiLayerGather::Linked, sub: true, }
    High { map_size: MapSize::Texels(2048), }
    Best { map_size: MapSize::Texels(2176), }
    => Paper {
        map_shape: MultiLayerMapShape::Square, ours "The map has the aspect ratio of its window, and its texels that of the light.";
        msaa: MultiLayerSamples::One, ours "Four samples per texel: opacity is the covered fraction of the texel.";
        faces: MultiLayerFaces::Back, ours "All faces of closed meshes cast, so that no light leaks at grooves and contacts \
             finer than a texel.";
        epsilon: 2.0, ours "10 texel widths, for shorter lists.";
        epsilon_growth: MultiLayerEpsilonGrowth::Double, ours "ε grows by √2 per level, so that surfaces stay separate in coarse levels.";
        hierarchy: MultiLayerHierarchy::YMap, ours "An additional level between each two kernels of the stack.";
        list_accumulation: MultiLayerListAccumulation::Add, ours "The overlap of lists is computed when they are merged.";
        level_accumulation: MultiLayerLevelAccumulation::Add, ours "Neighbouring levels mix; surfaces are combined by the \
             directions of their edges.";
        level_weights: MultiLayerLevelWeights::Depth, ours "The weights of levels are linear in the square of the filter's width.";
        hat: MultiLayerHat::Fragments, ours "The fragments of a level are accumulated first; then their opacity is weighted.";
        filter_widths: MultiLayerFilterWidths::Merged, ours "The width of a level includes the blur of its interpolation.";
        depth_average: MultiLayerDepthAverage::Count, ours "Depths are averaged by opacity.";
        lists: MultiLayerLists::Apart, ours "The four lists of a lookup are merged while they are read.";
        prune: false, ours "A level keeps only what receivers look up in it: the same shadow in less time.";
        planes: false, ours "Fragments are compared with the receiver's plane, and the part of the light below it is hidden.";
        light_parts: MultiLayerLightParts::One, ours "The quarters of the light are looked up separately.";
    } kept {
        "Open meshes have a bias of two thirds of a texel; the paper states none.",
    }
}
