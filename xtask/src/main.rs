//! Development commands: `cargo xtask demo`, `cargo xtask test`, `cargo xtask shaders`, `cargo xtask ci`.
//!
//! Standard library only: this is the first thing that a bare machine has to build, before anything else could be set
//! up for it.

mod bevy;
mod book;
mod demo;
mod driver;
mod families;
mod figures;
mod machine;
mod packages;
mod qualities;
mod shell;
mod skips;
mod test;
mod wasm;
mod web;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use machine::Missing;

const USAGE: &str = "\
Development commands of Antumbra.

    cargo xtask demo [SCENE.glb ...] [--no-open] [--driver default|installed|newer]
        Sets up what is missing, builds the command `antumbra`, compares the techniques on a few built-in scenes and
        on every scene given, and prints the path of the report (and opens it where there is a display).

    cargo xtask test [quick|long] [FILTER] [--driver default|installed|newer]
        Sets up what is missing, checks format and lints, and runs the tests of the workspace that continuous integration requires.
        `quick` runs those that are done in an instant, and draws one mask by each technique; `long` those that are marked `#[ignore]`,
        too, every command of the book among them, then the plugin for Bevy and a sample of mutants, which fails where one survives
        without a reason: hours. Without a graphics card, on Debian 12,
        tests draw by a newer Mesa than the installed, which is brought into target/newer-mesa and leaves the system as it is;
        where it cannot be had the installed driver serves, and that is said. `--driver` chooses, or ANTUMBRA_DRIVER does; VK_DRIVER_FILES
        is left as it is.

    cargo xtask ci [--driver default|installed|newer]
        What continuous integration runs: `test`, each family of techniques alone, `packages`, `wasm` and `web --shaders`, with a
        failure where a check would otherwise be skipped, or where no graphics adapter answers. Where no browser is, nor can be
        installed, its shaders alone are skipped, and that is said.

    cargo xtask shaders
        Links the library's shaders again, after a change to a .wesl file or to the list in src/shaders.rs.

    cargo xtask docs
        Writes the parts of the book and the README that are made of the techniques' declarations, after a change to one.

    cargo xtask book [--serve]
        Builds the book of docs/ in target/book, after `docs`; serves it on this machine. Installs mdbook in target/tools where
        it is not there: a few minutes, once.

    cargo xtask packages
        Makes the packages that would be published, and builds and runs a program outside the repository from them.

    cargo xtask wasm
        Checks that the library compiles for browsers; sets up a compiler for them where it can.

    cargo xtask web [--serve | --shaders | --pipelines | --check | --check-all]
        Builds the viewer as a page, in target/web, for any host of files; serves it on this machine; has a headless browser make
        every shader module and layout, without the page, which `ci` does too, or every pipeline of these; or tries the page in a
        headless browser and holds a mask of every technique there, or of all variants of each, against the system's. Sets up
        what is missing where it can.

    cargo xtask bevy [FILTER]
        Checks and tests the plugin for Bevy, by a toolchain of Rust 1.97 or newer where one is installed, nightly for one; says
        so where none is. Not part of `ci`: its first build takes a quarter of an hour and more. Its shaders and its patch of
        Bevy's are, which need no build of Bevy.

    cargo xtask mutants [--count N] [--seed S] [--only PATH] [--jobs N] [--seconds S] [--wide] [--again | --anew | --report] [--check]
        Changes the shaders one operator, comparison or number at a time, runs the tests that use what is changed, and writes
        docs/mutants.md: which changes no test notices. Takes an hour or two for 300. With `--check` it writes nothing, and fails where
        a survivor has no reason in xtask/mutants/reasons.toml.

    cargo xtask qualities
        Measures every technique at every quality but best on a few built-in scenes, and writes bench/qualities.md: ten minutes.

    cargo xtask figures [TECHNIQUE ...]
        Makes the pictures of docs/ and the README again, or those of some techniques on docs/limits.md alone.

    cargo xtask setup
        Only the setting up: a C++ compiler and a Vulkan driver.
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
        "packages" => packages::check(),
        "qualities" => qualities::run(),
        "wasm" => wasm::check(Missing::Skip),
        "web" => web::run(rest),
        "figures" => figures::run(rest),
        "setup" => machine::set_up(),
        other => {
            eprintln!("xtask: there is no command `{other}`; there are {}", commands().join(", "));
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

/// The names of the commands, as the usage has them.
fn commands() -> Vec<&'static str> {
    USAGE.lines().filter_map(|line| line.strip_prefix("    cargo xtask ")?.split(' ').next()).collect()
}

/// The linker is a program of its own: nothing else in the workspace has to build it.
fn link_shaders() -> Result<(), String> {
    shell::run(shell::cargo().args(["run", "--quiet", "--locked", "--package", "antumbra-linker"]))
}

/// As the linker.
fn find_mutants<'a>(
    args: &[String],
    variables: impl IntoIterator<Item = (&'a str, &'a std::ffi::OsString)>,
) -> Result<(), String> {
    let mut command = shell::cargo();
    shell::run(
        command.args(["run", "--quiet", "--locked", "--package", "antumbra-mutants", "--"]).args(args).envs(variables),
    )
}

/// The root of the workspace.
fn root() -> PathBuf {
    let manifest_dir =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    manifest_dir.parent().map_or(manifest_dir.clone(), Path::to_path_buf)
}

#[cfg(test)]
mod tests {
    use antumbra_testing::book::{book_pages, commands, page, spans, words};

    /// What the book and the README tell their readers to run of us.
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
