//! [`FileNotes`]: the metadata of a picture file, read without its pixels.

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

/// Metadata of a picture file: format, size, orientation, resolution and pages.
///
/// ```
/// # use plotter_vector::picture::{FileFormat, FileNotes};
/// # use std::io::Cursor;
/// let notes = FileNotes::read(Cursor::new(b"P4 10 2\n"), 1)?; // the rows are not read
/// assert_eq!((notes.format, notes.width_px, notes.height_px), (FileFormat::Pnm, 10, 2));
/// assert_eq!(notes.resolution, None); // this format has none
/// # Ok::<(), plotter_vector::DecodeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FileNotes {
    /// The format, recognized by the first bytes.
    pub format: FileFormat,
    /// Width of the upright picture, px.
    pub width_px: u32,
    /// Height of the upright picture, px.
    pub height_px: u32,
    /// How the stored picture is turned or mirrored to be upright.
    pub orientation: Orientation,
    /// Resolution, if the file states one; [`Resolution::mm_per_px`] tells whether it is plausible.
    pub resolution: Option<Resolution>,
    /// Number of the page that is read, from 1.
    pub page: u32,
    /// Number of pages: pictures of a TIFF, without smaller copies of others.
    pub pages: u32,
    /// Whether the file is an animation, of which the first picture is read.
    pub is_animated: bool,
    /// Background on which a transparent picture was laid; `None` if nothing can be transparent, and before
    /// the pixels have been read.
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

    /// Turns size and resolution of the stored picture.
    pub(crate) fn with_orientation(mut self, orientation: Orientation) -> Self {
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

    /// Reads the metadata of a page, from 1, up to its pixels.
    ///
    /// # Errors
    /// [`DecodeError`], as for [`FileRows::new`](crate::picture::FileRows::new); damage behind the header is
    /// not noticed.
    pub fn read(file: impl Read + Seek, page: u32) -> Result<Self, DecodeError> {
        read_notes(file, page)
    }
}
