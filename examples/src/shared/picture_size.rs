//! [`PictureSize`]: how large a picture's pixels are on the sheet, and who says so; and what else a file says
//! of itself, in words.

use clap::Args;
use plotter_vector::picture::{FileNotes, Ground};
use std::fmt::Write as _;

/// Millimetres of an inch.
const MM_PER_INCH: f64 = 25.4;

/// How large a picture is where neither an option nor its file says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UsualSize {
    /// So many mm a pixel.
    MmPerPx(f64),
    /// So many mm in width.
    WidthMm(f64),
}

/// What is asked of a picture's size in place of what its file says.
#[derive(Args, Clone, Copy, Debug, Default)]
#[group(multiple = false)]
pub struct SizeOptions {
    /// Width of the whole picture on the sheet, mm; less where the machine is smaller
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub width_mm: Option<f64>,
    /// Height of the whole picture on the sheet, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub height_mm: Option<f64>,
    /// Dots per inch that the picture was scanned with
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub dpi: Option<f64>,
    /// Size of a pixel on the sheet, mm: 0.1 is 254 dots per inch, 4 plotter units a pixel [default: as the
    /// file says, if a scanner may have written it, else 0.1; drawn by a machine, else 50 mm in width]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub mm_per_px: Option<f64>,
    /// The same, of a sheet whose size is known.
    #[arg(skip)]
    pub paper_mm_per_px: Option<f64>,
}

/// How large a picture's pixels are on the sheet, and who says so.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSize {
    /// Size of a pixel, mm.
    pub mm_per_px: f64,
    /// Width and height of the whole picture, mm.
    pub sheet_mm: [f64; 2],
    /// The option that asked for it.
    pub asked: Option<&'static str>,
    /// Whether the file says so.
    pub is_the_files: bool,
    /// Who says so, in words.
    pub from: String,
}

impl SizeOptions {
    /// The option that was given, with its value.
    fn given(&self) -> Option<(&'static str, f64)> {
        let options = [
            ("--width-mm", self.width_mm),
            ("--height-mm", self.height_mm),
            ("--dpi", self.dpi),
            ("--mm-per-px", self.mm_per_px),
            ("--paper", self.paper_mm_per_px),
        ];
        options.into_iter().find_map(|(option, value)| Some((option, value?)))
    }

    /// The option that was given.
    #[must_use]
    pub fn option_given(&self) -> Option<&'static str> {
        self.given().map(|(option, _)| option)
    }

    /// Whether what is asked for is a size.
    ///
    /// # Errors
    ///
    /// A number that is none, with what would be right.
    pub fn check(&self) -> Result<(), String> {
        match self.given() {
            Some((option, value)) if !(value > 0.0 && value.is_finite()) => Err(match option {
                "--dpi" => format!("--dpi: {value} is not a positive number; scanners have 100 to 1200"),
                "--mm-per-px" => {
                    format!("--mm-per-px: {value} mm is not a positive number; 0.1 gives 254 dots per inch")
                }
                "--width-mm" => format!("--width-mm {value}: give a width above 0 mm"),
                _ => format!("{option} {value}: give a height above 0 mm"),
            }),
            _ => Ok(()),
        }
    }

    /// The size of a picture: as asked, else as its file says, else the usual.
    ///
    /// # Errors
    ///
    /// A number that makes no size.
    pub fn of(&self, notes: &FileNotes, usual: UsualSize) -> Result<PictureSize, String> {
        self.check()?;
        let (width_px, height_px) = (f64::from(notes.width_px.max(1)), f64::from(notes.height_px.max(1)));
        let believed = notes.resolution.map(|resolution| (resolution, resolution.mm_per_px()));
        let (usual_mm, usual) = match usual {
            UsualSize::MmPerPx(mm) => (mm, format!("at {} mm a pixel", rounded(mm))),
            UsualSize::WidthMm(mm) => (mm / width_px, format!("{} mm in width", rounded(mm))),
        };
        let hint = "give --width-mm, --height-mm, --dpi or --mm-per-px";
        let (mm_per_px, from) = match (self.given(), believed) {
            (Some((option, value)), _) => {
                let mm_per_px = match option {
                    "--width-mm" => value / width_px,
                    "--height-mm" => value / height_px,
                    "--dpi" => MM_PER_INCH / value,
                    _ => value,
                };
                (mm_per_px, format!("as asked by {option}"))
            }
            (None, Some((resolution, Ok(mm_per_px)))) => (mm_per_px, format!("at {resolution}")),
            (None, Some((_, Err(doubt)))) => (usual_mm, format!("{usual}, for {doubt}; {hint}")),
            (None, None) => (usual_mm, format!("{usual}, for the file says no size; {hint}")),
        };
        if !(mm_per_px > 0.0 && mm_per_px.is_finite()) {
            let option = self.given().map_or("--mm-per-px", |(option, _)| option);
            return Err(format!(
                "{option}: a pixel of {mm_per_px} mm is no size; 0.1 gives 254 dots per inch"
            ));
        }
        Ok(PictureSize {
            mm_per_px,
            sheet_mm: [notes.width_px, notes.height_px].map(|px| f64::from(px) * mm_per_px),
            asked: self.given().map(|(option, _)| option),
            is_the_files: self.given().is_none() && matches!(believed, Some((_, Ok(_)))),
            from,
        })
    }
}

/// A number of millimetres with at most four decimals.
fn rounded(mm: f64) -> String {
    let text = format!("{mm:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl PictureSize {
    /// Width, height, and who says so, in a line.
    #[must_use]
    pub fn told(&self) -> String {
        let [width_mm, height_mm] = self.sheet_mm;
        format!("{width_mm:.2} x {height_mm:.2} mm, {}", self.from)
    }
}

/// What a file says of its picture that was made use of, each with its name: how it was turned, which page it
/// is, and what it lies on. What goes without saying is left out.
#[must_use]
pub fn told_notes(notes: &FileNotes) -> Vec<(&'static str, String)> {
    let mut told = Vec::new();
    if !notes.orientation.is_upright() {
        told.push(("upright", notes.orientation.to_string()));
    }
    if notes.pages > 1 {
        let mut text = format!("{} of {}; ", notes.page, notes.pages);
        let others: Vec<u32> = (1..=notes.pages).filter(|page| *page != notes.page).take(2).collect();
        let _ = match others.as_slice() {
            [one] => write!(text, "--page {one} for the other"),
            _ => write!(text, "--page N for the others"),
        };
        told.push(("page", text));
    }
    if notes.is_animated {
        told.push(("picture", "the first of an animation; the others are left out".into()));
    }
    if notes.ground == Some(Ground::Black) {
        told.push(("ground", "black: what is drawn is light, and the rest is clear".into()));
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_vector::picture::{Resolution, ResolutionSource};
    use std::io::Cursor;

    /// A picture of 200 x 100 px that says so many dots per inch.
    fn notes(dpi: Option<f64>) -> FileNotes {
        let mut notes = FileNotes::read(Cursor::new(b"P4 200 100\n"), 1).unwrap();
        notes.resolution = dpi.map(|dpi| Resolution {
            px_per_mm: [dpi / MM_PER_INCH; 2],
            source: ResolutionSource::Tiff,
            has_camera_tags: false,
        });
        notes
    }

    #[test]
    fn what_is_asked_goes_before_the_file_and_the_file_before_the_usual() {
        let none = SizeOptions::default();
        let cases = [
            (none, Some(300.0), 25.4 / 300.0, "at 300 dots per inch (tags of the TIFF)"),
            (none, Some(72.0), 0.1, "0.1 mm a pixel, for its 72 dots per inch are those of a screen"),
            (none, None, 0.1, "0.1 mm a pixel, for the file says no size; give --width-mm"),
            (SizeOptions { width_mm: Some(40.0), ..none }, Some(300.0), 0.2, "as asked by --width-mm"),
            (SizeOptions { height_mm: Some(40.0), ..none }, None, 0.4, "as asked by --height-mm"),
            (SizeOptions { dpi: Some(72.0), ..none }, Some(72.0), 25.4 / 72.0, "as asked by --dpi"),
            (SizeOptions { mm_per_px: Some(0.5), ..none }, Some(300.0), 0.5, "as asked by --mm-per-px"),
        ];
        for (options, dpi, mm_per_px, from) in cases {
            let size = options.of(&notes(dpi), UsualSize::MmPerPx(0.1)).unwrap();
            assert!((size.mm_per_px - mm_per_px).abs() < 1e-12, "{size:?}");
            assert!(size.told().contains(from), "{}", size.told());
            assert!((size.sheet_mm[0] - 200.0 * mm_per_px).abs() < 1e-9, "{size:?}");
        }
    }

    #[test]
    fn what_is_no_size_is_refused_with_a_size_that_is() {
        let none = SizeOptions::default();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for options in [
                SizeOptions { width_mm: Some(bad), ..none },
                SizeOptions { height_mm: Some(bad), ..none },
                SizeOptions { dpi: Some(bad), ..none },
                SizeOptions { mm_per_px: Some(bad), ..none },
            ] {
                assert!(options.of(&notes(None), UsualSize::MmPerPx(0.1)).is_err(), "{options:?}");
            }
        }
        assert!(SizeOptions { dpi: Some(1e-320), ..none }.of(&notes(None), UsualSize::MmPerPx(0.1)).is_err());
    }

    #[test]
    fn only_what_does_not_go_without_saying_is_told() {
        let mut plain = notes(None);
        assert_eq!(told_notes(&plain), []);
        plain.pages = 2;
        assert_eq!(told_notes(&plain), [("page", "1 of 2; --page 2 for the other".into())]);
        (plain.pages, plain.page) = (3, 2);
        assert_eq!(told_notes(&plain), [("page", "2 of 3; --page N for the others".into())]);
        plain.ground = Some(Ground::White);
        assert_eq!(told_notes(&plain).len(), 1);
    }
}
