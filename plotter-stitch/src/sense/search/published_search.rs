//! The published procedure: four scans, and each has to find its line.

use super::{Ask, Search, SearchError, place};
use crate::{
    Crossing, FindLine, FrameReadings, Mark, Optics, Reading,
    sense::{PublishedRule, Tact},
};
use plotter_motion::Point;

/// Sensing speed, mm/s.
const SPEED_MM_S: f64 = 300.0;

/// The procedure of the source: `X_border1`, `X_border2`, back to (0, 0), `Y_left`, `Y_right`, back to (0,
/// 0).
///
/// Each line is looked for from 50 mm before its expected place on, at 0.3 m/s, and the first thing that is
/// seen is taken for it.
///
/// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV. It
/// says "(0, `X_border2` + 50)" for the start of the last scan; as the scan lies on the right, the
/// coordinates must have been exchanged.
///
/// ```
/// # use plotter_motion::Vec2;
/// # use plotter_stitch::{FrameTransform, Optics, ReferenceLines};
/// # use plotter_stitch::sense::PublishedSearch;
/// # use plotter_stitch::sheet::{SensedJoint, SensorNoise};
/// let crossings: Vec<_> = ReferenceLines::published().crossings().collect();
/// let sheet = FrameTransform::new(0.001, Vec2::new(2.0, -1.0))?;
/// let mut joint = SensedJoint::new(&crossings, &sheet, Optics::default(), SensorNoise::none(), 1);
/// let mut search = PublishedSearch::new([crossings[0], crossings[1], crossings[2], crossings[3]], Optics::default());
/// joint.run(&mut search)?;
/// let found = FrameTransform::from_readings(&search.readings()?)?;
/// assert!((found.angle_rad() - 0.001).abs() < 0.6 / 2064.0); // a tact's way over the distance of both Y scans
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedSearch {
    marks: [Crossing; 4],
    optics: Optics,
    ahead_mm: [f64; 4],
    found_mm: [Option<f64>; 4],
    step: Step,
    rule: PublishedRule,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Travel(usize),
    Scan(usize),
    /// After the borders, and after the Y markers.
    Home(usize),
    Done,
}

impl PublishedSearch {
    /// The head begins to look for a line this far before it is expected, and gives up as far behind it, mm.
    pub const AHEAD_MM: f64 = 50.0;

    /// For the four marks, in the order of [`Mark::ALL`].
    #[must_use]
    pub fn new(marks: [Crossing; 4], optics: Optics) -> Self {
        Self {
            marks,
            optics,
            ahead_mm: [Self::AHEAD_MM; 4],
            found_mm: [None; 4],
            step: Step::Travel(0),
            rule: PublishedRule::new(&optics, SPEED_MM_S),
        }
    }

    /// The same, but each search begins so far before its line, mm: no line of the drawing lies between.
    #[must_use]
    pub const fn beginning(self, ahead_mm: [f64; 4]) -> Self {
        Self { ahead_mm, ..self }
    }

    /// Where the lines were found.
    ///
    /// # Errors
    ///
    /// [`SearchError::NotDone`] before the search is over.
    pub fn readings(&self) -> Result<FrameReadings, SearchError> {
        let reading = |mark: Mark| {
            let crossing = self.marks[mark as usize];
            self.found_mm[mark as usize]
                .map(|found_mm| Reading {
                    expected_mm: crossing.mark_mm,
                    found_mm,
                    scan_at_mm: crossing.scan_at_mm,
                })
                .ok_or(SearchError::NotDone)
        };
        Ok(FrameReadings {
            x_border1: reading(Mark::XBorder1)?,
            x_border2: reading(Mark::XBorder2)?,
            y_left: reading(Mark::YLeft)?,
            y_right: reading(Mark::YRight)?,
        })
    }

    /// The line was found, or the scan is over without.
    fn next(&mut self, index: usize) {
        self.step = match index {
            0 => Step::Travel(1),
            1 => Step::Home(1),
            2 => Step::Travel(3),
            _ => Step::Home(3),
        };
    }
}

impl Search for PublishedSearch {
    fn ask(&self) -> Ask {
        let from_mm = |index: usize| self.marks[index].mark_mm - self.ahead_mm[index];
        match self.step {
            Step::Travel(index) => Ask::Travel { to: place(&self.marks[index], from_mm(index)) },
            Step::Scan(index) => Ask::Scan {
                crossing: index,
                from: place(&self.marks[index], from_mm(index)),
                axis: self.marks[index].axis,
                to_mm: self.marks[index].mark_mm + Self::AHEAD_MM,
                velocity_mm_s: SPEED_MM_S,
            },
            Step::Home(_) => Ask::Travel { to: Point::ORIGIN },
            Step::Done => Ask::Done,
        }
    }

    fn tact(&mut self, tact: Tact) -> Result<(), SearchError> {
        let Step::Scan(index) = self.step else { return Ok(()) };
        let sighting = self.rule.push(tact).map_err(|error| SearchError::Tact { index, error })?;
        if let Some(sighting) = sighting {
            self.found_mm[index] = Some(sighting.at_mm);
            self.next(index);
        }
        Ok(())
    }

    fn arrived(&mut self) -> Result<(), SearchError> {
        match self.step {
            Step::Travel(index) => {
                self.rule = PublishedRule::new(&self.optics, SPEED_MM_S);
                self.step = Step::Scan(index);
            }
            Step::Scan(index) => {
                let crossing = self.marks[index];
                let sighting = self.rule.finish().ok_or(SearchError::NotFound {
                    index,
                    crossing,
                    from_mm: crossing.mark_mm - self.ahead_mm[index],
                    to_mm: crossing.mark_mm + Self::AHEAD_MM,
                })?;
                self.found_mm[index] = Some(sighting.at_mm);
                self.next(index);
            }
            Step::Home(1) => self.step = Step::Travel(2),
            Step::Home(_) | Step::Done => self.step = Step::Done,
        }
        Ok(())
    }
}
