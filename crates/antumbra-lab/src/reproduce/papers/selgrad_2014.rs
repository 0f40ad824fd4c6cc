//! Selgrad, Dachsbacher, Meyer, Stamminger 2014. Maps of 1024² unless said otherwise.

use crate::reproduce::exhibit::Reported::Number;
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, error, fps, ms};

const SPONZA: &str = "sponza.glb";
const STREET: &str = "builtin:street";
const TREE: &str = "builtin:tree";

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
                error("tinted panes", "builtin:stained-glass", "multi_layer").at(640, 360),
            ],
        },
        drawing("figure2", "A large light and a sharp occluder, or a point light and a blurred one"),
        drawing("figure3", "How lists of fragments are merged: code"),
        drawing("figure4", "How lists of fragments are merged: example"),
        drawing("figure5", "Levels of the shadow map in space"),
        drawing("figure6", "MIP-maps and Y-maps, levels four to six"),
        drawing("figure7", "How a Y-map is made"),
        drawing("figure8", "The filter size for an occluder"),
        drawing("figure9", "The lookup: code"),
        drawing("figure10", "Interpolation between levels"),
        Exhibit {
            id: "figure11",
            shows: "A fence of alpha maps under a close and a distant light",
            rows: &[
                error("multi-layer", "builtin:fence-alpha", "multi_layer").at(640, 360),
                error("PCSS", "builtin:fence-alpha", "pcss").at(640, 360),
            ],
        },
        Exhibit {
            id: "figure12",
            shows: "A tree: ESSM, and 1, 2 and 16 fragments in the base layer",
            rows: &[
                error("ESSM", TREE, "essm").at(640, 360),
                error("1 fragment", TREE, "multi_layer").with(&[("layers", "1")]).at(640, 360),
                error("16 fragments", TREE, "multi_layer").with(&[("layers", "16")]).at(640, 360),
            ],
        },
        Exhibit {
            id: "figure13",
            shows: "What each parameter costs in quality",
            rows: &[error("conservative", SPONZA, "multi_layer").at(640, 360)],
        },
        Exhibit {
            id: "figure14",
            shows: "An occluder across levels: additive and multiplicative accumulation",
            rows: &[
                error("multi-layer", "builtin:leaning-plank", "multi_layer").at(640, 360),
                error("ESSM", "builtin:leaning-plank", "essm").at(640, 360),
            ],
        },
        Exhibit {
            id: "figure15",
            shows: "Aligned panels: addition darkens too much",
            rows: &[
                error("multi-layer", "builtin:stacked-panels", "multi_layer").at(640, 360),
                error("ESSM", "builtin:stacked-panels", "essm").at(640, 360),
            ],
        },
        Exhibit {
            id: "table1",
            shows: "Milliseconds for each stage on Sponza: default, ε = 10w, 5 levels, sub-sampling, all",
            rows: &[
                ms("fragment counting", SPONZA, "multi_layer", "count", Number(0.83)),
                ms("scan", SPONZA, "multi_layer", "scan", Number(0.27)),
                ms("fragment collecting", SPONZA, "multi_layer", "scatter", Number(1.29)),
                ms("fragment sorting", SPONZA, "multi_layer", "sort", Number(0.63)),
                ms("filtering, default", SPONZA, "multi_layer", "filter", Number(3.35)),
                ms("soft shadows, default", SPONZA, "multi_layer", "resolve", Number(7.93)),
            ],
        },
        Exhibit {
            id: "table2",
            shows: "The same on Streets of Asia, 400 000 triangles",
            rows: &[
                ms("fragment counting", STREET, "multi_layer", "count", Number(0.98)),
                ms("scan", STREET, "multi_layer", "scan", Number(0.27)),
                ms("fragment collecting", STREET, "multi_layer", "scatter", Number(1.85)),
                ms("fragment sorting", STREET, "multi_layer", "sort", Number(0.60)),
                ms("filtering, default", STREET, "multi_layer", "filter", Number(5.40)),
                ms("soft shadows, default", STREET, "multi_layer", "resolve", Number(7.71)),
            ],
        },
        Exhibit {
            id: "table3",
            shows: "Frames a second with MIP-maps and Y-maps, two resolutions",
            rows: &[
                fps("Sponza, 1280x720, MIP", SPONZA, "multi_layer", 117.4),
                fps("Sponza, 1920x1080, MIP", SPONZA, "multi_layer", 90.2).at(1920, 1080),
                fps("street, 1280x720, MIP", STREET, "multi_layer", 104.9),
                fps("street, 1920x1080, MIP", STREET, "multi_layer", 84.2).at(1920, 1080),
            ],
        },
        Exhibit {
            id: "table4",
            shows: "ESSM, multi-layer at three sizes, and ray tracing on three scenes",
            rows: &[
                ms("Sponza: ESSM", SPONZA, "essm", "", Number(5.2)),
                ms("Sponza: multi-layer", SPONZA, "multi_layer", "", Number(8.5)),
                ms("tree: ESSM", TREE, "essm", "", Number(5.5)),
                ms("tree: multi-layer", TREE, "multi_layer", "", Number(6.1)),
                ms("street: ESSM", STREET, "essm", "", Number(6.7)),
                ms("street: multi-layer", STREET, "multi_layer", "", Number(9.5)),
                ms("street: multi-layer, 2048²", STREET, "multi_layer", "", Number(38.0)).with(&[("map_size", "2048")]),
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
            ],
        },
    ],
};
