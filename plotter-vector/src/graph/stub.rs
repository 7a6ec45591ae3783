//! Stubs: short strokes that stick out of a wider line.
//!
//! Thinning takes what sticks out of a line by less than the line's own width for roughness. Whether it is shows when
//! the lines that were found are drawn as a pen of their width draws them: ink that the pen would leave bare, and that
//! reaches away from the line, is a stroke of its own.

use super::fragment::{Fragment, Joint};
use super::junction::Junctions;
use super::site::{Scan, Site};
use super::{End, Graph, Place};
use crate::{Bitmap, Pixel, PxPoint};
use core::ops::Range;

/// What a drawn line may leave bare at its edges, px.
const MARGIN_PX: f64 = 1.0;

/// Least length of what is bare, px, and least part of the line's width.
const LEAST_PX: f64 = 1.5;
const LEAST_OF_WIDTH: f64 = 0.25;

/// Most pixels of a bare place; more is no stub but ink that is no line.
const MOST_PIXELS: usize = 4096;

/// Sites to either side among which the width of a line is found.
const CALM_SITES: usize = 8;

/// What a stub is found in.
pub(super) struct Lines<'a> {
    pub(super) graph: &'a Graph,
    pub(super) sites: &'a [Vec<Site>],
    pub(super) junctions: &'a Junctions,
    pub(super) gone: &'a [bool],
    pub(super) scan: Scan<'a>,
}

/// The stubs of a band, as strokes of their own from the middle of their line.
pub(super) fn stubs(lines: &Lines<'_>, core: &Range<u32>) -> Vec<Fragment> {
    let mut bare = lines.scan.ink.clone();
    lines.each_place(|at, width_px| wipe(&mut bare, lines.scan.first_row, at, 0.5 * width_px + MARGIN_PX));
    let mut found = Vec::new();
    let all: Vec<Pixel> = bare.ink().collect();
    let mut anchors = Vec::new();
    for first in all {
        if !bare.get(first) {
            continue;
        }
        let mut patch = take(&mut bare, first);
        patch.iter_mut().for_each(|at| at.y = at.y.saturating_add(lines.scan.first_row));
        let first = Pixel::new(first.x, first.y.saturating_add(lines.scan.first_row));
        if core.contains(&first.y) && patch.len() > 2 && patch.len() <= MOST_PIXELS {
            if anchors.is_empty() {
                lines.each_place(|at, width_px| anchors.push((at, width_px)));
                anchors.sort_by(|a, b| a.0.y.total_cmp(&b.0.y).then(a.0.x.total_cmp(&b.0.x)));
            }
            if let Some(stub) = stub(&patch, &anchors) {
                let places = stub.map(|at| Place::new(at, -1.0, false)).to_vec();
                found.push(Fragment { places, joints: Some([Joint::Free; 2]) });
            }
        }
    }
    found
}

impl Lines<'_> {
    /// Every place of the lines, about a pixel apart, and the line's width there.
    fn each_place(&self, mut visit: impl FnMut(PxPoint, f64)) {
        let is_line = |edge: usize| {
            !self.gone.get(edge).copied().unwrap_or(true)
                && !self.junctions.inner.get(edge).copied().unwrap_or(true)
        };
        for (edge, sites) in self.sites.iter().enumerate().filter(|(edge, _)| is_line(*edge)) {
            let skip = |at_last| self.junctions.skip(End { edge, at_last });
            let last = sites.len().saturating_sub(skip(true));
            for (index, site) in sites.iter().enumerate().take(last).skip(skip(false)) {
                visit(site.centre, calm_px(sites, index));
            }
        }
        for connection in self.junctions.connections.iter().filter(|one| is_line(one.from.edge)) {
            let root = |end: End| {
                let sites = self.sites.get(end.edge)?;
                let skip = self.junctions.skip(end);
                let index = if end.at_last { sites.len().checked_sub(skip + 1)? } else { skip };
                Some((sites.get(index)?.centre, calm_px(sites, index)))
            };
            let Some((from, width_px)) = root(connection.from) else { continue };
            let to = connection.to.and_then(root).map(|(to, _)| to);
            let mut before = from;
            for next in connection.points.iter().copied().chain(to) {
                let steps = libm::ceil(before.distance(next)).clamp(1.0, 400.0);
                let mut step = 1.0;
                while step <= steps {
                    let t = step / steps;
                    let at =
                        PxPoint::new(before.x + (next.x - before.x) * t, before.y + (next.y - before.y) * t);
                    visit(at, width_px);
                    step += 1.0;
                }
                before = next;
            }
        }
        for node in self.graph.nodes.iter().filter(|node| node.ends.is_empty()) {
            let at = PxPoint::from(node.at);
            visit(at, 2.0 * self.scan.radius_px(at, f64::MAX) + 1.0);
        }
    }
}

/// The line's own width at a site: the least one near it.
fn calm_px(sites: &[Site], index: usize) -> f64 {
    let near = sites.get(index.saturating_sub(CALM_SITES)..sites.len().min(index + CALM_SITES + 1));
    near.unwrap_or(&[]).iter().map(|site| site.width_px).fold(f64::INFINITY, f64::min).min(192.0)
}

/// Takes a disc out of a band of a picture that begins with row `first_row`.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
fn wipe(bare: &mut Bitmap, first_row: u32, at: PxPoint, radius_px: f64) {
    let (width, top) = (f64::from(bare.width()), f64::from(first_row));
    let bottom = top + f64::from(bare.height());
    let mut y = libm::ceil(at.y - radius_px - 0.5).max(top);
    while y + 0.5 <= at.y + radius_px && y < bottom {
        let dy = y + 0.5 - at.y;
        let half = libm::sqrt((radius_px * radius_px - dy * dy).max(0.0));
        let (from, to) =
            (libm::ceil(at.x - half - 0.5).max(0.0), libm::floor(at.x + half - 0.5).min(width - 1.0));
        if from <= to {
            bare.clear_run((y - top) as u32, from as u32..to as u32 + 1);
        }
        y += 1.0;
    }
}

/// Takes the 8-connected ink around a pixel out of a picture.
fn take(bare: &mut Bitmap, first: Pixel) -> Vec<Pixel> {
    let mut patch = vec![first];
    bare.set(first, false);
    let mut next = 0;
    while let Some(at) = patch.get(next).copied() {
        next += 1;
        for dy in -1..=1 {
            for dx in -1..=1 {
                let (Some(x), Some(y)) = (at.x.checked_add_signed(dx), at.y.checked_add_signed(dy)) else {
                    continue;
                };
                let beside = Pixel::new(x, y);
                if bare.get(beside) {
                    bare.set(beside, false);
                    patch.push(beside);
                }
            }
        }
    }
    patch
}

/// The stub that a bare patch is, from the middle of the nearest line to where its pen stopped.
fn stub(patch: &[Pixel], anchors: &[(PxPoint, f64)]) -> Option<[PxPoint; 2]> {
    #[expect(clippy::cast_precision_loss, reason = "a few pixels")]
    let area = patch.len() as f64;
    let sum = patch.iter().map(|at| PxPoint::from(*at)).fold((0.0, 0.0), |(x, y), at| (x + at.x, y + at.y));
    let centre = PxPoint::new(sum.0 / area, sum.1 / area);
    // The rows of the places within reach, by their order.
    const REACH_PX: f64 = 64.0;
    let from = anchors.partition_point(|(at, _)| at.y < centre.y - REACH_PX);
    let near = anchors.get(from..)?.iter().take_while(|(at, _)| at.y <= centre.y + REACH_PX);
    let (root, line_px) =
        near.min_by(|a, b| a.0.distance(centre).total_cmp(&b.0.distance(centre))).copied()?;
    let length = root.distance(centre);
    if length <= 0.0 {
        return None;
    }
    let direction = ((centre.x - root.x) / length, (centre.y - root.y) / length);
    let along = |at: &Pixel| {
        let at = PxPoint::from(*at);
        (at.x - root.x) * direction.0 + (at.y - root.y) * direction.1
    };
    let nearest = patch.iter().map(along).fold(f64::INFINITY, f64::min);
    let farthest = patch.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let long_px = farthest - nearest + 1.0;
    let wide_px = area / long_px;
    let end = farthest + 0.5 - 0.5 * wide_px;
    let sticks_out = long_px >= LEAST_PX.max(LEAST_OF_WIDTH * line_px) && long_px >= 0.6 * wide_px;
    (sticks_out && end > 0.5 * line_px)
        .then(|| [root, PxPoint::new(root.x + direction.0 * end, root.y + direction.1 * end)])
}
