//! The head's delays, from what all passes of a search saw.

use crate::Optics;
use crate::sense::{Passed, crossing::Delays};
use alloc::vec::Vec;

/// A fast pass sees a line no farther from where a slow one does, mm: 4 ms at 285 mm/s more.
const FARTHEST_AHEAD_MM: f64 = 1.2;

/// Least number of crossings that tell delays: with fewer, dust at one of them would weigh too much.
const LEAST_SEEN: usize = 6;

/// What half the difference of both delays makes at the slow speed is seen from here on, mm: three times what
/// 16 crossings know of it.
const LEAST_DIFFERENCE_MM: f64 = 0.007;

/// What the passes over all crossings show; what is known where they are too few.
///
/// Two passes up, a fast one and a slow one, see a line apart by the difference of their speeds times the
/// delay up; a slow one up and one down by the slow speed times the sum of both delays. In the mean of
/// the slow ones half the difference of the delays remains: that is what is wanted, and where it is too
/// small to be seen both are taken to be the same.
pub(super) fn shown<'a>(
    optics: &Optics,
    fast_mm_s: f64,
    slow_mm_s: f64,
    crossings: impl Iterator<Item = &'a [Passed]>,
) -> Delays {
    let known = Delays::known(optics);
    let (mut ahead_mm, mut apart_mm) = (Vec::new(), Vec::new());
    for passes in crossings {
        let of = |velocity_mm_s: f64| {
            passes
                .iter()
                .filter(move |pass| pass.sighting.like_a_line && pass.velocity_mm_s == velocity_mm_s)
                .map(|pass| pass.sighting.at_mm)
        };
        let (Some(up_mm), Some(down_mm)) = (of(slow_mm_s).next(), of(-slow_mm_s).next()) else {
            continue;
        };
        apart_mm.push(up_mm - down_mm);
        let off = |at_mm: &f64| libm::fabs(at_mm - up_mm);
        let nearest = of(fast_mm_s).min_by(|one, other| off(one).total_cmp(&off(other)));
        ahead_mm.extend(nearest.map(|at_mm| at_mm - up_mm).filter(|mm| libm::fabs(*mm) < FARTHEST_AHEAD_MM));
    }
    let faster_mm_s = fast_mm_s - slow_mm_s;
    if ahead_mm.len() < LEAST_SEEN || faster_mm_s <= 0.0 {
        return known;
    }
    let (Some(ahead_mm), Some(apart_mm)) = (median(&mut ahead_mm), median(&mut apart_mm)) else {
        return known;
    };
    let (up_s, sum_s) = (ahead_mm / faster_mm_s, apart_mm / slow_mm_s);
    if libm::fabs(slow_mm_s * (up_s - 0.5 * sum_s)) < LEAST_DIFFERENCE_MM {
        return known;
    }
    Delays { up_s, down_s: sum_s - up_s, sigma_s: known.sigma_s }
}

/// The middle one of some numbers; the mean of both middle ones.
pub(super) fn median(numbers: &mut [f64]) -> Option<f64> {
    numbers.sort_unstable_by(f64::total_cmp);
    let upper = numbers.get(numbers.len() / 2)?;
    let lower = numbers.get((numbers.len() - 1) / 2)?;
    Some(0.5 * (lower + upper))
}
