//! Stubs: short strokes that stick out of a wider line.
//!
//! Thinning takes what sticks out of a line by less than the line's own width for roughness. Whether it is shows when
//! the lines that were found are drawn as a pen of their width draws them: ink that the pen would leave bare, and that
//! reaches away from the line, is a stroke of its own.

use super::arm::{TYPICAL_SITES, are_of_two_pens, typical_width_px};
use super::fragment::{Fragment, Joint};
use super::junction::Junctions;
use super::mark::Marks;
use super::near::Near;
use super::site::{Scan, Site, least_around};
use super::sites::Sites;
use super::wiper::Wiper;
use super::{End, Graph, Place};
use crate::centrelines::each;
use crate::{Bitmap, Pixel, PxPoint};
use core::ops::Range;
use std::sync::Mutex;

/// What a drawn line may leave bare at its edges, px.
const MARGIN_PX: f64 = 1.0;

/// Least length of what is bare, px, and least part of the line's width.
const LEAST_PX: f64 = 1.5;
const LEAST_OF_WIDTH: f64 = 0.25;

/// Most pixels of a bare place; more is no stub but ink that is no line.
const MOST_PIXELS: usize = 4096;

/// How far beyond the rim of the picture a line is drawn that the rim cuts, in its widths: over all of its corner there at
/// 10 degrees, 1 / tan 10° / 2.
const BEYOND_WIDTHS: f64 = 3.0;

/// How far from the rim of the picture a place on it may be, px: a rounding.
const ON_RIM_PX: f64 = 1e-6;

/// Sites to either side among which the width of a line is found.
const CALM_SITES: usize = 8;

/// What a stub is found in.
pub(super) struct Lines<'a> {
    pub(super) graph: &'a Graph,
    pub(super) sites: &'a Sites<'a>,
    pub(super) junctions: &'a Junctions,
    pub(super) marks: &'a Marks,
    pub(super) scan: Scan<'a>,
    pub(super) near: &'a Near,
    /// All rows that there are.
    pub(super) all: Range<u32>,
    /// Where the calm sites of each line lie.
    pub(super) extents: Vec<Vec<Extent>>,
}

/// Sites of a line in sequence that are looked at, or passed over, together.
const TOGETHER: usize = 64;

/// Where such sites lie: the least and the greatest y, and the greatest width, px.
pub(super) struct Extent {
    top: f64,
    bottom: f64,
    widest_px: f64,
}

impl Extent {
    fn of(sites: &[Site]) -> Self {
        let none = Self { top: f64::INFINITY, bottom: f64::NEG_INFINITY, widest_px: 0.0 };
        sites.iter().fold(none, |all, Site { centre, width_px, .. }| Self {
            top: all.top.min(centre.y),
            bottom: all.bottom.max(centre.y),
            widest_px: all.widest_px.max(*width_px),
        })
    }

    /// Those of the calm sites of all lines.
    pub(super) fn of_lines(sites: &Sites<'_>, junctions: &Junctions) -> Vec<Vec<Self>> {
        let of_line =
            |edge: &usize| calm_sites(sites, junctions, *edge).chunks(TOGETHER).map(Self::of).collect();
        junctions.lines.iter().map(of_line).collect()
    }
}

/// The sites of an edge that no junction replaces, and no end of it: into a corner of the ink they get narrower.
fn calm_sites<'a>(sites: &'a Sites<'_>, junctions: &Junctions, edge: usize) -> &'a [Site] {
    let sites = sites.get(edge).unwrap_or(&[]);
    let skip = |at_last| junctions.skip(End { edge, at_last });
    sites.get(skip(false)..sites.len().saturating_sub(skip(true))).unwrap_or(&[])
}

/// Rows below a band's own in which a patch that begins in it mostly ends.
pub(super) const BELOW_ROWS: u32 = 16;

/// Width of the widest line, px.
const WIDEST_PX: f64 = 192.0;

/// How far up and down the line is looked for that a patch belongs to, px.
const REACH_PX: f64 = 64.0;

/// Rows in which the stubs are found in one go.
const SLICE_ROWS: u32 = 200;

/// The stubs of a band, as strokes of their own from the middle of their line; none when what is near does not decide about
/// all of them. Works in `words`, whatever they are.
pub(super) fn stubs(lines: &Lines<'_>, core: &Range<u32>, words: &mut Vec<u64>) -> Option<Vec<Fragment>> {
    let slice = |start: u32| start..start.saturating_add(SLICE_ROWS).min(core.end);
    let slices = core.clone().step_by(SLICE_ROWS as usize).map(slice).collect();
    // The first to come takes the memory that is there, and leaves it to the next.
    let memory = Mutex::new(core::mem::take(words));
    let found = each(slices, |slice| {
        let mut own = memory.lock().map_or_else(|_| Vec::new(), |mut words| core::mem::take(&mut *words));
        let found = lines.stubs(&slice, core, &mut own);
        if let Ok(mut words) = memory.lock()
            && words.capacity() < own.capacity()
        {
            *words = own;
        }
        found
    });
    *words = memory.into_inner().unwrap_or_default();
    let found: Option<Vec<_>> = found.into_iter().collect();
    found.map(|found| found.into_iter().flatten().collect())
}

/// A place that the drawn lines leave bare.
struct Patch {
    pixels: Vec<Pixel>,
    centre: PxPoint,
}

impl Lines<'_> {
    /// The stubs that begin in some rows of the band `core`; none when what is near does not decide about all of them.
    fn stubs(&self, slice: &Range<u32>, core: &Range<u32>, words: &mut Vec<u64>) -> Option<Vec<Fragment>> {
        let all = &self.all;
        // With a row above: what reaches it begins above, and is none of this slice's.
        let start = slice.start.saturating_sub(1).max(all.start);
        let to = |end: u32, below: u32| start..end.saturating_add(below).min(all.end);
        let most = if self.near.places == *all { u32::MAX } else { BELOW_ROWS };
        let patches = self
            .patches(to(slice.end, BELOW_ROWS), slice, words)
            .or_else(|| self.patches(to(core.end, most), slice, words))?;
        let mut found = Vec::new();
        for (patch, root) in patches.iter().zip(self.roots(&patches)) {
            // Of what is drawn by itself nothing is left bare.
            if patch.pixels.first().is_some_and(|at| self.marks.has_ink(*at)) {
                continue;
            }
            if !self.is_sure(patch, root) {
                return None;
            }
            let stub = root.and_then(|root| stub(&patch.pixels, patch.centre, root));
            // A line that no ink leads to it from has nothing to do with it.
            if let Some(stub) = stub.filter(|[from, to]| self.is_ink_between(*from, *to)) {
                let places = stub.map(|at| Place::new(at, -1.0, false)).to_vec();
                found.push(Fragment { places, joints: Some([Joint::Free; 2]) });
            }
        }
        Some(found)
    }

    /// Whether all that lies between two places is ink, but for what the raster rounds.
    fn is_ink_between(&self, from: PxPoint, to: PxPoint) -> bool {
        let length_px = from.distance(to);
        let direction = ((to.x - from.x) / length_px, (to.y - from.y) / length_px);
        length_px <= 0.0 || self.scan.reach_px(from, direction, length_px) + 1.0 >= length_px
    }

    /// The patches that begin in the rows `own`, of the ink in some rows; none when one of them may go on below.
    fn patches(&self, rows: Range<u32>, own: &Range<u32>, words: &mut Vec<u64>) -> Option<Vec<Patch>> {
        let top = self.scan.first_row;
        let inside = rows.start.saturating_sub(top)..rows.end.saturating_sub(top);
        let mut bare = self.scan.ink.band_in(inside, words);
        let goes_on = rows.end < self.all.end;
        let mut wiper = Wiper::new(&mut bare, rows.start);
        self.each_place(&rows, 0.0, |at, width_px| wiper.add(at, 0.5 * width_px + MARGIN_PX));
        wiper.wipe();
        let mut patches = Vec::new();
        for y in 0..bare.height() {
            if bare.row(y).iter().all(|bits| *bits == 0) {
                continue;
            }
            for word in 0..bare.row(y).len() {
                while let Some(first) = bare.first_of_word(y, word) {
                    let mut pixels = take(&mut bare, first);
                    pixels.iter_mut().for_each(|at| at.y = at.y.saturating_add(rows.start));
                    if !own.contains(&first.y.saturating_add(rows.start)) {
                        continue;
                    }
                    if goes_on && pixels.iter().any(|at| at.y + 1 == rows.end) {
                        *words = bare.into_words();
                        return None;
                    }
                    if pixels.len() > 2 && pixels.len() <= MOST_PIXELS {
                        let centre = centre(&pixels);
                        patches.push(Patch { pixels, centre });
                    }
                }
            }
        }
        *words = bare.into_words();
        Some(patches)
    }

    /// The nearest place of a line to each patch, and the line's width there: of equally near ones the first from the top.
    fn roots(&self, patches: &[Patch]) -> Vec<Option<(PxPoint, f64)>> {
        let mut roots = vec![None; patches.len()];
        let mut by_row: Vec<(f64, usize)> =
            patches.iter().enumerate().map(|(index, patch)| (patch.centre.y, index)).collect();
        by_row.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (Some((first, _)), Some((last, _))) = (by_row.first(), by_row.last()) else { return roots };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of a picture")]
        let rows = *first as u32..(*last as u32).saturating_add(1);
        self.each_place(&rows, REACH_PX, |at, width_px| {
            let from = by_row.partition_point(|(y, _)| at.y > y + REACH_PX);
            for (y, index) in by_row.get(from..).unwrap_or(&[]) {
                if at.y < y - REACH_PX {
                    break;
                }
                let (Some(patch), Some(root)) = (patches.get(*index), roots.get_mut(*index)) else {
                    continue;
                };
                if is_nearer(patch.centre, at, *root) {
                    *root = Some((at, width_px));
                }
            }
        });
        roots
    }

    /// Whether no place in rows that are not known can be nearer to a patch than its root.
    fn is_sure(&self, patch: &Patch, root: Option<(PxPoint, f64)>) -> bool {
        let places = &self.near.places;
        let above = (places.start > self.all.start).then(|| patch.centre.y - f64::from(places.start));
        let below = (places.end < self.all.end).then(|| f64::from(places.end) - patch.centre.y);
        let known_px = above.into_iter().chain(below).fold(REACH_PX, f64::min);
        known_px >= REACH_PX || root.is_some_and(|(at, _)| at.distance(patch.centre) < known_px)
    }
}

/// Whether a place is nearer than the root so far, or as near and comes before it.
fn is_nearer(centre: PxPoint, at: PxPoint, root: Option<(PxPoint, f64)>) -> bool {
    let Some((root, _)) = root else { return true };
    let squared = |to: PxPoint| {
        let (dx, dy) = to.minus(centre);
        dx * dx + dy * dy
    };
    // Far more than the squares are rounded.
    const ROUNDING: f64 = 1.0 + 1e-12;
    squared(at) <= squared(root) * ROUNDING
        && (at.distance(centre).total_cmp(&root.distance(centre)))
            .then(at.y.total_cmp(&root.y))
            .then(at.x.total_cmp(&root.x))
            .is_lt()
}

impl Lines<'_> {
    /// Typical width of the line from an end on.
    fn typical_px(&self, end: End) -> f64 {
        let sites = calm_sites(self.sites, self.junctions, end.edge);
        let first = if end.at_last { sites.len().saturating_sub(TYPICAL_SITES) } else { 0 };
        let some = sites.get(first..sites.len().min(first + TYPICAL_SITES)).unwrap_or(&[]);
        if some.is_empty() { 0.0 } else { typical_width_px(some).min(WIDEST_PX) }
    }

    /// Every place of the lines whose pen comes to some rows, or that lies at most `reach_px` from them: about a pixel
    /// apart, and the line's width there.
    fn each_place(&self, rows: &Range<u32>, reach_px: f64, mut visit: impl FnMut(PxPoint, f64)) {
        let (low, high) = (f64::from(rows.start), f64::from(rows.end));
        let within = |off_px: f64, width_px: f64| off_px <= reach_px.max(0.5 * width_px + MARGIN_PX);
        let near = |at: PxPoint, width_px: f64| within((low - at.y).max(at.y - high), width_px);
        let comes_near = |some: &Extent| within((low - some.bottom).max(some.top - high), some.widest_px);
        for (edge, extents) in self.junctions.lines.iter().copied().zip(&self.extents) {
            let sites = calm_sites(self.sites, self.junctions, edge);
            let closed = self.graph.edges.get(edge).is_some_and(|edge| edge.nodes.is_none());
            let mut calm = Calm { sites, closed, known: None };
            let together = sites.chunks(TOGETHER).zip((0..).step_by(TOGETHER)).zip(extents);
            for ((some, first), _) in together.filter(|(_, extent)| comes_near(extent)) {
                for (index, site) in (first..).zip(some) {
                    // Calm it is no wider.
                    if near(site.centre, site.width_px) {
                        let width_px = calm.px(index);
                        if near(site.centre, width_px) {
                            visit(site.centre, width_px);
                        }
                    }
                }
            }
        }
        for connection in self.junctions.of_lines() {
            let root = |end: End| {
                let sites = self.sites.get(end.edge)?;
                let skip = self.junctions.skip(end);
                // Of a line that lies in junctions altogether, where it leads to.
                let skip = skip.min(sites.len().checked_sub(1)?);
                let index = if end.at_last { sites.len() - 1 - skip } else { skip };
                Some((sites.get(index)?.centre, calm_px(sites, index, false)))
            };
            let Some((from, calm_px)) = root(connection.from) else { continue };
            let to = connection.to.and_then(root);
            let cut = connection.points.last().filter(|at| self.scan.rim_px(**at) <= ON_RIM_PX);
            // Near its end the cuts through a line may run out of that.
            let is_end = connection.tip.is_some() || cut.is_some();
            let width_px = if is_end { self.typical_px(connection.from).max(calm_px) } else { calm_px };
            // What the rim of the picture cuts goes on beyond it.
            let beyond = cut.map(|at| {
                let (x, y) = at.minus(from);
                let length_px = libm::hypot(x, y).max(1.0);
                at.along((x / length_px, y / length_px), BEYOND_WIDTHS * width_px)
            });
            let theirs_px = to.map_or(width_px, |(_, theirs)| theirs);
            // Lines of two pens that meet in a point come to it as wide as they are.
            let meet = connection.points.len() == 1 && are_of_two_pens(width_px, theirs_px);
            let narrow_px = if meet { width_px } else { width_px.min(theirs_px) };
            let inner = connection.points.iter().copied().chain(beyond).map(|at| (at, narrow_px));
            let last_px = if meet { theirs_px } else { narrow_px };
            let mut before = from;
            for (next, width_px) in inner.chain(to.map(|(to, _)| (to, last_px))) {
                let steps = libm::ceil(before.distance(next)).clamp(1.0, 400.0);
                let mut step = 1.0;
                while step <= steps {
                    let t = step / steps;
                    let at =
                        PxPoint::new(before.x + (next.x - before.x) * t, before.y + (next.y - before.y) * t);
                    if near(at, width_px) {
                        visit(at, width_px);
                    }
                    step += 1.0;
                }
                before = next;
            }
        }
        for node in self.graph.nodes.iter().filter(|node| node.ends.is_empty()) {
            let at = PxPoint::from(node.at);
            if near(at, WIDEST_PX) {
                visit(at, 2.0 * self.scan.radius_px(at, f64::MAX) + 1.0);
            }
        }
    }
}

/// The line's own width at one site after the other.
struct Calm<'a> {
    sites: &'a [Site],
    closed: bool,
    /// The site that was asked for last, and its line's width.
    known: Option<(usize, f64)>,
}

impl Calm<'_> {
    /// The line's own width at a site: of the site before it only what comes and what goes has to be looked at.
    fn px(&mut self, index: usize) -> f64 {
        let width_px = |at: Option<usize>| Some(self.sites.get(at?)?.width_px.min(WIDEST_PX));
        let inside = !self.closed || index > CALM_SITES && index + CALM_SITES + 1 < self.sites.len();
        let slid = self.known.filter(|(before, _)| before + 1 == index && inside).and_then(|(_, calm_px)| {
            let next = width_px(index.checked_add(CALM_SITES)).unwrap_or(f64::INFINITY);
            let gone = width_px(index.checked_sub(CALM_SITES + 1)).unwrap_or(f64::INFINITY);
            if next <= calm_px { Some(next) } else { (gone > calm_px).then_some(calm_px) }
        });
        let calm_px = slid.unwrap_or_else(|| calm_px(self.sites, index, self.closed));
        self.known = Some((index, calm_px));
        calm_px
    }
}

/// The line's own width at a site: the least one near it.
fn calm_px(sites: &[Site], index: usize, closed: bool) -> f64 {
    let width_px = |at: usize| sites.get(at).map(|site| site.width_px);
    least_around(sites.len(), index, CALM_SITES, closed, width_px).min(WIDEST_PX)
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

fn centre(patch: &[Pixel]) -> PxPoint {
    #[expect(clippy::cast_precision_loss, reason = "a few pixels")]
    let area = patch.len() as f64;
    let sum = patch.iter().map(|at| PxPoint::from(*at)).fold((0.0, 0.0), |(x, y), at| (x + at.x, y + at.y));
    PxPoint::new(sum.0 / area, sum.1 / area)
}

/// The stub that a bare patch is, from the middle of the nearest line, `line_px` wide, to where its pen stopped.
fn stub(patch: &[Pixel], centre: PxPoint, (root, line_px): (PxPoint, f64)) -> Option<[PxPoint; 2]> {
    #[expect(clippy::cast_precision_loss, reason = "a few pixels")]
    let area = patch.len() as f64;
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
