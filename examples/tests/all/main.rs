//! All integration tests of the examples as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-examples --test all SUBJECT::` runs those of one.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

mod arrange_command;
mod built_example;
mod compare_controllers_command;
mod convert_command;
mod convert_dxf_command;
mod convert_svg_command;
mod first_programs;
mod follow_command;
mod follow_live;
mod licences;
mod long_sheet_command;
mod long_sheet_drawing;
mod lost_ink;
#[path = "../../../plotter-vector/tests/all/made_font/mod.rs"]
mod made_font;
mod marks_files;
mod max_error_command;
mod odd_drawings;
mod paper_option;
#[path = "../../../plotter-motion/tests/all/papers.rs"]
mod papers;
mod picture_files;
mod plot_command;
mod program_command;
#[path = "../../../plotter-motion/tests/all/real_files/mod.rs"]
mod real_files;
mod rooms;
mod round_trip;
#[path = "../../../plotter-motion/tests/all/sampled.rs"]
mod sampled;
mod stepper_command;
mod told_commands;
mod trace_command;
mod trace_compared;
mod tune_command;
