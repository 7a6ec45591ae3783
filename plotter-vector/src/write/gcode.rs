//! [`gcode`]: a drawing as a program for GRBL and its like.

use crate::stroke::stroke_op::stroke_ops;
use crate::stroke::{Drawing, Scale};
use core::fmt::Write;
use plotter_motion::gcode::{WriteError, WriteOptions, Writer};

/// Writes a drawing as G-code in mm, y up; arcs as G2 and G3, a circle as two halves. Each change of pen is
/// asked for as the options say. A machine that knows no arcs takes [`Drawing::chords`]. Cubic curves, which
/// GRBL does not know, are chords no farther than 0.02 px from them.
///
/// # Errors
/// [`WriteError`]: a point or a speed that the options do not allow, or an error of `out`.
///
/// ```
/// # use plotter_vector::{Curve, Drawing, PxPoint, Scale, gcode};
/// use plotter_motion::{Point, gcode::WriteOptions};
/// let mut drawing = Drawing::new(20, 10);
/// // Half a circle over the top, clockwise.
/// let vertices = vec![PxPoint::new(2.0, 10.0), PxPoint::new(18.0, 10.0)];
/// drawing.push_curve(1, Curve { vertices, bulges: vec![1.0], ..Curve::default() });
/// let mut text = String::new();
/// gcode(&drawing, Scale::new(10, 0.5, Point::ORIGIN)?, WriteOptions::default(), &mut text)?;
/// assert!(text.contains("G0 X1 Y0\nM3 S90\nG4 P0.15\nG2 X9 Y0 I4 J0 F1800\nM5\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn gcode(
    drawing: &Drawing,
    scale: Scale,
    options: WriteOptions<'_>,
    out: &mut impl Write,
) -> Result<(), WriteError> {
    let mut writer = Writer::with_options(out, options);
    for index in 0..drawing.strokes().len() {
        if let Some(select) = drawing.select_pen(index) {
            writer.push(select)?;
        }
        for op in stroke_ops(drawing, index, scale) {
            writer.push(op)?;
        }
    }
    writer.finish().map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::{Curve, PxPoint};
    use plotter_motion::Point;

    #[test]
    fn lines_dots_circles_and_pens_are_written_in_millimetres() {
        let at = PxPoint::new;
        let mut drawing = Drawing::new(8, 6);
        drawing.push([at(0.5, 0.5), at(7.5, 0.5)]);
        drawing.push([at(2.5, 3.5)]);
        let vertices = vec![at(3.0, 3.0), at(5.0, 3.0), at(3.0, 3.0)];
        drawing.push_curve(2, Curve { vertices, bulges: vec![1.0, 1.0], ..Curve::default() });
        let mut text = String::new();
        gcode(&drawing, Scale::new(6, 1.0, Point::ORIGIN).unwrap(), WriteOptions::default(), &mut text)
            .unwrap();
        let lift = "M5\nG4 P0.15\n";
        let lower = "M3 S90\nG4 P0.15\n";
        assert_eq!(
            text,
            format!(
                "G21\nG90\nM5\n(pen 1)\nG0 X0.5 Y5.5\n{lower}G1 X7.5 Y5.5 F1800\n{lift}G0 X2.5 Y2.5\n{lower}{lift}\
                 M0 (pen 2)\nG0 X3 Y3\n{lower}G2 X5 Y3 I1 J0\nG2 X3 Y3 I-1 J0\n{lift}M2\n"
            )
        );
    }
}
