//! Tests of a report on synthetic images: files exist and are complete, links work, text is escaped.

use std::collections::BTreeSet;
use std::fs;

use glam::{UVec2, Vec3};
use serde_json::{Map, Value, json};

use super::*;
use crate::image_io::{read_png, read_visibility_exr};
use crate::metrics::{FlipMap, compare_visibility};
use crate::motion::{Motion, MotionFigures, TrueMotion};
use crate::output_files::OutputDir;
use crate::picture::{Picture, Visibility, pixel_count};
use crate::scene_facts::SceneFacts;
use crate::stopwatch::FrameCount;

const SIZE_PX: UVec2 = UVec2::new(48, 27);

/// Returns the shadow of a disc with a linear penumbra of a given width, pixels.
fn disc_shadow(penumbra_px: f32) -> Visibility {
    let values = (0..pixel_count(SIZE_PX)).map(|i| {
        let pos_px = UVec2::new(i as u32 % SIZE_PX.x, i as u32 / SIZE_PX.x).as_vec2() + 0.5;
        let distance_px = pos_px.distance(SIZE_PX.as_vec2() * 0.5) - 8.0;
        (0.5 + distance_px / penumbra_px).clamp(0.0, 1.0)
    });
    Visibility::one(SIZE_PX, values.collect())
}

fn shade(visibility: &Visibility) -> image::RgbImage {
    let color = Vec3::new(0.8, 0.6, 0.4);
    let pixels = (0..pixel_count(SIZE_PX)).map(|i| color * (0.05 + 0.95 * visibility.at(i, 0)));
    Picture::new(SIZE_PX, pixels.collect()).to_srgb8()
}

fn row(technique: &str, outcome: Outcome) -> Row {
    let parameters: Map<String, Value> = json!({ "map_size": 1024, "kernel": "vogel" }).as_object().unwrap().clone();
    Row {
        technique: technique.into(),
        title: format!("Title of {technique}"),
        parameters,
        command: format!("antumbra render builtin:disc --technique {technique} -o out.png"),
        outcome,
        warnings: Vec::new(),
        notes: Vec::new(),
        is_missing: false,
        cut_short_s: None,
        seconds: 0.25,
    }
}

fn synthetic_report() -> Report {
    let reference_visibility = disc_shadow(8.0);
    let judged: Vec<bool> = (0..pixel_count(SIZE_PX)).map(|i| i / SIZE_PX.x as usize > 3).collect();
    let measured = |penumbra_px: f32, ms: f64| {
        let visibility = disc_shadow(penumbra_px);
        let shaded = shade(&visibility);
        let mut metrics = compare_visibility(&reference_visibility, &visibility, &judged).unwrap();
        metrics.add_flip(&FlipMap::new(&shade(&reference_visibility), &shaded).unwrap());
        let pass = |name: &str, share: f64| PassTime { name: name.into(), median_ms: ms * share, ..Default::default() };
        Outcome::Measured(Box::new(Measurement {
            shaded,
            visibility,
            metrics,
            own_truth: None,
            passes: vec![pass("light map", 0.3), pass("resolve", 0.7)],
            total_ms: Some(ms),
            count: FrameCount { frames: 5, warm_up: 2 },
            memory_bytes: Some(4 << 20),
            auto_map_sizes: vec![1448],
            motions: vec![MotionFigures {
                motion: Motion::Light,
                flicker: Some(0.01),
                ratio: Some(0.25),
                lag_frames: None,
                after_stop: vec![0.5; 16],
                lacking_room: 0,
                strip: shade(&reference_visibility),
            }],
        }))
    };
    Report {
        scene: SceneInfo {
            name: "disc <script>alert(1)</script>".into(),
            summary: "A disc & its shadow.".into(),
            triangles: 1234,
            setup_toml: "[camera]\neye = [0, 1, 2]\n# </script>\n".into(),
        },
        facts: Some(SceneFacts::default()),
        adapter: AdapterInfo {
            name: "llvmpipe".into(),
            driver: "Mesa".into(),
            backend: "Vulkan".into(),
            is_software: true,
        },
        commit: "abc1234".into(),
        date: utc_now(),
        command: "antumbra compare builtin:disc -o out".into(),
        rows: vec![
            row("hard", measured(0.01, 1.0)),
            row("pcss", measured(7.0, 3.0)),
            row("needs_more", Outcome::Skipped("it needs 64-bit atomics, which \"llvmpipe\" lacks".into())),
            row("pcss", measured(9.0, 5.0)),
        ],
        reference: Reference {
            shaded: shade(&reference_visibility),
            visibility: reference_visibility,
            judged,
            info: ReferenceInfo { samples: 1024, rays: 1 << 20, seconds: 0.5 },
        },
        motion: Some(MotionInfo {
            frames: 8,
            step_m: 0.15,
            samples: 256,
            truths: vec![TrueMotion {
                motion: Motion::Light,
                caster: None,
                change: Some(0.04),
                noise: Some(0.001),
                strip: shade(&disc_shadow(8.0)),
            }],
        }),
        settings: json!({ "samples": 1024 }),
        missing: Vec::new(),
        baseline: None,
        warnings: vec!["one <b>warning</b>".into()],
    }
}

#[test]
fn a_report_is_whole_and_its_links_lead_somewhere() {
    let root = tempfile::tempdir().unwrap();
    let report = synthetic_report();
    let out = OutputDir::create(&root.path().join("report")).unwrap();
    write_report(out.path(), &report).unwrap();
    let dir = out.finish().unwrap();

    let html = fs::read_to_string(dir.join("index.html")).unwrap();
    assert!(!html.contains("{{") && !html.contains("<script>alert") && !html.contains("<b>warning"));
    assert!(html.contains("Times are from a software renderer"));
    // Once at each time of the three measured rows: in the table, above their passes, and at their images.
    assert_eq!(html.matches("median of 5 frames after 2").count(), 9, "{html}");
    assert!(html.contains("skipped: it needs 64-bit atomics, which &quot;llvmpipe&quot; lacks"));
    let links: BTreeSet<&str> = ["src=\"", "href=\""]
        .iter()
        .flat_map(|attribute| html.split(attribute).skip(1).map(|rest| rest.split('"').next().unwrap()))
        .filter(|link| !link.starts_with("data:"))
        .collect();
    assert!(links.len() > 15);
    for link in links {
        match link.strip_prefix('#') {
            Some(id) => assert!(html.contains(&format!("id=\"{id}\"")), "no {link}"),
            None => assert!(dir.join(link).is_file(), "no {link}"),
        }
    }
    assert!(!html.contains("http://") || html.matches("http").count() == html.matches("http://www.w3.org").count());

    for stem in ["reference", "hard", "pcss", "pcss-2"] {
        assert_eq!(read_png(&dir.join(format!("images/{stem}_shaded.png"))).unwrap().dimensions(), (48, 27));
    }
    let exr = read_visibility_exr(&dir.join("images/pcss-2_visibility.exr")).unwrap();
    assert_eq!(exr, disc_shadow(9.0));
    let values = fs::read_to_string(dir.join("values.js")).unwrap();
    assert_eq!(values.matches("data:image/png;base64,").count(), 5, "the judged pixels and four visibilities");
    // Each error map outlines its worst tile.
    let page = std::fs::read_to_string(dir.join("index.html")).unwrap();
    assert_eq!(page.matches("<i class=\"tile\" style=\"left:").count(), 3);
}

#[test]
fn the_numbers_are_in_the_json() {
    let dir = tempfile::tempdir().unwrap();
    write_report(dir.path(), &synthetic_report()).unwrap();
    let json: Value = serde_json::from_slice(&fs::read(dir.path().join("metrics.json")).unwrap()).unwrap();
    assert_eq!((&json["format"], &json["version"]), (&json!("antumbra-metrics"), &json!(1)));
    assert_eq!(json["size"], json!([48, 27]));
    assert_eq!(json["scene_facts"]["picture"]["lit"], json!(0.0));
    assert_eq!(json["reference"]["rays_per_second"], json!(2_097_152.0));
    assert_eq!(json["reference"]["judged_pixels"], json!(48 * 23));
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    assert_eq!(rows[2]["status"], "skipped");
    assert!(rows[2]["metrics"].is_null() && rows[2]["total_ms"].is_null());
    let pcss = &rows[1];
    assert_eq!(pcss["adapter"], "llvmpipe");
    assert_eq!(pcss["parameters"], json!({ "map_size": 1024, "kernel": "vogel" }));
    assert_eq!(pcss["auto_map_sizes"], json!([1448]));
    assert_eq!(pcss["passes"][0]["name"], "light map");
    assert_eq!((&pcss["total_ms"], &pcss["memory_bytes"]), (&json!(3.0), &json!(4 << 20)));
    assert_eq!((&pcss["frames"], &pcss["warm_up"]), (&json!(5), &json!(2)));
    assert!(rows[2]["frames"].is_null() && rows[2]["warm_up"].is_null());
    for key in [
        "rmse",
        "mae",
        "p99",
        "leak",
        "overshadow",
        "penumbra_rmse",
        "umbra_leak",
        "lit_loss",
        "ssim",
        "flip",
        "roughness",
        "worst_tile",
        "worst_tile_flip",
    ] {
        assert!(pcss["metrics"][key].is_number(), "{key}");
    }
    assert_eq!(json["motion"]["step_m"], json!(0.15));
    assert_eq!(json["motion"]["motions"]["light"]["truth_change"], json!(0.04));
    assert_eq!(
        (&pcss["motion"]["light"]["flicker"], &pcss["motion"]["light"]["lag_frames"]),
        (&json!(0.01), &Value::Null)
    );
    assert!(rows[0]["metrics"]["rmse"].as_f64() > pcss["metrics"]["rmse"].as_f64());
}

#[test]
fn a_report_without_rows_or_times_is_still_a_page() {
    let dir = tempfile::tempdir().unwrap();
    let mut report = synthetic_report();
    if let Outcome::Measured(measured) = &mut report.rows[0].outcome {
        (measured.passes, measured.total_ms, measured.memory_bytes) = (Vec::new(), None, None);
    }
    report.rows.truncate(1);
    write_report(dir.path(), &report).unwrap();
    report.rows.clear();
    write_report(dir.path(), &report).unwrap();
    assert!(fs::read_to_string(dir.path().join("index.html")).unwrap().contains("This adapter reports no times"));
}

#[test]
fn motion_is_a_section_where_something_moved() {
    let dir = tempfile::tempdir().unwrap();
    let mut report = synthetic_report();
    let page = |report: &Report| {
        write_report(dir.path(), report).unwrap();
        fs::read_to_string(dir.path().join("index.html")).unwrap()
    };
    let moved = page(&report);
    assert!(moved.contains("href=\"#motion\"") && moved.contains("images/pcss-2_motion_light.png"));
    assert!(moved.contains("&gt; 16"), "a mask that does not settle");
    report.motion = None;
    assert!(!page(&report).contains("\"#motion\""));
}

#[test]
fn an_index_links_its_reports() {
    let dir = tempfile::tempdir().unwrap();
    let report = synthetic_report();
    write_index(dir.path(), &[IndexEntry::of("disc", &report), IndexEntry::of("other", &report)]).unwrap();
    let html = fs::read_to_string(dir.path().join("index.html")).unwrap();
    assert!(html.contains("href=\"disc/index.html\"") && html.contains("src=\"other/images/reference_shaded.png\""));
    assert!(html.contains("Error against time") && html.contains("class=\"scatter\""), "a front over all scenes");
    assert!(html.contains("type=\"range\"") && html.contains("src=\"disc/images/hard_shaded.png\""), "{html}");
    let summary = fs::read_to_string(dir.path().join("summary.md")).unwrap();
    assert!(
        summary.contains("| technique | rmse | median ms | timed frames | warm-up frames |") && summary.contains("**`"),
        "{summary}"
    );
    assert!(
        summary.contains(" | 1.00 | 5 | 2 |") && html.contains("1.00 ms<br>median of 5 frames after 2"),
        "{summary}"
    );
    assert!(html.contains("2 scenes, 2 techniques, on llvmpipe") && !html.contains("<script>"));
    let mut without_hard = IndexEntry::of("disc", &report);
    without_hard.techniques.retain(|technique| technique.technique != "hard");
    write_index(dir.path(), &[without_hard]).unwrap();
    let html = fs::read_to_string(dir.path().join("index.html")).unwrap();
    assert!(html.contains("src=\"disc/images/pcss_shaded.png\""), "the largest error against the truth: {html}");
    write_index(dir.path(), &[]).unwrap();
}
