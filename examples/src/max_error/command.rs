//! The command line of `max_error`, and its course.

use super::figures::{Report, picture, report_refusal};
use super::plan::{Refusal, broken_lines, plan};
use super::scan::Scan;
use crate::max_error::follow;
use crate::shared::{PaperOption, SizeOptions, Telling, WorkShown, at, read_file, run, write_file};
use clap::Parser;
use plotter_motion::{Machine, MachineConfig};
use plotter_vector::trace::VectorizeConfig;
use std::path::PathBuf;
use std::process::ExitCode;

/// Draws a scan within one greatest error that you choose, from the ink of the scan to the ink of the plot.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "max_error",
    after_help = "Examples:\n  plotter max-error\n  plotter max-error scan.png --max-error-mm 0.2 --picture drawn.svg\n  \
                  plotter max-error scan.png --max-error-mm 0.05 --machine examples/machines/marking-board.toml --report plot.json\n\n\
                  Exit status: 0 drawn within the error; 1 that error cannot be promised, or something cannot be read or \
                  written; 2 wrong options.\n\n\
                  In a checkout of the project, `cargo run --release --example max_error --` stands for `plotter max-error`."
)]
pub struct MaxErrorCommand {
    /// PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM picture [default: a flag as line art]
    pub(super) image: Option<PathBuf>,
    /// Greatest distance between the scan's ink and what is drawn, either way, mm
    #[arg(long, value_name = "E", default_value_t = 0.2, allow_negative_numbers = true)]
    pub(super) max_error_mm: f64,
    /// The machine's TOML file, with DC motors, a belt or stepper motors [default: the semi-virtual gantry]
    #[arg(long, value_name = "FILE")]
    pub(super) machine: Option<PathBuf>,
    #[command(flatten)]
    pub(super) size: SizeOptions,
    #[command(flatten)]
    pub(super) paper: PaperOption,
    /// Number of the picture in a TIFF with several, from 1
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) page: u32,
    /// Allows ink that looks like dirt to be left out
    #[arg(long)]
    pub(super) allow_dirt: bool,
    /// Allows lines closer together than the error to be drawn as one: each is near a drawn line, not
    /// along one of its own
    #[arg(long)]
    pub(super) allow_merged_lines: bool,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    pub(super) report: Option<PathBuf>,
    /// Writes the plotted lines on a band around the scan's lines, as wide as the error allows
    #[arg(long, value_name = "F.svg")]
    pub(super) picture: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

impl MaxErrorCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        run("max_error", || draw(&self))
    }
}

pub(super) fn draw(args: &MaxErrorCommand) -> Result<(), String> {
    let (machine, vectorize) = machine(args)?;
    let scan = Scan::read(args, &machine, vectorize)?;
    let bar = WorkShown::said(args.telling);
    let planned = plan(args, &machine, &scan, &bar);
    bar.say("drawing");
    let drawn = planned.and_then(|plan| {
        let path = follow(&plan.machine, &plan.ops, plan.budget.blend_mm)?;
        Ok((plan, path))
    });
    bar.finish();
    let (plan, path) = drawn.map_err(|refusal: Refusal| {
        report_refusal(args, &machine, &scan, &refusal);
        refusal.to_string()
    })?;
    let report = Report::new(args, &machine, &scan, plan, &path);
    if let Some(file) = &args.report {
        write_file(file, format!("{:#}\n", report.json()))?;
    }
    if let Some(file) = &args.picture {
        write_file(file, picture(&scan, &path, args.max_error_mm))?;
    }
    args.telling.tell(&report.table(), || Ok(format!("{:#}\n", report.json())))?;
    if let Some(dirt) = report.dirt()
        && !args.allow_dirt
        && report.measured_mm() > args.max_error_mm
    {
        return Err(format!(
            "{dirt} of the scan, taken for dirt, and the drawing is {:.4} mm off with that ink, where {} mm were promised; \
             clean the scan, or allow it with --allow-dirt",
            report.measured_mm(),
            args.max_error_mm
        ));
    }
    if report.followed.broken() > 0 && !args.allow_merged_lines {
        return Err(broken_lines(&report.followed));
    }
    if report.measured_mm() > args.max_error_mm || !path.is_done {
        return Err(format!(
            "the drawing is {:.4} mm off, more than the {} mm that were promised: the test figure did not show it",
            report.measured_mm(),
            args.max_error_mm
        ));
    }
    Ok(())
}

/// The machine, and how pictures become strokes for it.
pub(super) fn machine(args: &MaxErrorCommand) -> Result<(Machine, VectorizeConfig), String> {
    let Some(path) = &args.machine else {
        let machine = Machine::new(MachineConfig::default()).map_err(|error| error.to_string())?;
        return Ok((machine, VectorizeConfig::default()));
    };
    let text = String::from_utf8(read_file(path)?)
        .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
    Machine::from_toml_with(&text).map_err(|error| at(path, &error))
}
