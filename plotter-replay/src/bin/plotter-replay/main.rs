//! Shows what a log of a plotter's serial line holds, draws it, and runs the controller again on it.
//!
//! Exit status: 0 clean, 1 damage or a difference found, 2 unreadable.

mod commands;

use clap::Parser;
use commands::{Command, Verdict};
use std::io::Write;
use std::process::ExitCode;

/// Shows what a log of a plotter's serial line holds, draws it, and runs the controller again on it.
///
/// Exit status: 0 clean, 1 damage or a difference found, 2 unreadable.
#[derive(Debug, Parser)]
#[command(version, after_help = "Example: plotter-replay render session.plog.gz -o pictures")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    match Arguments::parse().command.run(&mut std::io::stdout().lock()) {
        Ok(Verdict::Clean) => ExitCode::SUCCESS,
        Ok(Verdict::Found) => ExitCode::from(1),
        Err(message) => {
            // Nobody is left to tell when standard error is closed.
            let _ = writeln!(std::io::stderr(), "plotter-replay: {message}");
            ExitCode::from(2)
        }
    }
}
