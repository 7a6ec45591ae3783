//! [`turned`]: windows of a camera that is turned against its machine, as one sees them that is not.

use plotter_vector::{Gray, Pixel};

/// The largest square window in the middle of a square `window`, straight on the machine, of a camera that is
/// turned by so many degrees counterclockwise, as seen from above.
///
/// # Errors
///
/// A window so small that nothing of it is left.
pub(super) fn turned(window: &Gray, turn_deg: f64) -> Result<Gray, String> {
    if turn_deg == 0.0 {
        return Ok(window.clone());
    }
    let (sin, cos) = libm::sincos(turn_deg.to_radians());
    let side = f64::from(window.width().min(window.height()));
    // (a hair more than nothing: a quarter turn loses no pixel)
    let inside = libm::floor(side / (sin.abs() + cos.abs()) + 1e-9);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most the side")]
    let pixels = inside as u32;
    let from_middle = |at: u32| f64::from(at) + 0.5 - 0.5 * inside;
    let mut levels = Vec::new();
    for y in 0..pixels {
        for x in 0..pixels {
            let (right, down) = (from_middle(x), from_middle(y));
            levels.push(level(window, right * cos - down * sin, right * sin + down * cos));
        }
    }
    Gray::new(pixels, pixels, levels).map_err(|error| error.to_string())
}

/// The level at a place from the window's middle, between its pixels.
fn level(window: &Gray, right: f64, down: f64) -> u8 {
    let (x, y) =
        (right + 0.5 * f64::from(window.width()) - 0.5, down + 0.5 * f64::from(window.height()) - 0.5);
    let (left, top) = (libm::floor(x), libm::floor(y));
    let at = |x: f64, y: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a window")]
        let inside = |at: f64, size: u32| at.clamp(0.0, f64::from(size) - 1.0) as u32;
        let pixel = Pixel::new(inside(x, window.width()), inside(y, window.height()));
        f64::from(window.get(pixel).unwrap_or(u8::MAX))
    };
    let between = |a: f64, b: f64, share: f64| a + share * (b - a);
    let above = between(at(left, top), at(left + 1.0, top), x - left);
    let below = between(at(left, top + 1.0), at(left + 1.0, top + 1.0), x - left);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two levels")]
    let level = libm::round(between(above, below, y - top)) as u8;
    level
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of 4 px from the middle to the right, as a camera sees it.
    fn window() -> Gray {
        let is_ink = |x: u32, y: u32| x >= 50 && (48..52).contains(&y);
        let levels =
            (0..100).flat_map(|y| (0..100).map(move |x| if is_ink(x, y) { 0 } else { 255 })).collect();
        Gray::new(100, 100, levels).unwrap()
    }

    #[test]
    fn what_lies_to_the_right_in_the_picture_lies_round_by_the_turn_on_the_sheet() {
        assert_eq!(turned(&window(), 0.0).unwrap(), window());
        let dark = |turn_deg: f64, right: i32, down: i32| {
            let turned = turned(&window(), turn_deg).unwrap();
            let at = |by| (turned.width() / 2).saturating_add_signed(by);
            turned.get(Pixel::new(at(right), at(down))).unwrap() < 20
        };
        // Counterclockwise: up on the sheet, whose pixels count down.
        assert!(dark(90.0, 0, -30) && !dark(90.0, 30, 0) && !dark(90.0, 0, 30));
        assert!(dark(-90.0, 0, 30) && dark(180.0, -30, 0) && dark(45.0, 20, -20));
        let quarter = turned(&window(), 90.0).unwrap();
        assert_eq!((quarter.width(), turned(&window(), 45.0).unwrap().width()), (100, 70));
        assert_eq!(turned(&quarter, -90.0).unwrap(), window());
    }
}
