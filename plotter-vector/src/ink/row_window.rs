//! [`RowWindow`]: the rows of a picture that are still needed.

use crate::picture::{Bitmap, Gray};
use core::ops::Range;

/// Fewest rows that there is room for when the room is used up.
const ROWS_MORE: usize = 32;

/// Rows that come at the bottom and are forgotten at the top: words of 64 px, or grey levels.
#[derive(Clone, Debug)]
pub(crate) struct RowWindow<T> {
    width: u32,
    /// Items of a row.
    per_row: usize,
    /// Row of the picture that the first one kept is.
    first: u32,
    /// One past the last row.
    end: u32,
    /// Items that room is taken for at once.
    room: usize,
    items: Vec<T>,
}

impl<T: Copy + Default> RowWindow<T> {
    /// Before the first row of a picture of `width` px.
    pub(crate) fn new(width: u32, per_row: usize) -> Self {
        Self { width, per_row, first: 0, end: 0, room: 0, items: Vec::new() }
    }

    /// With room for so many rows: what grows leaves holes in the memory.
    pub(crate) fn with_room(self, rows: u32) -> Self {
        Self { room: self.per_row * rows as usize, ..self }
    }

    /// One past the last row that came.
    pub(crate) fn end(&self) -> u32 {
        self.end
    }

    /// A row more, to be filled; blank.
    pub(crate) fn next_row(&mut self) -> &mut [T] {
        let start = self.items.len();
        if self.items.capacity() < start + self.per_row {
            // By an eighth, not to twice as much: a sheet has hundreds of rows on their way.
            let more = (self.per_row * ROWS_MORE).max(start / 8);
            self.items.reserve_exact(more.max(self.room.saturating_sub(start)));
        }
        self.items.resize(start + self.per_row, T::default());
        self.end += 1;
        self.items.get_mut(start..).unwrap_or_default()
    }

    /// A row more.
    pub(crate) fn push(&mut self, row: &[T]) {
        self.next_row().iter_mut().zip(row).for_each(|(to, from)| *to = *from);
    }

    /// Forgets all rows above this one, and gives back their memory: other steps work before as many rows are
    /// here again.
    pub(crate) fn forget_before(&mut self, row: u32) {
        let row = row.clamp(self.first, self.end);
        if row > self.first {
            self.items.drain(..(row - self.first) as usize * self.per_row);
            self.items.shrink_to_fit();
        }
        self.first = row;
    }

    /// The items of some rows that are still here.
    pub(crate) fn rows(&self, rows: &Range<u32>) -> &[T] {
        let at = |row: u32| row.saturating_sub(self.first) as usize * self.per_row;
        self.items.get(at(rows.start)..at(rows.end)).unwrap_or(&[])
    }
}

impl RowWindow<u64> {
    /// Rows of ink.
    pub(crate) fn of_ink(width: u32) -> Self {
        Self::new(width, width.div_ceil(u64::BITS) as usize)
    }

    /// A copy of some rows that are still here, made of the memory of `words`.
    pub(crate) fn band(&self, rows: &Range<u32>, mut words: Vec<u64>) -> Bitmap {
        let own = self.rows(rows);
        words.clear();
        words.reserve_exact(own.len());
        words.extend_from_slice(own);
        Bitmap::of_words(self.width, rows.end - rows.start, words)
    }

    /// Lends all rows that are still here, and the number of the first one, without a copy.
    pub(crate) fn lend<R>(&mut self, work: impl FnOnce(&Bitmap, u32) -> R) -> R {
        let words = core::mem::take(&mut self.items);
        let picture = Bitmap::of_words(self.width, self.end - self.first, words);
        let result = work(&picture, self.first);
        self.items = picture.into_words();
        result
    }
}

impl RowWindow<u8> {
    /// Rows of grey levels.
    pub(crate) fn of_levels(width: u32) -> Self {
        Self::new(width, width as usize)
    }

    /// As [`RowWindow::lend`] of ink.
    pub(crate) fn lend<R>(&mut self, work: impl FnOnce(&Gray, u32) -> R) -> R {
        let levels = core::mem::take(&mut self.items);
        let picture = Gray::of_checked_size(self.width, self.end - self.first, levels);
        let result = work(&picture, self.first);
        self.items = picture.into_pixels();
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_their_numbers_when_those_above_are_forgotten() {
        let mut rows = RowWindow::of_ink(70);
        for y in 0..5 {
            rows.push(&[1 << y, 0]);
        }
        rows.forget_before(3);
        rows.push(&[1 << 5, 0]);
        assert_eq!(rows.end(), 6);
        let band = rows.band(&(4..6), vec![7]);
        assert_eq!((band.width(), band.height()), (70, 2));
        assert_eq!((band.row(0), band.row(1)), ([16, 0].as_slice(), [32, 0].as_slice()));
        let lent = rows.lend(|picture, first| (first, picture.height(), picture.row(0).to_vec()));
        assert_eq!(lent, (3, 3, vec![8, 0]));
        assert_eq!(rows.band(&(4..6), vec![7]), band);
    }

    #[test]
    fn a_picture_without_columns_has_rows_all_the_same() {
        let mut rows = RowWindow::of_levels(0);
        rows.push(&[]);
        rows.push(&[]);
        rows.forget_before(1);
        assert_eq!((rows.end(), rows.lend(|levels, first| (first, levels.height()))), (2, (1, 1)));
    }
}
