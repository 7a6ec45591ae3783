//! [`RowSource`]: a picture that comes row by row, and can come again.
//!
//! A sheet of A0 at 1200 dots per inch has 39 732 x 56 173 px, 2.2 thousand million: too many to hold even at
//! 1 bit each. What needs only a band of it at a time takes its rows from here.

use crate::picture::{Bitmap, DecodeError, Gray};

/// Most rows of a picture that comes row by row: 2²², or 177 m at 600 dots per inch. Down there a place is
/// still known to a thousand millionth of a pixel.
pub const MAX_SHEET_ROWS: u32 = 1 << 22;

/// What the pixels of a row are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Depth {
    /// 1 bit, a set bit is black.
    Bits1,
    /// 256 levels, 0 black to 255 white.
    Grey8,
}

/// A row of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Row<'a> {
    /// 64 px to a word, the leftmost in the lowest bit, a set bit is black; the bits right of the picture are
    /// clear. So it is a row of a [`Bitmap`] whose ink is black.
    Bits(&'a [u64]),
    /// A level a pixel, 0 black to 255 white, as in a [`Gray`].
    Grey(&'a [u8]),
}

/// A picture that comes row by row from the top, as often as one likes.
///
/// Twice is the usual: Otsu's level asks for a histogram of the whole sheet before its first row can become
/// ink.
///
/// ```
/// # use plotter_vector::{Bitmap, picture::{BitmapRows, Row, RowSource}};
/// fn black(picture: &mut impl RowSource) -> Result<u32, plotter_vector::DecodeError> {
///     let mut count = 0;
///     picture.rewind()?;
///     while let Some(row) = picture.next_row()? {
///         count += match row {
///             Row::Bits(words) => words.iter().map(|word| word.count_ones()).sum::<u32>(),
///             Row::Grey(levels) => levels.iter().map(|level| u32::from(*level < 128)).sum(),
///         };
///     }
///     Ok(count)
/// }
/// let bitmap = Bitmap::from_picture("##.\n..#\n")?;
/// assert_eq!(black(&mut BitmapRows::new(&bitmap))?, 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait RowSource {
    /// Number of columns, at most [`MAX_SIDE_PX`](crate::picture::MAX_SIDE_PX).
    fn width(&self) -> u32;

    /// Number of rows, at most [`MAX_SHEET_ROWS`].
    fn height(&self) -> u32;

    /// What all rows are.
    fn depth(&self) -> Depth;

    /// The next row; `None` behind the last one.
    ///
    /// # Errors
    /// [`DecodeError::DamagedRow`] where the file is damaged or cut off. The rows before are good; every
    /// further call gives the same error until the source is rewound.
    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError>;

    /// Starts again at the top.
    ///
    /// # Errors
    /// [`DecodeError`] when the file cannot be read again.
    fn rewind(&mut self) -> Result<(), DecodeError>;
}

/// The rows of a [`Bitmap`]: ink counts as black.
#[derive(Clone, Debug)]
pub struct BitmapRows<'a> {
    picture: &'a Bitmap,
    next: u32,
}

impl<'a> BitmapRows<'a> {
    /// Rows of the picture, from the top.
    #[must_use]
    pub const fn new(picture: &'a Bitmap) -> Self {
        Self { picture, next: 0 }
    }
}

impl RowSource for BitmapRows<'_> {
    fn width(&self) -> u32 {
        self.picture.width()
    }

    fn height(&self) -> u32 {
        self.picture.height()
    }

    fn depth(&self) -> Depth {
        Depth::Bits1
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        if self.next >= self.picture.height() {
            return Ok(None);
        }
        self.next += 1;
        Ok(Some(Row::Bits(self.picture.row(self.next - 1))))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        self.next = 0;
        Ok(())
    }
}

/// The rows of a [`Gray`].
#[derive(Clone, Debug)]
pub struct GrayRows {
    picture: Gray,
    next: u32,
}

impl GrayRows {
    /// Rows of the picture, from the top.
    #[must_use]
    pub const fn new(picture: Gray) -> Self {
        Self { picture, next: 0 }
    }

    /// The picture again.
    #[must_use]
    pub fn into_gray(self) -> Gray {
        self.picture
    }
}

impl RowSource for GrayRows {
    fn width(&self) -> u32 {
        self.picture.width()
    }

    fn height(&self) -> u32 {
        self.picture.height()
    }

    fn depth(&self) -> Depth {
        Depth::Grey8
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        if self.next >= self.picture.height() {
            return Ok(None);
        }
        let width = self.picture.width() as usize;
        let start = self.next as usize * width;
        self.next += 1;
        Ok(Some(Row::Grey(self.picture.pixels().get(start..start + width).unwrap_or(&[]))))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        self.next = 0;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_in_order_and_come_again() {
        let bitmap = Bitmap::from_picture("#..\n.#.\n").unwrap();
        let mut rows = BitmapRows::new(&bitmap);
        for _ in 0..2 {
            assert_eq!(rows.next_row(), Ok(Some(Row::Bits(&[1]))));
            assert_eq!(rows.next_row(), Ok(Some(Row::Bits(&[2]))));
            assert_eq!(rows.next_row(), Ok(None));
            assert_eq!(rows.next_row(), Ok(None));
            rows.rewind().unwrap();
        }
        let mut rows = GrayRows::new(Gray::new(2, 2, vec![1, 2, 3, 4]).unwrap());
        for _ in 0..2 {
            assert_eq!(rows.next_row(), Ok(Some(Row::Grey(&[1, 2]))));
            assert_eq!(rows.next_row(), Ok(Some(Row::Grey(&[3, 4]))));
            assert_eq!(rows.next_row(), Ok(None));
            rows.rewind().unwrap();
        }
    }

    #[test]
    fn rows_without_columns_are_rows() {
        let mut rows = GrayRows::new(Gray::new(0, 2, Vec::new()).unwrap());
        assert_eq!(rows.next_row(), Ok(Some(Row::Grey(&[]))));
        assert_eq!(rows.next_row(), Ok(Some(Row::Grey(&[]))));
        assert_eq!(rows.next_row(), Ok(None));
    }
}
