//! `cargo xtask mutants`: changes the library's shaders one operator, comparison or number at a time, and reports changes that
//! no test detects.
//!
//! The tests are built once, with the library's feature `mutants`, with which they read shader texts from a folder at run time. Each run
//! of a test reports the shaders it uses. A mutant is tested by those that use a changed shader, the most promising first, until one
//! fails that passes without the change. Verdicts are stored in `target/mutants/results.jsonl` and reused.

mod choice;
mod judge;
mod named;
mod places;
mod report;
mod results;
mod run;
mod sources;
mod suite;

use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask mutants [OPTIONS]

Changes one operator, comparison or number of the library's shaders at a time, runs the tests that use the changed shader, and
writes docs/mutants.md. A run that was stopped continues.

    --count N       Number of mutants that compile; default: 300.
    --seed S        Seed that selects the mutants; default: 1.
    --only PATH     Mutates only sources whose path under src/ begins with PATH.
    --jobs N        Number of mutants tested at the same time; default: 1.
    --seconds S     Time limit for the tests of one mutant; default: 60.
    --wide          Also runs the laboratory's tests of whole techniques, which are slow.
    --again         Repeats the survivors, after a test was added or with more seconds.
    --anew          Repeats all mutants, and measures the tests again.
    --report        Only writes the page from the results so far.
    --check         Writes no page, and stores its results separately from those of the page; fails if a mutant survives for which
                    `xtask/mutants/reasons.toml` has no reason.
";

/// Options of the command line.
#[derive(Debug, PartialEq)]
struct Options {
    count: usize,
    seed: u64,
    only: String,
    jobs: usize,
    seconds: f64,
    wide: bool,
    again: bool,
    anew: bool,
    report: bool,
    check: bool,
}

impl Options {
    fn parse(args: &[String]) -> Result<Self, String> {
        let mut options = Self {
            count: 300,
            seed: 1,
            only: String::new(),
            jobs: 1,
            seconds: 60.0,
            wide: false,
            again: false,
            anew: false,
            report: false,
            check: false,
        };
        let mut args = args.iter();
        while let Some(arg) = args.next() {
            let mut value = || args.next().ok_or_else(|| format!("`{arg}` needs a value"));
            match arg.as_str() {
                "--count" => options.count = number(arg, value()?)?,
                "--seed" => options.seed = number(arg, value()?)?,
                "--only" => options.only = value()?.clone(),
                "--jobs" => options.jobs = number(arg, value()?)?,
                "--seconds" => options.seconds = number(arg, value()?)?,
                "--wide" => options.wide = true,
                "--again" => options.again = true,
                "--anew" => options.anew = true,
                "--report" => options.report = true,
                "--check" => options.check = true,
                other => return Err(format!("there is no option `{other}`\n\n{USAGE}")),
            }
        }
        if !(options.seconds.is_finite() && options.seconds > 0.0) {
            return Err("`--seconds` must be more than 0".to_owned());
        }
        if options.count == 0 || options.jobs == 0 {
            return Err("`--count` and `--jobs` must be at least 1".to_owned());
        }
        Ok(options)
    }

    /// Returns the command that reproduces the choice.
    fn command(&self) -> String {
        let only = if self.only.is_empty() { String::new() } else { format!(" --only {}", self.only) };
        format!("cargo xtask mutants --count {} --seed {}{only}", self.count, self.seed)
    }
}

fn number<T: std::str::FromStr>(option: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("`{option} {value}`: expected a valid number"))
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match Options::parse(&args).and_then(|options| run::run(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("mutants: {message}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Options, String> {
        Options::parse(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn options_are_what_was_said() {
        let options = parsed("--count 12 --seed 3 --only techniques/summed").expect("options");
        assert_eq!((options.count, options.seed, options.only.as_str()), (12, 3, "techniques/summed"));
        assert_eq!(options.command(), "cargo xtask mutants --count 12 --seed 3 --only techniques/summed");
        assert!(!options.check && parsed("--check").is_ok_and(|options| options.check));
        assert_eq!(
            parsed("").map(|options| options.command()),
            Ok("cargo xtask mutants --count 300 --seed 1".to_owned())
        );
        for bad in ["--count", "--count x", "--count 0", "--jobs 0", "--seconds 0", "--seconds nan", "--many"] {
            assert!(parsed(bad).is_err(), "{bad}");
        }
    }
}
