//! [`hpgl`]: a drawing as a plotter file.

use crate::stroke::stroke_op::stroke_ops;
use crate::stroke::{Drawing, Scale};
use core::f64::consts::PI;
use core::fmt::Write;
use plotter_motion::hpgl::{UNITS_PER_MM, WriteError, Writer};
use plotter_motion::{PenMove, PlotOp};

/// Writes a drawing as HPGL in plotter units of 0.025 mm. Vertices that fall on the same unit as the one
/// before are written once. Each change of pen is an `SP`. Arcs are `AA`, a circle is a `CI` about its
/// centre: see [`Writer`]. The language of these plotters knows no cubic curves: they are chords no farther
/// than 0.02 px from them.
///
/// # Errors
/// [`WriteError`]: a point farther out than a plotter's numbers go, or an error of `out`.
///
/// ```
/// # use plotter_vector::{Drawing, PxPoint, Scale, hpgl};
/// use plotter_motion::Point;
/// let mut drawing = Drawing::new(20, 10);
/// drawing.push([PxPoint::new(0.0, 10.0), PxPoint::new(20.0, 0.0)]);
/// let mut text = String::new();
/// hpgl(&drawing, Scale::new(10, 0.5, Point::ORIGIN)?, &mut text)?;
/// assert!(text.contains("PU0,0;\nPD400,200;\n")); // 20 px are 10 mm are 400 units
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hpgl(drawing: &Drawing, scale: Scale, out: &mut impl Write) -> Result<(), WriteError> {
    let mut writer = Writer::new(out);
    for index in 0..drawing.strokes().len() {
        if let Some(select) = drawing.select_pen(index) {
            writer.push(select)?;
        }
        if let Some((centre, radius_px)) = drawing.course(index).circle() {
            writer.circle(scale.to_sheet(centre), radius_px * scale.mm_per_px())?;
            continue;
        }
        let mut before = None;
        let mut dot = false;
        for op in stroke_ops(drawing, index, scale) {
            let Some(to) = op.target() else { continue };
            let place = PenMove::from_op(PlotOp::Travel { to }, UNITS_PER_MM).map(|to| to.target);
            let travel = matches!(op, PlotOp::Travel { .. });
            // The first vertex after a travel may be a dot, which stays.
            let repeated = place == before && !travel && !dot;
            before = place;
            dot = travel;
            // Most of a turn may well end where it began.
            if !repeated || matches!(op, PlotOp::DrawArc { sweep_rad, .. } if sweep_rad.abs() > PI) {
                writer.push(op)?;
            }
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
    fn a_stroke_that_begins_where_the_last_one_ended_stays_a_stroke() {
        let mut drawing = Drawing::new(4, 4);
        let corner = PxPoint::new(4.0, 4.0);
        drawing.push([PxPoint::new(0.0, 4.0), corner]);
        drawing.push([corner, PxPoint::new(4.0, 0.0)]);
        let mut text = String::new();
        hpgl(&drawing, Scale::new(4, 1.0, Point::ORIGIN).unwrap(), &mut text).unwrap();
        assert!(text.contains("PU0,0;\nPD160,0;\nPU160,0;\nPD160,160;\n"), "{text}");
    }

    #[test]
    fn each_change_of_pen_is_written() {
        let mut drawing = Drawing::new(4, 4);
        let line = |y| [PxPoint::new(0.0, y), PxPoint::new(4.0, y)];
        drawing.push(line(4.0));
        drawing.push_with_pen(2, line(3.0));
        drawing.push_with_pen(2, line(2.0));
        let mut text = String::new();
        hpgl(&drawing, Scale::new(4, 1.0, Point::ORIGIN).unwrap(), &mut text).unwrap();
        assert_eq!(
            text,
            "IN;\nSP1;\nPU0,0;\nPD160,0;\nPU;\nSP2;\nPU0,40;\nPD160,40;\nPU0,80;\nPD160,80;\nPU;\nSP0;\n"
        );
    }

    #[test]
    fn arcs_and_circles_are_left_to_the_plotter() {
        let at = PxPoint::new;
        let mut drawing = Drawing::new(20, 10);
        // Right, half a circle down (clockwise as seen), back.
        let vertices = vec![at(2.0, 2.0), at(12.0, 2.0), at(12.0, 8.0), at(2.0, 8.0)];
        drawing.push_curve(1, Curve { vertices, bulges: vec![0.0, 1.0], ..Curve::default() });
        let vertices = vec![at(14.0, 5.0), at(18.0, 5.0), at(14.0, 5.0)];
        drawing.push_curve(1, Curve { vertices, bulges: vec![-1.0, -1.0], ..Curve::default() });
        let mut text = String::new();
        hpgl(&drawing, Scale::new(10, 1.0, Point::ORIGIN).unwrap(), &mut text).unwrap();
        assert_eq!(
            text,
            "IN;\nSP1;\nPU80,320;\nPD480,320;\nAA480,200,-90;\nPD600,200;\nAA480,200,-90;\nPD480,80,80,80;\n\
             PU640,200;\nCI80;\nPU;\nSP0;\n"
        );
    }

    #[test]
    fn dots_and_strokes_are_written_in_plotter_units() {
        let mut drawing = Drawing::new(8, 6);
        let corner = PxPoint::new(7.5, 0.5);
        drawing.push([PxPoint::new(0.5, 0.5), corner, PxPoint::new(7.51, 0.5), PxPoint::new(7.5, 5.5)]);
        drawing.push([PxPoint::new(2.5, 3.5)]);
        let mut text = String::new();
        hpgl(&drawing, Scale::new(6, 1.0, Point::ORIGIN).unwrap(), &mut text).unwrap();
        insta::assert_snapshot!(text);
    }
}
