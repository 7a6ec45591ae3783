//! [`Drawing::hatch`]: lines that fill closed strokes.

use super::occlude::sheets;
use super::region::outline;
use super::scan::{Rows, TooMany};
use super::{Affine, Drawing, PathSegment, Stroke};
use crate::Point;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::f64::consts::FRAC_PI_4;

/// How closed strokes are filled: by default with lines at 45 degrees and 1 mm from each other, within 0.01 mm.
///
/// ```
/// let mut hatching = plotter_motion::drawing::Hatching::default();
/// hatching.distance_mm = 0.4; // the width of a fineliner's line: the area is solid
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Hatching {
    /// From line to line, mm; above 0.
    pub distance_mm: f64,
    /// Direction of the lines, rad, counter-clockwise from the right.
    pub angle_rad: f64,
    /// How far the ends of lines may lie from an arc or a curve, and how far the ends of a closed stroke from each other, mm. A tenth of a
    /// micrometre at least.
    pub tolerance_mm: f64,
}

impl Default for Hatching {
    fn default() -> Self {
        Self { distance_mm: 1.0, angle_rad: FRAC_PI_4, tolerance_mm: 0.01 }
    }
}

/// Why a drawing is not hatched.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum HatchError {
    /// The distance of the lines is not above 0.
    Distance {
        /// What it is, mm.
        distance_mm: f64,
    },
    /// The angle is no number.
    Angle {
        /// What it is, rad.
        angle_rad: f64,
    },
    /// The lines are too many.
    TooMany {
        /// How many there would be.
        lines: f64,
        /// The most that there may be in the shapes of one pen and layer on one sheet.
        most: f64,
    },
}

impl core::fmt::Display for HatchError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Distance { distance_mm } => {
                write!(f, "the distance of hatch lines is {distance_mm} mm: choose one above 0 mm")
            }
            Self::Angle { angle_rad } => {
                write!(f, "the angle of hatch lines is {angle_rad} rad: choose a finite one")
            }
            Self::TooMany { lines, most } => write!(
                f,
                "the closed strokes of one pen would be hatched with {lines:.0} lines, more than {most:.0}: choose a greater distance"
            ),
        }
    }
}

impl core::error::Error for HatchError {}

impl Drawing {
    /// Fills closed strokes with parallel lines, and gives their number. Only strokes that are `wanted` count.
    ///
    /// The strokes of one pen, layer and sheet are filled together: what lies within an odd number of them. So a ring's inner stroke is
    /// the border of its hole. The lines are strokes of the same pen and layer, and have the speed and the power of the first segment
    /// of the first of these strokes. They stand behind the last of them, and every other one runs the other way, for short ways between.
    ///
    /// The lines of all shapes lie at odd multiples of half the distance from the origin, so that those of neighbours go on in each other.
    ///
    /// # Errors
    ///
    /// A distance that is not above 0, an angle that is not finite, more than 100,000 rows or 1,000,000 lines. Nothing is hatched then.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Bounds, Drawing, Hatching, Stroke}};
    /// let corners = Bounds::between(Point::ORIGIN, Point::new(10.0, 4.0)).corners();
    /// let outline = Stroke::through(corners.into_iter().chain([corners[0]])).unwrap();
    /// let mut drawing = Drawing { strokes: vec![outline], ..Drawing::new() };
    /// let mut hatching = Hatching::default();
    /// (hatching.distance_mm, hatching.angle_rad) = (2.0, 0.0);
    /// // Lines of 10 mm at 1 mm and 3 mm: the second comes back.
    /// assert_eq!(drawing.hatch(&hatching, |_| true)?, 2);
    /// assert_eq!((drawing.strokes[1].from, drawing.strokes[1].to()), (Point::new(0.0, 1.0), Point::new(10.0, 1.0)));
    /// assert_eq!((drawing.strokes[2].from, drawing.strokes[2].to()), (Point::new(10.0, 3.0), Point::new(0.0, 3.0)));
    /// # Ok::<(), plotter_motion::drawing::HatchError>(())
    /// ```
    pub fn hatch(
        &mut self,
        hatching: &Hatching,
        mut wanted: impl FnMut(&Stroke) -> bool,
    ) -> Result<usize, HatchError> {
        let Hatching { distance_mm, angle_rad, tolerance_mm } = *hatching;
        if !(distance_mm > 0.0 && distance_mm.is_finite()) {
            return Err(HatchError::Distance { distance_mm });
        }
        if !angle_rad.is_finite() {
            return Err(HatchError::Angle { angle_rad });
        }
        let way = Affine::turned(angle_rad).x;
        let base = Point::ORIGIN + way.perpendicular() * (0.5 * distance_mm);
        let rows = Rows { base, way, distance_mm };
        let mut shapes: BTreeMap<(usize, u8, u32), Shapes> = BTreeMap::new();
        for ((number, stroke), sheet) in self.strokes.iter().enumerate().zip(sheets(&self.strokes)) {
            if let Some(outline) = outline(stroke, tolerance_mm).filter(|_| wanted(stroke)) {
                let shapes = shapes.entry((sheet, stroke.pen, stroke.layer)).or_insert_with(|| Shapes {
                    outlines: Vec::new(),
                    first: number,
                    last: number,
                });
                shapes.outlines.push(closed(outline));
                shapes.last = number;
            }
        }
        let mut lines: BTreeMap<usize, Vec<Stroke>> = BTreeMap::new();
        for shapes in shapes.values() {
            let Some(first) = self.strokes.get(shapes.first) else { continue };
            lines.insert(shapes.last, shapes.lines(&rows, first)?);
        }
        let count = lines.values().map(Vec::len).sum();
        if count > 0 {
            let strokes = core::mem::take(&mut self.strokes).into_iter().enumerate();
            self.strokes = strokes
                .flat_map(|(number, stroke)| {
                    core::iter::once(stroke).chain(lines.remove(&number).unwrap_or_default())
                })
                .collect();
        }
        Ok(count)
    }
}

/// The last place of an outline is the first one.
fn closed(mut outline: Vec<Point>) -> Vec<Point> {
    outline.extend(outline.first().copied());
    outline
}

/// Closed strokes that are filled together.
struct Shapes {
    outlines: Vec<Vec<Point>>,
    /// Numbers of the first and the last of the strokes.
    first: usize,
    last: usize,
}

impl Shapes {
    fn lines(&self, rows: &Rows, like: &Stroke) -> Result<Vec<Stroke>, HatchError> {
        let mut lines: Vec<Stroke> = Vec::new();
        let (mut last_row, mut row_begin, mut is_back) = (f64::NAN, 0, true);
        rows.fill(&self.outlines, |row, from, to| {
            if row != last_row {
                if is_back && let Some(done) = lines.get_mut(row_begin..) {
                    done.reverse();
                }
                (last_row, row_begin, is_back) = (row, lines.len(), !is_back);
            }
            let (from, to) = if is_back { (to, from) } else { (from, to) };
            let (from, to) = (rows.place(row, from), rows.place(row, to));
            let style = like.segments.first().copied().unwrap_or_default();
            lines.push(like.like(
                from,
                alloc::vec![PathSegment { to, ..PathSegment { shape: super::Shape::Line, ..style } }],
            ));
        })
        .map_err(|TooMany { lines, most }| HatchError::TooMany { lines, most })?;
        if is_back && let Some(done) = lines.get_mut(row_begin..) {
            done.reverse();
        }
        Ok(lines)
    }
}
