//! [`DrawnStrip`]: the drawing's own lines where marks are looked for.

use crate::Field;
use alloc::vec::Vec;
use plotter_motion::{PlotOp, Point, Segment, Vec2, toolpath::chords};

/// As much of a frame's end is kept as the head reaches after the paper has moved, mm, with what it may have
/// moved too little.
const KEPT_MM: f64 = 100.0;

/// And what is so near to the field's sides, along the whole frame: published borders run there, mm.
const BORDER_MM: f64 = 3.0;

/// Greatest distance of an arc's chords from the arc, mm: a tenth of a pen's line.
const CHORD_MM: f64 = 0.05;

/// The lines at the end of a frame and along its sides, where they lie once the paper has been moved by a
/// frame: what an optical head meets there besides the marks.
///
/// ```
/// use plotter_motion::{PlotOp, Point, Segment};
/// use plotter_stitch::{Field, marks::DrawnStrip};
///
/// // A line at the very end of a frame of 950 mm lies where the next frame begins, at (10, 20) on the table.
/// let mut strip = DrawnStrip::new(&Field::default());
/// strip.push(PlotOp::Travel { to: Point::new(0.0, 950.0) });
/// strip.push(PlotOp::Draw { to: Point::new(100.0, 950.0), feed_mm_s: None });
/// assert_eq!(strip.lines(), [Segment::new(Point::new(10.0, 20.0), Point::new(110.0, 20.0))]);
/// assert!(!strip.is_clear(Point::new(50.0, 15.0), Point::new(60.0, 25.0)));
/// assert!(strip.is_clear(Point::new(50.0, 0.0), Point::new(60.0, 19.0)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnStrip {
    /// From a frame's coordinates to where it lies after the paper has been moved.
    by: Vec2,
    least_y_mm: f64,
    /// Within these ends lines are kept only where they are near the frame's end.
    inner_x_mm: [f64; 2],
    lines: Vec<Segment>,
    at: Point,
}

impl DrawnStrip {
    /// The end of a blank frame.
    #[must_use]
    pub fn new(field: &Field) -> Self {
        Self {
            by: field.corner() + Vec2::new(0.0, -field.frame_mm),
            least_y_mm: field.begin_mm - KEPT_MM,
            inner_x_mm: [field.left_mm + BORDER_MM, field.right_mm() - BORDER_MM],
            lines: Vec::new(),
            at: Point::ORIGIN,
        }
    }

    /// Takes the next operation of the frame, in its coordinates.
    pub fn push(&mut self, op: PlotOp) {
        match op {
            PlotOp::Draw { to, .. } => self.line(self.at, to),
            PlotOp::DrawArc { .. } => {
                let mut from = self.at;
                let arc = chords([PlotOp::Travel { to: from }, op], CHORD_MM);
                for to in arc.skip(1).filter_map(PlotOp::target) {
                    self.line(from, to);
                    from = to;
                }
            }
            _ => {}
        }
        self.at = op.target().unwrap_or(self.at);
    }

    /// The lines, in the machine's coordinates for paper that was moved as it should be.
    #[must_use]
    pub fn lines(&self) -> &[Segment] {
        &self.lines
    }

    /// Whether no middle of a line lies in a rectangle, given by its least and greatest coordinates.
    #[must_use]
    pub fn is_clear(&self, least: Point, most: Point) -> bool {
        self.met(least, most).is_none()
    }

    /// A line that comes into the rectangle.
    pub(super) fn met(&self, least: Point, most: Point) -> Option<Segment> {
        self.lines.iter().copied().find(|line| line.shares_in(least, most).is_some())
    }

    fn line(&mut self, from: Point, to: Point) {
        let line = Segment::new(from + self.by, to + self.by);
        let [left_mm, right_mm] = self.inner_x_mm;
        let is_near_border = line.from.x.min(line.to.x) < left_mm || line.from.x.max(line.to.x) > right_mm;
        if line.from.y.max(line.to.y) >= self.least_y_mm || is_near_border {
            self.lines.push(line);
        }
    }
}
