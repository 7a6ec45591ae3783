//! [`corners_seated`], [`ends_seated`]: corners, and the ends of lines, go to where a window shows them in its middle.
//!
//! They come into the map when they come into view, at a window's border, where light and lens are worst: a corner may be rounded there,
//! or both corners of a square turn lie a pixel beside their place. Elsewhere a line is cut across each time it is seen; near a corner
//! there is nothing to cut. Nor is there beyond a line's end: what came into the map from a place that was not well known along the line
//! would be followed to its end.

use super::corners::CORNER_COS;
use super::line_map::{LineMap, Link, State};
use super::lines::{Piece, cosine};
use super::paper::nearest;
use crate::PxPoint;

/// What is seen as near to the middle of a window is seen well, px.
const MIDDLE_PX: f64 = 50.0;

/// A corner farther from its place is another one, px.
const CORNER_PX: f64 = 2.5;

/// The neighbours of a corner's place lie so near to the lines that meet in it, and at least as far along them, px.
const BESIDE_PX: f64 = 1.5;
const ALONG_PX: f64 = 0.2;

/// An end in the map that is farther beyond the end that a window shows is another one, px; one that is nearer than the other bound is that end, as well as ends are seen.
const BEYOND_PX: f64 = 4.0;
const LEAST_BEYOND_PX: f64 = 1.0;

/// Nodes of a line beside a corner whose direction its bend hides.
const HIDDEN: usize = 4;

/// And in a tip, whose arms are one ink farther from it.
const TIP_HIDDEN: usize = 8;

/// A node that is as near to its arm of a tip, and nearer to it than to the other one by as much, is one that was seen well, px.
const ON_ARM_PX: f64 = 0.5;
const OTHER_ARM_PX: f64 = 2.0;

/// Tips are sharper: cosine of 60 degrees between their arms. There it is not the nearest line that a place is on.
const TIP_COS: f64 = 0.5;

const fn is_line(link: &Link) -> bool {
    !link.contact && !matches!(link.state, State::Ghost)
}

/// Moves the corners of lines that are not followed yet, as a window at `camera` shows them; all places are on the paper.
pub(super) fn corners_seated(map: &mut LineMap, pieces: &[Piece], camera: PxPoint) {
    for piece in pieces {
        for (i, three) in piece.places.windows(3).enumerate() {
            let &[before, at, behind] = three else { continue };
            let turns = cosine(at.minus(before), behind.minus(at)) < CORNER_COS;
            if !turns || at.distance(camera) > MIDDLE_PX {
                continue;
            }
            let near = map.near(at, CORNER_PX).into_iter();
            let fits = near.filter_map(|id| Some((id, arms(map, id, at, [before, behind])?)));
            let distance = |id: u32| map.at(id).distance(at);
            let Some((id, others)) = fits.min_by(|a, b| distance(a.0).total_cmp(&distance(b.0))) else {
                continue;
            };
            map.shift(id, at);
            let corner = i + 1;
            let is_tip = cosine(before.minus(at), behind.minus(at)) > TIP_COS;
            let most = if is_tip { TIP_HIDDEN } else { HIDDEN } + 2;
            let back: Vec<PxPoint> = piece.places.iter().take(corner + 1).rev().take(most).copied().collect();
            let on: Vec<PxPoint> = piece.places.iter().skip(corner).take(most).copied().collect();
            if is_tip {
                seat_tip(map, id, others, [&back, &on]);
            } else {
                seat_arm(map, id, others[0], &back);
                seat_arm(map, id, others[1], &on);
            }
        }
    }
}

/// Both neighbours of a node if the lines that meet in a corner go over them, that to `ways[0]` first.
fn arms(map: &LineMap, id: u32, corner: PxPoint, ways: [PxPoint; 2]) -> Option<[u32; 2]> {
    let [one, other] = neighbours(map, id)?;
    let is_on = |id: u32, to: PxPoint| {
        let ((x, y), (dx, dy)) = (map.at(id).minus(corner), to.minus(corner));
        let length = libm::hypot(dx, dy).max(1e-9);
        let (along, across) = ((x * dx + y * dy) / length, (x * dy - y * dx) / length);
        along > ALONG_PX && across.abs() < BESIDE_PX
    };
    let fits = |a: u32, b: u32| is_on(a, ways[0]) && is_on(b, ways[1]);
    if fits(one, other) { Some([one, other]) } else { fits(other, one).then_some([other, one]) }
}

/// The two nodes beside one on a line that is not followed yet. Two lines whose ends touch are one: so a corner may come into the map.
fn neighbours(map: &LineMap, id: u32) -> Option<[u32; 2]> {
    let joins_ends = |link: &Link| link.contact && link.ends.iter().all(|end| map.arms(*end) == 1);
    let mut links = map.links_of(id).filter(|(_, link, _)| is_line(link) || joins_ends(link));
    let (one, other) = (links.next()?, links.next()?);
    let are_ahead = [one, other].iter().all(|(_, link, _)| link.state == State::Ahead);
    (are_ahead && links.next().is_none()).then_some([one.2, other.2])
}

/// Puts the nodes behind a corner's, from `next` on, on the line that a window shows there, from the corner on.
fn seat_arm(map: &mut LineMap, corner: u32, next: u32, places: &[PxPoint]) {
    let (mut before, mut id) = (corner, next);
    for _ in 0..HIDDEN {
        let Some(beside) = neighbours(map, id) else { return };
        let at = map.at(id);
        let Some(to) = foot(at, places).filter(|to| to.distance(at) <= CORNER_PX) else { return };
        map.shift(id, to);
        let next = if beside[0] == before { beside[1] } else { beside[0] };
        (before, id) = (id, next);
    }
}

/// The place of a polyline that is nearest to one.
fn foot(at: PxPoint, places: &[PxPoint]) -> Option<PxPoint> {
    let feet = places.windows(2).filter_map(|pair| {
        let &[a, b] = pair else { return None };
        Some(nearest(at, a, b))
    });
    feet.min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)))
}

/// Puts the nodes beside a tip on its arms, as far as the first one of each arm that was seen well: between these and the tip they are spread
/// evenly, for the arms' ink is one there, and the nearest place may be on the other one.
fn seat_tip(map: &mut LineMap, tip: u32, beside: [u32; 2], arms: [&[PxPoint]; 2]) {
    let [one, other] = beside;
    for nodes in [[one, other], [other, one]] {
        let runs = [run_to_arm(map, tip, nodes[0], arms), run_to_arm(map, tip, nodes[1], [arms[1], arms[0]])];
        let [Some(back), Some(on)] = runs else { continue };
        for (run, to) in [back, on] {
            let from = map.at(tip);
            let parts = super::lines::count_f64(run.len() + 1);
            for (i, id) in run.into_iter().enumerate() {
                map.shift(id, from.along(to.minus(from), super::lines::count_f64(i + 1) / parts));
            }
        }
        return;
    }
}

/// The nodes from a tip on, by way of `next`, before the first one that is clearly on the first one of two arms, and that one's place on it;
/// none if there is no such node, or if the arm is not straight until there.
fn run_to_arm(
    map: &LineMap,
    tip: u32,
    next: u32,
    [own, other]: [&[PxPoint]; 2],
) -> Option<(Vec<u32>, PxPoint)> {
    let (mut before, mut id) = (tip, next);
    let mut run = Vec::new();
    for _ in 0..TIP_HIDDEN {
        let at = map.at(id);
        let (own_foot, other_foot) = (foot(at, own)?, foot(at, other)?);
        let off_px = own_foot.distance(at);
        if off_px < ON_ARM_PX && other_foot.distance(at) > off_px + OTHER_ARM_PX {
            let way_px = own_foot.distance(map.at(tip));
            let mut until = own.iter().take_while(|place| place.distance(map.at(tip)) < way_px);
            let is_straight =
                until.all(|place| nearest(*place, map.at(tip), own_foot).distance(*place) < ON_ARM_PX);
            return is_straight.then_some((run, own_foot));
        }
        let beside = neighbours(map, id)?;
        run.push(id);
        let next = if beside[0] == before { beside[1] } else { beside[0] };
        (before, id) = (id, next);
    }
    None
}

/// Takes back the ends of lines that are not followed yet to where a window at `camera` shows that they end; all places are on the paper.
pub(super) fn ends_seated(map: &mut LineMap, pieces: &[Piece], camera: PxPoint, width_px: f64) {
    for (i, piece) in pieces.iter().enumerate().filter(|(_, piece)| !piece.closed) {
        // The direction of the end is that of its last places.
        let from_first = [piece.places.first(), piece.places.get(HIDDEN)];
        let last = piece.places.len().checked_sub(HIDDEN + 1);
        let from_last = [piece.places.last(), last.and_then(|last| piece.places.get(last))];
        for (ends, open) in [from_first, from_last].into_iter().zip(piece.open) {
            let [Some(end), Some(inside)] = ends else { continue };
            let mut others = pieces.iter().enumerate().filter(|(other, _)| *other != i);
            let is_free = others.all(|(_, other)| other.places.iter().all(|at| at.distance(*end) > width_px));
            if !open && is_free && end.distance(camera) <= MIDDLE_PX {
                seat_end(map, *end, end.minus(*inside));
            }
        }
    }
}

/// Puts what is beyond a line's end at its end; the line comes to it in the direction `way`.
fn seat_end(map: &mut LineMap, end: PxPoint, way: (f64, f64)) {
    let length = libm::hypot(way.0, way.1).max(1e-9);
    let beyond = |at: PxPoint| {
        let (x, y) = at.minus(end);
        let (along, across) = ((x * way.0 + y * way.1) / length, (x * way.1 - y * way.0) / length);
        if across.abs() < BESIDE_PX { along } else { 0.0 }
    };
    let is_end = |id: &u32| {
        let mut links = map.links_of(*id);
        let is_ahead = links.next().is_some_and(|(_, link, _)| is_line(link) && link.state == State::Ahead);
        is_ahead && links.next().is_none() && map.node(*id).is_some_and(|node| !node.open)
    };
    let far = |id: &u32| beyond(map.at(*id));
    let near = map.near(end, BEYOND_PX).into_iter().filter(is_end).filter(|id| far(id) > LEAST_BEYOND_PX);
    let mut next = near.max_by(|a, b| far(a).total_cmp(&far(b)));
    let mut before = None;
    for _ in 0..HIDDEN {
        let Some(id) = next.filter(|id| beyond(map.at(*id)) > 0.0) else { return };
        map.shift(id, end);
        let mut links = map.links_of(id).filter(|(_, _, other)| Some(*other) != before);
        next = links.next().filter(|(_, link, _)| link.state == State::Ahead).map(|found| found.2);
        if links.next().is_some() {
            return;
        }
        before = Some(id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(places: &[(f64, f64)], open: [bool; 2]) -> Piece {
        Piece { places: places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect(), closed: false, open }
    }

    #[test]
    fn a_corner_of_two_lines_whose_ends_touch_goes_to_its_place() {
        // The corner is at (50, 50). From a window's rim it came into the map rounded, as the ends of two lines.
        let down: Vec<(f64, f64)> = (0..12).map(|i| (50.0, 54.0 + 2.0 * f64::from(i))).collect();
        let mut right = vec![(50.3, 51.9), (52.2, 51.4), (54.2, 50.4)];
        right.extend((0..12).map(|i| (56.2 + 2.0 * f64::from(i), 50.0)));
        let mut map = LineMap::default();
        map.insert(&[piece(&down, [false, true]), piece(&right, [false, true])], 5.0, &|_| true);
        let seen: Vec<(f64, f64)> = (0..10)
            .map(|i| (50.0, 70.0 - 2.0 * f64::from(i)))
            .chain((0..10).map(|i| (50.0 + 2.0 * f64::from(i), 50.0)))
            .collect();
        corners_seated(&mut map, &[piece(&seen, [true, true])], PxPoint::new(60.0, 60.0));
        let off = |at: PxPoint| {
            let beside = f64::min((at.x - 50.0).abs(), (at.y - 50.0).abs());
            beside.max(50.0 - at.x).max(50.0 - at.y)
        };
        assert!(map.nodes.iter().all(|node| off(node.at) < 0.05), "{:?}", map.nodes);
        assert!(map.nodes.iter().any(|node| node.at.distance(PxPoint::new(50.0, 50.0)) < 0.05));
    }

    #[test]
    fn what_is_beyond_a_line_s_end_goes_to_its_end() {
        // The end is at y = 50; the map has it 2.3 px beyond. The other line's end is as far beside as in hatching.
        let line = |x: f64, from: f64| -> Vec<(f64, f64)> {
            (0..12).map(|i| (x, from + 2.0 * f64::from(i))).collect()
        };
        let mut map = LineMap::default();
        let known = [piece(&line(50.0, 47.7), [false, true]), piece(&line(58.0, 48.0), [false, true])];
        map.insert(&known, 4.0, &|_| true);
        let seen = piece(&line(50.2, 50.0), [false, true]);
        // Far from the window's middle it is not seen well, and an open end is the window's.
        ends_seated(&mut map, std::slice::from_ref(&seen), PxPoint::new(50.0, 120.0), 4.0);
        let open = piece(&line(50.2, 50.0), [true, true]);
        ends_seated(&mut map, &[open], PxPoint::new(60.0, 60.0), 4.0);
        let highest = |map: &LineMap, x: f64| {
            let on = map.nodes.iter().filter(|node| (node.at.x - x).abs() < 1.0);
            on.map(|node| node.at.y).fold(f64::INFINITY, f64::min)
        };
        assert_eq!((highest(&map, 50.0), highest(&map, 58.0)), (47.7, 48.0));
        ends_seated(&mut map, &[seen], PxPoint::new(60.0, 60.0), 4.0);
        assert_eq!((highest(&map, 50.0), highest(&map, 58.0)), (50.0, 48.0));
    }

    #[test]
    fn an_arm_that_bulges_to_the_other_one_is_straight_to_the_tip() {
        // A tip at (50, 50) of arms to (46, 90) and (66, 90); in the map the second one comes over to the first one before it.
        let arm = |x: f64, from: i32| -> Vec<(f64, f64)> {
            (from..20).map(f64::from).map(|i| (50.0 + x * i, 50.0 + 2.0 * i)).collect()
        };
        let (mut seen, right) = (arm(-0.2, 0), arm(0.8, 1));
        seen.reverse();
        let left = seen.len();
        let mut known = seen.clone();
        seen.extend(&right);
        known.extend([(50.4, 52.0), (50.5, 54.0), (50.6, 56.0), (51.9, 57.5)]);
        known.extend(right.iter().skip(4));
        let mut map = LineMap::default();
        map.insert(&[piece(&known, [true, true])], 4.0, &|_| true);
        let seen = piece(&seen, [true, true]);
        let off = |map: &LineMap| {
            let lengths = map.nodes.iter().map(|node| foot(node.at, &seen.places).unwrap().distance(node.at));
            lengths.fold(0.0, f64::max)
        };
        assert!(off(&map) > 1.0 && left == 20, "{}", off(&map));
        corners_seated(&mut map, std::slice::from_ref(&seen), PxPoint::new(55.0, 70.0));
        assert!(off(&map) < 0.05, "{} {:?}", off(&map), map.nodes);
        assert!(map.nodes.iter().any(|node| node.at.distance(PxPoint::new(50.0, 50.0)) < 0.05));
    }
}
