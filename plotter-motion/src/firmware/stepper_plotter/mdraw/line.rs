//! [`Request`]: what a line of mDraw's asks for.
//!
//! As C reads it: words are separated by spaces and nothing else, the command is a capital letter and the
//! whole number after it, a number ends where it ceases to be one. What is unknown asks for nothing.

use crate::decimal::Decimal;

/// What a line asks for. A number that lacks is `None` within.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Request {
    /// `G0`, `G1`: `Some(None)` is a letter without its number.
    Move { x: Option<Option<f32>>, y: Option<Option<f32>>, delay_us: Option<i32> },
    /// `G28`.
    Home,
    /// `G91`, and `G90`.
    Relative(bool),
    /// `M1`, degrees.
    Servo(Option<i32>),
    /// `M2`, degrees.
    PenAngles { up: Option<i32>, down: Option<i32> },
    /// `M3`, microseconds.
    Delay(Option<i32>),
    /// `M4`, 0 to 255.
    Laser(Option<i32>),
    /// `M5`.
    Setup { a: Option<i32>, b: Option<i32>, height: Option<i32>, width: Option<i32>, speed: Option<i32> },
    /// `M10`.
    Settings,
    /// `M11`.
    EndStops,
    /// `P`.
    Position,
    #[default]
    Nothing,
}

impl Request {
    /// Reads a line without its end.
    pub(super) fn read(line: &[u8]) -> Self {
        let Some((letter, rest)) = line.split_first() else { return Self::Nothing };
        let code = whole(rest).unwrap_or(0);
        let mut words = rest.split(|&byte| byte == b' ').filter(|word| !word.is_empty());
        // The first one is the command's number.
        words.next();
        match (letter, code) {
            (b'G', 0 | 1) => {
                let (mut x, mut y, mut delay_us) = (None, None, None);
                for word in words {
                    match word.split_first() {
                        Some((b'X', number)) => x = Some(decimal(number)),
                        Some((b'Y', number)) => y = Some(decimal(number)),
                        Some((b'A', number)) => delay_us = whole(number),
                        _ => {}
                    }
                }
                Self::Move { x, y, delay_us }
            }
            (b'G', 28) => Self::Home,
            (b'G', 90 | 91) => Self::Relative(code == 91),
            (b'M', 1) => Self::Servo(words.next().and_then(whole)),
            (b'M', 2) => Self::PenAngles { up: lettered(words.clone(), b'U'), down: lettered(words, b'D') },
            (b'M', 3) => Self::Delay(words.next().and_then(whole)),
            (b'M', 4) => Self::Laser(words.next().and_then(whole)),
            (b'M', 5) => Self::Setup {
                a: lettered(words.clone(), b'A'),
                b: lettered(words.clone(), b'B'),
                height: lettered(words.clone(), b'H'),
                width: lettered(words.clone(), b'W'),
                speed: lettered(words, b'S'),
            },
            (b'M', 10) => Self::Settings,
            (b'M', 11) => Self::EndStops,
            (b'P', _) => Self::Position,
            _ => Self::Nothing,
        }
    }
}

/// The number of the last word with this letter.
fn lettered<'a>(words: impl Iterator<Item = &'a [u8]>, letter: u8) -> Option<i32> {
    words.filter_map(|word| word.strip_prefix(&[letter])).filter_map(whole).last()
}

/// The whole number that a text begins with; one beyond every range counts as the greatest there is.
fn whole(text: &[u8]) -> Option<i32> {
    let text = text.trim_ascii_start();
    let end = text.iter().position(|byte| *byte == b'.').unwrap_or(text.len());
    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    let whole = text.get(..end).and_then(number).map(|value| value as i32);
    whole
}

/// The decimal number that a text begins with.
fn decimal(text: &[u8]) -> Option<f32> {
    #[expect(clippy::cast_possible_truncation, reason = "what the machine's own program reads, a C float")]
    let value = number(text.trim_ascii_start()).map(|value| value as f32);
    value
}

/// Sign, digits and point, as far as they go. (The standard library's reader takes 14 KB of a
/// microcontroller's flash.)
fn number(text: &[u8]) -> Option<f64> {
    let (first, rest) = text.split_first()?;
    let mut number = Decimal::begin(*first)?;
    let _ = rest.iter().take_while(|byte| number.push(**byte)).count();
    number.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_where_they_cease_to_be_one() {
        for (text, expected) in [
            ("10", Some(10.0)),
            (" -2.50mm", Some(-2.5)),
            ("+.5", Some(0.5)),
            ("7.", Some(7.0)),
            ("1e3", Some(1.0)),
            ("-", None),
            (".", None),
            ("nan", None),
        ] {
            assert_eq!(decimal(text.as_bytes()), expected, "{text}");
        }
        assert_eq!(whole(b"99999999999"), Some(i32::MAX));
    }

    #[test]
    fn words_are_split_by_spaces_only() {
        let moved = |x, y| Request::Move { x, y, delay_us: None };
        assert_eq!(Request::read(b"G1X10 Y5"), moved(None, Some(Some(5.0))));
        assert_eq!(Request::read(b"G1\tX10"), moved(None, None));
        assert_eq!(Request::read(b"G 1  X10"), moved(Some(Some(10.0)), None));
        assert_eq!(Request::read(b"Garbage"), moved(None, None)); // C reads no number as 0, and G0 moves
        assert_eq!(Request::read(b"g1 X10"), Request::Nothing);
        assert_eq!(Request::read(b"M10\r"), Request::Settings);
    }
}
