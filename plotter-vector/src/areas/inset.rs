//! [`inset_outlines`]: borders moved inwards by half a pen's width, so that the pen's ink ends at the area's
//! edge.

use super::disc::Disc;
use super::outline::Outlines;
use crate::{
    picture::{Bitmap, Pixel},
    stroke::PxPoint,
};
use std::borrow::Cow;

/// From the centre of a paper pixel to its edge, px.
const TO_EDGE_PX: f64 = 0.5;

/// The outlines of all ink moved inwards by `inset_px`: dense sites about a pixel apart, closed (the first is
/// not repeated), outer borders clockwise as seen and holes the other way round.
///
/// A pen of width 2 · `inset_px` whose centre follows them inks the rim of the area and no centre of a paper
/// pixel: every site is `inset_px` + ½ px away from the nearest one (to within ¼ px, by linear interpolation
/// between pixels). Parts narrower than that pen have no such path and are left out;
/// [`split_by_width`](crate::areas::split_by_width()) with `max_line_px` of at least the pen's width keeps
/// them apart, and a [`Vectorizer`](crate::trace::Vectorizer) draws them along their middle. With 0 (or less,
/// or NaN) the sites are the middles of the pixels' edges, and nothing is left out.
///
/// Sources: erosion by a disc for the shape, then the distance to the nearest paper (P.-E. Danielsson,
/// "Euclidean distance mapping", 1980) at the pixels along its border only.
///
/// ```
/// # use plotter_vector::{Bitmap, areas::inset_outlines};
/// let square = Bitmap::from_picture(&"########\n".repeat(8))?;
/// let [path] = inset_outlines(&square, 2.0).collect::<Vec<_>>().try_into().unwrap();
/// let left = path.iter().map(|at| at.x).fold(8.0, f64::min);
/// assert_eq!((path.len(), left), (16, 2.0)); // 4 x 4 px are left
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
pub fn inset_outlines(ink: &Bitmap, inset_px: f64) -> impl Iterator<Item = Vec<PxPoint>> + '_ {
    let radius = pen_radius_px(inset_px);
    let (inner, shift) = radius.map_or((Cow::Borrowed(ink), 0), |radius| {
        let disc = Disc::of_radius(radius);
        (Cow::Owned(disc.places(ink).corners), disc.half())
    });
    Outlines::of(inner).map(move |path| {
        let Some(radius) = radius else { return path.midpoints().collect() };
        let moved = |pixel: Pixel| Pixel::new(pixel.x.wrapping_add(shift), pixel.y.wrapping_add(shift));
        let site = |(inside, outside): (Pixel, Pixel)| {
            let (inside, outside) = (moved(inside), moved(outside));
            let (far, near) = (paper_distance(ink, inside, radius), paper_distance(ink, outside, radius));
            // The disc fits around one and not around the other: far > radius ≥ near.
            let share = ((far - radius) / (far - near)).clamp(0.0, 1.0);
            // One pixel on, and maybe just outside of the picture.
            let step = |from: u32, to: u32| share * f64::from(to.wrapping_sub(from).cast_signed());
            let from = PxPoint::from(inside);
            PxPoint::new(from.x + step(inside.x, outside.x), from.y + step(inside.y, outside.y))
        };
        path.sides().map(site).collect()
    })
}

/// Distance of a path inset by `inset_px` from the nearest centre of a paper pixel, px; `None` without an
/// inset.
pub(super) fn pen_radius_px(inset_px: f64) -> Option<f64> {
    (inset_px > 0.0).then_some(inset_px.min(MAX_INSET_PX) + TO_EDGE_PX)
}

/// Greatest inset, px.
pub(super) const MAX_INSET_PX: f64 = 512.0;

/// Distance from a pixel's centre to that of the nearest paper pixel, px, outside the picture counting as
/// paper; a little more than `reach_px` + 1 where none is nearer.
fn paper_distance(ink: &Bitmap, at: Pixel, reach_px: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to MAX_INSET_PX + 3")]
    let limit = reach_px as u32 + 2;
    let mut best = limit * limit;
    for dy in (0..limit).take_while(|dy| dy * dy < limit * limit) {
        if dy * dy >= best {
            break;
        }
        for y in [at.y.checked_sub(dy), at.y.checked_add(dy)] {
            let row = y.map_or(&[] as &[u64], |y| ink.row(y));
            let dx = paper_in_row(row, at.x, limit);
            best = best.min(dx * dx + dy * dy);
        }
    }
    libm::sqrt(f64::from(best))
}

/// Columns from `x` to the nearest paper in a row, at most `limit`; a row outside the picture has no words.
fn paper_in_row(row: &[u64], x: u32, limit: u32) -> u32 {
    let (word, bit) = ((x / u64::BITS) as usize, x % u64::BITS);
    let Some(own) = row.get(word) else { return 0 };
    // Paper as ones, the pixel itself at the upper or the lower end.
    let (left, right) = (!own << (u64::BITS - 1 - bit), !own >> bit);
    let mut to_left = left.leading_zeros();
    if left == 0 {
        to_left = bit + 1;
        for bits in row.iter().take(word).rev() {
            let more = (!bits).leading_zeros();
            to_left += more;
            if more < u64::BITS || to_left >= limit {
                break;
            }
        }
    }
    let mut to_right = right.trailing_zeros();
    if right == 0 {
        to_right = u64::BITS - bit;
        for bits in row.iter().skip(word + 1) {
            let more = (!bits).trailing_zeros();
            to_right += more;
            if more < u64::BITS || to_right >= limit {
                break;
            }
        }
    }
    to_left.min(to_right).min(limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_paper_is_found_in_other_words_too() {
        let mut ink = Bitmap::new(300, 1).unwrap();
        (0..300).for_each(|x| ink.set(Pixel::new(x, 0), true));
        for paper in [None, Some(10), Some(63), Some(64), Some(200)] {
            paper.into_iter().for_each(|x| ink.set(Pixel::new(x, 0), false));
            for x in 0..300_u32 {
                let slow = (0..=300).find(|d| {
                    let paper = |x: Option<u32>| x.is_none_or(|x| !ink.get(Pixel::new(x, 0)));
                    paper(x.checked_sub(*d)) || paper(x.checked_add(*d))
                });
                assert_eq!(paper_in_row(ink.row(0), x, 1000), slow.unwrap(), "{x} of {paper:?}");
            }
        }
    }

    #[test]
    fn an_outline_in_a_disc_is_a_circle() {
        let centre = PxPoint::new(30.0, 30.0);
        let mut disc = Bitmap::new(60, 60).unwrap();
        for pixel in (0..60).flat_map(|y| (0..60).map(move |x| Pixel::new(x, y))) {
            disc.set(pixel, PxPoint::from(pixel).distance(centre) <= 25.0);
        }
        for inset_px in [0.3, 1.0, 4.5, 10.0] {
            let [path] = inset_outlines(&disc, inset_px).collect::<Vec<_>>().try_into().unwrap();
            for at in path {
                let radius = at.distance(centre);
                // Paper centres lie 0 to 1 px outside of the circle, and count as ½ px.
                assert!((radius - (25.0 - inset_px)).abs() < 0.75, "{radius} at {inset_px}");
            }
        }
    }

    #[test]
    fn parts_narrower_than_the_pen_have_no_path_inside() {
        let line = Bitmap::from_picture("##########\n##########\n").unwrap();
        assert_eq!(inset_outlines(&line, 1.5).count(), 0);
        for exact in [0.0, -1.0, f64::NAN] {
            assert_eq!(inset_outlines(&line, exact).map(|path| path.len()).collect::<Vec<_>>(), [24]);
        }
    }
}
