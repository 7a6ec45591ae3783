//! [`Islands`]: the rows that areas lie in, a stretch of them at a time.

use crate::picture::{Bitmap, MAX_PIXELS};

/// Cuts a picture at its empty rows: what lies in between is drawn by itself, as soon as it is complete.
///
/// A stretch of more than [`MAX_PIXELS`] is cut where it reaches them, which no picture that is held whole
/// does.
#[derive(Clone, Debug)]
pub(crate) struct Islands {
    width: u32,
    words: Vec<u64>,
    /// Row of the first words, and the row that comes next.
    first: u32,
    next: u32,
}

impl Islands {
    /// Before the first row of a picture of `width` px.
    pub(crate) const fn new(width: u32) -> Self {
        Self { width, words: Vec::new(), first: 0, next: 0 }
    }

    /// Takes the next row; gives the stretch that it ends, with its first row.
    pub(crate) fn push(&mut self, row: &[u64]) -> Option<(u32, Bitmap)> {
        let empty = row.iter().all(|bits| *bits == 0);
        let full = u64::from(self.next + 1 - self.first) * u64::from(self.width) > MAX_PIXELS;
        let ended = if empty || full { self.finish() } else { None };
        if !empty {
            if self.words.is_empty() {
                self.first = self.next;
            }
            self.words.extend_from_slice(row);
        }
        self.next += 1;
        if empty {
            self.first = self.next;
        }
        ended
    }

    /// The stretch that the last row belongs to, if any.
    pub(crate) fn finish(&mut self) -> Option<(u32, Bitmap)> {
        if self.words.is_empty() {
            return None;
        }
        let words = core::mem::take(&mut self.words);
        Some((self.first, Bitmap::of_words(self.width, self.next - self.first, words)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_end_at_empty_rows_and_at_the_last() {
        let mut islands = Islands::new(3);
        let rows = [0, 1, 2, 0, 0, 4];
        let mut ended: Vec<_> = rows.iter().filter_map(|row| islands.push(&[*row])).collect();
        ended.extend(islands.finish());
        let found: Vec<_> = ended.iter().map(|(first, ink)| (*first, ink.to_string())).collect();
        assert_eq!(found, [(1, "#..\n.#.\n".to_owned()), (5, "..#\n".to_owned())]);
        assert_eq!(islands.finish(), None);
    }
}
