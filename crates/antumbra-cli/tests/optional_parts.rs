//! Every command works without its optional arguments and with all of them; in the long tier with each alone. None panics.
//!
//! The options come from the commands' own help: an option that is declared but not covered here fails the test. Images
//! have few pixels, and ground truths one or two light samples.

mod common;

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Output;
use std::time::Instant;

use common::{adapter, antumbra, run};

/// A command with its optional arguments.
struct Walk {
    /// Required arguments, and those that reduce the work.
    base: &'static str,
    /// Optional arguments that can be combined.
    parts: &'static [&'static str],
    /// Arguments that exclude others, or are slow in combination.
    alone: &'static [&'static str],
}

const WALKS: &[Walk] = &[
    Walk {
        base: "render builtin:overlap --size 16x9 --technique hard -o a.png",
        parts: &[
            "--setup s.toml",
            "--time 1",
            "--ground",
            "--set map_size=64",
            "--visibility v.exr",
            "--light lamp",
            "--shadow-distance 20",
            "--coherent",
            "--shading product",
            "--frames 2",
            "--timings t.json",
            "--adapter ADAPTER",
        ],
        alone: &[],
    },
    Walk {
        base: "reference builtin:overlap --size 16x9 --samples 1 -o a.png",
        parts: &[
            "--setup s.toml",
            "--time 1",
            "--ground=no",
            "--seed 3",
            "--visibility v.exr",
            "--light lamp",
            "--adapter ADAPTER",
        ],
        alone: &[],
    },
    Walk {
        base: "compare builtin:overlap --size 16x9 --samples 1 --techniques hard -o out",
        parts: &[
            "--setup s.toml --frames 1",
            "--time 1 --coherent",
            "--ground=yes --set hard.map_size=64",
            "--light lamp --shadow-distance 20",
            "--motion camera,light,caster --motion-frames 1 --step 0.1 --caster boards --path s.toml",
            "--adapter ADAPTER",
        ],
        alone: &["--motion all", "--motion camera --motion-frames 1 --step 0"],
    },
    // These arguments need an existing run.
    Walk {
        base: "compare builtin:overlap --size 16x9 --samples 1 --techniques hard -o again",
        parts: &["--deadline 600", "--technique-limit 600", "--resume", "--baseline again/metrics.json"],
        alone: &[],
    },
    // A preset in place of techniques, then the ground truth for kernels of fixed width.
    Walk { base: "compare builtin:overlap --size 16x9 --samples 1 --preset marrs-2014 -o out", parts: &[], alone: &[] },
    Walk {
        base: "compare builtin:overlap builtin:window --size 16x9 --samples 1 --techniques vsm -o out",
        parts: &["--truth filtered"],
        alone: &[],
    },
    Walk {
        // A budget for which only small maps are tried. Each line is a search of its own: options of the search share a
        // line, those of the scene and the output others.
        base: "advise builtin:overlap --budget 1ms --size 24x24 --samples 1 --techniques hard",
        parts: &[
            "--memory 64MiB --roughness 0.5 --prefer motion",
            "--setup s.toml --setup s.toml",
            "--time 0 --time 1 --ground=no",
            "--light lamp -o advice --adapter ADAPTER",
        ],
        alone: &["--exhaustive"],
    },
    Walk {
        base: "bench builtin:overlap --sizes 16x9 --techniques hard",
        parts: &[
            "--setup s.toml",
            "--time 1",
            "--ground=no",
            "--light lamp",
            "--set map_size=64",
            "--frames 1",
            "--warm-up 0",
            "--minutes 1",
            "--json t.json",
            "--adapter ADAPTER",
        ],
        alone: &[],
    },
    Walk {
        base: "bench builtin:overlap --sizes 16x9 --techniques hard --json b.json",
        parts: &["--deadline 600", "--technique-limit 600", "--resume", "--baseline b.json", "--share card.json"],
        alone: &[],
    },
    Walk {
        base: "sweep plan builtin:overlap --sizes 16x9 --techniques hard,pcf+denoised -o sweep",
        parts: &[
            "--setup s.toml",
            "--time 1",
            "--ground",
            "--light lamp",
            "--set map_size=64",
            "--vary pcf.map_size=64,128",
            "--samples 1",
            "--frames 1",
        ],
        alone: &[],
    },
    // This runs the last plan.
    Walk { base: "sweep run sweep", parts: &["--shard 1/1", "--adapter ADAPTER"], alone: &[] },
    Walk { base: "sweep merge sweep -o results.json", parts: &[], alone: &[] },
    Walk { base: "techniques", parts: &["pcss", "--json"], alone: &[] },
    Walk { base: "scenes", parts: &["--export overlap -o x.glb"], alone: &["--json"] },
    Walk { base: "doctor", parts: &["--adapter ADAPTER", "--json"], alone: &[] },
    Walk { base: "completions zsh", parts: &[], alone: &[] },
    Walk { base: "man -o man1", parts: &[], alone: &[] },
    Walk { base: "reproduce", parts: &[], alone: &[] },
    // Figures with debug views, with errors, and with times.
    Walk {
        base: "reproduce lauritzen-2008/figure5 --size 16x9",
        parts: &[
            "--frames 1",
            "--samples 1",
            "--dear",
            "--bandwidth 100",
            "--json r.json",
            "-o papers",
            "--adapter ADAPTER",
        ],
        alone: &[],
    },
    Walk {
        base: "reproduce lauritzen-2008/figure6 --size 16x9 --samples 1 --frames 1",
        parts: &["-o more"],
        alone: &[],
    },
    Walk {
        base: "reproduce lauritzen-2008/figure6 --size 16x9 --samples 1 --frames 1 --json b.json -o again",
        parts: &["--deadline 600", "--technique-limit 600", "--resume", "--baseline b.json"],
        alone: &[],
    },
];

/// Options not covered here: they need minutes, a window or excluded arguments. Other tests cover them.
const ELSEWHERE: &[(&str, &[&str])] =
    &[("bench", &["--suite", "--parts", "--tables", "--cards"]), ("reproduce", &["--all"])];

/// Setup with a camera and a named light.
const SETUP: &str = "[camera]\neye = [4.0, 4.0, 6.0]\ntarget = [0.0, 0.5, 0.0]\n[[light]]\nname = \"lamp\"\nshape = \"disk\"\n\
                     radius = 0.2\ncenter = [0.0, 5.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n";

/// Declares a test for each command, and one that no command is omitted.
macro_rules! commands {
    ($( $test:ident = $command:literal; )+) => {
        $( #[test] fn $test() { walk($command, Parts::Together); } )+

        mod each_alone {
            use super::{Parts, walk};

            $( #[test] #[ignore = "long"] fn $test() { walk($command, Parts::EachAlone); } )+
        }

        #[test]
        fn every_line_is_walked() {
            let commands = [$($command),+];
            assert!(WALKS.iter().all(|walk| commands.iter().any(|command| is_of(walk, command))));
        }
    };
}

commands! {
    render = "render";
    reference = "reference";
    compare = "compare";
    advise = "advise";
    bench = "bench";
    sweep = "sweep";
    techniques = "techniques";
    scenes = "scenes";
    doctor = "doctor";
    completions = "completions";
    man = "man";
    reproduce = "reproduce";
}

fn is_of(walk: &Walk, command: &str) -> bool {
    walk.base == command || walk.base.starts_with(&format!("{command} "))
}

/// Selection of a line's optional arguments.
#[derive(Clone, Copy)]
enum Parts {
    /// None, and then all that can be combined.
    Together,
    /// One at a time.
    EachAlone,
}

/// Runs all lines of a command.
fn walk(command: &str, parts: Parts) {
    let Some(adapter) = adapter() else { return };
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("s.toml"), SETUP).unwrap();
    for walk in WALKS.iter().filter(|walk| is_of(walk, command)) {
        let with = |part: &str| {
            // The named light exists only in the setup.
            let setup = if part.starts_with("--light") { " --setup s.toml" } else { "" };
            format!("{} {part}{setup}", walk.base)
        };
        // The base comes first, because later lines may resume its output.
        let mut lines = vec![walk.base.to_owned()];
        match parts {
            Parts::Together => {
                lines.extend(walk.alone.iter().map(|part| with(part)));
                if !walk.parts.is_empty() {
                    lines.push(with(&walk.parts.join(" ")));
                }
            }
            Parts::EachAlone => lines.extend(walk.parts.iter().map(|part| with(part))),
        }
        for line in lines {
            let began = Instant::now();
            let words: Vec<&str> =
                line.split_whitespace().map(|word| if word == "ADAPTER" { adapter.as_str() } else { word }).collect();
            works(&line, &run(dir.path(), &words));
            println!("{line}: {:.1} s", began.elapsed().as_secs_f32());
            // These folders would be resumed instead of written.
            for folder in ["advice", "papers", "more", "other"] {
                let _ = std::fs::remove_dir_all(dir.path().join(folder));
            }
        }
    }
}

#[track_caller]
fn works(line: &str, output: &Output) {
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(!told.contains("panicked"), "{line}: {told}");
    assert_eq!(output.status.code(), Some(0), "{line}: {told}");
}

/// Returns the options in a command's help, such as `--size` and `--frames`.
fn declared(dir: &Path, command: &[&str]) -> BTreeSet<String> {
    let output = run(dir, &[command, &["--help"]].concat());
    assert_eq!(output.status.code(), Some(0), "{command:?}");
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    let options = told.lines().skip_while(|line| !line.starts_with("Options:")).skip(1);
    options
        .take_while(|line| line.is_empty() || line.starts_with(' '))
        .filter(|line| line.trim_start().starts_with('-'))
        .filter_map(|line| line.split(|c: char| !(c.is_alphanumeric() || c == '-')).find(|word| word.starts_with("--")))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_option_is_walked() {
    let dir = tempfile::tempdir().unwrap();
    for command in [
        &["render"][..],
        &["reference"],
        &["compare"],
        &["advise"],
        &["bench"],
        &["sweep", "plan"],
        &["sweep", "run"],
        &["sweep", "merge"],
        &["techniques"],
        &["scenes"],
        &["doctor"],
        &["completions"],
        &["man"],
        &["reproduce"],
    ] {
        let name = command.join(" ");
        let walked: String = WALKS
            .iter()
            .filter(|walk| is_of(walk, &name))
            .flat_map(|walk| {
                [walk.base].into_iter().chain(walk.parts.iter().copied()).chain(walk.alone.iter().copied())
            })
            .map(|words| format!("{words} "))
            .collect();
        let elsewhere = ELSEWHERE.iter().find(|(command, _)| *command == name).map_or(&[][..], |(_, options)| *options);
        let options = declared(dir.path(), command);
        assert!(options.contains("--help"), "{name}: {options:?}");
        // Every command has these two; `outputs.rs` covers the second.
        for option in options.iter().filter(|option| !["--help", "--quiet"].contains(&option.as_str())) {
            let short = if option == "--output" { " -o " } else { option.as_str() };
            let is_walked = walked.split([' ', '=']).any(|word| word == option) || walked.contains(short);
            assert!(is_walked || elsewhere.contains(&option.as_str()), "{name}: {option} is declared and not walked");
        }
    }
}

/// A missing argument is refused in one line, before any file is written.
#[test]
fn what_is_missing_is_said_in_one_line() {
    let dir = tempfile::tempdir().unwrap();
    for line in [
        "render",
        "reference",
        "compare",
        "advise",
        "sweep",
        "sweep plan",
        "sweep run",
        "sweep merge",
        "completions",
        "man",
        "scenes --export overlap",
        "scenes -o x.glb",
        "render builtin:overlap",
        "compare builtin:overlap",
        "advise builtin:overlap",
        "sweep merge sweep",
        "bench --parts times",
        "reproduce -o out",
        "reproduce --json r.json",
        "compare builtin:overlap -o out --step 1",
        "compare builtin:overlap -o out --caster boards",
        "techniques --all",
        "doctor pcss",
    ] {
        let output = run(dir.path(), &line.split(' ').collect::<Vec<_>>());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{line}: {told}");
        assert_eq!((told.lines().count(), told.starts_with("antumbra: ")), (1, true), "{line}: {told}");
        assert!(told.contains("--help") || told.contains("reproduce: "), "{line}: {told}");
        assert_eq!(common::names_in(dir.path()), Vec::<String>::new(), "{line}");
    }
}

/// Paths on Unix are arbitrary bytes and need not be Unicode.
#[cfg(target_os = "linux")]
#[test]
fn paths_need_not_be_unicode() {
    use std::os::unix::ffi::OsStrExt;
    let dir = tempfile::tempdir().unwrap();
    let name = std::ffi::OsStr::from_bytes(b"o\xffut");
    let run = |words: &[&str]| antumbra(dir.path()).args(words).arg(name).output().unwrap();
    for words in [&["frobnicate"][..], &["render", "builtin:overlap", "-o"], &["techniques"]] {
        let output = run(words);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), told.lines().count()), (Some(2), 1), "{words:?}: {told}");
    }
    if adapter().is_none() {
        return;
    }
    let small = ["--size", "16x9", "--samples", "1", "--techniques", "hard", "-o"];
    works("compare", &run(&[&["compare", "builtin:overlap"], &small[..]].concat()));
    assert!(dir.path().join(name).join("index.html").is_file());
}
