//! Qualities: named sets of a technique's parameters, from fast to best, and as published.

use std::fmt;

/// How much a technique may spend. Each step is a set of its parameters, chosen from measured fronts of error against time;
/// single parameters may be set after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quality {
    /// What a game with many lights can spend.
    Fast,
    /// The defaults: what is left of the error is hard to see.
    #[default]
    Balanced,
    /// Twice to four times the time for what error that takes away.
    High,
    /// The least error that the technique's parameters reach, whatever the time: for stills, and to compare with.
    Best,
    /// No step of the ladder: the algorithm as its paper prints it, to compare with; see [`Printed`]. Techniques that do not follow one paper
    /// closely have no such setting.
    Paper,
}

impl Quality {
    /// All qualities: the ladder, then the paper's.
    pub const ALL: [Self; 5] = [Self::Fast, Self::Balanced, Self::High, Self::Best, Self::Paper];
    /// The ladder, from the cheapest to the most expensive.
    pub const LADDER: [Self; 4] = [Self::Fast, Self::Balanced, Self::High, Self::Best];

    /// Name in command lines and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::High => "high",
            Self::Best => "best",
            Self::Paper => "paper",
        }
    }

    /// Quality of this name, in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name().eq_ignore_ascii_case(name))
    }
}

/// A technique as its paper prints it: what of ours [`Quality::Paper`] turns off, and what nothing turns off.
#[derive(Clone, Copy, Debug)]
pub struct Printed {
    /// Departures that a parameter turns off.
    pub departures: &'static [Departure],
    /// Departures that nothing turns off.
    pub kept: &'static [&'static str],
}

/// Departure of a technique from its paper.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Parameter that turns it off; [`Quality::Paper`] has the value.
    pub key: &'static str,
    /// What the default does in place of the paper's algorithm.
    pub ours: &'static str,
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
