//! Sine and cosine of an angle within a few turns. `libm`'s, for any angle, take 4.7 KB of a microcontroller's flash.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// π/2 in parts: the first 33 bits, whose product with a small whole number is exact, and what it is more.
const QUARTER: f64 = f64::from_bits(FRAC_PI_2.to_bits() & !0xf_ffff);
const QUARTER_REST: f64 = (FRAC_PI_2 - QUARTER) + 6.123_233_995_736_766e-17;

/// Sine and cosine of an angle of at most ±10 rad, right to 2·10⁻¹⁶.
pub(crate) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    let quarters = libm::rint(angle_rad * FRAC_2_PI);
    let rest_rad = (angle_rad - quarters * QUARTER) - quarters * QUARTER_REST;
    let square = rest_rad * rest_rad;
    let (sin, cos) = (rest_rad * series(3.0, square), series(2.0, square));
    #[expect(clippy::cast_possible_truncation, reason = "a few quarters")]
    match quarters as i8 & 3 {
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
}
