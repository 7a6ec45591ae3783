//! [`Palette`]: the pens of a machine, with their colours.

#[cfg(feature = "toml")]
mod from_toml;
#[cfg(feature = "toml")]
pub use from_toml::{PalettePlace, PaletteTomlError};

use crate::picture::Rgb;
use core::fmt;

/// Most pens of a palette: twice the carousel of the plotters that had one.
pub const MAX_PENS: usize = 16;

/// Longest name of a pen, bytes.
const MAX_NAME_BYTES: usize = 64;
/// Thinnest and widest tip, mm: a scribing needle and a poster marker.
const WIDTHS_MM: core::ops::RangeInclusive<f64> = 0.01..=50.0;

/// A pen of a [`Palette`].
#[derive(Clone, Debug, PartialEq)]
pub struct PalettePen {
    /// Place in the carousel, from 1: the number behind `SP` in HPGL.
    pub number: u8,
    /// What it is called, at most 64 bytes.
    pub name: String,
    /// The colour that it leaves on the paper.
    pub colour: Rgb,
    /// Width of its line, mm, where it is known.
    pub width_mm: Option<f64>,
}

/// Pens that have been checked: 1 to [`MAX_PENS`], no number and no colour twice.
///
/// The default is one black pen, number 1.
///
/// ```
/// # use plotter_vector::{Palette, Rgb, ink::PalettePen};
/// let pen = |number, name: &str, colour| PalettePen { number, name: name.to_owned(), colour, width_mm: None };
/// let red = Rgb([208, 24, 24]);
/// let palette = Palette::new(vec![pen(1, "black", Rgb::BLACK), pen(2, "red", red)])?;
/// assert_eq!(palette.pen(2).map(|pen| pen.colour), Some(red));
/// let error = Palette::new(vec![pen(1, "black", Rgb::BLACK), pen(1, "red", red)]).unwrap_err();
/// assert_eq!(error.to_string(), "pen 1 is there twice: give each pen its own number, from 1 to 255");
/// # Ok::<(), plotter_vector::ink::PaletteError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Palette {
    pens: Vec<PalettePen>,
}

impl Default for Palette {
    fn default() -> Self {
        let black = PalettePen { number: 1, name: "black".to_owned(), colour: Rgb::BLACK, width_mm: None };
        Self { pens: vec![black] }
    }
}

/// Why pens are no palette.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PaletteError {
    /// No pen, or more than [`MAX_PENS`].
    Count {
        /// Pens given.
        found: usize,
    },
    /// Number 0, which puts the pen away.
    NumberZero,
    /// Two pens of one number.
    NumberTwice {
        /// The number.
        number: u8,
    },
    /// Two pens of one colour, which a picture cannot tell apart.
    ColourTwice {
        /// The number of the later one.
        number: u8,
        /// The number of the earlier one.
        earlier: u8,
        /// The colour of both.
        colour: Rgb,
    },
    /// A name that is too long.
    Name {
        /// The pen.
        number: u8,
        /// Length of its name, bytes.
        bytes: usize,
    },
    /// A width that no pen has.
    Width {
        /// The pen.
        number: u8,
        /// Its width, mm.
        width_mm: f64,
    },
}

impl fmt::Display for PaletteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { found } => write!(f, "{found} pens are no palette: give 1 to {MAX_PENS}"),
            Self::NumberZero => {
                f.write_str("pen 0 is no pen, it puts the pen away: number them from 1 to 255")
            }
            Self::NumberTwice { number } => {
                write!(f, "pen {number} is there twice: give each pen its own number, from 1 to 255")
            }
            Self::ColourTwice { number, earlier, colour } => write!(
                f,
                "pen {number} has the colour {colour} of pen {earlier}: a picture cannot tell them apart, leave one out"
            ),
            Self::Name { number, bytes } => {
                write!(f, "pen {number}: a name of {bytes} bytes is too long, at most {MAX_NAME_BYTES} fit")
            }
            Self::Width { number, width_mm } => write!(
                f,
                "pen {number}: {width_mm} mm lies outside {}..={} mm; a fineliner has 0.3 mm",
                WIDTHS_MM.start(),
                WIDTHS_MM.end()
            ),
        }
    }
}

impl core::error::Error for PaletteError {}

impl Palette {
    /// A palette of these pens, in this order.
    ///
    /// # Errors
    /// [`PaletteError`] for the first pen that is wrong.
    pub fn new(pens: Vec<PalettePen>) -> Result<Self, PaletteError> {
        if pens.is_empty() || pens.len() > MAX_PENS {
            return Err(PaletteError::Count { found: pens.len() });
        }
        let mut before: Vec<&PalettePen> = Vec::with_capacity(pens.len());
        for pen in &pens {
            pen.check(&before)?;
            before.push(pen);
        }
        Ok(Self { pens })
    }

    /// The pens that were found on a picture, numbered from 1: at most [`MAX_PENS`], no colour twice.
    pub(crate) fn found(colours: impl IntoIterator<Item = Rgb>) -> Self {
        let pen = |(number, colour): (u8, Rgb)| PalettePen {
            number,
            name: colour.to_string(),
            colour,
            width_mm: None,
        };
        Self { pens: (1..).zip(colours).map(pen).collect() }
    }

    /// The pens, in the order in which they were given.
    #[must_use]
    pub fn pens(&self) -> &[PalettePen] {
        &self.pens
    }

    /// The pen of a number.
    #[must_use]
    pub fn pen(&self, number: u8) -> Option<&PalettePen> {
        self.pens.iter().find(|pen| pen.number == number)
    }
}

impl PalettePen {
    fn check(&self, before: &[&Self]) -> Result<(), PaletteError> {
        let number = self.number;
        if number == 0 {
            return Err(PaletteError::NumberZero);
        }
        if before.iter().any(|pen| pen.number == number) {
            return Err(PaletteError::NumberTwice { number });
        }
        if let Some(pen) = before.iter().find(|pen| pen.colour == self.colour) {
            return Err(PaletteError::ColourTwice { number, earlier: pen.number, colour: self.colour });
        }
        if self.name.len() > MAX_NAME_BYTES {
            return Err(PaletteError::Name { number, bytes: self.name.len() });
        }
        // NaN lies in no range.
        match self.width_mm.filter(|width_mm| !WIDTHS_MM.contains(width_mm)) {
            Some(width_mm) => Err(PaletteError::Width { number, width_mm }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pen(number: u8, grey: u8, width_mm: Option<f64>) -> PalettePen {
        PalettePen { number, name: String::new(), colour: Rgb([grey; 3]), width_mm }
    }

    fn refusal(pens: Vec<PalettePen>) -> String {
        Palette::new(pens).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_palette_is_refused_with_its_value_and_a_remedy() {
        let long = PalettePen { name: "x".repeat(65), ..pen(7, 0, None) };
        let messages = [
            refusal(Vec::new()),
            refusal((1..=17).map(|number| pen(number, number, None)).collect()),
            refusal(vec![pen(0, 0, None)]),
            refusal(vec![pen(4, 0, None), pen(4, 9, None)]),
            refusal(vec![pen(1, 9, None), pen(2, 9, None)]),
            refusal(vec![pen(3, 0, Some(0.0))]),
            refusal(vec![pen(3, 0, Some(f64::NAN))]),
            refusal(vec![long]),
        ];
        insta::assert_snapshot!(messages.join("\n"));
    }

    #[test]
    fn the_default_passes_its_own_check() {
        assert_eq!(Palette::new(Palette::default().pens), Ok(Palette::default()));
    }
}
