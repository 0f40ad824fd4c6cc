//! Shen, Feng, Yang 2013. Its scenes are not to be had; ours of the same kinds stand in.

use crate::reproduce::exhibit::Reported::Number;
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, error, ms};

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
        drawing("figure5", "Summed-area tables with and without adaptive tiles"),
        Exhibit {
            id: "table1",
            shows: "Milliseconds for each stage, on four scenes",
            rows: &[
                ms("ogre (a knot): shadow", "builtin:knot?triangles=100000", "essm", "resolve", Number(4.13))
                    .at(1280, 960),
                ms("plants (a tree): shadow", "builtin:tree", "essm", "resolve", Number(4.62)).at(1280, 960),
                ms("traffic (a street): tile grids", "builtin:street", "essm", "table", Number(41.3)).at(1280, 960),
                ms("traffic (a street): shadow", "builtin:street", "essm", "resolve", Number(10.4)).at(1280, 960),
            ],
        },
        Exhibit {
            id: "table2",
            shows: "Summed-area tables and tile grids over the size of the map",
            rows: &[
                ms("tile grids, 512²", "builtin:street", "essm", "table", Number(1.5))
                    .with(&[("map_size", "512")])
                    .at(1280, 960),
                ms("tile grids, 1024²", "builtin:street", "essm", "table", Number(4.5))
                    .with(&[("map_size", "1024")])
                    .at(1280, 960),
                ms("tile grids, 2048²", "builtin:street", "essm", "table", Number(18.3))
                    .with(&[("map_size", "2048")])
                    .at(1280, 960),
                ms("tile grids, 4096²", "builtin:street", "essm", "table", Number(41.3))
                    .with(&[("map_size", "4096")])
                    .at(1280, 960),
            ],
        },
        Exhibit {
            id: "figure6",
            shows: "CSSM, VSSM and ESSM at a map of 512²",
            rows: &[
                error("CSSM", "builtin:fence-geometry", "cssm").with(&[("map_size", "512")]).at(640, 480),
                error("VSSM", "builtin:fence-geometry", "vssm").with(&[("map_size", "512")]).at(640, 480),
                error("ESSM", "builtin:fence-geometry", "essm").with(&[("map_size", "512")]).at(640, 480),
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
                error("PCSS", "builtin:overlap", "pcss").with(&[("map_size", "512")]).at(640, 480),
                error("ESSM", "builtin:overlap", "essm").with(&[("map_size", "512")]).at(640, 480),
            ],
        },
    ],
};
