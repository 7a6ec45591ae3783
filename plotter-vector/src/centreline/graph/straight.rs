//! [`Straightened`]: where a line's ink can be that of a straight pen's stroke, at 1 bit a pixel, it is one.
//!
//! Both edges of the ink lie on whole pixels, so the middle of a line that is turned a little against the raster is a
//! staircase. At a width of whole pixels both edges step at once, and the stairs lie half a pixel to either side of
//! where the pen went:
//!
//! ```text
//!   ━━━━━━━━━━──╌╌╌╌╌╌                        the middles of the columns
//!               ╌╌╌╌╌╌━━━━━━━━━━━╌╌╌╌╌╌       all within half a pixel of one straight line
//!                                ╌╌╌╌╌╌──━━━━━━━━━━
//! ```
//!
//! An edge of a straight pen's stroke is found in a column to half a pixel, and so is the middle between both. The
//! straight lines that pass so near to the middles of all columns so far are a [`Strip`]; where none is left the line has
//! bent. It has not where pixels of noise are beside it, or lines that cross.
//!
//! Arcs have straight stretches, too: of a radius of r px the longest are √(12r) px long, on which they rise by a pixel and a
//! half. But they go on to either side as they were, and leave the stretch's line no faster than such an arc does. Lines
//! that bend there do.

use super::Place;
use super::strip::{Line, Strip};
use crate::stroke::{PxPoint, PxVec};
use core::ops::Range;

/// Fewest middles of a straight stretch.
const LEAST: usize = 24;

/// Most that an arc rises over a length on which it looks straight, px.
const MOST_RISE_PX: f64 = 1.5;

/// Middles of a stretch that is one, wherever it ends: else it would be that of an arc of more than 1300 px.
const LONG: usize = 128;

/// Middles in sequence that may lie beside the line: pixels of noise on an edge.
const MOST_BESIDE: usize = 2;

/// How far such middles may lie beside the end of a line, px.
const BESIDE_PX: f64 = 1.0;

/// The same of the places where lines end, meet others or have corners: these were found from a few middles near them.
const FOUND_PX: f64 = 1.5;

/// How near to it the place where a line meets others stays that place, px: other lines may end there, too.
const MEETS_PX: f64 = 0.1;

/// How far from the middle of a row a line along it may lie, px.
const ROW_PX: f64 = 0.5;

/// Where the ink is so much wider or narrower than the line, px, its middle is not the line's.
const OTHER_PX: f64 = 0.9;

/// How far the way may go back along a stretch, px.
const BACK_PX: f64 = 1.0;

/// A line with its straight stretches straightened.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Straightened {
    /// Where its places lie.
    pub(super) course: Vec<PxPoint>,
    /// Which of them lie on straight stretches.
    pub(super) is_straight: Vec<bool>,
}

impl Straightened {
    /// Of a line of typical width, px, between its corners (rising), which move to where straight stretches meet.
    pub(super) fn of(places: &[Place], closed: bool, corners: &[usize], width_px: f64) -> Self {
        if !closed {
            return Self::between(places, corners, width_px);
        }
        let Some(start) = corners.first().copied() else { return Self::around(places, width_px) };
        // From a corner to the same.
        let turned: Vec<Place> = places.iter().cycle().skip(start).take(places.len() + 1).copied().collect();
        let corners: Vec<usize> = corners.iter().map(|corner| corner - start).chain([places.len()]).collect();
        let mut line = Self::between(&turned, &corners, width_px);
        line.course.truncate(places.len());
        line.is_straight.truncate(places.len());
        line.course.rotate_right(start);
        line.is_straight.rotate_right(start);
        line
    }

    /// Of an open line, which may begin and end with corners; if both are the same place, as one.
    fn between(places: &[Place], corners: &[usize], width_px: f64) -> Self {
        let last = places.len().saturating_sub(1);
        let is_ring = last > 0 && corners.first() == Some(&0) && corners.last() == Some(&last);
        let mut line = Self::as_it_is(places);
        let mut found = Vec::new();
        let mut from = 0;
        for to in corners.iter().copied().chain([places.len()]) {
            found.extend(stretches(&Part { places, range: from..to, ends: true, width_px }));
            from = to + 1;
        }
        for stretch in &mut found {
            // The ends of a line along an axis show where in its row the pen went.
            let ends = [0, last].into_iter().filter(|end| stretch.places.contains(end));
            let tips: Vec<PxPoint> = ends
                .filter_map(|end| {
                    places.get(end).filter(|place| place.is_seated_tip()).map(|place| place.at())
                })
                .collect();
            if let Some(off_px) = stretch.line.level_off_px(&tips).filter(|off_px| off_px.abs() < ROW_PX) {
                stretch.line = stretch.line.shifted(off_px);
            }
            line.put(stretch);
        }
        for end in [0, last] {
            let place = places.get(end).filter(|place| !place.is_tip());
            if let (Some(place), Some(at)) = (place, line.course.get_mut(end))
                && place.at().distance(*at) <= MEETS_PX
            {
                *at = place.at();
            }
        }
        for corner in corners {
            let ends_at = if is_ring && *corner == 0 { last } else { *corner };
            let starts_at = if is_ring && *corner == last { 1 } else { corner + 1 };
            let before = found.iter().find(|stretch| stretch.places.end == ends_at);
            let after = found.iter().find(|stretch| stretch.places.start == starts_at);
            let Some(at) = line.course.get_mut(*corner) else { continue };
            let moved = match (before, after) {
                (Some(before), Some(after)) => before.line.crossing(&after.line),
                (Some(one), None) | (None, Some(one)) => Some(one.line.foot(*at)),
                (None, None) => None,
            };
            if let Some(moved) = moved.filter(|moved| (MEETS_PX..=FOUND_PX).contains(&moved.distance(*at))) {
                *at = moved;
            }
        }
        line
    }

    /// Of a ring without corners.
    fn around(places: &[Place], width_px: f64) -> Self {
        let count = places.len();
        let mut line = Self::as_it_is(places);
        // A lap with what lies before and after it.
        let laps = places.repeat(4);
        let lap = |start: usize| Part { places: &laps, range: start..start + count, ends: false, width_px };
        let Some(first) = stretches(&lap(count)).into_iter().next() else { return line };
        // From where a stretch ends: none goes around the lap's end.
        for stretch in stretches(&lap(count + first.places.end % count.max(1))) {
            line.put(&stretch);
        }
        line
    }

    fn as_it_is(places: &[Place]) -> Self {
        Self {
            course: places.iter().map(|place| place.at()).collect(),
            is_straight: vec![false; places.len()],
        }
    }

    /// Puts the places of a stretch on its line, none before the one before it; of a ring there may be some beyond its end.
    fn put(&mut self, stretch: &Stretch) {
        let count = self.course.len().max(1);
        let Stretch { places, line } = stretch;
        let along_px =
            |course: &[PxPoint], index: usize| course.get(index % count).map(|at| line.along_px(*at));
        let ends =
            along_px(&self.course, places.start).zip(along_px(&self.course, places.end.saturating_sub(1)));
        let Some((start_px, end_px)) = ends else { return };
        let way = if end_px < start_px { -1.0 } else { 1.0 };
        let mut reach_px = way * start_px;
        for index in places.clone().map(|index| index % count) {
            if let (Some(at), Some(is_straight)) =
                (self.course.get_mut(index), self.is_straight.get_mut(index))
            {
                reach_px = reach_px.max(way * line.along_px(*at));
                *at = line.at(way * reach_px);
                *is_straight = true;
            }
        }
    }
}

/// Places that lie on a straight line.
#[derive(Clone, Debug)]
struct Stretch {
    places: Range<usize>,
    line: Line,
}

/// A part of a line in which straight stretches are looked for.
struct Part<'a> {
    places: &'a [Place],
    range: Range<usize>,
    /// Whether the line ends or has a corner before and after it; else it goes on as the other places do.
    ends: bool,
    width_px: f64,
}

impl Part<'_> {
    /// Whether a place is the middle between both edges of the line's ink, as 1 bit a pixel shows them.
    fn is_measured(&self, place: &Place) -> bool {
        place.width_px().is_some_and(|px| (px - self.width_px).abs() < OTHER_PX) && place.is_on_raster()
    }

    /// Whether the places beyond a stretch to the end or the start of the part are but the end of its line.
    fn is_to_end(&self, stretch: &Stretch, rest: Range<usize>) -> bool {
        let rest = self.places.get(rest).unwrap_or(&[]);
        self.ends
            && rest.iter().filter(|place| self.is_measured(place)).count() <= MOST_BESIDE
            && rest.iter().all(|place| stretch.line.off_px(place.at()) <= FOUND_PX)
    }

    /// Whether what follows a stretch leaves its line faster than the arc does that looks as straight.
    fn is_left(&self, stretch: &Stretch, back: bool) -> bool {
        let [from, to] = if self.ends { [self.range.start, self.range.end] } else { [0, self.places.len()] };
        let Range { start, end } = stretch.places.clone();
        let count = end - start;
        let ahead = (count / 2).min(if back { start - from } else { to - end });
        let Some(place) = self.places.get(if back { start - ahead } else { end + ahead - 1 }) else {
            return false;
        };
        #[expect(clippy::cast_precision_loss, reason = "counts of places, far below 2^53")]
        let share = ahead as f64 / count as f64;
        // Of an arc of radius r over a length l, at s·l beyond its end: l²·(s + s²) / 2r, and it rises by l² / 8r.
        stretch.line.off_px(place.at()) > BESIDE_PX + 4.0 * MOST_RISE_PX * (share + share * share)
    }
}

/// The straight stretches of a part, from its start on each as long as may be.
fn stretches(part: &Part<'_>) -> Vec<Stretch> {
    let Range { start, end } = part.range;
    let mut found = Vec::new();
    let is_measured = |index: &usize| part.places.get(*index).is_some_and(|place| part.is_measured(place));
    // Behind this place there are too few middles.
    let Some(latest) = (start..end).rev().filter(is_measured).nth(LEAST - 1) else { return found };
    let (mut free, mut from) = (start, start);
    while from <= latest {
        let mut ahead = Walk::new(part, from);
        while ahead.step(end, false) {}
        let last = ahead.last;
        if ahead.measured < LEAST {
            // One that begins farther on is found from its middle as well.
            from += (last.saturating_sub(from) / 2).max(1);
            continue;
        }
        // What is disturbed at its ends shall come last.
        let mut walk = Walk::new(part, usize::midpoint(from, last));
        while walk.step(end, false) | walk.step(free, true) {}
        let mut stretch = Stretch { places: walk.first..walk.last + 1, line: walk.strip.best() };
        let [to_start, to_end] = [free..walk.first, walk.last + 1..end];
        let is_to_start = free == start && part.is_to_end(&stretch, to_start);
        let is_to_end = part.is_to_end(&stretch, to_end);
        let is_one = walk.measured >= LONG
            || walk.measured >= LEAST
                && (is_to_start || part.is_left(&stretch, true))
                && (is_to_end || part.is_left(&stretch, false));
        if is_to_start {
            stretch.places.start = start;
        }
        if is_to_end {
            stretch.places.end = end;
        }
        from = stretch.places.end.max(from + 1);
        if is_one {
            free = from;
            found.push(stretch);
        }
    }
    found
}

/// A straight line as it grows to both sides.
struct Walk<'a> {
    part: &'a Part<'a>,
    /// The outermost places that are known to lie on it.
    first: usize,
    last: usize,
    /// How many are known to.
    measured: usize,
    strip: Strip,
    /// Whether the way goes up along the axis.
    forward: bool,
    sides: [Side; 2],
}

/// One of the two sides to which a line grows: ahead, and back.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// The next place to look at ahead, the last one that was looked at back.
    at: usize,
    /// Places in sequence that were beside the line.
    beside: usize,
    /// How far along it the line is known, px.
    reach_px: f64,
}

impl<'a> Walk<'a> {
    /// From a place on.
    fn new(part: &'a Part<'a>, from: usize) -> Self {
        let at = |index: usize| part.places.get(index).copied().map(Place::at).unwrap_or_default();
        let origin = at(from);
        let PxVec { x, y } = at((from + LEAST / 2).min(part.range.end.saturating_sub(1))) - origin;
        let upright = y.abs() > x.abs();
        Self {
            part,
            first: from,
            last: from,
            measured: 0,
            strip: Strip::new(origin, upright),
            forward: if upright { y } else { x } >= 0.0,
            sides: [Side { at: from, ..Side::default() }; 2],
        }
    }

    /// Looks at one place more; `false` where the line or the part ends.
    fn step(&mut self, end: usize, back: bool) -> bool {
        let Some(side) = self.sides.get_mut(usize::from(back)).filter(|side| side.beside <= MOST_BESIDE)
        else {
            return false;
        };
        let index = if back { side.at.checked_sub(1) } else { Some(side.at) };
        let Some(index) = index.filter(|index| if back { *index >= end } else { *index < end }) else {
            return false;
        };
        let Some(place) = self.part.places.get(index) else { return false };
        side.at = if back { index } else { index + 1 };
        let (along, across) = self.strip.along_across(place.at());
        let way_px = if self.forward != back { along } else { -along };
        let (at, is_measured) = ((along, across), self.part.is_measured(place));
        let goes_back = way_px < side.reach_px - BACK_PX;
        if goes_back || !(is_measured && self.strip.take(at)) {
            let ends = goes_back || self.strip.is_beyond(at, FOUND_PX);
            side.beside = if ends { usize::MAX } else { side.beside + usize::from(is_measured) };
            return !ends;
        }
        side.beside = 0;
        side.reach_px = side.reach_px.max(way_px);
        self.measured += 1;
        if back {
            self.first = index;
        } else {
            self.last = index;
        }
        true
    }
}
