//! The middle of lines of any width: a graph over the thinned picture, whose strokes pass through their
//! junctions.

pub(crate) mod centrelines;
pub(crate) mod fit;
pub(crate) mod graph;
