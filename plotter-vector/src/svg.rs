//! [`svg`]: a drawing as a picture for the screen.

use crate::Drawing;
use core::fmt::{self, Write};

/// Writes a drawing as SVG: the view box is the picture's size in px, y down, the centre of pixel (i, j) at
/// (i + 0.5, j + 0.5); one polyline a stroke, with round caps so that dots show.
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
    let (width, height) = (drawing.width_px(), drawing.height_px());
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">"
    )?;
    let line = Short(stroke_width_px);
    writeln!(
        out,
        "<g fill=\"none\" stroke=\"#000\" stroke-width=\"{line}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">"
    )?;
    for stroke in drawing.strokes() {
        out.write_str("<polyline points=\"")?;
        // A polyline of one vertex is not drawn; one that goes nowhere is, as a round dot.
        let dot = if stroke.len() == 1 { stroke } else { &[] };
        for (index, vertex) in stroke.iter().chain(dot).enumerate() {
            let space = if index == 0 { "" } else { " " };
            write!(out, "{space}{},{}", Short(vertex.x), Short(vertex.y))?;
        }
        out.write_str("\"/>\n")?;
    }
    out.write_str("</g>\n</svg>\n")
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
    use crate::PxPoint;

    #[test]
    fn numbers_are_short() {
        let text = |number| Short(number).to_string();
        assert_eq!(
            [text(12.5), text(100.0), text(0.125), text(-0.0001), text(1.0 / 3.0)],
            ["12.5", "100", "0.125", "0", "0.333"]
        );
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
