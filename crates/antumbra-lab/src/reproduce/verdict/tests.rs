//! Tests of rules with numbers; every rule of every paper rejects some image or time.

use glam::UVec2;

use super::super::PAPERS;
use super::super::claim::{claim, not_here};
use super::super::exhibit::{Measure, error};
use super::super::outcome::Measured;
use super::*;
use crate::metrics::compare_visibility;
use crate::motion::flicker::{FlickerSums, TrueFrame};
use crate::picture::Visibility;

/// Claims about time refer to timed rows.
#[test]
fn claims_about_time_are_of_rows_that_are_timed() {
    let exhibits = || PAPERS.iter().flat_map(|paper| paper.exhibits);
    let mut found = 0;
    for exhibit in exhibits() {
        let rules = exhibit.claims.iter().flat_map(|claim| claim.rules);
        for row in rules.filter(|rule| rule.figure() == Figure::Ms).flat_map(Rule::rows) {
            let measure = exhibit.rows.iter().find(|one| one.what == row).map(|one| one.measure);
            let is_of_time = |measure: Measure| {
                // Rays are traced on the CPU and techniques run on the adapter, so their times are not comparable.
                measure.is_timed() || matches!(measure, Measure::SceneMs { .. })
            };
            assert!(measure.is_some_and(is_of_time), "{}: {row}", exhibit.id);
            found += 1;
        }
    }
    assert!(found > 50, "{found}");
}

const RULES: &[Rule] = &[Rule::RatioAtMost(Figure::Rmse, "a", "b", 0.5), Rule::AtMost(Figure::Rmse, "a", 0.12)];
const TIMES: &[Rule] = &[Rule::RatioAtLeast(Figure::Ms, "b", "a", 10.0)];
const EXHIBIT: Exhibit = Exhibit {
    id: "figure1",
    shows: "",
    rows: &[error("a", "builtin:overlap", "pcss"), error("b", "builtin:overlap", "hard")],
    claims: &[
        claim("a errs half as much", RULES).because("of the reason."),
        claim("a takes a tenth", TIMES),
        claim("a takes a tenth of the work", TIMES).on_any_adapter(),
    ],
    note: "",
};

fn measured(rmse: f64, ms: f64) -> Outcome {
    Outcome::Measured(Measured { rmse: Some(rmse), ms: Some(ms), size_px: [64, 36], ..Measured::default() })
}

fn judged(exhibit: &Exhibit, published: &[Outcome], is_software: bool) -> Vec<Judged> {
    judge(exhibit, Outcomes { published, ours: &[] }, is_software)
}

fn verdicts(outcomes: &[Outcome], is_software: bool) -> Vec<Verdict> {
    judged(&EXHIBIT, outcomes, is_software).into_iter().map(|judged| judged.published.verdict).collect()
}

#[test]
fn a_claim_holds_where_all_of_its_rules_do() {
    use Verdict::{Contradicted, Holds};
    let found = verdicts(&[measured(0.1, 1.0), measured(0.25, 11.0)], false);
    assert_eq!(found, [Holds, Holds, Holds]);
    // One rule of two is not enough, and neither is a ratio of nine for a bound of ten.
    let found = verdicts(&[measured(0.13, 1.0), measured(0.9, 9.0)], false);
    assert_eq!(found, [Contradicted, Contradicted, Contradicted]);
    let judged = judged(&EXHIBIT, &[measured(0.15, 1.0), measured(0.2, 9.0)], false);
    assert!(
        judged[0].published.found[0].ends_with("at most 0.5 times that of ‘b’: here 0.75 (0.1500, 0.2000)"),
        "{judged:?}"
    );
    assert_eq!(judged[0].published.sentence(), "The claim is contradicted here: of the reason.");
    assert_eq!(judged[1].published.sentence(), "The claim is contradicted here.");
    assert_eq!(judged[0].sizes, "64 × 36");
}

/// Figures whose range includes the bound decide nothing.
#[test]
fn values_too_close_to_a_bound_are_undecided() {
    let found = verdicts(&[measured(0.1, 1.0), measured(0.2, 10.0)], false);
    for verdict in &found {
        assert!(matches!(verdict, Verdict::Undecided(why) if why.contains("too close")), "{verdict:?}");
    }
    // A reference of 16 samples has noise of .016, so an rmse of .02 may be one of .012.
    let noisy =
        |rmse: f64| Outcome::Measured(Measured { rmse: Some(rmse), truth_samples: Some(16), ..Measured::default() });
    const AT_LEAST: &[Claim] = &[claim("", &[Rule::AtLeast(Figure::Rmse, "a", 0.018)])];
    let exhibit = Exhibit { claims: AT_LEAST, ..EXHIBIT };
    assert!(matches!(judged(&exhibit, &[noisy(0.02)], true)[0].published.verdict, Verdict::Undecided(_)));
    assert_eq!(judged(&exhibit, &[noisy(0.03)], true)[0].published.verdict, Verdict::Holds);
    assert_eq!(judged(&exhibit, &[noisy(0.017)], true)[0].published.verdict, Verdict::Contradicted);
}

#[test]
fn the_verdict_is_on_what_was_published() {
    let published = [measured(0.2, 1.0), measured(0.25, 11.0)];
    let ours = [Some(measured(0.1, 1.0)), None];
    let judged = judge(&EXHIBIT, Outcomes { published: &published, ours: &ours }, false);
    assert_eq!(judged[0].published.verdict, Verdict::Contradicted);
    // Rows without our form use the published one.
    assert_eq!(judged[0].ours.as_ref().map(|ours| ours.verdict.clone()), Some(Verdict::Holds));
    assert!(self::judged(&EXHIBIT, &published, false)[0].ours.is_none());
}

#[test]
fn a_software_renderer_decides_no_time_but_of_growth() {
    let found = verdicts(&[measured(0.1, 2.0), measured(0.25, 30.0)], true);
    assert!(
        matches!(&found[..], [Verdict::Holds, Verdict::Undecided(why), Verdict::Holds] if why.contains("GPU")),
        "{found:?}"
    );
    // Two frames do not decide about growth,
    let of_two = |ms: f64| {
        let count = Some(crate::stopwatch::FrameCount { frames: 2, warm_up: 1 });
        Outcome::Measured(Measured { ms: Some(ms), rmse: Some(0.1), count, ..Measured::default() })
    };
    let found = verdicts(&[of_two(2.0), of_two(30.0)], true);
    assert!(matches!(&found[2], Verdict::Undecided(why) if why.contains("few frames")), "{found:?}");
    // nor do times too short for the clock.
    let found = verdicts(&[measured(0.1, 0.2), measured(0.25, 30.0)], true);
    assert!(matches!(&found[2], Verdict::Undecided(why) if why.contains("clock")), "{found:?}");
}

/// A software renderer draws triangles by the processor that does all else, so no claim about them is decided on it: none whose rules
/// compare scenes, and none that speaks of triangles.
#[test]
fn no_claim_about_triangles_is_decided_on_a_software_renderer() {
    let mut about_triangles = 0;
    for (paper, exhibit) in PAPERS.iter().flat_map(|paper| paper.exhibits.iter().map(move |exhibit| (paper, exhibit))) {
        for claim in exhibit.claims {
            let of_times = claim.rules.iter().filter(|rule| rule.figure() == Figure::Ms);
            let scene = |what: &str| exhibit.rows.iter().find(|row| row.what == what).map(|row| row.scene);
            let compares_scenes = of_times.clone().any(|rule| {
                let rows = rule.rows();
                rows.iter().any(|row| scene(row) != scene(rows[0]))
            });
            if of_times.count() > 0 && (compares_scenes || claim.says.contains("triangles")) {
                assert!(!claim.on_any_adapter, "{}/{}: {}", paper.id, exhibit.id, claim.says);
                about_triangles += 1;
            }
        }
    }
    assert!(about_triangles > 6, "{about_triangles}");
}

/// A claim gives the reason of each of its rules that is not decided, and every reason names what would show it.
#[test]
fn every_undecided_rule_says_what_would_show_it() {
    const BOTH: &[Rule] = &[Rule::RatioAtLeast(Figure::Ms, "b", "a", 10.0), Rule::AtMost(Figure::Ms, "a", 10.0)];
    const CLAIMS: &[Claim] = &[claim("", BOTH), claim("", BOTH).on_any_adapter(), claim("", RULES)];
    let exhibit = Exhibit { claims: CLAIMS, ..EXHIBIT };
    let of_two = |ms: f64| {
        let count = Some(crate::stopwatch::FrameCount { frames: 2, warm_up: 1 });
        Outcome::Measured(Measured { ms: Some(ms), rmse: Some(0.1), count, ..Measured::default() })
    };
    let why =
        |outcomes: &[Outcome], claim: usize| match judged(&exhibit, outcomes, true)[claim].published.verdict.clone() {
            Verdict::Undecided(why) => why,
            other => panic!("{other:?}"),
        };
    // Rows that are too slow: on a GPU, or by --dear where a software renderer's times or images decide.
    let slow = [of_two(2.0), Outcome::TooSlow];
    let found = why(&slow, 0);
    assert!(found.contains("‘b’ is too slow for a software renderer: the same command on a GPU"), "{found}");
    assert!(
        found.contains("; times of a software renderer say little about a GPU") && !found.contains("--dear"),
        "{found}"
    );
    let found = why(&slow, 1);
    assert!(found.contains("‘b’ is too slow for a software renderer: --dear") && found.contains("--frames"), "{found}");
    let found = why(&slow, 2);
    assert!(found.contains("--dear, or the same command on a GPU, would show it"), "{found}");
    // Scenes that are not there, and what their times need then.
    let absent = [of_two(2.0), Outcome::NotReady("sponza.glb".to_owned())];
    for (claim, what) in [(0, "on a GPU would show it"), (1, "5 frames or more (--frames)"), (2, "that would show it")]
    {
        let found = why(&absent, claim);
        assert!(found.contains("Khronos") && found.contains(what), "{found}");
    }
}

/// What would decide figures that are too close depends on why they are: on the reference's noise, on the image, or on what a larger run
/// has found.
#[test]
fn what_is_too_close_says_what_would_show_it() {
    const CLAIMS: &[Claim] = &[
        claim("", &[Rule::RatioAtMost(Figure::Rmse, "a", "b", 0.75)]),
        claim("", &[Rule::RatioAtMost(Figure::Noise, "a", "b", 0.75)]),
        claim("", &[Rule::RatioAtMost(Figure::Noise, "a", "b", 0.75)]).if_too_close("as a larger run shows"),
    ];
    let exhibit = Exhibit { claims: CLAIMS, ..EXHIBIT };
    let one = |rmse: f64, noise: f64| {
        let (rmse, noise, truth_samples) = (Some(rmse), Some(noise), Some(64));
        Outcome::Measured(Measured { rmse, noise, truth_samples, ..Measured::default() })
    };
    let why = |a, b| -> Vec<String> {
        let judged = judged(&exhibit, &[a, b], true);
        judged.into_iter().map(|judged| judged.published.sentence()).collect()
    };
    // A reference of 64 samples has noise of .008: up to all of both errors.
    let found = why(one(0.0080, 0.0001), one(0.0090, 0.0001));
    assert!(found[0].contains("(--samples)") && found[1].contains("below what an image shows"), "{found:?}");
    assert!(found[2].ends_with("too close to tell: as a larger run shows."), "{found:?}");
    let found = why(one(0.0751, 0.0150), one(0.1, 0.02));
    assert!(found[0].contains("(--size)") && found[1].contains("(--size)"), "{found:?}");
}

#[test]
fn what_was_not_measured_decides_nothing() {
    let not_ready = Outcome::NotReady("sponza.glb".to_owned());
    let found = verdicts(&[not_ready.clone(), measured(0.2, 10.0)], false);
    assert!(
        matches!(&found[0], Verdict::Undecided(why) if why.contains("‘a’ is not ready") && why.contains("Khronos")),
        "{found:?}"
    );
    assert!(found.iter().all(|verdict| verdict.name() == "cannot be shown"));
    let none = Outcome::Measured(Measured::default());
    assert!(
        matches!(&verdicts(&[none.clone(), none], false)[0], Verdict::Undecided(why) if why.contains("‘a’ has no rmse here"))
    );
    assert!(matches!(verdicts(&[], false)[0], Verdict::Undecided(_)));
    let found = verdicts(&[measured(0.1, 0.0), measured(0.25, 0.0)], false);
    assert!(
        found[1..]
            .iter()
            .all(|one| matches!(one, Verdict::Undecided(why) if why.contains("the time of ‘b’ was reported as zero")))
    );
    // A single rule that is not met is enough.
    const TWO: &[Claim] = &[claim("", &[Rule::AtMost(Figure::Rmse, "b", 0.1), Rule::AtMost(Figure::Rmse, "a", 0.1)])];
    let exhibit = Exhibit { claims: TWO, ..EXHIBIT };
    assert_eq!(judged(&exhibit, &[not_ready, measured(0.2, 1.0)], true)[0].published.verdict, Verdict::Contradicted);
    const ELSEWHERE: &[Claim] = &[not_here("", "it needs what is not here")];
    let exhibit = Exhibit { claims: ELSEWHERE, ..EXHIBIT };
    assert_eq!(judged(&exhibit, &[], true)[0].published.sentence(), "Cannot be shown here: it needs what is not here.");
}

#[test]
fn orders_likeness_and_ratios() {
    let exhibit = |claims| Exhibit { claims, ..EXHIBIT };
    const CLAIMS: &[Claim] = &[
        claim("", &[Rule::Rising(Figure::Rmse, &["a", "b"])]),
        claim("", &[Rule::Alike(Figure::Rmse, &["a", "b"], 1.5)]),
        claim("", &[Rule::AtLeast(Figure::Rmse, "b", 0.2)]),
        claim("", &[Rule::RatioWithin(Figure::Rmse, "b", "a", [1.1, 1.4])]),
    ];
    let of = |a, b| -> Vec<&str> {
        let outcomes = [measured(a, 1.0), measured(b, 1.0)];
        judged(&exhibit(CLAIMS), &outcomes, true).iter().map(|judged| judged.published.verdict.name()).collect()
    };
    assert_eq!(of(0.2, 0.25), ["holds", "holds", "holds", "holds"]);
    assert_eq!(of(0.2, 0.3)[3], "contradicted");
    assert_eq!(of(0.25, 0.2), ["contradicted", "holds", "cannot be shown", "contradicted"]);
    assert_eq!(of(0.19, 0.1), ["contradicted", "contradicted", "contradicted", "contradicted"]);
}

/// Returns a step from umbra to light with a penumbra between them.
fn truth() -> Visibility {
    let size = UVec2::new(48, 32);
    let at = |i: u32| (f32::from((i % size.x) as u16) / 16.0 - 1.0).clamp(0.0, 1.0);
    Visibility::one(size, (0..size.element_product()).map(at).collect())
}

/// Returns images that a rule may accept as the truth (itself, slightly changed, with light in its umbra, with noise, as a hard shadow),
/// then images that none may accept: all dark, all lit, all grey.
fn images() -> [(&'static str, Visibility); 10] {
    let truth = truth();
    let with = |change: &dyn Fn(usize, f32) -> f32| {
        let values =
            (0..truth.size_px.element_product() as usize).map(|i| change(i, truth.at(i, 0)).clamp(0.0, 1.0)).collect();
        Visibility::one(truth.size_px, values)
    };
    let noise = |i: usize| (i.wrapping_mul(2_654_435_761) >> 7 & 255) as f32 / 255.0 - 0.5;
    let mean = (0..truth.size_px.element_product() as usize).map(|i| truth.at(i, 0)).sum::<f32>()
        / truth.size_px.element_product() as f32;
    [
        ("the truth", with(&|_, v| v)),
        ("nearly", with(&|i, v| v + 0.004 * noise(i))),
        ("a little light", with(&|_, v| v.max(0.012))),
        ("leaks", with(&|_, v| v.max(0.1))),
        ("noise", with(&|i, v| v + 0.2 * noise(i))),
        ("worse noise", with(&|i, v| v + 0.9 * noise(i))),
        ("a hard shadow", with(&|_, v| v.round())),
        ("dark", with(&|_, _| 0.0)),
        ("lit", with(&|_, _| 1.0)),
        ("grey", with(&|_, _| mean)),
    ]
}

const GOOD: usize = 7;

/// Returns the figures of each image.
fn figures() -> Vec<(&'static str, Outcome)> {
    let truth = truth();
    let judged = vec![true; truth.size_px.element_product() as usize];
    let images = images();
    images.iter().map(|(name, image)| (*name, outcome_of(image, &truth, &images[9].1, &judged))).collect()
}

/// Returns the figures of an image, and the error of one without any shadow.
fn outcome_of(image: &Visibility, truth: &Visibility, flat: &Visibility, judged: &[bool]) -> Outcome {
    let metrics = compare_visibility(truth, image, judged).unwrap();
    Outcome::Measured(Measured {
        rmse: metrics.rmse,
        umbra_leak: metrics.umbra_leak,
        lit_loss: metrics.lit_loss,
        noise: metrics.roughness,
        flat_rmse: compare_visibility(truth, flat, judged).unwrap().rmse,
        ..Measured::default()
    })
}

/// Returns sequences of masks in motion: the truth, which moves by a column per frame; nearly the truth; the truth with growing noise that
/// differs in each frame; the truth a frame late; its hard edges; then masks that no rule may accept: all dark, all lit, all grey.
fn frames_in_motion() -> [(&'static str, Vec<Visibility>); 10] {
    const FRAMES: u32 = 6;
    let still = truth();
    let of = |change: &dyn Fn(u32, u32, u32) -> f32| {
        let frame = |k: u32| {
            let pixels = (0..still.size_px.y).flat_map(|y| (0..still.size_px.x).map(move |x| (x, y)));
            Visibility::one(still.size_px, pixels.map(|(x, y)| change(k, x, y).clamp(0.0, 1.0)).collect())
        };
        (0..FRAMES).map(frame).collect()
    };
    let moved = |k: u32, x: u32| still.at(x.saturating_sub(k) as usize, 0);
    let noise =
        |k: u32, x: u32, y: u32| ((k * 7919 + y * 48 + x).wrapping_mul(2_654_435_761) >> 7 & 255) as f32 / 255.0 - 0.5;
    let noisy = |part: f32| of(&|k, x, y| moved(k, x) + part * noise(k, x, y));
    [
        ("the truth", of(&|k, x, _| moved(k, x))),
        ("nearly", noisy(0.002)),
        ("a little noise", noisy(0.01)),
        ("noise", noisy(0.03)),
        ("more noise", noisy(0.06)),
        ("a frame late", of(&|k, x, _| moved(k.saturating_sub(1), x))),
        ("hard shadows", of(&|k, x, _| moved(k, x).round())),
        ("dark", of(&|_, _, _| 0.0)),
        ("lit", of(&|_, _, _| 1.0)),
        ("grey", of(&|_, _, _| 0.5)),
    ]
}

/// Returns the flicker of each sequence.
fn figures_in_motion() -> Vec<(&'static str, Outcome)> {
    let frames = frames_in_motion();
    let judged = vec![true; truth().size_px.element_product() as usize];
    let truths: Vec<TrueFrame> =
        frames[0].1.iter().map(|frame| TrueFrame { visibility: frame.clone(), judged: judged.clone() }).collect();
    let outcome = |masks: &[Visibility]| {
        let mut sums = FlickerSums::new(judged.len());
        for (truths, masks) in truths.windows(2).zip(masks.windows(2)) {
            sums.add([&truths[0], &truths[1]], [&masks[0], &masks[1]]);
        }
        Outcome::Measured(Measured {
            flicker: sums.flicker(),
            still_flicker: sums.truth_change(),
            ..Measured::default()
        })
    };
    frames.iter().map(|(name, masks)| (*name, outcome(masks))).collect()
}

/// Flicker is zero for the truth and grows with noise; masks that never change have all of the truth's change as flicker.
#[test]
fn masks_in_motion_are_what_they_are_called() {
    let flickers: Vec<(f64, f64)> = figures_in_motion()
        .iter()
        .map(|(_, outcome)| match outcome {
            Outcome::Measured(Measured { flicker: Some(flicker), still_flicker: Some(still), .. }) => {
                (*flicker, *still)
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(flickers[0].0, 0.0);
    assert!(flickers[..5].windows(2).all(|pair| pair[0].0 < pair[1].0), "{flickers:?}");
    for (flicker, still) in &flickers[GOOD..] {
        assert!((flicker / still - 1.0).abs() < 1e-6, "{flickers:?}");
    }
}

/// Returns every assignment of one of `count` items to each of `places`.
fn assignments(places: usize, count: usize) -> impl Iterator<Item = Vec<usize>> {
    (0..count.pow(places as u32)).map(move |n| (0..places).map(|k| n / count.pow(k as u32) % count).collect())
}

/// Every rule is about images or about time, so that one of the two tests below covers it.
#[test]
fn every_rule_is_about_images_or_about_time() {
    for exhibit in PAPERS.iter().flat_map(|paper| paper.exhibits) {
        for rule in exhibit.claims.iter().flat_map(|claim| claim.rules) {
            assert!(rule.figure().is_of_images() || rule.figure() == Figure::Ms, "{}: {}", exhibit.id, rule.text());
            assert!(!rule.rows().is_empty(), "{}: {}", exhibit.id, rule.text());
        }
    }
}

/// Asserts that each row of a rule matters: some outcome in its place makes the rule fail. A rule that holds a ratio between two bounds
/// must fail on either side, with the first row's figure (by `size_of`) too small and too large.
fn assert_that_each_row_counts(
    what: &str,
    rule: &Rule,
    good: &[Vec<usize>],
    count: usize,
    met_by: &dyn Fn(&[usize]) -> RuleOutcome,
    size_of: &dyn Fn(usize) -> f64,
) {
    for (k, row) in rule.rows().iter().enumerate() {
        let wrong = good.iter().flat_map(|good| {
            (0..count).filter(|other| *other != good[k]).map(move |other| {
                let mut others = good.clone();
                others[k] = other;
                (others, good[k], other)
            })
        });
        assert!(wrong.clone().any(|(others, ..)| met_by(&others) == RuleOutcome::No), "{what}: any ‘{row}’ will do");
        if matches!(rule, Rule::RatioWithin(..)) {
            let is_rejected = |is_larger: bool| {
                wrong.clone().any(|(others, was, is)| {
                    (size_of(is) > size_of(was)) == is_larger
                        && size_of(is) != size_of(was)
                        && met_by(&others) == RuleOutcome::No
                })
            };
            assert!(is_rejected(true) && is_rejected(false), "{what}: one-sided in ‘{row}’");
        }
    }
}

/// Every rule about images is met by some images. It fails if a constant image replaces a praised one, or the exact image a criticised
/// one, and each of its rows matters.
#[test]
fn every_rule_about_images_rejects_a_wrong_one() {
    let (of_images, in_motion) = (figures(), figures_in_motion());
    let mut looked_at = 0;
    for (paper, exhibit) in PAPERS.iter().flat_map(|paper| paper.exhibits.iter().map(move |exhibit| (paper, exhibit))) {
        for (claim, rule) in exhibit.claims.iter().flat_map(|claim| claim.rules.iter().map(move |rule| (claim, rule))) {
            if !rule.figure().is_of_images() {
                continue;
            }
            let rows = rule.rows();
            let figures = if rule.figure() == Figure::Flicker { &in_motion } else { &of_images };
            let met_by = |images: &[usize]| {
                let place = |row: &str| rows.iter().position(|one| *one == row).map(|k| images[k]);
                let none = Outcome::NotRun;
                let published: Vec<Outcome> = exhibit
                    .rows
                    .iter()
                    .map(|row| place(row.what).map_or_else(|| none.clone(), |image| figures[image].1.clone()))
                    .collect();
                let bench =
                    Bench { exhibit, outcomes: Outcomes { published: &published, ours: &[] }, is_software: true };
                bench.look(claim, rule, Form::Published).1
            };
            let what = format!("{}/{}: {}", paper.id, exhibit.id, rule.text());
            let good: Vec<Vec<usize>> =
                assignments(rows.len(), GOOD).filter(|images| met_by(images) == RuleOutcome::Yes).collect();
            assert!(!good.is_empty(), "{what}: no image meets it");
            let with = |good: &[usize], k: usize, image: usize| {
                let mut images = good.to_vec();
                images[k] = image;
                images
            };
            for row in rule.favored() {
                let k = rows.iter().position(|one| *one == row).unwrap();
                for (image, (name, _)) in figures.iter().enumerate().skip(GOOD) {
                    let is_met = good.iter().any(|good| met_by(&with(good, k, image)) == RuleOutcome::Yes);
                    assert!(!is_met, "{what}: ‘{row}’ may be {name} all over");
                }
            }
            if rule.favored().is_empty() {
                let is_rejected = good.iter().any(|good| met_by(&with(good, 0, 0)) != RuleOutcome::Yes);
                assert!(is_rejected, "{what}: the truth is found wanting");
            }
            let size_of = |image: usize| match &figures[image].1 {
                Outcome::Measured(measured) => measured.figure(rule.figure()).unwrap_or(0.0),
                _ => 0.0,
            };
            assert_that_each_row_counts(&what, rule, &good, GOOD, &met_by, &size_of);
            looked_at += 1;
        }
    }
    assert!(looked_at > 60, "{looked_at}");
}

/// Techniques whose golden masks stand for images: some of each paper, and those that they compare with.
const TECHNIQUES: [&str; 12] = [
    "ray_traced",
    "sample_based",
    "multi_view",
    "reprojection",
    "multi_layer",
    "pcss",
    "pcss_anisotropic",
    "essm",
    "cssm",
    "lvsm",
    "vsm",
    "hard",
];

/// Returns the figures of real masks, of `overlap` under a rectangle, against ray tracing: the first of each technique's golden masks.
fn figures_of_techniques() -> Vec<(&'static str, Outcome)> {
    const SIZE_PX: UVec2 = UVec2::new(48, 32);
    let mask = |technique: &str| {
        let file = format!("{}/tests/golden/{technique}.png", env!("CARGO_MANIFEST_DIR"));
        let image = image::open(&file).unwrap_or_else(|error| panic!("{file}: {error}")).to_rgb8();
        let pixels = (0..SIZE_PX.y).flat_map(|y| (0..SIZE_PX.x).map(move |x| (x, y)));
        Visibility::one(SIZE_PX, pixels.map(|(x, y)| f32::from(image.get_pixel(x, y).0[0]) / 255.0).collect())
    };
    let truth = mask(TECHNIQUES[0]);
    let count = SIZE_PX.element_product() as usize;
    let judged = vec![true; count];
    let mean = (0..count).map(|i| truth.at(i, 0)).sum::<f32>() / count as f32;
    let flat = Visibility::one(SIZE_PX, vec![mean; count]);
    let outcome = |technique: &str| outcome_of(&mask(technique), &truth, &flat, &judged);
    TECHNIQUES.iter().map(|technique| (*technique, outcome(technique))).collect()
}

/// Rules of every paper tell real techniques apart: some masks of techniques meet them, and one of these replaced by another technique's
/// mask does not.
#[test]
fn rules_of_every_paper_reject_another_technique_s_mask() {
    let figures = figures_of_techniques();
    for paper in &PAPERS {
        let mut rejecting = 0;
        for exhibit in paper.exhibits {
            for (claim, rule) in
                exhibit.claims.iter().flat_map(|claim| claim.rules.iter().map(move |rule| (claim, rule)))
            {
                if !rule.figure().is_of_images() || rule.figure() == Figure::Flicker {
                    continue;
                }
                let rows = rule.rows();
                let met_by = |masks: &[usize]| {
                    let place = |row: &str| rows.iter().position(|one| *one == row).map(|k| masks[k]);
                    let outcome = |row: &str| place(row).map_or(Outcome::NotRun, |mask| figures[mask].1.clone());
                    let published: Vec<Outcome> = exhibit.rows.iter().map(|row| outcome(row.what)).collect();
                    let outcomes = Outcomes { published: &published, ours: &[] };
                    Bench { exhibit, outcomes, is_software: true }.look(claim, rule, Form::Published).1
                };
                // Two different techniques at the least, none of them ray tracing itself, which has no error here.
                let of_two = |masks: &Vec<usize>| masks.len() == 1 || masks.iter().any(|mask| *mask != masks[0]);
                let good = assignments(rows.len(), figures.len() - 1)
                    .map(|masks| masks.iter().map(|mask| mask + 1).collect::<Vec<usize>>())
                    .filter(of_two)
                    .find(|masks| met_by(masks) == RuleOutcome::Yes);
                let is_rejected = good.is_some_and(|good| {
                    (0..good.len()).any(|k| {
                        (1..figures.len()).any(|other| {
                            let mut masks = good.clone();
                            masks[k] = other;
                            met_by(&masks) == RuleOutcome::No
                        })
                    })
                });
                rejecting += usize::from(is_rejected);
            }
        }
        assert!(rejecting > 2, "{}: {rejecting}", paper.id);
    }
}

/// Every rule about time is met by some times. It fails if a row's time is replaced by another: with two bounds, by one too
/// short and by one too long.
#[test]
fn every_rule_about_time_rejects_a_wrong_one() {
    const MS: [f64; 14] = [8.0, 10.0, 11.2, 12.0, 14.0, 16.0, 21.0, 30.0, 45.0, 105.0, 115.0, 1150.0, 2000.0, 3500.0];
    let mut looked_at = 0;
    for (paper, exhibit) in PAPERS.iter().flat_map(|paper| paper.exhibits.iter().map(move |exhibit| (paper, exhibit))) {
        for (claim, rule) in exhibit.claims.iter().flat_map(|claim| claim.rules.iter().map(move |rule| (claim, rule))) {
            if rule.figure() != Figure::Ms {
                continue;
            }
            let rows = rule.rows();
            let met_by = |times: &[f64]| {
                let place = |row: &str| rows.iter().position(|one| *one == row).map(|k| times[k]);
                let published: Vec<Outcome> = exhibit
                    .rows
                    .iter()
                    .map(|row| place(row.what).map_or(Outcome::NotRun, |ms| measured(0.1, ms)))
                    .collect();
                let bench =
                    Bench { exhibit, outcomes: Outcomes { published: &published, ours: &[] }, is_software: false };
                bench.look(claim, rule, Form::Published).1
            };
            let what = format!("{}/{}: {}", paper.id, exhibit.id, rule.text());
            let met_by = |places: &[usize]| met_by(&places.iter().map(|i| MS[*i]).collect::<Vec<f64>>());
            let good: Vec<Vec<usize>> =
                assignments(rows.len(), MS.len()).filter(|places| met_by(places) == RuleOutcome::Yes).collect();
            assert!(!good.is_empty(), "{what}: no times meet it");
            assert_that_each_row_counts(&what, rule, &good, MS.len(), &met_by, &|i| MS[i]);
            looked_at += 1;
        }
    }
    assert!(looked_at > 30, "{looked_at}");
}
