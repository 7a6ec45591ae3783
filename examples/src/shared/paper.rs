//! [`PaperOption`]: the sheet that a photograph shows, taken out of it as if it were looked at from straight
//! above.

use super::picture_size::SizeOptions;
use clap::Args;
use plotter_vector::{
    DecodeError, Drawing, FileRows, Gray, PxPoint,
    picture::{FileNotes, NoSheetQuad, SheetQuad, StraightSheet, decode_page_in_colour},
};
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Cursor;
use std::str::FromStr;

/// Sheets by name, mm: ISO 216, and ANSI/ASME Y14.1.
const SHEETS: [(&str, [f64; 2]); 10] = [
    ("a0", [841.0, 1189.0]),
    ("a1", [594.0, 841.0]),
    ("a2", [420.0, 594.0]),
    ("a3", [297.0, 420.0]),
    ("a4", [210.0, 297.0]),
    ("a5", [148.0, 210.0]),
    ("a6", [105.0, 148.0]),
    ("letter", [215.9, 279.4]),
    ("legal", [215.9, 355.6]),
    ("tabloid", [279.4, 431.8]),
];

/// Proportions that a sheet is taken for, long for wide, and how near it must seem to be: a perspective that
/// was measured to half a pixel tells the proportion to one in a hundred, and the nearest two of these differ
/// by nine.
const USUAL: [(&str, f64); 2] =
    [("an A sheet", core::f64::consts::SQRT_2), ("a letter sheet", 279.4 / 215.9)];
const AS_USUAL: f64 = 0.02;

/// A sheet that was asked for and seems to be of another proportion by more than this is warned of.
const UNLIKE: f64 = 0.1;

/// Shortest and longest side of a sheet, mm, and how much longer one may be.
const SIDES_MM: core::ops::RangeInclusive<f64> = 5.0..=20_000.0;
const LONGEST: f64 = 50.0;

/// A width that is taken where the lines' is unknown, px.
const USUAL_LINE_PX: u32 = 3;

/// What is asked about the sheet in a photograph.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct PaperOption {
    /// Takes the sheet that a photograph shows out of it, as if it were looked at from straight above: auto
    /// finds it; a name (a0 to a6, letter, legal, tabloid) or mm, as 210x297, says its true size too; none
    /// takes the picture as it is [default: none]
    #[arg(long, value_name = "auto|none|a4|WxH")]
    pub paper: Option<PaperChoice>,
}

/// Which sheet a photograph shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PaperChoice {
    /// None: the picture is the sheet.
    None,
    /// One of unknown size.
    Auto,
    /// One of so many mm; which side is which is seen.
    Sized([f64; 2]),
}

impl FromStr for PaperChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim().to_ascii_lowercase();
        match text.as_str() {
            "none" => return Ok(Self::None),
            "auto" => return Ok(Self::Auto),
            _ => {}
        }
        if let Some((_, sides)) = SHEETS.iter().find(|(name, _)| *name == text) {
            return Ok(Self::Sized(*sides));
        }
        let remedy = "give auto, none, a name from a0 to a6, letter, legal, tabloid, or mm, as 210x297";
        let (width, height) = text.split_once(['x', '×']).ok_or(remedy)?;
        let side = |text: &str| text.trim().parse::<f64>().ok().filter(|mm| SIDES_MM.contains(mm));
        let (Some(width), Some(height)) = (side(width), side(height)) else {
            let (least, most) = (SIDES_MM.start(), SIDES_MM.end());
            return Err(format!("sides of a sheet are numbers from {least} to {most} mm; {remedy}"));
        };
        if width.max(height) > LONGEST * width.min(height) {
            return Err(format!("one side is more than {LONGEST} times the other; {remedy}"));
        }
        Ok(Self::Sized([width, height]))
    }
}

/// Why there is no straightened sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum PaperError {
    /// The picture shows none.
    NoSheet(NoSheetQuad),
    /// The picture cannot be read, or the options exclude each other.
    Other(String),
}

impl PaperError {
    /// In words, with what helps.
    #[must_use]
    pub fn told(&self) -> String {
        match self {
            Self::NoSheet(why) => format!(
                "--paper: {why}; photograph the whole sheet on something darker, or leave --paper out to take the \
                 picture as it is"
            ),
            Self::Other(text) => text.clone(),
        }
    }
}

/// A straightened sheet as a picture file, and where it comes from.
#[derive(Clone, Debug)]
pub struct Straightened {
    /// PGM or PPM: the sheet.
    pub file: Vec<u8>,
    /// What the photograph's file says, as far as it is true of the sheet.
    pub notes: FileNotes,
    /// Where it lies.
    pub paper: Paper,
    /// The photograph's levels, for a look at where the sheet lies in it.
    pub photograph: Gray,
}

/// The sheet, and where it lies in the photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// In the photograph.
    pub quad: SheetQuad,
    /// Straightened.
    pub sheet: StraightSheet,
    picture_px: [u32; 2],
    /// Width for height, as the perspective tells.
    measured: f64,
    /// The same as it was taken, and why.
    proportion: (f64, String),
    /// As asked.
    size_mm: Option<[f64; 2]>,
}

impl PaperOption {
    /// Whether a sheet is asked for.
    #[must_use]
    pub fn is_asked(self) -> bool {
        !matches!(self.paper, None | Some(PaperChoice::None))
    }

    /// The sheet that a page of a file shows; none where none is asked for.
    ///
    /// # Errors
    ///
    /// [`PaperError`]
    pub fn straightened(
        self,
        file: &[u8],
        page: u32,
        in_colour: bool,
        size: &SizeOptions,
    ) -> Result<Option<Straightened>, PaperError> {
        let size_mm = match self.paper {
            None | Some(PaperChoice::None) => return Ok(None),
            Some(PaperChoice::Auto) => None,
            Some(PaperChoice::Sized(sides)) => Some(sides),
        };
        if let (Some(_), Some(option)) = (size_mm, size.option_given()) {
            return Err(PaperError::Other(format!(
                "--paper and {option}: both say how large the sheet is; take --paper auto, or leave {option} out"
            )));
        }
        let failed = |error: DecodeError| PaperError::Other(error.to_string());
        if in_colour {
            let (colour, notes) = decode_page_in_colour(file, page).map_err(failed)?;
            let photograph = Gray::from(&colour);
            let paper = Paper::find(&photograph, size_mm)?;
            let straight = paper.sheet.colour(&colour);
            let file = pnm("P6", straight.width(), straight.height(), straight.pixels().as_flattened());
            return Ok(Some(Straightened { file, notes: paper.notes(&notes), paper, photograph }));
        }
        let scan = FileRows::of_page(Cursor::new(file), page).map_err(failed)?;
        let notes = scan.notes().clone();
        let photograph = scan.into_gray().map_err(failed)?;
        let paper = Paper::find(&photograph, size_mm)?;
        let straight = paper.sheet.gray(&photograph);
        let file = pnm("P5", straight.width(), straight.height(), straight.pixels());
        Ok(Some(Straightened { file, notes: paper.notes(&notes), paper, photograph }))
    }
}

/// A file of the channels of all pixels.
fn pnm(kind: &str, width: u32, height: u32, channels: &[u8]) -> Vec<u8> {
    let mut file = format!("{kind} {width} {height} 255\n").into_bytes();
    file.extend_from_slice(channels);
    file
}

impl Paper {
    fn find(picture: &Gray, size_mm: Option<[f64; 2]>) -> Result<Self, PaperError> {
        let quad = SheetQuad::find(picture).map_err(PaperError::NoSheet)?;
        let (width, height) = (picture.width(), picture.height());
        let measured = quad.proportion(width, height);
        let size_mm = size_mm.map(|[one, other]| {
            // As the sheet lies: what is asked for is which sheet it is.
            if (measured > 1.0) == (one > other) { [one, other] } else { [other, one] }
        });
        let proportion = match size_mm {
            Some([width_mm, height_mm]) => (width_mm / height_mm, "as asked".to_owned()),
            None => usual(measured),
        };
        let too_flat =
            || PaperError::Other("--paper: the sheet is seen too flat to make a picture of it".into());
        let sheet = quad.straightened(proportion.0).ok_or_else(too_flat)?;
        Ok(Self { quad, sheet, picture_px: [width, height], measured, proportion, size_mm })
    }

    /// The notes of the photograph as those of the sheet: its size is another, and how large a pixel is
    /// nobody has said.
    fn notes(&self, photograph: &FileNotes) -> FileNotes {
        let mut notes = photograph.clone();
        (notes.width_px, notes.height_px) = (self.sheet.width_px(), self.sheet.height_px());
        notes.resolution = None;
        notes
    }

    /// What is asked of the size, with what the sheet's own says.
    #[must_use]
    pub fn sized(&self, size: &SizeOptions) -> SizeOptions {
        let mm_per_px = self.size_mm.map(|[width_mm, _]| width_mm / self.sheet.size_px()[0]);
        SizeOptions { paper_mm_per_px: mm_per_px, ..*size }
    }

    /// What was found and done, each with its name.
    #[must_use]
    pub fn told(&self) -> Vec<(&'static str, String)> {
        let corners = self.quad.corners.map(|at| format!("({:.1}, {:.1})", at.x, at.y)).join(", ");
        let (proportion, from) = &self.proportion;
        let mut seen = String::new();
        // As people say it: the longer side for the shorter.
        let long = |proportion: f64| proportion.max(1.0 / proportion);
        if let Some([width_mm, height_mm]) = self.size_mm {
            let _ = write!(seen, "{width_mm} x {height_mm} mm, ");
        }
        let _ = write!(seen, "{:.3} : 1 {from}", long(*proportion));
        if long(*proportion) != long(self.measured) {
            let _ = write!(seen, ", where {:.3} is seen", long(self.measured));
        }
        if self.size_mm.is_some() && libm::fabs(self.measured / proportion - 1.0) > UNLIKE {
            seen.push_str(": is it that sheet?");
        }
        let [width, height] = self.picture_px.map(f64::from);
        let is_outside = |at: &&PxPoint| at.x < 0.0 || at.y < 0.0 || at.x > width || at.y > height;
        let outside = match self.quad.corners.iter().filter(is_outside).count() {
            0 => String::new(),
            1 => "; one of them lies outside of the picture, where the sheet is continued".into(),
            count => format!("; {count} of them lie outside of the picture, where the sheet is continued"),
        };
        let rows = self.sheet.to_picture().0.map(|row| row.map(|value| format!("{value:.6e}")).join(" "));
        vec![
            (
                "paper",
                format!(
                    "{} x {} px, straightened; {seen}; what lies beside it is left out",
                    self.sheet.width_px(),
                    self.sheet.height_px()
                ),
            ),
            ("corners", format!("{corners} px{outside}")),
            ("homography", format!("{}, from places on the paper to those in the picture", rows.join("; "))),
        ]
    }

    /// That strokes run to the sheet's edge, beyond which nothing is drawn; `line_px` is their width.
    #[must_use]
    pub fn told_ends(&self, drawing: &Drawing, line_px: Option<u32>) -> Option<(&'static str, String)> {
        let near = self.sheet.rim_px() + f64::from(line_px.unwrap_or(USUAL_LINE_PX));
        let [width, height] = self.sheet.size_px();
        let at_edge = |at: &PxPoint| at.x.min(at.y).min(width - at.x).min(height - at.y) < near;
        let ends =
            |stroke: &[PxPoint]| stroke.first().is_some_and(at_edge) || stroke.last().is_some_and(at_edge);
        let text = match drawing.strokes().filter(|stroke| ends(stroke)).count() {
            0 => return None,
            1 => "1 stroke runs".to_owned(),
            count => format!("{count} strokes run"),
        };
        Some(("at its edge", format!("{text} to the sheet's edge; what lies beyond is left out")))
    }

    /// Attributes of an SVG that say the same.
    #[must_use]
    pub fn svg_attributes(&self) -> String {
        let numbers: Vec<String> =
            self.sheet.to_picture().0.as_flattened().iter().map(f64::to_string).collect();
        let [width, height] = self.picture_px;
        format!("data-picture=\"{width} {height}\" data-homography=\"{}\"", numbers.join(" "))
    }

    /// As figures.
    #[must_use]
    pub fn report(&self) -> PaperReport {
        PaperReport {
            width_px: self.sheet.width_px(),
            height_px: self.sheet.height_px(),
            size_mm: self.size_mm,
            proportion: self.proportion.0,
            seen_proportion: self.measured,
            picture_px: self.picture_px,
            corners_px: self.quad.corners.map(|at| [at.x, at.y]),
            error_px: self.quad.error_px,
            homography: self.sheet.to_picture().0,
        }
    }
}

/// A straightened sheet in figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PaperReport {
    width_px: u32,
    height_px: u32,
    /// As asked.
    size_mm: Option<[f64; 2]>,
    /// Width for height, as it was taken.
    proportion: f64,
    /// The same as the perspective tells.
    seen_proportion: f64,
    /// Size of the photograph.
    picture_px: [u32; 2],
    /// In the photograph, clockwise from the left end of the uppermost side.
    corners_px: [[f64; 2]; 4],
    /// How far its edges lie from straight lines, standard deviation.
    error_px: f64,
    /// From places on the straightened sheet to those in the photograph, both counted from the upper left
    /// corner, row by row.
    homography: [[f64; 3]; 3],
}

/// The proportion that a sheet is taken for, with why.
fn usual(measured: f64) -> (f64, String) {
    let long = measured.max(1.0 / measured);
    match USUAL.iter().find(|(_, usual)| libm::fabs(long / usual - 1.0) <= AS_USUAL) {
        Some((name, usual)) => (if measured > 1.0 { *usual } else { 1.0 / usual }, format!("as of {name}")),
        None => (measured, "as it is seen".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_are_named_or_measured_and_others_are_refused_with_those_that_are() {
        let parse = |text: &str| text.parse::<PaperChoice>();
        assert_eq!((parse("auto"), parse("none")), (Ok(PaperChoice::Auto), Ok(PaperChoice::None)));
        assert_eq!(parse("A4"), Ok(PaperChoice::Sized([210.0, 297.0])));
        assert_eq!(parse("100x62.5"), Ok(PaperChoice::Sized([100.0, 62.5])));
        for bad in
            ["", "a9", "210", "0x10", "-5x10", "10x", "nanx10", "infx10", "10x1000", "1e9x1e9", "210x297x3"]
        {
            let said = parse(bad).unwrap_err();
            assert!(said.contains("210x297"), "{bad}: {said}");
        }
    }

    #[test]
    fn a_sheet_is_taken_for_a_usual_one_within_two_in_a_hundred() {
        let (taken, why) = usual(1.0 / 1.40);
        assert!((taken - 1.0 / core::f64::consts::SQRT_2).abs() < 1e-12 && why.contains("A sheet"));
        assert!((usual(1.29).0 - 279.4 / 215.9).abs() < 1e-12);
        for other in [1.0, 1.333, 1.36, 1.5, 0.5] {
            assert_eq!(usual(other), (other, "as it is seen".into()));
        }
    }
}
