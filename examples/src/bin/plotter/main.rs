//! `plotter`: the tools of the examples as one program.
//!
//! Each subcommand is the code behind the example of the same name, so both give the same bytes.

#[cfg(feature = "live")]
mod live_drawing;
mod papers;
mod recordings;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use papers::{Completions, Man};
use plotter_examples::compare::CompareCommand;
use plotter_examples::convert::ConvertCommand;
use plotter_examples::follow::FollowCommand;
use plotter_examples::long_sheet::LongSheetCommand;
use plotter_examples::max_error::MaxErrorCommand;
use plotter_examples::plot::PlotCommand;
use plotter_examples::shared::ExitStatus;
use plotter_examples::stepper::StepperCommand;
use plotter_examples::trace::TraceCommand;
use plotter_examples::tune::TuneCommand;
use std::process::ExitCode;

/// Pen plotters: pictures to strokes, strokes to motion, and recordings of what a machine did.
#[derive(Debug, Parser)]
#[command(
    name = "plotter",
    version,
    propagate_version = true,
    max_term_width = 100,
    after_help = format!(
        "Examples:\n  plotter trace scan.png --svg scan.svg --hpgl scan.plt\n  plotter stepper scan.plt --svg plot.svg\n\n\
         `plotter COMMAND --help` has more of them.\n\n{}",
        ExitStatus::table()
    )
)]
struct Plotter {
    #[command(subcommand)]
    tool: Tool,
}

/// The tools, in the order in which a drawing passes through them.
#[derive(Debug, Subcommand)]
enum Tool {
    Trace(Box<TraceCommand>),
    Plot(Box<PlotCommand>),
    Convert(Box<ConvertCommand>),
    Stepper(Box<StepperCommand>),
    MaxError(Box<MaxErrorCommand>),
    Follow(Box<FollowCommand>),
    LongSheet(Box<LongSheetCommand>),
    Tune(Box<TuneCommand>),
    Compare(Box<CompareCommand>),
    Completions(Completions),
    Man(Man),
}

impl Tool {
    fn run(self) -> ExitCode {
        match self {
            Self::Trace(tool) => tool.run(),
            Self::Plot(tool) => tool.run(),
            Self::Convert(tool) => tool.run(),
            Self::Stepper(tool) => tool.run(),
            Self::MaxError(tool) => tool.run(),
            Self::Follow(tool) => tool.run(),
            Self::LongSheet(tool) => tool.run(),
            Self::Tune(tool) => tool.run(),
            Self::Compare(tool) => tool.run(),
            Self::Completions(papers) => papers.run(command()),
            Self::Man(papers) => papers.run(command()),
        }
    }
}

/// The whole command line: the tools, and the commands on recordings of a serial line.
fn command() -> clap::Command {
    Plotter::command().subcommands(recordings::subcommands())
}

fn main() -> ExitCode {
    let arguments = std::env::args_os().collect::<Vec<_>>();
    #[cfg(feature = "live")]
    let (arguments, _kept) = match live_drawing::made(arguments) {
        Ok(made) => made,
        Err(status) => return status,
    };
    let matches = command().get_matches_from(arguments);
    if let Some((name, given)) = matches.subcommand()
        && let Some(code) = recordings::run(name, given)
    {
        return code;
    }
    match Plotter::from_arg_matches(&matches) {
        Ok(plotter) => plotter.tool.run(),
        Err(error) => error.exit(),
    }
}
