//! [`LineBuffer`]: from bytes to lines, as Grbl does it.

use super::rx_buffer::LOST;
use crate::protocol::SUBSTITUTE;

/// Greatest length of a line in characters, without blanks and comments: as in Grbl 1.1.
pub(super) const MOST: usize = 80;

/// The line that is being received, or that waits to be carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LineBuffer {
    text: [u8; MOST],
    len: usize,
    comment: Comment,
    ended: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comment {
    None,
    /// Within parentheses.
    Parentheses,
    /// After a semicolon.
    Rest,
}

impl LineBuffer {
    pub(super) const fn new() -> Self {
        Self { text: [0; MOST], len: 0, comment: Comment::None, ended: false }
    }

    /// Takes a byte of a line that has not ended.
    pub(super) fn push(&mut self, byte: u8) {
        match (self.comment, byte) {
            (_, b'\n' | b'\r') => self.ended = true,
            (_, LOST) => (self.len, self.ended) = (MOST + 1, true),
            (_, SUBSTITUTE) => self.len = MOST + 1,
            (Comment::Rest, _) => {}
            (Comment::Parentheses, b')') => self.comment = Comment::None,
            (Comment::Parentheses, _) => {}
            (Comment::None, b'(') => self.comment = Comment::Parentheses,
            (Comment::None, b';') => self.comment = Comment::Rest,
            (Comment::None, _) if byte <= b' ' => {}
            (Comment::None, _) => {
                if let Some(slot) = self.text.get_mut(self.len) {
                    *slot = byte.to_ascii_uppercase();
                }
                // A line that is too long stays so until it ends.
                self.len = (self.len + 1).min(MOST + 1);
            }
        }
    }

    /// Whether the line is complete.
    pub(super) const fn has_ended(&self) -> bool {
        self.ended
    }

    /// The line, without blanks and comments, in capitals; none if it was too long.
    pub(super) fn text(&self) -> Option<&[u8]> {
        self.text.get(..self.len)
    }

    /// Whether it is `$G`, of which nothing comes but an answer.
    pub(super) fn is_question(&self) -> bool {
        self.len == 2 && self.text.starts_with(b"$G")
    }

    pub(super) const fn clear(&mut self) {
        (self.len, self.comment, self.ended) = (0, Comment::None, false);
    }
}
