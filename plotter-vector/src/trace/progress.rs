//! [`Progress`]: how far long work has come, and a way to stop it.

use core::fmt;
use core::ops::ControlFlow;

/// Reports no more often than once each thousandth of the work, so that it may be told of every row.
const STEP: f64 = 1e-3;

/// Long work was stopped by the one who asked for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cancelled {
    /// How far it had come, 0 to 1.
    pub done: f64,
}

impl fmt::Display for Cancelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cancelled after {:.0} % of the work", 100.0 * self.done)
    }
}

impl core::error::Error for Cancelled {}

/// How far long work has come: tells a function the done part, from 0 to 1, and lets it stop the work.
///
/// The part never falls, and the function is asked about a thousand times in all. Work of several passes
/// gives each its [`part`](Progress::part) of the whole.
///
/// ```
/// use core::ops::ControlFlow;
/// use plotter_vector::{Progress, trace::Cancelled};
///
/// fn work(mut progress: Progress<'_>) -> Result<(), Cancelled> {
///     let mut histogram = progress.part(0.25); // the first quarter
///     for row in 0..10 {
///         histogram.at(row, 10)?;
///     }
///     let mut tracing = progress.part(1.0); // the rest
///     for row in 0..10 {
///         tracing.at(row, 10)?;
///     }
///     progress.at(1, 1)
/// }
///
/// assert_eq!(work(Progress::silent()), Ok(()));
/// let mut stop = |done: f64| if done > 0.3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
/// let error = work(Progress::new(&mut stop)).unwrap_err();
/// assert_eq!(error.to_string(), "cancelled after 32 % of the work"); // 0.25 + 0.75 · 1/10
/// ```
pub struct Progress<'a> {
    report: Option<&'a mut (dyn FnMut(f64) -> ControlFlow<()> + Send)>,
    /// The part of the whole that this work is.
    from: f64,
    to: f64,
    /// Where the next part begins.
    given: f64,
    /// What was told last.
    told: f64,
}

impl fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from, to, told, .. } = self;
        f.debug_struct("Progress")
            .field("from", from)
            .field("to", to)
            .field("told", told)
            .finish_non_exhaustive()
    }
}

impl Default for Progress<'_> {
    fn default() -> Self {
        Self::silent()
    }
}

impl<'a> Progress<'a> {
    /// Tells `report` the done part, 0 to 1; [`ControlFlow::Break`] stops the work.
    pub fn new(report: &'a mut (dyn FnMut(f64) -> ControlFlow<()> + Send)) -> Self {
        Self { report: Some(report), ..Self::silent() }
    }

    /// Tells nobody and never stops.
    #[must_use]
    pub const fn silent() -> Self {
        Self { report: None, from: 0.0, to: 1.0, given: 0.0, told: f64::NEG_INFINITY }
    }

    /// `done` of `of` rows (or of anything else) are done; all are when `of` is 0.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn at(&mut self, done: u64, of: u64) -> Result<(), Cancelled> {
        let Some(report) = &mut self.report else { return Ok(()) };
        #[expect(clippy::cast_precision_loss, reason = "a part of the whole, told to a person")]
        let part = if of == 0 { 1.0 } else { (done as f64 / of as f64).min(1.0) };
        let whole = self.from + (self.to - self.from) * part;
        // The end is always told; the same place twice, or one farther back, never.
        let last = part >= 1.0 && whole > self.told;
        if whole < self.told + STEP && !last {
            return Ok(());
        }
        self.told = whole;
        if report(whole).is_break() { Err(Cancelled { done: whole }) } else { Ok(()) }
    }

    /// The next part of this work, up to the place `to` in it (0 to 1), as a work of its own.
    pub fn part(&mut self, to: f64) -> Progress<'_> {
        let start = self.from + (self.to - self.from) * self.given;
        // A NaN counts as 1: `min` gives the other one.
        self.given = to.min(1.0).max(self.given);
        let end = self.from + (self.to - self.from) * self.given;
        let report: Option<&mut (dyn FnMut(f64) -> ControlFlow<()> + Send)> = match &mut self.report {
            Some(report) => Some(&mut **report),
            None => None,
        };
        Progress { report, from: start, to: end, given: 0.0, told: f64::NEG_INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told by some work.
    fn told(work: impl FnOnce(Progress<'_>) -> Result<(), Cancelled>) -> Vec<f64> {
        let mut told = Vec::new();
        let mut report = |done| {
            told.push(done);
            ControlFlow::Continue(())
        };
        work(Progress::new(&mut report)).unwrap();
        told
    }

    #[test]
    fn a_million_rows_are_told_a_thousand_times() {
        let told = told(|mut progress| (0..=1_000_000).try_for_each(|row| progress.at(row, 1_000_000)));
        assert!((1000..=1002).contains(&told.len()), "{}", told.len());
        assert!(told.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((told.first(), told.last()), (Some(&0.0), Some(&1.0)));
    }

    #[test]
    fn parts_follow_each_other_and_parts_of_parts_too() {
        let told = told(|mut progress| {
            let mut first = progress.part(0.5);
            first.part(0.5).at(1, 1)?;
            first.part(1.0).at(1, 2)?;
            progress.part(0.75).at(1, 1)?;
            progress.part(0.25).at(1, 1)?; // nothing is left before 0.75
            progress.part(f64::NAN).at(1, 1)?;
            progress.part(1.0).at(0, 0)
        });
        assert_eq!(told, [0.25, 0.375, 0.75, 0.75, 1.0, 1.0]);
    }

    #[test]
    fn cancelled_work_says_how_far_it_came() {
        let mut calls = 0;
        let mut stop = |done: f64| {
            calls += 1;
            if done >= 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut progress = Progress::new(&mut stop);
        let end = (0..4).try_for_each(|row| progress.at(row, 4));
        assert_eq!(end, Err(Cancelled { done: 0.5 }));
        assert_eq!(calls, 3); // 0, 1 and 2 quarters
    }

    #[test]
    fn silence_is_kept_in_every_part() {
        let mut progress = Progress::silent();
        assert_eq!(progress.part(0.5).at(1, 0), Ok(()));
        assert_eq!(progress.at(7, 3), Ok(()));
    }
}
