//! [`Simplify`]: fewer vertices for the same line; published ([`DynamicThreshold`]) and ours ([`Bounded`]).

mod arcs;
mod bounded;
mod dynamic_threshold;
mod links;
mod polish;
mod polyline;
mod promise;
mod ray_cone;

pub(crate) use bounded::segment_distance_squared;
pub use bounded::{Bounded, MAX_REACH_PX};
pub use dynamic_threshold::DynamicThreshold;

use crate::{Pixel, PxPoint};

/// Chooses the pixels of a figure that become vertices of its polyline.
pub trait Simplify {
    /// Indices of the pixels that stay: rising, with the first and the last pixel; all of them when there are
    /// fewer than three, none for no pixels.
    fn keep(&self, pixels: &[Pixel]) -> Vec<usize>;
}
