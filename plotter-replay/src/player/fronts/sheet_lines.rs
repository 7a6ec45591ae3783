//! Movements as lines for the plotter behind a front.

use plotter_motion::{Point, Vec2};

/// Decimals of coordinates, mm: 0.1 um is far below a step.
fn word(letter: char, mm: f64) -> String {
    format!(" {letter}{mm:.4}")
}

fn feed_word(feed_mm_min: Option<f64>) -> String {
    feed_mm_min.map_or_else(String::new, |feed| format!(" F{feed:.3}"))
}

/// A straight line to a place, at a speed in mm/min; without one, a travel.
pub(super) fn line_to(to: Point, feed_mm_min: Option<f64>) -> String {
    let code = if feed_mm_min.is_some() { "G1" } else { "G0" };
    format!("{code}{}{}{}", word('X', to.x), word('Y', to.y), feed_word(feed_mm_min))
}

/// An arc to a place; its centre lies so far from its beginning.
pub(super) fn arc_line(to: Point, centre: Vec2, sweep_rad: f64, feed_mm_min: Option<f64>) -> String {
    let code = if sweep_rad < 0.0 { "G2" } else { "G3" };
    let (place, middle) =
        ([word('X', to.x), word('Y', to.y)].concat(), [word('I', centre.x), word('J', centre.y)].concat());
    format!("{code}{place}{middle}{}", feed_word(feed_mm_min))
}

/// Whether all of a circle lies within an area with its corner at (0, 0).
pub(super) fn is_circle_within(centre: Point, radius: f64, [width, height]: [f64; 2]) -> bool {
    centre.x >= radius && centre.y >= radius && centre.x + radius <= width && centre.y + radius <= height
}

/// The part of a straight line that lies within such an area, if any does.
pub(super) fn within(from: Point, to: Point, [width, height]: [f64; 2]) -> Option<(Point, Point)> {
    let way = to - from;
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for (at, by, limit) in [(from.x, way.x, width), (from.y, way.y, height)] {
        if by == 0.0 {
            if !(0.0..=limit).contains(&at) {
                return None;
            }
            continue;
        }
        let (first, second) = (-at / by, (limit - at) / by);
        enters = enters.max(first.min(second));
        leaves = leaves.min(first.max(second));
    }
    let clamped = |share: f64| {
        Point::new((from.x + way.x * share).clamp(0.0, width), (from.y + way.y * share).clamp(0.0, height))
    };
    let place = |share: f64| match share {
        _ if share <= 0.0 => from,
        _ if share >= 1.0 => to,
        _ => clamped(share),
    };
    (enters <= leaves).then(|| (place(enters), place(leaves)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_at_the_edges_of_the_area() {
        let area = [10.0, 5.0];
        let cut = |from: (f64, f64), to: (f64, f64)| {
            within(Point::new(from.0, from.1), Point::new(to.0, to.1), area)
                .map(|(a, b)| ((a.x, a.y), (b.x, b.y)))
        };
        assert_eq!(cut((1.0, 1.0), (9.0, 4.0)), Some(((1.0, 1.0), (9.0, 4.0))));
        assert_eq!(cut((-5.0, 2.0), (15.0, 2.0)), Some(((0.0, 2.0), (10.0, 2.0))));
        assert_eq!(cut((5.0, 0.0), (5.0, 10.0)), Some(((5.0, 0.0), (5.0, 5.0))));
        assert_eq!(cut((-3.0, 3.0), (1.0, 7.0)), None);
        assert_eq!(cut((11.0, 0.0), (11.0, 5.0)), None);
        assert_eq!(cut((3.0, 3.0), (3.0, 3.0)), Some(((3.0, 3.0), (3.0, 3.0))));
        assert_eq!(cut((3.0, 6.0), (3.0, 6.0)), None);
    }
}
