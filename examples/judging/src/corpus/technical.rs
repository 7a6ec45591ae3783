//! A cover plate in two views, with dimensions, centre lines, hatching, frame and title block.

use super::letters;
use super::strokes::{At, Look, Picture, arc, polar, turned};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Length and half the breadth of an open arrow head, px.
const ARROW_PX: (f64, f64) = (15.0, 4.6);
const LETTER_PX: f64 = 24.0;
/// Extension lines begin this far from the part and end this far beyond the dimension line, px.
const GAP_PX: (f64, f64) = (9.0, 10.0);

/// The drawing with a broad pen for outlines and a thin one for the rest.
pub(crate) fn drawing(name: &'static str, broad_px: f64, thin_px: f64) -> Picture {
    let mut picture = Picture::new(name, (1330, 930), Look::Ink, broad_px);
    picture.rectangle((24.4, 26.3), (1305.6, 905.7));
    plate(&mut picture);
    section(&mut picture);
    picture.pen(broad_px).line(&[(840.4, 905.7), (840.4, 806.2), (1305.6, 806.2)]);
    picture.pen(thin_px);
    plate_marks(&mut picture);
    section_marks(&mut picture);
    title(&mut picture);
    picture
}

const LEFT: f64 = 150.3;
const RIGHT: f64 = 780.3;
const TOP: f64 = 170.6;
const BOTTOM: f64 = 610.6;
const BORE: At = (400.3, 390.6);
const SLOT: (At, At) = ((655.3, 300.6), (655.3, 440.6));

fn plate(picture: &mut Picture) {
    // Two rounded corners, one chamfer, one step.
    let mut outline = vec![(LEFT, BOTTOM)];
    outline.extend(arc((LEFT + 60.0, TOP + 60.0), 60.0, PI, 3.0 * FRAC_PI_2));
    outline.extend([(RIGHT - 150.0, TOP), (RIGHT, TOP + 85.0)]);
    outline.extend([(RIGHT, BOTTOM - 40.0), (RIGHT - 70.0, BOTTOM - 40.0), (RIGHT - 70.0, BOTTOM)]);
    outline.push((LEFT, BOTTOM));
    picture.line(&outline);

    for radius in [132.4, 78.0, 52.6] {
        picture.circle(BORE, radius);
    }
    for bolt in 0..6 {
        picture.circle(polar(BORE, 105.0, 0.3 + TAU * f64::from(bolt) / 6.0), 11.3);
    }
    let (upper, lower) = SLOT;
    let mut slot = arc(upper, 32.0, PI, TAU);
    slot.extend(arc(lower, 32.0, 0.0, PI));
    slot.push((upper.0 - 32.0, upper.1));
    picture.line(&slot);
}

fn plate_marks(picture: &mut Picture) {
    cross(picture, BORE, 158.0);
    for bolt in [0, 3] {
        let angle = 0.3 + TAU * f64::from(bolt) / 6.0;
        picture.line(&[polar(BORE, 88.0, angle), polar(BORE, 122.0, angle)]);
    }
    let (upper, lower) = SLOT;
    picture.dashed((upper.0, upper.1 - 58.0), (lower.0, lower.1 + 58.0), &[34.0, 5.0], 6.0);
    for end in [upper, lower] {
        picture.line(&[(end.0 - 46.0, end.1), (end.0 + 46.0, end.1)]);
    }

    let (chamfer, end) = ((RIGHT - 150.0, TOP), (RIGHT, TOP + 85.0));
    let slope = libm::atan2(85.0, 150.0);
    let (left, bore, right) = ((LEFT, BOTTOM), (BORE.0, BOTTOM), (RIGHT, BOTTOM - 40.0));
    for (from, to, angle_rad, away, extends, label) in [
        (left, bore, 0.0, 62.0, [false, true], "250"),
        (bore, (upper.0, BOTTOM), 0.0, 62.0, [false, true], "255"),
        (left, right, 0.0, 124.0, [true, true], "630.0"),
        ((LEFT, BORE.1), left, FRAC_PI_2, 66.0, [true, true], "220"),
        (chamfer, end, slope, -64.0, [true, true], "172.4"),
    ] {
        Dimension { from, to, angle_rad, away, extends, label }.draw(picture);
    }
    // The leader of a bolt hole crosses the outer circle and the upper edge.
    let bolt = polar(BORE, 105.0, 0.3 + TAU * 4.0 / 6.0);
    let tip = polar(bolt, 11.3, -1.1);
    let knee = (tip.0 + 82.0, tip.1 - 82.0 * libm::tan(1.1));
    picture.line(&[tip, knee, (knee.0 + 118.0, knee.1)]);
    arrow(picture, tip, -1.1);
    picture.text((knee.0 + 14.0, knee.1 - 34.0), LETTER_PX, 0.0, "6X R11");
    picture.text((70.3, 60.6), LETTER_PX, 0.0, "ALL EDGES 1X45");
}

const CUT: f64 = 930.4;

/// The same part, cut through the bore and seen from the right.
fn section(picture: &mut Picture) {
    let outline = [
        (CUT, TOP),
        (CUT + 70.0, TOP),
        (CUT + 70.0, 290.3),
        (CUT + 150.0, 316.3),
        (CUT + 150.0, 464.9),
        (CUT + 70.0, 490.9),
        (CUT + 70.0, BOTTOM),
        (CUT, BOTTOM),
        (CUT, TOP),
    ];
    picture.line(&outline);
    for y in [BORE.1 - 52.6, BORE.1 + 52.6] {
        picture.line(&[(CUT, y), (CUT + 150.0, y)]);
    }
}

fn section_marks(picture: &mut Picture) {
    picture.dashed((CUT - 28.0, BORE.1), (CUT + 178.0, BORE.1), &[40.0, 6.0], 7.0);
    // Hatching at 45 degrees, not quite to the outline.
    for (top, bottom) in [(TOP + 10.0, BORE.1 - 62.0), (BORE.1 + 62.0, BOTTOM - 10.0)] {
        let mut at = top;
        while at + 50.0 <= bottom {
            picture.line(&[(CUT + 10.0, at + 50.0), (CUT + 60.0, at)]);
            at += 21.7;
        }
    }
    let (upper, lower) = ((CUT + 150.0, 316.3), (CUT + 150.0, 464.9));
    for (from, to, angle_rad, away, label) in [
        ((CUT, BOTTOM), (CUT + 70.0, BOTTOM), 0.0, 62.0, "70"),
        ((CUT, TOP), upper, 0.0, -70.0, "150"),
        (upper, lower, FRAC_PI_2, -92.0, "148.6"),
    ] {
        Dimension { from, to, angle_rad, away, extends: [true, true], label }.draw(picture);
    }
}

fn title(picture: &mut Picture) {
    picture.line(&[(840.4, 856.0), (1305.6, 856.0)]);
    picture.line(&[(1098.2, 806.2), (1098.2, 905.7)]);
    picture.text((858.0, 818.6), LETTER_PX, 0.0, "COVER 40");
    picture.text((858.0, 868.6), LETTER_PX, 0.0, "SCALE 1:2");
    picture.text((1116.0, 818.6), LETTER_PX, 0.0, "A3-17");
    picture.text((1116.0, 868.6), LETTER_PX, 0.0, "2026");
}

/// The two centre lines of a bore, dashes meeting in its centre.
fn cross(picture: &mut Picture, centre: At, reach: f64) {
    for quarter in 0..2 {
        let angle = f64::from(quarter) * FRAC_PI_2;
        let at = |s: f64| polar(centre, s, angle);
        picture.line(&[at(-22.0), at(22.0)]);
        for side in [-1.0, 1.0] {
            picture.line(&[at(side * 28.0), at(side * 36.0)]);
            picture.line(&[at(side * 43.0), at(side * reach)]);
        }
    }
}

/// A dimension between two points of the part.
struct Dimension<'a> {
    from: At,
    to: At,
    /// Direction of the dimension line, which runs from the first point to the second.
    angle_rad: f64,
    /// How far to the right of that direction (below, when it is level) the line lies, from the nearer point.
    away: f64,
    /// Whether there is an extension line at each end.
    extends: [bool; 2],
    label: &'a str,
}

impl Dimension<'_> {
    fn draw(&self, picture: &mut Picture) {
        // In the frame whose x axis is the direction of the dimension line.
        let flat = |(x, y): At| turned((x - self.from.0, y - self.from.1), -self.angle_rad, (0.0, 0.0));
        let back = |at: At| turned(at, self.angle_rad, self.from);
        let (from, to, side) = (flat(self.from), flat(self.to), self.away.signum());
        let level = side * (side * from.1).max(side * to.1) + self.away;
        for (edge, _) in [from, to].iter().zip(self.extends).filter(|(_, extends)| *extends) {
            let (start, end) = (edge.1 + side * GAP_PX.0, level + side * GAP_PX.1);
            picture.line(&[back((edge.0, start)), back((edge.0, end))]);
        }
        let (a, b) = (back((from.0, level)), back((to.0, level)));
        picture.line(&[a, b]);
        arrow(picture, a, self.angle_rad);
        arrow(picture, b, self.angle_rad + PI);
        // Lettering stands above its line and reads from below or from the right.
        let turn = if self.angle_rad >= FRAC_PI_2 { self.angle_rad - PI } else { self.angle_rad };
        let middle = (f64::midpoint(a.0, b.0), f64::midpoint(a.1, b.1));
        let corner = turned((-letters::width(self.label, LETTER_PX) / 2.0, -LETTER_PX - 9.0), turn, middle);
        picture.text(corner, LETTER_PX, turn, self.label);
    }
}

/// An open arrow head with its tip on a dimension line that leaves at the angle.
fn arrow(picture: &mut Picture, tip: At, angle_rad: f64) {
    let wing = |side: f64| turned((ARROW_PX.0, side * ARROW_PX.1), angle_rad, tip);
    picture.line(&[wing(1.0), tip, wing(-1.0)]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::junctions;

    #[test]
    fn no_line_is_drawn_twice() {
        // Two chained dimensions meet in the most arms: extension line, two dimension lines, two arrow heads.
        let found = junctions::of(&drawing("test", 5.0, 2.5).strokes);
        assert_eq!(found.iter().map(|(_, _, arms)| *arms).max(), Some(8));
    }
}
