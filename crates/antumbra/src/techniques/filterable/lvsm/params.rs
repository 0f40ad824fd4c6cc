use crate::contract::{ParamList, param_choice};
use crate::techniques::filterable::{DepthAxis, MomentStorage, filterable_params};

param_choice! {
    /// Placement of the splits between the layers of [`Lvsm`](super::Lvsm).
    pub enum LayerPlacement {
        /// Equal steps of depth.
        Uniform = "uniform",
        /// Splits at `split_depths`.
        Manual = "manual",
        /// Splits behind the second occluders, found each frame.
        Lloyd = "lloyd",
    }
}

param_choice! {
    /// Source of the histogram for Lloyd's relaxation of [`Lvsm`](super::Lvsm)'s layers.
    pub enum RelaxOver {
        /// Bleeding that receivers in view would see.
        View = "view",
        /// Discontinuities of the light map, independent of the camera.
        Map = "map",
        /// Discontinuities as published: splits lie on second occluders, and μ + σ may lie beyond them.
        MapAsPublished = "map_as_published",
    }
}

param_choice! {
    /// Rule by which Lloyd's relaxation merges and splits layers of [`Lvsm`](super::Lvsm).
    pub enum LvsmTeleport {
        /// Merge the layers whose merging adds the least inertia, split the one that has the most.
        Inertia = "inertia",
        /// Merge layers that hold nothing, split the one with the largest weight: the paper's rule.
        Weight = "weight",
    }
}

param_choice! {
    /// Blend of two overlapping layers of [`Lvsm`](super::Lvsm).
    pub enum LvsmTransition {
        /// From the smaller of both bounds at the split to the receiver's own layer at the overlap's end.
        Lesser = "lesser",
        /// From one layer's bound to the other's, over the whole overlap: the paper's rule.
        Mixed = "mixed",
    }
}

param_choice! {
    /// Bound on visibility in a layer of [`Lvsm`](super::Lvsm).
    pub enum LvsmBound {
        /// Bound of depths that lie in the layer: at most Chebyshev's.
        Bounded = "bounded",
        /// Chebyshev's bound: the paper's.
        Chebyshev = "chebyshev",
    }
}

param_choice! {
    /// Least variance assumed for depths in a layer of [`Lvsm`](super::Lvsm).
    pub enum LvsmLeastVariance {
        /// Variance of the receiver's own plane over a texel.
        Receiver = "receiver",
        /// Variance of a plane at 45° to the light over a texel: the paper's one σ²min, scaled to layers by equation 7.
        Global = "global",
    }
}

param_choice! {
    /// Time at which the layers of [`Lvsm`](super::Lvsm) are written.
    pub enum LvsmLayersBy {
        /// After the light map, from its depths: a pass whose time does not depend on the casters.
        Depth = "depth",
        /// While casters are drawn, one target per layer: the paper's method.
        Targets = "targets",
    }
}

param_choice! {
    /// Output of [`Lvsm`](super::Lvsm).
    pub enum LvsmShow {
        /// Visibility.
        Visibility = "visibility",
        /// Layers of the receivers in colours, darker in shadow; a mask of one channel gets their luminance.
        Layers = "layers",
    }
}

filterable_params! {
    /// Parameters of [`Lvsm`](super::Lvsm).
    pub struct LvsmParams {
        /// Number of depth layers.
        layers: u32 = 4, in 1..=16,
            more "Less light bleeding; memory and the time of the blur grow in proportion, the time of the lookup does not.";
        /// Placement of the layers.
        placement: LayerPlacement = LayerPlacement::Lloyd,
            more "lloyd adapts to the scene; uniform distributes precision evenly; manual reliably removes bleeding on one receiver.";
        /// Depths at which manual layers meet, along `depth_axis` from the light's centre (for a sun, from the middle of the
        /// scene).
        split_depths: ParamList = ParamList::EMPTY, unit "m",
            more "One value fewer than `layers`, ascending; each split removes bleeding onto surfaces just behind it.";
        /// Overlap of neighbouring layers, relative to the depth that a plane at 45° spans under the kernel.
        overlap: f32 = 1.0, in 0.0..=8.0,
            more "No seams between layers on steep receivers, but layers can be less close to each other.";
        /// Whether two layers are blended where they overlap.
        blend: bool = true,
            more "false always reads one layer, and may show seams between layers where light bleeds.";
        /// Blend of two overlapping layers.
        transition: LvsmTransition = LvsmTransition::Lesser,
            more "mixed, the paper's, lets in the light that the worse of the two bounds bleeds.";
        /// Bound on visibility in a layer.
        bound: LvsmBound = LvsmBound::Bounded,
            more "chebyshev, the paper's, lets in a little light where occluders fill a layer.";
        /// Least variance assumed for depths.
        least_variance: LvsmLeastVariance = LvsmLeastVariance::Receiver,
            more "global, the paper's, darkens receivers steeper than 45° and bleeds more light onto receivers that face the light.";
        /// Number of splits that Lloyd's relaxation moves in each frame, in turns.
        splits_per_frame: u32 = 15, in 1..=15,
            more "Splits follow moving scenes more quickly.";
        /// Source of the histogram for Lloyd's relaxation.
        relax_over: RelaxOver = RelaxOver::View,
            more "view places layers where the camera sees light bleeding; map does not depend on the camera; map_as_published \
                 places splits on the occluders instead of behind them.";
        /// Whether texels without a caster count as occluders at the far end, unless `relax_over` is view.
        relax_background: bool = false,
            more "true spends layers on the edges of occluders in front of empty background.";
        /// Standard deviation of depth over neighbouring texels below which they ask for no split, unless `relax_over` is view.
        relax_from: f32 = 0.0, in 0.0..=0.5, unit "fractions of the range",
            more "Slopes and small steps in depth no longer attract splits.";
        /// Standard deviation beyond which their weight no longer grows, unless `relax_over` is view.
        relax_up_to: f32 = 0.5, in 0.001..=0.5, unit "fractions of the range",
            more "The largest steps in depth attract splits more strongly.";
        /// Rule by which Lloyd's relaxation merges and splits layers.
        teleport: LvsmTeleport = LvsmTeleport::Inertia,
            more "weight, the paper's, converges to worse splits.";
        /// Storage format of the moments.
        storage: MomentStorage = MomentStorage::Unorm16,
            more "unorm16 suffices because a layer covers a small depth range; float32 takes twice the memory.";
        /// Time at which the layers are written. With a host's depth map they are always written after it.
        layers_by: LvsmLayersBy = LvsmLayersBy::Depth,
            more "targets, the paper's, writes up to eight layers in one pass over the casters, and needs one more pass if \
                 layers are relaxed; requires an `msaa` of 1.";
        /// Content of the mask.
        show: LvsmShow = LvsmShow::Visibility,
            more "layers colours each receiver by its layer, which shows the splits.";
    } => Paper {
        anisotropy: 16, ours "8 probes have the same error with half the reads.";
        depth_axis: DepthAxis::Distance, ours "Depth is measured along the world axis closest to the light's axis.";
        splits_per_frame: 2, ours "All splits move in every frame.";
        relax_over: RelaxOver::MapAsPublished, ours "Splits are placed where light bleeds onto receivers in view.";
        teleport: LvsmTeleport::Weight, ours "Clusters merge and split by inertia.";
        layers_by: LvsmLayersBy::Targets, ours "Layers are encoded from the depths of the shadow map.";
        transition: LvsmTransition::Mixed, ours "Where layers overlap, the smaller of both bounds is used at the split.";
        least_variance: LvsmLeastVariance::Global, ours "The least variance follows from each receiver's slope.";
        bound: LvsmBound::Chebyshev, ours "The bound in a layer takes into account that its depths end where the layer ends.";
    } kept {
        "The two moments of each layer are one word; the paper stores two layers in a texel, which takes the same memory.",
        "Relaxed layers are written in a second pass over the casters, after a depth-only pass, because their splits belong to \
         the current frame; the paper's are some frames old.",
        "The overlap is derived from the kernel; the paper states no width.",
        "σ²min is that of a plane at 45° over a texel plus the quantisation of the storage; the paper states none.",
        "A histogram of 4096 bins replaces a mip pyramid of weighted samples: the means are the same.",
        "Splits move a quarter of the way to their target in each frame; in the first frame they start converged.",
    }
}
