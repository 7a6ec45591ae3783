//! [`stiff`]: a smooth line near places that are more or less sure.

use crate::stroke::{PxPoint, PxVec};

/// The weight of a line's third differences against that of a place that is sure.
const STIFFNESS: f64 = 20.0;

/// Third differences, and how many places beside its own one row of the equations reaches.
const DIFFERENCE: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
const BAND: usize = 3;

/// The places with the least sum of squared distances from the targets, by weight, and of squared third differences: where the targets
/// weigh nothing, the line goes on with the curvature that it has before and behind. At corners it may turn. The weights are positive.
///
/// Whittaker's graduation (E. T. Whittaker, "On a new method of graduation", 1923). Its equations have seven diagonals, and are solved by
/// Cholesky's factors without roots, in one pass.
pub(super) fn stiff(targets: &[PxPoint], weights: &[f64], is_corner: &[bool]) -> Vec<PxPoint> {
    let count = targets.len().min(weights.len()).min(is_corner.len());
    // Of each row the diagonal and what is behind it; the matrix is symmetric.
    let mut rows = vec![[0.0; BAND + 1]; count];
    for (row, weight) in rows.iter_mut().zip(weights) {
        row[0] = *weight;
    }
    for (first, inner) in is_corner.windows(BAND + 1).enumerate().take(count.saturating_sub(BAND)) {
        if inner.iter().skip(1).take(BAND - 1).any(|corner| *corner) {
            continue;
        }
        for (a, one) in DIFFERENCE.iter().enumerate() {
            for (beside, other) in DIFFERENCE.iter().skip(a).enumerate() {
                if let Some(cell) = rows.get_mut(first + a).and_then(|row| row.get_mut(beside)) {
                    *cell += STIFFNESS * one * other;
                }
            }
        }
    }
    let mut sums: Vec<PxVec> =
        targets.iter().zip(weights).map(|(at, w)| PxVec::new(w * at.x, w * at.y)).collect();
    // Each row takes its part out of those that it reaches.
    for i in 0..count {
        let Some((row, sum)) = rows.get(i).copied().zip(sums.get(i).copied()) else { break };
        for j in 1..=BAND {
            let Some(factor) = row.get(j).map(|cell| cell / row[0]) else { break };
            if let Some(later) = rows.get_mut(i + j) {
                for (cell, part) in later.iter_mut().zip(row.iter().skip(j)) {
                    *cell -= factor * part;
                }
            }
            if let Some(later) = sums.get_mut(i + j) {
                *later = PxVec::new(later.x - factor * sum.x, later.y - factor * sum.y);
            }
        }
    }
    let mut found = vec![PxPoint::default(); count];
    for i in (0..count).rev() {
        let Some((row, sum)) = rows.get(i).zip(sums.get(i)) else { break };
        let behind = row.iter().zip(found.get(i..).unwrap_or(&[])).skip(1);
        let PxVec { x, y } =
            behind.fold(*sum, |PxVec { x, y }, (cell, at)| PxVec::new(x - cell * at.x, y - cell * at.y));
        if let Some(place) = found.get_mut(i) {
            *place = PxPoint::new(x / row[0], y / row[0]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places of a parabola; none of those from 8 to 15 is sure.
    fn parabola() -> (Vec<PxPoint>, Vec<f64>) {
        let at = |i: usize| f64::from(u8::try_from(i).unwrap());
        let places = (0..24).map(|i| PxPoint::new(2.0 * at(i), 0.02 * at(i) * at(i)));
        (places.collect(), (0..24).map(|i| if (8..16).contains(&i) { 1e-3 } else { 1.0 }).collect())
    }

    #[test]
    fn where_nothing_is_sure_a_line_goes_on_with_its_curvature() {
        let (places, weights) = parabola();
        let mut moved = places.clone();
        moved.iter_mut().skip(8).take(8).for_each(|at| at.y += 3.0);
        for (found, place) in stiff(&moved, &weights, &[false; 24]).iter().zip(&places) {
            assert!(found.distance(*place) < 0.1, "{found:?} {place:?}");
        }
    }

    #[test]
    fn a_line_turns_at_its_corner_only() {
        let arm = (0..12_u8).map(|i| PxPoint::new(f64::from(i), 0.0));
        let other = (1..12_u8).map(|i| PxPoint::new(11.0, f64::from(i)));
        let places: Vec<PxPoint> = arm.chain(other).collect();
        let mut is_corner = vec![false; places.len()];
        let farthest = |is_corner: &[bool]| {
            let found = stiff(&places, &[1.0; 23], is_corner);
            found.iter().zip(&places).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
        };
        assert!(farthest(&is_corner) > 0.3);
        is_corner[11] = true;
        assert!(farthest(&is_corner) < 1e-9);
    }

    #[test]
    fn few_places_stay() {
        let places = [PxPoint::new(1.0, 2.0), PxPoint::new(3.0, 5.0)];
        assert_eq!(stiff(&places, &[1.0, 0.5], &[false; 2]), places);
        assert_eq!(stiff(&[], &[], &[]), []);
    }
}
