//! [`trace`]: the fragments of a graph's lines, whatever becomes of its marks.

use super::connection::Junctions;
use super::corner::Corners;
use super::near::Near;
use super::site::Scan;
use super::sites::Sites;
use super::spur::Spurs;
use super::{Fragment, Graph, Stretch, dot, fragment, raster_line};
use core::ops::Range;

/// The graph of a skeleton whose first row is row `first_row` of the picture. Works in `words`, whatever they
/// are.
pub(super) fn graph_of(
    scan: Scan<'_>,
    skeleton: &Stretch<'_>,
    first_row: u32,
    words: &mut Vec<u64>,
) -> Graph {
    let mut graph = Graph::of(skeleton, words);
    graph.move_down(first_row);
    raster_line::put_back(&mut graph, scan, skeleton, first_row);
    graph
}

/// The fragments in the rows `core` of a graph that is known in these rows of the picture, but for those of
/// the edges that are left out.
pub(super) fn trace(
    mut graph: Graph,
    scan: Scan<'_>,
    rows: &Range<u32>,
    core: &Range<u32>,
    is_left_out: &[bool],
) -> Vec<Fragment> {
    let dots = dot::dots(&mut graph, scan);
    let near = Near::to(core, &graph, scan, rows);
    let mut sites = Sites::new(&graph, scan);
    let spurs = Spurs::new(&graph, &sites, scan, &dots);
    let junctions = Junctions::of(&graph, &sites, &spurs, scan, &near);
    Corners::new(&graph, &junctions, scan).sharpen(&mut sites);
    fragment::fragments(&graph, &sites, &junctions, is_left_out, scan, core)
}
