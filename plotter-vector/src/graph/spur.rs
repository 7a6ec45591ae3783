//! Spurs: short branches that thinning grows out of a rough edge.

use super::arm::{TYPICAL_SITES, typical_width_px};
use super::site::Scan;
use super::sites::Sites;
use super::{End, Graph};
use crate::PxPoint;
use core::cell::OnceCell;

/// Rounds of pruning: a spur's own spur makes it look like a fork until it is gone.
const ROUNDS: usize = 2;

/// The edges that are spurs, found out when it is first asked.
///
/// A branch is one when its tip sticks out of the line that it leaves by less than half that line's width. What
/// sticks out is the branch's length and the ink around its tip, less the ink around its root. Of the lines at a
/// node at least two stay.
pub(super) struct Spurs<'a> {
    graph: &'a Graph,
    sites: &'a Sites<'a>,
    scan: Scan<'a>,
    /// Edges that are gone anyway.
    dots: &'a [bool],
    /// What is known of each edge.
    gone: Vec<OnceCell<bool>>,
    /// For each node the edges that go in a round.
    pruned: [Vec<OnceCell<Vec<usize>>>; ROUNDS],
}

impl<'a> Spurs<'a> {
    /// For a graph some of whose edges are gone already: those of its `dots`.
    pub(super) fn new(graph: &'a Graph, sites: &'a Sites<'a>, scan: Scan<'a>, dots: &'a [bool]) -> Self {
        Self {
            graph,
            sites,
            scan,
            dots,
            gone: vec![OnceCell::new(); graph.edges.len()],
            pruned: [(); ROUNDS].map(|()| vec![OnceCell::new(); graph.nodes.len()]),
        }
    }

    /// Whether an edge is a spur, or gone before.
    pub(super) fn has(&self, edge: usize) -> bool {
        let find = || self.dots.get(edge).copied().unwrap_or(true) || self.goes(edge, ROUNDS);
        self.gone.get(edge).is_none_or(|gone| *gone.get_or_init(find))
    }

    /// Whether an edge goes in one of the first rounds.
    fn goes(&self, edge: usize, rounds: usize) -> bool {
        let Some(last) = rounds.checked_sub(1) else { return false };
        let Some((a, b)) = self.graph.edges.get(edge).and_then(|edge| edge.nodes) else { return false };
        self.goes(edge, last) || [a, b].into_iter().any(|node| self.pruned(node, last).contains(&edge))
    }

    /// The ends at a node that are left after some rounds.
    fn left(&self, node: usize, rounds: usize) -> impl Iterator<Item = End> + '_ {
        let ends = self.graph.nodes.get(node).map_or(&[][..], |node| &node.ends);
        ends.iter().copied().filter(move |end| !self.goes(end.edge, rounds))
    }

    /// The edges that go at a node in the round after so many.
    fn pruned(&self, node: usize, rounds: usize) -> &[usize] {
        let several = self.graph.nodes.get(node).is_some_and(|node| node.ends.len() > 2);
        let memory = self.pruned.get(rounds).and_then(|round| round.get(node)).filter(|_| several);
        memory.map_or(&[], |memory| memory.get_or_init(|| self.short(node, rounds)))
    }

    fn short(&self, node: usize, rounds: usize) -> Vec<usize> {
        let left: Vec<End> = self.left(node, rounds).collect();
        let Some(at) = self.graph.nodes.get(node).map(|node| node.at).filter(|_| left.len() > 2) else {
            return Vec::new();
        };
        let root_px = self.scan.radius_px(at.into(), f64::MAX);
        let width_px = left.iter().map(|end| width_px(self.sites, *end)).fold(2.0 * root_px, f64::min);
        if width_px <= self.scan.thin_px() {
            return Vec::new();
        }
        let mut short: Vec<(f64, usize)> = left
            .iter()
            .filter_map(|end| Some((self.sticks_out_px(rounds, *end, at.into(), root_px)?, end.edge)))
            .filter(|(out_px, _)| *out_px < 0.5 * width_px + 0.25)
            .collect();
        // The shortest ones first; two lines stay.
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        short.into_iter().take(left.len() - 2).map(|(_, edge)| edge).collect()
    }

    /// How far a branch sticks out of the ink around its root; `None` for what is no branch, or a long one.
    fn sticks_out_px(&self, rounds: usize, end: End, root: PxPoint, root_px: f64) -> Option<f64> {
        let (first, last) = self.graph.edges.get(end.edge)?.nodes?;
        let far = if end.at_last { first } else { last };
        if first == last || self.left(far, rounds).count() != 1 {
            return None;
        }
        let tip = PxPoint::from(self.graph.nodes.get(far)?.at);
        let length_px = root.distance(tip);
        // No need to measure the ink around the tips of long lines.
        (length_px < 3.0 * root_px + 2.0)
            .then(|| length_px + self.scan.radius_px(tip, root_px + 1.0) - root_px)
    }
}

/// Typical width of the line that begins at an end.
fn width_px(sites: &Sites<'_>, end: End) -> f64 {
    let sites = sites.get(end.edge).unwrap_or(&[]);
    let first = if end.at_last { sites.len().saturating_sub(TYPICAL_SITES) } else { 0 };
    typical_width_px(sites.get(first..sites.len().min(first + TYPICAL_SITES)).unwrap_or(&[]))
}
