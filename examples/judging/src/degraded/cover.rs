//! Coverage: the fraction of each pixel that the strokes of a drawing cover.
//!
//! The rim of a stroke goes from ink to paper over one pixel across it, as on a sensor whose pixels are as
//! wide as far apart. `corpus::raster` asks 64 points a pixel instead, which differs at ends and corners only
//! and takes far longer on sheets of this size.

use super::plane::Plane;
use crate::corpus::strokes::{At, Stroke};

/// Longest piece that is painted at a time, px: the box about a long oblique one would hold half of the
/// sheet.
const PIECE_PX: f64 = 24.0;

/// Shares from 0 to 1. `place` and `pen` say where a point of the drawing lies in these pixels, and how wide
/// a pen is there, px.
pub(crate) fn cover(
    strokes: &[Stroke],
    (width, height): (usize, usize),
    place: impl Fn(At) -> At,
    pen: impl Fn(f64) -> f64,
) -> Plane {
    let mut plane = Plane::even(width, height, 0.0);
    for stroke in strokes {
        let radius = pen(stroke.width_px) / 2.0;
        if let [dot] = stroke.points.as_slice() {
            paint(&mut plane, place(*dot), place(*dot), radius);
        }
        for pair in stroke.points.windows(2) {
            let (from, to) = (place(pair[0]), place(pair[1]));
            let pieces = libm::ceil(libm::hypot(to.0 - from.0, to.1 - from.1) / PIECE_PX).max(1.0);
            let at = |share: f64| (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
            let mut piece = 0.0;
            while piece < pieces {
                paint(&mut plane, at(piece / pieces), at((piece + 1.0) / pieces), radius);
                piece += 1.0;
            }
        }
    }
    plane
}

fn paint(plane: &mut Plane, from: At, to: At, radius: f64) {
    let reach = radius + 1.0;
    let range = |a: f64, b: f64, size: usize| {
        let whole = |value: f64| {
            let value = libm::ceil(value).clamp(0.0, size as f64);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the plane")]
            let value = value as usize;
            value
        };
        whole(a.min(b) - reach)..whole(a.max(b) + reach)
    };
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let square = (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
    let columns = range(from.0, to.0, plane.width);
    for y in range(from.1, to.1, plane.height) {
        let row = y * plane.width;
        let Some(pixels) = plane.values.get_mut(row + columns.start..row + columns.end) else { continue };
        for (x, pixel) in columns.clone().zip(pixels) {
            let (px, py) = (x as f64 - from.0, y as f64 - from.1);
            let foot = ((px * dx + py * dy) / square).clamp(0.0, 1.0);
            let away = libm::sqrt((px - foot * dx) * (px - foot * dx) + (py - foot * dy) * (py - foot * dy));
            // Of the pixel's breadth about `away`, what lies within the radius to either side of the line.
            let share = (away + 0.5).min(radius) - (away - 0.5).max(-radius);
            *pixel = pixel.max(share.clamp(0.0, 1.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::strokes::{Look, Picture};

    #[test]
    fn a_line_covers_as_much_as_its_pen_is_wide() {
        for width_px in [0.6, 1.2, 2.0, 3.7, 7.0] {
            let mut picture = Picture::new("line", (60, 40), Look::Smooth, width_px);
            picture.line(&[(-20.0, 20.3), (80.0, 20.3)]);
            let plane = cover(&picture.strokes, (60, 40), |at| at, |pen| pen);
            let column: f64 = plane.values.iter().skip(30).step_by(60).sum();
            assert!((column - width_px).abs() < 1e-9, "{column} px of {width_px}");
        }
    }
}
