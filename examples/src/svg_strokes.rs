//! [`svg_strokes`]: the strokes of an SVG picture as plot operations.

use crate::{Diagnostic, Severity};
use plotter_motion::{PlotOp, Point, Vec2};
use std::collections::HashMap;
use std::f64::consts::TAU;
use usvg::roxmltree::{Document, ParsingOptions};
use usvg::tiny_skia_path::PathSegment;
use usvg::{Node, Paint, Tree};

/// A CSS pixel is the 96th part of an inch.
const MM_PER_PX: f64 = 25.4 / 96.0;

/// How far a cubic that stands for a quarter of a circle may be from it, as a share of the radius.
const CUBIC_SHARE: f64 = 3e-4;

/// Most lines that a curve becomes.
const MOST_LINES: f64 = 4096.0;

/// Most pens: later colours share the last.
const MOST_PENS: usize = 255;

/// What an SVG picture has to draw.
#[derive(Debug, Default)]
pub struct SvgStrokes {
    /// The strokes, mm from the lower left corner.
    pub ops: Vec<PlotOp>,
    /// What cannot be drawn.
    pub diagnostics: Vec<Diagnostic>,
    /// Colour of each pen from 1 on: red, green, blue.
    pub colours: Vec<[u8; 3]>,
}

/// The strokes of an SVG picture, in mm by its `width`, `height` and `viewBox`, a CSS pixel as the 96th part of an inch. The
/// lower left corner of the picture is the origin.
///
/// Each colour of stroke is a pen, in the order in which they come. Curves become lines within `tolerance_mm`, those that are
/// arcs of a circle stay arcs. Fills, text and pictures are left out, with a notice each kind.
///
/// # Errors
///
/// That it is no SVG, with its place.
pub fn svg_strokes(bytes: &[u8], tolerance_mm: f64) -> Result<SvgStrokes, String> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| format!("byte {}: this is not UTF-8", error.valid_up_to()))?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        format!("line {}, column {}: {error}", place.row, place.col)
    })?;
    let tree = Tree::from_xmltree(&document, &usvg::Options::default()).map_err(|error| error.to_string())?;
    let mut reader = Strokes {
        height_px: f64::from(tree.size().height()),
        tolerance_mm,
        strokes: SvgStrokes::default(),
        pens: HashMap::new(),
        pen: None,
        at: Point::ORIGIN,
        fills: 0,
        paints: 0,
        dashes: 0,
        clips: 0,
    };
    reader.unseen(&document);
    reader.group(tree.root());
    reader.count_up();
    Ok(reader.strokes)
}

struct Strokes {
    height_px: f64,
    tolerance_mm: f64,
    strokes: SvgStrokes,
    pens: HashMap<[u8; 3], u8>,
    pen: Option<u8>,
    at: Point,
    fills: u32,
    paints: u32,
    dashes: u32,
    clips: u32,
}

impl Strokes {
    /// Reports the elements that draw something which is no path, where they stand.
    fn unseen(&mut self, document: &Document<'_>) {
        for (name, remedy) in [
            ("text", "text is left out: convert it to paths"),
            ("image", "a picture is left out: trace it"),
            ("foreignObject", "foreign content is left out"),
        ] {
            let mut elements = document.descendants().filter(|node| node.tag_name().name() == name);
            let Some(first) = elements.next() else { continue };
            let place = document.text_pos_at(first.range().start);
            let others = elements.count();
            let more = if others > 0 { format!(" (and {others} more)") } else { String::new() };
            self.strokes.diagnostics.push(Diagnostic {
                line: Some(place.row),
                column: Some(place.col),
                severity: Severity::Notice,
                text: format!("{remedy}{more}"),
            });
        }
    }

    fn count_up(&mut self) {
        let counts = [
            (self.fills, "filled without a stroke, and left out: give them a stroke, or hatch them"),
            (self.paints, "stroked with a gradient or pattern: drawn in black"),
            (self.dashes, "dashed: drawn as whole lines"),
            (self.clips, "clipped or masked: drawn whole"),
        ];
        for (count, text) in counts.into_iter().filter(|(count, _)| *count > 0) {
            let shapes = if count == 1 { "shape is" } else { "shapes are" };
            let text = format!("{count} {shapes} {text}");
            self.strokes.diagnostics.push(Diagnostic::new(Severity::Notice, text));
        }
    }

    fn group(&mut self, group: &usvg::Group) {
        self.clips += u32::from(group.clip_path().is_some() || group.mask().is_some());
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group),
                Node::Path(path) => self.path(path),
                Node::Image(_) | Node::Text(_) => {}
            }
        }
    }

    fn path(&mut self, path: &usvg::Path) {
        if !path.is_visible() {
            return;
        }
        let Some(stroke) = path.stroke() else {
            self.fills += 1;
            return;
        };
        self.dashes += u32::from(stroke.dasharray().is_some());
        let colour = match stroke.paint() {
            Paint::Color(colour) => [colour.red, colour.green, colour.blue],
            _ => {
                self.paints += 1;
                [0; 3]
            }
        };
        self.take_pen(colour);
        let Some(data) = path.data().clone().transform(path.abs_transform()) else { return };
        let height_px = self.height_px;
        let place = |point: usvg::tiny_skia_path::Point| {
            Point::new(f64::from(point.x) * MM_PER_PX, (height_px - f64::from(point.y)) * MM_PER_PX)
        };
        let mut start = Point::ORIGIN;
        for segment in data.segments() {
            match segment {
                PathSegment::MoveTo(to) => {
                    start = place(to);
                    self.at = start;
                    self.strokes.ops.push(PlotOp::Travel { to: start });
                }
                PathSegment::LineTo(to) => self.line(place(to)),
                PathSegment::QuadTo(control, to) => {
                    let (control, to) = (place(control), place(to));
                    let thirds = |end: Point| end.lerp(control, 2.0 / 3.0);
                    self.cubic(thirds(self.at), thirds(to), to);
                }
                PathSegment::CubicTo(first, second, to) => self.cubic(place(first), place(second), place(to)),
                PathSegment::Close if self.at != start => self.line(start),
                PathSegment::Close => {}
            }
        }
    }

    fn take_pen(&mut self, colour: [u8; 3]) {
        let next = (self.pens.len() + 1).min(MOST_PENS);
        let next = u8::try_from(next).unwrap_or(u8::MAX);
        let pen = *self.pens.entry(colour).or_insert(next);
        if self.strokes.colours.len() < usize::from(pen) {
            self.strokes.colours.push(colour);
        }
        if self.pen != Some(pen) {
            self.pen = Some(pen);
            self.strokes.ops.push(PlotOp::SelectPen { pen });
        }
    }

    fn line(&mut self, to: Point) {
        self.strokes.ops.push(PlotOp::Draw { to, feed_mm_s: None });
        self.at = to;
    }

    fn cubic(&mut self, first: Point, second: Point, to: Point) {
        let from = self.at;
        if let Some((centre, sweep_rad)) = circular([from, first, second, to], self.tolerance_mm) {
            self.strokes.ops.push(PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None });
            self.at = to;
            return;
        }
        // The chord over 1/n of a cubic is no farther from it than an eighth of the second derivative over n².
        let bends = [(first - from) + -(second - first), (second - first) + -(to - second)];
        let bend_mm = bends[0].length().max(bends[1].length());
        let lines = (0.75 * bend_mm / self.tolerance_mm).sqrt().ceil().clamp(1.0, MOST_LINES);
        let mut index = 1.0;
        while index < lines {
            self.line(on_cubic([from, first, second, to], index / lines));
            index += 1.0;
        }
        self.line(to);
    }
}

fn on_cubic([from, first, second, to]: [Point; 4], t: f64) -> Point {
    let (a, b, c) = (from.lerp(first, t), first.lerp(second, t), second.lerp(to, t));
    a.lerp(b, t).lerp(b.lerp(c, t), t)
}

/// Centre and angle of the arc that a cubic stands for, if it does.
fn circular(cubic: [Point; 4], tolerance_mm: f64) -> Option<(Point, f64)> {
    let [from, first, second, to] = cubic;
    let (chord, into, out) = (to - from, first - from, to - second);
    let (chord_mm, into_mm) = (chord.length(), into.length());
    // An arc begins and ends alike, and turns by less than half a circle.
    if !(chord_mm > 0.0 && into_mm > 0.0) || (out.length() - into_mm).abs() > 0.02 * into_mm {
        return None;
    }
    let (begins, ends) = (turn(into, chord), turn(chord, out));
    if (begins - ends).abs() > 0.01 || begins.abs() < 0.01 || begins.abs() > 1.6 {
        return None;
    }
    let half_rad = 0.5 * (begins + ends);
    let radius_mm = 0.5 * chord_mm / half_rad.abs().sin();
    let to_centre_mm = 0.5 * chord_mm / half_rad.tan();
    let centre = from.lerp(to, 0.5) + chord.perpendicular() * (to_centre_mm / chord_mm);
    let near_mm = tolerance_mm.max(CUBIC_SHARE * radius_mm);
    let fits = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875]
        .iter()
        .all(|&t| (on_cubic(cubic, t).distance(centre) - radius_mm).abs() <= near_mm);
    (fits && radius_mm.is_finite()).then_some((centre, (2.0 * half_rad).clamp(-TAU, TAU)))
}

/// Angle from one direction to the other, rad, counter-clockwise above 0.
fn turn(from: Vec2, to: Vec2) -> f64 {
    libm::atan2(from.cross(to), from.dot(to))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What single precision leaves of a coordinate of some hundred pixels.
    const ROUNDING_MM: f64 = 1e-4;

    fn strokes(body: &str) -> SvgStrokes {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"5cm\" viewBox=\"0 0 200 100\">\n{body}\n</svg>"
        );
        svg_strokes(text.as_bytes(), 0.01).unwrap()
    }

    #[test]
    fn units_view_box_and_transforms_count() {
        let strokes = strokes("<g transform='translate(10 20)'><path d='M0 0h20' stroke='#f00'/></g>");
        let places: Vec<Point> = strokes.ops.iter().filter_map(|op| op.target()).collect();
        assert_eq!(strokes.colours, [[255, 0, 0]]);
        assert!(places[0].distance(Point::new(5.0, 40.0)) < ROUNDING_MM, "{places:?}");
        assert!(places[1].distance(Point::new(15.0, 40.0)) < ROUNDING_MM, "{places:?}");
    }

    #[test]
    fn a_circle_stays_arcs_and_other_curves_keep_the_tolerance() {
        let circle = strokes("<circle cx='100' cy='50' r='40' stroke='black'/>");
        let arcs: Vec<f64> = circle
            .ops
            .iter()
            .filter_map(|op| match op {
                PlotOp::DrawArc { centre, sweep_rad, .. } => {
                    assert!(centre.distance(Point::new(50.0, 25.0)) < 0.01, "{centre:?}");
                    Some(*sweep_rad)
                }
                _ => None,
            })
            .collect();
        assert!((arcs.iter().sum::<f64>().abs() - TAU).abs() < 0.01, "{arcs:?}");
        // An ellipse is none: its points lie on (x/20)² + (y/10)² = 1.
        let ellipse = strokes("<ellipse cx='100' cy='50' rx='40' ry='20' stroke='black'/>");
        let mut at = Point::ORIGIN;
        for op in &ellipse.ops {
            let Some(to) = op.target() else { continue };
            if let PlotOp::Draw { .. } = op {
                for share in [0.0, 0.5] {
                    let place = at.lerp(to, share);
                    let (x, y) = ((place.x - 50.0) / 20.0, (place.y - 25.0) / 10.0);
                    assert!((x.hypot(y) - 1.0).abs() * 10.0 < 0.02, "{place:?}");
                }
            } else {
                assert!(!matches!(op, PlotOp::DrawArc { .. }));
            }
            at = to;
        }
    }

    #[test]
    fn colours_are_pens_in_their_order() {
        let strokes = strokes(
            "<path d='M0 0h20' stroke='#00f'/><path d='M0 5h20' stroke='red'/><path d='M0 9h20' stroke='#00f'/>",
        );
        let pens: Vec<u8> = strokes
            .ops
            .iter()
            .filter_map(|op| if let PlotOp::SelectPen { pen } = op { Some(*pen) } else { None })
            .collect();
        assert_eq!(pens, [1, 2, 1]);
        assert_eq!(strokes.colours, [[0, 0, 255], [255, 0, 0]]);
    }

    #[test]
    fn what_is_not_drawn_is_said() {
        let strokes =
            strokes("<text x='1' y='2'>a</text>\n<rect width='5' height='5'/><rect width='5' height='4'/>");
        let said: Vec<String> = strokes.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "line 2, column 1: text is left out: convert it to paths",
                "2 shapes are filled without a stroke, and left out: give them a stroke, or hatch them",
            ]
        );
        assert!(strokes.ops.is_empty());
        assert!(svg_strokes(b"<svg", 0.01).unwrap_err().starts_with("line 1, column"));
    }
}
