//! All integration tests of the crate as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-stitch --test all SUBJECT::` runs those of one.

#![cfg(feature = "alloc")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

mod chain_precision;
mod golden_split;
mod joints;
mod judge;
#[cfg(feature = "toml")]
mod machine_section;
mod prop_fold;
mod prop_frame_transform;
mod prop_rigid;
mod prop_split;
mod serde_readings;
mod sim_fold;
mod sim_fold_stop;
mod sim_joints;
mod sim_judge;
mod sim_long_sheet;
mod sim_marks;
mod sim_paper;
