//! [`drawn_ways`]: which ways from one end of a stroke to another the pen has drawn already.

use super::plan::Stroke;
use crate::stroke::PxPoint;

/// A way is asked at places no farther from each other than this, px: less than any pen is wide.
const PLACES_PX: f64 = 0.5;

/// Least side of the squares in which the places are looked up, px: a longer segment is walked along in as
/// many steps.
const LEAST_SQUARE_PX: f64 = 16.0;

/// A place on a way: the square in which it lies, the way's number, and whether a pen has been there.
struct Place {
    square: (i64, i64),
    way: usize,
    at: PxPoint,
    is_drawn: bool,
}

/// Whether each way, a straight line, lies all along within `half_px` of some stroke's middle.
pub(super) fn drawn_ways(ways: &[[PxPoint; 2]], strokes: &[Stroke<'_>], half_px: f64) -> Vec<bool> {
    let side_px = (2.0 * half_px).max(LEAST_SQUARE_PX);
    let square = |at: PxPoint| (along(at.x, side_px), along(at.y, side_px));
    let mut places: Vec<Place> = Vec::new();
    for (way, [from, to]) in ways.iter().enumerate() {
        let steps = along(from.distance(*to), PLACES_PX) + 1;
        places.extend((0..=steps).map(|step| {
            let at = *from + (*to - *from) * (as_f64(step) / as_f64(steps));
            Place { square: square(at), way, at, is_drawn: false }
        }));
    }
    places.sort_by_key(|place| place.square);
    if places.is_empty() {
        return Vec::new();
    }
    for stroke in strokes {
        let chords = stroke.chords();
        for (from, to) in chords.iter().zip(chords.iter().skip(1)) {
            // What is near the segment is near one of these places on it.
            let steps = along(from.distance(*to), side_px) + 1;
            for step in 0..=steps {
                let (column, row) = square(*from + (*to - *from) * (as_f64(step) / as_f64(steps)));
                for column in column - 1..=column + 1 {
                    mark(&mut places, (column, row - 1), (column, row + 1), [*from, *to], half_px);
                }
            }
        }
    }
    let mut are_drawn = vec![true; ways.len()];
    for place in places.iter().filter(|place| !place.is_drawn) {
        are_drawn.iter_mut().skip(place.way).take(1).for_each(|drawn| *drawn = false);
    }
    are_drawn
}

/// Marks the places between two squares of a column that a pen has drawn which goes along a segment.
fn mark(places: &mut [Place], first: (i64, i64), last: (i64, i64), [from, to]: [PxPoint; 2], half_px: f64) {
    let start = places.partition_point(|place| place.square < first);
    for place in places.iter_mut().skip(start).take_while(|place| place.square <= last) {
        let (way, to_place) = (to - from, place.at - from);
        let part = (to_place.dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        place.is_drawn |= (to_place - way * part).length() <= half_px;
    }
}

/// How many whole units there are up to a place.
#[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
fn along(at: f64, unit: f64) -> i64 {
    libm::floor(at / unit) as i64
}

#[expect(clippy::cast_precision_loss, reason = "steps of a picture's length")]
fn as_f64(steps: i64) -> f64 {
    steps as f64
}

#[cfg(test)]
mod tests {
    use super::super::plan::strokes_of;
    use super::*;
    use crate::stroke::Drawing;

    fn place(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    #[test]
    fn a_way_along_a_stroke_is_drawn_and_one_over_paper_is_not() {
        let mut drawing = Drawing::new(400, 100);
        drawing.push([place(10.0, 50.0), place(390.0, 50.0)]);
        drawing.push([place(200.0, 53.0), place(200.0, 90.0)]);
        drawing.push([place(207.0, 47.0), place(207.0, 10.0)]);
        let ways = [
            [place(200.0, 53.0), place(207.0, 47.0)], // across the long line
            [place(200.0, 60.0), place(210.0, 47.0)], // and over the corner between two
            [place(30.0, 51.0), place(370.0, 49.0)],
            [place(200.0, 80.0), place(207.0, 20.0)],
        ];
        let strokes = strokes_of(&drawing);
        assert_eq!(drawn_ways(&ways, &strokes, 3.0), [true, false, true, false]);
        assert_eq!(drawn_ways(&ways, &strokes, 1.05), [false, false, true, false]);
        assert!(drawn_ways(&[], &strokes, 3.0).is_empty());
    }
}
