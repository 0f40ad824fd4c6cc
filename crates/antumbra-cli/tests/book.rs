//! Runs every command of the book: those in `sh` blocks of `docs/` and of the READMEs.
//!
//! The commands of a page run in order, in a folder of their own with a `scene.glb` and an `evening.toml`. Sizes are reduced by [`small`],
//! as `docs/reproducibility.md` says. Another test compares commands of `cargo xtask` with its usage text.

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use antumbra_testing::book::{Command, Page, blocks, book_pages, commands, page, root, spans};
use common::{adapter, antumbra, run};

/// Options that reduce the work of a command, for each command that draws or traces.
const SMALL: [(&str, &[(&str, &str)]); 6] = [
    ("advise", &[("--size", "48x27"), ("--samples", "4")]),
    ("bench", &[("--sizes", "48x27"), ("--frames", "1"), ("--warm-up", "0")]),
    ("compare", &[("--size", "48x27"), ("--samples", "4"), ("--frames", "1")]),
    ("reference", &[("--size", "48x27"), ("--samples", "4")]),
    ("render", &[("--size", "48x27")]),
    ("reproduce", &[("--size", "48x27"), ("--frames", "1")]),
];

/// Options that reduce the work of `sweep plan`.
const SMALL_PLAN: &[(&str, &str)] = &[("--sizes", "48x27"), ("--samples", "4"), ("--frames", "1")];

/// Declares a test for each page with commands, and one that no page is omitted.
macro_rules! pages {
    ($( $test:ident = $path:literal $( , $why:literal )?; )+) => {
        $( #[test] $( #[ignore = $why] )? fn $test() { run_page(&page($path)); } )+

        #[test]
        fn every_page_with_commands_is_run() {
            let mut with_commands: Vec<String> = book_pages()
                .into_iter()
                .chain([page("README.md"), page("crates/antumbra-cli/README.md")])
                .filter(|page| !commands(page).is_empty())
                .map(|page| page.path)
                .collect();
            with_commands.sort();
            assert_eq!(with_commands, [$($path),+]);
        }
    };
}

pages! {
    the_readme = "README.md";
    the_command_s_readme = "crates/antumbra-cli/README.md";
    adding = "docs/adding.md";
    advise = "docs/advise.md", "long";
    choose = "docs/choose.md", "long";
    integrating = "docs/integrating.md";
    laboratory = "docs/laboratory.md", "long";
    measurements = "docs/measurements.md", "long";
    reproducibility = "docs/reproducibility.md";
    shading = "docs/shading.md";
    start = "docs/start.md";
    sweep = "docs/sweep.md", "long";
    viewer = "docs/viewer.md";
}

/// Runs a page's commands in order.
fn run_page(page: &Page) {
    let dir = tempfile::tempdir().unwrap();
    if adapter().is_none() {
        return;
    }
    furnish(dir.path());
    for command in commands(page) {
        let began = Instant::now();
        for words in ours(&command) {
            let words = small(&words.iter().map(String::as_str).collect::<Vec<_>>());
            run_one(dir.path(), &command.place, &words);
        }
        println!("{}: {} in {:.1} s", command.place, command.words.join(" "), began.elapsed().as_secs_f32());
    }
}

/// Creates the files that commands of the book need: a scene, a setup, folders.
fn furnish(dir: &Path) {
    for folder in ["path/to", "docs/figures"] {
        fs::create_dir_all(dir.join(folder)).unwrap();
    }
    let output = run(dir, &["scenes", "--export", "overlap", "-o", "scene.glb"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    fs::copy(dir.join("scene.glb"), dir.join("path/to/scene.glb")).unwrap();
    let formats = page("docs/formats.md");
    let blocks = blocks(&formats.text);
    let setup = blocks.iter().find(|block| block.language == "toml").expect("a setup in docs/formats.md");
    let lines: Vec<&str> = setup.lines.iter().map(|(_, line)| *line).collect();
    fs::write(dir.join("evening.toml"), lines.join("\n")).unwrap();
}

/// Returns the arguments of `antumbra`, once for each time that a line runs it; empty if other tests run the line.
fn ours(command: &Command) -> Vec<Vec<String>> {
    let words: Vec<&str> = command.words.iter().map(String::as_str).collect();
    let place = &command.place;
    match words[..] {
        ["antumbra", ref rest @ ..] => vec![rest.iter().map(|word| of_an_array(word)).collect()],
        ["cargo", "run", "--bin", "antumbra", "--", ref rest @ ..] => {
            vec![rest.iter().map(|word| (*word).to_owned()).collect()]
        }
        // `parallel` runs a job for each of the words after `:::`.
        ["parallel", "antumbra", ref rest @ ..] => {
            let end = rest.iter().position(|word| *word == ":::").unwrap_or_else(|| panic!("{place}: no `:::`"));
            let (job, each) = (&rest[..end], &rest[end + 1..]);
            each.iter().map(|one| job.iter().map(|word| word.replace("{}", one)).collect()).collect()
        }
        ["cargo", "xtask", ..] => Vec::new(),
        ["cargo", "build", "--bin", "antumbra"] => Vec::new(),
        ["cargo", "install", name] => {
            assert_eq!(name, env!("CARGO_PKG_NAME"), "{place}");
            Vec::new()
        }
        // The workspace's build includes the examples, and a test of the laboratory runs their drawing.
        ["cargo", "run", "--example", name] => {
            let declares = |package: &str| {
                let manifest = fs::read_to_string(root().join("crates").join(package).join("Cargo.toml")).unwrap();
                manifest.contains(&format!("[[example]]\nname = \"{name}\""))
            };
            assert!(["antumbra", "antumbra-lab"].into_iter().any(declares), "{place}: there is no example {name}");
            Vec::new()
        }
        _ => panic!("{place}: no test knows how to run `{}`", command.words.join(" ")),
    }
}

/// Replaces a job array's variables as in the second of four jobs.
fn of_an_array(word: &str) -> String {
    word.replace("$SLURM_ARRAY_TASK_ID", "2").replace("$SLURM_ARRAY_TASK_COUNT", "4")
}

/// Reduces a command: small images, few light samples and frames, and two techniques in place of all.
fn small(words: &[&str]) -> Vec<String> {
    let mut small: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
    let mut set = |option: &str, value: &str| match small.iter().position(|word| word == option) {
        Some(at) => small[at + 1] = value.to_owned(),
        None => small.extend([option.to_owned(), value.to_owned()]),
    };
    let has = |option: &str| words.contains(&option);
    let options = match words {
        ["sweep", "plan", ..] => SMALL_PLAN,
        _ if has("--suite") || has("--tables") => &[],
        _ => SMALL.iter().find(|(name, _)| words.first() == Some(name)).map_or(&[][..], |(_, options)| *options),
    };
    options.iter().for_each(|(option, value)| set(option, value));
    let takes_techniques = matches!(words.first(), Some(&("advise" | "bench" | "compare"))) && !options.is_empty();
    if takes_techniques && !has("--techniques") && !has("--preset") {
        set("--techniques", "hard,pcf");
    }
    if has("--motion") {
        set("--motion-frames", "2");
    }
    small
}

/// Runs a command and checks that it succeeds and produces output.
fn run_one(dir: &Path, place: &str, words: &[String]) {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let line = format!("{place}: antumbra {}", words.join(" "));
    if words.contains(&"--suite") || words.contains(&"--all") {
        return interrupt(dir, &line, &words);
    }
    if words.first() == Some(&"view") {
        return view(dir, &line, &words);
    }
    let output = run(dir, &words);
    assert_eq!(output.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    let written: Vec<_> = words.windows(2).filter(|pair| matches!(pair[0], "-o" | "--json" | "--visibility")).collect();
    for pair in &written {
        assert!(dir.join(pair[1]).exists(), "{line}: it did not write {}", pair[1]);
    }
    assert!(!(written.is_empty() && output.stdout.is_empty()), "{line}: it says nothing and writes nothing");
}

/// Starts a command that takes minutes, and interrupts it once it has written its file.
#[cfg(unix)]
fn interrupt(dir: &Path, line: &str, words: &[&str]) {
    let file = words.iter().skip_while(|word| !matches!(**word, "--suite" | "-o")).nth(1).expect("a file to write");
    let mut child = antumbra(dir).args(words).stdout(std::process::Stdio::null()).spawn().unwrap();
    let began = Instant::now();
    while !dir.join(file).exists() {
        assert!(child.try_wait().unwrap().is_none(), "{line}: it ended without {file}");
        assert!(began.elapsed() < Duration::from_secs(120), "{line}: nothing in {file} after two minutes");
        std::thread::sleep(Duration::from_millis(50));
    }
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130), "{line}");
}

#[cfg(not(unix))]
fn interrupt(_: &Path, line: &str, _: &[&str]) {
    antumbra_testing::skip(format!("{line}: nothing here interrupts it"));
}

/// Runs `view` without a display: arguments, scene and setup are valid, and the error names the missing display.
#[cfg(target_os = "linux")]
fn view(dir: &Path, line: &str, words: &[&str]) {
    let mut command = antumbra(dir);
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(variable);
    }
    let output = command.args(words).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{line}: {told}");
    assert_eq!(told.lines().count(), 1, "{line}: {told}");
}

#[cfg(not(target_os = "linux"))]
fn view(_: &Path, line: &str, _: &[&str]) {
    antumbra_testing::skip(format!("{line}: a window would open"));
}

/// Commands within sentences have placeholders and are not run, but their commands and options exist.
#[test]
fn commands_within_sentences_name_what_there_is() {
    let dir = tempfile::tempdir().unwrap();
    let (mut helps, mut found) = (BTreeMap::new(), 0);
    for page in book_pages().into_iter().chain([page("README.md")]) {
        for span in spans(&page.text) {
            let words: Vec<&str> = span.split(' ').collect();
            let ["antumbra", command, rest @ ..] = words.as_slice() else { continue };
            // These are a placeholder, a setting and a test of the library.
            if *command == "COMMAND" || *command == "=" || command.contains("::") {
                continue;
            }
            let help = helps.entry((*command).to_owned()).or_insert_with(|| run(dir.path(), &[command, "--help"]));
            assert_eq!(help.status.code(), Some(0), "{}: {span}", page.path);
            let help = String::from_utf8_lossy(&help.stdout);
            for option in rest.iter().filter(|word| word.starts_with("--")) {
                assert!(help.contains(option), "{}: {span}: there is no {option}", page.path);
            }
            found += 1;
        }
    }
    assert!(found >= 10, "{found}");
}

/// The README starts with two commands, and the next command reuses their build. Another profile would rebuild everything;
/// a single package, whose dependencies have fewer features, would rebuild much of it.
#[test]
fn the_readme_has_two_commands_and_one_build() {
    let readme = page("README.md");
    let first: Vec<String> = commands(&readme).iter().take(3).map(|command| command.words.join(" ")).collect();
    assert_eq!(first, ["cargo xtask demo", "cargo xtask test", "cargo run --bin antumbra -- view path/to/scene.glb"]);
    let told = [page("README.md"), page("crates/antumbra-cli/README.md")].into_iter().chain(book_pages());
    let printed =
        ["src/commands/view.rs", "../../xtask/src/demo.rs"].map(|path| page(&format!("crates/antumbra-cli/{path}")));
    for page in told.chain(printed) {
        let builds = |line: &&str| line.contains("antumbra-cli") || line.contains("--bin antumbra");
        for line in page.text.lines().filter(builds) {
            assert!(!line.contains("--release") && !line.contains("--profile"), "{}: {line}", page.path);
        }
    }
    let demo = page("xtask/src/demo.rs").text;
    assert!(demo.contains(r#"built_of_workspace("antumbra")"#) && !demo.contains("--release"));
}

#[test]
fn small_commands_are_small() {
    let made_small = |line: &str| small(&line.split(' ').collect::<Vec<_>>()).join(" ");
    let compare = "compare a.glb --size 48x27 -o out --samples 4 --frames 1 --techniques hard,pcf";
    assert_eq!(made_small("compare a.glb --size 9x9 -o out"), compare);
    assert_eq!(made_small("compare a.glb --preset shen-2013 -o out").matches("--techniques").count(), 0);
    assert_eq!(made_small("bench --tables results.json"), "bench --tables results.json");
    assert_eq!(made_small("techniques pcss"), "techniques pcss");
}
