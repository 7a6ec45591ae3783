//! All integration tests of the crate as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-replay --test all SUBJECT::` runs those of one.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

#[cfg(all(feature = "cli", feature = "live"))]
mod browser;
mod command_line;
mod damaged_logs;
#[cfg(all(feature = "cli", feature = "live"))]
mod devtools;
#[cfg(feature = "live")]
mod driven;
mod golden_presets;
#[cfg(feature = "live")]
mod golden_simulated;
#[cfg(feature = "live")]
mod host_of_ebb;
#[cfg(feature = "live")]
mod hosts_of_hpgl;
#[cfg(feature = "live")]
mod hosts_of_lines;
#[cfg(feature = "live")]
mod hosts_of_marlin;
#[cfg(feature = "live")]
mod hosts_on_bad_lines;
mod house;
mod import;
#[path = "../../../plotter-motion/tests/all/law_cases.rs"]
mod law_cases;
mod line;
mod lines_in_logs;
mod linked_session;
#[cfg(all(feature = "cli", feature = "live"))]
mod live_bad;
#[cfg(all(feature = "cli", feature = "live"))]
mod live_command;
#[cfg(feature = "live")]
mod live_hand;
#[cfg(all(feature = "cli", feature = "live"))]
mod live_lines;
#[cfg(feature = "live")]
mod live_many;
#[cfg(feature = "live")]
mod live_session;
mod log_commands;
mod malformed_logs;
mod pictures;
mod player_times;
mod prop_log;
#[path = "../../../plotter-motion/tests/all/real_files/mod.rs"]
mod real_files;
mod real_logs;
mod record_command;
mod replay_of_the_gantry;
mod replay_of_the_link;
mod sim_drawings_over_lines;
mod sim_link;
#[cfg(all(feature = "cli", feature = "live", unix))]
mod simulate;
#[cfg(all(feature = "cli", feature = "live", unix))]
mod simulated_dialects;
#[cfg(feature = "live")]
mod simulated_ebb;
mod virtual_plotter;
#[cfg(feature = "live")]
mod watched;
