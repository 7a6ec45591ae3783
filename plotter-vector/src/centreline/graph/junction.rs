//! Junctions: where lines meet, and which of them go on as one stroke.
//!
//! At a crossing the skeleton has several nodes with short edges between them; those whose discs of ink overlap are
//! one junction. Two lines that cross at an acute angle `a` have two forks far apart, with an edge between them
//! along which both lines run together: it is wider than a line, and the arms continue each other across it.

use super::arm::{Arm, LONG, SHORT};
use super::connection::{Junctions, Tip, Way};
use super::corner::direction;
use super::fan::Fan;
use super::line_end::{line_end, seated_across, tail};
use super::meeting::{Heart, Meet, partners};
use super::near::Near;
use super::site::{Scan, Site, slack_px};
use super::sites::Sites;
use super::spur::Spurs;
use super::trial::Trial;
use super::{End, Graph};
use crate::centreline::fit::prices::{self, RASTER_PX2};
use crate::disjoint_sets::DisjointSets;
use crate::ink::hairlines::Hairlines;
use crate::stroke::PxPoint;
use crate::{PxVec, picture::Pixel};
use core::cell::{OnceCell, RefCell};
use std::borrow::Cow;
use std::collections::HashMap;

/// How the lines of a junction go on.
pub(super) struct Plan {
    pub(super) ways: Vec<Way>,
    /// The end of a line that is none.
    pub(super) dropped: Option<End>,
}

impl Junctions {
    /// Takes the junctions and line ends apart of all lines of a graph that come near.
    pub(super) fn of(
        graph: &Graph,
        sites: &Sites<'_>,
        gone: &Spurs<'_>,
        scan: Scan<'_>,
        near: &Near,
    ) -> Self {
        let mut found = Self {
            skips: vec![[0; 2]; graph.edges.len()],
            connections: Vec::new(),
            inner: vec![false; graph.edges.len()],
            lines: near.edges(graph),
        };
        found.lines.retain(|edge| !gone.has(*edge));
        sites.measure(&found.lines);
        let radii = vec![OnceCell::new(); graph.nodes.len()];
        let arms = RefCell::default();
        let lines = Lines { graph, sites, gone, scan, radii: &radii, arms: &arms };
        let (groups, fans) = lines.groups(&mut found);
        let mut fans: HashMap<usize, Fan> = fans.into_iter().map(|fan| (fan.node, fan)).collect();
        for group in groups {
            match group.first().and_then(|node| fans.remove(node)) {
                Some(fan) => found.take(fan.owner, fan.ways),
                None => lines.resolve(&group, &mut found),
            }
        }
        let Self { inner, lines, .. } = &mut found;
        lines.retain(|edge| inner.get(*edge) == Some(&false));
        found
    }
}

/// Sites from a line's end on that are looked at: more than any arm needs, and fewer than the rows of a band's context.
const LOOK: usize = 256;

/// A line shows its course on so many times its width, and so many px at least: the raster's error is that of a pixel.
const SURE_WIDTHS: f64 = 2.0;
const SURE_PX: f64 = 12.0;

/// A short line is at most so many radii of the ink at its junction long.
const SHORT_RADII: f64 = 6.0;

/// The same of the ink between the sides of a point: 1 / (2 sin 3°) widths, and the radius is nearly one.
const POINT_RADII: f64 = 12.0;

/// And at most so many px.
const LONGEST_POINT_PX: f64 = 160.0;

/// More arms meet in noise only.
pub(super) const MOST_ARMS: usize = 8;

/// What junctions are found in.
#[derive(Clone, Copy)]
pub(super) struct Lines<'a> {
    pub(super) graph: &'a Graph,
    pub(super) sites: &'a Sites<'a>,
    gone: &'a Spurs<'a>,
    pub(super) scan: Scan<'a>,
    /// Radius of the ink around each node, once it is measured.
    radii: &'a [OnceCell<f64>],
    /// The long arms that were asked for.
    arms: &'a RefCell<HashMap<End, Option<Arm>>>,
}

/// An arm of a junction and which edge end it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArmOf {
    pub(super) end: End,
    pub(super) arm: Arm,
    /// Where a short line ends that leads from here to nowhere else.
    pub(super) tip: Option<PxPoint>,
    /// The same of one as long as the ink between the sides of a sharp point is filled.
    pub(super) point: Option<PxPoint>,
}

impl ArmOf {
    /// A line too short to show its own direction, from the junction's middle to where it ends.
    fn aimed(&self, centre: PxPoint) -> Option<Self> {
        let tip = self.tip.filter(|_| self.arm.support_px < SURE_WIDTHS * self.arm.width_px)?;
        let direction = direction(centre, tip)?;
        let PxVec { x, y } = self.arm.origin - centre;
        let origin = centre + direction * (x * direction.x + y * direction.y);
        Some(Self { arm: Arm { origin, direction, bend_per_px: 0.0, ..self.arm }, ..*self })
    }
}

impl Lines<'_> {
    /// The nodes of each junction that a line comes to which is near, and which edges lie within them.
    fn groups(&self, found: &mut Junctions) -> (Vec<Vec<usize>>, Vec<Fan>) {
        let nodes_of = |edge: usize| self.graph.edges.get(edge).and_then(|edge| edge.nodes);
        let mut wanted = vec![false; self.graph.nodes.len()];
        let mut tried = vec![false; self.graph.edges.len()];
        let mut nodes: Vec<usize> =
            found.lines.iter().filter_map(|edge| nodes_of(*edge)).flat_map(|(a, b)| [a, b]).collect();
        let mut groups = DisjointSets::new(self.graph.nodes.len());
        let mut shared = Vec::new();
        while let Some(node) = nodes.pop() {
            let Some(wanted) = wanted.get_mut(node).filter(|wanted| !**wanted) else { continue };
            *wanted = true;
            for end in self.ends(node) {
                let Some(tried) = tried.get_mut(end.edge).filter(|tried| !**tried) else { continue };
                *tried = true;
                let joined = self.overlapping(end.edge).or_else(|| self.run_together(end.edge));
                if let Some((a, b)) = joined.or_else(|| self.shows_nothing(end.edge)) {
                    groups.join_to_lower(a, b);
                    nodes.extend([a, b]);
                    if let Some(inner) = found.inner.get_mut(end.edge) {
                        *inner = true;
                    }
                } else if let Some((a, b)) = self.shared(end.edge) {
                    shared.push(end.edge);
                    nodes.extend([a, b]);
                }
            }
        }
        let fans = self.join_fans(&shared, &mut groups, found);
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); self.graph.nodes.len()];
        for (node, _) in wanted.iter().enumerate().filter(|(_, wanted)| **wanted) {
            if let Some(group) = members.get_mut(groups.root(node)) {
                group.push(node);
            }
        }
        members.retain(|group| !group.is_empty());
        (members, fans)
    }

    /// The ends of the lines that are left at a node.
    pub(super) fn ends(&self, node: usize) -> impl Iterator<Item = End> + '_ {
        let ends = self.graph.nodes.get(node).map_or(&[][..], |node| &node.ends);
        ends.iter().copied().filter(|end| !self.gone.has(end.edge))
    }

    /// Radius of the ink around a node where lines meet; 0 elsewhere.
    pub(super) fn radius_px(&self, node: usize) -> f64 {
        let measure = || {
            if self.ends(node).count() > 1 { self.scan.radius_px(self.place(node), f64::MAX) } else { 0.0 }
        };
        self.radii.get(node).map_or(0.0, |radius| *radius.get_or_init(measure))
    }

    /// The two nodes of an edge that is left between two junctions.
    pub(super) fn between(&self, edge: usize) -> Option<(usize, usize)> {
        let (a, b) = self.graph.edges.get(edge)?.nodes?;
        let joins = a != b && !self.gone.has(edge) && self.ends(a).count() > 1 && self.ends(b).count() > 1;
        joins.then_some((a, b))
    }

    fn place(&self, node: usize) -> PxPoint {
        self.graph.nodes.get(node).map_or(PxPoint::default(), |node| node.at.into())
    }

    /// The nodes of an edge whose discs of ink overlap.
    fn overlapping(&self, edge: usize) -> Option<(usize, usize)> {
        let (a, b) = self.between(edge)?;
        let reach = self.radius_px(a) + self.radius_px(b);
        let pixels = self.graph.edges.get(edge)?.pixels.len();
        #[expect(clippy::cast_precision_loss, reason = "a count of pixels, far below 2^53")]
        let short = pixels as f64 <= 1.5 * reach + 2.0;
        (short && self.place(a).distance(self.place(b)) <= reach.max(1.5)).then_some((a, b))
    }

    /// The nodes of an edge between thin lines that is too short to show where it comes from: they belong to one crossing of
    /// several lines.
    fn shows_nothing(&self, edge: usize) -> Option<(usize, usize)> {
        let is_short = || self.graph.edges.get(edge).is_some_and(|edge| edge.pixels.len() <= SHORT);
        if self.scan.hairlines == Hairlines::Pen && is_short() { self.between(edge) } else { None }
    }

    /// The nodes of an edge along which two lines run together that cross at an acute angle.
    fn run_together(&self, edge: usize) -> Option<(usize, usize)> {
        /// Along a crossing at an angle of 9 degrees.
        const LONGEST_IN_WIDTHS: f64 = 13.0;
        let (a, b) = self.between(edge)?;
        let others = |node: usize| -> Option<[Arm; 2]> {
            let mut ends = self.ends(node).filter(|end| end.edge != edge);
            let (first, second) = (ends.next()?, ends.next()?);
            if ends.next().is_some() || first.edge == second.edge {
                return None;
            }
            Some([self.long_arm(first)?, self.long_arm(second)?])
        };
        let sites = self.sites.get(edge)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of pixels, far below 2^53")]
        let length = sites.len() as f64;
        let (mine, theirs) = (others(a)?, others(b)?);
        let arms = [mine[0], mine[1], theirs[0], theirs[1]];
        let width_px = arms.iter().map(|arm| arm.width_px).sum::<f64>() / 4.0;
        let sure = arms.iter().all(|arm| arm.support_px > 0.0);
        if width_px <= self.scan.thin_px() || !sure || length > LONGEST_IN_WIDTHS * width_px {
            return None;
        }
        let wide = sites.iter().filter(|site| site.width_px > width_px + slack_px(width_px)).count();
        if wide * 10 < sites.len() * 6 {
            return None;
        }
        let straight = bend(&mine[0], &theirs[0]).max(bend(&mine[1], &theirs[1]));
        let crossed = bend(&mine[0], &theirs[1]).max(bend(&mine[1], &theirs[0]));
        (straight.min(crossed) < 0.35).then_some((a, b))
    }

    /// The sites of an edge from one of its ends on.
    pub(super) fn sites_from(&self, end: End) -> Cow<'_, [Site]> {
        let sites = self.sites.get(end.edge).unwrap_or(&[]);
        if end.at_last {
            sites.iter().rev().take(LOOK).copied().collect()
        } else {
            sites.get(..LOOK).unwrap_or(sites).into()
        }
    }

    /// The arm at an edge's end by all that is seen of it.
    pub(super) fn long_arm(&self, end: End) -> Option<Arm> {
        let known = self.arms.borrow().get(&end).copied();
        known.unwrap_or_else(|| {
            let arm = self.arm(end, LONG);
            self.arms.borrow_mut().insert(end, arm);
            arm
        })
    }

    fn arm(&self, end: End, longest: usize) -> Option<Arm> {
        let sites = self.sites_from(end);
        // Half of a line between two junctions is for each of them.
        let edge = self.graph.edges.get(end.edge)?;
        let (first, last) = edge.nodes?;
        let (near, far) = if end.at_last { (last, first) } else { (first, last) };
        // What ends beyond the look is not known in a band.
        let reserved = if edge.pixels.len() > LOOK {
            0
        } else if self.ends(far).count() > 1 {
            2
        } else {
            // Thinning follows the ink into a corner of the line's end.
            self.tail_at(End { edge: end.edge, at_last: !end.at_last }, far)
        };
        let tail = if self.ends(near).count() > 1 { 0 } else { self.tail_at(end, near) };
        let arm = Arm::of(sites.get(tail..)?, reserved, longest)?;
        Some(Arm { skip: arm.skip + tail, ..arm })
    }

    /// Sites at a line's free end, at a node, that lead into a corner of it.
    fn tail_at(&self, end: End, node: usize) -> usize {
        let sites = self.sites_from(end);
        let had_branches = self.graph.nodes.get(node).is_some_and(|node| node.ends.len() > 1);
        let pixels = self.graph.edges.get(end.edge).map_or(&[][..], |edge| &edge.pixels).iter().copied();
        if end.at_last {
            tail(self.scan, pixels.rev(), &sites, had_branches)
        } else {
            tail(self.scan, pixels, &sites, had_branches)
        }
    }

    /// The pixel beside an edge's end and that at the end itself.
    fn first_pixels(&self, end: End) -> [Option<Pixel>; 2] {
        let pixels = self.graph.edges.get(end.edge).map_or(&[][..], |edge| &edge.pixels);
        let at = |from_end: usize| {
            let index = if end.at_last { pixels.len().checked_sub(from_end + 1)? } else { from_end };
            pixels.get(index).copied()
        };
        [at(1), at(0)]
    }

    /// The arms of a junction: all lines that leave its nodes but for its inner edges.
    pub(super) fn arms_of(&self, group: &[usize], is_inner: impl Fn(usize) -> bool) -> Vec<ArmOf> {
        let mut ends: Vec<End> =
            group.iter().flat_map(|node| self.ends(*node)).filter(|end| !is_inner(end.edge)).collect();
        // By where they begin, whichever way their edges were walked.
        ends.sort_by_key(|end| self.first_pixels(*end));
        let arm_of = |end: &End| {
            let (tip, point) = self.tip(*end);
            Some(ArmOf { end: *end, arm: self.long_arm(*end)?, tip, point })
        };
        ends.iter().filter_map(arm_of).collect()
    }

    /// The first node of a junction in reading order.
    pub(super) fn owner(&self, group: &[usize]) -> Option<Pixel> {
        let nodes = group.iter().filter_map(|node| self.graph.nodes.get(*node)).map(|node| node.at);
        nodes.min_by_key(|at| (at.y, at.x))
    }

    /// The middle of a junction.
    pub(super) fn heart(&self, group: &[usize], owner: Pixel) -> Heart<'_> {
        let centre = centre(group.iter().map(|node| self.place(*node)));
        let radius_px = group.iter().map(|node| self.radius_px(*node)).fold(0.0, f64::max);
        Heart { owner, centre, radius_px, scan: self.scan }
    }

    /// The tails of all lines at the nodes of one junction, dot or line end.
    fn resolve(&self, group: &[usize], found: &mut Junctions) {
        let is_inner = |edge: usize| found.inner.get(edge).copied().unwrap_or(false);
        let arms = self.arms_of(group, is_inner);
        if arms.is_empty() {
            return;
        }
        let Some(owner) = self.owner(group) else { return };
        let thinnest_px = arms.iter().map(|one| one.arm.width_px).fold(f64::INFINITY, f64::min);
        let widest_px = arms.iter().map(|one| one.arm.width_px).fold(0.0, f64::max);
        let thin_px = self.scan.thin_px();
        if thinnest_px <= thin_px && widest_px <= 2.0 * thin_px {
            self.resolve_thin(group, owner, &arms, found);
        } else if let [one] = arms.as_slice() {
            let (end, is_cut) = line_end(self.scan, &one.arm);
            let seat = if is_cut { None } else { seated_across(self.scan, &one.arm, end) };
            let tip = (!is_cut).then_some(if seat.is_some() { Tip::Seated } else { Tip::Ahead });
            found.end(owner, one, vec![seat.unwrap_or(end)], tip);
        } else {
            let heart = self.heart(group, owner);
            if !heart.resolve_point(&arms, |end| self.sites_from(end), found) {
                let Plan { ways, dropped } = self.best(group, &heart, &arms, found);
                found.take(owner, as_one(ways));
                dropped.into_iter().for_each(|end| found.drop_line(end));
            }
        }
    }

    /// Of several ways to connect the arms of a junction the one that, drawn by pens of their widths, gives the ink.
    fn best(&self, group: &[usize], heart: &Heart<'_>, arms: &[ArmOf], found: &Junctions) -> Plan {
        let straight = heart.plan(arms, Meet::WherePenWas);
        let all = |ways: Vec<Way>| Plan { ways, dropped: None };
        if arms.len() > MOST_ARMS {
            return all(straight);
        }
        let sites: Vec<Cow<'_, [Site]>> = arms.iter().map(|one| self.sites_from(one.end)).collect();
        let Some(trial) = Trial::new(self.scan, heart.centre, arms, &sites) else { return all(straight) };
        let cost = trial.cost(&straight, f64::INFINITY).unwrap_or(f64::INFINITY);
        let mut best = (cost, straight);
        if best.0 <= RASTER_PX2 {
            return self.without_short(heart, arms, &sites, &trial, best.0).unwrap_or(all(best.1));
        }
        let near: Option<Vec<ArmOf>> =
            arms.iter().map(|one| Some(ArmOf { arm: self.arm(one.end, SHORT)?, ..*one })).collect();
        let others = [
            Some(heart.plan(arms, Meet::InInk)),
            Some(heart.plan(arms, Meet::Apart)),
            near.as_ref().map(|near| heart.plan(near, Meet::WherePenWas)),
            near.as_ref().map(|near| heart.plan(near, Meet::Apart)),
            self.along_skeleton(group, arms, heart, found),
        ];
        let others = others.into_iter().flatten().map(|ways| (ways, prices::other_plan as fn(f64) -> f64));
        // Where all lines show their course, they go on as they come.
        let are_sure = arms.iter().all(is_sure);
        let below = if are_sure { prices::bent_plan } else { prices::other_plan };
        let curves = pairings(arms.len()).iter().map(|pairs| heart.curves(arms, pairs));
        let curves = curves.map(|ways| (ways, below as fn(f64) -> f64));
        for (ways, below) in others.chain(curves) {
            if best.0 <= RASTER_PX2 {
                break;
            }
            if let Some(cost) = trial.cost(&ways, below(best.0)) {
                best = (cost, ways);
            }
        }
        // What sticks out of the other side so little that thinning takes it for roughness.
        for index in 0..best.1.len() {
            let Some(Way { one, other: None, points }) = best.1.get(index).cloned() else { continue };
            let aimed = one.aimed(heart.centre);
            let straight_on = aimed.map(|aimed| (aimed, Vec::new()));
            for (one, mut points) in [Some((one, points)), straight_on].into_iter().flatten() {
                let (end, _) = line_end(self.scan, &one.arm);
                let last = points.last().copied().unwrap_or(heart.centre);
                if last.distance(end) > 1.5 * heart.radius_px + 3.0 {
                    continue;
                }
                points.push(end);
                let mut ways = best.1.clone();
                if let Some(way) = ways.get_mut(index) {
                    *way = Way { one, other: None, points };
                }
                if let Some(cost) = trial.cost(&ways, prices::other_plan(best.0)) {
                    best = (cost, ways);
                }
            }
        }
        let (ways, cost) = trial.settle(best.1, best.0);
        self.without_short(heart, arms, &sites, &trial, cost).unwrap_or(all(ways))
    }

    /// The arms of a junction connected as the skeleton runs.
    fn along_skeleton(
        &self,
        group: &[usize],
        arms: &[ArmOf],
        heart: &Heart<'_>,
        found: &Junctions,
    ) -> Option<Vec<Way>> {
        // From the undisturbed part of an arm to its node.
        let inwards = |one: &ArmOf| -> Vec<PxPoint> {
            let pixels = self.graph.edges.get(one.end.edge).map_or(&[][..], |edge| &edge.pixels);
            let at = |index: usize| {
                let index = if one.end.at_last { pixels.len().checked_sub(index + 1)? } else { index };
                pixels.get(index).map(|pixel| PxPoint::from(*pixel))
            };
            (0..one.arm.skip).rev().filter_map(at).collect()
        };
        let plan = heart.plan(arms, Meet::WherePenWas);
        let paired = plan.iter().find_map(|way| way.other.is_some().then_some(way.one.end));
        let hub = paired.or(arms.first().map(|one| one.end))?;
        let mut ways = Vec::new();
        for Way { one, other, .. } in plan {
            let mut points = inwards(&one);
            let (between, _) =
                self.way_between(group, one.end, other.map_or(hub, |other| other.end), found)?;
            points.extend(between);
            if let Some(other) = other {
                points.extend(inwards(&other).into_iter().rev());
            }
            points.dedup();
            ways.push(Way { one, other, points });
        }
        Some(ways)
    }

    /// Where the pen stopped that drew the line which leaves a junction here and ends free: of a short one, and of one as long
    /// as the ink of a point.
    fn tip(&self, end: End) -> (Option<PxPoint>, Option<PxPoint>) {
        let nodes = self.graph.edges.get(end.edge).and_then(|edge| edge.nodes);
        let Some((first, last)) = nodes else { return (None, None) };
        let (near, far) = if end.at_last { (last, first) } else { (first, last) };
        let (from, to) = (self.place(near), self.place(far));
        let length_px = from.distance(to);
        if self.ends(far).count() != 1 || length_px <= 0.0 {
            return (None, None);
        }
        let radius_px = self.scan.radius_px(self.place(near), f64::MAX);
        let is_short = length_px <= SHORT_RADII * radius_px + 2.0;
        if !is_short && length_px > (POINT_RADII * radius_px + 2.0).min(LONGEST_POINT_PX) {
            return (None, None);
        }
        let direction = (to - from) / length_px;
        let out_px = self.scan.reach_px(to, direction, 2.0 * radius_px + 2.0);
        let half_px = self.scan.radius_px(to, f64::MAX);
        let along = length_px + (out_px - half_px).max(0.0);
        let tip = from + direction * along;
        (is_short.then_some(tip), Some(tip))
    }

    /// Thin lines keep their pixels; only the partners are found. What lies between the nodes of a junction becomes
    /// part of the strokes that pass, and a stroke of its own where none does.
    fn resolve_thin(&self, group: &[usize], owner: Pixel, arms: &[ArmOf], found: &mut Junctions) {
        let (mut used, mut paired) = (Vec::new(), Vec::new());
        let arms: Vec<ArmOf> =
            arms.iter().map(|one| ArmOf { arm: Arm { skip: 0, ..one.arm }, ..*one }).collect();
        for (first, second) in partners(&arms, |one, other| {
            let (a, b) = (one.arm.direction, other.arm.direction);
            -a.dot(b)
        }) {
            let (Some(one), Some(other)) = (arms.get(first), arms.get(second)) else { continue };
            let Some((way, edges)) = self.way_between(group, one.end, other.end, found) else { continue };
            used.extend(edges);
            paired.extend([first, second]);
            found.pair(owner, one, other, way);
        }
        for (index, one) in arms.iter().enumerate() {
            if !paired.contains(&index) {
                found.end(owner, one, Vec::new(), None);
            }
        }
        let is_passed = |node: usize| {
            let is_inner = |edge: usize| found.inner.get(edge).copied().unwrap_or(false);
            self.ends(node).any(|end| used.contains(&end.edge) || !is_inner(end.edge))
        };
        // Between two pixels that touch and are passed there is nothing to draw.
        let is_drawn = |edge: &usize| {
            self.graph.edges.get(*edge).is_some_and(|edge| {
                edge.pixels.len() > 2 || !edge.nodes.is_some_and(|(a, b)| is_passed(a) && is_passed(b))
            })
        };
        let inner = group.iter().flat_map(|node| self.ends(*node)).map(|end| end.edge);
        let drawn: Vec<usize> = inner.filter(|edge| !used.contains(edge)).filter(is_drawn).collect();
        for edge in drawn {
            if let Some(inner) = found.inner.get_mut(edge) {
                *inner = false;
            }
        }
    }

    /// The pixels between the nodes of two edge ends of one junction, over its inner edges.
    fn way_between(
        &self,
        group: &[usize],
        from: End,
        to: End,
        found: &Junctions,
    ) -> Option<(Vec<PxPoint>, Vec<usize>)> {
        let node_of = |end: End| {
            let (first, last) = self.graph.edges.get(end.edge)?.nodes?;
            Some(if end.at_last { last } else { first })
        };
        let (start, goal) = (node_of(from)?, node_of(to)?);
        // Breadth first; the group is small, or a page of noise where the first few nodes will do.
        let mut before: Vec<(usize, usize, usize)> = vec![(start, usize::MAX, usize::MAX)];
        let mut next = 0;
        while let Some((node, ..)) = before.get(next).copied() {
            if node == goal {
                break;
            }
            if next > 32 {
                return None;
            }
            for end in self.ends(node).filter(|end| found.inner.get(end.edge).copied().unwrap_or(false)) {
                let other = node_of(end.other()).filter(|other| group.contains(other));
                if let Some(other) = other.filter(|other| before.iter().all(|(seen, ..)| seen != other)) {
                    before.push((other, next, end.edge));
                }
            }
            next += 1;
        }
        let mut at = before.iter().position(|(node, ..)| *node == goal)?;
        let (mut way, mut edges) = (Vec::new(), Vec::new());
        while let Some((node, previous, edge)) = before.get(at).copied() {
            if previous == usize::MAX {
                break;
            }
            let inner = self.graph.edges.get(edge)?;
            let starts_here = inner.nodes.is_some_and(|(first, _)| first == node);
            let centres = inner.pixels.iter().map(|pixel| PxPoint::from(*pixel));
            if starts_here {
                way.extend(centres)
            } else {
                way.extend(centres.rev())
            }
            edges.push(edge);
            at = previous;
        }
        way.reverse();
        Some((way, edges))
    }
}

/// Of two lines that end in the same place and meet nothing else there: one with a corner.
pub(super) fn as_one(ways: Vec<Way>) -> Vec<Way> {
    /// Nearer ends are one place, px.
    const SAME_PX: f64 = 1.0;
    let [Way { one, other: None, points }, Way { one: other, other: None, points: theirs }] = ways.as_slice()
    else {
        return ways;
    };
    let ([at], [there]) = (points.as_slice(), theirs.as_slice()) else { return ways };
    if at.distance(*there) > SAME_PX {
        return ways;
    }
    let points = vec![PxPoint::new(f64::midpoint(at.x, there.x), f64::midpoint(at.y, there.y))];
    vec![Way { one: *one, other: Some(*other), points }]
}

/// Whether a line shows its course.
pub(super) fn is_sure(one: &ArmOf) -> bool {
    one.arm.support_px >= (SURE_WIDTHS * one.arm.width_px).max(SURE_PX)
}

/// Which of two to four arms may be one line.
fn pairings(arms: usize) -> &'static [&'static [(usize, usize)]] {
    match arms {
        2 => &[&[(0, 1)]],
        3 => &[&[(0, 1)], &[(0, 2)], &[(1, 2)]],
        4 => &[&[(0, 1), (2, 3)], &[(0, 2), (1, 3)], &[(0, 3), (1, 2)]],
        _ => &[],
    }
}

/// How much the way from one arm's origin to another's turns at its ends, rad: the greater of both angles.
pub(super) fn bend(one: &Arm, other: &Arm) -> f64 {
    let (x, y) = (other.origin.x - one.origin.x, other.origin.y - one.origin.y);
    let angle = |PxVec { x: dx, y: dy }: PxVec| libm::atan2(dx * y - dy * x, dx * x + dy * y).abs();
    let PxVec { x: dx, y: dy } = one.direction;
    angle(PxVec::new(-dx, -dy)).max(angle(other.direction))
}

fn centre(places: impl Iterator<Item = PxPoint>) -> PxPoint {
    let (x, y, count) = places.fold((0.0, 0.0, 0.0), |(x, y, n), place| (x + place.x, y + place.y, n + 1.0));
    if count > 0.0 { PxPoint::new(x / count, y / count) } else { PxPoint::default() }
}
