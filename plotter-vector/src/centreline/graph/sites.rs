//! [`Sites`]: the sites of a graph's edges, measured when they are first asked for.
//!
//! A band looks at the edges that matter to its own rows; of most of its context's nobody asks.

use super::Graph;
use super::site::{Scan, Site};
use crate::parallel::each;
use std::sync::OnceLock;

/// Edges that are measured in one go.
const EDGES_TOGETHER: usize = 64;

/// The sites of all edges of a graph.
pub(super) struct Sites<'a> {
    graph: &'a Graph,
    scan: Scan<'a>,
    measured: Vec<OnceLock<Vec<Site>>>,
}

impl<'a> Sites<'a> {
    /// None measured yet.
    pub(super) fn new(graph: &'a Graph, scan: Scan<'a>) -> Self {
        Self { graph, scan, measured: vec![OnceLock::new(); graph.edges.len()] }
    }

    /// Measures the sites of some edges, on all cores.
    pub(super) fn measure(&self, edges: &[usize]) {
        each(edges.chunks(EDGES_TOGETHER).collect(), |some: &[usize]| {
            for edge in some {
                self.get(*edge);
            }
        });
    }

    /// The sites of an edge, one for each of its pixels; none when there is no such edge.
    pub(super) fn get(&self, edge: usize) -> Option<&[Site]> {
        let pixels = self.graph.edges.get(edge)?;
        let measure = || self.scan.sites(&pixels.pixels, pixels.nodes.is_none());
        Some(self.measured.get(edge)?.get_or_init(measure))
    }

    /// As [`Sites::get`], to be changed.
    pub(super) fn get_mut(&mut self, edge: usize) -> Option<&mut [Site]> {
        self.get(edge)?;
        self.measured.get_mut(edge)?.get_mut().map(Vec::as_mut_slice)
    }
}
