//! Selgrad, Dachsbacher, Meyer, Stamminger 2014. Maps of 1024² unless said otherwise.
//!
//! Times are of the paper's own settings ([`PRINTED`]: ε = 2w doubling from level to level, addition throughout, back
//! faces, a sample a texel, the light as a whole, hats over depth, lists apart, no planes, MIP-maps); errors are of our defaults
//! unless a row says otherwise.

use super::SKETCHED_PCSS;
use crate::reproduce::exhibit::Reported::{Drawn, Number};
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, error, fps, ms};

const SPONZA: &str = "sponza.glb";
const STREET: &str = "builtin:street";
const TREE: &str = "builtin:tree";
const LANTERN: &str = "builtin:lantern-wall";

/// A technique's parameters.
type Settings = &'static [(&'static str, &'static str)];

/// What the paper prints, and what each of its tables' columns changes.
macro_rules! printed {
    ($epsilon:literal $(, $key:literal = $value:literal)*) => {
        &[
            ("epsilon", $epsilon),
            ("epsilon_growth", "double"),
            ("list_accumulation", "add"),
            ("level_accumulation", "add"),
            ("faces", "back"),
            ("msaa", "1"),
            ("light_parts", "1"),
            ("level_weights", "depth"),
            ("filter_widths", "merged"),
            ("depth_average", "count"),
            ("lists", "apart"),
            ("planes", "false"),
            ("map_shape", "square"),
            $(($key, $value),)*
        ]
    };
}
const PRINTED: Settings = printed!("2", "hierarchy" = "mip_map");
/// Of figures 14 and 15, which compare what comes together how. Later settings win.
const ADDITIVE: Settings = printed!("2", "hierarchy" = "y_map");
const MULTIPLICATIVE: Settings =
    printed!("2", "hierarchy" = "y_map", "list_accumulation" = "multiply", "level_accumulation" = "multiply");
const LARGE_EPSILON: Settings = printed!("10", "hierarchy" = "mip_map");
const FIVE_LEVELS: Settings = printed!("2", "hierarchy" = "mip_map", "levels" = "5");
const SUB: Settings = printed!("2", "hierarchy" = "mip_map", "sub" = "true");
const ALL: Settings = printed!("10", "hierarchy" = "mip_map", "levels" = "5", "sub" = "true");
const ALL_Y_MAP: Settings = printed!("10", "hierarchy" = "y_map", "levels" = "5", "sub" = "true");
const ALL_2048: Settings = printed!("10", "hierarchy" = "mip_map", "levels" = "6", "sub" = "true", "map_size" = "2048");
const ALL_512: Settings = printed!("10", "hierarchy" = "mip_map", "levels" = "5", "sub" = "true", "map_size" = "512");

pub const PAPER: Paper = Paper {
    id: "selgrad-2014",
    citation: "K. Selgrad, C. Dachsbacher, Q. Meyer, M. Stamminger: Filtering Multi-Layer Shadow Maps for Accurate Soft \
               Shadows, Computer Graphics Forum 34(1), 2014",
    hardware: "NVIDIA GeForce GTX Titan",
    exhibits: &[
        Exhibit {
            id: "figure1",
            shows: "Soft shadows of opaque and tinted surfaces, and of a whole hall",
            rows: &[
                error("Sponza", SPONZA, "multi_layer").at(640, 360),
                error("distant and close occluders", LANTERN, "multi_layer").at(640, 360),
                error("the same, ESSM", LANTERN, "essm").at(640, 360),
                error("tinted panes", "builtin:stained-glass", "multi_layer").at(640, 360),
            ],
        },
        drawing("figure2", "A large light and a sharp occluder, or a point light and a blurred one"),
        drawing("figure3", "How lists of fragments are merged: code"),
        drawing("figure4", "How lists of fragments are merged: example"),
        Exhibit {
            id: "figure5",
            shows: "Wider penumbrae from more levels",
            rows: &[
                error("level 1 alone", LANTERN, "multi_layer").with(printed!("2", "fixed_level" = "1")).at(640, 360),
                error("level 3 alone", LANTERN, "multi_layer").with(printed!("2", "fixed_level" = "3")).at(640, 360),
                error("level 5 alone", LANTERN, "multi_layer").with(printed!("2", "fixed_level" = "5")).at(640, 360),
            ],
        },
        Exhibit {
            id: "figure6",
            shows: "MIP-maps and Y-maps: texels of wide filters",
            rows: &[
                error("MIP-map", "builtin:overlap", "multi_layer").with(&[("hierarchy", "mip_map")]).at(640, 360),
                error("Y-map", "builtin:overlap", "multi_layer").with(&[("hierarchy", "y_map")]).at(640, 360),
                error("finer Y-map (ours)", "builtin:overlap", "multi_layer")
                    .with(&[("hierarchy", "fine_y_map")])
                    .at(640, 360),
            ],
        },
        drawing("figure7", "How a Y-map is made"),
        drawing("figure8", "The filter size for an occluder"),
        drawing("figure9", "The lookup: code"),
        Exhibit {
            id: "figure10",
            shows: "Interpolation between levels: a penumbra of every width",
            rows: &[
                error("bilinear", "builtin:leaning-plank", "multi_layer")
                    .with(printed!("2", "hierarchy" = "y_map", "level_weights" = "none"))
                    .at(640, 360),
                error("trilinear", "builtin:leaning-plank", "multi_layer")
                    .with(printed!("2", "hierarchy" = "y_map"))
                    .at(640, 360),
                error("trilinear (ours)", "builtin:leaning-plank", "multi_layer").at(640, 360),
            ],
        },
        Exhibit {
            id: "figure11",
            shows: "A fence of alpha maps under a close and a distant light",
            rows: &[
                error("multi-layer", "builtin:fence-alpha", "multi_layer").at(640, 360),
                error("PCSS", "builtin:fence-alpha", "pcss").with(SKETCHED_PCSS).at(640, 360),
            ],
        },
        Exhibit {
            id: "figure12",
            shows: "A tree: ESSM, and 1, 2 and 16 fragments in the base layer",
            rows: &[
                error("ESSM", TREE, "essm").at(640, 360),
                error("1 fragment", TREE, "multi_layer").with(&[("layers", "1")]).at(640, 360),
                error("2 fragments", TREE, "multi_layer").with(&[("layers", "2")]).at(640, 360),
                error("16 fragments", TREE, "multi_layer").with(&[("layers", "16")]).at(640, 360),
                error("all fragments", TREE, "multi_layer").at(640, 360),
            ],
        },
        Exhibit {
            id: "figure13",
            shows: "What each parameter costs in quality",
            rows: &[
                error("conservative", LANTERN, "multi_layer").at(640, 360),
                error("one layer", LANTERN, "multi_layer").with(&[("layers", "1")]).at(640, 360),
                error("two layers", LANTERN, "multi_layer").with(&[("layers", "2")]).at(640, 360),
                error("ε = 130 w", LANTERN, "multi_layer")
                    .with(&[("epsilon", "130"), ("epsilon_growth", "double")])
                    .at(640, 360),
                error("four levels", LANTERN, "multi_layer").with(&[("levels", "4")]).at(640, 360),
                error("conservative, Sponza", SPONZA, "multi_layer").at(640, 360),
            ],
        },
        Exhibit {
            id: "figure14",
            shows: "An occluder across levels: additive and multiplicative accumulation",
            rows: &[
                error("by edges (ours)", "builtin:leaning-plank", "multi_layer").at(640, 360),
                error("additive", "builtin:leaning-plank", "multi_layer").with(ADDITIVE).at(640, 360),
                error("multiplicative", "builtin:leaning-plank", "multi_layer").with(MULTIPLICATIVE).at(640, 360),
                error("ESSM", "builtin:leaning-plank", "essm").at(640, 360),
            ],
        },
        Exhibit {
            id: "figure15",
            shows: "Aligned panels: addition darkens too much",
            rows: &[
                error("by edges (ours)", "builtin:stacked-panels", "multi_layer").at(640, 360),
                error("additive", "builtin:stacked-panels", "multi_layer").with(ADDITIVE).at(640, 360),
                error("multiplicative", "builtin:stacked-panels", "multi_layer").with(MULTIPLICATIVE).at(640, 360),
                error("ESSM", "builtin:stacked-panels", "essm").at(640, 360),
            ],
        },
        Exhibit {
            id: "table1",
            shows: "Milliseconds for each stage on Sponza: default, ε = 10w, 5 levels, sub-sampling, all",
            rows: &[
                ms("fragment counting", SPONZA, "multi_layer", "count", Number(0.83)).with(PRINTED),
                ms("scan", SPONZA, "multi_layer", "scan", Number(0.27)).with(PRINTED),
                ms("fragment collecting", SPONZA, "multi_layer", "collect", Number(1.29)).with(PRINTED),
                ms("fragment sorting", SPONZA, "multi_layer", "sort", Number(0.63)).with(PRINTED),
                ms("filtering, default", SPONZA, "multi_layer", "filter", Number(3.35)).with(PRINTED),
                ms("filtering, ε = 10w", SPONZA, "multi_layer", "filter", Number(2.10)).with(LARGE_EPSILON),
                ms("filtering, 5 levels", SPONZA, "multi_layer", "filter", Number(2.31)).with(FIVE_LEVELS),
                ms("filtering, sub", SPONZA, "multi_layer", "filter", Number(3.35)).with(SUB),
                ms("filtering, all", SPONZA, "multi_layer", "filter", Number(1.81)).with(ALL),
                ms("soft shadows, default", SPONZA, "multi_layer", "resolve", Number(7.93)).with(PRINTED),
                ms("soft shadows, ε = 10w", SPONZA, "multi_layer", "resolve", Number(6.24)).with(LARGE_EPSILON),
                ms("soft shadows, 5 levels", SPONZA, "multi_layer", "resolve", Number(5.59)).with(FIVE_LEVELS),
                ms("soft shadows, sub", SPONZA, "multi_layer", "resolve", Number(3.04)).with(SUB),
                ms("soft shadows, all", SPONZA, "multi_layer", "resolve", Number(2.23)).with(ALL),
            ],
        },
        Exhibit {
            id: "table2",
            shows: "The same on Streets of Asia, 400 000 triangles",
            rows: &[
                ms("fragment counting", STREET, "multi_layer", "count", Number(0.98)).with(PRINTED),
                ms("scan", STREET, "multi_layer", "scan", Number(0.27)).with(PRINTED),
                ms("fragment collecting", STREET, "multi_layer", "collect", Number(1.85)).with(PRINTED),
                ms("fragment sorting", STREET, "multi_layer", "sort", Number(0.60)).with(PRINTED),
                ms("filtering, default", STREET, "multi_layer", "filter", Number(5.40)).with(PRINTED),
                ms("filtering, ε = 10w", STREET, "multi_layer", "filter", Number(1.87)).with(LARGE_EPSILON),
                ms("filtering, 5 levels", STREET, "multi_layer", "filter", Number(3.78)).with(FIVE_LEVELS),
                ms("filtering, sub", STREET, "multi_layer", "filter", Number(5.40)).with(SUB),
                ms("filtering, all", STREET, "multi_layer", "filter", Number(1.66)).with(ALL),
                ms("soft shadows, default", STREET, "multi_layer", "resolve", Number(7.71)).with(PRINTED),
                ms("soft shadows, ε = 10w", STREET, "multi_layer", "resolve", Number(5.17)).with(LARGE_EPSILON),
                ms("soft shadows, 5 levels", STREET, "multi_layer", "resolve", Number(5.81)).with(FIVE_LEVELS),
                ms("soft shadows, sub", STREET, "multi_layer", "resolve", Number(2.54)).with(SUB),
                ms("soft shadows, all", STREET, "multi_layer", "resolve", Number(2.16)).with(ALL),
            ],
        },
        Exhibit {
            id: "table3",
            shows: "Frames a second with MIP-maps and Y-maps, two resolutions, all three options on",
            rows: &[
                fps("Sponza, 1280x720, MIP", SPONZA, "multi_layer", 117.4).with(ALL),
                fps("Sponza, 1280x720, Y", SPONZA, "multi_layer", 101.2).with(ALL_Y_MAP),
                fps("Sponza, 1920x1080, MIP", SPONZA, "multi_layer", 90.2).with(ALL).at(1920, 1080),
                fps("Sponza, 1920x1080, Y", SPONZA, "multi_layer", 80.8).with(ALL_Y_MAP).at(1920, 1080),
                fps("street, 1280x720, MIP", STREET, "multi_layer", 104.9).with(ALL),
                fps("street, 1280x720, Y", STREET, "multi_layer", 86.4).with(ALL_Y_MAP),
                fps("street, 1920x1080, MIP", STREET, "multi_layer", 84.2).with(ALL).at(1920, 1080),
                fps("street, 1920x1080, Y", STREET, "multi_layer", 77.9).with(ALL_Y_MAP).at(1920, 1080),
            ],
        },
        Exhibit {
            id: "table4",
            shows: "ESSM and multi-layer at three sizes on three scenes",
            rows: &[
                ms("Sponza: ESSM", SPONZA, "essm", "", Number(5.2)),
                ms("Sponza: multi-layer", SPONZA, "multi_layer", "", Number(8.5)).with(ALL),
                ms("Sponza: multi-layer, 2048²", SPONZA, "multi_layer", "", Number(45.0)).with(ALL_2048),
                ms("Sponza: multi-layer, 512²", SPONZA, "multi_layer", "", Number(5.7)).with(ALL_512),
                ms("tree: ESSM", TREE, "essm", "", Number(5.5)),
                ms("tree: multi-layer", TREE, "multi_layer", "", Number(6.1)).with(ALL),
                ms("tree: multi-layer, 2048²", TREE, "multi_layer", "", Number(28.0)).with(ALL_2048),
                ms("tree: multi-layer, 512²", TREE, "multi_layer", "", Number(4.4)).with(ALL_512),
                ms("street: ESSM", STREET, "essm", "", Number(6.7)),
                ms("street: multi-layer", STREET, "multi_layer", "", Number(9.5)).with(ALL),
                ms("street: multi-layer, 2048²", STREET, "multi_layer", "", Number(38.0)).with(ALL_2048),
                ms("street: multi-layer, 512²", STREET, "multi_layer", "", Number(8.5)).with(ALL_512),
            ],
        },
        Exhibit {
            id: "figure16",
            shows: "Streets of Asia",
            rows: &[error("multi-layer", STREET, "multi_layer").at(640, 360)],
        },
        Exhibit {
            id: "figure17",
            shows: "Multi-layer beside ray-traced shadows",
            rows: &[error("multi-layer", TREE, "multi_layer").at(640, 360)],
        },
        Exhibit {
            id: "figure18",
            shows: "Thin geometry with maps of 1024² and 2048²",
            rows: &[
                error("1024²", "builtin:fence-geometry", "multi_layer").with(&[("map_size", "1024")]).at(640, 360),
                error("2048²", "builtin:fence-geometry", "multi_layer").with(&[("map_size", "2048")]).at(640, 360),
                error("2048², sub-sampled", "builtin:fence-geometry", "multi_layer")
                    .with(&[("map_size", "2048"), ("subsampled_steps", "1")])
                    .at(640, 360),
                ms("filtering, 2048²", "builtin:fence-geometry", "multi_layer", "filter", Drawn)
                    .with(&[("map_size", "2048")]),
                ms("filtering, 2048², sub-sampled", "builtin:fence-geometry", "multi_layer", "filter", Drawn)
                    .with(&[("map_size", "2048"), ("subsampled_steps", "1")]),
            ],
        },
    ],
};
