//! [`Script`]: what is done to a simulated machine, and when.

use super::Act;
use core::fmt;
use core::time::Duration;
use std::collections::VecDeque;

/// What is done to a machine at which of its times: a line each, seconds and an [`Act`]. Blank lines and
/// those that begin with `#` say nothing.
///
/// ```
/// # use plotter_replay::simulation::Script;
/// # use std::time::Duration;
/// let mut script = Script::parse("# a hand in the way\n2.5 hold x\n3 let x\n")?;
/// assert_eq!(script.next_at(), Some(Duration::from_millis(2500)));
/// assert_eq!(script.due(Duration::from_secs(3)).count(), 2);
/// let error = Script::parse("1 hold x\n0.5 let x\n").unwrap_err();
/// assert_eq!(error.to_string(), "line 2: 0.5 s comes before the line above it");
/// # Ok::<(), plotter_replay::simulation::ScriptError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    acts: VecDeque<(Duration, Act)>,
}

/// A script that is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    /// The line, from 1.
    pub line: usize,
    /// The fault of the line.
    pub message: String,
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl core::error::Error for ScriptError {}

/// Latest time of a script, s: eleven days, longer than any drawing takes.
const LATEST_S: f64 = 1e6;

impl Script {
    /// Reads it.
    ///
    /// # Errors
    ///
    /// [`ScriptError`] for the first line that is none.
    pub fn parse(text: &str) -> Result<Self, ScriptError> {
        let mut acts: VecDeque<(Duration, Act)> = VecDeque::new();
        for (line, text) in (1..).zip(text.lines()) {
            let text = text.trim();
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let wrong = |message: String| ScriptError { line, message };
            let (time, act) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
            let seconds = time.parse().ok().filter(|seconds| (0.0..=LATEST_S).contains(seconds));
            let seconds: f64 = seconds.ok_or_else(|| {
                wrong(format!("expected seconds from 0 to {LATEST_S} and an act, found {time:?}"))
            })?;
            let at = Duration::from_secs_f64(seconds);
            if acts.back().is_some_and(|&(before, _)| at < before) {
                return Err(wrong(format!("{time} s comes before the line above it")));
            }
            acts.push_back((at, act.parse().map_err(|error: super::ActError| wrong(error.message))?));
        }
        Ok(Self { acts })
    }

    /// When the next act is due.
    #[must_use]
    pub fn next_at(&self) -> Option<Duration> {
        self.acts.front().map(|&(at, _)| at)
    }

    /// Takes out what is due by `now`.
    pub fn due(&mut self, now: Duration) -> impl Iterator<Item = Act> {
        let count = self.acts.iter().take_while(|&&(at, _)| at <= now).count();
        self.acts.drain(..count).map(|(_, act)| act)
    }
}
