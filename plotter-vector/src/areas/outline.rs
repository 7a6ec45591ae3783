//! [`Outlines`]: the borders of ink as closed paths along the pixels' edges.
//!
//! ```text
//!   ┌───────►┐          Between an ink pixel and a paper pixel lies a *crack*. Border following walks along the
//!   ▲ ■ ■ ■ ■ ▼          cracks with the ink on its right: outer borders run clockwise as seen, holes the other
//!   │ ■ ◄─┐ ■ │          way round, and every crack is walked along exactly once.
//!   │ ■ └─► ■ │
//!   └◄────────┘
//! ```
//!
//! Ink is 8-connected and paper 4-connected: where two ink pixels meet at a corner only, one path goes
//! through both.

use crate::{
    picture::{Bitmap, Gray, Pixel},
    stroke::PxPoint,
};
use std::borrow::Cow;

/// Direction of a step along a crack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Heading {
    East,
    South,
    West,
    North,
}

use Heading::{East, North, South, West};

impl Heading {
    const fn left(self) -> Self {
        match self {
            East => North,
            South => East,
            West => South,
            North => West,
        }
    }

    const fn right(self) -> Self {
        match self {
            East => South,
            South => West,
            West => North,
            North => East,
        }
    }

    /// The corner one step on. Never leaves the picture: a crack has an ink pixel at its side.
    const fn step(self, from: Pixel) -> Pixel {
        match self {
            East => Pixel { x: from.x.wrapping_add(1), y: from.y },
            South => Pixel { x: from.x, y: from.y.wrapping_add(1) },
            West => Pixel { x: from.x.wrapping_sub(1), y: from.y },
            North => Pixel { x: from.x, y: from.y.wrapping_sub(1) },
        }
    }

    /// Pixel to the right of the step that starts at this corner. What wraps lies outside of every picture.
    const fn pixel_right(self, from: Pixel) -> Pixel {
        match self {
            East => from,
            South => Pixel { x: from.x.wrapping_sub(1), y: from.y },
            West => Pixel { x: from.x.wrapping_sub(1), y: from.y.wrapping_sub(1) },
            North => Pixel { x: from.x, y: from.y.wrapping_sub(1) },
        }
    }

    /// Pixel to the left of the step that starts at this corner.
    const fn pixel_left(self, from: Pixel) -> Pixel {
        self.left().pixel_right(from)
    }
}

/// One border of ink: outer, or of a hole. Takes 1 byte per crack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outline {
    /// Corner at which the path starts, as the pixel right of and below it.
    start: Pixel,
    steps: Vec<Heading>,
}

impl Outline {
    /// Number of cracks: the length along the pixels' edges, px. At least 4.
    #[must_use]
    pub const fn cracks(&self) -> usize {
        self.steps.len()
    }

    /// Number of pixels inside: positive for an outer border (holes in it are counted), negative for a hole.
    ///
    /// The sum over all borders of a picture is its number of ink pixels.
    #[must_use]
    pub fn enclosed_px(&self) -> i64 {
        // Σ over the horizontal cracks: area between them and row 0, Green's theorem on a grid.
        let sign = |heading| match heading {
            East => -1,
            West => 1,
            South | North => 0,
        };
        self.walk().map(|(heading, from)| sign(heading) * i64::from(from.y)).sum()
    }

    /// Whether this is the border of a hole.
    #[must_use]
    pub fn is_hole(&self) -> bool {
        self.enclosed_px() < 0
    }

    /// The pixels' corners along the path, one after each crack's start; the first is not repeated. Filling
    /// these polygons by the even-odd rule gives back exactly the ink.
    pub fn corners(&self) -> impl Iterator<Item = PxPoint> + '_ {
        self.walk().map(|(_, from)| PxPoint::new(f64::from(from.x), f64::from(from.y)))
    }

    /// The middles of the cracks: half way between the centres of an ink and a paper pixel, so never more
    /// than half a pixel from the true edge that the raster stands for.
    pub fn midpoints(&self) -> impl Iterator<Item = PxPoint> + '_ {
        self.walk().map(|(heading, from)| {
            let to = heading.step(from);
            PxPoint::new(
                (f64::from(from.x) + f64::from(to.x)) / 2.0,
                (f64::from(from.y) + f64::from(to.y)) / 2.0,
            )
        })
    }

    /// The centres of the ink pixels along the path, each once per visit: a path half a pixel inside the ink.
    pub fn edge_pixels(&self) -> impl Iterator<Item = PxPoint> + '_ {
        let mut last = self.walk().last().map(|(heading, from)| heading.pixel_right(from));
        self.walk().filter_map(move |(heading, from)| {
            let pixel = heading.pixel_right(from);
            let is_new = last.replace(pixel) != Some(pixel);
            // A path around a single pixel sees no other.
            (is_new || self.steps.len() == 4 && from == self.start).then(|| pixel.into())
        })
    }

    /// Where the grey level passes `level` between the ink and the paper pixel of each crack, by linear
    /// interpolation of their centres; the crack's middle where the two do not lie on either side of it, and
    /// at the picture's border.
    pub fn sub_pixel<'a>(&'a self, gray: &'a Gray, level: f64) -> impl Iterator<Item = PxPoint> + 'a {
        let at = |pixel: Pixel| {
            let inside = pixel.x < gray.width() && pixel.y < gray.height();
            let index = pixel.y as usize * gray.width() as usize + pixel.x as usize;
            if inside { gray.pixels().get(index).map(|level| f64::from(*level)) } else { None }
        };
        self.walk().zip(self.midpoints()).map(move |((heading, from), middle)| {
            let (ink, paper) = (heading.pixel_right(from), heading.pixel_left(from));
            let (Some(ink_level), Some(paper_level)) = (at(ink), at(paper)) else { return middle };
            // NaN, of two equal levels, is in no range.
            let share = (level - ink_level) / (paper_level - ink_level);
            if !(0.0..=1.0).contains(&share) {
                return middle;
            }
            let (ink, paper) = (PxPoint::from(ink), PxPoint::from(paper));
            PxPoint::new(ink.x + share * (paper.x - ink.x), ink.y + share * (paper.y - ink.y))
        })
    }

    /// The ink and the paper pixel of each crack; the paper may wrap to outside the picture.
    pub(super) fn sides(&self) -> impl Iterator<Item = (Pixel, Pixel)> + '_ {
        self.walk().map(|(heading, from)| (heading.pixel_right(from), heading.pixel_left(from)))
    }

    /// Each step with the corner where it starts.
    fn walk(&self) -> impl Iterator<Item = (Heading, Pixel)> + '_ {
        self.steps.iter().scan(self.start, |at, heading| {
            let from = *at;
            *at = heading.step(from);
            Some((*heading, from))
        })
    }
}

/// The borders of all ink, one at a time, ordered by their first crack with ink below it in reading order.
///
/// Works on every picture: single pixels, holes in holes, all black, noise. Time is linear in the number of
/// pixels (64 at a time) and cracks. Memory: one bit a pixel, and the path that is being followed.
///
/// Sources: A. Rosenfeld, "Connectivity in digital pictures" (1970), for borders of 8-connected ink and
/// 4-connected paper; S. Suzuki, K. Abe, "Topological structural analysis of digitized binary images by
/// border following" (1985), for starting every border once in a single scan.
///
/// ```
/// # use plotter_vector::{Bitmap, areas::Outlines};
/// let ring = Bitmap::from_picture("###\n#.#\n###\n")?;
/// let borders: Vec<_> = Outlines::new(&ring).map(|outline| (outline.cracks(), outline.enclosed_px())).collect();
/// assert_eq!(borders, [(12, 9), (4, -1)]);
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Outlines<'a> {
    ink: Cow<'a, Bitmap>,
    /// Pixels whose upper crack has been walked along.
    done: Bitmap,
    row: u32,
    word: usize,
}

impl<'a> Outlines<'a> {
    /// The borders of this ink.
    #[must_use]
    pub fn new(ink: &'a Bitmap) -> Self {
        Self::of(Cow::Borrowed(ink))
    }

    pub(super) fn of(ink: Cow<'a, Bitmap>) -> Self {
        let done = super::disc::empty_like(&ink);
        Self { ink, done, row: 0, word: 0 }
    }

    /// The next pixel, in reading order, with paper above it and no path there yet. Every path has such
    /// cracks.
    fn next_start(&mut self) -> Option<Pixel> {
        while self.row < self.ink.height() {
            let row = self.ink.row(self.row);
            let above = self.row.checked_sub(1).map_or(&[] as &[u64], |above| self.ink.row(above));
            let done = self.done.row(self.row);
            let above = above.iter().chain(core::iter::repeat(&0));
            for (word, ((ink, above), done)) in row.iter().zip(above).zip(done).enumerate().skip(self.word) {
                let open = ink & !above & !done;
                if open != 0 {
                    self.word = word;
                    let x = u32::try_from(word).unwrap_or(u32::MAX).saturating_mul(u64::BITS);
                    return Some(Pixel::new(x.saturating_add(open.trailing_zeros()), self.row));
                }
            }
            self.row += 1;
            self.word = 0;
        }
        None
    }
}

impl Iterator for Outlines<'_> {
    type Item = Outline;

    fn next(&mut self) -> Option<Outline> {
        let start = self.next_start()?;
        let (mut at, mut heading) = (start, East);
        let mut steps = Vec::new();
        // Each crack has one successor and one predecessor, so the walk comes back to where it started.
        loop {
            steps.push(heading);
            if heading == East {
                self.done.set(at, true);
            }
            at = heading.step(at);
            heading = if self.ink.get(heading.pixel_left(at)) {
                heading.left()
            } else if self.ink.get(heading.pixel_right(at)) {
                heading
            } else {
                heading.right()
            };
            if (at, heading) == (start, East) {
                return Some(Outline { start, steps });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outlines(text: &str) -> Vec<Outline> {
        Outlines::new(&Bitmap::from_picture(text).unwrap()).collect()
    }

    #[test]
    fn a_single_pixel_has_an_outline_of_four_cracks() {
        let [dot] = outlines("...\n.#.\n").try_into().unwrap();
        let corners: Vec<_> = dot.corners().map(|at| (at.x, at.y)).collect();
        assert_eq!(corners, [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)]);
        let middles: Vec<_> = dot.midpoints().map(|at| (at.x, at.y)).collect();
        assert_eq!(middles, [(1.5, 1.0), (2.0, 1.5), (1.5, 2.0), (1.0, 1.5)]);
        assert_eq!(dot.edge_pixels().collect::<Vec<_>>(), [PxPoint::new(1.5, 1.5)]);
    }

    #[test]
    fn pixels_that_meet_at_a_corner_share_one_path() {
        let paths = outlines("#.\n.#\n");
        assert_eq!(paths.iter().map(Outline::cracks).collect::<Vec<_>>(), [8]);
        // So a ring of such pixels encloses its hole, and the hole has its own path.
        let ring: Vec<_> = outlines(".#.\n#.#\n.#.\n").iter().map(Outline::enclosed_px).collect();
        assert_eq!(ring, [5, -1]);
    }

    #[test]
    fn paper_that_meets_at_a_corner_is_two_holes() {
        let holes: Vec<_> = outlines("####\n#.##\n##.#\n####\n").iter().map(Outline::enclosed_px).collect();
        assert_eq!(holes, [16, -1, -1]);
    }

    #[test]
    fn holes_nest() {
        let nested = outlines("#####\n#...#\n#.#.#\n#...#\n#####\n");
        let found: Vec<_> = nested.iter().map(|path| (path.enclosed_px(), path.is_hole())).collect();
        assert_eq!(found, [(25, false), (1, false), (-9, true)]);
    }

    #[test]
    fn edge_pixels_go_round_once() {
        let [bar] = outlines("###\n").try_into().unwrap();
        let xs: Vec<_> = bar.edge_pixels().map(|at| at.x).collect();
        assert_eq!(xs, [1.5, 2.5, 1.5, 0.5]);
    }

    #[test]
    fn grey_levels_place_the_edge_between_pixels() {
        // Ink of level 0, paper of level 200: level 50 lies at a quarter of the way between the centres.
        let ink = Bitmap::from_picture(".#.\n").unwrap();
        let gray = Gray::new(3, 1, vec![200, 0, 200]).unwrap();
        let path = Outlines::new(&ink).next().unwrap();
        let at: Vec<_> = path.sub_pixel(&gray, 50.0).map(|at| (at.x, at.y)).collect();
        assert_eq!(at, [(1.5, 0.0), (1.75, 0.5), (1.5, 1.0), (1.25, 0.5)]);
    }
}
