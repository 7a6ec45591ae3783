//! Square roots, to the last bit. `libm`'s and their table take 1 KB of a microcontroller's flash, these less than half, and are as quick.

/// The square root, rounded to nearest; NaN below 0. Numbers below 2·10⁻³⁰⁸ are taken for 0.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn root(square: f64) -> f64 {
    const MANTISSA_BITS: u32 = 52;
    /// Digits that are missing after the first 32.
    const MORE_BITS: u32 = 22;
    let bits = square.to_bits();
    let exponent = (bits >> MANTISSA_BITS) as u32;
    if exponent.wrapping_sub(1) >= 0x7fe {
        let is_infinite = bits == f64::INFINITY.to_bits();
        return if exponent & 0x7ff == 0 {
            0.0
        } else if is_infinite {
            square
        } else {
            f64::NAN
        };
    }
    let mantissa = bits & ((1 << MANTISSA_BITS) - 1) | 1 << MANTISSA_BITS;
    // An even power of two is taken out, and the mantissa has its first bit in one of the first two places.
    let number = mantissa << (11 - (exponent & 1));
    let (high, inverse) = whole_root(number);
    let high = u64::from(high);
    let rest = number - high * high;
    // The other digits are rest / 2·high, and what is left says whether they are a few too many or too few.
    #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "23 bits")]
    #[expect(clippy::cast_sign_loss, reason = "above 0")]
    let more = u64::from(((rest >> 10) as u32 as f32 * inverse * 32_768.0) as u32);
    let mut found = (high << MORE_BITS) + more;
    let mut left = (((rest << MORE_BITS).wrapping_sub((more * high) << 1)) << MORE_BITS)
        .wrapping_sub(more * more)
        .cast_signed();
    while left < 0 {
        found -= 1;
        left += (found << 1 | 1).cast_signed();
    }
    while left > (found << 1).cast_signed() {
        left -= (found << 1 | 1).cast_signed();
        found += 1;
    }
    // One bit more than there is room for: no root lies just between two numbers.
    f64::from_bits((u64::from(exponent.div_ceil(2) + 510) << MANTISSA_BITS) + ((found + 1) >> 1))
}

/// As [`root`], of single precision; numbers below 10⁻³⁸ are taken for 0.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn root_single(square: f32) -> f32 {
    const MANTISSA_BITS: u32 = 23;
    let bits = square.to_bits();
    let exponent = bits >> MANTISSA_BITS;
    if exponent.wrapping_sub(1) >= 0xfe {
        let is_infinite = bits == f32::INFINITY.to_bits();
        return if exponent & 0xff == 0 {
            0.0
        } else if is_infinite {
            square
        } else {
            f32::NAN
        };
    }
    let mantissa = bits & ((1 << MANTISSA_BITS) - 1) | 1 << MANTISSA_BITS;
    let (found, _) = whole_root(u64::from(mantissa) << (40 - (exponent & 1)));
    f32::from_bits(((exponent.div_ceil(2) + 62) << MANTISSA_BITS) + (found >> 8) + (found >> 7 & 1))
}

/// The whole part of the root of a number from 2⁶² on, and about 2¹⁶ / root.
#[cfg_attr(target_os = "none", inline(never))]
fn whole_root(number: u64) -> (u32, f32) {
    #[expect(clippy::cast_precision_loss, reason = "a first guess")]
    let high = (number >> 32) as u32 as f32;
    // 1/√high: the bits of a float are nearly its logarithm, half of which is that of the root; then Newton's method.
    let mut inverse = f32::from_bits(0x5f37_59df - (high.to_bits() >> 1));
    for _ in 0..3 {
        inverse *= 1.5 - 0.5 * high * inverse * inverse;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
    let guess = (high * inverse * 65_536.0) as u32;
    let rest = |root: u32| number.wrapping_sub(u64::from(root) * u64::from(root)).cast_signed();
    // Once more, in whole numbers: the guess is off by some hundreds, and then by two at the most.
    #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "below 2^28")]
    let more = ((rest(guess) >> 16) as i32 as f32 * inverse * 0.5) as i32;
    let mut root = guess.saturating_add_signed(more);
    while rest(root) < 0 {
        root -= 1;
    }
    while rest(root) > i64::from(root) << 1 {
        root += 1;
    }
    (root, inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn odd_ones_are_as_usual() {
        for square in [0.0, 1.0, 4.0, f64::MAX, f64::MIN_POSITIVE, 1.0_f64.next_down(), 2.0, 3.0] {
            assert_eq!(root(square).to_bits(), libm::sqrt(square).to_bits(), "{square:e}");
        }
        for square in [0.0, 1.0, 4.0, f32::MAX, f32::MIN_POSITIVE, 1.0_f32.next_down(), 2.0, 3.0] {
            assert_eq!(root_single(square).to_bits(), libm::sqrtf(square).to_bits(), "{square:e}");
        }
        assert!(root(-1.0).is_nan() && root(f64::NAN).is_nan() && root_single(f32::NAN).is_nan());
        assert!(root_single(-1.0).is_nan() && root(f64::NEG_INFINITY).is_nan());
        assert_eq!((root(f64::INFINITY), root_single(f32::INFINITY)), (f64::INFINITY, f32::INFINITY));
        assert_eq!((root(-0.0), root(5e-324), root_single(1e-45)), (0.0, 0.0, 0.0));
    }

    #[test]
    fn squares_and_their_neighbours_have_the_right_root() {
        for number in (0..2_000_000_u32).map(|n| n * 67 + 1) {
            let exact = f64::from(number);
            let square = exact * exact;
            assert_eq!(root(square), exact);
            for near in [square.next_down(), square.next_up()] {
                assert_eq!(root(near).to_bits(), libm::sqrt(near).to_bits(), "{near:e}");
            }
            let single = f32::from_bits(0x0080_0000 + number * 8);
            assert_eq!(root_single(single).to_bits(), libm::sqrtf(single).to_bits(), "{single:e}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]
        #[test]
        fn it_is_the_nearest(bits in 0x0010_0000_0000_0000_u64..0x7ff0_0000_0000_0000, single in 0x0080_0000_u32..0x7f80_0000) {
            let (square, single) = (f64::from_bits(bits), f32::from_bits(single));
            prop_assert_eq!(root(square).to_bits(), libm::sqrt(square).to_bits());
            prop_assert_eq!(root_single(single).to_bits(), libm::sqrtf(single).to_bits());
        }

        #[test]
        fn whole_roots_are_right(number in 1_u64 << 62..u64::MAX) {
            let root = u64::from(whole_root(number).0);
            prop_assert!(root * root <= number && number - root * root <= 2 * root);
        }
    }
}
