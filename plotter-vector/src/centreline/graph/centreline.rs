//! [`Centreline`]: a whole stroke, in places about a pixel apart, ready to be simplified.

use super::Place;
use super::site::{EXACT_PX, THIN_PX};
use super::smooth::smooth;
use super::straight::Straightened;
use crate::stroke::Pieces;
use crate::stroke::{Bounded, Curve, PxPoint, PxVec};

/// How exact the places of a line are that is thin and has grey rims, px.
const EXACT_TO_PX: f64 = 0.15;

/// Places of a thin line for each that is twice or half as wide as most, at most, where a pen drew it: one of 1.05 px or more.
const PLACES_PER_OTHER: usize = 20;

/// A stroke whose ends are both known.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Whole {
    /// Its places; the first one is not repeated at the end of a closed stroke.
    pub(crate) places: Vec<Place>,
    /// Whether the end joins the start.
    pub(crate) closed: bool,
}

/// The middle of a line.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Centreline {
    /// Places in order; the first one is not repeated at the end of a closed line.
    pub(crate) places: Vec<PxPoint>,
    /// Whether the last place is followed by the first.
    pub(crate) closed: bool,
    /// Indices of places that are corners, rising.
    pub(crate) corners: Vec<usize>,
    /// Typical width of the ink, px.
    pub(crate) width_px: f64,
    /// Whether its start and its end join nothing.
    pub(crate) tips: [bool; 2],
}

impl Centreline {
    /// The centreline of a stroke: from its upper end (closed: from its uppermost place), whichever way it was put
    /// together; that of a wide line smooth between its corners.
    pub(crate) fn of(whole: Whole) -> Self {
        let mut places = whole.places;
        if whole.closed {
            turn_to_first(&mut places);
        } else if places.iter().rev().lt(places.iter()) {
            places.reverse();
        }
        places.dedup_by_key(|place| place.at());
        if whole.closed
            && places.len() > 1
            && places.first().map(|one| one.at()) == places.last().map(|one| one.at())
        {
            places.pop();
        }
        let width_px = width_px(&places);
        if !whole.closed && is_dot(&places, width_px) {
            // Of two or more places the middle of the outermost; one place is a dot already.
            let middle = |a: Place, b: Place| {
                let (a, b) = (a.at(), b.at());
                PxPoint::new(f64::midpoint(a.x, b.x), f64::midpoint(a.y, b.y))
            };
            let ends = places.first().copied().zip(places.last().copied());
            return Self {
                places: ends.map(|(a, b)| middle(a, b)).into_iter().collect(),
                width_px,
                ..Self::default()
            };
        }
        let keeps_pixels = keeps_pixels(&places, width_px);
        let most_px = most_smoothed_px(&places, width_px);
        if !keeps_pixels {
            fill_gaps(&mut places, whole.closed);
        }
        let corner = |(index, place): (usize, &Place)| place.is_corner().then_some(index);
        let corners: Vec<usize> = places.iter().enumerate().filter_map(corner).collect();
        let tips = [places.first(), places.last()].map(|place| place.is_some_and(|place| place.is_tip()));
        let places = if keeps_pixels {
            places.into_iter().map(Place::at).collect()
        } else {
            smooth(
                &Straightened::of(&places, whole.closed, &corners, width_px),
                whole.closed,
                &corners,
                most_px,
            )
        };
        Self { places, closed: whole.closed, corners, width_px, tips }
    }
}

/// Typical width of a line, px.
pub(super) fn width_px(places: &[Place]) -> f64 {
    let mut widths: Vec<f64> = places.iter().filter_map(|place| place.width_px()).collect();
    let middle = widths.len() / 2;
    if widths.is_empty() { 2.0 } else { *widths.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Whether a line is the raster's own: thin, and its places are pixels or lie half way between two.
pub(super) fn keeps_pixels(places: &[Place], width_px: f64) -> bool {
    width_px <= THIN_PX && are_on_raster(places) && !is_uneven(places, width_px)
}

/// Whether a line is one pixel wide here and two there, as a pen leaves it whose width is between both.
fn is_uneven(places: &[Place], width_px: f64) -> bool {
    let measured = || places.iter().filter_map(|place| place.width_px());
    let is_other = |px: &f64| (1.5..2.5).contains(&(px / width_px)) || (1.5..2.5).contains(&(width_px / px));
    measured().filter(is_other).count() * PLACES_PER_OTHER >= measured().count()
}

/// Whether most places of a line are all that 1 bit a pixel can tell.
fn are_on_raster(places: &[Place]) -> bool {
    let measured = || places.iter().filter(|place| place.width_px().is_some());
    2 * measured().filter(|place| place.is_on_raster()).count() >= measured().count()
}

/// How far smoothing may move a place of a line, px: those of a thin one with grey rims are exact, in its bends too.
pub(super) fn most_smoothed_px(places: &[Place], width_px: f64) -> f64 {
    if width_px <= EXACT_PX && !are_on_raster(places) { EXACT_TO_PX } else { f64::INFINITY }
}

/// Whether an open line is the dot of a pen: far shorter than wide, and so short that the raster alone can have made it
/// so.
fn is_dot(places: &[Place], width_px: f64) -> bool {
    let longest_px = (0.5 * width_px).min((0.25 * width_px).max(2.0));
    let mut length_px = 0.0;
    places.iter().zip(places.iter().skip(1)).all(|(a, b)| {
        length_px += a.at().distance(b.at());
        length_px <= longest_px
    })
}

/// Adds places where two are more than about a pixel apart.
pub(super) fn fill_gaps(places: &mut Vec<Place>, closed: bool) {
    const WIDEST_PX: f64 = 1.7;
    let next = || places.iter().skip(1).chain(places.first().filter(|_| closed));
    let is_near = |(from, to): (&Place, &Place)| {
        let PxVec { x, y } = to.at() - from.at();
        x * x + y * y <= WIDEST_PX * WIDEST_PX
    };
    if places.iter().zip(next()).all(is_near) {
        return;
    }
    let mut dense = Vec::with_capacity(places.len() * 5 / 4);
    for (from, to) in places.iter().zip(next()) {
        dense.push(*from);
        let (start, end) = (from.at(), to.at());
        let pieces = libm::floor(start.distance(end) / 1.2).clamp(1.0, 1e4);
        let mut piece = 1.0;
        while piece < pieces {
            let t = piece / pieces;
            let at = PxPoint::new(start.x + (end.x - start.x) * t, start.y + (end.y - start.y) * t);
            dense.push(from.moved(at));
            piece += 1.0;
        }
    }
    dense.extend(places.last().filter(|_| !closed));
    *places = dense;
}

/// Turns a closed line so that its places come in the least of all orders that it can be walked in: from its first place
/// in reading order, to the nearer of the two neighbours in that order. A line that comes back to a place on its way has
/// more than one way to start there.
fn turn_to_first(places: &mut [Place]) {
    let Some(first) = places.iter().min().copied() else { return };
    let from = |start: usize| places.iter().cycle().skip(start).take(places.len());
    let back_from =
        |start: usize| places.iter().rev().cycle().skip(places.len() - 1 - start).take(places.len());
    let starts = places.iter().enumerate().filter(|(_, place)| **place == first).map(|(index, _)| index);
    let ways = starts.flat_map(|start| [(start, false), (start, true)]);
    let walk = |(start, back): (usize, bool)| -> Box<dyn Iterator<Item = &Place> + '_> {
        if back { Box::new(back_from(start)) } else { Box::new(from(start)) }
    };
    let Some((start, back)) = ways.min_by(|one, other| walk(*one).cmp(walk(*other))) else { return };
    places.rotate_left(start);
    if back {
        places.get_mut(1..).unwrap_or_default().reverse();
    }
}

impl Centreline {
    /// The line with few vertices, its first one again at the end of a closed one, of the pieces that it may have.
    /// Corners are vertices.
    pub(crate) fn curve(&self, bounded: Bounded, pieces: Pieces) -> Curve {
        let simplified = |part: &[PxPoint], closed: bool| bounded.stroke(part, closed, pieces);
        let Some((first, rest)) = self.corners.split_first() else {
            if self.tips.contains(&true) && !self.closed && pieces == Pieces::Lines {
                return bounded.loose(&self.places, self.tips).into();
            }
            return simplified(&self.places, self.closed);
        };
        let mut curve = Curve::default();
        let mut add = |part: &[PxPoint]| curve.append(simplified(part, false));
        let between = |from: usize, to: usize| self.places.get(from..=to).unwrap_or(&[]);
        if !self.closed && *first > 0 {
            add(between(0, *first));
        }
        let mut last = *first;
        for corner in rest {
            add(between(last, *corner));
            last = *corner;
        }
        if self.closed {
            // Around the end to the first corner again.
            let around: Vec<PxPoint> =
                self.places.iter().skip(last).chain(self.places.iter().take(first + 1)).copied().collect();
            add(&around);
        } else if last + 1 < self.places.len() {
            add(between(last, self.places.len() - 1));
        }
        curve
    }
}
