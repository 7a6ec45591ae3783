//! [`Drawing::hatch`]: lines that fill closed strokes.

use super::boxes::BoxTree;
use super::occlude::sheets;
use super::region::{Region, outline};
use super::scan::{MOST_SPANS, Rows, TooMany};
use super::{Affine, Bounds, Drawing, PathSegment, Stroke};
use crate::Point;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::f64::consts::FRAC_PI_4;

/// Which closed strokes are filled together, of one pen, layer and sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum HatchTogether {
    /// All of them: what lies within an odd number of them. The lines stand behind the last one.
    #[default]
    All,
    /// Each by itself. One that is drawn later and lies in it wholly, without touching it, is its hole, and
    /// one in that is filled again. The lines stand directly behind their stroke, so that
    /// [`Drawing::occlude`] hides them as it hides the stroke: hatch first then.
    Within,
}

/// How closed strokes are filled: by default with lines at 45 degrees and 1 mm from each other, within 0.01
/// mm.
///
/// ```
/// let mut hatching = plotter_motion::drawing::Hatching::default();
/// hatching.distance_mm = 0.4; // the width of a fineliner's line: the area is solid
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Hatching {
    /// From line to line, mm; above 0.
    pub distance_mm: f64,
    /// Direction of the lines, rad, counter-clockwise from the right.
    pub angle_rad: f64,
    /// How far the ends of lines may lie from an arc or a curve, and how far the ends of a closed stroke from
    /// each other, mm. A tenth of a micrometre at least.
    pub tolerance_mm: f64,
    /// Which closed strokes are filled together.
    pub together: HatchTogether,
}

impl Default for Hatching {
    fn default() -> Self {
        Self {
            distance_mm: 1.0,
            angle_rad: FRAC_PI_4,
            tolerance_mm: 0.01,
            together: HatchTogether::default(),
        }
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
        /// The most that there may be in shapes that are filled together, or in all of them.
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
                "closed strokes would be hatched with {lines:.0} lines, more than {most:.0}: choose a greater distance"
            ),
        }
    }
}

impl core::error::Error for HatchError {}

impl Drawing {
    /// Fills closed strokes with parallel lines, and gives their number. Only strokes that are `wanted`
    /// count.
    ///
    /// The strokes of one pen, layer and sheet are filled together: what lies within an odd number of them.
    /// So a ring's inner stroke is the border of its hole. The lines are strokes of the same pen and layer,
    /// and have the speed and the power of the first segment of the first of these strokes. They stand behind
    /// the last of them, and every other one runs the other way, for short ways between.
    /// [`HatchTogether::Within`] fills each stroke by itself.
    ///
    /// The lines of all shapes lie at odd multiples of half the distance from the origin, so that those of
    /// neighbours go on in each other.
    ///
    /// # Errors
    ///
    /// A distance that is not above 0, an angle that is not finite, more than 100,000 rows or 1,000,000 lines
    /// in strokes that are filled together, or 1,000,000 lines in all. Nothing is hatched then.
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
        let Hatching { distance_mm, angle_rad, tolerance_mm, together } = *hatching;
        if !(distance_mm > 0.0 && distance_mm.is_finite()) {
            return Err(HatchError::Distance { distance_mm });
        }
        if !angle_rad.is_finite() {
            return Err(HatchError::Angle { angle_rad });
        }
        let way = Affine::turned(angle_rad).x;
        let base = Point::ORIGIN + way.perpendicular() * (0.5 * distance_mm);
        let rows = Rows { base, way, distance_mm };
        let mut shapes: BTreeMap<(usize, u8, u32), Vec<Numbered>> = BTreeMap::new();
        for ((number, stroke), sheet) in self.strokes.iter().enumerate().zip(sheets(&self.strokes)) {
            if let Some(outline) = outline(stroke, tolerance_mm).filter(|_| wanted(stroke)) {
                shapes.entry((sheet, stroke.pen, stroke.layer)).or_default().push((number, closed(outline)));
            }
        }
        let mut lines: BTreeMap<usize, Vec<Stroke>> = BTreeMap::new();
        let mut count = 0;
        for shapes in shapes.into_values() {
            let shapes = match together {
                HatchTogether::All => Shapes::all(shapes).into_iter().collect(),
                HatchTogether::Within => Shapes::within(shapes),
            };
            for shapes in shapes {
                let Some(first) = self.strokes.get(shapes.first) else { continue };
                let own = shapes.lines(&rows, first)?;
                count += own.len();
                #[expect(clippy::cast_precision_loss, reason = "a count in memory")]
                let all = count as f64;
                if all > MOST_SPANS {
                    return Err(HatchError::TooMany { lines: all, most: MOST_SPANS });
                }
                lines.insert(shapes.behind, own);
            }
        }
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

/// The box round an outline.
fn round(outline: &[Point]) -> Bounds {
    let mut bounds = Bounds::default();
    outline.iter().for_each(|place| bounds.grow(*place));
    bounds
}

/// The last place of an outline is the first one.
fn closed(mut outline: Vec<Point>) -> Vec<Point> {
    outline.extend(outline.first().copied());
    outline
}

/// An outline and the number of its stroke.
type Numbered = (usize, Vec<Point>);

/// Closed strokes that are filled together.
struct Shapes {
    outlines: Vec<Vec<Point>>,
    /// Number of the first of the strokes.
    first: usize,
    /// Number of the stroke behind which the lines stand.
    behind: usize,
}

impl Shapes {
    fn all(shapes: Vec<Numbered>) -> Option<Self> {
        let (first, behind) = (shapes.first()?.0, shapes.last()?.0);
        Some(Self { outlines: shapes.into_iter().map(|(_, outline)| outline).collect(), first, behind })
    }

    /// Each outline that is filled with its holes. The last of the earlier ones that an outline lies in
    /// tells: within a filled one it is a hole, within a hole it is filled.
    fn within(shapes: Vec<Numbered>) -> Vec<Self> {
        let bounds: Vec<Bounds> = shapes.iter().map(|(_, outline)| round(outline)).collect();
        let tree = BoxTree::new(bounds.iter().copied());
        let regions: Vec<Region> =
            shapes.iter().map(|(_, outline)| Region::polygons([outline.iter().copied()])).collect();
        let mut all: Vec<Self> = Vec::new();
        // Where each outline went that is filled.
        let mut filled: Vec<Option<usize>> = Vec::with_capacity(shapes.len());
        let mut around: Vec<usize> = Vec::new();
        for (index, ((number, outline), own)) in shapes.into_iter().zip(&bounds).enumerate() {
            around.clear();
            tree.each(|other| other.has(own.least) && other.has(own.most), |other| around.push(other));
            around.retain(|other| *other < index);
            around.sort_unstable_by(|a, b| b.cmp(a));
            let holds = |other: &&usize| regions.get(**other).is_some_and(|region| region.holds(&outline));
            let around = around.iter().find(holds).and_then(|other| filled.get(*other).copied().flatten());
            if let Some(shapes) = around.and_then(|around| all.get_mut(around)) {
                shapes.outlines.push(outline);
                filled.push(None);
            } else {
                filled.push(Some(all.len()));
                all.push(Self { outlines: alloc::vec![outline], first: number, behind: number });
            }
        }
        all
    }

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
