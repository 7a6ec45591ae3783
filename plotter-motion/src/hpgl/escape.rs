//! [`Escape`]: escape sequences, which lie over the text and may interrupt it anywhere.

const ESC: u8 = 0x1B;

/// How far into an escape sequence the text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Escape {
    /// Not in one.
    None,
    /// Right after the escape byte.
    Begun,
    /// After `ESC .`.
    Device,
    /// Within the numbers of a device control: `ESC .I81;;17:`.
    DeviceNumbers,
    /// Within a printer's sequence, `ESC %0B` or `ESC &l1X`, before its last byte.
    Printer { kind: u8 },
}

/// What a byte is to the escape sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// No part of one.
    NotMine,
    /// The escape byte.
    Begun,
    /// A part that says nothing by itself.
    Within,
    /// The byte that says which sequence it is.
    Named { kind: u8, name: u8 },
    /// The end of what cannot be a sequence.
    Broken,
}

impl Escape {
    pub(super) fn push(&mut self, byte: u8) -> Step {
        if byte == ESC {
            *self = Self::Begun;
            return Step::Begun;
        }
        match *self {
            Self::None => Step::NotMine,
            Self::Begun => match byte {
                b'.' => {
                    *self = Self::Device;
                    Step::Within
                }
                b'!'..=b'/' => {
                    *self = Self::Printer { kind: byte };
                    Step::Within
                }
                b'0'..=b'~' => self.end(Step::Named { kind: byte, name: byte }),
                _ => self.end(Step::Broken),
            },
            Self::Device => {
                if !byte.is_ascii_graphic() {
                    return self.end(Step::Broken);
                }
                // Only these take numbers, which end with a colon: ESC.@1;2: and the like.
                *self = match byte.to_ascii_uppercase() {
                    b'@' | b'H' | b'I' | b'M' | b'N' | b'P' | b'Q' | b'S' | b'T' => Self::DeviceNumbers,
                    _ => Self::None,
                };
                Step::Named { kind: b'.', name: byte }
            }
            Self::DeviceNumbers => match byte {
                b':' => self.end(Step::Within),
                b'0'..=b'9' | b';' => Step::Within,
                // The colon is missing: the byte belongs to what follows.
                _ => self.end(Step::NotMine),
            },
            Self::Printer { kind } => match byte {
                b'@'..=b'^' => self.end(Step::Named { kind, name: byte }),
                b' '..=b'~' => Step::Within,
                _ => self.end(Step::Broken),
            },
        }
    }

    /// Ends the text; whether that breaks a sequence.
    pub(super) fn finish(&mut self) -> bool {
        let broken = matches!(self, Self::Begun | Self::Device | Self::Printer { .. });
        *self = Self::None;
        broken
    }

    fn end(&mut self, step: Step) -> Step {
        *self = Self::None;
        step
    }
}
