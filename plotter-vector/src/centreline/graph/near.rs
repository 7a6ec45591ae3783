//! [`Near`]: which rows around a band's own matter to it.
//!
//! A junction looks far along its lines, so a band needs many rows more; but what lies in them need not be taken apart.

use super::Graph;
use super::site::Scan;
use core::ops::Range;

/// Rows that lines and junctions are found in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Near {
    /// Lines that come to these rows are followed, and their junctions taken apart.
    lines: Range<u32>,
}

impl Near {
    /// What matters to the rows `core` of a stretch that has the rows `all`.
    pub(super) fn to(core: &Range<u32>, graph: &Graph, scan: Scan<'_>, all: &Range<u32>) -> Self {
        let radius = widest_radius(graph, scan);
        // What a line covers lies within half its width, and no place of a junction farther from its lines'
        // pixels than twice their width.
        Self { lines: around(&around(core, 2 * radius + 8, all), 4 * radius + 8, all) }
    }

    /// The edges that come to the rows, in their order.
    pub(super) fn edges(&self, graph: &Graph) -> Vec<usize> {
        let comes_near = |edge: usize| {
            graph.edges.get(edge).is_some_and(|edge| {
                let mut at = 0;
                while let Some(pixel) = edge.pixels.get(at) {
                    // From pixel to pixel a line comes nearer by a row at most.
                    let far = self
                        .lines
                        .start
                        .saturating_sub(pixel.y)
                        .max((pixel.y + 1).saturating_sub(self.lines.end));
                    if far == 0 {
                        return true;
                    }
                    at += far as usize;
                }
                false
            })
        };
        (0..graph.edges.len()).filter(|edge| comes_near(*edge)).collect()
    }
}

/// Rows with so many more above and below, within others.
fn around(rows: &Range<u32>, more: u32, all: &Range<u32>) -> Range<u32> {
    rows.start.saturating_sub(more).max(all.start)..rows.end.saturating_add(more).min(all.end)
}

/// Greatest radius of the ink in the middle of an edge, px, rounded up.
fn widest_radius(graph: &Graph, scan: Scan<'_>) -> u32 {
    let middles = graph.edges.iter().filter_map(|edge| edge.pixels.get(edge.pixels.len() / 2));
    let radius_px = middles.map(|at| scan.radius_px((*at).into(), f64::MAX)).fold(1.0, f64::max);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 100 px")]
    let radius = libm::ceil(radius_px) as u32;
    radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centreline::graph::Stretch;
    use crate::picture::{Bitmap, Pixel};

    #[test]
    fn lines_that_come_to_the_rows_are_near() {
        // Down the whole picture, from the top half way and back, at the very bottom, and within a row.
        let mut skeleton = Bitmap::new(120, 200).unwrap();
        (0..200).for_each(|y| skeleton.set(Pixel::new(2, y), true));
        (0..80_u32).for_each(|x| skeleton.set(Pixel::new(10 + x, x.min(79 - x)), true));
        (150..200).for_each(|y| skeleton.set(Pixel::new(100, y), true));
        (105..115).for_each(|x| skeleton.set(Pixel::new(x, 60), true));
        let graph = Graph::of(&Stretch { picture: &skeleton, rows: 0..200 }, &mut Vec::new());
        assert_eq!(graph.edges.len(), 4);
        for (rows, least_x) in [
            (60..61, vec![2, 105]),
            (39..40, vec![2, 10]),
            (40..60, vec![2]),
            (0..200, vec![2, 10, 105, 100]),
            (199..200, vec![2, 100]),
        ] {
            let near = Near { lines: rows.clone() };
            let left = |edge: &usize| graph.edges[*edge].pixels.iter().map(|at| at.x).min().unwrap();
            let mut found: Vec<u32> = near.edges(&graph).iter().map(left).collect();
            let mut expected = least_x;
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected, "{rows:?}");
        }
    }

    #[test]
    fn the_wider_the_lines_the_more_is_near() {
        let near = |half: u32| {
            let mut ink = Bitmap::new(300, 1000).unwrap();
            (0..1000).for_each(|y| (100 - half..=100 + half).for_each(|x| ink.set(Pixel::new(x, y), true)));
            let mut skeleton = Bitmap::new(300, 1000).unwrap();
            (0..1000).for_each(|y| skeleton.set(Pixel::new(100, y), true));
            let graph = Graph::of(&Stretch { picture: &skeleton, rows: 0..1000 }, &mut Vec::new());
            Near::to(
                &(400..500),
                &graph,
                Scan {
                    ink: &ink,
                    first_row: 0,
                    grey: None,
                    hairlines: crate::ink::hairlines::Hairlines::Raster,
                },
                &(0..1000),
            )
        };
        // A radius of 3 px: 14 rows on either side, and 20 more.
        assert_eq!(near(2), Near { lines: 366..534 });
        let wide = near(20);
        assert!(wide.lines.start < 300 && wide.lines.end > 600, "{wide:?}");
    }
}
