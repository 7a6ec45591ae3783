//! [`Layout`]: what the tags of a TIFF say about where its pixels are and what they mean.
//!
//! Source: TIFF revision 6.0 (1992); the numbers of the sections stand at each tag.

use super::codec::Compression;
use super::file_view::FileView;
use super::metadata::to_px_per_mm;
use super::pixels::{Channels, Pixels, Sample};
use super::{Refused, one_line};
use crate::picture::{FileFormat, FileNotes, Orientation, Resolution, ResolutionSource};
use std::collections::BTreeSet;
use std::io::{BufReader, Read, Seek};
use tiff::TiffError;
use tiff::decoder::{Decoder, ifd::Value};
use tiff::tags::{ByteOrder, Tag};

/// Most memory of a band of tiles, bytes.
pub(super) const MAX_BAND_BYTES: usize = 1 << 24;

/// Where a block is in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BlockSpan {
    pub(super) offset: u64,
    pub(super) length: u64,
}

/// Blocks side by side and one below the other: strips are as wide as the picture, tiles are not.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) height: u32,
    pub(super) pixels: Pixels,
    pub(super) compression: Compression,
    /// Whether the bits of each byte are stored in reverse (`FillOrder`, section 8).
    pub(super) reversed: bool,
    /// Whether a row holds differences to the pixel on the left (`Predictor`, section 14).
    pub(super) differences: bool,
    pub(super) block_width: u32,
    pub(super) block_height: u32,
    /// Blocks side by side.
    pub(super) across: usize,
    pub(super) tiled: bool,
    pub(super) places: Vec<BlockSpan>,
}

/// The tags, with what they are when they are missing.
struct Tags<R: Read + Seek> {
    decoder: Decoder<BufReader<FileView<R>>>,
}

impl<R: Read + Seek> Tags<R> {
    fn list(&mut self, tag: Tag) -> Result<Vec<u64>, Refused> {
        let list = self.decoder.find_tag_unsigned_vec(tag).map_err(|error| refused(&error))?;
        Ok(list.unwrap_or_default())
    }

    /// The first number; with one for each sample, all must be the same.
    fn number(&mut self, tag: Tag, missing: u64) -> Result<u64, Refused> {
        let list = self.list(tag)?;
        let first = list.first().copied().unwrap_or(missing);
        if list.iter().any(|number| *number != first) {
            return Err(unsupported(&format!("with different values of {tag:?} for its samples")));
        }
        Ok(first)
    }

    fn side(&mut self, tag: Tag, missing: u32) -> Result<u32, Refused> {
        let side = self.number(tag, missing.into())?;
        Ok(u32::try_from(side).unwrap_or(u32::MAX).max(1))
    }
}

fn refused(error: &TiffError) -> Refused {
    match error {
        TiffError::UnsupportedError(what) => unsupported(&one_line(what)),
        other => Refused::Damaged(one_line(other)),
    }
}

fn unsupported(what: &str) -> Refused {
    Refused::Unsupported(format!("a TIFF {what}"))
}

impl Layout {
    /// Reads the tags of a page.
    pub(super) fn read<R: Read + Seek>(file: &FileView<R>, page: u32) -> Result<(Self, FileNotes), Refused> {
        let mut decoder = Decoder::new(BufReader::new(file.at(0))).map_err(|error| refused(&error))?;
        let pages = pages(&mut decoder);
        let count = u32::try_from(pages.len()).unwrap_or(u32::MAX);
        let wanted = page.checked_sub(1).and_then(|index| pages.get(index as usize));
        let index = *wanted.ok_or(Refused::NoSuchPage { page, pages: count })?;
        if index > 0 {
            decoder.seek_to_image(index).map_err(|error| refused(&error))?;
        }
        let mut tags = Tags { decoder };
        let width = tags.side(Tag::ImageWidth, 0)?;
        let height = tags.side(Tag::ImageLength, 0)?;
        Refused::check(width, height)?;
        let notes = FileNotes {
            resolution: resolution(&mut tags.decoder),
            page,
            pages: count,
            ..FileNotes::new(FileFormat::Tiff, (width, height))
        };
        let orientation = u32::try_from(tags.number(Tag::Orientation, 1)?).ok();
        let notes = notes.with_orientation(orientation.and_then(Orientation::of_number).unwrap_or_default());
        let pixels = pixels(&mut tags)?;
        let compression = compression(tags.number(Tag::Compression, 1)?)?;
        let differences = match tags.number(Tag::Predictor, 1)? {
            1 => false,
            2 if matches!(compression, Compression::None | Compression::PackBits | Compression::Group4) => {
                false
            }
            2 if pixels.bits_per_pixel() >= 8 => true,
            other => return Err(unsupported(&format!("with predictor {other}"))),
        };
        if compression == Compression::Group4 && pixels.bits_per_pixel() != 1 {
            return Err(Refused::Damaged("CCITT group 4 of pixels of more than 1 bit".into()));
        }
        let tiled = !tags.list(Tag::TileOffsets)?.is_empty();
        let (offsets, lengths, block_width, block_height) = if tiled {
            let (wide, high) = (tags.side(Tag::TileWidth, width)?, tags.side(Tag::TileLength, height)?);
            (tags.list(Tag::TileOffsets)?, tags.list(Tag::TileByteCounts)?, wide, high)
        } else {
            let high = tags.side(Tag::RowsPerStrip, u32::MAX)?;
            (tags.list(Tag::StripOffsets)?, tags.list(Tag::StripByteCounts)?, width, high)
        };
        let places: Vec<BlockSpan> =
            offsets.into_iter().zip(lengths).map(|(offset, length)| BlockSpan { offset, length }).collect();
        let across = width.div_ceil(block_width) as usize;
        let layout = Self {
            height,
            pixels,
            compression,
            reversed: tags.number(Tag::FillOrder, 1)? == 2,
            differences,
            block_width,
            block_height: block_height.min(height),
            across,
            tiled,
            places,
        };
        layout.check_tiles()?;
        if layout.places.len() < across * height.div_ceil(block_height) as usize {
            return Err(Refused::Damaged("fewer strips or tiles than its size asks for".into()));
        }
        Ok((layout, notes))
    }

    fn check_tiles(&self) -> Result<(), Refused> {
        let bits = self.block_width as usize * self.pixels.bits_per_pixel();
        if self.across > 1 && !bits.is_multiple_of(8) {
            return Err(unsupported("of tiles whose rows do not end with a byte"));
        }
        let band = (bits.div_ceil(8) * self.across).saturating_mul(self.block_height as usize);
        if self.tiled && band > MAX_BAND_BYTES {
            return Err(unsupported(&format!(
                "of tiles {} px high, a band of which takes {} MiB",
                self.block_height,
                band >> 20
            )));
        }
        Ok(())
    }

    /// Bytes of a row of a block.
    pub(super) fn block_row_bytes(&self) -> usize {
        self.pixels.row_bytes(self.block_width)
    }
}

/// The places among the directories of those that are pages: not those of smaller copies or masks of others
/// (`NewSubfileType`, section 8). Where all are, it is the first.
fn pages<R: Read + Seek>(decoder: &mut Decoder<BufReader<FileView<R>>>) -> Vec<usize> {
    /// More directories than this are not looked at; they might be without end.
    const MAX_DIRECTORIES: usize = 1 << 12;
    const COPY_OR_MASK: u64 = 0b101;
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    let mut next = decoder.ifd_pointer();
    while let Some(place) = next.filter(|place| seen.len() < MAX_DIRECTORIES && seen.insert(place.0)) {
        // A directory that cannot be read ends the chain; the pages before it are good.
        let Ok(directory) = decoder.read_directory(place) else { break };
        let kind = decoder.read_directory_tags(&directory).find_tag_unsigned::<u64>(Tag::NewSubfileType);
        if kind.ok().flatten().unwrap_or(0) & COPY_OR_MASK == 0 {
            found.push(seen.len() - 1);
        }
        next = directory.next();
    }
    if found.is_empty() {
        found.push(0);
    }
    found
}

/// `XResolution`, `YResolution` and `ResolutionUnit`, section 8; what is damaged is left out. A lens is told
/// by the directory of EXIF.
fn resolution<R: Read + Seek>(decoder: &mut Decoder<BufReader<FileView<R>>>) -> Option<Resolution> {
    /// `ExposureTime`, `FNumber` and `FocalLength` of EXIF.
    const OF_A_LENS: [u16; 3] = [33_434, 33_437, 37_386];
    let mut per_unit = |tag| match decoder.find_tag(tag).ok().flatten()? {
        Value::Rational(above, below) => Some(f64::from(above) / f64::from(below)),
        Value::Float(number) => Some(f64::from(number)),
        Value::Double(number) => Some(number),
        other => other.into_u32().ok().map(f64::from),
    };
    let both = [per_unit(Tag::XResolution)?, per_unit(Tag::YResolution)?];
    let unit = decoder.find_tag_unsigned::<u32>(Tag::ResolutionUnit).ok().flatten();
    let exif = decoder.find_tag(Tag::ExifDirectory).ok().flatten().and_then(|at| at.into_ifd_pointer().ok());
    let exif = exif.and_then(|at| decoder.read_directory(at).ok());
    let has_camera_tags =
        exif.is_some_and(|exif| OF_A_LENS.iter().any(|tag| exif.contains(Tag::Unknown(*tag))));
    let px_per_mm = to_px_per_mm(both, unit.unwrap_or(2))?;
    Some(Resolution { px_per_mm, source: ResolutionSource::Tiff, has_camera_tags })
}

/// `Compression`, sections 8 to 11 and 13; Deflate from the technical note of 1995.
fn compression(number: u64) -> Result<Compression, Refused> {
    let name = match number {
        1 => return Ok(Compression::None),
        4 => return Ok(Compression::Group4),
        5 => return Ok(Compression::Lzw),
        8 | 32946 => return Ok(Compression::Deflate),
        32773 => return Ok(Compression::PackBits),
        2 | 3 => "CCITT group 3".into(),
        6 | 7 => "JPEG".into(),
        50000 => "Zstandard".into(),
        other => format!("kind {other}"),
    };
    Err(unsupported(&format!("with compression of {name}")))
}

/// What the pixels mean: `PhotometricInterpretation` and its company, sections 3 to 6, 18 and 21.
fn pixels<R: Read + Seek>(tags: &mut Tags<R>) -> Result<Pixels, Refused> {
    let samples = usize::try_from(tags.number(Tag::SamplesPerPixel, 1)?).unwrap_or(usize::MAX);
    let bits = tags.number(Tag::BitsPerSample, 1)?;
    let meaning = tags.number(Tag::PhotometricInterpretation, u64::MAX)?;
    let planes = tags.number(Tag::PlanarConfiguration, 1)?;
    let extra = tags.list(Tag::ExtraSamples)?.first().copied();
    if tags.number(Tag::SampleFormat, 1)? != 1 {
        return Err(unsupported("of numbers that are not whole or may be negative"));
    }
    if planes == 2 && samples > 1 {
        return Err(unsupported("with a plane for each colour"));
    }
    let sample = match (bits, tags.decoder.byte_order()) {
        (16, ByteOrder::BigEndian) => Sample::BigEndian16,
        (16, ByteOrder::LittleEndian) => Sample::LittleEndian16,
        _ => Sample::Byte,
    };
    match (meaning, samples, bits) {
        (0 | 1 | 3, 1, 1 | 2 | 4 | 8) => {
            let bits = u8::try_from(bits).unwrap_or(8);
            let mut levels = Pixels::even_levels(bits);
            if meaning == 0 {
                levels = levels.map(|level| 255 - level);
            }
            if meaning == 3 {
                return Ok(Pixels::palette(bits, palette(&tags.list(Tag::ColorMap)?, bits)?));
            }
            Ok(Pixels::table(bits, levels))
        }
        (1, 1.., 8 | 16) | (2, 3.., 8 | 16) if samples <= 16 => {
            let grey = meaning == 1;
            let covered = samples > if grey { 1 } else { 3 };
            let channels = match (grey, extra.filter(|_| covered)) {
                (true, Some(1)) => Channels::GreyCover,
                (true, Some(2)) => Channels::GreyAlpha,
                (true, _) => Channels::Grey,
                (false, Some(1)) => Channels::RgbCover,
                (false, Some(2)) => Channels::RgbAlpha,
                (false, _) => Channels::Rgb,
            };
            Ok(Pixels::Samples { channels, sample, stride: samples })
        }
        _ => Err(unsupported(&format!(
            "of {samples} samples of {bits} bits with photometric interpretation {meaning}"
        ))),
    }
}

/// `ColorMap`, section 5: all reds, all greens, all blues, of 16 bits.
///
/// The high byte is taken: writers make 16 bits of 8 by 256 or by 257, and it is right for both. Some old
/// ones leave 8 bits as they are.
fn palette(map: &[u64], bits: u8) -> Result<[[u8; 4]; 256], Refused> {
    let count = 1_usize << bits;
    if map.len() < 3 * count {
        return Err(Refused::Damaged("a palette of too few colours".into()));
    }
    let shift = if map.iter().all(|value| *value < 256) { 0 } else { 8 };
    let value = |index: usize| {
        let value = map.get(index).copied().unwrap_or(0) >> shift;
        u8::try_from(value).unwrap_or(u8::MAX)
    };
    Ok(core::array::from_fn(|number| {
        if number < count {
            [value(number), value(count + number), value(2 * count + number), 255]
        } else {
            [0, 0, 0, 255]
        }
    }))
}
