use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// How [`MultiLayer`](super::MultiLayer) gathers fragments.
    pub enum MultiLayerGather {
        /// Two passes over the geometry: count, collect.
        Arrays = "arrays",
        /// One pass over the geometry, into linked lists, which are packed after.
        Linked = "linked",
    }
}

param_choice! {
    /// Which faces of closed opaque meshes cast.
    pub enum MultiLayerFaces {
        /// What faces away from the light: never what receives.
        Back = "back",
        /// All: twice the fragments, and sides of solids that are finer than a texel cast too.
        All = "all",
    }
}

param_choice! {
    /// The levels of [`MultiLayer`](super::MultiLayer).
    pub enum MultiLayerHierarchy {
        /// A Y-map with a level between each two kernels of the stack, whose size halves again once kernels are four
        /// texels wide.
        FineYMap = "fine_y_map",
        /// Halves down to `stack_size`, then keeps that size while kernels grow and overlap.
        YMap = "y_map",
        /// Halves down to one texel.
        MipMap = "mip_map",
    }
}

param_choice! {
    /// How opacities at one place come together.
    pub enum MultiLayerListAccumulation {
        /// Their sum: they do not overlap.
        Add = "add",
        /// The product of transmittances: they overlap at random.
        Multiply = "multiply",
        /// The largest: they cover one another.
        Max = "max",
        /// By how much the farther one was found to lie behind the nearer when lists were merged.
        Overlap = "overlap",
    }
}

param_choice! {
    /// How [`MultiLayer`](super::MultiLayer)'s levels come together at a receiver.
    pub enum MultiLayerLevelAccumulation {
        /// Two neighbouring levels, which see the same surfaces, mix; such pairs come together by how their edges lie:
        /// aligned ones hide one another, opposite ones adjoin, unrelated ones overlap at random.
        Correlated = "correlated",
        /// Two neighbouring levels mix; transmittances of such pairs multiply.
        Pairs = "pairs",
        /// All opacities add.
        Add = "add",
        /// All transmittances multiply.
        Multiply = "multiply",
        /// The pair of the largest opacity.
        Max = "max",
    }
}

param_choice! {
    /// Parts of the light that [`MultiLayer`](super::MultiLayer) looks up one by one.
    pub enum MultiLayerLightParts {
        /// The whole light at once.
        One = "1",
        /// Its quarters.
        Four = "4",
    }
}

impl MultiLayerLightParts {
    /// The number.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}

param_choice! {
    /// How ε grows from level to level.
    pub enum MultiLayerEpsilonGrowth {
        /// By √2.
        Sqrt2 = "sqrt2",
        /// By 2, as the levels' texels do.
        Double = "double",
    }
}

param_choice! {
    /// Samples of each texel of [`MultiLayer`](super::MultiLayer)'s base.
    pub enum MultiLayerSamples {
        /// One: a texel is covered or not.
        One = "1",
        /// Four: opacity is the share that is covered.
        Four = "4",
    }
}

impl MultiLayerSamples {
    /// The number.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}

param_choice! {
    /// The shape of [`MultiLayer`](super::MultiLayer)'s base.
    pub enum MultiLayerMapShape {
        /// That of what it sees, its texels of the light's proportions.
        Fitted = "fitted",
        /// A square of squares.
        Square = "square",
    }
}

param_choice! {
    /// How [`MultiLayer`](super::MultiLayer) shares a depth between two levels.
    pub enum MultiLayerLevelWeights {
        /// Linear in the square of the filter's width: what two levels mix has the variance asked for.
        Variance = "variance",
        /// Linear in depth: the paper's hat.
        Depth = "depth",
        /// Not: the finer level has it, as far as to the coarser one's own depth.
        None = "none",
    }
}

param_choice! {
    /// What [`MultiLayer`](super::MultiLayer) weights where two levels share a depth.
    pub enum MultiLayerHat {
        /// What each level has accumulated.
        Levels = "levels",
        /// Every fragment, before it is accumulated: the paper's.
        Fragments = "fragments",
    }
}

param_choice! {
    /// What width a level of [`MultiLayer`](super::MultiLayer) is looked up for.
    pub enum MultiLayerFilterWidths {
        /// That of the box that blurs as much as the level's lookup does.
        Effective = "effective",
        /// That of the texels that its lists merge.
        Merged = "merged",
    }
}

param_choice! {
    /// Whose depth a merged fragment has.
    pub enum MultiLayerDepthAverage {
        /// The mean, weighted by opacity.
        Opacity = "opacity",
        /// The mean.
        Count = "count",
    }
}

param_choice! {
    /// How the four lists about a receiver are looked up.
    pub enum MultiLayerLists {
        /// As one: what lies within ε in any of them is one surface.
        Together = "together",
        /// Each by itself; what they say is interpolated.
        Apart = "apart",
    }
}

param_choice! {
    /// What [`MultiLayer`](super::MultiLayer) writes into the mask.
    pub enum MultiLayerShow {
        /// Visibility.
        Visibility = "visibility",
        /// The levels that hide the light from each receiver in colours, mixed by the hat's weights and darker in shadow; a mask of
        /// one channel gets their luminance.
        Levels = "levels",
    }
}

params! {
    /// Parameters of [`MultiLayer`](super::MultiLayer).
    pub struct MultiLayerParams {
        /// Texels along a side of the base where it is square; elsewhere it has as many, in the shape of what it sees. With `auto`
        /// as many as make a texel about half as wide as a pixel where receivers are seen.
        map_size: MapSize = MapSize::Texels(1024), in 16..=4096, unit "texels", scale Log,
            more "Sharper contacts and finer occluders; memory and filter time grow with the square.";
        /// The shape of the base.
        map_shape: MultiLayerMapShape = MultiLayerMapShape::Fitted,
            more "square is the paper's: finer kernels one way and coarser ones the other, where light or view are longer than wide.";
        /// Samples of each texel of the base.
        msaa: MultiLayerSamples = MultiLayerSamples::Four,
            more "4 keeps the area of what is thinner than a texel; 1 is the paper's, with fewer fragments at edges.";
        /// Fragments kept of each texel's list, from the light; 0 keeps all.
        layers: u32 = 0, in 0..=1024, unit "fragments",
            more "Fewer occluders behind occluders missed; 16 is nearly all. With faces=all a solid counts twice.";
        /// Which faces of closed opaque meshes cast.
        faces: MultiLayerFaces = MultiLayerFaces::All,
            more "back is the paper's, with half the fragments; grooves and contacts finer than a texel leak.";
        /// How near in depth fragments must be to merge, in texel widths at their depth.
        epsilon: f32 = 10.0, in 0.0..=1000.0, unit "texel widths", scale Log,
            more "Shorter lists and less time; far above the default distant surfaces merge.";
        /// How ε grows from level to level.
        epsilon_growth: MultiLayerEpsilonGrowth = MultiLayerEpsilonGrowth::Sqrt2,
            more "double is the paper's, with epsilon=2; sqrt2 keeps coarse levels' surfaces apart.";
        /// Joins fragments of the base within ε.
        join_base: bool = false,
            more "true shortens lists where surfaces lie within ε of one another.";
        /// Levels of the hierarchy, the base among them, and so the widest penumbra; at most what the map has.
        levels: u32 = 11, in 1..=14,
            more "Wider penumbrae, each level twice the one before; filter and lookup time grow in proportion.";
        /// Halving throughout, or down to a size.
        hierarchy: MultiLayerHierarchy = MultiLayerHierarchy::FineYMap,
            more "fine_y_map blurs by what is asked for, y_map is the paper's; mip_map shows texels in wide penumbrae.";
        /// Size at which a Y-map stops halving.
        stack_size: u32 = 128, in 8..=512, unit "texels", scale Log,
            more "Finer sampling of wide penumbrae; filter time grows with the square.";
        /// First filter steps that keep one of four lists instead of merging them.
        subsampled_steps: u32 = 0, in 0..=4,
            more "Less filter time for large maps, of which only contacts see the full size.";
        /// How opacities in one list come together.
        list_accumulation: MultiLayerListAccumulation = MultiLayerListAccumulation::Overlap,
            more "add over-darkens stacked occluders; max leaks where they do not cover one another; multiply leaks through slanted surfaces.";
        /// How levels come together.
        level_accumulation: MultiLayerLevelAccumulation = MultiLayerLevelAccumulation::Correlated,
            more "add over-darkens overlapping occluders; multiply breaks occluders apart between levels.";
        /// How a depth is shared between the two levels whose filters it lies between.
        level_weights: MultiLayerLevelWeights = MultiLayerLevelWeights::Variance,
            more "depth is the paper's, a little too sharp between levels; none shows where levels meet.";
        /// What is weighted where two levels share a depth.
        hat: MultiLayerHat = MultiLayerHat::Levels,
            more "fragments is the paper's: two opaque surfaces half-way between two levels hide 1 − (½)⁴ by multiplication, where levels \
                  hides 1 − (½)². Levels that mix (correlated, pairs) multiply then.";
        /// The width that a level is looked up for.
        filter_widths: MultiLayerFilterWidths = MultiLayerFilterWidths::Effective,
            more "merged is the paper's: penumbrae come out too wide, by as much as interpolation blurs.";
        /// A level that everything is looked up in, 1 being the base; 0 looks each depth up in the level whose filter it
        /// asks for.
        fixed_level: u32 = 0, in 0..=24,
            more "A wider blur of one width, whatever the light: the paper's figures 5 and 6.";
        /// The depth of merged fragments.
        depth_average: MultiLayerDepthAverage = MultiLayerDepthAverage::Opacity,
            more "count is the paper's: a sliver pulls a surface from its place.";
        /// How the four lists about a receiver are looked up.
        lists: MultiLayerLists = MultiLayerLists::Together,
            more "apart is the paper's: what two lists hold is not compared, so a surface that lies in both counts as two.";
        /// Leave out of every level what no receiver looks up in it.
        prune: bool = true,
            more "false is the paper's: the same shadow, in the time and memory that epsilon and levels ask for.";
        /// Whether fragments are compared with the receiver's plane, and the light's part below it counts as hidden.
        planes: bool = true,
            more "false is the paper's: fragments are compared with the receiver's depth, and tilted receivers shade themselves.";
        /// Parts of the light looked up one by one.
        light_parts: MultiLayerLightParts = MultiLayerLightParts::Four,
            more "4 keeps apart what hides different quarters of the light, in four times the lookups; 1 is the paper's.";
        /// How fragments are gathered.
        gather: MultiLayerGather = MultiLayerGather::Arrays,
            more "linked draws the casters once instead of twice, and packs lists with scattered reads.";
        shared sub;
        /// Least blur at a receiver, for anti-aliasing.
        footprint: f32 = 0.0, in 0.0..=4.0, unit "pixels",
            more "Smoother shadow edges that are finer than pixels.";
        shared bias_scale;
        /// What goes into the mask.
        show: MultiLayerShow = MultiLayerShow::Visibility,
            more "levels colours each receiver by the levels that hide the light from it, as the paper's figure 14.";
    }
    Fast { map_size: MapSize::Texels(512), light_parts: MultiLayerLightParts::One, gather: MultiLayerGather::Linked, sub: true, }
    High { map_size: MapSize::Texels(2048), }
    Best { map_size: MapSize::Texels(2176), }
    => Paper {
        map_shape: MultiLayerMapShape::Square, ours "The map has the sides of what it sees, and its texels the light's proportions.";
        msaa: MultiLayerSamples::One, ours "Four samples a texel: opacity is the share of the texel that is covered.";
        faces: MultiLayerFaces::Back, ours "All faces of closed meshes, so that grooves and contacts finer than a texel do not leak.";
        epsilon: 2.0, ours "10 texel widths, for shorter lists.";
        epsilon_growth: MultiLayerEpsilonGrowth::Double, ours "ε grows by √2 a level, so that coarse levels keep surfaces apart.";
        hierarchy: MultiLayerHierarchy::YMap, ours "A level between each two kernels of the stack.";
        list_accumulation: MultiLayerListAccumulation::Add, ours "What lists have in common is found as they are merged.";
        level_accumulation: MultiLayerLevelAccumulation::Add, ours "Neighbouring levels mix; surfaces come together by how their edges lie.";
        level_weights: MultiLayerLevelWeights::Depth, ours "Levels mix linearly in the square of the filter's width.";
        hat: MultiLayerHat::Fragments, ours "A level's fragments are accumulated first, and what they hide is weighted.";
        filter_widths: MultiLayerFilterWidths::Merged, ours "A level's width counts what its interpolation blurs.";
        depth_average: MultiLayerDepthAverage::Count, ours "Depths are averaged by opacity.";
        lists: MultiLayerLists::Apart, ours "The four lists of a lookup are merged as they are walked.";
        prune: false, ours "A level keeps what receivers look up in it, and no more: the same shadow in less time.";
        planes: false, ours "Fragments are held against the receiver's plane, and the light below it is hidden.";
        light_parts: MultiLayerLightParts::One, ours "The light's quarters are looked up one by one.";
    } kept {
        "Open meshes have a bias of two thirds of a texel; the paper names none.",
    }
}
