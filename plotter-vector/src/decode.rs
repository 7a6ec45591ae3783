//! [`decode`]: a picture file as grey levels.

use crate::bitmap::{MAX_PIXELS, MAX_SIDE_PX};
use crate::{Gray, GrayError, SizeError, gray_on_white};
use core::fmt;
use image::{DynamicImage, GenericImageView, ImageError, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Most memory that decoding may take: 8 bytes (four channels of 16 bits) a pixel of the largest picture, bytes.
const MAX_ALLOC_BYTES: u64 = 8 * MAX_PIXELS;

/// Why a file is not a picture that can be traced.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DecodeError {
    /// No bytes at all.
    Empty,
    /// Not PNG, JPEG, PBM, PGM or PPM.
    UnknownFormat {
        /// How the file begins.
        first_bytes: Vec<u8>,
    },
    /// Larger than a picture may be.
    TooLarge(SizeError),
    /// Decoding it would take too much memory.
    TooMuchMemory,
    /// Damaged or cut off.
    Damaged {
        /// Length of the file, bytes.
        length: usize,
        /// What the decoder met.
        what: String,
    },
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the picture is empty (0 bytes): scan or save it again"),
            Self::UnknownFormat { first_bytes } => {
                f.write_str("the picture begins with")?;
                for byte in first_bytes {
                    write!(f, " {byte:02x}")?;
                }
                f.write_str(", which is not PNG, JPEG, PBM, PGM or PPM: save it as one of these")
            }
            Self::TooLarge(error) => error.fmt(f),
            Self::TooMuchMemory => {
                write!(
                    f,
                    "decoding the picture takes more than {} MiB: save it as 8-bit grey",
                    MAX_ALLOC_BYTES >> 20
                )
            }
            Self::Damaged { length, what } => {
                write!(f, "the picture ({length} bytes) is damaged or cut off: {what}; scan or save it again")
            }
        }
    }
}

impl core::error::Error for DecodeError {}

/// Decodes a PNG, JPEG, PBM, PGM or PPM picture; the format is told from the bytes, not from a name.
///
/// Colours become luma, 16 bits become 8, and what is transparent shows white paper ([`gray_on_white`]). The size
/// is checked before the pixels are decoded: [`MAX_SIDE_PX`] a side and [`MAX_PIXELS`] in all.
///
/// # Errors
/// [`DecodeError`]; never a panic, and never more memory than 9 bytes a pixel of the largest picture: 8 decoded, 1 as
/// grey.
///
/// ```
/// # use plotter_vector::decode;
/// let picture = decode(b"P1 3 2\n1 1 1\n1 0 0\n")?; // PBM in text: 1 is black
/// assert_eq!(picture.pixels(), [0, 0, 0, 0, 255, 255]);
/// assert!(decode(b"").is_err());
/// # Ok::<(), plotter_vector::DecodeError>(())
/// ```
pub fn decode(bytes: &[u8]) -> Result<Gray, DecodeError> {
    if bytes.is_empty() {
        return Err(DecodeError::Empty);
    }
    let damaged =
        |error: &dyn fmt::Display| DecodeError::Damaged { length: bytes.len(), what: one_line(error) };
    let reader =
        || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| damaged(&error));
    let unknown = || DecodeError::UnknownFormat { first_bytes: bytes.iter().take(8).copied().collect() };
    if reader()?.format().is_none() {
        return Err(unknown());
    }
    let refused = |error: ImageError| match error {
        ImageError::Unsupported(_) => unknown(),
        ImageError::Limits(_) => DecodeError::TooMuchMemory,
        other => damaged(&other),
    };
    if reader()?.format() == Some(ImageFormat::Jpeg) && !jpeg_has_its_end(bytes) {
        return Err(damaged(&"a JPEG without its end mark"));
    }
    // The header first: a picture of a size that is refused must not be decoded at all.
    let (width, height) = reader()?.into_dimensions().map_err(refused)?;
    SizeError::check(width, height).map_err(DecodeError::TooLarge)?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX);
    limits.max_image_height = Some(MAX_SIDE_PX);
    limits.max_alloc = Some(MAX_ALLOC_BYTES);
    let mut decoder = reader()?;
    decoder.limits(limits);
    let picture = decoder.decode().map_err(refused)?;
    to_gray(picture).map_err(|error| match error {
        GrayError::TooLarge(size) => DecodeError::TooLarge(size),
        other @ GrayError::WrongCount { .. } => damaged(&other),
    })
}

/// Whether a JPEG's last scan is followed by the end mark; the decoder itself would fill what is missing with grey.
///
/// Within a scan the byte FF is never followed by that of a mark, so what is found is one (ITU-T T.81, B.1.1.5).
fn jpeg_has_its_end(bytes: &[u8]) -> bool {
    const SCAN: [u8; 2] = [0xff, 0xda];
    const END: [u8; 2] = [0xff, 0xd9];
    let scan = bytes.windows(2).rposition(|pair| pair == SCAN).unwrap_or(0);
    bytes.get(scan..).unwrap_or(&[]).windows(2).any(|pair| pair == END)
}

/// A decoder's message on one line, whatever it holds.
fn one_line(message: &dyn fmt::Display) -> String {
    message.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

fn to_gray(picture: DynamicImage) -> Result<Gray, GrayError> {
    let (width, height) = picture.dimensions();
    let levels = match picture {
        DynamicImage::ImageLuma8(gray) => gray.into_raw(),
        // Pixel by pixel: a copy of the whole picture as RGBA would take half as much memory again.
        other => {
            let mut levels = Vec::with_capacity(width as usize * height as usize);
            levels.extend(other.pixels().map(|(_, _, pixel)| gray_on_white(pixel.0)));
            levels
        }
    };
    Gray::new(width, height, levels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageBuffer;

    fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.into().write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    /// The levels of a PNG of two pixels.
    fn levels(picture: Option<impl Into<DynamicImage>>) -> [u8; 2] {
        let gray = decode(&png(picture.unwrap())).unwrap();
        assert_eq!((gray.width(), gray.height()), (2, 1));
        gray.pixels().try_into().unwrap()
    }

    #[test]
    fn grey_pictures_of_8_and_16_bits_are_read() {
        assert_eq!(levels(ImageBuffer::<image::Luma<u8>, _>::from_raw(2, 1, vec![0, 200])), [0, 200]);
        // 65535 / 255 = 257, so 51400 is level 200.
        assert_eq!(
            levels(ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, vec![65535, 51400])),
            [255, 200]
        );
    }

    #[test]
    fn colours_of_8_and_16_bits_become_luma() {
        // Red and blue: 0.299 · 255 = 76.2 and 0.114 · 255 = 29.1.
        let small = vec![255, 0, 0, 0, 0, 255];
        let deep: Vec<u16> = small.iter().map(|channel| channel * 257).collect();
        let small = small.into_iter().map(|channel| u8::try_from(channel).unwrap()).collect();
        assert_eq!(levels(ImageBuffer::<image::Rgb<u8>, _>::from_raw(2, 1, small)), [76, 29]);
        assert_eq!(levels(ImageBuffer::<image::Rgb<u16>, _>::from_raw(2, 1, deep)), [76, 29]);
    }

    #[test]
    fn what_is_transparent_shows_white_paper() {
        let black_and_clear = vec![0, 0, 0, 255, 0, 0, 0, 0];
        let deep: Vec<u16> = black_and_clear.iter().map(|channel| u16::from(*channel) * 257).collect();
        assert_eq!(levels(ImageBuffer::<image::Rgba<u8>, _>::from_raw(2, 1, black_and_clear)), [0, 255]);
        assert_eq!(levels(ImageBuffer::<image::Rgba<u16>, _>::from_raw(2, 1, deep)), [0, 255]);
        assert_eq!(levels(ImageBuffer::<image::LumaA<u8>, _>::from_raw(2, 1, vec![9, 255, 9, 0])), [9, 255]);
    }

    #[test]
    fn jpeg_and_every_pnm_are_read() {
        let mut jpeg = Cursor::new(Vec::new());
        let paper = image::GrayImage::from_pixel(16, 8, image::Luma([255]));
        paper.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
        assert_eq!(decode(&jpeg.into_inner()).unwrap().pixels(), [255; 128]);
        let pictures: [&[u8]; 6] = [
            b"P1 2 1 1 0",
            b"P2 2 1 255 0 255",
            b"P3 2 1 255 0 0 0 255 255 255",
            b"P4 2 1\n\x80",
            b"P5 2 1 255\n\x00\xff",
            b"P6 2 1 255\n\x00\x00\x00\xff\xff\xff",
        ];
        for bytes in pictures {
            assert_eq!(decode(bytes).unwrap().pixels(), [0, 255], "{}", String::from_utf8_lossy(bytes));
        }
    }

    #[test]
    fn a_picture_cut_off_anywhere_is_an_error() {
        let whole = png(ImageBuffer::from_fn(9, 9, |x, y| image::Luma([u8::from(x == y) * 255])));
        // The last 12 bytes are the end mark, which holds no pixels.
        for length in 0..whole.len() - 12 {
            let error = decode(&whole[..length]).unwrap_err();
            assert!(!error.to_string().contains('\n'), "one line: {error}");
        }
    }

    #[test]
    fn a_jpeg_cut_off_anywhere_is_an_error() {
        let mut whole = Cursor::new(Vec::new());
        let noise =
            image::GrayImage::from_fn(40, 24, |x, y| image::Luma([(x * 37 + y * 101).to_le_bytes()[0]]));
        noise.write_to(&mut whole, ImageFormat::Jpeg).unwrap();
        let mut whole = whole.into_inner();
        for length in 0..whole.len() {
            assert!(decode(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
        }
        whole.extend(b"what a camera writes behind the picture");
        assert!(decode(&whole).is_ok());
    }

    #[test]
    fn a_huge_size_is_refused_from_the_header() {
        assert_eq!(
            decode(b"P5 100000 100000 255\n"),
            Err(DecodeError::TooLarge(SizeError { width: 100_000, height: 100_000 }))
        );
    }

    #[test]
    fn something_else_is_named_by_its_first_bytes() {
        let error = decode(b"IN;SP1;PU0,0;").unwrap_err();
        assert_eq!(
            error.to_string(),
            "the picture begins with 49 4e 3b 53 50 31 3b 50, which is not PNG, JPEG, PBM, PGM or PPM: save it as \
             one of these"
        );
    }
}
