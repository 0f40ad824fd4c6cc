//! Bad input gives one line that names the option, the file and valid values, and the documented exit code; no file
//! remains. No test needs an adapter, because arguments are checked before an adapter is requested.

mod common;

use std::fs;
use std::path::Path;

use common::{antumbra, names_in, run};

/// Runs in an empty folder and checks that the input is refused; the message must contain `parts`.
#[track_caller]
fn refuses(words: &[&str], parts: &[&str]) {
    let dir = tempfile::tempdir().unwrap();
    refuses_in(dir.path(), words, parts);
}

#[track_caller]
fn refuses_in(dir: &Path, words: &[&str], parts: &[&str]) {
    let before = names_in(dir);
    let output = run(dir, words);
    let line = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{words:?}: {line}");
    assert_eq!(line.trim_end().lines().count(), 1, "{words:?} must fail in one line: {line}");
    assert!(line.starts_with("antumbra: "), "{line}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    for part in parts {
        assert!(line.contains(part), "{words:?}: `{part}` is not in: {line}");
    }
    assert_eq!(names_in(dir), before, "nothing is left behind");
}

/// `reproduce` refuses a folder with other files in it.
#[test]
fn reproductions_go_into_folders_of_their_own() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("notes")).unwrap();
    fs::write(dir.path().join("notes/mine.txt"), "mine").unwrap();
    let words = ["reproduce", "--all", "-o", "notes"];
    refuses_in(dir.path(), &words, &["cannot write notes", "no results of `reproduce`", "another folder"]);
}

/// Files of other formats are refused with a hint how to convert them.
#[test]
fn other_formats_are_to_be_converted() {
    let dir = tempfile::tempdir().unwrap();
    for (name, bytes) in
        [("a.obj", &b"v 0 0 0\n"[..]), ("a.fbx", b"Kaydara FBX Binary  \0"), ("a.blend", b"BLENDER-v300")]
    {
        fs::write(dir.path().join(name), bytes).unwrap();
        refuses_in(dir.path(), &["render", name, "-o", "a.png"], &[name, "not a glTF file", "Blender", "glTF 2.0"]);
    }
}

/// Errors are reported before a window opens.
#[test]
#[cfg(feature = "viewer")]
fn a_window_on_nothing() {
    refuses(&["view", "missing.glb"], &["missing.glb", "cannot be read"]);
    refuses(&["view", "builtin:nothing"], &["there is no built-in scene `nothing`"]);
    refuses(&["view", "builtin:overlap", "--setup", "no-such.toml"], &["no-such.toml", "cannot be read"]);
    refuses(&["view", "builtin:overlap", "--set", "map_size=7"], &["--set", "map_size"]);
    refuses(&["view", "builtin:overlap", "--screenshot", "no/such/a.png"], &["no/such/a.png"]);
}

#[test]
fn arguments() {
    refuses(&["frobnicate"], &["frobnicate", "antumbra --help"]);
    refuses(&["render"], &["SCENE", "antumbra render --help"]);
    refuses(&["render", "builtin:overlap"], &["--output"]);
    refuses(&["view", "builtin:overlap", "--show", "all"], &["all", "visibility"]);
    refuses(&["render", "builtin:overlap", "-o", "a.png", "--frob"], &["--frob"]);
    refuses(&["render", "builtin:overlap", "-o", "a.png", "--shadow-distance", "0"], &["--shadow-distance", "above 0"]);
    refuses(&["render", "builtin:overlap", "builtin:tree", "-o", "a.png"], &["builtin:tree"]);
    refuses(&["reference", "builtin:overlap", "-o", "a.png", "--samples", "0"], &["--samples", "1 to 65536"]);
    refuses(&["reference", "builtin:overlap", "-o", "a.png", "--time", "NaN"], &["--time", "seconds"]);
    refuses(&["scenes", "--export", "knot"], &["--output"]);
    refuses(&["scenes", "--export", "knott", "-o", "a.glb"], &["knott", "knot"]);
    refuses(&["bench", "--frames", "0"], &["--frames", "1 to 10000"]);
    refuses(&["bench", "--tables", "no-such.json"], &["no-such.json", "no such file"]);
    refuses(&["bench", "--suite", "no/r.json"], &["no/r.json", "create it"]);
    refuses(&["bench", "builtin:overlap", "--suite", "r.json"], &["--suite", "cannot be used with"]);
    refuses(&["bench", "--minutes", "0"], &["--minutes", "1 to 10000"]);
    refuses(&["bench", "builtin:overlap", "--light", "lamp"], &["--light", "there is no light `lamp`"]);
    refuses(&["bench", "--setup", "no-such.toml"], &["no-such.toml", "cannot be read"]);
    refuses(&["techniques", "psm"], &["psm", "hard, pcf"]);
    refuses(&["reproduce", "marrs-2014/figure99"], &["marrs-2014/figure99", "did you mean"]);
    refuses(&["reproduce", "-o", "papers"], &["-o and --json need entries", "--all"]);
    refuses(&["reproduce", "--all", "--bandwidth", "0"], &["--bandwidth", "gigabytes per second"]);
}

#[test]
fn advice() {
    let advise = |rest: &[&str], parts: &[&str]| refuses(&[&["advise", "builtin:overlap"], rest].concat(), parts);
    advise(&[], &["--budget"]);
    advise(&["--budget", "4"], &["--budget", "4ms", "4x"]);
    advise(&["--budget", "4ms", "--memory", "64"], &["--memory", "64MiB"]);
    advise(&["--budget", "4ms", "--roughness", "0"], &["--roughness", "0.01"]);
    advise(&["--budget", "4ms", "--techniques", "pcss:fast"], &["there is no technique `pcss:fast`"]);
    advise(&["--budget", "4ms", "--prefer", "speed"], &["--prefer", "still or motion"]);
    advise(&["--budget", "4ms", "--light", "lamp"], &["--light", "there is no light `lamp`"]);
    advise(&["--budget", "4ms", "--setup", "no-such.toml"], &["no-such.toml", "cannot be read"]);
    refuses(&["advise", "missing.glb", "--budget", "4ms"], &["missing.glb", "cannot be read"]);
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("mine")).unwrap();
    fs::write(dir.path().join("mine/notes.txt"), "mine").unwrap();
    fs::write(dir.path().join("file"), "").unwrap();
    let in_dir = |out: &str, parts: &[&str]| {
        refuses_in(dir.path(), &["advise", "builtin:overlap", "--budget", "4ms", "-o", out], parts);
    };
    in_dir("mine", &["mine", "not empty", "name another folder"]);
    in_dir("file", &["it is a file"]);
}

/// Presets are read wherever a technique can be named.
#[test]
fn preset_files() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("a.toml"), "technique = \"pscs\"\n").unwrap();
    fs::write(dir.path().join("b.toml"), "technique = \"pcss\"\n[parameters]\nmap_size = 7\n").unwrap();
    let output = ["-o", "out.png"];
    for (words, file, part) in [
        (&["render", "builtin:overlap", "--technique"][..], "a.toml", "no technique `pscs`"),
        (&["render", "builtin:overlap", "--technique"], "no-such.toml", "no such file"),
        (&["compare", "builtin:overlap", "--techniques"], "b.toml", "from 16 to 8192"),
        (&["sweep", "plan", "builtin:overlap", "--techniques"], "b.toml", "from 16 to 8192"),
    ] {
        refuses_in(dir.path(), &[words, &[file], &output].concat(), &[file, part]);
    }
}

#[test]
fn sweeps() {
    let plan = |rest: &[&str], parts: &[&str]| {
        refuses(&[&["sweep", "plan", "builtin:overlap", "-o", "sweep"], rest].concat(), parts);
    };
    plan(&["--vary", "nosuch=1,2"], &["--vary", "nosuch"]);
    plan(&["--vary", "map_size=512,7"], &["map_size", "`7`"]);
    plan(&["--sizes", "0x0"], &["--sizes"]);
    refuses(&["sweep", "run", "no-such"], &["no-such", "no such file"]);
    refuses(&["sweep", "run", "no-such", "--shard", "5/4"], &["--shard", "such as 1/4"]);
    refuses(&["sweep", "merge", "no-such", "-o", "r.json"], &["no-such", "no such file"]);
    refuses(&["sweep", "merge", "no-such", "-o", "no/r.json"], &["no/r.json", "create it"]);
}

#[test]
fn sizes() {
    for size in ["0x0", "0x360", "640x0", "640", "640x-3", "100000x100", "wide", "640x360x2"] {
        refuses(&["render", "builtin:overlap", "-o", "a.png", "--size", size], &[size, "--size", "1280x720"]);
    }
}

#[test]
fn techniques_and_parameters() {
    let render = |rest: &[&str], parts: &[&str]| {
        refuses(&[&["render", "builtin:overlap", "-o", "a.png"], rest].concat(), parts);
    };
    render(&["--technique", "pscs"], &["`pscs`", "did you mean `pcss`?", "multi_view"]);
    render(&["--set", "map_siz=512"], &["map_siz", "did you mean `map_size`?"]);
    render(&["--set", "map_size=7"], &["map_size", "`7`", "from 16 to 8192"]);
    render(&["--set", "map_size=big"], &["map_size", "`big`", "whole number"]);
    render(&["--set", "bias_scale=inf"], &["bias_scale", "`inf`", "a number from"]);
    render(&["--set", "map_size"], &["KEY=VALUE"]);
    render(&["--set", "hard.map_size=512"], &["hard", "not among the chosen techniques (smrt)"]);
    let compare = |rest: &[&str], parts: &[&str]| {
        refuses(&[&["compare", "builtin:overlap", "-o", "out"], rest].concat(), parts);
    };
    compare(&["--motion", "camra"], &["--motion", "did you mean `camera`?"]);
    compare(&["--motion", "camera", "--motion-frames", "0"], &["--motion-frames", "1 to 1000"]);
    compare(&["--motion", "camera", "--caster", "boards"], &["--caster", "add `caster` to --motion"]);
    compare(&["--motion", "light", "--path", "a.toml"], &["--path", "add `camera` to --motion"]);
    compare(&["--motion", "camera", "--path", "no-such.toml"], &["no-such.toml", "cannot be read"]);
    compare(&["--step", "0.1"], &["--motion"]);
    compare(&["--techniques", "hard,pcff"], &["pcff", "did you mean `pcf`?"]);
    compare(&["--techniques", ""], &["--techniques"]);
    compare(&["--set", "hard.samples=4"], &["hard has no parameter `samples`"]);
    compare(&["--set", "nosuch=4"], &["nosuch"]);
}

#[test]
fn scene_files() {
    let dir = tempfile::tempdir().unwrap();
    let whole = run(dir.path(), &["scenes", "--export", "overlap", "-o", "whole.glb"]);
    assert!(whole.status.success(), "{}", String::from_utf8_lossy(&whole.stderr));
    let bytes = fs::read(dir.path().join("whole.glb")).unwrap();
    fs::write(dir.path().join("cut.glb"), &bytes[..bytes.len() / 2]).unwrap();
    fs::write(dir.path().join("noise.glb"), b"this is no scene").unwrap();
    let empty = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[]}]}"#;
    fs::write(dir.path().join("empty.gltf"), empty).unwrap();
    for command in ["render", "reference"] {
        let refuses = |scene: &str, parts: &[&str]| refuses_in(dir.path(), &[command, scene, "-o", "a.png"], parts);
        refuses("missing.glb", &["missing.glb", "cannot be read"]);
        refuses("cut.glb", &["cut.glb"]);
        refuses("noise.glb", &["noise.glb"]);
        refuses("empty.gltf", &["empty.gltf", "no triangle"]);
        refuses("overlap", &["no such file", "`builtin:overlap`"]);
        refuses("builtin:whole.glb", &["this is a file", "`whole.glb`"]);
        refuses("builtin:", &["built-in"]);
        refuses("builtin:overlapp", &["overlapp", "overlap"]);
        refuses("builtin:knot?triangles=1", &["triangles", "1000"]);
        refuses("builtin:knot?colour=1", &["colour", "triangles"]);
        refuses(".", &["cannot be read"]);
    }
}

#[test]
fn setup_files() {
    let dir = tempfile::tempdir().unwrap();
    let camera = "[camera]\neye = [4.0, 4.0, 6.0]\ntarget = [0.0, 0.5, 0.0]\n";
    let cases = [
        ("no-such.toml", None, "cannot be read"),
        ("syntax.toml", Some("[camera\n".to_owned()), "syntax.toml:1"),
        (
            "zero-axis.toml",
            Some(format!(
                "{camera}[[light]]\nname = \"key\"\nshape = \"disk\"\nradius = 0.2\ncenter = [0.0, 5.0, 0.0]\n\
                 target = [0.0, 5.0, 0.0]\n"
            )),
            "zero length",
        ),
        (
            "unknown-key.toml",
            Some(format!(
                "{camera}[[light]]\nshape = \"disk\"\nradius = 0.2\nradious = 0.2\ncenter = [0.0, 5.0, 0.0]\n"
            )),
            "radious",
        ),
        (
            "negative.toml",
            Some(format!("{camera}[[light]]\nshape = \"disk\"\nradius = -0.2\ncenter = [0.0, 5.0, 0.0]\n")),
            "radius",
        ),
    ];
    for (name, text, part) in cases {
        if let Some(text) = text {
            fs::write(dir.path().join(name), text).unwrap();
        }
        refuses_in(dir.path(), &["render", "builtin:overlap", "--setup", name, "-o", "a.png"], &[name, part]);
        fs::remove_file(dir.path().join(name)).ok();
    }
}

#[test]
fn names_of_other_kinds_of_files() {
    refuses(&["render", "builtin:overlap", "-o", "a.bmp"], &["a.bmp", "name it .png or .jpg"]);
    refuses(&["reference", "builtin:overlap", "-o", "a.exr"], &["a.exr", "name it .png or .jpg"]);
    refuses(&["render", "builtin:overlap", "-o", "a.png", "--visibility", "v.png"], &["v.png", "name it .exr"]);
    refuses(&["scenes", "--export", "overlap", "-o", "x.obj"], &["x.obj", "name it .glb or .gltf"]);
}

#[test]
fn output_folders() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("file"), "mine").unwrap();
    refuses_in(dir.path(), &["render", "builtin:overlap", "-o", "file/a.png"], &["file/a.png", "not a folder"]);
    refuses_in(dir.path(), &["render", "builtin:overlap", "-o", "no/such/a.png"], &["no/such/a.png", "create it"]);
    refuses_in(dir.path(), &["compare", "builtin:overlap", "-o", "file"], &["file"]);
    refuses_in(dir.path(), &["compare", "builtin:overlap", "-o", "file/out"], &["file/out"]);
    refuses_in(dir.path(), &["scenes", "--export", "overlap", "-o", "file/a.glb"], &["file/a.glb"]);
    refuses_in(
        dir.path(),
        &["render", "builtin:overlap", "-o", "a.png", "--visibility", "no/v.exr"],
        &["no/v.exr", "create it"],
    );
    refuses_in(dir.path(), &["bench", "--json", "no/t.json"], &["no/t.json"]);
    assert_eq!(fs::read_to_string(dir.path().join("file")).unwrap(), "mine");
}

#[test]
fn without_arguments_it_explains_itself() {
    let dir = tempfile::tempdir().unwrap();
    let output = run(dir.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("antumbra compare builtin:overlap"));
    for words in [&["--help"][..], &["--version"], &["compare", "--help"], &["techniques"], &["scenes"], &["reproduce"]]
    {
        let output = run(dir.path(), words);
        assert_eq!(output.status.code(), Some(0), "{words:?}");
        assert!(!output.stdout.is_empty() && output.stderr.is_empty(), "{words:?}");
    }
}

/// The Vulkan loader looks for drivers where these variables point, and finds none.
#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter() {
    let dir = tempfile::tempdir().unwrap();
    let run = |words: &[&str]| {
        let mut command = antumbra(dir.path());
        command.env("VK_DRIVER_FILES", "/nonexistent.json").env("VK_ICD_FILENAMES", "/nonexistent.json");
        command.args(words).output().unwrap()
    };
    for words in [
        &["doctor"][..],
        &["render", "builtin:overlap", "-o", "a.png"],
        &["compare", "builtin:overlap", "-o", "out"],
        &["bench", "builtin:overlap"],
        &["reproduce", "marrs-2014/figure1"],
        &["reproduce", "--all"],
        &["advise", "builtin:overlap", "--budget", "4x", "-o", "out"],
    ] {
        let output = run(words);
        let line = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{words:?}: {line}");
        assert_eq!(line.trim_end().lines().count(), 1, "{line}");
        assert!(line.contains("no usable adapter"), "{line}");
        assert!(names_in(dir.path()).is_empty());
    }
    // Ray tracing needs no adapter; neither does checking the arguments.
    let traced = run(&["reference", "builtin:overlap", "--size", "16x9", "--samples", "4", "-o", "a.png"]);
    assert_eq!(traced.status.code(), Some(0), "{}", String::from_utf8_lossy(&traced.stderr));
    assert_eq!(names_in(dir.path()), ["a.png"]);
    assert_eq!(run(&["render", "builtin:overlap", "-o", "b.png", "--set", "map_size=1"]).status.code(), Some(2));
}
