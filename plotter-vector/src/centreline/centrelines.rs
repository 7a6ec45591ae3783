//! Ink to strokes along the middle of its lines, band after band.
//!
//! A band is thinned and taken apart with as many rows above and below as decide about its own; what it cuts
//! at its border fits what the next one cuts. So the strokes are the same whatever the height of the bands,
//! and however many threads work on them.

pub(crate) use crate::centreline::graph::CONTEXT_ROWS;
use crate::centreline::graph::{Cuts, Fragment, Joiner, Rims, Scan, Stretch, Stroke, fragments};
use crate::ink::hairlines::Hairlines;
use crate::parallel::{each, threads};
use crate::stroke::Pieces;
use crate::{
    picture::{Bitmap, Gray},
    raster::{Thinning, ThinningMethod},
    stroke::{Bounded, Curve, PxPoint},
};
use core::ops::Range;

/// How ink becomes centrelines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centring {
    /// The thinning.
    pub(crate) thinning: Thinning,
    /// What the strokes are simplified with.
    pub(crate) bounded: Bounded,
    /// What they are made of.
    pub(crate) pieces: Pieces,
    /// Whether small marks are drawn again as a whole.
    pub(crate) redraw: bool,
    /// What thin lines are.
    pub(crate) hairlines: Hairlines,
    /// Own rows of a band.
    pub(crate) band_rows: u32,
}

impl Centring {
    /// For lines up to `max_line_px` wide.
    pub(crate) fn new(method: ThinningMethod, max_line_px: u32, bounded: Bounded, band_rows: u32) -> Self {
        let thinning = Thinning { method, max_passes: max_line_px / 2 + 3 };
        Self {
            thinning,
            bounded,
            pieces: Pieces::Lines,
            redraw: false,
            hairlines: Hairlines::Raster,
            band_rows: band_rows.max(1),
        }
    }

    /// Rows that a band needs above and below its own.
    pub(crate) fn rows_of_context(&self) -> u32 {
        self.thinning.rows_of_context() + CONTEXT_ROWS
    }

    /// Where long strokes are cut: with arcs and curves nowhere, for these may go on over any cut.
    pub(crate) fn cuts(&self) -> Cuts {
        match self.pieces {
            Pieces::Lines => Cuts::default(),
            Pieces::Arcs | Pieces::Cubics => Cuts { least: usize::MAX, ..Cuts::default() },
        }
    }

    /// What is made of small marks' lines before they are drawn again; with arcs and curves they are not.
    pub(crate) fn marks(&self) -> Option<Bounded> {
        (self.redraw && self.pieces == Pieces::Lines).then_some(self.bounded)
    }

    /// The strokes of a picture in memory, in reading order of where they begin; `grey`, with whether dark is
    /// ink, makes them more exact.
    pub(crate) fn strokes(&self, ink: &Bitmap, grey: Option<(&Gray, bool)>) -> Vec<Curve> {
        let mut joiner = Joiner::default();
        let mut strokes = Vec::new();
        let bands: Vec<Range<u32>> = (0..ink.height())
            .step_by(self.band_rows as usize)
            .map(|y| y..(y + self.band_rows).min(ink.height()))
            .collect();
        // As many bands at a time as there are threads: each holds its rows twice.
        for some in bands.chunks(threads()) {
            let mut whole = Vec::new();
            for fragments in each(some.to_vec(), |rows| self.band(ink, grey, &rows)) {
                whole.extend(fragments.into_iter().filter_map(|fragment| joiner.push(fragment)));
            }
            // At once: simplified they take a hundredth of the memory.
            strokes.extend(self.simplified(whole));
            joiner.cut(self.cuts(), self.bounded);
        }
        strokes.extend(self.simplified(joiner.finish().collect()));
        sort(&mut strokes);
        strokes
    }

    /// The fragments in some rows of a picture.
    fn band(&self, ink: &Bitmap, grey: Option<(&Gray, bool)>, rows: &Range<u32>) -> Vec<Fragment> {
        let context = self.rows_of_context();
        let first_row = rows.start.saturating_sub(context);
        let band = ink.band(first_row..rows.end.saturating_add(context).min(ink.height()));
        let thinned = rows.start.saturating_sub(CONTEXT_ROWS).saturating_sub(first_row)
            ..(rows.end.saturating_add(CONTEXT_ROWS).min(ink.height()) - first_row);
        let grey = grey.map(|(levels, ink_is_dark)| Rims { levels, ink_is_dark, first_row: 0 });
        let mut skeleton = band.clone();
        // Lines that are wider than expected stay so in places: their middle is found all the same.
        let _ = self.thinning.thin_rows(&mut skeleton, thinned.clone());
        let stretch = Stretch { picture: &skeleton, rows: thinned };
        fragments(
            Scan { ink: &band, first_row, grey, hairlines: self.hairlines },
            &stretch,
            first_row,
            rows,
            self.marks(),
            &mut Vec::new(),
        )
    }

    /// Strokes simplified.
    pub(crate) fn simplified(&self, mut whole: Vec<Stroke>) -> Vec<Curve> {
        whole.retain(|whole| !whole.is_empty());
        let mut strokes = each(whole, |whole| whole.curve(self.cuts(), self.bounded, self.pieces));
        strokes.retain(|stroke| !stroke.vertices.is_empty());
        strokes.iter_mut().for_each(|stroke| stroke.vertices.shrink_to_fit());
        strokes
    }
}

/// Brings strokes into an order that depends on nothing but themselves: that of their vertices in turn, from
/// the top.
pub(crate) fn sort(strokes: &mut [Curve]) {
    strokes.sort_unstable_by(compare);
}

/// By the vertices in turn, then by the bulges and the handles.
fn compare(one: &Curve, other: &Curve) -> core::cmp::Ordering {
    let places = one.vertices.iter().zip(&other.vertices);
    let unequal =
        places.map(|(a, b)| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))).find(|order| order.is_ne());
    let bulges =
        || one.bulges.iter().zip(&other.bulges).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
    let handles = |curve: &Curve| -> Vec<[PxPoint; 2]> { curve.handles.iter().flatten().copied().collect() };
    let bends = || {
        let (one, other) = (handles(one), handles(other));
        let places = one.iter().flatten().zip(other.iter().flatten());
        places.map(|(a, b)| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))).find(|order| order.is_ne())
    };
    let lengths = |curve: &Curve| (curve.vertices.len(), curve.bulges.len(), curve.handles.len());
    let rest = || bulges().or_else(bends).unwrap_or(core::cmp::Ordering::Equal);
    unequal.unwrap_or_else(|| lengths(one).cmp(&lengths(other)).then_with(rest))
}
