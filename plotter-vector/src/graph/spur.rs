//! Spurs: short branches that thinning grows out of a rough edge.

use super::arm::{TYPICAL_SITES, typical_width_px};
use super::site::{Scan, Site};
use super::{End, Graph};
use crate::PxPoint;

/// Rounds of pruning: a spur's own spur makes it look like a fork until it is gone.
const ROUNDS: usize = 2;

/// Lines up to this width are the raster's own: nothing of them is rough.
const THIN_PX: f64 = 1.5;

/// The edges that are spurs.
///
/// A branch is one when its tip sticks out of the line that it leaves by less than half that line's width. What
/// sticks out is the branch's length and the ink around its tip, less the ink around its root. Of the lines at a
/// node at least two stay.
pub(crate) fn spurs(graph: &Graph, sites: &[Vec<Site>], scan: Scan<'_>) -> Vec<bool> {
    let mut spur = vec![false; graph.edges.len()];
    for _ in 0..ROUNDS {
        let mut found = Vec::new();
        for (index, node) in graph.nodes.iter().enumerate() {
            let is_left = |end: &&End| !spur.get(end.edge).copied().unwrap_or(true);
            let left: Vec<End> = node.ends.iter().filter(is_left).copied().collect();
            if left.len() < 3 {
                continue;
            }
            let root_px = scan.radius_px(node.at.into(), f64::MAX);
            let width_px = left.iter().map(|end| width_px(sites, *end)).fold(2.0 * root_px, f64::min);
            if width_px <= THIN_PX {
                continue;
            }
            let mut short: Vec<(f64, usize)> = left
                .iter()
                .filter_map(|end| Some((sticks_out_px(graph, scan, &spur, *end, index, root_px)?, end.edge)))
                .filter(|(out_px, _)| *out_px < 0.5 * width_px + 0.25)
                .collect();
            // The shortest ones first; two lines stay.
            short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            found.extend(short.into_iter().take(left.len() - 2).map(|(_, edge)| edge));
        }
        if found.is_empty() {
            break;
        }
        for edge in found {
            if let Some(spur) = spur.get_mut(edge) {
                *spur = true;
            }
        }
    }
    spur
}

/// Typical width of the line that begins at an end.
fn width_px(sites: &[Vec<Site>], end: End) -> f64 {
    let sites = sites.get(end.edge).map_or(&[][..], Vec::as_slice);
    let first = if end.at_last { sites.len().saturating_sub(TYPICAL_SITES) } else { 0 };
    typical_width_px(sites.get(first..sites.len().min(first + TYPICAL_SITES)).unwrap_or(&[]))
}

/// How far a branch sticks out of the ink around its root; `None` for what is no branch, or a long one.
fn sticks_out_px(
    graph: &Graph,
    scan: Scan<'_>,
    spur: &[bool],
    end: End,
    root: usize,
    root_px: f64,
) -> Option<f64> {
    let edge = graph.edges.get(end.edge)?;
    let (first, last) = edge.nodes?;
    let tip = graph.nodes.get(if end.at_last { first } else { last })?;
    let free = tip.ends.iter().filter(|end| !spur.get(end.edge).copied().unwrap_or(true)).count() == 1;
    if !free || first == last {
        return None;
    }
    let root = graph.nodes.get(root)?;
    let length_px = PxPoint::from(root.at).distance(tip.at.into());
    // No need to measure the ink around the tips of long lines.
    (length_px < 3.0 * root_px + 2.0)
        .then(|| length_px + scan.radius_px(tip.at.into(), root_px + 1.0) - root_px)
}
