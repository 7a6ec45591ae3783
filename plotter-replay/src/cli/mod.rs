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

mod beginning;
mod check;
mod commands;
mod compare;
mod drawing;
mod export;
#[cfg(feature = "live")]
mod find_machine;
mod import;
mod info;
#[cfg(feature = "live")]
mod led_machine;
#[cfg(feature = "live")]
mod live;
#[cfg(feature = "live")]
mod live_hosted;
#[cfg(feature = "live")]
mod live_targets;
mod machine;
#[cfg(feature = "live")]
mod open_line;
mod output;
mod record;
mod render;
mod replay;
#[cfg(all(feature = "live", unix))]
mod simulate;

use clap::{Arg, ArgAction, ArgMatches, CommandFactory as _, Parser};
use commands::{Command, Verdict};
#[cfg(feature = "live")]
pub use led_machine::{LedError, LedMachine, LedPort, Protocol};
use output::{Output, Shown};
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::OnceLock;

/// Name of this crate's program in its messages and examples.
const OWN_NAME: &str = "plotter-replay";

/// A name for a recording that none before it has, in the working folder: `name.plog`, or the first of
/// `name-2.plog`, `name-3.plog`, ... that is not there. The last one may be needed to go on after a breakdown.
///
/// ```
/// assert_eq!(plotter_replay::cli::free_log("no-such").to_str(), Some("no-such.plog"));
/// ```
#[must_use]
pub fn free_log(name: &str) -> PathBuf {
    let first = PathBuf::from(format!("{name}.plog"));
    let more = (2..10_000_u32).map(|n| PathBuf::from(format!("{name}-{n}.plog")));
    core::iter::once(first.clone()).chain(more).find(|name| !name.exists()).unwrap_or(first)
}

/// Options for the output of a command.
const QUIET: &str = "quiet";
const JSON: &str = "json";

/// Name of the running program, which some messages contain.
static PROGRAM: OnceLock<String> = OnceLock::new();

/// Records a plotter's serial line, summarizes and draws logs, and runs the controller again on them.
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

/// The whole command line.
fn command() -> clap::Command {
    let line = Arguments::command();
    let names: Vec<String> = line.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    names.iter().fold(line, |line, name| line.mut_subcommand(name, telling))
}

/// A command with the options for its output, which all commands have.
fn telling(command: clap::Command) -> clap::Command {
    let flag = |name: &'static str, help: &'static str| {
        Arg::new(name).long(name).help(help).action(ArgAction::SetTrue)
    };
    command
        .arg(flag(
            QUIET,
            "Say nothing but what is wrong; a file on the standard output is written all the same",
        ))
        .arg(
            flag(JSON, "Say it as a JSON object: command, said (a list of lines), exit_status")
                .conflicts_with(QUIET),
        )
}

/// The commands, for a program that has them among its own; their examples have its name, `program`.
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
    command().get_subcommands().map(named).collect()
}

/// Runs the command `subcommand` of [`subcommands`] in the program of that name.
///
/// The exit code is 0 where all is clean, 1 where damage or a difference was found, and 2 where something
/// cannot be read or written, or there is no such command.
#[must_use]
pub fn run(program: &str, subcommand: &str, matches: &ArgMatches) -> ExitCode {
    let _ = PROGRAM.set(program.to_owned());
    let command = match Command::of_subcommand(subcommand, matches) {
        Ok(command) => command,
        Err(error) => return told(&error),
    };
    let is_asked = |flag| matches.try_get_one::<bool>(flag).ok().flatten().is_some_and(|asked| *asked);
    let shown = match (is_asked(QUIET), is_asked(JSON)) {
        _ if command.prints_file() => Shown::Lines,
        (true, _) => Shown::Nothing,
        (_, true) => Shown::Json,
        _ => Shown::Lines,
    };
    let mut out = Output::new(shown, subcommand);
    let done = command.run(&mut out);
    let (status, error) = match &done {
        Ok(Verdict::Clean) => (0, None),
        Ok(Verdict::Found) => (1, None),
        Err(message) => (2, Some(message.as_str())),
    };
    let finished = out.finish(status, error);
    match done.and(finished) {
        Ok(()) => status.into(),
        Err(message) => {
            // Nobody is left to tell when standard error is closed.
            let _ = writeln!(std::io::stderr(), "{program}: {message}");
            ExitCode::from(2)
        }
    }
}

/// The program `plotter-replay`.
#[must_use]
pub fn main() -> ExitCode {
    match command().try_get_matches() {
        Ok(matches) => match matches.subcommand() {
            Some((name, given)) => run(OWN_NAME, name, given),
            None => ExitCode::from(2),
        },
        Err(error) => told(&error),
    }
}

/// Help, the version, or what is wrong with a command line.
fn told(error: &clap::Error) -> ExitCode {
    // Nobody is left to tell when the stream is closed.
    let _ = error.print();
    u8::try_from(error.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// How to install the running program with a feature that it was built without.
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

/// Name of the running program.
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
