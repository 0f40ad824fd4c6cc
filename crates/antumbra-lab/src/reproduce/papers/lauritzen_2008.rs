//! Lauritzen, McCool 2008. 1920 × 1200 with 4× multisampling of picture and map; our pictures have one sample a pixel.
//!
//! The pictures are of fixed kernels, and so are held against exact filtering by the same kernel. At equal storage a term of
//! the convolution basis takes two bytes a texel and a layer four.

use crate::reproduce::exhibit::Reported::Drawn;
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, filtered_error, fps, ms};

const OVERLAP: &str = "builtin:overlap";
const BENCH: &str = "builtin:bench-under-tree";

/// The kernel of every picture: as wide as the penumbrae in which variance bleeds, and the one of our tests.
macro_rules! wide {
    ($($more:tt)*) => {
        &[("map_size", "384"), ("kernel_size", "9.1"), ("filter", "box"), ("mips", "false"), $($more)*]
    };
}

const WIDE: &[(&str, &str)] = wide!();
const FOUR_LAYERS: &[(&str, &str)] = wide!(("layers", "4"));

pub const PAPER: Paper = Paper {
    id: "lauritzen-2008",
    citation: "A. Lauritzen, M. McCool: Layered Variance Shadow Maps, Graphics Interface 2008",
    hardware: "NVIDIA GeForce 8800 GTX",
    exhibits: &[
        Exhibit {
            id: "figure1",
            shows: "Light bleeding of variance shadow maps, and none with layers",
            rows: &[
                filtered_error("VSM", OVERLAP, "vsm").with(WIDE).at(640, 360),
                filtered_error("LVSM, 4 layers", OVERLAP, "lvsm").with(FOUR_LAYERS).at(640, 360),
            ],
        },
        drawing("figure2", "The three-surface case in which light bleeds"),
        Exhibit {
            id: "figure3",
            shows: "The penumbra of a tree bleeds through a bench",
            rows: &[filtered_error("VSM", BENCH, "vsm").with(WIDE).at(640, 360)],
        },
        Exhibit {
            id: "figure4",
            shows: "Artefacts at the edges of layers, and overlaps that remove them",
            rows: &[
                filtered_error("no overlap", OVERLAP, "lvsm")
                    .with(wide!(("layers", "8"), ("placement", "uniform"), ("overlap", "0")))
                    .at(640, 360),
                filtered_error("overlap", OVERLAP, "lvsm")
                    .with(wide!(("layers", "8"), ("placement", "uniform")))
                    .at(640, 360),
            ],
        },
        Exhibit {
            id: "figure5",
            shows: "The bench of Figure 3 with four layers",
            rows: &[filtered_error("LVSM, 4 layers", BENCH, "lvsm").with(FOUR_LAYERS).at(640, 360)],
        },
        Exhibit {
            id: "figure6",
            shows: "Bleeding in a scene of overlapping shadows, reduced by several layers",
            rows: &[
                filtered_error("VSM", OVERLAP, "vsm").with(WIDE).at(640, 360),
                filtered_error("LVSM, 8 layers", OVERLAP, "lvsm").with(wide!(("layers", "8"))).at(640, 360),
            ],
        },
        Exhibit {
            id: "figure7",
            shows: "Filtered shadows of high quality",
            rows: &[filtered_error("LVSM, 4 layers", "builtin:columns", "lvsm").with(FOUR_LAYERS).at(640, 360)],
        },
        Exhibit {
            id: "figure8",
            shows: "Convolution shadow maps against layers, uniform and by Lloyd's relaxation, at equal storage",
            rows: &[
                filtered_error("CSM, M = 4", OVERLAP, "convolution").with(wide!(("terms", "4"))).at(640, 360),
                filtered_error("LVSM-2, uniform", OVERLAP, "lvsm")
                    .with(wide!(("layers", "2"), ("placement", "uniform"), ("storage", "unorm16")))
                    .at(640, 360),
                filtered_error("LVSM-2, Lloyd", OVERLAP, "lvsm")
                    .with(wide!(("layers", "2"), ("placement", "lloyd"), ("storage", "unorm16")))
                    .at(640, 360),
                filtered_error("CSM, M = 8", OVERLAP, "convolution").with(wide!(("terms", "8"))).at(640, 360),
                filtered_error("LVSM-4, uniform", OVERLAP, "lvsm")
                    .with(wide!(("layers", "4"), ("placement", "uniform"), ("storage", "unorm16")))
                    .at(640, 360),
                filtered_error("LVSM-4, Lloyd", OVERLAP, "lvsm")
                    .with(wide!(("layers", "4"), ("placement", "lloyd"), ("storage", "unorm16")))
                    .at(640, 360),
                filtered_error("CSM, M = 14", OVERLAP, "convolution").with(wide!(("terms", "14"))).at(640, 360),
                filtered_error("LVSM-7, uniform", OVERLAP, "lvsm")
                    .with(wide!(("layers", "7"), ("placement", "uniform"), ("storage", "unorm16")))
                    .at(640, 360),
                filtered_error("LVSM-7, Lloyd", OVERLAP, "lvsm")
                    .with(wide!(("layers", "7"), ("placement", "lloyd"), ("storage", "unorm16")))
                    .at(640, 360),
            ],
        },
        Exhibit {
            id: "figure9",
            shows: "Frame time of VSM and of LVSM with 2 to 14 layers, over the size of the map",
            rows: &[
                ms("VSM, 256²", BENCH, "vsm", "", Drawn).with(&[("map_size", "256"), ("msaa", "4")]).at(1920, 1200),
                ms("LVSM-2, 256²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "256"), ("layers", "2"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-4, 256²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "256"), ("layers", "4"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-8, 256²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "256"), ("layers", "8"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-14, 256²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "256"), ("layers", "14"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("VSM, 512²", BENCH, "vsm", "", Drawn).with(&[("map_size", "512"), ("msaa", "4")]).at(1920, 1200),
                ms("LVSM-2, 512²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "512"), ("layers", "2"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-4, 512²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "512"), ("layers", "4"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-8, 512²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "512"), ("layers", "8"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-14, 512²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "512"), ("layers", "14"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("VSM, 1024²", BENCH, "vsm", "", Drawn).with(&[("map_size", "1024"), ("msaa", "4")]).at(1920, 1200),
                ms("LVSM-2, 1024²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "1024"), ("layers", "2"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-4, 1024²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "1024"), ("layers", "4"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-8, 1024²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "1024"), ("layers", "8"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-14, 1024²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "1024"), ("layers", "14"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("VSM, 2048²", BENCH, "vsm", "", Drawn).with(&[("map_size", "2048"), ("msaa", "4")]).at(1920, 1200),
                ms("LVSM-2, 2048²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "2048"), ("layers", "2"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-4, 2048²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "2048"), ("layers", "4"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-8, 2048²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "2048"), ("layers", "8"), ("msaa", "4")])
                    .at(1920, 1200),
                ms("LVSM-14, 2048²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "2048"), ("layers", "14"), ("msaa", "4")])
                    .at(1920, 1200),
            ],
        },
        Exhibit {
            id: "figure10",
            shows: "Exponentially warped variance shadow maps",
            rows: &[
                filtered_error("EVSM", OVERLAP, "evsm").with(WIDE).at(640, 360),
                filtered_error("EVSM", BENCH, "evsm").with(WIDE).at(640, 360),
            ],
        },
        Exhibit {
            id: "text",
            shows: "Frames a second at maps of 1024²",
            rows: &[
                fps("LVSM, 14 layers", BENCH, "lvsm", 100.0)
                    .with(&[("map_size", "1024"), ("layers", "14"), ("msaa", "4")])
                    .at(1920, 1200),
                fps("EVSM", BENCH, "evsm", 140.0).with(&[("map_size", "1024"), ("msaa", "4")]).at(1920, 1200),
            ],
        },
    ],
};
