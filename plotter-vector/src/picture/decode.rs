//! [`decode`]: a picture file as grey levels, and [`decode_colour`], in colour.

use crate::picture::bitmap::{MAX_PIXELS, MAX_SIDE_PX};
use crate::picture::colour::colour_on;
use crate::picture::file_rows::{colours, one_line};
use crate::picture::gray::gray_on;
use crate::picture::ground::{Ground, GroundSurvey};
use crate::picture::{Colour, DecodeError, FileFormat, FileNotes, FileRows, Gray, SizeError};
use core::fmt;
use image::{DynamicImage, GenericImageView, ImageError, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Most memory that decoding may take: 8 bytes (four channels of 16 bits) a pixel of the largest picture,
/// bytes.
const MAX_ALLOC_BYTES: u64 = 8 * MAX_PIXELS;

/// Decodes a PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM picture; the format is told from the bytes, not
/// from a name. Of several pages, or of one that moves, it is the first.
///
/// The picture comes upright, as EXIF and TIFF say. Colours become luma, 16 bits become 8. What is
/// transparent shows white paper, or black where only light lines are drawn ([`Ground`]). The size is checked
/// before the pixels are decoded: [`MAX_SIDE_PX`] a side and [`MAX_PIXELS`] in all; [`FileRows`] reads larger
/// ones by rows. What the file says of itself stands in [`FileRows::notes`].
///
/// # Errors
/// [`DecodeError`]; never a panic. What is stored by rows takes a byte a pixel, and as much again to be
/// turned; what is not never more than 9 bytes a pixel of the largest picture: 8 decoded, 1 as grey.
///
/// ```
/// # use plotter_vector::decode;
/// let picture = decode(b"P1 3 2\n1 1 1\n1 0 0\n")?; // PBM in text: 1 is black
/// assert_eq!(picture.pixels(), [0, 0, 0, 0, 255, 255]);
/// assert!(decode(b"").is_err());
/// # Ok::<(), plotter_vector::DecodeError>(())
/// ```
pub fn decode(bytes: &[u8]) -> Result<Gray, DecodeError> {
    FileRows::new(Cursor::new(bytes))?.into_gray()
}

/// As [`decode`], in colour: greys become three equal channels, palettes are looked up, 16 bits become 8.
///
/// # Errors
/// [`DecodeError`]; never a panic. What is stored by rows takes 3 bytes a pixel, and as much again to be
/// turned; what is not never more than 11 bytes a pixel of the largest picture: 8 decoded, 3 in colour.
///
/// ```
/// # use plotter_vector::decode_colour;
/// let picture = decode_colour(b"P3 2 1 255\n200 0 0 255 255 255\n")?; // PPM in text
/// assert_eq!(picture.pixels(), [[200, 0, 0], [255, 255, 255]]);
/// # Ok::<(), plotter_vector::DecodeError>(())
/// ```
pub fn decode_colour(bytes: &[u8]) -> Result<Colour, DecodeError> {
    decode_page_in_colour(bytes, 1).map(|(picture, _)| picture)
}

/// As [`decode_colour`], of a page, 1 is the first, and with what the file says of itself.
///
/// # Errors
/// [`DecodeError::NoSuchPage`], and as for [`decode_colour`].
pub fn decode_page_in_colour(bytes: &[u8], page: u32) -> Result<(Colour, FileNotes), DecodeError> {
    colours(bytes, page)
}

/// Decodes a picture that is not stored by rows, as levels, and what it was laid on if it is transparent.
pub(crate) fn decode_whole(
    bytes: &[u8],
    format: FileFormat,
    size: (u32, u32),
) -> Result<(Vec<u8>, Option<Ground>), DecodeError> {
    let picture = picture(bytes, format, size)?;
    let ground = ground(&picture);
    Ok((to_gray(picture, ground.unwrap_or_default()), ground))
}

/// The same in colour, three channels a pixel.
pub(crate) fn colours_of_whole(
    bytes: &[u8],
    format: FileFormat,
    size: (u32, u32),
) -> Result<(Vec<u8>, Option<Ground>), DecodeError> {
    let picture = picture(bytes, format, size)?;
    let ground = ground(&picture);
    Ok((to_channels(picture, ground.unwrap_or_default()), ground))
}

fn damaged(bytes: &[u8], error: &dyn fmt::Display) -> DecodeError {
    DecodeError::Damaged { length: bytes.len() as u64, what: one_line(error) }
}

fn reader(bytes: &[u8], format: FileFormat) -> ImageReader<Cursor<&[u8]>> {
    let format = match format {
        FileFormat::Png => ImageFormat::Png,
        FileFormat::Jpeg => ImageFormat::Jpeg,
        FileFormat::Tiff => ImageFormat::Tiff,
        FileFormat::WebP => ImageFormat::WebP,
        FileFormat::Bmp => ImageFormat::Bmp,
        FileFormat::Gif => ImageFormat::Gif,
        FileFormat::Pnm => ImageFormat::Pnm,
    };
    ImageReader::with_format(Cursor::new(bytes), format)
}

/// Why the decoder of a format does not go on.
fn refused(bytes: &[u8], error: &ImageError) -> DecodeError {
    match error {
        ImageError::Unsupported(error) => DecodeError::Unsupported { what: one_line(error) },
        ImageError::Limits(_) => DecodeError::TooMuchMemory { bytes: MAX_ALLOC_BYTES },
        other => damaged(bytes, other),
    }
}

/// The size of a picture that is not stored by rows, from its header: one that is refused must not be decoded
/// at all.
pub(crate) fn size_of_whole(bytes: &[u8], format: FileFormat) -> Result<(u32, u32), DecodeError> {
    let (width, height) = reader(bytes, format).into_dimensions().map_err(|error| refused(bytes, &error))?;
    SizeError::check(width, height).map_err(DecodeError::TooLarge)?;
    Ok((width, height))
}

/// The picture as the file has it, of the size that its header said.
fn picture(bytes: &[u8], format: FileFormat, size: (u32, u32)) -> Result<DynamicImage, DecodeError> {
    if format == FileFormat::Jpeg && !jpeg_has_its_end(bytes) {
        return Err(damaged(bytes, &"a JPEG without its end mark"));
    }
    // What says how it is turned may stand behind the pixels.
    if format == FileFormat::WebP && webp_is_cut_off(bytes) {
        return Err(damaged(bytes, &"a WebP shorter than its header says"));
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX);
    limits.max_image_height = Some(MAX_SIDE_PX);
    limits.max_alloc = Some(MAX_ALLOC_BYTES);
    let mut decoder = reader(bytes, format);
    decoder.limits(limits);
    let picture = decoder.decode().map_err(|error| refused(bytes, &error))?;
    if picture.dimensions() != size {
        return Err(damaged(bytes, &"pixels of another size than the header says"));
    }
    Ok(picture)
}

/// Whether a JPEG's last scan is followed by the end mark; the decoder itself would fill what is missing with
/// grey.
///
/// Within a scan the byte FF is never followed by that of a mark, so what is found is one (ITU-T T.81,
/// B.1.1.5).
fn jpeg_has_its_end(bytes: &[u8]) -> bool {
    const SCAN: [u8; 2] = [0xff, 0xda];
    const END: [u8; 2] = [0xff, 0xd9];
    let scan = bytes.windows(2).rposition(|pair| pair == SCAN).unwrap_or(0);
    bytes.get(scan..).unwrap_or(&[]).windows(2).any(|pair| pair == END)
}

/// Whether a WebP is shorter than its RIFF header says.
fn webp_is_cut_off(bytes: &[u8]) -> bool {
    const HEADER_BYTES: u64 = 8;
    let length = bytes.get(4..).and_then(|rest| rest.first_chunk()).copied().map_or(0, u32::from_le_bytes);
    (bytes.len() as u64) < HEADER_BYTES + u64::from(length)
}

/// What a picture that may be transparent is laid on.
fn ground(picture: &DynamicImage) -> Option<Ground> {
    let (width, height) = picture.dimensions();
    // The iterator of `image` panics where there are rows without columns.
    if !picture.color().has_alpha() || width == 0 {
        return None;
    }
    let mut survey = GroundSurvey::new(width, height);
    picture.pixels().for_each(|(_, _, pixel)| survey.add(pixel.0));
    Some(survey.ground())
}

fn to_gray(picture: DynamicImage, ground: Ground) -> Vec<u8> {
    let (width, height) = picture.dimensions();
    match picture {
        DynamicImage::ImageLuma8(gray) => gray.into_raw(),
        _ if width == 0 => Vec::new(),
        // Pixel by pixel: a copy of the whole picture as RGBA would take half as much memory again.
        other => {
            let mut levels = Vec::with_capacity(width as usize * height as usize);
            levels.extend(other.pixels().map(|(_, _, pixel)| gray_on(ground.level(), pixel.0)));
            levels
        }
    }
}

fn to_channels(picture: DynamicImage, ground: Ground) -> Vec<u8> {
    let (width, height) = picture.dimensions();
    match picture {
        DynamicImage::ImageRgb8(colour) => colour.into_raw(),
        _ if width == 0 => Vec::new(),
        other => {
            let mut channels = Vec::with_capacity(3 * width as usize * height as usize);
            channels.extend(other.pixels().flat_map(|(_, _, pixel)| colour_on(ground.level(), pixel.0)));
            channels
        }
    }
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

    /// The pixels of a PNG of two pixels.
    fn colours(picture: Option<impl Into<DynamicImage>>) -> [[u8; 3]; 2] {
        decode_colour(&png(picture.unwrap())).unwrap().pixels().try_into().unwrap()
    }

    #[test]
    fn colours_of_8_and_16_bits_stay_colours() {
        let small = vec![255, 0, 7, 0, 90, 255];
        let deep: Vec<u16> = small.iter().map(|channel| u16::from(*channel) * 257).collect();
        let expected = [[255, 0, 7], [0, 90, 255]];
        assert_eq!(colours(ImageBuffer::<image::Rgb<u8>, _>::from_raw(2, 1, small)), expected);
        assert_eq!(colours(ImageBuffer::<image::Rgb<u16>, _>::from_raw(2, 1, deep)), expected);
    }

    #[test]
    fn transparent_colours_and_greys_are_colours_on_white_paper() {
        let fifth_and_clear = vec![255, 0, 0, 51, 9, 9, 9, 0];
        assert_eq!(
            colours(ImageBuffer::<image::Rgba<u8>, _>::from_raw(2, 1, fifth_and_clear)),
            [[255, 204, 204], [255; 3]]
        );
        assert_eq!(
            colours(ImageBuffer::<image::Luma<u8>, _>::from_raw(2, 1, vec![0, 200])),
            [[0; 3], [200; 3]]
        );
        assert_eq!(
            colours(ImageBuffer::<image::LumaA<u16>, _>::from_raw(2, 1, vec![257, 65535, 0, 0])),
            [[1; 3], [255; 3]]
        );
        assert_eq!(decode_colour(b"P4 2 1\n\x80").unwrap().pixels(), [[0; 3], [255; 3]]);
    }

    #[test]
    fn a_palette_is_looked_up() {
        // 2 x 1 px, 1 bit a pixel: blue, then red, of the palette (red, blue); no own encoder writes this.
        let bytes = b"\x89PNG\x0d\x0a\x1a\x0a\x00\x00\x00\x0dIHDR\x00\x00\x00\x02\x00\x00\x00\x01\x01\x03\x00\x00\x00\xce\xec\xed\xc9\x00\x00\x00\x06PLTE\xff\x00\x00\x00\x00\xffl\xa1\xfd\x8e\x00\x00\x00\x0aIDATx\x9cch\x00\x00\x00\x82\x00\x81w\xcdr\xb6\x00\x00\x00\x00IEND\xaeB`\x82";
        assert_eq!(decode_colour(bytes).unwrap().pixels(), [[0, 0, 255], [255, 0, 0]]);
    }

    #[test]
    fn a_tiff_keeps_its_colours() {
        let mut tiff = Cursor::new(Vec::new());
        let mut encoder = tiff::encoder::TiffEncoder::new(&mut tiff).unwrap();
        encoder.write_image::<tiff::encoder::colortype::RGB8>(2, 1, &[200, 30, 40, 1, 2, 3]).unwrap();
        assert_eq!(decode_colour(&tiff.into_inner()).unwrap().pixels(), [[200, 30, 40], [1, 2, 3]]);
    }

    #[test]
    fn a_jpeg_keeps_its_colours() {
        let mut jpeg = Cursor::new(Vec::new());
        let red = image::RgbImage::from_pixel(16, 8, image::Rgb([200, 30, 40]));
        red.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
        let picture = decode_colour(&jpeg.into_inner()).unwrap();
        assert_eq!((picture.width(), picture.height()), (16, 8));
        assert!(picture.pixels().iter().all(|[red, green, blue]| *red > 190 && *green < 40 && *blue < 50));
    }

    #[test]
    fn in_colour_the_same_is_refused() {
        assert_eq!(decode_colour(b""), Err(DecodeError::Empty));
        assert!(matches!(decode_colour(b"IN;"), Err(DecodeError::UnknownFormat { .. })));
        assert!(matches!(decode_colour(b"P6 100000 100000 255\n"), Err(DecodeError::TooLarge(_))));
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
        assert_eq!(decode(b"P5 200000 1 255\n"), Err(DecodeError::TooLong { width: 200_000, height: 1 }));
    }

    #[test]
    fn rows_without_columns_are_a_picture() {
        let header = "WIDTH 0\nHEIGHT 3\nDEPTH 3\nMAXVAL 255\nTUPLTYPE RGB\nENDHDR\n";
        for bytes in
            [format!("P7\n{header}"), "P6 0 3 255\n".into(), "P3 0 3 255\n".into(), "P4 0 3\n".into()]
        {
            let gray = decode(bytes.as_bytes()).unwrap();
            assert_eq!((gray.width(), gray.height()), (0, 3), "{bytes}");
            let deep = bytes.replace("255", "65535");
            assert_eq!(decode_colour(deep.as_bytes()).unwrap().pixels(), [] as [[u8; 3]; 0], "{bytes}");
        }
    }

    #[test]
    fn something_else_is_named_by_its_first_bytes() {
        let error = decode(b"IN;SP1;PU0,0;").unwrap_err();
        assert_eq!(
            error.to_string(),
            "the picture begins with 49 4e 3b 53 50 31 3b 50, which is not PNG, JPEG, TIFF, WebP, BMP, GIF, \
             PBM, PGM or PPM: save it as one of these"
        );
    }
}
