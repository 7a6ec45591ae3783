//! [`FileNotes`]: what a picture file says of itself, without its pixels.

use crate::picture::file_rows::read_notes;
use crate::picture::{DecodeError, Ground, Orientation, Resolution};
use core::fmt;
use std::io::{Read, Seek};

/// The format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FileFormat {
    /// Portable Network Graphics.
    Png,
    /// JPEG, with the header of JFIF, EXIF or none.
    Jpeg,
    /// Tag Image File Format, also with 64 bits.
    Tiff,
    /// WebP, lossy or lossless.
    WebP,
    /// Windows bitmap.
    Bmp,
    /// Graphics Interchange Format.
    Gif,
    /// PBM, PGM, PPM or PAM.
    Pnm,
}

impl fmt::Display for FileFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Tiff => "TIFF",
            Self::WebP => "WebP",
            Self::Bmp => "BMP",
            Self::Gif => "GIF",
            Self::Pnm => "PNM",
        })
    }
}

/// What a picture file says of itself, and what was made of it.
///
/// ```
/// # use plotter_vector::picture::{FileFormat, FileNotes};
/// # use std::io::Cursor;
/// let notes = FileNotes::read(Cursor::new(b"P4 10 2\n"), 1)?; // the rows are not looked at
/// assert_eq!((notes.format, notes.width_px, notes.height_px), (FileFormat::Pnm, 10, 2));
/// assert_eq!(notes.resolution, None); // this format knows none
/// # Ok::<(), plotter_vector::DecodeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FileNotes {
    /// The format, told from the bytes.
    pub format: FileFormat,
    /// Width of the upright picture, px.
    pub width_px: u32,
    /// Height of the upright picture, px.
    pub height_px: u32,
    /// How the stored picture was turned to be upright.
    pub orientation: Orientation,
    /// How large its pixels are, if the file says so; whether that can be believed tells
    /// [`Resolution::mm_per_px`].
    pub resolution: Option<Resolution>,
    /// The page that is read, 1 is the first.
    pub page: u32,
    /// Pages of the file: pictures of a TIFF that are no smaller copies of others.
    pub pages: u32,
    /// Whether it moves: then the first of its pictures is read.
    pub is_animated: bool,
    /// What a transparent picture was laid on; none where nothing can be transparent, and before the pixels
    /// have been read.
    pub ground: Option<Ground>,
}

impl FileNotes {
    pub(crate) fn new(format: FileFormat, (width, height): (u32, u32)) -> Self {
        Self {
            format,
            width_px: width,
            height_px: height,
            orientation: Orientation::UPRIGHT,
            resolution: None,
            page: 1,
            pages: 1,
            is_animated: false,
            ground: None,
        }
    }

    /// Turns what was noted of the stored picture.
    pub(crate) fn turned(mut self, orientation: Orientation) -> Self {
        self.orientation = orientation;
        (self.width_px, self.height_px) = orientation.turned_size((self.width_px, self.height_px));
        if let (true, Some(resolution)) = (orientation.swaps_sides(), &mut self.resolution) {
            resolution.px_per_mm.reverse();
        }
        self
    }

    /// Width and height of the picture as it is stored.
    pub(crate) fn stored_size(&self) -> (u32, u32) {
        self.orientation.turned_size((self.width_px, self.height_px))
    }

    /// Reads what stands before the pixels of a page, 1 is the first.
    ///
    /// # Errors
    /// [`DecodeError`]; as for [`FileRows::new`](crate::picture::FileRows::new), but what is damaged behind
    /// the header is not met.
    pub fn read(file: impl Read + Seek, page: u32) -> Result<Self, DecodeError> {
        read_notes(file, page)
    }
}
