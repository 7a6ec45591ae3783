//! [`corners_seated`]: corners, and the ends of the lines that meet in them, go to where a window shows them in its middle.
//!
//! They come into the map when they come into view, at a window's border, where light and lens are worst: a corner may be rounded there,
//! or both corners of a square turn lie a pixel beside their place. Elsewhere a line is cut across each time it is seen; near a corner
//! there is nothing to cut.

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
const ALONG_PX: f64 = 0.5;

/// Nodes of a line beside a corner whose direction its bend hides.
const HIDDEN: usize = 4;

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
            if cosine(before.minus(at), behind.minus(at)) > TIP_COS {
                continue;
            }
            let corner = i + 1;
            let back: Vec<PxPoint> =
                piece.places.iter().take(corner + 1).rev().take(HIDDEN + 2).copied().collect();
            let on: Vec<PxPoint> = piece.places.iter().skip(corner).take(HIDDEN + 2).copied().collect();
            seat_arm(map, id, others[0], &back);
            seat_arm(map, id, others[1], &on);
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
        let feet = places.windows(2).filter_map(|pair| {
            let &[a, b] = pair else { return None };
            Some(nearest(at, a, b))
        });
        let Some(foot) = feet.min_by(|a, b| a.distance(at).total_cmp(&b.distance(at))) else { return };
        if foot.distance(at) > CORNER_PX {
            return;
        }
        map.shift(id, foot);
        let next = if beside[0] == before { beside[1] } else { beside[0] };
        (before, id) = (id, next);
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
}
