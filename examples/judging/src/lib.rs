//! For development: pictures of which every line is known ([`corpus`]), and how well a drawing meets them
//! ([`Judgement`]).
//!
//! The examples `draw_corpus` and `judge` are its commands; `peers/` runs other programs on the same
//! pictures.

pub mod corpus;
pub mod degraded;
mod judged_corpus;
mod judged_drawing;
mod judgement;
mod near_lines;
pub mod pens;
mod straightened_paper;

pub use judged_corpus::judged_corpus;
pub use judged_drawing::JudgedDrawing;
pub use judgement::{Judgement, JunctionFigures};
pub use near_lines::{LinePiece, NearLines};
pub use straightened_paper::StraightenedPaper;
