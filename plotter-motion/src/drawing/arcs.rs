//! [`Drawing::fit_arcs`]: lines and curves that lie on a circle become arcs.
//!
//! From each place the longest arc is sought: its length is doubled until it does not fit, and then halved in
//! (so a run of n lines takes n log n looks at most). An arc that fits goes through both its ends, so only
//! where on the chord's bisector its centre lies is free: least squares of
//! |q − c|² − r² is linear in it, and where that misses, the middle of all centres that are possible for every place is tried.
//!
//! Places that are rounded, to units of HPGL as an example, are off by less than the tolerance, but an arc
//! goes exactly through two of them. So where one end does not fit, ends little before it are tried; and a
//! closed run is first looked at as a circle, whose centre is free in both directions, with the one that
//! keeps the farthest place nearest.

use super::{Drawing, PathSegment, Shape, Stroke};
use crate::{Point, Segment, Vec2};
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

/// Fewest lines that become an arc. Three lines are on a circle in many drawings that mean none.
const FEWEST_LINES: usize = 4;

/// Most of a turn that one line of an arc takes, rad: a polygon of fewer than 12 sides is meant as one.
const MOST_STEP_RAD: f64 = PI / 6.0 + 1e-6;

/// Ends that are tried for an arc, one before the other: of places rounded by chance four in a row are seldom
/// all at the wrong side. With one, circles of HPGL are up to four arcs.
const ENDS: usize = 4;

/// Rounds of the search for the best centre of a circle. With 16 the farthest place is within some per cent
/// of the best.
const ROUNDS: usize = 16;

/// Greatest distance of a cubic curve from the lines that are taken for it, as a share of the tolerance:
/// small, so that nearly all of it is left for the arc.
const CURVES: f64 = 0.125;

/// Least of a turn that an arc whose ends differ leaves open, rad; below, rounding decides where its centre
/// is.
const LEAST_OPEN_RAD: f64 = 1e-3;

impl Drawing {
    /// Replaces runs of lines and curves that lie on a circle by arcs, none of which is farther than
    /// `tolerance_mm` from what was drawn, nor is anything that was drawn farther from them. Returns how many
    /// arcs were made.
    ///
    /// An arc stands for at least four lines, of which none takes more than a twelfth of a turn, or for a
    /// curve. It begins and ends exactly where they did. What is straight within the tolerance, and lines of
    /// different speeds or powers, stay. A circle is one arc of a whole turn. A tolerance of 0 or below, or
    /// that is no number, changes nothing.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Drawing, Stroke}};
    /// // A circle of 10 mm as 360 lines, each of them 0.0004 mm beside it in its middle.
    /// let degrees = (0..360).map(|degree| f64::from(degree).to_radians()).chain([0.0]);
    /// let stroke = Stroke::through(degrees.map(|at| Point::new(10.0 * at.cos(), 10.0 * at.sin()))).unwrap();
    /// let mut drawing = Drawing { strokes: vec![stroke], ..Drawing::default() };
    /// assert_eq!(drawing.fit_arcs(0.01), 1);
    /// assert_eq!(drawing.strokes[0].segments.len(), 1);
    /// assert!((drawing.length_mm() - 62.832).abs() < 1e-2); // 2π · 10 mm
    /// ```
    pub fn fit_arcs(&mut self, tolerance_mm: f64) -> usize {
        if tolerance_mm.is_nan() || tolerance_mm <= 0.0 {
            return 0;
        }
        self.strokes.iter_mut().map(|stroke| fit_arcs(stroke, tolerance_mm)).sum()
    }
}

/// Puts arcs into a stroke; returns how many.
fn fit_arcs(stroke: &mut Stroke, tolerance_mm: f64) -> usize {
    let may_be_arc = |segment: &PathSegment| !matches!(segment.shape, Shape::Arc { .. });
    let mut segments = Vec::with_capacity(stroke.segments.len());
    let mut arcs = 0;
    let mut at = stroke.from;
    for run in stroke.segments.chunk_by(|a, b| may_be_arc(a) && may_be_arc(b) && a.is_driven_as(b)) {
        if run.iter().all(may_be_arc) {
            arcs += Run::new(at, run, tolerance_mm).into_arcs(&mut segments);
        } else {
            segments.extend_from_slice(run);
        }
        at = run.last().map_or(at, |last| last.to);
    }
    stroke.segments = segments;
    arcs
}

/// Lines and curves of one speed and power.
struct Run<'a> {
    segments: &'a [PathSegment],
    /// Places along them, curves as short lines.
    places: Vec<Point>,
    /// Where among the places each segment begins, and the last one ends.
    begins: Vec<usize>,
    /// What the places may be off.
    tolerance_mm: f64,
}

/// What a part of a run is.
#[derive(Clone, Copy)]
enum Fit {
    Arc { centre: Point, sweep_rad: f64 },
    Straight,
    Neither,
}

impl<'a> Run<'a> {
    fn new(from: Point, segments: &'a [PathSegment], tolerance_mm: f64) -> Self {
        let mut places = alloc::vec![from];
        let mut begins = alloc::vec![0];
        let mut at = from;
        let mut has_curves = false;
        for segment in segments {
            has_curves |= segment.shape != Shape::Line;
            places.extend(segment.places(at, CURVES * tolerance_mm));
            begins.push(places.len() - 1);
            at = segment.to;
        }
        let tolerance_mm = if has_curves { (1.0 - CURVES) * tolerance_mm } else { tolerance_mm };
        Self { segments, places, begins, tolerance_mm }
    }

    /// Appends the run with arcs; returns how many.
    fn into_arcs(self, into: &mut Vec<PathSegment>) -> usize {
        let mut arcs = 0;
        let mut begin = 0;
        while begin < self.segments.len() {
            let (count, fit) = self.longest_from(begin);
            let end = begin
                + match fit {
                    Fit::Arc { .. } => count,
                    // An arc may begin behind a straight stretch. Near its end each place is tried.
                    Fit::Straight if count > 2 * FEWEST_LINES => count / 2,
                    _ => 1,
                };
            let part = self.segments.get(begin..end).unwrap_or_default();
            match (fit, part.last()) {
                (Fit::Arc { centre, sweep_rad }, Some(last)) => {
                    into.push(PathSegment { shape: Shape::Arc { centre, sweep_rad }, ..*last });
                    arcs += 1;
                }
                _ => into.extend_from_slice(part),
            }
            begin = end;
        }
        arcs
    }

    /// The longest part from a segment on that is an arc or straight, and how many segments it is.
    fn longest_from(&self, begin: usize) -> (usize, Fit) {
        let rest = self.segments.get(begin..).unwrap_or_default();
        // A curve counts for four lines.
        let is_curve = |segment: &PathSegment| segment.shape != Shape::Line;
        let least = rest.iter().take(FEWEST_LINES).position(is_curve).map_or(FEWEST_LINES, |lines| lines + 1);
        let mut best = (0, Fit::Neither);
        if rest.len() < least {
            return best;
        }
        let is_closed = self.begins.get(begin).and_then(|at| self.places.get(*at)) == self.places.last();
        if is_closed && let fit @ Fit::Arc { .. } = self.fit(begin, self.segments.len()) {
            return (rest.len(), fit);
        }
        let (mut count, mut too_long) = (least, rest.len() + 1);
        while too_long - best.0 > 1 {
            let lowest = least.max(best.0 + 1).max((count + 1).saturating_sub(ENDS));
            let fits = (lowest..=count).rev().map(|count| (count, self.fit(begin, begin + count)));
            let found = fits.into_iter().find(|(_, fit)| !matches!(fit, Fit::Neither));
            if let Some(found) = found {
                best = found;
                if found.0 < count {
                    // All between both have been tried.
                    break;
                }
            } else {
                too_long = count;
            }
            if best.0 == 0 {
                break;
            }
            let is_growing = too_long > rest.len();
            count = if is_growing { (2 * best.0).min(rest.len()) } else { best.0.midpoint(too_long) };
        }
        best
    }

    /// What the segments between two are.
    fn fit(&self, begin: usize, end: usize) -> Fit {
        let (Some(&first), Some(&last)) = (self.begins.get(begin), self.begins.get(end)) else {
            return Fit::Neither;
        };
        let places = self.places.get(first..=last).unwrap_or_default();
        let ([from, ..], [.., to]) = (places, places) else { return Fit::Neither };
        let chord = Segment::new(*from, *to);
        if places.iter().all(|&place| chord.distance(place) <= self.tolerance_mm) {
            return Fit::Straight;
        }
        let half_mm = 0.5 * chord.length();
        let along = (*to - *from).normalized();
        let Some(along) = along else {
            let centre = circle_through(places);
            let fit = centre.and_then(|centre| self.check(begin, end, centre));
            let best = || best_circle(places, centre?).and_then(|centre| self.check(begin, end, centre));
            return fit.or_else(best).unwrap_or(Fit::Neither);
        };
        let middle = from.lerp(*to, 0.5);
        let up = along.perpendicular();
        // A centre is `middle + up · s`. Of a place (x, y) from the middle, |q − c|² − r² is x² + y² − half²
        // − 2 y s.
        let terms = || {
            places.iter().map(|&place| {
                let out = place - middle;
                (out.dot(up), out.length_squared() - half_mm * half_mm)
            })
        };
        let (products, squares) =
            terms().fold((0.0, 0.0), |(products, squares), (y, rest)| (products + y * rest, squares + y * y));
        let s = products / (2.0 * squares);
        if let Some(fit) = self.check(begin, end, middle + up * s) {
            return fit;
        }
        // That of a place is off by at most 2 r tolerance, so s lies between two bounds.
        let slack = 2.0 * libm::hypot(half_mm, s) * self.tolerance_mm;
        let (low, high) = terms().filter(|(y, _)| libm::fabs(*y) > self.tolerance_mm).fold(
            (f64::NEG_INFINITY, f64::INFINITY),
            |(low, high), (y, rest)| {
                let (a, b) = ((rest - slack) / (2.0 * y), (rest + slack) / (2.0 * y));
                (libm::fmax(low, libm::fmin(a, b)), libm::fmin(high, libm::fmax(a, b)))
            },
        );
        if low < high {
            self.check(begin, end, middle + up * low.midpoint(high)).unwrap_or(Fit::Neither)
        } else {
            Fit::Neither
        }
    }

    /// The arc about a centre, if all between two segments lies on it.
    fn check(&self, begin: usize, end: usize, centre: Point) -> Option<Fit> {
        let first = *self.begins.get(begin)?;
        let from = *self.places.get(first)?;
        let radius_mm = from.distance(centre);
        let slack_rad = self.tolerance_mm / radius_mm;
        if !(radius_mm > self.tolerance_mm && radius_mm.is_finite()) {
            return None;
        }
        // The angle so far, its bounds, and how far it went back, whichever way the arc goes.
        let (mut angle, mut low, mut high) = (0.0, 0.0, 0.0);
        let (mut back_from_high, mut back_from_low): (f64, f64) = (0.0, 0.0);
        let mut at = from;
        for (index, segment) in self.segments.iter().enumerate().take(end).skip(begin) {
            let most_rad = if segment.shape == Shape::Line { MOST_STEP_RAD } else { PI };
            let ends = self.places.get(*self.begins.get(index)? + 1..=*self.begins.get(index + 1)?)?;
            for &to in ends {
                let nearest_mm = Segment::new(at, to).distance(centre);
                if !(to.distance(centre) <= radius_mm + self.tolerance_mm
                    && nearest_mm >= radius_mm - self.tolerance_mm)
                {
                    return None;
                }
                let (here, there) = (at - centre, to - centre);
                let step = libm::atan2(here.cross(there), here.dot(there));
                if step.is_nan() || libm::fabs(step) > most_rad {
                    return None;
                }
                angle += step;
                (low, high) = (libm::fmin(low, angle), libm::fmax(high, angle));
                back_from_high = back_from_high.max(high - angle);
                back_from_low = back_from_low.max(angle - low);
                at = to;
            }
        }
        // Nothing lies beyond the ends, and nothing is drawn to and fro.
        const ROUNDING_RAD: f64 = 1e-9;
        let (beyond, back) = if angle > 0.0 {
            (high - angle - low, back_from_high)
        } else {
            (high + angle - low, back_from_low)
        };
        if !(beyond <= ROUNDING_RAD && back <= slack_rad) {
            return None;
        }
        let sweep_rad = if at == from {
            // All the way round, once.
            (libm::fabs(libm::fabs(angle) - TAU) < LEAST_OPEN_RAD).then(|| libm::copysign(TAU, angle))
        } else {
            (libm::fabs(angle) <= TAU - LEAST_OPEN_RAD).then_some(angle)
        };
        sweep_rad.map(|sweep_rad| Fit::Arc { centre, sweep_rad })
    }
}

/// The centre of the circle through the first of places from which the farthest of the others, and of the
/// middles between them, is nearest; from a centre that is near it.
///
/// By least squares whose weights grow with what is left (C. Lawson, "Contributions to the theory of linear
/// least maximum approximation", 1961). How far a place is off changes with the centre by the difference of
/// both directions from it.
fn best_circle(places: &[Point], mut centre: Point) -> Option<Point> {
    let first = *places.first()?;
    let middles = places.windows(2).filter_map(|pair| Some(pair.first()?.lerp(*pair.last()?, 0.5)));
    let all: Vec<Point> = places.iter().copied().chain(middles).collect();
    let mut weights = alloc::vec![1.0_f64; all.len()];
    let mut best = (f64::INFINITY, centre);
    for _ in 0..ROUNDS {
        let out = first - centre;
        let (radius_mm, towards) = (out.length(), out.normalized()?);
        let off_mm = |place: &Point| place.distance(centre) - radius_mm;
        let farthest_mm = all.iter().map(|place| libm::fabs(off_mm(place))).fold(0.0, libm::fmax);
        if farthest_mm < best.0 {
            best = (farthest_mm, centre);
        }
        let (mut xx, mut xy, mut yy, mut right, mut sum) = (0.0, 0.0, 0.0, Vec2::default(), 0.0);
        for (place, weight) in all.iter().zip(&mut weights) {
            let off_mm = off_mm(place);
            let Some(direction) = (*place - centre).normalized() else { continue };
            let way = direction - towards;
            xx += *weight * way.x * way.x;
            xy += *weight * way.x * way.y;
            yy += *weight * way.y * way.y;
            right = right + way * (*weight * off_mm);
            *weight *= libm::fabs(off_mm) / farthest_mm;
            sum += *weight;
        }
        let area = xx * yy - xy * xy;
        let step = Vec2::new(yy * right.x - xy * right.y, xx * right.y - xy * right.x) * (1.0 / area);
        centre += step;
        if !centre.is_finite() || sum <= 0.0 {
            break;
        }
        weights.iter_mut().for_each(|weight| *weight /= sum);
    }
    best.1.is_finite().then_some(best.1)
}

/// The centre of the circle through the first of places that fits the others best, by least squares of |q|² −
/// 2 q·c, with q from the first.
fn circle_through(places: &[Point]) -> Option<Point> {
    let first = *places.first()?;
    let (mut xx, mut xy, mut yy, mut right) = (0.0, 0.0, 0.0, Vec2::default());
    for &place in places {
        let out = place - first;
        (xx, xy, yy) = (xx + out.x * out.x, xy + out.x * out.y, yy + out.y * out.y);
        right = right + out * (0.5 * out.length_squared());
    }
    let area = xx * yy - xy * xy;
    let centre = first + Vec2::new(yy * right.x - xy * right.y, xx * right.y - xy * right.x) * (1.0 / area);
    centre.is_finite().then_some(centre)
}
