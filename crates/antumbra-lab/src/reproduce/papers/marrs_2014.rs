//! Marrs, Watson, Healey 2014. Times are drawn as curves but for Figure 1's two numbers; the window's size is not said.

use crate::reproduce::exhibit::Reported::{Drawn, Number};
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, error, ms};

/// Poisson-disc light points, maps of 512², 2 × 2 hardware comparison: the paper's section 4.
const VIEWS_64: &[(&str, &str)] =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("compare", "hardware")];
const VIEWS_16: &[(&str, &str)] =
    &[("samples", "16"), ("view_size", "512"), ("sample_set", "poisson"), ("compare", "hardware")];
/// Reprojection as it comes, with as many views of the same size.
const REPROJECTED_64: &[(&str, &str)] = &[("samples", "64"), ("view_size", "512")];
const DRAGON: &str = "builtin:knot?triangles=100000";
const TEN: &str = "builtin:ten-knots";

pub const PAPER: Paper = Paper {
    id: "marrs-2014",
    citation: "A. Marrs, B. Watson, C. Healey: Fast Multi-View Soft Shadowing via Fragment Reprojection, 2014",
    hardware: "NVIDIA GeForce GTX Titan",
    exhibits: &[
        Exhibit {
            id: "figure1",
            shows: "64 depth maps of 512² of 100 000 triangles: made by rasterisation, and by reprojection",
            rows: &[
                ms("depth maps by brute force", DRAGON, "multi_view", DEPTH, Number(4.85)).with(VIEWS_64),
                ms("depth maps by synchronised reprojection", DRAGON, "reprojection", "", Number(0.48))
                    .with(REPROJECTED_64),
            ],
        },
        drawing("figure2", "Depth bias before and after reprojection"),
        Exhibit {
            id: "figure3",
            shows: "Time over geometry: brute force, reprojection and PCSS on four scenes, 16 to 64 light samples",
            rows: &[
                ms("window, 780 triangles: brute force, 16", "builtin:window", "multi_view", "", Drawn).with(VIEWS_16),
                ms("window: brute force, 64", "builtin:window", "multi_view", "", Drawn).with(VIEWS_64),
                ms("window: PCSS", "builtin:window", "pcss", "", Drawn),
                ms("window: reprojection, 64", "builtin:window", "reprojection", "", Drawn).with(REPROJECTED_64),
                ms("shanty town, 23 500: brute force, 64", "builtin:shanty", "multi_view", "", Drawn).with(VIEWS_64),
                ms("shanty town: PCSS", "builtin:shanty", "pcss", "", Drawn),
                ms("shanty town: reprojection, 64", "builtin:shanty", "reprojection", "", Drawn).with(REPROJECTED_64),
                ms("dragon, 100 000 (a knot): brute force, 64", DRAGON, "multi_view", "", Drawn).with(VIEWS_64),
                ms("dragon (a knot): PCSS", DRAGON, "pcss", "", Drawn),
                ms("dragon (a knot): reprojection, 64", DRAGON, "reprojection", "", Drawn).with(REPROJECTED_64),
                ms("ten dragons, 1 000 000 (knots): brute force, 64", TEN, "multi_view", "", Drawn).with(VIEWS_64),
                ms("ten dragons (knots): PCSS", TEN, "pcss", "", Drawn),
                ms("ten dragons (knots): reprojection, 64", TEN, "reprojection", "", Drawn).with(REPROJECTED_64),
            ],
        },
        Exhibit {
            id: "figure4",
            shows: "Difference between brute force and reprojection, 64 samples of 512²",
            rows: &[
                error("brute force", "builtin:shanty", "multi_view").with(VIEWS_64).at(640, 360),
                error("reprojection", "builtin:shanty", "reprojection").with(REPROJECTED_64).at(640, 360),
            ],
        },
        drawing("figure5", "A rasterised depth map, and one with the gaps of reprojection"),
        Exhibit {
            id: "figure6",
            shows: "Final shadows of brute force, reprojection and PCSS on window, shanty town and dragon",
            rows: &[
                error("window: brute force", "builtin:window", "multi_view").with(VIEWS_64).at(640, 360),
                error("window: PCSS", "builtin:window", "pcss").at(640, 360),
                error("window: reprojection", "builtin:window", "reprojection").with(VIEWS_64).at(640, 360),
                error("shanty town: brute force", "builtin:shanty", "multi_view").with(VIEWS_64).at(640, 360),
                error("shanty town: PCSS", "builtin:shanty", "pcss").at(640, 360),
                error("shanty town: reprojection", "builtin:shanty", "reprojection").with(VIEWS_64).at(640, 360),
                error("dragon (a knot): brute force", DRAGON, "multi_view").with(VIEWS_64).at(640, 360),
                error("dragon (a knot): PCSS", DRAGON, "pcss").at(640, 360),
                error("dragon (a knot): reprojection", DRAGON, "reprojection").with(VIEWS_64).at(640, 360),
            ],
        },
    ],
};

/// Part of the label of the passes in which brute force draws its views.
const DEPTH: &str = "depth";
