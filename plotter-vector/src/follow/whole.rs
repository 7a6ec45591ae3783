//! From places to whole pixels: saturating, so that no number is out of range.

/// The whole number at or below, saturating; 0 for what is no number.
#[expect(clippy::cast_possible_truncation, reason = "saturates by definition")]
#[inline]
pub(super) fn floor(value: f64) -> i32 {
    // (`libm::floor` goes through the number's bits.)
    let whole = value as i32;
    if f64::from(whole) > value { whole.saturating_sub(1) } else { whole }
}

/// The nearest whole number that is not negative, saturating.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "saturates by definition"
)]
#[inline]
pub(super) fn count(value: f64) -> usize {
    let whole = value as usize;
    if value - whole as f64 >= 0.5 { whole.saturating_add(1) } else { whole }
}

/// The nearest level, 0 to 255.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates by definition")]
#[inline]
pub(super) fn level(value: f32) -> u8 {
    (value + 0.5) as u8
}

/// A place as an index of a row of `side`, if it is inside.
#[inline]
pub(super) fn inside(at: i32, side: usize) -> Option<usize> {
    usize::try_from(at).ok().filter(|at| *at < side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_as_libm_does() {
        let half_less = 0.5_f64.next_down();
        for value in [
            0.0,
            -0.0,
            0.4,
            half_less,
            0.5,
            1.5,
            2.0,
            -0.5,
            -1.0,
            -1.1,
            7.9,
            1e9,
            -1e9,
            3e9,
            -3e9,
            1e300,
            f64::NAN,
        ] {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates by definition"
            )]
            let by_libm = (libm::floor(value) as i32, libm::round(value) as usize);
            assert_eq!((floor(value), count(value)), by_libm, "{value}");
        }
    }
}
