use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// How the exponentials are summed.
    pub enum EssmTable {
        /// Integer tables on a grid of tiles, each with a plane of its own and as many bits as its size leaves.
        Tiles = "tiles",
        /// The paper's: integer tables of `precision_bits` on one range of depth, on a grid that keeps sums below 2³².
        TileGrid = "tile_grid",
        /// One table of 32-bit floats on one range of depth.
        Float = "float",
    }
}

param_choice! {
    /// How sums travel while tables are made.
    pub enum EssmScan {
        /// Work in proportion to the texels.
        Blocks = "blocks",
        /// Recursive doubling, the paper's: passes in proportion to the tile's logarithm.
        Doubling = "doubling",
    }
}

param_choice! {
    /// The shape that is filtered over.
    pub enum EssmKernel {
        /// The light's: a parallelogram for a rectangle, an ellipse for everything else; with the pixel's footprint.
        Light = "light",
        /// An ellipse with the pixel's footprint, whatever the light: the paper's.
        Ellipse = "ellipse",
        /// The light's, without the footprint.
        Isotropic = "isotropic",
    }
}

param_choice! {
    /// The window of the light map.
    pub enum EssmWindow {
        /// A square around what casts and receives; warped to what the camera sees where that makes the texels that fall
        /// there half as wide.
        Seen = "seen",
        /// The square, always.
        Square = "square",
    }
}

param_choice! {
    /// Where [`Essm`](super::Essm) looks for blockers.
    pub enum EssmSearch {
        /// In windows of several scales, and counts what hides a point of the light.
        Scales = "scales",
        /// In one window, as wide as the light is seen at the nearest blocker's depth, and counts all that is in it: the
        /// paper's.
        Window = "window",
    }
}

param_choice! {
    /// How [`Essm`](super::Essm) cuts a kernel's rows.
    pub enum EssmCuts {
        /// Into `subdivisions` columns each; their ends stay whole.
        Columns = "columns",
        /// Into `subdivisions` × `subdivisions` parts each, their ends too: the paper's.
        Squares = "squares",
    }
}

param_choice! {
    /// Where the range of depth of `tile_grid` and `float` comes from.
    pub enum EssmRange {
        /// The least and greatest depth in the map.
        Map = "map",
        /// The casters' box.
        Box = "box",
    }
}

param_choice! {
    /// What [`Essm`](super::Essm) takes the mean of over blockers.
    pub enum EssmBlockerMean {
        /// The width of the penumbra that each asks for.
        Width = "width",
        /// Their depth: the paper's.
        Depth = "depth",
    }
}

params! {
    /// Parameters of [`Essm`](super::Essm).
    pub struct EssmParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and the table's time grow with the square.";
        /// The light map's window, unless the host renders it.
        window: EssmWindow = EssmWindow::Seen,
            more "seen spends texels where the camera looks, be that near or far; square keeps them still when it moves.";
        /// Parts along each side of a kernel.
        subdivisions: u32 = 5, in 1..=16,
            more "Fewer wrong answers where a part holds near and far occluders; time grows with the square.";
        /// Scales at which blockers are searched.
        search_scales: u32 = 4, in 1..=16,
            more "Steadier penumbra widths among occluders of many depths; time grows in proportion.";
        /// Search blockers once more where their mean lies much nearer the receiver than the nearest caster, and look at each blocker at its
        /// own depth where that hides another part of the light than the mean.
        second_look: bool = true,
            more "Truer penumbrae under occluders of many depths; there search and kernel take up to twice the time.";
        /// Where blockers are searched; `search_scales` and `second_look` are for scales alone.
        search: EssmSearch = EssmSearch::Scales,
            more "window is the paper's; behind lattices what it holds that hides no part of the light widens penumbrae.";
        /// What the mean of blockers is of. Under a sun both are one.
        blocker_mean: EssmBlockerMean = EssmBlockerMean::Width,
            more "depth is the paper's: penumbrae are narrower where blockers of several depths meet under a near light.";
        /// Whether the light's part below the receiver's own plane counts as hidden.
        horizon: bool = true,
            more "false is the paper's: receivers that the light grazes are as bright as those that face it.";
        shared edge_goes_on;
        /// How a kernel's rows are cut.
        cuts: EssmCuts = EssmCuts::Columns,
            more "squares is the paper's: as many times more parts as there are rows in a kernel's height for each part.";
        /// How the exponentials are summed.
        table: EssmTable = EssmTable::Tiles,
            more "tiles holds at any depth; tile_grid is the paper's and darkens lit ground in deep scenes; float is noisy.";
        /// How sums travel while tables are made.
        scan: EssmScan = EssmScan::Blocks,
            more "doubling is the paper's, kept to be measured against: slower, and twice the memory and more.";
        /// Exponents: for tiles a texel's width, for the others the range of depth. 0 is automatic: 0.1 and 80.
        exponent: f32 = 0.0, in 0.0..=88.0,
            more "Darker contacts; above what the bits hold, more parts are read from the map, or turn dark.";
        /// Bits that tile_grid keeps for each value.
        precision_bits: u32 = 20, in 8..=24, unit "bits",
            more "Finer values; smaller tiles, and more of them under each kernel.";
        /// Where the range of depth of tile_grid and float comes from.
        range: EssmRange = EssmRange::Map,
            more "map is narrower, and needs a pyramid of the map, which the search needs in any case.";
        /// How far above 1 the exponential visibility of a part may be before it counts as non-planar.
        epsilon: f32 = 0.05, in 0.0..=10.0,
            more "Fewer parts are read from the map; what lies beyond the receiver hides more of what blocks.";
        /// Parts up to this width are read from the map, where that takes fewer reads than the table.
        direct_texels: f32 = 3.0, in 0.0..=64.0, unit "texels",
            more "Truer contacts; 2 × 2 comparisons miss what is finer than a quarter of this.";
        /// The shape that is filtered over.
        kernel: EssmKernel = EssmKernel::Light,
            more "ellipse is the paper's; isotropic leaves fine shadows far away to alias.";
        /// Whether the pixel's footprint ends where a neighbouring pixel shows another surface.
        footprint_ends: bool = true,
            more "false is the paper's: at edges of the picture's surfaces shadows are a little softer.";
        /// Height of an ellipse's rows as the paper has it, of `cuts = squares` alone: columns have as many rows for every ellipse.
        row_height: f32 = 5.0, in 1.0..=64.0, unit "texels", scale Log,
            more "Fewer lookups, coarser outline.";
        /// How often the ends of an ellipse's rows are refined: the paper's Level0, Level1, Level2.
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
        exponent: CONSISTENT_EXPONENT, ours "0.1 a texel's width; the printed 80 does not go with the printed 20 bits (see below).";
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

/// The exponent that 20 bits hold over the whole range, μ ln 2.
const CONSISTENT_EXPONENT: f32 = 20.0 * std::f32::consts::LN_2;
