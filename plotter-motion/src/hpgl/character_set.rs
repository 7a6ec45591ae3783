//! [`CharacterSets`]: what the bytes of labels mean: `CS`, `CA`, `SS`, `SA`, `SD`, `AD`, shift out and shift
//! in.

/// In the place of a byte of Latin-1: a character that the text has drawn itself with `DL`, by its number.
pub(super) const OWN: u16 = 0x100;

/// What a byte from `!` to `~` means, and where needed one beyond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum CharacterSet {
    /// ASCII, and Latin-1 beyond.
    #[default]
    Latin1,
    /// ASCII with letters of a language in the place of some signs: the one of [`NATIONAL`].
    National(u8),
    /// HP's Roman Extensions from `!` on.
    RomanExtensions,
    /// ASCII, and the Roman Extensions 128 higher.
    Roman8,
    /// Characters of `DL`.
    Own,
}

/// Signs of ASCII that the national versions of ISO 646 replace.
const REPLACED: [u8; 12] = *b"#$@[\\]^`{|}~";

/// Those versions: the number of `CS`, that of a printer (`SD1`), and what stands in the place of each sign,
/// in Latin-1.
///
/// Source: the ISO International Register of Coded Character Sets, registrations 2, 4, 10, 11, 14 to 17, 21,
/// 25, 60, 61.
const NATIONAL: [(u16, u16, [u8; 12]); 12] = [
    (6, 11, *b"#$@[\xA5]^`{|}\xAF"),                             // Japan
    (9, 85, *b"#\xA4@[\\]^`{|}\xAF"),                            // international
    (30, 115, *b"#\xA4@\xC4\xD6\xC5^`\xE4\xF6\xE5\xAF"),         // Sweden
    (31, 19, *b"#\xA4\xC9\xC4\xD6\xC5\xDC\xE9\xE4\xF6\xE5\xFC"), // Sweden, for names
    (32, 4, *b"#$@\xC6\xD8\xC5^`\xE6\xF8\xE5\xAF"),              // Norway
    (33, 39, *b"#$\xA7\xC4\xD6\xDC^`\xE4\xF6\xFC\xDF"),          // Germany
    (34, 6, *b"\xA3$\xE0\xB0\xE7\xA7^`\xE9\xF9\xE8\xA8"),        // France
    (35, 37, *b"\xA3$@[\\]^`{|}\xAF"),                           // Britain
    (36, 9, *b"\xA3$\xA7\xB0\xE7\xE9^\xF9\xE0\xF2\xE8\xEC"),     // Italy
    (37, 83, *b"\xA3$\xA7\xA1\xD1\xBF^`\xB0\xF1\xE7~"),          // Spain
    (38, 147, *b"#$\xA7\xC3\xC7\xD5^`\xE3\xE7\xF5\xB0"),         // Portugal
    (39, 36, *b"\xA7$@\xC6\xD8\xC5^`\xE6\xF8\xE5|"),             // Norway, second version
];

/// HP's Roman Extensions from `!` to `~`, in Latin-1; what is not in that is its nearest sign.
///
/// Source: J. Klensin, RFC 1345, "hp-roman8".
const ROMAN_EXTENSIONS: [u8; 94] = *b"\xC0\xC2\xC8\xCA\xCB\xCE\xCF\xB4`^\xA8~\xD9\xDB\xA3\xAF\xDD\xFD\xB0\xC7\xE7\xD1\xF1\
    \xA1\xBF\xA4\xA3\xA5\xA7f\xA2\xE2\xEA\xF4\xFB\xE1\xE9\xF3\xFA\xE0\xE8\xF2\xF9\xE4\xEB\xF6\xFC\xC5\xEE\xD8\xC6\xE5\xED\
    \xF8\xE6\xC4\xEC\xD6\xDC\xC9\xEF\xDF\xD4\xC1\xC3\xE3\xD0\xF0\xCD\xCC\xD3\xD2\xD5\xF5Ss\xDAY\xFF\xDE\xFE\xB7\xB5\xB6\
    \xBE-\xBC\xBD\xAA\xBA\xAB\xA0\xBB\xB1";

/// Numbers of fonts with letters as wide as they are lie this much higher than those with letters of one
/// width.
const VARIABLE_SPACE: u16 = 10;
/// Characters of one's own as a printer numbers its fonts.
const PRINTERS_OWN: u16 = 531;
/// Roman-8 and Latin-1 as a printer numbers its fonts; ASCII is 21.
const PRINTERS_ROMAN8: u16 = 277;

impl CharacterSet {
    /// The set with this number of `CS` and `CA`, −1 being one's own; none if its signs are not known here.
    pub(super) fn numbered(number: f64) -> Option<Self> {
        if number == -1.0 {
            return Some(Self::Own);
        }
        let is = |known: u16| number == f64::from(known) || number == f64::from(known + VARIABLE_SPACE);
        if is(0) {
            return Some(Self::Latin1);
        }
        if is(7) {
            return Some(Self::RomanExtensions);
        }
        Self::national(|(known, _, _)| is(*known))
    }

    /// The set that `SD` and `AD` know by this number: Latin-1 if it is not known here, as a printer takes
    /// what it has.
    pub(super) fn of_printer(number: f64) -> Self {
        let is = |known: u16| number == f64::from(known);
        if is(PRINTERS_OWN) {
            return Self::Own;
        }
        if is(PRINTERS_ROMAN8) {
            return Self::Roman8;
        }
        Self::national(|(_, known, _)| is(*known)).unwrap_or_default()
    }

    fn national(is: impl Fn(&(u16, u16, [u8; 12])) -> bool) -> Option<Self> {
        (0..).zip(&NATIONAL).find(|(_, set)| is(set)).map(|(which, _)| Self::National(which))
    }

    /// What a byte means: Latin-1, or from [`OWN`] on a character of one's own.
    pub(super) fn character(self, byte: u8) -> u16 {
        let extension = |from: u8| {
            let index = usize::from(byte.wrapping_sub(from));
            ROMAN_EXTENSIONS.get(index).copied().unwrap_or(byte).into()
        };
        match self {
            Self::National(which) => {
                let sign = REPLACED.iter().position(|sign| *sign == byte);
                let letters = NATIONAL.get(usize::from(which)).map(|(_, _, letters)| letters);
                let letter = sign.zip(letters).and_then(|(sign, letters)| letters.get(sign));
                letter.copied().unwrap_or(byte).into()
            }
            Self::RomanExtensions if byte < 0x80 => extension(b'!'),
            Self::Roman8 if byte >= 0x80 => extension(b'!' + 0x80),
            Self::Own => OWN | u16::from(byte),
            _ => byte.into(),
        }
    }
}

/// The sets that are chosen, and which of them holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct CharacterSets {
    pub(super) standard: CharacterSet,
    pub(super) alternate: CharacterSet,
    pub(super) is_alternate: bool,
}

impl CharacterSets {
    /// The one that holds.
    pub(super) fn set(&self) -> CharacterSet {
        if self.is_alternate { self.alternate } else { self.standard }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_a_language_take_the_place_of_signs() {
        let german = CharacterSet::numbered(33.0).unwrap();
        assert_eq!(german.character(b'{'), 0xE4); // ä
        assert_eq!(german.character(b'a'), u16::from(b'a'));
        assert_eq!(CharacterSet::numbered(43.0), Some(german), "the same with letters of their own widths");
        assert_eq!(CharacterSet::of_printer(39.0), german);
        assert_eq!(CharacterSet::numbered(5.0), None); // HP's special symbols
        assert_eq!(CharacterSet::numbered(0.5), None);
    }

    #[test]
    fn roman_extensions_are_a_set_or_the_upper_half_of_one() {
        // the registered names: 0xC5 is small e with acute, 0xB6 capital N with tilde, 0xFE plus-minus
        for (byte, meaning) in [(0xC5, 0xE9), (0xB6, 0xD1), (0xFE, 0xB1)] {
            assert_eq!(CharacterSet::Roman8.character(byte), meaning);
            assert_eq!(CharacterSet::RomanExtensions.character(byte - 0x80), meaning);
        }
        assert_eq!(CharacterSet::Roman8.character(b'E'), u16::from(b'E'));
    }
}
