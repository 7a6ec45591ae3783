//! Dots: where a pen was put down and lifted at once. Of a disc of a few pixels thinning leaves one pixel, or two or three
//! in whichever direction its raster is a little longer.

use super::Graph;
use super::site::Scan;
use crate::{PxVec, picture::Pixel, stroke::PxPoint};

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

/// Makes one node without edges of each dot. Of each edge whether it goes with them.
pub(super) fn dots(graph: &mut Graph, scan: Scan<'_>) -> Vec<bool> {
    let mut gone = vec![false; graph.edges.len()];
    for start in 0..graph.nodes.len() {
        let Some((middle, edges)) = dot(graph, start, scan) else { continue };
        if let Some(node) = graph.nodes.get_mut(start) {
            node.at = middle;
            node.ends.clear();
        }
        for edge in edges {
            if let Some(gone) = gone.get_mut(edge) {
                *gone = true;
            }
        }
    }
    gone
}

/// The middle of a dot whose first node is `start`, and its edges.
fn dot(graph: &Graph, start: usize, scan: Scan<'_>) -> Option<(Pixel, Vec<usize>)> {
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
    // The longest cuts through its ink cross in its middle.
    let longest = |along: PxVec| {
        let cuts = pixels().map(|pixel| scan.site(*pixel, along));
        cuts.max_by(|a, b| a.width_px.total_cmp(&b.width_px))
    };
    let (down, across) = (longest(PxVec::new(1.0, 0.0))?, longest(PxVec::new(0.0, 1.0))?);
    let middle = pixel_at(PxPoint::new(across.centre.x, down.centre.y));
    let (least, most) = (down.width_px.min(across.width_px), down.width_px.max(across.width_px));
    let is_dot = least >= NARROWEST_PX && most <= least + LONGER_PX && scan.is_ink_at(middle);
    is_dot.then_some((middle, edges))
}

/// The pixel that a place within the picture lies in.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
fn pixel_at(at: PxPoint) -> Pixel {
    Pixel::new(at.x as u32, at.y as u32)
}
