//! [`InkDistance`]: how far what a plotter drew is from the ink of the scan, both ways.
//!
//! ```text
//!   ink ──▶ drawn    each pixel, by how much it is farther from the drawn line than half the line's width
//!   drawn ──▶ ink    each place of the drawn line, by how far it is from the ink's lines
//! ```

use crate::report::coverage::{Index, segments, with_widths};
use crate::{
    picture::{Bitmap, Pixel},
    report::{ErrorReport, ErrorTally},
    stroke::{Drawing, PxPoint},
};

/// From place to place along a drawn line, px: between two of them it can be farther by half of this.
const STEP_PX: f64 = 0.1;

/// The ink of a scan, to which what was drawn of it is compared.
///
/// Unlike [`coverage`](crate::report::coverage), what is compared need not lie on the ink, and may consist of
/// any number of short pieces, as the places of a pen do: the widths of the ink's lines are those that a
/// reference drawing of the same ink meets, which is best one of its own vectorization within half a pixel.
///
/// ```
/// # use plotter_vector::{Bitmap, Drawing, PxPoint, report::InkDistance};
/// let ink = Bitmap::from_picture("........\n.######.\n........\n........\n")?;
/// let line = |y: f64, to: f64| {
///     let mut drawing = Drawing::new(8, 4);
///     drawing.push([PxPoint::new(1.5, y), PxPoint::new(to, y)]);
///     drawing
/// };
/// let distance = InkDistance::new(&ink, &line(1.5, 6.5));
/// assert_eq!(distance.of_ink(&line(2.5, 6.5)).max_px, 1.0); // a pixel too low
/// assert_eq!(distance.of_drawn(&line(1.5, 7.5)), 1.0); // a pixel too long
/// assert_eq!(distance.of_ink(&line(1.5, 7.5)).max_px, 0.0);
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[derive(Debug)]
pub struct InkDistance<'a> {
    ink: &'a Bitmap,
    reference: Index,
}

impl<'a> InkDistance<'a> {
    /// The lines of `ink`, with the widths that they have along `reference`.
    #[must_use]
    pub fn new(ink: &'a Bitmap, reference: &Drawing) -> Self {
        Self { ink, reference: with_widths(ink, reference, None) }
    }

    /// How far the pixels of the ink lie from what was drawn, beyond half the width of their line.
    #[must_use]
    pub fn of_ink(&self, drawn: &Drawing) -> ErrorReport {
        let drawn = Index::new(segments(drawn), self.ink.width(), self.ink.height());
        let mut tally = ErrorTally::default();
        let mut nearest = 0;
        for pixel in self.ink.ink() {
            let at = PxPoint::from(pixel);
            let distance_px = drawn.error_px(at, &mut nearest);
            // The centres of a line's pixels lie up to half of its width less a pixel's from its middle.
            let slack_px = if distance_px > 0.0 { self.reference.slack_px(at) - 0.5 } else { 0.0 };
            tally.add_error((distance_px - slack_px.max(0.0)).max(0.0));
        }
        tally.report()
    }

    /// Greatest distance of what was drawn from the ink's lines, px: from those through the centres of pixels
    /// that touch, and 0 between them. Strokes are taken as their vertices joined by straight lines; with
    /// nothing drawn it is 0, without ink infinite.
    #[must_use]
    pub fn of_drawn(&self, drawn: &Drawing) -> f64 {
        let mut farthest_px = 0.0_f64;
        for stroke in drawn.strokes() {
            let dot = stroke.first().map(|at| (*at, *at));
            let pieces = stroke.windows(2).filter_map(|pair| Some((*pair.first()?, *pair.last()?)));
            for (from, to) in dot.into_iter().chain(pieces) {
                let steps = (from.distance(to) / STEP_PX).ceil().clamp(1.0, 1e9);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
                for step in 1..=steps as u32 {
                    let share = f64::from(step) / steps;
                    let at = PxPoint::new(from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share);
                    farthest_px = farthest_px.max(self.off_lines_px(at, farthest_px));
                }
            }
        }
        farthest_px
    }

    /// How far a place is from the ink's lines, px; some number up to `enough_px` if it is no farther than
    /// that.
    fn off_lines_px(&self, at: PxPoint, enough_px: f64) -> f64 {
        let (width, height) = (i64::from(self.ink.width()), i64::from(self.ink.height()));
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let (column, row) = (at.x.floor() as i64, at.y.floor() as i64);
        let farthest = width.max(height).saturating_add(column.saturating_abs().max(row.saturating_abs()));
        let mut least_px = f64::INFINITY;
        let mut ring = 0;
        while ring <= farthest {
            // The centre of a pixel in this ring is at least half a pixel less away, and a line from it half
            // a pixel less again.
            #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
            let nearest_px = ring as f64 - 1.5;
            if least_px <= nearest_px.max(enough_px) {
                break;
            }
            for (x, y) in around(column, row, ring) {
                if (0..width).contains(&x) && (0..height).contains(&y) {
                    least_px = least_px.min(self.off_pixel_px(x, y, at));
                }
            }
            ring += 1;
        }
        least_px
    }

    /// How far a place is from the lines that join the centre of a pixel to those after it that touch it;
    /// infinite for paper.
    fn off_pixel_px(&self, x: i64, y: i64, at: PxPoint) -> f64 {
        let centre = |x: i64, y: i64| {
            let pixel = Pixel::new(u32::try_from(x).ok()?, u32::try_from(y).ok()?);
            self.ink.get(pixel).then(|| PxPoint::from(pixel))
        };
        let Some(from) = centre(x, y) else { return f64::INFINITY };
        let [right, below, below_right, below_left] =
            [(1, 0), (0, 1), (1, 1), (-1, 1)].map(|(dx, dy)| centre(x + dx, y + dy));
        let inside = |from: f64, at: f64| (from..=from + 1.0).contains(&at);
        if right.is_some()
            && below.is_some()
            && below_right.is_some()
            && inside(from.x, at.x)
            && inside(from.y, at.y)
        {
            return 0.0;
        }
        [right, below, below_right, below_left]
            .into_iter()
            .flatten()
            .map(|to| segment_px(from, to, at))
            .fold(from.distance(at), f64::min)
    }
}

/// The pixels of a square ring.
fn around(column: i64, row: i64, ring: i64) -> impl Iterator<Item = (i64, i64)> {
    (-ring..=ring).flat_map(move |dy| {
        let step = if dy.abs() == ring { 1 } else { (2 * ring).max(1) };
        let count = 2 * ring / step;
        (0..=count).map(move |index| (column - ring + index * step, row + dy))
    })
}

fn segment_px(from: PxPoint, to: PxPoint, at: PxPoint) -> f64 {
    let (x, y) = (to.x - from.x, to.y - from.y);
    let along = ((at.x - from.x) * x + (at.y - from.y) * y) / (x * x + y * y);
    let along = along.clamp(0.0, 1.0);
    at.distance(PxPoint::new(from.x + x * along, from.y + y * along))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(points: &[(f64, f64)]) -> Drawing {
        let mut drawing = Drawing::new(40, 40);
        drawing.push(points.iter().map(|&(x, y)| PxPoint::new(x, y)));
        drawing
    }

    /// A line 5 px wide, from (5, 18) to (34, 22).
    fn bar() -> Bitmap {
        let mut ink = Bitmap::new(40, 40).unwrap();
        (18..=22).for_each(|y| (5..=34).for_each(|x| ink.set(Pixel::new(x, y), true)));
        ink
    }

    #[test]
    fn a_line_beside_the_middle_of_a_wide_one_leaves_its_far_edge() {
        let ink = bar();
        let distance = InkDistance::new(&ink, &drawing(&[(5.5, 20.5), (34.5, 20.5)]));
        // As dense as the places of a pen, and 1.5 px too low: on the ink all the way.
        let places: Vec<_> = (0..=2900).map(|i| (5.5 + 0.01 * f64::from(i), 22.0)).collect();
        let drawn = drawing(&places);
        assert_eq!(distance.of_drawn(&drawn), 0.0);
        assert!((distance.of_ink(&drawn).max_px - 1.5).abs() < 1e-9, "{}", distance.of_ink(&drawn).max_px);
    }

    #[test]
    fn what_leaves_the_ink_is_seen_and_a_diagonal_through_the_corners_of_pixels_is_not() {
        let mut ink = Bitmap::new(40, 40).unwrap();
        (5..30).for_each(|i| ink.set(Pixel::new(i, i), true));
        let reference = drawing(&[(5.5, 5.5), (29.5, 29.5)]);
        let distance = InkDistance::new(&ink, &reference);
        assert!(distance.of_drawn(&reference) < 1e-9);
        assert_eq!(distance.of_ink(&reference).max_px, 0.0);
        let astray = drawing(&[(5.5, 5.5), (20.5, 20.5), (24.5, 16.5), (20.5, 20.5), (29.5, 29.5)]);
        assert!(
            (distance.of_drawn(&astray) - 32.0_f64.sqrt()).abs() < 1e-9,
            "{}",
            distance.of_drawn(&astray)
        );
        assert_eq!(distance.of_ink(&astray).max_px, 0.0);
        // What is outside of the picture too.
        assert!((distance.of_drawn(&drawing(&[(-10.0, 5.5)])) - 15.5).abs() < 1e-9);
    }

    #[test]
    fn nothing_drawn_is_nowhere_and_no_ink_is_far() {
        let ink = bar();
        let distance = InkDistance::new(&ink, &drawing(&[(5.5, 20.5), (34.5, 20.5)]));
        let nothing = Drawing::new(40, 40);
        assert_eq!(distance.of_drawn(&nothing), 0.0);
        assert!(distance.of_ink(&nothing).max_px > 10.0);
        let blank = Bitmap::new(40, 40).unwrap();
        assert_eq!(InkDistance::new(&blank, &nothing).of_drawn(&drawing(&[(1.0, 1.0)])), f64::INFINITY);
    }
}
