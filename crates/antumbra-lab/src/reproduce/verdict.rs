//! Verdicts on claims, from what was measured.
//!
//! A verdict is on a paper's technique as published; beside it stands what our form gives. A rule is met, not met, or too close to
//! tell: every figure is known to within its [`Range`], and a rule is decided where all of the range says the same. Nothing is
//! decided where a number is lacking, nor does a software renderer decide about a GPU's milliseconds, unless the claim is of work
//! that grows alike on any. Each "cannot be shown" says what would show it.

use std::ops::Mul;

use super::claim::{Claim, Rule};
use super::exhibit::Exhibit;
use super::figure::Figure;
use super::form::Form;
use super::outcome::{Measured, Outcome};

/// What is to be said of a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every rule is met.
    Holds,
    /// A rule is not met.
    Contradicted,
    /// Nothing can be said: why, and what would show it.
    Undecided(String),
}

impl Verdict {
    /// For tables and pages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Contradicted => "contradicted",
            Self::Undecided(_) => "cannot be shown",
        }
    }
}

/// A claim judged over one form of the paper's technique.
#[derive(Clone, Debug)]
pub struct Ruling {
    /// What is to be said of it.
    pub verdict: Verdict,
    /// Each of its rules in words, with what was measured.
    pub found: Vec<String>,
    /// Why it is contradicted, where that is known.
    because: &'static str,
}

impl Ruling {
    /// The verdict as a sentence, with its reason where there is one.
    pub fn sentence(&self) -> String {
        match &self.verdict {
            Verdict::Holds => "The claim holds here.".to_owned(),
            Verdict::Contradicted if self.because.is_empty() => "The claim is contradicted here.".to_owned(),
            Verdict::Contradicted => format!("The claim is contradicted here: {}", self.because),
            Verdict::Undecided(why) => format!("Cannot be shown here: {why}."),
        }
    }
}

/// A claim after measuring.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The claim.
    pub claim: Claim,
    /// The verdict: on the technique as published.
    pub published: Ruling,
    /// What our form gives; `None` where no row of the claim has one.
    pub ours: Option<Ruling>,
    /// Sizes of the images that were measured: `256 × 144`. Empty where none was.
    pub sizes: String,
}

impl Judged {
    /// The ruling on each form.
    pub fn rulings(&self) -> impl Iterator<Item = (Form, &Ruling)> {
        std::iter::once((Form::Published, &self.published)).chain(self.ours.as_ref().map(|ours| (Form::Ours, ours)))
    }
}

/// What came of an exhibit's rows, in their order.
#[derive(Clone, Copy, Debug)]
pub struct Outcomes<'a> {
    /// As published.
    pub published: &'a [Outcome],
    /// Ours, of rows that have a form of ours.
    pub ours: &'a [Option<Outcome>],
}

impl Outcomes<'_> {
    /// A row's outcome in a form: what has no form of ours stands as published.
    fn of(&self, i: usize, form: Form) -> Option<&Outcome> {
        let ours = self.ours.get(i).and_then(Option::as_ref).filter(|_| form == Form::Ours);
        ours.or_else(|| self.published.get(i))
    }
}

/// Decides an exhibit's claims.
pub fn judge(exhibit: &Exhibit, outcomes: Outcomes<'_>, is_software: bool) -> Vec<Judged> {
    let bench = Bench { exhibit, outcomes, is_software };
    exhibit.claims.iter().map(|claim| bench.judge(claim)).collect()
}

struct Bench<'a> {
    exhibit: &'a Exhibit,
    outcomes: Outcomes<'a>,
    is_software: bool,
}

/// What became of a rule.
#[derive(Clone, Debug, PartialEq)]
enum Met {
    Yes,
    No,
    /// Why nothing can be said, and what would show it.
    Unknown(String),
}

impl Bench<'_> {
    fn judge(&self, claim: &Claim) -> Judged {
        let rows: Vec<&str> = claim.rules.iter().flat_map(Rule::rows).collect();
        let places: Vec<usize> = rows.iter().filter_map(|row| self.place(row)).collect();
        let has_ours = places.iter().any(|i| self.outcomes.ours.get(*i).is_some_and(Option::is_some));
        let mut sizes: Vec<[u32; 2]> = Vec::new();
        for i in &places {
            if let Some(Outcome::Measured(measured)) = self.outcomes.of(*i, Form::Published)
                && !sizes.contains(&measured.size_px)
            {
                sizes.push(measured.size_px);
            }
        }
        let sizes: Vec<String> = sizes.iter().map(|[width, height]| format!("{width} × {height}")).collect();
        Judged {
            claim: *claim,
            published: self.rule_on(claim, Form::Published),
            ours: has_ours.then(|| self.rule_on(claim, Form::Ours)),
            sizes: sizes.join(", "),
        }
    }

    fn place(&self, row: &str) -> Option<usize> {
        self.exhibit.rows.iter().position(|one| one.what == row)
    }

    fn rule_on(&self, claim: &Claim, form: Form) -> Ruling {
        let found: Vec<(String, Met)> = claim.rules.iter().map(|rule| self.look(claim, rule, form)).collect();
        let unknown = found.iter().find_map(|(_, met)| match met {
            Met::Unknown(why) => Some(why.clone()),
            _ => None,
        });
        let verdict = match unknown {
            _ if !claim.needs.is_empty() => Verdict::Undecided(claim.needs.to_owned()),
            // One rule that is not met is enough.
            _ if found.iter().any(|(_, met)| *met == Met::No) => Verdict::Contradicted,
            Some(why) => Verdict::Undecided(why),
            None => Verdict::Holds,
        };
        let because = match form {
            Form::Published => claim.because,
            Form::Ours => claim.because_ours,
        };
        Ruling { verdict, found: found.into_iter().map(|(text, _)| text).collect(), because }
    }

    /// A rule held against what was measured.
    fn look(&self, claim: &Claim, rule: &Rule, form: Form) -> (String, Met) {
        let values: Result<Vec<f64>, String> =
            rule.rows().iter().map(|row| self.value(rule.figure(), row, form)).collect();
        let values = match values {
            Ok(values) => values,
            Err(why) => return (rule.text(), Met::Unknown(why)),
        };
        let all = values.iter().map(|v| rule.figure().text(*v)).collect::<Vec<_>>().join(", ");
        let here = match rule {
            Rule::RatioAtMost(..) | Rule::RatioAtLeast(..) | Rule::RatioWithin(..) => ratio_text(&values, &all),
            _ => all,
        };
        if let Some(doubt) = self.doubt_of_times(claim, rule, &values, form) {
            return (format!("{}: here {here}", rule.text()), Met::Unknown(doubt.to_owned()));
        }
        if let Some(why) = rule.favored().iter().find_map(|row| self.is_flat(row, form)) {
            return (format!("{}: here {here}, but {why}", rule.text()), Met::No);
        }
        let ranges: Vec<Range> =
            rule.rows().iter().zip(&values).map(|(row, v)| self.range(rule.figure(), row, *v, form)).collect();
        let met = met(rule, &ranges);
        let met = met
            .map_or_else(|| Met::Unknown(too_close(rule.figure())), |is_met| if is_met { Met::Yes } else { Met::No });
        (format!("{}: here {here}", rule.text()), met)
    }

    /// Why a software renderer's times do not decide a rule, and what would; `None` where they do, and of other figures.
    fn doubt_of_times(&self, claim: &Claim, rule: &Rule, values: &[f64], form: Form) -> Option<&'static str> {
        if rule.figure() != Figure::Ms || !self.is_software {
            return None;
        }
        if !claim.on_any_adapter {
            return Some(
                "it needs a GPU, since times of a software renderer say little about one: the same command on a GPU would show it",
            );
        }
        if values.iter().any(|ms| *ms < LEAST_MS) {
            return Some(
                "a time is too short for a software renderer's clock: a larger image (--size) or a GPU would show it",
            );
        }
        let is_of_few_frames = rule.rows().iter().any(|row| self.is_of_few_frames(row, form));
        is_of_few_frames.then_some(
            "a median of so few frames says little on a processor that others use: more of them (--frames) on an idle one would \
             show it",
        )
    }

    /// Why an image is none: it errs no less than one without any shadow in it.
    fn is_flat(&self, row: &str, form: Form) -> Option<String> {
        let measured = self.measured(row, form)?;
        if let (Some(flicker), Some(still)) = (measured.flicker, measured.still_flicker) {
            return (flicker >= still).then(|| {
                format!("‘{row}’ flickers no less than a mask that never changes ({flicker:.4} and {still:.4})")
            });
        }
        let (rmse, flat) = (measured.rmse?, measured.flat_rmse?);
        (rmse >= flat).then(|| format!("‘{row}’ errs no less than one grey (rmse {rmse:.4} and {flat:.4})"))
    }

    fn outcome(&self, row: &str, form: Form) -> Option<&Outcome> {
        self.outcomes.of(self.place(row)?, form)
    }

    fn measured(&self, row: &str, form: Form) -> Option<&Measured> {
        match self.outcome(row, form) {
            Some(Outcome::Measured(measured)) => Some(measured),
            _ => None,
        }
    }

    fn is_of_few_frames(&self, row: &str, form: Form) -> bool {
        let count = self.measured(row, form).and_then(|measured| measured.count);
        count.is_some_and(|count| count.frames < LEAST_FRAMES)
    }

    fn range(&self, figure: Figure, row: &str, value: f64, form: Form) -> Range {
        let samples = self.measured(row, form).and_then(|measured| measured.truth_samples);
        Range::of(figure, value, samples, self.is_software)
    }

    fn value(&self, figure: Figure, row: &str, form: Form) -> Result<f64, String> {
        match self.outcome(row, form) {
            None => Err(format!("‘{row}’ was not run")),
            Some(Outcome::Measured(measured)) => match measured.figure(figure) {
                // Software renderers' clocks do: a ratio to it would say anything.
                Some(ms) if figure == Figure::Ms && ms <= 0.0 => {
                    Err(format!("‘{row}’ was timed as nothing; a GPU would show it"))
                }
                found => found.ok_or_else(|| format!("‘{row}’ has no {figure} here; another size (--size) may have")),
            },
            Some(other) => Err(format!("‘{row}’ is {other}")),
        }
    }
}

/// Shorter times of a software renderer say nothing of its work: passes begin and end with its scheduler.
const LEAST_MS: f64 = 1.0;

/// Of fewer frames a software renderer's median may be of a moment in which others had the processor.
const LEAST_FRAMES: u32 = 5;

/// Noise of a traced reference with one light point a pixel, rmse: below .002 with 1024 points, but in foliage.
const TRUTH_NOISE: f64 = 0.064;

/// What no image shows: a twentieth of an 8-bit step.
const UNSEEN: f64 = 0.0002;

/// By such a part figures of an image change where its size does by one pixel.
const IMAGE_SPREAD: f64 = 0.01;

/// By such a part flicker differs from run to run, where threads race for what they store.
const FLICKER_SPREAD: f64 = 0.05;

/// By such a part medians of a row's time differ from run to run: on a graphics card, and on a processor that has other work.
const TIME_SPREAD: f64 = 0.03;
const SOFTWARE_TIME_SPREAD: f64 = 0.1;

/// Between what a figure lies.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(figure: Figure, value: f64, truth_samples: Option<u32>, is_software: bool) -> Self {
        let within = |part: f64, step: f64| Self {
            low: (value * (1.0 - part) - step).max(0.0),
            high: value * (1.0 + part) + step,
        };
        match figure {
            Figure::Ms => within(if is_software { SOFTWARE_TIME_SPREAD } else { TIME_SPREAD }, 0.0),
            Figure::MemoryMib => within(0.0, 0.0),
            Figure::UmbraLeak | Figure::LitLoss | Figure::Noise => within(IMAGE_SPREAD, UNSEEN),
            Figure::Flicker => within(FLICKER_SPREAD, UNSEEN),
            Figure::Rmse => {
                // The reference's noise adds to the square of what an image errs.
                let noise = truth_samples.map_or(0.0, |samples| TRUTH_NOISE / f64::from(samples.max(1)).sqrt());
                let range = within(IMAGE_SPREAD, 0.0);
                Self { low: (range.low * range.low - noise * noise).max(0.0).sqrt(), ..range }
            }
        }
    }
}

impl Mul<Range> for f64 {
    type Output = Range;

    fn mul(self, range: Range) -> Range {
        Range { low: self * range.low, high: self * range.high }
    }
}

/// Whether one is at most the other; `None` where that cannot be told.
fn at_most(a: Range, b: Range) -> Option<bool> {
    if a.high <= b.low {
        Some(true)
    } else if a.low > b.high {
        Some(false)
    } else {
        None
    }
}

/// Whether all are true; false where one is false, and unknown where one is unknown.
fn all(of: impl IntoIterator<Item = Option<bool>>) -> Option<bool> {
    let of: Vec<Option<bool>> = of.into_iter().collect();
    if of.contains(&Some(false)) { Some(false) } else { of.into_iter().collect::<Option<Vec<_>>>().map(|_| true) }
}

/// Whether a rule is met by its rows' figures.
fn met(rule: &Rule, of: &[Range]) -> Option<bool> {
    let exact = |bound: f64| Range { low: bound, high: bound };
    match rule {
        Rule::AtMost(.., bound) => at_most(of[0], exact(*bound)),
        Rule::AtLeast(.., bound) => at_most(exact(*bound), of[0]),
        // By products, so that nothing is divided by.
        Rule::RatioAtMost(.., bound) => at_most(of[0], *bound * of[1]),
        Rule::RatioAtLeast(.., bound) => at_most(*bound * of[1], of[0]),
        Rule::RatioWithin(.., [low, high]) => all([at_most(*low * of[1], of[0]), at_most(of[0], *high * of[1])]),
        Rule::Rising(..) => all(of.windows(2).map(|pair| at_most(pair[0], pair[1]))),
        Rule::Alike(.., bound) => all(of.iter().flat_map(|a| of.iter().map(|b| at_most(*a, *bound * *b)))),
    }
}

fn too_close(figure: Figure) -> String {
    match figure {
        Figure::Ms => {
            "it is too close to tell: more frames (--frames) on a machine with nothing else to do would show it"
                .to_owned()
        }
        _ => "it is too close to tell: more pixels and light points (--size, --samples) would show it".to_owned(),
    }
}

/// The ratio, and what it is of.
fn ratio_text(values: &[f64], all: &str) -> String {
    if values[1] > 0.0 { format!("{:.2} ({all})", values[0] / values[1]) } else { all.to_owned() }
}

#[cfg(test)]
mod tests;
