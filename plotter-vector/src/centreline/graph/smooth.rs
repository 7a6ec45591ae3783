//! Smoothing: the edges of a scanned line lie on whole pixels, so its middle jumps by half a pixel or a whole one.
//!
//! Each place is moved to the parabola that fits its neighbours best, which a straight line and a gentle curve leave
//! where they are. The window is as wide as the curve allows: 33 places where that agrees with 9, else 17, else 9.
//!
//! Source: A. Savitzky, M. J. E. Golay, "Smoothing and differentiation of data by simplified least squares
//! procedures" (1964): the value in the middle of a parabola fitted to 2m + 1 equidistant values is their sum with the
//! weights 3·(3m² + 3m − 1 − 5k²) / ((2m − 1)·(2m + 1)·(2m + 3)).

use super::straight::Straightened;
use crate::stroke::curve::unit;
use crate::stroke::{PxPoint, PxVec};

/// Half widths of the windows, the narrowest last.
const HALVES: [usize; 3] = [16, 8, 4];

/// How far from a place the line through its neighbours on one side comes by, px: farther, and the place itself is off.
const NEAR_PX: f64 = 0.25;

/// How far a wide window's result may be from the narrow one's, px: more is the curve's own shape.
const AGREE_PX: f64 = 0.35;

/// Smooths the places of a line, which are about equally far apart. Those at `breaks` (rising), and both ends of an open
/// line, stay where they are, and nothing is averaged across them. So do places of straight stretches, and places that would
/// move farther than `most_px`: of exact ones these are bends.
pub(super) fn smooth(line: &Straightened, closed: bool, breaks: &[usize], most_px: f64) -> Vec<PxPoint> {
    let places = line.course.as_slice();
    let count = places.len();
    let weights = HALVES.map(weights);
    let mut smoothed = Vec::with_capacity(count);
    let (mut before, mut next) = (None, breaks.iter().copied().peekable());
    for index in 0..count {
        while next.peek().is_some_and(|at| *at < index) {
            before = next.next();
        }
        let at = places.get(index).copied().unwrap_or_default();
        if line.is_straight.get(index) == Some(&true) {
            smoothed.push(at);
            continue;
        }
        // How far the window may go to either side: to the breaks, and to the ends of an open line.
        let first = before.or(if closed { breaks.last().copied() } else { Some(0) });
        let last =
            next.peek().copied().or(if closed { breaks.first().copied() } else { count.checked_sub(1) });
        let (first, last) = (first.filter(|_| count > 0), last.filter(|_| count > 0));
        let room_before = first
            .map_or(count / 2, |first| if first <= index { index - first } else { index + count - first });
        let room_after =
            last.map_or(count / 2, |last| if last >= index { last - index } else { last + count - index });
        let room = room_before.min(room_after).min(count.saturating_sub(1) / 2);
        let moved = smoothed_place(places, index, room, &weights);
        let is_bend = |moved: &PxPoint| {
            let near = |place: PxPoint| place.distance(at) <= NEAR_PX;
            moved.distance(at) > most_px
                && sideways_px(places, closed, index, *moved) > most_px
                && [-1, 1].into_iter().any(|way| continued(places, closed, index, way).is_some_and(near))
        };
        smoothed.push(moved.filter(|moved| !is_bend(moved)).unwrap_or(at));
    }
    smoothed
}

fn smoothed_place(places: &[PxPoint], index: usize, room: usize, weights: &[Vec<f64>; 3]) -> Option<PxPoint> {
    let [widest, wide, narrow] = weights;
    if room < HALVES[2] {
        // Close to a break: as wide as there is room.
        return (room > 1).then(|| average(places, index, &self::weights(room)));
    }
    let sure = average(places, index, narrow);
    for (half, weights) in [(HALVES[0], widest), (HALVES[1], wide)] {
        if room >= half {
            let place = average(places, index, weights);
            if place.distance(sure) <= AGREE_PX {
                return Some(place);
            }
        }
    }
    Some(sure)
}

/// The place so many after one, or before it; of a closed line around its end.
fn beside(places: &[PxPoint], closed: bool, index: usize, steps: isize) -> Option<PxPoint> {
    let at = index.checked_add_signed(steps);
    let around = |at: usize| at % places.len().max(1);
    let at =
        if closed { around(at.unwrap_or((index + places.len()).wrapping_add_signed(steps))) } else { at? };
    places.get(at).copied()
}

/// How far a place moves across its line, px: how far it moves along it says nothing.
fn sideways_px(places: &[PxPoint], closed: bool, index: usize, moved: PxPoint) -> f64 {
    let [before, at, after] = [-2, 0, 2].map(|steps| beside(places, closed, index, steps));
    let (Some(before), Some(at), Some(after)) = (before, at, after) else { return 0.0 };
    let (PxVec { x, y }, PxVec { x: u, y: v }) = (moved - at, unit(before, after));
    (x * v - y * u).abs()
}

/// Where the straight line through the three places before (−1) or after one (1) comes to it.
fn continued(places: &[PxPoint], closed: bool, index: usize, way: isize) -> Option<PxPoint> {
    let [a, b, c] = [1, 2, 3].map(|steps| beside(places, closed, index, way * steps));
    let (a, b, c) = (a?, b?, c?);
    let on = |a: f64, b: f64, c: f64| (4.0 * a + b - 2.0 * c) / 3.0;
    Some(PxPoint::new(on(a.x, b.x, c.x), on(a.y, b.y, c.y)))
}

/// The weights of a window of 2·half + 1 places.
fn weights(half: usize) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "at most 16")]
    let m = half as f64;
    let whole = (2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0);
    let mut weights = Vec::with_capacity(2 * half + 1);
    let mut k = -m;
    while k <= m {
        weights.push(3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * k * k) / whole);
        k += 1.0;
    }
    weights
}

/// The weighted mean of the places around one, beyond the end of a closed line from its start.
fn average(places: &[PxPoint], index: usize, weights: &[f64]) -> PxPoint {
    let (count, half) = (places.len(), weights.len() / 2);
    let add = |sum: PxPoint, (place, weight): (&PxPoint, &f64)| {
        PxPoint::new(sum.x + weight * place.x, sum.y + weight * place.y)
    };
    match index.checked_sub(half).and_then(|first| places.get(first..=index + half)) {
        Some(window) => window.iter().zip(weights).fold(PxPoint::default(), add),
        None => {
            let around = places.iter().cycle().skip((index + count - half % count.max(1)) % count.max(1));
            around.zip(weights).fold(PxPoint::default(), add)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without straight stretches.
    fn smooth(places: &[PxPoint], closed: bool, breaks: &[usize], most_px: f64) -> Vec<PxPoint> {
        let line = Straightened { course: places.to_vec(), is_straight: vec![false; places.len()] };
        super::smooth(&line, closed, breaks, most_px)
    }

    #[test]
    fn weights_of_five_are_those_of_the_table() {
        // Savitzky and Golay, table I, 5 points: -3, 12, 17, 12, -3 over 35.
        for (weight, expected) in weights(2).iter().zip([-3.0, 12.0, 17.0, 12.0, -3.0]) {
            assert!((weight - expected / 35.0).abs() < 1e-15);
        }
    }

    #[test]
    fn stairs_become_a_slope() {
        let stairs: Vec<PxPoint> =
            (0..80).map(|x| PxPoint::new(f64::from(x), f64::from((x + 3) / 6))).collect();
        let slope = smooth(&stairs, false, &[], f64::INFINITY);
        let off = |place: &PxPoint| (place.y - (place.x + 0.5) / 6.0).abs();
        let worst = slope.iter().skip(16).take(48).map(off).fold(0.0, f64::max);
        assert!(worst < 0.1, "{worst}");
        assert_eq!((slope.first(), slope.last()), (stairs.first(), stairs.last()));
    }

    #[test]
    fn a_small_circle_does_not_shrink() {
        let circle: Vec<PxPoint> = (0..52)
            .map(|step| 2.0 * core::f64::consts::PI * f64::from(step) / 52.0)
            .map(|angle| PxPoint::new(8.3 * libm::cos(angle), 8.3 * libm::sin(angle)))
            .collect();
        for place in smooth(&circle, true, &[], f64::INFINITY) {
            assert!((libm::hypot(place.x, place.y) - 8.3).abs() < 0.3, "{place:?}");
        }
    }

    #[test]
    fn a_break_stays_and_is_not_averaged_across() {
        let corner: Vec<PxPoint> =
            (-20..=20).map(|x| PxPoint::new(f64::from(x), f64::from(x).abs())).collect();
        for (place, smoothed) in corner.iter().zip(smooth(&corner, false, &[20], f64::INFINITY)) {
            assert!(place.distance(smoothed) < 1e-9);
        }
    }

    #[test]
    fn of_exact_places_a_bend_stays_and_a_place_beside_its_line_goes() {
        // A right angle, and before it a place half a pixel off.
        let arm = (0..20).map(|x| PxPoint::new(f64::from(x), if x == 10 { 0.5 } else { 0.0 }));
        let other = (0..20).map(|y| PxPoint::new(20.0, f64::from(y)));
        let bent: Vec<PxPoint> = arm.chain(other).collect();
        let at = |most_px: f64, index: usize| smooth(&bent, false, &[], most_px)[index].distance(bent[index]);
        assert!(at(0.15, 20) < 1e-12 && at(f64::INFINITY, 20) > 0.4);
        assert!(at(0.15, 10) > 0.3);
    }
}
