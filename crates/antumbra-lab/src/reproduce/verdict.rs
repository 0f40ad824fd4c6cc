//! Verdicts on claims, from measurements.
//!
//! A verdict is on a paper's technique as published; the result of our form is shown beside it. A rule is met, not met, or too close to
//! tell: every figure has an uncertainty [`Range`], and a rule is decided if the whole range agrees. Missing numbers decide nothing. A
//! software renderer does not decide about milliseconds unless the claim is about work that grows alike on any adapter. Each "cannot be
//! shown" names what would show it.

use std::ops::Mul;

use super::claim::{Claim, Rule};
use super::exhibit::Exhibit;
use super::figure::Figure;
use super::form::Form;
use super::outcome::{Measured, Outcome};

/// Verdict on a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All rules are met.
    Holds,
    /// A rule is not met.
    Contradicted,
    /// No decision, for the given reason, with what would show the claim.
    Undecided(String),
}

impl Verdict {
    /// Returns the name for tables and pages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Contradicted => "contradicted",
            Self::Undecided(_) => "cannot be shown",
        }
    }
}

/// Judgement of a claim for one form of the paper's technique.
#[derive(Clone, Debug)]
pub struct Ruling {
    /// Verdict on the claim.
    pub verdict: Verdict,
    /// Description of each rule with the measured values.
    pub found: Vec<String>,
    /// Known reason of a contradiction.
    because: &'static str,
}

impl Ruling {
    /// Returns the verdict as a sentence, with its reason if known.
    pub fn sentence(&self) -> String {
        match &self.verdict {
            Verdict::Holds => "The claim holds here.".to_owned(),
            Verdict::Contradicted if self.because.is_empty() => "The claim is contradicted here.".to_owned(),
            Verdict::Contradicted => format!("The claim is contradicted here: {}", self.because),
            Verdict::Undecided(why) => format!("Cannot be shown here: {why}."),
        }
    }
}

/// Judgement of a claim in both forms.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Claim.
    pub claim: Claim,
    /// Verdict on the technique as published.
    pub published: Ruling,
    /// Result of our form; `None` if no row of the claim has one.
    pub ours: Option<Ruling>,
    /// Sizes of the measured images: `256 × 144`. Empty without measurements.
    pub sizes: String,
}

impl Judged {
    /// Returns the ruling on each form.
    pub fn rulings(&self) -> impl Iterator<Item = (Form, &Ruling)> {
        std::iter::once((Form::Published, &self.published)).chain(self.ours.as_ref().map(|ours| (Form::Ours, ours)))
    }
}

/// Outcomes of an exhibit's rows, in their order.
#[derive(Clone, Copy, Debug)]
pub struct Outcomes<'a> {
    /// Outcomes as published.
    pub published: &'a [Outcome],
    /// Outcomes of our form, for rows that have one.
    pub ours: &'a [Option<Outcome>],
}

impl Outcomes<'_> {
    /// Returns a row's outcome in a form; rows without our form use the published one.
    fn of(&self, i: usize, form: Form) -> Option<&Outcome> {
        let ours = self.ours.get(i).and_then(Option::as_ref).filter(|_| form == Form::Ours);
        ours.or_else(|| self.published.get(i))
    }
}

/// Judges an exhibit's claims.
pub fn judge(exhibit: &Exhibit, outcomes: Outcomes<'_>, is_software: bool) -> Vec<Judged> {
    let bench = Bench { exhibit, outcomes, is_software };
    exhibit.claims.iter().map(|claim| bench.judge(claim)).collect()
}

struct Bench<'a> {
    exhibit: &'a Exhibit,
    outcomes: Outcomes<'a>,
    is_software: bool,
}

/// Result of a rule.
#[derive(Clone, Debug, PartialEq)]
enum RuleOutcome {
    Yes,
    No,
    /// Undecided, with the reason and what would show it.
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
        let found: Vec<(String, RuleOutcome)> = claim.rules.iter().map(|rule| self.look(claim, rule, form)).collect();
        let mut unknown: Vec<&str> = Vec::new();
        for (_, met) in &found {
            if let RuleOutcome::Unknown(why) = met
                && !unknown.contains(&why.as_str())
            {
                unknown.push(why);
            }
        }
        let verdict = if !claim.needs.is_empty() {
            Verdict::Undecided(claim.needs.to_owned())
        } else if found.iter().any(|(_, met)| *met == RuleOutcome::No) {
            // A single rule that is not met contradicts the claim.
            Verdict::Contradicted
        } else if unknown.is_empty() {
            Verdict::Holds
        } else {
            Verdict::Undecided(unknown.join("; "))
        };
        let because = match form {
            Form::Published => claim.because,
            Form::Ours => claim.because_ours,
        };
        Ruling { verdict, found: found.into_iter().map(|(text, _)| text).collect(), because }
    }

    /// Judges a rule by the measured values.
    fn look(&self, claim: &Claim, rule: &Rule, form: Form) -> (String, RuleOutcome) {
        let values: Result<Vec<f64>, String> =
            rule.rows().iter().map(|row| self.value(claim, rule.figure(), row, form)).collect();
        let values = match values {
            Ok(values) => values,
            Err(why) => return (rule.text(), RuleOutcome::Unknown(why)),
        };
        let all = values.iter().map(|v| rule.figure().text(*v)).collect::<Vec<_>>().join(", ");
        let here = match rule {
            Rule::RatioAtMost(..) | Rule::RatioAtLeast(..) | Rule::RatioWithin(..) => ratio_text(&values, &all),
            _ => all,
        };
        if let Some(doubt) = self.doubt_of_times(claim, rule, &values, form) {
            return (format!("{}: here {here}", rule.text()), RuleOutcome::Unknown(doubt.to_owned()));
        }
        if let Some(why) = rule.favored().iter().find_map(|row| self.is_flat(row, form)) {
            return (format!("{}: here {here}, but {why}", rule.text()), RuleOutcome::No);
        }
        let ranges: Vec<Range> =
            rule.rows().iter().zip(&values).map(|(row, v)| self.range(rule.figure(), row, *v, form)).collect();
        let met = match met(rule, &ranges) {
            Some(true) => RuleOutcome::Yes,
            Some(false) => RuleOutcome::No,
            None => RuleOutcome::Unknown(self.too_close(claim, rule, &values)),
        };
        (format!("{}: here {here}", rule.text()), met)
    }

    /// Returns the reason why figures lie too close to a rule to decide it, and what would show it.
    fn too_close(&self, claim: &Claim, rule: &Rule, values: &[f64]) -> String {
        let figure = rule.figure();
        let without_noise: Vec<Range> = values.iter().map(|v| Range::of(figure, *v, None, self.is_software)).collect();
        let would_show = match figure {
            Figure::Ms => "more frames (--frames) on a machine with nothing else to do would show it",
            _ if !claim.if_too_close.is_empty() => claim.if_too_close,
            Figure::Rmse if met(rule, &without_noise).is_some() => {
                "the reference's noise may be a large part of these errors: more light points (--samples) would show it"
            }
            _ if values.iter().all(|v| *v <= UNSEEN) => {
                "all are below what an image shows: a size (--size) at which one is above it would show it"
            }
            _ => "they differ by less than their uncertainty: a size (--size) at which they differ more would show it",
        };
        format!("it is too close to tell: {would_show}")
    }

    /// Returns the reason why a software renderer's times do not decide a rule, and what would; `None` if they do, or for other figures.
    fn doubt_of_times(&self, claim: &Claim, rule: &Rule, values: &[f64], form: Form) -> Option<&'static str> {
        if rule.figure() != Figure::Ms || !self.is_software {
            return None;
        }
        if !claim.on_any_adapter {
            return Some(
                "times of a software renderer say little about a GPU; run the same command on a GPU to decide",
            );
        }
        if values.iter().any(|ms| *ms < MIN_MS) {
            return Some(
                "a time is too short for a software renderer's clock; use a larger image (--size) or a GPU to decide",
            );
        }
        let is_of_few_frames = rule.rows().iter().any(|row| self.is_of_few_frames(row, form));
        is_of_few_frames.then_some(
            "a median of so few frames is unreliable on a CPU; use more frames (--frames) on an idle machine to decide",
        )
    }

    /// Returns the reason why an image does not count: its error is at least that of one without any shadow.
    fn is_flat(&self, row: &str, form: Form) -> Option<String> {
        let measured = self.measured(row, form)?;
        if let (Some(flicker), Some(still)) = (measured.flicker, measured.still_flicker) {
            return (flicker >= still).then(|| {
                format!("‘{row}’ flickers at least as much as a mask that never changes ({flicker:.4} and {still:.4})")
            });
        }
        let (rmse, flat) = (measured.rmse?, measured.flat_rmse?);
        (rmse >= flat)
            .then(|| format!("‘{row}’ has at least the error of a uniform grey (rmse {rmse:.4} and {flat:.4})"))
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
        count.is_some_and(|count| count.frames < MIN_FRAMES)
    }

    fn range(&self, figure: Figure, row: &str, value: f64, form: Form) -> Range {
        let samples = self.measured(row, form).and_then(|measured| measured.truth_samples);
        Range::of(figure, value, samples, self.is_software)
    }

    fn value(&self, claim: &Claim, figure: Figure, row: &str, form: Form) -> Result<f64, String> {
        let is_for_gpus = figure == Figure::Ms && self.is_software && !claim.on_any_adapter;
        let is_of_frames = figure == Figure::Ms && self.is_software && claim.on_any_adapter;
        match self.outcome(row, form) {
            None => Err(format!("‘{row}’ was not run")),
            Some(Outcome::Measured(measured)) => match measured.figure(figure) {
                // Software renderers' clocks report zero, for which ratios are meaningless.
                Some(ms) if figure == Figure::Ms && ms <= 0.0 => {
                    Err(format!("the time of ‘{row}’ was reported as zero; use a GPU to decide"))
                }
                found => found.ok_or_else(|| format!("‘{row}’ has no {figure} here; try another size (--size)")),
            },
            Some(Outcome::TooSlow) if is_for_gpus => Err(format!(
                "‘{row}’ is too slow for a software renderer: the same command on a GPU, which runs it, would show it"
            )),
            Some(Outcome::TooSlow) => Err(format!(
                "‘{row}’ is too slow for a software renderer: --dear, or the same command on a GPU, would show it"
            )),
            Some(other @ Outcome::NotReady(_)) if is_for_gpus => {
                Err(format!("‘{row}’ is {other}; with it, the same command on a GPU would show it"))
            }
            Some(other @ Outcome::NotReady(_)) if is_of_frames => Err(format!(
                "‘{row}’ is {other}; with it, {MIN_FRAMES} frames or more (--frames) on an idle processor would show it"
            )),
            Some(other @ Outcome::NotReady(_)) => Err(format!("‘{row}’ is {other}; that would show it")),
            Some(other) => Err(format!("‘{row}’ is {other}")),
        }
    }
}

/// Minimum time of a software renderer, ms. Shorter ones reflect its scheduler, which starts and ends passes.
const MIN_MS: f64 = 1.0;

/// Minimum number of frames of a software renderer's median. A shorter median may fall into a moment of other load.
const MIN_FRAMES: u32 = 5;

/// Noise of a traced reference with one light sample per pixel, rmse: below .002 with 1024 samples, except in foliage.
const TRUTH_NOISE: f64 = 0.064;

/// Invisible difference of an image: a twentieth of an 8-bit step.
const UNSEEN: f64 = 0.0002;

/// Relative change of an image's figures when its size changes by one pixel.
const IMAGE_SPREAD: f64 = 0.01;

/// Relative variation of flicker between runs, where threads race to store values.
const FLICKER_SPREAD: f64 = 0.05;

/// Relative variation of a row's median time between runs, on a graphics card and on a CPU with other load.
const TIME_SPREAD: f64 = 0.03;
const SOFTWARE_TIME_SPREAD: f64 = 0.1;

/// Uncertainty range of a figure.
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
                // The reference's noise adds to the square of an image's error.
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

/// Returns whether `a` is at most `b`; `None` if the ranges overlap.
fn at_most(a: Range, b: Range) -> Option<bool> {
    if a.high <= b.low {
        Some(true)
    } else if a.low > b.high {
        Some(false)
    } else {
        None
    }
}

/// Returns whether all are true: false if one is false, else unknown if one is unknown.
fn all(of: impl IntoIterator<Item = Option<bool>>) -> Option<bool> {
    let of: Vec<Option<bool>> = of.into_iter().collect();
    if of.contains(&Some(false)) { Some(false) } else { of.into_iter().collect::<Option<Vec<_>>>().map(|_| true) }
}

/// Returns whether the rows' figures meet a rule.
fn met(rule: &Rule, of: &[Range]) -> Option<bool> {
    let exact = |bound: f64| Range { low: bound, high: bound };
    match rule {
        Rule::AtMost(.., bound) => at_most(of[0], exact(*bound)),
        Rule::AtLeast(.., bound) => at_most(exact(*bound), of[0]),
        // Compares products, to avoid division by zero.
        Rule::RatioAtMost(.., bound) => at_most(of[0], *bound * of[1]),
        Rule::RatioAtLeast(.., bound) => at_most(*bound * of[1], of[0]),
        Rule::RatioWithin(.., [low, high]) => all([at_most(*low * of[1], of[0]), at_most(of[0], *high * of[1])]),
        Rule::Rising(..) => all(of.windows(2).map(|pair| at_most(pair[0], pair[1]))),
        Rule::Alike(.., bound) => all(of.iter().flat_map(|a| of.iter().map(|b| at_most(*a, *bound * *b)))),
    }
}

/// Returns the ratio, with its values.
fn ratio_text(values: &[f64], all: &str) -> String {
    if values[1] > 0.0 { format!("{:.2} ({all})", values[0] / values[1]) } else { all.to_owned() }
}

#[cfg(test)]
mod tests;
