#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod anchor;
mod chain;
mod crossing;
mod detector;
mod fold;
mod frame_transform;
mod readings;
mod reference_lines;
mod residual;
mod rigid;
mod search;
mod sheet;
mod split;

pub use anchor::{Anchor, AnchorSettings, JointSigma};
pub use chain::{Chain, Drift};
pub use crossing::{Crossing, Found, Passed, found_at};
pub use detector::{BothEdges, FindLine, Optics, PublishedRule, ScanError, Sighting, Tact, disc_over_line};
pub use fold::{EmptySquare, FoldDirection, FoldProbe, FoldTest, FoldVerdict, ProbeScan, Seen};
pub use frame_transform::{FrameTransform, TransformError};
pub use readings::{FrameReadings, Mark, Reading};
pub use reference_lines::{LayoutError, MOST_CROSSINGS, MarkGroup, ReferenceLines};
pub use residual::Residual;
pub use rigid::{FitError, JointEstimate, RigidFit};
pub use search::{Ask, MarkSearch, PublishedSearch, Search, SearchError, SearchSettings};
pub use sheet::{
    Feed, FeedSettings, JoinError, JoinFrames, Joined, JointReport, LongSheet, PaperEdge, PaperMove,
    PublishedJoin, SensedJoint, SensedProbe, SensorNoise, SheetSettings, StripJoin,
};
pub use split::{Frame, FrameLayout, FramePasses, Frames, SplitError};
