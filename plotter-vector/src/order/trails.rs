//! [`trails`]: strokes whose ends meet become one stroke.
//!
//! ```text
//!      a│      straight on, one partner an end:      the rest, where the drawing allows it:
//!    ───┼───   a goes on in d, b in c                ┌──┐  two rings that share a node are one,
//!    b  │  c                                         └──┼──┐  and four strokes that make a square are one
//!      d│                                               └──┘
//! ```
//!
//! The strokes are the edges of a multigraph, the places where they end are its nodes. Each end gets at most one
//! partner at its node; a choice of partners is a set of trails and rings. First the straightest pairs are made, then
//! what is left of each node is paired, so that at most one end of it is free; then each ring that shares a node with
//! another trail is spliced into it, as in Hierholzer's proof ("Ueber die Möglichkeit, einen Linienzug ohne
//! Wiederholung und ohne Unterbrechung zu umfahren", Mathematische Annalen 6, 1873). A connected component with 2k
//! ends in odd nodes then is max(1, k) trails, fewer is impossible.

use super::forest::Forest;
use super::plan::{Parts, Piece, Stroke, Trail};
use super::point_tree::PointTree;
use super::sites::number;
use crate::PxPoint;

/// Greatest cosine between the outward directions of two ends that go on in each other: they bend by 45° at most.
const STRAIGHT_COS: f64 = -core::f64::consts::FRAC_1_SQRT_2;

/// Nodes within the gap that an end looks at, partners each node offers it on either side of straight on, and ends of
/// a node of which all pairs are looked at: limits for drawings that meet in few places.
const NEAR_NODES: usize = 16;
const OFFERS: usize = 2;
const ALL_PAIRS: usize = 24;

/// Fewest gaps' lengths of a stroke that is closed with itself.
const CLOSED_GAPS: f64 = 8.0;

/// Which ends are joined.
pub(crate) struct Joining {
    /// Ends so near are joined where the line goes on.
    pub(crate) gap_px: f64,
    /// And ends in exactly one place, whatever the angle.
    pub(crate) one_stroke: bool,
    /// And then what is left within the gap, whatever the angle.
    pub(crate) at_corners: bool,
}

/// Joins strokes end to end. Trails come in the order of their first strokes.
pub(crate) fn trails<'a>(strokes: &'a [Stroke<'a>], joining: &Joining) -> (Parts<'a>, Vec<Trail>) {
    let mut meeting = Meeting::new(strokes, joining.one_stroke);
    let gap_px = if joining.gap_px > 0.0 { joining.gap_px } else { 0.0 };
    let searched = if gap_px > 0.0 { meeting.places.len() } else { 0 };
    let tree = PointTree::new(meeting.places.iter().copied().take(searched));
    meeting.go_on_straight(&tree, gap_px);
    if joining.one_stroke {
        meeting.pair_the_rest();
        if joining.at_corners {
            meeting.bridge_the_rest(&tree, gap_px);
        }
        meeting.splice();
    }
    drop(tree);
    meeting.assemble()
}

/// Where the strokes' ends meet, and which goes on in which. An end is twice its stroke's number, and 1 more for the
/// last vertex.
struct Meeting<'a> {
    strokes: &'a [Stroke<'a>],
    /// First vertex of each closed stroke.
    starts: Vec<u32>,
    /// Ends by node, and in a node by direction.
    ends: Vec<u32>,
    /// One past the last end of each node, in `ends`.
    nodes: Vec<u32>,
    /// Where each node lies.
    places: Vec<PxPoint>,
    /// Node of each end; `NONE` of a dot's.
    node_of: Vec<u32>,
    /// What each end goes on in; `NONE` where it ends.
    partners: Vec<u32>,
}

/// No end, and no node.
const NONE: u32 = u32::MAX;

/// What joins: the pen and the letter, and the place.
type Key = (u64, u64, u64);

fn key(stroke: &Stroke<'_>, at: PxPoint) -> Key {
    // Adding 0.0 makes one zero of the two.
    (u64::from(stroke.pen) << 32 | u64::from(stroke.letter), (at.x + 0.0).to_bits(), (at.y + 0.0).to_bits())
}

impl<'a> Meeting<'a> {
    fn new(strokes: &'a [Stroke<'a>], one_stroke: bool) -> Self {
        let starts = if one_stroke { starts_at_nodes(strokes) } else { vec![0; strokes.len()] };
        let mut keyed: Vec<(Key, u32)> = Vec::with_capacity(2 * strokes.len());
        for (stroke, index) in strokes.iter().zip(0_u32..).filter(|(stroke, _)| stroke.vertices().len() > 1) {
            for last in [false, true] {
                let (at, _) = tip(stroke, starts.get(index as usize).copied().unwrap_or(0), last);
                keyed.push((key(stroke, at), 2 * index + u32::from(last)));
            }
        }
        keyed.sort_unstable();
        let mut meeting = Self {
            strokes,
            starts,
            ends: keyed.iter().map(|(_, end)| *end).collect(),
            nodes: Vec::new(),
            places: Vec::new(),
            node_of: vec![NONE; 2 * strokes.len()],
            partners: vec![NONE; 2 * strokes.len()],
        };
        let mut from = 0;
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            for (_, end) in same {
                if let Some(slot) = meeting.node_of.get_mut(*end as usize) {
                    *slot = number(meeting.nodes.len());
                }
            }
            if same.len() > 1 {
                let mut by_angle: Vec<(f64, u32)> =
                    same.iter().map(|(_, end)| (meeting.angle(*end), *end)).collect();
                by_angle.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let slots = meeting.ends.iter_mut().skip(from);
                slots.zip(by_angle).for_each(|(slot, (_, end))| *slot = end);
            }
            from += same.len();
            meeting.nodes.push(number(from));
            let at = same.first().map(|((_, x, y), _)| PxPoint::new(f64::from_bits(*x), f64::from_bits(*y)));
            meeting.places.extend(at);
        }
        for (_, index) in strokes.iter().zip(0_u32..).filter(|(stroke, _)| stroke.closed) {
            meeting.connect(2 * index, 2 * index + 1);
        }
        meeting
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

    fn tip(&self, end: u32) -> (PxPoint, (f64, f64)) {
        let start = self.start(end / 2);
        self.strokes.get(end as usize / 2).map(|stroke| tip(stroke, start, end % 2 == 1)).unwrap_or_default()
    }

    fn start(&self, stroke: u32) -> u32 {
        self.starts.get(stroke as usize).copied().unwrap_or(0)
    }

    fn place(&self, end: u32) -> PxPoint {
        self.tip(end).0
    }

    fn outward(&self, end: u32) -> (f64, f64) {
        self.tip(end).1
    }

    /// Direction in which an end points.
    fn angle(&self, end: u32) -> f64 {
        let (x, y) = self.outward(end);
        libm::atan2(y, x)
    }

    /// Cosine between the directions in which two ends point: −1 when the line goes straight on, 1 for a hairpin.
    fn hairpin(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (self.outward(a), self.outward(b));
        a.0 * b.0 + a.1 * b.1
    }

    /// Pairs ends within the gap that go on in each other, the straightest first.
    fn go_on_straight(&mut self, tree: &PointTree, gap_px: f64) {
        let mut pairs: Vec<(f64, f64, u32, u32)> = Vec::new();
        let mut near: Vec<u32> = Vec::new();
        for (node, at) in (0..).zip(&self.places) {
            let own = self.node(node);
            if own.iter().all(|end| self.partner(*end).is_some()) {
                continue;
            }
            nodes_near(tree, (node, *at), gap_px, &mut near);
            for end in own.iter().filter(|end| self.partner(**end).is_none()) {
                for other in core::iter::once(node).chain(near.iter().copied()) {
                    for partner in self.offers(*end, other).filter(|partner| partner != end) {
                        let cos = self.hairpin(*end, partner);
                        if cos <= STRAIGHT_COS && self.may_join(*end, partner, gap_px) {
                            let far = self.place(*end).distance(self.place(partner));
                            pairs.push((cos, far, (*end).min(partner), (*end).max(partner)));
                        }
                    }
                }
            }
        }
        // Ends in one place come before ends across a gap only where they are as straight.
        pairs.sort_unstable_by(|a, b| {
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then((a.2, a.3).cmp(&(b.2, b.3)))
        });
        for (_, _, a, b) in pairs {
            if self.partner(a).is_none() && self.partner(b).is_none() {
                self.connect(a, b);
            }
        }
    }

    /// The ends of a node nearest to straight on from `end`.
    fn offers(&self, end: u32, node: u32) -> impl Iterator<Item = u32> {
        let ends = self.node(node);
        // Round the node, a few on either side; a small node is looked at whole, each end once.
        let few = (2 * OFFERS + 2).min(ends.len());
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

    /// Whether two ends are free, of the same pen and letter, and not those of one stroke too short to be closed.
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

    /// Pairs the free end of each node with that of another one within the gap, the nearest first.
    fn bridge_the_rest(&mut self, tree: &PointTree, gap_px: f64) {
        let mut pairs: Vec<(f64, u32, u32)> = Vec::new();
        let mut near: Vec<u32> = Vec::new();
        let free = |node: u32| self.node(node).iter().copied().find(|end| self.partner(*end).is_none());
        for (node, at) in (0..).zip(&self.places) {
            let Some(end) = free(node) else { continue };
            nodes_near(tree, (node, *at), gap_px, &mut near);
            for partner in near.iter().filter_map(|other| free(*other)) {
                if self.may_join(end, partner, gap_px) {
                    pairs.push((at.distance(self.place(partner)), end.min(partner), end.max(partner)));
                }
            }
        }
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
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

    /// All ends with their partners.
    fn pairs(&self) -> impl Iterator<Item = (u32, Option<u32>)> {
        (0..)
            .zip(&self.partners)
            .map(|(end, partner)| (end, Some(*partner).filter(|partner| *partner != NONE)))
    }

    /// The strokes by trail, and whether the trail of each root is open.
    fn chains(&self) -> (Forest, Vec<bool>) {
        let mut chains = Forest::new(self.strokes.len());
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

    /// The trails: those with free ends from the free end, then the rings from their first stroke.
    fn assemble(&self) -> (Parts<'a>, Vec<Trail>) {
        let mut done = vec![false; self.strokes.len()];
        let mut parts = Parts::new(self.strokes);
        let mut found: Vec<(u32, Trail)> = Vec::with_capacity(self.strokes.len());
        let free = self.pairs().filter(|(_, partner)| partner.is_none()).map(|(end, _)| end);
        let rings = (0..number(self.strokes.len())).map(|stroke| 2 * stroke);
        for entry in free.chain(rings) {
            let mut next = Some(entry);
            let mut least = NONE;
            let pieces = core::iter::from_fn(|| {
                let end = next?;
                let flag = done.get_mut(end as usize / 2).filter(|done| !**done)?;
                *flag = true;
                least = least.min(end / 2);
                next = self.partner(end ^ 1);
                Some(Piece { stroke: end / 2, reversed: end % 2 == 1, start: self.start(end / 2) })
            });
            let trail = parts.push(pieces, self.partner(entry).is_some());
            if least != NONE {
                found.push((least, trail));
            }
        }
        found.sort_by_key(|(least, _)| *least);
        (parts, found.into_iter().map(|(_, trail)| trail).collect())
    }
}

/// The nodes within the gap of one, besides itself; not all where there are very many.
fn nodes_near(tree: &PointTree, (node, at): (u32, PxPoint), gap_px: f64, near: &mut Vec<u32>) {
    // A little more, for the rounding of the differences.
    let reach = gap_px * gap_px * (1.0 + 1e-9);
    near.clear();
    tree.visit(at, reach, &mut |other, squared| {
        if other != node {
            near.push(other);
        }
        if near.len() < NEAR_NODES { reach } else { -squared }
    });
}

/// Where a stroke ends, and in which direction; a closed stroke ends at its vertex `start`.
fn tip(stroke: &Stroke<'_>, start: u32, last: bool) -> (PxPoint, (f64, f64)) {
    let [first_outward, last_outward] = stroke.outward;
    if let (Some(before), true) = (start.checked_sub(1), stroke.closed) {
        let at = stroke.vertices().get(start as usize).copied().unwrap_or_default();
        let heading = |index: u32| {
            stroke.course().piece(index as usize).map_or((0.0, 0.0), |piece| piece.heading(last))
        };
        let (x, y) = heading(if last { before } else { start });
        return (at, if last { (x, y) } else { (-x, -y) });
    }
    (stroke.end(last), if last { last_outward } else { first_outward })
}

/// The first vertex of each closed stroke at which another stroke ends; 0 where there is none.
fn starts_at_nodes(strokes: &[Stroke<'_>]) -> Vec<u32> {
    if strokes.iter().all(|stroke| !stroke.closed) {
        return vec![0; strokes.len()];
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
    use crate::Drawing;
    use crate::order::plan::strokes_of;

    const TIGHT: Joining = Joining { gap_px: 0.5, one_stroke: true, at_corners: false };

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
        let (parts, trails) = trails(&strokes, &Joining { gap_px, one_stroke, at_corners: false });
        let name = |trail: Trail| {
            let name =
                |piece: Piece| format!("{}{}", if piece.reversed { "-" } else { "" }, piece.stroke + 1);
            let names: Vec<String> = trail.pieces(&parts.pieces).map(name).collect();
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
        let (parts, trails) = trails(&strokes, &Joining { gap_px: 0.0, ..TIGHT });
        assert_eq!(trails.len(), 1);
        assert!(trails[0].closed);
        let vertices = parts.vertices(trails[0]);
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
        let (parts, trails) = trails(&strokes, &Joining { at_corners: true, ..TIGHT });
        assert_eq!((trails.len(), trails[0].closed, parts.vertices(trails[0]).len()), (1, true, 9));
    }

    #[test]
    fn a_dot_is_left_alone() {
        let dots = drawing(&[&[(1.0, 1.0)], &[(1.0, 1.0), (4.0, 1.0)], &[(1.0, 1.0)]]);
        assert_eq!(joined(&dots, 0.5, true), ["1", "2", "3"]);
    }
}
