//! [`RemarkReader`]: finds the few comments that mean something, byte by byte.

use super::Remark;

/// Longest comment that can mean something.
const MOST_BYTES: usize = 12;

/// A comment in progress: its first bytes, in lower case, without the blanks before them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct RemarkReader {
    bytes: [u8; MOST_BYTES],
    /// One more than there is room for where the comment is too long.
    count: usize,
}

impl RemarkReader {
    pub(super) fn push(&mut self, byte: u8) {
        if self.count == 0 && byte == b' ' {
            return;
        }
        if let Some(slot) = self.bytes.get_mut(self.count) {
            *slot = byte.to_ascii_lowercase();
        }
        self.count = (self.count + 1).min(MOST_BYTES + 1);
    }

    pub(super) fn finish(self) -> Option<Remark> {
        let bytes = self.bytes.get(..self.count)?.trim_ascii_end();
        if bytes == b"new sheet" {
            return Some(Remark::NewSheet);
        }
        let digits = bytes.strip_prefix(b"pen ")?;
        let pen = digits.iter().try_fold(0_u8, |pen, byte| {
            let digit = byte.checked_sub(b'0').filter(|digit| *digit < 10)?;
            pen.checked_mul(10)?.checked_add(digit)
        });
        pen.filter(|_| !digits.is_empty()).map(Remark::Pen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_comments_mean_something() {
        let read = |text: &str| {
            let mut remark = RemarkReader::default();
            text.bytes().for_each(|byte| remark.push(byte));
            remark.finish()
        };
        assert_eq!(read(" New Sheet "), Some(Remark::NewSheet));
        assert_eq!(read("pen 12"), Some(Remark::Pen(12)));
        for text in
            ["", "pen down", "pen 256", "pen +1", "pen 1 now", "pen", "new sheets", "new sheet, please"]
        {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
