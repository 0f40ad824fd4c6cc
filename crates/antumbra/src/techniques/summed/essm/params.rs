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
        shared map_size, more "Sharper contacts and finer occluders; memory and the time of the table grow with the square of the size.";
        /// Window of the light map, unless the host renders it.
        window: EssmWindow = EssmWindow::Seen,
            more "seen has finer texels where the camera looks, near or far; square does not depend on the camera, so shadows \
                 are steady when it moves.";
        /// Number of parts along each side of a kernel.
        subdivisions: u32 = 5, in 1..=16,
            more "Fewer errors where a part contains near and far occluders; time grows with the square of the number.";
        /// Number of scales at which blockers are searched.
        search_scales: u32 = 4, in 1..=16,
            more "More stable penumbra widths among occluders at many depths; time grows in proportion.";
        /// Search blockers once more if their mean lies much nearer to the receiver than the nearest caster, and evaluate
        /// blockers at their own depth if that hides another part of the light than the mean.
        second_look: bool = true,
            more "More accurate penumbrae under occluders at many depths; there, search and kernel take up to twice the time.";
        /// Blocker search; `search_scales` and `second_look` apply only to scales.
        search: EssmSearch = EssmSearch::Scales,
            more "window, the paper's, also counts blockers that hide no part of the light, which widens penumbrae behind lattices.";
        /// Quantity that is averaged over blockers. Under a sun both are the same.
        blocker_mean: EssmBlockerMean = EssmBlockerMean::Width,
            more "depth, the paper's, makes penumbrae too narrow where blockers at several depths meet under a near light.";
        /// Whether the light's part below the receiver's own plane counts as hidden.
        horizon: bool = true,
            more "false, the paper's, gives receivers at grazing angles the visibility of receivers that face the light.";
        shared edge_goes_on;
        /// Cuts of a kernel's rows.
        cuts: EssmCuts = EssmCuts::Columns,
            more "squares, the paper's, divides every row into `subdivisions` × `subdivisions` parts, which takes many times the lookups.";
        /// Storage of the exponentials' sums.
        table: EssmTable = EssmTable::Tiles,
            more "tiles works for any depth range; tile_grid, the paper's, darkens lit ground in deep scenes; float is noisy.";
        /// Algorithm that computes the tables.
        scan: EssmScan = EssmScan::Blocks,
            more "doubling, the paper's, is slower and takes more than twice the memory; it is provided for comparison.";
        /// Exponent: per texel width for tiles, over the depth range for the others. 0 is automatic: 0.1 and 80.
        exponent: f32 = 0.0, in 0.0..=88.0,
            more "Darker contacts; beyond the precision of the bits, more parts are read from the map or become dark.";
        /// Number of bits of each value of tile_grid.
        precision_bits: u32 = 20, in 8..=24, unit "bits",
            more "Finer values, but smaller tiles and therefore more of them under each kernel.";
        /// Source of the depth range of tile_grid and float.
        range: EssmRange = EssmRange::Map,
            more "map is narrower and needs a pyramid of the map, which the search also needs.";
        /// Excess over 1 of a part's exponential visibility from which it counts as non-planar.
        epsilon: f32 = 0.05, in 0.0..=10.0,
            more "Fewer parts are read from the map, but surfaces behind the receiver cancel more of the blockers.";
        /// Largest width of parts that are read from the map, if that takes fewer reads than the table.
        direct_texels: f32 = 3.0, in 0.0..=64.0, unit "texels",
            more "More accurate contacts, but 2 × 2 comparisons miss occluders finer than a quarter of this.";
        /// Shape of the filter kernel.
        kernel: EssmKernel = EssmKernel::Light,
            more "ellipse is the paper's; with isotropic, fine shadows in the distance alias.";
        /// Whether the pixel's footprint ends where a neighbouring pixel shows another surface.
        footprint_ends: bool = true,
            more "false, the paper's, makes shadows slightly softer at the edges of surfaces in the image.";
        /// Height of an ellipse's rows, for `cuts = squares` only: with columns, ellipses of any size have as many rows.
        row_height: f32 = 5.0, in 1.0..=64.0, unit "texels", scale Log,
            more "Fewer lookups, but a coarser outline.";
        /// Number of refinements of the ends of an ellipse's rows: the paper's Level0, Level1, Level2.
        level: u32 = 0, in 0..=3,
            more "A smoother outline; the lookups at the ends of each row double.";
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), subdivisions: 3, search_scales: 2, }
    High { map_size: MapSize::Texels(2048), subdivisions: 7, search_scales: 5, }
    Best { map_size: MapSize::Texels(4096), subdivisions: 9, search_scales: 8, }
    => Paper {
        window: EssmWindow::Square, ours "The window of the map is warped towards the camera's view.";
        subdivisions: 3, ours "5 × 5 parts.";
        table: EssmTable::TileGrid, ours "Every tile has its own plane, relative to which its exponentials are computed.";
        scan: EssmScan::Doubling, ours "Tables are computed in one pass over the map.";
        exponent: CONSISTENT_EXPONENT, ours "0.1 per texel width; the published 80 contradicts the published 20 bits (see below).";
        kernel: EssmKernel::Ellipse, ours "The kernel of a rectangle is a parallelogram.";
        search: EssmSearch::Window, ours "Blockers are searched at four scales, and count if they hide a point of the light.";
        blocker_mean: EssmBlockerMean::Depth, ours "The mean is that of g = 1 / z − 1 / z_receiver, to which the penumbra's \
             width is proportional.";
        horizon: false, ours "The part of the light below the receiver's plane is hidden.";
        edge_goes_on: false, ours "Casters at the map's edge are extended beyond it, for blockers closer to the light than the map covers.";
        footprint_ends: false, ours "The pixel's footprint ends where a neighbouring pixel shows another surface.";
        cuts: EssmCuts::Squares, ours "A row has n columns and an ellipse n rows; in the paper, each rectangle has n × n \
             parts, and larger ellipses have more rows.";
        direct_texels: 0.0, ours "Parts of kernels that are at most 3 texels wide are read from the map.";
    } kept {
        "Parts are compared with the receiver's plane at their centre, and divided by the value of the plane itself there; the \
         paper compares with one depth.",
        "The search window is computed at the depth of the nearest caster, found in a pyramid; the paper intersects with the \
         plane of the map.",
        "The bias is derived; the paper states none.",
        "R, the range of a float's exponent (here 80), and μ = 20 contradict each other: e^{c(z − 1)} is less than half of \
         2^−μ, and rounds to 0, for z < 1 − (μ + 1) ln 2 / c. At c = 80 that is more than four fifths of the range, in which \
         lit receivers become dark. exponent = μ ln 2 is the largest c with which the nearest depth is at least one step.",
    }
}

/// Largest exponent that 20 bits hold over the whole range, μ ln 2.
const CONSISTENT_EXPONENT: f32 = 20.0 * std::f32::consts::LN_2;
