//! Development commands: `cargo xtask demo`, `cargo xtask test`, `cargo xtask shaders`, `cargo xtask ci`.
//!
//! Standard library only: on a bare machine this is built first, before other dependencies can be installed.

mod bevy;
mod book;
mod cases;
mod demo;
mod driver;
mod families;
mod figures;
mod gpu_cost;
mod machine;
mod packages;
mod portability;
mod qualities;
mod semver;
mod shell;
mod site;
mod skips;
mod test;
mod wasm;
mod web;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use machine::Missing;

const USAGE: &str = "\
Development commands of Antumbra. They install missing programs where possible, and print what they install.

    cargo xtask demo [SCENE.glb ...] [--no-open] [--driver default|installed|newer]
        Builds the command `antumbra`, compares techniques with ground truth on built-in scenes and on the scenes given, prints the
        path of the report, and opens it if there is a display.

    cargo xtask test [quick|long] [FILTER] [--driver default|installed|newer]
        Checks formatting and lints, and runs the tests that continuous integration requires.
        quick: only the fastest tests and one mask of each technique. long: also tests marked #[ignore], every command of the book,
        the Bevy plugin and a sample of mutants, for hours.
        On Debian 12 without a graphics card, tests use a newer Mesa, installed in target/newer-mesa, or else the installed one.
        Choose with --driver or ANTUMBRA_DRIVER; VK_DRIVER_FILES is respected.

    cargo xtask ci [--driver default|installed|newer]
        Runs `test`, builds each family of techniques separately and the program of `packages`, runs `semver`, `wasm`, `web --shaders`,
        `portability` and `gpu-cost --check`. Fails where a check would be skipped, except in the last three, where a browser, a
        compiler or a driver may be missing.

    cargo xtask shaders
        Links the library's shaders. Run it after an edit to a .wesl file.

    cargo xtask docs
        Writes the generated parts of the book and the README. Run it after an edit to a technique's declaration.

    cargo xtask book [--serve]
        Builds the book in target/book; --serve serves it on this machine. Installs mdbook in target/tools once.

    cargo xtask site [-o FOLDER] [--check | --serve]
        Builds the book, a gallery and the web viewer as static files in target/site, for any server and any path.
        --check: crawls them in a headless browser: links, anchors, console, time to the first image. --serve: serves them on this \
machine.

    cargo xtask packages
        Creates the packages for publication, and builds and runs a program from them outside the repository, also with nightly if
        it is installed.

    cargo xtask semver [--baseline REVISION]
        Compares the library's public API with that of the last release (tag v*), or of a revision, by cargo-semver-checks, which is
        installed in target/tools once. Without a release, it does nothing.

    cargo xtask portability [--only TEXT]
        Translates the programs of every pipeline as wgpu does on other systems, and has their compilers judge them: HLSL by DXC, SPIR-V
        by spirv-val; MSL is translated only. A minute on two cores. Installs spirv-tools and, in target/tools, DXC; what cannot be
        installed is skipped. --only: only programs whose label, module or entry point contains the text.

    cargo xtask wasm
        Checks that the library and the page of the viewer compile for browsers.

    cargo xtask web [--serve | --shaders | --pipelines | --check | --check-all]
        Builds the viewer as a static page in target/web.
        --serve: serves it on this machine. --shaders, --pipelines: compiles every shader module, or every pipeline, in a headless
        browser. --check, --check-all: tests the page in a headless browser, and compares its masks with native ones.

    cargo xtask bevy [FILTER]
        Checks and tests the Bevy plugin, if a toolchain of Rust 1.97 or newer is installed. Not part of `ci`: its first build takes
        a quarter of an hour or more.

    cargo xtask mutants [--count N] [--seed S] [--only PATH] [--jobs N] [--seconds S] [--wide] [--again | --anew | --report] [--check]
        Changes one operator, comparison or number of a shader at a time, runs the tests that use it, and writes docs/mutants.md. An
        hour or two for 300. --check: writes nothing, and fails if a survivor has no reason in xtask/mutants/reasons.toml.

    cargo xtask qualities
        Measures every technique at every quality but best on built-in scenes, and writes bench/qualities.md: ten minutes.

    cargo xtask cases [NAME ...]
        Measures every technique on the small inputs of problem reports, and writes bench/cases.md: half an hour. With the beginnings
        of their names, only prints the table of those inputs.

    cargo xtask gpu-cost [--diff TABLE | --check]
        Counts registers, waves, instructions and workgroup memory of every pipeline as Mesa's compiler for AMD does, without a GPU,
        and dispatches, barriers and passes of a frame of each technique. Writes bench/gpu-cost.md, and tables in target/gpu-cost: two
        minutes. --diff: compares with an earlier table of target/gpu-cost.
        --check: writes no page, and fails on a spill or on more than 128 registers, except those in xtask/programs/exceptions.toml.

    cargo xtask figures [TECHNIQUE ...]
        Makes the images of docs/ and the README, or only those of the named techniques in docs/limits.md.

    cargo xtask setup
        Installs a C++ compiler and a Vulkan driver.
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let rest = args.get(1..).unwrap_or_default();
    let asks_for_help = args.iter().any(|arg| arg == "-h" || arg == "--help");
    let command = args.first().map_or("help", String::as_str);
    if asks_for_help || command == "help" {
        print!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let outcome = match command {
        "bevy" => bevy::run(rest),
        "demo" => demo::run(rest),
        "test" => test::run(rest, Missing::Skip),
        "ci" => test::run(rest, Missing::Fail),
        "book" => book::run(rest),
        "docs" => book::write_generated_parts(),
        "shaders" => link_shaders(),
        "mutants" => find_mutants(rest, []),
        "portability" => portability::run(rest),
        "packages" => packages::run(),
        "qualities" => qualities::run(),
        "semver" => semver::run(rest),
        "cases" => cases::run(rest),
        "wasm" => wasm::check(Missing::Skip),
        "web" => web::run(rest),
        "gpu-cost" => gpu_cost::run(rest),
        "figures" => figures::run(rest),
        "site" => site::run(rest),
        "setup" => machine::set_up(),
        other => {
            eprintln!("xtask: there is no command `{other}`; available: {}", commands().join(", "));
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Returns the names of the commands, from the usage text.
fn commands() -> Vec<&'static str> {
    USAGE.lines().filter_map(|line| line.strip_prefix("    cargo xtask ")?.split(' ').next()).collect()
}

/// Runs the linker, a separate program, so that nothing else in the workspace has to build it.
fn link_shaders() -> Result<(), String> {
    shell::run(shell::cargo().args(["run", "--quiet", "--locked", "--package", "antumbra-linker"]))
}

/// Runs the mutation tests, a separate program for the same reason.
fn find_mutants<'a>(
    args: &[String],
    variables: impl IntoIterator<Item = (&'a str, &'a std::ffi::OsString)>,
) -> Result<(), String> {
    let mut command = shell::cargo();
    shell::run(
        command.args(["run", "--quiet", "--locked", "--package", "antumbra-mutants", "--"]).args(args).envs(variables),
    )
}

/// Returns the root of the workspace.
fn root() -> PathBuf {
    let manifest_dir =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    manifest_dir.parent().map_or(manifest_dir.clone(), Path::to_path_buf)
}

#[cfg(test)]
mod tests {
    use antumbra_testing::book::{book_pages, commands, page, spans, words};

    /// Commands that the book and the README mention must exist.
    #[test]
    fn every_command_of_the_book_is_one_of_ours() {
        let known = super::commands();
        assert!(known.contains(&"demo") && known.contains(&"setup"), "{known:?}");
        let mut found = 0;
        let pages: Vec<_> =
            book_pages().into_iter().chain(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(page)).collect();
        let in_blocks = pages.iter().flat_map(commands).map(|command| (command.place, command.words));
        let in_sentences =
            pages.iter().flat_map(|page| spans(&page.text).into_iter().map(|span| (page.path.clone(), words(&span))));
        for (place, words) in in_blocks.chain(in_sentences) {
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let ["cargo", "xtask", name, ref rest @ ..] = words[..] else { continue };
            assert!(known.contains(&name), "{place}: there is no `cargo xtask {name}`");
            for option in rest.iter().filter(|word| word.starts_with("--")) {
                let usage = super::USAGE
                    .split("\n\n")
                    .find(|entry| entry.trim_start().starts_with(&format!("cargo xtask {name}")));
                assert!(usage.is_some_and(|usage| usage.contains(option)), "{place}: `{name}` takes no {option}");
            }
            found += 1;
        }
        assert!(found >= 20, "{found}");
    }
}
