//! The commands of `plotter-replay` in this program.

use clap::{ArgMatches, Command};
use plotter_replay::cli;
use std::process::ExitCode;

/// The program that the commands' examples name.
const PROGRAM: &str = "plotter";

/// What plotter-replay calls the comparison of two recordings, and what it is called here, where `compare` is
/// that of controllers.
const COMPARE: (&str, &str) = ("compare", "compare-logs");

/// Where they begin in the list of commands: clap counts each list from 0, and the tools are fewer.
const AFTER_THE_TOOLS: usize = 100;

/// The commands, by the names that they have here.
pub(crate) fn subcommands() -> impl Iterator<Item = Command> {
    cli::subcommands(PROGRAM).into_iter().zip(AFTER_THE_TOOLS..).map(|(command, place)| {
        let command = command.display_order(place);
        let (theirs, here) = COMPARE;
        if command.get_name() != theirs {
            return command;
        }
        let example = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        let example = example.replace(&format!("{PROGRAM} {theirs} "), &format!("{PROGRAM} {here} "));
        command.name(here).after_help(example)
    })
}

/// Runs the command of that name; none is one of the tools'.
pub(crate) fn run(name: &str, given: &ArgMatches) -> Option<ExitCode> {
    let command = subcommands().find(|command| command.get_name() == name)?;
    let (theirs, here) = COMPARE;
    let name = if command.get_name() == here { theirs } else { name };
    Some(cli::run(PROGRAM, name, given))
}
