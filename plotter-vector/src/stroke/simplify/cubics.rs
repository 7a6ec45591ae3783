//! [`Bounded::cubics`]: lines and cubic curves, few of them, for a promised error.

use super::Bounded;
use super::arcs::{Bent, number, smoothed};
use super::corners::{Anchor, anchors};
use super::cubic_fit::{Fit, Joint};
use super::doubling_search::farthest;
use super::promise::Promise;
use crate::stroke::curve::unit;
use crate::stroke::{Curve, PxPoint, PxVec};

/// How many times as many sites as a line a cubic curve has to stand for to be taken.
const PAYS: f64 = 1.5;

/// How much of the longest line may be left when its ends are to go as the sites do there.
const STRAIGHT: f64 = 0.7;

/// Greatest sine of the angle between such a line and the sites at its ends.
const SMOOTH: f64 = 0.06;

/// Sites on either side over which the direction of the line at a site is taken.
const DIRECTION_SITES: usize = 8;

/// Times that the joints are moved over.
const SWEEPS: usize = 2;

/// Sites by which a joint is moved along the line.
const SHIFTS: [usize; 4] = [8, 4, 2, 1];

/// Parts of the tolerance by which a joint is moved to either side.
const NUDGES: [f64; 2] = [0.3, 0.1];

/// Angles by which the direction at a joint is turned, rad.
const TURNS: [f64; 2] = [0.1, 0.03];

impl Bounded {
    /// Lines and cubic curves, few of them, such that the line through a sequence of sites is kept within the
    /// tolerance.
    ///
    /// The promise is that of [`Bounded::polyline`], for segments that may be curved: a pen can run along
    /// them and along the sites, never back on either, so that both pens stay within `tolerance_px` of each
    /// other. Open lines begin at the first and end at the last site; a closed line within the tolerance of
    /// one circle *is* that circle, of two arcs. Corners stay corners; elsewhere one curve goes over into the
    /// next in one direction, and into a straight line where the promise allows it. Curves must pay: where
    /// they do not save vertices, the answer is the polyline's.
    ///
    /// The corners are those vertices of the polyline at which no curve could have made it turn. Between them
    /// each curve is the one with the least squared distances, for the sites' places by the way between them
    /// and then by Newton's steps. Where one does not do, Schneider divides it at its worst site; here the
    /// longest one that does is looked for by doubling and halving, as with arcs. Every segment that is taken
    /// has been checked site by site: each site's distance to its place on the curve, those places in order,
    /// and how far the curve can be from the chord between two of them by its greatest second derivative there,
    /// which together bound the Fréchet distance. The longest one from one end need not be that from the other,
    /// so both are begun from, and the fewer vertices are taken. Then the joints are moved and turned to where
    /// the squared distances are less. What no curve will do for is drawn with straight lines. No segment
    /// stands for more than [`MAX_REACH_PX`](crate::stroke::MAX_REACH_PX) sites and each is tried a fixed
    /// number of times, so the work is bounded by sites × the logarithm of the reach: 1 to 31 µs a site from
    /// one end, up to 15 times that of arcs. Both ends take a sixth more, and up to twice as much where
    /// straight lines alone will do.
    ///
    /// Source: P. J. Schneider, "An algorithm for automatically fitting digitized curves", in Graphics Gems
    /// (1990).
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, stroke::Bounded};
    /// // A parabola takes one cubic curve where it takes four straight lines.
    /// let sites: Vec<PxPoint> = (0..=60).map(f64::from).map(|x| PxPoint::new(x, x * x / 60.0)).collect();
    /// assert_eq!(Bounded::default().with_tolerance_px(0.5).polyline(&sites, false).len(), 5);
    /// let curve = Bounded::default().with_tolerance_px(0.5).cubics(&sites, false);
    /// assert_eq!(curve.vertices, [PxPoint::new(0.0, 0.0), PxPoint::new(60.0, 60.0)]);
    /// let near = |at: &PxPoint| (at.x * at.x / 60.0 - at.y).abs() < 0.5 * (1.0 + (at.x / 30.0).powi(2)).sqrt() + 0.1;
    /// assert!(curve.chords(0.01).iter().all(near)); // half a pixel beside it
    /// ```
    #[must_use]
    pub fn cubics(&self, sites: &[PxPoint], closed: bool) -> Curve {
        let one = self.search(sites, closed);
        // No curve has fewer.
        if one.vertex_count() < 3 {
            return one.finished();
        }
        let backwards: Vec<PxPoint> = sites.iter().rev().copied().collect();
        let other = self.search(&backwards, closed);
        if other.vertex_count() >= one.vertex_count() {
            return one.finished();
        }
        let mut curve = other.finished();
        curve.reverse();
        curve
    }

    /// The joints as found from the first site on.
    fn search(&self, sites: &[PxPoint], closed: bool) -> Found {
        self.bent(sites, closed, |promise, line, straight| {
            if closed { around(promise, line, straight) } else { along(promise, &line, straight) }
        })
    }
}

/// The parts of a line, each from a corner to the next.
#[derive(Debug)]
struct Found {
    parts: Vec<Part>,
}

/// Joints are moved when the search is over: that changes none of their number.
#[derive(Debug)]
enum Part {
    /// As it is to be.
    Done(Curve),
    Open(CubicFitter, Vec<Joint>),
    /// Closed, without corners.
    Ring(CubicFitter, Vec<Joint>),
}

impl From<Curve> for Found {
    fn from(curve: Curve) -> Self {
        Self { parts: vec![Part::Done(curve)] }
    }
}

impl Bent for Found {
    fn vertex_count(&self) -> usize {
        let counts = self.parts.iter().map(|part| match part {
            Part::Done(curve) => curve.vertices.len(),
            Part::Open(_, joints) | Part::Ring(_, joints) => joints.len(),
        });
        // Where two parts meet they have one vertex together.
        let segments: usize = counts.clone().map(|count| count.saturating_sub(1)).sum();
        segments + usize::from(counts.max().is_some_and(|most| most > 0))
    }
}

impl Found {
    fn finished(self) -> Curve {
        let mut parts = self.parts.into_iter().map(|part| match part {
            Part::Done(curve) => curve,
            Part::Open(way, mut joints) => {
                way.improve(&mut joints);
                joints.into()
            }
            Part::Ring(way, joints) => improved_ring(way, joints).into(),
        });
        let first = parts.next().unwrap_or_default();
        parts.fold(first, |mut curve, part| {
            curve.append(part);
            curve
        })
    }
}

/// The segments of an open line, from corner to corner.
fn along(promise: Promise, line: &[PxPoint], straight: &[PxPoint]) -> Found {
    between_corners(promise, line, &anchors(promise, line, straight, false))
}

/// The segments of a closed line.
fn around(promise: Promise, mut line: Vec<PxPoint>, straight: &[PxPoint]) -> Found {
    let mut anchors = anchors(promise, &line, straight, true);
    let Some(first) = anchors.iter().position(|anchor| anchor.is_corner) else {
        return Found { parts: vec![ring(promise, line)] };
    };
    // The last one is the first one again: it comes back after the turn.
    anchors.pop();
    anchors.rotate_left(first);
    let (count, seam) = (line.len(), anchors.first().map_or(0, |anchor| anchor.site));
    anchors.iter_mut().for_each(|anchor| anchor.site = (anchor.site + count - seam) % count);
    line.rotate_left(seam);
    line.extend(line.first().copied());
    let again = anchors.first().map(|first| Anchor { site: count, ..*first });
    anchors.extend(again);
    between_corners(promise, &line, &anchors)
}

/// The segments of a line, each part between two corners for itself.
fn between_corners(promise: Promise, line: &[PxPoint], anchors: &[Anchor]) -> Found {
    let mut parts = Vec::new();
    let mut start = 0;
    for end in 1..anchors.len() {
        let part = anchors.get(start..=end).unwrap_or(&[]);
        let [first, .., last] = part else { continue };
        if !last.is_corner && end + 1 < anchors.len() {
            continue;
        }
        parts.push(part_between(promise, line, first, last, part));
        start = end;
    }
    Found { parts }
}

fn part_between(
    promise: Promise,
    line: &[PxPoint],
    first: &Anchor,
    last: &Anchor,
    straight: &[Anchor],
) -> Part {
    let links = |ends: &[Anchor]| match ends {
        [from, to] => {
            let sites = line.get(from.site + 1..to.site).unwrap_or(&[]);
            promise.link(from.at, to.at, sites).is_some()
        }
        _ => false,
    };
    let kept = straight.windows(2).all(links);
    let lines = || Part::Done(straight.iter().map(|anchor| anchor.at).collect::<Vec<PxPoint>>().into());
    if kept && straight.len() < 3 {
        return lines();
    }
    let sites = line.get(first.site..=last.site).unwrap_or(&[]).to_vec();
    let mut smooth = smoothed(promise, &sites, false);
    smooth.first_mut().into_iter().for_each(|slot| *slot = first.at);
    smooth.last_mut().into_iter().for_each(|slot| *slot = last.at);
    let directions = directions(&sites, false);
    let mut way = CubicFitter { fit: Fit { promise, sites }, smooth, directions };
    let joints = way.joints();
    if kept && joints.len() >= straight.len() { lines() } else { Part::Open(way, joints) }
}

impl From<Vec<Joint>> for Curve {
    fn from(joints: Vec<Joint>) -> Self {
        Self {
            handles: joints.iter().map(|joint| joint.handles).collect(),
            vertices: joints.into_iter().map(|joint| joint.at).collect(),
            ..Self::default()
        }
    }
}

/// The segments of a closed line without corners.
fn ring(promise: Promise, mut sites: Vec<PxPoint>) -> Part {
    let count = sites.len();
    let mut smooth = smoothed(promise, &sites, true);
    let mut way = lap(promise, &sites, &smooth);
    let mut best = way.joints();
    // The first lap began anywhere: begin again where its first segment ended.
    if let Some(seam) = best.get(1).map(|joint| joint.site).filter(|seam| *seam < count) {
        sites.rotate_left(seam);
        smooth.rotate_left(seam);
        let mut turned = lap(promise, &sites, &smooth);
        let again = turned.joints();
        if again.len() <= best.len() {
            (way, best) = (turned, again);
        }
    }
    Part::Ring(way, best)
}

/// Once around a closed line.
fn lap(promise: Promise, sites: &[PxPoint], smooth: &[PxPoint]) -> CubicFitter {
    let around = |places: &[PxPoint]| places.iter().chain(places.first()).copied().collect();
    let directions = directions(sites, true);
    CubicFitter { fit: Fit { promise, sites: around(sites) }, smooth: around(smooth), directions }
}

/// The joints of a lap, moved.
fn improved_ring(way: CubicFitter, mut joints: Vec<Joint>) -> Vec<Joint> {
    way.improve(&mut joints);
    // The seam could not move: turn the ring by half and move it too.
    let half = joints.len() / 2;
    let Some(seam) = joints.get(half).map(|joint| joint.site).filter(|_| joints.len() > 3) else {
        return joints;
    };
    let CubicFitter { fit: Fit { promise, mut sites }, mut smooth, .. } = way;
    sites.pop();
    smooth.pop();
    let count = sites.len();
    joints.pop();
    joints.iter_mut().for_each(|joint| joint.site = (joint.site + count - seam) % count.max(1));
    joints.rotate_left(half);
    let Some(first) = joints.first().copied() else { return joints };
    joints.push(Joint { site: count, handles: None, ..first });
    sites.rotate_left(seam.min(count));
    smooth.rotate_left(seam.min(count));
    lap(promise, &sites, &smooth).improve(&mut joints);
    joints
}

/// The direction of the line at each site: the slope of the straight line with the least squared distances,
/// and so of the parabola too. None at the ends of an open line, where anything will do; a closed one has its
/// first site once more.
fn directions(sites: &[PxPoint], closed: bool) -> Vec<Option<PxVec>> {
    let count = sites.len();
    let direction = |index: usize| {
        let most = if closed { (count - 1) / 2 } else { index.min(count - 1 - index) };
        let mut way = PxVec::default();
        for step in 1..=DIRECTION_SITES.min(most) {
            let after = sites.get((index + step) % count)?;
            let before = sites.get((index + count - step) % count)?;
            way += (*after - *before) * number(step);
        }
        way.normalized()
    };
    let last = if closed { count } else { count.saturating_sub(1) };
    (0..=last).map(|index| direction(index % count)).collect()
}

/// What a segment is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Line,
    /// A line from which a curve can go on.
    SmoothLine,
    Cubic,
}

/// The sites of a line without corners, and where joints near them are tried.
#[derive(Debug)]
struct CubicFitter {
    fit: Fit,
    /// The sites, smoothed; the first and the last one as they are.
    smooth: Vec<PxPoint>,
    /// The direction in which the line goes at each site; none at the ends of an open one.
    directions: Vec<Option<PxVec>>,
}

impl CubicFitter {
    fn last(&self) -> usize {
        self.fit.sites.len().saturating_sub(1)
    }

    /// The joint near a site.
    fn joint(&self, site: usize) -> Option<Joint> {
        let at = *self.smooth.get(site)?;
        Some(Joint { at, site, direction: self.directions.get(site).copied().flatten(), handles: None })
    }

    /// From each joint the segment that goes farthest.
    fn joints(&mut self) -> Vec<Joint> {
        let mut joints: Vec<Joint> = self.joint(0).into_iter().collect();
        while let Some(from) = joints.last().copied().filter(|from| from.site < self.last()) {
            let (mut to, handles) = self.next(&mut joints, &from);
            if let Some(from) = joints.last_mut() {
                from.handles = handles;
                let ahead = unit(from.at, to.at);
                if handles.is_none() && to.site < self.last() && ahead != PxVec::default() {
                    to.direction = Some(ahead);
                }
            }
            // One site farther at least.
            joints.push(to);
        }
        joints
    }

    /// The segment that goes on from the last joint.
    fn next(&mut self, joints: &mut [Joint], from: &Joint) -> (Joint, Option<[PxPoint; 2]>) {
        let line = self.farthest(from, Kind::Line);
        if line.0.site == self.last() && self.turn(joints, &line.0) {
            return line;
        }
        let cubic = self.farthest(from, Kind::Cubic);
        let reach = |segment: &(Joint, _)| number(segment.0.site - from.site);
        if cubic.1.is_some() && reach(&cubic) > PAYS * reach(&line) {
            return cubic;
        }
        let smooth = self.farthest(from, Kind::SmoothLine);
        if reach(&smooth) > STRAIGHT * reach(&line) && self.turn(joints, &smooth.0) {
            return smooth;
        }
        if cubic.1.is_some() && reach(&cubic) >= reach(&line) { cubic } else { line }
    }

    /// Turns the last joint so that a line can go on from there in its own direction; whether the curve
    /// before it still does, and there is no bend.
    fn turn(&mut self, joints: &mut [Joint], to: &Joint) -> bool {
        let Some(from) = joints.last().copied() else { return true };
        let direction = Some(unit(from.at, to.at)).filter(|way| *way != PxVec::default());
        let turned = Joint { direction, ..from };
        if from.site == 0 {
            // The seam of a ring is its end too.
            if from.direction.is_some() {
                for seam in [0, self.last()] {
                    self.directions.get_mut(seam).into_iter().for_each(|slot| *slot = direction);
                }
            }
            joints
                .last_mut()
                .into_iter()
                .filter(|_| from.direction.is_some())
                .for_each(|slot| *slot = turned);
            return true;
        }
        match joints {
            [.., before, last] if before.handles.is_some() => {
                let Some((handles, _)) = self.fit.cubic(before, &turned) else { return false };
                before.handles = Some(handles);
                *last = turned;
                true
            }
            _ => true,
        }
    }

    /// The farthest joint that one segment of a kind reaches, as found by doubling and halving, and its
    /// handles. The next site is always reached by a straight line.
    fn farthest(&self, from: &Joint, kind: Kind) -> (Joint, Option<[PxPoint; 2]>) {
        let next = self.joint(from.site + 1).unwrap_or(*from);
        let best = (Joint { site: from.site + 1, ..next }, None);
        farthest(best, self.last() - from.site, |reach| self.reaches(from, from.site + reach, kind))
    }

    /// A segment that ends near a site.
    fn reaches(&self, from: &Joint, site: usize, kind: Kind) -> Option<(Joint, Option<[PxPoint; 2]>)> {
        let to = self.joint(site)?;
        match kind {
            Kind::SmoothLine if !self.is_smooth(from, &to) => None,
            Kind::Line | Kind::SmoothLine => self.fit.line(from, &to).map(|_| (to, None)),
            Kind::Cubic => self.fit.cubic(from, &to).map(|(handles, _)| (to, Some(handles))),
        }
    }

    /// Whether the line between two joints goes as the sites do where it ends.
    fn is_smooth(&self, from: &Joint, to: &Joint) -> bool {
        let ahead = unit(from.at, to.at);
        let along = |joint: &Joint| {
            joint.direction.is_none_or(|way| way.cross(ahead).abs() <= SMOOTH && way.dot(ahead) > 0.0)
        };
        along(from) && along(to)
    }

    /// Moves the inner joints to where the sum of the squared distances is less, each by itself, some times
    /// over.
    fn improve(&self, joints: &mut [Joint]) {
        let mut moved = vec![true; joints.len()];
        for sweep in 0..SWEEPS {
            let mut any = false;
            for step in 1..joints.len().saturating_sub(1) {
                let index = if sweep % 2 == 0 { step } else { joints.len() - 1 - step };
                let stirred = moved.get(index - 1..index + 2).unwrap_or(&[]).contains(&true);
                let better = match joints.get(index - 1..index + 2) {
                    Some([before, joint, after]) if stirred => self.better(before, joint, after),
                    _ => None,
                };
                any |= better.is_some();
                moved.get_mut(index).into_iter().for_each(|slot| *slot = better.is_some());
                if let (Some((handles, better)), Some([before, joint])) =
                    (better, joints.get_mut(index - 1..=index))
                {
                    (before.handles, *joint) = (handles, better);
                }
            }
            if !any {
                break;
            }
        }
    }

    /// A better joint between two: the handles of the segment before, and the joint with those of the segment
    /// after.
    fn better(&self, before: &Joint, joint: &Joint, after: &Joint) -> Option<(Option<[PxPoint; 2]>, Joint)> {
        // Along a line beside it a joint may move, but not away from it: that would turn the line at its
        // other end.
        let rail = match (before.handles, joint.handles) {
            (None, None) => return None,
            (None, Some(_)) => Some(unit(before.at, joint.at)),
            (Some(_), None) => Some(unit(joint.at, after.at)),
            (Some(_), Some(_)) => None,
        };
        let judge = |place: Joint| -> Option<(f64, Option<[PxPoint; 2]>, Joint)> {
            let site = self.fit.sites.get(place.site)?;
            let own = *site - place.at;
            let (one, one_squares) = self.fit.segment(before, &place, before.handles.is_some())?;
            let (other, other_squares) = self.fit.segment(&place, after, joint.handles.is_some())?;
            let place = Joint { handles: other, ..place };
            Some((one_squares + other_squares + own.length_squared(), one, place))
        };
        let mut best = judge(*joint)?;
        let start = best.0;
        let attempt = |best: &mut (f64, Option<[PxPoint; 2]>, Joint), place: Option<Joint>| {
            let judged = place.filter(|place| self.fit.is_joint(place)).and_then(judge);
            if let Some(judged) = judged.filter(|judged| judged.0 < best.0) {
                *best = judged;
            }
        };
        for shift in SHIFTS {
            for forward in [false, true] {
                let from = best.2.site;
                let site = if forward { from + shift } else { from.saturating_sub(shift) };
                if site > before.site && site < after.site {
                    let place = self.joint(site).map(|place| match rail {
                        Some(rail) => {
                            let away = rail.dot(place.at - joint.at);
                            Joint { at: joint.at + rail * away, direction: joint.direction, ..place }
                        }
                        None => place,
                    });
                    attempt(&mut best, place);
                }
            }
        }
        if rail.is_none() {
            for (nudge, turn) in NUDGES.into_iter().zip(TURNS) {
                for side in [1.0, -1.0] {
                    let Some(direction) = best.2.direction else { continue };
                    let off = side * nudge * self.fit.promise.radius_px;
                    let place = Joint { at: best.2.at + direction.perpendicular() * off, ..best.2 };
                    attempt(&mut best, Some(place));
                    let direction = best.2.direction.map(|direction| direction.rotated(side * turn));
                    let place = Joint { direction, ..best.2 };
                    attempt(&mut best, Some(place));
                }
            }
        }
        let (least, handles, place) = best;
        // Less by a hundredth at least: it is to end.
        (least < 0.99 * start && least.is_finite()).then_some((handles, place))
    }
}
