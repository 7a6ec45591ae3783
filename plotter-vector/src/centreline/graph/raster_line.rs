//! Lines one pixel wide: every pixel of the ink is a place of the line.
//!
//! Thinning leaves out the pixel in a corner and every second one of a staircase. Where the raster itself is the line
//! no pixel may be lost: each is put back between those of its neighbours that follow each other along the line. A
//! pixel inside a block of two by two is no line's corner but part of its width, and stays out.

use super::build::Stretch;
use super::{Graph, Scan};
use crate::picture::{Bitmap, Pixel};
use std::collections::HashMap;

/// Puts the ink of thin lines that thinning took away back into the edges that pass beside it.
///
/// The skeleton's first row is row `first_row` of the whole picture. Which edge takes a pixel depends on its neighbours
/// only, so it is the same in a band and in the whole picture.
pub(crate) fn put_back(graph: &mut Graph, scan: Scan<'_>, skeleton: &Stretch<'_>, first_row: u32) {
    let mut lost: HashMap<(Pixel, Pixel), Vec<Pixel>> = HashMap::new();
    let down = |at: Pixel| Pixel { y: at.y.saturating_add(first_row), ..at };
    each_lost(scan.ink, first_row.saturating_sub(scan.first_row), skeleton, |beside| {
        if let Some((one, other)) = home(skeleton.picture, beside) {
            lost.entry((down(one), down(other))).or_default().push(down(beside));
        }
    });
    if lost.is_empty() {
        return;
    }
    for edge in &mut graph.edges {
        let link = |(at, next): (&Pixel, &Pixel)| lost.get(&(*at.min(next), *at.max(next)));
        let mut links = edge.pixels.iter().zip(edge.pixels.iter().skip(1));
        if !links.any(|pair| link(pair).is_some()) {
            continue;
        }
        let mut pixels = Vec::with_capacity(edge.pixels.len() + 8);
        for (index, at) in edge.pixels.iter().enumerate() {
            pixels.push(*at);
            let between = edge.pixels.get(index + 1).and_then(|next| link((at, next)));
            pixels.extend(between.into_iter().flatten());
        }
        edge.pixels = pixels;
    }
}

/// Calls `found` with the ink in no block of two by two that is not in the skeleton, in reading order. The skeleton's
/// first row is row `first_row` of the ink.
fn each_lost(ink: &Bitmap, first_row: u32, skeleton: &Stretch<'_>, mut found: impl FnMut(Pixel)) {
    // Blocks by their upper left pixel, in the row above and in this one.
    let mut above = vec![0; ink.row(0).len()];
    let mut here = above.clone();
    for y in skeleton.rows.clone() {
        let (row, below) = (ink.row(first_row + y), ink.row(first_row + y + 1));
        let both = |word: usize| row.get(word).copied().unwrap_or(0) & below.get(word).copied().unwrap_or(0);
        for (word, block) in here.iter_mut().enumerate() {
            let both_here = both(word);
            *block = if both_here == 0 { 0 } else { both_here & (both_here >> 1 | both(word + 1) << 63) };
        }
        let mut left = 0;
        for (word, ((ink, kept), (above, here))) in
            row.iter().zip(skeleton.picture.row(y)).zip(above.iter().zip(&here)).enumerate()
        {
            let blocks = above | here;
            let mut lost = ink & !kept & !(blocks | blocks << 1 | left >> 63);
            left = blocks;
            while lost != 0 {
                let x = u32::try_from(word).unwrap_or(u32::MAX) * u64::BITS + lost.trailing_zeros();
                lost &= lost - 1;
                found(Pixel::new(x, y));
            }
        }
        core::mem::swap(&mut above, &mut here);
    }
}

/// The first pair, in reading order, of skeleton pixels that touch each other and a pixel beside them.
fn home(skeleton: &Bitmap, beside: Pixel) -> Option<(Pixel, Pixel)> {
    let on = || around(beside).filter(|at| skeleton.get(*at));
    let pairs = on().flat_map(|one| on().map(move |other| (one, other)));
    pairs.filter(|(one, other)| one < other && one.touches(*other) && linked(skeleton, *one, *other)).min()
}

/// Whether two touching pixels of a skeleton follow each other: not over a corner that has a pixel of its own.
fn linked(skeleton: &Bitmap, one: Pixel, other: Pixel) -> bool {
    one.x == other.x
        || one.y == other.y
        || !(skeleton.get(Pixel::new(one.x, other.y)) || skeleton.get(Pixel::new(other.x, one.y)))
}

/// The eight neighbours.
fn around(at: Pixel) -> impl Iterator<Item = Pixel> {
    (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (dx, dy))).filter(|step| *step != (0, 0)).filter_map(
        move |(dx, dy)| Some(Pixel::new(at.x.checked_add_signed(dx)?, at.y.checked_add_signed(dy)?)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put_back_in(ink: &str, skeleton: &str) -> Vec<(u32, u32)> {
        let (ink, skeleton) = (Bitmap::from_picture(ink).unwrap(), Bitmap::from_picture(skeleton).unwrap());
        let skeleton = Stretch { picture: &skeleton, rows: 0..skeleton.height() };
        let mut graph = Graph::of(&skeleton, &mut Vec::new());
        put_back(
            &mut graph,
            Scan { ink: &ink, first_row: 0, grey: None, hairlines: crate::ink::hairlines::Hairlines::Raster },
            &skeleton,
            0,
        );
        graph.edges[0].pixels.iter().map(|at| (at.x, at.y)).collect()
    }

    #[test]
    fn a_corner_gets_its_pixel_back() {
        let corner = put_back_in("###\n..#\n..#\n", "##.\n..#\n..#\n");
        assert_eq!(corner, [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)]);
    }

    #[test]
    fn a_staircase_gets_its_pixels_back() {
        let stairs = put_back_in("##..\n.##.\n..##\n", "#...\n.#..\n..##\n");
        assert_eq!(stairs, [(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (3, 2)]);
    }

    #[test]
    fn a_line_two_pixels_wide_stays_a_line() {
        assert_eq!(put_back_in("####\n####\n", "####\n....\n").len(), 4);
    }
}
