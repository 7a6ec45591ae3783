//! [`lost_ink`]: ink that a vectorization should have drawn, and did not.

use plotter_vector::{
    FileRows, Pixel, Progress, TracedSheet, Vectorizer, ink::Unassigned, picture::FileNotes,
    trace::SheetErrors,
};
use std::io::Cursor;

/// How far beyond the promised error the farthest ink may lie from the strokes, as a multiple of the width of
/// the lines.
///
/// An error is what a pixel's distance is more than half of the line's width, so it is 0 all over a line
/// whose middle is drawn. Corners and junctions, where ink is wider than its lines, and blots take it up to
/// about a line's width beyond the promise. The nearest line that could be drawn in its place has a row of
/// paper between, so the far edge of a line that was not drawn has an error of at least a width and a pixel.
const WIDTHS: f64 = 1.0;

/// The same in a photograph, or of pencil and chalk, where ink is ragged and lines run together in dots.
const WIDTHS_IF_UNEVEN: f64 = 2.0;

/// The width that is taken where no lines were found, only areas or dots, px.
const USUAL_LINE_PX: u32 = 3;

/// Says where ink was lost, if its farthest pixel lies far beyond what was promised of the vectorization;
/// `line_px` is the width of the picture's lines, `is_uneven` says that no single level told its ink. The
/// published algorithm promises nothing.
///
/// # Errors
///
/// How far, where, and what may help.
pub fn lost_ink(
    vectorizer: &Vectorizer,
    errors: &SheetErrors,
    line_px: Option<u32>,
    is_uneven: bool,
) -> Result<(), String> {
    let Some(promised_px) = vectorizer.ours().map(|ours| ours.tolerance_px) else { return Ok(()) };
    let widths = if is_uneven { WIDTHS_IF_UNEVEN } else { WIDTHS };
    let most_px = promised_px + widths * f64::from(line_px.unwrap_or(USUAL_LINE_PX).max(1));
    match errors.worst {
        Some((Pixel { x, y }, error_px)) if error_px > most_px => Err(format!(
            "ink at ({x}, {y}) px lies {error_px:.1} px from the nearest stroke, where {promised_px} px were promised: \
                 something was not drawn there; look at it (`trace --overlay F.png` circles it), then try a scan with more \
                 dots per inch, another threshold, or another greatest width of lines (`trace --max-line-px`)"
        )),
        _ => Ok(()),
    }
}

/// Says where ink lies that none of several pens got.
pub(crate) fn no_pen_got(Unassigned { at, length_px, pieces }: Unassigned) -> String {
    let others = if pieces > 1 { format!(", and {} pieces more", pieces - 1) } else { String::new() };
    format!(
        "no pen got {length_px} px of ink at ({}, {}) px{others}: it is not drawn; give more pens (--pens), or a palette \
         that has its colour",
        at.x, at.y
    )
}

/// A page of a picture file as strokes with their errors, and what the file says of itself; where ink was
/// lost, [`lost_ink`] tells.
///
/// # Errors
///
/// What is wrong with the file, in words.
pub fn vectorized(
    vectorizer: &Vectorizer,
    file: Vec<u8>,
    page: u32,
) -> Result<(TracedSheet, FileNotes), String> {
    let mut scan = FileRows::of_page(Cursor::new(file), page).map_err(|error| error.to_string())?;
    let traced = vectorizer
        .vectorize_rows_with_errors(&mut scan, &mut Progress::silent())
        .map_err(|error| error.to_string())?;
    Ok((traced, scan.notes().clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_vector::Ours;

    fn errors(error_px: f64) -> SheetErrors {
        SheetErrors { worst: Some((Pixel::new(12, 34), error_px)), ..SheetErrors::default() }
    }

    #[test]
    fn ink_a_lines_width_beyond_the_promise_is_lost_and_said_with_its_place() {
        let within_half = Vectorizer::from(Ours::default().with_tolerance_px(0.5));
        assert_eq!(lost_ink(&within_half, &errors(3.5), Some(3), false), Ok(()));
        // The far edge of a line that was not drawn beside one that was: a width and a pixel.
        let said = lost_ink(&within_half, &errors(4.0), Some(3), false).unwrap_err();
        assert_eq!(lost_ink(&within_half, &errors(4.0), Some(3), true), Ok(()));
        assert!(lost_ink(&within_half, &errors(7.0), Some(3), true).is_err());
        for part in ["(12, 34) px", "4.0 px", "0.5 px were promised", "--overlay", "--max-line-px"] {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert_eq!(lost_ink(&within_half, &SheetErrors::default(), Some(3), false), Ok(()));
    }

    #[test]
    fn ink_that_no_pen_got_is_said_with_its_place_and_length() {
        let said = |pieces| no_pen_got(Unassigned { at: Pixel::new(12, 34), length_px: 56, pieces });
        assert!(said(1).starts_with("no pen got 56 px of ink at (12, 34) px: it is not drawn"));
        assert!(said(3).contains("px, and 2 pieces more: it is not drawn"));
    }

    #[test]
    fn the_published_algorithm_promises_nothing() {
        let published = Vectorizer::published();
        assert_eq!(lost_ink(&published, &errors(50.0), Some(1), false), Ok(()));
    }
}
