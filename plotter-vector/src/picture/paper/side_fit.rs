//! [`fitted_side`]: a side of a sheet to a part of a pixel.

use super::edge_lines::EdgeLine;
use crate::picture::{Gray, PxPoint};

/// Places along a side at which the edge is looked for.
const PLACES: u32 = 240;

/// Near the corners two edges are seen at once: so much of a side is left out at both ends.
const NEAR_CORNERS: f64 = 0.02;

/// Across the side the picture is looked at in steps of this, px.
const STEP_PX: f64 = 0.5;

/// At each place the means of so many levels to both sides along the edge are taken, a px apart.
const ALONG: i8 = 2;

/// The level falls by at least so much a px where there is an edge.
const LEAST_SLOPE: f64 = 1.5;

/// Places whose distance from the line is more than so many standard deviations count nothing: Tukey's
/// biweight, with the constant that keeps 95 % of a bell curve's efficiency (P. J. Huber, *Robust
/// statistics*, 1981, section 7.8; the deviation from the median one, section 5.1).
const BIWEIGHT: f64 = 4.685;
const OF_MEDIAN: f64 = 1.4826;

/// The deviation is taken for at least this, px: to less no edge is known.
const LEAST_DEVIATION_PX: f64 = 0.15;

/// Rounds of the robust fit; its weights stand still after some.
const ROUNDS: usize = 12;

/// A side needs so many places with an edge.
const LEAST_PLACES: usize = 24;

/// A side as it was fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FittedSide {
    pub(super) line: EdgeLine,
    /// Standard deviation of the edge's places from the line, px, without outliers.
    pub(super) error_px: f64,
}

/// The side near a line between two places, which lies at most `reach_px` from it; none where too little of
/// an edge is seen.
pub(super) fn fitted_side(
    picture: &Gray,
    line: EdgeLine,
    [from, to]: [PxPoint; 2],
    reach_px: f64,
    blur_px: f64,
) -> Option<FittedSide> {
    let places: Vec<PxPoint> = (0..PLACES)
        .filter_map(|place| {
            let part = (f64::from(place) + 0.5) / f64::from(PLACES);
            let at = from + (to - from) * (NEAR_CORNERS + (1.0 - 2.0 * NEAR_CORNERS) * part);
            Some(at + line.out * edge(picture, line, at, reach_px, blur_px)?)
        })
        .collect();
    if places.len() < LEAST_PLACES {
        return None;
    }
    // From the median distance on: the line's direction is known, and what lies beside it is not.
    let mut fitted = EdgeLine { away: line.away + median(places.iter().map(|at| line.beyond(*at)))?, ..line };
    let mut error_px = 0.0;
    for _ in 0..ROUNDS {
        let distances = || places.iter().map(|at| libm::fabs(fitted.beyond(*at)));
        let deviation = (OF_MEDIAN * median(distances())?).max(LEAST_DEVIATION_PX);
        let weight = |at: &PxPoint| {
            let part = fitted.beyond(*at) / (BIWEIGHT * deviation);
            (1.0 - part * part).max(0.0).powi(2)
        };
        let weights: f64 = places.iter().map(weight).sum();
        let squares: f64 = places.iter().map(|at| weight(at) * fitted.beyond(*at).powi(2)).sum();
        error_px = libm::sqrt(squares / weights.max(f64::MIN_POSITIVE));
        fitted = fitted.fitted(places.iter().map(|at| (*at, weight(at))))?;
    }
    Some(FittedSide { line: fitted, error_px })
}

/// How far beyond a place of a line its edge lies: where the level falls most.
fn edge(picture: &Gray, line: EdgeLine, at: PxPoint, reach_px: f64, blur_px: f64) -> Option<f64> {
    let along = line.out.perpendicular();
    let level = |beyond: f64| {
        let mut sum = 0.0;
        for step in -ALONG..=ALONG {
            sum += level(picture, at + line.out * beyond + along * f64::from(step))?;
        }
        Some(sum / f64::from(2 * ALONG + 1))
    };
    #[expect(clippy::cast_possible_truncation, reason = "some tens of steps")]
    let (reach, blur) = ((reach_px / STEP_PX) as i32, libm::ceil(3.0 * blur_px / STEP_PX) as i32);
    let levels: Vec<Option<f64>> =
        (-reach - blur..=reach + blur).map(|step| level(f64::from(step) * STEP_PX)).collect();
    // The derivative of a bell curve: the slope of the smoothed levels.
    let slope = |step: i32| -> Option<f64> {
        let (mut sum, mut norm) = (0.0, 0.0);
        for tap in -blur..=blur {
            let from = f64::from(tap) * STEP_PX;
            let weight = from * libm::exp(-from * from / (2.0 * blur_px * blur_px));
            let index = usize::try_from(step + tap + reach + blur).ok()?;
            sum += weight * (*levels.get(index)?)?;
            norm += weight * from;
        }
        Some(-sum / norm)
    };
    let slopes: Vec<Option<f64>> = (-reach..=reach).map(slope).collect();
    let steepest = slopes.iter().enumerate().filter_map(|(index, slope)| Some((index, (*slope)?)));
    let (index, here) = steepest.max_by(|one, other| one.1.total_cmp(&other.1))?;
    if here < LEAST_SLOPE {
        return None;
    }
    // At an end of what was looked at the edge may lie beyond.
    let (before, after) = ((*slopes.get(index.checked_sub(1)?)?)?, (*slopes.get(index + 1)?)?);
    let bend = before - 2.0 * here + after;
    let part = if bend < 0.0 { (before - after) / (2.0 * bend) } else { 0.0 };
    Some((index as f64 - f64::from(reach) + part.clamp(-0.5, 0.5)) * STEP_PX)
}

/// The level of a place between the middles of pixels; none outside.
fn level(picture: &Gray, at: PxPoint) -> Option<f64> {
    let (x, y) = (at.x - 0.5, at.y - 0.5);
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    if !(x >= 0.0 && y >= 0.0 && x < width - 1.0 && y < height - 1.0) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside the picture")]
    let (column, row) = (x as usize, y as usize);
    let (across, down) = (x - column as f64, y - row as f64);
    let columns = picture.width() as usize;
    let level =
        |column: usize, row: usize| picture.pixels().get(row * columns + column).map(|v| f64::from(*v));
    let upper = level(column, row)? * (1.0 - across) + level(column + 1, row)? * across;
    let lower = level(column, row + 1)? * (1.0 - across) + level(column + 1, row + 1)? * across;
    Some(upper * (1.0 - down) + lower * down)
}

/// The middle one by size; none of none.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::PxVec;

    #[test]
    fn a_side_is_found_to_a_part_of_a_pixel_beside_what_covers_it() {
        // Light up to the line y = 40.3 + 0.05 x; smooth over a pixel; a dark thing lies over a fourth of it.
        let edge = |x: f64| 40.3 + 0.05 * x;
        let level = |x: u32, y: u32| {
            if (60..110).contains(&x) && y > 20 {
                return 30;
            }
            let part = (edge(f64::from(x) + 0.5) - f64::from(y)).clamp(0.0, 1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a level")]
            let level = (90.0 + 120.0 * part) as u8;
            level
        };
        let levels = (0..80).flat_map(|y| (0..200).map(move |x| level(x, y))).collect();
        let picture = Gray::new(200, 80, levels).unwrap();
        // Known to two pixels at first.
        let ends = [PxPoint::new(0.0, 38.5), PxPoint::new(200.0, 52.0)];
        let way = ends[1] - ends[0];
        let out = -way.perpendicular() * (-1.0 / way.length());
        let line = EdgeLine { out, away: (ends[0] - PxPoint::default()).dot(out) };
        assert!(line.out.dot(PxVec::new(0.0, 1.0)) > 0.9);
        let side = fitted_side(&picture, line, ends, 8.0, 1.0).unwrap();
        for x in [5.0, 100.0, 195.0] {
            let off = side.line.beyond(PxPoint::new(x, edge(x)));
            assert!(off.abs() < 0.1, "{off} px off at {x}");
        }
        assert!(side.error_px < 0.2, "{side:?}");
        // Nothing to be seen there: no side.
        let even = Gray::new(200, 80, vec![200; 16_000]).unwrap();
        assert_eq!(fitted_side(&even, line, ends, 8.0, 1.0), None);
    }
}
