//! [`Command`]: a line of Marlin's, taken apart.

/// Letter and number of a command, and its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Command {
    /// Letter and number, as `G1`.
    pub(super) code: (u8, u32),
    /// The text from the letter on, without checksum.
    pub(super) text: String,
    parameters: Vec<(u8, Option<f64>)>,
}

/// The number that a line begins with; `None` where it begins with something else.
pub(super) fn line_number(line: &[u8]) -> Option<i64> {
    line.trim_ascii_start().strip_prefix(b"N").map(whole)
}

/// The whole number at the beginning of a text, as C's `strtol` reads it: 0 where there is none.
pub(super) fn whole(text: &[u8]) -> i64 {
    let text = text.trim_ascii_start();
    let (sign, digits) = match text {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        rest => (1, rest),
    };
    let digits = digits.iter().take_while(|byte| byte.is_ascii_digit());
    let magnitude =
        digits.fold(0_i64, |sum, &digit| sum.saturating_mul(10).saturating_add(i64::from(digit & 0x0f)));
    magnitude.saturating_mul(sign).clamp(i64::from(i32::MIN), i64::from(i32::MAX))
}

/// The checksum of a line: its bytes before the `*`, each exclusive-or the others.
pub(super) fn checksum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

impl Command {
    /// Takes a line apart; a line without a command has the code (0, 0).
    pub(super) fn parse(line: &[u8]) -> Self {
        let line = line.trim_ascii_start();
        let text = match line {
            [b'N', rest @ ..] => {
                let digits = rest.iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'-').count();
                rest.get(digits..).unwrap_or_default().trim_ascii_start()
            }
            _ => line,
        };
        let end = text.iter().position(|&byte| byte == b'*').unwrap_or(text.len());
        let text = text.get(..end).unwrap_or_default().trim_ascii_end();
        let (code, rest) = match text {
            [letter @ (b'G' | b'M' | b'T'), b'0'..=b'9', ..] => {
                let digits = text.iter().skip(1).take_while(|byte| byte.is_ascii_digit()).count();
                let number = u32::try_from(whole(text.get(1..).unwrap_or_default())).unwrap_or(u32::MAX);
                ((*letter, number), text.get(1 + digits..).unwrap_or_default())
            }
            _ => ((0, 0), &[][..]),
        };
        Self { code, text: String::from_utf8_lossy(text).into_owned(), parameters: parameters(rest) }
    }

    /// The number after a letter.
    pub(super) fn number(&self, letter: u8) -> Option<f64> {
        self.parameters.iter().find(|(name, _)| *name == letter).and_then(|(_, number)| *number)
    }

    /// Whether a letter is there, with a number or without.
    pub(super) fn has(&self, letter: u8) -> bool {
        self.parameters.iter().any(|(name, _)| *name == letter)
    }
}

fn parameters(text: &[u8]) -> Vec<(u8, Option<f64>)> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some((&letter, after)) = rest.split_first() {
        rest = after;
        if !letter.is_ascii_uppercase() {
            continue;
        }
        let blanks = rest.iter().take_while(|byte| **byte == b' ').count();
        let digits = rest.get(blanks..).unwrap_or_default();
        let length = digits.iter().take_while(|byte| byte.is_ascii_digit() || b"+-.".contains(byte)).count();
        let number = digits.get(..length).and_then(|digits| core::str::from_utf8(digits).ok());
        found.push((letter, number.and_then(|number| number.parse().ok())));
        rest = digits.get(length..).unwrap_or_default();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_taken_apart_with_and_without_blanks() {
        for line in ["N7 G1 X10 Y-2.5 F600*33", "N7G1X10Y-2.5F600", "  G1 X 10 Y-2.5 F600 "] {
            let command = Command::parse(line.as_bytes());
            assert_eq!(command.code, (b'G', 1), "{line}");
            let numbers = [b'X', b'Y', b'F', b'Z'].map(|letter| command.number(letter));
            assert_eq!(numbers, [Some(10.0), Some(-2.5), Some(600.0), None], "{line}");
        }
        assert_eq!(line_number(b" N-12 M110"), Some(-12));
        assert_eq!(Command::parse(b"N7 hello*1").text, "hello");
        assert_eq!(Command::parse(b"N7 hello*1").code, (0, 0));
        assert!(Command::parse(b"M114 D").has(b'D'));
        // "N1 G28" by hand: 4e ^ 31 ^ 20 ^ 47 ^ 32 ^ 38 = 12, in decimal 18
        assert_eq!(checksum(b"N1 G28"), 18);
    }
}
