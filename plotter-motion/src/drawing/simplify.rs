//! [`Drawing::simplify`]: lines with fewer places.
//!
//! A run of lines is replaced by lines through some of its places. Such a line may stand for those between
//! its ends if each of their places is within the tolerance of it: then each place of the line is within the
//! tolerance of them as well, because they lead from one of its ends to the other.
//!
//! Which lines may: from one place, the rays that pass a later place within the tolerance are a cone, and the
//! rays that pass all of them are the cones' common part, which only shrinks (W. Chan and F. Chin,
//! "Approximation of polygonal curves with minimum number of line segments or minimum error", 1996). So all
//! lines from one place are known after one look at each place that follows, until the cone is empty. Of all
//! lines found, the fewest that lead from end to end are taken (H. Imai and M. Iri, 1988). Douglas and
//! Peucker's halving is not used: it takes a square of the number of places at worst.

use super::{Drawing, PathSegment, Shape, Stroke};
use crate::{Point, Segment, Vec2};
use alloc::vec::Vec;

/// Places that are tried as the end of a line that begins at any place. Only along one chain, of longest
/// lines, are more tried. It bounds the time: a straight line of a million places would take a million for
/// each.
const WINDOW: usize = 64;

impl Drawing {
    /// Replaces runs of lines by fewer lines, none of which is farther than `tolerance_mm` from what was
    /// drawn, nor is anything that was drawn farther from them. Returns how many places were left out.
    ///
    /// The places left are places of before; ends of strokes stay. Arcs and curves are left as they are, and
    /// lines of different speeds or powers stay apart. What is closed stays closed. A tolerance of 0 or
    /// below, or that is no number, changes nothing.
    ///
    /// The result is the least number of lines, for runs of which no line stands for more than 64; it is
    /// never more than that of taking the longest line again and again. The time is proportional to the
    /// number of places, whatever they are.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Drawing, Stroke}};
    /// // A step of 0.05 mm in a line of 10 mm, and a corner of 5 mm.
    /// let places = [(0.0, 0.0), (4.0, 0.0), (5.0, 0.05), (6.0, 0.0), (10.0, 0.0), (10.0, 5.0)];
    /// let stroke = Stroke::through(places.map(|(x, y)| Point::new(x, y))).unwrap();
    /// let mut drawing = Drawing { strokes: vec![stroke], ..Drawing::default() };
    /// assert_eq!(drawing.simplify(0.1), 3);
    /// assert_eq!((drawing.strokes[0].segments.len(), drawing.length_mm()), (2, 15.0));
    /// ```
    pub fn simplify(&mut self, tolerance_mm: f64) -> usize {
        if tolerance_mm.is_nan() || tolerance_mm <= 0.0 {
            return 0;
        }
        self.strokes.iter_mut().map(|stroke| simplify(stroke, tolerance_mm)).sum()
    }
}

impl PathSegment {
    /// Whether another one is drawn at the same speed and power.
    pub(super) fn is_driven_as(&self, other: &Self) -> bool {
        self.feed_mm_s == other.feed_mm_s && self.power == other.power
    }
}

/// Simplifies the runs of lines of a stroke; returns how many places were left out.
fn simplify(stroke: &mut Stroke, tolerance_mm: f64) -> usize {
    let is_line = |segment: &PathSegment| segment.shape == Shape::Line;
    let mut segments = Vec::with_capacity(stroke.segments.len());
    let mut at = stroke.from;
    for run in stroke.segments.chunk_by(|a, b| is_line(a) && is_line(b) && a.is_driven_as(b)) {
        if run.len() > 1 {
            let places: Vec<Point> = core::iter::once(at).chain(run.iter().map(|line| line.to)).collect();
            segments.extend(
                fewest(&places, tolerance_mm).into_iter().filter_map(|end| run.get(end.checked_sub(1)?)),
            );
        } else {
            segments.extend_from_slice(run);
        }
        at = run.last().map_or(at, |last| last.to);
    }
    let left_out = stroke.segments.len() - segments.len();
    stroke.segments = segments;
    left_out
}

/// How a place is reached by the fewest lines.
#[derive(Clone, Copy)]
struct Reached {
    lines: usize,
    /// From which place.
    from: usize,
}

/// The ends of the fewest lines along places: their indices, without that of the first.
fn fewest(places: &[Point], tolerance_mm: f64) -> Vec<usize> {
    let last = places.len().saturating_sub(1);
    let is_closed =
        places.first() == places.last() && places.iter().any(|place| Some(place) != places.first());
    let mut reached = alloc::vec![Reached { lines: usize::MAX, from: 0 }; places.len()];
    if let Some(first) = reached.first_mut() {
        first.lines = 0;
    }
    // The next place of the chain of longest lines.
    let mut link = 0;
    for begin in 0..last {
        let Some(lines) = reached.get(begin).map(|here| here.lines.saturating_add(1)) else { break };
        let is_link = begin == link;
        lines_from(places, begin, is_link, tolerance_mm, |end| {
            // One line from a place back to it would be a dot.
            if is_closed && end > begin + 1 && places.get(begin) == places.get(end) {
                return;
            }
            if let Some(there) = reached.get_mut(end).filter(|there| lines < there.lines) {
                *there = Reached { lines, from: begin };
            }
            if is_link {
                link = link.max(end);
            }
        });
    }
    let mut ends = Vec::new();
    let mut end = last;
    while end > 0 {
        ends.push(end);
        // Each place is reached at least from the one before it.
        end = reached.get(end).map_or(0, |there| there.from.min(end - 1));
    }
    ends.reverse();
    ends
}

/// Tells the ends of lines from one place that stand for all places between.
fn lines_from(places: &[Point], begin: usize, is_far: bool, tolerance_mm: f64, mut found: impl FnMut(usize)) {
    let Some((&from, rest)) = places.get(begin..).and_then(<[Point]>::split_first) else { return };
    let stands_for = |passed: usize| {
        let (Some(&to), Some(between)) = (rest.get(passed), rest.get(..passed)) else { return false };
        between.iter().all(|&place| Segment::new(from, to).distance(place) <= tolerance_mm)
    };
    let mut cone = Cone::All;
    // The farthest place so far.
    let mut farthest_mm: f64 = 0.0;
    // Places passed to the last end found, and to the last of those that were not looked at because they are
    // many.
    let (mut best, mut perhaps) = (0, 0);
    for (passed, &to) in rest.iter().enumerate() {
        let way = to - from;
        let length_mm = way.length_near();
        if cone.has(way) {
            // A place farther than the line's end must be near that end, but where all are near its
            // beginning.
            let is_end = length_mm >= farthest_mm || matches!(cone, Cone::All);
            let turns_back = !is_end && length_mm + tolerance_mm >= farthest_mm;
            if is_end || (turns_back && passed <= WINDOW && stands_for(passed)) {
                best = passed;
                found(begin + passed + 1);
            } else if turns_back {
                perhaps = passed;
            }
        }
        farthest_mm = farthest_mm.max(length_mm);
        let most = if is_far { 3 * best + WINDOW } else { WINDOW };
        if !cone.narrow(way, length_mm, tolerance_mm) || passed >= most {
            break;
        }
    }
    if perhaps > best && stands_for(perhaps) {
        found(begin + perhaps + 1);
    }
}

/// Directions in which all places so far are passed within the tolerance.
enum Cone {
    /// Every direction.
    All,
    /// From `right` counter-clockwise to `left`, less than half a turn; both of length 1.
    Between { right: Vec2, left: Vec2 },
}

impl Cone {
    fn has(&self, way: Vec2) -> bool {
        match *self {
            Self::All => true,
            Self::Between { right, left } => {
                right.cross(way) >= 0.0 && way.cross(left) >= 0.0 && way.dot(right + left) >= 0.0
            }
        }
    }

    /// Leaves the directions that pass a place, whose way and distance are given; false if none is left.
    fn narrow(&mut self, way: Vec2, length_mm: f64, tolerance_mm: f64) -> bool {
        // From here it is passed in every direction.
        if length_mm <= tolerance_mm {
            return true;
        }
        let along = way * (1.0 / length_mm);
        let sin = tolerance_mm / length_mm;
        let (out, across) = (along * libm::sqrt(1.0 - sin * sin), along.perpendicular() * sin);
        let place = (out - across, out + across);
        let other = Self::Between { right: place.0, left: place.1 };
        *self = match *self {
            Self::All => other,
            Self::Between { right, left } => {
                let pick = |ours: Vec2, theirs: Vec2| {
                    if self.has(theirs) { Some(theirs) } else { other.has(ours).then_some(ours) }
                };
                match (pick(right, place.0), pick(left, place.1)) {
                    (Some(right), Some(left)) => Self::Between { right, left },
                    _ => return false,
                }
            }
        };
        true
    }
}
