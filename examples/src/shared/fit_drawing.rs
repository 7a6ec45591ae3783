//! Places a drawing on a machine's sheet.

use super::picture_size::{SizeOptions, UsualSize};
use plotter_motion::{Machine, Point};
use plotter_vector::{Scale, picture::FileNotes};

/// Width of a picture whose size nothing says, mm.
const WIDTH_MM: f64 = 50.0;

/// Where a picture lies on a machine's sheet, in its true size if its file says it and the area allows it;
/// and who says so, in words.
///
/// # Errors
///
/// A size that is none, or an area too small for the margin.
pub fn fit_picture(
    notes: &FileNotes,
    asked: &SizeOptions,
    machine: &Machine,
) -> Result<(Scale, String), String> {
    /// Rounding makes nothing smaller.
    const SMALLER: f64 = 1.0 - 1e-9;
    let size = asked.of(notes, UsualSize::WidthMm(WIDTH_MM))?;
    // Exactly what was asked for, not what its pixels add up to.
    let width_mm = match (asked.width_mm, size.asked, size.is_the_files) {
        (Some(asked), ..) => asked,
        (None, None, false) => WIDTH_MM,
        _ => size.mm_per_px * f64::from(notes.width_px.max(1)),
    };
    let scale = fit_drawing((notes.width_px, notes.height_px), machine, width_mm)?;
    let mut told = size.told();
    if scale.mm_per_px() < SMALLER * size.mm_per_px {
        let [width_mm, height_mm] =
            [notes.width_px, notes.height_px].map(|px| f64::from(px) * scale.mm_per_px());
        told.push_str(&format!("; drawn {width_mm:.2} x {height_mm:.2} mm, for the machine is smaller"));
    }
    Ok((scale, told))
}

/// The drawing's place: its left lower corner a little off the origin, as large as asked and as the area
/// allows.
///
/// # Errors
///
/// A width that is none, or an area too small for the margin.
pub fn fit_drawing(
    (width_px, height_px): (u32, u32),
    machine: &Machine,
    width_mm: f64,
) -> Result<Scale, String> {
    const MARGIN_MM: f64 = 5.0;
    if !(width_mm > 0.0 && width_mm.is_finite()) {
        return Err(format!("--width-mm {width_mm}: give a width above 0 mm"));
    }
    let area = machine.config().area;
    let (width_px, height_px) = (width_px.max(1), height_px.max(1));
    let height_mm = width_mm * f64::from(height_px) / f64::from(width_px);
    let corner = Point::new(
        area.width_mm.min(width_mm + 2.0 * MARGIN_MM),
        area.height_mm.min(height_mm + 2.0 * MARGIN_MM),
    );
    Scale::fit(width_px, height_px, Point::ORIGIN, corner, MARGIN_MM).map_err(|error| error.to_string())
}
