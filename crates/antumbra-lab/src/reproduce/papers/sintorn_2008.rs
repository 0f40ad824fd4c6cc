//! Sintorn, Eisemann, Assarsson 2008. Frames per second are of whole frames at 512 × 512.

use super::SKETCHED_PCSS;
use crate::reproduce::claim::{Rule, claim, not_here};
use crate::reproduce::exhibit::Reported::Drawn;
use crate::reproduce::exhibit::{Exhibit, Paper, Row, Settings, difference, drawing, error, fps, ms};
use crate::reproduce::figure::Figure::{Ms, Noise, Rmse, UmbraLeak};

const SAMPLES_128: Settings = &[("samples", "128")];
const SAMPLES_256: Settings = &[("samples", "256")];

/// Bitmask soft shadows of one to four depth layers, with as many light samples. With 64 squares along the light they take longer for
/// the same error (at 192 × 192 an rmse of .0137, with 16 of .0138).
const ONE_LAYER: Settings = &[("samples", "256"), ("layers", "1"), ("patches", "16")];
const TWO_LAYERS: Settings = &[("samples", "256"), ("layers", "2"), ("patches", "16")];
const THREE_LAYERS: Settings = &[("samples", "256"), ("layers", "3"), ("patches", "16")];
const FOUR_LAYERS: Settings = &[("samples", "256"), ("layers", "4"), ("patches", "16")];
/// Panels behind one another, aligned with the light: two or more depths of occluders in two fifths of the penumbra (128 × 72), where
/// a ring of columns has one depth in 99 % of it, and shows nothing of layers.
const PANELS: &str = "builtin:stacked-panels";
/// Outlines of a single map's texels.
const OUTLINES: Settings = &[("occluders", "outlines"), ("squares", "64")];
/// Equation 1, sample by sample.
const IRRADIANCE_256: Settings = &[("samples", "256"), ("weights", "irradiance")];
/// Section 4.3: a subset of the view-samples, and reconstruction.
const SUBSET_256: Settings = &[("samples", "256"), ("sub", "true")];

/// Row of figure 7: number of accumulated frames with different light samples.
const fn jittered(what: &'static str, frames: u32) -> Row {
    error(what, "builtin:columns", "sample_based")
        .with(&[("samples", "128"), ("accumulate", "true")])
        .after_frames(frames)
        .plotted("frames that add up", "jittering", frames as f64)
        .at(512, 512)
}

/// Product of lighting and visibility against equation 1, under the plank's square light, 0.6 m wide and 5.4 m away, or a larger one.
const fn factored(what: &'static str, light_scale: f32) -> Row {
    difference(what, "builtin:leaning-plank", "sample_based", ("sample_based", IRRADIANCE_256))
        .with(SAMPLES_256)
        .light_scaled(light_scale)
        .plotted("light's width over its distance", "factored", 0.111 * light_scale as f64)
        .at(512, 512)
}

/// Atrium seen from above its floor, along it: the paper's figure 9.
const ATRIUM: &str = "sponza-atrium";

/// Figure 7 with more light points.
const FIGURE_7_IF_TOO_CLOSE: &str = "\
    more light points and pixels: by `--samples 1024` errors are .0012 after 32 frames and .0045 without jittering (128 × 72). Noise \
    is judged where the truth changes by less than a fiftieth a pixel, as penumbrae do in larger images: at 256 × 256 it is .0001 and \
    .0003, which is a third, and still hardly more than an image shows";

/// Factor of a light too small for any penumbra, the reference of hard shadows.
const POINT: f32 = 1e-4;

/// "About an order of magnitude": ten times at the least, and nearer to ten than to a hundred, by their logarithms.
const AN_ORDER: [f64; 2] = [10.0, 32.0];

/// Even maps without this library's additions, as the paper compares with.
const MAPS_128: Settings = &[("samples", "128"), ("window", "plain"), ("compare", "gather")];
const MAPS_256: Settings = &[("samples", "256"), ("window", "plain"), ("compare", "gather")];
const MAPS_512: Settings = &[("samples", "512"), ("window", "plain"), ("compare", "gather")];
const MAPS_1024: Settings = &[("samples", "1024"), ("window", "plain"), ("compare", "gather")];

pub const PAPER: Paper = Paper {
    id: "sintorn-2008",
    citation: "E. Sintorn, E. Eisemann, U. Assarsson: Sample Based Visibility for Soft Shadows using Alias-free \
               Shadow Maps, EGSR 2008",
    hardware: "NVIDIA GeForce 8800 GTS 512",
    bandwidth_gb_s: 62.0,
    own: &["alias_free", "sample_based"],
    exhibits: &[
        Exhibit {
            id: "equation1",
            shows: "Visibility separate from lighting, compared with irradiance per light sample, under lights of several sizes",
            rows: &[
                factored("a ninth of its distance", 1.0),
                factored("two ninths", 2.0),
                factored("four ninths", 4.0),
                factored("eight ninths", 8.0),
            ],
            claims: &[claim(
                "The factored solution differs little if receivers are at a certain distance from the source.",
                &[
                    Rule::AtMost(Rmse, "a ninth of its distance", 0.01),
                    Rule::RatioAtLeast(Rmse, "eight ninths", "a ninth of its distance", 3.0),
                ],
            )],
            note: "",
        },
        Exhibit {
            id: "figure1",
            shows: "One depth layer compared with accurate visibility, where four depths are behind one another and a face is \
                 aligned with the light",
            rows: &[
                error("one depth layer (bitmask)", PANELS, "bitmask").with(ONE_LAYER).at(512, 512),
                error("two depth layers (bitmask)", PANELS, "bitmask").with(TWO_LAYERS).at(512, 512),
                error("three depth layers (bitmask)", PANELS, "bitmask").with(THREE_LAYERS).at(512, 512),
                error("four depth layers (bitmask)", PANELS, "bitmask").with(FOUR_LAYERS).at(512, 512),
                error("one depth layer (backprojection)", PANELS, "backprojection").with(OUTLINES).at(512, 512),
                error("one depth layer (PCSS)", PANELS, "pcss").with(SKETCHED_PCSS).at(512, 512),
                error("sample-based, 256", PANELS, "sample_based").with(SAMPLES_256).at(512, 512),
            ],
            claims: &[
                claim(
                    "One depth layer is not enough, even with light samples as bits or occluders as outlines; sampled \
                     visibility is accurate.",
                    &[
                        Rule::RatioAtMost(Rmse, "sample-based, 256", "one depth layer (bitmask)", 0.5),
                        Rule::RatioAtMost(Rmse, "sample-based, 256", "one depth layer (backprojection)", 0.5),
                        Rule::RatioAtMost(Rmse, "sample-based, 256", "one depth layer (PCSS)", 0.25),
                        Rule::AtMost(Rmse, "sample-based, 256", 0.01),
                    ],
                ),
                claim(
                    "This case needs four layers: with three, the bitmasks of Schwarz and Stamminger still leak light.",
                    &[
                        Rule::RatioAtMost(UmbraLeak, "four depth layers (bitmask)", "three depth layers (bitmask)", 0.5),
                        Rule::RatioAtMost(Rmse, "four depth layers (bitmask)", "one depth layer (bitmask)", 0.25),
                        Rule::AtMost(Rmse, "four depth layers (bitmask)", 0.02),
                    ],
                ),
            ],
            note: "",
        },
        drawing("figure2", "Which view-samples are stored in the shadow map"),
        drawing("figure3", "Memory layout of the lists"),
        drawing("figure4", "Conservative rasterisation"),
        drawing("figure5", "A triangle's region of influence"),
        drawing("figure6", "The bit mask of light samples behind a plane"),
        Exhibit {
            id: "figure7",
            shows: "128 light samples, and different ones in each frame, averaged over a second (32 frames)",
            rows: &[
                error("no jittering", "builtin:columns", "sample_based").with(SAMPLES_128).at(512, 512),
                error("turned by pixel", "builtin:columns", "sample_based")
                    .with(&[("samples", "128"), ("rotate", "true")])
                    .at(512, 512),
                jittered("jittering, 1 frame", 1),
                jittered("jittering, 2 frames", 2),
                jittered("jittering, 4 frames", 4),
                jittered("jittering, 8 frames", 8),
                jittered("jittering, 16 frames", 16),
                jittered("jittering, 32 frames", 32),
            ],
            claims: &[claim(
                "Different light samples in each frame average to a smooth shadow.",
                &[
                    Rule::RatioAtMost(Noise, "jittering, 32 frames", "no jittering", 0.75),
                    Rule::RatioAtMost(Rmse, "jittering, 32 frames", "no jittering", 0.75),
                ],
            )
            .if_too_close(FIGURE_7_IF_TOO_CLOSE)],
            note: "",
        },
        Exhibit {
            id: "section4.3",
            shows: "A subset of the view-samples and a reconstruction step, which the paper proposes without times",
            rows: &[
                error("every view-sample", "builtin:columns", "sample_based").with(SAMPLES_256).timed().at(512, 512),
                error("a subset, reconstructed", "builtin:columns", "sample_based").with(SUBSET_256).timed().at(512, 512),
                ms("every view-sample: time", "builtin:columns", "sample_based", "", Drawn).with(SAMPLES_256).at(512, 512),
                ms("a subset: time", "builtin:columns", "sample_based", "", Drawn).with(SUBSET_256).at(512, 512),
            ],
            claims: &[
                claim(
                    "A reconstruction step yields the final image from a subset of the view-samples.",
                    &[Rule::AtMost(Rmse, "a subset, reconstructed", 0.03)],
                )
                .because_both(
                    "a smaller image has a larger fraction of pixels at edges, where neighbours that differ by less than a \
                     quarter are interpolated: `columns` has .0225 at the paper's 512² and .034 at 320 × 180.",
                ),
                claim(
                    "A subset saves computations.",
                    &[Rule::RatioAtMost(Ms, "a subset: time", "every view-sample: time", 0.8)],
                ),
            ],
            note: "",
        },
        // `antumbra render builtin:spheres --coherent` shows it; docs/limits.md has both images.
        drawing("figure8", "Bent normals: `antumbra render SCENE --coherent`"),
        Exhibit {
            id: "figure9",
            shows: "Sponza with 256 light samples",
            rows: &[
                fps("sample-based, 256", "sponza.glb", "sample_based", 2.6).seen(ATRIUM).with(SAMPLES_256).at(512, 512),
                ms("shadow maps, 256", "sponza.glb", "multi_view", "", Drawn)
                    .seen(ATRIUM)
                    .slow()
                    .with(MAPS_256)
                    .at(512, 512),
            ],
            claims: &[claim(
                "Sample-based visibility is about an order of magnitude faster than the same number of shadow maps.",
                &[Rule::RatioWithin(Ms, "shadow maps, 256", "sample-based, 256", AN_ORDER)],
            )],
            note: "",
        },
        Exhibit {
            id: "figure10",
            shows: "A large penumbra with 128 and 512 light samples",
            rows: &[
                error("sample-based, 128", "builtin:columns", "sample_based").with(SAMPLES_128).timed().at(512, 512),
                error("sample-based, 512", "builtin:columns", "sample_based")
                    .with(&[("samples", "512")])
                    .timed()
                    .at(512, 512),
            ],
            claims: &[claim(
                "More light samples lower the error of a large penumbra.",
                &[Rule::RatioAtMost(Rmse, "sample-based, 512", "sample-based, 128", 0.75)],
            )],
            note: "",
        },
        Exhibit {
            id: "figure11",
            shows: "Time by the number of triangles, 128 light samples",
            rows: &[
                ms("10 000 triangles", "builtin:knot?triangles=10000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512),
                ms("100 000 triangles", "builtin:knot?triangles=100000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512),
                ms("300 000 triangles", "builtin:knot?triangles=300000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512),
                ms("1 000 000 triangles", "builtin:knot?triangles=1000000", "sample_based", "", Drawn)
                    .with(SAMPLES_128)
                    .at(512, 512)
                    .slow(),
            ],
            claims: &[claim(
                "Time is mostly linear in the number of triangles.",
                &[
                    Rule::RatioWithin(Ms, "300 000 triangles", "100 000 triangles", [2.0, 4.0]),
                    Rule::RatioWithin(Ms, "1 000 000 triangles", "100 000 triangles", [5.0, 14.0]),
                ],
            )],
            note: "",
        },
        Exhibit {
            id: "figure12",
            shows: "Time by the radius of the light, 6 000 triangles, 256 light samples",
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
            claims: &[claim(
                "Time is linear in the light's radius: half the radius takes half the time, twice the radius twice the time.",
                &[
                    Rule::RatioWithin(Ms, "half the radius", "the scene's radius", [0.4, 0.65]),
                    Rule::RatioWithin(Ms, "twice the radius", "the scene's radius", [1.55, 2.5]),
                    Rule::RatioWithin(Ms, "four times the radius", "twice the radius", [1.55, 2.5]),
                ],
            )
            .because_both(
                "part of the time does not depend on the radius: that of building lists, and regions of influence are at least \
                 as large as their triangles.",
            )
            .on_any_adapter()],
            note: "",
        },
        Exhibit {
            id: "figure13",
            shows: "Time by the number of light samples, compared with the same number of shadow maps",
            rows: &[
                ms("shadow maps, 128", "builtin:columns", "multi_view", "", Drawn).with(MAPS_128).at(512, 512),
                ms("shadow maps, 256", "builtin:columns", "multi_view", "", Drawn).with(MAPS_256).at(512, 512),
                ms("shadow maps, 512", "builtin:columns", "multi_view", "", Drawn).with(MAPS_512).at(512, 512).slow(),
                ms("shadow maps, 1024", "builtin:columns", "multi_view", "", Drawn).with(MAPS_1024).at(512, 512).slow(),
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
            claims: &[
                claim(
                    "Eight times as many light samples, 128 to 1024, take about twice the time.",
                    &[Rule::RatioWithin(Ms, "sample-based, 1024", "sample-based, 128", [1.5, 2.7])],
                ),
                claim(
                    "Sample-based visibility is about an order of magnitude faster than the same number of shadow maps.",
                    &[
                        Rule::RatioWithin(Ms, "shadow maps, 256", "sample-based, 256", AN_ORDER),
                        Rule::RatioWithin(Ms, "shadow maps, 1024", "sample-based, 1024", AN_ORDER),
                    ],
                ),
            ],
            note: "",
        },
        Exhibit {
            id: "figure14",
            shows: "A hairball of 44 000 triangles, hard and soft",
            rows: &[
                fps("alias-free hard shadows", "builtin:hairball", "alias_free", 66.0).at(512, 512),
                error("alias-free: errors", "builtin:hairball", "alias_free").light_scaled(POINT).at(512, 512),
                ms("shadow map", "builtin:hairball", "hard", "", Drawn).at(512, 512),
                error("shadow map: errors", "builtin:hairball", "hard").light_scaled(POINT).at(512, 512),
                error("sample-based, 256", "builtin:hairball", "sample_based").with(SAMPLES_256).at(512, 512),
                ms("sample-based, 256: time", "builtin:hairball", "sample_based", "", Drawn)
                    .with(SAMPLES_256)
                    .at(512, 512),
            ],
            claims: &[
                claim(
                    "It works robustly for a hairball: hard shadows have no aliasing.",
                    &[
                        Rule::AtMost(Rmse, "alias-free: errors", 0.02),
                        Rule::RatioAtMost(Rmse, "alias-free: errors", "shadow map: errors", 0.25),
                    ],
                ),
                claim("Soft shadows of a hairball are accurate.", &[Rule::AtMost(Rmse, "sample-based, 256", 0.02)]).because_both(
                    "it is the reference's noise: a hair hides single light points. At 128 × 72 against 64 of them the error is .025, \
                     against 1024 (`--samples 1024`) .0098, and .0048 with `samples=1024`, too. With that alone it is .024.",
                ),
            ],
            note: "",
        },
        Exhibit {
            id: "figure15",
            shows: "Large scenes: 90 000 triangles, the same in a zoomed view, 70 000, and the ring in grass with 379 000",
            rows: &[
                fps("tree, 85 000 (the paper's: 90 000)", "builtin:tree", "sample_based", 7.0)
                    .with(SAMPLES_256)
                    .at(512, 512),
                fps("tree, zoomed", "builtin:tree", "sample_based", 4.5)
                    .with(SAMPLES_256)
                    .seen("tree-near")
                    .at(512, 512),
                fps("a knot of 70 000 (the paper's: 70 000)", "builtin:knot?triangles=70000", "sample_based", 4.8)
                    .with(SAMPLES_256)
                    .at(512, 512),
                fps("ring in grass, 379 000", "builtin:ring-in-grass", "sample_based", 0.65)
                    .with(SAMPLES_256)
                    .at(512, 512),
                ms("ring in grass: shadow maps, 256", "builtin:ring-in-grass", "multi_view", "", Drawn)
                    .with(MAPS_256)
                    .at(512, 512)
                    .slow(),
            ],
            claims: &[
                claim(
                    "The zoomed view is slower than the whole one (4.5 and 7 frames per second).",
                    &[Rule::RatioWithin(Ms, "tree, zoomed", "tree, 85 000 (the paper's: 90 000)", [1.1, 2.2])],
                ),
                claim(
                    "The ring is the slowest (0.65 frames per second).",
                    &[
                        Rule::RatioAtLeast(Ms, "ring in grass, 379 000", "tree, zoomed", 2.0),
                        Rule::RatioAtLeast(Ms, "ring in grass, 379 000", "a knot of 70 000 (the paper's: 70 000)", 2.0),
                    ],
                ),
            ],
            note: "",
        },
        Exhibit {
            id: "text",
            shows: "A shadow map with as little aliasing as alias-free shadows needs 8192² texels; times of other systems",
            rows: &[
                ms("alias-free hard shadows", "builtin:columns", "alias_free", "", Drawn).at(512, 512),
                ms("shadow map of 8192²", "builtin:columns", "hard", "", Drawn)
                    .with(&[("map_size", "8192")])
                    .at(512, 512),
                error("alias-free: errors", "builtin:columns", "alias_free").light_scaled(POINT).at(512, 512),
                error("shadow map of 8192²: errors", "builtin:columns", "hard")
                    .with(&[("map_size", "8192")])
                    .light_scaled(POINT)
                    .at(512, 512),
            ],
            claims: &[
                claim(
                    "Alias-free shadows take three times as long as a shadow map of 8192².",
                    &[
                        Rule::RatioWithin(Ms, "alias-free hard shadows", "shadow map of 8192²", [2.0, 4.5]),
                        Rule::RatioAtMost(Rmse, "alias-free: errors", "shadow map of 8192²: errors", 1.0),
                    ],
                ),
                not_here(
                    "On Sponza, it is 23 times as fast as Overbeck's beam tracing (9 s).",
                    "that system is not in this repository; a comparison needs both on one machine, not the times of a \
                     graphics card of 2008 and a current CPU",
                ),
                not_here(
                    "On the ring, it is 49 times as fast as soft shadow volumes (75 s).",
                    "that system is not in this repository; a comparison needs both on one machine, not the times of a CPU of \
                     2005 and a current graphics card",
                ),
            ],
            note: "the systems of Overbeck and Laine, which are not implemented here.",
        },
    ],
};
