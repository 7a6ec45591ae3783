//! [`Trail`]: operations that a machine was given, until it has carried them out.

use super::ring::Ring;
use crate::{Pen, PlotOp, Point, Segment};

/// Operations that are kept. GRBL plans 15 moves and has 128 bytes of lines before them; GRBLHAL plans up to
/// 100.
const MOST_OPS: usize = 128;
/// How far from its way a machine may say to be, mm: four steps of a usual plotter, and the tenth of a
/// millimetre by which corners are usually rounded.
const ON_WAY_MM: f64 = 0.15;

/// An operation under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Given {
    /// Its number in the drawing, from 0.
    pub(super) index: u64,
    pub(super) op: PlotOp,
    /// Where the pen stands before it.
    pub(super) from: Point,
    /// Which pen is in the holder before it, 0 if the drawing has selected none.
    pub(super) holds: u8,
}

/// Operations in their order, from the first that is not known to be done.
#[derive(Clone, Debug)]
pub(super) struct Trail {
    ops: Ring<Given, MOST_OPS>,
    /// How many of them the machine was sent.
    sent: usize,
    /// Operations that are done.
    done: u64,
    /// Where the pen stands behind the last of them, and which it is.
    end: Point,
    end_holds: u8,
}

impl Trail {
    pub(super) const fn new() -> Self {
        Self { ops: Ring::new(), sent: 0, done: 0, end: Point::ORIGIN, end_holds: 0 }
    }

    /// Operations that are done.
    pub(super) const fn done(&self) -> u64 {
        self.done
    }

    /// Where the pen stands behind what was sent.
    pub(super) fn sent_end(&self) -> Point {
        self.ops.get(self.sent).map_or(self.end, |given| given.from)
    }

    /// Which pen is in the holder behind what was sent, 0 if the drawing has selected none.
    pub(super) fn sent_holds(&self) -> u8 {
        self.ops.get(self.sent).map_or(self.end_holds, |given| given.holds)
    }

    /// The next that the machine was not sent.
    pub(super) fn next(&self) -> Option<Given> {
        self.ops.get(self.sent).copied()
    }

    /// How the pen is in the first that was sent and is not done.
    pub(super) fn pen(&self) -> Option<Pen> {
        (0..self.sent).find_map(|place| match self.ops.get(place)?.op {
            PlotOp::Travel { .. } => Some(Pen::Up),
            PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => Some(Pen::Down),
            _ => None,
        })
    }

    /// Operations that were sent and are not known to be done.
    pub(super) const fn under_way(&self) -> usize {
        self.sent
    }

    /// Takes an operation of the drawing behind the others. Where there is no room, the oldest that was sent
    /// counts as done: no machine plans so far ahead.
    pub(super) fn push(&mut self, index: u64, op: PlotOp) -> bool {
        if self.ops.is_full() && !self.finish_first() {
            return false;
        }
        let given = Given { index, op, from: self.end, holds: self.end_holds };
        if self.ops.push(given).is_err() {
            return false;
        }
        self.end = op.target().unwrap_or(self.end);
        if let PlotOp::SelectPen { pen } = op {
            self.end_holds = pen;
        }
        true
    }

    /// The next was sent.
    pub(super) const fn send(&mut self) {
        if self.sent < self.ops.len() {
            self.sent += 1;
        }
    }

    /// The first is done; says whether there was one that was sent.
    pub(super) fn finish_first(&mut self) -> bool {
        if self.sent == 0 {
            return false;
        }
        self.sent -= 1;
        if let Some(given) = self.ops.pop() {
            self.done = given.index.saturating_add(1);
        }
        true
    }

    /// All up to this one are done.
    pub(super) fn finish_to(&mut self, index: u64) {
        while self.sent > 0 && self.ops.get(0).is_some_and(|given| given.index <= index) {
            self.finish_first();
        }
    }

    /// All that was sent is done.
    pub(super) fn finish_sent(&mut self) {
        while self.finish_first() {}
    }

    /// The machine says that it is here: all before the first operation that leads past this place is done.
    /// Says whether one does.
    pub(super) fn is_at(&mut self, at: Point) -> bool {
        let mut nearest = None;
        for place in 0..self.sent {
            let distance_mm = self.ops.get(place).map_or(f64::INFINITY, |given| given.distance_mm(at));
            if distance_mm <= ON_WAY_MM {
                nearest = Some(place);
                // A corner belongs to both of its sides: the second has begun where it is as near.
                let next = self.ops.get(place + 1).filter(|_| place + 1 < self.sent);
                if next.is_some_and(|next| next.distance_mm(at) < distance_mm) {
                    nearest = Some(place + 1);
                }
                break;
            }
        }
        let Some(place) = nearest else { return false };
        (0..place).for_each(|_| {
            self.finish_first();
        });
        true
    }

    /// Operations from this one on were not sent after all.
    pub(super) fn unsend_from(&mut self, index: u64) {
        let place =
            (0..self.sent).find(|&place| self.ops.get(place).is_some_and(|given| given.index >= index));
        self.sent = place.unwrap_or(self.sent);
    }

    /// All of them are done, sent or not.
    pub(super) fn finish_all(&mut self) {
        self.sent = self.ops.len();
        self.finish_sent();
    }

    /// The machine has come to rest here in the middle of the first operation, or before it, and has
    /// forgotten all that it was sent: the rest of it comes first, then what comes behind. At a place that is
    /// not on its way all of it comes again.
    pub(super) fn interrupted_at(&mut self, at: Point) {
        self.sent = 0;
        if let Some(first) = self.ops.get_mut(0).filter(|first| first.distance_mm(at) <= ON_WAY_MM) {
            first.shorten(at);
        }
    }

    /// Of operations that were sent, perhaps, by an earlier host: those up to the one that ends here are
    /// done. Says whether there is one, the last of them before which nothing ends elsewhere.
    pub(super) fn rests_at(&mut self, at: Point, within_mm: f64) -> bool {
        let start = self.ops.get(0).map_or(self.end, |first| first.from);
        if start.distance(at) <= within_mm {
            return true;
        }
        let ends = |given: &Given| given.op.target().is_some_and(|to| to.distance(at) <= within_mm);
        let place = (0..self.ops.len()).find(|&place| self.ops.get(place).is_some_and(ends));
        let Some(place) = place else { return false };
        self.sent = place + 1;
        self.finish_sent();
        true
    }
}

impl Given {
    /// How far its way is from a place, mm; infinite for what goes nowhere.
    fn distance_mm(&self, at: Point) -> f64 {
        match self.op {
            PlotOp::Travel { to } | PlotOp::Draw { to, .. } => Segment::new(self.from, to).distance(at),
            PlotOp::DrawArc { centre, sweep_rad, to, .. } => {
                let turned = turned(self.from, centre, at, sweep_rad);
                if turned <= sweep_rad.abs() {
                    ((at - centre).length() - (self.from - centre).length()).abs()
                } else {
                    self.from.distance(at).min(to.distance(at))
                }
            }
            _ => f64::INFINITY,
        }
    }

    /// Leaves of it what is behind a place on its way.
    fn shorten(&mut self, at: Point) {
        if let PlotOp::DrawArc { centre, sweep_rad, .. } = &mut self.op {
            let turned = turned(self.from, *centre, at, *sweep_rad);
            // (before its beginning it is as a whole turn behind it)
            if turned <= sweep_rad.abs() {
                *sweep_rad -= if *sweep_rad < 0.0 { -turned } else { turned };
            } else {
                return;
            }
        }
        if self.op.target().is_some() {
            self.from = at;
        }
    }
}

/// How far round a centre a place is from another, rad, in the sense of a sweep: 0 to a whole turn.
fn turned(from: Point, centre: Point, at: Point, sweep_rad: f64) -> f64 {
    let (a, b) = (from - centre, at - centre);
    let angle = libm::atan2(a.cross(b), a.dot(b));
    let angle = if sweep_rad < 0.0 { -angle } else { angle };
    if angle < 0.0 { angle + core::f64::consts::TAU } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(x: f64, y: f64) -> PlotOp {
        PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None }
    }

    fn corner() -> Trail {
        let mut trail = Trail::new();
        for (index, op) in [draw(10.0, 0.0), draw(10.0, 10.0), draw(0.0, 10.0)].into_iter().enumerate() {
            assert!(trail.push(index as u64, op));
            trail.send();
        }
        trail
    }

    #[test]
    fn a_place_tells_what_is_done() {
        let mut trail = corner();
        assert!(trail.is_at(Point::new(5.0, 0.05)));
        assert_eq!((trail.done(), trail.under_way()), (0, 3));
        assert!(trail.is_at(Point::new(10.0, 4.0)));
        assert_eq!((trail.done(), trail.under_way()), (1, 2));
        assert!(!trail.is_at(Point::new(50.0, 4.0))); // nowhere on its way
        assert!(trail.is_at(Point::new(3.0, 10.0)));
        assert_eq!(trail.done(), 2);
    }

    #[test]
    fn what_is_left_begins_where_it_was_interrupted() {
        let mut trail = corner();
        assert!(trail.is_at(Point::new(10.0, 4.0)));
        trail.interrupted_at(Point::new(10.0, 4.0));
        let next = trail.next().unwrap();
        assert_eq!((next.index, next.from, next.op), (1, Point::new(10.0, 4.0), draw(10.0, 10.0)));
    }

    #[test]
    fn half_a_circle_is_left_of_one_that_was_interrupted_half_way() {
        let mut trail = Trail::new();
        let (centre, sweep_rad) = (Point::new(-5.0, 0.0), -core::f64::consts::TAU);
        assert!(trail.push(0, PlotOp::DrawArc { centre, sweep_rad, to: Point::ORIGIN, feed_mm_s: None }));
        trail.send();
        assert!(trail.is_at(Point::new(-5.0, -5.0)));
        trail.interrupted_at(Point::new(-5.0, -5.0)); // clockwise: a quarter
        let Some(PlotOp::DrawArc { sweep_rad, .. }) = trail.next().map(|next| next.op) else {
            unreachable!("an arc stays one")
        };
        assert!((sweep_rad + 1.5 * core::f64::consts::PI).abs() < 1e-9, "{sweep_rad}");
    }

    #[test]
    fn a_rest_at_no_end_is_none_of_ours() {
        let mut trail = corner();
        trail.interrupted_at(Point::ORIGIN);
        assert!(!trail.rests_at(Point::new(4.0, 4.0), 0.05));
        assert!(trail.rests_at(Point::new(10.0, 10.01), 0.05));
        assert_eq!((trail.done(), trail.next().unwrap().index), (2, 2));
    }
}
