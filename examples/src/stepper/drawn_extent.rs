//! [`DrawnExtent`]: how a drawing lies in the machine's area.

use crate::drawings::{Diagnostic, Diagnostics, Severity};
use plotter_motion::{PlotOp, Point, config::AreaConfig};
use std::fmt::Write as _;

/// A point may lie this far outside of the area, mm: what rounding makes of its border.
const BORDER_MM: f64 = 0.02;

/// What has been read, and how it lies in the machine's area.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnExtent {
    area: AreaConfig,
    /// Lines and arcs, drawn or travelled.
    pub segments: u64,
    /// Lines and arcs that are drawn; whoever plans them counts them here.
    pub drawn: u64,
    /// Lower left corner of what is drawn, mm.
    pub least: Option<Point>,
    /// Upper right corner of what is drawn, mm.
    pub most: Option<Point>,
    /// Movements that leave the area.
    pub outside: u64,
    first_outside: Option<(Point, Option<u32>)>,
    line: Option<u32>,
    position: Point,
}

impl DrawnExtent {
    /// Nothing yet, in this area.
    #[must_use]
    pub fn new(area: AreaConfig) -> Self {
        Self {
            area,
            segments: 0,
            drawn: 0,
            least: None,
            most: None,
            outside: 0,
            first_outside: None,
            line: None,
            position: Point::ORIGIN,
        }
    }

    /// Counts an operation; gives it as it is to be planned.
    pub fn take(&mut self, mut op: PlotOp, line: Option<u32>, ignore_feed: bool) -> PlotOp {
        self.line = line;
        self.segments += u64::from(op.target().is_some());
        if let (true, PlotOp::Draw { feed_mm_s, .. } | PlotOp::DrawArc { feed_mm_s, .. }) =
            (ignore_feed, &mut op)
        {
            *feed_mm_s = None;
        }
        op
    }

    /// Whether an operation leaves the area. What is drawn counts for the size of the drawing.
    pub fn outside(&mut self, op: PlotOp) -> bool {
        let Some(to) = op.target() else { return false };
        let from = std::mem::replace(&mut self.position, to);
        let mut first_outside = None;
        self.pass(to, op, &mut first_outside);
        if !matches!(op, PlotOp::Travel { .. }) {
            self.pass(from, op, &mut first_outside);
        }
        if let PlotOp::DrawArc { .. } = op {
            let arc = [PlotOp::Travel { to: from }, op];
            for place in plotter_motion::toolpath::chords(arc, BORDER_MM).filter_map(PlotOp::target) {
                self.pass(place, op, &mut first_outside);
            }
        }
        let Some(place) = first_outside else { return false };
        self.outside += 1;
        self.first_outside = self.first_outside.or(Some((place, self.line)));
        true
    }

    /// A place that an operation passes.
    fn pass(&mut self, place: Point, op: PlotOp, first_outside: &mut Option<Point>) {
        if !matches!(op, PlotOp::Travel { .. }) {
            let least = self.least.unwrap_or(place);
            let most = self.most.unwrap_or(place);
            self.least = Some(Point::new(least.x.min(place.x), least.y.min(place.y)));
            self.most = Some(Point::new(most.x.max(place.x), most.y.max(place.y)));
        }
        let AreaConfig { width_mm, height_mm } = self.area;
        let is_inside = (-BORDER_MM..=width_mm + BORDER_MM).contains(&place.x)
            && (-BORDER_MM..=height_mm + BORDER_MM).contains(&place.y);
        if !is_inside {
            *first_outside = first_outside.or(Some(place));
        }
    }

    /// Where the area is left first.
    #[must_use]
    pub fn complaint(&self) -> Diagnostic {
        let AreaConfig { width_mm, height_mm } = self.area;
        let (Point { x, y }, line) = self.first_outside.unwrap_or_default();
        let text = format!(
            "the point ({x:.3}, {y:.3}) mm lies outside of the machine's area, 0..={width_mm} and 0..={height_mm} mm: move or \
             shrink the drawing"
        );
        Diagnostic { line, ..Diagnostic::new(Severity::Warning, text) }
    }

    /// Says once where and how far the area is left, if it is.
    pub fn warn(&self, said: &mut Diagnostics) {
        if self.outside == 0 {
            return;
        }
        let mut complaint = self.complaint();
        if let (Some(least), Some(most)) = (self.least, self.most) {
            let _ = write!(
                complaint.text,
                "; it spans {:.1}..={:.1} and {:.1}..={:.1} mm, {} of its {} movements leave the area",
                least.x, most.x, least.y, most.y, self.outside, self.segments
            );
        }
        said.push(complaint);
    }
}
