use crate::contract::{ParamList, param_choice};
use crate::techniques::filterable::{DepthAxis, MomentStorage, filterable_params};

param_choice! {
    /// Where the layers of [`Lvsm`](super::Lvsm) meet.
    pub enum LayerPlacement {
        /// At equal steps of depth.
        Uniform = "uniform",
        /// At `split_depths`.
        Manual = "manual",
        /// Behind the second occluders, found each frame.
        Lloyd = "lloyd",
    }
}

param_choice! {
    /// What Lloyd's relaxation of [`Lvsm`](super::Lvsm)'s layers looks at.
    pub enum RelaxOver {
        /// The bleeding that receivers in view would see.
        View = "view",
        /// The light map's discontinuities, wherever the camera looks.
        Map = "map",
        /// The same as published: splits lie on second occluders, and μ + σ may lie beyond them.
        MapAsPrinted = "map_as_printed",
    }
}

param_choice! {
    /// Which layers of [`Lvsm`](super::Lvsm) Lloyd's relaxation merges and which it splits, where that helps.
    pub enum LvsmTeleport {
        /// Merges those whose merging adds the least inertia, splits the one that has the most.
        Inertia = "inertia",
        /// Merges those that hold nothing, splits the one with the largest weight: the paper's.
        Weight = "weight",
    }
}

param_choice! {
    /// How [`Lvsm`](super::Lvsm) blends where two layers overlap.
    pub enum LvsmTransition {
        /// From the lesser of both layers' bounds at the split to the receiver's own layer at the overlap's end.
        Lesser = "lesser",
        /// From one layer's bound to the other's, over the whole overlap: the paper's.
        Mixed = "mixed",
    }
}

param_choice! {
    /// What bounds the visibility in a layer of [`Lvsm`](super::Lvsm).
    pub enum LvsmBound {
        /// The bound of depths that lie in the layer, which is Chebyshev's or less.
        Bounded = "bounded",
        /// Chebyshev's: the paper's.
        Chebyshev = "chebyshev",
    }
}

param_choice! {
    /// The least variance that depths in a layer of [`Lvsm`](super::Lvsm) are taken to have.
    pub enum LvsmLeastVariance {
        /// That of the receiver's own plane over a texel.
        Receiver = "receiver",
        /// That of a plane at 45° to the light over a texel, everywhere: one σ²min, by equation 7 in every layer, the paper's.
        Global = "global",
    }
}

param_choice! {
    /// When the layers of [`Lvsm`](super::Lvsm) are written.
    pub enum LvsmLayersBy {
        /// After the light map, from its depths: a pass whose time does not depend on the casters.
        Depth = "depth",
        /// As casters are drawn, a target for each layer: the paper's.
        Targets = "targets",
    }
}

param_choice! {
    /// What [`Lvsm`](super::Lvsm) writes into the mask.
    pub enum LvsmShow {
        /// Visibility.
        Visibility = "visibility",
        /// The receivers' layers in colours, darker in shadow; a mask of one channel gets their luminance.
        Layers = "layers",
    }
}

filterable_params! {
    /// Parameters of [`Lvsm`](super::Lvsm).
    pub struct LvsmParams {
        /// Layers of depth.
        layers: u32 = 4, in 1..=16,
            more "Less light bleeding; memory and the blur's time grow in proportion, the lookup's does not.";
        /// How the layers are placed.
        placement: LayerPlacement = LayerPlacement::Lloyd,
            more "lloyd follows the scene; uniform spreads precision evenly; manual clears one receiver for certain.";
        /// The depths at which manual layers meet, along `depth_axis` from the light's centre (a sun: from the scene's
        /// middle).
        split_depths: ParamList = ParamList::EMPTY, unit "m",
            more "One less than `layers`, ascending; each takes away bleeding onto what lies just behind it.";
        /// Overlap of neighbouring layers, relative to the depth that a plane at 45° spans under the kernel.
        overlap: f32 = 1.0, in 0.0..=8.0,
            more "Steep receivers cross from layer to layer without a seam, and layers can lie less close.";
        /// Blend between two layers where they overlap.
        blend: bool = true,
            more "false reads one layer always, and may show where layers meet in bleeding regions.";
        /// How two layers blend where they overlap.
        transition: LvsmTransition = LvsmTransition::Lesser,
            more "mixed is the paper's, and lets in what the worse of two bounds bleeds.";
        /// What bounds the visibility in a layer.
        bound: LvsmBound = LvsmBound::Bounded,
            more "chebyshev is the paper's: layers let in a little light where occluders fill them.";
        /// The least variance that depths are taken to have.
        least_variance: LvsmLeastVariance = LvsmLeastVariance::Receiver,
            more "global is the paper's: receivers steeper than 45° shade themselves, and those that face the light bleed more.";
        /// Splits that Lloyd's relaxation moves in each frame, in turns.
        splits_per_frame: u32 = 15, in 1..=15,
            more "Follows moving scenes more quickly.";
        /// What Lloyd's relaxation looks at.
        relax_over: RelaxOver = RelaxOver::View,
            more "view spends layers where the camera sees light bleed; map does not depend on the camera; splits of \
                  map_as_printed cut the occluders that they should lie behind.";
        /// Whether texels without a caster count as occluders at the far end, where `relax_over` is not view.
        relax_background: bool = false,
            more "true spends layers on the edges of what stands before nothing.";
        /// Standard deviation below which depths under a texel's neighbourhood ask for no split, where `relax_over` is not view.
        relax_from: f32 = 0.0, in 0.0..=0.5, unit "parts of the range",
            more "Slopes and small steps of depth no longer draw splits to themselves.";
        /// Standard deviation beyond which they ask for a split no more, where `relax_over` is not view.
        relax_up_to: f32 = 0.5, in 0.001..=0.5, unit "parts of the range",
            more "The deepest steps draw splits the more.";
        /// Which layers Lloyd's relaxation merges and splits.
        teleport: LvsmTeleport = LvsmTeleport::Inertia,
            more "weight is the paper's, and stays in worse places.";
        /// How the moments are stored.
        storage: MomentStorage = MomentStorage::Unorm16,
            more "unorm16 suffices, since a layer covers little depth; float32 takes twice the memory.";
        /// When the layers are written. Of a host's depth map, after it always.
        layers_by: LvsmLayersBy = LvsmLayersBy::Depth,
            more "targets is the paper's: eight layers in a pass over the casters, which relaxed layers draw once more; needs an \
                  `msaa` of 1.";
        /// What goes into the mask.
        show: LvsmShow = LvsmShow::Visibility,
            more "layers colours each receiver by its layer, to see where the splits lie.";
    } => Paper {
        anisotropy: 16, ours "8 probes have the same error at half the reads.";
        depth_axis: DepthAxis::Distance, ours "Depth is measured along the world's axis nearest to the light's.";
        splits_per_frame: 2, ours "All splits move in every frame.";
        relax_over: RelaxOver::MapAsPrinted, ours "Splits are placed where receivers in view see light bleed.";
        teleport: LvsmTeleport::Weight, ours "Clusters merge and split by inertia.";
        layers_by: LvsmLayersBy::Targets, ours "Layers are encoded from the light map's depths.";
        transition: LvsmTransition::Mixed, ours "Where layers overlap the lesser of both bounds counts at the split.";
        least_variance: LvsmLeastVariance::Global, ours "The least variance follows from each receiver's slope.";
        bound: LvsmBound::Chebyshev, ours "A layer's bound knows that its depths end where the layer does.";
    } kept {
        "Each layer's two moments are a word of their own, where the paper has two layers to a texel: the same memory.",
        "Relaxed layers are written in a second pass over the casters, after one of depth alone, since their splits are this frame's; \
         the paper's are some frames old.",
        "The overlap follows from the kernel, since the paper names no width.",
        "σ²min is that of a plane at 45° over a texel, since the paper names none, plus the storage's own step.",
        "A histogram of 4096 bins takes the place of a mip pyramid of weighted samples: the same means.",
        "Splits glide to where they belong, a quarter of the way a frame; the first frame has converged.",
    }
}
