//! Output files of the commands are complete and have the documented formats.

mod common;

use std::fs;

use common::{adapter, names_in, run};
use exr::prelude::read_all_data_from_file;

/// Name and size of each channel.
fn channels(path: &std::path::Path) -> (Vec<String>, (usize, usize)) {
    let image = read_all_data_from_file(path).unwrap();
    let layer = &image.layer_data[0];
    let names = layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    (names, (layer.size.0, layer.size.1))
}

#[test]
fn render_writes_a_picture_its_visibility_and_its_times() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let words = "render builtin:overlap --technique hard --set map_size=256 --size 67x41 -o a.png --visibility v.exr \
                 --timings t.json";
    let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names_in(dir.path()), ["a.png", "t.json", "v.exr"]);
    assert_eq!(channels(&dir.path().join("v.exr")), (vec!["V".to_owned()], (67, 41)));
    let timings: serde_json::Value = serde_json::from_slice(&fs::read(dir.path().join("t.json")).unwrap()).unwrap();
    assert_eq!(timings["parameters"]["map_size"], 256);
    assert!(timings["lights"][0]["timings"]["total_ms"].as_f64().unwrap() > 0.0);
    assert!(timings["adapter"].as_str().is_some_and(|name| !name.is_empty()));
}

/// The image is shaded by the irradiance ratio, while the file beside it has visibility.
#[test]
fn render_shades_by_the_ratio_and_writes_visibility() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    for factor in ["ratio", "product"] {
        let words = format!(
            "render builtin:hall --technique ray_traced --set samples=8 --size 67x41 --shading {factor} -o {factor}.png \
             --visibility {factor}.exr --timings {factor}.json"
        );
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let read = |name: &str| fs::read(dir.path().join(name)).unwrap();
    assert_eq!(read("ratio.exr"), read("product.exr"));
    assert_ne!(read("ratio.png"), read("product.png"));
    for (factor, weights) in [("ratio", "irradiance"), ("product", "emission")] {
        let timings: serde_json::Value = serde_json::from_slice(&read(&format!("{factor}.json"))).unwrap();
        assert_eq!(timings["parameters"]["weights"], weights);
    }
}

#[test]
fn reference_writes_one_channel_or_three() {
    let dir = tempfile::tempdir().unwrap();
    for (scene, expected) in [("builtin:overlap", vec!["V"]), ("builtin:stained-glass", vec!["V.B", "V.G", "V.R"])] {
        let words = ["reference", scene, "--samples", "4", "--size", "32x18", "-o", "r.png", "--visibility", "v.exr"];
        let output = run(dir.path(), &words);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let (mut names, size) = channels(&dir.path().join("v.exr"));
        names.sort();
        assert_eq!((names, size), (expected.into_iter().map(str::to_owned).collect(), (32, 18)));
    }
}

#[test]
fn names_say_what_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let run = |words: &str| {
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    };
    run("scenes --export overlap -o x.gltf");
    run("scenes --export overlap -o x.glb");
    assert!(fs::read(dir.path().join("x.gltf")).unwrap().starts_with(b"{"));
    for scene in ["x.gltf", "x.glb"] {
        run(&format!("reference {scene} --samples 4 --size 32x18 -o {scene}.jpg --visibility {scene}.exr"));
    }
    assert!(fs::read(dir.path().join("x.gltf.jpg")).unwrap().starts_with(b"\xff\xd8\xff"));
    let visibility = |name: &str| fs::read(dir.path().join(name)).unwrap();
    assert_eq!(visibility("x.gltf.exr"), visibility("x.glb.exr"), "text and container are one scene");
}

/// A search is resumed, and its preset can be used like a technique.
#[test]
fn an_advice_writes_a_preset_that_other_commands_read() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let run = |words: &str| {
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let advise = "advise builtin:overlap --budget 1.2x --techniques hard --size 32x24 --samples 16 -o advice";
    for _ in 0..2 {
        let said = run(advise);
        for part in ["penumbra: ", "--technique advice/advice.toml", "TechniqueKind::", "advice/index.html"] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
    assert_eq!(
        names_in(&dir.path().join("advice")),
        ["advice.json", "advice.toml", "images", "index.html", "measurements.json"]
    );
    let advice: serde_json::Value =
        serde_json::from_slice(&fs::read(dir.path().join("advice/advice.json")).unwrap()).unwrap();
    let best = advice["best"]["rmse"].as_f64().unwrap();
    run("compare builtin:overlap --techniques advice/advice.toml,hard --size 32x24 --samples 16 --frames 1 -o out");
    let metrics: serde_json::Value =
        serde_json::from_slice(&fs::read(dir.path().join("out/metrics.json")).unwrap()).unwrap();
    let here = metrics["rows"][0]["metrics"]["rmse"].as_f64().unwrap();
    assert!((here - best).abs() < 1e-12, "{here} against {best}");
    assert!(metrics["scene_facts"]["penumbra"]["width_px"]["median"].as_f64().unwrap() > 0.0);
    run("render builtin:overlap --technique advice/advice.toml --size 32x24 -o a.png");
}

#[test]
fn a_sweep_is_a_comparison_in_parts() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let run = |words: &str| {
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    };
    run(
        "sweep plan builtin:overlap builtin:leaning-plank --techniques hard,pcf --vary pcf.map_size=256,512 --sizes 48x27 \
         --samples 16 --frames 1 -o sweep",
    );
    run("sweep run sweep --shard 1/2");
    run("sweep run sweep --shard 2/2");
    run("sweep merge sweep -o results.json");
    run(
        "compare builtin:overlap --techniques hard,pcf --set pcf.map_size=256 --size 48x27 --samples 16 --frames 1 -o out",
    );
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&fs::read(dir.path().join(name)).unwrap()).unwrap()
    };
    let (results, metrics) = (read("results.json"), read("out/metrics.json"));
    assert_eq!(results["rows"].as_array().unwrap().len(), 6);
    for row in [0, 1] {
        let [there, here] = [&results["rows"][row], &metrics["rows"][row]];
        assert_eq!((&there["technique"], &there["metrics"]["rmse"]), (&here["technique"], &here["metrics"]["rmse"]));
    }
}

/// Ten kilometres from the world's origin, where 32-bit floats are a millimetre apart, a scene gives the same results as at
/// the origin, and files have world coordinates.
#[test]
fn a_scene_far_from_the_origin_is_as_at_it() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let run = |words: &str| {
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    };
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&fs::read(dir.path().join(name)).unwrap()).unwrap()
    };
    run("scenes --export spheres -o near.gltf");
    let mut far = read("near.gltf");
    let roots = far["scenes"][0]["nodes"].take();
    let nodes = far["nodes"].as_array_mut().unwrap();
    nodes.push(serde_json::json!({ "children": roots, "translation": [10_000.3, 0.0, -7_300.1] }));
    far["scenes"][0]["nodes"] = serde_json::json!([nodes.len() - 1]);
    fs::write(dir.path().join("far.gltf"), far.to_string()).unwrap();

    let options =
        "--techniques multi_view,sample_based,alias_free,pcss --set multi_view.samples=64 --samples 64 --frames 1";
    let rows = |name: &str| {
        run(&format!("compare {name}.gltf {options} --size 64x36 -o {name}"));
        read(&format!("{name}/metrics.json"))["rows"].as_array().unwrap().clone()
    };
    for (near, far) in rows("near").iter().zip(&rows("far")) {
        let [near_rmse, far_rmse] = [near, far].map(|row| row["metrics"]["rmse"].as_f64().unwrap());
        assert!(far_rmse <= 1.1 * near_rmse + 0.002, "{}: {near_rmse} and {far_rmse}", near["technique"]);
    }
    let eye = |toml: &str| {
        let line = toml.lines().find(|line| line.starts_with("eye")).unwrap().to_owned();
        line.split(['[', ',']).nth(1).unwrap().trim().parse::<f64>().unwrap()
    };
    let written = read("far/metrics.json")["scene"]["setup"].as_str().unwrap().to_owned();
    assert!((eye(&written) - 10_000.3).abs() < 100.0, "{written}");
    run(&format!("sweep plan far.gltf {options} --sizes 64x36 -o sweep"));
    run("sweep run sweep");
    run("sweep merge sweep -o results.json");
    let [there, here] = [read("results.json"), read("far/metrics.json")];
    for (there, here) in there["rows"].as_array().unwrap().iter().zip(here["rows"].as_array().unwrap()) {
        let [there, here] = [there, here].map(|row| row["metrics"]["rmse"].as_f64().unwrap());
        assert!((there - here).abs() < 0.001, "{there} and {here}");
    }
}

/// The first light's visibility is written to the given path, and each other light's beside it.
#[test]
fn each_light_has_its_visibility() {
    let dir = tempfile::tempdir().unwrap();
    let light = |name: &str, x: f32| {
        format!(
            "[[light]]\nname = \"{name}\"\nshape = \"sphere\"\nradius = 0.2\ncenter = [{x}, 5.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n"
        )
    };
    let camera = "[camera]\neye = [4.0, 4.0, 6.0]\ntarget = [0.0, 0.5, 0.0]\n";
    fs::write(dir.path().join("two.toml"), format!("{camera}{}{}", light("key", -2.0), light("fill", 3.0))).unwrap();
    let words =
        ["reference", "builtin:overlap", "--setup", "two.toml", "--samples", "4", "--size", "32x18", "-o", "r.png"];
    let one = run(dir.path(), &[&words[..], &["--visibility", "one.exr", "--light", "fill"]].concat());
    assert_eq!(one.status.code(), Some(0), "{}", String::from_utf8_lossy(&one.stderr));
    assert_eq!(names_in(dir.path()), ["one.exr", "r.png", "two.toml"]);
    let all = run(dir.path(), &[&words[..], &["--visibility", "v.exr"]].concat());
    assert!(String::from_utf8_lossy(&all.stderr).contains("visibility of light `fill` to v.fill.exr"));
    assert_eq!(names_in(dir.path()), ["one.exr", "r.png", "two.toml", "v.exr", "v.fill.exr"]);
    let bytes = |name: &str| fs::read(dir.path().join(name)).unwrap();
    assert_eq!(bytes("one.exr"), bytes("v.fill.exr"));
    assert_ne!(bytes("v.exr"), bytes("v.fill.exr"));
}

/// The shadow distance works as an option and in a setup file.
#[test]
fn shadows_end_where_they_are_told_to() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let setup = "[camera]\neye = [4.0, 4.0, 6.0]\ntarget = [0.0, 0.5, 0.0]\n";
    let light = "[[light]]\nshape = \"disk\"\nradius = 0.2\n";
    fs::write(dir.path().join("all.toml"), format!("{setup}{light}")).unwrap();
    fs::write(dir.path().join("near.toml"), format!("{setup}shadow_distance = 8\n{light}")).unwrap();
    // Sum of occlusion over the image's pixels.
    let darkness = |words: &str| {
        let words = format!("render builtin:overlap --technique hard --size 64x36 -o a.png --visibility v.exr {words}");
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        let image = read_all_data_from_file(dir.path().join("v.exr")).unwrap();
        let samples = &image.layer_data[0].channel_data.list[0].sample_data;
        samples.levels_as_slice()[0].values_as_f32().map(|v| 1.0 - v).sum::<f32>()
    };
    let all = darkness("--setup all.toml");
    let by_setup = darkness("--setup near.toml");
    let by_option = darkness("--setup all.toml --shadow-distance 8");
    assert_eq!(by_setup, by_option);
    assert!(by_setup > 5.0 && by_setup < 0.9 * all, "{by_setup} of {all} is dark");
    assert_eq!(darkness("--setup all.toml --shadow-distance 2"), 0.0, "nothing is so near");
}

#[test]
fn compare_writes_a_report_and_replaces_its_own() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let words =
        ["compare", "builtin:overlap", "--techniques", "hard,pcf", "--size", "64x36", "--samples", "16", "-o", "out"];
    for _ in 0..2 {
        let output = run(dir.path(), &words);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(names_in(dir.path()), ["out"]);
    }
    let out = dir.path().join("out");
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    for fetched in ["src=\"http", "href=\"http", "url(http", "@import", "fetch("] {
        assert!(!page.contains(fetched), "the page opens without a network, and it has {fetched}");
    }
    let metrics: serde_json::Value = serde_json::from_slice(&fs::read(out.join("metrics.json")).unwrap()).unwrap();
    let text = metrics.to_string();
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
        assert!(text.contains(&format!("\"{key}\"")), "{key} is missing");
    }
}

#[test]
fn what_moves_is_measured_and_shown() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let words = "compare builtin:overlap --techniques hard,pcf --size 64x36 --samples 16 --motion caster,camera --motion-frames 3 \
                 --caster boards -o out";
    let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("Motion, 3 frames of 0.15 m each"));
    let out = dir.path().join("out");
    let metrics: serde_json::Value = serde_json::from_slice(&fs::read(out.join("metrics.json")).unwrap()).unwrap();
    assert_eq!(metrics["motion"]["motions"]["caster"]["caster"], "boards");
    for row in metrics["rows"].as_array().unwrap() {
        for motion in ["caster", "camera"] {
            let figures = &row["motion"][motion];
            assert!(
                figures["flicker"].as_f64().unwrap() > 0.0 && figures["ratio"].as_f64().unwrap() > 0.0,
                "{figures}"
            );
            assert!(out.join(figures["image"].as_str().unwrap()).is_file());
        }
    }
    // An unknown mesh name is reported before the long work, and the earlier report stays.
    let unknown =
        ["compare", "builtin:overlap", "--motion", "caster", "--caster", "board", "--size", "64x36", "-o", "out"];
    let output = run(dir.path(), &unknown);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("available: ground, boards, table"));
    assert!(out.join("images/hard_motion_camera.png").is_file());
}

#[test]
fn a_preset_is_a_paper_s_comparison_as_published() {
    let dir = tempfile::tempdir().unwrap();
    let told = run(dir.path(), &["techniques", "lvsm"]);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("As published: lvsm:paper") && told.contains("  transition = mixed\n"), "{told}");
    if adapter().is_none() {
        return;
    }
    let words = "compare builtin:overlap --preset lauritzen-2008 --size 64x36 --samples 4 --frames 1 -o out";
    let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let metrics = fs::read_to_string(dir.path().join("out/metrics.json")).unwrap();
    let metrics: serde_json::Value = serde_json::from_str(&metrics).unwrap();
    let names: Vec<_> =
        metrics["rows"].as_array().unwrap().iter().map(|row| row["technique"].as_str().unwrap()).collect();
    assert_eq!(names, ["lvsm:paper", "evsm:paper", "vsm", "convolution"]);
    let both =
        run(dir.path(), &["compare", "builtin:overlap", "--preset", "shen-2013", "--techniques", "pcss", "-o", "x"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn bench_measures_the_light_and_the_camera_that_it_is_given() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let camera = "[camera]\neye = [4.0, 4.0, 6.0]\ntarget = [0.0, 0.5, 0.0]\n";
    let light = "[[light]]\nshape = \"sphere\"\nradius = 0.2\ntarget = [0.0, 0.0, 0.0]\n";
    let setup = format!("{camera}{light}name = \"lamp\"\ncenter = [0.0, 5.0, 0.0]\n");
    fs::write(dir.path().join("s.toml"), setup).unwrap();
    let words = "bench builtin:overlap --setup s.toml --light lamp --techniques hard,pcf --sizes 64x36 --frames 2 --json t.json";
    let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{told}");
    assert!(told.contains("2 techniques on 1 scene at 64x36") && told.contains("at most 10 minutes"), "{told}");
    let json: serde_json::Value = serde_json::from_slice(&fs::read(dir.path().join("t.json")).unwrap()).unwrap();
    assert_eq!(json["rows"].as_array().unwrap().len(), 2);
    for row in json["rows"].as_array().unwrap() {
        assert_eq!((&row["ran"]["timings"]["frames"], &row["light"]), (&2.into(), &"lamp".into()));
    }
}

#[test]
fn compare_shades_coherently_where_it_is_asked_to() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let pictures = ["", " --coherent"].map(|how| {
        let words =
            format!("compare builtin:spheres --techniques hard --size 64x36 --samples 4 --frames 1 -o out{how}");
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let metrics = fs::read_to_string(dir.path().join("out/metrics.json")).unwrap();
        let metrics: serde_json::Value = serde_json::from_str(&metrics).unwrap();
        assert_eq!(metrics["rows"][0]["command"].as_str().unwrap().contains("--coherent"), !how.is_empty());
        fs::read(dir.path().join("out/images/reference_shaded.png")).unwrap()
    });
    assert_ne!(pictures[0], pictures[1]);
}

#[test]
fn what_is_assumed_of_a_scene_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let told = |words: &str| {
        let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{told}");
        told
    };
    // One triangle without camera and lights.
    let triangle = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    fs::write(dir.path().join("t.gltf"), triangle).unwrap();
    let plain = told("reference t.gltf --samples 4 --size 32x18 -o a.png --visibility a.exr --time 3");
    assert!(
        plain.contains("t has no camera, so one that frames it was added; no lights, so a square one of"),
        "{plain}"
    );
    assert!(plain.contains("t has no ground, so a ground plane was added; --ground=no omits it"), "{plain}");
    let quiet = told("reference t.gltf --samples 4 --size 32x18 -o a.png --time 3 --quiet");
    assert!(quiet.is_empty(), "{quiet}");
    let bare = told("reference t.gltf --samples 4 --size 32x18 -o a.png --ground=no");
    assert!(!bare.contains("ground plane"), "{bare}");
    assert!(plain.contains("--time 3: nothing in the scene is animated"), "{plain}");
    // The camera looks from the side to which the shadow falls.
    let setup = "[camera]\neye = [2.0, 2.0, -2.0]\ntarget = [0.5, 0.0, -0.3]\n[[light]]\nshape = \"sphere\"\nradius = 0.1\n\
                 center = [-1.0, 3.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n";
    fs::write(dir.path().join("s.toml"), setup).unwrap();
    let seen = "reference t.gltf --setup s.toml --samples 4 --size 32x18";
    told(&format!("{seen} -o a.png --visibility a.exr"));
    told(&format!("{seen} -o b.png --visibility b.exr --ground"));
    let dark_pixels = |name: &str| {
        let image = read_all_data_from_file(dir.path().join(name)).unwrap();
        let samples = &image.layer_data[0].channel_data.list[0].sample_data;
        let values: Vec<f32> = samples.levels_as_slice()[0].values_as_f32().collect();
        values.iter().filter(|v| **v < 0.5).count()
    };
    assert!(dark_pixels("b.exr") > dark_pixels("a.exr") + 5, "the shadow falls on the ground");
    assert!(told("reference builtin:overlap --samples 4 --size 32x18 -o c.png").is_empty(), "nothing is assumed");
}

#[test]
fn several_scenes_get_a_folder_each() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let words = "compare builtin:overlap builtin:leaning-plank --techniques hard --size 32x18 --samples 4 -o out";
    let output = run(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let out = dir.path().join("out");
    assert!(out.join("index.html").is_file());
    for scene in ["overlap", "leaning-plank"] {
        assert!(out.join(scene).join("index.html").is_file(), "{scene}");
    }
}

#[test]
fn every_technique_explains_its_parameters() {
    let dir = tempfile::tempdir().unwrap();
    let list = run(dir.path(), &["techniques"]);
    let list = String::from_utf8_lossy(&list.stdout).into_owned();
    for name in ["hard", "pcf", "pcss", "multi_view"] {
        assert!(list.contains(name));
        let page = run(dir.path(), &["techniques", name]);
        let page = String::from_utf8_lossy(&page.stdout).into_owned();
        assert!(page.contains("bias_scale") && page.contains("default") && page.contains("from 16 to 8192"), "{page}");
    }
}

#[test]
fn lists_are_json_where_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let json = |words: &[&str]| -> serde_json::Value {
        let output = run(dir.path(), words);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{words:?}: {error}"))
    };
    let names = |list: &serde_json::Value| -> Vec<String> {
        list.as_array().unwrap().iter().map(|item| item["name"].as_str().unwrap().to_owned()).collect()
    };
    let techniques = json(&["techniques", "--json"]);
    let kinds: Vec<String> = antumbra::TechniqueKind::ALL.iter().map(|kind| kind.name().to_owned()).collect();
    assert_eq!(names(&techniques), kinds);
    let pcf = json(&["techniques", "pcf", "--json"]);
    let samples = pcf["parameters"].as_array().unwrap().iter().find(|parameter| parameter["key"] == "samples").unwrap();
    assert!(samples["default"].is_u64() && samples["range"][0].is_number(), "{samples}");
    assert_eq!(pcf["qualities"]["balanced"], serde_json::json!({}));
    let scenes = json(&["scenes", "--json"]);
    assert!(names(&scenes).contains(&"builtin:overlap".to_owned()));
    let parameters: Vec<_> =
        scenes.as_array().unwrap().iter().flat_map(|s| s["parameters"].as_array().unwrap()).collect();
    assert!(parameters.iter().any(|parameter| parameter["name"] == "triangles"), "{parameters:?}");
    if adapter().is_some() {
        let doctor = json(&["doctor", "--json"]);
        assert!(doctor["in_use"]["name"].as_str().is_some_and(|name| !name.is_empty()));
        assert!(
            doctor["techniques"]["hard"].is_null() && doctor["techniques"].as_object().unwrap().len() == kinds.len()
        );
    }
}

/// Manual pages exist for every command, and shell completions for every option.
#[test]
fn manual_pages_and_completions_have_every_command() {
    let dir = tempfile::tempdir().unwrap();
    let man = run(dir.path(), &["man", "-o", "man1"]);
    assert_eq!(man.status.code(), Some(0), "{}", String::from_utf8_lossy(&man.stderr));
    let pages = names_in(&dir.path().join("man1"));
    for page in ["antumbra.1", "antumbra-compare.1", "antumbra-sweep-plan.1", "antumbra-man.1"] {
        assert!(pages.iter().any(|name| name == page), "{page}: {pages:?}");
    }
    let compare = fs::read_to_string(dir.path().join("man1/antumbra-compare.1")).unwrap();
    assert!(compare.starts_with(".ie") && compare.contains("techniques"), "{compare}");
    for shell in ["bash", "zsh", "fish", "elvish", "PowerShell"] {
        let script = run(dir.path(), &["completions", shell]);
        let script = String::from_utf8_lossy(&script.stdout).into_owned();
        assert!(script.contains("shadow-distance") && script.contains("reproduce"), "{shell}: {script}");
    }
}

/// Ctrl-C during tracing gives exit code 130 and leaves the folder empty.
#[cfg(unix)]
#[test]
fn an_interruption_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let words = ["reference", "builtin:overlap", "--samples", "65536", "--size", "4096x4096", "-o", "a.png"];
    let mut child = common::antumbra(dir.path())
        .args(words)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(1));
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(names_in(dir.path()).is_empty());
}

/// A closed pipe, as in `antumbra techniques pcss | head -1`, is no error; a full disk is an error in one line.
#[test]
#[cfg(target_os = "linux")]
fn a_closed_pipe_is_no_error_and_a_full_disk_is_one() {
    let command = || {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_antumbra"));
        command.args(["techniques", "pcss"]).stderr(std::process::Stdio::piped());
        command
    };
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = command().stdout(writer).output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = command().stdout(full).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        message.starts_with("antumbra: cannot write to standard output") && message.lines().count() == 1,
        "{message}"
    );
}
