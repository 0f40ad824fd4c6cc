//! Marrs, Watson, Healey 2014. Times are drawn as curves but for Figure 1's two numbers; the window's size is not said.

use super::SKETCHED_PCSS;
use crate::reproduce::exhibit::Reported::{Drawn, Number};
use crate::reproduce::exhibit::{Exhibit, Paper, Row, error, ms};

/// Parameters of a row.
type Settings = &'static [(&'static str, &'static str)];

/// Poisson-disc light points, even maps of 512², 2 × 2 hardware comparison: the paper's section 4.
const VIEWS_64: Settings =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("compare", "hardware"), ("window", "plain")];
const VIEWS_32: Settings =
    &[("samples", "32"), ("view_size", "512"), ("sample_set", "poisson"), ("compare", "hardware"), ("window", "plain")];
const VIEWS_16: Settings =
    &[("samples", "16"), ("view_size", "512"), ("sample_set", "poisson"), ("compare", "hardware"), ("window", "plain")];
/// The same views reprojected from a central map of twice their size.
const SYNC_64: Settings = &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson")];
const SYNC_32: Settings = &[("samples", "32"), ("view_size", "512"), ("sample_set", "poisson")];
const SYNC_16: Settings = &[("samples", "16"), ("view_size", "512"), ("sample_set", "poisson")];
const UNSYNC_64: Settings =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("synchronized", "false")];
const UNSYNC_32: Settings =
    &[("samples", "32"), ("view_size", "512"), ("sample_set", "poisson"), ("synchronized", "false")];
const UNSYNC_16: Settings =
    &[("samples", "16"), ("view_size", "512"), ("sample_set", "poisson"), ("synchronized", "false")];
/// Section 3.1.2 and 4.1: the same in fragment shaders, and the ways to a filterable map of section 4.1.2.
const THREE_PASS: Settings =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("path", "fragment")];
const TWO_PASS: Settings =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("path", "fragment_two_pass")];
const COPIED: Settings = &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("filter", "copy")];
const DRAWN: Settings = &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("filter", "draw")];
/// Section 4.2.1: central maps of other sizes.
const SAME_SIZE: Settings =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("central_scale", "1")];
const FOUR_TIMES: Settings =
    &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("central_scale", "4")];
/// As they come but for the view's size, which is the paper's.
const VIEWS_OF_512: Settings = &[("view_size", "512")];
const BIAS_BEFORE: Settings = &[("samples", "64"), ("view_size", "512"), ("sample_set", "poisson"), ("bias", "before")];

const WINDOW: &str = "builtin:window";
const SHANTY: &str = "builtin:shanty";
const DRAGON: &str = "builtin:knot?triangles=100000";
const TEN: &str = "builtin:ten-knots";

const fn brute(what: &'static str, scene: &'static str, settings: Settings) -> Row {
    ms(what, scene, "multi_view", "", Drawn).with(settings)
}

const fn reprojected(what: &'static str, scene: &'static str, settings: Settings) -> Row {
    ms(what, scene, "reprojection", "", Drawn).with(settings)
}

const fn pcss(what: &'static str, scene: &'static str) -> Row {
    ms(what, scene, "pcss", "", Drawn).with(SKETCHED_PCSS)
}

const fn picture(what: &'static str, scene: &'static str, technique: &'static str, settings: Settings) -> Row {
    error(what, scene, technique).with(settings).at(640, 360)
}

const fn size_row(what: &'static str, technique: &'static str, light_scale: f32) -> Row {
    picture(what, SHANTY, technique, VIEWS_OF_512).light_scaled(light_scale)
}

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
                ms("depth maps by synchronised reprojection", DRAGON, "reprojection", DEPTH, Number(0.48))
                    .with(SYNC_64),
            ],
        },
        Exhibit {
            id: "figure2",
            shows: "Depth bias before and after reprojection: before, surfaces shadow themselves",
            rows: &[
                picture("bias before reprojection", "builtin:tilted-planes", "reprojection", BIAS_BEFORE),
                picture("bias after reprojection", "builtin:tilted-planes", "reprojection", SYNC_64),
            ],
        },
        Exhibit {
            id: "figure3",
            shows: "Time over geometry: brute force, reprojection and PCSS on four scenes, 16 to 64 light samples",
            rows: &[
                brute("window, 780 triangles: brute force, 16", WINDOW, VIEWS_16),
                brute("window: brute force, 32", WINDOW, VIEWS_32),
                brute("window: brute force, 64", WINDOW, VIEWS_64),
                reprojected("window: synchronised, 16", WINDOW, SYNC_16),
                reprojected("window: synchronised, 32", WINDOW, SYNC_32),
                reprojected("window: synchronised, 64", WINDOW, SYNC_64),
                reprojected("window: unsynchronised, 16", WINDOW, UNSYNC_16),
                reprojected("window: unsynchronised, 32", WINDOW, UNSYNC_32),
                reprojected("window: unsynchronised, 64", WINDOW, UNSYNC_64),
                pcss("window: PCSS", WINDOW),
                brute("shanty town, 23 500: brute force, 16", SHANTY, VIEWS_16),
                brute("shanty town: brute force, 32", SHANTY, VIEWS_32),
                brute("shanty town: brute force, 64", SHANTY, VIEWS_64),
                reprojected("shanty town: synchronised, 16", SHANTY, SYNC_16),
                reprojected("shanty town: synchronised, 32", SHANTY, SYNC_32),
                reprojected("shanty town: synchronised, 64", SHANTY, SYNC_64),
                reprojected("shanty town: unsynchronised, 16", SHANTY, UNSYNC_16),
                reprojected("shanty town: unsynchronised, 32", SHANTY, UNSYNC_32),
                reprojected("shanty town: unsynchronised, 64", SHANTY, UNSYNC_64),
                pcss("shanty town: PCSS", SHANTY),
                brute("dragon, 100 000 (a knot): brute force, 16", DRAGON, VIEWS_16),
                brute("dragon (a knot): brute force, 32", DRAGON, VIEWS_32),
                brute("dragon (a knot): brute force, 64", DRAGON, VIEWS_64),
                reprojected("dragon (a knot): synchronised, 16", DRAGON, SYNC_16),
                reprojected("dragon (a knot): synchronised, 32", DRAGON, SYNC_32),
                reprojected("dragon (a knot): synchronised, 64", DRAGON, SYNC_64),
                reprojected("dragon (a knot): unsynchronised, 16", DRAGON, UNSYNC_16),
                reprojected("dragon (a knot): unsynchronised, 32", DRAGON, UNSYNC_32),
                reprojected("dragon (a knot): unsynchronised, 64", DRAGON, UNSYNC_64),
                pcss("dragon (a knot): PCSS", DRAGON),
                brute("ten dragons, 1 000 000 (knots): brute force, 16", TEN, VIEWS_16),
                brute("ten dragons (knots): brute force, 32", TEN, VIEWS_32),
                brute("ten dragons (knots): brute force, 64", TEN, VIEWS_64),
                reprojected("ten dragons (knots): synchronised, 16", TEN, SYNC_16),
                reprojected("ten dragons (knots): synchronised, 32", TEN, SYNC_32),
                reprojected("ten dragons (knots): synchronised, 64", TEN, SYNC_64),
                reprojected("ten dragons (knots): unsynchronised, 16", TEN, UNSYNC_16),
                reprojected("ten dragons (knots): unsynchronised, 32", TEN, UNSYNC_32),
                reprojected("ten dragons (knots): unsynchronised, 64", TEN, UNSYNC_64),
                pcss("ten dragons (knots): PCSS", TEN),
            ],
        },
        Exhibit {
            id: "section4.1",
            shows: "The fragment-shader forms, and the ways to filter integer maps",
            rows: &[
                reprojected("shanty town: compute", SHANTY, SYNC_64),
                reprojected("shanty town: fragments, three passes", SHANTY, THREE_PASS),
                reprojected("shanty town: fragments, two passes", SHANTY, TWO_PASS),
                reprojected("shanty town: copied to a float texture", SHANTY, COPIED),
                reprojected("shanty town: drawn to a depth texture", SHANTY, DRAWN),
            ],
        },
        Exhibit {
            id: "figure4",
            shows: "Difference between brute force and reprojection, 64 samples of 512²",
            rows: &[
                picture("brute force", SHANTY, "multi_view", VIEWS_64),
                picture("reprojection", SHANTY, "reprojection", SYNC_64),
            ],
        },
        Exhibit {
            id: "figure5",
            shows: "A rasterised depth map, and one with the gaps of reprojection, which leak light; here the leak itself",
            rows: &[
                picture("rasterised depth maps", SHANTY, "multi_view", VIEWS_64),
                picture("reprojected from a central map of a view's size", SHANTY, "reprojection", SAME_SIZE),
                picture("reprojected from one of twice the size", SHANTY, "reprojection", SYNC_64),
                picture("reprojected from one of four times the size", SHANTY, "reprojection", FOUR_TIMES),
                picture("reprojected from layers", SHANTY, "reprojection_layered", SYNC_64),
            ],
        },
        Exhibit {
            id: "figure6",
            shows: "Final shadows of brute force, reprojection and PCSS on window, shanty town and dragon",
            rows: &[
                picture("window: brute force", WINDOW, "multi_view", VIEWS_64),
                picture("window: PCSS", WINDOW, "pcss", SKETCHED_PCSS),
                picture("window: reprojection", WINDOW, "reprojection", SYNC_64),
                picture("window: reprojection from layers", WINDOW, "reprojection_layered", SYNC_64),
                picture("shanty town: brute force", SHANTY, "multi_view", VIEWS_64),
                picture("shanty town: PCSS", SHANTY, "pcss", SKETCHED_PCSS),
                picture("shanty town: reprojection", SHANTY, "reprojection", SYNC_64),
                picture("shanty town: reprojection from layers", SHANTY, "reprojection_layered", SYNC_64),
                picture("dragon (a knot): brute force", DRAGON, "multi_view", VIEWS_64),
                picture("dragon (a knot): PCSS", DRAGON, "pcss", SKETCHED_PCSS),
                picture("dragon (a knot): reprojection", DRAGON, "reprojection", SYNC_64),
                picture("dragon (a knot): reprojection from layers", DRAGON, "reprojection_layered", SYNC_64),
            ],
        },
        Exhibit {
            id: "section4.3",
            shows: "The limitation: error over the light's size, here from a quarter of the scene's own to eight times",
            rows: &[
                size_row("a quarter: reprojection", "reprojection", 0.25),
                size_row("a half: reprojection", "reprojection", 0.5),
                size_row("the scene's own: reprojection", "reprojection", 1.0),
                size_row("twice: reprojection", "reprojection", 2.0),
                size_row("four times: reprojection", "reprojection", 4.0),
                size_row("eight times: reprojection", "reprojection", 8.0),
                size_row("a quarter: from layers", "reprojection_layered", 0.25),
                size_row("a half: from layers", "reprojection_layered", 0.5),
                size_row("the scene's own: from layers", "reprojection_layered", 1.0),
                size_row("twice: from layers", "reprojection_layered", 2.0),
                size_row("four times: from layers", "reprojection_layered", 4.0),
                size_row("eight times: from layers", "reprojection_layered", 8.0),
            ],
        },
    ],
};

/// Part of the labels of the passes that make depth maps, central or of views.
const DEPTH: &str = "depth";
