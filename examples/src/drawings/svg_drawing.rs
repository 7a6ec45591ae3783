//! [`svg_drawing`]: what an SVG picture has to draw, as plot operations.

use crate::drawings::svg_text::{PEN_GROUP, pen_of_group};
use crate::drawings::{Diagnostic, PensBy, Severity, SvgReading};
use crate::shared::usual_colour;
use plotter_motion::drawing::Hatching;
use plotter_motion::{PlotOp, Point};
use plotter_vector::{
    PxPoint, SvgOptions,
    svg_in::{SvgDrawing, SvgFonts, SvgLayer, SvgLeftOut, SvgPens, SvgWithoutPen, read_svg_with_fonts},
};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

/// Finest and coarsest that curves of an SVG are cut into chords, mm: single precision, in which they are
/// parsed, says no more.
const TOLERANCES_MM: (f64, f64) = (0.001, 10.0);

/// Farthest beyond the sheet that nobody is told of, mm.
const OUTSIDE_MM: f64 = 0.05;

/// What an SVG picture has to draw.
pub struct SvgOps {
    /// The strokes, mm from the sheet's lower left corner.
    pub ops: Box<dyn Iterator<Item = PlotOp>>,
    /// What cannot be drawn.
    pub diagnostics: Vec<Diagnostic>,
    /// Colour of each pen from 1 on: red, green, blue.
    pub colours: Vec<[u8; 3]>,
    /// Width and height of the sheet, mm.
    pub sheet_mm: (f64, f64),
    /// Name of each layer that draws, and the number of its first stroke, from 0.
    pub layers: Vec<(String, usize)>,
}

impl fmt::Debug for SvgOps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SvgOps").field("diagnostics", &self.diagnostics).finish_non_exhaustive()
    }
}

/// What an SVG picture has to draw; [`read_svg_with_fonts`] says what becomes of it. Arcs stay arcs.
///
/// Each colour is a pen, in the order in which they come, unless `how` says otherwise; in a picture that was
/// written here, the pens are those that they were. Where a layer asks for it,
/// the pen waits before it. `hatch` fills closed shapes, as large as the file has them.
///
/// # Errors
///
/// What is wrong with the file, and where.
pub fn svg_drawing(
    bytes: Cow<'_, [u8]>,
    tolerance_mm: f64,
    how: &SvgReading,
    fonts: &SvgFonts,
    hatch: Option<Hatching>,
) -> Result<SvgOps, String> {
    let (least, most) = TOLERANCES_MM;
    let options = SvgOptions::default()
        .with_tolerance_mm(tolerance_mm.clamp(least, most))
        .with_arcs(true)
        .with_paper(how.paper.0)
        .with_keeps_clipped(how.keep_clipped)
        .with_occludes(how.occlude)
        .with_hatch(hatch)
        .with_px_per_inch(how.px_per_inch);
    let read = |bytes: Cow<'_, [u8]>, pens| {
        let error = |error: plotter_vector::svg_in::SvgError| {
            let text = error.to_string();
            text.strip_prefix("svg: ").or(text.strip_prefix("svg, ")).unwrap_or(&text).to_owned()
        };
        read_svg_with_fonts(bytes, &options.with_pens(pens), fonts).map_err(error)
    };
    let may_name_pens = bytes.windows(PEN_GROUP.len()).any(|word| word == PEN_GROUP.as_bytes());
    let by_groups = if may_name_pens && how.pens.is_none() {
        Some(read(Cow::Borrowed(&bytes), SvgPens::ByLayer)?)
    } else {
        None
    };
    let by_groups = by_groups.and_then(|svg| {
        let numbers: Option<Vec<u8>> = svg.pens.iter().map(|pen| pen_of_group(&pen.name)).collect();
        numbers.filter(|numbers| !numbers.is_empty()).map(|numbers| (svg, numbers))
    });
    let (svg, numbers) = match by_groups {
        Some(found) => found,
        None => {
            let svg = read(bytes, how.pens.map_or(SvgPens::ByColour, SvgPens::from))?;
            let numbers = svg.pens.iter().map(|pen| pen.number).collect();
            (svg, numbers)
        }
    };
    let most_pen = numbers.iter().copied().max().unwrap_or(0);
    let mut colours: Vec<[u8; 3]> = (1..=most_pen).map(usual_colour).collect();
    for (pen, number) in svg.pens.iter().zip(&numbers) {
        if let Some(colour) = colours.get_mut(usize::from(*number).saturating_sub(1)) {
            *colour = pen.colour.0;
        }
    }
    let problems = svg.problems.iter().map(|problem| Diagnostic {
        line: Some(problem.line),
        column: Some(problem.column),
        ..Diagnostic::new(Severity::Warning, problem.text.clone())
    });
    let unfilled = (hatch.is_some() && svg.hatched == 0).then(crate::drawings::arrangement::nothing_filled);
    let diagnostics = problems
        .chain(left_out(&svg, how))
        .chain(of_layers(&svg))
        .chain(without_pen(&svg, how))
        .chain(beyond(&svg))
        .chain(unfilled)
        .collect();
    let mut layers: Vec<(String, usize)> =
        svg.layers.iter().filter_map(|layer| Some((layer.name.clone(), layer.first_stroke?))).collect();
    layers.sort_by_key(|(_, first)| *first);
    let sheet_mm = (svg.width_mm, svg.height_mm);
    Ok(SvgOps { ops: Box::new(ops(svg, numbers)), diagnostics, colours, sheet_mm, layers })
}

/// Its operations by pens of these numbers, one for each of its own; where a layer asks for it, the pen waits
/// before it.
fn ops(svg: SvgDrawing, numbers: Vec<u8>) -> impl Iterator<Item = PlotOp> {
    let SvgDrawing { drawing, scale, pens, layers, .. } = svg;
    let mut waits_ms: BTreeMap<usize, u32> = BTreeMap::new();
    for (stroke, ms) in layers.iter().filter_map(|layer| layer.first_stroke.zip(layer.delay_ms)) {
        let wait = waits_ms.entry(stroke).or_default();
        *wait = ms.max(*wait);
    }
    // Where all is drawn by the first pen, the drawing does not select it.
    let first = match (&pens[..], &numbers[..]) {
        ([pen], [only]) if pen.number <= 1 => Some(PlotOp::SelectPen { pen: *only }),
        _ => None,
    };
    let number_of = move |pen: u8| {
        let found = pens.iter().zip(&numbers).find(|(known, _)| known.number == pen);
        found.map_or(pen, |(_, number)| *number)
    };
    let mut stroke = 0;
    first.into_iter().chain(drawing.into_plot_ops_with_arcs(scale).flat_map(move |op| {
        let mut wait = None;
        if matches!(op, PlotOp::Travel { .. }) {
            let duration = |ms: u32| Duration::from_millis(ms.into());
            wait = waits_ms.remove(&stroke).map(|ms| PlotOp::Dwell { duration: duration(ms) });
            stroke += 1;
        }
        let op = match op {
            PlotOp::SelectPen { pen } => PlotOp::SelectPen { pen: number_of(pen) },
            op => op,
        };
        wait.into_iter().chain([op])
    }))
}

/// What the names of layers ask for and is not done here.
fn of_layers(svg: &SvgDrawing) -> Vec<Diagnostic> {
    let mut said = Vec::new();
    for layer in &svg.layers {
        let SvgLayer { name, is_left_out, pauses, speed_percent, height_percent, first_stroke, .. } = layer;
        if *is_left_out {
            said.push(format!("layer {name:?} is left out, as the % in its name asks"));
        }
        if first_stroke.is_none() {
            continue;
        }
        let asked = [
            pauses.then(|| "a pause before it (!)".to_owned()),
            speed_percent.map(|percent| format!("{percent} % of the speed (+S)")),
            height_percent.map(|percent| format!("{percent} % of the pen's height (+H)")),
        ];
        let asked: Vec<String> = asked.into_iter().flatten().collect();
        if !asked.is_empty() {
            said.push(format!(
                "layer {name:?} asks for {}, which is not done: set it at the machine",
                asked.join(" and ")
            ));
        }
    }
    said.into_iter().map(|text| Diagnostic::new(Severity::Notice, text)).collect()
}

fn left_out(svg: &SvgDrawing, how: &SvgReading) -> Vec<Diagnostic> {
    let SvgLeftOut { texts, text_line, images, image_line, clip_paths, masks, filters, occluded, paper, far } =
        svg.left_out;
    let remedy = |text| Cow::Borrowed(text);
    let paper_colour = how.paper.0.map_or_else(String::new, |colour| match colour {
        plotter_vector::Rgb::WHITE => "white".to_owned(),
        plotter_vector::Rgb::BLACK => "black".to_owned(),
        other => other.to_string(),
    });
    let in_paper = format!(
        "left out: it leaves no ink on {paper_colour} paper; give the paper's colour with --paper COLOUR, or --paper none to draw all"
    );
    let shape = format!("{paper_colour} shape");
    [
        (texts, text_line, "text", missing(svg, how)),
        (images, image_line, "picture", remedy("left out: trace it")),
        (
            clip_paths,
            None,
            "clip path",
            remedy("applied: what it cuts off is left out; --keep-clipped draws it"),
        ),
        (masks, None, "mask", remedy("applied: what it hides is left out; --keep-clipped draws it")),
        (occluded, None, "stroke", remedy("hidden by filled shapes, or a part of it is")),
        (filters, None, "filter", remedy("without effect")),
        (paper, None, &shape, in_paper.into()),
        (
            far,
            None,
            "shape",
            remedy("cut off 277 m from the corner of the sheet, beyond which no plotter draws: correct its places or its transform"),
        ),
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

/// That there are fewer pens than colours or layers.
fn without_pen(svg: &SvgDrawing, how: &SvgReading) -> Option<Diagnostic> {
    let SvgWithoutPen { kinds, shapes } = svg.without_pen;
    let (what, remedy) = match how.pens {
        None | Some(PensBy::Colour) => {
            ("colours", "draw with fewer colours, or give each layer a pen with --pens order")
        }
        Some(PensBy::Layer | PensBy::Order) => ("layers", "put several in one layer"),
    };
    (kinds > 0).then(|| {
        let pens = svg.pens.len();
        let text = format!(
            "{what} beyond the {pens} pens: {kinds}, with {shapes} shapes, which the pen of the nearest colour draws: {remedy}"
        );
        Diagnostic::new(Severity::Warning, text)
    })
}

/// What reaches beyond the sheet: shown by no viewer, and drawn all the same.
fn beyond(svg: &SvgDrawing) -> Option<Diagnostic> {
    let drawing = &svg.drawing;
    let [mut left, mut right, mut below, mut above] = [0.0_f64; 4];
    let mut see = |at: &PxPoint| {
        let Point { x, y } = svg.scale.to_sheet(*at);
        left = left.max(-x);
        right = right.max(x - svg.width_mm);
        below = below.max(-y);
        above = above.max(y - svg.height_mm);
    };
    for (index, stroke) in drawing.strokes().enumerate() {
        if drawing.bulges(index).is_empty() {
            stroke.iter().for_each(&mut see);
        } else {
            let chords = drawing.curve(index).chords(OUTSIDE_MM / svg.scale.mm_per_px());
            chords.iter().for_each(&mut see);
        }
    }
    let sides = [(left, "to the left of"), (right, "to the right of"), (below, "below"), (above, "above")];
    let told: Vec<String> = sides
        .into_iter()
        .filter(|(by_mm, _)| *by_mm > OUTSIDE_MM)
        .map(|(by_mm, side)| format!("{by_mm:.1} mm {side}"))
        .collect();
    if told.is_empty() {
        return None;
    }
    let text = format!(
        "the drawing reaches {} its sheet of {:.1} x {:.1} mm, and is drawn there too: make the sheet larger, or move the drawing",
        told.join(" and "),
        svg.width_mm,
        svg.height_mm
    );
    Some(Diagnostic::new(Severity::Warning, text))
}

/// What texts that are left out need.
fn missing(svg: &SvgDrawing, how: &SvgReading) -> Cow<'static, str> {
    let needs = &svg.missing_fonts;
    let families = needs.families.join(", ");
    if needs.letters.is_empty() && how.fonts.is_empty() {
        let wanted = if families.is_empty() { String::new() } else { format!(" ({families} is asked for)") };
        return format!("left out: give a font with --font FILE{wanted}, or --single-stroke").into();
    }
    let mut wanted = Vec::new();
    if !families.is_empty() {
        wanted.push(format!("no font {families} is given"));
    }
    if !needs.letters.is_empty() {
        let who = if how.fonts.single_stroke {
            "neither the letters of one line nor a font given"
        } else {
            "no font given"
        };
        wanted.push(format!("{who} has {}", needs.letters));
    }
    let else_by = if how.fonts.single_stroke { "convert it to paths" } else { "--single-stroke" };
    format!("left out: {}; give one with --font FILE, or {else_by}", wanted.join(", and ")).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// What single precision leaves of a coordinate of some hundred pixels.
    const ROUNDING_MM: f64 = 1e-4;

    /// The diagnostics and all operations.
    struct Drawn {
        ops: Vec<PlotOp>,
        diagnostics: Vec<Diagnostic>,
        colours: Vec<[u8; 3]>,
    }

    fn drawing(body: &str) -> Drawn {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"5cm\" viewBox=\"0 0 200 100\">\n{body}\n</svg>"
        );
        let bytes = text.as_bytes().into();
        let SvgOps { ops, diagnostics, colours, .. } =
            svg_drawing(bytes, 0.01, &SvgReading::default(), &SvgFonts::default(), None).unwrap();
        Drawn { ops: ops.collect(), diagnostics, colours }
    }

    fn pens(drawing: &Drawn) -> Vec<u8> {
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
    fn what_reaches_beyond_the_sheet_is_said_and_drawn() {
        // 88 x 51 mm on a sheet of 100 x 50.
        let high = drawing("<path d='M6 -1V101H182' fill='none' stroke='red'/>");
        let said: Vec<String> = high.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "the drawing reaches 0.5 mm below and 0.5 mm above its sheet of 100.0 x 50.0 mm, and is drawn there too: make \
              the sheet larger, or move the drawing"
            ]
        );
        assert_eq!(high.ops.iter().filter(|op| matches!(op, PlotOp::Draw { .. })).count(), 2);
        let whole = drawing("<rect width='200' height='100' fill='none' stroke='red'/>");
        assert_eq!(whole.diagnostics, []);
    }

    #[test]
    fn what_lies_too_far_away_is_said_and_cut_off() {
        let far = drawing("<path d='M0 50H1e9' fill='none' stroke='red'/>\n<path d='M0 20H9' stroke='red'/>");
        let said: Vec<String> = far.diagnostics.iter().map(ToString::to_string).collect();
        let cut = "a shape is cut off 277 m from the corner of the sheet, beyond which no plotter draws: correct its places or \
                   its transform";
        assert_eq!(said.iter().filter(|said| *said == cut).count(), 1, "{said:?}");
        assert_eq!(far.ops.iter().filter(|op| matches!(op, PlotOp::Draw { .. })).count(), 2);
    }

    #[test]
    fn what_is_not_drawn_is_said() {
        let drawing = drawing("<text x='1' y='2'>a</text>\n<rect width='5' height='5' fill='white'/>");
        let said: Vec<String> = drawing.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "line 2: a text is left out: give a font with --font FILE, or --single-stroke",
                "a white shape is left out: it leaves no ink on white paper; give the paper's colour with --paper COLOUR, or \
                 --paper none to draw all"
            ]
        );
        assert!(drawing.ops.is_empty());
        assert!(
            svg_drawing(b"<svg".into(), 0.01, &SvgReading::default(), &SvgFonts::default(), None).is_err()
        );
    }
}
