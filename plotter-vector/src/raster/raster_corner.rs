//! [`take_out`] and [`put_back`]: pixels in the corners of a staircase belong to the line that passes beside
//! them.
//!
//! ```text
//!   # # c . .        the corners c are taken out before the lines are followed, so that each step is one across a
//!   . . # # c        corner, and come back between the two pixels that they lie beside
//!   . . . . #
//! ```

use crate::picture::{Bitmap, Figures, Pixel};

/// Takes the pixels of ink out that only fill a corner: what is left touches as it did. They are in reading
/// order.
pub(crate) fn take_out(ink: &mut Bitmap) -> Vec<Pixel> {
    let mut corners = Vec::new();
    for y in 0..ink.height() {
        for word in 0..ink.row(y).len() {
            let mut bits = ink.row(y).get(word).copied().unwrap_or(0);
            while bits != 0 {
                let x = u32::try_from(word).unwrap_or(u32::MAX) * u64::BITS + bits.trailing_zeros();
                bits &= bits - 1;
                let at = Pixel::new(x, y);
                if is_corner(ink, at) {
                    ink.set(at, false);
                    corners.push(at);
                }
            }
        }
    }
    corners
}

/// Whether a pixel has one neighbour in its row and one in its column, that touch, and all others touch
/// these.
fn is_corner(ink: &Bitmap, at: Pixel) -> bool {
    let is_ink = |dx: i32, dy: i32| {
        let (x, y) = (at.x.checked_add_signed(dx), at.y.checked_add_signed(dy));
        x.zip(y).is_some_and(|(x, y)| ink.get(Pixel::new(x, y)))
    };
    let [right, below, left, above] = [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(dx, dy)| is_ink(dx, dy));
    if right == left || above == below {
        return false;
    }
    let (dx, dy) = (if right { 1 } else { -1 }, if below { 1 } else { -1 });
    // A block has no corner, and across the outer corner there may be another line.
    if is_ink(dx, dy) || is_ink(-dx, -dy) {
        return false;
    }
    // Beyond both neighbours a staircase goes on, beyond one of them at least across: else the line has a
    // corner of its own here.
    let across = [is_ink(2 * dx, -dy) || is_ink(dx, -dy), is_ink(-dx, 2 * dy) || is_ink(-dx, dy)];
    let goes_on = (across[0] || is_ink(2 * dx, 0)) && (across[1] || is_ink(0, 2 * dy));
    goes_on && across.contains(&true)
}

/// Puts corners back into figures, and figures of a single pixel that lie in one: each between two pixels
/// that follow each other. What lies beside none is a figure of its own.
pub(crate) fn put_back(figures: &Figures, corners: &[Pixel], width: u32, height: u32) -> Figures {
    let Ok(mut out) = Bitmap::new(width, height) else { return figures.clone() };
    let single = figures.iter().filter(|figure| figure.len() == 1).flatten();
    let single: Vec<Pixel> = single.copied().collect();
    corners.iter().chain(&single).for_each(|at| out.set(*at, true));
    let mut whole = Figures::default();
    for figure in figures.iter().filter(|figure| figure.len() > 1) {
        let mut pixels = Vec::with_capacity(figure.len() * 5 / 4);
        // The end of a closed figure is followed by its start: there it may begin, as it would have with all
        // its pixels.
        let before = figure.iter().rev().take(1).chain(figure);
        for (before, at) in before.zip(figure) {
            if let Some(corner) = corner(&out, *before, *at) {
                out.set(corner, false);
                pixels.push(corner);
            }
            pixels.push(*at);
        }
        whole.push(pixels);
    }
    for at in corners.iter().chain(&single) {
        if out.get(*at) {
            whole.push([*at]);
        }
    }
    whole
}

/// The pixel of a picture in one of the two corners of a diagonal step.
fn corner(picture: &Bitmap, from: Pixel, to: Pixel) -> Option<Pixel> {
    let diagonal = from.x.abs_diff(to.x) == 1 && from.y.abs_diff(to.y) == 1;
    let corners = [Pixel::new(from.x, to.y), Pixel::new(to.x, from.y)];
    corners.into_iter().find(|at| diagonal && picture.get(*at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken_out(picture: &str) -> (String, Vec<(u32, u32)>) {
        let mut ink = Bitmap::from_picture(picture).unwrap();
        let corners = take_out(&mut ink);
        (ink.to_string(), corners.iter().map(|at| (at.x, at.y)).collect())
    }

    fn back(figures: &[&[(u32, u32)]], corners: &[(u32, u32)]) -> Vec<Vec<(u32, u32)>> {
        let pixel = |(x, y): &(u32, u32)| Pixel::new(*x, *y);
        let mut all = Figures::default();
        figures.iter().for_each(|figure| all.push(figure.iter().map(pixel)));
        let corners: Vec<Pixel> = corners.iter().map(pixel).collect();
        put_back(&all, &corners, 9, 9)
            .iter()
            .map(|figure| figure.iter().map(|at| (at.x, at.y)).collect())
            .collect()
    }

    #[test]
    fn each_step_of_a_staircase_gives_one_pixel() {
        let stairs = "###...\n..###.\n....##\n";
        assert_eq!(taken_out(stairs), ("##....\n..##..\n....##\n".into(), vec![(2, 0), (4, 1)]));
        // Between diagonals, too.
        let diagonal = "#....\n.##..\n..#..\n...#.\n";
        assert_eq!(taken_out(diagonal), ("#....\n.#...\n..#..\n...#.\n".into(), vec![(2, 1)]));
    }

    #[test]
    fn corners_crossings_and_areas_keep_their_pixels() {
        for picture in
            ["####\n#..#\n####\n", "..#..\n..#..\n#####\n..#..\n", "###\n###\n###\n", "###\n..#\n..#\n"]
        {
            assert_eq!(taken_out(picture), (picture.into(), vec![]));
        }
    }

    #[test]
    fn a_pixel_in_a_corner_becomes_part_of_the_line() {
        let line: &[(u32, u32)] = &[(0, 0), (1, 0), (2, 1), (3, 1)];
        let whole = [(0, 0), (1, 0), (2, 0), (2, 1), (3, 1)];
        assert_eq!(back(&[line], &[(2, 0)]), [whole]);
        assert_eq!(back(&[&[(2, 0)], line], &[]), [whole]);
        // On the other side too, but only one for each step: the other one is a dot.
        let both = [vec![(0, 0), (1, 0), (1, 1), (2, 1), (3, 1)], vec![(2, 0)]];
        assert_eq!(back(&[line, &[(1, 1)], &[(2, 0)]], &[]), both);
    }

    #[test]
    fn a_closed_line_begins_with_the_pixel_in_its_last_corner() {
        let ring: &[(u32, u32)] = &[(1, 0), (2, 0), (3, 1), (3, 2), (2, 3), (1, 3), (0, 2), (0, 1)];
        assert_eq!(back(&[ring], &[(0, 0)])[0], [&[(0, 0)], ring].concat());
    }

    #[test]
    fn other_dots_stay() {
        let line: &[(u32, u32)] = &[(0, 0), (1, 0), (2, 0)];
        assert_eq!(back(&[line, &[(1, 1)], &[(7, 7)]], &[]), [line, &[(1, 1)], &[(7, 7)]]);
    }
}
