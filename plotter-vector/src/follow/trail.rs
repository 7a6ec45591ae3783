//! Which way next: every line once, with few lifts.
//!
//! Fleury's rule (1883): of several ways take one that is no bridge, that is from which what is left here can still be reached; of
//! those the one straight on. What no window has shown yet counts as joined to everything.

use super::line_map::{LineMap, Link, State};
use super::lines::{SPACING_PX, cosine};
use super::paper::nearest;
use crate::stroke::{PxPoint, PxVec};
use std::collections::HashSet;

/// Most nodes that are visited to tell a bridge.
const MOST_VISITED: usize = 20_000;

/// Nodes of a line that tell its direction.
const AHEAD: usize = 4;

/// Longer rests are lines, links.
const MOST_DRAWN: usize = 16;

const fn is_ahead(link: &Link) -> bool {
    !link.contact && matches!(link.state, State::Ahead)
}

/// A node, and all that touch it.
fn cluster(map: &LineMap, node: u32) -> Vec<u32> {
    let mut found = vec![node];
    let mut i = 0;
    while let Some(id) = found.get(i).copied() {
        for (_, link, other) in map.links_of(id) {
            if link.contact && !found.contains(&other) && found.len() < 16 {
                found.push(other);
            }
        }
        i += 1;
    }
    found
}

/// The way of a line behind a link, over a few nodes.
fn course(map: &LineMap, from: u32, to: u32) -> PxVec {
    let (mut before, mut at) = (from, to);
    for _ in 1..AHEAD {
        let mut rest = map.links_of(at).filter(|(_, link, other)| !link.contact && *other != before);
        let (Some((_, _, next)), None) = (rest.next(), rest.next()) else { break };
        (before, at) = (at, next);
    }
    map.at(at) - map.at(from)
}

/// Whether the places `here` can be reached again from the other end of a link without it.
fn returns(map: &LineMap, link: u32, from: u32, here: &[u32]) -> bool {
    let mut seen: HashSet<u32> = HashSet::from([from]);
    let mut open = vec![from];
    while let Some(id) = open.pop() {
        let is_unknown = map.node(id).is_some_and(|node| node.open);
        if here.contains(&id) || is_unknown || seen.len() > MOST_VISITED {
            return true;
        }
        for (other_link, found, other) in map.links_of(id) {
            if other_link != link && (found.contact || is_ahead(found)) && seen.insert(other) {
                open.push(other);
            }
        }
    }
    false
}

/// The link to follow from a node, with its near and its far end.
pub(super) fn next(map: &LineMap, node: u32, heading: PxVec) -> Option<(u32, u32, u32)> {
    let here = cluster(map, node);
    let mut ways: Vec<(u32, u32, u32)> = Vec::new();
    for near in &here {
        ways.extend(
            map.links_of(*near)
                .filter(|(_, link, _)| is_ahead(link))
                .map(|(link, _, far)| (link, *near, far)),
        );
    }
    if ways.len() > 1 {
        let free: Vec<_> =
            ways.iter().copied().filter(|(link, _, far)| returns(map, *link, *far, &here)).collect();
        if !free.is_empty() {
            ways = free;
        }
    }
    let straight = |(_, near, far): &(u32, u32, u32)| {
        let way = course(map, *near, *far);
        // Of equal ways that of the line itself.
        cosine(heading, way) + if *near == node { 1e-3 } else { 0.0 }
    };
    ways.into_iter().max_by(|a, b| straight(a).total_cmp(&straight(b)).then(b.0.cmp(&a.0)))
}

/// Takes for followed what the tool has drawn on its way: rests no longer than half a line's width that lie as near to lines that were
/// followed. A tip that was put back to its place behind the tool leaves such ones.
pub(super) fn pass_drawn(map: &mut LineMap, width_px: f64) {
    let half_px = 0.5 * width_px;
    let all: Vec<u32> = map.ahead().collect();
    for from in all {
        // All of a rest, or more links than a rest has: never a part of a line.
        let (mut nodes, mut links) = (vec![from], Vec::new());
        let mut i = 0;
        while let Some(id) = nodes.get(i).copied() {
            for (link, _, other) in map.links_of(id).filter(|(_, found, _)| is_ahead(found)) {
                if !links.contains(&link) && links.len() < MOST_DRAWN {
                    links.push(link);
                    if !nodes.contains(&other) {
                        nodes.push(other);
                    }
                }
            }
            i += 1;
        }
        let length_px: f64 =
            links.iter().filter_map(|link| map.link(*link)).map(|link| map.length(link)).sum();
        // Whatever goes on behind an open end there was in the middle of a window, and would be on the map.
        let is_drawn = |id: &u32| is_near_followed(map, map.at(*id), half_px);
        if links.len() < MOST_DRAWN && length_px <= half_px && nodes.iter().all(is_drawn) {
            links.into_iter().for_each(|link| map.set_state(link, State::Followed));
        }
    }
}

/// Whether a followed line is nearer to a place.
fn is_near_followed(map: &LineMap, at: PxPoint, reach_px: f64) -> bool {
    map.near(at, reach_px + SPACING_PX).into_iter().any(|id| {
        map.links_of(id).any(|(_, link, other)| {
            let is_followed = !link.contact && link.state == State::Followed;
            is_followed && nearest(at, map.at(id), map.at(other)).distance(at) <= reach_px
        })
    })
}

/// Where to go to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Start {
    /// To a node that is to be begun at.
    At(u32),
    /// To a node that no end is known before, to see how the line goes on; or to begin at the other one.
    Unseen(u32, u32),
}

/// Where to begin: of the lines nearest to a place an end that is one (or another odd node), so that no piece is left behind;
/// of a loop the nearest place. Where a line leaves what was seen it must be looked at first.
pub(super) fn start(map: &mut LineMap, from: PxPoint) -> Option<Start> {
    let all: Vec<u32> = map.ahead().collect();
    let distance = |id: &u32| map.at(*id).distance(from);
    let nearest = all.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)))?;
    let mut seen: HashSet<u32> = HashSet::from([nearest]);
    let mut open = std::collections::VecDeque::from([nearest]);
    // The nearest odd node, and the nearest that no end is known before.
    let mut found: [Option<(f64, u32)>; 2] = [None; 2];
    while let Some(id) = open.pop_front() {
        let here = cluster(map, id);
        let arms: usize =
            here.iter().map(|id| map.links_of(*id).filter(|(_, link, _)| is_ahead(link)).count()).sum();
        let is_unknown = map.node(id).is_some_and(|node| node.open);
        let own = map.links_of(id).any(|(_, link, _)| is_ahead(link));
        let near = map.at(id).distance(from);
        for (found, fits) in found.iter_mut().zip([arms % 2 == 1 && !is_unknown, is_unknown]) {
            if own && fits && found.is_none_or(|(least, _)| near < least) {
                *found = Some((near, id));
            }
        }
        if seen.len() > MOST_VISITED {
            break;
        }
        for (_, link, other) in map.links_of(id) {
            if (link.contact || is_ahead(link)) && seen.insert(other) {
                open.push_back(other);
            }
        }
    }
    Some(match found {
        [Some((_, id)), _] => Start::At(id),
        [None, Some((_, id))] => Start::Unseen(id, nearest),
        [None, None] => Start::At(nearest),
    })
}

#[cfg(test)]
mod tests {
    use super::super::lines::Piece;
    use super::*;

    #[test]
    fn what_the_tool_has_drawn_beside_a_line_is_not_gone_for() {
        let line = |from: f64, length: u32, y: f64| Piece {
            places: (0..=length).map(|i| PxPoint::new(from + 2.0 * f64::from(i), y)).collect(),
            closed: false,
            open: [false, false],
        };
        let rest_px = |stub: Piece, width_px: f64| {
            let mut map = LineMap::default();
            map.insert(&[line(20.0, 30, 50.0), stub], width_px, &|_| false);
            (0..30).for_each(|link| map.set_state(link, State::Followed));
            assert!(map.length_of(State::Ahead) > 1.0 && map.length_of(State::Followed) > 59.0);
            pass_drawn(&mut map, width_px);
            map.length_of(State::Ahead)
        };
        // Beside the line's end, 1.6 px off: within half of 5 px.
        let stub = |y: f64, length: u32| line(78.0, length, y);
        let rests = [stub(51.6, 1), stub(54.0, 1), stub(51.6, 4)].map(|stub| rest_px(stub, 5.0));
        assert!(rests[0] < 0.5 && rests[1] > 1.0 && rests[2] > 7.0, "{rests:?}");
        // A line that ends there is no rest, however long it is.
        for links in 3..40 {
            let mut long = stub(51.6, links);
            long.places.reverse();
            let length_px = 2.0 * f64::from(links);
            assert!((rest_px(long, 5.0) - length_px).abs() < 1e-9, "{links} links");
        }
    }
}
