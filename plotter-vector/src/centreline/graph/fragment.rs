//! [`Fragment`]: a piece of a stroke as one band of a picture sees it, with what it joins at either end.
//!
//! Everything about a line is decided by the ink within a few hundred rows. A band that is given as many rows above and
//! below comes to the same decisions as its neighbours; it hands out what lies in its own rows, and what it cuts at
//! their border fits the neighbour's piece.

use super::connection::{Connection, Junctions, Tip};
use super::site::{Role, Scan, Site};
use super::sites::Sites;
use super::{Edge, End, Graph, Place};
use crate::{PxVec, picture::Pixel, stroke::PxPoint};
use core::ops::Range;

/// What the end of a fragment joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Joint {
    /// Nothing: the line ends.
    Free,
    /// The other side of a cut between two pixels of a line, the first one in reading order first.
    Cut(Pixel, Pixel),
    /// What a junction at the first pixel has for the arm that leaves it over the second one.
    Arm(Pixel, Pixel),
}

/// A piece of a stroke.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fragment {
    /// Its places in order; none where an edge lies within junctions altogether.
    pub(crate) places: Vec<Place>,
    /// What its start and its end join; none when the end joins the start: a closed line.
    pub(crate) joints: Option<[Joint; 2]>,
}

fn place_of(site: &Site) -> Option<Place> {
    (site.role != Role::Left).then(|| Place::new(site.centre, site.width_px, site.role == Role::Corner))
}

fn cut(one: Pixel, other: Pixel) -> Joint {
    Joint::Cut(one.min(other), one.max(other))
}

/// The fragments in the rows `core`, which are a band's own, but for those of edges that are left out.
pub(super) fn fragments(
    graph: &Graph,
    sites: &Sites<'_>,
    junctions: &Junctions,
    is_left_out: &[bool],
    scan: Scan<'_>,
    core: &Range<u32>,
) -> Vec<Fragment> {
    let stays = |edge: usize| is_left_out.get(edge) != Some(&true);
    let mut found = Vec::new();
    for index in junctions.lines.iter().copied().filter(|edge| stays(*edge)) {
        if let (Some(edge), Some(sites)) = (graph.edges.get(index), sites.get(index)) {
            let skip = |at_last| junctions.skip(End { edge: index, at_last });
            pieces(edge, sites, [skip(false), skip(true)], core, &mut found);
        }
    }
    let own = |one: &&Connection| core.contains(&one.owner.y) && stays(one.from.edge);
    for connection in junctions.of_lines().filter(own) {
        let joint = |end: End| arm_joint(graph, end);
        let Some(start) = joint(connection.from) else { continue };
        let end = match connection.to {
            Some(to) => joint(to),
            None => Some(Joint::Free),
        };
        let place = |at: &PxPoint| match connection.tip {
            None => Place::new(*at, -1.0, connection.corner),
            Some(Tip::Ahead) => Place::tip(*at),
            Some(Tip::Seated) => Place::seated_tip(*at),
        };
        let places = connection.points.iter().map(place).collect();
        found.extend(end.map(|end| Fragment { places, joints: Some([start, end]) }));
    }
    for node in graph.nodes.iter().filter(|node| node.ends.is_empty() && core.contains(&node.at.y)) {
        let (down, across) =
            (scan.site(node.at, PxVec::new(1.0, 0.0)), scan.site(node.at, PxVec::new(0.0, 1.0)));
        let dot = PxPoint::new(across.centre.x, down.centre.y);
        let places = vec![Place::new(dot, down.width_px.min(across.width_px), false)];
        found.push(Fragment { places, joints: Some([Joint::Free; 2]) });
    }
    found
}

/// The joint of an edge's end: its node and the pixel beside it.
pub(super) fn arm_joint(graph: &Graph, end: End) -> Option<Joint> {
    let pixels = &graph.edges.get(end.edge)?.pixels;
    let (at, next) = if end.at_last {
        (pixels.last()?, pixels.get(pixels.len().checked_sub(2)?)?)
    } else {
        (pixels.first()?, pixels.get(1)?)
    };
    Some(Joint::Arm(*at, *next))
}

/// What lies in the rows `core` of an edge, but for so many sites at its start and its end.
pub(super) fn pieces(
    edge: &Edge,
    sites: &[Site],
    [skip_first, skip_last]: [usize; 2],
    core: &Range<u32>,
    found: &mut Vec<Fragment>,
) {
    let joint = |at_last: bool| {
        let (at, next) = if at_last {
            (edge.pixels.last(), edge.pixels.len().checked_sub(2).and_then(|index| edge.pixels.get(index)))
        } else {
            (edge.pixels.first(), edge.pixels.get(1))
        };
        at.zip(next).map_or(Joint::Free, |(at, next)| Joint::Arm(*at, *next))
    };
    let (first, last) = (skip_first, sites.len().saturating_sub(skip_last));
    if edge.nodes.is_none() {
        cut_loop(edge, sites, core, found);
        return;
    }
    if first >= last {
        // All of it lies in junctions: the two arms are one straight piece.
        if edge.pixels.first().is_some_and(|at| core.contains(&at.y)) {
            found.push(Fragment { places: Vec::new(), joints: Some([joint(false), joint(true)]) });
        }
        return;
    }
    let mut open: Option<(Joint, Vec<Place>)> = None;
    for at in first..last {
        let (Some(pixel), Some(site)) = (edge.pixels.get(at), sites.get(at)) else { break };
        let before = at.checked_sub(1).and_then(|before| edge.pixels.get(before));
        if core.contains(&pixel.y) {
            let start = || match before {
                Some(before) if at > first => cut(*before, *pixel),
                _ => joint(false),
            };
            open.get_or_insert_with(|| (start(), Vec::new())).1.extend(place_of(site));
        } else if let Some((start, places)) = open.take() {
            let end = before.map_or(Joint::Free, |before| cut(*before, *pixel));
            found.push(Fragment { places, joints: Some([start, end]) });
        }
    }
    if let Some((start, places)) = open {
        found.push(Fragment { places, joints: Some([start, joint(true)]) });
    }
}

/// What lies in the rows `core` of a loop without nodes.
fn cut_loop(edge: &Edge, sites: &[Site], core: &Range<u32>, found: &mut Vec<Fragment>) {
    // The last pixel is the first one again.
    let count = edge.pixels.len().saturating_sub(1);
    let pixel = |index: usize| edge.pixels.get(index % count.max(1)).copied().unwrap_or_default();
    let place = |index: usize| sites.get(index % count.max(1)).and_then(place_of);
    let Some(outside) = (0..count).find(|index| !core.contains(&pixel(*index).y)) else {
        found.push(Fragment { places: (0..count).filter_map(place).collect(), joints: None });
        return;
    };
    // Once around from a pixel outside, so that no piece is met in its middle.
    let mut open: Option<(Joint, Vec<Place>)> = None;
    for index in outside + 1..=outside + count {
        let cut = cut(pixel(index - 1), pixel(index));
        if core.contains(&pixel(index).y) {
            open.get_or_insert_with(|| (cut, Vec::new())).1.extend(place(index));
        } else if let Some((start, places)) = open.take() {
            found.push(Fragment { places, joints: Some([start, cut]) });
        }
    }
}
