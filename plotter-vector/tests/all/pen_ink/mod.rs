//! What a pen leaves of straight lines at 1 bit a pixel.
#![allow(clippy::cast_possible_truncation, reason = "places in a picture are made to fit")]

use crate::segment_distance::segment_distance;
use plotter_vector::{Bitmap, Pixel, PxPoint};

/// A straight line, from and to.
pub(crate) type Line = [PxPoint; 2];

/// A square picture of lines: ink is every pixel whose middle lies within half their width.
pub(crate) fn ink_of(side_px: u32, lines: &[Line], width_px: f64) -> Bitmap {
    let mut ink = Bitmap::new(side_px, side_px).unwrap();
    for [from, to] in lines {
        let range = |a: f64, b: f64| (a.min(b) - width_px) as u32..=(a.max(b) + width_px) as u32;
        for y in range(from.y, to.y) {
            for at in range(from.x, to.x).map(|x| Pixel::new(x, y)) {
                if segment_distance(at.into(), *from, *to) <= width_px / 2.0 {
                    ink.set(at, true);
                }
            }
        }
    }
    ink
}
