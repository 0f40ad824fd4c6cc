//! Claims of papers about their tables and figures, as rules over an exhibit's rows.
//!
//! A claim holds if all its rules do. A rule names rows and is printed beside its verdict, so that readers of "holds" see which result
//! would be "contradicted". Each rule is judged twice, for the rows as published and for ours.

use super::figure::Figure;

/// A claim of a paper.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Summary of the paper's statement.
    pub says: &'static str,
    /// Rules that must all be met; empty if nothing here can show the claim.
    pub rules: &'static [Rule],
    /// Whether times of a software renderer may decide the claim.
    pub on_any_adapter: bool,
    /// Known reason of a contradiction as published; empty if unknown.
    pub because: &'static str,
    /// Known reason of a contradiction in our form; empty if unknown.
    pub because_ours: &'static str,
    /// What would decide the claim where its figures are too close to tell, found by a larger run; empty if that was not tried.
    pub if_too_close: &'static str,
    /// Reason why nothing here can show the claim, and what would; empty if there are rules.
    pub needs: &'static str,
}

impl Claim {
    /// Lets times of a software renderer decide the claim, because it is about the growth of work, which is alike on any adapter.
    pub(super) const fn on_any_adapter(self) -> Self {
        Self { on_any_adapter: true, ..self }
    }

    /// Sets the reason of a contradiction as published.
    pub(super) const fn because(self, because: &'static str) -> Self {
        Self { because, ..self }
    }

    /// Sets the reason of a contradiction in both forms.
    pub(super) const fn because_both(self, because: &'static str) -> Self {
        Self { because, because_ours: because, ..self }
    }

    /// Sets the reason of a contradiction in our form.
    pub(super) const fn because_ours(self, because_ours: &'static str) -> Self {
        Self { because_ours, ..self }
    }

    /// Sets what would decide the claim where its figures are too close to tell.
    pub(super) const fn if_too_close(self, if_too_close: &'static str) -> Self {
        Self { if_too_close, ..self }
    }
}

/// Creates a claim that holds if all `rules` do.
pub(super) const fn claim(says: &'static str, rules: &'static [Rule]) -> Claim {
    Claim { says, rules, on_any_adapter: false, because: "", because_ours: "", if_too_close: "", needs: "" }
}

/// Creates a claim that nothing here can show, with the reason and what would show it.
pub(super) const fn not_here(says: &'static str, needs: &'static str) -> Claim {
    Claim { needs, ..claim(says, &[]) }
}

/// Condition on the figures of rows.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// A row's figure is at most the bound.
    AtMost(Figure, &'static str, f64),
    /// A row's figure is at least the bound.
    AtLeast(Figure, &'static str, f64),
    /// The ratio of a row's figure to another row's is at most the bound.
    RatioAtMost(Figure, &'static str, &'static str, f64),
    /// The ratio of a row's figure to another row's is at least the bound.
    RatioAtLeast(Figure, &'static str, &'static str, f64),
    /// The ratio of a row's figure to another row's is within the bounds.
    RatioWithin(Figure, &'static str, &'static str, [f64; 2]),
    /// Figures increase from row to row.
    Rising(Figure, &'static [&'static str]),
    /// The ratio of the largest to the smallest figure of the rows is at most the bound.
    Alike(Figure, &'static [&'static str], f64),
}

impl Rule {
    /// Returns the figure of the rule.
    pub fn figure(&self) -> Figure {
        match self {
            Self::AtMost(figure, ..)
            | Self::AtLeast(figure, ..)
            | Self::RatioAtMost(figure, ..)
            | Self::RatioAtLeast(figure, ..)
            | Self::RatioWithin(figure, ..)
            | Self::Rising(figure, _)
            | Self::Alike(figure, ..) => *figure,
        }
    }

    /// Returns the names of the rule's rows.
    pub fn rows(&self) -> Vec<&'static str> {
        match self {
            Self::AtMost(_, row, _) | Self::AtLeast(_, row, _) => vec![row],
            Self::RatioAtMost(_, row, to, _) | Self::RatioAtLeast(_, row, to, _) | Self::RatioWithin(_, row, to, _) => {
                vec![row, to]
            }
            Self::Rising(_, rows) | Self::Alike(_, rows, _) => rows.to_vec(),
        }
    }

    /// Returns the rows that the rule praises. Their images must be better than one without any shadow, or else a black, white or grey
    /// image would meet the rule. Rules that criticise return none.
    pub fn favored(&self) -> Vec<&'static str> {
        match self {
            _ if !self.figure().is_of_images() => Vec::new(),
            Self::AtMost(_, row, _) | Self::RatioAtMost(_, row, ..) | Self::RatioWithin(_, row, ..) => vec![row],
            Self::Rising(_, rows) => rows[..1].to_vec(),
            Self::Alike(_, rows, _) => rows.to_vec(),
            Self::AtLeast(..) | Self::RatioAtLeast(..) => Vec::new(),
        }
    }

    /// Describes the rule without measured values.
    pub fn text(&self) -> String {
        let figure = self.figure();
        let list = |rows: &[&str]| rows.iter().map(|row| format!("‘{row}’")).collect::<Vec<_>>().join(", ");
        match self {
            Self::AtMost(_, row, bound) => format!("{figure} of ‘{row}’ is at most {bound}"),
            Self::AtLeast(_, row, bound) => format!("{figure} of ‘{row}’ is at least {bound}"),
            Self::RatioAtMost(_, row, to, bound) => {
                format!("{figure} of ‘{row}’ is at most {bound} times that of ‘{to}’")
            }
            Self::RatioAtLeast(_, row, to, bound) => {
                format!("{figure} of ‘{row}’ is at least {bound} times that of ‘{to}’")
            }
            Self::RatioWithin(_, row, to, [low, high]) => {
                format!("{figure} of ‘{row}’ is {low} to {high} times that of ‘{to}’")
            }
            Self::Rising(_, rows) => format!("{figure} rises from each of {} to the next", list(rows)),
            Self::Alike(_, rows, bound) => format!("{figure} of {} differs by a factor of at most {bound}", list(rows)),
        }
    }
}
