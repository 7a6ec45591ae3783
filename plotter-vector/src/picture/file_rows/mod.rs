//! [`FileRows`]: a picture file by rows.
//!
//! ```text
//!   file ──► FileView ──► pnm | png | tiff ──► bytes of a row ──► Pixels ──► Row
//!                    │                                                 └──► turned, if stored so ──► Row
//!                    └──► JPEG, WebP, BMP, GIF, interlaced PNG, PAM: decoded whole, turned, then by rows
//! ```

mod codec;
mod fax_lines;
mod file_view;
mod metadata;
mod pixels;
mod png_rows;
mod pnm_rows;
mod tiff_layout;
mod tiff_rows;

use crate::picture::decode::{colours_of_whole, decode_whole, size_of_whole};
use crate::picture::ground::{Ground, GroundSurvey};
use crate::picture::{
    Bitmap, Colour, DecodeError, Depth, FileFormat, FileNotes, Gray, MAX_SHEET_ROWS, MAX_SIDE_PX, OtherFile,
    Row, RowSource, SizeError,
};
use core::fmt;
use file_view::FileView;
use metadata::whole_notes;
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
/// what is transparent shows a [`Ground`]. Pictures of two values, black and white, come as [`Row::Bits`],
/// others as [`Row::Grey`]. At most [`MAX_SIDE_PX`] columns and [`MAX_SHEET_ROWS`] rows; how many pixels
/// there are in all does not matter.
///
/// Of TIFF strips and tiles are read; uncompressed, `PackBits`, LZW, Deflate and CCITT group 4; black and
/// white, grey, palette and RGB. Memory is a few rows, whatever the file says, and 16 MiB at most for a band
/// of tiles. JPEG, WebP, BMP, GIF, interlaced PNG and PAM cannot be decoded by rows: they are decoded whole,
/// within the limits of [`decode`](crate::picture::decode()), and given by rows. So is what is stored turned
/// or mirrored: it comes upright. What a transparent picture lies on is found in a pass of its own.
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
    notes: FileNotes,
    line: RowBuffer,
    /// Row that comes next.
    next: u32,
    /// Whether what follows the last row has been looked at.
    ended: bool,
    failed: Option<DecodeError>,
}

/// What reads the file: a reader for each format, or what is held of it.
enum Rows<R: Read + Seek> {
    Pnm(PnmRows<BufReader<FileView<R>>>),
    Png(Box<PngRows<BufReader<FileView<R>>>>),
    Tiff(Box<TiffRows<R>>),
    Grey(Gray),
    Bits(Bitmap),
}

impl<R: Read + Seek> Rows<R> {
    /// Reads the next row of what is stored by rows: its bytes and what they mean.
    fn read(&mut self) -> Result<(&Pixels, &[u8]), String> {
        match self {
            Self::Pnm(rows) => rows.read(),
            Self::Png(rows) => rows.read(),
            Self::Tiff(rows) => rows.read(),
            Self::Grey(_) | Self::Bits(_) => Err("it has been decoded whole".into()),
        }
    }

    /// What the bytes mean of what is stored by rows.
    fn pixels(&mut self) -> Option<&mut Pixels> {
        match self {
            Self::Pnm(rows) => Some(rows.pixels()),
            Self::Png(rows) => Some(rows.pixels()),
            Self::Tiff(rows) => Some(rows.pixels()),
            Self::Grey(_) | Self::Bits(_) => None,
        }
    }

    /// Looks at what stands behind the last row.
    fn end(&mut self) -> Result<(), String> {
        if let Self::Png(rows) = self { rows.end() } else { Ok(()) }
    }

    fn depth(&mut self) -> Depth {
        match self {
            Self::Grey(_) => Depth::Grey8,
            Self::Bits(_) => Depth::Bits1,
            by_rows => by_rows.pixels().map_or(Depth::Grey8, |pixels| pixels.depth()),
        }
    }
}

impl<R: Read + Seek> fmt::Debug for FileRows<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { notes, next, failed, .. } = self;
        f.debug_struct("FileRows")
            .field("notes", notes)
            .field("depth", &self.line.depth())
            .field("next", next)
            .field("failed", failed)
            .finish_non_exhaustive()
    }
}

/// What a format's reader says when it opens a file.
struct Opened<T> {
    notes: FileNotes,
    /// None where it is not stored by rows.
    rows: Option<T>,
}

/// A file with its header read.
enum Contents<R: Read + Seek> {
    ByRows(Rows<R>),
    Whole(Vec<u8>),
}

/// Why a file cannot be opened.
enum Refused {
    Unsupported(String),
    TooLong { width: u32, height: u32 },
    NoSuchPage { page: u32, pages: u32 },
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
    /// Reads what stands before the first row of the first page. The file need not be buffered.
    ///
    /// # Errors
    /// [`DecodeError`] for what is no picture, or one of a kind or size that is not read.
    pub fn new(file: R) -> Result<Self, DecodeError> {
        Self::of_page(file, 1)
    }

    /// The same of a page, 1 is the first: of a TIFF with several pictures.
    ///
    /// # Errors
    /// [`DecodeError::NoSuchPage`], and as for [`new`](Self::new).
    pub fn of_page(file: R, page: u32) -> Result<Self, DecodeError> {
        Self::read_header(FileView::new(file), page, None)
    }

    /// Metadata of the file.
    pub const fn notes(&self) -> &FileNotes {
        &self.notes
    }

    /// Opens it; `known` is what it is laid on, if that has been found before.
    fn read_header(file: FileView<R>, page: u32, known: Option<Ground>) -> Result<Self, DecodeError> {
        let (mut notes, contents) = open(&file, page)?;
        let size = notes.stored_size();
        let rows = match contents {
            Contents::Whole(bytes) => {
                let (levels, ground) = decode_whole(&bytes, notes.format, size)?;
                notes.ground = ground;
                let levels = notes.orientation.turned(levels, size);
                // A size that is refused has been refused before the pixels were decoded.
                Rows::Grey(Gray::of_checked_size(notes.width_px, notes.height_px, levels))
            }
            Contents::ByRows(rows) => {
                let (mut rows, ground) = laid_on_ground(&file, page, rows, size, known)?;
                notes.ground = ground;
                if notes.orientation.is_upright() { rows } else { turned(&mut rows, &notes)? }
            }
        };
        Refused::check(notes.width_px, notes.height_px)
            .map_err(|_| DecodeError::TooLong { width: notes.width_px, height: notes.height_px })?;
        let mut rows = rows;
        let line = match rows.depth() {
            // What is held needs no row beside it.
            depth if rows.pixels().is_none() => RowBuffer::new(0, depth),
            depth => RowBuffer::new(notes.width_px, depth),
        };
        Ok(Self { file, rows, notes, line, next: 0, ended: false, failed: None })
    }

    /// The picture in memory.
    ///
    /// # Errors
    /// [`DecodeError`]: larger than a picture that is held, or damaged.
    pub fn into_gray(mut self) -> Result<Gray, DecodeError> {
        if let Rows::Grey(gray) = self.rows {
            return Ok(gray);
        }
        let (width, height) = (self.width(), self.height());
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
        Gray::new(width, height, levels).map_err(|error| DecodeError::Unsupported { what: one_line(&error) })
    }
}

/// What a page says of itself.
pub(crate) fn read_notes<R: Read + Seek>(file: R, page: u32) -> Result<FileNotes, DecodeError> {
    open(&FileView::new(file), page).map(|(notes, _)| notes)
}

/// The pixels of a page in colour.
pub(crate) fn colours(bytes: &[u8], page: u32) -> Result<(Colour, FileNotes), DecodeError> {
    let file = FileView::new(Cursor::new(bytes));
    let (mut notes, contents) = open(&file, page)?;
    let size = notes.stored_size();
    let (channels, ground) = match contents {
        Contents::Whole(bytes) => colours_of_whole(&bytes, notes.format, size)?,
        Contents::ByRows(rows) => {
            SizeError::check(size.0, size.1).map_err(DecodeError::TooLarge)?;
            let (mut rows, ground) = laid_on_ground(&file, page, rows, size, None)?;
            // Taken as the rows come: a size alone, without rows, takes nothing.
            let mut pixels = Vec::new();
            let damaged = |row, what| DecodeError::DamagedRow { row, rows: size.1, what };
            for row in 0..size.1 {
                let (meaning, bytes) = rows.read().map_err(|what| damaged(row, what))?;
                meaning.colours(bytes, size.0, ground.unwrap_or_default(), &mut pixels);
            }
            rows.end().map_err(|what| damaged(size.1, what))?;
            (pixels.into_flattened(), ground)
        }
    };
    notes.ground = ground;
    let channels = if notes.orientation.is_upright() {
        channels
    } else {
        notes.orientation.turned(channels.as_chunks::<3>().0.to_vec(), size).into_flattened()
    };
    let picture = Colour::new(notes.width_px, notes.height_px, channels);
    let picture = picture.map_err(|error| DecodeError::Unsupported { what: one_line(&error) })?;
    Ok((picture, notes))
}

/// The rows with what is transparent laid on the ground that is known, or else found; with none where nothing
/// can be transparent.
fn laid_on_ground<R: Read + Seek>(
    file: &FileView<R>,
    page: u32,
    mut rows: Rows<R>,
    (width, height): (u32, u32),
    known: Option<Ground>,
) -> Result<(Rows<R>, Option<Ground>), DecodeError> {
    if !rows.pixels().is_some_and(|pixels| pixels.may_be_clear()) {
        return Ok((rows, None));
    }
    let ground = match known {
        Some(known) => known,
        None => {
            let mut survey = GroundSurvey::new(width, height);
            // A row that is damaged is told when it is read again.
            for _ in 0..height {
                let Ok((pixels, bytes)) = rows.read() else { break };
                pixels.survey(bytes, width, &mut survey);
                if survey.is_decided() {
                    break;
                }
            }
            let (_, Contents::ByRows(again)) = open(file, page)? else {
                return Err(DecodeError::Unreadable { what: "the file has changed meanwhile".into() });
            };
            rows = again;
            survey.ground()
        }
    };
    if let Some(pixels) = rows.pixels() {
        pixels.lay_on(ground);
    }
    Ok((rows, Some(ground)))
}

/// All rows of a picture that is stored turned or mirrored, upright: bits stay bits.
fn turned<R: Read + Seek>(rows: &mut Rows<R>, notes: &FileNotes) -> Result<Rows<R>, DecodeError> {
    let (width, height) = notes.stored_size();
    SizeError::check(width, height).map_err(DecodeError::TurnedTooLarge)?;
    let depth = rows.depth();
    let mut line = RowBuffer::new(width, depth);
    let (mut words, mut levels) = (Vec::new(), Vec::new());
    let damaged = |row, what| DecodeError::DamagedRow { row, rows: height, what };
    // Taken as the rows come: a size alone, without rows, takes nothing.
    for row in 0..height {
        let (pixels, bytes) = rows.read().map_err(|what| damaged(row, what))?;
        pixels.read(bytes, width, notes.ground.unwrap_or_default(), &mut line);
        match line.row() {
            Row::Bits(row) => words.extend_from_slice(row),
            Row::Grey(row) => levels.extend_from_slice(row),
        }
    }
    rows.end().map_err(|what| damaged(height, what))?;
    Ok(match depth {
        Depth::Bits1 => Rows::Bits(notes.orientation.turned_bits(&Bitmap::of_words(width, height, words))),
        Depth::Grey8 => {
            let levels = notes.orientation.turned(levels, (width, height));
            Rows::Grey(Gray::of_checked_size(notes.width_px, notes.height_px, levels))
        }
    })
}

/// All bytes of a file that is not stored by rows.
fn whole_file<R: Read + Seek>(file: &FileView<R>, length: u64) -> Result<Vec<u8>, DecodeError> {
    if length > MAX_WHOLE_BYTES {
        return Err(DecodeError::TooMuchMemory { bytes: length });
    }
    let mut bytes = Vec::new();
    file.clone().take(MAX_WHOLE_BYTES).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    Ok(bytes)
}

/// Reads what stands before the first row of a page.
fn open<R: Read + Seek>(file: &FileView<R>, page: u32) -> Result<(FileNotes, Contents<R>), DecodeError> {
    /// As many bytes as tell the kinds of XML apart.
    const HEAD_BYTES: u64 = 1024;
    const SHOWN_BYTES: usize = 8;
    let mut head = Vec::new();
    file.clone().take(HEAD_BYTES).read_to_end(&mut head).map_err(|error| unreadable(&error))?;
    let buffered = || BufReader::with_capacity(BUFFER_BYTES, file.clone());
    let length = file_length(file)?;
    let opened = match head.as_slice() {
        [] => return Err(DecodeError::Empty),
        [b'P', b'1'..=b'6', ..] => PnmRows::open(buffered()).map(|opened| opened.map(Rows::Pnm)),
        [0x89, b'P', b'N', b'G', ..] => {
            PngRows::open(buffered()).map(|opened| opened.map(|rows| Rows::Png(Box::new(rows))))
        }
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => {
            TiffRows::open(file, page).map(|opened| opened.map(|rows| Rows::Tiff(Box::new(rows))))
        }
        other => {
            let format = match other {
                [0xff, 0xd8, 0xff, ..] => FileFormat::Jpeg,
                [b'P', b'7', ..] => FileFormat::Pnm,
                [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => FileFormat::WebP,
                [b'B', b'M', ..] => FileFormat::Bmp,
                [b'G', b'I', b'F', b'8', b'7' | b'9', b'a', ..] => FileFormat::Gif,
                _ => {
                    return Err(other_file(&head).map_or_else(
                        || DecodeError::UnknownFormat {
                            first_bytes: head.iter().copied().take(SHOWN_BYTES).collect(),
                        },
                        DecodeError::ReadElsewhere,
                    ));
                }
            };
            let bytes = whole_file(file, length)?;
            let notes = whole_notes(&bytes, format, size_of_whole(&bytes, format)?);
            check_page(page, &notes)?;
            return Ok((notes, Contents::Whole(bytes)));
        }
    };
    let opened = opened.map_err(|refused| match refused {
        Refused::Unsupported(what) => DecodeError::Unsupported { what },
        Refused::TooLong { width, height } => DecodeError::TooLong { width, height },
        Refused::NoSuchPage { page, pages } => DecodeError::NoSuchPage { page, pages },
        Refused::Damaged(what) => DecodeError::Damaged { length, what },
    })?;
    check_page(page, &opened.notes)?;
    let contents = match opened.rows {
        Some(rows) => Contents::ByRows(rows),
        None => {
            let bytes = whole_file(file, length)?;
            // Its size is checked as that of what is held.
            size_of_whole(&bytes, opened.notes.format)?;
            Contents::Whole(bytes)
        }
    };
    Ok((opened.notes, contents))
}

fn check_page(page: u32, notes: &FileNotes) -> Result<(), DecodeError> {
    let pages = notes.pages;
    if (1..=pages).contains(&page) { Ok(()) } else { Err(DecodeError::NoSuchPage { page, pages }) }
}

/// A file that is no picture but is known, by how it begins.
fn other_file(head: &[u8]) -> Option<OtherFile> {
    let is_heif = |brand: &[u8]| {
        matches!(
            brand,
            b"heic" | b"heix" | b"hevc" | b"heim" | b"heis" | b"mif1" | b"msf1" | b"avif" | b"avis"
        )
    };
    if head.get(4..8) == Some(b"ftyp") && head.get(8..12).is_some_and(is_heif) {
        return Some(OtherFile::Heif);
    }
    if head.starts_with(b"%PDF-") || head.starts_with(b"%!PS") {
        return Some(OtherFile::Pdf);
    }
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let is_xml =
        [&b"<svg"[..], b"<?xml", b"<!--", b"<!DOCTYPE svg"].iter().any(|start| text.starts_with(start));
    (is_xml && text.windows(4).any(|part| part == b"<svg" || part == b" svg")).then_some(OtherFile::Svg)
}

fn file_length<R: Read + Seek>(file: &FileView<R>) -> Result<u64, DecodeError> {
    file.clone().seek(SeekFrom::End(0)).map_err(|error| unreadable(&error))
}

impl<T> Opened<T> {
    fn map<U>(self, change: impl FnOnce(T) -> U) -> Opened<U> {
        Opened { notes: self.notes, rows: self.rows.map(change) }
    }
}

impl<R: Read + Seek> RowSource for FileRows<R> {
    fn width(&self) -> u32 {
        self.notes.width_px
    }

    fn height(&self) -> u32 {
        self.notes.height_px
    }

    fn depth(&self) -> Depth {
        self.line.depth()
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        let (width, height) = (self.notes.width_px, self.notes.height_px);
        let over = self.next >= height;
        let read = match &mut self.rows {
            Rows::Grey(_) | Rows::Bits(_) => Ok(()),
            _ if over && self.ended => Ok(()),
            rows if over => rows.end(),
            rows => rows.read().map(|(pixels, bytes)| {
                pixels.read(bytes, width, self.notes.ground.unwrap_or_default(), &mut self.line);
            }),
        };
        if let Err(what) = read {
            let error = DecodeError::DamagedRow { row: self.next, rows: height, what };
            self.failed = Some(error.clone());
            return Err(error);
        }
        if over {
            self.ended = true;
            return Ok(None);
        }
        let row = self.next;
        self.next += 1;
        Ok(Some(match &self.rows {
            Rows::Grey(gray) => {
                let start = row as usize * width as usize;
                Row::Grey(gray.pixels().get(start..start + width as usize).unwrap_or(&[]))
            }
            Rows::Bits(bits) => Row::Bits(bits.row(row)),
            _ => self.line.row(),
        }))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        if self.rows.pixels().is_none() {
            self.next = 0;
            return Ok(());
        }
        // The headers are few bytes: reading them again costs less than code that remembers where rows begin.
        let again = Self::read_header(self.file.at(0), self.notes.page, self.notes.ground)?;
        let size = |rows: &Self| (rows.width(), rows.height(), rows.depth());
        if size(&again) != size(self) {
            return Err(DecodeError::Unreadable { what: "the file has changed meanwhile".into() });
        }
        *self = again;
        Ok(())
    }
}
