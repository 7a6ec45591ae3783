//! Ours: a fast scan over each mark, then a slow one each way over what lies where the sheet has it.

use super::{Ask, Search, SearchError, line_width, place, shown_delays};
use crate::sense::crossing::{Delays, places};
use crate::{
    Crossing, FindLine, FrameTransform, Optics, RigidFit, Sighting,
    sense::{BothEdges, Found, Passed, Tact},
};
use alloc::vec;
use alloc::vec::Vec;
use plotter_motion::Point;

/// Most sightings that are kept of one crossing. It bounds memory; more dust than that hides any mark.
const MOST_PASSED: usize = 16;

/// A fast sighting this near to where the sheet has the mark is visited, mm: what a fast scan tells, and
/// smear and swelling.
const NEAR_MM: f64 = 0.8;

/// How the marks are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
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

impl SearchSettings {
    /// The same with another [`SearchSettings::optics`].
    #[must_use]
    pub const fn with_optics(self, optics: Optics) -> Self {
        Self { optics, ..self }
    }

    /// The same with another [`SearchSettings::window_mm`].
    #[must_use]
    pub const fn with_window_mm(self, window_mm: f64) -> Self {
        Self { window_mm, ..self }
    }

    /// The same with another [`SearchSettings::fast_mm_s`].
    #[must_use]
    pub const fn with_fast_mm_s(self, fast_mm_s: f64) -> Self {
        Self { fast_mm_s, ..self }
    }

    /// The same with another [`SearchSettings::slow_mm_s`].
    #[must_use]
    pub const fn with_slow_mm_s(self, slow_mm_s: f64) -> Self {
        Self { slow_mm_s, ..self }
    }

    /// The same with another [`SearchSettings::slow_window_mm`].
    #[must_use]
    pub const fn with_slow_window_mm(self, slow_window_mm: f64) -> Self {
        Self { slow_window_mm, ..self }
    }

    /// The same with another [`SearchSettings::least_found`].
    #[must_use]
    pub const fn with_least_found(self, least_found: usize) -> Self {
        Self { least_found, ..self }
    }
}

impl Default for SearchSettings {
    /// The published sensing speed, then a twentieth of it over 2.6 mm, each way, a third of a second in all:
    /// a line's half, and a delay of 2 ms in the first pass; 12 mm are the greatest error of rewinding, 4 mm
    /// that a turn of 0.002 rad adds over 2000 mm, and 3 mm to spare.
    fn default() -> Self {
        Self {
            optics: Optics::default(),
            window_mm: 12.0,
            fast_mm_s: 300.0,
            slow_mm_s: 15.0,
            slow_window_mm: 1.3,
            least_found: 6,
        }
    }
}

/// Looks for the mark of each crossing: a fast pass over all windows, then, at each crossing, slow passes
/// forth and back over what lies where most of what was seen has the sheet. Where the fast passes do not
/// tell, whatever they saw nearest to the expected places is visited. Slow passes may tell another place of
/// the sheet: what lies there and was not visited is visited then. A mark that is not found is left out; the
/// others will do.
///
/// Width of the line and the head's delays are taken from what was seen, not from the settings: see
/// [`found`](Self::found).
///
/// The example is with [`SensedJoint`](crate::sheet::SensedJoint).
#[derive(Clone, Debug, PartialEq)]
pub struct MarkSearch {
    settings: SearchSettings,
    span_mm: f64,
    crossings: Vec<Crossing>,
    step: Step,
    /// Which crossing is being looked at.
    at: usize,
    edges: BothEdges,
    /// What was seen at each crossing.
    passed: Vec<Vec<Passed>>,
    /// Where each is to be visited slowly, mm; none where nothing lies.
    to_visit_mm: Vec<Option<f64>>,
    /// Whether these are what the slow passes told to visit.
    is_second_round: bool,
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
            passed: vec![Vec::new(); crossings.len()],
            to_visit_mm: Vec::new(),
            is_second_round: false,
            found: Vec::with_capacity(crossings.len()),
            found_crossings: 0,
            first_missed: None,
        }
    }

    /// The places that were found, at each crossing none or more.
    ///
    /// What all passes have in common is taken from them: how long a line is seen is the median of all,
    /// whatever the pen's width; one that is seen longer is smeared to one side or the other, and is known by
    /// half of that less; delays of the head that differ between up and down show in passes of two speeds.
    ///
    /// # Errors
    ///
    /// [`SearchError::NotDone`] before the search is over, [`SearchError::TooFew`] with the first missed mark
    /// if too few were found.
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

    fn keep(&mut self, sighting: Option<Sighting>) {
        let velocity_mm_s = self.velocity_mm_s();
        let passed = self.passed.get_mut(self.at);
        if let Some((sighting, passed)) =
            sighting.zip(passed).filter(|(_, passed)| passed.len() < MOST_PASSED)
        {
            passed.push(Passed { velocity_mm_s, sighting });
        }
    }

    /// The next crossing: the fast pass over it, a slow visit, or the end.
    fn go_on(&mut self) {
        self.at += 1;
        if self.step == Step::Fast {
            if self.at < self.crossings.len() {
                self.step = Step::Travel;
                return;
            }
            self.to_visit_mm = self.visits();
            self.at = 0;
        }
        if self.go_to_visit() {
            return;
        }
        self.tell();
        if !core::mem::replace(&mut self.is_second_round, true) {
            self.to_visit_mm = self.second_visits();
            self.at = 0;
            if self.go_to_visit() {
                return;
            }
        }
        self.count_found();
        self.step = Step::Done;
    }

    /// On to the next crossing that is to be visited, if there is one.
    fn go_to_visit(&mut self) -> bool {
        while let Some(visit) = self.to_visit_mm.get(self.at) {
            if let Some(about_mm) = *visit {
                self.step = Step::SlowTravel { about_mm };
                return true;
            }
            self.at += 1;
        }
        false
    }

    /// What is visited slowly at each crossing.
    fn visits(&self) -> Vec<Option<f64>> {
        let fast = self.places(Delays::known(&self.settings.optics), &self.judged());
        let sheet = self.rough_sheet(&fast);
        let visit = |(index, crossing): (usize, &Crossing)| match &sheet {
            Some(sheet) => nearest(&fast, index, crossing.place_mm(sheet), NEAR_MM),
            None => nearest(&fast, index, crossing.mark_mm, f64::INFINITY),
        };
        self.crossings.iter().enumerate().map(visit).collect()
    }

    /// What lies where the slow passes have the sheet, and was seen by a fast pass alone.
    fn second_visits(&self) -> Vec<Option<f64>> {
        let Some(sheet) = self.rough_sheet(&self.found) else { return Vec::new() };
        let visit = |(index, crossing): (usize, &Crossing)| {
            let at_mm = nearest(&self.found, index, crossing.place_mm(&sheet), NEAR_MM)?;
            let visited_mm = self.to_visit_mm.get(index).copied().flatten();
            visited_mm.is_none_or(|mm| libm::fabs(mm - at_mm) > NEAR_MM).then_some(at_mm)
        };
        self.crossings.iter().enumerate().map(visit).collect()
    }

    /// Where the sheet lies, as well as what was found so far knows it.
    fn rough_sheet(&self, found: &[Found]) -> Option<FrameTransform> {
        let rough =
            RigidFit { most_sigma_mm: f64::INFINITY, most_unseen_mm: f64::INFINITY, ..RigidFit::default() };
        rough.estimate(&self.crossings, found).ok().map(|sheet| sheet.transform)
    }

    /// All passes, with what is a line among what they saw.
    fn judged(&self) -> Vec<Vec<Passed>> {
        let mut passed = self.passed.clone();
        line_width::judge(&mut passed, &self.settings, self.span_mm);
        passed
    }

    /// What all passes have told.
    fn tell(&mut self) {
        let passed = self.judged();
        let SearchSettings { optics, fast_mm_s, slow_mm_s, .. } = &self.settings;
        let delays = shown_delays::shown(optics, *fast_mm_s, *slow_mm_s, passed.iter().map(Vec::as_slice));
        self.found = self.places(delays, &passed);
    }

    fn count_found(&mut self) {
        for crossing in 0..self.crossings.len() {
            if self.found.iter().any(|place| place.crossing == crossing) {
                self.found_crossings += 1;
            } else {
                self.first_missed.get_or_insert(crossing);
            }
        }
    }

    fn places(&self, delays: Delays, passed: &[Vec<Passed>]) -> Vec<Found> {
        let passed = passed.iter().enumerate();
        passed.flat_map(|(crossing, passed)| places(crossing, delays, passed)).collect()
    }
}

/// Of what was found at a crossing, the nearest to a place and within a distance of it, mm.
fn nearest(found: &[Found], crossing: usize, about_mm: f64, within_mm: f64) -> Option<f64> {
    let off = |at_mm: f64| libm::fabs(at_mm - about_mm);
    let seen = found.iter().filter(|place| place.crossing == crossing).map(|place| place.at_mm);
    let nearest = seen.min_by(|one, other| off(*one).total_cmp(&off(*other)));
    nearest.filter(|at_mm| off(*at_mm) <= within_mm)
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
