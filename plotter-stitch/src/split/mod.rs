//! A drawing of any length divided into frames: [`Frames`] in one pass, [`FramePasses`] with one pass for
//! each frame.

mod error;
mod frames;
mod gather;
mod layout;
mod pieces;
mod span;
mod window;
mod zones;

pub use error::SplitError;
pub use frames::{FramePasses, Frames};
pub use layout::FrameLayout;
pub use pieces::Frame;
