//! Marks that a tracer is tempted to drop as dirt, and strokes without a middle of even width.

use super::strokes::{Look, Picture, arc, polar};
use core::f64::consts::PI;

/// Dots, short dashes, crosses, tiny circles and commas of a 3 px pen.
pub(crate) fn small() -> Picture {
    let mut picture = Picture::new("small_marks", (400, 300), Look::Ink, 3.0);
    for place in 0..8_u32 {
        let at = f64::from(place);
        // Each mark sits a little differently on the pixels.
        let (x, slip) = (32.0 + 46.0 * at, 0.13 * at);
        picture.line(&[(x + slip, 28.0 - slip)]);
        let dash = 4.0 + 8.0 * at / 7.0;
        let angle = 0.4 * at;
        picture
            .line(&[polar((x, 70.0 + slip), -dash / 2.0, angle), polar((x, 70.0 + slip), dash / 2.0, angle)]);
        picture.through((x + slip, 118.0), 6.0 + at / 2.0, 11.0 * at);
        picture.through((x + slip, 118.0), 6.0 + at / 2.0, 11.0 * at + 90.0);
        picture.circle((x, 168.0 + slip), 3.0 + 5.0 * at / 7.0);
        // A comma: half a turn of growing radius.
        picture.line(&arc((x - 3.0, 214.0 + slip), 5.0 + 0.4 * at, -PI / 3.0, PI / 2.0));
    }
    picture.text((24.0, 244.0), 12.0, 0.0, "1:2.5 A.B-C 0.10");
    picture.text((24.0, 272.0), 14.0, 0.0, "R7 X40+0.1 ....");
    picture
}

/// Needles of 200 px that are 9 px broad at their base.
pub(crate) fn needles() -> Picture {
    let mut picture = Picture::new("sharp_ends", (560, 520), Look::Ink, 9.0);
    for (place, degrees) in (0_u32..).zip([0.0, 4.0, -9.0, -17.0, 26.0]) {
        let base = (30.4, 60.2 + 84.0 * f64::from(place));
        picture.needle(base, polar(base, 200.0, f64::to_radians(degrees)));
    }
    for (place, degrees) in (0_u32..).zip([90.0, 86.0, 97.0, 75.0]) {
        let base = (300.7 + 60.0 * f64::from(place), 20.6);
        picture.needle(base, polar(base, 200.0, f64::to_radians(degrees)));
    }
    for (place, degrees) in (0_u32..).zip([205.0, 228.0, 250.0]) {
        let base = (430.3 + 50.0 * f64::from(place), 420.0);
        picture.needle(base, polar(base, 200.0, f64::to_radians(degrees)));
    }
    picture
}
