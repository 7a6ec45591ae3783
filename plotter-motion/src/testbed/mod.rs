//! The control test bed.

mod bed;
mod figures;
mod misjudged;

pub use bed::{Moment, TestBed, TestBedSettings};
pub use figures::Figures;
pub use misjudged::misjudged;
