//! Bytes in hex with or without their characters beside them.

/// A byte from two hex digits.
pub(super) fn hex_byte(text: &str) -> Option<u8> {
    (text.len() == 2 && text.bytes().all(|b| b.is_ascii_hexdigit()))
        .then(|| u8::from_str_radix(text, 16).ok())
        .flatten()
}

/// The bytes of hex digits without anything between, at least one.
pub(super) fn hex_run(text: &str) -> Option<Vec<u8>> {
    if text.is_empty() || !text.len().is_multiple_of(2) {
        return None;
    }
    (0..text.len()).step_by(2).map(|at| hex_byte(text.get(at..at.checked_add(2)?)?)).collect()
}

/// The bytes at the beginning of a line, two digits each and a space between, as many as there are; with
/// `lead` a space comes before each.
pub(super) fn pairs(line: &str, lead: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let mut rest = line;
    loop {
        let pair = if lead || !out.is_empty() { rest.strip_prefix(' ') } else { Some(rest) };
        let Some((byte, after)) = pair.and_then(|pair| Some((hex_byte(pair.get(..2)?)?, pair.get(2..)?)))
        else {
            return out;
        };
        // `13` may be the beginning of the characters `1313`.
        if !(after.is_empty() || after.starts_with([' ', '\t'])) {
            return out;
        }
        out.push(byte);
        rest = after;
    }
}

/// The bytes of a line that has their characters behind them. These may look like hex too, so as many bytes
/// are taken as fit the characters; if none do, all that look like bytes.
pub(super) fn pairs_with_characters(line: &str) -> Vec<u8> {
    let mut all = pairs(line, false);
    let fits = |count: usize| {
        let characters =
            line.get(count.saturating_mul(3)..).unwrap_or_default().trim_start_matches([' ', '\t']);
        let shown = |&byte: &u8| if byte.is_ascii_graphic() { char::from(byte) } else { '.' };
        let expected: String = all.iter().take(count).map(shown).collect();
        characters == expected || characters.replace(' ', ".") == expected.replace(' ', ".")
    };
    if let Some(count) = (1..=all.len()).rev().find(|&count| fits(count)) {
        all.truncate(count);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_look_like_bytes_are_none() {
        assert_eq!(pairs(" 31 33 31 33                                      1313", true), b"1313");
        assert_eq!(pairs(" 31 33", true), b"13");
        assert_eq!(pairs_with_characters("31 33 20 33 31 13 31"), b"13 31");
        assert_eq!(pairs_with_characters("33 31 20 33 31 20\t31 31 "), b"31 31 ");
        assert_eq!(pairs_with_characters("31 32 32 12 2"), [0x31, 0x32, 0x32, 0x12]);
        assert_eq!(pairs_with_characters("41 42   AB"), b"AB");
        assert_eq!(pairs_with_characters("00 0A   .."), [0, 10]);
        assert_eq!(pairs_with_characters("hello"), b"");
    }
}
