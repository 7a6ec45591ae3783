//! Which marks a frame gets, and where they are looked for again: data, not code.

use crate::Crossing;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use plotter_motion::{Axis, Point};

/// Most crossings of one joint.
pub const MOST_CROSSINGS: usize = 64;

/// No machine is so large, mm.
const FARTHEST_MM: f64 = 1e6;

/// The marks of a frame that can still be reached when the next one is about to be drawn, and the scans over them.
///
/// ```text
///            20            180
///         ┃   │             │        ┃ joint: where the lines of both frames must meet
///   980 ┄┄┃┄┄┄│┄┄┄┄┄┄┄┄┄┄┄┄┄│┄┄▶     │ marks of constant x, scanned along x
///         ┃ ──┊─────────────┊──      ─ marks of constant y, scanned along y
///   500 ┄┄┃┄┄┄│┄┄┄┄┄┄┄┄┄┄┄┄┄│┄┄▶
///         ┃ ──┊─────────────┊──
///    20 ┄┄┃┄┄┄│┄┄┄┄┄┄┄┄┄┄┄┄┄│┄┄▶
///            45            155
/// ```
///
/// All coordinates of marks are those of the frame about to be drawn. In TOML (feature `serde`, any reader of it):
///
/// ```toml
/// schema = 1
/// joint = [{ x = 20.0, y = 0.0 }, { x = 20.0, y = 1000.0 }]
///
/// [[marks]]
/// axis = "x"
/// at_mm = [20.0, 180.0]
/// scans_mm = [60.0, 280.0, 500.0, 720.0, 940.0]
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ReferenceLines {
    /// Version of this layout's form: 1.
    pub schema: u32,
    /// Both ends of the border where the frames meet, in the frame about to be drawn, mm.
    pub joint: [Point; 2],
    /// The marks; each scan of a group crosses each mark of it.
    pub marks: Vec<MarkGroup>,
}

/// Marks that are crossed by the same scans.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MarkGroup {
    /// Direction of the scans: marks of constant x are scanned along x.
    pub axis: Axis,
    /// The marks' coordinates in the frame, mm.
    pub at_mm: Vec<f64>,
    /// The machine's other coordinate during each scan, mm.
    pub scans_mm: Vec<f64>,
}

const JOINT: [Point; 2] = [Point::new(20.0, 0.0), Point::new(20.0, 1000.0)];

impl ReferenceLines {
    /// Marks of constant x and their scans, then those of constant y.
    fn of(x_marks_mm: &[f64], x_scans_mm: &[f64], y_marks_mm: &[f64], y_scans_mm: &[f64]) -> Self {
        let group = |axis, at_mm: &[f64], scans_mm: &[f64]| MarkGroup {
            axis,
            at_mm: at_mm.to_vec(),
            scans_mm: scans_mm.to_vec(),
        };
        Self {
            schema: 1,
            joint: JOINT,
            marks: vec![group(Axis::X, x_marks_mm, x_scans_mm), group(Axis::Y, y_marks_mm, y_scans_mm)],
        }
    }

    fn strip(x_scans_mm: &[f64], y_marks_mm: &[f64]) -> Self {
        Self::of(&[20.0, 180.0], x_scans_mm, y_marks_mm, &[45.0, 155.0])
    }

    /// As published: both borders, and a Y marker that is scanned on the left and on the right, in the order of
    /// [`Mark::ALL`](crate::Mark::ALL).
    #[must_use]
    pub fn published() -> Self {
        Self::of(&[20.0, 1820.0], &[520.0], &[500.0], &[25.0, 1825.0])
    }

    /// Ours with 16 crossings: two lines of constant x crossed five times, three of constant y crossed twice, all in the strip of
    /// 200 mm that can still be reached.
    #[must_use]
    pub fn strip16() -> Self {
        Self::strip(&[60.0, 280.0, 500.0, 720.0, 940.0], &[90.0, 510.0, 910.0])
    }

    /// Ours with 24 crossings: seven lines of constant x crossed as near to the joint's ends as they can be, where a rotation shows
    /// most, and five of constant y crossed twice.
    #[must_use]
    pub fn strip24() -> Self {
        Self::of(
            &[20.0, 45.0, 70.0, 95.0, 120.0, 145.0, 170.0],
            &[10.0, 990.0],
            &[90.0, 290.0, 510.0, 710.0, 910.0],
            &[45.0, 155.0],
        )
    }

    /// Ours with 32 crossings.
    #[must_use]
    pub fn strip32() -> Self {
        Self::strip(
            &[20.0, 40.0, 60.0, 80.0, 100.0, 900.0, 920.0, 940.0, 960.0, 980.0],
            &[90.0, 250.0, 410.0, 590.0, 750.0, 910.0],
        )
    }

    /// All crossings: group by group, mark by mark, scan by scan.
    ///
    /// ```
    /// # use plotter_stitch::ReferenceLines;
    /// assert_eq!(ReferenceLines::strip16().crossings().count(), 2 * 5 + 3 * 2);
    /// ```
    pub fn crossings(&self) -> impl Iterator<Item = Crossing> + '_ {
        self.marks.iter().flat_map(|group| {
            let scans = move |mark_mm: f64| {
                group.scans_mm.iter().map(move |&scan_at_mm| Crossing {
                    axis: group.axis,
                    mark_mm,
                    scan_at_mm,
                })
            };
            group.at_mm.iter().flat_map(move |&mark_mm| scans(mark_mm))
        })
    }

    /// The strokes that draw the marks: `reach_mm` to both sides of each scan, so that a sheet may have moved by as much and
    /// the scan still crosses them.
    ///
    /// ```
    /// # use plotter_motion::Point;
    /// # use plotter_stitch::ReferenceLines;
    /// let first = ReferenceLines::strip16().strokes(8.0).next();
    /// assert_eq!(first, Some([Point::new(20.0, 52.0), Point::new(20.0, 68.0)]));
    /// ```
    pub fn strokes(&self, reach_mm: f64) -> impl Iterator<Item = [Point; 2]> + '_ {
        self.crossings().map(move |crossing| {
            let (from_mm, to_mm) = (crossing.scan_at_mm - reach_mm, crossing.scan_at_mm + reach_mm);
            match crossing.axis {
                Axis::X => [Point::new(crossing.mark_mm, from_mm), Point::new(crossing.mark_mm, to_mm)],
                Axis::Y => [Point::new(from_mm, crossing.mark_mm), Point::new(to_mm, crossing.mark_mm)],
            }
        })
    }

    /// Checks what came from a file.
    ///
    /// # Errors
    ///
    /// [`LayoutError`] names what is wrong.
    pub fn check(&self) -> Result<(), LayoutError> {
        if self.schema != 1 {
            return Err(LayoutError::Schema { schema: self.schema });
        }
        let numbers = self
            .marks
            .iter()
            .flat_map(|group| group.at_mm.iter().chain(&group.scans_mm))
            .copied()
            .chain(self.joint.iter().flat_map(|end| [end.x, end.y]));
        for value_mm in numbers {
            if !(-FARTHEST_MM..=FARTHEST_MM).contains(&value_mm) {
                return Err(LayoutError::Coordinate { value_mm });
            }
        }
        let crossings = self
            .marks
            .iter()
            .map(|group| group.at_mm.len().saturating_mul(group.scans_mm.len()))
            .fold(0, usize::saturating_add);
        if !(3..=MOST_CROSSINGS).contains(&crossings) {
            return Err(LayoutError::Crossings { crossings });
        }
        if self.joint[0].distance(self.joint[1]) <= 0.0 {
            return Err(LayoutError::Joint { at: self.joint[0] });
        }
        Ok(())
    }
}

/// What is wrong with a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LayoutError {
    /// Another version.
    Schema {
        /// The version it says.
        schema: u32,
    },
    /// A coordinate is not finite, or on no machine.
    Coordinate {
        /// The coordinate, mm.
        value_mm: f64,
    },
    /// Too few crossings to tell three numbers, or more than are taken.
    Crossings {
        /// How many there are.
        crossings: usize,
    },
    /// The joint has no length.
    Joint {
        /// Where it is.
        at: Point,
    },
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Schema { schema } => {
                write!(f, "schema {schema} of reference lines is unknown; write schema = 1")
            }
            Self::Coordinate { value_mm } => {
                write!(f, "{value_mm} mm is no coordinate of a mark, a scan or the joint")
            }
            Self::Crossings { crossings } => write!(
                f,
                "the layout has {crossings} crossings (marks times scans of each group), 3 to {MOST_CROSSINGS} are possible"
            ),
            Self::Joint { at } => {
                write!(f, "both ends of the joint lie at ({}, {}) mm; write two places", at.x, at.y)
            }
        }
    }
}

impl core::error::Error for LayoutError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_of_ours_is_right_and_has_as_many_crossings_as_its_name_says() {
        let layouts = [
            (ReferenceLines::published(), 4),
            (ReferenceLines::strip16(), 16),
            (ReferenceLines::strip24(), 24),
            (ReferenceLines::strip32(), 32),
        ];
        for (lines, crossings) in layouts {
            assert_eq!(lines.check(), Ok(()));
            assert_eq!(lines.crossings().count(), crossings);
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let wrong = |change: fn(&mut ReferenceLines)| {
            let mut lines = ReferenceLines::strip16();
            change(&mut lines);
            lines.check().map_err(|error| std::string::ToString::to_string(&error)).unwrap_err()
        };
        assert_eq!(wrong(|l| l.schema = 2), "schema 2 of reference lines is unknown; write schema = 1");
        assert_eq!(
            wrong(|l| l.marks[0].at_mm[1] = f64::NAN),
            "NaN mm is no coordinate of a mark, a scan or the joint"
        );
        assert_eq!(
            wrong(|l| l.marks.clear()),
            "the layout has 0 crossings (marks times scans of each group), 3 to 64 are possible"
        );
        assert_eq!(
            wrong(|l| l.joint[1] = l.joint[0]),
            "both ends of the joint lie at (20, 0) mm; write two places"
        );
    }
}
