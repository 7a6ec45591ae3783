//! [`FrameChange`]: a picture of the table at a frame change.

use crate::shared::escaped;
use plotter_motion::{Axis, PlotOp, Point, toolpath::chords};
use plotter_stitch::Crossing;
use std::fmt::Write as _;

/// Width of the picture, px, and its margin.
const WIDTH_PX: f64 = 1_200.0;
const MARGIN_PX: f64 = 60.0;
/// Curves are shown as chords this near to them, mm.
const CHORD_MM: f64 = 0.5;

/// What lies on the table when a frame has been joined and drawn, in the machine's coordinates.
#[derive(Clone, Debug, Default)]
pub struct FrameChange {
    /// Number of the frame, from 1.
    pub frame: u32,
    /// The paper's edges, as straight lines: each from the table's lower end to its upper one.
    pub edges: [[Point; 2]; 2],
    /// Lines of the frame before, and its marks.
    pub before: (Vec<PlotOp>, Vec<[Point; 2]>),
    /// The scans over its marks.
    pub scans: Vec<Crossing>,
    /// Probes for folds: the line, and the scans over it.
    pub probes: Vec<[Point; 2]>,
    /// Lines of the frame, and its marks.
    pub after: (Vec<PlotOp>, Vec<[Point; 2]>),
    /// Size of the table, mm, and how far beyond it the head reaches.
    pub table_mm: [f64; 2],
    /// See above.
    pub beyond_mm: f64,
}

impl FrameChange {
    /// The picture: the table from above, with y up.
    #[must_use]
    pub fn svg(&self) -> String {
        let [width_mm, height_mm] = self.table_mm;
        let scale = (WIDTH_PX - 2.0 * MARGIN_PX) / (width_mm + 2.0 * self.beyond_mm);
        let height_px = (height_mm + 2.0 * self.beyond_mm) * scale + 2.0 * MARGIN_PX + 30.0;
        let at = |place: Point| {
            let x = MARGIN_PX + (place.x + self.beyond_mm) * scale;
            (x, height_px - MARGIN_PX - (place.y + self.beyond_mm) * scale)
        };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px:.0}\" \
             viewBox=\"0 0 {WIDTH_PX} {height_px:.0}\" font-family=\"sans-serif\" font-size=\"13\" fill=\"#333\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        );
        let title = format!(
            "Frame {} on the table. Blue: the frame before, moved down. Red: this frame. Thick: marks. Green: scans. Orange: the \
             probe for a fold.",
            self.frame
        );
        let _ = writeln!(svg, "<text x=\"{MARGIN_PX}\" y=\"30\">{}</text>", escaped(&title));
        let mut polygon = |corners: &[Point], style: &str| {
            let places: Vec<String> =
                corners.iter().map(|place| at(*place)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            let _ = writeln!(svg, "<polygon points=\"{}\" {style}/>", places.join(" "));
        };
        let beyond = self.beyond_mm;
        let rectangle = |by: f64| {
            [(-by, -by), (width_mm + by, -by), (width_mm + by, height_mm + by), (-by, height_mm + by)]
                .map(|(x, y)| Point::new(x, y))
        };
        polygon(&rectangle(beyond), "fill=\"#e8eef0\" stroke=\"none\"");
        let [left, right] = self.edges;
        polygon(&[left[0], right[0], right[1], left[1]], "fill=\"#fffdf4\" stroke=\"#b9ab7a\"");
        polygon(&rectangle(0.0), "fill=\"none\" stroke=\"#999\" stroke-dasharray=\"4 4\"");
        self.lines(&mut svg, &self.before, "#1565c0", &at);
        self.lines(&mut svg, &self.after, "#c62828", &at);
        for crossing in &self.scans {
            let ends = [-12.0, 12.0].map(|by_mm| match crossing.axis {
                Axis::X => Point::new(crossing.mark_mm + by_mm, crossing.scan_at_mm),
                Axis::Y => Point::new(crossing.scan_at_mm, crossing.mark_mm + by_mm),
            });
            line(&mut svg, ends.map(at), "#2e7d32", 1.2);
        }
        for stroke in &self.probes {
            line(&mut svg, stroke.map(at), "#ef6c00", 1.5);
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// Lines within the head's reach; marks are thicker.
    fn lines(
        &self,
        svg: &mut String,
        (ops, marks): &(Vec<PlotOp>, Vec<[Point; 2]>),
        colour: &str,
        at: &impl Fn(Point) -> (f64, f64),
    ) {
        let [width_mm, height_mm] = self.table_mm;
        let is_near = |place: &Point| {
            (-self.beyond_mm..=width_mm + self.beyond_mm).contains(&place.x)
                && (-self.beyond_mm..=height_mm + self.beyond_mm).contains(&place.y)
        };
        let mut path = String::new();
        let (mut from, mut goes_on) = (Point::ORIGIN, false);
        for op in chords(ops.iter().copied(), CHORD_MM) {
            let to = op.target().unwrap_or(from);
            let is_shown = matches!(op, PlotOp::Draw { .. }) && is_near(&from) && is_near(&to);
            if is_shown {
                if !goes_on {
                    let (x, y) = at(from);
                    let _ = write!(path, "M{x:.1} {y:.1}");
                }
                let (x, y) = at(to);
                let _ = write!(path, "L{x:.1} {y:.1}");
            }
            (from, goes_on) = (to, is_shown);
        }
        let _ = writeln!(
            svg,
            "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"0.5\" fill=\"none\" stroke-linecap=\"round\"/>"
        );
        // Borders go on beyond what is shown, up and down.
        let within = |place: Point| {
            Point::new(place.x, place.y.clamp(-self.beyond_mm, self.table_mm[1] + self.beyond_mm))
        };
        for ends in marks {
            let shown = ends.map(within);
            if shown[0] != shown[1] {
                line(svg, shown.map(at), colour, 2.0);
            }
        }
    }
}

fn line(svg: &mut String, [(x1, y1), (x2, y2)]: [(f64, f64); 2], colour: &str, width: f64) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\" stroke-width=\"{width}\" \
         stroke-linecap=\"round\"/>"
    );
}
