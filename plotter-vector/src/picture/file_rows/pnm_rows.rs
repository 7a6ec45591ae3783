//! [`PnmRows`]: PBM, PGM and PPM by rows, binary and in text.
//!
//! Source: the pages pbm(5), pgm(5) and ppm(5) of Netpbm.

use super::file_view::fill;
use super::pixels::{Channels, Pixels, Sample};
use super::{Opened, Refused, one_line};
use crate::picture::{FileFormat, FileNotes};
use image::codecs::pnm::{PnmDecoder, PnmSubtype, SampleEncoding};
use std::io::BufRead;

/// The rows of a PBM, PGM or PPM.
#[derive(Debug)]
pub(super) struct PnmRows<B> {
    file: B,
    text: bool,
    width: u32,
    /// The sample that is white.
    maxval: u16,
    pixels: Pixels,
    /// A row as the binary kinds have it.
    bytes: Vec<u8>,
}

impl<B: BufRead> PnmRows<B> {
    /// Reads the header.
    pub(super) fn open(file: B) -> Result<Opened<Self>, Refused> {
        let (file, header) =
            PnmDecoder::new(file).map_err(|error| Refused::Damaged(one_line(&error)))?.into_inner();
        let (width, height) = (header.width(), header.height());
        Refused::check(width, height)?;
        let notes = FileNotes::new(FileFormat::Pnm, (width, height));
        // The decoder has checked that it is 1 to 65535.
        let maxval = u16::try_from(header.maximal_sample()).unwrap_or(u16::MAX);
        let sample = if maxval <= 255 { Sample::Byte } else { Sample::BigEndian16 };
        let (encoding, pixels) = match header.subtype() {
            // 1 is black here, whatever a sample of 1 is elsewhere.
            PnmSubtype::Bitmap(encoding) => {
                (encoding, Pixels::Bits { zero_is_black: false, one_is_black: true })
            }
            PnmSubtype::Graymap(encoding) => {
                (encoding, Pixels::Samples { channels: Channels::Grey, sample, stride: 1 })
            }
            PnmSubtype::Pixmap(encoding) => {
                (encoding, Pixels::Samples { channels: Channels::Rgb, sample, stride: 3 })
            }
            PnmSubtype::ArbitraryMap => return Ok(Opened { notes, rows: None }),
        };
        let text = encoding == SampleEncoding::Ascii;
        let bytes = vec![0; pixels.row_bytes(width)];
        let rows = Self { file, text, width, maxval, pixels, bytes };
        Ok(Opened { notes, rows: Some(rows) })
    }

    /// Reads the next row: its bytes and what they mean.
    pub(super) fn read(&mut self) -> Result<(&Pixels, &[u8]), String> {
        match (&self.pixels, self.text) {
            (Pixels::Bits { .. }, true) => self.bits_in_text()?,
            (_, true) => self.samples_in_text()?,
            (_, false) => fill(&mut self.file, &mut self.bytes)?,
        }
        match (&self.pixels, self.maxval) {
            (Pixels::Bits { .. }, _) | (_, 255 | 65535) => {}
            (_, 1..255) => {
                for byte in &mut self.bytes {
                    let scaled = scale(u16::from(*byte), self.maxval, 255);
                    *byte = u8::try_from(scaled).unwrap_or(u8::MAX);
                }
            }
            _ => {
                let (samples, _) = self.bytes.as_chunks_mut::<2>();
                for sample in samples {
                    *sample = scale(u16::from_be_bytes(*sample), self.maxval, 65535).to_be_bytes();
                }
            }
        }
        Ok((&self.pixels, &self.bytes))
    }

    pub(super) fn pixels(&mut self) -> &mut Pixels {
        &mut self.pixels
    }

    /// Bits in text: any white space or none between them.
    fn bits_in_text(&mut self) -> Result<(), String> {
        self.bytes.fill(0);
        for column in 0..self.width {
            let bit = loop {
                match next_byte(&mut self.file)? {
                    Some(b'0') => break 0,
                    Some(b'1') => break 1,
                    Some(space) if is_space(space) => {}
                    Some(other) => return Err(format!("the byte {other:02x} where 0 or 1 is expected")),
                    None => return Err("it ends here".into()),
                }
            };
            if let Some(byte) = self.bytes.get_mut(column as usize / 8) {
                *byte |= bit << (7 - column % 8);
            }
        }
        Ok(())
    }

    /// Numbers in text, as the bytes of the binary kind.
    fn samples_in_text(&mut self) -> Result<(), String> {
        if self.maxval <= 255 {
            for byte in &mut self.bytes {
                let number = number(&mut self.file)?;
                *byte = u8::try_from(number).map_err(|_| format!("the sample {number}, above 255"))?;
            }
        } else {
            for pair in self.bytes.as_chunks_mut::<2>().0 {
                *pair = number(&mut self.file)?.to_be_bytes();
            }
        }
        Ok(())
    }
}

/// White space of the format.
fn is_space(byte: u8) -> bool {
    matches!(byte, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | b' ')
}

fn next_byte(file: &mut impl BufRead) -> Result<Option<u8>, String> {
    let byte = file.fill_buf().map_err(|error| one_line(&error))?.first().copied();
    file.consume(usize::from(byte.is_some()));
    Ok(byte)
}

/// The next number, and the one space behind it.
fn number(file: &mut impl BufRead) -> Result<u16, String> {
    let mut found: Option<u16> = None;
    loop {
        let buffer = file.fill_buf().map_err(|error| one_line(&error))?;
        if buffer.is_empty() {
            return found.ok_or_else(|| "it ends here".into());
        }
        let mut used = 0;
        let mut ended = false;
        for byte in buffer {
            used += 1;
            match byte {
                b'0'..=b'9' => {
                    let number = found.unwrap_or(0).checked_mul(10);
                    let number = number.and_then(|number| number.checked_add(u16::from(byte - b'0')));
                    found = Some(number.ok_or("a sample above 65535")?);
                }
                space if is_space(*space) => {
                    ended = found.is_some();
                    if ended {
                        break;
                    }
                }
                other => return Err(format!("the byte {other:02x} where a number is expected")),
            }
        }
        file.consume(used);
        if let Some(number) = found.filter(|_| ended) {
            return Ok(number);
        }
    }
}

/// A sample of `maxval` levels as one of `white`, to nearest; above `maxval` it is white.
fn scale(sample: u16, maxval: u16, white: u16) -> u16 {
    // In `f32`, as `image` does it, so that both ways to read a picture give the same levels.
    let scaled = libm::roundf(f32::from(sample) * (f32::from(white) / f32::from(maxval)));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole and not negative; the cast stops at the greatest, as wanted"
    )]
    let scaled = scaled as u16;
    scaled.min(white)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_parted_by_any_space_and_end_with_the_file() {
        let mut text: &[u8] = b" \n007\t12\x0c65535";
        assert_eq!([number(&mut text), number(&mut text), number(&mut text)], [Ok(7), Ok(12), Ok(65535)]);
        assert_eq!(number(&mut text), Err("it ends here".into()));
        assert!(number(&mut &b"65536"[..]).is_err());
        assert!(number(&mut &b"1x"[..]).is_err());
    }

    #[test]
    fn a_number_may_lie_across_two_buffers() {
        let mut text = std::io::BufReader::with_capacity(2, &b"  123 45\n"[..]);
        assert_eq!([number(&mut text), number(&mut text)], [Ok(123), Ok(45)]);
    }

    #[test]
    fn samples_are_spread_up_to_white() {
        assert_eq!([0, 1, 2, 3, 4].map(|sample| scale(sample, 3, 255)), [0, 85, 170, 255, 255]);
        assert_eq!(scale(4095, 4095, 65535), 65535);
    }
}
