//! The joint of two frames: where each mark was seen in both, the rigid motion between them, its trust, and
//! what adds up along a row.

mod anchor;
mod chain;
mod frame_transform;
mod readings;
mod residual;
mod rigid;

pub use anchor::{Anchor, AnchorSettings, JointSigma};
pub use chain::{Chain, Drift};
pub use frame_transform::{FrameTransform, TransformError};
pub use readings::{FrameReadings, Mark, Reading};
pub use residual::Residual;
pub use rigid::{FitError, JointEstimate, RigidFit};
