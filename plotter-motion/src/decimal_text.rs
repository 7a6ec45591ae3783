//! Numbers as text. The standard library's way for all of them, in any width, takes 14 KB of a microcontroller's flash.

use core::fmt::{self, Write as _};

/// Digits of a `u64`.
const MOST_DIGITS: usize = 20;

/// A number with so many decimals, 0 to 3, as `{:.3}` writes it, to the last byte: its exact value rounded to nearest, halves to even.
/// Beyond 9·10¹⁵ it is cut off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decimals<const PLACES: usize>(pub(crate) f64);

/// A number of at most three decimals with no more of them than it needs, as `{}` writes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trimmed(pub(crate) f64);

/// A whole number, as `{}` writes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole(pub(crate) u64);

/// A text, as `{}` writes it: without the parts of the formatter that make it longer or shorter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain<'t>(pub(crate) &'t str);

/// Bits of an `f64` after its sign: an exponent, and a mantissa without its first 1.
const MANTISSA_BITS: u32 = 52;

/// The magnitude in units of the last decimal.
fn units(value: f64, units_per_one: u64) -> u64 {
    let bits = value.abs().to_bits();
    let exponent = bits >> MANTISSA_BITS;
    let mantissa = bits & ((1 << MANTISSA_BITS) - 1);
    // The value is mantissa / 2^shift.
    let (mantissa, exponent) =
        if exponent == 0 { (mantissa, 1) } else { (mantissa | 1 << MANTISSA_BITS, exponent) };
    let Some(shift) = 1075_u64.checked_sub(exponent) else { return u64::MAX };
    if shift >= u64::from(u64::BITS) {
        return 0; // less than half of a thousandth
    }
    let (whole, rest) = (mantissa >> shift, mantissa & ((1 << shift) - 1));
    // 53 bits and the ten of a thousand.
    let scaled = rest * units_per_one;
    let (low, lost) = (scaled >> shift, scaled & ((1 << shift) - 1));
    let below = whole.saturating_mul(units_per_one).saturating_add(low);
    let twice = lost << 1;
    let up = match twice.cmp(&(1 << shift)) {
        core::cmp::Ordering::Less => 0,
        core::cmp::Ordering::Equal => below & 1,
        core::cmp::Ordering::Greater => 1,
    };
    below.saturating_add(up)
}

fn write(f: &mut fmt::Formatter<'_>, value: f64, places: usize, trims: bool) -> fmt::Result {
    let units_per_one = [1, 10, 100, 1000].get(places).copied().unwrap_or(1);
    let mut rest = units(value, units_per_one);
    let mut places = places;
    while trims && places > 0 && rest.is_multiple_of(10) {
        (rest, places) = (rest / 10, places - 1);
    }
    if value.is_sign_negative() {
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

impl<const PLACES: usize> fmt::Display for Decimals<PLACES> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(f, self.0, PLACES, false)
    }
}

impl fmt::Display for Trimmed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(f, self.0, 3, true)
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

    fn same(value: f64) {
        assert_eq!(format!("{}", Decimals::<0>(value)), format!("{value:.0}"));
        assert_eq!(format!("{}", Decimals::<1>(value)), format!("{value:.1}"));
        assert_eq!(format!("{}", Decimals::<3>(value)), format!("{value:.3}"));
    }

    #[test]
    fn halves_go_to_even_and_zeros_keep_their_sign() {
        for value in [
            0.0,
            -0.0,
            0.5,
            1.5,
            2.5,
            -2.5,
            0.0625,
            0.1875,
            0.0005,
            0.0015,
            -0.0004,
            0.9995,
            0.9996,
            999.9995,
            12.0,
            87.58,
            1e-300,
            5e-324,
            4e15,
            9_007_199_254_740_991.0,
            8_388_608.062_5,
        ] {
            same(value);
        }
        for whole in [0, 9, 10, 4_294_967_295, u64::MAX] {
            assert_eq!(format!("{}", Whole(whole)), format!("{whole}"));
        }
        assert_eq!(format!("{}", Decimals::<3>(1e300)), "18446744073709551.615");
    }

    proptest! {
        #[test]
        fn every_number_is_written_as_the_standard_library_does(
            value in -9e15_f64..9e15, small in -100.0_f64..100.0, sixteenths in -100_000_i32..100_000, thousandths in -1_000_000_000_i64..1_000_000_000,
        ) {
            same(value);
            same(small);
            same(f64::from(sixteenths) / 16.0);
            let thousandths = thousandths as f64 / 1e3;
            same(thousandths);
            prop_assert_eq!(format!("{}", Trimmed(thousandths)), format!("{thousandths}"));
        }
    }
}
