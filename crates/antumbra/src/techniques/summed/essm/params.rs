use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Storage of the exponentials' sums.
    pub enum EssmTable {
        /// Integer tables on a grid of tiles, each with a plane of its own and as many bits as its size allows.
        Tiles = "tiles",
        /// Integer tables of `precision_bits` over one depth range, on a grid that keeps sums below 2³²: the paper's.
        TileGrid = "tile_grid",
        /// One table of 32-bit floats over one depth range.
        Float = "float",
    }
}

param_choice! {
    /// Algorithm that computes the tables.
    pub enum EssmScan {
        /// Block scan: work is proportional to the number of texels.
        Blocks = "blocks",
        /// Recursive doubling, the paper's: the number of passes is proportional to the tile's logarithm.
        Doubling = "doubling",
    }
}

param_choice! {
    /// Shape of the filter kernel.
    pub enum EssmKernel {
        /// The light's shape with the pixel's footprint: a parallelogram for a rectangle, an ellipse for all others.
        Light = "light",
        /// An ellipse with the pixel's footprint for every light: the paper's.
        Ellipse = "ellipse",
        /// The light's shape without the footprint.
        Isotropic = "isotropic",
    }
}

param_choice! {
    /// Window of the light map.
    pub enum EssmWindow {
        /// Square around casters and receivers, warped towards the camera's view if that makes the texels there half as wide.
        Seen = "seen",
        /// Square around casters and receivers, always.
        Square = "square",
    }
}

param_choice! {
    /// Blocker search of [`Essm`](super::Essm).
    pub enum EssmSearch {
        /// Windows of several scales; counts blockers that hide a point of the light.
        Scales = "scales",
        /// One window, as wide as the light appears at the nearest blocker's depth; counts all that is in it: the paper's.
        Window = "window",
    }
}

param_choice! {
    /// Cuts of a kernel's rows by [`Essm`](super::Essm).
    pub enum EssmCuts {
        /// `subdivisions` columns per row; the ends of rows stay whole.
        Columns = "columns",
        /// `subdivisions` × `subdivisions` parts per row, and for its ends too: the paper's.
        Squares = "squares",
    }
}

param_choice! {
    /// Source of the depth range of `tile_grid` and `float`.
    pub enum EssmRange {
        /// Smallest and largest depth in the map.
        Map = "map",
        /// Bounding box of the casters.
        Box = "box",
    }
}

param_choice! {
    /// Quantity that [`Essm`](super::Essm) averages over blockers.
    pub enum EssmBlockerMean {
        /// Penumbra width that each blocker implies.
        Width = "width",
        /// Depth of each blocker: the paper's.
        Depth = "depth",
    }
}

params! {
    /// Parameters of [`Essm`](super::Essm).
    pub struct EssmParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and the table's time grow with the square.";
        /// Window of the light map, unless the host renders it.
        window: EssmWindow = EssmWindow::Seen,
            more "seen spends texels where the camera looks, be that near or far; square keeps them still when it moves.";
        /// Number of parts along each side of a kernel.
        subdivisions: u32 = 5, in 1..=16,
            more "Fewer wrong answers where a part holds near and far occluders; time grows with the square.";
        /// Number of scales at which blockers are searched.
        search_scales: u32 = 4, in 1..=16,
            more "Steadier penumbra widths among occluders of many depths; time grows in proportion.";
        /// Search blockers once more if their mean lies much nearer to the receiver than the nearest caster, and evaluate
        /// blockers at their own depth if that hides another part of the light than the mean.
        second_look: bool = true,
            more "Truer penumbrae under occluders of many depths; there search and kernel take up to twice the time.";
        /// Blocker search; `search_scales` and `second_look` apply only to scales.
        search: EssmSearch = EssmSearch::Scales,
            more "window is the paper's; behind lattices what it holds that hides no part of the light widens penumbrae.";
        /// Quantity that is averaged over blockers. Under a sun both are the same.
        blocker_mean: EssmBlockerMean = EssmBlockerMean::Width,
            more "depth is the paper's: penumbrae are narrower where blockers of several depths meet under a near light.";
        /// Whether the light's part below the receiver's own plane counts as hidden.
        horizon: bool = true,
            more "false is the paper's: receivers that the light grazes are as bright as those that face it.";
        shared edge_goes_on;
        /// Cuts of a kernel's rows.
        cuts: EssmCuts = EssmCuts::Columns,
            more "squares is the paper's: as many times more parts as there are rows in a kernel's height for each part.";
        /// Storage of the exponentials' sums.
        table: EssmTable = EssmTable::Tiles,
            more "tiles holds at any depth; tile_grid is the paper's and darkens lit ground in deep scenes; float is noisy.";
        /// Algorithm that computes the tables.
        scan: EssmScan = EssmScan::Blocks,
            more "doubling is the paper's, kept to be measured against: slower, and twice the memory and more.";
        /// Exponent: per texel width for tiles, over the depth range for the others. 0 is automatic: 0.1 and 80.
        exponent: f32 = 0.0, in 0.0..=88.0,
            more "Darker contacts; above what the bits hold, more parts are read from the map, or turn dark.";
        /// Number of bits of each value of tile_grid.
        precision_bits: u32 = 20, in 8..=24, unit "bits",
            more "Finer values; smaller tiles, and more of them under each kernel.";
        /// Source of the depth range of tile_grid and float.
        range: EssmRange = EssmRange::Map,
            more "map is narrower, and needs a pyramid of the map, which the search needs in any case.";
        /// Excess over 1 of a part's exponential visibility from which it counts as non-planar.
        epsilon: f32 = 0.05, in 0.0..=10.0,
            more "Fewer parts are read from the map; what lies beyond the receiver hides more of what blocks.";
        /// Largest width of parts that are read from the map, if that takes fewer reads than the table.
        direct_texels: f32 = 3.0, in 0.0..=64.0, unit "texels",
            more "Truer contacts; 2 × 2 comparisons miss what is finer than a quarter of this.";
        /// Shape of the filter kernel.
        kernel: EssmKernel = EssmKernel::Light,
            more "ellipse is the paper's; isotropic leaves fine shadows far away to alias.";
        /// Whether the pixel's footprint ends where a neighbouring pixel shows another surface.
        footprint_ends: bool = true,
            more "false is the paper's: at edges of the picture's surfaces shadows are a little softer.";
        /// Height of an ellipse's rows, for `cuts = squares` only: with columns, ellipses of any size have as many rows.
        row_height: f32 = 5.0, in 1.0..=64.0, unit "texels", scale Log,
            more "Fewer lookups, coarser outline.";
        /// Number of refinements of the ends of an ellipse's rows: the paper's Level0, Level1, Level2.
        level: u32 = 0, in 0..=3,
            more "A smoother outline; lookups at each row's ends double.";
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), subdivisions: 3, search_scales: 2, }
    High { map_size: MapSize::Texels(2048), subdivisions: 7, search_scales: 5, }
    Best { map_size: MapSize::Texels(4096), subdivisions: 9, search_scales: 8, }
    => Paper {
        window: EssmWindow::Square, ours "The map's window is warped to what the camera sees.";
        subdivisions: 3, ours "5 × 5 parts.";
        table: EssmTable::TileGrid, ours "Every tile has a plane of its own, before which its exponentials are taken.";
        scan: EssmScan::Doubling, ours "Tables take one pass over the map.";
        exponent: CONSISTENT_EXPONENT, ours "0.1 a texel's width; the published 80 does not go with the published 20 bits (see below).";
        kernel: EssmKernel::Ellipse, ours "A rectangle's kernel is a parallelogram.";
        search: EssmSearch::Window, ours "Blockers are searched at four scales, and count where they hide a point of the light.";
        blocker_mean: EssmBlockerMean::Depth, ours "The mean is of g = 1 / z − 1 / z_receiver, which a penumbra's width is proportional to.";
        horizon: false, ours "The light's part below the receiver's plane is hidden.";
        edge_goes_on: false, ours "What the map shows at its edge goes on beyond it, for blockers nearer to the light than the map holds.";
        footprint_ends: false, ours "The pixel's footprint is narrower where a neighbour shows another surface.";
        cuts: EssmCuts::Squares, ours "A row has n columns, where the paper's rectangles have n × n parts, and an ellipse n rows, where the paper's become more.";
        direct_texels: 0.0, ours "Kernels of parts up to 3 texels wide are read from the map.";
    } kept {
        "Parts are compared with the receiver's plane at their own middle, and divided by what the plane itself gives there; the \
         paper compares with one depth.",
        "The search window is that at the nearest caster's depth, found in a pyramid; the paper intersects with the map's plane.",
        "The bias is derived; the paper names none.",
        "R, what a float's exponent holds, here 80, and μ = 20 contradict one another: e^{c(z − 1)} is less than half of 2^−μ, and is stored as nothing, for \
         z < 1 − (μ + 1) ln 2 / c, at c = 80 more than four fifths of the range, where all that is lit turns dark. exponent = μ ln 2 \
         is the largest c that leaves the nearest depth one step.",
    }
}

/// Largest exponent that 20 bits hold over the whole range, μ ln 2.
const CONSISTENT_EXPONENT: f32 = 20.0 * std::f32::consts::LN_2;
