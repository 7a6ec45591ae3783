//! Where the pen went: strokes drawn again, held against the ink, and moved to where they contradict it
//! least.
//!
//! ```text
//!      ink            pens            residual
//!    . # # # .      . # # . .      . . . + .      + ink that no pen has left,  at most FARTHEST_PX² each
//!    . # # # .  vs  . # # # .  =   . . . . .      - paper that a pen covers, by how deep
//!    . . # # .      . . # # #      . . . . -
//! ```
//!
//! - [`pens`]: what a pen covers that goes from place to place. Nothing else draws pens.
//! - [`canvas`]: the ink, and what pens leave of it unexplained, px²: the *residual*. Nothing else compares them.
//! - [`prices`]: what a vertex or a stroke more has to explain, in the same unit.
//! - [`search`]: places moved by shorter and shorter steps, in an order that depends on nothing but them.
//!
//! Junctions and small marks bring proposals: which arms go on in each other, which ends meet, what may be
//! left out. None of them decides; a proposal is taken where the residual and its prices are less than
//! before.

mod canvas;
mod pens;
pub(crate) mod prices;
pub(crate) mod search;

pub(crate) use canvas::{Canvas, Layer};
pub(crate) use pens::Capsule;
