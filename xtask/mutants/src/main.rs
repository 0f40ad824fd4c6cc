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

Changes the library's shaders one operator, comparison or number at a time, runs the tests that use what is changed, and
writes docs/mutants.md. A run that was ended is taken up where it was.

    --count N       How many mutants that compile; 300.
    --seed S        Which; 1.
    --only PATH     Of sources whose path under src/ begins so.
    --jobs N        How many at a time; 1.
    --seconds S     How long tests are asked about a mutant at most; 60.
    --wide          Asks the laboratory's tests of whole techniques too, which take long.
    --again         Judges those that survived again, after a test was added or with more seconds.
    --anew          Judges all again, and measures the tests again.
    --report        Only writes the page, of what is judged.
    --check         Writes no page, and keeps what it judges apart from what a page is made of; fails where a mutant survives that
                    `xtask/mutants/reasons.toml` has no reason for.
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
            let mut value = || args.next().ok_or_else(|| format!("`{arg}` wants a value"));
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
            return Err("`--seconds` is more than 0".to_owned());
        }
        if options.count == 0 || options.jobs == 0 {
            return Err("`--count` and `--jobs` are 1 or more".to_owned());
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
    value.parse().map_err(|_| format!("`{option} {value}`: that is no such number"))
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
