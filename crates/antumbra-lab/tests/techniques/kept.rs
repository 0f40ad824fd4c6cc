//! Pictures that are kept. Every technique's masks, with small maps on several stages and on one of them with each of its parameters
//! at another value, equal those in `tests/kept/`, so that no change of a shader passes unseen.
//!
//! What a mask should be is what the other modules hold against rays; a kept picture says that it is what it was. One that was
//! meant to change is kept anew by `ANTUMBRA_KEEP=1 cargo test -p antumbra-lab --test techniques kept`, and looked at.
//!
//! A technique's picture has a mask for each stage, parameter or both; a line of its text says what it is of, and its mean.

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

/// Masks are small: what tells is that they are many.
const MASK_PX: UVec2 = UVec2::new(48, 32);
/// Masks side by side.
const ACROSS: u32 = 8;

/// Counts are of more receivers, so that groups of them are some.
const WORK_PX: UVec2 = UVec2::new(96, 54);

/// By as much 8-bit levels may differ where the adapter is the one that they were kept on, and so many pixels of a mask may by more.
const SAME_LEVELS: u8 = 2;
const SAME_PIXELS: usize = 3;
/// And so much the mean: masks are the same bits from run to run, on however many threads. It tells of what is less than a level
/// everywhere, or more at a pixel or two.
const SAME_MEAN: f64 = 2e-5;
/// More for masks that depend on last bits: a technique, a label, how many pixels, how much of the mean, and why. They are what versions of
/// software Mesa differ by, which share a name and compile sums in other orders and with other roundings.
const ROUGH: [(TechniqueKind, &str, usize, f64, &str); 2] = [
    (TechniqueKind::Vssm, "a ball at the stairs' horizon", 16, 5e-4, NEAR_NONE),
    (TechniqueKind::Evssm, "a ball at the stairs' horizon", 20, 1.2e-3, NEAR_NONE),
];
const NEAR_NONE: &str = "along the horizon a step has one depth: its variance is the last bits of a difference of sums, taken for one or none";
/// Another adapter rounds otherwise, and covers other pixels along edges: the mean over a mask, of the whole range.
const OTHER_MEAN: f64 = 0.01;

/// In place of the defaults, so that all of it takes a minute: maps that suffice for so few pixels, and fewer views.
const SMALL: [(&str, &str); 2] = [("map_size", "256"), ("view_size", "128")];
const FEW_VIEWS: (&str, &str) = ("samples", "16");
const OF_VIEWS: [TechniqueKind; 3] =
    [TechniqueKind::MultiView, TechniqueKind::Reprojection, TechniqueKind::ReprojectionLayered];

/// Not changed: what is on each run another mask by its nature.
const UNSTEADY: [&str; 1] = ["synchronized"];

/// A scene with a light of some kind.
struct Stage {
    name: &'static str,
    scene: Scene,
    setup: Setup,
}

/// Lights of all kinds, tinted and masked casters, receivers all around a light and along its horizon, a mesh that encloses it.
fn stages() -> &'static [Stage] {
    static STAGES: OnceLock<Vec<Stage>> = OnceLock::new();
    let stage = |name, scene: &str, change: &dyn Fn(&mut Setup)| {
        let scene = load(scene, &LoadOptions::default()).expect("a built-in scene");
        let mut setup = Setup::for_scene(&scene);
        change(&mut setup);
        Stage { name, scene, setup }
    };
    // What is masked elsewhere, as foil that tints by its texture.
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

/// Frames after one another where a mask is made of several.
const FRAMES: u32 = 4;
/// By these parameters it is.
const OVER_TIME: [&str; 2] = ["jitter", "accumulate"];

/// A stage's number and settings, with the words by which they are kept.
struct Kept {
    label: String,
    stage: usize,
    settings: Vec<(&'static str, String)>,
    is_denoised: bool,
}

impl Kept {
    fn is_over_time(&self) -> bool {
        self.is_denoised || self.settings.iter().any(|(key, _)| OVER_TIME.contains(key))
    }
}

/// What tells only together: a technique, a stage, settings, and whether it is denoised.
type Together = (TechniqueKind, &'static str, &'static [(&'static str, &'static str)], bool);

/// Paths of their own that masked casters or suns take; kernels that reach beyond the map's ends; lookups of light points in space;
/// turns that go on from frame to frame.
const TOGETHER: [Together; 18] = [
    (
        TechniqueKind::Lvsm,
        "boards under a rectangle",
        &[("relax_over", "map_as_printed"), ("relax_background", "true")],
        false,
    ),
    (
        TechniqueKind::Lvsm,
        "boards under a rectangle",
        &[("relax_over", "map_as_printed"), ("relax_from", "0.1")],
        false,
    ),
    (
        TechniqueKind::Lvsm,
        "boards under a rectangle",
        &[("relax_over", "map_as_printed"), ("relax_up_to", "0.05")],
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

/// By itself on every stage, as its paper has it on the first, and there with each parameter at another value; the denoiser behind
/// one, and what tells together.
fn all_of(kind: TechniqueKind) -> Vec<Kept> {
    let on_stages = stages().iter().enumerate().map(|(stage, Stage { name, .. })| Kept {
        label: (*name).to_owned(),
        stage,
        settings: Vec::new(),
        is_denoised: false,
    });
    let of_the_first = |label: String, settings| Kept { label, stage: 0, settings, is_denoised: false };
    let paper: Vec<_> =
        kind.quality_settings(Quality::Paper).into_iter().map(|(key, value)| (key, value.to_string())).collect();
    let paper = (!paper.is_empty()).then(|| of_the_first("quality=paper".to_owned(), paper));
    // Of few taps, which are spread anew in each frame.
    let denoised = (kind == TechniqueKind::Pcss).then(|| Kept {
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
    let together = TOGETHER.iter().filter(|(of, ..)| *of == kind).map(|(_, name, settings, is_denoised)| Kept {
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

/// What a technique has in place of its defaults.
fn small(kind: TechniqueKind) -> Vec<(&'static str, String)> {
    let small = SMALL.into_iter().chain(OF_VIEWS.contains(&kind).then_some(FEW_VIEWS));
    let small = small.filter(|(key, _)| kind.param_specs().iter().any(|spec| spec.key == *key));
    small.map(|(key, value)| (key, value.to_owned())).collect()
}

/// Values of a parameter other than the one that it has: all of a choice, of a number one. It is less, which takes less time,
/// where there is less. Names in a number's place stand for numbers.
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
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/kept")
}

/// In place of a mask where the technique refuses, which is kept as well: no mask has such a colour.
const REFUSED: Rgb<u8> = Rgb([160, 0, 160]);

/// A mask in 8 bits, and its mean over pixels and channels, which tells of finer changes; a refused one's is 0.
struct Mask {
    picture: RgbImage,
    mean: f64,
}

fn mask_of(lab: &LabDevice, kind: TechniqueKind, kept: &Kept) -> Mask {
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

/// How many pixels of a mask may differ, and how much its mean, on an adapter of the same name.
type Tolerance = (usize, f64);

fn tolerance(kind: TechniqueKind, label: &str) -> Tolerance {
    let rough = ROUGH.iter().find(|(of, mask, ..)| (*of, *mask) == (kind, label));
    rough.map_or((SAME_PIXELS, SAME_MEAN), |(_, _, pixels, mean, _)| (*pixels, *mean))
}

/// How far two masks are apart, where that is more than they may be: the tolerance is of the same adapter, `None` of any other.
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

/// Whether all is to be kept anew.
fn keeps_anew() -> bool {
    std::env::var_os("ANTUMBRA_KEEP").is_some()
}

const AGAIN: &str = "ANTUMBRA_KEEP=1 keeps them anew";

/// The first line of a text: on which adapter its pictures or numbers were kept.
fn heading(lab: &LabDevice) -> String {
    format!("kept on {}", lab.adapter.name)
}

/// The lines of a kept text, and whether they are of this adapter.
fn kept_text(lab: &LabDevice, path: &Path) -> (Vec<String>, bool) {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}; {AGAIN}", path.display()));
    let mut lines = text.lines().map(str::to_owned);
    let is_same_adapter = lines.next() == Some(heading(lab));
    (lines.collect(), is_same_adapter)
}

fn keep_text(lab: &LabDevice, path: &Path, lines: &[String]) {
    let text = format!("{}\n{}\n", heading(lab), lines.join("\n"));
    fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// The first `most` masks of a technique are those that were kept.
fn pictures_are_kept(kind: TechniqueKind, most: usize) {
    let Some(lab) = lab() else { return };
    let (picture, words) = (folder().join(format!("{kind}.png")), folder().join(format!("{kind}.txt")));
    let all = all_of(kind);
    if keeps_anew() {
        let masks: Vec<Mask> = all.iter().map(|kept| mask_of(lab, kind, kept)).collect();
        fs::create_dir_all(folder()).expect("a folder");
        sheet_of(&masks).save(&picture).expect("a picture");
        let lines = all.iter().zip(&masks).map(|(kept, mask)| format!("{}: {:.6}", kept.label, mask.mean));
        keep_text(lab, &words, &lines.collect::<Vec<_>>());
        return;
    }
    let (lines, is_same_adapter) = kept_text(lab, &words);
    let lines: Vec<_> = lines.iter().map(|line| line.rsplit_once(": ").expect("a line of ours")).collect();
    let labels: Vec<_> = all.iter().map(|kept| kept.label.as_str()).collect();
    let kept_labels: Vec<_> = lines.iter().map(|(label, _)| *label).collect();
    assert_eq!(kept_labels, labels, "{}: parameters are other ones; {AGAIN}", words.display());
    let sheet =
        image::open(&picture).unwrap_or_else(|error| panic!("{}: {error}; {AGAIN}", picture.display())).to_rgb8();
    for ((i, kept), (_, mean)) in (0..).zip(&all).zip(lines).take(most) {
        let was = Mask { picture: mask_in(&sheet, i), mean: mean.parse().expect("a number of ours") };
        // What one adapter refuses another may have.
        if !is_same_adapter && *was.picture.get_pixel(0, 0) == REFUSED {
            continue;
        }
        let tolerance = is_same_adapter.then(|| tolerance(kind, &kept.label));
        if let Some(difference) = difference(&was, &mask_of(lab, kind, kept), tolerance) {
            panic!("{kind}, {}: {difference}; {} has it as mask {i}; {AGAIN}", kept.label, picture.display());
        }
    }
}

/// A test for each technique: a change of one is asked of its own.
macro_rules! kept {
    ($($name:ident: $kind:ident),* $(,)?) => {
        $(#[test]
        fn $name() {
            pictures_are_kept(TechniqueKind::$kind, usize::MAX);
        })*

        #[test]
        fn no_technique_is_left_out() {
            assert_eq!([$(TechniqueKind::$kind),*].as_slice(), TechniqueKind::ALL);
        }
    };
}

kept! {
    hard: Hard,
    pcf: Pcf,
    pcss: Pcss,
    smrt: Smrt,
    bitmask: Bitmask,
    backprojection: Backprojection,
    multi_view: MultiView,
    vsm: Vsm,
    lvsm: Lvsm,
    evsm: Evsm,
    esm: Esm,
    convolution: Convolution,
    moment: Moment,
    pcss_anisotropic: PcssAnisotropic,
    essm: Essm,
    savsm: Savsm,
    vssm: Vssm,
    cssm: Cssm,
    evssm: Evssm,
    mssm: Mssm,
    multi_layer: MultiLayer,
    reprojection: Reprojection,
    reprojection_layered: ReprojectionLayered,
    ray_traced: RayTraced,
    alias_free: AliasFree,
    sample_based: SampleBased,
}

/// For a first look: by each technique's first settings, on one scene.
#[test]
fn one_mask_of_each_technique() {
    if !keeps_anew() {
        TechniqueKind::ALL.iter().for_each(|kind| pictures_are_kept(*kind, 1));
    }
}

/// So much more or less may be tested than was, on the adapter of before and on others, whose depths are others by a rounding. (Which
/// triangles of a cell lie in one box may be random.)
const SAME_WORK: f64 = 0.001;
const OTHER_WORK: f64 = 0.03;
const LEAST_WORK: f64 = 4.0;
/// Which receivers of a cell make a group is random, and with it a fiftieth of what is tested; walked or drawn is another half of it.
const CELLS: &str = "columns, cells";
const CHANCE: f64 = 0.1;

/// What culling spares changes no mask: what `sample_based` tests is kept as well, in `work.txt`. A line for each scene and traversal has
/// the boxes, triangles, pairs, near pairs, words and points that were tested.
#[test]
fn work() {
    let Some(lab) = lab() else { return };
    let path = folder().join("work.txt");
    let (mut lines, mut all) = (Vec::new(), Vec::new());
    // Of a map of so few texels that lists are longer than groups, and of one that has them short.
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
            // Which of its receivers make a group is random, and with it a fifteenth of what is tested.
            if scene == "fence-alpha" && map_size == 16 {
                continue;
            }
            let params = SampleBasedParams { traversal, region, map_size, samples: 64, ..SampleBasedParams::default() };
            let counts = view_samples::counts(lab, &format!("builtin:{scene}"), WORK_PX, &params, |_| {}).all();
            lines.push(format!("{scene}, {name}: {}", counts.map(|count| count.to_string()).join(" ")));
            all.push(counts);
        }
    }
    // So many receivers that lists are longer than groups even so, and cells are made of them; and hexagons of directions.
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
    if keeps_anew() {
        keep_text(lab, &path, &lines);
        return;
    }
    let (kept, is_same_adapter) = kept_text(lab, &path);
    // A graphics card draws receivers elsewhere by a part of a pixel, which moves them between cells.
    let part = if is_same_adapter { SAME_WORK } else { OTHER_WORK };
    assert_eq!(kept.len(), all.len(), "{}: other scenes", path.display());
    for (line, counts) in kept.iter().zip(all) {
        let (what, numbers) = line.split_once(": ").expect("a line of ours");
        let part = if what == CELLS { CHANCE } else { part };
        for (was, is) in numbers.split(' ').zip(counts) {
            let (was, is): (f64, f64) = (was.parse().expect("a number"), is.into());
            let may = LEAST_WORK + part * was;
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

/// One that no technique has would loosen nothing, and be believed to.
#[test]
fn rough_masks_are_masks_of_their_techniques() {
    for (kind, label, pixels, mean, why) in ROUGH {
        assert!(all_of(kind).iter().any(|kept| kept.label == label), "{kind} has no mask `{label}`");
        assert!(pixels > SAME_PIXELS && mean > SAME_MEAN && !why.is_empty(), "{kind}, {label}: {pixels}, {mean}");
    }
}
