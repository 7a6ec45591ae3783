//! [`Run`]: letters within encoded data that turn out to be commands, where the `;` of `PE` is missing.

use super::{Mnemonic, Position, Syntax};

/// Most commands without numbers in a row: ten letters, which is as long as an encoded number may be.
const MOST: usize = 5;

/// One to five commands whose letters stand one behind the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Commands {
    letters: [[u8; 2]; MOST],
    count: u8,
}

impl Commands {
    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = Mnemonic> {
        let [a, b, c, d, e] = self.letters;
        [a, b, c, d, e]
            .into_iter()
            .take(usize::from(self.count))
            .filter_map(|[first, second]| Mnemonic::new(first, second))
    }

    /// The last one.
    pub(super) fn last(&self) -> Option<Mnemonic> {
        self.iter().last()
    }
}

/// Letters since the last complete number of encoded data.
///
/// ```text
/// PE<=k@\u{BF}PUSP0;      after the number k@\u{BF}: P U S P, digits all four, and 0, which is none
/// ```
///
/// A digit of encoded data is a byte from 63 on, letters among them; a number ends with one from 191 on (in
/// seven bits from 95 on). Commands are what a number that breaks off has been if all of its bytes are pairs
/// of letters that are known as commands.
///
/// Source: *The HP-GL/2 and HP RTL Reference Guide*, on `PE`, which must be ended by a `;`. AutoCAD's driver
/// leaves it out before `PU`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    letters: [[u8; 2]; MOST],
    /// How many letters; more than there is room for when they are no commands.
    count: u8,
    start: Position,
    seven_bits: bool,
}

const NO_COMMANDS: u8 = u8::MAX;

impl Run {
    /// Outside of data.
    pub(super) const NONE: Self = Self::START;
    /// Before the first byte of data.
    pub(super) const START: Self =
        Self { letters: [[0; 2]; MOST], count: 0, start: Position::START, seven_bits: false };

    /// Takes one more byte of data; the commands before it, if it shows that they are some: it is then the
    /// first byte behind the letters of the last one.
    pub(super) fn push(&mut self, byte: u8, at: Position) -> Option<(Commands, Position)> {
        let byte = if self.seven_bits { byte & 0x7F } else { byte };
        let is_last_digit = if self.seven_bits { (95..=126).contains(&byte) } else { byte > 127 };
        if is_last_digit {
            self.count = 0;
            return None;
        }
        let room = usize::from(self.count) < 2 * MOST;
        if byte.is_ascii_alphabetic() && room {
            if self.count == 0 {
                self.start = at;
            }
            let index = usize::from(self.count);
            if let Some(letter) = self.letters.get_mut(index / 2).and_then(|pair| pair.get_mut(index % 2)) {
                *letter = byte;
            }
            self.count += 1;
            return None;
        }
        let found = self.commands().filter(|(commands, _)| {
            let fits = match commands.last().map(Mnemonic::syntax) {
                Some(Syntax::Encoded) => matches!(byte, b'<' | b'=' | b':' | b'>' | b'7'),
                Some(Syntax::Numbers) => {
                    matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.') || byte.is_ascii_alphabetic()
                }
                _ => false,
            };
            fits && (!byte.is_ascii_alphabetic() || self.all_ended().is_some())
        });
        if found.is_some() {
            *self = Self::START;
        } else if self.count == 0 {
            self.seven_bits |= byte == b'7';
        }
        if byte >= 63 || (byte <= b' ' && self.count > 0) {
            self.count = NO_COMMANDS;
        }
        found
    }

    /// The commands, if the last one ends here.
    pub(super) fn all_ended(&self) -> Option<(Commands, Position)> {
        self.commands().filter(|(commands, _)| {
            commands
                .last()
                .is_some_and(|last| may_stand_alone(last) || matches!(last.letters(), b"EP" | b"FP"))
        })
    }

    fn commands(&self) -> Option<(Commands, Position)> {
        let is_even = self.count.is_multiple_of(2) && self.count > 0 && usize::from(self.count) <= 2 * MOST;
        let commands = Commands { letters: self.letters, count: self.count / 2 };
        let last = usize::from(commands.count).saturating_sub(1);
        let is_known = |(index, command): (usize, Mnemonic)| {
            if index == last { command.meaning().is_some() } else { may_stand_alone(command) }
        };
        (is_even && commands.iter().enumerate().all(is_known)).then_some((commands, self.start))
    }
}

/// Whether a command makes sense without numbers, and draws nothing by itself.
fn may_stand_alone(command: Mnemonic) -> bool {
    matches!(
        command.letters(),
        b"PU"
            | b"PD"
            | b"PA"
            | b"PR"
            | b"PE"
            | b"SP"
            | b"PG"
            | b"IN"
            | b"DF"
            | b"LT"
            | b"UL"
            | b"FT"
            | b"LA"
            | b"PW"
            | b"WU"
            | b"VS"
            | b"SC"
            | b"IP"
            | b"IR"
            | b"IW"
            | b"RO"
            | b"MC"
            | b"TR"
    )
}
