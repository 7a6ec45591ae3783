//! Which marks a frame gets, and where they are looked for again: data, not code.

use super::MOST_CROSSINGS;
use crate::{Crossing, Field};
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use plotter_motion::{Axis, Point};

/// No machine is so large, mm.
const FARTHEST_MM: f64 = 1e6;

/// The marks of a frame that can still be reached when the next one is about to be drawn, and the scans over
/// them.
///
/// ```text
///         beside the field │ the field                  │ beside the field
///                 ──┊──  ╷ │                            │ ╷  ──┊──       ── marks of constant y, scanned along y
///                   ┊   ┄┼┄│                            │┄┼┄   ┊         │  marks of constant x, scanned along x
///                 ──┊──  ╵ │   frame about to be drawn  │ ╵  ──┊──
///   y = 20          ┊      ├━━━━━━━━━━━━━━━━━━━━━━━━━━━━┤      ┊         ━  joint: where the lines of both frames meet
///                 ──┊──  ╷ │   frame before             │ ╷  ──┊──
///                   ┊   ┄┼┄│                            │┄┼┄   ┊
/// ```
///
/// Ours lie beside the field, where nothing is drawn, each moved a little otherwise so that no stroke of a
/// drawing imitates them ([`with_pattern`](Self::with_pattern)). Their coordinates are the machine's, for a
/// frame that lies in its own place ([`Field`]). In TOML (feature `serde`, any reader of it), rows of marks:
///
/// ```toml
/// schema = 1
/// joint = [{ x = 10.0, y = 20.0 }, { x = 1990.0, y = 20.0 }]
///
/// [[marks]]
/// axis = "y"
/// at_mm = [-34.0, -8.0, 18.0, 44.0, 70.0]
/// scans_mm = [-32.0, 2032.0]
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "Unchecked"))]
pub struct ReferenceLines {
    /// Version of this layout's form: 1.
    pub schema: u32,
    /// Both ends of the border where the frames meet, mm.
    pub joint: [Point; 2],
    /// The marks; each scan of a group crosses each mark of it.
    pub marks: Vec<MarkGroup>,
}

/// What a file says of one.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    schema: u32,
    joint: [Point; 2],
    marks: Vec<MarkGroup>,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for ReferenceLines {
    type Error = LayoutError;

    fn try_from(said: Unchecked) -> Result<Self, LayoutError> {
        let lines = Self { schema: said.schema, joint: said.joint, marks: said.marks };
        lines.check().map(|()| lines)
    }
}

/// Marks that are crossed by the same scans.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MarkGroup {
    /// Direction of the scans: marks of constant x are scanned along x.
    pub axis: Axis,
    /// The marks' coordinates, mm.
    pub at_mm: Vec<f64>,
    /// The machine's other coordinate during each scan, mm.
    pub scans_mm: Vec<f64>,
}

/// From the field's border to where marks of constant y are scanned, mm: in the middle of marks that end at
/// the margin's end.
const Y_SCAN_BESIDE_MM: f64 = 42.0;

/// From the field's border to marks of constant x, mm: a search of 12 mm to each side meets no line of the
/// field, and no mark of constant y, if the paper is moved by 5 mm.
const X_MARK_BESIDE_MM: f64 = 20.0;

/// From a frame's beginning to the marks of constant y, mm. They are farther apart than a search goes, so
/// none is taken for another, and all lie where the head of the documented machine comes before and after the
/// paper is moved.
const Y_MARKS_MM: [f64; 5] = [-54.0, -28.0, -2.0, 24.0, 50.0];

/// From a frame's beginning to where the source's borders are scanned, mm: on the frame before.
const BORDER_SCAN_MM: f64 = -50.0;

impl ReferenceLines {
    /// Ours: marks of constant y on both sides of the field, those of each group scanned so far beside their
    /// middle; and marks of constant x, scanned `x_scans_mm` from the frame's beginning. All with a pattern.
    fn strip(field: &Field, y_groups: &[(&[f64], &[f64])], x_scans_mm: &[f64]) -> Self {
        let along = |mm: &f64| field.begin_mm + mm;
        let middles_mm = [field.left_mm - Y_SCAN_BESIDE_MM, field.right_mm() + Y_SCAN_BESIDE_MM];
        let y = y_groups.iter().map(|(marks_mm, beside_mm)| MarkGroup {
            axis: Axis::Y,
            at_mm: marks_mm.iter().map(along).collect(),
            scans_mm: middles_mm
                .iter()
                .flat_map(|middle| beside_mm.iter().map(move |mm| middle + mm))
                .collect(),
        });
        let x = MarkGroup {
            axis: Axis::X,
            at_mm: vec![field.left_mm - X_MARK_BESIDE_MM, field.right_mm() + X_MARK_BESIDE_MM],
            scans_mm: x_scans_mm.iter().map(along).collect(),
        };
        Self { schema: 1, joint: field.joint(), marks: y.chain([x]).collect() }.with_pattern()
    }

    /// As published, on the widest field of the documented machine.
    #[must_use]
    pub fn published() -> Self {
        Self::published_on(&Field::default())
    }

    /// As published, in the order of [`Mark::ALL`](crate::Mark::ALL): both borders, scanned 50 mm before the
    /// frame begins, on the frame before; and the Y markers at its end, left and right of the field.
    ///
    /// The source has the head start "about" 50 mm beside the frame. The markers are scanned 42 mm beside it,
    /// so that their ends, 50 mm beside it, can be drawn on the widest field.
    ///
    /// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV
    /// and figure 5.
    #[must_use]
    pub fn published_on(field: &Field) -> Self {
        let x = MarkGroup {
            axis: Axis::X,
            at_mm: vec![field.left_mm, field.right_mm()],
            scans_mm: vec![field.begin_mm + BORDER_SCAN_MM],
        };
        let y = MarkGroup {
            axis: Axis::Y,
            at_mm: vec![field.begin_mm],
            scans_mm: vec![field.left_mm - Y_SCAN_BESIDE_MM, field.right_mm() + Y_SCAN_BESIDE_MM],
        };
        Self { schema: 1, joint: field.joint(), marks: vec![x, y] }
    }

    /// Ours with 16 crossings, on the widest field of the documented machine.
    #[must_use]
    pub fn strip16() -> Self {
        Self::strip16_on(&Field::default())
    }

    /// Ours with 16 crossings: five marks of constant y on either side of the field, as far from one another
    /// as they can be, where a rotation shows most; and one mark of constant x on either side, crossed three
    /// times.
    #[must_use]
    pub fn strip16_on(field: &Field) -> Self {
        Self::strip(field, &[(&Y_MARKS_MM, &[0.0])], &[-41.0, 11.0, 37.0])
    }

    /// Ours with 24 crossings, there.
    #[must_use]
    pub fn strip24() -> Self {
        Self::strip24_on(&Field::default())
    }

    /// Ours with 24 crossings: three of the marks of constant y are crossed twice on either side, those of
    /// constant x four times.
    #[must_use]
    pub fn strip24_on(field: &Field) -> Self {
        let y_groups: [(&[f64], &[f64]); 2] =
            [(&[-54.0, -2.0, 50.0], &[-1.0, 1.0]), (&[-28.0, 24.0], &[0.0])];
        Self::strip(field, &y_groups, &[-41.0, -15.0, 11.0, 37.0])
    }

    /// Ours with 32 crossings, there.
    #[must_use]
    pub fn strip32() -> Self {
        Self::strip32_on(&Field::default())
    }

    /// Ours with 32 crossings: the marks of constant y are crossed twice, those of constant x six times.
    #[must_use]
    pub fn strip32_on(field: &Field) -> Self {
        Self::strip(field, &[(&Y_MARKS_MM, &[-1.0, 1.0])], &[-43.0, -39.0, -15.0, 11.0, 35.0, 39.0])
    }

    /// All crossings: group by group, mark by mark, scan by scan.
    ///
    /// ```
    /// # use plotter_stitch::ReferenceLines;
    /// assert_eq!(ReferenceLines::strip16().crossings().count(), 5 * 2 + 2 * 3);
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

    /// The strokes that draw the marks: `reach_mm` to both sides of each scan, so that a sheet may have moved
    /// by as much and the scan still crosses them.
    ///
    /// ```
    /// # use plotter_motion::Point;
    /// # use plotter_stitch::ReferenceLines;
    /// let first = ReferenceLines::strip16().strokes(8.0).next();
    /// assert_eq!(first, Some([Point::new(-40.0, -36.925), Point::new(-24.0, -36.925)]));
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

    /// Checks what was put together by hand; what serde reads has been.
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
            wrong(|l| l.marks[0].at_mm[0] = f64::NAN),
            "NaN mm is no coordinate of a mark, a scan or the joint"
        );
        assert_eq!(
            wrong(|l| l.marks.clear()),
            "the layout has 0 crossings (marks times scans of each group), 3 to 64 are possible"
        );
        assert_eq!(
            wrong(|l| l.joint[1] = l.joint[0]),
            "both ends of the joint lie at (10, 20) mm; write two places"
        );
    }

    /// While one mark is searched, the paper moved by as much as it ever is: no other ink lies within the
    /// window.
    #[test]
    fn no_search_meets_another_mark_or_the_field() {
        /// Window of the search, reach of the strokes, rewinding and walk, and what a turn adds at the
        /// field's far side, mm.
        const WINDOW_MM: f64 = 12.0;
        const REACH_MM: f64 = 8.0;
        const WALK_MM: f64 = 5.0;
        const REWIND_MM: f64 = 9.0;
        let field = Field::default();
        // Those of 32 leave the scans of constant y only 7 mm of the 9.
        let all = [
            (ReferenceLines::strip16(), REWIND_MM),
            (ReferenceLines::strip24(), REWIND_MM),
            (ReferenceLines::strip32(), 7.0),
        ];
        for (lines, rewind_mm) in all {
            for scan in lines.crossings() {
                for [from, to] in lines.strokes(REACH_MM) {
                    let (own, is_same_mark) = match scan.axis {
                        Axis::X => (from.x, from.x == to.x && from.x == scan.mark_mm),
                        Axis::Y => (from.y, from.y == to.y && from.y == scan.mark_mm),
                    };
                    if is_same_mark {
                        continue;
                    }
                    let apart_mm = |a: f64, from: f64, to: f64| (from.min(to) - a).max(a - from.max(to));
                    let (across_mm, along_mm) = match scan.axis {
                        Axis::X => {
                            (apart_mm(scan.scan_at_mm, from.y, to.y) - rewind_mm, (own - scan.mark_mm).abs())
                        }
                        Axis::Y => {
                            (apart_mm(scan.scan_at_mm, from.x, to.x) - WALK_MM, (own - scan.mark_mm).abs())
                        }
                    };
                    let farther_mm = if scan.axis == Axis::X { WALK_MM } else { rewind_mm };
                    // Beside the scan's way, or beyond its ends.
                    assert!(
                        across_mm > 0.6 || along_mm > WINDOW_MM + farther_mm,
                        "{scan} meets {from:?} {to:?}"
                    );
                }
                if scan.axis == Axis::X {
                    let field_mm = if scan.mark_mm < 100.0 { field.left_mm } else { field.right_mm() };
                    assert!((scan.mark_mm - field_mm).abs() > WINDOW_MM + WALK_MM);
                }
            }
        }
    }
}
