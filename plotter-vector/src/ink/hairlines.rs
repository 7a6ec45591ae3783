//! [`Hairlines`]: whether thin lines are chains of pixels or the ink of a pen wider than a pixel.
//!
//! ```text
//!   # # # . . . .      a bare step: the next pixel lies across the corner,
//!   . . . # # # .      as in the raster of a line
//!
//!   # # # . . . .      a filled step: the corner has a pixel of its own, or more,
//!   . . # # # # .      as under a pen that inks all pixels whose middle it comes over
//! ```
//!
//! A pen of w px that moves in the direction θ, up to 45°, inks w / cos θ pixels of each column on average. A
//! step comes once in 1 / tan θ columns, so the fraction (w / cos θ − 1) / tan θ of all steps is filled. That
//! is tan(θ / 2), at most 0.414, for w = 1, and at least √(w² − 1) for a wider pen: 0.458 for 1.1 px, in any
//! direction. The raster of a line has filled steps only where lines run into each other: fewer than one in
//! eight.

/// Least number of filled steps in sixteen under a pen: 7/16 is a pen of 1.09 px, between the 0.414 of one
/// pixel and the 0.458 of 1.1 px.
const FILLED_OF_16: u64 = 7;

/// Most pixels of ink per filled step of a pen: fewer filled steps than that come of lines that touch.
const INK_PER_STEP: u64 = 256;

/// Kinds of thin lines in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Hairlines {
    /// Chains of pixels, each of which is the line.
    #[default]
    Raster,
    /// Chains with pixels in the corners of some steps: the ink of a pen one pixel wide.
    Stairs,
    /// The ink of a wider pen: the line is its middle.
    Pen,
}

/// Counts steps of thin lines, row by row from the top.
#[derive(Clone, Debug)]
pub(crate) struct Steps {
    /// The last five rows, the lowest last, each with a word of paper before and after it.
    rows: [Vec<u64>; 5],
    found: Found,
}

/// Counts of steps and blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Found {
    /// Bare steps.
    bare: u64,
    /// Pixels in which a line turns along a step that one pixel fills.
    turns: u64,
    /// Steps that more pixels fill.
    overlaps: u64,
    /// Blocks of two by two pixels of ink.
    pub(crate) blocks: u64,
}

impl Steps {
    /// No rows yet, of a picture `width` px wide.
    pub(crate) fn new(width: u32) -> Self {
        let row = || vec![0; width.div_ceil(u64::BITS) as usize + 2];
        Self { rows: [row(), row(), row(), row(), row()], found: Found::default() }
    }

    /// Counts the next row, in words as of [`Bitmap::row`](crate::picture::Bitmap::row); a longer row is cut,
    /// a shorter one ends with paper.
    pub(crate) fn push(&mut self, row: &[u64]) {
        self.rows.rotate_left(1);
        let [first, above, here, below, last] = &mut self.rows;
        let end = last.len() - 1;
        let words = last.get_mut(1..end).unwrap_or_default();
        let given = row.len().min(words.len());
        let (words, rest) = words.split_at_mut(given);
        words.copy_from_slice(row.get(..given).unwrap_or(&[]));
        rest.fill(0);
        let pairs = here.iter().zip(below.iter()).skip(1).take(end - 1);
        for (before, _) in pairs.enumerate().filter(|(_, (here, below))| **here | **below != 0) {
            // Words of paper, most of a sheet, have been skipped. The five calls are written out: an array
            // mapped over is not kept in registers.
            let of = |row: &[u64]| row.get(before..before + 3).map_or_else(Around::default, Around::of);
            self.found.add([of(first), of(above), of(here), of(below), of(last)]);
        }
    }

    /// The counts, after the last row.
    pub(crate) fn finish(mut self) -> Found {
        (0..2).for_each(|_| self.push(&[]));
        self.found
    }
}

impl Found {
    /// Adds the steps of the third of five rows, some of which it has together with the fourth.
    fn add(&mut self, window: [Around; 5]) {
        let [first, above, here, below, last] = window;
        let mirrored =
            [first.mirrored(), above.mirrored(), here.mirrored(), below.mirrored(), last.mirrored()];
        self.bare += u64::from(bare_steps(window).count_ones());
        self.turns += u64::from((turns(window) | turns(mirrored)).count_ones());
        self.blocks += u64::from(here.blocks(below)[1].count_ones());
        self.overlaps += u64::from(overlaps([above, here, below, last]).count_ones());
    }

    /// Filled steps: a line turns twice in each.
    fn filled(self) -> u64 {
        self.turns / 2 + self.overlaps
    }

    /// The kind of the thin lines in a picture with `ink_pixels` pixels of ink.
    pub(crate) fn hairlines(self, ink_pixels: u64) -> Hairlines {
        let (steps, filled) = (self.bare + self.filled(), self.filled());
        if filled == 0 || filled * INK_PER_STEP < ink_pixels || 8 * filled < steps {
            Hairlines::Raster
        } else if 16 * filled < FILLED_OF_16 * steps {
            Hairlines::Stairs
        } else {
            Hairlines::Pen
        }
    }
}

/// The pixels of a word, and those one and two to the left and to the right of each.
#[derive(Clone, Copy, Default)]
struct Around {
    left: [u64; 2],
    at: u64,
    right: [u64; 2],
}

impl Around {
    /// The middle one of three words of a row.
    fn of(words: &[u64]) -> Self {
        let &[before, at, after] = words else { return Self::default() };
        Self {
            left: [at << 1 | before >> 63, at << 2 | before >> 62],
            at,
            right: [at >> 1 | after << 63, at >> 2 | after << 62],
        }
    }

    /// Blocks of two by two pixels in this row and the next one: where one begins a pixel to the left, here,
    /// and a pixel to the right.
    fn blocks(self, next: Self) -> [u64; 3] {
        let both = |one: u64, other: u64| one & other;
        let [left, at] = [both(self.left[0], next.left[0]), both(self.at, next.at)];
        let [right, far] = [both(self.right[0], next.right[0]), both(self.right[1], next.right[1])];
        [left & at, at & right, right & far]
    }

    /// The same seen in a mirror.
    fn mirrored(self) -> Self {
        Self { left: self.right, right: self.left, ..self }
    }
}

/// Where a pixel of the fourth of five rows touches one of the third across a corner only.
fn bare_steps([_, _, here, below, _]: [Around; 5]) -> u64 {
    below.at & !here.at & (here.left[0] & !below.left[0] | here.right[0] & !below.right[0])
}

/// Pixels of the third of five rows in which a staircase one pixel wide turns from along the row to along a
/// column: two of a step that a pixel fills, but one where both its neighbours lie across a corner. Beyond
/// its neighbours it turns back; else the line has a corner of its own.
fn turns([first, above, here, below, last]: [Around; 5]) -> u64 {
    // From the left, on to the next row and the one after that.
    let to = |[back, next, far]: [Around; 3]| {
        let turns_back = next.right[0] | far.right[0] | back.left[0] | back.left[1];
        here.left[0] & !here.right[0] & next.at & !next.left[0] & !back.at & turns_back
    };
    here.at & (to([above, below, last]) | to([below, above, first]))
}

/// Where a row or a column of blocks begins, between the second of four rows and the third, that is one block
/// high or wide.
fn overlaps([above, here, below, last]: [Around; 4]) -> u64 {
    let [left, at, right] = here.blocks(below);
    at & !left & !above.blocks(here)[1] & !(right & below.blocks(last)[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Bitmap, Pixel};

    const SIDE_PX: u32 = 200;

    fn steps(ink: &Bitmap) -> Found {
        let mut steps = Steps::new(ink.width());
        (0..ink.height()).for_each(|y| steps.push(ink.row(y)));
        steps.finish()
    }

    fn counts(picture: &str) -> (u64, u64, u64) {
        let found = steps(&Bitmap::from_picture(picture).unwrap());
        (found.bare, found.filled(), found.blocks)
    }

    /// Lines 20 px apart that make an angle with the rows, each at another place between the pixels.
    fn lines(angle_rad: f64, is_ink: impl Fn(f64, f64) -> bool) -> Bitmap {
        let (sine, cosine) = libm::sincos(angle_rad);
        let mut ink = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
        for (x, y) in (0..SIDE_PX).flat_map(|y| (0..SIDE_PX).map(move |x| (x, y))) {
            let across = f64::from(y) * cosine - f64::from(x) * sine;
            let off_px = across - 20.37 * libm::round(across / 20.37);
            ink.set(Pixel::new(x, y), is_ink(off_px, cosine));
        }
        ink
    }

    #[test]
    fn a_step_is_bare_or_filled() {
        assert_eq!(counts("###....\n...###.\n"), (1, 0, 0));
        assert_eq!(counts("...###\n####..\n"), (0, 1, 0));
        assert_eq!(counts("#.\n##\n.#\n"), (0, 1, 0));
        // Filled by a row of two blocks, and by a column.
        assert_eq!(counts("#####..\n..#####\n"), (0, 1, 2));
        assert_eq!(counts("#.\n##\n##\n##\n.#\n"), (0, 1, 2));
    }

    #[test]
    fn crossings_ends_corners_and_areas_are_no_steps() {
        assert_eq!(counts("..#..\n..#..\n#####\n..#..\n"), (0, 0, 0));
        assert_eq!(counts("#####\n..#..\n..#..\n"), (0, 0, 0));
        assert_eq!(counts("#####\n#...#\n#...#\n#####\n"), (0, 0, 0));
        assert_eq!(counts("####\n####\n####\n"), (0, 0, 6));
    }

    #[test]
    fn steps_are_seen_across_words() {
        for left in [58, 59, 60, 61, 62, 63] {
            for (picture, expected) in
                [("###..\n...##\n", (1, 0)), ("###..\n..###\n", (0, 1)), ("####.\n..###\n", (0, 1))]
            {
                let small = Bitmap::from_picture(picture).unwrap();
                let mut ink = Bitmap::new(130, 2).unwrap();
                small.ink().for_each(|at| ink.set(Pixel::new(at.x + left, at.y), true));
                let found = steps(&ink);
                assert_eq!((found.bare, found.filled()), expected, "{left}\n{picture}");
            }
        }
    }

    #[test]
    fn a_pen_is_told_from_a_raster_by_a_tenth_of_a_pixel_in_any_direction() {
        for step in 1..32 {
            let angle_rad = 0.05 * f64::from(step);
            for (width_px, is_pen) in [(1.0, false), (1.1, true), (1.5, true)] {
                let ink = lines(angle_rad, |off_px, _| off_px.abs() <= width_px / 2.0);
                let found = steps(&ink).hairlines(ink.count());
                assert_eq!(found == Hairlines::Pen, is_pen, "{width_px} px at {angle_rad}: {found:?}");
            }
            let raster = |off_px: f64, cosine: f64| {
                off_px.abs() <= 0.5 * cosine.max(libm::sqrt(1.0 - cosine * cosine))
            };
            let ink = lines(angle_rad, raster);
            assert_eq!(steps(&ink).hairlines(ink.count()), Hairlines::Raster, "raster at {angle_rad}");
        }
    }
}
