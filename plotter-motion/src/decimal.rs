//! [`Decimal`]: a number read digit by digit; [`WrittenNumber`]: what of it a message shows.

use core::fmt;

/// Digits kept. An `f64` holds 15 to 17, and 18 fit into a `u64`.
const MAX_DIGITS: u8 = 18;

/// Most places behind the point. 10 to this power is the greatest that is a float without rounding, as are
/// all before it.
const MOST_PLACES: u8 = 22;

/// A decimal number in progress: sign, digits, point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Decimal {
    negative: bool,
    any_digit: bool,
    point: bool,
    mantissa: u64,
    /// Digits of `mantissa` after its first that is not 0.
    digits: u8,
    places: u8,
    /// More digits before the point than `mantissa` holds: beyond every range anyway.
    huge: bool,
}

impl Decimal {
    /// A number whose first byte is `byte`; `None` if no number begins so.
    pub(crate) fn begin(byte: u8) -> Option<Self> {
        let mut number = Self { negative: byte == b'-', ..Self::default() };
        (matches!(byte, b'+' | b'-') || number.push(byte)).then_some(number)
    }

    /// Takes one more byte; `false` if it does not belong to the number.
    pub(crate) fn push(&mut self, byte: u8) -> bool {
        match byte {
            b'.' if !self.point => self.point = true,
            b'0'..=b'9' => self.digit(byte - b'0'),
            _ => return false,
        }
        true
    }

    fn digit(&mut self, digit: u8) {
        self.any_digit = true;
        if self.digits < MAX_DIGITS && self.places < MOST_PLACES {
            self.mantissa = self.mantissa * 10 + u64::from(digit);
            self.digits += u8::from(self.mantissa > 0);
            self.places += u8::from(self.point);
        } else if !self.point {
            self.huge = true;
        }
    }

    /// The value, to the nearest `f64` for up to 15 digits; `None` while there is no digit.
    pub(crate) fn value(self) -> Option<f64> {
        if !self.any_digit {
            return None;
        }
        // A table of them would be 184 bytes.
        let scale = (0..self.places).fold(1.0, |scale, _| scale * 10.0);
        #[expect(clippy::cast_precision_loss, reason = "digits beyond the 15th are rounded")]
        let magnitude = if self.huge { f64::INFINITY } else { self.mantissa as f64 / scale };
        Some(if self.negative { -magnitude } else { magnitude })
    }

    /// It as a message shows it.
    pub(crate) fn written(self) -> WrittenNumber {
        WrittenNumber { number: self }
    }
}

/// A number as it was written, for messages: its first 18 digits without leading zeros, and `…` where more
/// stand before the point.
///
/// ```
/// use plotter_motion::gcode::Reader;
/// let mut reader = Reader::new();
/// let error = b"G1 X-99999999999999999999999999\n".iter().find_map(|byte| reader.push(*byte)).unwrap().unwrap_err();
/// assert!(error.to_string().starts_with("line 1, column 4 (byte 3): X with -999999999999999999…: "));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenNumber {
    number: Decimal,
}

impl fmt::Display for WrittenNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Decimal { negative, mantissa, places, huge, .. } = self.number;
        f.write_str(if negative { "-" } else { "" })?;
        match 10_u64.checked_pow(places.into()) {
            Some(scale) if places > 0 => {
                write!(f, "{}.{:0width$}", mantissa / scale, mantissa % scale, width = places.into())
            }
            // So many places are of numbers that are near 0.
            None => write!(f, "{mantissa}e-{places}"),
            _ => write!(f, "{mantissa}{}", if huge { "…" } else { "" }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<f64> {
        let (first, rest) = text.as_bytes().split_first()?;
        let mut number = Decimal::begin(*first)?;
        rest.iter().all(|byte| number.push(*byte)).then(|| number.value()).flatten()
    }

    #[test]
    fn numbers_are_the_nearest_ones() {
        for text in ["0", "-1385.640646", "+.5", "7.", "0.1", "007", "-0.0000000003", "8388607.9999"] {
            assert_eq!(read(text), text.parse().ok(), "{text}");
        }
    }

    #[test]
    fn a_number_is_shown_as_it_was_written() {
        let shown = |text: &str| {
            let (first, rest) = text.as_bytes().split_first().unwrap();
            let mut number = Decimal::begin(*first).unwrap();
            assert!(rest.iter().all(|byte| number.push(*byte)));
            std::format!("{}", number.written())
        };
        for text in ["1000000001", "-12345678901.0625", "7.05"] {
            assert_eq!(shown(text), text);
        }
        assert_eq!(shown("+00012345678901234567890123.5"), "123456789012345678…");
        assert_eq!(shown("-0.00000000000000000000001"), "-0e-22");
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in ["", "-", "+", ".", "-.", "1.2.3", "1e5", "--1", "a"] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn very_long_numbers_stay_bounded() {
        let long = |digit: char, count| core::iter::repeat_n(digit, count).collect::<std::string::String>();
        assert_eq!(read(&long('9', 400)), Some(f64::INFINITY));
        assert_eq!(read(&std::format!("-{}", long('9', 400))), Some(f64::NEG_INFINITY));
        assert_eq!(read(&std::format!("{}12.5", long('0', 400))), Some(12.5));
        assert_eq!(read(&std::format!("0.{}", long('3', 400))), Some(0.333_333_333_333_333_3));
        assert_eq!(read(&std::format!("0.{}", long('0', 400))), Some(0.0));
    }
}
