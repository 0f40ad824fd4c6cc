//! Sintorn, Eisemann, Assarsson 2008. Frames a second of whole frames at 512 × 512.

use super::SKETCHED_PCSS;
use crate::reproduce::exhibit::Reported::Drawn;
use crate::reproduce::exhibit::{Exhibit, Paper, drawing, error, fps, ms};

const SAMPLES_128: &[(&str, &str)] = &[("samples", "128")];
const SAMPLES_256: &[(&str, &str)] = &[("samples", "256")];

/// Even maps without what this library adds to them, as the paper compares with.
const MAPS_128: &[(&str, &str)] = &[("samples", "128"), ("window", "plain"), ("compare", "gather")];
const MAPS_256: &[(&str, &str)] = &[("samples", "256"), ("window", "plain"), ("compare", "gather")];
const MAPS_512: &[(&str, &str)] = &[("samples", "512"), ("window", "plain"), ("compare", "gather")];
const MAPS_1024: &[(&str, &str)] = &[("samples", "1024"), ("window", "plain"), ("compare", "gather")];

pub const PAPER: Paper = Paper {
    id: "sintorn-2008",
    citation: "E. Sintorn, E. Eisemann, U. Assarsson: Sample Based Visibility for Soft Shadows using Alias-free Shadow \
               Maps, EGSR 2008",
    hardware: "NVIDIA GeForce 8800 GTS 512",
    exhibits: &[
        Exhibit {
            id: "figure1",
            shows: "One depth layer against accurate visibility",
            rows: &[
                error("one depth layer (PCSS)", "builtin:columns", "pcss").with(SKETCHED_PCSS).at(512, 512),
                error("sample-based, 256", "builtin:columns", "sample_based").with(SAMPLES_256).at(512, 512),
            ],
        },
        drawing("figure2", "Which view-samples are stored in the shadow map"),
        drawing("figure3", "Memory layout of the lists"),
        drawing("figure4", "Conservative rasterisation"),
        drawing("figure5", "A triangle's region of influence"),
        drawing("figure6", "The bit mask of light samples behind a plane"),
        Exhibit {
            id: "figure7",
            shows: "128 light samples, and other ones in each frame, added up for a second (32 frames)",
            rows: &[
                error("no jittering", "builtin:columns", "sample_based").with(SAMPLES_128).at(512, 512),
                error("turned by pixel", "builtin:columns", "sample_based")
                    .with(&[("samples", "128"), ("rotate", "true")])
                    .at(512, 512),
                error("jittering, 32 frames", "builtin:columns", "sample_based")
                    .with(&[("samples", "128"), ("accumulate", "true")])
                    .after_frames(32)
                    .at(512, 512),
            ],
        },
        // `antumbra render builtin:spheres --coherent` shows it; docs/limits.md has both pictures.
        drawing("figure8", "Bent normals: `antumbra render SCENE --coherent`"),
        Exhibit {
            id: "figure9",
            shows: "Sponza with 256 light samples",
            rows: &[
                fps("sample-based, 256", "sponza.glb", "sample_based", 2.6).with(SAMPLES_256).at(512, 512),
                ms("shadow maps, 256", "sponza.glb", "multi_view", "", Drawn).with(MAPS_256).at(512, 512),
            ],
        },
        Exhibit {
            id: "figure10",
            shows: "A large penumbra with 128 and 512 light samples",
            rows: &[
                error("sample-based, 128", "builtin:columns", "sample_based").with(SAMPLES_128).at(512, 512),
                error("sample-based, 512", "builtin:columns", "sample_based").with(&[("samples", "512")]).at(512, 512),
            ],
        },
        Exhibit {
            id: "figure11",
            shows: "Time over the number of triangles, 128 light samples",
            rows: &[
                ms("10 000 triangles", "builtin:knot?triangles=10000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512),
                ms("100 000 triangles", "builtin:knot?triangles=100000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512),
                ms("1 000 000 triangles", "builtin:knot?triangles=1000000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512),
            ],
        },
        Exhibit {
            id: "figure12",
            shows: "Time over the radius of the light, 6 000 triangles, 256 light samples",
            rows: &[
                ms("half the radius", "builtin:knot?triangles=6000", "sample_based", "", Drawn)
                    .with(SAMPLES_256)
                    .light_scaled(0.5)
                    .at(512, 512),
                ms("the scene's radius", "builtin:knot?triangles=6000", "sample_based", "", Drawn)
                    .with(SAMPLES_256)
                    .light_scaled(1.0)
                    .at(512, 512),
                ms("twice the radius", "builtin:knot?triangles=6000", "sample_based", "", Drawn)
                    .with(SAMPLES_256)
                    .light_scaled(2.0)
                    .at(512, 512),
                ms("four times the radius", "builtin:knot?triangles=6000", "sample_based", "", Drawn)
                    .with(SAMPLES_256)
                    .light_scaled(4.0)
                    .at(512, 512),
            ],
        },
        Exhibit {
            id: "figure13",
            shows: "Time over the number of light samples, against as many shadow maps",
            rows: &[
                ms("shadow maps, 128", "builtin:columns", "multi_view", "", Drawn).with(MAPS_128).at(512, 512),
                ms("shadow maps, 256", "builtin:columns", "multi_view", "", Drawn).with(MAPS_256).at(512, 512),
                ms("shadow maps, 512", "builtin:columns", "multi_view", "", Drawn).with(MAPS_512).at(512, 512),
                ms("shadow maps, 1024", "builtin:columns", "multi_view", "", Drawn).with(MAPS_1024).at(512, 512),
                ms("sample-based, 128", "builtin:columns", "sample_based", "", Drawn).with(SAMPLES_128).at(512, 512),
                ms("sample-based, 256", "builtin:columns", "sample_based", "", Drawn).with(SAMPLES_256).at(512, 512),
                ms("sample-based, 128, by the table", "builtin:columns", "sample_based", "", Drawn)
                    .with(&[("samples", "128"), ("evaluation", "lookup")])
                    .at(512, 512),
                ms("sample-based, 512", "builtin:columns", "sample_based", "", Drawn)
                    .with(&[("samples", "512")])
                    .at(512, 512),
                ms("sample-based, 1024", "builtin:columns", "sample_based", "", Drawn)
                    .with(&[("samples", "1024")])
                    .at(512, 512),
            ],
        },
        Exhibit {
            id: "figure14",
            shows: "A hairball of 44 000 triangles, hard and soft",
            rows: &[
                fps("alias-free hard shadows", "builtin:hairball", "alias_free", 66.0).at(512, 512),
                error("alias-free hard shadows", "builtin:hairball", "alias_free").at(512, 512),
                ms("shadow map", "builtin:hairball", "hard", "", Drawn).at(512, 512),
                error("shadow map", "builtin:hairball", "hard").at(512, 512),
                error("sample-based, 256", "builtin:hairball", "sample_based").with(SAMPLES_256).at(512, 512),
            ],
        },
        Exhibit {
            id: "figure15",
            shows: "Large scenes: 90 000, 70 000 and 379 000 triangles",
            rows: &[
                fps("ring in grass, 379 000", "builtin:ring-in-grass", "sample_based", 0.65)
                    .with(SAMPLES_256)
                    .at(512, 512),
                fps("tree, 85 000 (the paper's: 90 000)", "builtin:tree", "sample_based", 7.0)
                    .with(SAMPLES_256)
                    .at(512, 512),
                ms("ring in grass: shadow maps, 256", "builtin:ring-in-grass", "multi_view", "", Drawn)
                    .with(MAPS_256)
                    .at(512, 512),
            ],
        },
    ],
};
