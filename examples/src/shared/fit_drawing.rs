//! Where a drawing lies on a machine's sheet.

use plotter_motion::{Machine, Point};
use plotter_vector::Scale;

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
