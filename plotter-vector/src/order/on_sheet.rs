//! [`Order`] for drawings of the sheet: pens, layers, speeds and what happens between strokes stay with them.

use super::plan::{Leg, Trail, share_of, strokes_of};
use super::sites::number;
use super::{Order, OrderEffort};
use crate::stroke::{Drawing, PxPoint};
use core::f64::consts::TAU;
use plotter_motion::drawing::{self, Bounds, Mark, PathSegment, Shape, Stroke};
use std::collections::BTreeMap;

/// Pixels to the millimetre: what is a pixel to the search, over which ends are compared, is the tenth of a
/// millimetre here, about a third of a pen's line.
const PX_PER_MM: f64 = 10.0;

impl Order {
    /// What is a pixel in the settings is the tenth of a millimetre on the sheet.
    pub const PX_PER_MM: f64 = PX_PER_MM;

    /// The drawing in an order with less travel. As [`Order::apply`], with `merge_gap_px` in tenths of a
    /// millimetre.
    ///
    /// Strokes are joined within one pen and one layer; one that is preceded by a dwell stays by itself. A
    /// new sheet, and a pen that is put away, part what is ordered. Speeds and powers stay with their
    /// segments; a bridged gap has those of what follows it.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Drawing, Stroke}};
    /// use plotter_vector::Order;
    /// let line = |from, to| Stroke::through([Point::new(from, 0.0), Point::new(to, 0.0)]);
    /// let strokes = [line(0.0, 9.0), line(30.0, 39.0), line(20.0, 10.0)].into_iter().flatten().collect();
    /// let ordered = Order::default().apply_to(Drawing { strokes, ..Drawing::default() });
    /// assert_eq!(ordered.travel_mm(), 1.0 + 10.0);
    /// ```
    #[must_use]
    pub fn apply_to(&self, drawing: drawing::Drawing) -> drawing::Drawing {
        let drawing::Drawing { mut strokes, after, layers } = drawing;
        if self.effort == OrderEffort::None {
            return drawing::Drawing { strokes, after, layers };
        }
        // Of each sheet how many strokes it had, and how many it has.
        let mut counts: Vec<(usize, usize)> = Vec::new();
        let parts = |stroke: &Stroke| stroke.before.iter().any(|mark| !matches!(mark, Mark::Dwell(_)));
        for sheet in strokes.chunk_by_mut(|_, next| !parts(next)) {
            // What begins the sheet begins it whatever is drawn first.
            let first = sheet.first_mut().filter(|first| parts(first));
            let begins = first.map(|first| std::mem::take(&mut first.before)).unwrap_or_default();
            counts.push((sheet.len(), self.put_in_order(sheet)));
            if let Some(first) = sheet.first_mut() {
                first.before.splice(0..0, begins);
            }
        }
        let mut is_kept = counts.into_iter().flat_map(|(had, has)| (0..had).map(move |index| index < has));
        strokes.retain(|_| is_kept.next().unwrap_or(true));
        drawing::Drawing { strokes, after, layers }
    }

    /// Puts the strokes of a sheet in order, joined, and gives how many they are now; behind them are empty
    /// ones.
    fn put_in_order(&self, given: &mut [Stroke]) -> usize {
        let (picture, ranks, given_px) = side_by_side(given);
        let mut strokes = strokes_of(&picture);
        let mut groups = BTreeMap::new();
        for (known, rank) in strokes.iter_mut().zip(ranks) {
            known.rank = rank;
            let Some(stroke) = given.get(rank as usize) else { continue };
            // Pens are told apart here, so that pen 0 is one too.
            known.pen = stroke.pen;
            let next = number(groups.len() + 1);
            known.letter = if stroke.before.is_empty() {
                *groups.entry((stroke.pen, stroke.layer, None)).or_insert(next)
            } else {
                *groups.entry((0, 0, Some(next))).or_insert(next)
            };
        }
        let (legs, mut trails) = self.plan(&strokes, &[], Some(given_px), self.joining());
        let all = legs.in_given_numbers(&mut trails);
        // What was needed for the search is given free before the answer is built.
        drop(strokes);
        drop(picture);
        // Where each stroke comes to: that which begins a trail where that is, all others behind. So nothing
        // is there twice, and memory is walked along as it was given.
        let count = trails.len();
        let mut standing: Vec<u32> = vec![u32::MAX; given.len()];
        for (trail, place) in trails.iter().zip(0..) {
            let first = trail.legs(&all).next();
            if let Some(slot) = first.and_then(|first| standing.get_mut(first.stroke as usize)) {
                *slot = place;
            }
        }
        for index in 0..given.len() {
            let trail = standing.get(index).and_then(|place| trails.get(*place as usize));
            let stroke = trail.and_then(|trail| joined(*trail, &all, given));
            if let (Some(stroke), Some(slot)) = (stroke, given.get_mut(index)) {
                *slot = stroke;
            }
        }
        let behind = standing.iter_mut().filter(|place| **place == u32::MAX);
        behind.zip(number(count)..).for_each(|(place, free)| *place = free);
        bring_to_places(given, &mut standing);
        count
    }
}

/// Moves all to the places that are said for them, each once.
fn bring_to_places(all: &mut [Stroke], places: &mut [u32]) {
    for index in 0..all.len() {
        while let Some(place) = places.get(index).map(|place| *place as usize) {
            // Each exchange brings one to its place.
            if place == index || place >= all.len() {
                break;
            }
            all.swap(index, place);
            places.swap(index, place);
        }
    }
}

/// The strokes as curves along a Z-order curve (G. M. Morton, "A computer oriented geodetic data base",
/// 1966), and the number that each was given: what is near on the sheet is near in memory, where the search
/// needs it next. And the way between the strokes as given, px.
fn side_by_side(given: &[Stroke]) -> (Drawing, Vec<u32>, f64) {
    let px = |at: plotter_motion::Point| PxPoint::new(at.x * PX_PER_MM, at.y * PX_PER_MM);
    let mut all = Bounds::default();
    let mut as_given = Drawing::new(0, 0);
    for stroke in given {
        all.grow(stroke.from);
        as_given.push_curve(stroke.pen, crate::stroke::on_sheet::curve(stroke, px, 1.0));
    }
    let mut along: Vec<(u32, u32)> = Vec::with_capacity(given.len());
    along.extend(given.iter().zip(0..).map(|(stroke, rank)| (z_order(stroke.from, all), rank)));
    along.sort_unstable();
    let ranks: Vec<u32> = along.into_iter().map(|(_, rank)| rank).collect();
    let mut picture = Drawing::new(0, 0);
    picture.reserve_for(&as_given);
    for rank in &ranks {
        picture.push_again(&as_given, *rank as usize);
    }
    (picture, ranks, as_given.pen_up_px())
}

/// Where a place comes on the curve through the box: the bits of its two coordinates by turns, y first.
fn z_order(at: plotter_motion::Point, all: Bounds) -> u32 {
    // Bits of a coordinate that stand apart.
    let spread = |from: f64, at: f64, to: f64| {
        let share = (at - from) / (to - from);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within 0 and 65535, and 0 for what is no number"
        )]
        let whole = (share * f64::from(u16::MAX)) as u16;
        let pairs = [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)];
        pairs.iter().fold(u32::from(whole), |bits, (by, mask)| (bits | bits << by) & mask)
    };
    spread(all.least.x, at.x, all.most.x) | spread(all.least.y, at.y, all.most.y) << 1
}

/// The strokes of a trail as one. Each stroke is of one trail only.
fn joined(trail: Trail, legs: &[Leg], given: &mut [Stroke]) -> Option<Stroke> {
    let mut all: Option<Stroke> = None;
    let mut turns: Vec<plotter_motion::Point> = Vec::new();
    for leg in trail.legs(legs) {
        let mut stroke = std::mem::take(given.get_mut(leg.stroke as usize)?);
        // As the search knows it.
        let given_turns = turns.len();
        let whole = stroke
            .segments()
            .filter(|(from, segment)| crate::stroke::on_sheet::is_whole_turn(*from, segment));
        turns.extend(whole.filter_map(|(_, segment)| match segment.shape {
            Shape::Arc { centre, .. } => Some(centre),
            Shape::Line | Shape::Cubic { .. } => None,
        }));
        if turns.len() > given_turns {
            let halves =
                stroke.segments().flat_map(|(from, segment)| crate::stroke::on_sheet::halved(from, segment));
            stroke.segments = halves.collect();
        }
        if leg.start > 0 && stroke.is_closed() {
            begin_at(&mut stroke, leg.start as usize);
        }
        if leg.reversed {
            stroke.reverse();
        }
        match &mut all {
            None => all = Some(stroke),
            Some(all) => {
                if all.is_dot() && all.from == stroke.from {
                    all.segments.clear();
                }
                if all.to() != stroke.from {
                    all.segments.push(bridge(stroke.segments.first(), stroke.from));
                }
                if !stroke.is_dot() || all.segments.is_empty() {
                    all.segments.append(&mut stroke.segments);
                }
            }
        }
    }
    let mut all = all?;
    if trail.closed {
        if all.to() != all.from && !all.is_dot() {
            all.segments.push(bridge(all.segments.last(), all.from));
        }
        begin_at(&mut all, trail.start as usize);
        begin_within(&mut all, share_of(trail.share));
    }
    if !turns.is_empty() {
        turns.sort_unstable_by(by_place);
        join_arcs(&mut all.segments, &turns);
    }
    Some(all)
}

/// Makes one of arcs that go on in each other, up to a whole turn, where a whole turn about their centre was
/// given and halved. Arcs that came as parts stay parts. The centres of the turns are sorted by their place.
fn join_arcs(segments: &mut Vec<PathSegment>, turns: &[plotter_motion::Point]) {
    segments.dedup_by(|next, last| {
        let (Shape::Arc { centre, sweep_rad }, Shape::Arc { centre: own, sweep_rad: before }) =
            (next.shape, last.shape)
        else {
            return false;
        };
        let sum_rad = before + sweep_rad;
        let goes_on = own == centre
            && turns.binary_search_by(|turn| by_place(turn, &centre)).is_ok()
            && before * sweep_rad > 0.0
            && sum_rad.abs() <= TAU + ROUNDING_RAD
            && (last.feed_mm_s, last.power) == (next.feed_mm_s, next.power);
        if goes_on {
            let sweep_rad = if sum_rad.abs() > TAU - ROUNDING_RAD { TAU.copysign(sum_rad) } else { sum_rad };
            *last = PathSegment { shape: Shape::Arc { centre, sweep_rad }, ..*next };
        }
        goes_on
    });
}

fn by_place(one: &plotter_motion::Point, other: &plotter_motion::Point) -> std::cmp::Ordering {
    one.x.total_cmp(&other.x).then(one.y.total_cmp(&other.y))
}

/// What the sum of the parts of a turn may be off, rad.
const ROUNDING_RAD: f64 = 1e-12;

/// A line over a gap, as quick and as strong as another one.
fn bridge(like: Option<&PathSegment>, to: plotter_motion::Point) -> PathSegment {
    let like = like.copied().unwrap_or_default();
    PathSegment { feed_mm_s: like.feed_mm_s, power: like.power, ..PathSegment::line(to) }
}

/// Lets a closed stroke begin within its first segment, a share of it on: that becomes the first and the last
/// one.
fn begin_within(stroke: &mut Stroke, share: f64) {
    let from = stroke.from;
    if let Some(first) = stroke.segments.first_mut().filter(|_| share > 0.0) {
        let (before, after) = (first.part(from, 0.0, share), first.part(from, share, 1.0));
        *first = after;
        stroke.from = before.to;
        stroke.segments.push(before);
    }
}

/// Lets a closed stroke begin where its segment of this number does.
fn begin_at(stroke: &mut Stroke, segment: usize) {
    let Some(before) = segment.checked_sub(1).and_then(|before| stroke.segments.get(before)) else { return };
    if segment < stroke.segments.len() {
        stroke.from = before.to;
        stroke.segments.rotate_left(segment);
    }
}
