//! Floats as whole numbers, in one place: a small processor has no `f64`, and reckons with its bits.

/// The magnitude: the whole number, and the 2^64ths that are left, never none of them where something is
/// left. What does not fit becomes the greatest; a NaN 0.
#[cfg_attr(target_os = "none", inline(never))]
fn parts(value: f64) -> (u64, u64) {
    const MANTISSA_BITS: u64 = 52;
    /// The exponent of a whole mantissa, with its offset.
    const WHOLE: u64 = 1075;
    let bits = value.abs().to_bits();
    let (exponent, mantissa) = (bits >> MANTISSA_BITS, bits & ((1 << MANTISSA_BITS) - 1));
    let (exponent, mantissa) =
        if exponent == 0 { (1, mantissa) } else { (exponent, mantissa | 1 << MANTISSA_BITS) };
    if value.is_nan() {
        (0, 0)
    } else if exponent >= WHOLE {
        let up = exponent - WHOLE;
        (if up > 10 { u64::MAX } else { mantissa << up }, 0)
    } else {
        match WHOLE - exponent {
            down @ 0..64 => (mantissa >> down, mantissa << (64 - down)),
            // Less than a thousandth.
            _ => (0, u64::from(mantissa > 0)),
        }
    }
}

/// With the sign of `value`.
fn signed(magnitude: u64, value: f64) -> i64 {
    let magnitude = i64::try_from(magnitude).unwrap_or(i64::MAX);
    match (value.is_sign_negative(), magnitude) {
        (false, _) => magnitude,
        (true, i64::MAX) => i64::MIN,
        (true, _) => -magnitude,
    }
}

/// Towards zero; what does not fit becomes the nearest end, a NaN 0.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn whole(value: f64) -> i64 {
    signed(parts(value).0, value)
}

/// To nearest, halves away from zero; else as [`whole`].
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn nearest(value: f64) -> i64 {
    let (whole, rest) = parts(value);
    signed(whole.saturating_add(rest >> 63), value)
}

/// Whether nothing stands behind the point, of numbers below 2^63.
pub(crate) fn is_whole(value: f64) -> bool {
    parts(value).1 == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn same(value: f64) {
        assert_eq!(nearest(value), whole(libm::round(value)), "{value}");
        assert_eq!(is_whole(value), libm::floor(value) == value, "{value}");
    }

    #[test]
    fn halves_and_their_neighbours_go_where_they_should() {
        for half in [0.5_f64, 1.5, 2.5, 4_503_599_627_370_495.5, 2_251_799_813_685_248.5, 1e15 + 0.5] {
            for value in [half, half.next_up(), half.next_down()] {
                same(value);
                same(-value);
            }
        }
        for value in [0.0, -0.0, 4e18, -4e18] {
            same(value);
        }
        for (value, end) in [(1e300, i64::MAX), (-1e300, i64::MIN), (f64::NAN, 0), (f64::INFINITY, i64::MAX)]
        {
            assert_eq!([whole(value), nearest(value)], [end; 2], "{value}");
        }
    }

    proptest! {
        #[test]
        fn they_are_the_usual_ones(value in -9e15_f64..9e15, small in -100.0_f64..100.0, halves in -1000_i32..1000) {
            same(value);
            same(small);
            same(f64::from(halves) / 2.0);
        }
    }
}
