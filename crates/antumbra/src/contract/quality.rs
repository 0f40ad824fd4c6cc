//! How much a technique may spend: named sets of its parameters.

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
}

impl Quality {
    /// From the cheapest to the dearest.
    pub const ALL: [Self; 4] = [Self::Fast, Self::Balanced, Self::High, Self::Best];

    /// The name that command lines and files use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::High => "high",
            Self::Best => "best",
        }
    }

    /// The step of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name() == name)
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
