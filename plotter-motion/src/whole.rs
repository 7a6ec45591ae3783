//! Floats as whole numbers, in one place: on a small processor, which has no `f64`, each cast with its ends is 80 bytes.

/// Towards zero; what does not fit becomes the nearest end, a NaN 0.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn whole(value: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "a cast saturates")]
    let whole = value as i64;
    whole
}

/// To nearest, halves away from zero; else as [`whole`].
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn nearest(value: f64) -> i64 {
    let whole = whole(value);
    let rest = value - float(whole);
    if rest >= 0.5 {
        whole.saturating_add(1)
    } else if rest <= -0.5 {
        whole.saturating_sub(1)
    } else {
        whole
    }
}

/// To nearest, halves to the even one; else as [`whole`].
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn nearest_even(value: f64) -> i64 {
    let nearest = nearest(value);
    // Away from zero was the odd one.
    if nearest & 1 == 1 && libm::fabs(value - float(nearest)) == 0.5 {
        nearest - nearest.signum()
    } else {
        nearest
    }
}

/// Whether nothing stands behind the point, of numbers below 2^63.
pub(crate) fn is_whole(value: f64) -> bool {
    float(whole(value)) == value
}

/// The nearest float.
pub(crate) fn float(value: i64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "numbers beyond 53 bits are rounded")]
    let float = value as f64;
    float
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn same(value: f64) {
        assert_eq!(nearest(value), whole(libm::round(value)), "{value}");
        assert_eq!(nearest_even(value), whole(libm::rint(value)), "{value}");
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
            assert_eq!([whole(value), nearest(value), nearest_even(value)], [end; 3], "{value}");
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
