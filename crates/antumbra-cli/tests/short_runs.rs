//! Runs that end early, by deadline, technique limit or interruption, their resumption, and refused combinations.

mod common;

use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

use common::{adapter, antumbra, names_in, run};
use serde_json::Value;

/// Small runs: few pixels, few triangles, two cheap techniques.
const BENCH: &str = "bench builtin:overlap --techniques hard,pcf --sizes 32x18 --frames 2 --warm-up 0 --json t.json";
const COMPARE: &str = "compare builtin:overlap --techniques hard,pcf --size 32x18 --samples 4 --frames 1 -o out";
const REPRODUCE: &str = "reproduce lauritzen-2008/figure6 --size 16x9 --samples 1 --frames 1 -o papers";

/// Techniques that compile quickly, in the order of the full list: two for each of three interruptions, and some more.
#[cfg(unix)]
const SOON_COMPILED: [&str; 9] = ["hard", "pcf", "pcss", "multi_view", "vsm", "evsm", "esm", "convolution", "moment"];

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

fn code(dir: &Path, line: &str) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = run(dir, &words(line));
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

#[track_caller]
fn works(dir: &Path, line: &str) -> String {
    let (code, said, told) = code(dir, line);
    assert_eq!(code, Some(0), "{line}: {told}");
    said
}

#[track_caller]
fn read(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Names of the rows with a result.
fn measured(json: &Value) -> Vec<String> {
    let rows = json["rows"].as_array().unwrap().iter();
    let done = rows.filter(|row| row["ran"].is_object() || row["status"] == "measured");
    done.map(|row| row["technique"].as_str().unwrap().to_owned()).collect()
}

/// Checks that a line is refused in one line that contains `parts`, before anything is drawn or written.
#[track_caller]
fn refuses(dir: &Path, line: &str, parts: &[&str]) {
    let before = names_in(dir);
    let (code, said, told) = code(dir, line);
    assert_eq!((code, told.trim_end().lines().count()), (Some(2), 1), "{line}: {told}");
    assert!(said.is_empty() || said.starts_with("Adapter: "), "{line}: {said}");
    for part in parts {
        assert!(told.contains(part), "{line}: `{part}` is not in: {told}");
    }
    assert_eq!(names_in(dir), before, "{line}");
}

/// Starts a command, waits for `is_there`, and ends the command by a signal.
#[cfg(unix)]
#[track_caller]
fn stop(dir: &Path, line: &str, signal: &str, is_there: impl Fn() -> bool) -> Option<i32> {
    let mut child =
        antumbra(dir).args(words(line)).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it was built");
    let began = Instant::now();
    while !is_there() {
        assert!(began.elapsed() < Duration::from_secs(120), "{line}: nothing was written");
        assert_eq!(child.try_wait().unwrap(), None, "{line}: it ended too early");
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    child.wait().unwrap().code()
}

/// Number of measured rows in a file; 0 if it does not exist yet.
#[cfg(unix)]
fn rows_so_far(path: &Path) -> usize {
    fs::read(path).map_or(0, |bytes| measured(&serde_json::from_slice(&bytes).expect("whole at any moment")).len())
}

#[cfg(unix)]
#[test]
fn a_bench_that_is_stopped_is_resumed() {
    stop_and_resume_a_bench(&SOON_COMPILED.join(","), &SOON_COMPILED);
}

#[cfg(unix)]
#[test]
#[ignore = "compiles the programs of every technique up to four times"]
fn a_bench_of_all_techniques_that_is_stopped_is_resumed() {
    let all: Vec<&str> = antumbra::TechniqueKind::ALL.iter().map(|kind| kind.name()).collect();
    stop_and_resume_a_bench("all", &all);
}

/// Interrupts a `bench` of the techniques `asked`, which expand to `planned`, by three signals, and resumes it each time.
#[cfg(unix)]
fn stop_and_resume_a_bench(asked: &str, planned: &[&str]) {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let path = dir.path().join("t.json");
    let all = format!("bench builtin:overlap --techniques {asked} --sizes 32x18 --frames 2 --warm-up 0 --json t.json");
    for (signal, exit) in [("-TERM", Some(130)), ("-KILL", None), ("-INT", Some(130))] {
        let before = rows_so_far(&path);
        assert_eq!(stop(dir.path(), &format!("{all} --resume"), signal, || rows_so_far(&path) > before + 1), exit);
        assert!(rows_so_far(&path) > before + 1, "{signal}");
    }
    let there = read(&path);
    let done = there["rows"].as_array().unwrap();
    assert_eq!(done.len() + there["missing"].as_array().unwrap().len(), planned.len());
    works(dir.path(), &format!("{all} --resume"));
    let resumed = read(&path);
    let rows = resumed["rows"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| row["technique"].as_str().unwrap()).collect();
    assert_eq!(names, planned, "the plan's order");
    assert!(done.iter().all(|row| rows.contains(row)), "what was measured stays as it was");
    assert_eq!(resumed["missing"], serde_json::json!([]));
}

#[cfg(unix)]
#[test]
fn a_comparison_that_is_stopped_is_resumed() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let line = "compare builtin:overlap --techniques hard,pcf,pcss,vsm,moment --size 32x18 --samples 4 --frames 1 \
                --motion light --motion-frames 2";
    works(dir.path(), &format!("{line} -o whole"));
    // The new run replaces an earlier report.
    works(dir.path(), "compare builtin:overlap --techniques esm --size 32x18 --samples 4 --frames 1 -o out");
    let out = dir.path().join("out");
    let path = out.join("metrics.json");
    let is_new = || rows_so_far(&path) > 1;
    assert_eq!(stop(dir.path(), &format!("{line} -o out"), "-KILL", is_new), None);
    let stopped = read(&path);
    assert!(measured(&stopped).len() > 1 && !stopped["missing"].as_array().unwrap().is_empty(), "{stopped}");
    works(dir.path(), &format!("{line} --resume -o out"));
    let (whole, resumed) = (read(&dir.path().join("whole/metrics.json")), read(&path));
    assert_eq!(resumed["missing"], serde_json::json!([]));
    // Everything but times must be equal.
    for key in ["scene", "scene_facts", "size", "settings", "warnings"] {
        assert_eq!(whole[key], resumed[key], "{key}");
    }
    assert_eq!(whole["motion"], resumed["motion"]);
    for (whole, resumed) in whole["rows"].as_array().unwrap().iter().zip(resumed["rows"].as_array().unwrap()) {
        for key in ["technique", "status", "metrics", "parameters", "motion", "images", "notes"] {
            assert_eq!(whole[key], resumed[key], "{}: {key}", whole["technique"]);
        }
    }
    let first = &stopped["rows"][0];
    assert_eq!(first["total_ms"], resumed["rows"][0]["total_ms"], "it is not measured again");
    let files = |name: &str| names_in(&dir.path().join(name).join("images"));
    assert_eq!(files("whole"), files("out"));
    assert_eq!(names_in(&out), names_in(&dir.path().join("whole")));
    for file in ["reference_shaded.png", "hard_visibility.exr", "pcss_error.png", "vsm_motion_light.png"] {
        let bytes = |name: &str| fs::read(dir.path().join(name).join("images").join(file)).unwrap();
        assert_eq!(bytes("whole"), bytes("out"), "{file}");
    }
    let values = |name: &str| fs::read(dir.path().join(name).join("values.js")).unwrap();
    assert_eq!(values("whole"), values("out"));
}

#[cfg(unix)]
#[test]
fn a_reproduction_that_is_stopped_is_resumed() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let path = dir.path().join("papers/reproduced.json");
    let rows = || {
        fs::read(&path).map_or(0, |bytes| {
            let json: Value = serde_json::from_slice(&bytes).expect("whole at any moment");
            json["rows"].as_object().unwrap().len()
        })
    };
    assert_eq!(stop(dir.path(), &format!("{REPRODUCE} --json r.json"), "-KILL", || rows() > 1), None);
    let stopped = read(&path);
    assert!(read(&dir.path().join("r.json"))["exhibits"][0]["rows"].is_array());
    let said = works(dir.path(), &format!("{REPRODUCE} --resume --json r.json"));
    let resumed = read(&path);
    let (before, after) = (stopped["rows"].as_object().unwrap(), resumed["rows"].as_object().unwrap());
    assert!(before.iter().all(|(name, row)| after[name] == *row) && after.len() > before.len());
    assert!(said.contains(&format!("{} of {} rows run now", after.len() - before.len(), after.len())), "{said}");
}

#[test]
fn a_deadline_ends_in_time_and_says_what_is_missing() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    // Three qualities of all techniques take minutes.
    let techniques = "--techniques all:fast,all,all:high";
    for line in [
        format!("bench builtin:overlap {techniques} --sizes 32x18 --json t.json"),
        format!("compare builtin:overlap {techniques} --size 32x18 --samples 4 -o out"),
        "reproduce lauritzen-2008 --size 16x9 --samples 1 -o papers --json r.json".to_owned(),
    ] {
        // A slow machine needs a longer deadline to have a result.
        let ends = |seconds: &u64| {
            let began = Instant::now();
            let (code, _, told) = code(dir.path(), &format!("{line} --quiet --deadline {seconds}"));
            assert_eq!((code, told.lines().count()), (Some(4), 1), "{line}: {told}");
            assert!(told.contains("the deadline ended the run before ") && told.contains(" of "), "{told}");
            assert!(told.contains("; and ") && told.contains(" more"), "{told}");
            // A running frame or compilation is not interrupted.
            assert!(began.elapsed() < Duration::from_secs(60 + seconds), "{line}: {:?}", began.elapsed());
            told.contains(" --resume to continue")
        };
        assert!([4, 8, 16, 32, 64].iter().any(ends), "{line}: nothing was measured in a minute");
    }
    let bench = read(&dir.path().join("t.json"));
    let of = |json: &Value, key: &str| json[key].as_array().unwrap().len();
    let skipped = bench["rows"].as_array().unwrap().iter().filter(|row| row["skipped"].is_string()).count();
    assert_eq!(measured(&bench).len() + skipped, of(&bench, "rows"), "missing ones say so: {bench}");
    assert_eq!(skipped, of(&bench, "missing"));
    assert!(of(&bench, "missing") > 0);
    let out = dir.path().join("out");
    let compared = read(&out.join("metrics.json"));
    let missing = compared["rows"].as_array().unwrap().iter().filter(|row| row["status"] == "missing").count();
    assert_eq!(missing, of(&compared, "missing"));
    assert!(missing > 0 && out.join("index.html").is_file());
    assert!(fs::read_to_string(out.join("index.html")).unwrap().contains("No time was left for "));
    assert!(of(&read(&dir.path().join("r.json")), "missing") > 0);
}

#[test]
fn a_deadline_that_is_long_enough_changes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    for line in [BENCH, COMPARE, REPRODUCE] {
        works(dir.path(), &format!("{line} --deadline 600 --technique-limit 300"));
    }
    assert_eq!(measured(&read(&dir.path().join("t.json"))), ["hard", "pcf"]);
    assert_eq!(measured(&read(&dir.path().join("out/metrics.json"))), ["hard", "pcf"]);
}

/// A technique that exceeds its limit gets a row with the reason in every command, and is measured again with a longer limit.
#[test]
fn a_technique_that_takes_too_long_is_cut_short_and_said() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    for line in [BENCH, COMPARE, REPRODUCE] {
        let said = works(dir.path(), &format!("{line} --technique-limit 0.000001"));
        assert!(said.contains("cut short by the limit of 0.000001 s per technique"), "{line}: {said}");
    }
    let [bench, compared] = ["t.json", "out/metrics.json"].map(|name| read(&dir.path().join(name)));
    for json in [&bench, &compared] {
        for row in json["rows"].as_array().unwrap() {
            assert!(row["skipped"].as_str().unwrap().contains("cut short by") && row["cut_short_s"] == 1e-6, "{row}");
        }
    }
    for line in [BENCH, COMPARE] {
        works(dir.path(), &format!("{line} --resume --technique-limit 100"));
    }
    assert_eq!(measured(&read(&dir.path().join("t.json"))), ["hard", "pcf"]);
    assert_eq!(measured(&read(&dir.path().join("out/metrics.json"))), ["hard", "pcf"]);
}

#[test]
fn another_run_is_not_resumed() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    works(dir.path(), BENCH);
    works(dir.path(), COMPARE);
    works(dir.path(), REPRODUCE);
    let other = |line: &str, from: &str, to: &str| format!("{} --quiet --resume", line.replace(from, to));
    refuses(
        dir.path(),
        &other(BENCH, "--frames 2", "--frames 3"),
        &["--resume t.json: its frames is 2, but this run has 3"],
    );
    refuses(dir.path(), &other(BENCH, "hard,pcf", "hard"), &["its techniques is [\"hard\",\"pcf\"]"]);
    refuses(dir.path(), &other(COMPARE, "32x18", "48x27"), &["out/metrics.json: its scene is", "48x27"]);
    refuses(dir.path(), &other(COMPARE, "--samples 4", "--samples 9"), &["its samples is 4, but this run has 9"]);
    refuses(dir.path(), &other(REPRODUCE, "--frames 1", "--frames 2"), &["its frames is 1, but this run has 2"]);
    for (file, line) in [("t.json", BENCH), ("out/metrics.json", COMPARE), ("papers/reproduced.json", REPRODUCE)] {
        let path = dir.path().join(file);
        let whole = fs::read_to_string(&path).unwrap();
        let adapter = read(&path);
        let of = |json: &Value| {
            [&json["adapter"], &json["adapter"]["name"], &json["about"]["adapter"]]
                .into_iter()
                .find_map(|name| name.as_str().map(str::to_owned))
                .unwrap()
        };
        let resume = format!("{line} --quiet --resume");
        fs::write(&path, whole.replace(&format!("\"{}\"", of(&adapter)), "\"another card\"")).unwrap();
        refuses(dir.path(), &resume, &[file, "its adapter is \"another card\", but this run has"]);
        let commit = [&adapter["commit"], &adapter["about"]["commit"]].into_iter().find_map(Value::as_str).unwrap();
        fs::write(&path, whole.replace(&format!("\"{commit}\""), "\"0123456789ab\"")).unwrap();
        refuses(dir.path(), &resume, &[file, "its commit is \"0123456789ab\""]);
        fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        refuses(dir.path(), &resume, &[file, "cannot read"]);
        fs::write(&path, whole).unwrap();
        works(dir.path(), &resume);
    }
}

#[test]
fn a_baseline_gives_ratios_and_differences() {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    works(dir.path(), BENCH);
    works(dir.path(), COMPARE);
    let reproduce = format!("{REPRODUCE} --json r.json");
    works(dir.path(), &reproduce);
    // The baseline is twice as fast, and of another card.
    let mut bench = read(&dir.path().join("t.json"));
    bench["adapter"] = "another card".into();
    let here_ms = |row: &Value| row["ran"]["timings"]["total_ms"].as_f64().unwrap();
    for row in bench["rows"].as_array_mut().unwrap() {
        row["ran"]["timings"]["total_ms"] = (0.5 * here_ms(row)).into();
    }
    fs::write(dir.path().join("b.json"), bench.to_string()).unwrap();
    let said = works(dir.path(), &format!("{BENCH} --resume --baseline b.json"));
    assert!(said.contains("Compared with another card") && said.contains("geometric mean over 2: 2.000"), "{said}");
    assert_eq!(read(&dir.path().join("t.json"))["baseline"]["rows"][0]["ratio"], 2.0);

    let mut metrics = read(&dir.path().join("out/metrics.json"));
    metrics["adapter"]["name"] = "another card".into();
    for row in metrics["rows"].as_array_mut().unwrap() {
        row["total_ms"] = (4.0 * row["total_ms"].as_f64().unwrap()).into();
        row["metrics"]["rmse"] = (row["metrics"]["rmse"].as_f64().unwrap() - 0.0625).into();
    }
    fs::write(dir.path().join("m.json"), metrics.to_string()).unwrap();
    let said = works(dir.path(), &format!("{COMPARE} --resume --baseline m.json"));
    assert!(said.contains("geometric mean over 2: 0.250") && said.contains("+0.0625"), "{said}");
    let against = &read(&dir.path().join("out/metrics.json"))["baseline"];
    assert_eq!((&against["adapter"], against["rows"].as_array().unwrap().len()), (&"another card".into(), 2));
    for row in against["rows"].as_array().unwrap() {
        assert!((row["ratio"].as_f64().unwrap() - 0.25).abs() < 1e-9, "{row}");
        assert!((row["differences"]["rmse"].as_f64().unwrap() - 0.0625).abs() < 1e-9, "{row}");
        assert_eq!(row["differences"]["penumbra_rmse"], 0.0);
    }
    let page = fs::read_to_string(dir.path().join("out/index.html")).unwrap();
    assert!(page.contains("id=\"baseline\"") && page.contains("Compared with another card"));

    let said = works(dir.path(), &format!("{reproduce} --baseline r.json"));
    assert!(said.contains("lauritzen-2008/figure6: ") && said.contains("+0.0000"), "{said}");
    assert!(read(&dir.path().join("r.json"))["baseline"]["rows"].is_array());

    let other = COMPARE.replace("32x18", "48x27").replace("out", "other");
    refuses(dir.path(), &format!("{other} --quiet --baseline m.json"), &["--baseline m.json: its size is [32,18]"]);
    refuses(dir.path(), &format!("{COMPARE} --baseline t.json"), &["t.json", "give a metrics.json"]);
    refuses(dir.path(), &format!("{BENCH} --baseline m.json"), &["m.json", "`antumbra bench --json`"]);
    refuses(dir.path(), &format!("{BENCH} --baseline no.json"), &["no.json", "no such file"]);
    let two = COMPARE.replace("builtin:overlap", "builtin:overlap builtin:window");
    refuses(dir.path(), &format!("{two} --baseline m.json"), &["--baseline m.json", "give the folder"]);
}

/// A shared file contains the device's description and times, and nothing about the user.
#[test]
fn a_shared_file_has_no_personal_data() {
    let home = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    let dir = home.path().join("zaphod's own");
    fs::create_dir(&dir).unwrap();
    let mut command = antumbra(&dir);
    for (key, value) in
        [("HOME", "/home/zaphod"), ("USER", "zaphod"), ("LOGNAME", "zaphod"), ("HOSTNAME", "heart-of-gold")]
    {
        command.env(key, value);
    }
    let line = "bench builtin:overlap --techniques hard,pcf --sizes 32x18 --frames 2 --warm-up 0 --share card.json";
    let output = command.args(words(line)).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(dir.join("card.json")).unwrap();
    for personal in ["zaphod", "heart-of-gold", "/home", "/tmp", &home.path().display().to_string()] {
        assert!(!text.contains(personal), "{personal} is in {text}");
    }
    let host = fs::read_to_string("/etc/hostname").unwrap_or_default();
    let mut words = text.split(|c: char| !(c.is_alphanumeric() || c == '-'));
    assert!(host.trim().is_empty() || !words.any(|word| word == host.trim()), "{host} is in {text}");
    let card = read(&dir.join("card.json"));
    let keys: Vec<&String> = card.as_object().unwrap().keys().collect();
    let expected = [
        "format", "version", "antumbra", "commit", "date", "system", "adapter", "driver", "backend", "software",
        "warm_up", "frames", "rows",
    ];
    assert_eq!(keys, expected);
    for row in card["rows"].as_array().unwrap() {
        assert!(row["ran"]["start_up"]["compile_ms"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["ran"]["start_up"]["first_frame_ms"].as_f64().unwrap() > 0.0, "{row}");
    }
    let page = works(&dir, "bench --cards .");
    assert!(page.contains("## `overlap`, 32 × 18") && page.contains("| `pcf` | "), "{page}");

    fs::write(dir.join("mine.glb"), "").unwrap();
    refuses(&dir, "bench mine.glb --share a.json", &["mine.glb is a file", "built-in scenes"]);
    refuses(&dir, "bench --share a.json --setup zaphod.toml", &["--share", "cannot be used with"]);
    refuses(&dir, "bench --cards ..", &["no .json files"]);
}

#[test]
fn what_cannot_be_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    refuses(dir.path(), "bench builtin:overlap --resume", &["--resume", "add --json times.json"]);
    refuses(dir.path(), "reproduce marrs-2014/figure1 --resume", &["--resume", "-o DIR"]);
    for command in ["bench", "compare builtin:overlap -o out", "reproduce --all"] {
        refuses(dir.path(), &format!("{command} --deadline 0"), &["--deadline", "seconds above 0"]);
        refuses(dir.path(), &format!("{command} --technique-limit soon"), &["--technique-limit", "such as 60"]);
    }
    refuses(dir.path(), "bench --suite r.json --deadline 60", &["--suite", "cannot be used with"]);
    fs::write(dir.path().join("t.json"), "{}").unwrap();
    let resume = "bench builtin:overlap --json t.json --resume";
    if adapter().is_some() {
        refuses(dir.path(), &format!("{resume} --quiet"), &["t.json", "not a file of the format antumbra-bench"]);
    }
}
