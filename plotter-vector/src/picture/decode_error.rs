//! [`DecodeError`]: why a file is not a picture that can be traced.

use crate::picture::{MAX_SHEET_ROWS, MAX_SIDE_PX, SizeError};
use core::fmt;

/// Why a file is not a picture that can be traced.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DecodeError {
    /// The file cannot be opened or read.
    Unreadable {
        /// Message of the operating system.
        what: String,
    },
    /// No bytes at all.
    Empty,
    /// Not PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM.
    UnknownFormat {
        /// How the file begins.
        first_bytes: Vec<u8>,
    },
    /// A file of a kind that another program reads.
    ReadElsewhere(OtherFile),
    /// Fewer pictures in the file than were asked for.
    NoSuchPage {
        /// The page that was asked for, 1 is the first.
        page: u32,
        /// Pages of the file.
        pages: u32,
    },
    /// A picture of a kind that is not read.
    Unsupported {
        /// The kind of file.
        what: String,
    },
    /// Larger than a picture that is held whole may be.
    TooLarge(SizeError),
    /// Stored turned or mirrored, and larger than a picture that is held whole, which turning asks for.
    TurnedTooLarge(SizeError),
    /// More than [`MAX_SIDE_PX`] columns or [`MAX_SHEET_ROWS`] rows, which holds for reading by rows too.
    TooLong {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
    },
    /// Decoding it would take too much memory.
    TooMuchMemory {
        /// Memory that decoding needs at least, bytes.
        bytes: u64,
    },
    /// Damaged or cut off before the first row is known.
    Damaged {
        /// Length of the file, bytes.
        length: u64,
        /// Message of the decoder.
        what: String,
    },
    /// Damaged or cut off in a row; those above it have been read.
    DamagedRow {
        /// The row, 0 is the uppermost.
        row: u32,
        /// Rows of the picture.
        rows: u32,
        /// Message of the decoder.
        what: String,
    },
}

/// A kind of file that is no picture of pixels, or one that is read by other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum OtherFile {
    /// SVG: strokes already.
    Svg,
    /// HEIC, HEIF or AVIF, as telephones write them.
    Heif,
    /// PDF or PostScript.
    Pdf,
}

impl fmt::Display for OtherFile {
    /// The format, and a program that reads it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Svg => {
                "this is an SVG drawing, whose lines need not be traced: `convert` reads it, in a program `read_svg`"
            }
            Self::Heif => {
                "this is a HEIC or AVIF picture, which is not read: save it as JPEG or PNG, as with `heif-convert IN.heic OUT.jpg`"
            }
            Self::Pdf => {
                "this is a PDF or PostScript file, which is not read: take its lines with `pdftocairo -svg IN.pdf OUT.svg`, or of a \
                 scan its picture with `pdftoppm -png -r 300 IN.pdf OUT`"
            }
        })
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { what } => write!(f, "the picture cannot be read: {what}"),
            Self::Empty => f.write_str("the picture is empty (0 bytes): scan or save it again"),
            Self::UnknownFormat { first_bytes } => {
                f.write_str("the picture begins with")?;
                for byte in first_bytes {
                    write!(f, " {byte:02x}")?;
                }
                f.write_str(", which is not PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM: save it as one of these")
            }
            Self::ReadElsewhere(file) => file.fmt(f),
            Self::NoSuchPage { page: 0, .. } => f.write_str("pages are counted from 1: there is no page 0"),
            Self::NoSuchPage { page, pages: 1 } => {
                write!(f, "there is no page {page}: the file has one picture, page 1")
            }
            Self::NoSuchPage { page, pages } => {
                write!(
                    f,
                    "there is no page {page}: the file has {pages}, of which 1 to {pages} can be asked for"
                )
            }
            Self::Unsupported { what } => write!(
                f,
                "the picture is {what}, which is not read: save it as PNG of 8-bit grey, or black and white as TIFF \
                 of CCITT group 4"
            ),
            Self::TooLarge(error) => error.fmt(f),
            Self::TurnedTooLarge(error) => write!(
                f,
                "{error}; or save it upright: it is stored turned or mirrored, and only upright ones are read row by row"
            ),
            Self::TooLong { width, height } => write!(
                f,
                "a picture of {width} x {height} px is too large: at most {MAX_SIDE_PX} px wide and {MAX_SHEET_ROWS} px high; \
                 turn a wide one by 90 degrees, scan with fewer dots per inch, or cut it into sheets"
            ),
            Self::TooMuchMemory { bytes } => write!(
                f,
                "decoding the picture takes {} MiB or more, for this kind is decoded whole: save it as PNG of 8-bit \
                 grey without interlacing",
                bytes >> 20
            ),
            Self::Damaged { length, what } => {
                write!(f, "the picture ({length} bytes) is damaged or cut off: {what}; scan or save it again")
            }
            Self::DamagedRow { row: 0, rows, what } if *rows > 0 => write!(
                f,
                "the picture is damaged or cut off at row 1 of {rows}: {what}; no row of it is good, scan or save it again"
            ),
            Self::DamagedRow { row, rows, what } if row < rows => write!(
                f,
                "the picture is damaged or cut off at row {} of {rows}: {what}; the rows above are good, scan or save \
                 it again for the others",
                row + 1
            ),
            Self::DamagedRow { rows, what, .. } => write!(
                f,
                "the picture is damaged behind the last of its {rows} rows: {what}; check them, or scan or save it \
                 again"
            ),
        }
    }
}

impl core::error::Error for DecodeError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::TooLarge(error) | Self::TurnedTooLarge(error) => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_row_is_counted_from_one() {
        let error = DecodeError::DamagedRow { row: 0, rows: 7, what: "the file ends".into() };
        assert_eq!(
            error.to_string(),
            "the picture is damaged or cut off at row 1 of 7: the file ends; no row of it is good, scan or save it again"
        );
        let error = DecodeError::DamagedRow { row: 1, rows: 7, what: "the file ends".into() };
        assert_eq!(
            error.to_string(),
            "the picture is damaged or cut off at row 2 of 7: the file ends; the rows above are good, scan or save it \
             again for the others"
        );
        let error = DecodeError::DamagedRow { row: 7, rows: 7, what: "a wrong checksum".into() };
        assert!(error.to_string().starts_with("the picture is damaged behind the last of its 7 rows"));
    }
}
