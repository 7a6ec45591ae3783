//! Dots: where a pen was put down and lifted at once. Of a disc of a few pixels thinning leaves one pixel, or two or three
//! in whichever direction its raster is a little longer.

use super::Graph;
use super::site::Scan;
use crate::{Pixel, PxPoint};

/// Greatest distance between two pixels of a dot's skeleton, px.
const FARTHEST_PX: f64 = 2.5;

/// Most pixels of an edge that may be a part of one.
const MOST_PIXELS: usize = 4;

/// Most nodes of one: a longer way from node to node is noise.
const MOST_NODES: usize = 6;

/// How much longer than broad the ink of a dot may be, px: its raster ends on whole pixels on either side.
const LONGER_PX: f64 = 1.0;

/// Narrower marks are the raster's own, px: every pixel is a place of them.
const NARROWEST_PX: f64 = 2.0;

/// Makes one node without edges of each dot. The edges that go with them.
pub(super) fn dots(graph: &mut Graph, scan: Scan<'_>) -> Vec<usize> {
    let mut gone = Vec::new();
    for start in 0..graph.nodes.len() {
        let Some((node, edges)) = dot(graph, start, scan) else { continue };
        if let Some(node) = graph.nodes.get_mut(node) {
            node.ends.clear();
        }
        gone.extend(edges);
    }
    gone
}

/// The node deepest in the ink of a dot whose first one is `start`, and its edges.
fn dot(graph: &Graph, start: usize, scan: Scan<'_>) -> Option<(usize, Vec<usize>)> {
    graph.nodes.get(start).filter(|node| !node.ends.is_empty())?;
    let mut nodes = vec![start];
    let mut edges: Vec<usize> = Vec::new();
    let mut next = 0;
    while let Some(node) = nodes.get(next).and_then(|node| graph.nodes.get(*node)) {
        next += 1;
        if nodes.len() > MOST_NODES {
            return None;
        }
        for end in &node.ends {
            let edge = graph.edges.get(end.edge)?;
            let (one, other) = edge.nodes?;
            // Nodes come in reading order: what has one before `start` begins there.
            if edge.pixels.len() > MOST_PIXELS || one.min(other) < start {
                return None;
            }
            if !edges.contains(&end.edge) {
                edges.push(end.edge);
                for node in [one, other] {
                    if !nodes.contains(&node) {
                        nodes.push(node);
                    }
                }
            }
        }
    }
    let pixels = || edges.iter().filter_map(|edge| graph.edges.get(*edge)).flat_map(|edge| &edge.pixels);
    let far = |one: &Pixel| pixels().any(|other| PxPoint::from(*one).distance((*other).into()) > FARTHEST_PX);
    if edges.is_empty() || pixels().any(far) {
        return None;
    }
    let at = |node: &usize| graph.nodes.get(*node).map(|node| node.at);
    let inside_px = |node: &usize| at(node).map_or(0.0, |at| scan.radius_px(at.into(), FARTHEST_PX));
    // Of equals the first one.
    let middle = nodes.iter().copied().rev().max_by(|a, b| inside_px(a).total_cmp(&inside_px(b)))?;
    let at = at(&middle)?;
    let widths = [(1.0, 0.0), (0.0, 1.0)].map(|along| scan.site(at, along).width_px);
    let (least, most) = (widths[0].min(widths[1]), widths[0].max(widths[1]));
    (least >= NARROWEST_PX && most <= least + LONGER_PX).then_some((middle, edges))
}
