//! From a skeleton to pen strokes: nodes and edges, junctions where they truly are, ends that reach the ink's end.
//!
//! Thinning keeps the topology of the ink and nothing else: near a crossing its lines bend towards each other
//! (`>--<` instead of `X`), at a corner they take the short cut, at an end they stop early. What is left of a
//! line's true course are its stretches away from all that, where its middle lies half way between its two edges.
//! So:
//!
//! 1. [`Graph`] turns the skeleton into nodes and edges;
//! 2. [`sites`](site) gives each of an edge's pixels the middle between both edges of the ink, and the width there;
//! 3. [`spurs`](spur) that stick out no farther than the edge's roughness go, and [`dots`](dot) become one node each;
//! 4. [`junctions`](junction): the arms of a crossing are extrapolated from where they are undisturbed, and meet;
//! 5. [`corners`](corner) of a single line are sharpened in the same way;
//! 6. small [`marks`](mark), in which no line is undisturbed, are drawn again as a whole.

mod arm;
mod bend;
mod build;
mod centreline;
mod connection;
mod corner;
mod dot;
mod fan;
mod fragment;
mod join;
mod junction;
mod leave_out;
mod line_end;
mod mark;
mod meeting;
mod near;
mod pixel_line;
mod place;
mod raster_line;
mod redraw;
mod short;
mod site;
mod sites;
mod smooth;
mod spur;
mod straight;
mod strip;
mod stroke;
mod trace;
mod trial;

pub(crate) use build::Stretch;
use build::{Edge, End, Graph, Node};
pub(crate) use fragment::Fragment;
pub(crate) use join::Joiner;
use mark::Marks;
pub(crate) use pixel_line::pixel_fragments;
use place::Place;
pub(crate) use site::{Rims, Scan};
pub(crate) use stroke::{Cuts, Stroke};

use crate::stroke::Bounded;
use core::ops::Range;

/// Rows of context that a band needs beside what its thinning needs: how far a junction looks along its arms.
pub(crate) const CONTEXT_ROWS: u32 = 288;

/// The pieces of centrelines in the rows `core` of a picture, from a stretch of its skeleton with a few hundred rows more
/// on either side; the skeleton's first row is row `first_row` of the picture. The scan has these rows, and may have
/// more. Works in `words`, whatever they are.
///
/// Small marks are drawn again as a whole from what `marks` makes of their lines, if anything.
///
/// All coordinates are those of the whole picture, so that sums and roots round alike whatever the band.
pub(crate) fn fragments(
    scan: Scan<'_>,
    skeleton: &Stretch<'_>,
    first_row: u32,
    core: &Range<u32>,
    marks: Option<Bounded>,
    words: &mut Vec<u64>,
) -> Vec<Fragment> {
    let graph = trace::graph_of(scan, skeleton, first_row, words);
    let marks = marks.map(|bounded| Marks::of(&graph, scan, core, bounded)).unwrap_or_default();
    let rows = first_row.saturating_add(skeleton.rows.start)..first_row.saturating_add(skeleton.rows.end);
    let mut found = trace::trace(graph, scan, &rows, core, &marks.edges);
    found.extend(marks.strokes);
    found
}
