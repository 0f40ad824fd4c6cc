//! Claims of papers by their tables and figures, as rules over an exhibit's rows.
//!
//! A claim holds where all of its rules do. A rule speaks of rows by name and is printed beside its verdict, so that whoever
//! reads "holds" sees what would have been "contradicted". Each rule is judged twice, over its rows as published and over ours.

use super::figure::Figure;

/// A claim of a paper.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// What the paper says, in short.
    pub says: &'static str,
    /// What must be measured for it to hold: all of these. Empty where nothing here can show it.
    pub rules: &'static [Rule],
    /// Whether times of a software renderer may decide it.
    pub on_any_adapter: bool,
    /// Why it was found contradicted as published, where that is known; empty where it is not.
    pub because: &'static str,
    /// Why it was found contradicted by our form, where that is known.
    pub because_ours: &'static str,
    /// Why nothing here can show it, and what would; empty where there are rules.
    pub needs: &'static str,
}

impl Claim {
    /// Times of a software renderer decide it too: it is of how work grows, which is alike on any adapter.
    pub(super) const fn on_any_adapter(self) -> Self {
        Self { on_any_adapter: true, ..self }
    }

    /// Why it was found contradicted.
    pub(super) const fn because(self, because: &'static str) -> Self {
        Self { because, ..self }
    }

    /// Why it was found contradicted by both forms.
    pub(super) const fn because_both(self, because: &'static str) -> Self {
        Self { because, because_ours: because, ..self }
    }

    /// Why it was found contradicted by our form.
    pub(super) const fn because_ours(self, because_ours: &'static str) -> Self {
        Self { because_ours, ..self }
    }
}

/// A claim that holds where all of `rules` do.
pub(super) const fn claim(says: &'static str, rules: &'static [Rule]) -> Claim {
    Claim { says, rules, on_any_adapter: false, because: "", because_ours: "", needs: "" }
}

/// A claim that nothing here can show: why, and what would.
pub(super) const fn not_here(says: &'static str, needs: &'static str) -> Claim {
    Claim { needs, ..claim(says, &[]) }
}

/// A condition on what rows measured.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// A row's figure is at most this.
    AtMost(Figure, &'static str, f64),
    /// A row's figure is at least this.
    AtLeast(Figure, &'static str, f64),
    /// A row's figure, divided by another row's, is at most this.
    RatioAtMost(Figure, &'static str, &'static str, f64),
    /// A row's figure, divided by another row's, is at least this.
    RatioAtLeast(Figure, &'static str, &'static str, f64),
    /// A row's figure, divided by another row's, lies between these: not less, and not more.
    RatioWithin(Figure, &'static str, &'static str, [f64; 2]),
    /// Each of these rows has a larger figure than the one before it.
    Rising(Figure, &'static [&'static str]),
    /// The largest figure of these rows is at most so many times the smallest.
    Alike(Figure, &'static [&'static str], f64),
}

impl Rule {
    /// Of what it speaks.
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

    /// The rows that it speaks of.
    pub fn rows(&self) -> Vec<&'static str> {
        match self {
            Self::AtMost(_, row, _) | Self::AtLeast(_, row, _) => vec![row],
            Self::RatioAtMost(_, row, to, _) | Self::RatioAtLeast(_, row, to, _) | Self::RatioWithin(_, row, to, _) => {
                vec![row, to]
            }
            Self::Rising(_, rows) | Self::Alike(_, rows, _) => rows.to_vec(),
        }
    }

    /// The rows that it finds good: images there have to be better than one without any shadow in it, or a black, white or grey
    /// one would do. Rules that find something wanting name none.
    pub fn favored(&self) -> Vec<&'static str> {
        match self {
            _ if !self.figure().is_of_images() => Vec::new(),
            Self::AtMost(_, row, _) | Self::RatioAtMost(_, row, ..) | Self::RatioWithin(_, row, ..) => vec![row],
            Self::Rising(_, rows) => rows[..1].to_vec(),
            Self::Alike(_, rows, _) => rows.to_vec(),
            Self::AtLeast(..) | Self::RatioAtLeast(..) => Vec::new(),
        }
    }

    /// The rule in words, without what was measured.
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
