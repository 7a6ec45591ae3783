//! [`Decoder`]: the numbers of `PE`, a polyline in a few bytes a point; and how they are written.

use crate::Vec2;
use core::fmt;

/// Digits of one number: ten of six bits are the range of any plotter and its fractions.
const MOST_DIGITS: u32 = 10;
/// Greatest count of binary places, with either sign.
const MOST_PLACES: f64 = 30.0;

/// What a few bytes of `PE` say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Go there; from where the pen is unless `absolute`.
    Go { to: Vec2, up: bool, absolute: bool },
    /// Take this pen.
    Pen(f64),
}

/// How a byte stands to what has been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Misplaced;

/// What the number that is being read means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meaning {
    Coordinate,
    Pen,
    Places,
}

/// Whether bytes above 127 are what the plotter was sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Bytes {
    /// Nothing has been seen that would tell.
    #[default]
    Unknown,
    /// They are.
    Whole,
    /// They were taken for Latin-1 letters and written as UTF-8, each as two.
    Damaged,
}

/// Reads the data of one `PE`.
///
/// A number is written in digits of six bits (five with the flag `7`), the lowest first. A digit d is the
/// byte 63 + d, the last one 191 + d (95 + d). An even number n means n/2, an odd one −(n − 1)/2; after a
/// fraction flag `>` all of them are divided by a power of two. The flags `<` (pen up), `=` (absolute) hold
/// for the next point, `:` is followed by a pen.
///
/// ```text
/// 1     →  2·1 = 2            →  191 + 2 = 193
/// −50   →  2·50 + 1 = 101     =  37 + 1·64  →  63 + 37, 191 + 1
/// ```
///
/// Source: *The HP-GL/2 and HP RTL Reference Guide*, on `PE`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decoder {
    seven_bits: bool,
    /// What each coordinate is multiplied by.
    unit: f64,
    meaning: Meaning,
    value: u64,
    digits: u32,
    x: Option<f64>,
    up: bool,
    absolute: bool,
    bytes: Bytes,
    /// The first byte of what may be a pair.
    lead: Option<u8>,
}

impl Decoder {
    /// A decoder at the start of the data; what is known of the text's bytes is kept from one `PE` to the
    /// next.
    pub(super) fn new(bytes: Bytes) -> Self {
        Self {
            seven_bits: false,
            unit: 1.0,
            meaning: Meaning::Coordinate,
            value: 0,
            digits: 0,
            x: None,
            up: false,
            absolute: false,
            bytes,
            lead: None,
        }
    }

    /// What is now known of the text's bytes.
    pub(super) fn bytes(&self) -> Bytes {
        self.bytes
    }

    /// Whether the data may end here: not within a number or a point.
    pub(super) fn is_complete(&self) -> bool {
        self.digits == 0 && self.x.is_none() && self.lead.is_none()
    }

    /// The x that waits for its y.
    pub(super) fn lonely(&self) -> Option<f64> {
        self.x
    }

    /// Forgets the number in progress: its digits were something else.
    pub(super) fn forget_number(&mut self) {
        (self.value, self.digits) = (0, 0);
    }

    /// Takes the next byte. One byte can complete two numbers: where a pair turns out not to be one, its
    /// first byte counts before it.
    pub(super) fn push(&mut self, byte: u8) -> Result<[Option<Step>; 2], Misplaced> {
        if self.seven_bits || self.bytes == Bytes::Whole {
            return Ok([self.digit(byte)?, None]);
        }
        // Damaged, a byte from 0xC0 is 0xC3 and one from 0x80 to 0xBF; only 0xBF is 0xC2 and itself. As
        // digits, bytes from 0x80 to 0xBE do not exist, so that a pair with one of them gives the damage
        // away.
        match self.lead.take() {
            Some(lead) if matches!(byte, 0x80..=0xBE) || (self.bytes == Bytes::Damaged && byte == 0xBF) => {
                self.bytes = Bytes::Damaged;
                Ok([self.digit(((lead & 0x03) << 6) | (byte & 0x3F))?, None])
            }
            Some(lead) => {
                if byte != 0xBF {
                    self.bytes = Bytes::Whole;
                }
                Ok([self.digit(lead)?, self.digit(byte)?])
            }
            None if matches!(byte, 0xC2 | 0xC3) => {
                self.lead = Some(byte);
                Ok([None, None])
            }
            None => {
                if byte > 0xBF {
                    self.bytes = Bytes::Whole;
                }
                Ok([self.digit(byte)?, None])
            }
        }
    }

    /// Ends the data: a byte that waited for a second one was whole.
    pub(super) fn finish(&mut self) -> Result<Option<Step>, Misplaced> {
        self.lead.take().map_or(Ok(None), |lead| self.digit(lead))
    }

    fn digit(&mut self, byte: u8) -> Result<Option<Step>, Misplaced> {
        let byte = if self.seven_bits { byte & 0x7F } else { byte };
        let (base, bits, last_from) = if self.seven_bits { (32, 5, 95) } else { (64, 6, 191) };
        let (digit, last) = if (last_from..=last_from + (base - 1)).contains(&byte) {
            (byte - last_from, true)
        } else if (63..63 + base).contains(&byte) {
            (byte - 63, false)
        } else if byte <= b' ' || (127..=160).contains(&byte) || byte == 255 {
            return Ok(None);
        } else {
            return self.flag(byte);
        };
        if self.digits >= MOST_DIGITS {
            return Err(Misplaced);
        }
        self.value |= u64::from(digit) << (bits * self.digits);
        self.digits += 1;
        Ok(if last { self.number()? } else { None })
    }

    fn flag(&mut self, byte: u8) -> Result<Option<Step>, Misplaced> {
        if self.digits > 0 {
            return Err(Misplaced);
        }
        match byte {
            b'7' => self.seven_bits = true,
            b'<' => self.up = true,
            b'=' => self.absolute = true,
            b':' => self.meaning = Meaning::Pen,
            b'>' => self.meaning = Meaning::Places,
            _ => return Err(Misplaced),
        }
        Ok(None)
    }

    fn number(&mut self) -> Result<Option<Step>, Misplaced> {
        #[expect(clippy::cast_precision_loss, reason = "digits beyond the 53rd bit are rounded")]
        let magnitude = (self.value >> 1) as f64;
        let number = if self.value & 1 == 1 { -magnitude } else { magnitude };
        (self.value, self.digits) = (0, 0);
        match core::mem::replace(&mut self.meaning, Meaning::Coordinate) {
            Meaning::Pen => Ok(Some(Step::Pen(number))),
            Meaning::Places if libm::fabs(number) > MOST_PLACES => Err(Misplaced),
            Meaning::Places => {
                self.unit = libm::exp2(-number);
                Ok(None)
            }
            Meaning::Coordinate => {
                let number = number * self.unit;
                let Some(x) = self.x.take() else {
                    self.x = Some(number);
                    return Ok(None);
                };
                let (up, absolute) = (core::mem::take(&mut self.up), core::mem::take(&mut self.absolute));
                Ok(Some(Step::Go { to: Vec2::new(x, number), up, absolute }))
            }
        }
    }
}

/// Writes a number in the base 32, as the flag `7` announces: all of its bytes are printable.
pub(super) fn write_number(out: &mut impl fmt::Write, number: i64) -> fmt::Result {
    let mut left = 2 * number.unsigned_abs() + u64::from(number < 0);
    loop {
        let digit = u8::try_from(left % 32).unwrap_or(0);
        left /= 32;
        let last = left == 0;
        out.write_char(char::from(digit + if last { 95 } else { 63 }))?;
        if last {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn read(data: &[u8]) -> Vec<Step> {
        let mut decoder = Decoder::new(Bytes::Unknown);
        let mut steps: Vec<Step> =
            data.iter().flat_map(|byte| decoder.push(*byte).unwrap()).flatten().collect();
        steps.extend(decoder.finish().unwrap());
        assert!(decoder.is_complete());
        steps
    }

    fn go(x: f64, y: f64, up: bool, absolute: bool) -> Step {
        Step::Go { to: Vec2::new(x, y), up, absolute }
    }

    #[test]
    fn numbers_are_read_in_either_base() {
        // 728 = 1456 / 2 = 48 + 22 * 64: bytes 111, 213; 338 likewise 99, 201.
        assert_eq!(read(b"<=o\xD5c\xC9"), [go(728.0, 338.0, true, true)]);
        // -50: 101 = 37 + 1 * 64 = 5 + 3 * 32
        assert_eq!(read(b"d\xC0\xC1"), [go(-50.0, 1.0, false, false)]);
        assert_eq!(read(b"7Dba"), [go(-50.0, 1.0, false, false)]);
        // Three binary places, and control characters: 8 / 8 and 12 / 8.
        assert_eq!(read(b">\xC5O\r\n\xBFW\xBF"), [go(1.0, 1.5, false, false)]);
        assert_eq!(read(b":\xC3\xBF\xBF"), [Step::Pen(2.0), go(0.0, 0.0, false, false)]);
    }

    #[test]
    fn data_taken_for_letters_are_told_from_whole_ones() {
        let whole = b"<=o\xD5c\xC9S\xC2\xBF<yR\xC3\xBFT\xC2\xBF";
        let as_letters: Vec<char> = whole.iter().map(|byte| char::from(*byte)).collect();
        let damaged: std::string::String = as_letters.into_iter().collect();
        assert_ne!(damaged.as_bytes(), whole);
        let expected = read(whole);
        assert_eq!(expected[1], go(106.0, 0.0, false, false));
        assert_eq!(read(damaged.as_bytes()), expected);
    }

    #[test]
    fn a_flag_within_a_number_is_misplaced() {
        for data in [&b"A<"[..], b"!", b"AAAAAAAAAAAA", b"7>^^^^_"] {
            let mut decoder = Decoder::new(Bytes::Unknown);
            assert!(data.iter().any(|byte| decoder.push(*byte).is_err()), "{data:?}");
        }
    }
}
