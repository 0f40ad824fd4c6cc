//! Progress bars on stderr if it is a terminal.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use antumbra_lab::progress::Progress;
use indicatif::{ProgressBar, ProgressStyle};

use crate::tell;

/// Progress bar, one at a time. Prints only notes if stderr is no terminal, and nothing in quiet mode.
#[derive(Debug)]
pub struct Bars {
    current: Mutex<Option<ProgressBar>>,
    is_quiet: bool,
}

impl Bars {
    /// Creates bars that print notes and progress, or nothing if `is_quiet`.
    pub fn new(is_quiet: bool) -> Self {
        Self { current: Mutex::new(None), is_quiet }
    }

    fn with_current(&self, act: impl FnOnce(&mut Option<ProgressBar>)) {
        act(&mut self.current.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Progress for Bars {
    fn begin(&self, stage: &str, steps: u64) {
        if self.is_quiet {
            return;
        }
        let bar = if steps > 1 { ProgressBar::new(steps) } else { ProgressBar::new_spinner() };
        let template = if steps > 1 {
            "{msg:32!} {bar:30} {percent:>3} %  {elapsed} of about {duration}"
        } else {
            "{msg:32!} {spinner} {elapsed}"
        };
        // The template is constant and parses; a plain bar is an acceptable fallback.
        bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(stage.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        self.with_current(|current| {
            if let Some(previous) = current.replace(bar) {
                previous.finish_and_clear();
            }
        });
    }

    fn reach(&self, done: u64) {
        self.with_current(|current| {
            if let Some(bar) = current {
                bar.set_position(done);
            }
        });
    }

    fn end(&self) {
        self.with_current(|current| {
            if let Some(bar) = current.take() {
                bar.finish_and_clear();
            }
        });
    }

    fn note(&self, text: &str) {
        if self.is_quiet {
            return;
        }
        self.with_current(|current| match current {
            Some(bar) => bar.suspend(|| tell(&text)),
            None => tell(&text),
        });
    }
}
