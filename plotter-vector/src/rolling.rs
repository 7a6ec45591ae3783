//! [`Rolling`]: the rows of a picture that are still needed.

use crate::{Bitmap, Gray};
use core::ops::Range;

/// Rows that come at the bottom and are forgotten at the top: words of 64 px, or grey levels.
#[derive(Clone, Debug)]
pub(crate) struct Rolling<T> {
    width: u32,
    /// Items of a row.
    per_row: usize,
    /// Row of the picture that the first one kept is.
    first: u32,
    /// One past the last row.
    end: u32,
    items: Vec<T>,
}

impl<T: Copy + Default> Rolling<T> {
    /// Before the first row of a picture of `width` px.
    pub(crate) fn new(width: u32, per_row: usize) -> Self {
        Self { width, per_row, first: 0, end: 0, items: Vec::new() }
    }

    /// One past the last row that came.
    pub(crate) fn end(&self) -> u32 {
        self.end
    }

    /// A row more, to be filled; blank.
    pub(crate) fn next_row(&mut self) -> &mut [T] {
        let start = self.items.len();
        self.items.resize(start + self.per_row, T::default());
        self.end += 1;
        self.items.get_mut(start..).unwrap_or_default()
    }

    /// A row more.
    pub(crate) fn push(&mut self, row: &[T]) {
        self.next_row().iter_mut().zip(row).for_each(|(to, from)| *to = *from);
    }

    /// Forgets all rows above this one.
    pub(crate) fn forget_before(&mut self, row: u32) {
        let row = row.clamp(self.first, self.end);
        self.items.drain(..(row - self.first) as usize * self.per_row);
        self.first = row;
    }

    /// The items of some rows that are still here.
    fn rows(&self, rows: &Range<u32>) -> &[T] {
        let at = |row: u32| row.saturating_sub(self.first) as usize * self.per_row;
        self.items.get(at(rows.start)..at(rows.end)).unwrap_or(&[])
    }
}

impl Rolling<u64> {
    /// Rows of ink.
    pub(crate) fn of_ink(width: u32) -> Self {
        Self::new(width, width.div_ceil(u64::BITS) as usize)
    }

    /// A copy of some rows that are still here.
    pub(crate) fn band(&self, rows: &Range<u32>) -> Bitmap {
        Bitmap::of_words(self.width, rows.end - rows.start, self.rows(rows).to_vec())
    }
}

impl Rolling<u8> {
    /// Rows of grey levels.
    pub(crate) fn of_levels(width: u32) -> Self {
        Self::new(width, width as usize)
    }

    /// A copy of some rows that are still here.
    pub(crate) fn band(&self, rows: &Range<u32>) -> Gray {
        Gray::of_checked_size(self.width, rows.end - rows.start, self.rows(rows).to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_their_numbers_when_those_above_are_forgotten() {
        let mut rows = Rolling::of_ink(70);
        for y in 0..5 {
            rows.push(&[1 << y, 0]);
        }
        rows.forget_before(3);
        rows.push(&[1 << 5, 0]);
        assert_eq!(rows.end(), 6);
        let band = rows.band(&(4..6));
        assert_eq!((band.width(), band.height()), (70, 2));
        assert_eq!((band.row(0), band.row(1)), ([16, 0].as_slice(), [32, 0].as_slice()));
    }

    #[test]
    fn a_picture_without_columns_has_rows_all_the_same() {
        let mut rows = Rolling::of_levels(0);
        rows.push(&[]);
        rows.push(&[]);
        rows.forget_before(1);
        assert_eq!((rows.end(), rows.band(&(1..2)).height()), (2, 1));
    }
}
