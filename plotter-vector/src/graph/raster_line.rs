//! Lines one pixel wide: every pixel of the ink is a place of the line.
//!
//! Thinning leaves out the pixel in a corner and every second one of a staircase. Where the raster itself is the line
//! no pixel may be lost: each is put back between those of its neighbours that follow each other along the line. A
//! pixel inside a block of two by two is no line's corner but part of its width, and stays out.

use super::Graph;
use crate::{Bitmap, Pixel};

/// Puts the ink of thin lines that thinning took away back into the edges that pass beside it.
///
/// Which edge takes a pixel depends on its neighbours only, so it is the same in a band and in the whole picture.
pub(crate) fn put_back(graph: &mut Graph, ink: &Bitmap, skeleton: &Bitmap) {
    for edge in &mut graph.edges {
        let is_lost = |at: Pixel| ink.get(at) && !skeleton.get(at) && !in_block(ink, at);
        if !edge.pixels.iter().any(|at| ink.around(*at) & !skeleton.around(*at) != 0) {
            continue;
        }
        let mut pixels = Vec::with_capacity(edge.pixels.len() + 8);
        for (index, at) in edge.pixels.iter().enumerate() {
            pixels.push(*at);
            let Some(next) = edge.pixels.get(index + 1) else { break };
            if ink.around(*at) & !skeleton.around(*at) == 0 {
                continue;
            }
            let link = (*at.min(next), *at.max(next));
            let between = around(*at).filter(|beside| beside.touches(*next) && is_lost(*beside));
            pixels.extend(between.filter(|beside| home(skeleton, *beside) == Some(link)));
        }
        edge.pixels = pixels;
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

/// Whether a pixel lies in a block of two by two pixels of ink.
fn in_block(ink: &Bitmap, at: Pixel) -> bool {
    let around = ink.around(at);
    // Right and below with the corner between them, and so on around.
    (0..4).any(|turn| {
        let three = 0b111_u8.rotate_left(2 * turn);
        around & three == three
    })
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
        let mut graph = Graph::of(&skeleton);
        put_back(&mut graph, &ink, &skeleton);
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
