//! [`FileRows`]: a picture file by rows.
//!
//! ```text
//!   file ──► FileView ──► pnm | png | tiff ──► bytes of a row ──► Pixels ──► Row
//!                    └──► JPEG, interlaced PNG, PAM: decoded whole, then by rows
//! ```

mod codec;
mod fax_lines;
mod file_view;
mod pixels;
mod png_rows;
mod pnm_rows;
mod tiff_layout;
mod tiff_rows;

use crate::picture::decode::decode_whole;
use crate::picture::{
    Colour, DecodeError, Depth, GrayRows, MAX_SHEET_ROWS, MAX_SIDE_PX, Row, RowSource, SizeError,
};
use core::fmt;
use file_view::FileView;
use pixels::{Pixels, RowBuffer};
use png_rows::PngRows;
use pnm_rows::PnmRows;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use tiff_rows::TiffRows;

/// Longest file that is read whole, bytes: a JPEG or an interlaced PNG of that length is no drawing.
const MAX_WHOLE_BYTES: u64 = 1 << 28;

/// Read at once from the file, bytes.
const BUFFER_BYTES: usize = 1 << 16;

/// A picture file by rows: PNG, TIFF, PBM, PGM and PPM; the format is told from the bytes, not from a name.
///
/// Levels and bits are those of [`decode`](crate::picture::decode()): colours become luma, 16 bits become 8,
/// what is transparent shows white paper. Pictures of two values, black and white, come as [`Row::Bits`],
/// others as [`Row::Grey`]. At most [`MAX_SIDE_PX`] columns and [`MAX_SHEET_ROWS`] rows; how many pixels
/// there are in all does not matter.
///
/// Of TIFF the first picture is read: strips and tiles; uncompressed, `PackBits`, LZW, Deflate and CCITT
/// group 4; black and white, grey, palette and RGB. Memory is a few rows, whatever the file says, and 16 MiB
/// at most for a band of tiles. JPEG, interlaced PNG and PAM cannot be decoded by rows: they are decoded
/// whole, within the limits of [`decode`](crate::picture::decode()), and given by rows.
///
/// ```
/// # use plotter_vector::{FileRows, picture::{Depth, Row, RowSource}};
/// # use std::io::Cursor;
/// // PBM: the leftmost pixel in the highest bit.
/// let mut scan = FileRows::new(Cursor::new(b"P4 10 2\n\xc0\x40\x00\x80"))?;
/// assert_eq!((scan.width(), scan.height(), scan.depth()), (10, 2, Depth::Bits1));
/// assert_eq!(scan.next_row()?, Some(Row::Bits(&[0b10_0000_0011]))); // here: in the lowest
/// assert_eq!(scan.next_row()?, Some(Row::Bits(&[0b01_0000_0000])));
/// assert_eq!(scan.next_row()?, None);
/// scan.rewind()?;
/// assert_eq!(scan.next_row()?, Some(Row::Bits(&[0b10_0000_0011])));
/// # Ok::<(), plotter_vector::DecodeError>(())
/// ```
pub struct FileRows<R: Read + Seek> {
    file: FileView<R>,
    rows: Rows<R>,
    width: u32,
    height: u32,
    line: RowBuffer,
    /// Row that comes next.
    next: u32,
    /// Whether what follows the last row has been looked at.
    ended: bool,
    failed: Option<DecodeError>,
}

/// What reads the file: a reader for each format.
enum Rows<R: Read + Seek> {
    Pnm(PnmRows<BufReader<FileView<R>>>),
    Png(Box<PngRows<BufReader<FileView<R>>>>),
    Tiff(Box<TiffRows<R>>),
    Whole(GrayRows),
}

impl<R: Read + Seek> Rows<R> {
    /// Reads the next row of what is stored by rows: its bytes and what they mean.
    fn read(&mut self) -> Result<(&Pixels, &[u8]), String> {
        match self {
            Self::Pnm(rows) => rows.read(),
            Self::Png(rows) => rows.read(),
            Self::Tiff(rows) => rows.read(),
            Self::Whole(_) => Err("it has been decoded whole".into()),
        }
    }
}

impl<R: Read + Seek> fmt::Debug for FileRows<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { width, height, next, failed, .. } = self;
        f.debug_struct("FileRows")
            .field("width", width)
            .field("height", height)
            .field("depth", &self.line.depth())
            .field("next", next)
            .field("failed", failed)
            .finish_non_exhaustive()
    }
}

/// What a format's reader says when it opens a file.
enum Opened<T> {
    Rows {
        width: u32,
        height: u32,
        depth: Depth,
        rows: T,
    },
    /// This one is not stored by rows.
    NotByRows,
}

/// Why a file cannot be opened.
enum Refused {
    Unsupported(String),
    TooLong { width: u32, height: u32 },
    Damaged(String),
}

impl Refused {
    /// The size itself when it may be read by rows.
    fn check(width: u32, height: u32) -> Result<(), Self> {
        if width > MAX_SIDE_PX || height > MAX_SHEET_ROWS {
            Err(Self::TooLong { width, height })
        } else {
            Ok(())
        }
    }
}

/// A decoder's message on one line, whatever it holds.
pub(crate) fn one_line(message: &dyn fmt::Display) -> String {
    message.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

fn unreadable(error: &std::io::Error) -> DecodeError {
    DecodeError::Unreadable { what: one_line(error) }
}

impl FileRows<File> {
    /// Opens a file.
    ///
    /// # Errors
    /// [`DecodeError`]; as for [`FileRows::new`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, DecodeError> {
        Self::new(File::open(path).map_err(|error| unreadable(&error))?)
    }
}

impl<R: Read + Seek> FileRows<R> {
    /// Reads what stands before the first row. The file need not be buffered.
    ///
    /// # Errors
    /// [`DecodeError`] for what is no picture, or one of a kind or size that is not read.
    pub fn new(file: R) -> Result<Self, DecodeError> {
        Self::read_header(FileView::new(file))
    }

    fn read_header(file: FileView<R>) -> Result<Self, DecodeError> {
        let opened = open(&file)?;
        let (rows, width, height, depth) = match opened {
            Opened::Rows { width, height, depth, rows } => (rows, width, height, depth),
            Opened::NotByRows => {
                let rows = whole(file.clone(), file_length(&file)?)?;
                let (width, height) = (rows.width(), rows.height());
                (Rows::Whole(rows), width, height, Depth::Grey8)
            }
        };
        Refused::check(width, height).map_err(|_| DecodeError::TooLong { width, height })?;
        let line = RowBuffer::new(width, depth);
        Ok(Self { file, rows, width, height, line, next: 0, ended: false, failed: None })
    }

    /// The picture in memory.
    pub(crate) fn into_gray(mut self) -> Result<crate::picture::Gray, DecodeError> {
        if let Rows::Whole(rows) = self.rows {
            return Ok(rows.into_gray());
        }
        let (width, height) = (self.width, self.height);
        SizeError::check(width, height).map_err(DecodeError::TooLarge)?;
        // Taken as the rows come: a size alone, without rows, takes nothing.
        let mut levels = Vec::new();
        while let Some(row) = self.next_row()? {
            match row {
                Row::Grey(row) => levels.extend_from_slice(row),
                Row::Bits(words) => {
                    let mut left = width as usize;
                    for word in words {
                        let here = left.min(64);
                        levels.extend((0..here).map(|bit| if word >> bit & 1 == 1 { 0 } else { 255 }));
                        left -= here;
                    }
                }
            }
        }
        crate::picture::Gray::new(width, height, levels)
            .map_err(|error| DecodeError::Unsupported { what: one_line(&error) })
    }
}

/// The pixels in colour of a picture that is stored by rows; `None` for one that is not.
pub(crate) fn colour_by_rows(bytes: &[u8]) -> Result<Option<Colour>, DecodeError> {
    let opened = open(&FileView::new(Cursor::new(bytes)))?;
    let Opened::Rows { width, height, mut rows, .. } = opened else { return Ok(None) };
    SizeError::check(width, height).map_err(DecodeError::TooLarge)?;
    // Taken as the rows come: a size alone, without rows, takes nothing.
    let mut channels = Vec::new();
    let damaged = |row, what| DecodeError::DamagedRow { row, rows: height, what };
    for row in 0..height {
        let (pixels, bytes) = rows.read().map_err(|what| damaged(row, what))?;
        pixels.colours(bytes, width, &mut channels);
    }
    if let Rows::Png(rows) = &mut rows {
        rows.end().map_err(|what| damaged(height, what))?;
    }
    let picture = Colour::new(width, height, channels);
    picture.map(Some).map_err(|error| DecodeError::Unsupported { what: one_line(&error) })
}

/// A file that is not stored by rows.
fn whole<R: Read + Seek>(file: FileView<R>, length: u64) -> Result<GrayRows, DecodeError> {
    if length > MAX_WHOLE_BYTES {
        return Err(DecodeError::TooMuchMemory { bytes: length });
    }
    let mut bytes = Vec::new();
    file.take(MAX_WHOLE_BYTES).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    Ok(GrayRows::new(decode_whole(&bytes)?))
}

/// Reads what stands before the first row.
fn open<R: Read + Seek>(file: &FileView<R>) -> Result<Opened<Rows<R>>, DecodeError> {
    let mut first_bytes = Vec::new();
    file.clone().take(8).read_to_end(&mut first_bytes).map_err(|error| unreadable(&error))?;
    let buffered = BufReader::with_capacity(BUFFER_BYTES, file.clone());
    let opened = match first_bytes.as_slice() {
        [] => return Err(DecodeError::Empty),
        [b'P', b'1'..=b'6', ..] => PnmRows::open(buffered).map(|opened| opened.map(Rows::Pnm)),
        [0x89, b'P', b'N', b'G', ..] => {
            PngRows::open(buffered).map(|opened| opened.map(|rows| Rows::Png(Box::new(rows))))
        }
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => {
            TiffRows::open(file).map(|opened| opened.map(|rows| Rows::Tiff(Box::new(rows))))
        }
        [0xff, 0xd8, 0xff, ..] | [b'P', b'7', ..] => Ok(Opened::NotByRows),
        _ => return Err(DecodeError::UnknownFormat { first_bytes }),
    };
    let length = file_length(file)?;
    opened.map_err(|refused| match refused {
        Refused::Unsupported(what) => DecodeError::Unsupported { what },
        Refused::TooLong { width, height } => DecodeError::TooLong { width, height },
        Refused::Damaged(what) => DecodeError::Damaged { length, what },
    })
}

fn file_length<R: Read + Seek>(file: &FileView<R>) -> Result<u64, DecodeError> {
    file.clone().seek(SeekFrom::End(0)).map_err(|error| unreadable(&error))
}

impl<T> Opened<T> {
    fn map<U>(self, change: impl FnOnce(T) -> U) -> Opened<U> {
        match self {
            Self::Rows { width, height, depth, rows } => {
                Opened::Rows { width, height, depth, rows: change(rows) }
            }
            Self::NotByRows => Opened::NotByRows,
        }
    }
}

impl<R: Read + Seek> RowSource for FileRows<R> {
    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn depth(&self) -> Depth {
        self.line.depth()
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        let over = self.next >= self.height;
        let read = match &mut self.rows {
            Rows::Whole(rows) => return rows.next_row(),
            _ if over && self.ended => Ok(()),
            Rows::Png(rows) if over => rows.end(),
            _ if over => Ok(()),
            rows => rows.read().map(|(pixels, bytes)| pixels.read(bytes, self.width, &mut self.line)),
        };
        if let Err(what) = read {
            let error = DecodeError::DamagedRow { row: self.next, rows: self.height, what };
            self.failed = Some(error.clone());
            return Err(error);
        }
        if over {
            self.ended = true;
            return Ok(None);
        }
        self.next += 1;
        Ok(Some(self.line.row()))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        match &mut self.rows {
            Rows::Whole(rows) => rows.rewind(),
            // The headers are few bytes: reading them again costs less than code that remembers where rows
            // begin.
            _ => {
                let again = Self::read_header(self.file.at(0))?;
                if (again.width, again.height, again.depth()) != (self.width, self.height, self.depth()) {
                    return Err(DecodeError::Unreadable { what: "the file has changed meanwhile".into() });
                }
                *self = again;
                Ok(())
            }
        }
    }
}
