//! [`svg`]: a drawing as a picture for the screen; [`svg_in_colour`]: with the colours of its pens.

use crate::stroke::curve::{Course, Segment};
use crate::{ink::Palette, picture::Rgb, stroke::Drawing};
use core::f64::consts::PI;
use core::fmt::{self, Write};

/// Most that one arc command spans, rad: nearer to half a circle the rounding of its radius would move its
/// middle.
const MOST_RAD: f64 = 2.0 * PI / 3.0;

/// Writes a drawing as SVG: the view box is the picture's size in px, y down, the centre of pixel (i, j) at
/// (i + 0.5, j + 0.5); one polyline a stroke, with round caps so that dots show; a path for a stroke with
/// arcs or cubic curves, a circle for a whole one. All pens are black, each in a group of its own, as with
/// [`svg_in_colour`].
///
/// # Errors
/// Those of the writer.
///
/// ```
/// # use plotter_vector::{Drawing, PxPoint, svg};
/// let mut drawing = Drawing::new(4, 3);
/// drawing.push([PxPoint::new(0.5, 1.5), PxPoint::new(3.5, 1.5)]);
/// let mut text = String::new();
/// svg(&drawing, 1.0, &mut text)?;
/// assert!(text.contains("viewBox=\"0 0 4 3\"") && text.contains("points=\"0.5,1.5 3.5,1.5\""));
/// # Ok::<(), std::fmt::Error>(())
/// ```
pub fn svg(drawing: &Drawing, stroke_width_px: f64, out: &mut impl Write) -> fmt::Result {
    svg_in_colour(drawing, &Palette::default(), None, stroke_width_px, out)
}

/// As [`svg`], with a group for each pen in the colour that the palette gives it: in ascending order of their
/// numbers, within each in the order of drawing. A pen that the palette does not have is black.
///
/// With `mm_per_px` the sheet is in true size, its width and height in mm; the view box stays the picture's
/// pixels.
///
/// # Errors
/// Those of the writer.
///
/// ```
/// # use plotter_vector::{Drawing, Palette, PxPoint, Rgb, ink::PalettePen, write::svg_in_colour};
/// let red = PalettePen { number: 2, name: "red".to_owned(), colour: Rgb([208, 24, 24]), width_mm: None };
/// let mut drawing = Drawing::new(4, 3);
/// drawing.push_with_pen(2, [PxPoint::new(0.5, 1.5), PxPoint::new(3.5, 1.5)]);
/// let mut text = String::new();
/// svg_in_colour(&drawing, &Palette::new(vec![red])?, Some(0.5), 1.0, &mut text)?;
/// assert!(text.contains("width=\"2mm\" height=\"1.5mm\" viewBox=\"0 0 4 3\""));
/// assert!(text.contains("stroke=\"#d01818\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn svg_in_colour(
    drawing: &Drawing,
    palette: &Palette,
    mm_per_px: Option<f64>,
    stroke_width_px: f64,
    out: &mut impl Write,
) -> fmt::Result {
    let (width, height) = (drawing.width_px(), drawing.height_px());
    let side = |px: u32| mm_per_px.map_or_else(|| px.to_string(), |mm_per_px| millimetres(px, mm_per_px));
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\">",
        side(width),
        side(height)
    )?;
    // A drawing without strokes has its group too.
    let pens = if drawing.strokes().len() == 0 { vec![1] } else { drawing.pens() };
    for pen in pens {
        let colour = palette.pen(pen).map_or(Rgb::BLACK, |pen| pen.colour);
        group(drawing, pen, colour, stroke_width_px, out)?;
    }
    out.write_str("</svg>\n")
}

/// A side of the sheet, to the millionth of a millimetre: rounded more, both sides would not be in the same
/// scale.
fn millimetres(px: u32, mm_per_px: f64) -> String {
    let text = format!("{:.6}", f64::from(px) * mm_per_px);
    format!("{}mm", text.trim_end_matches('0').trim_end_matches('.'))
}

/// The strokes of one pen.
fn group(drawing: &Drawing, pen: u8, colour: Rgb, stroke_width_px: f64, out: &mut impl Write) -> fmt::Result {
    let line = Short(stroke_width_px);
    let colour = if colour == Rgb::BLACK { "#000".to_owned() } else { colour.to_string() };
    writeln!(
        out,
        "<g fill=\"none\" stroke=\"{colour}\" stroke-width=\"{line}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">"
    )?;
    for (index, stroke) in drawing.strokes().enumerate().filter(|(index, _)| drawing.pen(*index) == pen) {
        let course = drawing.course(index);
        if !course.is_straight() {
            write_curve(course, out)?;
            continue;
        }
        out.write_str("<polyline points=\"")?;
        // A polyline of one vertex is not drawn; one that goes nowhere is, as a round dot.
        let dot = if stroke.len() == 1 { stroke } else { &[] };
        for (index, vertex) in stroke.iter().chain(dot).enumerate() {
            let space = if index == 0 { "" } else { " " };
            write!(out, "{space}{},{}", Short(vertex.x), Short(vertex.y))?;
        }
        out.write_str("\"/>\n")?;
    }
    out.write_str("</g>\n")
}

/// A stroke with arcs or cubic curves.
fn write_curve(course: Course<'_>, out: &mut impl Write) -> fmt::Result {
    if let Some((centre, radius_px)) = course.circle() {
        let (x, y, radius) = (Short(centre.x), Short(centre.y), Short(radius_px));
        return writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>");
    }
    let Some(first) = course.vertices.first() else { return Ok(()) };
    write!(out, "<path d=\"M{},{}", Short(first.x), Short(first.y))?;
    for segment in course.segments() {
        let to = segment.to();
        let arc = match segment {
            Segment::Line(..) => {
                write!(out, " L{},{}", Short(to.x), Short(to.y))?;
                continue;
            }
            Segment::Cubic(cubic) => {
                let [first, second] = cubic.handles;
                let (x, y) = (Short(to.x), Short(to.y));
                write!(out, " C{},{} ", Short(first.x), Short(first.y))?;
                write!(out, "{},{} {x},{y}", Short(second.x), Short(second.y))?;
                continue;
            }
            Segment::Arc(arc) => arc,
        };
        let (radius, sweep) = (Short(arc.radius_px), u8::from(arc.sweep_rad > 0.0));
        let parts = libm::ceil(arc.sweep_rad.abs() / MOST_RAD).max(1.0);
        let mut part = 1.0;
        while part <= parts {
            let to = if part < parts { arc.at(part / parts) } else { to };
            write!(out, " A{radius} {radius} 0 0 {sweep} {},{}", Short(to.x), Short(to.y))?;
            part += 1.0;
        }
    }
    out.write_str("\"/>\n")
}

/// A number with at most three decimals and no trailing zeros.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.3}", self.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::{Curve, PxPoint};

    #[test]
    fn numbers_are_short() {
        let text = |number| Short(number).to_string();
        assert_eq!(
            [text(12.5), text(100.0), text(0.125), text(-0.0001), text(1.0 / 3.0)],
            ["12.5", "100", "0.125", "0", "0.333"]
        );
    }

    #[test]
    fn each_pen_has_one_group() {
        let mut drawing = Drawing::new(8, 6);
        for pen in [2, 1, 2] {
            drawing.push_with_pen(pen, [PxPoint::new(f64::from(pen), 0.5)]);
        }
        let mut text = String::new();
        svg(&drawing, 1.0, &mut text).unwrap();
        assert_eq!(text.matches("<g ").count(), 2);
        assert!(text.find("1,0.5") < text.find("2,0.5"), "{text}");
    }

    #[test]
    fn arcs_are_written_as_paths_and_circles() {
        let at = PxPoint::new;
        let mut drawing = Drawing::new(20, 20);
        let quarter = 2.0_f64.sqrt() - 1.0;
        drawing.push_curve(
            1,
            Curve {
                vertices: vec![at(1.0, 9.0), at(1.0, 5.0), at(5.0, 1.0), at(9.0, 1.0)],
                bulges: vec![0.0, quarter, 0.0],
                ..Curve::default()
            },
        );
        // Three quarters of a circle, the other way round: two arcs of 135 degrees.
        let bulges = vec![-(1.0 + quarter) / (1.0 - quarter)];
        let vertices = vec![at(15.0, 10.0), at(10.0, 15.0)];
        drawing.push_curve(1, Curve { vertices, bulges, ..Curve::default() });
        let (left, right) = (at(2.0, 12.0), at(5.0, 12.0));
        let vertices = vec![left, right, left];
        drawing.push_curve(1, Curve { vertices, bulges: vec![1.0, 1.0], ..Curve::default() });
        drawing.push([left, right]);
        let mut text = String::new();
        svg(&drawing, 1.0, &mut text).unwrap();
        insta::assert_snapshot!(text);
    }

    #[test]
    fn cubic_curves_are_written_as_paths() {
        let at = PxPoint::new;
        let vertices = vec![at(1.0, 9.0), at(3.0, 9.0), at(9.0, 3.0)];
        let handles = vec![None, Some([at(6.5, 9.0), at(9.0, 6.25)])];
        let mut drawing = Drawing::new(10, 10);
        drawing.push_curve(1, Curve { vertices, handles, ..Curve::default() });
        let mut text = String::new();
        svg(&drawing, 1.0, &mut text).unwrap();
        assert!(text.contains("<path d=\"M1,9 L3,9 C6.5,9 9,6.25 9,3\"/>"), "{text}");
    }

    #[test]
    fn a_drawing_is_written_as_polylines() {
        let mut drawing = Drawing::new(8, 6);
        drawing.push([PxPoint::new(0.5, 0.5), PxPoint::new(7.5, 0.5), PxPoint::new(7.5, 5.5)]);
        drawing.push([PxPoint::new(2.5, 3.5)]);
        let mut text = String::new();
        svg(&drawing, 1.5, &mut text).unwrap();
        insta::assert_snapshot!(text);
    }
}
