//! Fans: lines that leave one point at acute angles, as the two strokes of an arrow head and its dimension line do.
//!
//! ```text
//!      \  |  /
//!       \ | /        near the point they are one wide line: the skeleton has a stem there, with a fork at
//!        \|/         each of its ends
//!     ----+----
//! ```
//!
//! Whether the junctions at both ends of such a stem are one shows when pens draw all their lines from one point. A line so
//! short that it is nowhere undisturbed then goes straight on to where it ends.

use super::arm::{Arm, typical_width_px};
use super::connection::{Junctions, Way};
use super::corner::direction;
use super::junction::{ArmOf, Lines, MOST_ARMS, is_sure};
use super::meeting::{Heart, Meet};
use super::site::{Site, slack_px};
use super::trial::Trial;
use crate::centreline::fit::prices::{RASTER_PX2, VERTEX_PX2};
use crate::disjoint_sets::DisjointSets;
use crate::picture::Pixel;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Longest stem of a fan in widths of its thinnest line.
const LONGEST_IN_WIDTHS: f64 = 10.0;

/// Most nodes of a fan: more is a thicket.
const MOST_NODES: usize = 12;

/// Calm sites in a row that show the course of a line of its own.
const CALM_SITES: usize = 3;

/// Lines that all go through one point, and how they go on there.
pub(super) struct Fan {
    /// Its first node.
    pub(super) node: usize,
    pub(super) owner: Pixel,
    pub(super) ways: Vec<Way>,
}

impl Lines<'_> {
    /// The nodes of an edge along which several lines seem to run together: it is nowhere as thin as one of the lines at its
    /// ends.
    pub(super) fn shared(&self, edge: usize) -> Option<(usize, usize)> {
        let (a, b) = self.between(edge)?;
        let sites = self.sites.get(edge)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of pixels, far below 2^53")]
        let length = sites.len() as f64;
        // No line at a node is wider than the ink there.
        if length > LONGEST_IN_WIDTHS * 2.0 * self.radius_px(a).max(self.radius_px(b)) {
            return None;
        }
        let others = [a, b].into_iter().flat_map(|node| self.ends(node)).filter(|end| end.edge != edge);
        let arms = others.filter_map(|end| self.long_arm(end)).filter(|arm| arm.support_px > 0.0);
        let thinnest_px = arms.map(|arm| arm.width_px).fold(f64::INFINITY, f64::min);
        if thinnest_px <= self.scan.thin_px() || length > LONGEST_IN_WIDTHS * thinnest_px {
            return None;
        }
        let calm =
            |some: &[Site]| some.iter().all(|site| site.width_px <= thinnest_px + slack_px(thinnest_px));
        (!sites.windows(CALM_SITES).any(calm)).then_some((a, b))
    }

    /// Joins the junctions at the ends of stems that are shared by lines which all go through one point.
    pub(super) fn join_fans(
        &self,
        shared: &[usize],
        groups: &mut DisjointSets,
        found: &mut Junctions,
    ) -> Vec<Fan> {
        let mut joined = groups.clone();
        let stems = || {
            let nodes_of = |edge: &usize| self.graph.edges.get(*edge).and_then(|edge| edge.nodes);
            shared.iter().filter_map(move |edge| Some((*edge, nodes_of(edge)?)))
        };
        for (_, (a, b)) in stems() {
            joined.join_to_lower(a, b);
        }
        // The stems and the nodes of each.
        let mut wholes: BTreeMap<usize, (Vec<usize>, Vec<usize>)> = BTreeMap::new();
        for (stem, (a, _)) in stems() {
            wholes.entry(joined.root(a)).or_default().0.push(stem);
        }
        if !wholes.is_empty() {
            for node in 0..self.graph.nodes.len() {
                if let Some((_, nodes)) = wholes.get_mut(&joined.root(node)) {
                    nodes.push(node);
                }
            }
        }
        let mut fans = Vec::new();
        for (stems, nodes) in wholes.into_values().filter(|(_, nodes)| nodes.len() <= MOST_NODES) {
            let inner =
                |edge: usize| stems.contains(&edge) || found.inner.get(edge).copied().unwrap_or(false);
            let Some(fan) = self.fan(&nodes, inner) else { continue };
            fans.push(fan);
            for pair in nodes.windows(2) {
                if let [a, b] = pair {
                    groups.join_to_lower(*a, *b);
                }
            }
            for stem in stems {
                if let Some(inner) = found.inner.get_mut(stem) {
                    *inner = true;
                }
            }
        }
        fans
    }

    /// The lines of some nodes as going through one point, if they leave ink like that.
    fn fan(&self, nodes: &[usize], is_inner: impl Fn(usize) -> bool) -> Option<Fan> {
        let arms = self.arms_of(nodes, is_inner);
        let (owner, node) = (self.owner(nodes)?, *nodes.first()?);
        if arms.len() < 3 || arms.len() > MOST_ARMS {
            return None;
        }
        let heart = self.heart(nodes, owner);
        // In two places or more, each of its lines would have one of its own.
        #[expect(clippy::cast_precision_loss, reason = "at most 8")]
        let most = RASTER_PX2 + VERTEX_PX2 * arms.len() as f64;
        let rays =
            || -> Vec<ArmOf> { arms.iter().map(|one| self.ray(one, &heart).unwrap_or(*one)).collect() };
        let good = |star: &(f64, Vec<Way>)| star.0 <= most;
        let star = self.star(&heart, &arms).filter(good).or_else(|| self.star(&heart, &rays()).filter(good));
        star.map(|(_, ways)| Fan { node, owner, ways })
    }

    /// All arms from one point, and what that costs.
    fn star(&self, heart: &Heart<'_>, arms: &[ArmOf]) -> Option<(f64, Vec<Way>)> {
        let sites: Vec<Cow<'_, [Site]>> = arms.iter().map(|one| self.sites_from(one.end)).collect();
        let trial = Trial::new(self.scan, heart.centre, arms, &sites)?;
        let ways = heart.plan(arms, Meet::WherePenWas);
        let place = ways.first().and_then(|way| way.points.first().copied())?;
        if !ways.iter().all(|way| way.points == [place]) {
            return None;
        }
        let cost = trial.cost(&ways, f64::INFINITY)?;
        let (ways, cost) = trial.settle(ways, cost);
        Some((cost, ways))
    }

    /// A line too short to show its course, straight on to where it ends.
    fn ray(&self, one: &ArmOf, heart: &Heart<'_>) -> Option<ArmOf> {
        let tip = one.tip.filter(|_| !is_sure(one))?;
        let sites = self.sites_from(one.end);
        let width_px = typical_width_px(sites.get(sites.len() / 2..)?);
        let arm = Arm {
            skip: sites.len(),
            origin: tip,
            direction: direction(heart.centre, tip)?,
            bend_per_px: 0.0,
            width_px,
            support_px: 0.0,
        };
        Some(ArmOf { arm, ..*one })
    }
}
