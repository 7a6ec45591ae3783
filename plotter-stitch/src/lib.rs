#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod anchor;
mod chain;
mod fold;
mod frame_transform;
mod readings;
mod residual;
mod split;

pub use anchor::{Anchor, AnchorSettings, JointSigma};
pub use chain::{Chain, Drift};
pub use fold::{EmptySquare, FoldDirection, FoldProbe, FoldTest, FoldVerdict, ProbeScan, Seen};
pub use frame_transform::{FrameTransform, TransformError};
pub use readings::{FrameReadings, Mark, Reading};
pub use residual::Residual;
pub use split::{Frame, FrameLayout, FramePasses, Frames, SplitError};
