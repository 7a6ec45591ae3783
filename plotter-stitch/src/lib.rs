#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod field;

pub mod fold;
pub mod joint;
pub mod marks;
pub mod paper;
pub mod sense;
#[cfg(feature = "alloc")]
#[cfg_attr(docsrs, doc(cfg(feature = "alloc")))]
pub mod sheet;
#[cfg(feature = "alloc")]
#[cfg_attr(docsrs, doc(cfg(feature = "alloc")))]
pub mod split;

pub use field::Field;
pub use fold::{FoldProbe, FoldTest, FoldVerdict};
pub use joint::{
    Anchor, Chain, FitError, FrameReadings, FrameTransform, JointEstimate, Mark, Reading, RigidFit,
};
#[cfg(feature = "alloc")]
pub use marks::{MarkGroup, MarkPlacer, ReferenceLines};
pub use paper::{Paper, PaperSearch};
pub use plotter_motion;
#[cfg(feature = "alloc")]
pub use sense::MarkSearch;
pub use sense::{Crossing, FindLine, Optics, ScanError, Search, Sighting};
#[cfg(feature = "alloc")]
pub use sheet::{JoinError, LongSheet, SheetSettings, StripJoin};
#[cfg(feature = "alloc")]
pub use split::{Frame, FrameLayout, Frames, SplitError};
