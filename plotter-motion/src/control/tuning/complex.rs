//! [`Complex`]: a complex number, as far as frequency responses need one.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A complex number. Its functions come from `libm`, so the same frequency response has the same bits everywhere.
///
/// ```
/// # use plotter_motion::control::tuning::Complex;
/// let product = Complex { re: 1.0, im: 2.0 } * Complex { re: 3.0, im: -1.0 };
/// assert_eq!(product, Complex { re: 5.0, im: 5.0 });
/// assert_eq!(Complex { re: 3.0, im: 4.0 }.size(), 5.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// 0.
    pub const ZERO: Self = Self::real(0.0);
    /// 1.
    pub const ONE: Self = Self::real(1.0);

    /// A real number.
    #[must_use]
    pub const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    /// The number of this size and this angle.
    #[must_use]
    pub fn polar(size: f64, angle_rad: f64) -> Self {
        Self { re: size * libm::cos(angle_rad), im: size * libm::sin(angle_rad) }
    }

    /// Absolute value.
    #[must_use]
    pub fn size(self) -> f64 {
        libm::hypot(self.re, self.im)
    }

    /// Argument, −π to π; 0 for 0.
    #[must_use]
    pub fn angle_rad(self) -> f64 {
        libm::atan2(self.im, self.re)
    }

    /// `e` to its power.
    #[must_use]
    pub fn exp(self) -> Self {
        Self::polar(libm::exp(self.re), self.im)
    }

    /// `e^z - 1`, right near 0 too.
    #[must_use]
    pub fn exp_m1(self) -> Self {
        // e^(a + jb) - 1 = (e^a - 1) cos b - 2 sin²(b/2) + j e^a sin b
        let half = libm::sin(0.5 * self.im);
        Self {
            re: libm::expm1(self.re) * libm::cos(self.im) - 2.0 * half * half,
            im: libm::exp(self.re) * libm::sin(self.im),
        }
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Mul<f64> for Complex {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}

impl Div for Complex {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        // Divided by the larger part first (R. L. Smith, "Algorithm 116: Complex division", 1962): no square overflows.
        if other.re.abs() >= other.im.abs() {
            let ratio = other.im / other.re;
            let below = other.re + other.im * ratio;
            Self { re: (self.re + self.im * ratio) / below, im: (self.im - self.re * ratio) / below }
        } else {
            let ratio = other.re / other.im;
            let below = other.re * ratio + other.im;
            Self { re: (self.re * ratio + self.im) / below, im: (self.im * ratio - self.re) / below }
        }
    }
}

impl Neg for Complex {
    type Output = Self;

    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few last bits.
    const ROUNDING: f64 = 1e-15;

    #[test]
    fn a_quotient_times_the_divisor_is_the_dividend() {
        let a = Complex { re: 3.0, im: -2.0 };
        for b in [Complex { re: 0.5, im: 4.0 }, Complex { re: -7.0, im: 1.0 }, Complex { re: 0.0, im: 2.0 }] {
            assert!((a / b * b - a).size() < 10.0 * ROUNDING, "{b:?}");
        }
    }

    #[test]
    fn powers_of_e_near_one_lose_no_digit() {
        let small = Complex { re: 1e-9, im: -2e-9 };
        // e^z - 1 = z + z²/2 + ...
        assert!((small.exp_m1() - small - small * small * 0.5).size() < 1e-24);
        let large = Complex { re: -0.7, im: 2.0 };
        assert!((large.exp_m1() - (large.exp() - Complex::ONE)).size() < ROUNDING);
    }
}
