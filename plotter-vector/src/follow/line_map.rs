//! [`LineMap`]: the lines that were seen, and which of them were followed.
//!
//! A sparse graph: a node about every 2 px along a line, links between neighbours, in cells of 8 px. Its memory grows with the
//! length of the lines, whatever the size of the sheet. Lines that cross keep their own nodes; a *contact* of length 0 joins
//! them.

use super::keyframe::Shifts;
use super::lines::{Piece, cosine};
use super::paper::nearest;
use crate::stroke::{PxPoint, PxVec};
use std::collections::HashMap;

/// Side of a cell, px.
const CELL_PX: f64 = 8.0;

/// Seen again this near, a line is the same, as a share of its width and a pixel: less than half of the way to a line that nearly
/// touches it.
const SAME_SHARE: f64 = 0.45;

/// And at least as near and at most so far, px.
const SAME_PX: [f64; 2] = [1.5, 3.0];

/// Nearer than this a place is the same whatever its direction, px.
const SAME_PLACE_PX: f64 = 0.5;

/// As far beyond the last place that was seen of a line its next place is another one, px: it may turn there.
const BEYOND_PX: f64 = 1.0;

/// Lines whose directions differ by more are not the same: cosine of 45 degrees.
const SAME_COS: f64 = 0.7;

/// Nodes to either side that tell a line's direction.
const DIRECTION_NODES: usize = 3;

/// A line turns back where the way along it is longer than the straight one by this factor.
const TURN_FACTOR: f64 = 1.3;

/// Most nodes: with all around them about 200 bytes each.
pub(super) const MAX_NODES: usize = 1 << 24;

/// A place on a line.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) at: PxPoint,
    pub(super) links: Vec<u32>,
    /// How often it was measured.
    pub(super) seen: u16,
    /// How often there was nothing where it should be.
    missed: u16,
    /// The line goes on behind it, where no window has looked.
    pub(super) open: bool,
    /// Number of the keyframe by which it was seen last.
    keyframe: u32,
}

/// What joins two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) ends: [u32; 2],
    /// Lines that cross or meet here, no piece of a line.
    pub(super) contact: bool,
    pub(super) state: State,
}

/// What became of a piece of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// Yet to be followed.
    Ahead,
    Followed,
    /// Outside of what can be reached.
    Outside,
    /// Seen once, and not there when looked at again.
    Ghost,
    /// Could not be followed.
    GivenUp,
}

/// The map.
#[derive(Clone, Debug, Default)]
pub(super) struct LineMap {
    pub(super) nodes: Vec<Node>,
    pub(super) links: Vec<Link>,
    cells: HashMap<(i32, i32), Vec<u32>>,
    /// Links before this one are not ahead.
    first_ahead: usize,
    /// Number of the keyframe by which the camera's place is known.
    pub(super) keyframe: u32,
}

fn cell(at: PxPoint) -> (i32, i32) {
    (super::whole::floor(at.x / CELL_PX), super::whole::floor(at.y / CELL_PX))
}

impl LineMap {
    pub(super) fn node(&self, id: u32) -> Option<&Node> {
        self.nodes.get(id as usize)
    }

    pub(super) fn at(&self, id: u32) -> PxPoint {
        self.node(id).map_or_else(PxPoint::default, |node| node.at)
    }

    pub(super) fn link(&self, id: u32) -> Option<&Link> {
        self.links.get(id as usize)
    }

    /// The links of a node, with the node at their other end.
    pub(super) fn links_of(&self, id: u32) -> impl Iterator<Item = (u32, &Link, u32)> {
        self.node(id).into_iter().flat_map(|node| &node.links).filter_map(move |link| {
            let found = self.link(*link)?;
            let other = if found.ends[0] == id { found.ends[1] } else { found.ends[0] };
            Some((*link, found, other))
        })
    }

    /// Number of pieces of lines at a node.
    pub(super) fn arms(&self, id: u32) -> usize {
        self.links_of(id).filter(|(_, link, _)| !link.contact && link.state != State::Ghost).count()
    }

    pub(super) fn length(&self, link: &Link) -> f64 {
        self.at(link.ends[0]).distance(self.at(link.ends[1]))
    }

    /// Length of all lines in a state, px.
    pub(super) fn length_of(&self, state: State) -> f64 {
        self.links
            .iter()
            .filter(|link| !link.contact && link.state == state)
            .map(|link| self.length(link))
            // From 0: the sum of nothing is -0.
            .fold(0.0, |sum, px| sum + px)
    }

    /// The nodes within a distance.
    pub(super) fn near(&self, at: PxPoint, reach_px: f64) -> Vec<u32> {
        let (left, top) = cell(PxPoint::new(at.x - reach_px, at.y - reach_px));
        let (right, low) = cell(PxPoint::new(at.x + reach_px, at.y + reach_px));
        let mut found = Vec::new();
        for y in top..=low {
            for x in left..=right {
                let ids = self.cells.get(&(x, y)).map_or(&[] as &[u32], Vec::as_slice);
                found.extend(ids.iter().copied().filter(|id| self.at(*id).is_within(reach_px, at)));
            }
        }
        found
    }

    /// Direction of the line at a node, of length 1, over a few nodes to either side; none near a corner or a junction, or
    /// where the line is short.
    pub(super) fn direction(&self, id: u32) -> Option<PxVec> {
        let is_line = |link: &Link| !link.contact && link.state != State::Ghost;
        let mut ways = self.links_of(id).filter(|(_, link, _)| is_line(link)).map(|(_, _, other)| other);
        let (one, two) = (ways.next()?, ways.next());
        if ways.next().is_some() {
            return None;
        }
        let walk = |first: u32| {
            let (mut before, mut at) = (id, first);
            for _ in 1..DIRECTION_NODES {
                let mut rest = self.links_of(at).filter(|(_, link, other)| is_line(link) && *other != before);
                let (Some((_, _, next)), None) = (rest.next(), rest.next()) else { break };
                (before, at) = (at, next);
            }
            self.at(at)
        };
        let here = self.at(id);
        let a = walk(one);
        let b = two.map_or(here, walk);
        if two.is_some() && cosine(here - a, b - here) < 0.85 {
            return None;
        }
        let way = b - a;
        let length = way.length();
        (length > 3.0).then(|| way / length)
    }

    /// Whether another part of a line, or the other arm of a sharp turn, is so near that both are one piece of ink.
    pub(super) fn is_crowded(&self, id: u32, reach_px: f64) -> bool {
        let at = self.at(id);
        let hops = super::whole::count(libm::ceil(TURN_FACTOR * reach_px / super::lines::SPACING_PX)) + 1;
        let own = self.around(id, hops);
        // Where another line touches, the ink beside is its.
        let touching = |(node, hops): &(u32, usize)| {
            super::lines::SPACING_PX * super::lines::count_f64(*hops) <= reach_px
                && self.links_of(*node).any(|(_, link, _)| link.contact)
        };
        if own.iter().any(touching) {
            return true;
        }
        self.near(at, reach_px).into_iter().any(|other| {
            let hops = own.iter().find(|(node, _)| *node == other).map(|(_, hops)| *hops);
            let turned = |hops: usize| {
                let way_px = super::lines::SPACING_PX * super::lines::count_f64(hops);
                way_px > TURN_FACTOR * self.at(other).distance(at) + super::lines::SPACING_PX
            };
            hops.is_none_or(turned) && self.arms(other) > 0
        })
    }

    /// Whether a line that goes on where no window has looked does so within a distance.
    pub(super) fn is_near_open_end(&self, id: u32, reach_px: f64) -> bool {
        let hops = super::whole::count(libm::ceil(reach_px / super::lines::SPACING_PX));
        let is_open = |id: u32| self.node(id).is_some_and(|node| node.open);
        self.around(id, hops).iter().any(|(id, _)| is_open(*id))
    }

    /// The nodes that are reached over so many links at most, and over how many.
    fn around(&self, from: u32, most_hops: usize) -> Vec<(u32, usize)> {
        let mut found = vec![(from, 0)];
        let mut i = 0;
        while let Some((id, hops)) = found.get(i).copied() {
            if hops < most_hops {
                for (_, link, other) in self.links_of(id) {
                    if link.state != State::Ghost && found.iter().all(|(node, _)| *node != other) {
                        found.push((other, hops + 1));
                    }
                }
            }
            i += 1;
        }
        found
    }

    fn add_node(&mut self, at: PxPoint) -> u32 {
        let id = u32::try_from(self.nodes.len()).unwrap_or(u32::MAX);
        self.nodes.push(Node {
            at,
            links: Vec::new(),
            seen: 1,
            missed: 0,
            open: false,
            keyframe: self.keyframe,
        });
        self.cells.entry(cell(at)).or_default().push(id);
        id
    }

    /// Moves a node to where it was seen.
    pub(super) fn shift(&mut self, id: u32, to: PxPoint) {
        let Some(node) = self.nodes.get_mut(id as usize) else { return };
        node.seen = node.seen.saturating_add(1);
        node.missed = 0;
        node.keyframe = self.keyframe;
        self.put(id, to);
    }

    /// All nodes go with the keyframes by which they were seen.
    pub(super) fn move_with(&mut self, shifts: &Shifts) {
        for id in 0..u32::try_from(self.nodes.len()).unwrap_or(u32::MAX) {
            let Some(node) = self.node(id) else { continue };
            let by = shifts.of(node.keyframe);
            if by != PxVec::default() {
                self.put(id, node.at + by);
            }
        }
    }

    /// A node at another place; its cell follows.
    fn put(&mut self, id: u32, to: PxPoint) {
        let Some(node) = self.nodes.get_mut(id as usize) else { return };
        let (from, new) = (cell(node.at), cell(to));
        node.at = to;
        if from != new {
            if let Some(ids) = self.cells.get_mut(&from) {
                ids.retain(|other| *other != id);
            }
            self.cells.entry(new).or_default().push(id);
        }
    }

    fn add_link(&mut self, a: u32, b: u32, contact: bool) {
        if a == b || self.links_of(a).any(|(_, link, other)| other == b && link.contact == contact) {
            return;
        }
        let id = u32::try_from(self.links.len()).unwrap_or(u32::MAX);
        self.links.push(Link { ends: [a, b], contact, state: State::Ahead });
        for end in [a, b] {
            if let Some(node) = self.nodes.get_mut(end as usize) {
                node.links.push(id);
            }
        }
    }

    pub(super) fn set_state(&mut self, id: u32, state: State) {
        if let Some(link) = self.links.get_mut(id as usize) {
            link.state = state;
        }
    }

    /// Whether a node can be reached over so many links.
    fn connected(&self, from: u32, to: u32, hops: usize) -> bool {
        self.around(from, hops).iter().any(|(id, _)| *id == to)
    }

    /// The node of the map that a place of a line is, among the first `known`.
    fn same(&self, at: PxPoint, ways: [PxVec; 2], known: usize, reach_px: f64) -> Option<u32> {
        let agrees = |id: u32| {
            if self.at(id).distance(at) < SAME_PLACE_PX {
                return true;
            }
            let mut links = self.links_of(id).filter(|(_, link, _)| !link.contact).peekable();
            links.peek().is_none()
                || links.any(|(_, _, other)| {
                    let way = self.at(other) - self.at(id);
                    ways.iter().any(|along| cosine(way, *along).abs() > SAME_COS)
                })
        };
        let alive = |id: u32| {
            let mut links = self.links_of(id).peekable();
            links.peek().is_none() || links.any(|(_, link, _)| link.state != State::Ghost)
        };
        let near = self.near(at, reach_px);
        // Nor is it a place of the line before its open end.
        let open = near.iter().filter(|id| self.beyond_open_px(**id, at) >= BEYOND_PX);
        let before: Vec<u32> = open.flat_map(|id| self.before_open(*id)).collect();
        let known = |id: &u32| (*id as usize) < known && alive(*id) && agrees(*id) && !before.contains(id);
        near.into_iter()
            .filter(known)
            .min_by(|a, b| self.at(*a).distance(at).total_cmp(&self.at(*b).distance(at)).then(a.cmp(b)))
    }

    /// An open end and the nodes of its line before it.
    fn before_open(&self, end: u32) -> Vec<u32> {
        let mut found = vec![end];
        while let Some(id) = found.last().copied().filter(|_| found.len() <= DIRECTION_NODES) {
            let mut links = self.links_of(id).filter(|(_, link, _)| !link.contact);
            let Some((_, _, next)) = links.find(|(_, _, other)| !found.contains(other)) else { break };
            found.push(next);
        }
        found
    }

    /// The open end near a node that the next place of its line is beyond: the line goes on from there, not from the node. Else the node.
    fn to_open_end(&self, node: u32, next: Option<&PxPoint>) -> u32 {
        let is_beyond = |id: &u32| next.is_some_and(|at| self.beyond_open_px(*id, *at) > 0.0);
        let near = self.near(self.at(node), SAME_PX[1]).into_iter();
        near.filter(is_beyond).find(|id| self.before_open(*id).contains(&node)).unwrap_or(node)
    }

    /// How far beyond a node a place is if the line goes on there unseen, px; 0 if it does not.
    fn beyond_open_px(&self, id: u32, at: PxPoint) -> f64 {
        let mut links = self.links_of(id).filter(|(_, link, _)| !link.contact);
        let (Some((_, _, inside)), None) = (links.next(), links.next()) else { return 0.0 };
        if self.node(id).is_none_or(|node| !node.open) {
            return 0.0;
        }
        let (PxVec { x, y }, PxVec { x: u, y: v }) = (at - self.at(id), self.at(id) - self.at(inside));
        (x * u + y * v) / libm::hypot(u, v).max(1e-9)
    }

    /// Puts the lines of a window into the map. What is there already stays; new lines are linked to what
    /// they go on from. Gives the number of new nodes.
    pub(super) fn insert(
        &mut self,
        pieces: &[Piece],
        width_px: f64,
        is_ink: &dyn Fn(PxPoint) -> bool,
    ) -> usize {
        let known = self.nodes.len();
        let first_link = self.links.len();
        if known + pieces.iter().map(|piece| piece.places.len()).sum::<usize>() > MAX_NODES {
            return 0;
        }
        let mut ends = Vec::new();
        for piece in pieces {
            self.insert_piece(piece, width_px, known, &mut ends);
        }
        for end in ends {
            self.join_end(end, width_px, is_ink);
        }
        for link in first_link..self.links.len() {
            self.join_crossing(link);
        }
        self.nodes.len() - known
    }

    fn insert_piece(&mut self, piece: &Piece, width_px: f64, known: usize, ends: &mut Vec<u32>) {
        let places = &piece.places;
        let count = places.len();
        let reach_px = (SAME_SHARE * (width_px + 1.0)).clamp(SAME_PX[0], SAME_PX[1]);
        let near = |i: usize, ahead: bool| {
            let other = match (ahead, piece.closed) {
                (true, true) => (i + 1) % count,
                (false, true) => (i + count - 1) % count,
                (true, false) => (i + 1).min(count - 1),
                (false, false) => i.saturating_sub(1),
            };
            places.get(other).copied().unwrap_or_default()
        };
        let mut nodes: Vec<Option<u32>> = (0..)
            .zip(places)
            .map(|(i, at)| {
                let ways = [*at - near(i, false), near(i, true) - *at];
                let ways = if ways[0] == PxVec::default() {
                    [ways[1]; 2]
                } else if ways[1] == PxVec::default() {
                    [ways[0]; 2]
                } else {
                    ways
                };
                self.same(*at, ways, known, reach_px)
            })
            .collect();
        // A loop begins where it is known.
        let mut places = places.clone();
        if piece.closed
            && let Some(first) = nodes.iter().position(Option::is_some)
        {
            places.rotate_left(first);
            nodes.rotate_left(first);
            places.extend(places.first().copied());
            nodes.extend(nodes.first().copied());
        }
        let is_new_loop = piece.closed && nodes.iter().all(Option::is_none);
        let mut i = 0;
        while i < nodes.len() {
            if let Some(node) = nodes.get(i).copied().flatten() {
                let ends_here = (i == 0 && !piece.open[0]) || (i + 1 == nodes.len() && !piece.open[1]);
                if ends_here
                    && !piece.closed
                    && let Some(node) = self.nodes.get_mut(node as usize)
                {
                    node.open = false;
                }
                if let Some(next) = nodes.get(i + 1).copied().flatten() {
                    self.close_gap(node, next);
                }
                i += 1;
                continue;
            }
            let length = nodes.iter().skip(i).take_while(|node| node.is_none()).count();
            let run = places.get(i..i + length).unwrap_or(&[]);
            let before = i.checked_sub(1).and_then(|i| nodes.get(i).copied().flatten());
            let before = before.map(|id| self.to_open_end(id, run.first()));
            let behind = nodes.get(i + length).copied().flatten();
            let behind = behind.map(|id| self.to_open_end(id, run.last()));
            if is_new_loop || self.is_news(run, before, behind, width_px, known) {
                let open = [before.is_none() && piece.open[0], behind.is_none() && piece.open[1]];
                self.add_run(run, [before, behind], open, is_new_loop, ends);
            }
            i += length;
        }
    }

    /// Whether places that are not in the map belong there, or are what noise makes of a line that is.
    fn is_news(
        &self,
        run: &[PxPoint],
        before: Option<u32>,
        behind: Option<u32>,
        width_px: f64,
        known: usize,
    ) -> bool {
        let ends = [before.map(|id| self.at(id)), behind.map(|id| self.at(id))];
        let all: Vec<PxPoint> = ends[0].into_iter().chain(run.iter().copied()).chain(ends[1]).collect();
        let length: f64 =
            all.windows(2).map(|pair| if let [a, b] = pair { a.distance(*b) } else { 0.0 }).sum();
        let is_end = |id: u32| self.arms(id) <= 1;
        let is_open = |id: u32| self.node(id).is_some_and(|node| node.open);
        let goes_on = before.into_iter().chain(behind).any(|id| is_end(id) || is_open(id));
        if !goes_on && run.iter().all(|at| self.is_in_ink(*at, 0.5 * width_px + 1.0, known)) {
            return false;
        }
        match (before, behind) {
            (None, None) => {
                let beside = |at: &PxPoint| {
                    self.near(*at, 0.5 * width_px + 2.0).into_iter().any(|id| (id as usize) < known)
                };
                length > 2.0 * width_px + 4.0 || !run.iter().any(beside)
            }
            (Some(id), None) | (None, Some(id)) => {
                if is_open(id) {
                    length > 0.5
                } else if is_end(id) {
                    length > 0.5 * width_px + 3.0
                } else {
                    length > 2.0 * width_px + 4.0
                }
            }
            (Some(a), Some(b)) => {
                (is_open(a) && is_open(b) && !self.connected(a, b, 4))
                    || length > 2.0 * width_px + 6.0
                    || !self.connected(a, b, 4 + super::whole::count(length))
            }
        }
    }

    /// Whether a place is nearer to a line between the first `known` nodes than `reach_px`.
    fn is_in_ink(&self, at: PxPoint, reach_px: f64, known: usize) -> bool {
        let is_known = |id: u32| (id as usize) < known;
        self.near(at, reach_px + super::lines::SPACING_PX).into_iter().filter(|id| is_known(*id)).any(|id| {
            self.links_of(id).any(|(_, link, other)| {
                let is_line = !link.contact && link.state != State::Ghost && is_known(other);
                is_line && nearest(at, self.at(id), self.at(other)).distance(at) < reach_px
            })
        })
    }

    fn add_run(
        &mut self,
        run: &[PxPoint],
        anchors: [Option<u32>; 2],
        open: [bool; 2],
        closed: bool,
        ends: &mut Vec<u32>,
    ) {
        let ids: Vec<u32> = run.iter().map(|at| self.add_node(*at)).collect();
        let chain: Vec<u32> = anchors[0].into_iter().chain(ids.iter().copied()).chain(anchors[1]).collect();
        for anchor in anchors.into_iter().flatten() {
            if let Some(node) = self.nodes.get_mut(anchor as usize) {
                node.open = false;
            }
        }
        for pair in chain.windows(2) {
            if let [a, b] = pair {
                self.add_link(*a, *b, false);
            }
        }
        if closed
            && ids.len() > 2
            && let (Some(first), Some(last)) = (ids.first(), ids.last())
        {
            self.add_link(*last, *first, false);
        }
        let mut end = |map: &mut Self, id: Option<&u32>, free: bool, open: bool| {
            if let Some(id) = id.copied().filter(|_| free && !closed) {
                if let Some(node) = map.nodes.get_mut(id as usize) {
                    node.open = open;
                }
                if !open {
                    ends.push(id);
                }
            }
        };
        end(self, ids.first(), anchors[0].is_none(), open[0]);
        end(self, ids.last(), anchors[1].is_none(), open[1]);
    }

    /// Links two nodes that follow each other on a line, if the map does not know yet that they do.
    fn close_gap(&mut self, a: u32, b: u32) {
        let is_end = |id: u32| self.arms(id) <= 1;
        if (is_end(a) || is_end(b))
            && self.at(a).distance(self.at(b)) < 3.0 * super::lines::SPACING_PX
            && !self.connected(a, b, 5)
        {
            self.add_link(a, b, false);
            for id in [a, b] {
                if self.arms(id) > 1
                    && let Some(node) = self.nodes.get_mut(id as usize)
                {
                    node.open = false;
                }
            }
        }
    }

    /// Where a line ends on another one, with nothing but ink between them, they touch.
    fn join_end(&mut self, end: u32, width_px: f64, is_ink: &dyn Fn(PxPoint) -> bool) {
        let at = self.at(end);
        let over_ink = |to: PxPoint| [0.25, 0.5, 0.75].iter().all(|part| is_ink(at + (to - at) * *part));
        let apart = |id: &u32| *id != end && over_ink(self.at(*id)) && !self.connected(end, *id, 6);
        let found = self.near(at, 0.6 * width_px + 2.5).into_iter().filter(apart);
        let nearest =
            found.min_by(|a, b| self.at(*a).distance(at).total_cmp(&self.at(*b).distance(at)).then(a.cmp(b)));
        if let Some(other) = nearest {
            self.add_link(end, other, true);
        }
    }

    /// Where a new link crosses others, they touch.
    fn join_crossing(&mut self, link: usize) {
        let Some(Link { ends: [a, b], contact: false, .. }) = self.links.get(link).copied() else { return };
        let (from, to) = (self.at(a), self.at(b));
        let middle = PxPoint::new(0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
        let mut found = Vec::new();
        for near in self.near(middle, 2.0 * super::lines::SPACING_PX) {
            for (_, other, end) in self.links_of(near) {
                let shares = [near, end].iter().any(|id| *id == a || *id == b);
                if !other.contact && !shares && near < end && cross(from, to, self.at(near), self.at(end)) {
                    found.push((near, end));
                }
            }
        }
        for (c, d) in found {
            let pairs = [(a, c), (a, d), (b, c), (b, d)];
            let distance = |(one, other): &(u32, u32)| self.at(*one).distance(self.at(*other));
            let nearest = pairs.into_iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
            if let Some((one, other)) = nearest.filter(|(one, other)| !self.connected(*one, *other, 4)) {
                self.add_link(one, other, true);
            }
        }
    }

    /// Counts that there was no ink at a node; the second time what it joins is a ghost.
    pub(super) fn miss(&mut self, id: u32) {
        let Some(node) = self.nodes.get_mut(id as usize) else { return };
        node.missed += 1;
        if node.missed < 2 {
            return;
        }
        node.open = false;
        for link in node.links.clone() {
            if self.link(link).is_some_and(|link| link.state == State::Ahead) {
                self.set_state(link, State::Ghost);
            }
        }
    }

    /// The nodes that pieces of lines yet to be followed begin at.
    pub(super) fn ahead(&mut self) -> impl Iterator<Item = u32> {
        let is_ahead = |link: &Link| !link.contact && link.state == State::Ahead;
        while self.links.get(self.first_ahead).is_some_and(|link| !is_ahead(link)) {
            self.first_ahead += 1;
        }
        let rest = self.links.get(self.first_ahead..).unwrap_or(&[]);
        rest.iter().filter(move |link| is_ahead(link)).flat_map(|link| link.ends)
    }
}

/// Whether two pieces of straight lines cross.
fn cross(a: PxPoint, b: PxPoint, c: PxPoint, d: PxPoint) -> bool {
    let side = |p: PxPoint, q: PxPoint, r: PxPoint| {
        let (one, other) = (q - p, r - p);
        one.cross(other)
    };
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_turns_behind_its_last_seen_place_turns_where_it_does() {
        let piece = |places: &[(f64, f64)]| {
            let places = places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect();
            Piece { places, closed: false, open: [true, true] }
        };
        let up = |from: f64| -> Vec<(f64, f64)> {
            (0..10).map(|i| (50.0, from + 2.0 * f64::from(i))).rev().collect()
        };
        // A window ends 2.5 px before the corner at (50, 49.5); the next one shows it.
        let mut map = LineMap::default();
        map.insert(&[piece(&up(52.0))], 5.0, &|_| true);
        let mut turned = up(51.4);
        turned.extend((0..10).map(|i| (50.0 - 2.4 * f64::from(i), 49.5)));
        map.insert(&[piece(&turned)], 5.0, &|_| true);
        let corner = PxPoint::new(50.0, 49.5);
        assert!(map.nodes.iter().any(|node| node.at.distance(corner) < 1e-9), "{:?}", map.nodes);
        let on = |at: PxPoint| (at.x - 50.0).abs() < 1e-9 || (at.y - 49.5).abs() < 1e-9;
        let shortcut = map.links.iter().find(|link| {
            let [a, b] = link.ends.map(|end| map.at(end));
            !on(a + (b - a) * 0.5)
        });
        assert!(shortcut.is_none(), "{shortcut:?}");
        assert!(map.links.iter().all(|link| !link.contact) && map.links.len() == map.nodes.len() - 1);
    }

    #[test]
    fn a_line_that_goes_on_behind_a_place_seen_late_has_no_stub() {
        let piece = |xs: &[f64], open| {
            let places = xs.iter().map(|x| PxPoint::new(*x, 50.0)).collect();
            Piece { places, closed: false, open }
        };
        let mut map = LineMap::default();
        // The second window shows 1.4 px more; the third has a place before that, and the next one behind it.
        map.insert(&[piece(&[20.0, 22.0, 24.0, 26.0, 28.0, 30.0], [true, true])], 5.0, &|_| true);
        map.insert(&[piece(&[25.4, 27.4, 29.4, 31.4], [true, true])], 5.0, &|_| true);
        map.insert(&[piece(&[26.5, 28.5, 30.5, 32.5, 34.5, 36.5], [true, true])], 5.0, &|_| true);
        let arms = |id: u32| map.links.iter().filter(|link| link.ends.contains(&id)).count();
        let count =
            |fits: &dyn Fn(usize) -> bool| (0..).zip(&map.nodes).filter(|(id, _)| fits(arms(*id))).count();
        let (ends, forks) = (count(&|arms| arms == 1), count(&|arms| arms > 2));
        assert_eq!((ends, forks), (2, 0), "{:?} {:?}", map.nodes, map.links);
        assert!((map.length_of(State::Ahead) - 16.5).abs() < 1e-9, "{}", map.length_of(State::Ahead));
    }
}
