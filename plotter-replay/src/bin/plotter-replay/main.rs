//! Records a plotter's serial line, shows what a log of it holds, draws it, and runs the controller again on it.
//!
//! Exit status: 0 clean, 1 damage or a difference found, 2 unreadable, not writable or a wrong command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    plotter_replay::cli::main()
}
