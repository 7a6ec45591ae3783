//! The command line of the program `plotter-replay`, also for a program that has its commands among its own.
//!
//! ```
//! use clap::Command;
//!
//! let program = Command::new("mine").subcommands(plotter_replay::cli::subcommands("mine"));
//! let matches = program.try_get_matches_from(["mine", "info", "no-such.plog"])?;
//! if let Some((name, matches)) = matches.subcommand() {
//!     let _status = plotter_replay::cli::run("mine", name, matches);
//! }
//! # Ok::<(), clap::Error>(())
//! ```

mod check;
mod commands;
mod compare;
mod drawing;
mod export;
mod import;
mod info;
#[cfg(feature = "live")]
mod live;
mod machine;
mod output;
mod record;
mod render;
mod replay;
#[cfg(all(feature = "live", unix))]
mod simulate;

use clap::{ArgMatches, CommandFactory as _, Parser};
use commands::{Command, Verdict};
use output::Output;
use std::io::Write as _;
use std::process::ExitCode;
use std::sync::OnceLock;

/// What the program of this crate is called, as its words and examples have it.
const OWN_NAME: &str = "plotter-replay";

/// What the running program is called, which some answers name.
static PROGRAM: OnceLock<String> = OnceLock::new();

/// Records a plotter's serial line, shows what a log of it holds, draws it, and runs the controller again on it.
///
/// Exit status: 0 clean, 1 damage or a difference found, 2 unreadable, not writable or a wrong command line.
#[derive(Debug, Parser)]
#[command(
    name = "plotter-replay",
    version,
    propagate_version = true,
    after_help = "Example: plotter-replay render session.plog.gz -o pictures"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The commands, for the program of that name to take among its own; their examples name it.
#[must_use]
pub fn subcommands(program: &str) -> Vec<clap::Command> {
    let named = |command: &clap::Command| {
        let example = command.get_after_help().map(|text| text.to_string().replace(OWN_NAME, program));
        let command = command.clone();
        match example {
            Some(text) => command.after_help(text),
            None => command,
        }
    };
    Arguments::command().get_subcommands().map(named).collect()
}

/// Runs the command `subcommand` of [`subcommands`] in the program of that name.
///
/// The exit code is 0 where all is clean, 1 where damage or a difference was found, and 2 where something cannot be read or
/// written, or there is no such command.
#[must_use]
pub fn run(program: &str, subcommand: &str, matches: &ArgMatches) -> ExitCode {
    match Command::of_subcommand(subcommand, matches) {
        Ok(command) => end(program, command),
        Err(error) => told(&error),
    }
}

/// The program `plotter-replay`.
#[must_use]
pub fn main() -> ExitCode {
    let parsed = Arguments::try_parse();
    match parsed {
        Ok(arguments) => end(OWN_NAME, arguments.command),
        Err(error) => told(&error),
    }
}

/// Help, the version, or what is wrong with a command line.
fn told(error: &clap::Error) -> ExitCode {
    // Nobody is left to tell when the stream is closed.
    let _ = error.print();
    u8::try_from(error.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
}

fn end(program: &str, command: Command) -> ExitCode {
    let _ = PROGRAM.set(program.to_owned());
    let mut out = Output::default();
    let done = command.run(&mut out);
    match done.and_then(|verdict| out.finish().map(|()| verdict)) {
        Ok(Verdict::Clean) => ExitCode::SUCCESS,
        Ok(Verdict::Found) => ExitCode::from(1),
        Err(message) => {
            // Nobody is left to tell when standard error is closed.
            let _ = writeln!(std::io::stderr(), "{program}: {message}");
            ExitCode::from(2)
        }
    }
}

/// How the running program comes by what it was built without.
#[cfg_attr(
    all(feature = "live", feature = "mcap", feature = "serial"),
    expect(dead_code, reason = "this one has all")
)]
fn with_feature(feature: &str) -> String {
    if program() == OWN_NAME {
        format!("cargo install {OWN_NAME} --features cli,{feature}")
    } else {
        format!("build it with --features {feature}")
    }
}

/// What the running program is called.
fn program() -> &'static str {
    PROGRAM.get().map_or(OWN_NAME, String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_run_by_its_name() {
        let commands = subcommands("mine");
        assert!(commands.len() >= 9, "{}", commands.len());
        for command in commands {
            let name = command.get_name().to_owned();
            // Without its arguments: what is missed is told, not that the command is unknown.
            let matches = command.clone().ignore_errors(true).try_get_matches_from([&name]).unwrap();
            let known = Command::of_subcommand(&name, &matches);
            assert!(
                known
                    .map_or_else(|error| error.kind() != clap::error::ErrorKind::InvalidSubcommand, |_| true),
                "{name}"
            );
            let example = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(!example.contains("plotter-replay"), "{name}: {example}");
        }
        let other = clap::Command::new("x").get_matches_from(["x"]);
        assert!(Command::of_subcommand("no-such", &other).is_err());
    }
}
