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

/// What the segments of a stroke may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum SegmentKinds {
    /// Straight lines.
    #[default]
    Lines,
    /// And circular arcs.
    Arcs,
    /// And cubic curves.
    Curves,
}

impl Bounded {
    /// A stroke through sites.
    pub(crate) fn stroke(&self, sites: &[PxPoint], closed: bool, kinds: SegmentKinds) -> Curve {
        match kinds {
            SegmentKinds::Lines => self.polyline(sites, closed).into(),
            SegmentKinds::Arcs => self.arcs(sites, closed),
            SegmentKinds::Curves => self.cubics(sites, closed),
        }
    }
}

/// Chooses the pixels of a figure that become vertices of its polyline.
pub trait Simplify {
    /// Indices of the pixels that stay: rising, with the first and the last pixel; all of them when there are
    /// fewer than three, none for no pixels.
    fn keep(&self, pixels: &[Pixel]) -> Vec<usize>;
}
