//! Noise of paper, boards and cameras.

use super::plane::Plane;
use crate::corpus::random::Random;

/// Noise of mean 0 and variance 1 in which pixels nearer than about `size_px` resemble each other.
pub(crate) fn grain(width: usize, height: usize, size_px: f64, random: &mut Random) -> Plane {
    let white = Plane::from_fn(width, height, |_, _| random.normal());
    if size_px > 0.0 { white.blurred(size_px).normalized() } else { white }
}

/// The same for what is stretched: fibres of wood, wipes of a sponge.
pub(crate) fn streaks(
    (width, height): (usize, usize),
    (across_px, down_px): (f64, f64),
    random: &mut Random,
) -> Plane {
    // What lies beyond the edge is blurred in too, not the edge's own pixel again and again.
    let beyond = |sd_px: f64| {
        let mut count = 0_u32;
        while f64::from(count) < 3.0 * sd_px {
            count += 1;
        }
        usize::try_from(count).unwrap_or(0)
    };
    let (left, top) = (beyond(across_px), beyond(down_px));
    Plane::from_fn(width + 2 * left, height + 2 * top, |_, _| random.normal())
        .blurred_apart(across_px, down_px)
        .cut((left, top), (width, height))
        .normalized()
}

/// Slow changes over `size_px`, roughly of mean 0 and variance 1: a coarse grid of random values with a
/// smooth passage between them.
pub(crate) fn clouds(width: usize, height: usize, size_px: f64, random: &mut Random) -> Plane {
    let cells = |size: usize| {
        let mut count = 2;
        while (count as f64 - 2.0) * size_px < size as f64 {
            count += 1;
        }
        count
    };
    let coarse = Plane::from_fn(cells(width), cells(height), |_, _| random.normal());
    let smooth = |place: f64| {
        let share = place - libm::floor(place);
        libm::floor(place) + share * share * (3.0 - 2.0 * share)
    };
    Plane::from_fn(width, height, |x, y| coarse.at(smooth(x / size_px), smooth(y / size_px)))
}

/// From 0 to 1 while the value goes from `from` to `to`, level at both.
pub(crate) fn step(from: f64, to: f64, value: f64) -> f64 {
    let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Standard normal quantile of a share from 0.001 to 0.999, by halving the distribution function.
pub(crate) fn quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-4.0, 4.0);
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        let below = 0.5 * (1.0 + libm::erf(middle * core::f64::consts::FRAC_1_SQRT_2));
        if below < share { low = middle } else { high = middle }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quantile_of_a_sixth_is_about_one_standard_deviation_below() {
        // Of a normal distribution 15.866 % lie below -1.
        assert!((quantile(0.158_66) + 1.0).abs() < 1e-4);
        assert!(quantile(0.5).abs() < 1e-9);
    }
}
