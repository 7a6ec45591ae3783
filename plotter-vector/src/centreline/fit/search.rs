//! A pattern search: places go a step along the raster's axes as long as that costs less, with shorter and
//! shorter steps.
//!
//! Source: R. Hooke, T. A. Jeeves, "Direct search solution of numerical and statistical problems" (1961).

use super::prices::FARTHEST_PX;
use crate::{PxVec, stroke::PxPoint};

/// How far places move at a time, px: from what thinning cuts off a corner down to what the raster shows of
/// an edge.
const STEPS_PX: [f64; 3] = [0.8, 0.4, 0.2];

/// Moves the places of a fit by each step, so many times around as that is better. `shift` moves those that
/// lie in one place, and tells whether that was better.
pub(crate) fn settle<F>(
    fit: &mut F,
    rounds: usize,
    places: impl Fn(&F) -> Vec<PxPoint>,
    mut shift: impl FnMut(&mut F, PxPoint, f64) -> bool,
) {
    for step_px in STEPS_PX {
        for _ in 0..rounds {
            let mut moved = false;
            for place in places(fit) {
                moved |= shift(fit, place, step_px);
            }
            if !moved {
                break;
            }
        }
    }
}

/// Each place once, in their order.
pub(crate) fn distinct(places: impl Iterator<Item = PxPoint>) -> Vec<PxPoint> {
    let mut found: Vec<PxPoint> = Vec::new();
    for at in places {
        if !found.contains(&at) {
            found.push(at);
        }
    }
    found
}

/// Where a place goes by steps of one length, and what it costs there. `cost_at` tells what it costs in a
/// place where that is better than so much; by each step it goes no farther than twice as far as ink tells
/// anything.
pub(crate) fn shifted(
    start: PxPoint,
    step_px: f64,
    cost: f64,
    mut cost_at: impl FnMut(PxPoint, f64) -> Option<f64>,
) -> (PxPoint, f64) {
    let (mut at, mut least, mut direction) = (start, cost, 0);
    // Round by round until no direction is better.
    while let Some(way) = PxVec::AXES.get(direction).copied() {
        let next = at + way * step_px;
        match (next.distance(start) <= 2.0 * f64::from(FARTHEST_PX)).then(|| cost_at(next, least)).flatten() {
            Some(less) => (at, least, direction) = (next, less, 0),
            None => direction += 1,
        }
    }
    (at, least)
}
