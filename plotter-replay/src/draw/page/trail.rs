//! [`Trail`]: where the pen was, and when, in a bounded number of points.

/// A point of a trail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TrailPoint {
    /// Microseconds, or whatever else the trail runs along; never less than that of the point before.
    pub(crate) at_us: u64,
    pub(crate) x_mm: f64,
    pub(crate) y_mm: f64,
    /// How the way to this point was: [`DRAWN`], [`DIFFERS`], both or neither.
    pub(crate) state: u8,
}

/// The pen was down.
pub(crate) const DRAWN: u8 = 1;
/// The pen was farther from its line than is let pass.
pub(crate) const DIFFERS: u8 = 2;

/// Which pen it was: bits of the state above those two.
pub(crate) const fn pen_bits(number: u8) -> u8 {
    (if number < 2 { 0 } else { (number - 2) % 7 + 1 }) << 2
}

/// Keeps as few points of a way as give the place of the pen at every time within a tolerance, and never more
/// than a given number: when there would be more, the tolerance is doubled and what is kept goes through it
/// again.
///
/// From the last kept point the place at each later time is seen through a door, wider by the tolerance than
/// the place on either side, in x and in y alone. One straight stretch at one speed does as long as it passes
/// all doors. One pass, constant memory.
///
/// Source: the "swinging door" of process recorders: E. H. Bristol, "Swinging door trending: adaptive trend
/// recording?", ISA National Conference Proceedings (1990).
#[derive(Clone, Debug)]
pub(crate) struct Trail {
    most: usize,
    tolerance_mm: f64,
    /// Greatest distance of the present points from what was pushed: the sum of all tolerances so far.
    error_mm: f64,
    kept: Vec<TrailPoint>,
    doors: [Door; 2],
    last: Option<TrailPoint>,
    /// Counts the rounds in which points that were kept went away again.
    rounds: u32,
}

/// Least and greatest slope that pass all doors so far, mm/us.
#[derive(Clone, Copy, Debug)]
struct Door {
    least: f64,
    greatest: f64,
}

impl Door {
    const OPEN: Self = Self { least: f64::NEG_INFINITY, greatest: f64::INFINITY };

    fn passes(self, way_mm: f64, time_us: f64, tolerance_mm: f64) -> bool {
        if time_us <= 0.0 {
            return way_mm.abs() <= tolerance_mm;
        }
        let slope = way_mm / time_us;
        (self.least..=self.greatest).contains(&slope)
    }

    fn narrow(&mut self, way_mm: f64, time_us: f64, tolerance_mm: f64) {
        if time_us > 0.0 {
            self.least = self.least.max((way_mm - tolerance_mm) / time_us);
            self.greatest = self.greatest.min((way_mm + tolerance_mm) / time_us);
        }
    }
}

impl Trail {
    /// An empty trail of at most `most` points (at least 16), each within `tolerance_mm` while that suffices.
    pub(crate) fn new(tolerance_mm: f64, most: usize) -> Self {
        Self {
            most: most.max(16),
            tolerance_mm,
            error_mm: tolerance_mm,
            kept: Vec::new(),
            doors: [Door::OPEN; 2],
            last: None,
            rounds: 0,
        }
    }

    /// Takes the next place; one that is not finite is left out.
    pub(crate) fn push(&mut self, point: TrailPoint) {
        if !(point.x_mm.is_finite() && point.y_mm.is_finite()) {
            return;
        }
        self.take(point);
        while self.kept.len() >= self.most {
            self.coarsen();
        }
    }

    fn take(&mut self, mut point: TrailPoint) {
        let Some(last) = self.last else {
            self.keep(point);
            return;
        };
        let mut changes = point.state != last.state;
        if changes && self.rounds > 0 && self.is_near_anchor(last) {
            point.state |= last.state;
            changes = false;
        }
        if (changes && self.kept.last() != Some(&last)) || !self.passes(point) {
            self.keep(last);
            if !self.passes(point) {
                self.keep(point); // it jumped
                return;
            }
        }
        if let Some(&anchor) = self.kept.last() {
            let time_us = span(anchor, point);
            let [x, y] = &mut self.doors;
            x.narrow(point.x_mm - anchor.x_mm, time_us, self.tolerance_mm);
            y.narrow(point.y_mm - anchor.y_mm, time_us, self.tolerance_mm);
        }
        self.last = Some(point);
    }

    fn passes(&self, point: TrailPoint) -> bool {
        let Some(&anchor) = self.kept.last() else {
            return false;
        };
        let time_us = span(anchor, point);
        let [x, y] = self.doors;
        x.passes(point.x_mm - anchor.x_mm, time_us, self.tolerance_mm)
            && y.passes(point.y_mm - anchor.y_mm, time_us, self.tolerance_mm)
    }

    fn is_near_anchor(&self, point: TrailPoint) -> bool {
        self.kept.last().is_some_and(|anchor| {
            (point.x_mm - anchor.x_mm).abs() <= self.tolerance_mm
                && (point.y_mm - anchor.y_mm).abs() <= self.tolerance_mm
        })
    }

    fn keep(&mut self, point: TrailPoint) {
        if self.kept.last() != Some(&point) {
            self.kept.push(point);
        }
        self.doors = [Door::OPEN; 2];
        self.last = Some(point);
    }

    /// Doubles the tolerance and lets what is kept through again. From then on a stretch smaller than the
    /// tolerance takes the state of what is before it, too: ink over no ink, a difference over none.
    pub(crate) fn coarsen(&mut self) {
        self.tolerance_mm = (self.tolerance_mm * 2.0).max(1e-6);
        self.error_mm += self.tolerance_mm;
        self.rounds = self.rounds.saturating_add(1);
        let last = self.last.take();
        let mut points = core::mem::take(&mut self.kept);
        points.extend(last.filter(|last| points.last() != Some(last)));
        self.doors = [Door::OPEN; 2];
        for point in points {
            self.take(point);
        }
    }

    /// The points that are settled.
    #[cfg(feature = "live")]
    pub(crate) fn settled(&self) -> &[TrailPoint] {
        &self.kept
    }

    /// The last place pushed.
    #[cfg(feature = "live")]
    pub(crate) fn last(&self) -> Option<TrailPoint> {
        self.last
    }

    /// Counts the rounds in which settled points changed.
    #[cfg(feature = "live")]
    pub(crate) fn rounds(&self) -> u32 {
        self.rounds
    }

    /// All points, and how far the way may be from them, mm.
    pub(crate) fn finish(mut self) -> (Vec<TrailPoint>, f64) {
        let last = self.last.take();
        self.kept.extend(last.filter(|last| self.kept.last() != Some(last)));
        (self.kept, self.error_mm)
    }
}

#[expect(clippy::cast_precision_loss, reason = "a span below 2^53 us is 285 years")]
fn span(from: TrailPoint, to: TrailPoint) -> f64 {
    to.at_us.saturating_sub(from.at_us) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(at_us: u64, x_mm: f64, y_mm: f64) -> TrailPoint {
        TrailPoint { at_us, x_mm, y_mm, state: DRAWN }
    }

    /// The place that a trail gives for a time; of several at the same time, the one nearest to `near`.
    fn distance_mm(points: &[TrailPoint], near: TrailPoint) -> f64 {
        let mut least = f64::INFINITY;
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            if !(a.at_us..=b.at_us).contains(&near.at_us) {
                continue;
            }
            let span_us = (b.at_us - a.at_us) as f64;
            let shares =
                if span_us > 0.0 { vec![(near.at_us - a.at_us) as f64 / span_us] } else { vec![0.0, 1.0] };
            for share in shares {
                let (x, y) = (a.x_mm + share * (b.x_mm - a.x_mm), a.y_mm + share * (b.y_mm - a.y_mm));
                least = least.min((x - near.x_mm).abs().max((y - near.y_mm).abs()));
            }
        }
        if points.len() == 1 {
            (points[0].x_mm - near.x_mm).abs().max((points[0].y_mm - near.y_mm).abs())
        } else {
            least
        }
    }

    #[test]
    fn a_steady_line_is_two_points_and_a_pause_two_more() {
        let mut trail = Trail::new(0.03, 1_000);
        (0..=1_000).for_each(|n| trail.push(point(n * 100, n as f64 * 0.025, 0.0)));
        trail.push(point(500_000, 25.0, 0.0));
        trail.push(point(500_100, 25.0, 1.0));
        let (points, error_mm) = trail.finish();
        assert_eq!(points.iter().map(|p| p.at_us).collect::<Vec<_>>(), [0, 100_000, 500_000, 500_100]);
        assert_eq!(error_mm, 0.03);
    }

    #[test]
    fn the_pen_is_lifted_where_it_was() {
        let mut trail = Trail::new(1.0, 1_000);
        for n in 0..100 {
            trail.push(TrailPoint { state: u8::from(n < 50), ..point(n * 10, n as f64 * 0.025, 0.0) });
        }
        let (points, _) = trail.finish();
        assert_eq!(
            points.iter().map(|p| (p.at_us, p.state)).collect::<Vec<_>>(),
            [(0, 1), (490, 1), (990, 0)]
        );
    }

    #[test]
    fn however_long_the_way_the_points_are_few() {
        let mut trail = Trail::new(0.001, 500);
        for n in 0..200_000_u64 {
            let turn = n as f64 * 0.01;
            let state = u8::from(n % 7 < 4); // a pen that never rests
            trail.push(TrailPoint { state, ..point(n * 10, 50.0 * turn.cos(), turn) });
            assert!(trail.kept.len() < 500);
        }
        let (points, error_mm) = trail.finish();
        assert!(points.len() > 20 && error_mm < 300.0, "{} points, {error_mm} mm", points.len());
        assert_eq!(points.last().map(|p| p.at_us), Some(1_999_990));
    }

    proptest! {
        #[test]
        fn the_pen_is_where_it_was_at_every_time(
            steps in prop::collection::vec((0_u64..50, -5.0..5.0_f64, -5.0..5.0_f64, 0_u8..4), 1..400),
            tolerance_mm in 0.01..4.0_f64,
            most in 16_usize..200,
        ) {
            let (mut at_us, mut x_mm, mut y_mm) = (0, 0.0, 0.0);
            let way: Vec<_> = steps.iter().map(|&(us, x, y, state)| {
                at_us += us;
                x_mm += x;
                y_mm += y;
                TrailPoint { at_us, x_mm, y_mm, state }
            }).collect();
            let mut trail = Trail::new(tolerance_mm, most);
            way.iter().for_each(|&point| trail.push(point));
            let (points, error_mm) = trail.finish();
            prop_assert!(points.len() <= most);
            prop_assert!(points.is_sorted_by_key(|p| p.at_us));
            for &place in &way {
                let off_mm = distance_mm(&points, place);
                prop_assert!(off_mm <= error_mm * (1.0 + 1e-9) + 1e-9, "{off_mm} of {error_mm}");
            }
        }
    }
}
