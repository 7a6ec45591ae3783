//! All integration tests of the package as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-judging --test all SUBJECT::` runs those of one.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

#[path = "../../../tests/all/built_example/mod.rs"]
mod built_example;
mod degraded;
mod judge_command;
mod judged_corpus;
mod lost_ink;
mod paper;
mod pens;
