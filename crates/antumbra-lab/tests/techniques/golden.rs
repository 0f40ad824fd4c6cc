//! Golden masks in `tests/golden/`. Every technique is drawn with small maps on several test scenes, and on one of them with
//! each of its parameters at another value, so that no change of a shader passes unnoticed.
//!
//! Other modules compare masks with traced rays; golden masks show that nothing has changed. After an intended change
//! update them by `ANTUMBRA_UPDATE_GOLDEN=1 cargo test -p antumbra-lab --test techniques golden`, and inspect them.
//!
//! A technique's image contains a mask for each test scene, parameter or combination; each line of its text names a mask and its mean.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use antumbra::contract::{ParamSpec, ParamValue};
use antumbra::techniques::receiver_lists::sample_based::{RegionOfInfluence, SampleBasedParams, Traversal};
use antumbra::{Quality, TechniqueKind};
use antumbra_lab::device::LabDevice;
use antumbra_lab::error::LabError;
use antumbra_lab::picture::{Visibility, pixel_count};
use antumbra_lab::technique_run::{Extras, TechniqueChoice};
use antumbra_lab::view::View;
use antumbra_light::{Light, LightShape};
use antumbra_scene::{AlphaMode, LoadOptions, Scene, Setup, load};
use glam::{UVec2, Vec2, Vec3, Vec4};
use image::{GenericImage, GenericImageView, Rgb, RgbImage};

use crate::common::lab;
use crate::view_samples;

/// Mask size: small, because there are many masks.
const MASK_PX: UVec2 = UVec2::new(48, 32);
/// Number of masks side by side.
const ACROSS: u32 = 8;

/// Image size for counting work: larger, so that receivers form several groups.
const WORK_PX: UVec2 = UVec2::new(96, 54);

/// Tolerance of 8-bit levels on the adapter of the golden masks, and number of pixels per mask that may exceed it.
const SAME_LEVELS: u8 = 2;
const SAME_PIXELS: usize = 3;
/// Tolerance of the mean on the same adapter, where masks are reproducible to the bit with any number of threads. It
/// detects changes of less than a level everywhere, or of more in one or two pixels.
const SAME_MEAN: f64 = 2e-5;
/// Larger tolerances for masks that depend on last bits: technique, label, number of pixels, change of the mean, and reason. Versions of
/// software Mesa that share a name differ by these, because they compile sums in other orders and with other rounding.
const LOOSE_TOLERANCES: [(TechniqueKind, &str, usize, f64, &str); 2] = [
    (TechniqueKind::Vssm, "a ball at the stairs' horizon", 16, 5e-4, NEAR_NONE),
    (TechniqueKind::Evssm, "a ball at the stairs' horizon", 20, 1.2e-3, NEAR_NONE),
];
const NEAR_NONE: &str = "along the horizon a step has one depth: its variance is the last bits of a difference of sums, taken for one or none";
/// Tolerance of the mean difference on other adapters, which round differently and cover other pixels along edges. Full range is 1.
const OTHER_MEAN: f64 = 0.01;

/// Settings in place of the defaults, so that the tests take a minute: maps sufficient for so few pixels, and fewer views.
const SMALL: [(&str, &str); 2] = [("map_size", "256"), ("view_size", "128")];
const FEW_VIEWS: (&str, &str) = ("samples", "16");
const OF_VIEWS: [TechniqueKind; 3] =
    [TechniqueKind::MultiView, TechniqueKind::Reprojection, TechniqueKind::ReprojectionLayered];

/// Parameters that are not varied, because their masks differ between runs by design.
const UNSTEADY: [&str; 1] = ["synchronized"];

/// A test scene with a kind of light.
struct Stage {
    name: &'static str,
    scene: Scene,
    setup: Setup,
}

/// Lights of all kinds, tinted and alpha-tested casters, receivers all around a light and along its horizon, and a mesh around a light.
fn stages() -> &'static [Stage] {
    static STAGES: OnceLock<Vec<Stage>> = OnceLock::new();
    let stage = |name, scene: &str, change: &dyn Fn(&mut Setup)| {
        let scene = load(scene, &LoadOptions::default()).expect("a built-in scene");
        let mut setup = Setup::for_scene(&scene);
        change(&mut setup);
        Stage { name, scene, setup }
    };
    // Turns alpha-tested casters into foil that its texture tints.
    let as_foil = |mut stage: Stage| {
        for material in stage.scene.materials.iter_mut().filter(|material| material.alpha != AlphaMode::Opaque) {
            material.alpha = AlphaMode::Blend;
            material.base_color = Vec4::new(0.9, 0.4, 0.1, 0.8);
            material.transmission = 1.0;
        }
        stage
    };
    STAGES.get_or_init(|| {
        vec![
            stage("boards under a rectangle", "builtin:overlap", &|_| {}),
            stage("a plank under a disk", "builtin:leaning-plank", &|setup| {
                setup.lights[0].shape = LightShape::Disk { radius_m: 0.4 };
            }),
            stage("columns around an ellipsoid", "builtin:columns", &|setup| {
                setup.lights[0].shape = LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) };
            }),
            stage("a lamp in a room", "builtin:lamp-room", &|_| {}),
            stage("panes of colours", "builtin:stained-glass", &|_| {}),
            stage("masked leaves under a sun", "builtin:tree-alpha", &|setup| {
                let light = &mut setup.lights[0];
                light.shape = LightShape::Sun { angular_diameter_rad: 0.05 };
                light.fov_rad = None;
            }),
            stage("a strip light in a hall", "builtin:hall", &|setup| {
                setup.lights[0].shape = LightShape::Rectangle { size_m: Vec2::new(1.5, 0.3) };
            }),
            stage("a ball at the stairs' horizon", "builtin:staircase", &|setup| {
                setup.lights[0].shape = LightShape::Sphere { radius_m: 0.3 };
            }),
            stage("a masked fence", "builtin:fence-alpha", &|_| {}),
            as_foil(stage("leaves of foil", "builtin:tree-alpha", &|_| {})),
            stage("three points", "builtin:window", &|setup| {
                let light = &mut setup.lights[0];
                let across = 0.2 * Vec3::Y.cross(light.axis).normalize_or(Vec3::X);
                let positions_m = [-across, across, 0.2 * Vec3::Y].map(|offset| light.center + offset).to_vec();
                light.shape = LightShape::Points { positions_m };
            }),
        ]
    })
}

/// Number of successive frames for masks that depend on several.
const FRAMES: u32 = 4;
/// Parameters whose masks depend on several frames.
const OVER_TIME: [&str; 2] = ["jitter", "accumulate"];

/// Test scene and settings of a golden mask, with its label.
struct GoldenCase {
    label: String,
    stage: usize,
    settings: Vec<(&'static str, String)>,
    is_denoised: bool,
}

impl GoldenCase {
    fn is_over_time(&self) -> bool {
        self.is_denoised || self.settings.iter().any(|(key, _)| OVER_TIME.contains(key))
    }
}

/// A combination: technique, test scene, settings, and whether it is denoised.
type Together = (TechniqueKind, &'static str, &'static [(&'static str, &'static str)], bool);

/// Combinations with code paths of their own: alpha-tested casters or suns, kernels that extend beyond the map, lookups of
/// light samples in space, rotations over frames.
const TOGETHER: [Together; 18] = [
    (
        TechniqueKind::Lvsm,
        "boards under a rectangle",
        &[("relax_over", "map_as_published"), ("relax_background", "true")],
        false,
    ),
    (
        TechniqueKind::Lvsm,
        "boards under a rectangle",
        &[("relax_over", "map_as_published"), ("relax_from", "0.1")],
        false,
    ),
    (
        TechniqueKind::Lvsm,
        "boards under a rectangle",
        &[("relax_over", "map_as_published"), ("relax_up_to", "0.05")],
        false,
    ),
    (TechniqueKind::Pcf, "a strip light in a hall", &[("kernel_size", "31"), ("map_size", "32")], false),
    (
        TechniqueKind::Pcf,
        "a strip light in a hall",
        &[("kernel", "vogel"), ("kernel_size", "31"), ("map_size", "32")],
        false,
    ),
    (TechniqueKind::Pcf, "boards under a rectangle", &[("kernel", "vogel"), ("samples", "4")], true),
    (TechniqueKind::Pcss, "a plank under a disk", &[("sub", "true")], false),
    (TechniqueKind::Reprojection, "a masked fence", &[("path", "fragment_two_pass")], false),
    (TechniqueKind::ReprojectionLayered, "a masked fence", &[("view_size", "64")], false),
    (
        TechniqueKind::AliasFree,
        "masked leaves under a sun",
        &[("traversal", "raster"), ("planes", "triangle"), ("stored_positions", "true")],
        false,
    ),
    (TechniqueKind::AliasFree, "a masked fence", &[("traversal", "raster"), ("stored_positions", "true")], false),
    (TechniqueKind::AliasFree, "a lamp in a room", &[("traversal", "raster")], false),
    (
        TechniqueKind::SampleBased,
        "columns around an ellipsoid",
        &[("evaluation", "lookup"), ("lookup_size", "32")],
        false,
    ),
    (
        TechniqueKind::SampleBased,
        "masked leaves under a sun",
        &[("traversal", "raster"), ("region", "hexagons"), ("samples", "32")],
        false,
    ),
    (
        TechniqueKind::SampleBased,
        "a masked fence",
        &[("traversal", "raster"), ("stored_positions", "true"), ("samples", "32")],
        false,
    ),
    (TechniqueKind::SampleBased, "a lamp in a room", &[("traversal", "raster"), ("samples", "32")], false),
    (TechniqueKind::SampleBased, "boards under a rectangle", &[("rotate", "true"), ("samples", "4")], true),
    (TechniqueKind::MultiView, "a masked fence", &[("compare", "sharp")], false),
];

/// Returns a technique's golden masks: on every test scene; on the first one also with the paper's parameters, with each
/// parameter at another value, and denoised for one technique; and the combinations.
fn all_of(kind: TechniqueKind) -> Vec<GoldenCase> {
    let on_stages = stages().iter().enumerate().map(|(stage, Stage { name, .. })| GoldenCase {
        label: (*name).to_owned(),
        stage,
        settings: Vec::new(),
        is_denoised: false,
    });
    let of_the_first = |label: String, settings| GoldenCase { label, stage: 0, settings, is_denoised: false };
    let paper: Vec<_> =
        kind.quality_settings(Quality::Paper).into_iter().map(|(key, value)| (key, value.to_string())).collect();
    let paper = (!paper.is_empty()).then(|| of_the_first("quality=paper".to_owned(), paper));
    // Few samples, which are spread differently in each frame.
    let denoised = (kind == TechniqueKind::Pcss).then(|| GoldenCase {
        is_denoised: true,
        ..of_the_first("denoised".to_owned(), vec![("samples", "8".to_owned()), ("search_samples", "8".to_owned())])
    });
    let specs = kind.param_specs().iter().filter(|spec| !UNSTEADY.contains(&spec.key));
    let small = small(kind);
    let others = specs.flat_map(|spec| {
        let kept = |value: String| of_the_first(format!("{}={value}", spec.key), vec![(spec.key, value)]);
        let is_small = small.iter().find(|(key, _)| *key == spec.key);
        others(spec, is_small.map_or_else(|| spec.default.to_string(), |(_, value)| value.clone()))
            .into_iter()
            .map(kept)
    });
    let together = TOGETHER.iter().filter(|(of, ..)| *of == kind).map(|(_, name, settings, is_denoised)| GoldenCase {
        label: format!(
            "{name}, {}{}",
            settings.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(" "),
            if *is_denoised { ", denoised" } else { "" }
        ),
        stage: stages().iter().position(|stage| stage.name == *name).expect("a stage"),
        settings: settings.iter().map(|(key, value)| (*key, (*value).to_owned())).collect(),
        is_denoised: *is_denoised,
    });
    on_stages.chain(paper).chain(denoised).chain(others).chain(together).collect()
}

/// Settings of a technique in place of its defaults.
fn small(kind: TechniqueKind) -> Vec<(&'static str, String)> {
    let small = SMALL.into_iter().chain(OF_VIEWS.contains(&kind).then_some(FEW_VIEWS));
    let small = small.filter(|(key, _)| kind.param_specs().iter().any(|spec| spec.key == *key));
    small.map(|(key, value)| (key, value.to_owned())).collect()
}

/// Returns other values of a parameter: all choices, or one number, which is smaller and therefore faster if possible.
/// Names that replace numbers are ignored.
fn others(spec: &ParamSpec, value: String) -> Vec<String> {
    if let ParamValue::List(_) = spec.default {
        return Vec::new();
    }
    let Some((low, high)) = spec.range else {
        let choices = if spec.choices.is_empty() { &["true", "false"] } else { spec.choices };
        return choices.iter().filter(|choice| **choice != value).map(|choice| (*choice).to_owned()).collect();
    };
    let value: f64 = value.parse().expect("a number's");
    let other = match spec.is_whole() {
        true if value > low => (0.5 * value).floor().max(low),
        true => (value + 1.0).min(high),
        false if value > low => (0.5 * value).max(low),
        false => low + 0.0625 * (high - low),
    };
    vec![(other as f32).to_string()]
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// Colour in place of a mask that the technique refuses; no mask has it.
const REFUSED: Rgb<u8> = Rgb([160, 0, 160]);

/// A mask in 8 bits, and its mean over pixels and channels, which detects finer changes; 0 for a refused mask.
struct Mask {
    picture: RgbImage,
    mean: f64,
}

fn mask_of(lab: &LabDevice, kind: TechniqueKind, kept: &GoldenCase) -> Mask {
    let settings = small(kind).into_iter().chain(kept.settings.iter().cloned());
    let settings = settings.map(|(key, value)| (key.to_owned(), value)).collect();
    let choice = TechniqueChoice::with_settings(kind, settings)
        .with_extras(Extras { is_denoised: kept.is_denoised, ..Extras::default() });
    let frames = if kept.is_over_time() { FRAMES } else { 1 };
    let Stage { scene, setup, .. } = &stages()[kept.stage];
    let view = View::new(lab, scene, setup, MASK_PX).expect("built-in scenes can be seen");
    match view.create(&choice).and_then(|mut technique| view.draw(&mut technique, 0, frames)) {
        Ok(drawn) => Mask { picture: drawn.visibility.to_gray_levels(), mean: mean_of(&drawn.visibility) },
        Err(LabError::Technique(_)) => Mask { picture: RgbImage::from_pixel(MASK_PX.x, MASK_PX.y, REFUSED), mean: 0.0 },
        Err(error) => panic!("{kind}, {}: {error}", kept.label),
    }
}

fn mean_of(visibility: &Visibility) -> f64 {
    let (pixels, channels) = (pixel_count(visibility.size_px), visibility.channel_count());
    let sum: f64 = (0..pixels).flat_map(|i| (0..channels).map(move |c| f64::from(visibility.at(i, c)))).sum();
    sum / (pixels * channels) as f64
}

/// Number of pixels that may differ, and change of the mean, on an adapter of the same name.
type Tolerance = (usize, f64);

fn tolerance(kind: TechniqueKind, label: &str) -> Tolerance {
    let rough = LOOSE_TOLERANCES.iter().find(|(of, mask, ..)| (*of, *mask) == (kind, label));
    rough.map_or((SAME_PIXELS, SAME_MEAN), |(_, _, pixels, mean, _)| (*pixels, *mean))
}

/// Describes the difference of two masks if it exceeds the tolerance; `None` as tolerance means another adapter.
fn difference(was: &Mask, is: &Mask, of_same_adapter: Option<Tolerance>) -> Option<String> {
    let (old, new) = (&was.picture, &is.picture);
    let levels = || old.as_raw().iter().zip(new.as_raw()).map(|(a, b)| a.abs_diff(*b));
    let apart = levels().map(f64::from).sum::<f64>() / (255.0 * old.as_raw().len() as f64);
    let pixels = old.pixels().zip(new.pixels());
    let beyond = pixels.filter(|(a, b)| (0..3).any(|c| a[c].abs_diff(b[c]) > SAME_LEVELS)).count();
    let more = is.mean - was.mean;
    let is_far = match of_same_adapter {
        Some((pixels, mean)) => beyond > pixels || more.abs() > mean,
        None => apart > OTHER_MEAN,
    };
    is_far.then(|| format!("{beyond} pixels differ, by {apart:.4} over all; the mean is {more:+.6} more"))
}

fn sheet_of(masks: &[Mask]) -> RgbImage {
    let down = masks.len().div_ceil(ACROSS as usize) as u32;
    let mut sheet = RgbImage::new(ACROSS * MASK_PX.x, down * MASK_PX.y);
    for (i, mask) in (0..).zip(masks) {
        sheet.copy_from(&mask.picture, i % ACROSS * MASK_PX.x, i / ACROSS * MASK_PX.y).expect("it has room");
    }
    sheet
}

fn mask_in(sheet: &RgbImage, i: u32) -> RgbImage {
    sheet.view(i % ACROSS * MASK_PX.x, i / ACROSS * MASK_PX.y, MASK_PX.x, MASK_PX.y).to_image()
}

/// Whether the golden masks are to be updated.
fn updates_golden() -> bool {
    std::env::var_os("ANTUMBRA_UPDATE_GOLDEN").is_some()
}

const UPDATE_HINT: &str = "ANTUMBRA_UPDATE_GOLDEN=1 updates them";

/// First line of a text file: the adapter of its masks or numbers.
fn heading(lab: &LabDevice) -> String {
    format!("drawn on {}", lab.adapter.name)
}

/// Returns the lines of a text file, and whether they are from this adapter.
fn golden_text(lab: &LabDevice, path: &Path) -> (Vec<String>, bool) {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}; {UPDATE_HINT}", path.display()));
    let mut lines = text.lines().map(str::to_owned);
    let is_same_adapter = lines.next() == Some(heading(lab));
    (lines.collect(), is_same_adapter)
}

fn keep_text(lab: &LabDevice, path: &Path, lines: &[String]) {
    let text = format!("{}\n{}\n", heading(lab), lines.join("\n"));
    fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// Compares the first `most` masks of a technique with the golden masks.
fn masks_equal_golden_ones(kind: TechniqueKind, most: usize) {
    let Some(lab) = lab() else { return };
    let (picture, words) = (folder().join(format!("{kind}.png")), folder().join(format!("{kind}.txt")));
    let all = all_of(kind);
    if updates_golden() {
        let masks: Vec<Mask> = all.iter().map(|kept| mask_of(lab, kind, kept)).collect();
        fs::create_dir_all(folder()).expect("a folder");
        sheet_of(&masks).save(&picture).expect("a picture");
        let lines = all.iter().zip(&masks).map(|(kept, mask)| format!("{}: {:.6}", kept.label, mask.mean));
        keep_text(lab, &words, &lines.collect::<Vec<_>>());
        return;
    }
    let (lines, is_same_adapter) = golden_text(lab, &words);
    let lines: Vec<_> = lines.iter().map(|line| line.rsplit_once(": ").expect("a line of ours")).collect();
    let labels: Vec<_> = all.iter().map(|kept| kept.label.as_str()).collect();
    let golden_labels: Vec<_> = lines.iter().map(|(label, _)| *label).collect();
    assert_eq!(golden_labels, labels, "{}: parameters are other ones; {UPDATE_HINT}", words.display());
    let sheet =
        image::open(&picture).unwrap_or_else(|error| panic!("{}: {error}; {UPDATE_HINT}", picture.display())).to_rgb8();
    for ((i, kept), (_, mean)) in (0..).zip(&all).zip(lines).take(most) {
        let was = Mask { picture: mask_in(&sheet, i), mean: mean.parse().expect("a number of ours") };
        // Another adapter may support what this one refused.
        if !is_same_adapter && *was.picture.get_pixel(0, 0) == REFUSED {
            continue;
        }
        let tolerance = is_same_adapter.then(|| tolerance(kind, &kept.label));
        if let Some(difference) = difference(&was, &mask_of(lab, kind, kept), tolerance) {
            panic!("{kind}, {}: {difference}; {} has it as mask {i}; {UPDATE_HINT}", kept.label, picture.display());
        }
    }
}

/// Declares a test for each technique, so that a technique can be tested alone.
macro_rules! golden_masks {
    ($($name:ident: $kind:ident,)*) => {
        $(#[test]
        fn $name() {
            masks_equal_golden_ones(TechniqueKind::$kind, usize::MAX);
        })*
    };
}

antumbra::each_technique!(golden_masks);

/// Quick test: only the first mask of each technique, on one test scene.
#[test]
fn one_mask_of_each_technique() {
    if !updates_golden() {
        TechniqueKind::ALL.iter().for_each(|kind| masks_equal_golden_ones(*kind, 1));
    }
}

/// Tolerance of work on the same adapter and on others, whose depths differ by rounding, and minimum tolerance. (The
/// assignment of a cell's triangles to boxes may be random.)
const SAME_WORK: f64 = 0.001;
const OTHER_WORK: f64 = 0.03;
const MIN_WORK: f64 = 4.0;
/// Tolerance for cells: the grouping of a cell's receivers is random and changes the work by a fiftieth; drawing instead of
/// walking would change it by half.
const CELLS: &str = "columns, cells";
const CELLS_TOLERANCE: f64 = 0.1;

/// Culling changes no mask, so the work of `sample_based` is recorded, too, in `work.txt`. Each line is a scene and
/// traversal with the numbers of tested boxes, triangles, pairs, near pairs, words and points.
#[test]
fn work() {
    let Some(lab) = lab() else { return };
    let path = folder().join("work.txt");
    let (mut lines, mut all) = (Vec::new(), Vec::new());
    // With few texels lists are longer than groups; with many they are short.
    let (boxes, hexagons) = (RegionOfInfluence::Boxes, RegionOfInfluence::Hexagons);
    let traversals = [
        ("groups", Traversal::Groups, boxes, 512),
        ("raster", Traversal::Raster, boxes, 512),
        ("raster, hexagons", Traversal::Raster, hexagons, 512),
        ("chosen, 16 texels", Traversal::Chosen, boxes, 16),
        ("chosen, 512 texels", Traversal::Chosen, boxes, 512),
    ];
    for scene in ["overlap", "columns", "knot?triangles=6000", "fence-alpha"] {
        for (name, traversal, region, map_size) in traversals {
            // The grouping of receivers is random here and changes the work by a fifteenth.
            if scene == "fence-alpha" && map_size == 16 {
                continue;
            }
            let params = SampleBasedParams { traversal, region, map_size, samples: 64, ..SampleBasedParams::default() };
            let counts = view_samples::counts(lab, &format!("builtin:{scene}"), WORK_PX, &params, |_| {}).all();
            lines.push(format!("{scene}, {name}: {}", counts.map(|count| count.to_string()).join(" ")));
            all.push(counts);
        }
    }
    // So many receivers that lists are longer than groups and cells are formed; then hexagons for directions.
    let cells = SampleBasedParams { traversal: Traversal::Chosen, map_size: 16, ..SampleBasedParams::default() };
    let drawn = SampleBasedParams { traversal: Traversal::Raster, region: hexagons, ..SampleBasedParams::default() };
    let sun = LightShape::Sun { angular_diameter_rad: 0.1 };
    for (what, scene, shape, size_px, params) in [
        (CELLS, "columns", None, UVec2::new(192, 108), cells),
        ("columns under a sun, raster, hexagons", "columns", Some(sun), WORK_PX, drawn),
    ] {
        let change = |light: &mut Light| light.shape = shape.clone().unwrap_or(light.shape.clone());
        let params = SampleBasedParams { samples: 32, ..params };
        let counts = view_samples::counts(lab, &format!("builtin:{scene}"), size_px, &params, change).all();
        lines.push(format!("{what}: {}", counts.map(|count| count.to_string()).join(" ")));
        all.push(counts);
    }
    if updates_golden() {
        keep_text(lab, &path, &lines);
        return;
    }
    let (kept, is_same_adapter) = golden_text(lab, &path);
    // Other GPUs rasterise receivers a fraction of a pixel away, which moves some to other cells.
    let part = if is_same_adapter { SAME_WORK } else { OTHER_WORK };
    assert_eq!(kept.len(), all.len(), "{}: other scenes", path.display());
    for (line, counts) in kept.iter().zip(all) {
        let (what, numbers) = line.split_once(": ").expect("a line of ours");
        let part = if what == CELLS { CELLS_TOLERANCE } else { part };
        for (was, is) in numbers.split(' ').zip(counts) {
            let (was, is): (f64, f64) = (was.parse().expect("a number"), is.into());
            let may = MIN_WORK + part * was;
            assert!((is - was).abs() <= may, "{what}: {counts:?} were tested, {numbers} before");
        }
    }
}

#[test]
fn one_level_or_a_few_pixels_are_no_difference() {
    let mask = |at: &[usize], level: u8| {
        let mut raw = vec![100; 3 * (MASK_PX.x * MASK_PX.y) as usize];
        at.iter().for_each(|pixel| raw[3 * pixel] = level);
        Mask { picture: RgbImage::from_raw(MASK_PX.x, MASK_PX.y, raw).expect("as many"), mean: 0.4 }
    };
    let was = mask(&[], 0);
    let same = Some((SAME_PIXELS, SAME_MEAN));
    assert_eq!(difference(&was, &mask(&[0, 1, 2, 3, 4], 100 + SAME_LEVELS), same), None);
    assert_eq!(difference(&was, &mask(&[5, 6, 7], 255), same), None);
    assert!(difference(&was, &mask(&[5, 6, 7, 8], 255), same).is_some());
    assert_eq!(difference(&was, &mask(&[5, 6, 7, 8], 255), None), None, "another adapter's edges");
    let half: Vec<usize> = (0..768).collect();
    assert!(difference(&was, &mask(&half, 120), None).is_some());
    let brighter = Mask { mean: 0.4001, ..mask(&[], 0) };
    assert!(difference(&was, &brighter, same).is_some() && difference(&was, &brighter, None).is_none());
}

/// An entry of `LOOSE_TOLERANCES` that matches no mask would have no effect, unnoticed.
#[test]
fn rough_masks_are_masks_of_their_techniques() {
    for (kind, label, pixels, mean, why) in LOOSE_TOLERANCES {
        assert!(all_of(kind).iter().any(|kept| kept.label == label), "{kind} has no mask `{label}`");
        assert!(pixels > SAME_PIXELS && mean > SAME_MEAN && !why.is_empty(), "{kind}, {label}: {pixels}, {mean}");
    }
}
