//! [`Text`]: what a line tells people.

use super::Remark;
use super::remark::RemarkReader;
use core::fmt;

/// Most bytes that are kept of a text: a line of a small display, as most machines have it, holds 20 to 40.
const MOST_BYTES: usize = 60;

/// The beginning of a text for people, without the blanks before it: what a pause asks for, or the name of a
/// command.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Text {
    bytes: [u8; MOST_BYTES],
    /// One more than there is room for where the text is longer.
    count: u8,
}

impl Default for Text {
    fn default() -> Self {
        Self { bytes: [0; MOST_BYTES], count: 0 }
    }
}

impl Text {
    pub(super) fn push(&mut self, byte: u8) {
        if self.count == 0 && byte.is_ascii_whitespace() {
            return;
        }
        let count = usize::from(self.count);
        if let Some(slot) = self.bytes.get_mut(count) {
            *slot = byte;
        }
        if count <= MOST_BYTES {
            self.count += 1;
        }
    }

    /// Its bytes, without the blanks behind it; at most 60.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.count).min(MOST_BYTES)).unwrap_or_default().trim_ascii_end()
    }

    /// Whether the text is longer than what is kept of it.
    #[cfg(feature = "alloc")]
    pub(super) fn is_cut(&self) -> bool {
        usize::from(self.count) > MOST_BYTES
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.as_bytes().is_empty()
    }

    /// What it means, if it is one of the few comments that mean something.
    pub(super) fn remark(&self) -> Option<Remark> {
        let mut remark = RemarkReader::default();
        self.as_bytes().iter().for_each(|byte| remark.push(*byte));
        remark.finish()
    }

    /// The same if it is a message, as in `(MSG, change the pen)`; otherwise none.
    pub(super) fn message(self) -> Self {
        let is_message = self.as_bytes().get(..3).is_some_and(|head| head.eq_ignore_ascii_case(b"msg"));
        if is_message { self } else { Self::default() }
    }
}

impl fmt::Display for Text {
    /// In one line; what is no text in UTF-8 as `\u{fffd}`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.as_bytes();
        let mut end = bytes.len();
        for chunk in bytes.utf8_chunks() {
            for letter in chunk.valid().chars() {
                write!(f, "{}", if letter.is_control() { ' ' } else { letter })?;
            }
            end -= chunk.valid().len() + chunk.invalid().len();
            // A letter that is cut off at the end of the room is no fault of the text.
            let is_cut = end == 0 && usize::from(self.count) > MOST_BYTES;
            if !(is_cut || chunk.invalid().is_empty()) {
                f.write_str("\u{fffd}")?;
            }
        }
        if usize::from(self.count) > MOST_BYTES { f.write_str("…") } else { Ok(()) }
    }
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{self}\"")
    }
}
