//! What the ink has to say for itself before a drawing of it changes: one table, in px² of contradicted ink.
//!
//! A pixel contradicts a drawing by the square of how far it lies beyond a pen's edge. So n pixels' length of
//! an edge that is off by d px are n·d pixels, each off by d²/3 in the mean: n·d³/3 in all. What this makes
//! of a price stands beside it; that it is this price was measured on the pictures that `judge` draws and on
//! those of `degrade_corpus --strength middle`.

/// A pixel costs no more than the square of this, px: farther off lies ink of another line, which no move
/// here explains. Of paper that was drawn on without a bound, the figures are the same to two digits.
pub(crate) const FARTHEST_PX: f32 = 2.0;

/// What the raster alone may leave: both edges of 6 px of a line that is off by half a pixel.
pub(crate) const RASTER_PX2: f64 = 0.5;

/// Less is no gain: 4 px of an edge that is off by a quarter of a pixel.
pub(crate) const GAIN_PX2: f64 = 0.02;

/// A vertex: 7 px of an edge that is off by half a pixel. Of lines that meet in one place each saves one.
pub(crate) const VERTEX_PX2: f64 = 0.3;

/// A stroke beside its vertices: 3 px of an edge that is off by more than a pixel, what sticks out of a
/// line's side. For 1 px² there are 1 % more strokes on felt pens and newsprint, and none of them a line of
/// its own.
pub(crate) const STROKE_PX2: f64 = 1.5;

/// Another plan of lines that meet, and each step of their places, leaves no more than this share, or
/// [`RASTER_PX2`] less. With a gain of [`GAIN_PX2`] alone they follow the raster's noise: 12 of 17 junctions
/// of small marks were within 1 px for 14, .37 of a felt pen's for .43, and there were 2 % more vertices.
const KEPT: f64 = 0.8;

/// Of a thinner line the edges are too near each other to tell where between them its middle is, px: half a
/// pixel for each, and as much between them.
pub(crate) const WIDE_PX: f64 = 2.0;

/// What a place is moved for where lines meet, of what it costs so far.
pub(crate) fn step(cost: f64) -> f64 {
    KEPT * cost
}

/// What another plan of lines that meet is taken for.
pub(crate) fn other_plan(cost: f64) -> f64 {
    step(cost).max(cost - RASTER_PX2)
}

/// The same for lines that bend where they meet although their course outside does not: what a camera's blur
/// or a pen's ink fills in the corners of a crossing looks like that, too. So these explain half of what is
/// left.
pub(crate) fn bent_plan(cost: f64) -> f64 {
    (0.5 * cost).min(cost - RASTER_PX2)
}
