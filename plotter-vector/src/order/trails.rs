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
use super::plan::{Piece, Stroke, Trail};
use super::point_tree::PointTree;
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

/// Joins strokes end to end. Ends within `gap_px` are joined where the line goes on; with `one_stroke` so are ends in
/// exactly one place, whatever the angle. Trails come in the order of their first strokes.
pub(crate) fn trails(strokes: &[Stroke<'_>], gap_px: f64, one_stroke: bool) -> Vec<Trail> {
    let mut meeting = Meeting::new(strokes, one_stroke);
    meeting.go_on_straight(gap_px);
    if one_stroke {
        meeting.pair_the_rest();
        meeting.splice();
    }
    meeting.assemble()
}

/// Where the strokes' ends meet, and which goes on in which. An end is twice its stroke's number, and 1 more for the
/// last vertex.
struct Meeting<'a> {
    strokes: &'a [Stroke<'a>],
    /// First vertex of each closed stroke.
    starts: Vec<usize>,
    /// Ends by node, and in a node by direction.
    ends: Vec<usize>,
    /// One past the last end of each node, in `ends`.
    nodes: Vec<usize>,
    /// Node of each end.
    node_of: Vec<Option<usize>>,
    partners: Vec<Option<usize>>,
}

/// What joins: the pen, the letter and the place.
type Key = (u8, usize, u64, u64);

fn key(stroke: &Stroke<'_>, at: PxPoint) -> Key {
    // Adding 0.0 makes one zero of the two.
    (stroke.pen, stroke.letter, (at.x + 0.0).to_bits(), (at.y + 0.0).to_bits())
}

impl<'a> Meeting<'a> {
    fn new(strokes: &'a [Stroke<'a>], one_stroke: bool) -> Self {
        let starts = if one_stroke { starts_at_nodes(strokes) } else { vec![0; strokes.len()] };
        let mut keyed: Vec<(Key, f64, usize)> = Vec::with_capacity(2 * strokes.len());
        for (index, stroke) in strokes.iter().enumerate().filter(|(_, stroke)| stroke.vertices.len() > 1) {
            for last in [false, true] {
                let (at, direction) = tip(stroke, starts.get(index).copied().unwrap_or(0), last);
                let angle = libm::atan2(direction.1, direction.0);
                keyed.push((key(stroke, at), angle, 2 * index + usize::from(last)));
            }
        }
        keyed.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut node_of = vec![None; 2 * strokes.len()];
        let mut nodes = Vec::new();
        for run in keyed.chunk_by(|a, b| a.0 == b.0) {
            for (_, _, end) in run {
                if let Some(slot) = node_of.get_mut(*end) {
                    *slot = Some(nodes.len());
                }
            }
            nodes.push(nodes.last().unwrap_or(&0) + run.len());
        }
        let mut meeting = Self {
            strokes,
            starts,
            ends: keyed.into_iter().map(|(_, _, end)| end).collect(),
            nodes,
            node_of,
            partners: vec![None; 2 * strokes.len()],
        };
        for index in
            (0..strokes.len()).filter(|index| strokes.get(*index).is_some_and(|stroke| stroke.closed))
        {
            meeting.connect(2 * index, 2 * index + 1);
        }
        meeting
    }

    fn node(&self, index: usize) -> &[usize] {
        let from = index.checked_sub(1).and_then(|before| self.nodes.get(before)).copied().unwrap_or(0);
        self.nodes.get(index).and_then(|to| self.ends.get(from..*to)).unwrap_or(&[])
    }

    fn partner(&self, end: usize) -> Option<usize> {
        self.partners.get(end).copied().flatten()
    }

    fn connect(&mut self, a: usize, b: usize) {
        for (end, other) in [(a, b), (b, a)] {
            if let Some(slot) = self.partners.get_mut(end) {
                *slot = Some(other);
            }
        }
    }

    fn tip(&self, end: usize) -> (PxPoint, (f64, f64)) {
        let start = self.starts.get(end / 2).copied().unwrap_or(0);
        self.strokes.get(end / 2).map(|stroke| tip(stroke, start, end % 2 == 1)).unwrap_or_default()
    }

    fn place(&self, end: usize) -> PxPoint {
        self.tip(end).0
    }

    fn outward(&self, end: usize) -> (f64, f64) {
        self.tip(end).1
    }

    /// Cosine between the directions in which two ends point: −1 when the line goes straight on, 1 for a hairpin.
    fn hairpin(&self, a: usize, b: usize) -> f64 {
        let (a, b) = (self.outward(a), self.outward(b));
        a.0 * b.0 + a.1 * b.1
    }

    /// Pairs ends within the gap that go on in each other, the straightest first.
    fn go_on_straight(&mut self, gap_px: f64) {
        let places: Vec<PxPoint> = (0..self.nodes.len())
            .map(|node| self.node(node).first().map_or(PxPoint::default(), |end| self.place(*end)))
            .collect();
        let tree = PointTree::new(places.iter().copied().take(if gap_px > 0.0 { places.len() } else { 0 }));
        let mut pairs: Vec<(f64, f64, usize, usize)> = Vec::new();
        let mut near: Vec<usize> = Vec::new();
        // A little more, for the rounding of the differences.
        let reach = gap_px * gap_px * (1.0 + 1e-9);
        for (node, at) in places.iter().enumerate() {
            let own = self.node(node);
            if own.iter().all(|end| self.partner(*end).is_some()) {
                continue;
            }
            near.clear();
            tree.visit(*at, reach, &mut |other, squared| {
                let other = other as usize;
                if other != node {
                    near.push(other);
                }
                if near.len() < NEAR_NODES { reach } else { -squared }
            });
            for end in own.iter().filter(|end| self.partner(**end).is_none()) {
                for other in core::iter::once(node).chain(near.iter().copied()) {
                    for partner in self.offers(*end, other) {
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
    fn offers(&self, end: usize, node: usize) -> impl Iterator<Item = usize> {
        let ends = self.node(node);
        let angle = |end: usize| {
            let (x, y) = self.outward(end);
            libm::atan2(y, x)
        };
        let turn = core::f64::consts::PI;
        let opposite = if angle(end) > 0.0 { angle(end) - turn } else { angle(end) + turn };
        let from = ends.partition_point(|other| angle(*other) < opposite) + ends.len();
        // Round the node, a few on either side; a small node is looked at whole, each end once.
        let few = (2 * OFFERS + 2).min(ends.len());
        let first = from - few / 2;
        (first..first + few).filter_map(move |index| ends.get(index % ends.len().max(1)).copied())
    }

    /// Whether two ends are free, of the same pen and letter, and not those of one stroke too short to be closed.
    fn may_join(&self, a: usize, b: usize, gap_px: f64) -> bool {
        let (Some(of_a), Some(of_b)) = (self.strokes.get(a / 2), self.strokes.get(b / 2)) else {
            return false;
        };
        let closes = || a != b && of_a.length_px() > CLOSED_GAPS * gap_px;
        self.partner(b).is_none()
            && (of_a.pen, of_a.letter) == (of_b.pen, of_b.letter)
            && (a / 2 != b / 2 || closes())
    }

    /// Pairs the free ends of each node, the straightest first, until at most one is left.
    fn pair_the_rest(&mut self) {
        for node in 0..self.nodes.len() {
            let mut free: Vec<usize> =
                self.node(node).iter().copied().filter(|end| self.partner(*end).is_none()).collect();
            if free.len() > ALL_PAIRS {
                // In order of direction: each with the one half round.
                let (half, rest) = free.split_at(free.len() / 2);
                let pairs: Vec<(usize, usize)> = half.iter().copied().zip(rest.iter().copied()).collect();
                pairs.into_iter().for_each(|(a, b)| self.connect(a, b));
                continue;
            }
            while let Some((a, b)) = self.straightest(&free) {
                self.connect(a, b);
                free.retain(|end| *end != a && *end != b);
            }
        }
    }

    fn straightest(&self, free: &[usize]) -> Option<(usize, usize)> {
        let pairs =
            free.iter().enumerate().flat_map(|(index, a)| free.iter().skip(index + 1).map(move |b| (*a, *b)));
        pairs.min_by(|a, b| self.hairpin(a.0, a.1).total_cmp(&self.hairpin(b.0, b.1)))
    }

    /// Opens each ring at a node that it shares with another trail, and goes round it from there.
    fn splice(&mut self) {
        let (mut chains, open) = self.chains();
        for node in 0..self.nodes.len() {
            let ends = self.node(node).to_vec();
            let roots: Vec<usize> = ends.iter().map(|end| chains.root(end / 2)).collect();
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

    fn same_node(&self, a: usize, b: usize) -> bool {
        self.node_of.get(a) == self.node_of.get(b)
    }

    /// Puts the ring that goes through its node from `a` to `b` between `host` and what follows it there.
    fn open_ring(&mut self, host: usize, a: usize, b: usize) {
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
                if let Some(slot) = self.partners.get_mut(b) {
                    *slot = None;
                }
            }
        }
    }

    /// The strokes by trail, and whether the trail of each root is open.
    fn chains(&self) -> (Forest, Vec<bool>) {
        let mut chains = Forest::new(self.strokes.len());
        for (end, partner) in self.partners.iter().enumerate() {
            if let Some(partner) = partner {
                chains.join(end / 2, partner / 2);
            }
        }
        let mut open = vec![false; self.strokes.len()];
        for end in (0..self.partners.len()).filter(|end| self.partner(*end).is_none()) {
            if let Some(slot) = open.get_mut(chains.root(end / 2)) {
                *slot = true;
            }
        }
        (chains, open)
    }

    /// The trails: those with free ends from the free end, then the rings from their first stroke.
    fn assemble(&self) -> Vec<Trail> {
        let mut done = vec![false; self.strokes.len()];
        let mut found: Vec<(usize, Trail)> = Vec::new();
        let free = (0..self.partners.len()).filter(|end| self.partner(*end).is_none());
        let rings = (0..self.strokes.len()).map(|stroke| 2 * stroke);
        for entry in free.chain(rings) {
            if done.get(entry / 2) != Some(&false) {
                continue;
            }
            let mut trail = Trail { closed: self.partner(entry).is_some(), ..Trail::default() };
            let mut next = Some(entry);
            let mut least = entry / 2;
            while let Some(end) = next.filter(|end| done.get(end / 2) == Some(&false)) {
                let start = self.starts.get(end / 2).copied().unwrap_or(0);
                trail.pieces.push(Piece { stroke: end / 2, reversed: end % 2 == 1, start });
                if let Some(flag) = done.get_mut(end / 2) {
                    *flag = true;
                }
                least = least.min(end / 2);
                next = self.partner(end ^ 1);
            }
            found.push((least, trail));
        }
        found.sort_by_key(|(least, _)| *least);
        found.into_iter().map(|(_, trail)| trail).collect()
    }
}

/// Where a stroke ends, and in which direction; a closed stroke ends at its vertex `start`.
fn tip(stroke: &Stroke<'_>, start: usize, last: bool) -> (PxPoint, (f64, f64)) {
    let [first_outward, last_outward] = stroke.outward;
    if let (Some(before), true) = (start.checked_sub(1), stroke.closed) {
        let at = stroke.vertices.get(start).copied().unwrap_or_default();
        let heading = |index| stroke.course.piece(index).map_or((0.0, 0.0), |piece| piece.heading(last));
        let (x, y) = heading(if last { before } else { start });
        return (at, if last { (x, y) } else { (-x, -y) });
    }
    (stroke.end(last), if last { last_outward } else { first_outward })
}

/// The first vertex of each closed stroke at which another stroke ends; 0 where there is none.
fn starts_at_nodes(strokes: &[Stroke<'_>]) -> Vec<usize> {
    let mut nodes: Vec<(Key, usize)> = Vec::with_capacity(2 * strokes.len());
    for (index, stroke) in strokes.iter().enumerate().filter(|(_, stroke)| stroke.vertices.len() > 1) {
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
        if stroke.closed { stroke.vertices.iter().position(meets).unwrap_or(0) } else { 0 }
    };
    strokes.iter().enumerate().map(start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Drawing;
    use crate::order::plan::strokes_of;

    fn drawing(strokes: &[&[(f64, f64)]]) -> Drawing {
        let mut drawing = Drawing::new(100, 100);
        for stroke in strokes {
            drawing.push(stroke.iter().map(|(x, y)| PxPoint::new(*x, *y)));
        }
        drawing
    }

    /// Strokes of each trail, one more than their numbers, negative where drawn backwards; `o` for a ring.
    fn joined(drawing: &Drawing, gap_px: f64, one_stroke: bool) -> Vec<String> {
        let name = |trail: Trail| {
            let name =
                |piece: &Piece| format!("{}{}", if piece.reversed { "-" } else { "" }, piece.stroke + 1);
            let names: Vec<String> = trail.pieces.iter().map(name).collect();
            format!("{}{}", if trail.closed { "o " } else { "" }, names.join(" "))
        };
        trails(&strokes_of(drawing), gap_px, one_stroke).into_iter().map(name).collect()
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
            assert_eq!(trails(&strokes, 0.5, true).len(), 1);
            (strokes[0].letter, strokes[1].letter) = (1, 2);
            assert_eq!(trails(&strokes, 0.5, true).len(), 2, "{gap}");
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
        let trails = trails(&strokes, 0.0, true);
        assert_eq!(trails.len(), 1);
        assert!(trails[0].closed);
        let vertices = trails[0].vertices(&strokes);
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
    fn a_dot_is_left_alone() {
        let dots = drawing(&[&[(1.0, 1.0)], &[(1.0, 1.0), (4.0, 1.0)], &[(1.0, 1.0)]]);
        assert_eq!(joined(&dots, 0.5, true), ["1", "2", "3"]);
    }
}
