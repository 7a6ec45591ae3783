//! [`PenPicture`]: ways in which a sheet of several pens becomes a picture.

use super::PenSheet;
use crate::corpus::random::Random;
use crate::degraded::{Plane, Sheet, cover, light, rules};
use clap::ValueEnum;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat, ImageResult};
use std::io::Cursor;

/// Light at the darkest place of a photograph, of that at the brightest: by a window.
const PHOTO_LEAST: f64 = 0.5;
/// Noise of a photograph, and of the noisy scan, sd, levels.
const PHOTO_NOISE: f64 = 3.0;
const NOISE: f64 = 6.0;
/// Blur of a photograph, and of the blurred picture, sd, px.
const PHOTO_BLUR_PX: f64 = 0.6;
const BLUR_PX: f64 = 1.0;
/// Quality of the compressed picture.
const QUALITY: u8 = 85;
/// Paper: white, as a telephone sees it, and tinted.
const WHITE: [f64; 3] = [255.0; 3];
const LAMP: [f64; 3] = [238.0, 232.0, 220.0];
const TINTED: [f64; 3] = [240.0, 224.0, 188.0];
/// Contrast of a squared paper's pale blue lines, levels.
const SQUARED: [f64; 3] = [45.0, 35.0, 22.0];

/// How a sheet becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PenPicture {
    /// Each pixel of one pen, or paper.
    Clean,
    /// With rims, as programs draw.
    Soft,
    /// Out of focus by a pixel.
    Blurred,
    /// JPEG of quality 85, its colours at half the resolution.
    Jpeg,
    /// A noisy scan.
    Noisy,
    /// In uneven light, a little noisy and blurred.
    Photo,
    /// On yellowish paper.
    Tinted,
    /// On squared paper.
    Squared,
}

impl PenPicture {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Clean,
        Self::Soft,
        Self::Blurred,
        Self::Jpeg,
        Self::Noisy,
        Self::Photo,
        Self::Tinted,
        Self::Squared,
    ];

    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Soft => "soft",
            Self::Blurred => "blurred",
            Self::Jpeg => "jpeg",
            Self::Noisy => "noisy",
            Self::Photo => "photo",
            Self::Tinted => "tinted",
            Self::Squared => "squared",
        }
    }

    /// The end of its files' names.
    #[must_use]
    pub fn extension(self) -> &'static str {
        if self == Self::Jpeg { "jpg" } else { "png" }
    }
}

impl PenSheet {
    /// The sheet as a picture file; `seed` decides noise and light.
    ///
    /// # Errors
    ///
    /// A picture that cannot be encoded; none of these is.
    pub fn picture(&self, shown: PenPicture, seed: u64) -> ImageResult<Vec<u8>> {
        let random = &mut Random::new(seed.wrapping_mul(100).wrapping_add(shown as u64));
        let size = (self.picture.width as usize, self.picture.height as usize);
        let paper = match shown {
            PenPicture::Photo => LAMP,
            PenPicture::Tinted => TINTED,
            _ => WHITE,
        };
        let mut sheet = Sheet::inked(paper, paper, &Plane::even(size.0, size.1, 0.0));
        if shown == PenPicture::Squared {
            let mut contrast = SQUARED.iter();
            let ruling = rules(size, random);
            sheet.channels = sheet.channels.map(|plane| {
                let contrast = contrast.next().copied().unwrap_or(0.0);
                plane.with(&ruling, |level, share| level - contrast * share)
            });
        }
        for stroke in self.strokes() {
            let cover = cover(core::slice::from_ref(stroke), size, |at| at, |pen| pen);
            // Nothing between ink and paper.
            let cover = if shown == PenPicture::Clean { cover.map(libm::round) } else { cover };
            let mut ink = stroke.colour.iter();
            sheet.channels = sheet.channels.map(|plane| {
                let ink = f64::from(ink.next().copied().unwrap_or(0));
                plane.with(&cover, |level, share| level + (ink - level) * share)
            });
        }
        let sheet = match shown {
            PenPicture::Clean | PenPicture::Soft | PenPicture::Tinted => sheet,
            PenPicture::Blurred => sheet.blurred(BLUR_PX),
            PenPicture::Jpeg => colours_halved(&sheet),
            PenPicture::Noisy => sheet.noisy(NOISE, 0.0, random),
            PenPicture::Photo => sheet.lit(&light(size, PHOTO_LEAST, random)).blurred(PHOTO_BLUR_PX).noisy(
                PHOTO_NOISE,
                0.6,
                random,
            ),
            PenPicture::Squared => sheet.noisy(1.5, 0.0, random),
        };
        let mut file = Cursor::new(Vec::new());
        let picture: DynamicImage = sheet.picture();
        if shown == PenPicture::Jpeg {
            picture.write_with_encoder(JpegEncoder::new_with_quality(&mut file, QUALITY))?;
        } else {
            picture.write_to(&mut file, ImageFormat::Png)?;
        }
        Ok(file.into_inner())
    }
}

/// As cameras store it: the brightness of every pixel, and one colour for two by two.
fn colours_halved(sheet: &Sheet) -> Sheet {
    let [red, green, blue] = &sheet.channels;
    let luma = red
        .with(green, |red, green| 0.299 * red + 0.587 * green)
        .with(blue, |other, blue| other + 0.114 * blue);
    let channels = sheet.channels.each_ref().map(|channel| {
        let colour = channel.with(&luma, |channel, luma| channel - luma);
        let mean = Plane::from_fn(colour.width, colour.height, |x, y| {
            let even = |at: f64| 2.0 * libm::floor(at / 2.0);
            colour.at(even(x) + 0.5, even(y) + 0.5)
        });
        luma.with(&mean, |luma, colour| luma + colour)
    });
    Sheet { channels }
}
