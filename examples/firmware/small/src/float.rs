//! `f64` by whole numbers: a number is taken apart, reckoned exactly or with a last bit that says "and some
//! more", and rounded once, in [`pack`].

const SIGN: u64 = 1 << 63;
const INFINITY: u64 = 0x7FF << 52;
const NAN: u64 = INFINITY | 1 << 51;

/// How a float is laid out: bits of the mantissa, and what is added to the exponent.
#[derive(Clone, Copy)]
struct Format {
    mantissa_bits: u32,
    most_exponent: i32,
}

const DOUBLE: Format = Format { mantissa_bits: 52, most_exponent: 0x7FF };
const SINGLE: Format = Format { mantissa_bits: 23, most_exponent: 0xFF };

/// The magnitude of a number that is neither infinite nor NaN: `mantissa * 2^exponent`.
#[derive(Clone, Copy)]
struct Parts {
    exponent: i32,
    mantissa: u64,
}

/// Of `bits` without a sign; the mantissa has 53 bits, or is zero.
#[inline(never)]
fn unpack(bits: u64) -> Parts {
    let (exponent, mantissa) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
    if exponent > 0 {
        return Parts { exponent: exponent - 1075, mantissa: mantissa | 1 << 52 };
    }
    let shift = mantissa.leading_zeros() - 11;
    Parts { exponent: 1 - 1075 - shift as i32, mantissa: mantissa << shift }
}

/// The nearest number without a sign, of two equally near ones the even one. The lowest bit of the mantissa
/// may stand for what is below it, if it has 55 bits at least.
#[inline(never)]
fn pack(Parts { exponent, mantissa }: Parts, format: Format) -> u64 {
    if mantissa == 0 {
        return 0;
    }
    let lead = mantissa.leading_zeros();
    let mantissa = mantissa << lead;
    // Of 2^0 it is half of the greatest one; the mantissa is one of 64 bits.
    let exponent = exponent - lead as i32 + 63 + format.most_exponent / 2;
    if exponent >= format.most_exponent {
        return (format.most_exponent as u64) << format.mantissa_bits;
    }
    // Below the least exponent the mantissa becomes shorter.
    let lost_bits = 63 - format.mantissa_bits as i32 + (1 - exponent).max(0);
    if lost_bits > 64 {
        return 0;
    }
    let (kept, lost) =
        if lost_bits == 64 { (0, mantissa) } else { (mantissa >> lost_bits, mantissa << (64 - lost_bits)) };
    // The mantissa's own first bit adds one to the exponent, and so does rounding up to the next power of
    // two.
    let bits = (((exponent - 1).max(0) as u64) << format.mantissa_bits) + kept;
    bits + u64::from(lost > SIGN || (lost == SIGN && kept & 1 == 1))
}

/// `number` shifted to the right; what is lost is told by the lowest bit.
fn shifted(number: u64, bits: u32) -> u64 {
    if bits >= 64 {
        return u64::from(number != 0);
    }
    let kept = number >> bits;
    kept | u64::from(kept << bits != number)
}

/// `a + b`.
#[must_use]
pub fn add(a: u64, b: u64) -> u64 {
    // The greater magnitude first.
    let (a, b) = if (a & !SIGN) < (b & !SIGN) { (b, a) } else { (a, b) };
    let (high, low, sign) = (a & !SIGN, b & !SIGN, a & SIGN);
    if high >= INFINITY {
        return if high > INFINITY || (low == INFINITY && a != b) { NAN } else { a };
    }
    let (first, second) = (unpack(high), unpack(low));
    // Ten bits more, so that what rounding looks at is there, and one to spare for the sum.
    let more = shifted(second.mantissa << 10, first.exponent.abs_diff(second.exponent));
    let whole = first.mantissa << 10;
    let mantissa = if (a ^ b) & SIGN == 0 { whole + more } else { whole - more };
    let sign = if mantissa == 0 { a & b & SIGN } else { sign };
    sign | pack(Parts { exponent: first.exponent - 10, mantissa }, DOUBLE)
}

/// `a * b`.
#[must_use]
pub fn multiply(a: u64, b: u64) -> u64 {
    let (high, low, sign) = (a & !SIGN, b & !SIGN, (a ^ b) & SIGN);
    if high >= INFINITY || low >= INFINITY {
        let is_number = high <= INFINITY && low <= INFINITY && high != 0 && low != 0;
        return if is_number { sign | INFINITY } else { NAN };
    }
    let (first, second) = (unpack(high), unpack(low));
    let (mantissa, bits) = product(first.mantissa << 11, second.mantissa << 11);
    // The product's upper 64 bits of 128.
    let exponent = first.exponent + second.exponent - 22 + 64;
    sign | pack(Parts { exponent, mantissa: mantissa | u64::from(bits != 0) }, DOUBLE)
}

/// Upper half of a product, and what tells whether the lower half is zero.
fn product(a: u64, b: u64) -> (u64, u32) {
    let half = |number: u64| (number >> 32, number & 0xFFFF_FFFF);
    let ((a_high, a_low), (b_high, b_low)) = (half(a), half(b));
    let lowest = a_low * b_low;
    let (one, other) = (a_low * b_high, a_high * b_low);
    let middle = (lowest >> 32) + (one & 0xFFFF_FFFF) + (other & 0xFFFF_FFFF);
    let upper = a_high * b_high + (one >> 32) + (other >> 32) + (middle >> 32);
    (upper, lowest as u32 | middle as u32)
}

/// `a / b`.
#[must_use]
pub fn divide(a: u64, b: u64) -> u64 {
    let (high, low, sign) = (a & !SIGN, b & !SIGN, (a ^ b) & SIGN);
    let is_number = high <= INFINITY && low <= INFINITY;
    if high >= INFINITY || low >= INFINITY || low == 0 || high == 0 {
        return if !is_number || (high == low) {
            NAN
        } else if high >= INFINITY || low == 0 {
            sign | INFINITY
        } else {
            sign
        };
    }
    let (first, second) = (unpack(high), unpack(low));
    let (mut rest, divisor) = (first.mantissa, second.mantissa);
    let mut quotient = 0;
    for _ in 0..56 {
        quotient <<= 1;
        if rest >= divisor {
            rest -= divisor;
            quotient |= 1;
        }
        rest <<= 1;
    }
    let exponent = first.exponent - second.exponent - 55;
    sign | pack(Parts { exponent, mantissa: quotient | u64::from(rest != 0) }, DOUBLE)
}

/// How two numbers lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The first is the smaller one.
    Less = -1,
    /// Equal, also 0 and −0.
    Equal = 0,
    /// The first is the greater one.
    Greater = 1,
    /// One of them is NaN.
    None = 2,
}

/// How `a` and `b` lie.
#[inline(never)]
#[must_use]
pub fn compare(a: u64, b: u64) -> Order {
    let (high, low) = (a & !SIGN, b & !SIGN);
    if high > INFINITY || low > INFINITY {
        return Order::None;
    }
    let signed = |bits: u64, magnitude: u64| {
        let number = magnitude.cast_signed();
        if bits & SIGN == 0 { number } else { -number }
    };
    let (a, b) = (signed(a, high), signed(b, low));
    if a < b {
        Order::Less
    } else if a > b {
        Order::Greater
    } else {
        Order::Equal
    }
}

/// A whole number as `f64`.
#[inline(never)]
#[must_use]
pub fn from_u64(number: u64) -> u64 {
    pack(Parts { exponent: 0, mantissa: number }, DOUBLE)
}

/// A whole number as `f64`.
#[must_use]
pub fn from_i64(number: i64) -> u64 {
    number.cast_unsigned() & SIGN | from_u64(number.unsigned_abs())
}

/// Towards zero; `number` fits, or nobody looks at what comes out.
#[inline(never)]
#[must_use]
pub fn to_i64(number: u64) -> i64 {
    let Parts { exponent, mantissa } = unpack(number & !SIGN);
    let shift = exponent.unsigned_abs();
    let magnitude = if shift > 63 {
        0
    } else if exponent < 0 {
        mantissa >> shift
    } else {
        mantissa << shift
    };
    let magnitude = magnitude.cast_signed();
    if number & SIGN == 0 { magnitude } else { magnitude.wrapping_neg() }
}

/// An `f64` as `f32`.
#[must_use]
pub fn narrow(number: u64) -> u32 {
    let magnitude = number & !SIGN;
    let bits = if magnitude > INFINITY { NAN >> 29 & 0x7FFF_FFFF } else { pack(unpack(magnitude), SINGLE) };
    (number >> 32) as u32 & 1 << 31 | bits as u32
}

/// An `f32` as `f64`.
#[must_use]
pub fn widen(number: u32) -> u64 {
    let sign = u64::from(number & 1 << 31) << 32;
    let exponent = (number >> 23 & 0xFF) as i32;
    let mantissa = u64::from(number & ((1 << 23) - 1));
    sign | match exponent {
        0xFF => INFINITY | mantissa << 29,
        0 => pack(Parts { exponent: 1 - 150, mantissa }, DOUBLE),
        _ => pack(Parts { exponent: exponent - 150, mantissa: mantissa | 1 << 23 }, DOUBLE),
    }
}

/// A whole number as `f32`.
#[must_use]
pub fn single_from_u64(number: u64) -> u32 {
    pack(Parts { exponent: 0, mantissa: number }, SINGLE) as u32
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const CASES: u32 = 2_000_000;

    struct Bits(u64);

    impl Bits {
        fn next(&mut self) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.0 ^ self.0 >> 33
        }

        /// Any number; half of them near one, every so often with few bits, an eighth at the ends of what
        /// there is.
        fn number(&mut self) -> u64 {
            let (bits, how) = (self.next(), self.next());
            let bits = if how & 8 == 0 { bits } else { bits & !(u64::MAX >> (12 + (how >> 8) % 52)) };
            let bits = if how & 16 == 0 { bits } else { bits | u64::MAX >> (12 + (how >> 8) % 52) };
            let exponent = |exponent: u64| bits & !INFINITY | exponent << 52;
            match how & 7 {
                0..=3 => exponent(1023 - 40 + (how >> 16) % 80),
                4 => exponent([0, 1, 2, 2045, 2046, 2047, 1023, 53][(how >> 16) as usize % 8]),
                5 => exponent(1023 - 160 + (how >> 16) % 320),
                6 => [0, SIGN, INFINITY, INFINITY | SIGN, NAN, 1, SIGN | 1, 1.0_f64.to_bits()]
                    [(how >> 16) as usize % 8],
                _ => bits,
            }
        }
    }

    fn same(ours: u64, theirs: f64, what: &str, a: u64, b: u64) {
        let ours = f64::from_bits(ours);
        assert!(
            ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()),
            "{what} of {a:#x} and {b:#x}: {ours:e}, not {theirs:e}"
        );
    }

    #[test]
    fn sums_products_quotients_and_orders_are_the_processor_s() {
        let mut bits = Bits(1);
        for _ in 0..CASES {
            let a = bits.number();
            // Now and then two that are nearly alike.
            let b = if bits.next() & 3 == 0 {
                a ^ (bits.next() & 3) ^ (bits.next() & SIGN)
            } else {
                bits.number()
            };
            let (x, y) = (f64::from_bits(a), f64::from_bits(b));
            same(add(a, b), x + y, "sum", a, b);
            same(multiply(a, b), x * y, "product", a, b);
            same(divide(a, b), x / y, "quotient", a, b);
            let order = match x.partial_cmp(&y) {
                Some(core::cmp::Ordering::Less) => Order::Less,
                Some(core::cmp::Ordering::Equal) => Order::Equal,
                Some(core::cmp::Ordering::Greater) => Order::Greater,
                None => Order::None,
            };
            assert_eq!(compare(a, b), order, "{x:e} and {y:e}");
        }
    }

    #[test]
    fn numbers_change_their_kind_as_in_the_processor() {
        let mut bits = Bits(2);
        for _ in 0..CASES {
            let a = bits.number();
            let x = f64::from_bits(a);
            let single = f32::from_bits(narrow(a));
            assert!(
                single.to_bits() == (x as f32).to_bits() || (single.is_nan() && x.is_nan()),
                "{x:e} as f32"
            );
            let whole = bits.next() >> (bits.next() & 63);
            assert_eq!(from_u64(whole), (whole as f64).to_bits(), "{whole}");
            assert_eq!(from_i64(whole.cast_signed()), (whole.cast_signed() as f64).to_bits(), "{whole}");
            assert_eq!(single_from_u64(whole), (whole as f32).to_bits(), "{whole}");
            if x.abs() < 9.2e18 {
                assert_eq!(to_i64(a), x as i64, "{x:e}");
            } else if (9.2e18..1.8e19).contains(&x) {
                assert_eq!(to_i64(a).cast_unsigned(), x as u64, "{x:e}");
            }
            let small = a as u32;
            same(widen(small), f64::from(f32::from_bits(small)), "wide", small.into(), 0);
            // Half way between two of 24 bits.
            let between = narrow(x.to_bits() & !0x1FFF_FFFF | 1 << 28);
            let x = f64::from_bits(x.to_bits() & !0x1FFF_FFFF | 1 << 28);
            assert!(f32::from_bits(between).to_bits() == (x as f32).to_bits() || x.is_nan(), "{x:e}");
        }
        let edges: Vec<f32> =
            std::vec![0.0, -0.0, f32::MAX, f32::MIN_POSITIVE, 1e-45, f32::INFINITY, f32::NEG_INFINITY];
        for edge in edges {
            assert_eq!(widen(edge.to_bits()), f64::from(edge).to_bits(), "{edge:e}");
            assert_eq!(narrow(f64::from(edge).to_bits()), edge.to_bits(), "{edge:e}");
        }
    }
}
