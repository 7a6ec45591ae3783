//! [`Resolution`]: how large a picture file says its pixels are.

use core::fmt;

/// Millimetres of an inch.
pub(crate) const MM_PER_INCH: f64 = 25.4;

/// What screens have, dots per inch: programs write these where nothing was measured, and telephones the
/// first.
const SCREENS_DPI: [f64; 2] = [72.0, 96.0];

/// How near a value is to one of a screen's, dots per inch: PNG counts pixels of a whole metre, 0.03 dpi.
const SCREEN_WITHIN_DPI: f64 = 0.5;

/// What scanners do, dots per inch: the coarsest preview, and twice the finest flatbed.
const SCANNERS_DPI: core::ops::RangeInclusive<f64> = 50.0..=12_800.0;

/// How much wider than high a pixel may be: 300 by 299.99 is a rounding, 204 by 196 a fax.
const SQUARE_WITHIN: f64 = 0.01;

/// Where a resolution stands in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ResolutionSource {
    /// The chunk `pHYs` of a PNG.
    PngPhys,
    /// The JFIF header of a JPEG.
    Jfif,
    /// EXIF, of whichever format.
    Exif,
    /// The tags of a TIFF.
    Tiff,
    /// The header of a BMP.
    Bmp,
}

impl fmt::Display for ResolutionSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PngPhys => "pHYs of the PNG",
            Self::Jfif => "JFIF of the JPEG",
            Self::Exif => "EXIF",
            Self::Tiff => "tags of the TIFF",
            Self::Bmp => "header of the BMP",
        })
    }
}

/// Resolution of a picture, pixels per millimetre, as its file states it;
/// [`mm_per_px`](Self::mm_per_px) tells whether that is plausible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Pixels per millimetre along a row and down a column of the upright picture.
    pub px_per_mm: [f64; 2],
    /// The part of the file that states it.
    pub source: ResolutionSource,
    /// Whether the file also has tags of a camera (focal length, aperture, exposure): then the resolution is
    /// not the paper's.
    pub has_camera_tags: bool,
}

/// Why a resolution is not believed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ResolutionDoubt {
    /// Zero, infinite or no number.
    NoNumber,
    /// Pixels that are wider than high, or higher than wide.
    NotSquare {
        /// Dots per inch along a row and down a column.
        dpi: [f64; 2],
    },
    /// A photograph's: what a camera writes says nothing about the paper before it.
    Camera {
        /// Dots per inch.
        dpi: f64,
    },
    /// A screen's, 72 or 96 dots per inch, which programs write where nothing was measured.
    Screen {
        /// Dots per inch.
        dpi: f64,
    },
    /// No scanner's: below 50 or above 12,800 dots per inch.
    OutOfRange {
        /// Dots per inch.
        dpi: f64,
    },
}

impl Resolution {
    /// Dots per inch, along a row and down a column.
    #[must_use]
    pub fn dpi(&self) -> [f64; 2] {
        self.px_per_mm.map(|px_per_mm| px_per_mm * MM_PER_INCH)
    }

    /// The size of a pixel on the paper, mm, if it can be believed.
    ///
    /// # Errors
    /// [`ResolutionDoubt`] for what is no scanner's: no number, pixels that are not square, a screen's 72 or
    /// 96 dots per inch, a photograph's, and what lies outside 50 to 12,800 dots per inch.
    ///
    /// ```
    /// # use plotter_vector::picture::{Resolution, ResolutionDoubt, ResolutionSource};
    /// let source = ResolutionSource::Tiff;
    /// let mut scan = Resolution { px_per_mm: [12.0; 2], source, has_camera_tags: false };
    /// assert_eq!(scan.mm_per_px(), Ok(1.0 / 12.0));
    /// scan.px_per_mm = [2.835; 2]; // 72 dots per inch
    /// assert!(matches!(scan.mm_per_px(), Err(ResolutionDoubt::Screen { .. })));
    /// ```
    pub fn mm_per_px(&self) -> Result<f64, ResolutionDoubt> {
        let [across, down] = self.dpi();
        let is_number = |dpi: f64| dpi > 0.0 && dpi.is_finite();
        if !(is_number(across) && is_number(down)) {
            return Err(ResolutionDoubt::NoNumber);
        }
        if (across / down - 1.0).abs() > SQUARE_WITHIN {
            return Err(ResolutionDoubt::NotSquare { dpi: [across, down] });
        }
        let dpi = 0.5 * (across + down);
        if self.has_camera_tags {
            return Err(ResolutionDoubt::Camera { dpi });
        }
        if SCREENS_DPI.iter().any(|screen| (dpi - screen).abs() < SCREEN_WITHIN_DPI) {
            return Err(ResolutionDoubt::Screen { dpi });
        }
        if !SCANNERS_DPI.contains(&dpi) {
            return Err(ResolutionDoubt::OutOfRange { dpi });
        }
        Ok(2.0 / (self.px_per_mm[0] + self.px_per_mm[1]))
    }
}

/// Dots per inch with as many decimals as they need, two at most; a whole number where PNG, which counts
/// pixels of a whole metre, cannot be nearer to it.
struct Dpi(f64);

impl fmt::Display for Dpi {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const WITHIN_DPI: f64 = 0.5 * MM_PER_INCH / 1000.0;
        let whole = libm::round(self.0);
        let text = format!("{:.2}", if (self.0 - whole).abs() <= WITHIN_DPI { whole } else { self.0 });
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [across, down] = self.dpi();
        if (across / down - 1.0).abs() > SQUARE_WITHIN {
            write!(f, "{} x {} dots per inch ({})", Dpi(across), Dpi(down), self.source)
        } else {
            write!(f, "{} dots per inch ({})", Dpi(0.5 * (across + down)), self.source)
        }
    }
}

impl fmt::Display for ResolutionDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoNumber => f.write_str("its resolution is no number"),
            Self::NotSquare { dpi: [across, down] } => write!(
                f,
                "its pixels are not square ({} x {} dots per inch): scale it to square pixels, or it is drawn distorted",
                Dpi(*across),
                Dpi(*down)
            ),
            Self::Camera { dpi } => {
                write!(f, "its {} dots per inch are those of a camera, not of the paper before it", Dpi(*dpi))
            }
            Self::Screen { dpi } => {
                write!(
                    f,
                    "its {} dots per inch are those of a screen, written where nothing was measured",
                    Dpi(*dpi)
                )
            }
            Self::OutOfRange { dpi } => {
                let (least, most) = (SCANNERS_DPI.start(), SCANNERS_DPI.end());
                write!(f, "its {} dots per inch lie outside the {least} to {most} of scanners", Dpi(*dpi))
            }
        }
    }
}

impl core::error::Error for ResolutionDoubt {}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_dpi(across: f64, down: f64) -> Resolution {
        Resolution {
            px_per_mm: [across, down].map(|dpi| dpi / MM_PER_INCH),
            source: ResolutionSource::PngPhys,
            has_camera_tags: false,
        }
    }

    #[test]
    fn what_scanners_write_is_believed_and_nothing_else() {
        for dpi in [75.0, 100.0, 150.0, 299.9994, 300.0, 1200.0, 9600.0] {
            let mm_per_px = of_dpi(dpi, dpi).mm_per_px().unwrap();
            assert!((mm_per_px - MM_PER_INCH / dpi).abs() < 1e-12, "{dpi}");
        }
        // 2835 and 3780 px of a metre, as PNG has 72 and 96 dots per inch.
        for dpi in [72.0, 72.009, 96.0, 96.012, 95.987] {
            assert!(matches!(of_dpi(dpi, dpi).mm_per_px(), Err(ResolutionDoubt::Screen { .. })), "{dpi}");
        }
        for dpi in [1.0, 30.0, 20_000.0] {
            assert!(matches!(of_dpi(dpi, dpi).mm_per_px(), Err(ResolutionDoubt::OutOfRange { .. })), "{dpi}");
        }
        for (across, down) in [(0.0, 300.0), (f64::NAN, f64::NAN), (f64::INFINITY, 300.0), (-300.0, -300.0)] {
            assert_eq!(of_dpi(across, down).mm_per_px(), Err(ResolutionDoubt::NoNumber));
        }
        let fax = of_dpi(204.0, 98.0);
        assert!(matches!(fax.mm_per_px(), Err(ResolutionDoubt::NotSquare { .. })));
        assert_eq!(fax.to_string(), "204 x 98 dots per inch (pHYs of the PNG)");
        let photo = Resolution { has_camera_tags: true, ..of_dpi(300.0, 300.0) };
        assert!(matches!(photo.mm_per_px(), Err(ResolutionDoubt::Camera { .. })));
        assert_eq!(of_dpi(299.9994, 299.9994).to_string(), "300 dots per inch (pHYs of the PNG)");
    }
}
