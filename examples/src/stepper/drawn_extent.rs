//! [`DrawnExtent`]: size of a drawing, and how much of it leaves the machine's area.

use crate::drawings::{Diagnostic, Diagnostics, Severity};
use plotter_motion::{PlotOp, Point, config::AreaConfig};
use std::fmt::Write as _;

/// How far outside the area a point may lie and still count as inside, mm. It covers the rounding of
/// coordinates to whole steps and of millimetres to plotter units (0.025 mm), and the chords by which an arc
/// is judged, which are within it.
const BORDER_TOLERANCE_MM: f64 = 0.02;

/// Size of a drawing, and how much of it leaves the machine's area.
///
/// For each operation, in their order: [`count`](Self::count), then [`add_to_extent`](Self::add_to_extent).
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnExtent {
    area: AreaConfig,
    /// Lines and arcs, drawn or travelled.
    pub segments: u64,
    /// Lines and arcs that are drawn and could be planned: see [`count_planned`](Self::count_planned).
    pub drawn: u64,
    /// Lower left corner of the drawing, mm.
    pub min: Option<Point>,
    /// Upper right corner of the drawing, mm.
    pub max: Option<Point>,
    /// Movements that leave the area.
    pub movements_outside: u64,
    /// The first point outside, and the line of the file that asks for it.
    first_outside: Option<(Point, Option<u32>)>,
    /// Line of the file of the operation counted last.
    line: Option<u32>,
    /// Where the last operation ended.
    position: Point,
}

impl DrawnExtent {
    /// An empty drawing in this area.
    #[must_use]
    pub fn new(area: AreaConfig) -> Self {
        Self {
            area,
            segments: 0,
            drawn: 0,
            min: None,
            max: None,
            movements_outside: 0,
            first_outside: None,
            line: None,
            position: Point::ORIGIN,
        }
    }

    /// Counts `op`, read from line `line` of the file, and returns it; without its feed if `ignore_feed`.
    pub fn count(&mut self, mut op: PlotOp, line: Option<u32>, ignore_feed: bool) -> PlotOp {
        self.line = line;
        self.segments += u64::from(op.target().is_some());
        if let (true, PlotOp::Draw { feed_mm_s, .. } | PlotOp::DrawArc { feed_mm_s, .. }) =
            (ignore_feed, &mut op)
        {
            *feed_mm_s = None;
        }
        op
    }

    /// Counts `op` as drawn, if it draws: the planner has taken it.
    pub fn count_planned(&mut self, op: PlotOp) {
        self.drawn += u64::from(!matches!(op, PlotOp::Travel { .. }));
    }

    /// Adds `op`, which has just been counted, to the extent; returns whether it leaves the area.
    ///
    /// A line counts with both ends, an arc also with what lies between them, a travel with its end only: it
    /// draws nothing, and its start is the end of the operation before.
    pub fn add_to_extent(&mut self, op: PlotOp) -> bool {
        let Some(to) = op.target() else { return false };
        let from = std::mem::replace(&mut self.position, to);
        let mut first_outside = None;
        // The end comes first: a diagnostic shall name the coordinates that stand on the line of the file.
        self.visit_point(to, op, &mut first_outside);
        if !matches!(op, PlotOp::Travel { .. }) {
            self.visit_point(from, op, &mut first_outside);
        }
        if let PlotOp::DrawArc { .. } = op {
            let arc = [PlotOp::Travel { to: from }, op];
            for point in plotter_motion::toolpath::chords(arc, BORDER_TOLERANCE_MM).filter_map(PlotOp::target)
            {
                self.visit_point(point, op, &mut first_outside);
            }
        }
        let Some(point) = first_outside else { return false };
        self.movements_outside += 1;
        self.first_outside = self.first_outside.or(Some((point, self.line)));
        true
    }

    /// Widens the extent by a point of `op`, and keeps it if it is the first one of `op` outside the area.
    fn visit_point(&mut self, point: Point, op: PlotOp, first_outside: &mut Option<Point>) {
        if !matches!(op, PlotOp::Travel { .. }) {
            let min = self.min.unwrap_or(point);
            let max = self.max.unwrap_or(point);
            self.min = Some(Point::new(min.x.min(point.x), min.y.min(point.y)));
            self.max = Some(Point::new(max.x.max(point.x), max.y.max(point.y)));
        }
        let AreaConfig { width_mm, height_mm } = self.area;
        let is_inside = (-BORDER_TOLERANCE_MM..=width_mm + BORDER_TOLERANCE_MM).contains(&point.x)
            && (-BORDER_TOLERANCE_MM..=height_mm + BORDER_TOLERANCE_MM).contains(&point.y);
        if !is_inside {
            *first_outside = first_outside.or(Some(point));
        }
    }

    /// Where the drawing first leaves the area; `None` if it never does.
    #[must_use]
    pub fn outside_diagnostic(&self) -> Option<Diagnostic> {
        let AreaConfig { width_mm, height_mm } = self.area;
        let (Point { x, y }, line) = self.first_outside?;
        let text = format!(
            "the point ({x:.3}, {y:.3}) mm lies outside of the machine's area, 0..={width_mm} and 0..={height_mm} mm: move or \
             shrink the drawing"
        );
        Some(Diagnostic { line, ..Diagnostic::new(Severity::Warning, text) })
    }

    /// Adds one warning if any movement leaves the area: where first, and the size of the drawing.
    pub fn warn(&self, diagnostics: &mut Diagnostics) {
        let Some(mut warning) = self.outside_diagnostic() else { return };
        if let (Some(min), Some(max)) = (self.min, self.max) {
            let _ = write!(
                warning.text,
                "; it spans {:.1}..={:.1} and {:.1}..={:.1} mm, {} of its {} movements leave the area",
                min.x, max.x, min.y, max.y, self.movements_outside, self.segments
            );
        }
        diagnostics.push(warning);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_circle_leaves_the_area_between_its_ends() {
        let mut extent = DrawnExtent::new(AreaConfig { width_mm: 100.0, height_mm: 30.0 });
        let travel = PlotOp::Travel { to: Point::new(20.0, 20.0) };
        // From (20, 20) to (60, 20) about (40, 20), clockwise: its top, (40, 40), is 10 mm above the area.
        let arc = PlotOp::DrawArc {
            to: Point::new(60.0, 20.0),
            centre: Point::new(40.0, 20.0),
            sweep_rad: -std::f64::consts::PI,
            feed_mm_s: Some(10.0),
        };
        let outside = [travel, arc].map(|op| {
            let op = extent.count(op, Some(7), true);
            extent.add_to_extent(op)
        });
        assert_eq!(outside, [false, true]);
        assert_eq!((extent.segments, extent.movements_outside), (2, 1));
        let (min, max) = (extent.min.unwrap(), extent.max.unwrap());
        assert_eq!((min, max.x), (Point::new(20.0, 20.0), 60.0));
        assert!((max.y - 40.0).abs() <= BORDER_TOLERANCE_MM, "{max:?}");
        assert_eq!(extent.outside_diagnostic().and_then(|warning| warning.line), Some(7));
    }
}
