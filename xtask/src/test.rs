//! `cargo xtask test` in its three tiers and `cargo xtask ci`: format, lints and tests; packages and browsers.

use std::ffi::OsStr;
use std::time::Instant;

use crate::driver::{self, Driver};
use crate::machine::{self, Missing};
use crate::shell::{self, cargo, find, succeeds};
use crate::skips::{self, Skips};
use crate::{bevy, families, find_mutants, gpu_cost, packages, portability, semver, wasm, web};

/// Tier of tests.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tier {
    /// Tests without an adapter, and one mask per technique.
    Quick,
    /// All tests except those marked `#[ignore]`; required by continuous integration.
    Required,
    /// Also tests marked `#[ignore]`, then a run of the program outside, the Bevy plugin and a sample of mutants.
    Long,
}

/// Filter of [`Tier::Quick`] for nextest: crates and modules whose tests finish in an instant.
const QUICK: &str = "package(antumbra-light) | package(antumbra-scene) | package(antumbra-linker) | package(antumbra-book) | package(xtask) \
                     | (package(antumbra-reference) & not test(robustness) & not test(surfaces)) \
                     | (package(antumbra) & (test(in_shaders::) | test(contract::) | test(/^tests::/) | test(primitives::prefix_scan))) \
                     | (binary(bad_input) & package(antumbra-cli)) \
                     | test(one_mask_of_each_technique)";

/// Mutants that [`Tier::Long`] judges: always the same ones, without earlier verdicts.
const MUTANTS: [&str; 6] = ["--count", "100", "--seed", "1", "--anew", "--check"];

impl Tier {
    /// Returns the tier that the first word names, and the remaining words.
    fn of(words: &[String]) -> (Self, &[String]) {
        match words.split_first() {
            Some((word, rest)) if word == "quick" => (Self::Quick, rest),
            Some((word, rest)) if word == "long" => (Self::Long, rest),
            _ => (Self::Required, words),
        }
    }
}

/// Sets up, checks and tests. With [`Missing::Fail`] it also checks single families, packages and browsers. The test runner's summary
/// comes last, followed by the number of skipped tests if tests may be skipped. The driver option is removed from the arguments; the rest
/// is a filter for the test runner.
///
/// # Errors
/// The first check that failed.
pub fn run(arguments: &[String], missing: Missing) -> Result<(), String> {
    let began = Instant::now();
    let (wanted, words) = driver::option(arguments)?;
    let (tier, filter) = if missing == Missing::Skip { Tier::of(&words) } else { (Tier::Required, words.as_slice()) };
    machine::set_up()?;
    let driver = Driver::choose(wanted)?;
    if filter.is_empty() {
        if component("fmt", "rustfmt", missing)? {
            shell::run(cargo().args(["fmt", "--all", "--check"]))?;
        }
        if missing == Missing::Fail {
            // Before all slow steps, because without an adapter most tests would fail one by one. The whole workspace is built, so that
            // the tests find its dependencies.
            timed("built", || run_locked(&["build", "--workspace", "--exclude", "xtask"], &[]))?;
            shell::run(std::process::Command::new(shell::built_binary()?).arg("doctor").envs(driver.variables()))
                .map_err(|problem| {
                    format!("no graphics adapter works on this machine, but most tests need one: {problem}")
                })?;
        }
        let lint = || {
            if component("clippy", "clippy", missing)? {
                let denied = ["--", "-D", "warnings"];
                timed("linted", || run_locked(&["clippy", "--workspace", "--all-targets"], &denied))?;
            }
            Ok(())
        };
        if missing == Missing::Fail {
            // Checks with separate build folders run in parallel, because compiling often waits for a single crate.
            let (inside, outside) = std::thread::scope(|scope| {
                let outside = scope
                    .spawn(|| packages::check().and_then(|()| wasm::check(missing)).and_then(|()| semver::run(&[])));
                let inside = lint().and_then(|()| families::check());
                (inside, outside.join().expect("checks do not panic"))
            });
            inside.and(outside)?;
            web::check_programs(web::Programs::ModulesAndLayouts)?;
            portability::run(&[])?;
            gpu_cost::check()?;
        } else {
            lint()?;
        }
        eprintln!("xtask: checks done after {} s", began.elapsed().as_secs());
    } else {
        // Otherwise the filtered tests would use the shaders from before an edit.
        run_locked(&["test", "--quiet", "--package", "antumbra-linker"], &[])?;
    }
    match missing {
        Missing::Fail => run_tests(tier, filter, &driver, (skips::REQUIRE_ADAPTER, OsStr::new("1"))),
        Missing::Skip => {
            let skips = Skips::new()?;
            let outcome = run_tests(tier, filter, &driver, (skips::LIST, skips.path().as_os_str()));
            skips.report();
            outcome?;
            if tier == Tier::Long && filter.is_empty() {
                packages::run()?;
                bevy::run(&[])?;
                find_mutants(&MUTANTS.map(str::to_owned), driver.variables())?;
            }
            Ok(())
        }
    }
}

/// Runs a tier's tests with a driver and a variable, by nextest if it is installed.
fn run_tests(tier: Tier, filter: &[String], driver: &Driver, variable: (&str, &OsStr)) -> Result<(), String> {
    let words: Vec<&str> = filter.iter().map(String::as_str).collect();
    let run = |command: &[&str], rest: &[&str]| {
        shell::run(cargo().args(command).arg("--locked").args(rest).envs(driver.variables()).envs([variable]))
    };
    if find("cargo-nextest").is_none() {
        return match tier {
            Tier::Quick => run(&["test", "--package", "antumbra-light", "--package", "antumbra-scene"], &words),
            Tier::Required => run(&["test", "--workspace"], &words),
            Tier::Long => run(&["test", "--workspace"], &[&words, &["--", "--include-ignored"][..]].concat()),
        };
    }
    // nextest does not run the examples in the documentation.
    if filter.is_empty() && tier != Tier::Quick {
        run(&["test", "--workspace", "--doc", "--quiet"], &[])?;
    }
    let of_tier: &[&str] = match tier {
        Tier::Quick => &["-E", QUICK],
        Tier::Required => &[],
        Tier::Long => &["--run-ignored", "all"],
    };
    run(&["nextest", "run", "--workspace", "--no-tests", "pass"], &[of_tier, &words].concat())
}

/// Runs a step and prints its time.
fn timed(what: &str, step: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    let began = Instant::now();
    step()?;
    eprintln!("xtask: {what} in {} s", began.elapsed().as_secs());
    Ok(())
}

/// Runs cargo with the versions of the lock file.
fn run_locked(command: &[&str], rest: &[&str]) -> Result<(), String> {
    shell::run(cargo().args(command).arg("--locked").args(rest))
}

/// Whether a component of the toolchain is installed, after asking rustup for it if necessary.
fn component(subcommand: &str, name: &str, missing: Missing) -> Result<bool, String> {
    let here = || succeeds(cargo().args([subcommand, "--version"]));
    if here() {
        return Ok(true);
    }
    if find("rustup").is_some() {
        eprintln!("xtask: this toolchain lacks {name}; installing it with rustup");
        if shell::run(std::process::Command::new("rustup").args(["component", "add", name])).is_ok() && here() {
            return Ok(true);
        }
    }
    match missing {
        Missing::Fail => Err(format!("{name} is not installed: `rustup component add {name}`")),
        Missing::Skip => {
            eprintln!("xtask: SKIPPED {name}: it is not installed (`rustup component add {name}`)");
            Ok(false)
        }
    }
}
