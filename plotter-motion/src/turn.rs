//! Sine and cosine of an angle within a few turns, and the angle of a direction, in `f32`, which small
//! processors reckon with in hardware; `libm`'s are for any angle, and longer.

use crate::root::root;
use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// π/2 in parts: the first 8 bits, whose product with a small whole number is exact, and what it is more.
const QUARTER: f32 = f32::from_bits(FRAC_PI_2.to_bits() & !0xffff);
const QUARTER_REST: f32 = 4.838_268e-4;

/// Sine and cosine of an angle of at most ±10 rad, right to 2·10⁻⁷.
pub(crate) fn sin_cos(angle_rad: f32) -> (f32, f32) {
    let half = if angle_rad < 0.0 { -0.5 } else { 0.5 };
    #[expect(clippy::cast_possible_truncation, reason = "some few quarters")]
    let whole_quarters = (angle_rad * FRAC_2_PI + half) as i8;
    let quarters = f32::from(whole_quarters);
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

/// The power series, within an eighth of a turn: 1 − x²/(2·1) (1 − x²/(4·3) (…)) is the cosine, and with 3·2,
/// 5·4, … the sine is x times it.
fn series(first: f32, square: f32) -> f32 {
    let (mut sum, mut n) = (1.0, first + 8.0);
    while n >= first {
        sum = 1.0 - sum * square / (n * (n - 1.0));
        n -= 2.0;
    }
    sum
}

/// The angle of the direction (x, y), -π to π, good to some last bits.
pub(crate) fn atan2(y: f32, x: f32) -> f32 {
    // tan(φ/2) = y / (r + x), of the angle to the x axis on whichever side is nearer.
    let r = root(x * x + y * y);
    let angle_rad = if y == 0.0 { y } else { 2.0 * atan(y / (r + x.abs())) };
    if x == 0.0 && y != 0.0 {
        // A quarter is one to the last bit.
        return FRAC_PI_2.copysign(y);
    }
    if x > 0.0 || (x == 0.0 && y == 0.0) { angle_rad } else { PI.copysign(y) - angle_rad }
}

/// The angle whose tangent is `tangent`, which is from -1 to 1.
pub(crate) fn atan(tangent: f32) -> f32 {
    // tan(φ/2) = t / (1 + √(1 + t²)), twice: then it is below 0.2, and five terms of t - t³/3 + t⁵/5 - … are
    // enough.
    let mut t = tangent;
    for _ in 0..2 {
        t /= 1.0 + root(1.0 + t * t);
    }
    let square = t * t;
    let (mut sum, mut n) = (0.0, 9.0);
    while n > 0.0 {
        sum = 1.0 / n - square * sum;
        n -= 2.0;
    }
    4.0 * t * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::single;

    #[test]
    fn it_is_as_good_as_any_angle_s() {
        /// Three last bits of 1.
        const LAST_BITS: f64 = 2e-7;
        let mut most = 0.0_f64;
        for thousandth in -10_000_i16..=10_000 {
            let angle_rad = f32::from(thousandth) / 1e3;
            let (sin, cos) = sin_cos(angle_rad);
            let exact_rad = f64::from(angle_rad);
            for (ours, exact) in [(sin, libm::sin(exact_rad)), (cos, libm::cos(exact_rad))] {
                most = most.max((f64::from(ours) - exact).abs());
            }
        }
        assert!(most <= LAST_BITS, "{most}");
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn the_angle_of_a_direction_is_good_to_some_last_bits() {
        const SOME_LAST_BITS: f32 = 6.0 * f32::EPSILON;
        for thousandth in -3141_i16..=3141 {
            let angle_rad = f64::from(thousandth) / 1e3;
            for length in [1e-6, 1.0, 123.456, 1e7] {
                let (y, x) = (single(length * libm::sin(angle_rad)), single(length * libm::cos(angle_rad)));
                let (ours, exact) = (atan2(y, x), single(libm::atan2(y.into(), x.into())));
                assert!(
                    (ours - exact).abs() <= SOME_LAST_BITS * exact.abs(),
                    "{angle_rad}: {ours} for {exact}"
                );
            }
        }
        for (y, x) in [(0.0_f32, 1.0_f32), (-0.0, 1.0), (0.0, -2.0), (-0.0, -2.0), (0.0, 0.0), (-0.0, 0.0)] {
            let (ours, exact) = (atan2(y, x), libm::atan2f(y, x));
            assert!(
                (ours - exact).abs() <= SOME_LAST_BITS && ours.is_sign_negative() == exact.is_sign_negative()
            );
        }
        assert_eq!([atan2(3.0, 0.0), atan2(-3.0, 0.0)], [FRAC_PI_2, -FRAC_PI_2]);
    }
}
