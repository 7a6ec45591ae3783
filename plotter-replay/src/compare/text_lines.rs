//! [`TextLines`]: lines of text in words, whole where they end, however their bytes came.

use crate::import::Side;

/// Bytes of a line that are kept.
const MOST_LINE: usize = 128;

/// The lines of both sides, as far as they have come.
#[derive(Clone, Debug)]
pub(super) struct TextLines {
    is_grbl: bool,
    begun: [Vec<u8>; 2],
}

impl TextLines {
    /// For a protocol of text lines; `None` for another one.
    pub(super) fn of(protocol: Option<&str>) -> Option<Self> {
        let is_grbl = match protocol? {
            "grbl" => true,
            "mdraw" | "marlin" | "ebb" => false,
            _ => return None,
        };
        Some(Self { is_grbl, begun: Default::default() })
    }

    /// What comes to its end with these bytes.
    pub(super) fn words(&mut self, side: Side, bytes: &[u8]) -> String {
        let [host, machine] = &mut self.begun;
        let begun = if side == Side::Host { host } else { machine };
        let mut parts = Vec::new();
        for &byte in bytes {
            let order = if self.is_grbl && side == Side::Host { order(byte) } else { None };
            if let Some(words) = order {
                parts.push(words);
            } else if byte != b'\n' && byte != b'\r' {
                if begun.len() < MOST_LINE {
                    begun.push(byte);
                }
            } else if !begun.is_empty() {
                parts.push(format!("{:?}", String::from_utf8_lossy(begun)));
                begun.clear();
            }
        }
        match (parts.is_empty(), begun.is_empty()) {
            (true, true) => String::from("end of line"),
            (true, false) => String::from("... of a line"),
            (false, true) => parts.join(", "),
            (false, false) => format!("{}, ...", parts.join(", ")),
        }
    }
}

/// What a host of Grbl's asks by one byte.
fn order(byte: u8) -> Option<String> {
    Some(match byte {
        b'?' => String::from("question"),
        b'!' => String::from("order hold"),
        b'~' => String::from("order go on"),
        0x18 => String::from("order reset"),
        0x84 => String::from("order door"),
        0x85 => String::from("order end jog"),
        0x80.. => format!("order 0x{byte:02x}"),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_told_where_it_ends() {
        let mut lines = TextLines::of(Some("grbl")).unwrap();
        assert_eq!(lines.words(Side::Host, b"G1 X1"), "... of a line");
        assert_eq!(lines.words(Side::Host, b"?0\nM3"), "question, \"G1 X10\", ...");
        assert_eq!(lines.words(Side::Controller, b"ok\r\nok"), "\"ok\", ...");
        assert_eq!(lines.words(Side::Controller, b"\r"), "\"ok\"");
        assert_eq!(lines.words(Side::Controller, b"\n"), "end of line");
        // To mDraw's machine a question mark is a letter.
        let mut lines = TextLines::of(Some("mdraw")).unwrap();
        assert_eq!(lines.words(Side::Host, b"?\n"), "\"?\"");
        assert!(TextLines::of(Some("digits")).is_none());
    }
}
