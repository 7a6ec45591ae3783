//! The drawing that is plotted where none is given.

use std::fmt::Write as _;

/// A spiral with pen 1, a hatched square and a circle with pen 2, and letters with pen 3, in HPGL.
pub(super) fn built_in() -> String {
    let mut text = String::from("IN;SP1;");
    for point in 0..=720_u32 {
        // Five turns out to 72.5 mm, in 144 lines each; the centre lies at (95, 95) mm.
        let turn_rad = f64::from(point) * std::f64::consts::TAU / 144.0;
        let radius_units = f64::from(point) * 2900.0 / 720.0;
        let (x, y) =
            (3800.0 + radius_units * libm::cos(turn_rad), 3800.0 + radius_units * libm::sin(turn_rad));
        let _ = write!(text, "{}{:.0},{:.0};", if point == 0 { "PU" } else { "PD" }, x, y);
    }
    text.push_str("PU;SP2;PU7600,960;FT3,200,45;RA12600,5960;EA12600,5960;PU10100,7200;CI800;");
    text.push_str("SP3;PU960,9200;SI1.6,2.4;LBSTEP BY STEP\x03;PU;SP0;");
    text
}
