//! Test pictures with known lines, the ground truth, and a measure of how well a vectorization matches them.
//! Not published; used to develop `plotter-vector`.
//!
//! [`corpus`] has the pictures, [`degraded`] makes photographs and bad scans of them, and [`pens`] has scans
//! of plots with several pens. [`Judgement`] is the measure: distances in pixels, 0 at best, and recall and
//! precision, 1 at best. `docs/results/other-programs.md` has figures of several programs.
//!
//! The examples `draw_corpus` and `judge` run it from the command line:
//!
//! ```text
//! cargo run --release -p plotter-judging --example draw_corpus -- --help
//! cargo run --release -p plotter-judging --example judge -- --help
//! ```
//!
//! The scripts in `peers/` run other vectorizers, such as autotrace and potrace, on the same pictures.

pub mod corpus;
pub mod degraded;
mod judged_corpus;
mod judged_drawing;
mod judgement;
mod nearest_line_index;
pub mod pens;
mod straightened_paper;

pub use judged_corpus::judge_corpus;
pub use judged_drawing::JudgedDrawing;
pub use judgement::{Judgement, JunctionFigures};
pub use nearest_line_index::{LinePiece, NearestLineIndex};
pub use straightened_paper::StraightenedPaper;
