//! Qualities: named sets of a technique's parameters, from fast to best, and as published.

use std::fmt;

/// Quality of a technique: a set of its parameters, chosen from measured fronts of error against time. Single parameters may be set
/// afterwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quality {
    /// Cost that a game with many lights can afford.
    Fast,
    /// The defaults: the remaining error is hard to see.
    #[default]
    Balanced,
    /// Less error for two to four times the time.
    High,
    /// Least error that the technique's parameters reach, regardless of time: for stills and comparison.
    Best,
    /// The algorithm as published, for comparison; not on the ladder. See [`PublishedForm`](super::PublishedForm). Techniques that
    /// do not follow one paper closely have no such setting.
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

    /// Quality of this name; case-insensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name().eq_ignore_ascii_case(name))
    }
}

/// Departures of a technique from its paper: those that [`Quality::Paper`] turns off, and those that nothing turns off.
#[derive(Clone, Copy, Debug)]
pub struct PublishedForm {
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
