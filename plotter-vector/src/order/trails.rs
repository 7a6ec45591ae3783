//! [`trails`]: strokes whose ends meet become one stroke.
//!
//! ```text
//!      a│      straight on, one partner an end:      the rest, where the drawing allows it:
//!    ───┼───   a goes on in d, b in c                ┌──┐  two rings that share a node are one,
//!    b  │  c                                         └──┼──┐  and four strokes that make a square are one
//!      d│                                               └──┘
//! ```
//!
//! The strokes are the edges of a multigraph, the places where they end are its nodes. Each end gets at most
//! one partner at its node; a choice of partners is a set of trails and rings. First the straightest pairs
//! are made, then what is left of each node is paired, so that at most one end of it is free; then each ring
//! that shares a node with another trail is spliced into it, as in Hierholzer's proof ("Ueber die
//! Möglichkeit, einen Linienzug ohne Wiederholung und ohne Unterbrechung zu umfahren", Mathematische Annalen
//! 6, 1873). A connected component with 2k ends in odd nodes then is max(1, k) trails, fewer is impossible.

use super::chains::Chains;
use super::drawn_ways::drawn_ways;
use super::near_nodes::NearNodes;
use super::plan::{Legs, Stroke, Trail};
use super::sites::{NONE, number};
use crate::disjoint_sets::DisjointSets;
use crate::parallel::each;
use crate::stroke::curve::unit;
use crate::stroke::{PxPoint, PxVec};
use core::ops::Range;

/// Greatest cosine between the outward directions of two ends that go on in each other: they bend by 45° at
/// most.
const STRAIGHT_COS: f64 = -core::f64::consts::FRAC_1_SQRT_2;

/// Partners that a node offers an end on either side of straight on, and ends of a node of which all pairs are
/// looked at: limits for drawings that meet in few places.
const OFFERS: usize = 2;
const OFFERED: usize = 2 * OFFERS + 2;
const ALL_PAIRS: usize = 24;

/// Fewest gaps' lengths of a stroke that is closed with itself.
const CLOSED_GAPS: f64 = 8.0;

/// Which ends are joined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joining {
    /// Ends so near are joined where the line goes on.
    pub(crate) gap_px: f64,
    /// And ends in exactly one place, whatever the angle.
    pub(crate) one_stroke: bool,
    /// And then what is left within so much, whatever the angle; 0 for none.
    pub(crate) corner_gap_px: f64,
    /// And what is left between which a pen so wide has drawn all of the way, in whole px; 0 for none.
    pub(crate) pen_px: f64,
}

/// Ends so far from each other are joined where the pen has drawn all of the way, in its widths: the ink of
/// two lines that cross at 15 degrees runs together over 1 / sin 15° = 3.9 of them. 8 join what lies on two
/// sides of a letter.
const OVER_INK_WIDTHS: f64 = 4.0;

/// No place of such a way lies farther from the middle of a stroke, px: half of one, which is what the raster
/// leaves open of a line. So no line is moved by it, whatever the pen's width. 1.5 leave 1.08 strokes for
/// each one of a clean scan instead of 1.14, but put the places where lines meet .51 px off in a noisy one.
const BESIDE_PX: f64 = 0.5;

/// Joins strokes end to end. Trails come in the order of their first strokes.
pub(crate) fn trails<'a>(strokes: &'a [Stroke<'a>], joining: &Joining) -> (Legs<'a>, Vec<Trail>) {
    let mut meeting = Meeting::new(strokes, joining.one_stroke);
    let gap_px = if joining.gap_px > 0.0 { joining.gap_px } else { 0.0 };
    let mut near = meeting.near_nodes(gap_px);
    meeting.go_on_straight(&near, gap_px);
    if joining.one_stroke {
        meeting.pair_the_rest();
        let corner_gap_px = joining.corner_gap_px;
        if corner_gap_px > 0.0 {
            if corner_gap_px != gap_px {
                near = meeting.near_nodes(corner_gap_px);
            }
            let pairs = meeting.free_pairs(&near, |_| corner_gap_px);
            meeting.connect_free(pairs.into_iter());
        }
        drop(near);
        if joining.pen_px > 0.0 {
            meeting.bridge_over_ink(joining.pen_px);
        }
        meeting.splice();
    }
    meeting.into_chains().assemble()
}

/// Where the strokes' ends meet, and which goes on in which. An end is twice its stroke's number, and 1 more
/// for the last vertex.
struct Meeting<'a> {
    strokes: &'a [Stroke<'a>],
    /// First vertex of each closed stroke; nothing where there is none.
    starts: Vec<u32>,
    /// Strokes that are more than one line, and in which directions these end.
    bent: Vec<(u32, [PxVec; 2])>,
    /// Ends by node, and in a node by direction.
    ends: Vec<u32>,
    /// One past the last end of each node, in `ends`.
    nodes: Vec<u32>,
    /// Node of each end; `NONE` of a dot's.
    node_of: Vec<u32>,
    /// What each end goes on in; `NONE` where it ends.
    partners: Vec<u32>,
}

/// Nodes for which pairs are looked for in one go: some milliseconds of work. And such parts before what was
/// found is put together, so that it is not there twice.
const NODES_TOGETHER: usize = 4096;
const PARTS_TOGETHER: usize = 32;

/// Two ends that go on in each other, after the cosine between their directions.
type StraightPair = (f64, u32, u32);

/// What joins: the pen and the letter, and the place.
type Key = (u64, u64, u64);

fn key(stroke: &Stroke<'_>, at: PxPoint) -> Key {
    // Adding 0.0 makes one zero of the two.
    (u64::from(stroke.pen) << 32 | u64::from(stroke.letter), (at.x + 0.0).to_bits(), (at.y + 0.0).to_bits())
}

impl<'a> Meeting<'a> {
    fn new(strokes: &'a [Stroke<'a>], one_stroke: bool) -> Self {
        let starts = if one_stroke { starts_at_nodes(strokes) } else { Vec::new() };
        let start = |stroke: usize| starts.get(stroke).copied().unwrap_or(0);
        // By one coordinate first, since most ends differ in it: the whole keys of a million lines are 50 MB.
        let whole_key = |end: u32| {
            strokes
                .get(end as usize / 2)
                .map(|stroke| key(stroke, end_place(stroke, start(end as usize / 2), end % 2 == 1)))
        };
        let mut keyed: Vec<(u64, u32)> = Vec::with_capacity(2 * strokes.len());
        for (stroke, index) in strokes.iter().zip(0_u32..).filter(|(stroke, _)| stroke.vertices().len() > 1) {
            for last in [false, true] {
                let (_, x, _) = key(stroke, end_place(stroke, start(index as usize), last));
                keyed.push((x, 2 * index + u32::from(last)));
            }
        }
        keyed.sort_unstable_by(|a, b| {
            a.0.cmp(&b.0).then_with(|| whole_key(a.1).cmp(&whole_key(b.1))).then(a.1.cmp(&b.1))
        });
        let mut nodes: Vec<u32> = Vec::with_capacity(keyed.len());
        for same in keyed.chunk_by(|a, b| a.0 == b.0 && whole_key(a.1) == whole_key(b.1)) {
            nodes.push(nodes.last().copied().unwrap_or(0) + number(same.len()));
        }
        let ends: Vec<u32> = keyed.iter().map(|(_, end)| *end).collect();
        drop(keyed);
        let is_bent = |(stroke, _): &(&Stroke<'_>, u32)| !stroke.is_line;
        let bent = strokes.iter().zip(0..).filter(is_bent).map(|(stroke, index)| (index, stroke.outward()));
        let mut meeting = Self {
            strokes,
            bent: bent.collect(),
            ends,
            nodes,
            node_of: vec![NONE; 2 * strokes.len()],
            partners: vec![NONE; 2 * strokes.len()],
            starts,
        };
        let mut by_angle: Vec<(f64, u32)> = Vec::new();
        let mut from = 0;
        for node in 0..meeting.nodes.len() {
            let to = meeting.nodes.get(node).map_or(from, |to| *to as usize);
            let same = meeting.ends.get(from..to).unwrap_or(&[]);
            for end in same {
                if let Some(slot) = meeting.node_of.get_mut(*end as usize) {
                    *slot = number(node);
                }
            }
            if same.len() > 1 {
                by_angle.clear();
                by_angle.extend(same.iter().map(|end| (meeting.angle(*end), *end)));
                by_angle.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let slots = meeting.ends.iter_mut().skip(from);
                slots.zip(&by_angle).for_each(|(slot, (_, end))| *slot = *end);
            }
            from = to;
        }
        for (_, index) in strokes.iter().zip(0_u32..).filter(|(stroke, _)| stroke.closed) {
            meeting.connect(2 * index, 2 * index + 1);
        }
        meeting
    }

    /// The nodes that may be near each other; none where nothing is joined across a gap.
    fn near_nodes(&self, gap_px: f64) -> NearNodes {
        // By ends, which lie in the order of the strokes in memory.
        let ends = if gap_px > 0.0 { self.node_of.len() } else { 0 };
        let places = (0..number(ends)).zip(&self.node_of).filter(|(_, node)| **node != NONE);
        NearNodes::new(gap_px, places.map(|(end, node)| (self.place(end), *node)))
    }

    /// Where a node lies.
    fn node_place(&self, node: u32) -> PxPoint {
        self.node(node).first().map_or_else(PxPoint::default, |end| self.place(*end))
    }

    fn node(&self, index: u32) -> &[u32] {
        let end = |index: usize| self.nodes.get(index).map_or(0, |end| *end as usize);
        let from = (index as usize).checked_sub(1).map_or(0, end);
        self.ends.get(from..end(index as usize)).unwrap_or(&[])
    }

    fn partner(&self, end: u32) -> Option<u32> {
        self.partners.get(end as usize).copied().filter(|partner| *partner != NONE)
    }

    fn connect(&mut self, a: u32, b: u32) {
        for (end, other) in [(a, b), (b, a)] {
            if let Some(slot) = self.partners.get_mut(end as usize) {
                *slot = other;
            }
        }
    }

    fn start(&self, stroke: u32) -> u32 {
        self.starts.get(stroke as usize).copied().unwrap_or(0)
    }

    fn place(&self, end: u32) -> PxPoint {
        let stroke = self.strokes.get(end as usize / 2);
        stroke.map(|stroke| end_place(stroke, self.start(end / 2), end % 2 == 1)).unwrap_or_default()
    }

    /// The unit vector in which a stroke would go on beyond its end; (0, 0) for a dot.
    fn outward(&self, end: u32) -> PxVec {
        let (index, last) = (end / 2, end % 2 == 1);
        let Some(stroke) = self.strokes.get(index as usize) else { return PxVec::default() };
        if let (Some(before), true) = (self.start(index).checked_sub(1), stroke.closed) {
            let segment = stroke.course().segment(if last { before } else { self.start(index) } as usize);
            let heading = segment.map_or(PxVec::default(), |segment| segment.heading(last));
            return if last { heading } else { -heading };
        }
        if stroke.is_line {
            return unit(stroke.end(!last), stroke.end(last));
        }
        let known = self.bent.binary_search_by_key(&index, |(bent, _)| *bent);
        let [first_outward, last_outward] =
            known.ok().and_then(|at| self.bent.get(at)).map(|(_, outward)| *outward).unwrap_or_default();
        if last { last_outward } else { first_outward }
    }

    /// Direction in which an end points.
    fn angle(&self, end: u32) -> f64 {
        let PxVec { x, y } = self.outward(end);
        libm::atan2(y, x)
    }

    /// Cosine between the directions in which two ends point: −1 when the line goes straight on, 1 for a
    /// hairpin.
    fn hairpin(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (self.outward(a), self.outward(b));
        a.dot(b)
    }

    /// Pairs ends within the gap that go on in each other, the straightest first.
    fn go_on_straight(&mut self, near: &NearNodes, gap_px: f64) {
        let mut pairs = in_parts(self.nodes.len(), |nodes| {
            let mut pairs = Vec::new();
            (number(nodes.start)..number(nodes.end))
                .for_each(|node| self.straight_on(node, node, gap_px, &mut pairs));
            pairs
        });
        pairs.append(&mut in_parts(near.len(), |firsts| {
            let mut pairs = Vec::new();
            near.pairs(
                firsts,
                |node| self.node_place(node),
                |a, b| {
                    // Of a node of few ends each is offered.
                    if self.node(b).len() <= OFFERED {
                        self.straight_on(a, b, gap_px, &mut pairs);
                    } else {
                        self.straight_on(b, a, gap_px, &mut pairs);
                        if self.node(a).len() > OFFERED {
                            self.straight_on(a, b, gap_px, &mut pairs);
                        }
                    }
                },
            );
            pairs
        }));
        let far = |pair: &StraightPair| self.place(pair.1).distance(self.place(pair.2));
        // Ends in one place come before ends across a gap only where they are as straight.
        pairs.sort_unstable_by(|a, b| {
            let nearer = || far(a).total_cmp(&far(b));
            a.0.total_cmp(&b.0).then_with(nearer).then((a.1, a.2).cmp(&(b.1, b.2)))
        });
        for (_, a, b) in pairs {
            if self.partner(a).is_none() && self.partner(b).is_none() {
                self.connect(a, b);
            }
        }
    }

    /// Adds the pairs of free ends of which one, at the node `from`, goes on in the other, at the node `to`.
    fn straight_on(&self, from: u32, to: u32, gap_px: f64, pairs: &mut Vec<StraightPair>) {
        let own = self.node(from);
        for end in own.iter().filter(|end| self.partner(**end).is_none()) {
            for partner in self.offers(*end, to).filter(|partner| partner != end) {
                let cos = self.hairpin(*end, partner);
                // Within a node of few ends each pair is come by from both of them.
                let is_known = from == to && own.len() <= OFFERED && partner < *end;
                if !is_known && cos <= STRAIGHT_COS && self.may_join(*end, partner, gap_px) {
                    pairs.push((cos, (*end).min(partner), (*end).max(partner)));
                }
            }
        }
    }

    /// The ends of a node nearest to straight on from `end`.
    fn offers(&self, end: u32, node: u32) -> impl Iterator<Item = u32> {
        let ends = self.node(node);
        // Round the node, a few on either side; a small node is looked at whole, each end once.
        let few = OFFERED.min(ends.len());
        let turn = core::f64::consts::PI;
        let opposite = |angle: f64| if angle > 0.0 { angle - turn } else { angle + turn };
        let from = if few < ends.len() {
            let opposite = opposite(self.angle(end));
            ends.partition_point(|other| self.angle(*other) < opposite) + ends.len()
        } else {
            ends.len()
        };
        let first = from - few / 2;
        (first..first + few).filter_map(move |index| ends.get(index % ends.len().max(1)).copied())
    }

    /// Whether two ends are free, of the same pen and letter, and not those of one stroke too short to be
    /// closed.
    fn may_join(&self, a: u32, b: u32, gap_px: f64) -> bool {
        let of = |end: u32| self.strokes.get(end as usize / 2);
        let (Some(of_a), Some(of_b)) = (of(a), of(b)) else {
            return false;
        };
        let closes = || a != b && of_a.length_px() > CLOSED_GAPS * gap_px;
        self.partner(b).is_none()
            && (of_a.pen, of_a.letter) == (of_b.pen, of_b.letter)
            && (a / 2 != b / 2 || closes())
    }

    /// Pairs the free ends of each node, the straightest first, until at most one is left.
    fn pair_the_rest(&mut self) {
        for node in 0..number(self.nodes.len()) {
            if self.node(node).len() < 2 {
                continue;
            }
            let mut free: Vec<u32> =
                self.node(node).iter().copied().filter(|end| self.partner(*end).is_none()).collect();
            if free.len() > ALL_PAIRS {
                // In order of direction: each with the one half round.
                let (half, rest) = free.split_at(free.len() / 2);
                let pairs: Vec<(u32, u32)> = half.iter().copied().zip(rest.iter().copied()).collect();
                pairs.into_iter().for_each(|(a, b)| self.connect(a, b));
                continue;
            }
            while let Some((a, b)) = self.straightest(&free) {
                self.connect(a, b);
                free.retain(|end| *end != a && *end != b);
            }
        }
    }

    /// Pairs the free ends between which a pen so wide has drawn all of the way.
    fn bridge_over_ink(&mut self, pen_px: f64) {
        let near = self.near_nodes(OVER_INK_WIDTHS * pen_px);
        let pairs = self.free_pairs(&near, |apart_px| apart_px);
        drop(near);
        let ways: Vec<[PxPoint; 2]> =
            pairs.iter().map(|(_, a, b)| [self.place(*a), self.place(*b)]).collect();
        let are_drawn = drawn_ways(&ways, self.strokes, BESIDE_PX);
        let drawn = pairs.into_iter().zip(are_drawn).filter(|(_, is_drawn)| *is_drawn);
        self.connect_free(drawn.map(|(pair, _)| pair));
    }

    /// The free end of each node with that of another one near it, the nearest first. `gap_px` says, given
    /// how far they are apart, over what gap they would be joined.
    fn free_pairs(&self, near: &NearNodes, gap_px: impl Fn(f64) -> f64 + Sync) -> Vec<(f64, u32, u32)> {
        let free = |node: u32| self.node(node).iter().copied().find(|end| self.partner(*end).is_none());
        let mut pairs: Vec<(f64, u32, u32)> = in_parts(near.len(), |firsts| {
            let mut pairs = Vec::new();
            near.pairs(
                firsts,
                |node| self.node_place(node),
                |a, b| {
                    let (Some(end), Some(partner)) = (free(a), free(b)) else { return };
                    let apart_px = self.place(end).distance(self.place(partner));
                    if self.may_join(end, partner, gap_px(apart_px)) {
                        pairs.push((apart_px, end.min(partner), end.max(partner)));
                    }
                },
            );
            pairs
        });
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        pairs
    }

    /// Joins pairs of ends, in their order, of which both are still free.
    fn connect_free(&mut self, pairs: impl Iterator<Item = (f64, u32, u32)>) {
        for (_, a, b) in pairs {
            if self.partner(a).is_none() && self.partner(b).is_none() {
                self.connect(a, b);
            }
        }
    }

    fn straightest(&self, free: &[u32]) -> Option<(u32, u32)> {
        let pairs =
            free.iter().enumerate().flat_map(|(index, a)| free.iter().skip(index + 1).map(move |b| (*a, *b)));
        pairs.min_by(|a, b| self.hairpin(a.0, a.1).total_cmp(&self.hairpin(b.0, b.1)))
    }

    /// Opens each ring at a node that it shares with another trail, and goes round it from there.
    fn splice(&mut self) {
        let (mut chains, open) = self.chains();
        for node in 0..number(self.nodes.len()) {
            if self.node(node).len() < 2 {
                continue;
            }
            let ends = self.node(node).to_vec();
            let roots: Vec<usize> = ends.iter().map(|end| chains.root(*end as usize / 2)).collect();
            if roots.iter().all(|root| Some(root) == roots.first()) {
                continue;
            }
            // Rings go into an open trail where there is one.
            let is_open = |root: &usize| open.get(*root) == Some(&true);
            let host = roots.iter().position(is_open).unwrap_or(0);
            let Some((host, host_root)) = ends.get(host).zip(roots.get(host)) else { continue };
            for (end, ring) in ends.iter().zip(&roots).filter(|(_, root)| !is_open(root)) {
                let Some(back) = self.partner(*end).filter(|back| self.same_node(*end, *back)) else {
                    continue;
                };
                // A ring that was taken in by an end before this one has the host's root now.
                if chains.root(*ring) != chains.root(*host_root) {
                    self.open_ring(*host, *end, back);
                    chains.join(*ring, *host_root);
                }
            }
        }
    }

    fn same_node(&self, a: u32, b: u32) -> bool {
        self.node_of.get(a as usize) == self.node_of.get(b as usize)
    }

    /// Puts the ring that goes through its node from `a` to `b` between `host` and what follows it there.
    fn open_ring(&mut self, host: u32, a: u32, b: u32) {
        match self.partner(host) {
            Some(next) if self.same_node(host, next) => {
                let straight = self.hairpin(host, a) + self.hairpin(b, next);
                let crossed = self.hairpin(host, b) + self.hairpin(a, next);
                let (a, b) = if crossed < straight { (b, a) } else { (a, b) };
                self.connect(host, a);
                self.connect(b, next);
            }
            Some(next) => {
                // The host goes on across a gap: the ring first, then the gap.
                self.connect(host, a);
                self.connect(b, next);
            }
            None => {
                self.connect(host, a);
                if let Some(slot) = self.partners.get_mut(b as usize) {
                    *slot = NONE;
                }
            }
        }
    }

    /// What its trails are put together of; the rest is given free.
    fn into_chains(self) -> Chains<'a> {
        Chains { strokes: self.strokes, starts: self.starts, partners: self.partners }
    }

    /// All ends with their partners.
    fn pairs(&self) -> impl Iterator<Item = (u32, Option<u32>)> {
        (0..)
            .zip(&self.partners)
            .map(|(end, partner)| (end, Some(*partner).filter(|partner| *partner != NONE)))
    }

    /// The strokes by trail, and whether the trail of each root is open.
    fn chains(&self) -> (DisjointSets, Vec<bool>) {
        let mut chains = DisjointSets::new(self.strokes.len());
        for (end, partner) in self.pairs() {
            if let Some(partner) = partner {
                chains.join(end as usize / 2, partner as usize / 2);
            }
        }
        let mut open = vec![false; self.strokes.len()];
        for (end, _) in self.pairs().filter(|(_, partner)| partner.is_none()) {
            if let Some(slot) = open.get_mut(chains.root(end as usize / 2)) {
                *slot = true;
            }
        }
        (chains, open)
    }
}

/// What is found for so many things, some of them in one go.
fn in_parts<T: Send>(count: usize, find: impl Fn(Range<usize>) -> Vec<T> + Sync) -> Vec<T> {
    let mut all = Vec::new();
    let parts: Vec<Range<usize>> = (0..count)
        .step_by(NODES_TOGETHER)
        .map(|from| from..count.min(from.saturating_add(NODES_TOGETHER)))
        .collect();
    for parts in parts.chunks(PARTS_TOGETHER) {
        each(parts.to_vec(), &find).into_iter().for_each(|mut own| all.append(&mut own));
    }
    all
}

/// Where a stroke ends; a closed one ends at its vertex `start`.
fn end_place(stroke: &Stroke<'_>, start: u32, last: bool) -> PxPoint {
    if start > 0 && stroke.closed {
        stroke.vertices().get(start as usize).copied().unwrap_or_default()
    } else {
        stroke.end(last)
    }
}

/// The first vertex of each closed stroke at which another stroke ends; 0 where there is none.
fn starts_at_nodes(strokes: &[Stroke<'_>]) -> Vec<u32> {
    if strokes.iter().all(|stroke| !stroke.closed) {
        return Vec::new();
    }
    let mut nodes: Vec<(Key, usize)> = Vec::with_capacity(2 * strokes.len());
    for (index, stroke) in strokes.iter().enumerate().filter(|(_, stroke)| stroke.vertices().len() > 1) {
        nodes.extend([false, true].map(|last| (key(stroke, stroke.end(last)), index)));
    }
    nodes.sort_unstable();
    nodes.dedup();
    let met = |stroke: &Stroke<'_>, index: usize, at: PxPoint| {
        let key = key(stroke, at);
        let from = nodes.partition_point(|(node, _)| *node < key);
        nodes.iter().skip(from).take(2).any(|(node, owner)| *node == key && *owner != index)
    };
    let start = |(index, stroke): (usize, &Stroke<'_>)| {
        let meets = |at: &PxPoint| met(stroke, index, *at);
        if stroke.closed { stroke.vertices().iter().position(meets).map_or(0, number) } else { 0 }
    };
    strokes.iter().enumerate().map(start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::plan::{Leg, strokes_of};
    use crate::stroke::Drawing;

    const TIGHT: Joining = Joining { gap_px: 0.5, one_stroke: true, corner_gap_px: 0.0, pen_px: 0.0 };

    fn drawing(strokes: &[&[(f64, f64)]]) -> Drawing {
        let mut drawing = Drawing::new(100, 100);
        for stroke in strokes {
            drawing.push(stroke.iter().map(|(x, y)| PxPoint::new(*x, *y)));
        }
        drawing
    }

    /// Strokes of each trail, one more than their numbers, negative where drawn backwards; `o` for a ring.
    fn joined(drawing: &Drawing, gap_px: f64, one_stroke: bool) -> Vec<String> {
        let strokes = strokes_of(drawing);
        let (legs, trails) = trails(&strokes, &Joining { gap_px, one_stroke, ..TIGHT });
        let name = |trail: Trail| {
            let name = |leg: Leg| format!("{}{}", if leg.reversed { "-" } else { "" }, leg.stroke + 1);
            let names: Vec<String> = trail.legs(&legs.all).map(name).collect();
            format!("{}{}", if trail.closed { "o " } else { "" }, names.join(" "))
        };
        trails.into_iter().map(name).collect()
    }

    #[test]
    fn through_a_crossing_each_line_goes_straight_on() {
        let cross: [&[(f64, f64)]; 4] = [
            &[(0.0, 10.0), (10.0, 10.0)],
            &[(10.0, 0.0), (10.0, 10.0)],
            &[(10.0, 10.0), (20.0, 10.2)],
            &[(10.2, 20.0), (10.0, 10.0)],
        ];
        assert_eq!(joined(&drawing(&cross), 0.0, false), ["1 3", "2 -4"]);
    }

    #[test]
    fn a_gap_is_bridged_up_to_its_width_only() {
        let line = drawing(&[&[(0.0, 0.0), (10.0, 0.0)], &[(10.3, 0.4), (20.0, 0.4)]]);
        assert_eq!(joined(&line, 0.5, false), ["1 2"]);
        assert_eq!(joined(&line, 0.49, true), ["1", "2"]);
        // Not round a corner.
        let corner = drawing(&[&[(0.0, 0.0), (10.0, 0.0)], &[(10.0, 0.2), (10.0, 9.0)]]);
        assert_eq!(joined(&corner, 0.5, true), ["1", "2"]);
    }

    #[test]
    fn of_several_ways_on_the_straightest_is_taken_and_of_equals_the_nearest() {
        // The second stroke goes on more straight than the one before it.
        let fork: [&[(f64, f64)]; 3] =
            [&[(0.0, 10.0), (10.0, 10.0)], &[(10.0, 10.0), (20.0, 14.0)], &[(10.0, 10.0), (20.0, 10.5)]];
        assert_eq!(joined(&drawing(&fork), 0.0, false), ["1 3", "2"]);
        let gaps: [&[(f64, f64)]; 3] =
            [&[(0.0, 10.0), (10.0, 10.0)], &[(10.45, 10.0), (20.45, 10.0)], &[(10.25, 10.0), (20.25, 10.0)]];
        assert_eq!(joined(&drawing(&gaps), 0.5, false), ["1 3", "2"]);
    }

    #[test]
    fn what_is_left_at_a_node_is_paired_with_as_few_sharp_turns_as_can_be() {
        // Four rays to one side, 40 to 45 degrees apart: none goes straight on in another.
        let ray = |degrees: f64| {
            [
                (50.0, 50.0),
                (50.0 + 9.0 * libm::cos(degrees.to_radians()), 50.0 + 9.0 * libm::sin(degrees.to_radians())),
            ]
        };
        let rays = [0.0, 40.0, 85.0, 130.0].map(ray);
        let rays: Vec<&[(f64, f64)]> = rays.iter().map(|ray| &ray[..]).collect();
        assert_eq!(joined(&drawing(&rays), 0.0, true), ["-1 4", "-2 3"]);
    }

    #[test]
    fn strokes_of_two_letters_are_not_joined_whether_they_touch_or_nearly() {
        for gap in [0.0, 0.3] {
            let touching = drawing(&[&[(0.0, 0.0), (5.0, 0.0)], &[(5.0 + gap, 0.0), (9.0, 0.0)]]);
            let mut strokes = strokes_of(&touching);
            assert_eq!(trails(&strokes, &TIGHT).1.len(), 1);
            (strokes[0].letter, strokes[1].letter) = (1, 2);
            assert_eq!(trails(&strokes, &TIGHT).1.len(), 2, "{gap}");
        }
    }

    #[test]
    fn a_short_stroke_is_not_closed_over_the_gap_and_a_long_one_is() {
        let hook = |size: f64| drawing(&[&[(0.0, 0.0), (size, 0.0), (size, size), (0.0, 0.4)]]);
        assert_eq!(joined(&hook(1.0), 0.5, true), ["1"]);
        let round = [(0.0, 0.0), (3.0, -3.0), (6.0, 0.0), (3.0, 3.0), (0.0, 0.4)];
        assert_eq!(joined(&drawing(&[&round]), 0.5, true), ["1"]);
        let nearly = [(0.4, 0.0), (9.0, 0.0), (9.0, 9.0), (-9.0, 9.0), (-9.0, 0.0), (0.0, 0.0)];
        assert_eq!(joined(&drawing(&[&nearly]), 0.5, true), ["o 1"]);
    }

    #[test]
    fn four_sides_of_a_square_are_one_ring() {
        let square = drawing(&[
            &[(0.0, 0.0), (9.0, 0.0)],
            &[(0.0, 9.0), (9.0, 9.0)],
            &[(0.0, 0.0), (0.0, 9.0)],
            &[(9.0, 9.0), (9.0, 0.0)],
        ]);
        assert_eq!(joined(&square, 0.0, false), ["1", "2", "3", "4"]);
        assert_eq!(joined(&square, 0.0, true), ["o 1 -4 -2 -3"]);
    }

    #[test]
    fn rings_that_share_a_node_are_one_ring() {
        // Two closed strokes; the second one meets the first one's start with its third vertex.
        let eight = drawing(&[
            &[(5.0, 5.0), (9.0, 5.0), (9.0, 9.0), (5.0, 5.0)],
            &[(0.0, 0.0), (0.0, 5.0), (5.0, 5.0), (0.0, 0.0)],
        ]);
        let strokes = strokes_of(&eight);
        let (legs, trails) = trails(&strokes, &Joining { gap_px: 0.0, ..TIGHT });
        assert_eq!(trails.len(), 1);
        assert!(trails[0].closed);
        let vertices = legs.vertices(trails[0]);
        assert_eq!(vertices.len(), 7);
        assert_eq!(vertices.iter().filter(|at| **at == PxPoint::new(5.0, 5.0)).count(), 3);
    }

    #[test]
    fn the_house_of_santa_claus_is_one_stroke() {
        let (a, b, c, d, e) = ((0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0), (4.0, 12.0));
        let house = drawing(&[&[a, b], &[b, c], &[c, d], &[d, a], &[a, c], &[b, d], &[d, e], &[e, c]]);
        assert_eq!(joined(&house, 0.0, true).len(), 1);
    }

    #[test]
    fn what_is_left_within_the_gap_is_joined_round_corners_where_that_is_asked_for() {
        // A square of four strokes that do not quite meet.
        let square = drawing(&[
            &[(0.2, 0.0), (9.0, 0.0)],
            &[(0.0, 9.0), (9.0, 9.2)],
            &[(0.0, 0.0), (0.0, 8.8)],
            &[(9.2, 9.0), (9.0, 0.2)],
        ]);
        let strokes = strokes_of(&square);
        assert_eq!(trails(&strokes, &TIGHT).1.len(), 4);
        let (legs, trails) = trails(&strokes, &Joining { corner_gap_px: 0.5, ..TIGHT });
        assert_eq!((trails.len(), trails[0].closed, legs.vertices(trails[0]).len()), (1, true, 9));
    }

    #[test]
    fn ends_between_which_the_pen_has_drawn_are_joined_and_others_are_not() {
        // A stem that goes into a stroke from above and one that leaves it below, by a pen of 3 px.
        let stems: [&[(f64, f64)]; 3] =
            [&[(0.0, 50.0), (90.0, 50.0)], &[(40.0, 10.0), (40.0, 49.6)], &[(46.0, 50.4), (46.0, 90.0)]];
        let over_ink = |drawing: &Drawing| {
            trails(&strokes_of(drawing), &Joining { corner_gap_px: 3.0, pen_px: 3.0, ..TIGHT }).1.len()
        };
        assert_eq!(over_ink(&drawing(&stems)), 2);
        // Without the stroke there is paper between them, and far apart they are two for good.
        assert_eq!(over_ink(&drawing(&stems[1..])), 2);
        let far: [&[(f64, f64)]; 3] = [stems[0], stems[1], &[(53.0, 50.4), (53.0, 90.0)]];
        assert_eq!(over_ink(&drawing(&far)), 3);
        // In the ink of the stroke, but beside its middle, the way would be a line of its own.
        let beside: [&[(f64, f64)]; 3] =
            [stems[0], &[(40.0, 10.0), (40.0, 48.5)], &[(46.0, 51.5), (46.0, 90.0)]];
        assert_eq!(over_ink(&drawing(&beside)), 3);
        // Dashes stay apart where a pixel of paper lies between them.
        let dashes: [&[(f64, f64)]; 2] = [&[(0.0, 5.0), (20.0, 5.0)], &[(24.0, 5.0), (40.0, 5.0)]];
        assert_eq!(over_ink(&drawing(&dashes)), 2);
    }

    #[test]
    fn a_dot_is_left_alone() {
        let dots = drawing(&[&[(1.0, 1.0)], &[(1.0, 1.0), (4.0, 1.0)], &[(1.0, 1.0)]]);
        assert_eq!(joined(&dots, 0.5, true), ["1", "2", "3"]);
    }
}
