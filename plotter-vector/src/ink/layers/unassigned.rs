//! [`Unassigned`]: ink that no pen got.

use super::bridge_gaps::grown_by;
use crate::ink::pen_width_px;
use crate::picture::{Bitmap, Pixel};

/// Rims that one pen alone would draw and that the pens leave out reach so far, px.
const RIM_PX: u32 = 3;
/// What is shorter than so many widths of the lines is a rim or a blot, and no stroke.
const LEAST_WIDTHS: u32 = 3;

/// Ink of a picture in colour that none of its pens got: it is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unassigned {
    /// A pixel of the longest piece.
    pub at: Pixel,
    /// Length of that piece, px: the longer side of the box around it.
    pub length_px: u32,
    /// Number of pieces.
    pub pieces: usize,
}

/// What of the ink lies apart from the ink of all pens.
pub(super) fn unassigned<'a>(
    ink: &Bitmap,
    of_pens: impl IntoIterator<Item = &'a Bitmap>,
) -> Option<Unassigned> {
    let mut got = Bitmap::new(ink.width(), ink.height()).ok()?;
    for pen in of_pens {
        got = got.united(pen);
    }
    let mut rest = ink.clone().without(&grown_by(&got, RIM_PX));
    let least_px = LEAST_WIDTHS * pen_width_px(ink).unwrap_or(1);
    let mut found: Option<Unassigned> = None;
    let mut next = rest.ink().next();
    while let Some(at) = next {
        let length_px = take_piece(&mut rest, at);
        if length_px >= least_px {
            let pieces = found.map_or(0, |found| found.pieces) + 1;
            let longest = found.filter(|found| found.length_px >= length_px);
            found = Some(Unassigned { pieces, ..longest.unwrap_or(Unassigned { at, length_px, pieces }) });
        }
        next = rest.first_from(at.y);
    }
    found
}

/// Takes out the ink that hangs together with a pixel, and gives the longer side of the box around it.
fn take_piece(ink: &mut Bitmap, at: Pixel) -> u32 {
    let (mut left, mut right, mut top, mut bottom) = (at.x, at.x, at.y, at.y);
    let mut to_do = vec![at];
    ink.set(at, false);
    while let Some(at) = to_do.pop() {
        (left, right) = (left.min(at.x), right.max(at.x));
        (top, bottom) = (top.min(at.y), bottom.max(at.y));
        for y in at.y.saturating_sub(1)..=at.y + 1 {
            for x in at.x.saturating_sub(1)..=at.x + 1 {
                let beside = Pixel::new(x, y);
                if ink.get(beside) {
                    ink.set(beside, false);
                    to_do.push(beside);
                }
            }
        }
    }
    (right - left).max(bottom - top) + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ink_apart_from_all_pens_is_told_with_its_place_and_length() {
        let line = |y: u32, columns: core::ops::Range<u32>| {
            let mut ink = Bitmap::new(90, 40).unwrap();
            columns.flat_map(|x| [y, y + 1].map(|y| Pixel::new(x, y))).for_each(|at| ink.set(at, true));
            ink
        };
        let (got, left, short) = (line(5, 5..80), line(20, 10..60), line(30, 70..74));
        let ink = got.clone().united(&left).united(&short);
        let all = unassigned(&ink, [&got]);
        assert_eq!(all, Some(Unassigned { at: Pixel::new(10, 20), length_px: 50, pieces: 1 }));
        assert_eq!(unassigned(&ink, [&got, &left]), None);
        // A rim of the ink is no stroke.
        assert_eq!(unassigned(&line(5, 5..80), [&line(7, 5..80)]), None);
    }
}
