//! Marks: letters, figures and signs so small that nowhere in them a line is undisturbed.
//!
//! What junctions and corners are made of, an arm that runs straight for a few widths, a letter 12 px high by a pen of
//! 3 px has not. So each such mark is traced by itself, in a picture of its own, and drawn again as a whole
//! ([`redraw`](super::redraw)): its vertices go to where the pen leaves the ink that is there.

use super::fragment::{Fragment, Joint};
use super::join::Joiner;
use super::redraw::Redrawn;
use super::site::{Rims, Scan, THIN_PX};
use super::trace::{graph_of, trace};
use super::{Cuts, Graph, Place, Stretch, Stroke};
use crate::centreline::fit::Canvas;
use crate::disjoint_sets::DisjointSets;
use crate::parallel::each;
use crate::raster::continuity::neighbours;
use crate::stroke::Pieces;
use crate::{
    picture::{Bitmap, Gray, Pixel},
    stroke::{Bounded, PxPoint},
};
use core::ops::Range;

/// Most columns and rows of a mark, px: letters up to 24 px high by a pen of 4 px, or two of 12 px that touch. In what is
/// larger there is room for lines.
const MOST_PX: u32 = 32;

/// Paper around a mark's own picture, px: what a level beyond a rim is asked for.
const PAPER_PX: u32 = 3;

/// Marks that are redrawn in one go.
const MARKS_TOGETHER: usize = 16;

/// Fewest widths of its pen that a mark is long or high: less is a dot, or a dash, and its junctions say all.
const LEAST_WIDTHS: f64 = 2.5;

/// The marks of a band.
#[derive(Default)]
pub(super) struct Marks {
    /// Of each edge whether it is part of one.
    pub(super) edges: Vec<bool>,
    /// The strokes of those that begin in the band's own rows.
    pub(super) strokes: Vec<Fragment>,
}

impl Marks {
    /// The marks that come to the rows `core`, redrawn where that meets their ink better than what `bounded` makes of
    /// their lines.
    pub(super) fn of(graph: &Graph, scan: Scan<'_>, core: &Range<u32>, bounded: Bounded) -> Self {
        let mut marks = Self { edges: vec![false; graph.edges.len()], ..Self::default() };
        let redrawn = |edges: &Vec<usize>| {
            let pixels =
                || edges.iter().filter_map(|edge| graph.edges.get(*edge)).flat_map(|edge| &edge.pixels);
            let picture = Picture::of(pixels().copied(), scan)?;
            let top = picture.top.wrapping_add(PAPER_PX);
            let rows = top..top.saturating_add(picture.ink.height().saturating_sub(2 * PAPER_PX));
            if rows.end <= core.start || rows.start >= core.end {
                return None;
            }
            let strokes = picture.redrawn(pixels().copied(), scan, bounded)?;
            let begins = core.contains(&rows.start);
            Some((edges.clone(), if begins { strokes } else { Vec::new() }))
        };
        let components = components(graph, core);
        let some = components.chunks(MARKS_TOGETHER).collect();
        let found = each(some, |some: &[Vec<usize>]| some.iter().filter_map(redrawn).collect::<Vec<_>>());
        for (edges, mut strokes) in found.into_iter().flatten() {
            for edge in edges {
                if let Some(mark) = marks.edges.get_mut(edge) {
                    *mark = true;
                }
            }
            marks.strokes.append(&mut strokes);
        }
        marks
    }
}

/// The edges of each part of a graph that is no larger than a mark and comes near the rows `core`.
fn components(graph: &Graph, core: &Range<u32>) -> Vec<Vec<usize>> {
    let mut forest = DisjointSets::new(graph.nodes.len());
    for (a, b) in graph.edges.iter().filter_map(|edge| edge.nodes) {
        forest.join(a, b);
    }
    // A loop without nodes is a part by itself.
    let mut parts: Vec<Option<(Extent, Vec<usize>)>> = vec![None; graph.nodes.len()];
    let mut found = Vec::new();
    for (index, edge) in graph.edges.iter().enumerate() {
        let extent = Extent::of(&edge.pixels);
        let Some((a, _)) = edge.nodes else {
            found.extend(extent.is_mark(core).then(|| vec![index]));
            continue;
        };
        if let Some(part) = parts.get_mut(forest.root(a)) {
            let (whole, edges) = part.get_or_insert((extent, Vec::new()));
            *whole = whole.with(extent);
            edges.push(index);
        }
    }
    found.extend(
        parts.into_iter().flatten().filter(|(extent, _)| extent.is_mark(core)).map(|(_, edges)| edges),
    );
    found
}

/// The columns and rows that pixels lie in.
#[derive(Clone, Copy, Debug)]
struct Extent {
    left: u32,
    top: u32,
    right: u32,
    bottom: u32,
}

impl Extent {
    /// Of what is too long for a mark only that it is.
    fn of(pixels: &[Pixel]) -> Self {
        let nothing = Self { left: u32::MAX, top: u32::MAX, right: 0, bottom: 0 };
        let longest = 4 * MOST_PX as usize;
        let whole = Self { left: 0, top: 0, right: u32::MAX, bottom: u32::MAX };
        if pixels.len() > longest {
            return whole;
        }
        pixels
            .iter()
            .fold(nothing, |all, at| all.with(Self { left: at.x, top: at.y, right: at.x, bottom: at.y }))
    }

    fn with(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    fn is_mark(self, core: &Range<u32>) -> bool {
        let small = |from: u32, to: u32| to.saturating_sub(from) < MOST_PX;
        let near =
            self.bottom.saturating_add(MOST_PX) >= core.start && self.top < core.end.saturating_add(MOST_PX);
        small(self.left, self.right) && small(self.top, self.bottom) && near
    }
}

/// The ink of a mark, with paper around it.
struct Picture {
    /// Column and row of the whole picture that its first ones are; both may lie outside of it.
    left: u32,
    top: u32,
    ink: Bitmap,
}

impl Picture {
    /// The ink around the pixels of a skeleton; none when it is larger than a mark.
    fn of(skeleton: impl Iterator<Item = Pixel>, scan: Scan<'_>) -> Option<Self> {
        let mut ink: Vec<Pixel> = skeleton.take(1).collect();
        let first = *ink.first()?;
        // Ink of a mark lies as far from its skeleton as its pen's radius at most.
        let (low, high) = (
            Pixel::new(first.x.saturating_sub(2 * MOST_PX), first.y.saturating_sub(2 * MOST_PX)),
            Pixel::new(first.x + 2 * MOST_PX, first.y + 2 * MOST_PX),
        );
        let side = 4 * MOST_PX + 1;
        let mut seen = Bitmap::new(side, side).ok()?;
        let inside = |at: Pixel| Pixel::new(at.x.wrapping_sub(low.x), at.y.wrapping_sub(low.y));
        seen.set(inside(first), true);
        let mut extent = Extent::of(&ink);
        let mut next = 0;
        while let Some(at) = ink.get(next).copied() {
            next += 1;
            extent = extent.with(Extent::of(&[at]));
            if extent.right - extent.left >= MOST_PX || extent.bottom - extent.top >= MOST_PX {
                return None;
            }
            for beside in neighbours(at) {
                let near = beside.x >= low.x && beside.y >= low.y && beside.x <= high.x && beside.y <= high.y;
                if near && scan.is_ink_at(beside) && !seen.get(inside(beside)) {
                    seen.set(inside(beside), true);
                    ink.push(beside);
                }
            }
        }
        // Coordinates may wrap at the picture's border; they do so back again.
        let (left, top) = (extent.left.wrapping_sub(PAPER_PX), extent.top.wrapping_sub(PAPER_PX));
        let (width, height) = (extent.right - extent.left, extent.bottom - extent.top);
        let mut picture =
            Self { left, top, ink: Bitmap::new(width + 1 + 2 * PAPER_PX, height + 1 + 2 * PAPER_PX).ok()? };
        ink.into_iter().for_each(|at| {
            let at = picture.inside(at);
            picture.ink.set(at, true);
        });
        Some(picture)
    }

    fn inside(&self, at: Pixel) -> Pixel {
        Pixel::new(at.x.wrapping_sub(self.left), at.y.wrapping_sub(self.top))
    }

    /// The levels around the mark; none where they are not known.
    fn levels(&self, rims: Rims<'_>) -> Option<Gray> {
        let at = |x: u32, y: u32| {
            let at =
                Pixel::new(self.left.wrapping_add(x), self.top.wrapping_add(y).wrapping_sub(rims.first_row));
            rims.levels.get(at).unwrap_or(if rims.ink_is_dark { u8::MAX } else { 0 })
        };
        let (width, height) = (self.ink.width(), self.ink.height());
        let levels =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect();
        Gray::new(width, height, levels).ok()
    }

    /// The mark's strokes, redrawn; none when its lines meet the ink as well, or when its pen is too thin.
    fn redrawn(
        &self,
        skeleton: impl Iterator<Item = Pixel>,
        scan: Scan<'_>,
        bounded: Bounded,
    ) -> Option<Vec<Fragment>> {
        let (width, height) = (self.ink.width(), self.ink.height());
        let mut thin = Bitmap::new(width, height).ok()?;
        skeleton.for_each(|at| thin.set(self.inside(at), true));
        let levels = scan.grey.and_then(|rims| Some((self.levels(rims)?, rims.ink_is_dark)));
        let grey = levels.as_ref().map(|(levels, ink_is_dark)| Rims {
            levels,
            ink_is_dark: *ink_is_dark,
            first_row: 0,
        });
        let own = Scan { ink: &self.ink, first_row: 0, grey, ..scan };
        let rows = 0..height;
        let mut joiner = Joiner::default();
        let mut strokes: Vec<Stroke> = Vec::new();
        let mut widths: Vec<f64> = Vec::new();
        let skeleton = Stretch { picture: &thin, rows: rows.clone() };
        let graph = graph_of(own, &skeleton, 0, &mut Vec::new());
        for fragment in trace(graph, own, &rows, &rows, &[]) {
            widths.extend(fragment.places.iter().filter_map(|place| place.width_px()));
            strokes.extend(joiner.push(fragment));
        }
        strokes.extend(joiner.finish());
        // Where strokes run into each other they are wider than their pen.
        let thin = widths.len() / 10;
        if widths.is_empty() {
            return None;
        }
        let width_px = *widths.select_nth_unstable_by(thin, f64::total_cmp).1;
        let side_px = f64::from(width.max(height) - 2 * PAPER_PX);
        if width_px <= THIN_PX || side_px < LEAST_WIDTHS * width_px {
            return None;
        }
        let lines = strokes.into_iter().filter(|stroke| !stroke.is_empty());
        let lines: Vec<Vec<PxPoint>> =
            lines.map(|stroke| stroke.curve(Cuts::default(), bounded, Pieces::Lines).vertices).collect();
        let canvas = Canvas::of(&self.ink);
        let redrawn = Redrawn::of(&canvas, lines, width_px)?;
        Some(redrawn.strokes.iter().map(|stroke| self.fragment(stroke, 2.0 * redrawn.half_px)).collect())
    }

    /// A stroke whose vertices all stay.
    fn fragment(&self, stroke: &[PxPoint], width_px: f64) -> Fragment {
        let from_corner = |v: u32| f64::from(v.wrapping_add(PAPER_PX)) - f64::from(PAPER_PX);
        let (left, top) = (from_corner(self.left), from_corner(self.top));
        // A vertex of a thin pen may have gone out of the ink to reach its last pixels, where no pen was.
        let inside =
            |v: f64, side: u32| v.clamp(PAPER_PX.into(), side.saturating_sub(PAPER_PX).max(PAPER_PX).into());
        let place = |at: &PxPoint| {
            let (x, y) = (inside(at.x, self.ink.width()), inside(at.y, self.ink.height()));
            Place::new(PxPoint::new(x + left, y + top), width_px, true)
        };
        let closed = stroke.len() > 3 && stroke.first() == stroke.last();
        let own = stroke.get(..stroke.len() - usize::from(closed)).unwrap_or(stroke);
        Fragment { places: own.iter().map(place).collect(), joints: (!closed).then_some([Joint::Free; 2]) }
    }
}
