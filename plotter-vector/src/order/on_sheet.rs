//! [`Order`] for drawings of the sheet: pens, layers, speeds and what happens between strokes stay with them.

use super::plan::{Parts, Piece, Trail, share_of, strokes_of};
use super::sites::number;
use super::{Order, OrderEffort};
use crate::{Drawing, PxPoint};
use core::f64::consts::TAU;
use plotter_motion::drawing::{self, Bounds, Mark, PathSegment, Shape, Stroke};
use std::collections::BTreeMap;

/// Pixels to the millimetre: what is a pixel to the search, over which ends are compared, is the tenth of a millimetre here, about a
/// third of a pen's line.
const PX_PER_MM: f64 = 10.0;

impl Order {
    /// What is a pixel in the settings is the tenth of a millimetre on the sheet.
    pub const PX_PER_MM: f64 = PX_PER_MM;

    /// The drawing in an order with less travel. As [`Order::apply`], with `merge_gap_px` in tenths of a millimetre.
    ///
    /// Strokes are joined within one pen and one layer; one that is preceded by a dwell stays by itself. A new sheet, and a pen that is
    /// put away, part what is ordered. Speeds and powers stay with their segments; a bridged gap has those of what follows it.
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
        let mut ordered =
            drawing::Drawing { strokes: Vec::new(), after: drawing.after, layers: drawing.layers };
        let parts = |stroke: &Stroke| stroke.before.iter().any(|mark| !matches!(mark, Mark::Dwell(_)));
        let mut rest = drawing.strokes.into_iter().peekable();
        while let Some(mut first) = rest.next() {
            // What begins the sheet begins it whatever is drawn first.
            let begins = if parts(&first) { std::mem::take(&mut first.before) } else { Vec::new() };
            let mut sheet = vec![first];
            while let Some(stroke) = rest.next_if(|stroke| !parts(stroke)) {
                sheet.push(stroke);
            }
            let mut strokes = self.ordered(sheet);
            if let Some(first) = strokes.first_mut() {
                first.before.splice(0..0, begins);
            }
            ordered.strokes.append(&mut strokes);
        }
        ordered
    }

    fn ordered(&self, given: Vec<Stroke>) -> Vec<Stroke> {
        if self.effort == OrderEffort::None {
            return given;
        }
        let px = |at: plotter_motion::Point| PxPoint::new(at.x * PX_PER_MM, at.y * PX_PER_MM);
        let (ranks, mut given) = side_by_side(given);
        let mut picture = Drawing::new(0, 0);
        for stroke in given.iter().flatten() {
            picture.push_curve(stroke.pen, crate::on_sheet::curve(stroke, px, 1.0));
        }
        let mut strokes = strokes_of(&picture);
        let mut groups = BTreeMap::new();
        for ((known, stroke), rank) in strokes.iter_mut().zip(given.iter().flatten()).zip(ranks) {
            known.rank = rank;
            // Pens are told apart here, so that pen 0 is one too.
            known.pen = stroke.pen;
            let next = number(groups.len() + 1);
            known.letter = if stroke.before.is_empty() {
                *groups.entry((stroke.pen, stroke.layer, None)).or_insert(next)
            } else {
                *groups.entry((0, 0, Some(next))).or_insert(next)
            };
        }
        let (Parts { pieces, .. }, trails) = self.plan(&strokes, &[]);
        // What was needed for the search is given free before the answer is built.
        drop(strokes);
        drop(picture);
        trails.iter().filter_map(|trail| joined(*trail, &pieces, &mut given)).collect()
    }
}

/// The strokes along a Z-order curve (G. M. Morton, "A computer oriented geodetic data base", 1966), each
/// with its number before: what is near on the sheet is near in memory, where the search needs it next.
fn side_by_side(given: Vec<Stroke>) -> (Vec<u32>, Vec<Option<Stroke>>) {
    let mut all = Bounds::default();
    given.iter().for_each(|stroke| all.grow(stroke.from));
    let mut along: Vec<(u32, u32)> = Vec::with_capacity(given.len());
    along.extend(given.iter().zip(0..).map(|(stroke, rank)| (z_order(stroke.from, all), rank)));
    along.sort_unstable();
    let ranks: Vec<u32> = along.into_iter().map(|(_, rank)| rank).collect();
    let mut given: Vec<Option<Stroke>> = given.into_iter().map(Some).collect();
    let sorted = ranks.iter().map(|rank| given.get_mut(*rank as usize).and_then(Option::take)).collect();
    (ranks, sorted)
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
fn joined(trail: Trail, pieces: &[Piece], given: &mut [Option<Stroke>]) -> Option<Stroke> {
    let mut all: Option<Stroke> = None;
    let mut has_halves = false;
    for piece in trail.pieces(pieces) {
        let mut stroke = given.get_mut(piece.stroke as usize)?.take()?;
        // As the search knows it.
        let halves: Vec<PathSegment> =
            stroke.segments().flat_map(|(from, segment)| crate::on_sheet::halved(from, segment)).collect();
        if halves.len() > stroke.segments.len() {
            stroke.segments = halves;
            has_halves = true;
        }
        if piece.start > 0 && stroke.is_closed() {
            begin_at(&mut stroke, piece.start as usize);
        }
        if piece.reversed {
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
    if has_halves {
        join_arcs(&mut all.segments);
    }
    Some(all)
}

/// Makes one of arcs of one circle that go on in each other, up to a whole turn.
fn join_arcs(segments: &mut Vec<PathSegment>) {
    segments.dedup_by(|next, last| {
        let (Shape::Arc { centre, sweep_rad }, Shape::Arc { centre: own, sweep_rad: before }) =
            (next.shape, last.shape)
        else {
            return false;
        };
        let sum_rad = before + sweep_rad;
        let goes_on = own == centre
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
