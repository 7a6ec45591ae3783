//! [`hpgl`]: a drawing as a plotter file.

use crate::{Drawing, Scale};
use core::fmt::{self, Write};

/// Plotter units per mm: one unit is 0.025 mm.
///
/// Source: HP 7475A "Interfacing and Programming Manual", plotter units.
const UNITS_PER_MM: f64 = 40.0;

/// Writes a drawing as HPGL, a line a stroke: `IN;SP1;`, then `PU x,y;PD x,y,…;` in plotter units, and `PU;SP0;` at
/// the end. Vertices that fall on the same unit as the one before are written once.
///
/// # Errors
/// Those of the writer.
///
/// ```
/// # use plotter_vector::{Drawing, PxPoint, Scale, hpgl};
/// use plotter_motion::Point;
/// let mut drawing = Drawing::new(20, 10);
/// drawing.push([PxPoint::new(0.0, 10.0), PxPoint::new(20.0, 0.0)]);
/// let mut text = String::new();
/// hpgl(&drawing, Scale::new(10, 0.5, Point::ORIGIN)?, &mut text)?;
/// assert_eq!(text, "IN;SP1;\nPU0,0;PD400,200;\nPU;SP0;\n"); // 20 px are 10 mm are 400 units
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hpgl(drawing: &Drawing, scale: Scale, out: &mut impl Write) -> fmt::Result {
    out.write_str("IN;SP1;\n")?;
    for stroke in drawing.strokes() {
        let mut units = stroke.iter().map(|vertex| {
            let at = scale.to_sheet(*vertex);
            (units(at.x), units(at.y))
        });
        let Some((x, y)) = units.next() else { continue };
        write!(out, "PU{x},{y};PD")?;
        let mut pen = (x, y);
        let mut separator = "";
        for (x, y) in units {
            if (x, y) != pen {
                write!(out, "{separator}{x},{y}")?;
                pen = (x, y);
                separator = ",";
            }
        }
        if separator.is_empty() {
            write!(out, "{x},{y}")?; // A dot: down where the pen stands.
        }
        out.write_str(";\n")?;
    }
    out.write_str("PU;SP0;\n")
}

/// Plotter units of a coordinate, to nearest, halves away from zero; saturates.
#[expect(clippy::cast_possible_truncation, reason = "a float cast saturates, and the value is whole")]
fn units(mm: f64) -> i32 {
    libm::round(mm * UNITS_PER_MM) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PxPoint;
    use plotter_motion::Point;

    #[test]
    fn dots_and_strokes_are_written_in_plotter_units() {
        let mut drawing = Drawing::new(8, 6);
        drawing.push([PxPoint::new(0.5, 0.5), PxPoint::new(7.5, 0.5), PxPoint::new(7.5, 5.5)]);
        drawing.push([PxPoint::new(2.5, 3.5)]);
        let mut text = String::new();
        hpgl(&drawing, Scale::new(6, 1.0, Point::ORIGIN).unwrap(), &mut text).unwrap();
        insta::assert_snapshot!(text);
    }
}
