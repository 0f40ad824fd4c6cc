//! Shen, Feng, Yang 2013. Its scenes are not to be had; ours of the same kinds stand in.

use crate::reproduce::exhibit::Reported::{Drawn, Number};
use crate::reproduce::exhibit::{Exhibit, Paper, Row, drawing, error, ms};

const OGRE: &str = "builtin:knot?triangles=100000";
const PLANTS: &str = "builtin:tree";
const DINOSAURS: &str = "builtin:ten-knots";
const TRAFFIC: &str = "builtin:street";

/// The paper's settings, its section 8: μ = 20, 3 × 3 parts, H = 5, Level0; sums by recursive doubling. As `essm:paper`, whose
/// exponent goes with μ.
const PRINTED: &[(&str, &str)] = &[
    ("table", "tile_grid"),
    ("scan", "doubling"),
    ("window", "square"),
    ("precision_bits", "20"),
    ("exponent", "13.863"),
    ("subdivisions", "3"),
    ("search", "window"),
    ("cuts", "squares"),
    ("direct_texels", "0"),
    ("kernel", "ellipse"),
    ("row_height", "5"),
    ("level", "0"),
];

/// One size of map: the paper's one table and its tile grids, by its recursive doubling, then by our passes, then the tiles
/// that hold at any depth. Milliseconds of table and shadow as printed.
macro_rules! table2 {
    ($( $size:literal: $sat:literal, $sat_shadow:literal, $stg:literal, $stg_shadow:literal; )+) => {
        &[$(
            table2!(row $size, "one table, doubling", "float", "doubling", "table", $sat),
            table2!(row $size, "one table, blocks", "float", "blocks", "table", $sat),
            table2!(row $size, "one table: shadow", "float", "blocks", "resolve", $sat_shadow),
            table2!(row $size, "tile grids, doubling", "tile_grid", "doubling", "table", $stg),
            table2!(row $size, "tile grids, one pass", "tile_grid", "blocks", "table", $stg),
            table2!(row $size, "tile grids: shadow", "tile_grid", "blocks", "resolve", $stg_shadow),
            table2!(row $size, "tiles of their own range", "tiles", "blocks", "table", $stg),
            table2!(row $size, "tiles of their own range: shadow", "tiles", "blocks", "resolve", $stg_shadow),
        )+]
    };
    (row $size:literal, $what:literal, $table:literal, $scan:literal, $passes:literal, $paper:literal) => {
        ms(concat!($what, ", ", $size, "²"), TRAFFIC, "essm", $passes, Number($paper))
            .with(&[("table", $table), ("scan", $scan), ("subdivisions", "3"), ("map_size", $size)])
            .at(1280, 960)
    };
}

/// Behind a lattice every pixel is searched and most are filtered, whatever the light's size.
const LATTICE: &str = "builtin:window";

/// The shadow pass under a light of another size. The paper has no numbers for it, only the word.
const fn over_light(what: &'static str, technique: &'static str, light_scale: f32) -> Row {
    ms(what, LATTICE, technique, "resolve", Drawn).light_scaled(light_scale).at(640, 360)
}

pub const PAPER: Paper = Paper {
    id: "shen-2013",
    citation: "L. Shen, J. Feng, B. Yang: Exponential Soft Shadow Mapping, Computer Graphics Forum 32(4), 2013",
    hardware: "NVIDIA GeForce GTX 465",
    exhibits: &[
        Exhibit {
            id: "figure1",
            shows: "ESSM on four scenes",
            rows: &[
                error("ogre (a knot)", "builtin:knot?triangles=100000", "essm").at(640, 480),
                error("plants (a tree)", "builtin:tree", "essm").at(640, 480),
                error("traffic (a street)", "builtin:street", "essm").at(640, 480),
            ],
        },
        drawing("figure2", "Functions that reconstruct the shadow test"),
        drawing("figure3", "The soft shadow's filter convolved with the pixel's footprint"),
        drawing("figure4", "Rasterisation of the elliptical footprint"),
        Exhibit {
            id: "figure5",
            shows: "Noise of one summed-area table, and of tile grids",
            rows: &[
                error("one table of floats", "builtin:street", "essm")
                    .with(&[("table", "float"), ("window", "square")])
                    .at(640, 480),
                error("tile grids as printed", "builtin:street", "essm").with(PRINTED).at(640, 480),
                error("tiles with their own range", "builtin:street", "essm").at(640, 480),
            ],
        },
        Exhibit {
            id: "table1",
            shows: "Milliseconds for each stage, on four scenes",
            rows: &[
                ms("ogre (a knot): basis", OGRE, "essm", "basis", Number(0.21)).with(PRINTED).at(1280, 960),
                ms("ogre (a knot): tile grids", OGRE, "essm", "table", Number(1.90)).with(PRINTED).at(1280, 960),
                ms("ogre (a knot): shadow", OGRE, "essm", "resolve", Number(4.13)).with(PRINTED).at(1280, 960),
                ms("plants (a tree): basis", PLANTS, "essm", "basis", Number(0.56)).with(PRINTED).at(1280, 960),
                ms("plants (a tree): tile grids", PLANTS, "essm", "table", Number(4.43)).with(PRINTED).at(1280, 960),
                ms("plants (a tree): shadow", PLANTS, "essm", "resolve", Number(4.62)).with(PRINTED).at(1280, 960),
                ms("dinosaurs (ten knots): basis", DINOSAURS, "essm", "basis", Number(0.52))
                    .with(PRINTED)
                    .at(1280, 960),
                ms("dinosaurs (ten knots): tile grids", DINOSAURS, "essm", "table", Number(4.22))
                    .with(PRINTED)
                    .at(1280, 960),
                ms("dinosaurs (ten knots): shadow", DINOSAURS, "essm", "resolve", Number(3.51))
                    .with(PRINTED)
                    .at(1280, 960),
                ms("traffic (a street): basis", TRAFFIC, "essm", "basis", Number(9.6)).with(PRINTED).at(1280, 960),
                ms("traffic (a street): tile grids", TRAFFIC, "essm", "table", Number(41.3))
                    .with(PRINTED)
                    .at(1280, 960),
                ms("traffic (a street): shadow", TRAFFIC, "essm", "resolve", Number(10.4)).with(PRINTED).at(1280, 960),
            ],
        },
        Exhibit {
            id: "table2",
            shows: "Summed-area tables and tile grids over the size of the map: making them, and the shadow pass",
            rows: table2! {
                "512": 1.8, 4.0, 1.5, 4.1;
                "1024": 6.8, 4.2, 4.5, 4.6;
                "2048": 28.2, 5.7, 18.3, 6.2;
                "4096": 121.1, 8.6, 41.3, 10.4;
            },
        },
        Exhibit {
            id: "figure6",
            shows: "CSSM, VSSM and ESSM at a map of 512²",
            rows: &[
                error("CSSM", "builtin:fence-geometry", "cssm").with(&[("map_size", "512")]).at(640, 480),
                error("VSSM", "builtin:fence-geometry", "vssm").with(&[("map_size", "512")]).at(640, 480),
                error("ESSM", "builtin:fence-geometry", "essm").with(&[("map_size", "512")]).at(640, 480),
                error("analytic", "builtin:fence-geometry", "pcss_anisotropic")
                    .with(&[("map_size", "512"), ("samples", "256"), ("kernel", "parallelogram")])
                    .at(640, 480),
            ],
        },
        Exhibit {
            id: "figure7",
            shows: "VSSM and ESSM in a large scene, map of 4096²",
            rows: &[
                error("VSSM", "builtin:street", "vssm").with(&[("map_size", "4096")]).at(640, 480),
                error("ESSM", "builtin:street", "essm").with(&[("map_size", "4096")]).at(640, 480),
            ],
        },
        Exhibit {
            id: "figure8",
            shows: "Artefacts of ESSM and PCSS against 32 × 32 light points, map of 512²",
            rows: &[
                error("PCSS", "builtin:overlap", "pcss")
                    .with(&[("map_size", "512"), ("attach_contacts", "false")])
                    .at(640, 480),
                error("ESSM", "builtin:overlap", "essm").with(&[("map_size", "512")]).at(640, 480),
            ],
        },
        Exhibit {
            id: "section2",
            shows: "Constant time for any size of light: the shadow pass, from where kernels are some 15 texels wide; PCSS \
                    with the taps that keep its error",
            rows: &[
                over_light("ESSM, 1024², light", "essm", 1.0),
                over_light("ESSM, 1024², 8 times the light", "essm", 8.0),
                over_light("ESSM, 4096², a quarter of the light", "essm", 0.25).with(&[("map_size", "4096")]),
                over_light("ESSM, 4096², twice the light", "essm", 2.0).with(&[("map_size", "4096")]),
                over_light("PCSS, 64 taps, a quarter of the light", "pcss", 0.25).with(&[
                    ("samples", "64"),
                    ("search_samples", "64"),
                    ("attach_contacts", "false"),
                ]),
                over_light("PCSS, 256 taps, twice the light", "pcss", 2.0).with(&[
                    ("samples", "256"),
                    ("search_samples", "256"),
                    ("attach_contacts", "false"),
                ]),
            ],
        },
    ],
};
