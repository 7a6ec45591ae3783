//! [`straight_on`]: a line that another one cuts goes straight on beyond it.
//!
//! ```text
//!   tracked              gone on
//!   a.....b              a.....b         the tracking went down b, and a and c end at it;
//!   .a...b.              .a...b.         a and c lie in line, the pixel x of b is ink between
//!   ...b...     ──►      ...x...         them, and becomes a part of both lines
//!   .b...c.              .b...a.
//!   b.....c              b.....a
//! ```
//!
//! What it adds to a figure is ink, and the figure stays a chain of touching pixels: whatever is promised of
//! figures holds of these too.

use crate::picture::PxVec;
use crate::picture::{Bitmap, Figures, Pixel};
use crate::raster::continuity::{Links, is_closed, neighbours};
use crate::raster::cut_at_turns::Cut;
use std::collections::BTreeMap;

/// Pixels from which the direction of an end is taken, as many as lie in line.
const TAILS_PX: [usize; 4] = [32, 20, 12, 8];

/// How far the pixels of one straight line may lie beside it, px: rounded to the raster, and a little.
const LINE_PX: f64 = 0.75;

/// Pixels at an end that may lie beside its line: where it comes to another one.
const LOOSE_PX: usize = 3;

/// What a pixel of the way from end to end counts: far less than a turn, but of two ends in line the nearer
/// one is next.
const COST_PER_PX: f64 = 0.003;

/// Longest way from end to end, px: lines that cross at some 3 degrees share as much.
const REACH_PX: u32 = 20;

/// Figures that go straight on over the ink of others.
pub(crate) struct GoneOn {
    pub(crate) figures: Figures,
    /// The pixels that more than one figure may have.
    pub(crate) shared: Bitmap,
}

/// Joins figures whose ends lie along one straight line with ink between them, the straightest pairs first.
/// Linear in the pixels, and n·log n in the figures.
pub(crate) fn straight_on(Cut { figures, ends: cut }: &Cut, ink: &Bitmap) -> GoneOn {
    let ends = Ends::of(figures, ink);
    let mut pairs = Vec::new();
    for (at, id) in &ends.sorted {
        ends.add_pairs(*at, *id, &mut pairs);
    }
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut links = Links::new(figures.len());
    let mut gaps = BTreeMap::new();
    let mut shared = Bitmap::new(ink.width(), ink.height()).unwrap_or(Bitmap::empty());
    for (_, a, b) in pairs {
        if let Some(gap) = ends.gap(a, b)
            && links.connect(a, b)
        {
            gap.iter().for_each(|at| shared.set(*at, true));
            gaps.insert((a, b), gap);
        }
    }
    // What goes straight on nowhere turns as it did.
    for (a, b) in cut {
        links.connect(*a, *b);
    }
    GoneOn { figures: links.assemble(figures, &gaps), shared }
}

/// The ends of open figures that are straight there.
struct Ends<'a> {
    ink: &'a Bitmap,
    figures: &'a Figures,
    /// Pixel of each end, and twice its figure's index, and 1 more for the last pixel; sorted.
    sorted: Vec<(Pixel, usize)>,
    marked: Bitmap,
}

impl<'a> Ends<'a> {
    fn of(figures: &'a Figures, ink: &'a Bitmap) -> Self {
        let shortest = TAILS_PX.last().copied().unwrap_or(0);
        let mut marked = Bitmap::new(ink.width(), ink.height()).unwrap_or(Bitmap::empty());
        let mut sorted = Vec::new();
        for (index, figure) in figures.iter().enumerate() {
            if figure.len() < shortest || is_closed(figure) {
                continue;
            }
            for id in [2 * index, 2 * index + 1] {
                let end = if id.is_multiple_of(2) { figure.first() } else { figure.last() };
                if let Some(at) = end.filter(|_| straight_tail(figure, id).is_some()) {
                    marked.set(*at, true);
                    sorted.push((*at, id));
                }
            }
        }
        sorted.sort_unstable();
        Self { ink, figures, sorted, marked }
    }

    fn end(&self, id: usize) -> Option<Pixel> {
        let figure = self.figures.get(id / 2);
        if id.is_multiple_of(2) { figure.first().copied() } else { figure.last().copied() }
    }

    fn straight_tail(&self, id: usize) -> Option<Vec<Pixel>> {
        straight_tail(self.figures.get(id / 2), id)
    }

    fn at(&self, at: Pixel) -> impl Iterator<Item = usize> + '_ {
        let from = if self.marked.get(at) {
            self.sorted.partition_point(|end| end.0 < at)
        } else {
            self.sorted.len()
        };
        let here = self.sorted.get(from..).unwrap_or(&[]).iter();
        here.take_while(move |end| end.0 == at).map(|(_, id)| *id)
    }

    /// The ends that lie ahead of one, and how far from a line with it.
    fn add_pairs(&self, start: Pixel, id: usize, pairs: &mut Vec<(f64, usize, usize)>) {
        let Some(own) = self.straight_tail(id) else { return };
        let Some(inner) = own.last() else { return };
        let way = start - *inner;
        let step = way / way.x.abs().max(way.y.abs()).max(1.0);
        let mut seen: Vec<usize> = Vec::new();
        for steps in 1..=REACH_PX {
            let along = f64::from(steps);
            let Some(at) = moved(start, step * along) else { return };
            let near = || neighbours(at).chain([at]);
            if !near().any(|at| self.ink.get(at)) {
                return;
            }
            for other in near().flat_map(|at| self.at(at)) {
                if id < other && id / 2 != other / 2 && !seen.contains(&other) {
                    seen.push(other);
                    if let Some(cost) = self.straight_tail(other).and_then(|other| bend(&own, &other)) {
                        pairs.push((cost + COST_PER_PX * along, id, other));
                    }
                }
            }
        }
    }

    /// The ink between two ends; `None` if it leaves their line.
    fn gap(&self, a: usize, b: usize) -> Option<Vec<Pixel>> {
        let (mut at, to) = (self.end(a)?, self.end(b)?);
        let from = at;
        let way = to - from;
        let away = |at: Pixel| (at - from).cross(way).abs();
        let left = |at: Pixel| at.x.abs_diff(to.x).pow(2) + at.y.abs_diff(to.y).pow(2);
        let mut gap = Vec::new();
        while !at.touches(to) {
            let ahead = neighbours(at).filter(|next| self.ink.get(*next) && left(*next) < left(at));
            at = ahead.min_by(|a, b| away(*a).total_cmp(&away(*b)).then(left(*a).cmp(&left(*b))))?;
            gap.push(at);
        }
        let length = way.length_near();
        gap.iter().all(|at| away(*at) <= length).then_some(gap)
    }
}

/// The longest part of a figure's end that is straight, outermost first, but for the loose pixels before it.
fn straight_tail(figure: &[Pixel], id: usize) -> Option<Vec<Pixel>> {
    let tails = TAILS_PX.iter().flat_map(|length| (0..=LOOSE_PX).map(move |loose| (*length, loose)));
    let tail = |(length, loose): (usize, usize)| -> Option<Vec<Pixel>> {
        if id.is_multiple_of(2) {
            Some(figure.get(loose..loose + length)?.to_vec())
        } else {
            let end = figure.len().checked_sub(loose)?;
            Some(figure.get(end.checked_sub(length)?..end)?.iter().rev().copied().collect())
        }
    };
    tails.filter_map(tail).find(|tail| beside_line_px(tail, &[]) <= LINE_PX)
}

fn moved(at: Pixel, by: PxVec) -> Option<Pixel> {
    #[allow(clippy::cast_possible_truncation, reason = "at most the reach")]
    let whole = |step: f64| libm::round(step) as i32;
    Some(Pixel::new(at.x.checked_add_signed(whole(by.x))?, at.y.checked_add_signed(whole(by.y))?))
}

/// How far two tails lie from one line that they follow in opposite directions, px for each of the shorter
/// one's pixels.
fn bend(a: &[Pixel], b: &[Pixel]) -> Option<f64> {
    let ahead = {
        let (here, there) = (*a.first()? - *a.last()?, *b.last()? - *b.first()?);
        here.dot(there) > 0.0 && here.dot(*b.first()? - *a.first()?) > 0.0
    };
    for length in TAILS_PX {
        let part = |tail: &'_ [Pixel]| tail.get(..length.min(tail.len())).map(<[Pixel]>::to_vec);
        let (a, b) = (part(a)?, part(b)?);
        let beside_px = beside_line_px(&a, &b);
        if ahead && beside_px <= 1.0 {
            let shorter = u32::try_from(a.len().min(b.len())).unwrap_or(u32::MAX);
            return Some(beside_px / f64::from(shorter));
        }
    }
    None
}

/// The greatest distance of pixels from the straight line with the least squared distances, px.
pub(crate) fn beside_line_px(some: &[Pixel], others: &[Pixel]) -> f64 {
    let Some(origin) = some.first() else { return 0.0 };
    let places = || some.iter().chain(others).map(|at| *at - *origin);
    let (mut n, mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for PxVec { x: dx, y: dy } in places() {
        (n, x, y) = (n + 1.0, x + dx, y + dy);
        (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
    }
    let (x, y) = (x / n, y / n);
    let (xx, xy, yy) = (xx / n - x * x, xy / n - x * y, yy / n - y * y);
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let (dx, dy) = (libm::cos(angle), libm::sin(angle));
    places().map(|PxVec { x: px, y: py }| ((px - x) * dy - (py - y) * dx).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(y: u32) -> Vec<Pixel> {
        (0..21).map(|x| Pixel::new(x, y)).collect()
    }

    fn column(rows: core::ops::Range<u32>) -> Vec<Pixel> {
        rows.map(|y| Pixel::new(10, y)).collect()
    }

    fn gone_on(lines: &[Vec<Pixel>]) -> GoneOn {
        let mut ink = Bitmap::new(30, 21).unwrap();
        let mut figures = Figures::default();
        for line in lines {
            line.iter().for_each(|at| ink.set(*at, true));
            figures.push(line.iter().copied());
        }
        straight_on(&Cut { figures, ends: Vec::new() }, &ink)
    }

    #[test]
    fn a_line_that_another_cuts_goes_straight_on_over_its_pixel() {
        let gone_on = gone_on(&[row(10), column(0..10), column(11..21)]);
        assert_eq!(gone_on.figures.len(), 2);
        assert_eq!(gone_on.figures.get(0), row(10));
        assert_eq!(gone_on.figures.get(1), column(0..21));
        assert_eq!(gone_on.shared.ink().collect::<Vec<_>>(), [Pixel::new(10, 10)]);
    }

    #[test]
    fn a_line_does_not_go_on_over_paper() {
        assert_eq!(gone_on(&[column(0..9), column(12..21)]).figures.len(), 2);
    }

    #[test]
    fn of_two_ends_in_line_the_nearer_one_is_next() {
        let part = |columns: core::ops::Range<u32>| columns.map(|x| Pixel::new(x, 10)).collect::<Vec<_>>();
        let [left, middle, right] = [part(0..8), part(9..18), part(19..30)];
        let across = |x: u32| (5..15).map(move |y| Pixel::new(x, y)).collect::<Vec<_>>();
        // The farther one comes first.
        let gone_on = gone_on(&[left, right, middle, across(8), across(18)]);
        assert_eq!(gone_on.figures.get(0), part(0..30));
        assert_eq!(gone_on.figures.len(), 3);
    }

    #[test]
    fn pixels_at_an_end_may_lie_beside_its_line() {
        let mut above = column(0..9);
        above.push(Pixel::new(11, 9));
        let gone_on = gone_on(&[row(10), above, column(11..21)]);
        assert_eq!(gone_on.figures.len(), 2);
    }

    #[test]
    fn short_ends_have_no_direction() {
        assert_eq!(gone_on(&[row(10), column(4..10), column(11..17)]).figures.len(), 3);
    }
}
