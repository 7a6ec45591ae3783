//! [`Zones`]: which part of a span lies in which frame, and which in the window around a border.

use super::FrameLayout;
use super::span::Span;

/// A stretch of the sheet along y: the inside of a frame, or the window around a border.
///
/// ```text
///      frame 0      ░ 1 ░      frame 1      ░ 2 ░      frame 2
/// ──────────────────┼───┼───────────────────┼───┼──────────────────
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Zone {
    /// Inside a frame.
    Frame(u32),
    /// In the window around the border at which this frame begins.
    Border(u32),
}

impl Zone {
    /// Its place in the row of all zones.
    fn rank(self) -> u64 {
        match self {
            Self::Frame(frame) => 2 * u64::from(frame) + 1,
            Self::Border(frame) => 2 * u64::from(frame),
        }
    }
}

impl PartialOrd for Zone {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Zone {
    fn cmp(&self, other: &Self) -> core::cmp::Ordering {
        self.rank().cmp(&other.rank())
    }
}

/// A part of a span in one zone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) zone: Zone,
    pub(super) t0: f64,
    pub(super) t1: f64,
}

/// The zones of a layout, or those that one frame needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zones {
    layout: FrameLayout,
    /// The zone met last, with its ends: most spans lie in the same one as the span before.
    last: (Zone, f64, f64),
    /// Outside of these ends nothing is wanted, mm.
    wanted: (f64, f64),
}

impl Zones {
    pub(super) fn all(layout: FrameLayout) -> Self {
        Self {
            layout,
            last: (Zone::Frame(0), f64::NAN, f64::NAN),
            wanted: (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Only those from which a frame takes something.
    pub(super) fn of_frame(layout: FrameLayout, frame: u32) -> Self {
        let (begin, end) = (layout.border_mm(frame), layout.border_mm(frame.saturating_add(1)));
        let begin = if frame == 0 { f64::NEG_INFINITY } else { begin - layout.window_mm };
        Self { wanted: (begin, end + layout.window_mm), ..Self::all(layout) }
    }

    /// From now on only what lies beyond one zone, if any, and up to the window after a frame is wanted.
    /// Gives the last zone.
    pub(super) fn limit(&mut self, done: Option<Zone>, last: u32) -> Zone {
        let window = self.layout.window_mm;
        let next = last.saturating_add(1);
        let begin = done.map_or(f64::NEG_INFINITY, |done| self.ends(done).1);
        self.wanted = (begin, self.layout.border_mm(next) + window);
        if window > 0.0 { Zone::Border(next) } else { Zone::Frame(last) }
    }

    /// Whether a span reaches beyond a zone towards larger y.
    pub(super) fn goes_beyond(&self, span: &Span, zone: Zone) -> bool {
        let (_, end) = self.ends(zone);
        span.bounds().1.y >= end && span.exact_bounds().1.y >= end
    }

    /// Gives the parts of a span from its start to its end, each as long as it can be.
    pub(super) fn parts<E>(
        &mut self,
        span: &Span,
        mut each: impl FnMut(Part) -> Result<(), E>,
    ) -> Result<(), E> {
        let (least, most) = span.bounds();
        let (zone, low, high) = self.last;
        if least.y > low && most.y < high {
            return each(Part { zone, t0: 0.0, t1: 1.0 });
        }
        let (wanted_low, wanted_high) = self.wanted;
        if most.y < wanted_low || least.y > wanted_high {
            return Ok(());
        }
        let mut pending: Option<Part> = None;
        let mut give = |part: Part| match &mut pending {
            Some(before) if before.zone == part.zone && before.t1 >= part.t0 => {
                before.t1 = part.t1;
                Ok(())
            }
            slot => slot.replace(part).map_or(Ok(()), &mut each),
        };
        let mut t0 = 0.0;
        for t1 in span.turning_points().iter() {
            self.monotone(span, t0, t1, &mut give)?;
            t0 = t1;
        }
        pending.map_or(Ok(()), each)
    }

    /// The zone in which a span ends that has no part at its end, though that lies where something is wanted:
    /// it came as far, and no farther.
    pub(super) fn end_zone(&self, span: &Span) -> Option<Zone> {
        let y = span.at(1.0).y;
        let (wanted_low, wanted_high) = self.wanted;
        if y < wanted_low || y > wanted_high {
            return None;
        }
        let mut before = (0.0, 0.0);
        span.turning_points().iter().for_each(|t| before = (before.1, t));
        let rises = y > span.at(before.0).y;
        let (zone, low, _) = self.locate(y, y);
        Some(if rises && y <= low { self.next(zone, false) } else { zone })
    }

    /// The parts of a stretch on which y rises or falls throughout.
    fn monotone<E>(
        &mut self,
        span: &Span,
        t0: f64,
        t1: f64,
        give: &mut impl FnMut(Part) -> Result<(), E>,
    ) -> Result<(), E> {
        let (begin_y, end_y) = (span.at(t0).y, span.at(t1).y);
        let (wanted_low, wanted_high) = self.wanted;
        let rises = end_y > begin_y;
        let (entry_y, exit_y) = if rises { (wanted_low, wanted_high) } else { (wanted_high, wanted_low) };
        let is_past = |y: f64, limit: f64| if rises { y > limit } else { y < limit };
        if is_past(begin_y, exit_y) || is_past(entry_y, end_y) {
            return Ok(());
        }
        let mut from = t0;
        let mut y = begin_y;
        if is_past(entry_y, begin_y) {
            from = span.crossing(t0, t1, entry_y);
            y = entry_y;
        }
        let (mut zone, mut low, mut high) = self.locate(y, end_y);
        loop {
            let end = if rises { high } else { low };
            if !is_past(end_y, end) {
                self.last = (zone, low, high);
                // One that ends where the wanted begins has no length there.
                return if from < t1 { give(Part { zone, t0: from, t1 }) } else { Ok(()) };
            }
            let to = span.crossing(t0, t1, end).max(from);
            // A start on the border itself leaves a part without length.
            if to > from {
                give(Part { zone, t0: from, t1: to })?;
            }
            from = to;
            if !is_past(exit_y, end) {
                return Ok(());
            }
            zone = self.next(zone, rises);
            (low, high) = self.ends(zone);
        }
    }

    /// The zone at y on the way towards another y, with its ends.
    fn locate(&self, y: f64, towards: f64) -> (Zone, f64, f64) {
        let frame = self.layout.frame_at(y);
        let window = self.layout.window_mm;
        let mut zone = if frame > 0 && y < self.layout.border_mm(frame) + window {
            Zone::Border(frame)
        } else if window > 0.0 && y >= self.layout.border_mm(frame + 1) - window {
            Zone::Border(frame + 1)
        } else {
            Zone::Frame(frame)
        };
        let (mut low, mut high) = self.ends(zone);
        if towards < y && y <= low {
            zone = self.next(zone, false);
            (low, high) = self.ends(zone);
        }
        (zone, low, high)
    }

    fn ends(&self, zone: Zone) -> (f64, f64) {
        let window = self.layout.window_mm;
        match zone {
            Zone::Frame(0) => (f64::NEG_INFINITY, self.layout.border_mm(1) - window),
            Zone::Frame(frame) => (
                self.layout.border_mm(frame) + window,
                self.layout.border_mm(frame.saturating_add(1)) - window,
            ),
            Zone::Border(frame) => {
                (self.layout.border_mm(frame) - window, self.layout.border_mm(frame) + window)
            }
        }
    }

    /// The zone after one, towards larger or smaller y. Without a window frames follow on frames.
    fn next(&self, zone: Zone, rises: bool) -> Zone {
        let has_window = self.layout.window_mm > 0.0;
        match (zone, rises) {
            (Zone::Frame(frame), true) if has_window => Zone::Border(frame + 1),
            (Zone::Frame(frame), true) => Zone::Frame(frame + 1),
            (Zone::Frame(frame), false) if has_window => Zone::Border(frame),
            (Zone::Frame(frame), false) => Zone::Frame(frame.saturating_sub(1)),
            (Zone::Border(frame), true) => Zone::Frame(frame),
            (Zone::Border(frame), false) => Zone::Frame(frame.saturating_sub(1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::{PlotOp, Point};
    use std::vec::Vec;

    fn parts(mut zones: Zones, from: Point, op: PlotOp) -> Vec<(Zone, f64, f64)> {
        let mut found = Vec::new();
        let span = Span::new(from, op).unwrap();
        let done: Result<(), ()> = zones.parts(&span, |part| {
            found.push((part.zone, part.t0, part.t1));
            Ok(())
        });
        done.unwrap();
        found
    }

    fn layout(window_mm: f64) -> FrameLayout {
        FrameLayout { frame_mm: 100.0, window_mm, ..FrameLayout::default() }
    }

    fn line(y: f64) -> PlotOp {
        PlotOp::Draw { to: Point::new(0.0, y), feed_mm_s: None }
    }

    #[test]
    fn a_line_goes_through_frames_and_windows_in_turn() {
        use Zone::{Border, Frame};
        let zones = Zones::all(layout(10.0));
        let there = parts(zones, Point::ORIGIN, line(200.0));
        assert_eq!(
            there,
            [(Frame(0), 0.0, 0.45), (Border(1), 0.45, 0.55), (Frame(1), 0.55, 0.95), (Border(2), 0.95, 1.0)]
        );
        let back = parts(zones, Point::new(0.0, 110.0), line(10.0));
        assert_eq!(back, [(Border(1), 0.0, 0.2), (Frame(0), 0.2, 1.0)]);
        assert_eq!(
            parts(Zones::all(layout(0.0)), Point::ORIGIN, line(200.0)),
            [(Frame(0), 0.0, 0.5), (Frame(1), 0.5, 1.0)]
        );
    }

    #[test]
    fn one_frame_wants_its_own_and_the_windows_beside_it() {
        let wanted = parts(Zones::of_frame(layout(10.0), 1), Point::ORIGIN, line(1_000.0));
        let zones: Vec<Zone> = wanted.iter().map(|part| part.0).collect();
        assert_eq!(zones, [Zone::Border(1), Zone::Frame(1), Zone::Border(2)]);
        assert_eq!((wanted[0].1, wanted[2].2), (0.09, 0.21));
    }

    #[test]
    fn an_arc_that_bulges_over_a_border_comes_back() {
        // A half circle of radius 20 about (0, 90), from right to left: within y > 100 for 60 degrees either
        // side.
        let op = PlotOp::DrawArc {
            centre: Point::new(0.0, 90.0),
            sweep_rad: core::f64::consts::PI,
            to: Point::new(-20.0, 90.0),
            feed_mm_s: None,
        };
        let found = parts(Zones::all(layout(0.0)), Point::new(20.0, 90.0), op);
        let zones: Vec<Zone> = found.iter().map(|part| part.0).collect();
        assert_eq!(zones, [Zone::Frame(0), Zone::Frame(1), Zone::Frame(0)]);
        assert!(
            (found[1].1 - 1.0 / 6.0).abs() < 1e-12 && (found[1].2 - 5.0 / 6.0).abs() < 1e-12,
            "{found:?}"
        );
    }
}
