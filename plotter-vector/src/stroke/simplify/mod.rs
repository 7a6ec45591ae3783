//! [`Simplify`]: fewer vertices for the same line; published ([`DynamicThreshold`]) and ours ([`Bounded`]).

mod arcs;
mod bounded;
mod corners;
mod cubic_fit;
mod cubics;
mod doubling_search;
mod dynamic_threshold;
mod free_ends;
mod min_link_path;
mod polish;
mod polyline;
mod promise;
mod ray_cone;

pub(crate) use bounded::segment_distance_squared;
pub use bounded::{Bounded, MAX_REACH_PX};
pub use dynamic_threshold::DynamicThreshold;

use crate::{
    picture::Pixel,
    stroke::{Curve, PxPoint},
};

/// What strokes are made of. What is more than a straight line is taken where it saves vertices, within the
/// same tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Pieces {
    /// Straight lines.
    #[default]
    Lines,
    /// Straight lines, circular arcs and whole circles.
    Arcs,
    /// Straight lines and cubic curves.
    Cubics,
}

impl Bounded {
    /// A stroke through sites.
    pub(crate) fn stroke(&self, sites: &[PxPoint], closed: bool, pieces: Pieces) -> Curve {
        match pieces {
            Pieces::Lines => self.polyline(sites, closed).into(),
            Pieces::Arcs => self.arcs(sites, closed),
            Pieces::Cubics => self.cubics(sites, closed),
        }
    }
}

/// Chooses the pixels of a figure that become vertices of its polyline.
pub trait Simplify {
    /// Indices of the pixels that stay: rising, with the first and the last pixel; all of them when there are
    /// fewer than three, none for no pixels.
    fn keep(&self, pixels: &[Pixel]) -> Vec<usize>;
}
