//! Numbers as text. The standard library's way for all of them, in any width, takes 14 KB of a
//! microcontroller's flash.

use crate::whole::nearest;
use core::fmt::{self, Write as _};

/// Digits of a `u64`.
const MOST_DIGITS: usize = 20;

/// A number rounded to thousandths, halves away from zero; beyond ±9·10¹⁵ it is cut off. `-0.000` is told as
/// `0.000`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Thousandths(i64);

impl Thousandths {
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn of(value: f64) -> Self {
        Self(nearest(value * 1e3))
    }

    /// With no more decimals than it needs.
    pub(crate) fn trimmed(self) -> Trimmed {
        Trimmed(self)
    }
}

/// A number of at most three decimals with no more of them than it needs, as `{}` writes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trimmed(Thousandths);

/// A whole number, as `{}` writes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole(pub(crate) u64);

/// A text, as `{}` writes it: without the parts of the formatter that make it longer or shorter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain<'t>(pub(crate) &'t str);

/// Decimals of thousandths.
const PLACES: usize = 3;

fn write(f: &mut fmt::Formatter<'_>, Thousandths(thousandths): Thousandths, trims: bool) -> fmt::Result {
    let (mut rest, mut places) = (thousandths.unsigned_abs(), PLACES);
    while trims && places > 0 && rest.is_multiple_of(10) {
        (rest, places) = (rest / 10, places - 1);
    }
    if thousandths < 0 {
        f.write_char('-')?;
    }
    digits(f, rest, places)
}

/// A whole number, with a point before its last `places` digits.
fn digits(f: &mut fmt::Formatter<'_>, number: u64, places: usize) -> fmt::Result {
    let mut text = [b'0'; MOST_DIGITS];
    let (mut rest, mut count) = (number, 0);
    for slot in &mut text {
        if rest == 0 && count > places {
            break;
        }
        let digit = (rest % 10) as u8;
        (*slot, rest, count) = (b'0' + digit, rest / 10, count + 1);
    }
    for (place, digit) in text.iter().enumerate().take(count).rev() {
        f.write_char(char::from(*digit))?;
        if place == places && places > 0 {
            f.write_char('.')?;
        }
    }
    Ok(())
}

impl fmt::Display for Thousandths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(f, *self, false)
    }
}

impl fmt::Display for Trimmed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(f, self.0, true)
    }
}

impl fmt::Display for Whole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        digits(f, self.0, 0)
    }
}

impl fmt::Display for Plain<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::format;

    #[test]
    fn halves_go_away_from_zero_which_has_no_sign() {
        for (value, text) in [
            (0.0, "0.000"),
            (-0.0, "0.000"),
            (-0.0004, "0.000"),
            (0.0625, "0.063"),
            (-0.0625, "-0.063"),
            (0.9995, "1.000"),
            (12.0, "12.000"),
            (87.58, "87.580"),
            (5e-324, "0.000"),
            (1e300, "9223372036854775.807"),
        ] {
            assert_eq!(format!("{}", Thousandths::of(value)), text);
        }
        for whole in [0, 9, 10, 4_294_967_295, u64::MAX] {
            assert_eq!(format!("{}", Whole(whole)), format!("{whole}"));
        }
    }

    proptest! {
        #[test]
        fn every_number_is_written_to_the_nearest_thousandth(
            value in -4e12_f64..4e12, small in -100.0_f64..100.0, thousandths in -1_000_000_000_i64..1_000_000_000,
        ) {
            for value in [value, small] {
                let text = format!("{}", Thousandths::of(value));
                let (_, decimals) = text.split_once('.').unwrap();
                prop_assert_eq!(decimals.len(), 3);
                let off = text.parse::<f64>().unwrap() - value;
                prop_assert!(off.abs() <= 5e-4 + value.abs() * f64::EPSILON, "{} for {}", text, value);
            }
            let value = thousandths as f64 / 1e3;
            if thousandths != 0 {
                prop_assert_eq!(format!("{}", Thousandths::of(value)), format!("{value:.3}"));
            }
            prop_assert_eq!(format!("{}", Thousandths::of(value).trimmed()), format!("{value}"));
        }
    }
}
