//! Strokes: polylines, arcs and cubic curves, drawings made of them, and how few vertices say the same.

pub(crate) mod clip_to_picture;
mod cubic;
pub(crate) mod curve;
mod drawing;
pub(crate) mod join_gaps;
pub(crate) mod on_sheet;
mod pre_elimination;
pub(crate) mod simplify;
pub(crate) mod stroke_op;
pub(crate) mod turn;

pub(crate) use crate::picture::{PxPoint, PxVec};
pub use cubic::Cubic;
pub use curve::{Arc, Curve};
pub use drawing::{Drawing, Scale, ScaleError};
pub use pre_elimination::PreElimination;
pub use simplify::{Bounded, DynamicThreshold, MAX_REACH_PX, Pieces, Simplify};
