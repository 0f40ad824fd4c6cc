//! Warnings that are logged once.

use std::collections::HashSet;
use std::fmt::Display;

use bevy::prelude::*;

/// Lines that were logged.
#[derive(Resource, Default)]
pub struct Warnings {
    said: HashSet<String>,
}

impl Warnings {
    /// Logs a line once.
    pub fn say(&mut self, line: impl Display) {
        let line = line.to_string();
        if self.said.contains(&line) {
            return;
        }
        warn!("bevy_antumbra: {line}");
        self.said.insert(line);
    }

    /// Logs the error of a failed operation.
    pub fn of<E: Display>(&mut self, outcome: Result<(), E>) {
        if let Err(error) = outcome {
            self.say(error);
        }
    }
}
