//! What goes wrong, said once.

use std::collections::HashSet;
use std::fmt::Display;

use bevy::prelude::*;

/// The lines that were said.
#[derive(Resource, Default)]
pub struct Warnings {
    said: HashSet<String>,
}

impl Warnings {
    /// Says a line, unless it was said.
    pub fn say(&mut self, line: impl Display) {
        let line = line.to_string();
        if self.said.contains(&line) {
            return;
        }
        warn!("bevy_antumbra: {line}");
        self.said.insert(line);
    }

    /// Says why something failed.
    pub fn of<E: Display>(&mut self, outcome: Result<(), E>) {
        if let Err(error) = outcome {
            self.say(error);
        }
    }
}
