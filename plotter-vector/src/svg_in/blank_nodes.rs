//! [`without_blank_nodes`]: blanks between the elements of a large file as parts of tags.
//!
//! The XML parser makes a node of the end of a line between two elements, as large as that of an element.
//! Within a tag blanks are nothing:
//!
//! ```text
//!   <path d="…"/>⏎              <path d="…"⏎
//!   <path d="…"/>⏎    becomes   /><path d="…"⏎
//! ```

use core::ops::Range;

/// Smaller files stay as they are, bytes: below this, nodes are a few MB.
const SMALL_BYTES: usize = 4_000_000;

/// The text with blanks moved into the tags before them, as long as it was, each line where it was; `None`
/// where it stays as it is: small, or with texts, in which blanks are letters.
pub(super) fn without_blank_nodes(text: &str) -> Option<String> {
    if text.len() < SMALL_BYTES || text.contains("<text") || text.contains(":text") {
        return None;
    }
    let mut moved = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(end) = rest.find("/>") {
        let (before, after) = rest.split_at(end);
        moved.push_str(before);
        let after = after.get(END.len()..).unwrap_or_default();
        let next = after.trim_start_matches([' ', '\t', '\r', '\n']);
        let blanks = after.get(..after.len() - next.len()).unwrap_or_default();
        if next.starts_with('<') {
            moved.push_str(blanks);
            moved.push_str(END);
        } else {
            moved.push_str(END);
            moved.push_str(blanks);
        }
        rest = next;
    }
    moved.push_str(rest);
    Some(moved)
}

/// What ends an element without content.
const END: &str = "/>";

/// How far to the left of where it stands now a byte stood in its line, by an end that was moved before it.
pub(super) fn moved_by(text: &str, byte: usize) -> u32 {
    let line = |range: Range<usize>| text.get(range).unwrap_or_default();
    let before = line(0..byte);
    let begin = before.rfind('\n').map_or(0, |end| end + 1);
    u32::from(line(begin..byte).trim_start().starts_with(END)) * 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_go_into_the_tag_before_them() {
        let piece = "<path d='M0 0H9'/>\n  <path/> <g>\n</g> a/> b\n";
        let expected = "<path d='M0 0H9'\n  /><path /><g>\n</g> a/> b\n";
        let times = SMALL_BYTES / piece.len() + 1;
        assert_eq!(without_blank_nodes(&piece.repeat(times)), Some(expected.repeat(times)));
        assert_eq!(without_blank_nodes(piece), None);
        assert_eq!(moved_by(expected, expected.find("d=").unwrap()), 0);
        assert_eq!(moved_by(expected, expected.find("<path />").unwrap()), 2);
        assert_eq!(without_blank_nodes(&(piece.repeat(times) + "<text/>")), None);
    }
}
