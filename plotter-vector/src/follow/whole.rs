//! From places to whole pixels: saturating, so that no number is out of range.

/// The whole number at or below, saturating; 0 for what is no number.
#[expect(clippy::cast_possible_truncation, reason = "saturates by definition")]
pub(super) fn floor(value: f64) -> i32 {
    libm::floor(value) as i32
}

/// The nearest whole number that is not negative, saturating.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates by definition")]
pub(super) fn count(value: f64) -> usize {
    libm::round(value) as usize
}

/// The nearest level, 0 to 255.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates by definition")]
pub(super) fn level(value: f32) -> u8 {
    (value + 0.5) as u8
}

/// A place as an index of a row of `side`, if it is inside.
pub(super) fn inside(at: i32, side: usize) -> Option<usize> {
    usize::try_from(at).ok().filter(|at| *at < side)
}
