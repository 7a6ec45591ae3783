//! [`SheetLimits`]: a sheet that is noise is refused before it takes more memory than a drawing.
//!
//! What a band takes grows with its lines' pixels, what stays of the sheet with its strokes; of either there
//! is a limit. Both are counted in rows of the sheet, so that what is refused depends on neither bands nor
//! threads.

use super::SheetError;
use crate::stroke::Curve;

/// Rows in which the pixels of lines are counted together, from each multiple of it to the next.
const ROWS: u32 = 256;

/// Most pixels of centrelines in so many rows of a sheet: 2²⁰, as if upright lines stood 4096 to a row. Noise
/// takes some 250 bytes a pixel of them in a band, straight lines 80.
pub const MAX_LINE_PIXELS: u64 = 1 << 20;

/// Most strokes of a sheet: 2²⁰, of which each takes some 700 bytes while they are ordered. A pen that lifts
/// five times a second draws them in two and a half days.
pub const MAX_SHEET_STROKES: u64 = 1 << 20;

/// Pixels of the centrelines of some rows beyond which bands are worked on one by one.
const DENSE_PIXELS: u64 = 1 << 20;

/// Rows below its lowest vertex in which a stroke may still have come together.
const SETTLED_ROWS: u32 = 512;

/// What of a sheet has been counted.
#[derive(Debug, Default)]
pub(super) struct SheetLimits {
    /// Pixels of centrelines in the last rows that are counted together.
    pixels: u64,
    /// Strokes that end in each of the rows that are counted together.
    strokes: Vec<u64>,
    /// How many of these are known, and their strokes.
    settled: usize,
    sum: u64,
}

/// Pixels of ink in some words.
pub(super) fn ink_of(words: &[u64]) -> u64 {
    words.iter().map(|bits| u64::from(bits.count_ones())).sum()
}

/// Whether rows with so many pixels of centrelines are worked on one by one.
pub(super) fn is_dense(pixels: u64) -> bool {
    pixels > DENSE_PIXELS
}

impl SheetLimits {
    /// The next row of centrelines, row `y` of the sheet.
    pub(super) fn push(&mut self, y: u32, centrelines: &[u64]) -> Result<(), SheetError> {
        let first_row = y / ROWS * ROWS;
        if y == first_row {
            self.pixels = 0;
        }
        self.pixels += ink_of(centrelines);
        if self.pixels > MAX_LINE_PIXELS {
            return Err(SheetError::TooManyLines { rows: [first_row, first_row.saturating_add(ROWS - 1)] });
        }
        Ok(())
    }

    /// Strokes that have been found.
    pub(super) fn add(&mut self, strokes: &[Curve]) {
        for stroke in strokes {
            let lowest = stroke.vertices.iter().map(|at| at.y).fold(0.0, f64::max);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a row of the sheet, or one near it"
            )]
            let part = (lowest as u32 / ROWS) as usize;
            if self.strokes.len() <= part {
                self.strokes.resize(part + 1, 0);
            }
            self.strokes.iter_mut().skip(part).take(1).for_each(|count| *count += 1);
        }
    }

    /// Refuses too many strokes, now that all that end well above row `end` are found.
    pub(super) fn check(&mut self, end: u32) -> Result<(), SheetError> {
        let settled = (end.saturating_sub(SETTLED_ROWS) / ROWS) as usize;
        while self.settled < settled.min(self.strokes.len()) {
            self.sum += self.strokes.get(self.settled).copied().unwrap_or(0);
            self.settled += 1;
            if self.sum > MAX_SHEET_STROKES {
                let rows = u32::try_from(self.settled).unwrap_or(u32::MAX).saturating_mul(ROWS);
                return Err(SheetError::TooManyStrokes { last_row: rows - 1 });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::PxPoint;

    #[test]
    fn lines_are_counted_in_256_rows() {
        let mut limits = SheetLimits::default();
        let row = [u64::MAX; 64];
        // 4096 px a row.
        (0..512).for_each(|y| assert_eq!(limits.push(y, &row), Ok(())));
        (512..767).for_each(|y| assert_eq!(limits.push(y, &row), Ok(())));
        let error = limits.push(767, &[u64::MAX; 65]).unwrap_err();
        assert_eq!(error, SheetError::TooManyLines { rows: [512, 767] });
    }

    #[test]
    fn strokes_are_counted_by_where_they_end_whatever_comes_first() {
        let stroke = |y: f64| Curve::from(vec![PxPoint::new(1.0, y), PxPoint::new(1.0, y - 9.0)]);
        let mut limits = SheetLimits::default();
        limits.add(&[stroke(700.0), stroke(20.0), stroke(300.0), stroke(1e5)]);
        assert_eq!(limits.strokes[..3], [1, 1, 1]);
        limits.strokes[1] = MAX_SHEET_STROKES;
        assert_eq!(limits.check(512 + 511), Ok(()));
        assert_eq!(limits.check(512 + 512), Err(SheetError::TooManyStrokes { last_row: 511 }));
    }
}
