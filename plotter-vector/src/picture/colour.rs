//! [`Colour`]: a picture of three channels.

use crate::picture::{Gray, Rgb, SizeError, gray_on_white};
use core::fmt;

/// A picture in colour: red, green and blue of 0..=255 a pixel, encoded as sRGB, row by row from the top.
///
/// Make one with [`Colour::new`], from a [`Gray`], or with [`decode_colour`](crate::picture::decode_colour())
/// from a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Colour {
    width: u32,
    height: u32,
    /// Three bytes a pixel.
    channels: Vec<u8>,
}

/// Why channels do not make a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ColourError {
    /// Larger than a picture may be.
    TooLarge(SizeError),
    /// Not three channels a pixel.
    WrongCount {
        /// Width × height × 3.
        expected: usize,
        /// Channels given.
        found: usize,
    },
}

impl fmt::Display for ColourError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge(error) => error.fmt(f),
            Self::WrongCount { expected, found } => {
                write!(f, "{found} channels given where the size asks for {expected}: give three a pixel")
            }
        }
    }
}

impl core::error::Error for ColourError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::TooLarge(error) => Some(error),
            _ => None,
        }
    }
}

impl Colour {
    /// A picture from its channels: red, green, blue of the first pixel, then of the one right of it.
    ///
    /// # Errors
    /// [`ColourError::TooLarge`], or [`ColourError::WrongCount`] unless there are three channels a pixel.
    ///
    /// ```
    /// # use plotter_vector::Colour;
    /// assert!(Colour::new(2, 1, vec![255, 0, 0, 255, 255, 255]).is_ok());
    /// assert!(Colour::new(2, 1, vec![255, 0, 0]).is_err());
    /// ```
    pub fn new(width: u32, height: u32, channels: Vec<u8>) -> Result<Self, ColourError> {
        SizeError::check(width, height).map_err(ColourError::TooLarge)?;
        // At most 3 · 2²⁸.
        let expected = 3 * width as usize * height as usize;
        if channels.len() != expected {
            return Err(ColourError::WrongCount { expected, found: channels.len() });
        }
        Ok(Self { width, height, channels })
    }

    /// A picture of a size that another picture could have, from three channels a pixel.
    pub(crate) fn of_checked_size(width: u32, height: u32, channels: Vec<u8>) -> Self {
        debug_assert_eq!(channels.len(), 3 * width as usize * height as usize, "three channels a pixel");
        Self { width, height, channels }
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

    /// The pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        self.channels.as_chunks().0
    }

    /// The rows from the top.
    pub fn rows(&self) -> impl Iterator<Item = &[[u8; 3]]> {
        // A picture without columns has no pixels either; a chunk must not be empty.
        self.pixels().chunks(self.width.max(1) as usize)
    }

    /// One pixel; `None` outside the picture.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> Option<Rgb> {
        let inside = x < self.width && y < self.height;
        let index = y as usize * self.width as usize + x as usize;
        self.pixels().get(index).filter(|_| inside).copied().map(Rgb)
    }
}

impl From<&Gray> for Colour {
    /// The same picture with three equal channels.
    fn from(gray: &Gray) -> Self {
        let channels = gray.pixels().iter().flat_map(|level| [*level; 3]).collect();
        Self { width: gray.width(), height: gray.height(), channels }
    }
}

impl From<&Colour> for Gray {
    /// The luma, as [`gray_on_white`] has it.
    fn from(colour: &Colour) -> Self {
        let luma = |[red, green, blue]: &[u8; 3]| gray_on_white([*red, *green, *blue, u8::MAX]);
        Gray::of_checked_size(colour.width, colour.height, colour.pixels().iter().map(luma).collect())
    }
}

/// A colour (red, green, blue, alpha: 0 clear to 255 solid) seen on white paper: c·α + 255·(1 − α), to
/// nearest.
///
/// ```
/// # use plotter_vector::{Rgb, picture::colour_on_white};
/// assert_eq!(colour_on_white([200, 0, 0, 255]), Rgb([200, 0, 0]));
/// assert_eq!(colour_on_white([200, 0, 0, 0]), Rgb::WHITE); // clear: the paper is seen
/// assert_eq!(colour_on_white([255, 0, 0, 51]), Rgb([255, 204, 204])); // a fifth
/// ```
#[must_use]
pub fn colour_on_white(colour: [u8; 4]) -> Rgb {
    Rgb(colour_on(u8::MAX, colour))
}

/// The same on paper of any level.
pub(crate) fn colour_on(paper: u8, [red, green, blue, alpha]: [u8; 4]) -> [u8; 3] {
    let alpha = u32::from(alpha);
    [red, green, blue].map(|channel| {
        let level = (u32::from(channel) * alpha + u32::from(paper) * (255 - alpha) + 127) / 255;
        u8::try_from(level).unwrap_or(u8::MAX)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_pixels_are_where_they_were_given() {
        let picture = Colour::new(2, 2, (0..12).collect()).unwrap();
        assert_eq!(picture.rows().nth(1), Some(&[[6, 7, 8], [9, 10, 11]][..]));
        assert_eq!(picture.pixel(1, 0), Some(Rgb([3, 4, 5])));
        assert_eq!([picture.pixel(2, 0), picture.pixel(0, 2)], [None, None]);
    }

    #[test]
    fn a_grey_picture_comes_back_from_colour() {
        let gray = Gray::new(16, 16, (0..=255).collect()).unwrap();
        assert_eq!(Gray::from(&Colour::from(&gray)), gray);
    }

    #[test]
    fn a_picture_without_pixels_is_a_picture() {
        assert_eq!(Colour::new(0, 5, Vec::new()).unwrap().rows().count(), 0);
        assert_eq!(Colour::new(1, 1, Vec::new()), Err(ColourError::WrongCount { expected: 3, found: 0 }));
    }
}
