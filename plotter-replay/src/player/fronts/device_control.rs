//! [`DeviceControl`]: what a host says to a plotter's interface, between the bytes of its drawing.

const ESC: u8 = 0x1B;
/// Most numbers of an instruction: `ESC .N` with its delay and ten characters.
const MOST_NUMBERS: usize = 11;
/// Greatest number that is told apart.
const MOST_NUMBER: u32 = 99_999;

/// What the interface is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Said {
    /// A byte of the drawing; of an escape that is none of the interface's, two.
    Data(u8, Option<u8>),
    /// An instruction with its numbers; one that was left out between semicolons is none.
    Instruction(u8, Vec<Option<u32>>),
    /// It is none: the number of the error (`ESC .E`).
    Wrong(u8),
}

/// Error of `ESC .E`: after `ESC .` came no letter of an instruction.
const NO_INSTRUCTION: u8 = 11;
/// Among the numbers of an instruction came something else.
const NO_NUMBER: u8 = 12;
/// A number is out of its range.
pub(super) const OUT_OF_RANGE: u8 = 13;
/// There are too many numbers.
const TOO_MANY: u8 = 14;

/// Takes device control out of the bytes of a host.
///
/// Source: *HP 7475A Interfacing and Programming Manual*, chapter on RS-232-C interfacing, device control
/// instructions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) enum DeviceControl {
    /// In the drawing.
    #[default]
    Outside,
    /// After the escape.
    Escape,
    /// After the point.
    Point,
    /// Among the numbers.
    Numbers(u8, Vec<Option<u32>>),
}

impl DeviceControl {
    /// Takes a byte; what it completes.
    pub(super) fn push(&mut self, byte: u8) -> Option<Said> {
        match core::mem::take(self) {
            Self::Outside if byte == ESC => *self = Self::Escape,
            Self::Outside => return Some(Said::Data(byte, None)),
            Self::Escape if byte == b'.' => *self = Self::Point,
            Self::Escape => return Some(Said::Data(ESC, Some(byte))),
            Self::Point => match byte {
                b'B' | b'E' | b'J' | b'K' | b'L' | b'O' | b'R' | b'(' | b')' | b'Y' | b'Z' => {
                    return Some(Said::Instruction(byte, Vec::new()));
                }
                b'@' | b'H' | b'I' | b'M' | b'N' => *self = Self::Numbers(byte, vec![None]),
                _ => return Some(Said::Wrong(NO_INSTRUCTION)),
            },
            Self::Numbers(letter, mut numbers) => {
                match byte {
                    b':' => return Some(Said::Instruction(letter, numbers)),
                    b';' if numbers.len() >= MOST_NUMBERS => return Some(Said::Wrong(TOO_MANY)),
                    b';' => numbers.push(None),
                    b'0'..=b'9' => {
                        if let Some(last) = numbers.last_mut() {
                            let digit = u32::from(byte & 0x0f);
                            *last = Some((last.unwrap_or(0) * 10 + digit).min(MOST_NUMBER));
                        }
                    }
                    _ => return Some(Said::Wrong(NO_NUMBER)),
                }
                *self = Self::Numbers(letter, numbers);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(bytes: &[u8]) -> Vec<Said> {
        let mut control = DeviceControl::default();
        bytes.iter().filter_map(|&byte| control.push(byte)).collect()
    }

    #[test]
    fn instructions_stand_between_the_bytes_of_a_drawing() {
        let numbers = vec![Some(81), None, Some(17)];
        assert_eq!(
            said(b"P\x1b.BU\x1b.I81;;17:;"),
            [
                Said::Data(b'P', None),
                Said::Instruction(b'B', vec![]),
                Said::Data(b'U', None),
                Said::Instruction(b'I', numbers),
                Said::Data(b';', None),
            ]
        );
        assert_eq!(said(b"\x1bE"), [Said::Data(ESC, Some(b'E'))]);
        assert_eq!(said(b"\x1b.?"), [Said::Wrong(NO_INSTRUCTION)]);
        assert_eq!(said(b"\x1b.I8x"), [Said::Wrong(NO_NUMBER)]);
        assert_eq!(said(b"\x1b.N1;2;3;4;5;6;7;8;9;10;11;"), [Said::Wrong(TOO_MANY)]);
        assert_eq!(said(b"\x1b.@99999999;:"), [Said::Instruction(b'@', vec![Some(MOST_NUMBER), None])]);
    }
}
