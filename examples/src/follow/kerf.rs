//! [`beside`]: the way of a tool that goes beside a line by half of what it takes away.

use plotter_motion::{Point, Vec2};

/// At a corner the tool goes at most so many times its distance from the line away from it: what is sharper
/// is cut off.
const MOST_MITRE: f64 = 2.0;

/// A line on the right of `line`, so far beside it; what ends where it began stays closed. Where the line
/// turns right in less room than that, the way crosses itself there.
pub(super) fn beside(line: &[Point], by_mm: f64) -> Vec<Point> {
    let mut places = line.to_vec();
    places.dedup();
    if by_mm <= 0.0 || places.len() < 2 {
        return places;
    }
    let ways: Vec<Vec2> =
        places.windows(2).filter_map(|pair| (*pair.get(1)? - *pair.first()?).normalized()).collect();
    let is_closed = places.len() > 3 && places.first() == places.last();
    let around = if is_closed { (ways.last().copied(), ways.first().copied()) } else { (None, None) };
    let right = |way: Vec2| Vec2::new(way.y, -way.x);
    let mut out = Vec::with_capacity(places.len());
    for (index, &at) in places.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|index| ways.get(index).copied()).or(around.0);
        let behind = ways.get(index).copied().or(around.1);
        match (before, behind) {
            (Some(before), Some(behind)) => {
                // The middle between both sides, as far out as both lines beside are.
                let (one, other) = (right(before), right(behind));
                let share = 1.0 + one.dot(other);
                let middle = one + other;
                if share * MOST_MITRE * MOST_MITRE >= 2.0 {
                    out.push(at + middle * (by_mm / share));
                } else {
                    out.extend([at + one * by_mm, at + other * by_mm]);
                }
            }
            (Some(way), None) | (None, Some(way)) => out.push(at + right(way) * by_mm),
            (None, None) => {}
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places: &[(f64, f64)]) -> Vec<Point> {
        places.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    #[test]
    fn the_tool_goes_on_the_right_and_around_corners() {
        let corner = line(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)]);
        assert_eq!(beside(&corner, 0.0), corner);
        assert_eq!(beside(&corner, 1.0), line(&[(0.0, -1.0), (11.0, -1.0), (11.0, 10.0)]));
        let back: Vec<Point> = corner.into_iter().rev().collect();
        assert_eq!(beside(&back, 1.0), line(&[(9.0, 10.0), (9.0, 1.0), (0.0, 1.0)]));
    }

    #[test]
    fn a_square_stays_closed_and_a_point_that_turns_back_is_cut_off() {
        let square = line(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)]);
        let wider = line(&[(-1.0, -1.0), (11.0, -1.0), (11.0, 11.0), (-1.0, 11.0), (-1.0, -1.0)]);
        assert_eq!(beside(&square, 1.0), wider);
        let there_and_back = line(&[(0.0, 0.0), (10.0, 0.0), (0.0, 0.0)]);
        assert_eq!(beside(&there_and_back, 1.0), line(&[(0.0, -1.0), (10.0, -1.0), (10.0, 1.0), (0.0, 1.0)]));
    }
}
