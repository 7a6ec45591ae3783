//! Lines one pixel wide, of which every pixel stays: the raster is the line.
//!
//! ```text
//!   . # . . .      Each pixel is a place of a stroke, where it is. At a node (n) the arms that go on straightest are one
//!   . . # . .      stroke; what is left over ends there.
//!   # # n # #
//!   . . . # .
//! ```

use super::fragment::{Joint, arm_joint, pieces};
use super::site::{Role, Site};
use super::{Edge, End, Fragment, Graph, Node, Place, Stretch};
use crate::picture::Pixel;
use crate::stroke::PxVec;
use core::ops::Range;

/// Pixels over which the direction of an arm is taken: enough for one stair of a gentle slope.
const REACH_PX: usize = 6;

/// Width of the lines, px.
const WIDTH_PX: f64 = 1.0;

/// The pieces of lines one pixel wide in the rows `core` of a picture, from a stretch of its ink with some rows more on
/// either side; the ink's first row is row `first_row` of the picture. Works in `words`, whatever they are.
pub(crate) fn pixel_fragments(
    ink: &Stretch<'_>,
    first_row: u32,
    core: &Range<u32>,
    words: &mut Vec<u64>,
) -> Vec<Fragment> {
    let mut graph = Graph::of(ink, words);
    graph.move_down(first_row);
    let mut found = Vec::new();
    let site = |at: &Pixel| Site { centre: (*at).into(), width_px: WIDTH_PX, role: Role::Course };
    let is_own = |edge: &&Edge| edge.pixels.iter().any(|at| core.contains(&at.y));
    for edge in graph.edges.iter().filter(is_own) {
        let sites: Vec<Site> = edge.pixels.iter().map(site).collect();
        // The nodes themselves are places of what joins their arms.
        pieces(edge, &sites, [1, 1], core, &mut found);
    }
    for node in graph.nodes.iter().filter(|node| core.contains(&node.at.y)) {
        let places = || vec![Place::new(node.at.into(), WIDTH_PX, false)];
        let joints = through(&graph, node).into_iter();
        found.extend(joints.map(|joints| Fragment { places: places(), joints: Some(joints) }));
    }
    found
}

/// What is joined at a node: the straightest pairs of arms first, then the one that is left over; of a dot nothing.
fn through(graph: &Graph, node: &Node) -> Vec<[Joint; 2]> {
    let arm = |end: &End| Some((arm_joint(graph, *end)?, heading(graph, *end)?));
    let mut arms: Vec<(Joint, PxVec)> = node.ends.iter().filter_map(arm).collect();
    arms.sort_unstable_by_key(|(joint, _)| *joint);
    let mut pairs = Vec::new();
    for (index, (one, PxVec { x, y })) in arms.iter().enumerate() {
        for (other, PxVec { x: u, y: v }) in arms.iter().skip(index + 1) {
            pairs.push((x * u + y * v, *one, *other));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut left: Vec<Joint> = arms.into_iter().map(|(joint, _)| joint).collect();
    let mut joined = Vec::new();
    for (_, one, other) in pairs {
        if left.contains(&one) && left.contains(&other) {
            left.retain(|joint| *joint != one && *joint != other);
            joined.push([one, other]);
        }
    }
    joined.extend(left.into_iter().map(|joint| [joint, Joint::Free]));
    if node.ends.is_empty() {
        joined.push([Joint::Free; 2]);
    }
    joined
}

/// The unit direction in which an edge leaves its node at an end.
fn heading(graph: &Graph, end: End) -> Option<PxVec> {
    let pixels = &graph.edges.get(end.edge)?.pixels;
    let last = pixels.len().checked_sub(1)?;
    let far = REACH_PX.min(last);
    let (from, to) = if end.at_last { (last, last - far) } else { (0, far) };
    let PxVec { x, y } = *pixels.get(to)? - *pixels.get(from)?;
    let length = libm::hypot(x, y);
    Some(if length > 0.0 { PxVec::new(x / length, y / length) } else { PxVec::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centreline::graph::Joiner;
    use crate::stroke::Pieces;
    use crate::{
        picture::Bitmap,
        stroke::{Bounded, PxPoint},
    };

    /// Tolerance of the strokes, and what counts as one of their places, px.
    const EXACT_PX: f64 = 1e-6;
    const NEAR_PX: f64 = 1e-5;

    /// The strokes of a picture, found in bands of so many rows; every place is a vertex.
    fn strokes(picture: &str, band_rows: u32) -> Vec<Vec<(f64, f64)>> {
        let ink = Bitmap::from_picture(picture).unwrap();
        let mut joiner = Joiner::default();
        let mut whole = Vec::new();
        for start in (0..ink.height()).step_by(band_rows as usize) {
            let stretch = Stretch { picture: &ink, rows: 0..ink.height() };
            let core = start..(start + band_rows).min(ink.height());
            let found = pixel_fragments(&stretch, 0, &core, &mut Vec::new());
            whole.extend(found.into_iter().filter_map(|fragment| joiner.push(fragment)));
        }
        assert_eq!(joiner.finish().count(), 0);
        let exact = Bounded { tolerance_px: EXACT_PX };
        let places = |at: &PxPoint| (at.x - 0.5, at.y - 0.5);
        let mut strokes: Vec<Vec<_>> = whole
            .into_iter()
            .map(|stroke| stroke.curve(Default::default(), exact, Pieces::Lines))
            .map(|curve| curve.vertices.iter().map(places).collect())
            .collect();
        strokes.sort_by(|a, b| a.partial_cmp(b).unwrap());
        strokes
    }

    #[test]
    fn a_crossing_is_two_strokes_through_its_pixel() {
        let cross = "..#....\n..#....\n#######\n..#....\n..#....\n";
        let expected = [vec![(0.0, 2.0), (6.0, 2.0)], vec![(2.0, 0.0), (2.0, 4.0)]];
        (1..6).for_each(|rows| assert_eq!(strokes(cross, rows), expected));
    }

    #[test]
    fn a_branch_ends_on_the_line_it_springs_from() {
        let branch = "#######\n...#...\n...#...\n";
        let expected = [vec![(0.0, 0.0), (6.0, 0.0)], vec![(3.0, 0.0), (3.0, 2.0)]];
        (1..4).for_each(|rows| assert_eq!(strokes(branch, rows), expected));
    }

    #[test]
    fn every_pixel_of_a_thick_place_is_kept() {
        let blob = "#......\n.##....\n.###...\n..##...\n....#..\n";
        let ink = Bitmap::from_picture(blob).unwrap();
        for rows in 1..6 {
            let strokes = strokes(blob, rows);
            let near = |at: Pixel| {
                let (x, y) = (f64::from(at.x), f64::from(at.y));
                strokes.iter().any(|stroke| {
                    let links = stroke.iter().zip(stroke.iter().skip(1).chain(stroke.last()));
                    links.into_iter().any(|((a, b), (c, d))| {
                        let squared = (c - a) * (c - a) + (d - b) * (d - b);
                        let part = ((x - a) * (c - a) + (y - b) * (d - b)) / squared.max(1e-9);
                        let part = part.clamp(0.0, 1.0);
                        libm::hypot(x - a - part * (c - a), y - b - part * (d - b)) < NEAR_PX
                    })
                })
            };
            assert!(ink.ink().all(near), "{strokes:?}");
        }
    }

    #[test]
    fn a_dot_and_a_ring_are_strokes() {
        let picture = "#.##.\n.#..#\n..##.\n";
        assert_eq!(strokes(picture, 2).len(), strokes(picture, 9).len());
        assert_eq!(strokes("#..\n..#\n", 1), [vec![(0.0, 0.0)], vec![(2.0, 1.0)]]);
    }
}
