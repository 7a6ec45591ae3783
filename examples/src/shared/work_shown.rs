//! [`WorkShown`]: how far work has come and how long it still takes, where it takes longer than a second.

use super::telling::Telling;
use core::time::Duration;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Once;

/// Work that is done sooner shows nothing: a line that comes and goes at once is only a flicker.
const PATIENCE: Duration = Duration::from_secs(1);

/// How often a line whose work has no known end shows that it is still done.
const TICK: Duration = Duration::from_millis(200);

/// A line about work on the standard error, where that is a terminal, after the first second of it.
#[derive(Debug)]
pub struct WorkShown {
    bar: ProgressBar,
    is_quiet: bool,
    shown: Once,
}

impl WorkShown {
    /// Of `all` parts that are called `unit`; the time left is told.
    #[must_use]
    pub fn of(telling: Telling, what: &str, all: u64, unit: &str) -> Self {
        let template = format!("{what} {{bar:30}} {{pos}}/{{len}} {unit}, {{elapsed}}, {{eta}} left");
        Self::with_template(telling, Some(all), &template)
    }

    /// Of bytes of a file; the time left is told.
    #[must_use]
    pub fn of_bytes(telling: Telling, what: &str, all: u64) -> Self {
        let template = format!("{what} {{bar:30}} {{bytes}}/{{total_bytes}}, {{elapsed}}, {{eta}} left");
        Self::with_template(telling, Some(all), &template)
    }

    /// Of work whose end nobody knows: how much is done, and for how long.
    #[must_use]
    pub fn endless(telling: Telling, what: &str, unit: &str) -> Self {
        Self::with_template(telling, None, &format!("{what}: {{pos}} {unit}, {{elapsed}}"))
    }

    /// Of several works one after the other, each of which is said by [`say`](Self::say).
    #[must_use]
    pub fn said(telling: Telling) -> Self {
        Self::with_template(telling, None, "{spinner} {msg}, {elapsed}")
    }

    fn with_template(telling: Telling, all: Option<u64>, template: &str) -> Self {
        let bar = ProgressBar::with_draw_target(all, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar, is_quiet: telling.is_quiet(), shown: Once::new() }
    }

    /// So much is done.
    pub fn set(&self, done: u64) {
        self.bar.set_position(done);
        self.show();
    }

    /// One part more is done.
    pub fn next(&self) {
        self.bar.inc(1);
        self.show();
    }

    /// What is done from now on.
    pub fn say(&self, what: &'static str) {
        self.bar.set_message(what);
        self.show();
    }

    /// It is over; nothing of it is left to be seen.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self) {
        if !self.is_quiet && self.bar.elapsed() >= PATIENCE {
            self.shown.call_once(|| {
                // Where the standard error is no terminal this draws nothing.
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
                self.bar.enable_steady_tick(TICK);
            });
        }
    }
}
