//! [`TiffRows`]: a TIFF by rows, from strips or tiles.

use super::codec::Codec;
use super::file_view::{FileView, fill};
use super::pixels::{Pixels, Sample};
use super::tiff_layout::{BlockSpan, Layout};
use super::{BUFFER_BYTES, Opened, Refused, one_line};
use std::io::{BufReader, Read, Result as IoResult, Seek, Take};

/// A block of the file as it is stored, the bits of each byte put right.
#[derive(Debug)]
struct Stored<R> {
    file: Take<FileView<R>>,
    reversed: bool,
}

impl<R: Read + Seek> Read for Stored<R> {
    fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
        let count = self.file.read(buffer)?;
        if self.reversed {
            buffer.iter_mut().take(count).for_each(|byte| *byte = byte.reverse_bits());
        }
        Ok(count)
    }
}

type Block<R> = Codec<BufReader<Stored<R>>>;

/// The rows of a TIFF.
#[derive(Debug)]
pub(super) struct TiffRows<R> {
    file: FileView<R>,
    layout: Layout,
    /// The strip that is being read.
    strip: Option<Block<R>>,
    /// Of strips a row; of tiles all rows of those side by side.
    band: Vec<u8>,
    /// Row that comes next.
    next: u32,
}

impl<R: Read + Seek> TiffRows<R> {
    /// Reads the tags.
    pub(super) fn open(file: &FileView<R>, page: u32) -> Result<Opened<Self>, Refused> {
        let (layout, notes) = Layout::read(file, page)?;
        let rows = if layout.tiled { layout.block_height as usize } else { 1 };
        let band = vec![0; layout.block_row_bytes() * layout.across * rows];
        let rows = Self { file: file.clone(), layout, strip: None, band, next: 0 };
        Ok(Opened { notes, rows: Some(rows) })
    }

    /// Reads the next row: its bytes and what they mean.
    pub(super) fn read(&mut self) -> Result<(&Pixels, &[u8]), String> {
        let row = self.next % self.layout.block_height;
        let place = (self.next / self.layout.block_height) as usize * self.layout.across;
        if self.layout.tiled {
            if row == 0 {
                self.read_band(place)?;
            }
        } else {
            if row == 0 {
                self.strip = Some(self.block(place)?);
            }
            let strip = self.strip.as_mut().ok_or("a strip is missing")?;
            fill(strip, &mut self.band)?;
            undo_differences(&self.layout, &mut self.band);
        }
        let row_bytes = self.layout.block_row_bytes() * self.layout.across;
        let start = if self.layout.tiled { row as usize * row_bytes } else { 0 };
        let bytes = self.band.get(start..start + row_bytes).unwrap_or(&[]);
        self.next += 1;
        Ok((&self.layout.pixels, bytes))
    }

    pub(super) fn pixels(&mut self) -> &mut Pixels {
        &mut self.layout.pixels
    }

    /// Opens a block.
    fn block(&self, number: usize) -> Result<Block<R>, String> {
        let BlockSpan { offset, length } =
            *self.layout.places.get(number).ok_or("a strip or tile is missing")?;
        let file = Stored { file: self.file.at(offset).take(length), reversed: self.layout.reversed };
        // Strips may be of a single row: a buffer longer than they are would read most of the file again and
        // again.
        let buffer = usize::try_from(length).unwrap_or(usize::MAX).clamp(1, BUFFER_BYTES);
        let file = BufReader::with_capacity(buffer, file);
        Codec::new(self.layout.compression, file, self.layout.block_width).map_err(|error| one_line(&error))
    }

    /// Reads the tiles side by side that begin with `first`.
    fn read_band(&mut self, first: usize) -> Result<(), String> {
        let bytes = self.layout.block_row_bytes();
        let rows = self.layout.block_height.min(self.layout.height - self.next) as usize;
        for column in 0..self.layout.across {
            let mut tile = self.block(first + column)?;
            for row in self.band.chunks_exact_mut((bytes * self.layout.across).max(1)).take(rows) {
                let part = row.get_mut(column * bytes..(column + 1) * bytes).unwrap_or(&mut []);
                fill(&mut tile, part)?;
                undo_differences(&self.layout, part);
            }
        }
        Ok(())
    }
}

/// Adds up the differences to the pixel on the left, sample by sample (TIFF 6.0, section 14).
fn undo_differences(layout: &Layout, row: &mut [u8]) {
    if !layout.differences {
        return;
    }
    let (sample, stride) = match layout.pixels {
        Pixels::Samples { sample, stride, .. } => (sample, stride),
        Pixels::Bits { .. } | Pixels::Table { .. } | Pixels::ClearTable { .. } => (Sample::Byte, 1),
    };
    match sample {
        Sample::Byte => add_up(row.as_chunks_mut::<1>().0, stride, |[sum], [step]| [sum.wrapping_add(step)]),
        Sample::BigEndian16 => add_up(row.as_chunks_mut::<2>().0, stride, |sum, step| {
            u16::from_be_bytes(sum).wrapping_add(u16::from_be_bytes(step)).to_be_bytes()
        }),
        Sample::LittleEndian16 => add_up(row.as_chunks_mut::<2>().0, stride, |sum, step| {
            u16::from_le_bytes(sum).wrapping_add(u16::from_le_bytes(step)).to_le_bytes()
        }),
    }
}

fn add_up<const N: usize>(samples: &mut [[u8; N]], stride: usize, sum: impl Fn([u8; N], [u8; N]) -> [u8; N]) {
    for index in stride..samples.len() {
        let left = samples.get(index - stride).copied();
        if let (Some(left), Some(here)) = (left, samples.get_mut(index)) {
            *here = sum(left, *here);
        }
    }
}
