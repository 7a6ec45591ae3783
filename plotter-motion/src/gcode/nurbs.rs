//! [`Nurbs`]: the curve of `G5.2`, as Bézier curves while its control points come.

use super::{Error, Position, Problem};
use crate::rational::{Weighted, bezier_point};
use crate::{Point, Vec2};

/// Highest order that is read, one more than the degree: programs write 3 and 4.
pub(super) const MOST_ORDER: usize = 6;
/// The lowest, which is also that of a curve that names none: `LinuxCNC`'s.
pub(super) const LEAST_ORDER: usize = 3;
/// Control points that are held: a stretch of degree p is known once p points have come behind its own p + 1.
const HELD: usize = 2 * MOST_ORDER - 1;
/// Most lines of one stretch.
const MOST_LINES: f64 = 4096.0;

/// A curve whose knots are 0 as often as its order says, then 1, 2, …, and the last as often as the first:
/// `LinuxCNC`'s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nurbs {
    /// Where it began, on the sheet and in the text.
    pub(super) start: Point,
    at: Position,
    pub(super) order: usize,
    /// The last control points, each at the remainder of its number.
    points: [Weighted<Vec2>; HELD],
    count: usize,
    /// The last point of the next stretch.
    next: usize,
}

impl Nurbs {
    /// One that begins here.
    pub(super) fn new(start: Point, weight: f64, at: Position) -> Self {
        let mut nurbs = Self {
            start,
            at,
            order: LEAST_ORDER,
            points: [Weighted::default(); HELD],
            count: 0,
            next: LEAST_ORDER - 1,
        };
        nurbs.keep(start, weight);
        nurbs
    }

    /// Its order from here on, while it has one point only.
    pub(super) fn set_order(&mut self, order: usize) {
        if self.count <= 1 {
            (self.order, self.next) = (order, order - 1);
        }
    }

    /// That no `G5.3` comes.
    pub(super) fn not_ended(&self) -> Error {
        let expected = "the curve of G5.2 needs a G5.3 behind its last point: what of it has not been drawn by then is left out";
        Error { at: self.at, problem: Problem::Missing { expected } }
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The last control point.
    pub(super) fn last(&self) -> Point {
        Point::ORIGIN + self.point(self.count.saturating_sub(1)).projected()
    }

    fn keep(&mut self, point: Point, weight: f64) {
        if let Some(slot) = self.points.get_mut(self.count % HELD) {
            *slot = Weighted::new(point - Point::ORIGIN, weight);
        }
        self.count += 1;
    }

    fn point(&self, number: usize) -> Weighted<Vec2> {
        self.points.get(number % HELD).copied().unwrap_or_default()
    }

    /// Takes a control point; gives the stretch that is known by it.
    pub(super) fn push(&mut self, point: Point, weight: f64, tolerance_mm: f64) -> Option<Stretch> {
        self.keep(point, weight);
        let is_known = self.count >= self.next + self.order;
        is_known.then(|| self.stretch(None, tolerance_mm))
    }

    /// The next stretch of those that are left when no more points come.
    pub(super) fn rest(&mut self, tolerance_mm: f64) -> Option<Stretch> {
        (self.next < self.count).then(|| self.stretch(Some(self.count), tolerance_mm))
    }

    /// The Bézier points of a stretch.
    fn stretch(&mut self, count: Option<usize>, tolerance_mm: f64) -> Stretch {
        let (degree, first) = (self.order - 1, self.next + 1 - self.order);
        self.next += 1;
        let knot = |number: usize| {
            let number =
                count.map_or(first + number, |count| (first + number).min(count)).saturating_sub(degree);
            f64::from(u32::try_from(number).unwrap_or(u32::MAX))
        };
        let mut points = [Weighted::default(); MOST_ORDER];
        for (ends, slot) in points.iter_mut().enumerate().take(self.order) {
            let mut row = [Weighted::default(); MOST_ORDER];
            row.iter_mut().zip(first..).for_each(|(slot, number)| *slot = self.point(number));
            *slot = row.get_mut(..self.order).map(|row| bezier_point(row, ends, knot)).unwrap_or_default();
        }
        Stretch::new(points, degree, tolerance_mm)
    }
}

/// A rational Bézier curve that is being divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    points: [Weighted<Vec2>; MOST_ORDER],
    degree: usize,
    lines: u32,
    next: u32,
}

impl Stretch {
    /// As so many lines of equal parameter that none is farther than `tolerance_mm` from it, at most 4096.
    ///
    /// Source: J. Zheng and T. Sederberg, "Estimating tessellation parameter intervals for rational curves
    /// and surfaces" (2000): with places from the first point on, second differences D of places times
    /// weights and d of weights, the farthest point at r and the least weight w, steps of √(8 w · tolerance /
    /// (D + r · d)).
    fn new(points: [Weighted<Vec2>; MOST_ORDER], degree: usize, tolerance_mm: f64) -> Self {
        let used = points.get(..=degree).unwrap_or_default();
        let origin = used.first().map(|point| point.projected()).unwrap_or_default();
        let from_first = |point: &Weighted<Vec2>| point.place - origin * point.weight;
        let (mut places, mut weights) = (0.0_f64, 0.0_f64);
        for three in used.windows(3) {
            let [a, b, c] = three else { continue };
            let bend = from_first(a) + from_first(b) * -2.0 + from_first(c);
            places = libm::fmax(places, bend.length());
            weights = libm::fmax(weights, (a.weight - 2.0 * b.weight + c.weight).abs());
        }
        let far = used.iter().map(|point| (point.projected() - origin).length()).fold(0.0, libm::fmax);
        let least = used.iter().map(|point| point.weight).fold(f64::INFINITY, libm::fmin);
        let steps = u32::try_from(degree * (degree - 1)).map_or(0.0, f64::from);
        let lines = libm::ceil(libm::sqrt(steps * (places + far * weights) / (8.0 * least * tolerance_mm)));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number, clamped"
        )]
        let lines = if lines.is_nan() { 1 } else { lines.clamp(1.0, MOST_LINES) as u32 };
        Self { points, degree, lines, next: 1 }
    }

    /// The end of the next line.
    pub(super) fn next(&mut self) -> Option<Point> {
        let index = self.next;
        if index > self.lines {
            return None;
        }
        self.next += 1;
        let t = f64::from(index) / f64::from(self.lines);
        let mut row = self.points;
        for level in (0..self.degree).rev() {
            for index in 0..=level {
                if let Some([point, after]) = row.get_mut(index..=index + 1) {
                    *point = point.mixed(*after, t);
                }
            }
        }
        row.first().map(|point| Point::ORIGIN + point.projected())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    /// A place on the curve by its definition: the sum of the control points times their basis functions (Cox
    /// and de Boor), with knots written out.
    fn defined(points: &[(Point, f64)], order: usize, t: f64) -> Point {
        fn basis(knots: &[f64], i: usize, k: usize, t: f64) -> f64 {
            if k == 1 {
                let is_last = knots[i + 1] == *knots.last().unwrap() && t >= knots[i + 1];
                return if knots[i] < knots[i + 1] && (knots[i] <= t && (t < knots[i + 1] || is_last)) {
                    1.0
                } else {
                    0.0
                };
            }
            let share = |over: f64, under: f64| if under == 0.0 { 0.0 } else { over / under };
            share(t - knots[i], knots[i + k - 1] - knots[i]) * basis(knots, i, k - 1, t)
                + share(knots[i + k] - t, knots[i + k] - knots[i + 1]) * basis(knots, i + 1, k - 1, t)
        }
        let spans = points.len() - order + 1;
        let mut knots = vec![0.0; order];
        knots.extend((1..spans).map(|knot| knot as f64));
        knots.extend(vec![spans as f64; order]);
        let (mut place, mut weight) = (Vec2::default(), 0.0);
        for (i, (point, w)) in points.iter().enumerate() {
            let share = basis(&knots, i, order, t) * w;
            place = place + (*point - Point::ORIGIN) * share;
            weight += share;
        }
        Point::ORIGIN + place * (1.0 / weight)
    }

    fn chords(points: &[(Point, f64)], order: usize, tolerance_mm: f64) -> Vec<Point> {
        let mut nurbs = Nurbs::new(points[0].0, points[0].1, Position::START);
        nurbs.set_order(order);
        let mut stretches: Vec<Stretch> = points[1..]
            .iter()
            .filter_map(|(point, weight)| nurbs.push(*point, *weight, tolerance_mm))
            .collect();
        while let Some(stretch) = nurbs.rest(tolerance_mm) {
            stretches.push(stretch);
        }
        assert_eq!(stretches.len(), points.len() - order + 1);
        let ends = stretches.into_iter().flat_map(|mut stretch| core::iter::from_fn(move || stretch.next()));
        core::iter::once(points[0].0).chain(ends).collect()
    }

    proptest! {
        #[test]
        fn chords_lie_on_the_curve_as_it_is_defined(
            places in prop::collection::vec((-50.0..50.0, -50.0..50.0, 0.2..5.0), 6..14),
            order in 3..7_usize,
            shares in prop::collection::vec(0.0..1.0, 20),
        ) {
            let points: Vec<(Point, f64)> = places.iter().map(|(x, y, w)| (Point::new(*x, *y), *w)).collect();
            let chords = chords(&points, order, 0.01);
            prop_assert_eq!(chords.last().map(|end| end.distance(points[points.len() - 1].0) < 1e-9), Some(true));
            for share in shares {
                let spans = (points.len() - order + 1) as f64;
                let place = defined(&points, order, share * spans);
                let off = chords
                    .windows(2)
                    .map(|pair| {
                        let (way, out) = (pair[1] - pair[0], place - pair[0]);
                        let along = (out.dot(way) / way.dot(way).max(1e-300)).clamp(0.0, 1.0);
                        (out - way * along).length()
                    })
                    .fold(f64::INFINITY, f64::min);
                prop_assert!(off <= 0.010_001, "{off}");
            }
        }
    }

    #[test]
    fn a_quarter_of_a_circle_is_one() {
        let weight = core::f64::consts::FRAC_1_SQRT_2;
        let points =
            [(Point::new(10.0, 0.0), 1.0), (Point::new(10.0, 10.0), weight), (Point::new(0.0, 10.0), 1.0)];
        let chords = chords(&points, 3, 0.01);
        assert!(chords.len() > 10 && chords.len() < 60, "{}", chords.len());
        for place in chords {
            assert!((place.distance(Point::ORIGIN) - 10.0).abs() < 1e-9);
        }
    }
}
