//! How long a drawing takes on a plotter with stepper motors, and what its motors do on the way.
//!
//! A file in HPGL, G-code, SVG or the thesis' text is planned with look-ahead and turned into timed steps, as the controller
//! does it; then the steps alone are walked through. From them come the picture that the pen draws, its speed over time, and the
//! greatest speed, acceleration and distance from the drawing.
//!
//! Look at the speed chart: in the mode `exact` the pen brakes for every corner, with `tolerance` it rounds them within a
//! distance that you name, and curves of many short lines run through. Compare the times.
//!
//! ```text
//! cargo run --release --example stepper -- --svg plot.svg --speed-plot speed.svg
//! cargo run --release --example stepper -- drawing.plt --mode tolerance --tolerance-mm 0.05
//! cargo run --release --example stepper -- drawing.gcode --max-speed 100 --accel 1000 --ignore-feed --report plot.json
//! ```

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::{
    Diagnostic, Diagnostics, DrawingFile, Happening, Language, Reading, Severity, SpeedChart, SteppedFigures,
    SteppedPlot, SteppedPreview, at, print, read_file, run, write_file,
};
use plotter_motion::kinematics::MotorScale;
use plotter_motion::{
    AreaConfig, DriveChoice, Machine, MachineConfig, PathMode, Pen, PlannerSettings, PlotOp, Point,
    StepGenSettings,
};
use serde::Serialize;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Greatest side of a machine's area, mm: beyond it nothing is planned.
const FARTHEST_MM: f64 = 100_000.0;

/// A point may lie this far outside of the area, mm: what rounding makes of its border.
const BORDER_MM: f64 = 0.02;

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
                  cat drawing.svg | stepper - --s-curve --jerk 20000 --steps steps.txt\n\n\
                  Exit status: 0 plotted; 1 nothing that can be plotted, or with --strict any error or point outside of the \
                  area; 2 wrong options."
)]
struct Arguments {
    /// Drawing in HPGL, G-code, SVG or the thesis' text; - is the standard input [default: a spiral, hatching and letters]
    file: Option<PathBuf>,
    /// What the file is written in [default: told by its contents]
    #[arg(long, value_enum)]
    language: Option<Language>,
    /// The machine's TOML file [default: machines/stepper-plotter.toml]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// How corners are passed [default: the machine's]
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    /// How far the pen may be from the drawing, mm; chooses --mode tolerance [default: the machine's]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    tolerance_mm: Option<f64>,
    /// Limits the jerk too
    #[arg(long)]
    s_curve: bool,
    /// Greatest speed with the pen down and up, mm/s [default: the machine's, 45 and 90]
    #[arg(long, value_name = "V", value_parser = positive, allow_negative_numbers = true)]
    max_speed: Option<f64>,
    /// Greatest acceleration, mm/s² [default: the machine's, 250]
    #[arg(long, value_name = "A", value_parser = positive, allow_negative_numbers = true)]
    accel: Option<f64>,
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
        Some(path) => DrawingFile::open(path, arguments.language)?,
        None => DrawingFile::held("the built-in drawing", built_in().into_bytes(), None)?,
    };
    let mut said = Diagnostics::default();
    let (machine, settings) = machine(arguments, &mut said)?;
    let config = machine.config();
    let motor = |stepper: &plotter_motion::StepperConfig| MotorScale {
        steps_per_mm: arguments.steps_per_mm.unwrap_or(stepper.steps_per_mm),
        // Which way a motor turns does not matter to the picture.
        inverted: false,
    };
    let motors = [motor(&config.x.stepper), motor(&config.y.stepper)];
    let finest = motors[0].steps_per_mm.max(motors[1].steps_per_mm);
    let settings = PlannerSettings { resolution_mm: 0.5 / finest, ..settings };
    let plot = SteppedPlot::new(settings, StepGenSettings::of(&machine), motors)?;

    let mut writers = Writers {
        preview: arguments.svg.is_some().then(|| SteppedPreview::new(Point::ORIGIN, 1.0 / finest)),
        chart: arguments.speed_plot.is_some().then(SpeedChart::default),
        steps: arguments.steps.as_deref().map(StepFile::create).transpose()?,
        pen: Pen::Up,
    };
    let mut read = Read::new(config.area);
    let (figures, colours) = walk(arguments, &drawing, plot, &mut read, &mut said, &mut writers)?;
    if read.drawn == 0 {
        let why = said.first_error().map_or_else(String::new, |first| format!("; {first}"));
        return Err(format!(
            "{}: nothing is drawn by it, read as {}{why}",
            drawing.name(),
            drawing.language().name()
        ));
    }
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
    let report = Report::new(&drawing, &machine, &settings, motors, &figures, &read, &said);
    if let Some(path) = &arguments.report {
        let text = serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?;
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
            if machine.config().drive != DriveChoice::Stepper {
                let text = "this machine has no stepper motors: take one with drive = \"stepper\", as \
                            machines/stepper-plotter.toml";
                return Err(at(path, &text));
            }
            machine
        }
        None => Machine::new(MachineConfig::stepper_plotter()).map_err(|error| error.to_string())?,
    };
    let config = machine.config();
    let mut settings = PlannerSettings::of(&machine);
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

/// Reads, plans and steps the drawing, all at once; gives the figures and the colours of its pens.
fn walk(
    arguments: &Arguments,
    drawing: &DrawingFile,
    mut plot: SteppedPlot,
    read: &mut Read,
    said: &mut Diagnostics,
    writers: &mut Writers,
) -> Result<(SteppedFigures, Vec<[u8; 3]>), String> {
    let mut ops = drawing.ops(Reading { counts_per_mm: 40.0, ..Reading::default() })?;
    let colours = std::mem::take(&mut ops.colours);
    let bar = ProgressBar::new(drawing.length_bytes());
    if let Ok(style) = ProgressStyle::with_template("plotting {bar:40} {bytes}/{total_bytes}, {elapsed}") {
        bar.set_style(style);
    }
    // Whether the pen is not where the next line begins, because an operation was left out.
    let mut is_lost = false;
    let name = drawing.name();
    while let Some(item) = ops.next() {
        bar.set_position(ops.bytes());
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
            push(&mut plot, op, ops.line(), writers, said)?;
            continue;
        };
        if leaves_out {
            is_lost = true;
            continue;
        }
        // Nothing is drawn that the drawing does not hold: the way from what is left out is made with the pen up.
        let op = if std::mem::take(&mut is_lost) { PlotOp::Travel { to } } else { op };
        if push(&mut plot, op, ops.line(), writers, said)? {
            read.drawn += u64::from(!matches!(op, PlotOp::Travel { .. }));
        } else {
            is_lost = true;
        }
    }
    bar.finish_and_clear();
    let figures = plot.finish(&mut |happening| writers.take(happening)).map_err(|error| error.to_string())?;
    Ok((figures, colours))
}

fn is_near(place: Point) -> bool {
    place.x.abs() <= FARTHEST_MM && place.y.abs() <= FARTHEST_MM
}

/// Says whether the operation could be planned.
fn push(
    plot: &mut SteppedPlot,
    op: PlotOp,
    line: Option<u32>,
    writers: &mut Writers,
    said: &mut Diagnostics,
) -> Result<bool, String> {
    let outcome = plot.push(op, &mut |happening| writers.take(happening));
    if let Some(failure) = writers.steps.as_mut().and_then(|steps| steps.failure.take()) {
        return Err(failure);
    }
    if let Err(error) = outcome {
        said.push(Diagnostic { line, ..Diagnostic::new(Severity::Error, error.to_string()) });
        return Ok(false);
    }
    Ok(true)
}

/// What has been read, and how it lies in the machine's area.
struct Read {
    area: AreaConfig,
    segments: u64,
    drawn: u64,
    least: Option<Point>,
    most: Option<Point>,
    outside: u64,
    first_outside: Option<(Point, Option<u32>)>,
    line: Option<u32>,
    position: Point,
}

impl Read {
    fn new(area: AreaConfig) -> Self {
        Self {
            area,
            segments: 0,
            drawn: 0,
            least: None,
            most: None,
            outside: 0,
            first_outside: None,
            line: None,
            position: Point::ORIGIN,
        }
    }

    /// Counts an operation; gives it as it is to be planned.
    fn take(&mut self, mut op: PlotOp, line: Option<u32>, ignore_feed: bool) -> PlotOp {
        self.line = line;
        self.segments += u64::from(op.target().is_some());
        if let (true, PlotOp::Draw { feed_mm_s, .. } | PlotOp::DrawArc { feed_mm_s, .. }) =
            (ignore_feed, &mut op)
        {
            *feed_mm_s = None;
        }
        op
    }

    /// Whether an operation leaves the area. What is drawn counts for the size of the drawing.
    fn outside(&mut self, op: PlotOp) -> bool {
        let Some(to) = op.target() else { return false };
        let from = std::mem::replace(&mut self.position, to);
        let mut extremes = vec![to];
        match op {
            PlotOp::Draw { .. } => extremes.push(from),
            PlotOp::DrawArc { .. } => {
                extremes.push(from);
                let arc = [PlotOp::Travel { to: from }, op];
                extremes.extend(plotter_motion::chords(arc, BORDER_MM).filter_map(PlotOp::target));
            }
            _ => {}
        }
        if !matches!(op, PlotOp::Travel { .. }) {
            for place in &extremes {
                let least = self.least.unwrap_or(*place);
                let most = self.most.unwrap_or(*place);
                self.least = Some(Point::new(least.x.min(place.x), least.y.min(place.y)));
                self.most = Some(Point::new(most.x.max(place.x), most.y.max(place.y)));
            }
        }
        let AreaConfig { width_mm, height_mm } = self.area;
        let is_inside = |place: &Point| {
            (-BORDER_MM..=width_mm + BORDER_MM).contains(&place.x)
                && (-BORDER_MM..=height_mm + BORDER_MM).contains(&place.y)
        };
        let Some(place) = extremes.iter().find(|place| !is_inside(place)) else { return false };
        self.outside += 1;
        self.first_outside = self.first_outside.or(Some((*place, self.line)));
        true
    }

    fn complaint(&self) -> Diagnostic {
        let AreaConfig { width_mm, height_mm } = self.area;
        let (Point { x, y }, line) = self.first_outside.unwrap_or_default();
        let text = format!(
            "the point ({x:.3}, {y:.3}) mm lies outside of the machine's area, 0..={width_mm} and 0..={height_mm} mm: move or \
             shrink the drawing"
        );
        Diagnostic { line, ..Diagnostic::new(Severity::Warning, text) }
    }

    fn warn(&self, said: &mut Diagnostics) {
        if self.outside == 0 {
            return;
        }
        let mut complaint = self.complaint();
        if let (Some(least), Some(most)) = (self.least, self.most) {
            let _ = write!(
                complaint.text,
                "; it spans {:.1}..={:.1} and {:.1}..={:.1} mm, {} of its {} movements leave the area",
                least.x, most.x, least.y, most.y, self.outside, self.segments
            );
        }
        said.push(complaint);
    }
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

/// The steps as text.
struct StepFile {
    path: PathBuf,
    out: BufWriter<File>,
    failure: Option<String>,
}

impl StepFile {
    fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).map_err(|error| at(path, &format!("cannot be written: {error}")))?;
        let mut steps = Self { path: path.to_owned(), out: BufWriter::new(file), failure: None };
        steps.line(format_args!("# tick of 1 us, dx, dy, pen\n"));
        Ok(steps)
    }

    fn take(&mut self, happening: Happening, pen: Pen) {
        match happening {
            Happening::Step(tick, dx, dy, _) => {
                self.line(format_args!("{tick} {dx} {dy} {}\n", u8::from(pen == Pen::Down)));
            }
            Happening::SelectPen(pen) => self.line(format_args!("# pen {pen}\n")),
            Happening::NewPage => self.line(format_args!("# new sheet\n")),
            _ => {}
        }
    }

    fn line(&mut self, text: std::fmt::Arguments<'_>) {
        if let Err(error) = self.out.write_fmt(text) {
            self.failure.get_or_insert(at(&self.path, &format!("cannot be written: {error}")));
        }
    }

    fn finish(mut self) -> Result<(), String> {
        if let Err(error) = self.out.flush() {
            self.failure.get_or_insert(at(&self.path, &format!("cannot be written: {error}")));
        }
        self.failure.map_or(Ok(()), Err)
    }
}

#[derive(Serialize)]
struct Report {
    file: String,
    language: Language,
    machine: String,
    mode: &'static str,
    tolerance_mm: Option<f64>,
    s_curve: bool,
    limits: Limits,
    steps_per_mm: [f64; 2],
    time_s: f64,
    time_with_pen_s: f64,
    dwell_s: f64,
    draw_mm: f64,
    travel_mm: f64,
    segments: u64,
    courses: u64,
    steps: u64,
    strokes: u64,
    pen_lifts: u64,
    max_speed_mm_s: f64,
    max_accel_mm_s2: f64,
    max_accel_across_mm_s2: f64,
    accel_window_ms: usize,
    max_deviation_mm: f64,
    max_steps_from_drawing_mm: f64,
    max_drawing_from_steps_mm: f64,
    bounds_mm: Option<[f64; 4]>,
    outside: u64,
    errors: usize,
    warnings: usize,
    notices: usize,
    diagnostics: Vec<Diagnostic>,
}

#[derive(Serialize)]
struct Limits {
    speed_mm_s: f64,
    travel_speed_mm_s: f64,
    accel_mm_s2: f64,
    jerk_mm_s3: Option<f64>,
    junction_deviation_mm: f64,
}

impl Report {
    fn new(
        drawing: &DrawingFile,
        machine: &Machine,
        settings: &PlannerSettings,
        motors: [MotorScale; 2],
        figures: &SteppedFigures,
        read: &Read,
        said: &Diagnostics,
    ) -> Self {
        let tolerance_mm = match settings.path {
            PathMode::Tolerance { path_tolerance_mm } => Some(path_tolerance_mm),
            PathMode::Exact => None,
        };
        let Diagnostics { kept, errors, warnings, notices } = said.clone();
        Self {
            file: drawing.name().to_owned(),
            language: drawing.language(),
            machine: machine.config().name.as_str().to_owned(),
            mode: if tolerance_mm.is_some() { "tolerance" } else { "exact" },
            tolerance_mm,
            s_curve: settings.jerk_mm_s3.is_some(),
            limits: Limits {
                speed_mm_s: settings.speed_mm_s,
                travel_speed_mm_s: settings.travel_speed_mm_s,
                accel_mm_s2: settings.accel_mm_s2,
                jerk_mm_s3: settings.jerk_mm_s3,
                junction_deviation_mm: settings.junction_deviation_mm,
            },
            steps_per_mm: motors.map(|motor| motor.steps_per_mm),
            time_s: figures.motion_s,
            time_with_pen_s: figures.total_s,
            dwell_s: figures.dwell_s,
            draw_mm: figures.draw_mm,
            travel_mm: figures.travel_mm,
            segments: read.segments,
            courses: figures.courses,
            steps: figures.steps,
            strokes: figures.strokes,
            pen_lifts: figures.pen_lifts,
            max_speed_mm_s: figures.max_speed_mm_s,
            max_accel_mm_s2: figures.max_accel_mm_s2,
            max_accel_across_mm_s2: figures.max_accel_across_mm_s2,
            accel_window_ms: figures.accel_window_ms,
            max_deviation_mm: figures.from_drawing_mm.max(figures.from_steps_mm),
            max_steps_from_drawing_mm: figures.from_drawing_mm,
            max_drawing_from_steps_mm: figures.from_steps_mm,
            bounds_mm: read.least.zip(read.most).map(|(least, most)| [least.x, least.y, most.x, most.y]),
            outside: read.outside,
            errors,
            warnings,
            notices,
            diagnostics: kept,
        }
    }

    fn table(&self) -> String {
        let mut out = format!("{} ({}), {}, {}", self.file, self.language.name(), self.machine, self.mode);
        if let Some(tolerance_mm) = self.tolerance_mm {
            let _ = write!(out, " {tolerance_mm} mm");
        }
        out.push_str(if self.s_curve { ", s-curve\n" } else { "\n" });
        let rows = [
            ("time in motion", format!("{:.1}", self.time_s), "s"),
            ("with pen and pauses", format!("{:.1}", self.time_with_pen_s), "s"),
            ("pen down", format!("{:.1}", self.draw_mm), "mm"),
            ("pen up", format!("{:.1}", self.travel_mm), "mm"),
            ("strokes", self.strokes.to_string(), ""),
            ("lines and arcs", self.segments.to_string(), "read"),
            ("", self.courses.to_string(), "planned"),
            ("steps", self.steps.to_string(), ""),
            ("greatest speed", format!("{:.1}", self.max_speed_mm_s), "mm/s"),
            ("acceleration along", format!("{:.0}", self.max_accel_mm_s2), "mm/s²"),
            ("across, in curves", format!("{:.0}", self.max_accel_across_mm_s2), "mm/s²"),
            ("from the drawing", format!("{:.4}", self.max_deviation_mm), "mm"),
        ];
        for (name, value, unit) in rows {
            out.push_str(format!("  {name:20} {value:>12} {unit}").trim_end());
            out.push('\n');
        }
        out
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
