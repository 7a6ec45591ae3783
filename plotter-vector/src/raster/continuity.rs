//! Lines that are whole on the paper come out whole: [`link`] mends lines that the tracking met in their
//! middle, [`join`] closes outlines and lets a branch end *on* the line it springs from.
//!
//! ```text
//!   tracked            linked             joined
//!   aaa.bbb            aaaaaaa            aaaaaaa      one stroke; c now ends on the line,
//!   ...c               ...c               ...a         in the pixel below which it ended
//!   ...c               ...c               ...c
//! ```

use crate::disjoint_sets::DisjointSets;
use crate::picture::PxVec;
use crate::picture::{Bitmap, Figures, Pixel};
use std::collections::BTreeMap;

/// Fewest pixels of a figure that can enclose paper: a ring round one pixel.
const MIN_CLOSED_PX: usize = 8;

/// Pixels over which the direction of a figure's end is taken: enough for one stair of a gentle slope.
const END_REACH_PX: usize = 6;

/// Pixels of the same figure nearer than this along it are its own neighbours, not another line.
const OWN_NEIGHBOURHOOD_PX: usize = 6;

/// Whether a figure comes back to where it began: its last pixel touches its first one and it is long enough
/// to go round something.
#[must_use]
pub fn is_closed(figure: &[Pixel]) -> bool {
    let ends = figure.first().zip(figure.last());
    figure.len() >= MIN_CLOSED_PX && ends.is_some_and(|(first, last)| first.touches(*last))
}

/// One end of a figure.
#[derive(Clone, Copy, Debug)]
struct End {
    at: Pixel,
    /// Twice the figure's index, and 1 more for its last pixel.
    id: usize,
}

/// The end's pixel and the unit direction in which the figure points there; (0, 0) for a dot.
fn pointing(figure: &[Pixel], last: bool) -> Option<(Pixel, PxVec)> {
    let inner = END_REACH_PX.min(figure.len().checked_sub(1)?);
    let (at, from) = if last {
        (figure.last()?, figure.get(figure.len() - 1 - inner)?)
    } else {
        (figure.first()?, figure.get(inner)?)
    };
    Some((*at, unit(*at - *from)))
}

fn unit(way: PxVec) -> PxVec {
    let length = way.length_near();
    if length > 0.0 { way / length } else { PxVec::default() }
}

/// The eight pixels round one, in the order of the tracking's numbers.
pub(crate) fn neighbours(at: Pixel) -> impl Iterator<Item = Pixel> {
    const ROUND: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
    ROUND.into_iter().filter_map(move |(dx, dy)| {
        Some(Pixel::new(at.x.checked_add_signed(dx)?, at.y.checked_add_signed(dy)?))
    })
}

/// Links figures whose ends touch into one, the straightest pairs first; every pixel stays, once.
///
/// The tracking meets many a line in its middle and records it in two figures; linked, they are one stroke
/// again, with one vertex less. Closed figures are left alone. Linear in the pixels, and n·log n in the
/// figures.
#[must_use]
pub(crate) fn link(figures: &Figures) -> Figures {
    let mut ends: Vec<End> = Vec::new();
    for (index, figure) in figures.iter().enumerate().filter(|(_, figure)| !is_closed(figure)) {
        for (last, at) in [figure.first(), figure.last()].into_iter().enumerate() {
            ends.extend(at.map(|at| End { at: *at, id: 2 * index + last }));
        }
    }
    ends.sort_unstable_by_key(|end| (end.at, end.id));
    // Most ends have no other beside them.
    let side = |of: fn(Pixel) -> u32| ends.iter().map(|end| of(end.at).saturating_add(1)).max().unwrap_or(0);
    let mut marked = Bitmap::new(side(|at| at.x), side(|at| at.y)).ok();
    if let Some(marked) = &mut marked {
        ends.iter().for_each(|end| marked.set(end.at, true));
    }
    let is_end = |at: &Pixel| marked.as_ref().is_none_or(|marked| marked.get(*at));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for end in &ends {
        for at in neighbours(end.at).filter(is_end) {
            let from = ends.partition_point(|other| other.at < at);
            for other in ends.get(from..).unwrap_or(&[]).iter().take_while(|other| other.at == at) {
                // Each pair is met from both sides; a figure is not linked with itself.
                if end.id < other.id && end.id / 2 != other.id / 2 {
                    pairs.push((hairpin(figures, end.id, other.id), end.id, other.id));
                }
            }
        }
    }
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut links = Links::new(figures.len());
    for (_, a, b) in pairs {
        links.connect(a, b);
    }
    links.assemble(figures, &BTreeMap::new())
}

/// Cosine between the directions in which two ends point: −1 when the line goes straight on, 1 for a hairpin.
fn hairpin(figures: &Figures, a: usize, b: usize) -> f64 {
    let direction =
        |id: usize| pointing(figures.get(id / 2), id % 2 == 1).map_or(PxVec::default(), |(_, unit)| unit);
    direction(a).dot(direction(b))
}

/// Which end is linked with which; never a ring. An end is twice its figure's index, and 1 more for its last
/// pixel.
pub(crate) struct Links {
    partners: Vec<Option<usize>>,
    /// The figures of one chain belong together.
    chains: DisjointSets,
}

impl Links {
    pub(crate) fn new(figures: usize) -> Self {
        Self { partners: vec![None; 2 * figures], chains: DisjointSets::new(figures) }
    }

    fn partner(&self, end: usize) -> Option<usize> {
        self.partners.get(end).copied().flatten()
    }

    /// Whether both ends were free, and of two chains.
    pub(crate) fn connect(&mut self, a: usize, b: usize) -> bool {
        let is_free = self.partner(a).is_none() && self.partner(b).is_none();
        if !is_free || !self.chains.join_to_lower(a / 2, b / 2) {
            return false;
        }
        for (end, other) in [(a, b), (b, a)] {
            if let Some(slot) = self.partners.get_mut(end) {
                *slot = Some(other);
            }
        }
        true
    }

    /// The chains of linked figures; between two ends come the pixels of their gap, from the lesser end to
    /// the greater.
    pub(crate) fn assemble(&self, figures: &Figures, gaps: &BTreeMap<(usize, usize), Vec<Pixel>>) -> Figures {
        let mut whole = Figures::default();
        let mut done = vec![false; figures.len()];
        for index in 0..figures.len() {
            if done.get(index).copied().unwrap_or(true) {
                continue;
            }
            // Back to the chain's free end; the forest has no ring, so this stops.
            let mut entry = 2 * index;
            while let Some(before) = self.partner(entry) {
                entry = before ^ 1;
            }
            let mut pixels: Vec<Pixel> = Vec::new();
            let mut next = Some(entry);
            while let Some(end) = next {
                let figure = figures.get(end / 2).iter().copied();
                if end % 2 == 0 {
                    pixels.extend(figure)
                } else {
                    pixels.extend(figure.rev())
                }
                if let Some(flag) = done.get_mut(end / 2) {
                    *flag = true;
                }
                let exit = end ^ 1;
                next = self.partner(exit);
                if let Some(entry) = next {
                    let gap = gaps.get(&(exit.min(entry), exit.max(entry))).into_iter().flatten().copied();
                    if exit < entry { pixels.extend(gap) } else { pixels.extend(gap.rev()) }
                }
            }
            whole.push(pixels);
        }
        whole
    }
}

/// Figures that borrow the pixel on which they end from the line they touch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Joined {
    /// The figures with the borrowed pixels.
    pub(crate) figures: Figures,
    /// For each figure whether its first and its last pixel are borrowed.
    pub(crate) borrowed: Vec<(bool, bool)>,
}

/// Closes closed figures with their first pixel, and lengthens every other figure's ends by the touching
/// pixel of another line (or of a far stretch of its own) that lies straightest ahead, so that no gap of a
/// pixel is left. Dots stay dots. Linear in the pixels, and n·log n in the figures.
#[must_use]
pub(crate) fn join(figures: &Figures, size: &Bitmap) -> Joined {
    let owners = Owners::of_touching_pixels(figures, size);
    let mut joined = Joined::default();
    for (index, figure) in figures.iter().enumerate() {
        let (head, tail) = if is_closed(figure) {
            (None, figure.first().copied())
        } else if figure.len() < 2 {
            (None, None)
        } else {
            (owners.ahead(figure, index, false), owners.ahead(figure, index, true))
        };
        joined.borrowed.push((head.is_some(), tail.is_some()));
        joined.figures.push(head.into_iter().chain(figure.iter().copied()).chain(tail));
    }
    joined
}

/// To whom the pixels round the figures' ends belong: pixel, figure, place in it; sorted.
struct Owners(Vec<(Pixel, usize, usize)>);

impl Owners {
    fn of_touching_pixels(figures: &Figures, size: &Bitmap) -> Self {
        let mut wanted = Bitmap::new(size.width(), size.height()).unwrap_or(Bitmap::empty());
        for figure in figures.iter().filter(|figure| figure.len() > 1) {
            for end in [figure.first(), figure.last()].into_iter().flatten() {
                neighbours(*end).for_each(|at| wanted.set(at, true));
            }
        }
        let mut owners = Vec::new();
        for (index, figure) in figures.iter().enumerate() {
            let touching = figure.iter().enumerate().filter(|(_, pixel)| wanted.get(**pixel));
            owners.extend(touching.map(|(place, pixel)| (*pixel, index, place)));
        }
        owners.sort_unstable();
        Self(owners)
    }

    fn ahead(&self, figure: &[Pixel], index: usize, last: bool) -> Option<Pixel> {
        let (end, direction) = pointing(figure, last)?;
        let place = if last { figure.len() - 1 } else { 0 };
        let mut best: Option<(f64, Pixel)> = None;
        for at in neighbours(end) {
            let found = self.0.partition_point(|owner| owner.0 < at);
            let Some((pixel, owner, there)) = self.0.get(found) else { continue };
            if *pixel != at || (*owner == index && there.abs_diff(place) < OWN_NEIGHBOURHOOD_PX) {
                continue;
            }
            let step = unit(at - end);
            let along = step.dot(direction);
            if best.is_none_or(|(most, _)| along > most) {
                best = Some((along, at));
            }
        }
        best.map(|(_, at)| at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::OrderedTracking;

    fn tracked(picture: &str) -> (Bitmap, Figures) {
        let ink = Bitmap::from_picture(picture).unwrap();
        let figures = OrderedTracking { min_run: 3, ..OrderedTracking::default() }.track(&ink).unwrap();
        (ink, figures)
    }

    #[test]
    fn a_roof_met_at_its_top_is_one_line_again() {
        let (_, figures) = tracked("...#...\n..#.#..\n.#...#.\n#.....#\n");
        assert_eq!(figures.len(), 2);
        let whole = link(&figures);
        assert_eq!(whole.len(), 1);
        assert_eq!(whole.get(0).len(), 7);
        assert!(whole.get(0).windows(2).all(|pair| pair[0].touches(pair[1])));
    }

    #[test]
    fn of_three_ends_that_meet_the_straightest_two_are_linked() {
        let mut figures = Figures::default();
        figures.push((0..5).map(|x| Pixel::new(x, 5)));
        let upright: Vec<Pixel> = (0..5).map(|y| Pixel::new(5, y)).collect();
        figures.push(upright.iter().copied());
        figures.push((5..10).map(|x| Pixel::new(x, 5)));
        let linked = link(&figures);
        assert_eq!(linked.len(), 2);
        assert_eq!(linked.get(0), (0..10).map(|x| Pixel::new(x, 5)).collect::<Vec<_>>());
        assert_eq!(linked.get(1), upright);
    }

    #[test]
    fn a_branch_ends_on_the_line_it_springs_from() {
        let (ink, figures) = tracked("#######\n...#...\n...#...\n...#...\n");
        let joined = join(&figures, &ink);
        assert_eq!(joined.borrowed, [(false, false), (true, false)]);
        assert_eq!(joined.figures.get(1).first(), Some(&Pixel::new(3, 0)));
    }

    #[test]
    fn a_rectangle_is_closed_with_its_first_pixel() {
        let (ink, figures) = tracked("#####\n#...#\n#####\n");
        let joined = join(&link(&figures), &ink);
        assert_eq!(joined.figures.get(0).first(), joined.figures.get(0).last());
        assert_eq!(joined.figures.pixel_count() as u64, ink.count() + 1);
    }

    #[test]
    fn a_line_does_not_borrow_from_itself() {
        let (ink, figures) = tracked("##.\n.#.\n.##\n");
        assert_eq!(join(&figures, &ink).borrowed, [(false, false)]);
    }
}
