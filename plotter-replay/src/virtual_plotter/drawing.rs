//! Finds the targets of a log again in the drawing that was sent, to know the pen.

use core::ops::Range;
use plotter_motion::{Pen, PenMove, StepPoint};

/// How far ahead a target is looked for: a host may leave out moves of no length.
const LOOK_AHEAD: usize = 64;

/// The stops of a drawing in their order, with the pen on the way to each, and how far the log has come.
#[derive(Clone, Debug, Default)]
pub(super) struct Drawing {
    stops: Vec<PenMove>,
    next: usize,
    /// Stops that were passed over.
    passed_over: Vec<Range<usize>>,
}

impl Drawing {
    pub(super) fn new(stops: Vec<PenMove>) -> Self {
        Self { stops, next: 0, passed_over: Vec::new() }
    }

    /// The pen on the way to `target`; `None` if that is not among what comes next. A target sent again is
    /// the one before.
    pub(super) fn pen(&mut self, target: StepPoint) -> Option<Pen> {
        // A rounding elsewhere may differ by one count.
        let near = |stop: StepPoint| stop.x.abs_diff(target.x) <= 1 && stop.y.abs_diff(target.y) <= 1;
        let mut ahead = self.stops.iter().enumerate().skip(self.next).take(LOOK_AHEAD);
        if let Some((index, &PenMove { pen, .. })) = ahead.find(|(_, stop)| near(stop.target)) {
            let again = self.next.checked_sub(1).and_then(|last| self.stops.get(last));
            match again {
                // Sent again: nearer than a stop further on that happens to lie at the same place.
                Some(stop) if near(stop.target) && index > self.next => return Some(stop.pen),
                _ => {}
            }
            if index > self.next {
                self.passed_over.push(self.next..index);
            }
            self.next = index.saturating_add(1);
            return Some(pen);
        }
        let last = self.stops.get(self.next.checked_sub(1)?)?;
        near(last.target).then_some(last.pen)
    }

    /// The lines to the stops that were passed over or have not come yet: from, to.
    pub(super) fn undrawn(&self) -> impl Iterator<Item = (StepPoint, StepPoint)> {
        let rest = self.next..self.stops.len();
        let ranges = self.passed_over.iter().cloned().chain([rest]);
        ranges.flatten().filter_map(|index| {
            let stop = self.stops.get(index)?;
            let before = index.checked_sub(1).and_then(|before| self.stops.get(before));
            let from = before.map_or(StepPoint::default(), |before| before.target);
            (stop.pen == Pen::Down).then_some((from, stop.target))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_sent_again_does_not_use_up_the_drawing() {
        let stop = |x, pen| PenMove { pen, target: StepPoint::new(x, 0) };
        let mut drawing = Drawing::new(vec![
            stop(0, Pen::Up),
            stop(100, Pen::Down),
            stop(200, Pen::Down),
            stop(100, Pen::Up),
        ]);
        let at = |x| StepPoint::new(x, 0);
        assert_eq!(drawing.pen(at(0)), Some(Pen::Up));
        assert_eq!(drawing.pen(at(100)), Some(Pen::Down));
        assert_eq!(drawing.pen(at(100)), Some(Pen::Down)); // sent again, not the last stop
        assert_eq!(drawing.pen(at(50)), None);
        assert_eq!(drawing.pen(at(201)), Some(Pen::Down));
        assert_eq!(drawing.pen(at(100)), Some(Pen::Up));
        assert_eq!(drawing.pen(at(0)), None);
        assert_eq!(drawing.undrawn().next(), None);
    }

    #[test]
    fn what_was_passed_over_and_what_never_came_is_undrawn() {
        let stop = |x, pen| PenMove { pen, target: StepPoint::new(x, 0) };
        let mut drawing = Drawing::new(vec![
            stop(100, Pen::Down),
            stop(200, Pen::Down),
            stop(300, Pen::Up),
            stop(400, Pen::Down),
            stop(500, Pen::Down),
        ]);
        drawing.pen(StepPoint::new(100, 0));
        drawing.pen(StepPoint::new(400, 0));
        let lines: Vec<_> = drawing.undrawn().map(|(from, to)| (from.x, to.x)).collect();
        assert_eq!(lines, [(100, 200), (400, 500)]);
    }
}
