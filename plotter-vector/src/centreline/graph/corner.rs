//! Corners of a single line: thinning rounds them off; the two straight parts beside them say where they are.
//!
//! ```text
//!   ──────────╮          the skeleton takes the short cut
//!             │
//!   ──────────┼ P        the straight parts, continued, meet in P: the pen was there
//!             │
//! ```
//!
//! A tight bend is told from a corner by the ink: a pen that went to P has left ink around P, half its width far.

use super::connection::{Connection, Junctions};
use super::site::{Role, Scan, Site, surely_px};
use super::sites::Sites;
use super::{End, Graph};
use crate::centreline::fit::prices::{GAIN_PX2, VERTEX_PX2};
use crate::centreline::fit::search::{settle, shifted};
use crate::centreline::fit::{Canvas, Capsule};
use crate::stroke::{PxPoint, PxVec, turn::CORNER_COS};
use core::ops::Range;
use std::collections::HashMap;

/// Width from which a line may be what no round pen has drawn, a printed letter's stroke, px: thinner, what a
/// camera's blur and noise leave of a corner costs as much as the corner.
const LETTER_PX: f64 = 8.0;

/// What the raster takes of a pen's disc in a corner, px: with more, a curve of a line 3 px wide has corners.
const SHARP_RASTER_PX: f64 = 0.45;

/// Greatest root mean square distance of the sites of a straight part, px.
const STRAIGHT_PX: f64 = 0.4;

/// Radius of the circles whose sites are no straight part of a thin line with grey rims, which shows them exactly, px.
const ROUND_PX: f64 = 12.0;

/// Sites that are looked at for the width of the line around one.
const WIDTH_SITES: usize = 8;

/// Turn from which on a corner is a sharp one: cos 96°.
const SHARP_COS: f64 = -0.1;

/// Fewest sites on either side of a corner that show where the line goes.
const FEWEST_SITES: usize = 4;

/// A corner of a line.
struct Corner {
    /// Site in the middle of it.
    index: usize,
    /// Sites to either side that it replaces.
    gap: usize,
    /// Where it is.
    at: PxPoint,
    /// Cosine of the turn: the smaller, the sharper.
    cos: f64,
}

/// The sites of a line, the first one after the last if it is closed.
#[derive(Clone, Copy)]
struct Line<'a> {
    sites: &'a [Site],
    closed: bool,
}

/// What corners are found in.
pub(super) struct Corners<'a> {
    graph: &'a Graph,
    junctions: &'a Junctions,
    scan: Scan<'a>,
    /// Where a line goes on at an edge's end.
    onward: HashMap<End, (&'a Connection, End)>,
}

impl<'a> Corners<'a> {
    pub(super) fn new(graph: &'a Graph, junctions: &'a Junctions, scan: Scan<'a>) -> Self {
        let mut onward = HashMap::new();
        for connection in &junctions.connections {
            if let Some(to) = connection.to {
                onward.insert(connection.from, (connection, to));
                onward.insert(to, (connection, connection.from));
            }
        }
        Self { graph, junctions, scan, onward }
    }

    /// Sharpens the corners of the undisturbed sites of all lines: the site in the middle of one moves there, those beside
    /// it go.
    pub(super) fn sharpen(&self, sites: &mut Sites<'_>) {
        // All are found before the first one is sharpened: a line goes on in other edges.
        let of_edge = |edge: &usize| (*edge, self.of_edge(*edge, sites));
        let found: Vec<(usize, Vec<Corner>)> = self.junctions.lines.iter().map(of_edge).collect();
        for (edge, corners) in found.into_iter().filter(|(_, corners)| !corners.is_empty()) {
            let closed = self.is_closed(edge);
            let Some(sites) = sites.get_mut(edge) else { continue };
            // The last site of a loop is the first one again.
            let end = if closed { sites.len().saturating_sub(1) } else { sites.len() };
            for corner in corners {
                let line = Line { sites: sites.get(..end).unwrap_or(&[]), closed };
                let span: Vec<usize> = line.span(&corner).collect();
                for index in span {
                    if let Some(site) = sites.get_mut(index) {
                        site.role = if index == corner.index { Role::Corner } else { Role::Left };
                    }
                }
                if let Some(site) = sites.get_mut(corner.index) {
                    site.centre = corner.at;
                }
            }
        }
    }

    fn is_closed(&self, edge: usize) -> bool {
        self.graph.edges.get(edge).is_some_and(|edge| edge.nodes.is_none())
    }

    /// The corners of an edge that do not overlap.
    fn of_edge(&self, edge: usize, sites: &Sites<'_>) -> Vec<Corner> {
        let own = sites.get(edge).unwrap_or(&[]);
        if self.is_closed(edge) {
            let own = own.get(..own.len().saturating_sub(1)).unwrap_or(&[]);
            return Line { sites: own, closed: true }.sharpest(&(0..own.len()), self.scan);
        }
        let [start, end] = [false, true].map(|at_last| End { edge, at_last });
        let skip = |end: End| self.junctions.skip(end);
        let first = skip(start);
        let Some(own) = own.get(first..own.len().saturating_sub(skip(end))) else { return Vec::new() };
        let mut line = self.beyond(start, sites);
        line.reverse();
        let before = line.len();
        line.extend_from_slice(own);
        line.extend(self.beyond(end, sites));
        let mut corners =
            Line { sites: &line, closed: false }.sharpest(&(before..before + own.len()), self.scan);
        for corner in &mut corners {
            corner.index = corner.index + first - before;
        }
        corners
    }

    /// How a line goes on at an edge's end: through the junction, and as far beyond as a corner's sides are looked at.
    fn beyond(&self, end: End, sites: &Sites<'_>) -> Vec<Site> {
        /// Sites beyond a junction: more show nothing of a corner before it.
        const LOOK: usize = 24;
        let Some((connection, to)) = self.onward.get(&end) else { return Vec::new() };
        let own = |end: End, index: usize| {
            let sites = sites.get(end.edge)?;
            let index = index + self.junctions.skip(end);
            sites.get(if end.at_last { sites.len().checked_sub(index + 1)? } else { index })
        };
        let Some(last) = own(end, 0) else { return Vec::new() };
        let inner = connection.points.iter();
        let inner: Vec<PxPoint> =
            if connection.from == end { inner.copied().collect() } else { inner.rev().copied().collect() };
        let there = own(*to, 0).map(|site| site.centre);
        let mut beyond = Vec::new();
        let mut before = last.centre;
        for next in inner.into_iter().chain(there) {
            // About a pixel apart, as the sites are.
            let steps = libm::round(before.distance(next)).clamp(1.0, 200.0);
            let mut step = 1.0;
            while step <= steps {
                let t = step / steps;
                let centre =
                    PxPoint::new(before.x + (next.x - before.x) * t, before.y + (next.y - before.y) * t);
                beyond.push(Site { centre, ..*last });
                step += 1.0;
            }
            before = next;
        }
        beyond.extend((1..LOOK).map_while(|index| own(*to, index)));
        beyond
    }
}

impl Line<'_> {
    /// The index `ahead` sites after `index` and `back` before it, around the end of a closed line.
    fn index(&self, index: usize, ahead: usize, back: usize) -> Option<usize> {
        let count = self.sites.len();
        if self.closed && count > 0 {
            Some((index + ahead + count - back % count) % count)
        } else {
            (index + ahead).checked_sub(back).filter(|index| *index < count)
        }
    }

    fn place(&self, index: usize, ahead: usize, back: usize) -> Option<PxPoint> {
        self.sites.get(self.index(index, ahead, back)?).map(|site| site.centre)
    }

    /// Width of the line around a site: the least one near it, for a corner only widens it.
    fn width_px(&self, index: usize) -> f64 {
        let near = (0..=2 * WIDTH_SITES).step_by(2).filter_map(|step| self.index(index, step, WIDTH_SITES));
        near.filter_map(|index| self.sites.get(index)).map(|site| site.width_px).fold(f64::INFINITY, f64::min)
    }

    /// The sites that a corner replaces.
    fn span<'a>(&'a self, corner: &'a Corner) -> impl Iterator<Item = usize> + 'a {
        (0..=2 * corner.gap).filter_map(|step| self.index(corner.index, step, corner.gap))
    }

    /// The corners among a line's `own` sites, those before and after show only where it comes from and goes to; of those
    /// that overlap the sharpest.
    fn sharpest(&self, own: &Range<usize>, scan: Scan<'_>) -> Vec<Corner> {
        let mut corners = self.corners(own, scan);
        // Of equals the upper one: whichever way the line runs.
        let place = |corner: &Corner| {
            self.sites.get(corner.index).map_or((0.0, 0.0), |site| (site.centre.y, site.centre.x))
        };
        corners.sort_by(|a, b| {
            let ((top, left), (y, x)) = (place(a), place(b));
            a.cos.total_cmp(&b.cos).then(top.total_cmp(&y)).then(left.total_cmp(&x))
        });
        let mut taken = vec![false; self.sites.len()];
        corners.retain(|corner| {
            let span: Vec<usize> = self.span(corner).collect();
            let free = span.len() > 2 * corner.gap
                && span.iter().all(|index| own.contains(index) && taken.get(*index) == Some(&false));
            if free {
                for index in span {
                    if let Some(taken) = taken.get_mut(index) {
                        *taken = true;
                    }
                }
            }
            free
        });
        corners
    }

    /// All corners, those that overlap too.
    fn corners(&self, own: &Range<usize>, scan: Scan<'_>) -> Vec<Corner> {
        /// Sites to either side whose chords give a first look at the turn.
        const LOOK: usize = 6;
        /// Square of the cosine of a turn that is none, a little above that of [`CORNER_COS`]: seen without a
        /// root.
        const STRAIGHT_COS2: f64 = 0.83;
        let count = self.sites.len();
        if count <= 2 * LOOK {
            return Vec::new();
        }
        let turn = |index: usize| {
            let (before, at, after) =
                (self.place(index, 0, LOOK)?, self.place(index, 0, 0)?, self.place(index, LOOK, 0)?);
            let (PxVec { x, y }, PxVec { x: u, y: v }) = (at - before, after - at);
            let dot = x * u + y * v;
            if dot > 0.0 && dot * dot > STRAIGHT_COS2 * (x * x + y * y) * (u * u + v * v) {
                return None;
            }
            Some(cos(direction(before, at)?, direction(at, after)?))
        };
        let turns: Vec<f64> = (0..count).map(|index| turn(index).unwrap_or(1.0)).collect();
        let mut found = Vec::new();
        for (index, turn) in turns.iter().enumerate().filter(|(_, turn)| **turn < CORNER_COS) {
            if !own.contains(&index) {
                continue;
            }
            let near = (0..=4).filter_map(|step| self.index(index, step, 2));
            let sharpest = near.filter_map(|index| turns.get(index)).fold(f64::INFINITY, |a, b| a.min(*b));
            if *turn <= sharpest {
                found.extend(self.corner(scan, index));
            }
        }
        found
    }

    /// The corner at a place, if the parts beside it are straight and meet where the pen has been.
    fn corner(&self, scan: Scan<'_>, index: usize) -> Option<Corner> {
        let width_px = self.width_px(index);
        if width_px <= scan.thin_px() {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a width below 200 px")]
        let (gap, support) =
            (libm::ceil(0.6 * width_px) as usize + 1, libm::ceil(1.2 * width_px) as usize + 5);
        let is_exact = scan.is_exact(width_px);
        let ((a, u), (b, v)) = (FEWEST_SITES..=support).rev().step_by(2).find_map(|support| {
            let side = |ahead: bool| {
                let places = (gap..gap + support).map_while(|step| {
                    if ahead { self.place(index, step, 0) } else { self.place(index, 0, step) }
                });
                straight(places, if is_exact { round_px(support) } else { STRAIGHT_PX })
            };
            side(false).zip(side(true))
        })?;
        // The line before runs away from the corner, so it is turned around.
        let cos = -u.dot(v);
        let cross = u.cross(v);
        if cos > CORNER_COS || cross.abs() < 0.1 {
            return None;
        }
        let t = ((b.x - a.x) * v.y - (b.y - a.y) * v.x) / cross;
        let at = PxPoint::new(a.x + u.x * t, a.y + u.y * t);
        let inside = self.place(index, 0, 0)?;
        if inside.distance(at) > 1.2 * width_px + 1.0 {
            return None;
        }
        let half_px = 0.5 * width_px;
        let pen_was_at = |at: &PxPoint| scan.pen_was_at(*at, surely_px(half_px, SHARP_RASTER_PX));
        // Of a sharp corner the raster shows the tip a little too far out.
        let most_px = if cos < SHARP_COS { 0.5 } else { 0.0 };
        let inwards = direction(at, inside).unwrap_or_default();
        let moved = [0.0, 0.25, 0.5].into_iter().take_while(|off_px| *off_px <= most_px);
        let seen = moved.map(|off_px| at + inwards * off_px).find(pen_was_at);
        let at = seen.or_else(|| self.fitted(scan, (index, gap), at, width_px))?;
        Some(Corner { index, gap, at, cos })
    }

    /// Where the straight parts beside a site meet so that their pen leaves more of the ink than one that
    /// goes as the sites do: what no round pen has drawn, such as the foot of a printed letter, has no corner
    /// that a pen went to.
    fn fitted(
        &self,
        scan: Scan<'_>,
        (index, gap): (usize, usize),
        at: PxPoint,
        width_px: f64,
    ) -> Option<PxPoint> {
        let half_px = 0.5 * width_px;
        if width_px < LETTER_PX {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a width below 200 px")]
        let canvas = Canvas::around(scan, self.place(index, 0, 0)?, gap as f64 + half_px)?;
        let way = |steps: Range<usize>| steps.filter_map(|step| self.place(index, step, 2 * gap));
        let draw = |places: &mut dyn Iterator<Item = PxPoint>, pens: &mut Vec<Capsule>| {
            canvas.add_pen(places.map(|at| (at, half_px)), pens);
        };
        let (mut sides, mut course) = (Vec::new(), Vec::new());
        draw(&mut way(0..gap + 1), &mut sides);
        draw(&mut way(3 * gap..4 * gap + 1), &mut sides);
        draw(&mut way(gap..3 * gap + 1), &mut course);
        let sides = canvas.layer(&sides);
        let as_it_is = canvas.residual(&sides, &course, f64::INFINITY)?;
        let (before, after) = (self.place(index, 0, gap)?, self.place(index, gap, 0)?);
        let cost = |at: PxPoint, limit: f64| {
            let mut pens = Vec::new();
            draw(&mut [before, at, after].into_iter(), &mut pens);
            canvas.residual(&sides, &pens, limit)
        };
        let mut fit = (at, cost(at, f64::INFINITY)?);
        settle(
            &mut fit,
            1,
            |(at, _)| vec![*at],
            |(at, least), start, step_px| {
                (*at, *least) = shifted(start, step_px, *least, |to, limit| cost(to, limit - GAIN_PX2));
                *at != start
            },
        );
        let (at, cost) = fit;
        (cost + VERTEX_PX2 <= as_it_is).then_some(at)
    }
}

/// Root mean square distance of so many sites, about a pixel apart, of a circle of [`ROUND_PX`] from a straight line: an arc
/// of length s rises by s² / 8 r, and √(4/45) of that is the mean.
fn round_px(sites: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "fewer than ten")]
    let length_px = sites as f64;
    0.298 * length_px * length_px / (8.0 * ROUND_PX)
}

/// The line through places, none when they are not straight, within a root mean square distance in px: their mean, and the
/// direction from the first to the last.
fn straight(places: impl Iterator<Item = PxPoint>, within_px: f64) -> Option<(PxPoint, PxVec)> {
    let (mut n, mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut first, mut last) = (None, None);
    for place in places {
        let origin = *first.get_or_insert(place);
        last = Some(place);
        let (dx, dy) = (place.x - origin.x, place.y - origin.y);
        (n, x, y) = (n + 1.0, x + dx, y + dy);
        (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
    }
    let (origin, last) = (first?, last?);
    if n < 3.0 {
        return None;
    }
    (x, y) = (x / n, y / n);
    (xx, xy, yy) = (xx / n - x * x, xy / n - x * y, yy / n - y * y);
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let (mut dx, mut dy) = (libm::cos(angle), libm::sin(angle));
    if (last.x - origin.x) * dx + (last.y - origin.y) * dy < 0.0 {
        (dx, dy) = (-dx, -dy);
    }
    let across = xx * dy * dy - 2.0 * xy * dx * dy + yy * dx * dx;
    (across <= within_px * within_px)
        .then_some((PxPoint::new(origin.x + x, origin.y + y), PxVec::new(dx, dy)))
}

pub(super) fn direction(from: PxPoint, to: PxPoint) -> Option<PxVec> {
    let length = from.distance(to);
    (length > 0.0).then(|| (to - from) / length)
}

fn cos(a: PxVec, b: PxVec) -> f64 {
    a.dot(b)
}
