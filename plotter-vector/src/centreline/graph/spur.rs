//! Spurs: short branches that thinning grows out of a rough edge.

use super::arm::{TYPICAL_SITES, typical_width_px};
use super::line_end::{AT_RIM_PX, MOST_CUT_RADII};
use super::site::{Scan, Side, slack_px};
use super::sites::Sites;
use super::{End, Graph};
use crate::stroke::PxPoint;
use core::cell::OnceCell;

/// Rounds of pruning: a spur's own spur makes it look like a fork until it is gone.
const ROUNDS: usize = 2;

/// What sticks out less is the raster's own, px.
const ROUGH_PX: f64 = 1.25;

/// A short branch that leads nowhere else.
#[derive(Clone, Copy)]
struct Branch {
    /// How far it sticks out of the ink around its root, px.
    out_px: f64,
    /// Whether it leads into a corner of the ink: the discs of ink along it get evenly smaller, up to a tip.
    tapers: bool,
    /// Where it leads to at the picture's rim: the ink there.
    cut: Option<(Side, f64, f64)>,
}

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
        let branches: Vec<(End, Option<Branch>)> =
            left.iter().map(|end| (*end, self.branch(rounds, *end, at.into(), root_px))).collect();
        if branches.iter().all(|(_, branch)| branch.is_none()) {
            return Vec::new();
        }
        let narrowest_px = |corners_too: bool| {
            let counts = |branch: &Option<Branch>| corners_too || branch.is_none_or(|branch| !branch.tapers);
            let ends = branches.iter().filter(|(_, branch)| counts(branch));
            ends.map(|(end, _)| width_px(self.sites, *end)).fold(2.0 * root_px, f64::min)
        };
        let width_px = narrowest_px(true);
        if width_px <= self.scan.thin_px() {
            return Vec::new();
        }
        // Into a corner of the ink the branch itself gets narrower, not its line.
        let line_px = narrowest_px(false);
        // Both corners of a line that the rim cuts are at the ends of the same ink there.
        let is_corner_of_cut = |branch: &Branch| {
            let at_same = |(_, other): &&(End, Option<Branch>)| {
                other.is_some_and(|other| branch.cut.is_some() && other.cut == branch.cut)
            };
            branches.iter().filter(at_same).count() > 1
        };
        let is_short = |branch: &Branch| {
            branch.out_px < 0.5 * if branch.tapers { line_px } else { width_px } + 0.25
                || branch.tapers && is_corner_of_cut(branch)
        };
        let mut short: Vec<(f64, usize, bool)> = branches
            .iter()
            .filter_map(|(end, branch)| branch.filter(is_short).map(|branch| (end.edge, branch)))
            .map(|(edge, branch)| (branch.out_px, edge, branch.tapers))
            .collect();
        // The shortest ones first; two lines stay, and one whose end has nothing but corners.
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let is_corner = |(out_px, _, tapers): &(f64, usize, bool)| *tapers || *out_px < ROUGH_PX;
        let is_end = short.len() + 1 == left.len() && short.iter().all(is_corner);
        let most = if is_end { short.len() } else { left.len() - 2 };
        short.into_iter().take(most).map(|(_, edge, _)| edge).collect()
    }

    /// The branch at an end; `None` for what is no branch, or a long one.
    fn branch(&self, rounds: usize, end: End, root: PxPoint, root_px: f64) -> Option<Branch> {
        let pixels = &self.graph.edges.get(end.edge)?.pixels;
        let (first, last) = self.graph.edges.get(end.edge)?.nodes?;
        let far = if end.at_last { first } else { last };
        if first == last || self.left(far, rounds).count() != 1 {
            return None;
        }
        let tip = PxPoint::from(self.graph.nodes.get(far)?.at);
        let length_px = root.distance(tip);
        let is_cut = self.scan.rim_px(tip) <= AT_RIM_PX;
        // No need to measure the ink around the tips of long lines.
        let longest_px = if is_cut { MOST_CUT_RADII } else { 3.0 } * root_px + 2.0;
        if length_px >= longest_px {
            return None;
        }
        let tip_px = self.scan.radius_px(tip, root_px + 1.0);
        let middle_px = || {
            let middle = pixels.get(pixels.len() / 2).copied().unwrap_or_default();
            self.scan.radius_px(middle.into(), root_px + 1.0)
        };
        let slack_px = slack_px(root_px);
        let tapers =
            tip_px <= 0.3 * root_px + 0.5 && (middle_px() - f64::midpoint(root_px, tip_px)).abs() <= slack_px;
        let cut = if is_cut && tapers { self.scan.rim_run(tip) } else { None };
        Some(Branch { out_px: length_px + tip_px - root_px, tapers, cut })
    }
}

/// Typical width of the line that begins at an end.
fn width_px(sites: &Sites<'_>, end: End) -> f64 {
    let sites = sites.get(end.edge).unwrap_or(&[]);
    let first = if end.at_last { sites.len().saturating_sub(TYPICAL_SITES) } else { 0 };
    typical_width_px(sites.get(first..sites.len().min(first + TYPICAL_SITES)).unwrap_or(&[]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centreline::graph::Stretch;
    use crate::picture::{Bitmap, Pixel};

    /// How many lines are left of a level line `width` px wide whose skeleton has a branch that ends `out` px above it. What
    /// sticks out there is 1 px wide, or a corner as wide as it is high.
    fn left(width: u32, out: u32, is_corner: bool) -> usize {
        let (top, middle, column) = (40, 40 + width / 2, 50);
        let mut ink = Bitmap::new(100, 90).unwrap();
        let mut skeleton = ink.clone();
        (0..100).for_each(|x| (top..top + width).for_each(|y| ink.set(Pixel::new(x, y), true)));
        for up in 0..out {
            let half = if is_corner { out - 1 - up } else { 0 };
            (column - half..=column + half).for_each(|x| ink.set(Pixel::new(x, top - 1 - up), true));
        }
        (10..90).for_each(|x| skeleton.set(Pixel::new(x, middle), true));
        (top - out..middle).for_each(|y| skeleton.set(Pixel::new(column, y), true));
        let scan =
            Scan { ink: &ink, first_row: 0, grey: None, hairlines: crate::ink::hairlines::Hairlines::Raster };
        let graph = Graph::of(&Stretch { picture: &skeleton, rows: 0..90 }, &mut Vec::new());
        let sites = Sites::new(&graph, scan);
        sites.measure(&(0..graph.edges.len()).collect::<Vec<_>>());
        let dots = vec![false; graph.edges.len()];
        let spurs = Spurs::new(&graph, &sites, scan, &dots);
        (0..graph.edges.len()).filter(|edge| !spurs.has(*edge)).count()
    }

    #[test]
    fn a_branch_goes_that_sticks_out_less_than_half_its_lines_width() {
        for (width, out, lines) in [(13, 4, 2), (13, 9, 3), (9, 3, 2), (9, 7, 3), (5, 2, 2), (5, 4, 3)] {
            assert_eq!(left(width, out, true), lines, "{width} px wide, {out} px out");
        }
    }

    #[test]
    fn of_a_hairline_its_own_width_decides() {
        for (width, out, lines) in [(13, 3, 3), (9, 3, 3), (5, 3, 3)] {
            assert_eq!(left(width, out, false), lines, "{width} px wide, {out} px out");
        }
    }
}
