//! [`Seats`]: corners, and the ends of lines, go to where windows show them in their middle.
//!
//! They come into the map when they come into view, at a window's border, where light and lens are worst: a corner may be rounded there,
//! or both corners of a square turn lie a pixel beside their place. Elsewhere a line is cut across each time it is seen; near a corner
//! there is nothing to cut. Nor is there beyond a line's end: what came into the map from a place that was not well known along the line
//! would be followed to its end.
//!
//! Now and then a single window of fifty shows a square turn rounded or a line that ends 3 px before its end, in its very middle; so what
//! is elsewhere goes there only when a second window shows it there, too.

use super::corners::CORNER_COS;
use super::line_map::{LineMap, Link, State};
use super::lines::{Piece, cosine};
use super::paper::nearest;
use crate::stroke::{PxPoint, PxVec};
use std::collections::HashMap;

/// What goes farther must be seen twice, as near to the first time, px.
const ELSEWHERE_PX: f64 = 0.4;

/// Along their line ends are not seen better than this, px.
const END_PX: f64 = 1.0;

/// Most nodes of which it is kept where they were seen once.
const MOST_ONCE: usize = 4096;

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

/// Where nodes should go.
type Moves = Vec<(u32, PxPoint)>;

/// Seats corners and ends.
#[derive(Clone, Debug, Default)]
pub(super) struct Seats {
    /// Where windows have shown nodes elsewhere, once.
    once: HashMap<u32, PxPoint>,
}

impl Seats {
    /// Moves the corners and the ends of lines that are not followed yet, as a window at `camera` shows them; all places are on the
    /// paper. Gives whether something is elsewhere that a second window has to show.
    pub(super) fn seat(
        &mut self,
        map: &mut LineMap,
        pieces: &[Piece],
        camera: PxPoint,
        width_px: f64,
    ) -> bool {
        let mut in_doubt = false;
        for piece in pieces {
            for i in 1..piece.places.len().saturating_sub(1) {
                let moves = corner_moves(map, piece, i, camera);
                in_doubt |= !self.go(map, &moves, ELSEWHERE_PX);
            }
        }
        for moves in end_moves(map, pieces, camera, width_px) {
            in_doubt |= !self.go(map, &moves, END_PX);
        }
        in_doubt
    }

    /// Forgets where nodes were seen once: all are elsewhere.
    pub(super) fn forget(&mut self) {
        self.once.clear();
    }

    /// Makes the moves if they are small or seen for the second time; whether it did.
    fn go(&mut self, map: &mut LineMap, moves: &[(u32, PxPoint)], alike_px: f64) -> bool {
        let is_seen = |(id, to): &(u32, PxPoint)| {
            let is_there = |at: PxPoint| at.distance(*to) < alike_px;
            is_there(map.at(*id)) || self.once.get(id).copied().is_some_and(is_there)
        };
        let are_seen = moves.iter().all(is_seen);
        if self.once.len() > MOST_ONCE {
            self.once.clear();
        }
        for (i, (id, to)) in moves.iter().enumerate() {
            if are_seen {
                map.shift(*id, *to);
                // The next corner's arm goes over this one's nodes, too: what it tells of them takes back nothing of this one.
                if i == 0 || self.once.get(id).is_some_and(|at| at.distance(*to) < alike_px) {
                    self.once.remove(id);
                }
            } else {
                self.once.insert(*id, *to);
            }
        }
        are_seen
    }
}

/// Where a corner's node and those beside it should go, if the place `i` of a piece is a corner that the map has.
fn corner_moves(map: &LineMap, piece: &Piece, i: usize, camera: PxPoint) -> Moves {
    let Some(&[before, at, behind]) = piece.places.get(i - 1..i + 2) else { return Moves::new() };
    if !turns([before, at, behind]) || at.distance(camera) > MIDDLE_PX {
        return Moves::new();
    }
    let near = map.near(at, CORNER_PX).into_iter();
    let fits = near.filter_map(|id| Some((id, arms(map, id, at, [before, behind])?)));
    let distance = |id: u32| map.at(id).distance(at);
    let Some((id, others)) = fits.min_by(|a, b| distance(a.0).total_cmp(&distance(b.0))) else {
        return Moves::new();
    };
    let is_tip = cosine(before - at, behind - at) > TIP_COS;
    let most = if is_tip { TIP_HIDDEN + 2 } else { HIDDEN + 4 };
    let back: Vec<PxPoint> = piece.places.iter().take(i + 1).rev().take(most).copied().collect();
    let on: Vec<PxPoint> = piece.places.iter().skip(i).take(most).copied().collect();
    let mut moves = vec![(id, at)];
    if is_tip {
        moves.extend(tip_moves(map, (id, at), others, [&back, &on]));
    } else {
        moves.extend(arm_moves(map, id, others[0], &back));
        moves.extend(arm_moves(map, id, others[1], &on));
    }
    moves
}

/// Whether a line has a corner in the middle one of three places.
fn turns([before, at, behind]: [PxPoint; 3]) -> bool {
    cosine(at - before, behind - at) < CORNER_COS
}

/// Both neighbours of a node if the lines that meet in a corner go over them, that to `ways[0]` first.
fn arms(map: &LineMap, id: u32, corner: PxPoint, ways: [PxPoint; 2]) -> Option<[u32; 2]> {
    let [one, other] = neighbours(map, id)?;
    let is_on = |id: u32, to: PxPoint| {
        let (PxVec { x, y }, PxVec { x: dx, y: dy }) = (map.at(id) - corner, to - corner);
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

/// Where the nodes behind a corner's, from `next` on, are on the line that a window shows there, from the corner on; one of them is at each of
/// that line's corners.
fn arm_moves(map: &LineMap, corner: u32, next: u32, places: &[PxPoint]) -> Moves {
    let (mut before, mut id) = (corner, next);
    let (mut moves, mut ways) = (Moves::new(), Vec::new());
    for _ in 0..HIDDEN {
        let Some(beside) = neighbours(map, id) else { break };
        let Some(to) = foot(map.at(id), places) else { break };
        moves.push((id, to));
        ways.push(way_px(places, to));
        let next = if beside[0] == before { beside[1] } else { beside[0] };
        (before, id) = (id, next);
    }
    // What lies between nodes of the line is of it, too.
    let is_on = |(id, to): &(u32, PxPoint)| map.at(*id).distance(*to) <= CORNER_PX;
    let count = moves.iter().rposition(is_on).map_or(0, |last| last + 1);
    moves.truncate(count);
    ways.truncate(count);
    // Where the map goes straight over a corner there is no node that is near to it.
    for three in places.windows(3) {
        let &[a, corner, b] = three else { continue };
        let way = way_px(places, corner);
        let off = |i: &usize| ways.get(*i).map_or(f64::INFINITY, |other| (other - way).abs());
        let nearest = (0..ways.len()).min_by(|i, j| off(i).total_cmp(&off(j)));
        if turns([a, corner, b])
            && ways.last().is_some_and(|last| *last >= way)
            && let Some((_, to)) = nearest.and_then(|i| moves.get_mut(i))
        {
            *to = corner;
        }
    }
    moves
}

/// How far along a polyline one of its places is, px.
fn way_px(places: &[PxPoint], at: PxPoint) -> f64 {
    let (mut way, mut best) = (0.0, (f64::INFINITY, 0.0));
    for pair in places.windows(2) {
        let &[a, b] = pair else { continue };
        let foot = nearest(at, a, b);
        if foot.distance(at) < best.0 {
            best = (foot.distance(at), way + a.distance(foot));
        }
        way += a.distance(b);
    }
    best.1
}

/// The place of a polyline that is nearest to one.
fn foot(at: PxPoint, places: &[PxPoint]) -> Option<PxPoint> {
    let feet = places.windows(2).filter_map(|pair| {
        let &[a, b] = pair else { return None };
        Some(nearest(at, a, b))
    });
    feet.min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)))
}

/// Where the nodes beside a tip are on its arms, as far as the first one of each arm that was seen well: between these and the tip they are
/// spread evenly, for the arms' ink is one there, and the nearest place may be on the other one.
fn tip_moves(map: &LineMap, tip: (u32, PxPoint), beside: [u32; 2], arms: [&[PxPoint]; 2]) -> Moves {
    let [one, other] = beside;
    for nodes in [[one, other], [other, one]] {
        let runs = [run_to_arm(map, tip, nodes[0], arms), run_to_arm(map, tip, nodes[1], [arms[1], arms[0]])];
        let [Some(back), Some(on)] = runs else { continue };
        let spread = |(run, to): (Vec<u32>, PxPoint)| {
            let parts = super::lines::count_f64(run.len() + 1);
            let place = move |i: usize| tip.1 + (to - tip.1) * (super::lines::count_f64(i + 1) / parts);
            run.into_iter().enumerate().map(move |(i, id)| (id, place(i)))
        };
        return spread(back).chain(spread(on)).collect();
    }
    Moves::new()
}

/// The nodes from a tip on, by way of `next`, before the first one that is clearly on the first one of two arms, and that one's place on it;
/// none if there is no such node, or if the arm is not straight until there.
fn run_to_arm(
    map: &LineMap,
    (tip, tip_at): (u32, PxPoint),
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
            let way_px = own_foot.distance(tip_at);
            let mut until = own.iter().take_while(|place| place.distance(tip_at) < way_px);
            let is_straight =
                until.all(|place| nearest(*place, tip_at, own_foot).distance(*place) < ON_ARM_PX);
            return is_straight.then_some((run, own_foot));
        }
        let beside = neighbours(map, id)?;
        run.push(id);
        let next = if beside[0] == before { beside[1] } else { beside[0] };
        (before, id) = (id, next);
    }
    None
}

/// How the ends of lines that are not followed yet go back to where a window at `camera` shows that they end.
fn end_moves(map: &LineMap, pieces: &[Piece], camera: PxPoint, width_px: f64) -> Vec<Moves> {
    let mut all = Vec::new();
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
                all.push(beyond_end(map, *end, *end - *inside));
            }
        }
    }
    all
}

/// What is beyond a line's end goes to its end; the line comes to it in the direction `way`.
fn beyond_end(map: &LineMap, end: PxPoint, way: PxVec) -> Moves {
    let length = way.length().max(1e-9);
    let beyond = |at: PxPoint| {
        let away = at - end;
        let (along, across) = (away.dot(way) / length, away.cross(way) / length);
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
    let (mut moves, mut before) = (Moves::new(), None);
    for _ in 0..HIDDEN {
        let Some(id) = next.filter(|id| beyond(map.at(*id)) > 0.0) else { break };
        moves.push((id, end));
        let mut links = map.links_of(id).filter(|(_, _, other)| Some(*other) != before);
        next = links.next().filter(|(_, link, _)| link.state == State::Ahead).map(|found| found.2);
        if links.next().is_some() {
            break;
        }
        before = Some(id);
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(places: &[(f64, f64)], open: [bool; 2]) -> Piece {
        Piece { places: places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect(), closed: false, open }
    }

    /// Two windows that show the same; whether both said so.
    fn seat_twice(map: &mut LineMap, pieces: &[Piece], camera: PxPoint) -> [bool; 2] {
        let mut seats = Seats::default();
        [0; 2].map(|_| seats.seat(map, pieces, camera, 4.0))
    }

    /// A line along y = 50 up to x = 90, down to y = 58, and back.
    fn square_turn() -> Vec<(f64, f64)> {
        let mut turn: Vec<(f64, f64)> = (0..20).map(|i| (50.0 + 2.0 * f64::from(i), 50.0)).collect();
        turn.extend((0..4).map(|i| (90.0, 50.0 + 2.0 * f64::from(i))));
        turn.extend((0..20).map(|i| (90.0 - 2.0 * f64::from(i), 58.0)));
        turn
    }

    #[test]
    fn what_a_single_window_shows_elsewhere_is_not_believed() {
        let mut map = LineMap::default();
        map.insert(&[piece(&square_turn(), [true, true])], 4.0, &|_| true);
        let known: Vec<PxPoint> = map.nodes.iter().map(|node| node.at).collect();
        let mut rounded: Vec<(f64, f64)> = (0..18).map(|i| (50.0 + 2.0 * f64::from(i), 50.0)).collect();
        rounded.extend([(86.4, 50.0), (88.1, 51.1), (89.7, 52.2), (90.0, 54.0), (90.2, 55.6), (89.6, 56.8)]);
        rounded.extend((0..20).map(|i| (89.0 - 2.0 * f64::from(i), 57.9)));
        let (rounded, square) = (piece(&rounded, [true, true]), piece(&square_turn(), [true, true]));
        let mut seats = Seats::default();
        let camera = PxPoint::new(82.0, 58.0);
        let doubts: Vec<bool> = [&rounded, &square, &rounded, &square]
            .into_iter()
            .map(|seen| seats.seat(&mut map, std::slice::from_ref(seen), camera, 4.0))
            .collect();
        assert_eq!(doubts, [true, false, true, false]);
        let moved = map.nodes.iter().zip(&known).map(|(node, known)| node.at.distance(*known));
        assert!(moved.fold(0.0, f64::max) < 0.05, "{:?}", map.nodes);
    }

    #[test]
    fn a_square_turn_that_was_cut_short_gets_both_its_corners() {
        // The first window showed one corner, and a straight line from there to the second arm.
        let mut cut: Vec<(f64, f64)> = (0..20).map(|i| (50.0 + 2.0 * f64::from(i), 50.0)).collect();
        cut.extend([(90.3, 49.7), (89.4, 51.3), (88.4, 52.9), (87.4, 54.5), (86.4, 56.1), (85.3, 58.0)]);
        cut.extend((0..15).map(|i| (83.5 - 2.0 * f64::from(i), 58.0)));
        let mut map = LineMap::default();
        map.insert(&[piece(&cut, [true, true])], 4.0, &|_| true);
        let seen = [piece(&square_turn(), [true, true])];
        assert_eq!(seat_twice(&mut map, &seen, PxPoint::new(70.0, 58.0)), [true, false]);
        let off = |at: PxPoint| foot(at, &seen[0].places).unwrap().distance(at);
        let along = |link: &Link, part: f64| {
            let [a, b] = link.ends.map(|end| map.at(end));
            off(a + (b - a) * part)
        };
        let parts = [0.0, 0.25, 0.5, 0.75];
        let most = map.links.iter().flat_map(|link| parts.map(|part| along(link, part))).fold(0.0, f64::max);
        assert!(most < 0.1, "{most} {:?}", map.nodes);
    }

    #[test]
    fn a_corner_is_not_kept_from_its_place_by_the_next_one() {
        // The first corner came into the map rounded; the second one's arm goes on to the node that should be in it.
        let mut rounded: Vec<(f64, f64)> = (0..19).map(|i| (50.0 + 2.0 * f64::from(i), 50.0)).collect();
        rounded.extend([(88.1, 50.9), (89.9, 51.4), (90.0, 53.0), (90.0, 54.6), (90.0, 56.4), (90.0, 58.0)]);
        rounded.extend((1..20).map(|i| (90.0 - 2.0 * f64::from(i), 58.0)));
        let mut map = LineMap::default();
        map.insert(&[piece(&rounded, [true, true])], 4.0, &|_| true);
        let seen = [piece(&square_turn(), [true, true])];
        assert_eq!(seat_twice(&mut map, &seen, PxPoint::new(70.0, 58.0)), [true, false]);
        assert!(map.nodes.iter().any(|node| node.at.distance(PxPoint::new(90.0, 50.0)) < 0.05));
        let off = |at: PxPoint| foot(at, &seen[0].places).unwrap().distance(at);
        assert!(map.nodes.iter().all(|node| off(node.at) < 0.05), "{:?}", map.nodes);
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
        seat_twice(&mut map, &[piece(&seen, [true, true])], PxPoint::new(60.0, 60.0));
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
        seat_twice(&mut map, std::slice::from_ref(&seen), PxPoint::new(50.0, 120.0));
        let open = piece(&line(50.2, 50.0), [true, true]);
        seat_twice(&mut map, &[open], PxPoint::new(60.0, 60.0));
        let highest = |map: &LineMap, x: f64| {
            let on = map.nodes.iter().filter(|node| (node.at.x - x).abs() < 1.0);
            on.map(|node| node.at.y).fold(f64::INFINITY, f64::min)
        };
        assert_eq!((highest(&map, 50.0), highest(&map, 58.0)), (47.7, 48.0));
        seat_twice(&mut map, &[seen], PxPoint::new(60.0, 60.0));
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
        seat_twice(&mut map, std::slice::from_ref(&seen), PxPoint::new(55.0, 70.0));
        assert!(off(&map) < 0.05, "{} {:?}", off(&map), map.nodes);
        assert!(map.nodes.iter().any(|node| node.at.distance(PxPoint::new(50.0, 50.0)) < 0.05));
    }
}
