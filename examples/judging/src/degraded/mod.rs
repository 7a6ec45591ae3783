//! Drawings as people have them: photographed, in pencil, enlarged, faint. What `degrade_corpus` makes.
//!
//! [`drawing`] draws, another sheet for each seed and number; [`Drawn::degraded`] makes a file of it as a
//! scanner, a telephone or a program would, in one of the [`Kind`]s, at one [`Strength`]. [`PARAMETERS`] says
//! in numbers what that is.

mod cover;
mod drawings;
mod drawn;
mod ink_on_paper;
mod kind;
mod parameters;
mod photographed;
mod plane;
mod scanned;
mod sheet;
mod texture;

pub use drawings::drawing;
pub use drawn::Drawn;
pub use kind::{Kind, Strength};
pub use parameters::{PARAMETERS, Parameter, parameter_table};

use crate::corpus::random::Random;
use crate::corpus::{Truth, View};
pub(crate) use cover::cover;
use drawings::mixed;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use image::{DynamicImage, GrayImage, ImageFormat, ImageResult};
pub(crate) use photographed::{light, rules};
pub(crate) use plane::Plane;
pub(crate) use sheet::Sheet;
use sheet::{grey_picture, ink_picture};
use std::io::Cursor;

/// A drawing as a file, and all that is known about it.
#[derive(Debug)]
pub struct Degraded {
    /// The file.
    pub file: Vec<u8>,
    /// The end of its name: `png`, or `jpg`.
    pub extension: &'static str,
    /// What was drawn, and where it is seen.
    pub truth: Truth,
    /// The undegraded ink in the file's pixels: black where a stroke covers half of a pixel or more.
    pub ink: GrayImage,
}

impl Drawn {
    /// The drawing degraded in one way; `number` names it, and `seed` with that decides what is left to
    /// chance.
    ///
    /// # Errors
    ///
    /// A picture that cannot be encoded; none of these is.
    pub fn degraded(&self, kind: Kind, strength: Strength, seed: u64, number: u32) -> ImageResult<Degraded> {
        // The same for all strengths: the same scene, only worse.
        let random = &mut Random::new(mixed(mixed(seed, u64::from(number)), kind as u64 + 1000));
        let cover = &self.cover;
        let mut truth = Truth::of(&self.picture);
        truth.name = format!("{}_{}_{number:02}", kind.name(), strength.name());
        let mut ink = None;
        let picture = match kind {
            Kind::Clean => grey_picture(&scanned::clean(cover, strength, random)),
            Kind::Pencil => grey_picture(&ink_on_paper::pencil(cover, strength, random)),
            Kind::Chalk => ink_on_paper::chalk(cover, strength, random).picture(),
            Kind::Marker => ink_on_paper::marker(cover, strength, random).picture(),
            Kind::Photo => photographed::photo(cover, strength, random).picture(),
            Kind::Reflections => photographed::reflections(cover, strength, random).picture(),
            Kind::Squared => photographed::squared(cover, strength, random).picture(),
            Kind::Perspective => match photographed::perspective(cover, strength, random) {
                Some((sheet, seen, homography)) => {
                    let picture = sheet.picture();
                    truth.view = Some(View { width: picture.width(), height: picture.height(), homography });
                    ink = Some(ink_picture(&seen));
                    picture
                }
                // Corners so little moved never lie in a line; a plain scan is right in any case.
                None => grey_picture(&scanned::clean(cover, strength, random)),
            },
            Kind::Jpeg => grey_picture(&scanned::for_jpeg(cover, random)),
            Kind::EnlargedNearest | Kind::EnlargedBicubic => {
                let factor = parameters::ENLARGED_FACTOR.at(strength);
                let (small, pen) = scanned::small(self, factor, strength);
                for line in &mut truth.polylines {
                    line.width = pen(line.width);
                }
                for width in &mut truth.stroke_width {
                    *width = pen(*width);
                }
                truth.stroke_width.dedup();
                let size = (cover.width, cover.height);
                ink = Some(ink_picture(&self::cover(&self.picture.strokes, size, |at| at, pen)));
                enlarged(&small, cover, factor, kind)
            }
            Kind::Faint => grey_picture(&scanned::faint(cover, strength, random)),
            Kind::BleedThrough => grey_picture(&scanned::bleed_through(cover, self.back(), strength, random)),
            Kind::Newsprint => ink_on_paper::newsprint(cover, strength, random).picture(),
        };
        let quality = match kind {
            Kind::Jpeg => Some(parameters::JPEG_QUALITY),
            Kind::EnlargedNearest | Kind::EnlargedBicubic if number % 2 == 1 => {
                Some(parameters::ENLARGED_JPEG)
            }
            _ => None,
        };
        let mut file = Cursor::new(Vec::new());
        match quality {
            Some(quality) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "qualities are whole and at most 100"
                )]
                let quality = quality.at(strength) as u8;
                picture.write_with_encoder(JpegEncoder::new_with_quality(&mut file, quality))?;
            }
            None => picture.write_to(&mut file, ImageFormat::Png)?,
        }
        Ok(Degraded {
            file: file.into_inner(),
            extension: if quality.is_some() { "jpg" } else { "png" },
            truth,
            ink: ink.unwrap_or_else(|| ink_picture(cover)),
        })
    }
}

/// The small picture blown up, and cut to the drawing's size.
fn enlarged(small: &Plane, full: &Plane, factor: f64, kind: Kind) -> DynamicImage {
    let side = |small: usize| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole factor")]
        let side = (small as f64 * factor) as u32;
        side
    };
    let filter = if kind == Kind::EnlargedNearest { FilterType::Nearest } else { FilterType::CatmullRom };
    let large = resize(&grey_picture(small).into_luma8(), side(small.width), side(small.height), filter);
    let size = [full.width, full.height].map(|side| u32::try_from(side).unwrap_or(0));
    DynamicImage::from(large).crop_imm(0, 0, size[0], size[1])
}
