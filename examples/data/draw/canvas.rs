//! Thin black lines on white paper.

use image::{GrayImage, Luma};

/// A point, px: x to the right, y down, whole numbers are pixel centres.
pub(crate) type At = (f64, f64);

pub(crate) fn paper(width: u32, height: u32) -> GrayImage {
    GrayImage::from_pixel(width, height, Luma([255]))
}

fn dot(sheet: &mut GrayImage, x: f64, y: f64) {
    let inside = |value: f64, size: u32| (0.0..f64::from(size)).contains(&value);
    if inside(x, sheet.width()) && inside(y, sheet.height()) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and inside the sheet"
        )]
        sheet.put_pixel(x as u32, y as u32, Luma([0]));
    }
}

/// Half up in the direction of the axes: a pixel on the border between two belongs to one of them only.
fn round(value: f64) -> f64 {
    libm::floor(value + 0.5)
}

/// A straight line of 1 px, connected by sides or corners.
pub(crate) fn line(sheet: &mut GrayImage, from: At, to: At) {
    let (from, to) = ((round(from.0), round(from.1)), (round(to.0), round(to.1)));
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let steps = libm::fabs(dx).max(libm::fabs(dy));
    dot(sheet, from.0, from.1);
    let mut step = 1.0;
    while step <= steps {
        dot(sheet, round(from.0 + dx * step / steps), round(from.1 + dy * step / steps));
        step += 1.0;
    }
}

/// Straight lines through all points.
pub(crate) fn lines(sheet: &mut GrayImage, points: &[At]) {
    for pair in points.windows(2) {
        line(sheet, pair[0], pair[1]);
    }
}

/// A level or upright line of `width` px: rows or columns side by side, the first one on the given points.
pub(crate) fn thick(sheet: &mut GrayImage, from: At, to: At, width: u32) {
    let (right, down) = if from.1 == to.1 { (0.0, 1.0) } else { (1.0, 0.0) };
    for row in 0..width {
        let by = f64::from(row);
        let shift = |at: At| (at.0 + right * by, at.1 + down * by);
        line(sheet, shift(from), shift(to));
    }
}

/// The part of a circle for which `keep` says yes, 1 px thin: in each column where the circle is flatter than
/// 45 degrees the row nearest to it, and in each row where it is steeper the column nearest to it.
pub(crate) fn circle(sheet: &mut GrayImage, centre: At, radius: f64, keep: impl Fn(f64, f64) -> bool) {
    let reach = libm::ceil(radius * core::f64::consts::FRAC_1_SQRT_2);
    for flat in [true, false] {
        let (along, across) = if flat { (centre.0, centre.1) } else { (centre.1, centre.0) };
        let mut at = round(along) - reach;
        while at <= round(along) + reach {
            let away = at - along;
            let height = libm::sqrt(radius * radius - away * away);
            if libm::fabs(away) <= height {
                for side in [-1.0, 1.0] {
                    let on = round(across + side * height);
                    let (x, y) = if flat { (at, on) } else { (on, at) };
                    if keep(x, y) {
                        dot(sheet, x, y);
                    }
                }
            }
            at += 1.0;
        }
    }
}
