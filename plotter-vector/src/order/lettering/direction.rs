//! [`direction`]: which way a group of letters is read.

use super::mark::{Mark, Placed};
use super::{ALIGNED, NEAR, TAIL};
use crate::order::point_tree::PointTree;
use core::f64::consts::FRAC_PI_2;

/// Limits for very large groups: letters that are asked, and directions that are tried.
const ASKED: usize = 1000;
const DIRECTIONS: usize = 32;

/// The direction in which most bottoms of the group are aligned, rad; to the right and up before any other.
pub(super) fn direction(group: &[&Mark<'_>]) -> f64 {
    let asked = group.get(..ASKED).unwrap_or(group);
    let mut best = (0, 0.0);
    for angle in directions(asked) {
        // The middles of letters lie on a line only roughly, their bottoms exactly.
        let angle = fit(asked, fit(asked, angle));
        let aligned = aligned(asked, angle);
        if aligned > best.0 {
            best = (aligned, angle);
        }
    }
    best.1
}

/// Directions in which a group may be read: right, up, and from letters to their neighbours.
fn directions<'a>(group: &'a [&Mark<'a>]) -> impl Iterator<Item = f64> + 'a {
    let place = move |mark: u32| group.get(mark as usize).map(|mark| mark.middle()).unwrap_or_default();
    let tree = PointTree::new(group.len(), &place);
    let step = group.len().div_ceil(DIRECTIONS).max(1);
    let to_neighbour = move |(index, mark): (usize, &&Mark<'a>)| {
        let mut nearest = (f64::INFINITY, None);
        tree.visit(mark.middle(), f64::INFINITY, &place, &mut |other, squared| {
            if other as usize == index {
                return nearest.0;
            }
            nearest = (squared, group.get(other as usize));
            squared
        });
        let (from, to) = (mark.middle(), nearest.1?.middle());
        Some(readable(libm::atan2(to.y - from.y, to.x - from.x)))
    };
    [0.0, -FRAC_PI_2].into_iter().chain(group.iter().enumerate().step_by(step).filter_map(to_neighbour))
}

/// The direction or its opposite, so that it is read from the left or from below.
fn readable(angle: f64) -> f64 {
    let turn = core::f64::consts::PI;
    // A degree beyond vertical is vertical, drawn by hand.
    let slack = turn / 180.0;
    let angle = if angle >= FRAC_PI_2 - slack { angle - turn } else { angle };
    if angle < -FRAC_PI_2 - slack { angle + turn } else { angle }.max(-FRAC_PI_2)
}

/// The direction of the line through the bottoms of those whose bottoms are near the median one.
fn fit(group: &[&Mark<'_>], angle: f64) -> f64 {
    let placed: Vec<Placed<'_>> = group.iter().map(|mark| Placed::new(mark, angle)).collect();
    let Some(height) = median(placed.iter().map(|letter| letter.bottom - letter.top)) else { return angle };
    let Some(base) = median(placed.iter().map(|letter| letter.bottom)) else { return angle };
    let on_line: Vec<(f64, f64)> = placed
        .iter()
        .filter(|letter| (letter.bottom - base).abs() <= TAIL * height)
        .map(|letter| ((letter.left + letter.right) / 2.0, letter.bottom))
        .collect();
    let count = on_line.len().max(1) as f64;
    let mean = (
        on_line.iter().map(|at| at.0).sum::<f64>() / count,
        on_line.iter().map(|at| at.1).sum::<f64>() / count,
    );
    let (mut square, mut product) = (0.0, 0.0);
    for (along, across) in on_line {
        square += (along - mean.0) * (along - mean.0);
        product += (along - mean.0) * (across - mean.1);
    }
    // Letters above each other say nothing of a direction.
    if square > height * height / 4.0 { readable(angle + libm::atan2(product, square)) } else { angle }
}

/// How many have a neighbour at the same height: twice the aligned bottoms and the tops of those.
fn aligned(group: &[&Mark<'_>], angle: f64) -> usize {
    let mut placed: Vec<Placed<'_>> = group.iter().map(|mark| Placed::new(mark, angle)).collect();
    placed.sort_by(|a, b| a.bottom.total_cmp(&b.bottom));
    let Some(height) = median(placed.iter().map(|letter| letter.bottom - letter.top)) else { return 0 };
    let count = |index: usize, letter: &Placed<'_>| {
        let others = placed.iter().skip(index.saturating_sub(NEAR)).take(2 * NEAR);
        let same: Vec<&Placed<'_>> = others
            .filter(|other| other.mark.stroke != letter.mark.stroke)
            .filter(|other| (other.bottom - letter.bottom).abs() <= ALIGNED * height)
            .filter(|other| letter.gap(other) > -ALIGNED * height)
            .collect();
        let tops = same.iter().any(|other| (other.top - letter.top).abs() <= ALIGNED * height);
        2 * usize::from(!same.is_empty()) + usize::from(tops)
    };
    placed.iter().enumerate().map(|(index, letter)| count(index, letter)).sum()
}

/// The middle one of the values; of an even number the upper one.
pub(super) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
