//! [`MarkPlacer`]: where a mark may lie, so that its search meets no line of the drawing.

use super::DrawnStrip;
use crate::Crossing;
use core::fmt;
use plotter_motion::{Axis, Point};

/// How far paper may lie beside its place when marks are looked for, across its way and along it, mm: what it
/// walks, and what rewinding misses with the turn of 0.002 rad over a field of 2 m.
pub(crate) const ASTRAY_MM: [f64; 2] = [5.0, 9.0];

/// Distance from a line's middle at which the head sees its ink, mm: the head's disc of 0.6 mm and a line of
/// 0.5 mm have these radii.
const SEEN_MM: f64 = 0.3 + 0.25;

/// Step of the search for a place, mm: two widths of a pen's line.
const STEP_MM: f64 = 1.0;

/// Looks for a place for a mark among the lines of a frame.
///
/// The way of the scan over a mark, with all by which the paper may lie beside its place, is a rectangle; no
/// line of the drawing may come into it. If one does, the scan is slid along the mark, and then the mark
/// itself is moved away from the field.
///
/// ```
/// use plotter_motion::{Axis, PlotOp, Point};
/// use plotter_stitch::{Crossing, Field, MarkPlacer, marks::DrawnStrip};
///
/// let field = Field::default();
/// let mut strip = DrawnStrip::new(&field);
/// // The right border is scanned at y = -30, from x = 1940 on; a line of the drawing goes there.
/// strip.push(PlotOp::Travel { to: Point::new(1900.0, 900.0) });
/// strip.push(PlotOp::Draw { to: Point::new(1970.0, 900.0), feed_mm_s: None });
/// let border = Crossing { axis: Axis::X, mark_mm: 1990.0, scan_at_mm: -30.0 };
/// let placer = MarkPlacer {
///     ahead_mm: 50.0,
///     least_ahead_mm: 50.0,
///     behind_mm: 2.0,
///     reach_mm: [-8.0, 8.0],
///     slide_mm: [0.0, 30.0],
///     move_mm: 0.0,
/// };
/// let placed = placer.place(border, &strip)?;
/// // 9 mm that the paper may be moved too far and 0.55 mm from head to ink beside it: slid by 10 mm.
/// assert_eq!((placed.crossing.mark_mm, placed.crossing.scan_at_mm), (1990.0, -20.0));
/// # Ok::<(), plotter_stitch::marks::MarkError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkPlacer {
    /// How far before its expected place the head begins to look for a mark, mm.
    pub ahead_mm: f64,
    /// The least that is taken where lines leave no more room, mm: more than the paper may lie beside its
    /// place.
    pub least_ahead_mm: f64,
    /// How far behind the mark no line may lie, mm. What is drawn moves with the mark: where a search ends at
    /// the first ink it meets, this is what keeps two inks apart.
    pub behind_mm: f64,
    /// From where to where the mark itself reaches, along itself, from where it is scanned, mm.
    pub reach_mm: [f64; 2],
    /// How far the scan may be slid along the mark, mm: least and greatest.
    pub slide_mm: [f64; 2],
    /// How far the mark may be moved, mm: with its sign, away from the field.
    pub move_mm: f64,
}

/// A mark with a clear way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedMark {
    /// Where it lies and is scanned.
    pub crossing: Crossing,
    /// How far before its place the head begins, mm.
    pub ahead_mm: f64,
}

/// A mark has no place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MarkError {
    /// Lines of the drawing are in the way wherever it is looked for.
    Crowded {
        /// The mark where it should be.
        crossing: Crossing,
        /// The nearer end of a line that is in its way, mm in the machine's coordinates.
        line: Point,
    },
}

impl fmt::Display for MarkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Crowded { crossing, line } => write!(
                f,
                "there is no place for the mark {crossing}: lines of the drawing are in the way of its scan, one from ({:.1}, \
                 {:.1}) mm; move the drawing, or leave a margin",
                line.x, line.y
            ),
        }
    }
}

impl core::error::Error for MarkError {}

impl MarkPlacer {
    /// The place nearest to the wanted one that is clear: with the whole way first, then with the least.
    ///
    /// # Errors
    ///
    /// [`MarkError::Crowded`]: no place is clear.
    pub fn place(&self, crossing: Crossing, strip: &DrawnStrip) -> Result<PlacedMark, MarkError> {
        let ways_mm = [self.ahead_mm, self.least_ahead_mm];
        let [least_mm, most_mm] = self.slide_mm;
        let slides = move || {
            steps(most_mm.max(-least_mm))
                .flat_map(|by_mm| [by_mm, -by_mm])
                .filter(move |by_mm| (least_mm..=most_mm).contains(by_mm))
        };
        for ahead_mm in ways_mm {
            for away_mm in steps(libm::fabs(self.move_mm)) {
                for slide_mm in slides() {
                    let tried = Crossing {
                        mark_mm: crossing.mark_mm + libm::copysign(away_mm, self.move_mm),
                        scan_at_mm: crossing.scan_at_mm + slide_mm,
                        ..crossing
                    };
                    let [least, most] = self.way(&tried, ahead_mm);
                    let [first, last] = self.mark(&tried, slide_mm);
                    if strip.is_clear(least, most) && strip.is_clear(first, last) {
                        return Ok(PlacedMark { crossing: tried, ahead_mm });
                    }
                }
            }
        }
        let [least, most] = self.way(&crossing, self.least_ahead_mm);
        let [first, last] = self.mark(&crossing, 0.0);
        let met = strip.met(least, most).or_else(|| strip.met(first, last));
        let line = met.map_or(Point::ORIGIN, |line| line.from);
        Err(MarkError::Crowded { crossing, line })
    }

    /// The rectangle in which a line would lie on the mark or touch it. Where the scan is slid the mark
    /// stays.
    fn mark(&self, crossing: &Crossing, slide_mm: f64) -> [Point; 2] {
        let Crossing { axis, mark_mm, scan_at_mm } = *crossing;
        let [from_mm, to_mm] = self.reach_mm.map(|by_mm| scan_at_mm - slide_mm + by_mm);
        let corner = |beside_mm: f64, along_mm: f64| match axis {
            Axis::X => Point::new(mark_mm + beside_mm, along_mm),
            Axis::Y => Point::new(along_mm, mark_mm + beside_mm),
        };
        [corner(-2.0 * SEEN_MM, from_mm), corner(2.0 * SEEN_MM, to_mm)]
    }

    /// The rectangle in which ink would be met before the mark or beside it, or lie on it.
    fn way(&self, crossing: &Crossing, ahead_mm: f64) -> [Point; 2] {
        let [across_mm, along_mm] = ASTRAY_MM;
        let Crossing { axis, mark_mm, scan_at_mm } = *crossing;
        let (astray_mm, beside_mm) = match axis {
            Axis::X => (across_mm, along_mm + SEEN_MM),
            Axis::Y => (along_mm, across_mm + SEEN_MM),
        };
        // The head starts at a place of the table, the mark lies somewhere beside its own.
        let ways = [mark_mm - ahead_mm - astray_mm - SEEN_MM, mark_mm + self.behind_mm];
        let besides = [scan_at_mm - beside_mm, scan_at_mm + beside_mm];
        let corner = |end: usize| match axis {
            Axis::X => Point::new(ways[end], besides[end]),
            Axis::Y => Point::new(besides[end], ways[end]),
        };
        [corner(0), corner(1)]
    }
}

/// 0, 1, 2, … mm up to a length.
fn steps(most_mm: f64) -> impl Iterator<Item = f64> {
    (0_u16..=u16::MAX).map(|step| STEP_MM * f64::from(step)).take_while(move |by_mm| *by_mm <= most_mm)
}
