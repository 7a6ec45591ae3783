//! All integration tests of the package as one program, which is linked once. Each module tests one subject.
//!
//! `cargo test -p plotter-judging --test all SUBJECT::` runs the tests of one module.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests fail by panics and print tables"
)]

#[path = "../../../tests/all/built_example/mod.rs"]
mod built_example;
mod degraded;
mod judge_command;
mod judged_corpus;
mod lost_ink;
mod paper;
mod pens;
