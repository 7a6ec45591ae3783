//! [`EmergencyParser`]: finds the commands that act as soon as their bytes come, whatever waits before them.

/// What acts at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Urgent {
    /// `M112`: the machine halts until it is reset.
    Kill,
    /// `M410`: what is planned is dropped; the machine goes on.
    QuickStop,
}

/// Reads along with the bytes of the host, before they lie in a buffer. A checksum is not looked at, as in
/// Marlin (`feature/e_parser.h`): a stop in a damaged line is a stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum EmergencyParser {
    /// Before the first byte of a line, or within its number.
    #[default]
    Begin,
    /// After so many letters of a word that fits.
    Letters([u8; 3], u8),
    /// A command that acts when the line ends.
    Found(Urgent),
    /// The line has none.
    Other,
}

impl EmergencyParser {
    /// Takes the next byte; what acts now.
    pub(super) fn push(&mut self, byte: u8) -> Option<Urgent> {
        if matches!(byte, b'\n' | b'\r') {
            let found = if let Self::Found(urgent) = *self { Some(urgent) } else { None };
            *self = Self::Begin;
            return found;
        }
        *self = match *self {
            Self::Begin => match byte {
                b' ' | b'N' | b'-' | b'0'..=b'9' => Self::Begin,
                b'M' => Self::Letters([0; 3], 0),
                _ => Self::Other,
            },
            Self::Letters([_, a, b], count) => match (count, [a, b, byte]) {
                (2, [b'1', b'1', b'2']) => Self::Found(Urgent::Kill),
                (2, [b'4', b'1', b'0']) => Self::Found(Urgent::QuickStop),
                (0 | 1, digits) if byte.is_ascii_digit() => Self::Letters(digits, count + 1),
                _ => Self::Other,
            },
            state => state,
        };
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(line: &[u8]) -> Option<Urgent> {
        let mut parser = EmergencyParser::default();
        line.iter().filter_map(|&byte| parser.push(byte)).last()
    }

    #[test]
    fn a_stop_is_found_with_a_number_and_a_wrong_checksum_and_nothing_else_is() {
        for line in ["M112\n", "N12 M112*99\r", "  M112 \n", "N-1M112\n"] {
            assert_eq!(found(line.as_bytes()), Some(Urgent::Kill), "{line}");
        }
        assert_eq!(found(b"N3 M410*1\n"), Some(Urgent::QuickStop));
        for line in ["M112", "M11\n", "M11 2\n", "G1 M112\n", "; M112\n", "M1 12\n", "M412\n"] {
            assert_eq!(found(line.as_bytes()), None, "{line}");
        }
    }
}
