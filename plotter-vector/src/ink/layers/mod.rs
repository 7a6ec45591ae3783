//! [`Pens`]: from a picture in colour to the ink of each pen, [`Layers`].

mod bridge_gaps;
mod cores;
mod find_pens;
mod histogram;
mod label_pixels;
mod light;
mod mixing_line;
mod mixtures;
mod ruling;
mod unassigned;

use crate::picture::oklab::OklabTable;
use crate::{
    ink::{MAX_PENS, Palette, PalettePen},
    picture::{Bitmap, Colour, Gray, Rgb},
};
use core::fmt;
use histogram::Histogram;
use light::Light;
use mixing_line::MixingLine;
pub use unassigned::Unassigned;
use unassigned::unassigned;

/// Which pens have drawn a picture. The default finds them.
///
/// The paper is the most frequent colour; where the light is uneven, as in a photograph, all colours are first
/// divided by that of the paper around. A pen is told by the middle of its lines, where its colour is neither
/// mixed with the paper nor with another pen; around such cores ink belongs to their pens. A pixel is ink of a
/// pen when the pen covers half of it or more on the way from the paper's colour to the pen's own. Rims, which
/// are mixtures with the paper, go to the pen that they are a rim of by their direction from the paper, not to
/// the nearest colour: the grey rim of a black stroke is black. Where two pens meet, a mixed pixel goes to the
/// one that has more of it.
///
/// ```
/// # use plotter_vector::{Colour, Rgb, ink::Pens};
/// let [paper, black, red, pink] = [[255, 255, 255], [0, 0, 0], [208, 24, 24], [220, 90, 90]];
/// let row = [[paper; 16], [black; 16], [paper; 16], [red; 16], [pink; 16], [paper; 16]].concat();
/// let picture = Colour::new(16, 6, row.as_flattened().to_vec())?;
/// let layers = Pens::Found.separate(&picture)?;
/// assert_eq!(layers.paper(), Rgb::WHITE);
/// let found: Vec<(u8, u64)> = layers.iter().map(|(pen, ink)| (pen.number, ink.count())).collect();
/// assert_eq!(found, [(1, 16), (2, 32)]); // black, and red with its rim
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Pens {
    /// As many as there are: colours that differ in the middle of lines, or whose lines to the paper differ, and
    /// that draw at least 0.3 % of the ink. A colour and a paler one of the same hue, as black and pencil, are
    /// two pens where the paler one has less than seven tenths of the contrast and nothing lies between; else
    /// they are one, pressed harder and less. The ruling of squared paper is none. Without ink, one black pen.
    #[default]
    Found,
    /// This many, from 1 to [`MAX_PENS`]; fewer when the picture has fewer.
    Count(usize),
    /// These. A pen may have faded, or the scanner be off, by a fifth of the way from black to white. Ink of
    /// no given pen goes to the one that it is most like.
    Given(Palette),
}

/// Why a picture cannot be shared among pens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PensError {
    /// No pens, or too many of them.
    Count {
        /// What was asked.
        count: usize,
    },
}

impl fmt::Display for PensError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { count } => {
                write!(f, "{count} pens cannot be found: ask for 1 to {MAX_PENS}, or leave the number open")
            }
        }
    }
}

impl core::error::Error for PensError {}

impl Pens {
    /// Shares the ink of a picture among the pens. Found pens are numbered from 1, the darkest first.
    ///
    /// Takes one bit a pixel and pen five times over, a byte a pixel, three more in uneven light, and 2 MB.
    /// The result depends on nothing but the picture.
    ///
    /// # Errors
    /// [`PensError`].
    pub fn separate(&self, picture: &Colour) -> Result<Layers, PensError> {
        self.shared_out(picture, false)
    }

    /// The same; `keeps_ruling` takes the ruling of paper for a pen's.
    pub(crate) fn shared_out(&self, picture: &Colour, keeps_ruling: bool) -> Result<Layers, PensError> {
        let count = match self {
            Self::Count(count) if !(1..=MAX_PENS).contains(count) => {
                return Err(PensError::Count { count: *count });
            }
            Self::Count(count) => Some(*count),
            Self::Found | Self::Given(_) => None,
        };
        let table = OklabTable::new();
        let light = Light::of(picture);
        let evened = light.as_ref().map(|light| light.evened(picture));
        let picture = evened.as_ref().unwrap_or(picture);
        let histogram = Histogram::new(picture, &table);
        let cores = cores::cores(picture, &histogram);
        let find = |count: Option<usize>| match self {
            Self::Given(palette) => find_pens::seen(&histogram, palette, &table),
            Self::Found | Self::Count(_) => {
                find_pens::find(&histogram, cores::pens(&cores, histogram.paper, &table), count, &table)
            }
        };
        let size = (picture.width(), picture.height());
        let label = |lines: &[MixingLine]| {
            let seeds = cores::seeds(&cores, lines, size, &table);
            label_pixels::label(picture, &histogram, lines, &seeds, &table)
        };
        let mut lines = find(count);
        let mut ink = label(&lines);
        if *self == Self::Found
            && let Some(pens) = mixtures::without_mixtures(&lines, &ink, &table)
        {
            lines = pens;
            ink = label(&lines);
        }
        let mut ruling = None;
        if !matches!(self, Self::Given(_)) && !keeps_ruling {
            let paper = table.oklab(histogram.paper);
            let mut found = ruling::ruling(&lines, &ink, paper);
            if let (Some(_), Some(count)) = (found, count) {
                // It has taken the place of a pen.
                lines = find(Some(count + 1));
                ink = label(&lines);
                found = ruling::ruling(&lines, &ink, paper);
            }
            ruling = found.map(|found| Ruling { colour: lines.remove(found).pen(), ink: ink.remove(found) });
        }
        let palette = match self {
            Self::Given(palette) => palette.clone(),
            _ if lines.is_empty() => Palette::default(),
            _ => Palette::found(lines.iter().map(MixingLine::pen)),
        };
        // A sheet without ink still has its one pen.
        let empty = || Bitmap::new(picture.width(), picture.height()).unwrap_or_else(|_| Bitmap::empty());
        ink.resize_with(palette.pens().len(), empty);
        Ok(Layers { paper: histogram.paper, palette, lines, ink, light, ruling })
    }
}

/// The ink of each pen of a picture. Every ink pixel is in exactly one of them, save after
/// [`Layers::bridged`].
#[derive(Clone, Debug)]
pub struct Layers {
    paper: Rgb,
    palette: Palette,
    /// From the paper to each pen's colour on the picture; none on a sheet without ink.
    lines: Vec<MixingLine>,
    ink: Vec<Bitmap>,
    /// The light on the picture, where it is uneven.
    light: Option<Light>,
    /// The lines of squared paper, which no pen drew.
    ruling: Option<Ruling>,
}

#[derive(Clone, Debug)]
struct Ruling {
    colour: Rgb,
    ink: Bitmap,
}

impl Layers {
    /// The colour of the paper.
    #[must_use]
    pub const fn paper(&self) -> Rgb {
        self.paper
    }

    /// The pens, given or found.
    #[must_use]
    pub const fn palette(&self) -> &Palette {
        &self.palette
    }

    /// Each pen and its ink, in the order of the palette.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&PalettePen, &Bitmap)> {
        self.palette.pens().iter().zip(&self.ink)
    }

    /// The ink of the pen with this index in the palette.
    #[must_use]
    pub fn ink(&self, index: usize) -> Option<&Bitmap> {
        self.ink.get(index)
    }

    /// The ink of a pen with its strokes made whole where another pen has crossed them: pixels of other pens
    /// between two ends that face each other count for this pen too.
    ///
    /// A gap is at most 4 widths of the crossing stroke long, and the stroke goes on for 2 of its own widths
    /// on both sides. Strokes that end at another one, and parallel ones, are left as they are.
    #[must_use]
    pub fn bridged(&self, index: usize) -> Option<Bitmap> {
        let own = self.ink.get(index)?;
        Some(bridge_gaps::bridge(own, &self.others(index)))
    }

    /// How much of each pixel a pen covers, as grey levels: 0 wholly, 255 not at all, so that a centreline
    /// can be set between pixels. `ink` is the pen's ink, bridged or not; beyond it only the pixels that
    /// touch it are asked, and where another pen's ink is bridged the pen covers all.
    ///
    /// `None` unless `picture` is of the size that was shared out, and there is such a pen.
    #[must_use]
    pub fn coverage(&self, index: usize, ink: &Bitmap, picture: &Colour) -> Option<Gray> {
        let own = self.ink.get(index)?;
        let size = |bitmap: &Bitmap| (bitmap.width(), bitmap.height());
        if size(own) != size(ink) || size(own) != (picture.width(), picture.height()) {
            return None;
        }
        let others = self.others(index);
        let mut levels = vec![u8::MAX; picture.pixels().len()];
        for at in bridge_gaps::grown(ink).ink() {
            let covered = match (ink.get(at), others.get(at)) {
                (true, true) => u8::MAX,
                (false, true) => 0,
                _ => {
                    let line = self.lines.get(index);
                    let even =
                        |colour| self.light.as_ref().map_or(colour, |light| light.even((at.x, at.y), colour));
                    let colour = picture.pixel(at.x, at.y).map(even);
                    colour.zip(line).map_or(0, |(colour, line)| line.share_255(colour))
                }
            };
            let place = at.y as usize * picture.width() as usize + at.x as usize;
            if let Some(level) = levels.get_mut(place) {
                *level = u8::MAX - covered;
            }
        }
        Some(Gray::of_checked_size(picture.width(), picture.height(), levels))
    }

    /// The colour of the ruling of squared or ruled paper, which is left out.
    #[must_use]
    pub fn ruling(&self) -> Option<Rgb> {
        self.ruling.as_ref().map(|ruling| ruling.colour)
    }

    /// What of the ink no pen got; the ruling is no pen's.
    pub(crate) fn unassigned(&self, ink: &Bitmap) -> Option<Unassigned> {
        unassigned(ink, self.ink.iter().chain(self.ruling.as_ref().map(|ruling| &ruling.ink)))
    }

    /// The ink of all other pens; nothing without other pens.
    fn others(&self, index: usize) -> Bitmap {
        let others = self.ink.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, ink)| ink);
        others.fold(Bitmap::empty(), |all, ink| if all.width() == 0 { ink.clone() } else { all.united(ink) })
    }
}
