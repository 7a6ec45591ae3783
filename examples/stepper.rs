//! How long a drawing takes on a plotter with stepper motors, and what its motors do on the way.
//!
//! A file in HPGL, G-code, SVG, a cutter's language or the thesis' text is planned with look-ahead and turned into timed steps, as
//! the controller does it; then the steps alone are walked through. From them come the picture that the pen draws, its speed over
//! time, and the greatest speed, acceleration and distance from the drawing.
//!
//! Look at the speed chart: in the mode `exact` the pen brakes for every corner, with `tolerance` it rounds them within a
//! distance that you name. Compare the times. Short lines that turn by no more than the last digit of the file, or a motor step, are a
//! curve in either mode: `--allowance-mm 0` shows what they would cost.
//!
//! ```text
//! cargo run --release --example stepper -- --svg plot.svg --speed-plot speed.svg
//! cargo run --release --example stepper -- drawing.plt --mode tolerance --tolerance-mm 0.05
//! cargo run --release --example stepper -- drawing.gcode --max-speed 100 --accel 1000 --ignore-feed --report plot.json
//! cargo run --release --example stepper -- large.plt --estimate
//! ```
//!
//! With `--estimate` the steps are not made: the plan alone tells how long the plot takes, to the microsecond as the steps would,
//! some hundred times as fast.

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::drawings::{
    Arrangement, Diagnostic, Diagnostics, DrawingFile, Language, Ops, PenLines, Reading, Severity, SvgReading,
};
use plotter_examples::machine::{BLOCKS, Happening, SteppedPlot};
use plotter_examples::shared::{at, print, read_file, run, write_file};
use plotter_examples::stepper::{
    DrawnExtent, PlotFigures, SpeedChart, StepFile, SteppedPreview, SteppedReport,
};
use plotter_motion::kinematics::MotorScale;
use plotter_motion::{
    Machine, MachineConfig, PathMode, Pen, PlannerSettings, PlotOp, Point,
    config::{AccelChoice, MachineKind},
    planner::{AccelLimit, PlanError},
    stepgen::{Estimator, StepGenSettings},
};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Greatest side of a machine's area, mm: beyond it nothing is planned.
const FARTHEST_MM: f64 = 100_000.0;

/// Plots a drawing on a simulated plotter with stepper motors: how long it takes, and how fast the pen goes where.
///
/// The file is planned with look-ahead and turned into timed steps; all figures but the lengths are measured from the steps.
/// The time in motion is that without pen and pauses.
#[derive(Debug, Parser)]
#[command(
    name = "stepper",
    after_help = "Examples:\n  \
                  stepper --svg plot.svg --speed-plot speed.svg\n  \
                  stepper drawing.plt --mode tolerance --tolerance-mm 0.05 --report plot.json\n  \
                  stepper drawing.gcode --max-speed 100 --accel 1000 --ignore-feed\n  \
                  stepper large.plt --estimate\n  \
                  cat drawing.svg | stepper - --s-curve --jerk 20000 --steps steps.txt\n\n\
                  Exit status: 0 plotted; 1 nothing that can be plotted, or with --strict any error or point outside of the \
                  area; 2 wrong options."
)]
struct Arguments {
    /// Drawing in HPGL, G-code, SVG, DXF, CAMM-GL, GP-GL or the thesis' text; - is the standard input [default: a spiral, hatching
    /// and letters]
    file: Option<PathBuf>,
    /// What the file is written in [default: told by its contents]
    #[arg(long, value_enum)]
    language: Option<Language>,
    /// Size of a step in CAMM-GL and GP-GL, or of the unit of a DXF, mm: 25.4 for inches [default: 0.025, 0.1, Silhouette's 0.05; what
    /// the DXF says, else 1]
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    #[command(flatten)]
    svg_reading: SvgReading,
    #[command(flatten)]
    arrangement: Arrangement,
    #[command(flatten)]
    pen_lines: PenLines,
    /// The machine's TOML file [default: machines/stepper-plotter.toml]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// How corners are passed [default: the machine's]
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    /// How far the pen may be from the drawing, mm; chooses --mode tolerance [default: the machine's]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    tolerance_mm: Option<f64>,
    /// How far the pen may miss a vertex in the mode exact, because rounding did, mm [default: half the last digit that the file
    /// writes, or a step, whichever is greater]
    #[arg(long, value_name = "A", value_parser = allowance, allow_negative_numbers = true)]
    allowance_mm: Option<f64>,
    /// Limits the jerk too
    #[arg(long)]
    s_curve: bool,
    /// Greatest speed with the pen down and up, mm/s [default: the machine's, 45 and 90]
    #[arg(long, value_name = "V", value_parser = positive, allow_negative_numbers = true)]
    max_speed: Option<f64>,
    /// Greatest acceleration of the pen, as a vector, mm/s² [default: the machine's, 250]
    #[arg(long, value_name = "A", value_parser = positive, allow_negative_numbers = true)]
    accel: Option<f64>,
    /// Greatest acceleration of each motor instead, mm/s²; of a belt machine mm of the belt
    #[arg(long, value_names = ["X", "Y"], num_args = 2, value_parser = positive, allow_negative_numbers = true, conflicts_with = "accel")]
    accel_axes: Option<Vec<f64>>,
    /// How far from a corner the circle passes whose speed the corner is taken with, mm [default: the machine's, 0.01]
    #[arg(long, value_name = "D", value_parser = not_negative, allow_negative_numbers = true)]
    junction_deviation: Option<f64>,
    /// Greatest jerk, mm/s³; counts with --s-curve [default: the machine's, 10000]
    #[arg(long, value_name = "J", value_parser = positive, allow_negative_numbers = true)]
    jerk: Option<f64>,
    /// Steps to the millimetre of both motors [default: the machine's, 87.58]
    #[arg(long, value_name = "N", value_parser = steps_per_mm, allow_negative_numbers = true)]
    steps_per_mm: Option<f64>,
    /// Plans at the machine's speed whatever speeds (F, VS) the file asks for; otherwise they count where they are lower
    #[arg(long)]
    ignore_feed: bool,
    /// What becomes of what lies outside of the machine's area; there is a warning either way
    #[arg(long, value_enum, default_value = "draw")]
    outside: Outside,
    /// Tells the times and lengths from the plan alone, without making its steps: as they would be, in a hundredth of the time
    #[arg(long, conflicts_with_all = ["svg", "speed_plot", "steps"])]
    estimate: bool,
    /// Writes the picture that the pen draws: true scale in mm, pen-up ways dashed, the machine's area as frame
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes speed and acceleration over time as a chart
    #[arg(long, value_name = "F.svg")]
    speed_plot: Option<PathBuf>,
    /// Writes the steps as text: tick of a microsecond, dx, dy, pen (1 is down) a line
    #[arg(long, value_name = "F")]
    steps: Option<PathBuf>,
    /// Writes all figures and diagnostics as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Stops at the first error, or point outside of the area, with exit status 1; notices pass
    #[arg(long)]
    strict: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Mode {
    /// Through every corner
    Exact,
    /// Corners rounded, and short lines joined, within the tolerance
    Tolerance,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Outside {
    /// It is planned all the same
    Draw,
    /// Lines that begin or end there are left out
    LeaveOut,
}

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if (1e-3..=1e12).contains(&number) { Ok(number) } else { Err("give 0.001 or more".into()) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if number >= 0.0 && number.is_finite() { Ok(number) } else { Err("give 0 or more".into()) }
}

fn allowance(text: &str) -> Result<f64, String> {
    let number = not_negative(text)?;
    if number <= 1000.0 { Ok(number) } else { Err("give 0 to 1000".into()) }
}

fn steps_per_mm(text: &str) -> Result<f64, String> {
    let number = positive(text)?;
    if (0.1..=100_000.0).contains(&number) { Ok(number) } else { Err("give 0.1 to 100000".into()) }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.mode == Some(Mode::Exact) && arguments.tolerance_mm.is_some() {
        eprintln!("stepper: --tolerance-mm does not go with --mode exact: leave one of them out");
        return ExitCode::from(2);
    }
    run("stepper", || plot(&arguments))
}

fn plot(arguments: &Arguments) -> Result<(), String> {
    let drawing = match &arguments.file {
        Some(path) => DrawingFile::open(path, arguments.language)?
            .with_svg(&arguments.svg_reading)?
            .arranged(&arguments.arrangement)
            .with_pen_lines(&arguments.pen_lines)?,
        None => DrawingFile::held("the built-in drawing", built_in().into_bytes(), None)?,
    };
    let mut said = Diagnostics::default();
    let (machine, settings) = machine(arguments, &mut said)?;
    let config = machine.config();
    let motor = |stepper: &plotter_motion::config::StepperConfig| MotorScale {
        steps_per_mm: arguments.steps_per_mm.unwrap_or(stepper.steps_per_mm),
        // Which way a motor turns does not matter to the picture.
        inverted: false,
    };
    let motors = [motor(&config.x.stepper), motor(&config.y.stepper)];
    let finest = motors[0].steps_per_mm.max(motors[1].steps_per_mm);
    let ops =
        drawing.ops(Reading { counts_per_mm: 40.0, step_mm: arguments.step_mm, ..Reading::default() })?;
    let settings = PlannerSettings { resolution_mm: 0.5 / finest, allowance_mm: 1.0 / finest, ..settings };
    let settings = match (arguments.allowance_mm, ops.digit_mm) {
        (Some(allowance_mm), _) => PlannerSettings { allowance_mm, ..settings },
        (None, Some(digit_mm)) => settings.for_digits_of(digit_mm),
        (None, None) => settings,
    };
    let timing = StepGenSettings::of(&machine);
    let mut read = DrawnExtent::new(config.area);
    if arguments.estimate {
        let mut estimator = Estimator::<BLOCKS>::new(settings, timing).map_err(|error| error.to_string())?;
        walk(arguments, &drawing, ops, &mut read, &mut said, |op| Ok(estimator.push(op)))?;
        let time = estimator.finish().map_err(|error| error.to_string())?;
        check_drawn(&drawing, &read, &said)?;
        read.warn(&mut said);
        let figures = PlotFigures::Estimated(&time);
        let report = SteppedReport::new(&drawing, &machine, &settings, motors, figures, &read, &said);
        return tell(arguments, &drawing, &report, &said);
    }
    let mut plot = SteppedPlot::new(settings, timing, motors)?;
    let mut writers = Writers {
        preview: arguments.svg.is_some().then(|| SteppedPreview::new(Point::ORIGIN, 1.0 / finest)),
        chart: arguments.speed_plot.is_some().then(SpeedChart::default),
        steps: arguments.steps.as_deref().map(StepFile::create).transpose()?,
        pen: Pen::Up,
    };
    let colours = walk(arguments, &drawing, ops, &mut read, &mut said, |op| {
        let outcome = plot.push(op, &mut |happening| writers.take(happening));
        let failure = writers.steps.as_mut().and_then(|steps| steps.failure.take());
        failure.map_or(Ok(outcome), Err)
    })?;
    let figures = plot.finish(&mut |happening| writers.take(happening)).map_err(|error| error.to_string())?;
    check_drawn(&drawing, &read, &said)?;
    read.warn(&mut said);

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
    let report = SteppedReport::new(&drawing, &machine, &settings, motors, figures, &read, &said);
    tell(arguments, &drawing, &report, &said)
}

/// That something is drawn.
fn check_drawn(drawing: &DrawingFile, read: &DrawnExtent, said: &Diagnostics) -> Result<(), String> {
    if read.drawn > 0 {
        return Ok(());
    }
    Err(drawing.nothing_drawn(said))
}

fn tell(
    arguments: &Arguments,
    drawing: &DrawingFile,
    report: &SteppedReport,
    said: &Diagnostics,
) -> Result<(), String> {
    if let Some(path) = &arguments.report {
        let text = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
        write_file(path, text + "\n")?;
    }
    print(&report.table())?;
    said.complain(drawing.name());
    Ok(())
}

/// The machine, and how its motion is planned: as its file says where no option does.
fn machine(arguments: &Arguments, said: &mut Diagnostics) -> Result<(Machine, PlannerSettings), String> {
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
    let mut settings = PlannerSettings::of(&machine);
    if let Some([x, y]) = arguments.accel_axes.as_deref() {
        let mut limited = *config;
        let planner = &mut limited.planner;
        (planner.accel_limit, planner.accel_x_mm_s2, planner.accel_y_mm_s2) = (AccelChoice::Axes, *x, *y);
        settings = PlannerSettings::of(&Machine::new(limited).map_err(|error| error.to_string())?);
    }
    if arguments.accel.is_some() {
        settings.accel_limit = AccelLimit::Vector;
    }
    let tolerance_mm = arguments.tolerance_mm.unwrap_or(config.planner.path_tolerance_mm);
    match (arguments.mode, arguments.tolerance_mm) {
        (Some(Mode::Exact), _) => settings.path = PathMode::Exact,
        (Some(Mode::Tolerance), _) | (None, Some(_)) => {
            settings.path = PathMode::Tolerance { path_tolerance_mm: tolerance_mm };
        }
        (None, None) => {}
    }
    if let Some(speed_mm_s) = arguments.max_speed {
        (settings.speed_mm_s, settings.travel_speed_mm_s) = (speed_mm_s, speed_mm_s);
        let stepper = &config.x.stepper;
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
    if arguments.s_curve || config.planner.s_curve {
        settings.jerk_mm_s3 = Some(arguments.jerk.unwrap_or(config.planner.jerk_mm_s3));
    } else if arguments.jerk.is_some() {
        said.push(Diagnostic::new(Severity::Notice, "--jerk counts with --s-curve only".into()));
    }
    Ok((machine, settings))
}

/// Reads the drawing, and hands over its operations one by one to be planned; gives the colours of its pens. `push` says what is wrong
/// with an operation, or why it cannot go on at all.
fn walk(
    arguments: &Arguments,
    drawing: &DrawingFile,
    mut ops: Ops<'_>,
    read: &mut DrawnExtent,
    said: &mut Diagnostics,
    mut push: impl FnMut(PlotOp) -> Result<Result<(), PlanError>, String>,
) -> Result<Vec<[u8; 3]>, String> {
    let colours = std::mem::take(&mut ops.colours);
    let bar = ProgressBar::new(drawing.length_bytes());
    bar.set_prefix(if arguments.estimate { "estimating" } else { "plotting" });
    if let Ok(style) = ProgressStyle::with_template("{prefix} {bar:40} {bytes}/{total_bytes}, {elapsed}") {
        bar.set_style(style);
    }
    // Whether the pen is not where the next line begins, because an operation was left out.
    let mut is_lost = false;
    let mut shown = 0;
    let name = drawing.name();
    while let Some(item) = ops.next() {
        if ops.bytes() != shown {
            shown = ops.bytes();
            bar.set_position(shown);
        }
        let op = match item {
            Ok(op) => op,
            Err(found) => {
                if arguments.strict && found.severity == Severity::Error {
                    return Err(format!("{name}: {found}"));
                }
                said.push(found);
                continue;
            }
        };
        let op = read.take(op, ops.line(), arguments.ignore_feed);
        let outside = read.outside(op);
        if let Some(place) = op.target().filter(|place| !is_near(*place)) {
            let text = format!("({}, {}) mm is farther than any machine reaches: left out", place.x, place.y);
            let found = Diagnostic { line: ops.line(), ..Diagnostic::new(Severity::Error, text) };
            if arguments.strict {
                return Err(format!("{name}: {found}"));
            }
            said.push(found);
            is_lost = true;
            continue;
        }
        if outside && arguments.strict {
            return Err(format!("{name}: {}", read.complaint()));
        }
        let leaves_out = outside && arguments.outside == Outside::LeaveOut;
        let Some(to) = op.target() else {
            plan(op, ops.line(), &mut push, said)?;
            continue;
        };
        if leaves_out {
            is_lost = true;
            continue;
        }
        // Nothing is drawn that the drawing does not hold: the way from what is left out is made with the pen up.
        let op = if std::mem::take(&mut is_lost) { PlotOp::Travel { to } } else { op };
        if plan(op, ops.line(), &mut push, said)? {
            read.drawn += u64::from(!matches!(op, PlotOp::Travel { .. }));
        } else {
            is_lost = true;
        }
    }
    bar.finish_and_clear();
    Ok(colours)
}

fn is_near(place: Point) -> bool {
    place.x.abs() <= FARTHEST_MM && place.y.abs() <= FARTHEST_MM
}

/// Says whether the operation could be planned.
fn plan(
    op: PlotOp,
    line: Option<u32>,
    push: &mut impl FnMut(PlotOp) -> Result<Result<(), PlanError>, String>,
    said: &mut Diagnostics,
) -> Result<bool, String> {
    if let Err(error) = push(op)? {
        said.push(Diagnostic { line, ..Diagnostic::new(Severity::Error, error.to_string()) });
        return Ok(false);
    }
    Ok(true)
}

/// Who looks at the steps.
struct Writers {
    preview: Option<SteppedPreview>,
    chart: Option<SpeedChart>,
    steps: Option<StepFile>,
    pen: Pen,
}

impl Writers {
    fn take(&mut self, happening: Happening) {
        match (happening, &mut self.preview) {
            (Happening::Pen(pen), preview) => {
                self.pen = pen;
                if let Some(preview) = preview {
                    preview.put(pen);
                }
            }
            (Happening::SelectPen(pen), Some(preview)) => preview.select(pen),
            (Happening::Step(_, _, _, place), Some(preview)) => preview.step(place),
            _ => {}
        }
        if let (Happening::Moment(moment, pen), Some(chart)) = (happening, &mut self.chart) {
            chart.push(moment, pen);
        }
        if let Some(steps) = &mut self.steps {
            steps.take(happening, self.pen);
        }
    }
}

/// A spiral with pen 1, a hatched square and a circle with pen 2, and letters with pen 3, in HPGL.
fn built_in() -> String {
    let mut text = String::from("IN;SP1;");
    for point in 0..=720_u32 {
        // Five turns out to 72.5 mm, in 144 lines each; the centre lies at (95, 95) mm.
        let turn_rad = f64::from(point) * std::f64::consts::TAU / 144.0;
        let radius_units = f64::from(point) * 2900.0 / 720.0;
        let (x, y) =
            (3800.0 + radius_units * libm::cos(turn_rad), 3800.0 + radius_units * libm::sin(turn_rad));
        let _ = write!(text, "{}{:.0},{:.0};", if point == 0 { "PU" } else { "PD" }, x, y);
    }
    text.push_str("PU;SP2;PU7600,960;FT3,200,45;RA12600,5960;EA12600,5960;PU10100,7200;CI800;");
    text.push_str("SP3;PU960,9200;SI1.6,2.4;LBSTEP BY STEP\x03;PU;SP0;");
    text
}
