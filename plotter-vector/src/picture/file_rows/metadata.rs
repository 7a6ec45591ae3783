//! What formats that are decoded whole, and EXIF in all of them, say beside the pixels.

use crate::picture::resolution::MM_PER_INCH;
use crate::picture::{FileFormat, FileNotes, Orientation, Resolution, ResolutionSource};
use exif::{In, Tag, Value};
use image::ImageDecoder as _;
use std::io::Cursor;

/// Longest EXIF that is looked at, bytes: a segment of JPEG has 64 KiB.
const MAX_EXIF_BYTES: usize = 1 << 20;

/// What EXIF says of a picture; all of it may be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Exif {
    orientation: Orientation,
    px_per_mm: Option<[f64; 2]>,
    by_lens: bool,
}

impl Exif {
    /// Reads it; what is damaged is left out, for the picture may be good.
    pub(super) fn read(bytes: &[u8]) -> Self {
        let bytes = bytes.strip_prefix(b"Exif\0\0").unwrap_or(bytes);
        if bytes.len() > MAX_EXIF_BYTES {
            return Self::default();
        }
        let mut reader = exif::Reader::new();
        reader.continue_on_error(true);
        let read = reader.read_raw(bytes.to_vec());
        let Ok(exif) = read.or_else(|error| error.distill_partial_result(|_| ())) else {
            return Self::default();
        };
        let number = |tag| exif.get_field(tag, In::PRIMARY)?.value.get_uint(0);
        let per_unit = |tag| match &exif.get_field(tag, In::PRIMARY)?.value {
            Value::Rational(values) => values.first().map(|value| value.to_f64()),
            _ => None,
        };
        let both = per_unit(Tag::XResolution).zip(per_unit(Tag::YResolution));
        Self {
            orientation: number(Tag::Orientation).and_then(Orientation::of_number).unwrap_or_default(),
            px_per_mm: both.and_then(|(x, y)| px_per_mm([x, y], number(Tag::ResolutionUnit).unwrap_or(2))),
            by_lens: [Tag::FocalLength, Tag::FNumber, Tag::ExposureTime]
                .iter()
                .any(|tag| exif.get_field(*tag, In::PRIMARY).is_some()),
        }
    }

    /// Adds it to what the format itself says, which goes before unless it is not to be believed.
    pub(super) fn add_to(&self, mut notes: FileNotes) -> FileNotes {
        if let Some(resolution) = &mut notes.resolution {
            resolution.by_lens = self.by_lens;
        }
        let own = self.px_per_mm.map(|px_per_mm| Resolution {
            px_per_mm,
            source: ResolutionSource::Exif,
            by_lens: self.by_lens,
        });
        let is_good = |resolution: &Resolution| resolution.mm_per_px().is_ok();
        notes.resolution = match notes.resolution {
            Some(before) if is_good(&before) || !own.as_ref().is_some_and(is_good) => Some(before),
            _ => own,
        };
        notes.turned(self.orientation)
    }
}

/// Pixels a millimetre of pixels a unit: 2 is an inch, 3 a centimetre, in EXIF and TIFF. Without a unit only
/// their ratio means something, and that only if it is not 1.
pub(super) fn px_per_mm(per_unit: [f64; 2], unit: u32) -> Option<[f64; 2]> {
    let unit_mm = match unit {
        2 => MM_PER_INCH,
        3 => 10.0,
        _ if per_unit[0] == per_unit[1] => return None,
        _ => MM_PER_INCH,
    };
    Some(per_unit.map(|px| px / unit_mm))
}

/// What a file that is decoded whole says of itself; nothing but the size when the rest is damaged.
pub(super) fn whole_notes(bytes: &[u8], format: FileFormat, size: (u32, u32)) -> FileNotes {
    let mut notes = FileNotes::new(format, size);
    match format {
        FileFormat::Jpeg => {
            notes.resolution = segments(bytes).find_map(|(mark, segment)| jfif(mark, segment));
            let exif = segments(bytes).find(|(mark, part)| *mark == 0xe1 && part.starts_with(b"Exif\0\0"));
            exif.map_or(Exif::default(), |(_, segment)| Exif::read(segment)).add_to(notes)
        }
        FileFormat::WebP => {
            let Ok(mut decoder) = image::codecs::webp::WebPDecoder::new(Cursor::new(bytes)) else {
                return notes;
            };
            notes.is_animated = decoder.has_animation();
            let exif = decoder.exif_metadata().ok().flatten().unwrap_or_default();
            Exif::read(&exif).add_to(notes)
        }
        FileFormat::Bmp => FileNotes { resolution: bmp_resolution(bytes), ..notes },
        FileFormat::Gif => FileNotes { is_animated: has_two_frames(bytes), ..notes },
        FileFormat::Png | FileFormat::Tiff | FileFormat::Pnm => notes,
    }
}

/// The segments of a JPEG up to its first scan, each with the second byte of its mark (ITU-T T.81, B.1.1).
fn segments(bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    const SCAN: u8 = 0xda;
    let mut rest = bytes.get(2..).unwrap_or(&[]);
    core::iter::from_fn(move || {
        // Any number of FF may stand before a mark.
        while let [0xff, 0xff, ..] = rest {
            rest = rest.get(1..)?;
        }
        let [0xff, mark, high, low, ..] = *rest else { return None };
        let length = usize::from(u16::from_be_bytes([high, low]));
        if mark == SCAN || length < 2 {
            return None;
        }
        let segment = rest.get(4..2 + length)?;
        rest = rest.get(2 + length..)?;
        Some((mark, segment))
    })
}

/// The density of a JFIF header (ITU-T T.871, 10.1): its unit is 1 for an inch, 2 for a centimetre.
fn jfif(mark: u8, segment: &[u8]) -> Option<Resolution> {
    let (0xe0, Some([_, _, unit, x_high, x_low, y_high, y_low])) =
        (mark, segment.strip_prefix(b"JFIF\0")?.first_chunk::<7>())
    else {
        return None;
    };
    let density = [u16::from_be_bytes([*x_high, *x_low]), u16::from_be_bytes([*y_high, *y_low])];
    let px_per_mm = px_per_mm(density.map(f64::from), u32::from(*unit) + 1)?;
    Some(Resolution { px_per_mm, source: ResolutionSource::Jfif, by_lens: false })
}

/// Pixels a metre in the header of a BMP, if it has those of `BITMAPINFOHEADER` or later; 0 says nothing.
fn bmp_resolution(bytes: &[u8]) -> Option<Resolution> {
    const HEADER_BYTES: u32 = 40;
    let number = |at: usize| bytes.get(at..)?.first_chunk::<4>().map(|four| u32::from_le_bytes(*four));
    let per_metre = [number(38)?, number(42)?];
    if number(14)? < HEADER_BYTES || per_metre == [0, 0] {
        return None;
    }
    let px_per_mm = per_metre.map(|px| f64::from(px) / 1000.0);
    Some(Resolution { px_per_mm, source: ResolutionSource::Bmp, by_lens: false })
}

/// Whether a GIF has more than one picture. None is decoded.
fn has_two_frames(bytes: &[u8]) -> bool {
    let mut options = gif::DecodeOptions::new();
    options.skip_frame_decoding(true);
    let Ok(mut decoder) = options.read_info(bytes) else { return false };
    (0..2).all(|_| matches!(decoder.next_frame_info(), Ok(Some(_))))
}
