//! [`NearestLineIndex`]: finds the nearest of many lines to a point.

use plotter_vector::PxPoint;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

/// Longest piece that is looked up, px: the box about a long oblique one would hold half of the picture.
const LONGEST_PX: f64 = 16.0;

/// Most pieces of one segment, however long it is.
const MOST_PIECES: f64 = 65_536.0;

/// Polylines with a grid that finds the nearest of them.
#[derive(Debug)]
pub struct NearestLineIndex {
    /// Their segments, each with the number of its polyline; of one vertex, from that to itself.
    segments: Vec<(PxPoint, PxPoint, usize)>,
    tree: RTree<GeomWithData<Line<[f64; 2]>, usize>>,
}

/// A piece of a line, with its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePiece {
    /// Middle of the piece.
    pub middle: PxPoint,
    /// Length of the piece, px.
    pub length_px: f64,
    /// Number of the polyline.
    pub line: usize,
}

impl NearestLineIndex {
    /// An index of polylines; one vertex is a dot, none is nothing.
    pub fn new<'a>(lines: impl IntoIterator<Item = &'a [PxPoint]>) -> Self {
        let mut segments = Vec::new();
        for (line, points) in lines.into_iter().enumerate() {
            if let [dot] = points {
                segments.push((*dot, *dot, line));
            }
            segments.extend(points.windows(2).map(|pair| (pair[0], pair[1], line)));
        }
        let mut pieces = Vec::new();
        for (from, to, line) in &segments {
            let number = number_of_pieces(*from, *to, LONGEST_PX);
            for index in 0..number {
                let [from, to] = [index, index + 1].map(|end| {
                    let at = between(*from, *to, f64::from(end) / f64::from(number));
                    [at.x, at.y]
                });
                pieces.push(GeomWithData::new(Line::new(from, to), *line));
            }
        }
        Self { segments, tree: RTree::bulk_load(pieces) }
    }

    /// Distance to the nearest of the lines, px, and its number; `None` when there are none.
    #[must_use]
    pub fn nearest(&self, at: PxPoint) -> Option<(f64, usize)> {
        let place = [at.x, at.y];
        let found = self.tree.nearest_neighbor(place)?;
        let [x, y] = found.geom().nearest_point(&place);
        Some((at.distance(PxPoint::new(x, y)), found.data))
    }

    /// All lines as equal pieces of each segment, none longer than `longest_px`; a dot is one of no length.
    pub fn pieces(&self, longest_px: f64) -> impl Iterator<Item = LinePiece> + '_ {
        self.segments.iter().flat_map(move |(from, to, line)| {
            let number = number_of_pieces(*from, *to, longest_px);
            let length_px = from.distance(*to) / f64::from(number);
            (0..number).map(move |index| {
                let middle = between(*from, *to, (f64::from(index) + 0.5) / f64::from(number));
                LinePiece { middle, length_px, line: *line }
            })
        })
    }
}

fn between(from: PxPoint, to: PxPoint, share: f64) -> PxPoint {
    PxPoint::new(from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share)
}

fn number_of_pieces(from: PxPoint, to: PxPoint, longest_px: f64) -> u32 {
    let number = libm::ceil(from.distance(to) / longest_px).clamp(1.0, MOST_PIECES);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 1..=65536")]
    let number = number as u32;
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    #[test]
    fn the_nearest_is_found_on_long_lines_and_dots() {
        let (long, dot) = ([at(0.0, 0.0), at(300.0, 400.0)], [at(100.0, 0.0)]);
        let lines = NearestLineIndex::new([&long[..], &dot[..], &[]]);
        // (100, 0) lies 80 px from the line: 0.8 · 100.
        assert_eq!(lines.nearest(at(100.0, 3.0)), Some((3.0, 1)));
        let (far, line) = lines.nearest(at(146.0, 203.0)).unwrap();
        assert!((far - 5.0).abs() < 1e-9 && line == 0, "{far}");
        assert_eq!(NearestLineIndex::new([]).nearest(at(0.0, 0.0)), None);
    }

    #[test]
    fn pieces_are_equal_and_have_the_whole_length() {
        let (line, dot) = ([at(0.0, 0.0), at(3.0, 0.0), at(3.0, 0.7)], [at(9.0, 9.0)]);
        let pieces: Vec<LinePiece> = NearestLineIndex::new([&line[..], &dot[..]]).pieces(0.5).collect();
        assert_eq!(pieces.len(), 6 + 2 + 1);
        assert_eq!(pieces[0], LinePiece { middle: at(0.25, 0.0), length_px: 0.5, line: 0 });
        assert_eq!(pieces[8], LinePiece { middle: at(9.0, 9.0), length_px: 0.0, line: 1 });
        assert!((pieces.iter().map(|piece| piece.length_px).sum::<f64>() - 3.7).abs() < 1e-12);
    }
}
