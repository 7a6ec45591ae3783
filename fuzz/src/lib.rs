//! Code that the fuzz targets share.

use image::{DynamicImage, ImageFormat};
use std::io::Cursor;
use std::sync::LazyLock;

/// A file of few pixels in a format that has a place for more than these.
fn small(format: ImageFormat) -> Vec<u8> {
    let rgba = image::RgbaImage::from_fn(5, 3, |x, y| image::Rgba([255, 255, 255, u8::from(x == y) * 255]));
    let picture = DynamicImage::from(rgba);
    let picture = if format == ImageFormat::Jpeg { DynamicImage::from(picture.to_luma8()) } else { picture };
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).expect("a vector takes all");
    bytes.into_inner()
}

static JPEG: LazyLock<Vec<u8>> = LazyLock::new(|| small(ImageFormat::Jpeg));
static PNG: LazyLock<Vec<u8>> = LazyLock::new(|| small(ImageFormat::Png));
static WEBP: LazyLock<Vec<u8>> = LazyLock::new(|| small(ImageFormat::WebP));

/// A small JPEG with other bytes in place of its header: as a segment of that mark and beginning, or, without
/// one, as they are.
pub fn in_jpeg(segment: Option<(u8, &[u8])>, bytes: &[u8]) -> Vec<u8> {
    let header = 4 + usize::from(JPEG[5]);
    let Some((mark, head)) = segment else {
        return [&JPEG[..2], bytes, &JPEG[header..]].concat();
    };
    let bytes = &bytes[..bytes.len().min(60_000)];
    let length = u16::try_from(bytes.len() + head.len() + 2).expect("short").to_be_bytes();
    [&JPEG[..2], &[0xff, mark], &length, head, bytes, &JPEG[header..]].concat()
}

/// A small PNG with a chunk behind its header.
pub fn in_png(name: [u8; 4], bytes: &[u8]) -> Vec<u8> {
    const HEADER: usize = 33;
    let length = u32::try_from(bytes.len()).expect("short").to_be_bytes();
    let mut sum = flate2::Crc::new();
    sum.update(&name);
    sum.update(bytes);
    [&PNG[..HEADER], &length, &name, bytes, &sum.sum().to_be_bytes(), &PNG[HEADER..]].concat()
}

/// A small WebP with EXIF behind its pixels.
pub fn in_webp(exif: &[u8]) -> Vec<u8> {
    const ALPHA_AND_EXIF: u8 = 0x18;
    let chunk = |name: &[u8; 4], body: &[u8]| {
        let length = u32::try_from(body.len()).expect("short").to_le_bytes();
        let mut bytes = [&name[..], &length, body].concat();
        bytes.resize(bytes.len().next_multiple_of(2), 0);
        bytes
    };
    let header = chunk(b"VP8X", &[ALPHA_AND_EXIF, 0, 0, 0, 4, 0, 0, 2, 0, 0]);
    chunk(b"RIFF", &[b"WEBP", &header[..], &WEBP[12..], &chunk(b"EXIF", exif)].concat())
}

/// Whether a picture is small enough to be tried many times a second, as far as its header can tell.
pub fn is_small(bytes: &[u8]) -> bool {
    const MOST_PIXELS: u64 = 1 << 16;
    // Many rows without columns are many rows.
    let size = |(width, height): (u32, u32)| u64::from(width.max(1)) * u64::from(height.max(1));
    // What is decoded whole is decoded when it is opened: its size must be known before.
    let whole: [&[u8]; 6] = [b"\xff\xd8", b"\x89PNG", b"P7", b"RIFF", b"BM", b"GIF8"];
    if whole.iter().any(|head| bytes.starts_with(head)) {
        let reader = image::ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
        let dimensions = reader.ok().and_then(|reader| reader.into_dimensions().ok());
        return dimensions.is_none_or(|dimensions| size(dimensions) <= MOST_PIXELS);
    }
    use plotter_vector::{FileRows, picture::RowSource};
    let scan = FileRows::new(std::io::Cursor::new(bytes));
    scan.map_or(true, |scan| size((scan.width(), scan.height())) <= MOST_PIXELS)
}
