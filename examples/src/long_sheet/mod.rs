//! `long_sheet`: a drawing longer than the table, and recorded joints of one.

mod command;
mod course;
mod frame_change_svg;
mod json_place;
mod report;
mod run;
mod stitch_traces;
mod svg;
mod textile_pattern;
mod told_joints;

pub use command::LongSheetCommand;
pub use frame_change_svg::FrameChange;
pub use json_place::JsonPlace;
pub use report::{JointRow, LongSheetReport};
pub use run::{FrameFigures, JointFigures, LongSheetMachine, LongSheetRun, View};
pub use stitch_traces::{CrossingSet, JointAnswer, JointPose, answer_traces};
pub use svg::long_sheet_svg;
pub use textile_pattern::TextilePattern;
pub use told_joints::told_joints;
