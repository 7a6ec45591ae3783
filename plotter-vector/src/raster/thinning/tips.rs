//! Tells tips of ink that are still shrinking from ends of strokes.

/// Rows above and below that [`shrinking`] looks at.
pub(super) const REACH: u32 = 3;

/// Rows of a window, and columns.
const SIDE: usize = 7;

/// Those of the `tips` in word `at` of the middle row that go on shrinking: the ink next to them is still
/// thick.
///
/// While a stroke is peeled from its sides its end is peeled too, as fast. Keeping every tip would keep each
/// corner of a square end, and each hair of a ragged edge, as a branch; dropping every tip would eat the
/// stroke. A tip is therefore the end of a stroke from the moment there is no pixel with ink on all four
/// sides within two of it, counted in either direction: the stroke has become thin there, be it by thinning
/// or by tapering.
///
/// Ink with all four sides has no tip among them, so this does not depend on which tips have already gone. Of
/// a component of two pixels both are tips, and both stay.
pub(super) fn shrinking(rows: [&[u64]; SIDE], at: usize, tips: u64) -> u64 {
    let mut rest = tips;
    let mut gone = 0;
    while rest != 0 {
        let bit = rest & rest.wrapping_neg();
        rest ^= bit;
        let window = window(rows, at, bit.trailing_zeros());
        if is_thick(window) && !is_pair(window) {
            gone |= bit;
        }
    }
    gone
}

/// The 7 x 7 pixels around pixel `x` of word `at`, eight bits a row; the pixel itself is bit 3 of row 3.
fn window(rows: [&[u64]; SIDE], at: usize, x: u32) -> u64 {
    rows.iter().rev().fold(0, |window, row| {
        let word = |index: usize| row.get(index).copied().unwrap_or(0);
        let middle = word(at);
        let bits = match x {
            0..3 => middle << (3 - x) | word(at.wrapping_sub(1)) >> (61 + x),
            3..61 => middle >> (x - 3),
            _ => middle >> (x - 3) | word(at + 1) << (67 - x),
        };
        window << 8 | bits & 0x7f
    })
}

/// Whether a pixel of the inner 5 x 5 has ink on all four sides.
const fn is_thick(window: u64) -> bool {
    const INNER: u64 = 0x0000_3e3e_3e3e_3e00;
    window & window << 1 & window >> 1 & window << 8 & window >> 8 & INNER != 0
}

/// Whether the pixel in the middle and its only neighbour are a component by themselves.
const fn is_pair(window: u64) -> bool {
    const RING: u64 = 0x0000_001c_141c_0000;
    let neighbours = window & RING;
    if neighbours.count_ones() != 1 {
        return false;
    }
    let at = neighbours.trailing_zeros();
    // The ring moved from the middle, bit 27, to the neighbour: at most 9 places either way.
    let around = if at < 27 { RING >> (27 - at) } else { RING << (at - 27) };
    (window & around).count_ones() == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Bitmap, Pixel};

    /// Judges the pixel in the middle of a picture of 7 x 7, wherever it lies in its words.
    fn goes(picture: &str) -> bool {
        let small = Bitmap::from_picture(picture).unwrap();
        let answers: Vec<bool> = (0..125)
            .map(|shift| {
                let mut large = Bitmap::new(140, 7).unwrap();
                small.ink().for_each(|at| large.set(Pixel::new(at.x + shift, at.y), true));
                let rows = [0, 1, 2, 3, 4, 5, 6].map(|y| large.row(y));
                let x = shift + 3;
                let tip = 1 << (x % 64);
                shrinking(rows, (x / 64) as usize, tip) == tip
            })
            .collect();
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{picture}");
        answers[0]
    }

    #[test]
    fn a_bump_on_thick_ink_goes() {
        assert!(goes(".......\n.......\n.......\n...#...\n#######\n#######\n#######\n"));
        assert!(goes(".......\n.......\n.......\n...##..\n.....##\n....###\n.....#.\n"));
    }

    #[test]
    fn the_end_of_a_thin_line_stays() {
        assert!(!goes(".......\n.......\n.......\n...####\n.......\n.......\n.......\n"));
        assert!(!goes(".......\n.......\n.......\n...####\n....###\n.......\n.......\n"));
        assert!(!goes(".......\n.......\n.......\n...#...\n...#...\n...#...\n..###..\n"));
    }

    #[test]
    fn a_pair_beside_thick_ink_stays() {
        assert!(!goes(".......\n.......\n.......\n...##..\n.......\n..####.\n..####.\n"));
        assert!(!goes("..###..\n..###..\n.......\n...#...\n..#....\n.......\n.......\n"));
    }
}
