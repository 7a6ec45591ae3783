//! [`Extension`]: what programs for cutters write between the commands of HPGL.

use core::fmt;

/// Something that is no HPGL, and that programs for cutters write into it for the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Extension {
    /// The sign, and the letters after a `!`.
    signs: [u8; 3],
}

/// What ends a label, or a command of GP-GL.
const ETX: u8 = 3;

/// The signs of an extension, and what it does on its devices.
///
/// Source: Roland's *CAMM-GL III Programmer's Manual* and *CAMM-GL II Programmer's Manual*, on the common
/// commands.
const KNOWN: [([u8; 3], &str); 16] = [
    (*b"!CT", "cutting mode"),
    (*b"!DW", "wait"),
    (*b"!FS", "force"),
    (*b"!MC", "motor of the tool"),
    (*b"!NR", "not ready: end of the job"),
    (*b"!OF", "offset of the blade"),
    (*b"!PG", "feed of the sheet behind the drawing"),
    (*b"!PZ", "heights of the tool"),
    (*b"!RC", "speed of the tool's motor"),
    (*b"!ST", "choice of the tool"),
    (*b"!VZ", "speed of the tool's axis"),
    (*b"!ZM", "height of the tool"),
    (*b"!ZO", "zero of the tool's height"),
    (*b"!ZZ", "move in three axes"),
    ([b'@', 0, 0], "end of a job in DM/PL"),
    ([ETX, 0, 0], "end of a command in GP-GL"),
];

impl Extension {
    /// The one that a sign is by itself, between commands.
    pub(super) fn of_sign(sign: u8) -> Option<Self> {
        matches!(sign, b'@' | ETX).then_some(Self { signs: [sign, 0, 0] })
    }

    /// `!` and its letters, 0 for none.
    pub(super) fn setting([first, second]: [u8; 2]) -> Self {
        Self { signs: [b'!', first.to_ascii_uppercase(), second.to_ascii_uppercase()] }
    }

    /// Effect on the machines that know it.
    ///
    /// ```
    /// # use plotter_motion::hpgl::{Event, Reader};
    /// let mut reader = Reader::new();
    /// let events: Vec<_> = b"!PG;".iter().filter_map(|byte| reader.push(*byte)).flatten().collect();
    /// let [Event::Extension { extension, .. }] = events[..] else { panic!("{events:?}") };
    /// assert_eq!((extension.to_string(), extension.meaning()), ("!PG".into(), "feed of the sheet behind the drawing"));
    /// ```
    #[must_use]
    pub fn meaning(&self) -> &'static str {
        let known = KNOWN.iter().find(|(signs, _)| *signs == self.signs);
        known.map_or("a cutter's own command", |(_, meaning)| meaning)
    }

    /// Which one of [`Extension::KINDS`] it is, for what is said once.
    pub(super) fn kind(self) -> usize {
        KNOWN.iter().position(|(signs, _)| *signs == self.signs).unwrap_or(KNOWN.len())
    }

    /// How many kinds there are, those that are not known as one.
    pub(super) const KINDS: usize = KNOWN.len() + 1;
}

impl fmt::Display for Extension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.signs == [ETX, 0, 0] {
            return f.write_str("byte 0x03");
        }
        self.signs.iter().filter(|sign| **sign != 0).try_for_each(|sign| write!(f, "{}", char::from(*sign)))
    }
}
