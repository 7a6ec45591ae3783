//! [`SvgText`]: plot operations as an SVG of strokes.

use crate::shared::pen_colour;
use plotter_motion::{PlotOp, Point};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Line width, mm.
const PEN_MM: f64 = 0.3;

/// A turn that is nearly whole has two ends in one place, which an SVG's arc cannot say, rad.
const NEARLY_WHOLE_RAD: f64 = 0.9 * TAU;

/// How the groups of pens are called.
pub(super) const PEN_GROUP: &str = "pen-";

/// Gathers strokes, one path each, in a group from one change of the pen to the next. Millimetres from the
/// lower left corner of the picture, which lies at the origin, or farther left and down if something is drawn
/// there; arcs stay arcs.
#[derive(Clone, Debug, Default)]
pub struct SvgText {
    /// What is drawn with one pen, in the order of drawing.
    groups: Vec<(u8, String)>,
    pen: u8,
    at: Point,
    stroke: String,
    bounds: Option<(Point, Point)>,
    sheet_mm: Option<(f64, f64)>,
}

impl SvgText {
    /// An empty sheet with pen 1.
    #[must_use]
    pub fn new() -> Self {
        Self { pen: 1, ..Self::default() }
    }

    /// A sheet of this width and height, mm, with its lower left corner at the origin: as large stays the
    /// picture, whatever is drawn.
    #[must_use]
    pub fn on_sheet(self, sheet_mm: Option<(f64, f64)>) -> Self {
        Self { sheet_mm, ..self }
    }

    /// Takes the next operation. What neither moves the pen nor changes it leaves no mark.
    pub fn push(&mut self, op: PlotOp) {
        match op {
            PlotOp::Travel { to } => {
                self.end();
                self.at = to;
            }
            PlotOp::Draw { to, .. } => {
                self.begin();
                self.line(to);
            }
            PlotOp::DrawArc { centre, sweep_rad, to, .. } => {
                self.begin();
                let out = self.at - centre;
                // An arc whose ends are unequally far from its centre is none in SVG; nor is one without a
                // radius.
                let radius_mm = out.length();
                if (radius_mm - to.distance(centre)).abs() > 0.01 || radius_mm < 1e-6 {
                    let arc = [PlotOp::Travel { to: self.at }, op];
                    for place in
                        plotter_motion::toolpath::chords(arc, 0.01).skip(1).filter_map(PlotOp::target)
                    {
                        self.line(place);
                    }
                    return;
                }
                if sweep_rad.abs() > NEARLY_WHOLE_RAD {
                    self.arc(centre, 0.5 * sweep_rad, centre + out.rotated(0.5 * sweep_rad), radius_mm);
                    self.arc(centre, 0.5 * sweep_rad, to, radius_mm);
                } else {
                    self.arc(centre, sweep_rad, to, radius_mm);
                }
            }
            PlotOp::SelectPen { pen } => {
                self.end();
                self.pen = pen;
            }
            _ => {}
        }
    }

    fn begin(&mut self) {
        if self.stroke.is_empty() {
            self.grow(self.at);
            let Point { x, y } = self.at;
            let _ = write!(self.stroke, "M{} {}", short(x), short(y));
        }
    }

    fn line(&mut self, to: Point) {
        self.grow(to);
        let _ = write!(self.stroke, "L{} {}", short(to.x), short(to.y));
        self.at = to;
    }

    fn arc(&mut self, centre: Point, sweep_rad: f64, to: Point, radius_mm: f64) {
        let arc =
            [PlotOp::Travel { to: self.at }, PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None }];
        for place in plotter_motion::toolpath::chords(arc, 0.1).skip(1).filter_map(PlotOp::target) {
            self.grow(place);
        }
        let large = u8::from(sweep_rad.abs() > 0.5 * TAU);
        // The pen's group turns the picture upside down, and the sense of arcs with it.
        let positive = u8::from(sweep_rad > 0.0);
        let (radius, x, y) = (short(radius_mm), short(to.x), short(to.y));
        let _ = write!(self.stroke, "A{radius} {radius} 0 {large} {positive} {x} {y}");
        self.at = to;
    }

    fn grow(&mut self, place: Point) {
        let (least, most) = self.bounds.unwrap_or((place, place));
        self.bounds = Some((
            Point::new(least.x.min(place.x), least.y.min(place.y)),
            Point::new(most.x.max(place.x), most.y.max(place.y)),
        ));
    }

    fn end(&mut self) {
        if !self.stroke.is_empty() {
            if self.groups.last().is_none_or(|(pen, _)| *pen != self.pen) {
                self.groups.push((self.pen, String::new()));
            }
            if let Some((_, strokes)) = self.groups.last_mut() {
                let _ = writeln!(strokes, "<path d=\"{}\"/>", self.stroke);
            }
            self.stroke.clear();
        }
    }

    /// Where the lower left corner of the picture lies, mm.
    #[must_use]
    pub fn corner(&self) -> Point {
        if self.sheet_mm.is_some() {
            return Point::ORIGIN;
        }
        let (least, _) = self.bounds.unwrap_or_default();
        // What is written as 0 is none below it.
        let below = |at: f64| if at < -0.5 * DIGIT_MM { at } else { 0.0 };
        Point::new(below(least.x), below(least.y))
    }

    /// The picture.
    #[must_use]
    pub fn finish(mut self, colours: &[[u8; 3]]) -> String {
        self.end();
        let corner = self.corner();
        let (_, most) = self.bounds.unwrap_or_default();
        let (width, height) = self.sheet_mm.unwrap_or_else(|| {
            let side = |length_mm: f64| (length_mm + PEN_MM).ceil().max(1.0);
            (side(most.x - corner.x), side(most.y - corner.y))
        });
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" viewBox=\"{} {} {} {}\">\n",
            short(width),
            short(height),
            short(corner.x),
            short(-corner.y - height),
            short(width),
            short(height)
        );
        let mut turns = BTreeMap::new();
        for (pen, strokes) in &self.groups {
            let turn = turns.entry(*pen).and_modify(|turn| *turn += 1).or_insert(1);
            let (name, colour) = (name_of_group(*pen, *turn), pen_colour(*pen, colours));
            let _ = writeln!(
                svg,
                "<g id=\"{name}\" transform=\"scale(1 -1)\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{PEN_MM}\" \
                 stroke-linecap=\"round\" stroke-linejoin=\"round\">\n{strokes}</g>"
            );
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// The name of the group of a pen, from 1, that is taken for the first, the second, … time.
fn name_of_group(pen: u8, turn: u32) -> String {
    if turn == 1 { format!("{PEN_GROUP}{pen}") } else { format!("{PEN_GROUP}{pen}-{turn}") }
}

/// The pen whose group has this name.
pub(super) fn pen_of_group(name: &str) -> Option<u8> {
    let name = name.strip_prefix(PEN_GROUP)?;
    let (pen, turn) = name.split_once('-').unwrap_or((name, "1"));
    let is_turn = turn.parse::<u32>().is_ok();
    pen.parse().ok().filter(|pen| *pen > 0 && is_turn)
}

/// What the last digit of a number is worth that is written, mm.
const DIGIT_MM: f64 = 1e-4;

/// With at most four decimals, and no zeros behind them.
fn short(number: f64) -> String {
    let text = format!("{number:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_are_paths_in_the_group_of_their_pen() {
        let mut text = SvgText::new();
        text.push(PlotOp::SelectPen { pen: 2 });
        text.push(PlotOp::Travel { to: Point::new(10.0, 5.0) });
        text.push(PlotOp::Draw { to: Point::new(20.5, 5.0), feed_mm_s: None });
        text.push(PlotOp::SelectPen { pen: 1 });
        let quarter = std::f64::consts::FRAC_PI_2;
        let to = Point::new(15.5, 10.0);
        text.push(PlotOp::DrawArc { centre: Point::new(15.5, 5.0), sweep_rad: quarter, to, feed_mm_s: None });
        let svg = text.finish(&[]);
        assert!(svg.contains("width=\"21mm\" height=\"11mm\" viewBox=\"0 -11 21 11\""), "{svg}");
        assert!(
            svg.contains("<g id=\"pen-2\" transform=\"scale(1 -1)\" fill=\"none\" stroke=\"#c62828\""),
            "{svg}"
        );
        assert!(svg.contains("<path d=\"M10 5L20.5 5\"/>"), "{svg}");
        assert!(svg.contains("<path d=\"M20.5 5A5 5 0 0 1 15.5 10\"/>"), "{svg}");
    }

    #[test]
    fn a_pen_that_is_taken_again_has_a_group_more() {
        let mut text = SvgText::new();
        for (pen, y) in [(1, 1.0), (2, 2.0), (1, 3.0), (1, 4.0), (2, 5.0)] {
            text.push(PlotOp::SelectPen { pen });
            text.push(PlotOp::Travel { to: Point::new(0.0, y) });
            text.push(PlotOp::Draw { to: Point::new(9.0, y), feed_mm_s: None });
        }
        let svg = text.finish(&[]);
        let ids: Vec<&str> =
            svg.split("<g id=\"").skip(1).filter_map(|group| group.split('"').next()).collect();
        assert_eq!(ids, ["pen-1", "pen-2", "pen-1-2", "pen-2-2"]);
        assert_eq!(
            ids.iter().map(|id| pen_of_group(id)).collect::<Option<Vec<u8>>>(),
            Some(vec![1, 2, 1, 2])
        );
        // The lines at 3 and 4 mm are in one group.
        let paths: Vec<usize> =
            svg.split("<g ").skip(1).map(|group| group.matches("<path").count()).collect();
        assert_eq!(paths, [1, 1, 2, 1]);
        for name in ["pen-0", "pen-256", "pen-", "pen-1-", "pen-1-x", "pen-x", "ink-1"] {
            assert_eq!(pen_of_group(name), None, "{name}");
        }
    }

    #[test]
    fn a_sheet_stays_as_large_as_it_is() {
        let mut text = SvgText::new().on_sheet(Some((210.0, 297.0)));
        text.push(PlotOp::Draw { to: Point::new(-3.0, 300.0), feed_mm_s: None });
        assert_eq!(text.corner(), Point::ORIGIN);
        assert!(text.finish(&[]).contains("width=\"210mm\" height=\"297mm\" viewBox=\"0 -297 210 297\""));
    }

    #[test]
    fn what_rounding_puts_below_the_origin_is_at_it() {
        let mut text = SvgText::new();
        text.push(PlotOp::Draw { to: Point::new(-1e-14, -4e-5), feed_mm_s: None });
        assert_eq!(text.corner(), Point::ORIGIN);
    }

    #[test]
    fn what_lies_below_the_origin_widens_the_picture() {
        let mut text = SvgText::new();
        text.push(PlotOp::Draw { to: Point::new(-3.0, -2.0), feed_mm_s: None });
        assert!(text.finish(&[]).contains("viewBox=\"-3 -1 4 3\""));
    }
}
