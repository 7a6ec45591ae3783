//! [`Order`]: the same ink with fewer strokes and less travel between them.
//!
//! ```text
//!   strokes ──► trails ─────► nearest first ──► search ─────► drawing
//!               ends that     both ends,        2-opt,        if it travels less
//!               meet, joined  rings anywhere    Or-opt        than the given order
//! ```

pub(crate) mod forest;
mod on_sheet;
pub(crate) mod plan;
pub(crate) mod point_tree;
mod ring_start;
mod route;
mod search;
mod sites;
mod trails;
mod units;

use crate::curve::Piece as Segment;
use crate::{Curve, Drawing, Lettering, PxPoint, TextBlock};
use plan::{Parts, Piece, Stroke, Trail, rebuild, strokes_of};
use ring_start::start_rings_well;
use search::shorten;
use sites::{RING_PLACES, Sites, number};
use units::{Units, mark_letters};

/// Greatest coordinate of a drawing that is ordered, px: squares of distances stay far from infinity.
const FARTHEST_PX: f64 = 1e12;

/// How hard an order is searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum OrderEffort {
    /// The given strokes in the given order.
    None,
    /// Strokes joined, each where the first of its pieces was, pen by pen.
    Join,
    /// Strokes joined, then from each end to the nearest stroke.
    Fast,
    /// Then 2-opt and Or-opt, and local shakes as long as the budget lasts.
    #[default]
    Best,
}

/// How strokes are joined and ordered.
///
/// The pens come in rising order, each with all its strokes. Of what one pen draws,
///
/// 1. ends that lie within `merge_gap_px` of each other are joined where the line goes on, so that a line cut at a
///    crossing is whole again: the straightest pairs first, one partner an end;
/// 2. with `one_stroke`, ends in exactly one place are joined whatever the angle, so that each connected part of the
///    drawing takes the fewest strokes it can (Hierholzer 1873);
/// 3. the pen goes from each end to the nearest stroke, entering lines at either end and closed strokes
///    anywhere, then changes of the order that shorten the travel are made (2-opt: Croes 1958; Or-opt: Or 1976;
///    Johnson and McGeoch 1997).
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Order {
    /// How hard the order is searched for.
    pub effort: OrderEffort,
    /// Most that [`OrderEffort::Best`] looks at: candidates for a change and strokes moved, of all pens together.
    /// A count, so that a slow machine finds the same order as a fast one, later. At most 5000 for each stroke are used.
    pub budget: u64,
    /// Width of the gaps over which a line goes on, px; 0 joins ends in exactly one place only.
    pub merge_gap_px: f64,
    /// Whether strokes are joined at corners too.
    pub one_stroke: bool,
    /// Whether pens are changed wherever that shortens the way, and not only once each: for drawings of one tool.
    #[cfg_attr(feature = "serde", serde(default))]
    pub across_pens: bool,
    /// Whether ends within `merge_gap_px` are joined at corners too, where `one_stroke` is set: for files
    /// whose corners do not quite meet.
    #[cfg_attr(feature = "serde", serde(default))]
    pub bridges_corners: bool,
    /// What lifting and lowering the pen costs, as the way that it travels in that time, px. The order with
    /// the least sum of travel and lifts is taken.
    #[cfg_attr(feature = "serde", serde(default))]
    pub lift_px: f64,
    /// How lettering is found, so that each block of it is drawn in one go, in reading order; `None` does not look.
    pub lettering: Option<Lettering>,
}

/// Most that is looked at for a stroke. Fifty times as much shortened the travel by 0 to 2.7 per cent on eight drawings of
/// 3 to 134 strokes, and took up to 70 ms.
const LOOKS_PER_STROKE: u64 = 5_000;

impl Default for Order {
    /// Best, within 100 million looks at some 10 ns each, about a second for 20 000 strokes and more. Lines go on over
    /// half a pixel.
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
        let (parts, trails) = self.plan(&strokes, &blocks);
        rebuild(drawing, &parts, &trails)
    }

    /// What is drawn as one, in order.
    fn plan<'a>(&self, strokes: &'a [Stroke<'a>], blocks: &[TextBlock]) -> (Parts<'a>, Vec<Trail>) {
        if !strokes.iter().all(is_within) {
            return as_given(strokes, &[], self.across_pens);
        }
        let joining = trails::Joining {
            gap_px: self.merge_gap_px,
            one_stroke: self.one_stroke,
            at_corners: self.bridges_corners,
        };
        let (parts, joined) = trails::trails(strokes, &joining);
        let units = Units::new(&parts, joined, blocks);
        if self.effort == OrderEffort::Join {
            let joined = self.as_joined(&parts, &units);
            return (parts, joined);
        }
        let (mut trails, mut ends) = self.sequence(&parts, &units);
        let mut least_px = self.well_begun(&parts, &mut trails, &mut ends);
        let cost_px = |parts: &Parts<'_>, trails: &mut [Trail]| {
            if trails.iter().any(|trail| trail.closed) {
                let mut ends: Vec<Ends> = trails.iter().map(|trail| parts.ends(*trail)).collect();
                return self.well_begun(parts, trails, &mut ends);
            }
            // A million lines are not noted once more.
            self.cost_px(trails.len(), trails.iter().map(|trail| parts.ends(*trail)))
        };
        // Where nothing is joined, this is the given order.
        if trails.len() < strokes.len() {
            let mut joined = self.as_joined(&parts, &units);
            let joined_px = cost_px(&parts, &mut joined);
            if joined_px < least_px {
                (trails, least_px) = (joined, joined_px);
            }
        }
        drop(units);
        let (as_given, mut given) = as_given(strokes, blocks, self.across_pens);
        if least_px <= cost_px(&as_given, &mut given) { (parts, trails) } else { (as_given, given) }
    }

    /// Lets closed trails begin where that is best, and gives what all of them cost.
    fn well_begun(&self, parts: &Parts<'_>, trails: &mut [Trail], ends: &mut [Ends]) -> f64 {
        start_rings_well(parts, trails, ends);
        self.cost_px(trails.len(), ends.iter().copied())
    }

    /// What so many trails cost besides the ink: the way between them, and the lifts.
    fn cost_px(&self, trails: usize, ends: impl IntoIterator<Item = Ends>) -> f64 {
        let lift_px = if self.lift_px > 0.0 { self.lift_px.min(FARTHEST_PX) } else { 0.0 };
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^32")]
        let lifts = trails as f64;
        travel_px(ends) + lifts * lift_px
    }

    /// The trails of the units in the given order, pen by pen.
    fn as_joined(&self, parts: &Parts<'_>, units: &Units) -> Vec<Trail> {
        let rank = |trail: &Trail| {
            let strokes =
                trail.pieces(&parts.pieces).filter_map(|piece| parts.strokes.get(piece.stroke as usize));
            strokes.map(|stroke| stroke.rank).min()
        };
        let key = |unit: u32| {
            let own = units.of(unit);
            let pen = own.first().filter(|_| !self.across_pens).map_or(0, |trail| parts.pen(*trail));
            (pen, own.iter().filter_map(rank).min(), unit)
        };
        let mut order: Vec<_> = (0..number(units.len())).map(key).collect();
        order.sort_unstable();
        order.into_iter().flat_map(|(_, _, unit)| units.of(unit).iter().copied()).collect()
    }

    /// The trails of the units in order, pen by pen, and where each begins and ends.
    fn sequence(&self, parts: &Parts<'_>, units: &Units) -> (Vec<Trail>, Vec<Ends>) {
        let pen = |unit: &u32| match units.of(*unit).first() {
            Some(trail) if !self.across_pens => parts.pen(*trail),
            _ => 0,
        };
        let mut by_pen: Vec<u32> = (0..number(units.len())).collect();
        by_pen.sort_by_key(pen);
        let all = units.len().max(1) as u64;
        let mut ordered: Vec<Trail> = Vec::with_capacity(units.len());
        let mut ends: Vec<Ends> = Vec::with_capacity(units.len());
        for same_pen in by_pen.chunk_by(|a, b| pen(a) == pen(b)) {
            let from = ends.last().map(|ends| ends.1);
            let mut sites = Sites::default();
            let rings = same_pen.iter().flat_map(|unit| units.of(*unit)).filter(|trail| trail.closed).count();
            same_pen.iter().for_each(|unit| add_site(&mut sites, parts, units.of(*unit), rings));
            let mut visits = sites.nearest_first(from);
            if self.effort == OrderEffort::Best {
                let share = (self.budget / all).min(LOOKS_PER_STROKE) * same_pen.len() as u64;
                visits = shorten(&sites, &visits, from, share);
            }
            for visit in visits {
                let Some(unit) = same_pen.get(visit.site as usize) else { continue };
                let from = ordered.len();
                ordered.extend(units.of(*unit));
                if let Some([trail]) = ordered.get_mut(from..) {
                    ends.push((sites.place(visit.entry), sites.place(visit.exit)));
                    if trail.closed {
                        trail.start = sites.vertices.get(visit.entry as usize).map_or(0, |vertex| *vertex);
                    } else if visit.entry > visit.exit {
                        trail.reversed = !trail.reversed;
                    }
                } else {
                    ends.extend(units.of(*unit).iter().map(|trail| parts.ends(*trail)));
                }
            }
        }
        (ordered, ends)
    }
}

/// Where a trail begins and ends.
type Ends = (PxPoint, PxPoint);

/// Way from trail to trail, px; the way to the first is not known.
fn travel_px(ends: impl IntoIterator<Item = Ends>) -> f64 {
    let mut at: Option<PxPoint> = None;
    let way = |(from, to): Ends| at.replace(to).map_or(0.0, |at| at.distance(from));
    ends.into_iter().map(way).fold(0.0, |sum, px| sum + px)
}

/// Whether a stroke can be ordered by distances.
fn is_within(stroke: &Stroke<'_>) -> bool {
    stroke.vertices().iter().all(|at| at.x.abs() <= FARTHEST_PX && at.y.abs() <= FARTHEST_PX)
}

/// Where the pen may enter and leave a unit, one of so many rings if it is one.
fn add_site(sites: &mut Sites, parts: &Parts<'_>, unit: &[Trail], rings: usize) {
    match unit {
        [trail] if trail.closed => {
            sites.push_ring(&ring_places(&parts.curve(*trail)), rings);
        }
        [trail] if parts.is_dot(*trail) => sites.push_ring(&[(parts.ends(*trail).0, 0)], rings),
        [trail] => sites.push_line(parts.ends(*trail)),
        trails => {
            let from = trails.first().map(|trail| parts.ends(*trail).0);
            let to = trails.last().map(|trail| parts.ends(*trail).1);
            sites.push_one_way((from.unwrap_or_default(), to.unwrap_or_default()));
        }
    }
}

/// Places at which a closed trail may be entered, each with the vertex before: the vertices, and where these
/// are few, those that divide what is not straight evenly.
fn ring_places(ring: &Curve) -> Vec<(PxPoint, u32)> {
    let pieces = ring.vertices.len().saturating_sub(1).max(1);
    let parts = number(RING_PLACES.div_ceil(pieces));
    let mut places = Vec::with_capacity(pieces);
    for (vertex, piece) in ring.course().pieces().enumerate() {
        let parts = if matches!(piece, Segment::Line(..)) { 1 } else { parts };
        let place = |part: u32| (piece.at(f64::from(part) / f64::from(parts)), number(vertex));
        places.extend((0..parts).map(place));
    }
    places
}

/// The same strokes in an order with less travel: [`Order::apply`] with the default settings.
#[must_use]
pub fn order(drawing: &Drawing) -> Drawing {
    Order::default().apply(drawing)
}

/// Each stroke by itself, in the given order, but for the pens, and for blocks of lettering: those are drawn in reading
/// order where their first stroke was.
fn as_given<'a>(
    strokes: &'a [Stroke<'a>],
    blocks: &[TextBlock],
    across_pens: bool,
) -> (Parts<'a>, Vec<Trail>) {
    let pen = |stroke: &Stroke<'_>| if across_pens { 0 } else { stroke.pen };
    // The pen, where its block begins, its place in the block, and which it is.
    let mut order: Vec<(u8, u32, u32, u32)> =
        strokes.iter().zip(0..).map(|(stroke, index)| (pen(stroke), stroke.rank, 0, index)).collect();
    for block in blocks {
        let own = || block.letters().flatten().copied();
        let least =
            own().filter_map(|stroke| strokes.get(stroke)).map(|stroke| stroke.rank).min().unwrap_or(0);
        for (stroke, read) in own().zip(0..) {
            if let Some(slot) = order.get_mut(stroke) {
                (slot.1, slot.2) = (least, read);
            }
        }
    }
    order.sort_unstable();
    let mut parts = Parts::new(strokes);
    let alone = |stroke: u32| {
        let closed = strokes.get(stroke as usize).is_some_and(|stroke| stroke.closed);
        parts.push([Piece { stroke, reversed: false, start: 0 }], closed)
    };
    let trails = order.into_iter().map(|(_, _, _, stroke)| stroke).map(alone).collect();
    (parts, trails)
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINING: trails::Joining = trails::Joining { gap_px: 0.5, one_stroke: true, at_corners: false };

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
        let (parts, joined) = trails::trails(&strokes, &JOINING);
        let (trails, _) = order.sequence(&parts, &Units::new(&parts, joined, &[]));
        let drawn: Vec<u32> =
            trails.iter().flat_map(|trail| trail.pieces(&parts.pieces)).map(|piece| piece.stroke).collect();
        let pens: Vec<u8> = trails.iter().map(|trail| parts.pen(*trail)).collect();
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
