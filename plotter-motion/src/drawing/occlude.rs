//! [`Drawing::occlude`]: closed strokes hide what lies below them.

use super::boxes::BoxTree;
use super::region::{Keep, Region, is_near};
use super::remains::{Part, Remains};
use super::{CutCount, Drawing, Mark, PathSegment, Stroke};
use crate::Point;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::ops::ControlFlow;

/// What a closed stroke hides of the strokes that are drawn before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Hides {
    /// All of them.
    #[default]
    All,
    /// Those of its pen.
    SamePen,
    /// Those of its layer.
    SameLayer,
}

impl Hides {
    /// Strokes of the same number act on each other.
    fn group(self, stroke: &Stroke) -> u32 {
        match self {
            Self::All => 0,
            Self::SamePen => stroke.pen.into(),
            Self::SameLayer => stroke.layer,
        }
    }
}

/// The closed strokes of one sheet that hide the same others.
#[derive(Default)]
struct Cover {
    /// Which stroke of the drawing each of them is, in rising order.
    strokes: Vec<usize>,
    regions: Vec<Region>,
    tree: BoxTree,
}

impl Cover {
    /// Takes away the parts of a segment that lie in or on the border of any region from `first` on. The last
    /// one, which most likely is in sight, comes first; nothing is asked any more when all is hidden.
    fn hide(&self, first: usize, from: Point, segment: &PathSegment, shares: &mut Vec<(f64, f64)>) {
        let bounds = segment.bounds(from);
        self.tree.back_from_last(
            first,
            |other| bounds.meets(other) && is_near(other, from, segment),
            |number| {
                if let Some(region) = self.regions.get(number) {
                    region.keep(Keep::Outside, from, segment, &bounds, shares);
                }
                if shares.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        );
    }
}

impl Drawing {
    /// Takes away what is hidden: what lies in a closed stroke that is drawn later, as in a picture of opaque
    /// things of which the last one lies on top. Dots are hidden too, and so are lines on the border of a
    /// later stroke.
    ///
    /// A stroke is closed if its ends are at most `tolerance_mm` apart; its arcs and curves hide as lines
    /// within that, and what runs along them so near is hidden. A tolerance below a tenth of a micrometre is
    /// raised to that. Strokes that cross themselves hide what lies within them an odd number of times.
    /// Strokes on other sheets hide nothing. Open strokes hide nothing and are hidden.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Bounds, Drawing, Hides, Stroke}};
    /// let square = |at: f64| {
    ///     let corners = Bounds::between(Point::new(at, at), Point::new(at + 2.0, at + 2.0)).corners();
    ///     Stroke::through(corners.into_iter().chain([corners[0]])).unwrap()
    /// };
    /// // The second square, of 8 mm, hides the corner of the first: 1 mm of each of two sides.
    /// let mut drawing = Drawing { strokes: vec![square(0.0), square(1.0)], ..Drawing::new() };
    /// let count = drawing.occlude(Hides::All, 0.01);
    /// assert_eq!((count.shortened, drawing.strokes.len(), drawing.length_mm()), (1, 2, 6.0 + 8.0));
    /// ```
    ///
    /// Source: the rule is that of vpype's plugin *occult* (L. Goudet, 2021).
    pub fn occlude(&mut self, hides: Hides, tolerance_mm: f64) -> CutCount {
        let sheets: Vec<usize> = sheets(&self.strokes).collect();
        let mut covers: BTreeMap<(usize, u32), Cover> = BTreeMap::new();
        for ((number, stroke), sheet) in self.strokes.iter().enumerate().zip(&sheets) {
            if let Some(region) = Region::of_stroke(stroke, tolerance_mm) {
                let cover = covers.entry((*sheet, hides.group(stroke))).or_default();
                cover.strokes.push(number);
                cover.regions.push(region);
            }
        }
        for cover in covers.values_mut() {
            cover.tree = BoxTree::new(cover.regions.iter().map(Region::bounds));
        }
        let mut remains = Remains::default();
        let (mut shares, mut parts) = (Vec::new(), Vec::new());
        for ((number, stroke), sheet) in
            core::mem::take(&mut self.strokes).into_iter().enumerate().zip(sheets)
        {
            parts.clear();
            let cover = covers.get(&(sheet, hides.group(&stroke)));
            let first = cover.map_or(0, |cover| cover.strokes.partition_point(|other| *other <= number));
            for (segment_number, (from, segment)) in stroke.segments().enumerate() {
                shares.clear();
                shares.push((0.0, 1.0));
                if let Some(cover) = cover {
                    cover.hide(first, from, segment, &mut shares);
                }
                let part = |&(begin, end): &(f64, f64)| Part { segment: segment_number, begin, end };
                parts.extend(shares.iter().map(part));
            }
            remains.take(stroke, &parts);
        }
        remains.into_drawing(self)
    }
}

/// The sheet of each stroke, from 0.
pub(super) fn sheets(strokes: &[Stroke]) -> impl Iterator<Item = usize> + '_ {
    strokes.iter().scan(0_usize, |sheet, stroke| {
        let turned = stroke.before.iter().filter(|mark| **mark == Mark::NewPage).count();
        *sheet = sheet.saturating_add(turned);
        Some(*sheet)
    })
}
