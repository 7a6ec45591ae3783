//! Sine and cosine of an angle within a few turns, and the angle of a direction. `libm`'s, for any angle, take 4.7 KB of a
//! microcontroller's flash, and 1.2 KB.

use crate::whole::{float, nearest_even};
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// π/2 in parts: the first 33 bits, whose product with a small whole number is exact, and what it is more.
const QUARTER: f64 = f64::from_bits(FRAC_PI_2.to_bits() & !0xf_ffff);
const QUARTER_REST: f64 = (FRAC_PI_2 - QUARTER) + 6.123_233_995_736_766e-17;

/// Sine and cosine of an angle of at most ±10 rad, right to 2·10⁻¹⁶.
pub(crate) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    let whole_quarters = nearest_even(angle_rad * FRAC_2_PI);
    let quarters = float(whole_quarters);
    let rest_rad = (angle_rad - quarters * QUARTER) - quarters * QUARTER_REST;
    let square = rest_rad * rest_rad;
    let (sin, cos) = (rest_rad * series(3.0, square), series(2.0, square));
    match whole_quarters & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The power series, within an eighth of a turn: 1 − x²/(2·1) (1 − x²/(4·3) (…)) is the cosine, and with 3·2, 5·4, … the sine is x times
/// it.
fn series(first: f64, square: f64) -> f64 {
    let (mut sum, mut n) = (1.0, first + 16.0);
    while n >= first {
        sum = 1.0 - sum * square / (n * (n - 1.0));
        n -= 2.0;
    }
    sum
}

/// The angle of the direction (x, y), -π to π, good to some last bits.
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    // tan(φ/2) = y / (r + x), of the angle to the x axis on whichever side is nearer.
    let r = libm::sqrt(x * x + y * y);
    let angle_rad = if y == 0.0 { y } else { 2.0 * atan(y / (r + x.abs())) };
    if x == 0.0 && y != 0.0 {
        // A quarter is one to the last bit.
        return FRAC_PI_2.copysign(y);
    }
    if x > 0.0 || (x == 0.0 && y == 0.0) { angle_rad } else { PI.copysign(y) - angle_rad }
}

/// The angle whose tangent is `tangent`, which is from -1 to 1.
pub(crate) fn atan(tangent: f64) -> f64 {
    // tan(φ/2) = t / (1 + √(1 + t²)), twice: then it is below 0.2, and twelve terms of t - t³/3 + t⁵/5 - … are enough.
    let mut t = tangent;
    for _ in 0..2 {
        t /= 1.0 + libm::sqrt(1.0 + t * t);
    }
    let square = t * t;
    let (mut sum, mut n) = (0.0, 25.0);
    while n > 0.0 {
        sum = 1.0 / n - square * sum;
        n -= 2.0;
    }
    4.0 * t * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_as_good_as_any_angle_s() {
        /// The last bit of 1, both ways.
        const LAST_BIT: f64 = 2.3e-16;
        for thousandth in -10_000..=10_000 {
            let angle_rad = f64::from(thousandth) / 1e3;
            let (sin, cos) = sin_cos(angle_rad);
            assert!((sin - libm::sin(angle_rad)).abs() <= LAST_BIT, "sin {angle_rad}");
            assert!((cos - libm::cos(angle_rad)).abs() <= LAST_BIT, "cos {angle_rad}");
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn the_angle_of_a_direction_is_good_to_some_last_bits() {
        const SOME_LAST_BITS: f64 = 6.0 * f64::EPSILON;
        for thousandth in -3141..=3141 {
            let angle_rad = f64::from(thousandth) / 1e3;
            for length in [1e-6, 1.0, 123.456, 1e7] {
                let (y, x) = (length * libm::sin(angle_rad), length * libm::cos(angle_rad));
                let (ours, exact) = (atan2(y, x), libm::atan2(y, x));
                assert!(
                    (ours - exact).abs() <= SOME_LAST_BITS * exact.abs(),
                    "{angle_rad}: {ours} for {exact}"
                );
            }
        }
        for (y, x) in [(0.0, 1.0), (-0.0, 1.0), (0.0, -2.0), (-0.0, -2.0), (0.0, 0.0), (-0.0, 0.0)] {
            let (ours, exact) = (atan2(y, x), libm::atan2(y, x));
            assert!(
                (ours - exact).abs() <= SOME_LAST_BITS && ours.is_sign_negative() == exact.is_sign_negative()
            );
        }
        assert_eq!([atan2(3.0, 0.0), atan2(-3.0, 0.0)], [FRAC_PI_2, -FRAC_PI_2]);
    }
}
