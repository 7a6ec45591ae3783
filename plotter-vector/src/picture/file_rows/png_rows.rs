//! [`PngRows`]: a PNG by rows.

use super::metadata::Exif;
use super::pixels::{Channels, Pixels, Sample};
use super::{Opened, Refused, one_line};
use crate::picture::{FileFormat, FileNotes, Resolution, ResolutionSource};
use png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Reader, Transformations, Unit};
use std::io::{BufRead, Seek};

/// Most memory that the decoder may take for what is no picture, and for its rows, bytes.
const MAX_ALLOC_BYTES: usize = 1 << 24;

/// The rows of a PNG.
pub(super) struct PngRows<B: BufRead + Seek> {
    reader: Reader<B>,
    pixels: Pixels,
    bytes: Vec<u8>,
}

impl<B: BufRead + Seek> PngRows<B> {
    /// Reads what stands before the first row.
    pub(super) fn open(file: B) -> Result<Opened<Self>, Refused> {
        let refused = |error: DecodingError| Refused::Damaged(one_line(&error));
        let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MAX_ALLOC_BYTES });
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let header = decoder.read_header_info().map_err(refused)?;
        let (width, height) = header.size();
        Refused::check(width, height)?;
        let interlaced = header.interlaced;
        let (colour, depth) = (header.color_type, header.bit_depth);
        // A number a pixel goes through one table; for the rest a transparent colour becomes alpha.
        let numbers =
            depth != BitDepth::Sixteen && matches!(colour, ColorType::Grayscale | ColorType::Indexed);
        decoder.set_transformations(if numbers {
            Transformations::IDENTITY
        } else {
            Transformations::EXPAND
        });
        let reader = decoder.read_info().map_err(refused)?;
        let notes = notes(reader.info());
        if interlaced {
            return Ok(Opened { notes, rows: None });
        }
        let pixels = if numbers { table(&reader)? } else { samples(&reader) };
        let length = reader.output_line_size(width).unwrap_or(0);
        if length < pixels.row_bytes(width) {
            return Err(Refused::Damaged("rows of another length than the header says".into()));
        }
        let rows = Self { reader, pixels, bytes: vec![0; length] };
        Ok(Opened { notes, rows: Some(rows) })
    }

    /// Reads the next row: its bytes and what they mean.
    pub(super) fn read(&mut self) -> Result<(&Pixels, &[u8]), String> {
        match self.reader.read_row(&mut self.bytes) {
            Ok(Some(_)) => Ok((&self.pixels, &self.bytes)),
            Ok(None) => Err("the picture has fewer rows than its header says".into()),
            Err(error) => Err(one_line(&error)),
        }
    }

    pub(super) fn pixels(&mut self) -> &mut Pixels {
        &mut self.pixels
    }

    /// Looks at the checksums behind the last row.
    pub(super) fn end(&mut self) -> Result<(), String> {
        self.reader.read_row(&mut self.bytes).map(|_| ()).map_err(|error| one_line(&error))
    }
}

/// What stands before the pixels: `pHYs`, `eXIf` and `acTL`.
fn notes(info: &Info<'_>) -> FileNotes {
    let resolution = info.pixel_dims.and_then(|dims| {
        let per_unit = [f64::from(dims.xppu), f64::from(dims.yppu)];
        // Without a unit only the shape of a pixel is told, and that it is square is nothing new.
        let is_told = dims.unit == Unit::Meter || dims.xppu != dims.yppu;
        let px_per_mm = per_unit.map(|per_metre| per_metre / 1000.0);
        is_told.then_some(Resolution { px_per_mm, source: ResolutionSource::PngPhys, has_camera_tags: false })
    });
    let is_animated = info.animation_control.is_some_and(|control| control.num_frames > 1);
    let notes = FileNotes { resolution, is_animated, ..FileNotes::new(FileFormat::Png, info.size()) };
    info.exif_metadata.as_deref().map(Exif::read).unwrap_or_default().add_to(notes)
}

/// Grey or palette of up to 8 bits: the level or colour of each number.
fn table<B: BufRead + Seek>(reader: &Reader<B>) -> Result<Pixels, Refused> {
    let info = reader.info();
    let bits = info.bit_depth as u8;
    let clear = info.trns.as_deref().unwrap_or(&[]);
    if info.color_type == ColorType::Grayscale {
        let levels = Pixels::even_levels(bits);
        // One number may be wholly transparent.
        let Some(number) = clear.first() else { return Ok(Pixels::table(bits, levels)) };
        let mut colours = levels.map(|level| [level, level, level, 255]);
        if let Some([.., alpha]) = colours.get_mut(usize::from(*number)) {
            *alpha = 0;
        }
        return Ok(Pixels::palette(bits, colours));
    }
    let palette = info.palette.as_deref().ok_or_else(|| Refused::Damaged("a palette is missing".into()))?;
    let (colours, _) = palette.as_chunks::<3>();
    // More alphas than colours count as none, as in the decoder's own way with palettes.
    let clear = if clear.len() <= colours.len() { clear } else { &[] };
    let alphas = clear.iter().copied().chain(core::iter::repeat(255));
    // A number without a colour is black.
    let mut shown = [[0, 0, 0, 255]; 256];
    for ((shown, [red, green, blue]), alpha) in shown.iter_mut().zip(colours).zip(alphas) {
        *shown = [*red, *green, *blue, alpha];
    }
    Ok(Pixels::palette(bits, shown))
}

fn samples<B: BufRead + Seek>(reader: &Reader<B>) -> Pixels {
    let (colour, depth) = reader.output_color_type();
    let channels = match colour {
        // Palettes have become colours, which is why they are not met here.
        ColorType::Grayscale | ColorType::Indexed => Channels::Grey,
        ColorType::GrayscaleAlpha => Channels::GreyAlpha,
        ColorType::Rgb => Channels::Rgb,
        ColorType::Rgba => Channels::RgbAlpha,
    };
    let sample = if depth == BitDepth::Sixteen { Sample::BigEndian16 } else { Sample::Byte };
    Pixels::Samples { channels, sample, stride: colour.samples() }
}
