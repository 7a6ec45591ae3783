//! [`Graph`]: the nodes and edges of a skeleton.

use crate::picture::{Bitmap, Pixel};
use core::ops::Range;
use std::collections::HashMap;

/// The eight neighbours in the order of the bits of a neighbourhood, clockwise from the right (y down).
const AROUND: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Which neighbours a pixel is linked to: all beside, above and below it, and those across a corner that cannot be
/// reached over one of them. So three pixels around a corner are a path, not a triangle.
const LINKS: [u8; 256] = links();

#[expect(clippy::cast_possible_truncation, reason = "below 256")]
const fn links() -> [u8; 256] {
    let mut table = [0; 256];
    let mut around = 0;
    while around < 256 {
        let mut mask = around as u8 & 0b0101_0101;
        let mut diagonal = 1;
        while diagonal < 8 {
            let beside = 1 << (diagonal - 1) | 1 << ((diagonal + 1) % 8);
            if around & 1 << diagonal != 0 && around & beside == 0 {
                mask |= 1 << diagonal;
            }
            diagonal += 2;
        }
        table[around] = mask;
        around += 1;
    }
    table
}

/// Some rows of a skeleton: what lies above and below is as if it were not there.
#[derive(Clone, Debug)]
pub(crate) struct Stretch<'a> {
    /// The skeleton.
    pub(crate) picture: &'a Bitmap,
    /// The rows, as the picture counts them.
    pub(crate) rows: Range<u32>,
}

impl Stretch<'_> {
    /// The links of a pixel, a bit for each of [`AROUND`].
    fn links_of(&self, at: Pixel) -> u8 {
        const BELOW: u8 = 0b0000_1110;
        const ABOVE: u8 = 0b1110_0000;
        let mut around = self.picture.around(at);
        if at.y == self.rows.start {
            around &= !ABOVE;
        }
        if at.y + 1 == self.rows.end {
            around &= !BELOW;
        }
        LINKS.get(usize::from(around)).copied().unwrap_or(0)
    }
}

/// The pixels of a skeleton that are not yet in an edge, from its row `first_row` on.
struct Rest {
    picture: Bitmap,
    first_row: u32,
}

impl Rest {
    fn has(&self, at: Pixel) -> bool {
        at.y.checked_sub(self.first_row).is_some_and(|y| self.picture.get(Pixel { y, ..at }))
    }

    fn take(&mut self, at: Pixel) {
        if let Some(y) = at.y.checked_sub(self.first_row) {
            self.picture.set(Pixel { y, ..at }, false);
        }
    }
}

/// The neighbour in a direction of [`AROUND`].
fn step(at: Pixel, direction: usize) -> Pixel {
    let (dx, dy) = AROUND.get(direction).copied().unwrap_or((0, 0));
    Pixel::new(at.x.wrapping_add_signed(dx), at.y.wrapping_add_signed(dy))
}

/// The directions in a mask of links.
fn directions(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).filter(move |direction| mask & 1 << direction != 0)
}

/// One of the two ends of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct End {
    /// Index of the edge.
    pub(crate) edge: usize,
    /// Whether it is the end of the edge's pixels; else their start.
    pub(crate) at_last: bool,
}

impl End {
    /// The edge's other end.
    pub(crate) fn other(self) -> Self {
        Self { at_last: !self.at_last, ..self }
    }
}

/// A chain of skeleton pixels from node to node, both included; of a closed loop without a node, from one pixel
/// around to the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct Edge {
    /// Neighbouring pixels in order.
    pub(crate) pixels: Vec<Pixel>,
    /// The nodes at the first and the last pixel; none for a closed loop.
    pub(crate) nodes: Option<(usize, usize)>,
}

/// A pixel of the skeleton where a line ends or lines meet.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Where.
    pub(crate) at: Pixel,
    /// The edges that end here, clockwise from the right; a loop's two ends both.
    pub(crate) ends: Vec<End>,
}

/// The nodes and edges of a skeleton one pixel wide. Nodes come in reading order, edges in the order of their first
/// nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    /// Ends (one edge), junctions (three or more) and dots (none).
    pub(crate) nodes: Vec<Node>,
    /// What connects them.
    pub(crate) edges: Vec<Edge>,
}

impl Graph {
    /// Follows all lines of a skeleton. Every pixel is in exactly one edge, or is a node; linear in the skeleton. Works in
    /// `words`, whatever they are.
    pub(crate) fn of(skeleton: &Stretch<'_>, words: &mut Vec<u64>) -> Self {
        let mut graph = Self::default();
        let mut at_pixel = HashMap::new();
        let mut rest = Rest {
            picture: skeleton.picture.band_in(skeleton.rows.clone(), words),
            first_row: skeleton.rows.start,
        };
        for at in rest.picture.ink() {
            let at = Pixel { y: at.y + rest.first_row, ..at };
            if skeleton.links_of(at).count_ones() != 2 {
                at_pixel.insert(at, graph.nodes.len());
                graph.nodes.push(Node { at, ends: Vec::new() });
            }
        }
        // What is left of the rest in the end are closed loops.
        for node in 0..graph.nodes.len() {
            let Some(start) = graph.nodes.get(node).map(|node| node.at) else { continue };
            rest.take(start);
            for direction in directions(skeleton.links_of(start)) {
                let first = step(start, direction);
                // The other node of an edge of two pixels walks it only from the one that comes first.
                let direct = at_pixel.get(&first).copied();
                if direct.is_some_and(|other| other < node) || (direct.is_none() && !rest.has(first)) {
                    continue;
                }
                let (mut pixels, other) = walk(skeleton, &mut rest, &at_pixel, start, first);
                pixels.shrink_to_fit();
                let edge = graph.edges.len();
                graph.edges.push(Edge { pixels, nodes: Some((node, other)) });
                for (node, at_last) in [(node, false), (other, true)] {
                    if let Some(node) = graph.nodes.get_mut(node) {
                        node.ends.push(End { edge, at_last });
                    }
                }
            }
        }
        for y in 0..rest.picture.height() {
            for word in 0..rest.picture.row(y).len() {
                while let Some(start) = rest.picture.first_of_word(y, word) {
                    rest.picture.set(start, false);
                    let start = Pixel { y: y + rest.first_row, ..start };
                    if let Some(direction) = directions(skeleton.links_of(start)).next() {
                        let first = step(start, direction);
                        let (mut pixels, _) = walk(skeleton, &mut rest, &at_pixel, start, first);
                        pixels.push(start);
                        pixels.dedup();
                        pixels.shrink_to_fit();
                        graph.edges.push(Edge { pixels, nodes: None });
                    }
                }
            }
        }
        *words = rest.picture.into_words();
        graph
    }

    /// Moves everything down by some rows.
    pub(crate) fn move_down(&mut self, rows: u32) {
        let nodes = self.nodes.iter_mut().map(|node| &mut node.at);
        let pixels = self.edges.iter_mut().flat_map(|edge| &mut edge.pixels);
        nodes.chain(pixels).for_each(|at| at.y = at.y.saturating_add(rows));
    }
}

/// The pixels from `start` over `first` on to the next node, which is the second result, or around a loop back to
/// `start`.
fn walk(
    skeleton: &Stretch<'_>,
    rest: &mut Rest,
    at_pixel: &HashMap<Pixel, usize>,
    start: Pixel,
    first: Pixel,
) -> (Vec<Pixel>, usize) {
    let mut pixels = vec![start];
    let (mut before, mut at) = (start, first);
    loop {
        pixels.push(at);
        let links = skeleton.links_of(at);
        if links.count_ones() != 2 {
            return (pixels, at_pixel.get(&at).copied().unwrap_or(0));
        }
        rest.take(at);
        let on = directions(links).map(|direction| step(at, direction)).find(|next| *next != before);
        match on {
            Some(next) if next != start || at_pixel.contains_key(&next) => (before, at) = (at, next),
            _ => return (pixels, 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(picture: &str) -> Graph {
        let skeleton = Bitmap::from_picture(picture).unwrap();
        Graph::of(&Stretch { picture: &skeleton, rows: 0..skeleton.height() }, &mut Vec::new())
    }

    #[test]
    fn rows_beside_the_stretch_are_not_there() {
        let skeleton = Bitmap::from_picture("#...\n.#..\n..#.\n...#\n").unwrap();
        let graph = Graph::of(&Stretch { picture: &skeleton, rows: 1..3 }, &mut vec![7; 99]);
        assert_eq!(graph.edges.len(), 1);
        assert_eq!(graph.edges[0].pixels, [Pixel::new(1, 1), Pixel::new(2, 2)]);
    }

    #[test]
    fn a_line_is_an_edge_between_two_ends() {
        let line = graph("##...\n..##.\n....#\n");
        assert_eq!(line.nodes.len(), 2);
        assert_eq!(line.edges.len(), 1);
        assert_eq!(line.edges[0].pixels.len(), 5);
    }

    #[test]
    fn a_corner_is_no_junction() {
        let corner = graph("###\n..#\n..#\n");
        assert_eq!((corner.nodes.len(), corner.edges.len()), (2, 1));
    }

    #[test]
    fn a_cross_is_one_node_with_four_edges() {
        let cross = graph("..#..\n..#..\n#####\n..#..\n..#..\n");
        assert_eq!((cross.nodes.len(), cross.edges.len()), (5, 4));
        assert_eq!(cross.nodes.iter().map(|node| node.ends.len()).max(), Some(4));
    }

    #[test]
    fn a_ring_is_one_edge_without_nodes() {
        let ring = graph(".##.\n#..#\n#..#\n.##.\n");
        assert_eq!((ring.nodes.len(), ring.edges.len()), (0, 1));
        let pixels = &ring.edges[0].pixels;
        assert_eq!((pixels.len(), pixels.first()), (9, pixels.last()));
    }

    #[test]
    fn a_loop_at_a_node_ends_twice_there() {
        let lasso = graph("......\n.##...\n#..###\n.##...\n");
        assert_eq!(lasso.edges.len(), 2);
        let node = lasso.nodes.iter().find(|node| node.ends.len() == 3).unwrap();
        let twice = |edge: usize| node.ends.iter().filter(|end| end.edge == edge).count() == 2;
        assert!(node.ends.iter().any(|end| twice(end.edge)));
    }

    #[test]
    fn dots_and_neighbouring_nodes_are_kept() {
        assert_eq!(graph("#..#\n").nodes.len(), 2);
        let pair = graph("##\n");
        assert_eq!((pair.nodes.len(), pair.edges.len(), pair.edges[0].pixels.len()), (2, 1, 2));
    }
}
