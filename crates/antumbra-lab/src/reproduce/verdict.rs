//! Verdicts on claims, from what was measured.
//!
//! Where a rule lacks a number nothing is decided, and the reason is said; nor does a software renderer decide about a GPU's
//! milliseconds, unless the claim is of work that grows alike on any.

use super::claim::{Claim, Rule};
use super::exhibit::Exhibit;
use super::figure::Figure;
use super::outcome::Outcome;

/// What is to be said of a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every rule is met.
    Holds,
    /// A rule is not met.
    Contradicted,
    /// Nothing can be said: why.
    Undecided(String),
}

impl Verdict {
    /// For tables and pages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Contradicted => "contradicted",
            Self::Undecided(_) => "not shown here",
        }
    }
}

/// A claim after measuring.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The claim.
    pub claim: Claim,
    /// What is to be said of it.
    pub verdict: Verdict,
    /// Each of its rules in words, with what was measured.
    pub found: Vec<String>,
}

impl Judged {
    /// The verdict as a sentence, with its reason where there is one.
    pub fn sentence(&self) -> String {
        match &self.verdict {
            Verdict::Holds => "The claim holds here.".to_owned(),
            Verdict::Contradicted if self.claim.because.is_empty() => "The claim is contradicted here.".to_owned(),
            Verdict::Contradicted => format!("The claim is contradicted here: {}", self.claim.because),
            Verdict::Undecided(why) => format!("Not shown here: {why}."),
        }
    }
}

/// Decides an exhibit's claims. `outcomes` are of its rows, in their order.
pub fn judge(exhibit: &Exhibit, outcomes: &[Outcome], is_software: bool) -> Vec<Judged> {
    exhibit.claims.iter().map(|claim| judge_claim(claim, exhibit, outcomes, is_software)).collect()
}

fn judge_claim(claim: &Claim, exhibit: &Exhibit, outcomes: &[Outcome], is_software: bool) -> Judged {
    let found: Vec<Found> = claim.rules.iter().map(|rule| look(rule, exhibit, outcomes)).collect();
    let lacks = found.iter().find_map(|found| found.is_met.as_ref().err());
    let is_of_time = claim.rules.iter().any(|rule| rule.figure() == Figure::Ms);
    let verdict = match lacks {
        Some(why) => Verdict::Undecided(why.clone()),
        None if is_of_time && is_software && !claim.on_any_adapter => {
            Verdict::Undecided("times of a software renderer say little about a GPU's".to_owned())
        }
        None if found.iter().all(|found| found.is_met == Ok(true)) => Verdict::Holds,
        None => Verdict::Contradicted,
    };
    Judged { claim: *claim, verdict, found: found.into_iter().map(|found| found.text).collect() }
}

/// What became of a rule.
struct Found {
    text: String,
    /// Or which number is lacking.
    is_met: Result<bool, String>,
}

/// A rule held against what was measured.
fn look(rule: &Rule, exhibit: &Exhibit, outcomes: &[Outcome]) -> Found {
    let values: Result<Vec<f64>, String> =
        rule.rows().iter().map(|row| value_of(rule.figure(), row, exhibit, outcomes)).collect();
    let values = match values {
        Ok(values) => values,
        Err(why) => return Found { text: rule.text(), is_met: Err(why) },
    };
    let all = values.iter().map(|v| rule.figure().text(*v)).collect::<Vec<_>>().join(", ");
    let (is_met, here) = match rule {
        Rule::AtMost(.., bound) => (values[0] <= *bound, all),
        Rule::AtLeast(.., bound) => (values[0] >= *bound, all),
        // By products, so that nothing is divided by.
        Rule::RatioAtMost(.., bound) => (values[0] <= bound * values[1], ratio_text(&values, &all)),
        Rule::RatioAtLeast(.., bound) => (values[0] >= bound * values[1], ratio_text(&values, &all)),
        Rule::Rising(..) => (values.is_sorted_by(|a, b| a < b), all),
        Rule::Alike(.., bound) => {
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = values.iter().copied().fold(0.0, f64::max);
            (most <= bound * least, all)
        }
    };
    Found { text: format!("{}: here {here}", rule.text()), is_met: Ok(is_met) }
}

fn ratio_text(values: &[f64], all: &str) -> String {
    if values[1] > 0.0 { format!("{:.2} ({all})", values[0] / values[1]) } else { all.to_owned() }
}

fn value_of(figure: Figure, row: &str, exhibit: &Exhibit, outcomes: &[Outcome]) -> Result<f64, String> {
    let found = exhibit.rows.iter().position(|one| one.what == row).and_then(|i| outcomes.get(i));
    match found {
        None => Err(format!("‘{row}’ was not run")),
        Some(Outcome::Measured(measured)) => match measured.figure(figure) {
            // Software renderers' clocks do: a ratio to it would say anything.
            Some(ms) if figure == Figure::Ms && ms <= 0.0 => Err(format!("‘{row}’ was timed as nothing")),
            found => found.ok_or_else(|| format!("‘{row}’ has no {figure} here")),
        },
        Some(other) => Err(format!("‘{row}’ is {other}")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::PAPERS;
    use super::super::claim::claim;
    use super::super::exhibit::{Measure, error};
    use super::super::outcome::Measured;
    use super::*;

    /// No claim about time speaks of a row that takes none.
    #[test]
    fn claims_about_time_are_of_rows_that_are_timed() {
        let exhibits = || PAPERS.iter().flat_map(|paper| paper.exhibits);
        let mut found = 0;
        for exhibit in exhibits() {
            let rules = exhibit.claims.iter().flat_map(|claim| claim.rules);
            for row in rules.filter(|rule| rule.figure() == Figure::Ms).flat_map(Rule::rows) {
                let measure = exhibit.rows.iter().find(|one| one.what == row).map(|one| one.measure);
                let is_of_time = |measure: Measure| {
                    measure.is_timed() || matches!(measure, Measure::SceneMs { .. } | Measure::Rays { .. })
                };
                assert!(measure.is_some_and(is_of_time), "{}: {row}", exhibit.id);
                found += 1;
            }
        }
        assert!(found > 50, "{found}");
    }

    const RULES: &[Rule] = &[Rule::RatioAtMost(Figure::Rmse, "a", "b", 0.5), Rule::AtMost(Figure::Rmse, "a", 0.1)];
    const TIMES: &[Rule] = &[Rule::RatioAtLeast(Figure::Ms, "b", "a", 10.0)];
    const EXHIBIT: Exhibit = Exhibit {
        id: "figure1",
        shows: "",
        rows: &[error("a", "builtin:overlap", "pcss"), error("b", "builtin:overlap", "hard")],
        claims: &[
            claim("a errs half as much", RULES).because("of the reason."),
            claim("a takes a tenth", TIMES),
            claim("a takes a tenth of the work", TIMES).on_any_adapter(),
        ],
        note: "",
    };

    fn measured(rmse: f64, ms: f64) -> Outcome {
        Outcome::Measured(Measured { rmse: Some(rmse), ms: Some(ms), ..Measured::default() })
    }

    fn verdicts(outcomes: &[Outcome], is_software: bool) -> Vec<Verdict> {
        judge(&EXHIBIT, outcomes, is_software).into_iter().map(|judged| judged.verdict).collect()
    }

    #[test]
    fn a_claim_holds_where_all_of_its_rules_do() {
        use Verdict::{Contradicted, Holds};
        let found = verdicts(&[measured(0.1, 1.0), measured(0.2, 10.0)], false);
        assert_eq!(found, [Holds, Holds, Holds]);
        // One rule of two is not enough; nor is nine times ten.
        let found = verdicts(&[measured(0.11, 1.0), measured(0.9, 9.0)], false);
        assert_eq!(found, [Contradicted, Contradicted, Contradicted]);
        let judged = judge(&EXHIBIT, &[measured(0.15, 1.0), measured(0.2, 9.0)], false);
        assert!(
            judged[0].found[0].ends_with("at most 0.5 times that of ‘b’: here 0.75 (0.1500, 0.2000)"),
            "{judged:?}"
        );
        assert_eq!(judged[0].sentence(), "The claim is contradicted here: of the reason.");
        assert_eq!(judged[1].sentence(), "The claim is contradicted here.");
    }

    #[test]
    fn a_software_renderer_decides_no_time_but_of_growth() {
        let found = verdicts(&[measured(0.1, 1.0), measured(0.2, 10.0)], true);
        assert!(matches!(&found[..], [Verdict::Holds, Verdict::Undecided(_), Verdict::Holds]), "{found:?}");
    }

    #[test]
    fn what_was_not_measured_decides_nothing() {
        let not_ready = Outcome::NotReady("sponza.glb".to_owned());
        let found = verdicts(&[not_ready, measured(0.2, 10.0)], false);
        assert!(matches!(&found[0], Verdict::Undecided(why) if why.contains("‘a’ is not ready")), "{found:?}");
        assert!(found.iter().all(|verdict| verdict.name() == "not shown here"));
        let none = Outcome::Measured(Measured::default());
        assert_eq!(verdicts(&[none.clone(), none], false)[0], Verdict::Undecided("‘a’ has no rmse here".into()));
        assert!(matches!(verdicts(&[], false)[0], Verdict::Undecided(_)));
        let found = verdicts(&[measured(0.1, 0.0), measured(0.2, 0.0)], false);
        assert_eq!(found[1..], [(); 2].map(|()| Verdict::Undecided("‘b’ was timed as nothing".into())));
    }

    #[test]
    fn orders_and_likeness() {
        let exhibit = |claims| Exhibit { claims, ..EXHIBIT };
        const RISING: &[Claim] = &[
            claim("", &[Rule::Rising(Figure::Rmse, &["a", "b"])]),
            claim("", &[Rule::Alike(Figure::Rmse, &["a", "b"], 1.5)]),
            claim("", &[Rule::AtLeast(Figure::Rmse, "b", 0.2)]),
        ];
        let of = |a, b| -> Vec<Verdict> {
            let outcomes = [measured(a, 1.0), measured(b, 1.0)];
            judge(&exhibit(RISING), &outcomes, true).into_iter().map(|judged| judged.verdict).collect()
        };
        use Verdict::{Contradicted, Holds};
        assert_eq!(of(0.2, 0.3), [Holds, Holds, Holds]);
        assert_eq!(of(0.2, 0.2), [Contradicted, Holds, Holds]);
        assert_eq!(of(0.19, 0.1), [Contradicted, Contradicted, Contradicted]);
    }
}
