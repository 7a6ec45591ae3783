//! [`Gray`]: a picture of 256 grey levels.

use crate::picture::{Pixel, SizeError};
use core::fmt;

/// A picture of 256 grey levels, 0 black to 255 white, row by row from the top.
///
/// Make one with [`Gray::new`], or with [`decode`](crate::picture::decode()) from a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gray {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

/// Why levels do not make a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GrayError {
    /// Larger than a picture may be.
    TooLarge(SizeError),
    /// Not one level a pixel.
    WrongCount {
        /// Width × height.
        expected: usize,
        /// Levels given.
        found: usize,
    },
}

impl fmt::Display for GrayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge(error) => error.fmt(f),
            Self::WrongCount { expected, found } => {
                write!(f, "{found} grey levels given where the size asks for {expected}: give one a pixel")
            }
        }
    }
}

impl core::error::Error for GrayError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::TooLarge(error) => Some(error),
            _ => None,
        }
    }
}

/// A grey picture of the crate `image`.
///
/// ```
/// # use plotter_vector::Gray;
/// let picture = image::GrayImage::from_pixel(3, 2, image::Luma([200]));
/// assert_eq!(Gray::try_from(picture)?.pixels(), [200; 6]);
/// # Ok::<(), plotter_vector::picture::GrayError>(())
/// ```
#[cfg(feature = "image")]
impl TryFrom<image::GrayImage> for Gray {
    type Error = GrayError;

    /// Refused is one that is larger than any picture here.
    fn try_from(picture: image::GrayImage) -> Result<Self, GrayError> {
        Self::new(picture.width(), picture.height(), picture.into_raw())
    }
}

impl Gray {
    /// A picture from its levels.
    ///
    /// # Errors
    /// [`GrayError::TooLarge`], or [`GrayError::WrongCount`] unless there is one level a pixel.
    ///
    /// ```
    /// # use plotter_vector::Gray;
    /// assert!(Gray::new(2, 2, vec![255, 0, 255, 255]).is_ok());
    /// assert!(Gray::new(2, 2, vec![255, 0, 255]).is_err());
    /// ```
    pub fn new(width: u32, height: u32, pixels: Vec<u8>) -> Result<Self, GrayError> {
        SizeError::check(width, height).map_err(GrayError::TooLarge)?;
        let expected = width as usize * height as usize;
        if pixels.len() != expected {
            return Err(GrayError::WrongCount { expected, found: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }

    /// A picture of a size that another picture has, from one level a pixel.
    pub(crate) fn of_checked_size(width: u32, height: u32, pixels: Vec<u8>) -> Self {
        debug_assert_eq!(pixels.len(), width as usize * height as usize, "one level a pixel");
        Self { width, height, pixels }
    }

    /// The levels of all pixels.
    pub(crate) fn into_pixels(self) -> Vec<u8> {
        self.pixels
    }

    /// Number of columns.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The levels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The level of a pixel; none outside the picture.
    #[must_use]
    pub fn get(&self, at: Pixel) -> Option<u8> {
        let inside = at.x < self.width && at.y < self.height;
        let index = at.y as usize * self.width as usize + at.x as usize;
        if inside { self.pixels.get(index).copied() } else { None }
    }

    /// The rows from the top.
    pub fn rows(&self) -> impl Iterator<Item = &[u8]> {
        // A picture without columns has no levels either; a chunk must not be empty.
        self.pixels.chunks(self.width.max(1) as usize)
    }
}

/// Level of a colour (red, green, blue, alpha: 0 clear to 255 solid) seen on white paper.
///
/// Luma by ITU-R BT.601, Y = 0.299 R + 0.587 G + 0.114 B, then Y·α + 255·(1 − α), to nearest.
///
/// ```
/// # use plotter_vector::picture::gray_on_white;
/// assert_eq!(gray_on_white([0, 0, 0, 255]), 0); // ink
/// assert_eq!(gray_on_white([0, 0, 0, 0]), 255); // clear: the paper is seen
/// assert_eq!(gray_on_white([255, 0, 0, 255]), 76); // red: 0.299 · 255
/// ```
#[must_use]
pub fn gray_on_white(colour: [u8; 4]) -> u8 {
    gray_on(u8::MAX, colour)
}

/// The same on paper of any level.
pub(crate) fn gray_on(paper: u8, [red, green, blue, alpha]: [u8; 4]) -> u8 {
    let (level, alpha) = (u32::from(luma([red, green, blue])), u32::from(alpha));
    let level = (level * alpha + u32::from(paper) * (255 - alpha) + 127) / 255;
    u8::try_from(level).unwrap_or(u8::MAX)
}

/// Luma by ITU-R BT.601, to nearest.
pub(crate) fn luma([red, green, blue]: [u8; 3]) -> u8 {
    let luma = (299 * u32::from(red) + 587 * u32::from(green) + 114 * u32::from(blue) + 500) / 1000;
    u8::try_from(luma).unwrap_or(u8::MAX)
}
