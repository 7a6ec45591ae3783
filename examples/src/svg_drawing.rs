//! [`svg_drawing`]: what an SVG picture has to draw, as plot operations.

use crate::{Diagnostic, Severity, usual_colour};
use plotter_motion::PlotOp;
use plotter_vector::{SvgLeftOut, SvgOptions, SvgPens, read_svg};

/// Finest and coarsest that curves of an SVG are cut into chords, mm: single precision, in which they are parsed, says no more.
const TOLERANCES_MM: (f64, f64) = (0.001, 10.0);

/// How the groups of pens are called in the SVG that [`SvgText`](crate::SvgText) writes.
const PEN_GROUP: &str = "pen-";

/// What an SVG picture has to draw.
#[derive(Debug, Default)]
pub struct SvgOps {
    /// The strokes, mm from the sheet's lower left corner.
    pub ops: Vec<PlotOp>,
    /// What cannot be drawn.
    pub diagnostics: Vec<Diagnostic>,
    /// Colour of each pen from 1 on: red, green, blue.
    pub colours: Vec<[u8; 3]>,
}

/// What an SVG picture has to draw; [`read_svg`] says what becomes of it. Arcs stay arcs.
///
/// Each colour is a pen, in the order in which they come; in a picture that was written here, of which each pen is a group, the pens
/// are those that they were.
///
/// # Errors
///
/// What is wrong with the file, and where.
pub fn svg_drawing(bytes: &[u8], tolerance_mm: f64) -> Result<SvgOps, String> {
    let (least, most) = TOLERANCES_MM;
    let options =
        SvgOptions { tolerance_mm: tolerance_mm.clamp(least, most), arcs: true, ..SvgOptions::default() };
    let read = |pens| {
        let error = |error: plotter_vector::SvgError| {
            let text = error.to_string();
            text.strip_prefix("svg: ").or(text.strip_prefix("svg, ")).unwrap_or(&text).to_owned()
        };
        read_svg(bytes, &SvgOptions { pens, ..options }).map_err(error)
    };
    let may_name_pens = bytes.windows(PEN_GROUP.len()).any(|word| word == PEN_GROUP.as_bytes());
    let by_groups = if may_name_pens { Some(read(SvgPens::ByLayer)?) } else { None };
    let by_groups = by_groups.and_then(|svg| {
        let numbers: Option<Vec<u8>> = svg.pens.iter().map(|pen| pen_of_group(&pen.name)).collect();
        numbers.filter(|numbers| !numbers.is_empty()).map(|numbers| (svg, numbers))
    });
    let (svg, numbers) = match by_groups {
        Some(found) => found,
        None => {
            let svg = read(SvgPens::ByColour)?;
            let numbers = svg.pens.iter().map(|pen| pen.number).collect();
            (svg, numbers)
        }
    };
    let most_pen = numbers.iter().copied().max().unwrap_or(0);
    let mut colours: Vec<[u8; 3]> = (1..=most_pen).map(usual_colour).collect();
    let number_of = |pen: u8| {
        let found = svg.pens.iter().zip(&numbers).find(|(known, _)| known.number == pen);
        found.map_or(pen, |(_, number)| *number)
    };
    for (pen, number) in svg.pens.iter().zip(&numbers) {
        if let Some(colour) = colours.get_mut(usize::from(*number).saturating_sub(1)) {
            *colour = pen.colour.0;
        }
    }
    // The drawing does not select its first pen where all is drawn by it.
    let mut ops = Vec::new();
    if let [only] = numbers[..] {
        ops.push(PlotOp::SelectPen { pen: only });
    }
    ops.extend(svg.drawing.plot_ops_with_arcs(svg.scale).map(|op| match op {
        PlotOp::SelectPen { pen } => PlotOp::SelectPen { pen: number_of(pen) },
        op => op,
    }));
    Ok(SvgOps { ops, diagnostics: left_out(&svg.left_out), colours })
}

/// The pen that a group is of, by its name.
fn pen_of_group(name: &str) -> Option<u8> {
    name.strip_prefix(PEN_GROUP)?.parse().ok().filter(|pen| *pen > 0)
}

fn left_out(left_out: &SvgLeftOut) -> Vec<Diagnostic> {
    let SvgLeftOut { texts, text_line, images, image_line, clip_paths, masks, filters, paper } = *left_out;
    [
        (texts, text_line, "text", "left out: convert it to paths"),
        (images, image_line, "picture", "left out: trace it"),
        (clip_paths, None, "clip path", "without effect: what it cuts off is drawn"),
        (masks, None, "mask", "without effect: what it hides is drawn"),
        (filters, None, "filter", "without effect"),
        (paper, None, "white shape", "left out: it leaves no ink on white paper"),
    ]
    .into_iter()
    .filter(|(count, ..)| *count > 0)
    .map(|(count, line, what, remedy)| {
        let text =
            if count == 1 { format!("a {what} is {remedy}") } else { format!("{count} {what}s: {remedy}") };
        Diagnostic { line, ..Diagnostic::new(Severity::Notice, text) }
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::Point;
    use std::f64::consts::TAU;

    /// What single precision leaves of a coordinate of some hundred pixels.
    const ROUNDING_MM: f64 = 1e-4;

    fn drawing(body: &str) -> SvgOps {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"5cm\" viewBox=\"0 0 200 100\">\n{body}\n</svg>"
        );
        svg_drawing(text.as_bytes(), 0.01).unwrap()
    }

    fn pens(drawing: &SvgOps) -> Vec<u8> {
        let pen = |op: &PlotOp| if let PlotOp::SelectPen { pen } = op { Some(*pen) } else { None };
        drawing.ops.iter().filter_map(pen).collect()
    }

    #[test]
    fn units_view_box_and_transforms_count() {
        let drawing = drawing("<g transform='translate(10 20)'><path d='M0 0h20' stroke='#f00'/></g>");
        let places: Vec<Point> = drawing.ops.iter().filter_map(|op| op.target()).collect();
        assert_eq!((&drawing.colours[..], pens(&drawing)), (&[[255, 0, 0]][..], vec![1]));
        assert!(places[0].distance(Point::new(5.0, 40.0)) < ROUNDING_MM, "{places:?}");
        assert!(places[1].distance(Point::new(15.0, 40.0)) < ROUNDING_MM, "{places:?}");
    }

    #[test]
    fn a_circle_stays_arcs_and_an_ellipse_is_lines() {
        let circle = drawing("<circle cx='100' cy='50' r='40' fill='none' stroke='black'/>");
        let mut turn_rad = 0.0;
        for op in &circle.ops {
            assert!(!matches!(op, PlotOp::Draw { .. }));
            if let PlotOp::DrawArc { centre, sweep_rad, .. } = op {
                assert!(centre.distance(Point::new(50.0, 25.0)) < 0.01, "{centre:?}");
                turn_rad += sweep_rad;
            }
        }
        assert!((turn_rad.abs() - TAU).abs() < 0.01, "{turn_rad}");
        let ellipse = drawing("<ellipse cx='100' cy='50' rx='40' ry='20' stroke='black'/>");
        assert!(!ellipse.ops.iter().any(|op| matches!(op, PlotOp::DrawArc { .. })));
    }

    #[test]
    fn colours_are_pens_unless_groups_say_which() {
        let colours = drawing(
            "<path d='M0 0h20' stroke='#00f'/><path d='M0 5h20' stroke='red'/><path d='M0 9h20' stroke='#00f'/>",
        );
        assert_eq!(pens(&colours), [1, 2, 1]);
        assert_eq!(colours.colours, [[0, 0, 255], [255, 0, 0]]);
        let groups = drawing(
            "<g id='pen-4' stroke='red'><path d='M0 0h20'/></g><g id='pen-2' stroke='red'><path d='M0 5h20'/></g>",
        );
        assert_eq!(pens(&groups), [4, 2]);
        assert_eq!(groups.colours, [usual_colour(1), [255, 0, 0], usual_colour(3), [255, 0, 0]]);
        assert_eq!(pens(&drawing("<g id='pen-3' stroke='red'><path d='M0 0h20'/></g>")), [3]);
    }

    #[test]
    fn what_is_not_drawn_is_said() {
        let drawing = drawing("<text x='1' y='2'>a</text>\n<rect width='5' height='5' fill='white'/>");
        let said: Vec<String> = drawing.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "line 2: a text is left out: convert it to paths",
                "a white shape is left out: it leaves no ink on white paper"
            ]
        );
        assert!(drawing.ops.is_empty());
        assert!(svg_drawing(b"<svg", 0.01).is_err());
    }
}
