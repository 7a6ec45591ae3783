//! Metadata: resolution, orientation and animation of the formats that are decoded as a whole, and EXIF of
//! all formats.

use crate::picture::resolution::MM_PER_INCH;
use crate::picture::{FileFormat, FileNotes, Orientation, Resolution, ResolutionSource};
use exif::{In, Tag, Value};
use image::ImageDecoder as _;
use std::io::Cursor;

/// Longest EXIF block that is read, bytes. JPEG allows 64 KiB and other formats more; the tags read here take
/// some hundred bytes, the rest are thumbnails.
const MAX_EXIF_BYTES: usize = 1 << 20;

/// The tags of EXIF that are used; all of them may be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Exif {
    orientation: Orientation,
    px_per_mm: Option<[f64; 2]>,
    has_camera_tags: bool,
}

impl Exif {
    /// Reads an EXIF block. Damaged tags count as missing, for the picture may be good.
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
        let density = per_unit(Tag::XResolution).zip(per_unit(Tag::YResolution));
        Self {
            orientation: number(Tag::Orientation).and_then(Orientation::of_number).unwrap_or_default(),
            px_per_mm: density
                .and_then(|(x, y)| to_px_per_mm([x, y], number(Tag::ResolutionUnit).unwrap_or(2))),
            has_camera_tags: [Tag::FocalLength, Tag::FNumber, Tag::ExposureTime]
                .iter()
                .any(|tag| exif.get_field(*tag, In::PRIMARY).is_some()),
        }
    }

    /// Adds EXIF to the format's own metadata. The format's resolution wins if it is plausible.
    pub(super) fn add_to(&self, mut notes: FileNotes) -> FileNotes {
        if let Some(resolution) = &mut notes.resolution {
            resolution.has_camera_tags = self.has_camera_tags;
        }
        let own = self.px_per_mm.map(|px_per_mm| Resolution {
            px_per_mm,
            source: ResolutionSource::Exif,
            has_camera_tags: self.has_camera_tags,
        });
        let is_plausible = |resolution: &Resolution| resolution.mm_per_px().is_ok();
        notes.resolution = match notes.resolution {
            Some(before) if is_plausible(&before) || !own.as_ref().is_some_and(is_plausible) => Some(before),
            _ => own,
        };
        notes.with_orientation(self.orientation)
    }
}

/// Converts pixels per unit to pixels per millimetre. `unit` is as in EXIF and TIFF 6.0: 2 an inch, 3 a
/// centimetre, anything else no unit.
///
/// Without a unit only the ratio of both directions counts; `None` if it is 1, for square pixels say nothing.
pub(super) fn to_px_per_mm(per_unit: [f64; 2], unit: u32) -> Option<[f64; 2]> {
    let unit_mm = match unit {
        2 => MM_PER_INCH,
        3 => 10.0,
        _ if per_unit[0] == per_unit[1] => return None,
        // Any unit will do: `Resolution::mm_per_px` refuses pixels that are not square.
        _ => MM_PER_INCH,
    };
    Some(per_unit.map(|px| px / unit_mm))
}

/// Metadata of a file that is decoded as a whole; only its size if the rest is damaged.
pub(super) fn whole_notes(bytes: &[u8], format: FileFormat, size: (u32, u32)) -> FileNotes {
    const APP1: u8 = 0xe1;
    let mut notes = FileNotes::new(format, size);
    match format {
        FileFormat::Jpeg => {
            notes.resolution = segments(bytes).find_map(|(marker, segment)| jfif(marker, segment));
            let exif =
                segments(bytes).find(|(marker, segment)| *marker == APP1 && segment.starts_with(b"Exif\0\0"));
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

/// The segments of a JPEG up to its first scan, each with the second byte of its marker (ITU-T T.81, B.1.1).
fn segments(bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    const START_OF_SCAN: u8 = 0xda;
    let mut rest = bytes.get(2..).unwrap_or(&[]);
    core::iter::from_fn(move || {
        // Any number of FF may stand before a marker.
        while let [0xff, 0xff, ..] = rest {
            rest = rest.get(1..)?;
        }
        let [0xff, marker, high, low, ..] = *rest else { return None };
        let length = usize::from(u16::from_be_bytes([high, low]));
        if marker == START_OF_SCAN || length < 2 {
            return None;
        }
        let segment = rest.get(4..2 + length)?;
        rest = rest.get(2 + length..)?;
        Some((marker, segment))
    })
}

/// The density of a JFIF header (ITU-T T.871, 10.1): its unit is 1 for an inch, 2 for a centimetre.
fn jfif(marker: u8, segment: &[u8]) -> Option<Resolution> {
    const APP0: u8 = 0xe0;
    let (APP0, Some([_, _, unit, x_high, x_low, y_high, y_low])) =
        (marker, segment.strip_prefix(b"JFIF\0")?.first_chunk::<7>())
    else {
        return None;
    };
    let density = [u16::from_be_bytes([*x_high, *x_low]), u16::from_be_bytes([*y_high, *y_low])];
    // EXIF counts units from one higher: 0, none, becomes its 1, none.
    let px_per_mm = to_px_per_mm(density.map(f64::from), u32::from(*unit) + 1)?;
    Some(Resolution { px_per_mm, source: ResolutionSource::Jfif, has_camera_tags: false })
}

/// Resolution of a BMP, if its header is a `BITMAPINFOHEADER` or later: pixels per metre, 0 if unknown.
///
/// The header follows the file's 14 bytes: its size is at 14, `biXPelsPerMeter` at 38, `biYPelsPerMeter` at
/// 42. Both are signed; a negative one becomes a resolution out of range, as 0 in one direction does, which
/// `Resolution::mm_per_px` refuses.
fn bmp_resolution(bytes: &[u8]) -> Option<Resolution> {
    const HEADER_BYTES: u32 = 40;
    let number = |at: usize| bytes.get(at..)?.first_chunk::<4>().map(|four| u32::from_le_bytes(*four));
    let per_metre = [number(38)?, number(42)?];
    if number(14)? < HEADER_BYTES || per_metre == [0, 0] {
        return None;
    }
    let px_per_mm = per_metre.map(|px| f64::from(px) / 1000.0);
    Some(Resolution { px_per_mm, source: ResolutionSource::Bmp, has_camera_tags: false })
}

/// Whether a GIF has more than one picture. No picture is decoded.
fn has_two_frames(bytes: &[u8]) -> bool {
    let mut options = gif::DecodeOptions::new();
    options.skip_frame_decoding(true);
    let Ok(mut decoder) = options.read_info(bytes) else { return false };
    (0..2).all(|_| matches!(decoder.next_frame_info(), Ok(Some(_))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jfif_header_of_300_dots_per_inch_is_read_behind_fill_bytes() {
        let mut jpeg = vec![0xff, 0xd8, 0xff, 0xff, 0xe0, 0, 16];
        jpeg.extend(b"JFIF\0\x01\x02\x01\x01\x2c\x01\x2c\0\0"); // 0x012c is 300
        jpeg.extend([0xff, 0xda, 0, 2]);
        let notes = whole_notes(&jpeg, FileFormat::Jpeg, (1, 1));
        let Some(Resolution { px_per_mm: [across, down], source, .. }) = notes.resolution else { panic!() };
        assert!((across - 300.0 / 25.4).abs() < 1e-12 && across.total_cmp(&down).is_eq(), "{across}");
        assert_eq!(source, ResolutionSource::Jfif);
    }

    #[test]
    fn a_bmp_of_11811_pixels_per_metre_has_300_dots_per_inch() {
        let mut bmp = [0_u8; 54];
        bmp[14] = 40;
        bmp[38..42].copy_from_slice(&11_811_u32.to_le_bytes());
        bmp[42..46].copy_from_slice(&11_811_u32.to_le_bytes());
        assert_eq!(bmp_resolution(&bmp).map(|found| found.px_per_mm), Some([11.811; 2]));
        bmp[14] = 12; // the header of OS/2, which has no resolution
        assert_eq!(bmp_resolution(&bmp), None);
    }

    #[test]
    fn square_pixels_without_a_unit_say_nothing() {
        assert_eq!(to_px_per_mm([1.0, 1.0], 1), None);
        assert_eq!(to_px_per_mm([100.0, 100.0], 3), Some([10.0, 10.0]));
    }
}
