//! Lauritzen, McCool 2008. 1920 × 1200 with 4× multisampling; we render one sample a pixel.

use crate::reproduce::exhibit::Reported::Drawn;
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, error, fps, ms};

const BENCH: &str = "builtin:bench-under-tree";
const TREE: &str = "builtin:tree";

pub const PAPER: Paper = Paper {
    id: "lauritzen-2008",
    citation: "A. Lauritzen, M. McCool: Layered Variance Shadow Maps, Graphics Interface 2008",
    hardware: "NVIDIA GeForce 8800 GTX",
    exhibits: &[
        Exhibit {
            id: "figure1",
            shows: "Light bleeding of variance shadow maps, and none with layers",
            rows: &[
                error("VSM", "builtin:overlap", "vsm").at(640, 360),
                error("LVSM, 4 layers", "builtin:overlap", "lvsm").with(&[("layers", "4")]).at(640, 360),
            ],
        },
        drawing("figure2", "The three-surface case in which light bleeds"),
        Exhibit {
            id: "figure3",
            shows: "The penumbra of a tree bleeds through a bench",
            rows: &[error("VSM", BENCH, "vsm").at(640, 360)],
        },
        drawing("figure4", "Artefacts at the edges of layers, and overlaps that remove them"),
        Exhibit {
            id: "figure5",
            shows: "The bench of Figure 3 with four layers",
            rows: &[error("LVSM, 4 layers", BENCH, "lvsm").with(&[("layers", "4")]).at(640, 360)],
        },
        Exhibit {
            id: "figure6",
            shows: "Bleeding in a scene of high depth complexity, reduced by several layers",
            rows: &[
                error("VSM", TREE, "vsm").at(640, 360),
                error("LVSM, 8 layers", TREE, "lvsm").with(&[("layers", "8")]).at(640, 360),
            ],
        },
        Exhibit {
            id: "figure7",
            shows: "Filtered shadows of high quality",
            rows: &[error("LVSM, 4 layers", "builtin:columns", "lvsm").with(&[("layers", "4")]).at(640, 360)],
        },
        Exhibit {
            id: "figure8",
            shows: "Convolution shadow maps against layers, at equal storage",
            rows: &[
                error("CSM", BENCH, "convolution").at(640, 360),
                error("LVSM, 14 layers", BENCH, "lvsm").with(&[("layers", "14")]).at(640, 360),
            ],
        },
        Exhibit {
            id: "figure9",
            shows: "Frame time of VSM and of LVSM with 2 to 8 layers, over the size of the map",
            rows: &[
                ms("VSM, 1024²", BENCH, "vsm", "", Drawn).with(&[("map_size", "1024")]).at(1920, 1200),
                ms("LVSM-4, 1024²", BENCH, "lvsm", "", Drawn)
                    .with(&[("map_size", "1024"), ("layers", "4")])
                    .at(1920, 1200),
            ],
        },
        Exhibit {
            id: "figure10",
            shows: "Exponentially warped variance shadow maps",
            rows: &[error("EVSM", BENCH, "evsm").at(640, 360)],
        },
        Exhibit {
            id: "text",
            shows: "Frames a second at maps of 1024²",
            rows: &[
                fps("LVSM, 14 layers", BENCH, "lvsm", 100.0)
                    .with(&[("map_size", "1024"), ("layers", "14")])
                    .at(1920, 1200),
                fps("EVSM", BENCH, "evsm", 140.0).with(&[("map_size", "1024")]).at(1920, 1200),
            ],
        },
    ],
};
