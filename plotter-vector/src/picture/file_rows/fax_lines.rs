//! [`FaxLines`]: CCITT group 4 as bytes, row by row.

use fax::decoder::{DecodeError, DecodeStatus, Group4Decoder};
use std::io::{BufRead, Error, ErrorKind, Read, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// A block of CCITT group 4 as a reader of packed rows, the leftmost pixel in the highest bit; black is 1.
///
/// Behind the end mark all rows are white, for some writers leave white rows at the end out.
///
/// Source: ITU-T T.6 (11/88).
pub(super) struct FaxLines<B> {
    decoder: Option<Group4Decoder<Codes<B>>>,
    /// What the decoder may read for this row, bytes.
    budget: Arc<AtomicU32>,
    width: u32,
    row: Vec<u8>,
    /// Bytes of the row that have been given.
    given: usize,
}

/// The bytes of the block, as many of them for a row as the longest codes need: a row of endless codes would
/// take endless memory.
struct Codes<B> {
    file: B,
    budget: Arc<AtomicU32>,
}

impl<B: BufRead> Iterator for Codes<B> {
    type Item = Result<u8>;

    fn next(&mut self) -> Option<Self::Item> {
        let left = self.budget.load(Ordering::Relaxed);
        let Some(less) = left.checked_sub(1) else {
            return Some(Err(damaged("more codes than a row can have")));
        };
        self.budget.store(less, Ordering::Relaxed);
        match self.file.fill_buf() {
            Ok(bytes) => {
                let byte = *bytes.first()?;
                self.file.consume(1);
                Some(Ok(byte))
            }
            Err(error) => Some(Err(error)),
        }
    }
}

fn damaged(what: &str) -> Error {
    Error::new(ErrorKind::InvalidData, what)
}

impl<B> core::fmt::Debug for FaxLines<B> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("FaxLines").field("width", &self.width).finish_non_exhaustive()
    }
}

impl<B: BufRead> FaxLines<B> {
    /// The rows of a block `width` px wide.
    pub(super) fn new(file: B, width: u32) -> Result<Self> {
        let budget = Arc::new(AtomicU32::new(Self::budget(width)));
        let decoder = Group4Decoder::new(Codes { file, budget: Arc::clone(&budget) }, width)?;
        let row = vec![0; width.div_ceil(8) as usize];
        let given = row.len();
        Ok(Self { decoder: Some(decoder), budget, width, row, given })
    }

    /// Two runs of one pixel take 12 bits at worst, so a row never needs a byte a pixel; the rest is for end
    /// marks.
    fn budget(width: u32) -> u32 {
        width.saturating_add(1024)
    }

    fn next_row(&mut self) -> Result<()> {
        self.row.fill(0);
        self.given = 0;
        let Some(decoder) = &mut self.decoder else { return Ok(()) };
        self.budget.store(Self::budget(self.width), Ordering::Relaxed);
        match decoder.advance() {
            Ok(DecodeStatus::Incomplete) => {}
            Ok(DecodeStatus::End) => {
                self.decoder = None;
                return Ok(());
            }
            Err(DecodeError::Reader(error)) => return Err(error),
            Err(_) => return Err(damaged("it ends here, or has a code that CCITT group 4 has not")),
        }
        let edges = decoder.transition();
        // Edges that do not rise would make the decoder's search in the next row slow without bound.
        if edges.windows(2).any(|pair| matches!(pair, [left, right] if left >= right)) {
            return Err(damaged("runs of CCITT group 4 that go backwards"));
        }
        for run in edges.chunks(2) {
            let [from, to] = match *run {
                [from, to] => [from, to.min(self.width)],
                [from] => [from, self.width],
                _ => break,
            };
            blacken(&mut self.row, from, to);
        }
        Ok(())
    }
}

/// Sets the bits from `from` up to before `to`.
fn blacken(row: &mut [u8], from: u32, to: u32) {
    if from >= to {
        return;
    }
    let (first, last) = (from as usize / 8, (to - 1) as usize / 8);
    let left = 0xff_u8 >> (from % 8);
    let right = 0xff_u8 << (7 - (to - 1) % 8);
    match row.get_mut(first..=last) {
        Some([one]) => *one |= left & right,
        Some([start, middle @ .., end]) => {
            *start |= left;
            middle.fill(0xff);
            *end |= right;
        }
        _ => {}
    }
}

impl<B: BufRead> Read for FaxLines<B> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if self.given == self.row.len() {
            self.next_row()?;
        }
        let ready = self.row.get(self.given..).unwrap_or(&[]);
        let count = ready.len().min(buffer.len());
        buffer.iter_mut().zip(ready).for_each(|(to, from)| *to = *from);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fax::{Color, VecWriter, encoder::Encoder};

    /// Rows of bits, 1 black, as a block.
    fn encoded(rows: &[&[u8]], width: u32) -> Vec<u8> {
        let mut encoder = Encoder::new(VecWriter::new());
        for row in rows {
            let pixels = (0..width).map(|x| {
                if row[x as usize / 8] >> (7 - x % 8) & 1 == 1 { Color::Black } else { Color::White }
            });
            encoder.encode_line(pixels, width).unwrap();
        }
        encoder.finish().unwrap().finish()
    }

    #[test]
    fn rows_come_back_and_white_follows_the_end_mark() {
        let rows: [&[u8]; 4] = [&[0x80, 0x01], &[0xff, 0xff], &[0x00, 0x00], &[0x3c, 0x55]];
        let block = encoded(&rows, 16);
        let mut lines = FaxLines::new(&block[..], 16).unwrap();
        let mut read = [0xaa; 12];
        lines.read_exact(&mut read).unwrap();
        assert_eq!(read[..8], rows.concat());
        assert_eq!(read[8..], [0; 4]);
    }

    #[test]
    fn runs_are_filled_to_the_pixel() {
        let mut row = [0; 4];
        blacken(&mut row, 3, 5);
        blacken(&mut row, 15, 25);
        blacken(&mut row, 32, 40); // beyond: without effect
        blacken(&mut row, 9, 9);
        assert_eq!(row, [0b0001_1000, 0b0000_0001, 0xff, 0b1000_0000]);
    }

    #[test]
    fn a_block_cut_off_is_an_error_in_its_row() {
        let block = encoded(&[&[0x0f], &[0x33], &[0x55]], 8);
        let mut lines = FaxLines::new(&block[..2], 8).unwrap();
        let mut row = [0];
        lines.read_exact(&mut row).unwrap();
        assert_eq!(row, [0x0f]);
        assert!((0..2).any(|_| lines.read_exact(&mut row).is_err()));
    }

    #[test]
    fn a_row_of_endless_codes_is_refused() {
        // Horizontal mode, white 0, black 0 for ever: 001 00110101 0000110111.
        let code = "001001101010000110111";
        let bits: Vec<u8> = code.bytes().cycle().take(21 * 8 * 4000).map(|bit| bit - b'0').collect();
        let block: Vec<u8> =
            bits.chunks(8).map(|eight| eight.iter().fold(0, |byte, bit| byte << 1 | bit)).collect();
        let error = FaxLines::new(&block[..], 64).unwrap().read_exact(&mut [0; 8]).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
    }
}
