//! Ours: a fast scan over each mark, then a slow one each way.

use super::{Ask, Search, SearchError, place};
use crate::{BothEdges, Crossing, FindLine, Found, Optics, Passed, Tact, found_at};
use alloc::vec::Vec;
use plotter_motion::Point;

/// Most things that are kept of one crossing; more dust than that is no mark.
const MOST_PASSED: usize = 16;

/// Two fast sightings this near to each other are visited by one slow pass, mm: a line's own width and some.
const VISITED_MM: f64 = 1.2;

/// How the marks are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct SearchSettings {
    /// The optical head.
    pub optics: Optics,
    /// How far to both sides of its expected place a mark is looked for, mm.
    pub window_mm: f64,
    /// Speed of the first pass, mm/s.
    pub fast_mm_s: f64,
    /// Speed of the passes over what the first one saw, mm/s.
    pub slow_mm_s: f64,
    /// How far to both sides of it they go, mm.
    pub slow_window_mm: f64,
    /// Least number of crossings at which something must be found.
    pub least_found: usize,
}

impl Default for SearchSettings {
    /// The published sensing speed, then a twentieth of it over 1.8 mm, each way, a quarter of a second in all; 12 mm are twice the greatest error of rewinding and what
    /// a turn of 0.002 rad adds over 1000 mm.
    fn default() -> Self {
        Self {
            optics: Optics::default(),
            window_mm: 12.0,
            fast_mm_s: 300.0,
            slow_mm_s: 15.0,
            slow_window_mm: 0.9,
            least_found: 6,
        }
    }
}

/// Looks for the mark of each crossing: a fast pass over the whole window, then slow passes forth and back over what it
/// saw. If that turns out to be no line, the next thing that the fast pass saw is visited. A mark that is not found is left out; the
/// others will do.
///
/// The example is with [`SensedJoint`](crate::SensedJoint).
#[derive(Clone, Debug, PartialEq)]
pub struct MarkSearch {
    settings: SearchSettings,
    span_mm: f64,
    crossings: Vec<Crossing>,
    step: Step,
    /// Which crossing is being looked at.
    at: usize,
    edges: BothEdges,
    passed: Vec<Passed>,
    /// What the fast pass saw and no slow one has visited yet, mm.
    to_visit_mm: Vec<f64>,
    found: Vec<Found>,
    found_crossings: usize,
    first_missed: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Travel,
    Fast,
    SlowTravel { about_mm: f64 },
    SlowForth { about_mm: f64 },
    SlowBack { about_mm: f64 },
    Done,
}

impl MarkSearch {
    /// For these crossings, in their order.
    #[must_use]
    pub fn new(crossings: &[Crossing], settings: SearchSettings) -> Self {
        let span_mm = settings.optics.span_mm();
        Self {
            settings,
            span_mm,
            crossings: crossings.to_vec(),
            step: if crossings.is_empty() { Step::Done } else { Step::Travel },
            at: 0,
            edges: BothEdges::with_span(&settings.optics, settings.fast_mm_s, span_mm),
            passed: Vec::with_capacity(MOST_PASSED),
            to_visit_mm: Vec::with_capacity(MOST_PASSED),
            found: Vec::with_capacity(crossings.len()),
            found_crossings: 0,
            first_missed: None,
        }
    }

    /// The places that were found, at each crossing none or more.
    ///
    /// # Errors
    ///
    /// [`SearchError::NotDone`] before the search is over, [`SearchError::TooFew`] with the first missed mark if too few
    /// were found.
    pub fn found(&self) -> Result<&[Found], SearchError> {
        if self.step != Step::Done {
            return Err(SearchError::NotDone);
        }
        let missed = self.first_missed.and_then(|index| Some((index, *self.crossings.get(index)?)));
        match missed {
            Some((first_missed, crossing)) if self.found_crossings < self.settings.least_found => {
                Err(SearchError::TooFew {
                    found: self.found_crossings,
                    crossings: self.crossings.len(),
                    first_missed,
                    crossing,
                })
            }
            _ => Ok(&self.found),
        }
    }

    fn velocity_mm_s(&self) -> f64 {
        match self.step {
            Step::SlowForth { .. } => self.settings.slow_mm_s,
            Step::SlowBack { .. } => -self.settings.slow_mm_s,
            _ => self.settings.fast_mm_s,
        }
    }

    fn keep(&mut self, sighting: Option<crate::Sighting>) {
        let Some(sighting) = sighting else { return };
        if self.passed.len() >= MOST_PASSED {
            return;
        }
        self.passed.push(Passed { velocity_mm_s: self.velocity_mm_s(), sighting });
        let is_near = |at_mm: &f64| libm::fabs(at_mm - sighting.at_mm) < VISITED_MM / 2.0;
        if self.step == Step::Fast && sighting.like_a_line && !self.to_visit_mm.iter().any(is_near) {
            self.to_visit_mm.push(sighting.at_mm);
        }
    }

    /// The next thing to visit, or the next crossing.
    fn go_on(&mut self) {
        let slow_saw_a_line = self.passed.iter().any(|pass| {
            pass.sighting.like_a_line && libm::fabs(pass.velocity_mm_s) < self.settings.fast_mm_s
        });
        if !slow_saw_a_line && !self.to_visit_mm.is_empty() {
            self.step = Step::SlowTravel { about_mm: self.to_visit_mm.remove(0) };
            return;
        }
        let before = self.found.len();
        self.found.extend(found_at(self.at, &self.settings.optics, &self.passed));
        if self.found.len() > before {
            self.found_crossings += 1;
        } else {
            self.first_missed.get_or_insert(self.at);
        }
        self.passed.clear();
        self.to_visit_mm.clear();
        self.at += 1;
        self.step = if self.at < self.crossings.len() { Step::Travel } else { Step::Done };
    }
}

impl Search for MarkSearch {
    fn ask(&self) -> Ask {
        let Some(crossing) = self.crossings.get(self.at) else { return Ask::Done };
        let (window_mm, slow_mm) = (self.settings.window_mm, self.settings.slow_window_mm);
        let scan = |from_mm: f64, to_mm: f64| Ask::Scan {
            crossing: self.at,
            from: place(crossing, from_mm),
            axis: crossing.axis,
            to_mm,
            velocity_mm_s: self.velocity_mm_s(),
        };
        let travel = |to: Point| Ask::Travel { to };
        match self.step {
            Step::Travel => travel(place(crossing, crossing.mark_mm - window_mm)),
            Step::Fast => scan(crossing.mark_mm - window_mm, crossing.mark_mm + window_mm),
            Step::SlowTravel { about_mm } => travel(place(crossing, about_mm - slow_mm)),
            Step::SlowForth { about_mm } => scan(about_mm - slow_mm, about_mm + slow_mm),
            Step::SlowBack { about_mm } => scan(about_mm + slow_mm, about_mm - slow_mm),
            Step::Done => Ask::Done,
        }
    }

    fn tact(&mut self, tact: Tact) -> Result<(), SearchError> {
        if !matches!(self.step, Step::Fast | Step::SlowForth { .. } | Step::SlowBack { .. }) {
            return Ok(());
        }
        let sighting = self.edges.push(tact).map_err(|error| SearchError::Tact { index: self.at, error })?;
        self.keep(sighting);
        Ok(())
    }

    fn arrived(&mut self) -> Result<(), SearchError> {
        let last = self.edges.finish();
        self.keep(last);
        match self.step {
            Step::Travel => self.step = Step::Fast,
            Step::SlowTravel { about_mm } => self.step = Step::SlowForth { about_mm },
            Step::SlowForth { about_mm } => self.step = Step::SlowBack { about_mm },
            Step::Fast | Step::SlowBack { .. } => self.go_on(),
            Step::Done => {}
        }
        self.edges = BothEdges::with_span(&self.settings.optics, self.velocity_mm_s(), self.span_mm);
        Ok(())
    }
}
