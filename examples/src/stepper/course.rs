//! From the file to its figures.

use super::built_in::built_in;
use super::command::{Limit, Mode, StepperCommand};
use super::walk::{Writers, walk};
use crate::drawings::{Diagnostic, Diagnostics, DrawingFile, Severity};
use crate::machine::{BLOCKS, SteppedPlot};
use crate::shared::{at, read_file, write_file};
use crate::stepper::{DrawnExtent, PlotFigures, SpeedChart, StepFile, SteppedPreview, SteppedReport};
use plotter_motion::config::SteppersConfig;
use plotter_motion::{
    Machine, MachineConfig, PathMode, Pen, PlannerSettings, Point,
    config::{AccelChoice, JerkChoice, MachineKind},
    kinematics::MotorScale,
    planner::{AccelLimit, JerkLimit},
    stepgen::{Estimator, StepGenSettings},
};
use std::path::Path;

pub(super) fn plot(arguments: &StepperCommand) -> Result<(), String> {
    let drawing = match &arguments.file {
        Some(path) => arguments.drawing.open(path)?,
        None => DrawingFile::held("the built-in drawing", built_in().into_bytes(), None)?,
    };
    let mut said = Diagnostics::default();
    let (machine, settings) = machine(arguments, &mut said)?;
    let config = machine.config();
    let steppers = SteppersConfig::of(&machine);
    let motor = |stepper: &plotter_motion::config::StepperConfig| MotorScale {
        steps_per_mm: arguments.steps_per_mm.unwrap_or(stepper.steps_per_mm),
        // Which way a motor turns does not matter to the picture.
        inverted: false,
    };
    let motors = [motor(&steppers.x), motor(&steppers.y)];
    let finest = motors[0].steps_per_mm.max(motors[1].steps_per_mm);
    let ops = drawing.ops(arguments.drawing.reading())?;
    let settings = PlannerSettings { resolution_mm: 0.5 / finest, allowance_mm: 1.0 / finest, ..settings };
    let settings = match (arguments.allowance_mm, ops.digit_mm) {
        (Some(allowance_mm), _) => PlannerSettings { allowance_mm, ..settings },
        (None, Some(digit_mm)) => settings.for_digits_of(digit_mm),
        (None, None) => settings,
    };
    let timing = StepGenSettings::of(&machine);
    let mut extent = DrawnExtent::new(config.area);
    if arguments.estimate {
        let mut estimator = Estimator::<BLOCKS>::new(settings, timing).map_err(|error| error.to_string())?;
        walk(arguments, &drawing, ops, &mut extent, &mut said, |op| Ok(estimator.push(op)))?;
        let time = estimator.finish().map_err(|error| error.to_string())?;
        check_drawn(&drawing, &extent, &said)?;
        extent.warn(&mut said);
        let figures = PlotFigures::Estimated(&time);
        let report = SteppedReport::new(&drawing, &machine, &settings, motors, figures, &extent, &said);
        return tell(arguments, &drawing, &report, &said);
    }
    let mut plot = SteppedPlot::new(settings, timing, motors)?;
    let mut writers = Writers {
        preview: arguments.svg.is_some().then(|| SteppedPreview::new(Point::ORIGIN, 1.0 / finest)),
        chart: arguments.speed_plot.is_some().then(SpeedChart::default),
        steps: arguments.steps.as_deref().map(StepFile::create).transpose()?,
        pen: Pen::Up,
    };
    let colours = walk(arguments, &drawing, ops, &mut extent, &mut said, |op| {
        let outcome = plot.push(op, &mut |event| writers.take(event));
        let failure = writers.steps.as_mut().and_then(|steps| steps.failure.take());
        failure.map_or(Ok(outcome), Err)
    })?;
    let figures = plot.finish(&mut |event| writers.take(event)).map_err(|error| error.to_string())?;
    check_drawn(&drawing, &extent, &said)?;
    extent.warn(&mut said);

    let title = format!("{}: {:.1} s", drawing.name(), figures.motion_s);
    if let (Some(path), Some(preview)) = (&arguments.svg, writers.preview) {
        write_file(path, preview.to_svg(&title, config.area, &colours))?;
    }
    if let (Some(path), Some(chart)) = (&arguments.speed_plot, writers.chart) {
        let file =
            Path::new(drawing.name()).file_name().map_or(drawing.name().into(), |f| f.to_string_lossy());
        let title = format!("{file}: {:.1} s in motion, {:.1} s in all", figures.motion_s, figures.total_s);
        write_file(path, chart.to_svg(&title, &settings))?;
    }
    if let Some(steps) = writers.steps {
        steps.finish()?;
    }
    let figures = PlotFigures::Stepped(&figures);
    let report = SteppedReport::new(&drawing, &machine, &settings, motors, figures, &extent, &said);
    tell(arguments, &drawing, &report, &said)
}

/// Refuses a drawing of which nothing was drawn.
fn check_drawn(drawing: &DrawingFile, extent: &DrawnExtent, said: &Diagnostics) -> Result<(), String> {
    if extent.drawn > 0 {
        return Ok(());
    }
    Err(drawing.nothing_drawn(said))
}

fn tell(
    arguments: &StepperCommand,
    drawing: &DrawingFile,
    report: &SteppedReport,
    said: &Diagnostics,
) -> Result<(), String> {
    if let Some(path) = &arguments.report {
        let text = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
        write_file(path, text + "\n")?;
    }
    arguments
        .telling
        .tell(&report.table(), || serde_json::to_string_pretty(report).map_err(|error| error.to_string()))?;
    said.complain(drawing.name());
    Ok(())
}

/// The machine, and how its motion is planned: as its file says where no option does.
pub(super) fn machine(
    arguments: &StepperCommand,
    said: &mut Diagnostics,
) -> Result<(Machine, PlannerSettings), String> {
    let machine = match &arguments.machine {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            let machine = Machine::from_toml(&text).map_err(|error| at(path, &error))?;
            machine.require(MachineKind::Steppers, "stepper").map_err(|error| at(path, &error))?;
            machine
        }
        None => Machine::new(MachineConfig::stepper_plotter()).map_err(|error| error.to_string())?,
    };
    let config = machine.config();
    let steppers = SteppersConfig::of(&machine);
    let mut settings = PlannerSettings::of(&machine);
    if let Some([x, y]) = arguments.accel_axes.as_deref() {
        let mut limited = *config;
        if let Some(SteppersConfig { planner, .. }) = limited.steppers_mut() {
            (planner.accel_limit, planner.accel_x_mm_s2, planner.accel_y_mm_s2) = (AccelChoice::Axes, *x, *y);
        }
        settings = PlannerSettings::of(&Machine::new(limited).map_err(|error| error.to_string())?);
    }
    if arguments.accel.is_some() {
        settings.accel_limit = AccelLimit::Vector;
    }
    let tolerance_mm = arguments.tolerance_mm.unwrap_or(steppers.planner.path_tolerance_mm);
    match (arguments.mode, arguments.tolerance_mm) {
        (Some(Mode::Exact), _) => settings.path = PathMode::Exact,
        (Some(Mode::Tolerance), _) | (None, Some(_)) => {
            settings.path = PathMode::Tolerance { path_tolerance_mm: tolerance_mm };
        }
        (None, None) => {}
    }
    // As in a machine's file: it is the vector within a tolerance, if nothing else is said.
    settings.jerk_limit = match (arguments.jerk_limit, settings.path, steppers.planner.jerk_limit) {
        (Some(Limit::Vector), ..) => JerkLimit::Vector,
        (Some(Limit::Path), ..) | (None, PathMode::Exact, _) | (None, _, Some(JerkChoice::Path)) => {
            JerkLimit::Path
        }
        (None, ..) => JerkLimit::Vector,
    };
    if let Some(speed_mm_s) = arguments.max_speed {
        (settings.speed_mm_s, settings.travel_speed_mm_s) = (speed_mm_s, speed_mm_s);
        let stepper = &steppers.x;
        let rate_hz = speed_mm_s * arguments.steps_per_mm.unwrap_or(stepper.steps_per_mm);
        if rate_hz > stepper.max_rate_hz {
            said.push(Diagnostic::new(
                Severity::Notice,
                format!(
                    "{speed_mm_s} mm/s are {rate_hz:.0} steps/s, more than the {} that the machine's motors are described \
                     for; planned all the same",
                    stepper.max_rate_hz
                ),
            ));
        }
    }
    settings.accel_mm_s2 = arguments.accel.unwrap_or(settings.accel_mm_s2);
    settings.junction_deviation_mm = arguments.junction_deviation.unwrap_or(settings.junction_deviation_mm);
    if arguments.s_curve || steppers.planner.s_curve {
        settings.jerk_mm_s3 = Some(arguments.jerk.unwrap_or(steppers.planner.jerk_mm_s3));
    } else if arguments.jerk.is_some() || arguments.jerk_limit.is_some() {
        said.push(Diagnostic::new(
            Severity::Notice,
            "--jerk and --jerk-limit count with --s-curve only".into(),
        ));
    }
    Ok((machine, settings))
}
