//! [`Order`]: the same ink with fewer strokes and less travel between them.
//!
//! ```text
//!   strokes ──► trails ─────► nearest first ──► search ─────► drawing
//!               ends that     both ends,        2-opt,        if it travels less
//!               meet, joined  rings anywhere    Or-opt        than the given order
//! ```

mod chains;
mod drawn_ways;
pub(crate) mod lettering;
mod near_nodes;
mod on_sheet;
pub(crate) mod plan;
pub(crate) mod point_tree;
mod ring_start;
mod route;
mod search;
mod sites;
mod trails;
mod units;

use crate::stroke::curve::Segment;
use crate::stroke::{Curve, Drawing, PxPoint};
pub use lettering::{Lettering, TextBlock, TextLine};
use plan::{Legs, Stroke, Trail, all_vertices, rebuild, strokes_of};
use ring_start::{least_way_px, start_rings_well};
use search::shorten;
use sites::{RING_PLACES, Sites, Stop, number};
use trails::Joining;
use units::{Units, mark_letters};

/// Greatest coordinate of a drawing that is ordered, px: squares of distances stay far from infinity.
const FARTHEST_PX: f64 = 1e12;

/// How hard an order is searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum OrderEffort {
    /// The given strokes in the given order.
    None,
    /// Strokes joined, each where the first of its legs was, pen by pen.
    Join,
    /// Strokes joined, then from each end to the nearest stroke; where there are at most 25,000, changed by
    /// 2-opt and Or-opt until no small change gains.
    Fast,
    /// 2-opt and Or-opt for any number, then local shakes as long as the budget lasts.
    #[default]
    Best,
}

/// How strokes are joined and ordered.
///
/// The pens come in rising order, each with all its strokes. Of what one pen draws,
///
/// 1. ends that lie within `merge_gap_px` of each other are joined where the line goes on, so that a line cut
///    at a crossing is whole again: the straightest pairs first, one partner an end;
/// 2. with `one_stroke`, ends in exactly one place are joined whatever the angle, so that each connected part
///    of the drawing takes the fewest strokes it can (Hierholzer 1873);
/// 3. the pen goes from each end to the nearest stroke, entering lines at either end and closed strokes
///    anywhere, then changes of the order that shorten the travel are made (2-opt: Croes 1958; Or-opt: Or
///    1976; Johnson and McGeoch 1997).
///
/// The travel, with `lift_px` for each stroke, is never longer than that of the given order; where there are
/// several pens or lettering, than that of the given order with the strokes of each pen and of each block
/// brought together. Drawn is what was drawn, and the bridges of gaps. The result depends on nothing but the
/// drawing and the settings.
///
/// A drawing with a coordinate that is no number, or beyond 10¹² px, is only sorted by pen.
///
/// ```
/// use plotter_vector::{Drawing, Order, PxPoint};
/// let line = |from, to| [PxPoint::new(from, 0.5), PxPoint::new(to, 0.5)];
/// let mut drawing = Drawing::new(50, 1);
/// drawing.push(line(0.5, 9.5));
/// drawing.push(line(30.5, 39.5));
/// drawing.push(line(20.5, 10.5));
/// drawing.push(line(39.5, 49.5)); // goes on where the second one ends
/// assert_eq!(drawing.pen_up_px(), 21.0 + 19.0 + 29.0);
/// let ordered = Order::default().apply(&drawing);
/// assert_eq!((ordered.strokes().len(), ordered.pen_up_px()), (3, 1.0 + 10.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Order {
    /// How hard the order is searched for.
    pub effort: OrderEffort,
    /// Most that is looked at: candidates for a change and strokes moved, of all pens
    /// together. A count, so that a slow machine finds the same order as a fast one, later. At most 5000 for
    /// each stroke are used.
    pub budget: u64,
    /// Width of the gaps over which a line goes on, px; 0 joins ends in exactly one place only.
    pub merge_gap_px: f64,
    /// Whether strokes are joined at corners too.
    pub one_stroke: bool,
    /// Whether pens are changed wherever that shortens the way, and not only once each: for drawings of one
    /// tool.
    pub across_pens: bool,
    /// Whether ends within `merge_gap_px` are joined at corners too, where `one_stroke` is set: for files
    /// whose corners do not quite meet.
    pub bridges_corners: bool,
    /// What lifting and lowering the pen costs, as the way that it travels in that time, px. The order with
    /// the least sum of travel and lifts is taken.
    pub lift_px: f64,
    /// How lettering is found, so that each block of it is drawn in one go, in reading order; `None` does not
    /// look.
    pub lettering: Option<Lettering>,
}

impl Order {
    /// The same with another [`Order::effort`].
    #[must_use]
    pub const fn with_effort(self, effort: OrderEffort) -> Self {
        Self { effort, ..self }
    }

    /// The same with another [`Order::budget`].
    #[must_use]
    pub const fn with_budget(self, budget: u64) -> Self {
        Self { budget, ..self }
    }

    /// The same with another [`Order::merge_gap_px`].
    #[must_use]
    pub const fn with_merge_gap_px(self, merge_gap_px: f64) -> Self {
        Self { merge_gap_px, ..self }
    }

    /// The same with another [`Order::one_stroke`].
    #[must_use]
    pub const fn with_one_stroke(self, one_stroke: bool) -> Self {
        Self { one_stroke, ..self }
    }

    /// The same with another [`Order::across_pens`].
    #[must_use]
    pub const fn with_across_pens(self, across_pens: bool) -> Self {
        Self { across_pens, ..self }
    }

    /// The same with another [`Order::bridges_corners`].
    #[must_use]
    pub const fn with_bridges_corners(self, bridges_corners: bool) -> Self {
        Self { bridges_corners, ..self }
    }

    /// The same with another [`Order::lift_px`].
    #[must_use]
    pub const fn with_lift_px(self, lift_px: f64) -> Self {
        Self { lift_px, ..self }
    }

    /// The same with another [`Order::lettering`].
    #[must_use]
    pub const fn with_lettering(self, lettering: Option<Lettering>) -> Self {
        Self { lettering, ..self }
    }
}

/// Most that is looked at for a stroke. Fifty times as much shortened the travel by 0 to 2.7 per cent on
/// eight drawings of 3 to 134 strokes, and took up to 70 ms.
const LOOKS_PER_STROKE: u64 = 5_000;

/// Most that [`OrderEffort::Fast`] looks at, some tens of milliseconds: a twentieth of the budget of the
/// other.
const FAST_LOOKS: u64 = 5_000_000;

/// Most places of a ring that [`OrderEffort::Fast`] considers: with a third of those of the other the
/// neighbours are found in a ninth of the time, and the start is chosen afterwards among all places.
const FAST_RING_PLACES: usize = 4;

/// Looks at each stroke below which it does not begin: twice what a first descent takes on the 1,300 strokes
/// of a plot. So the limit is 25,000 strokes, and a million take no longer.
const FEWEST_FAST_LOOKS: u64 = 200;

impl Default for Order {
    /// Best, within 100 million looks at some 10 ns each, about a second for 20 000 strokes and more. Lines
    /// go on over half a pixel.
    fn default() -> Self {
        Self {
            effort: OrderEffort::Best,
            budget: 100_000_000,
            merge_gap_px: 0.5,
            one_stroke: true,
            across_pens: false,
            bridges_corners: false,
            lift_px: 0.0,
            lettering: None,
        }
    }
}

impl Order {
    /// The drawing in an order with less travel. See [`Order`] for what is kept.
    #[must_use]
    pub fn apply(&self, drawing: &Drawing) -> Drawing {
        self.applied(drawing, self.joining())
    }

    /// Which ends are joined.
    fn joining(&self) -> Joining {
        Joining {
            gap_px: self.merge_gap_px,
            one_stroke: self.one_stroke,
            corner_gap_px: self.corner_gap_px(),
            pen_px: 0.0,
        }
    }

    /// Within what ends are joined at any angle, px.
    fn corner_gap_px(&self) -> f64 {
        if self.bridges_corners { self.merge_gap_px } else { 0.0 }
    }

    /// The same of strokes by a pen so wide: of the ends that are left those are joined, at any angle, that
    /// it overlaps, and those between which it has drawn all of the way.
    pub(crate) fn apply_to_ink(&self, drawing: &Drawing, pen_px: f64) -> Drawing {
        self.applied(drawing, Joining { corner_gap_px: pen_px, pen_px, ..self.joining() })
    }

    fn applied(&self, drawing: &Drawing, joining: Joining) -> Drawing {
        if self.effort == OrderEffort::None {
            return drawing.clone();
        }
        let mut strokes = strokes_of(drawing);
        let blocks = match self.lettering {
            Some(_) if !strokes.iter().all(is_within) => Vec::new(),
            Some(lettering) if drawing.has_arcs() => lettering.find(drawing),
            Some(lettering) => lettering.find_in(&strokes),
            None => Vec::new(),
        };
        mark_letters(&mut strokes, &blocks);
        let (legs, trails) = self.plan(&strokes, &blocks, None, joining);
        rebuild(drawing, &legs, &trails)
    }

    /// What is drawn as one, in order; `given_px` is the way between the strokes in the order of their ranks,
    /// where that is known.
    fn plan<'a>(
        &self,
        strokes: &'a [Stroke<'a>],
        blocks: &[TextBlock],
        given_px: Option<f64>,
        joining: Joining,
    ) -> (Legs<'a>, Vec<Trail>) {
        if !strokes.iter().all(is_within) {
            return as_given(strokes, &[], self.across_pens);
        }
        let (legs, joined) = trails::trails(strokes, &joining);
        let units = Units::new(&legs, joined, blocks);
        if self.effort == OrderEffort::Join {
            let joined = self.as_joined(&legs, &units);
            return (legs, joined);
        }
        // Where nothing is joined, this is the given order. Of two answers only the cost is kept.
        let is_joined = units.trails() < strokes.len();
        let joined_px = is_joined.then(|| self.cost_px(&legs, &mut self.as_joined(&legs, &units), None));
        let (mut trails, way_px) = self.sequence(&legs, &units);
        let mut least_px = self.cost_px(&legs, &mut trails, Some(way_px));
        if let Some(joined_px) = joined_px.filter(|joined_px| *joined_px < least_px) {
            trails = self.as_joined(&legs, &units);
            least_px = joined_px;
            self.cost_px(&legs, &mut trails, None);
        }
        drop(units);
        // Pens that take turns in the given order, and blocks, are brought together.
        let is_one_pen = || strokes.windows(2).all(|two| matches!(two, [a, b] if a.pen == b.pen));
        let is_as_known = blocks.is_empty()
            && (self.across_pens || is_one_pen())
            && !strokes.iter().any(|stroke| stroke.closed);
        let given_px = given_px.filter(|_| is_as_known).map(|way_px| way_px + self.lifts_px(strokes.len()));
        if given_px.is_some_and(|given_px| least_px <= given_px) {
            return (legs, trails);
        }
        let (as_given, mut given) = as_given(strokes, blocks, self.across_pens);
        let is_least = least_px <= least_way_px(&as_given, &given) + self.lifts_px(given.len())
            || least_px <= self.cost_px(&as_given, &mut given, None);
        if is_least { (legs, trails) } else { (as_given, given) }
    }

    /// Lets closed trails begin where that is best, and gives what all of them cost besides the ink: the way
    /// between them, which may be known where none is closed, and the lifts.
    fn cost_px(&self, legs: &Legs<'_>, trails: &mut [Trail], known_px: Option<f64>) -> f64 {
        let way_px = match known_px {
            Some(way_px) if !trails.iter().any(|trail| trail.closed) => way_px,
            _ => start_rings_well(legs, trails),
        };
        way_px + self.lifts_px(trails.len())
    }

    /// What so many lifts cost, px.
    fn lifts_px(&self, lifts: usize) -> f64 {
        let lift_px = if self.lift_px > 0.0 { self.lift_px.min(FARTHEST_PX) } else { 0.0 };
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^32")]
        let lifts = lifts as f64;
        lifts * lift_px
    }

    /// The trails of the units in the given order, pen by pen.
    fn as_joined(&self, legs: &Legs<'_>, units: &Units) -> Vec<Trail> {
        let rank = |trail: &Trail| {
            let strokes = trail.legs(&legs.all).filter_map(|leg| legs.strokes.get(leg.stroke as usize));
            strokes.map(|stroke| stroke.rank).min()
        };
        let pen = |unit: &u32| {
            units.of(*unit).first().filter(|_| !self.across_pens).map_or(0, |trail| legs.pen(*trail))
        };
        // Each unit where the first of its strokes was.
        let mut order = vec![u32::MAX; legs.strokes.len()];
        for unit in 0..number(units.len()) {
            let first = units.of(unit).iter().filter_map(rank).min();
            if let Some(slot) = first.and_then(|first| order.get_mut(first as usize)) {
                *slot = unit;
            }
        }
        order.retain(|unit| *unit != u32::MAX);
        order.sort_by_key(pen);
        let mut joined = Vec::with_capacity(order.len());
        joined.extend(order.iter().flat_map(|unit| units.of(*unit).iter().copied()));
        joined
    }

    /// How many looks at changes each of so many strokes has; `None` where the nearest is all.
    fn looks_per_stroke(&self, all: u64) -> Option<u64> {
        let looks = (self.budget / all).min(LOOKS_PER_STROKE);
        match self.effort {
            OrderEffort::Best => Some(looks),
            _ => Some(looks.min(FAST_LOOKS / all)).filter(|looks| *looks >= FEWEST_FAST_LOOKS),
        }
    }

    /// The trails of the units in order, pen by pen, and the way between them, px.
    fn sequence(&self, legs: &Legs<'_>, units: &Units) -> (Vec<Trail>, f64) {
        let pen = |unit: &u32| match units.of(*unit).first() {
            Some(trail) if !self.across_pens => legs.pen(*trail),
            _ => 0,
        };
        // Of one pen they stay as they are.
        let mut by_pen: Vec<u32> = Vec::new();
        let mut of_pens: Vec<usize> = vec![units.len()];
        if (0..number(units.len())).any(|unit| pen(&unit) != pen(&0)) {
            by_pen.extend(0..number(units.len()));
            by_pen.sort_unstable_by_key(|unit| (pen(unit), *unit));
            of_pens = by_pen.chunk_by(|a, b| pen(a) == pen(b)).map(<[u32]>::len).collect();
        }
        let all = units.len().max(1) as u64;
        let mut ordered: Vec<Trail> = Vec::new();
        let mut travel = Travel::default();
        let mut first = 0;
        for count in of_pens {
            let unit_of = |site: u32| {
                let index = first + site as usize;
                units.of(by_pen.get(index).copied().unwrap_or_else(|| number(index)))
            };
            let same_pen = || (0..number(count)).map(unit_of);
            let mut sites = Sites::new(all_vertices(legs.strokes));
            sites.reserve(count);
            let rings = same_pen().flatten().filter(|trail| trail.closed).count();
            let looks = self.looks_per_stroke(all);
            // Without a search all is that of the fast order.
            let is_best = self.effort == OrderEffort::Best && looks > Some(0);
            let most = if is_best { RING_PLACES } else { FAST_RING_PLACES };
            same_pen().for_each(|unit| add_site(&mut sites, legs, unit, (rings, most)));
            let mut entries = sites.nearest_first(travel.at);
            if let Some(looks) = looks {
                let shakes = self.effort == OrderEffort::Best;
                entries = shorten(&sites, entries, travel.at, looks * count as u64, shakes);
            }
            ordered.reserve(entries.len());
            for visit in entries.into_iter().filter_map(|entry| sites.enter(entry)) {
                let unit = unit_of(visit.site);
                let from = ordered.len();
                ordered.extend(unit);
                if let Some([trail]) = ordered.get_mut(from..) {
                    travel.go_on((sites.place(visit.entry), sites.place(visit.exit)));
                    if trail.closed {
                        trail.start = sites.ring_vertex(visit.entry);
                    } else if visit.entry > visit.exit {
                        trail.reversed = !trail.reversed;
                    }
                } else {
                    unit.iter().for_each(|trail| travel.go_on(legs.ends(*trail)));
                }
            }
            first += count;
        }
        (ordered, travel.px)
    }
}

/// Where a trail begins and ends.
type Ends = (PxPoint, PxPoint);

/// The travel of the pen between trails.
#[derive(Clone, Copy, Debug, Default)]
struct Travel {
    /// Where the pen is.
    at: Option<PxPoint>,
    px: f64,
}

impl Travel {
    fn go_on(&mut self, (from, to): Ends) {
        self.px += self.at.replace(to).map_or(0.0, |at| at.distance(from));
    }
}

/// Whether a stroke can be ordered by distances.
fn is_within(stroke: &Stroke<'_>) -> bool {
    stroke.vertices().iter().all(|at| at.x.abs() <= FARTHEST_PX && at.y.abs() <= FARTHEST_PX)
}

/// Where the pen may enter and leave a unit, one of so many rings if it is one.
fn add_site(sites: &mut Sites<'_>, legs: &Legs<'_>, unit: &[Trail], (rings, most): (usize, usize)) {
    let ends = |trail: &Trail| {
        if trail.closed {
            let (from, to) = legs.ends(*trail);
            return (Stop::Between(from), Stop::Between(to));
        }
        let (from, to) = legs.end_vertices(*trail);
        (Stop::Vertex(from), Stop::Vertex(to))
    };
    match unit {
        [trail] if trail.closed => {
            sites.push_ring(&ring_places(&legs.curve(*trail), most), rings, most);
        }
        [trail] if legs.is_dot(*trail) => sites.push_ring(&[(ends(trail).0, 0)], rings, most),
        [trail] => sites.push_line(ends(trail)),
        [first, .., last] => sites.push_one_way((ends(first).0, ends(last).1)),
        [] => sites.push_one_way((PxPoint::default(), PxPoint::default())),
    }
}

/// Places at which a closed trail may be entered, each with the vertex before: the vertices, and where these
/// are few, those that divide what is not straight evenly.
fn ring_places(ring: &Curve, most: usize) -> Vec<(PxPoint, u32)> {
    let segments = ring.vertices.len().saturating_sub(1).max(1);
    let parts = number(most.div_ceil(segments));
    let mut places = Vec::with_capacity(segments);
    for (vertex, segment) in ring.course().segments().enumerate() {
        let parts = if matches!(segment, Segment::Line(..)) { 1 } else { parts };
        let place = |part: u32| (segment.at(f64::from(part) / f64::from(parts)), number(vertex));
        places.extend((0..parts).map(place));
    }
    places
}

/// The same strokes in an order with less travel: [`Order::apply`] with the default settings.
#[must_use]
pub fn order(drawing: &Drawing) -> Drawing {
    Order::default().apply(drawing)
}

/// Each stroke by itself, in the given order, but for the pens, and for blocks of lettering: those are drawn
/// in reading order where their first stroke was.
fn as_given<'a>(
    strokes: &'a [Stroke<'a>],
    blocks: &[TextBlock],
    across_pens: bool,
) -> (Legs<'a>, Vec<Trail>) {
    let pen = |stroke: &Stroke<'_>| if across_pens { 0 } else { stroke.pen };
    // Of each stroke of a block where that begins, and its place in it.
    let mut read: Vec<(u32, u32)> = Vec::new();
    if !blocks.is_empty() {
        read.extend(strokes.iter().map(|stroke| (stroke.rank, 0)));
    }
    for block in blocks {
        let own = || block.letters().flatten().copied();
        let least =
            own().filter_map(|stroke| strokes.get(stroke)).map(|stroke| stroke.rank).min().unwrap_or(0);
        for (stroke, place) in own().zip(0..) {
            if let Some(slot) = read.get_mut(stroke) {
                *slot = (least, place);
            }
        }
    }
    let key = |index: &u32| {
        let stroke = strokes.get(*index as usize);
        let read = read.get(*index as usize).copied();
        stroke.map(|stroke| (pen(stroke), read.unwrap_or((stroke.rank, 0)), *index))
    };
    let mut order: Vec<u32> = vec![0; strokes.len()];
    for (stroke, index) in strokes.iter().zip(0..) {
        if let Some(slot) = order.get_mut(stroke.rank as usize) {
            *slot = index;
        }
    }
    // Of one pen without lettering that is all.
    if !order.is_sorted_by_key(key) {
        order.sort_unstable_by_key(key);
    }
    let alone = |stroke: u32| {
        let closed = strokes.get(stroke as usize).is_some_and(|stroke| stroke.closed);
        Trail::of_stroke(stroke, closed)
    };
    (Legs::new(strokes), order.into_iter().map(alone).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINING: Joining = Joining { gap_px: 0.5, one_stroke: true, corner_gap_px: 0.0, pen_px: 0.0 };

    fn line(from: f64, to: f64) -> [PxPoint; 2] {
        [PxPoint::new(from, 0.0), PxPoint::new(to, 0.0)]
    }

    #[test]
    fn each_pen_draws_all_its_strokes_and_lower_pens_come_first() {
        let mut drawing = Drawing::new(99, 1);
        for k in 0..9_u32 {
            drawing.push(line(f64::from(10 * k), f64::from(10 * k + 5)));
        }
        let mut strokes = strokes_of(&drawing);
        for (stroke, pen) in strokes.iter_mut().zip([2, 1, 3].into_iter().cycle()) {
            stroke.pen = pen;
        }
        let order = Order::default();
        let (legs, joined) = trails::trails(&strokes, &JOINING);
        let (trails, _) = order.sequence(&legs, &Units::new(&legs, joined, &[]));
        let drawn: Vec<u32> =
            trails.iter().flat_map(|trail| trail.legs(&legs.all)).map(|leg| leg.stroke).collect();
        let pens: Vec<u8> = trails.iter().map(|trail| legs.pen(*trail)).collect();
        assert_eq!(pens, [1, 1, 1, 2, 2, 2, 3, 3, 3]);
        // Each pen begins on the side where the one before ended.
        assert!(drawn == [1, 4, 7, 6, 3, 0, 2, 5, 8] || drawn == [7, 4, 1, 0, 3, 6, 8, 5, 2], "{drawn:?}");
    }

    #[test]
    fn an_ordered_drawing_keeps_the_pens_of_its_strokes() {
        let mut drawing = Drawing::new(99, 1);
        drawing.push_with_pen(2, line(0.0, 9.0));
        drawing.push(line(30.0, 39.0));
        drawing.push_with_pen(2, line(20.0, 10.0));
        let ordered = order(&drawing);
        assert_eq!(ordered.pens(), [1, 2]);
        assert_eq!((0..3).map(|index| ordered.pen(index)).collect::<Vec<_>>(), [1, 2, 2]);
        assert_eq!(ordered.stroke(0).first().map(|at| at.x >= 30.0), Some(true));
    }

    #[test]
    fn strokes_of_two_pens_are_not_joined() {
        let mut drawing = Drawing::new(99, 1);
        drawing.push(line(0.0, 5.0));
        drawing.push(line(5.0, 9.0));
        let mut strokes = strokes_of(&drawing);
        strokes[1].pen = 2;
        assert_eq!(trails::trails(&strokes, &JOINING).1.len(), 2);
    }

    #[test]
    fn a_closed_stroke_begins_where_the_pen_passes_it() {
        let mut drawing = Drawing::new(99, 99);
        drawing.push(line(0.0, 10.0));
        let square = [(20.0, 9.0), (29.0, 9.0), (29.0, 0.0), (20.0, 0.0), (20.0, 9.0)];
        drawing.push(square.map(|(x, y)| PxPoint::new(x, y)));
        assert_eq!(order(&drawing).pen_up_px(), 10.0);
    }

    #[test]
    fn a_ring_of_many_vertices_begins_at_the_nearest_of_all() {
        // The search looks at a dozen of them.
        let mut drawing = Drawing::new(99, 99);
        drawing.push(line(0.0, 10.0));
        let vertex = |k: u32| {
            let angle = f64::from(k % 100).to_radians() * 3.6;
            PxPoint::new(40.0 - 20.0 * libm::sin(angle + 2.0), 20.0 * libm::cos(angle + 2.0))
        };
        drawing.push((0..=100).map(vertex));
        let nearest =
            (0..100).map(|k| vertex(k).distance(PxPoint::new(10.0, 0.0))).fold(f64::INFINITY, f64::min);
        assert_eq!(order(&drawing).pen_up_px(), nearest);
    }

    #[test]
    fn a_coordinate_that_is_no_number_leaves_the_order_as_it_was() {
        let mut drawing = Drawing::new(9, 9);
        for (from, to) in [(0.0, 1.0), (f64::NAN, 3.0), (7.0, 8.0), (1.0, 2.0)] {
            drawing.push(line(from, to));
        }
        // NaN is not equal to itself: compared as text.
        assert_eq!(format!("{:?}", order(&drawing)), format!("{drawing:?}"));
    }
}
