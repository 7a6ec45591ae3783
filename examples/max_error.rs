//! One greatest error, from the scan to the ink.
//!
//! You say how far the drawing may be from the scan, in mm. How finely the lines are traced, how far corners are rounded, and how
//! fast the machine may go follow from it: the rest of the example finds the split with which the drawing is done soonest. Then
//! the simulated machine draws, and what it drew is compared with the scan's ink, both ways.
//!
//! Look at `--picture`: the pale band is as wide as the error that you allowed, and the ink stays in it. Ask for less and less:
//! it takes longer and longer, until you are told what is in the way, and what the smallest error is.
//!
//! Near some ink is not enough: each line of the scan, from where it meets others to where it meets others
//! again, is followed from its beginning to its end by something drawn that stands for no other line. Where
//! lines closer together than the error may become one, say so with `--allow-merged-lines`; how many did is
//! told.
//!
//! ```text
//! cargo run --release --example max_error
//! cargo run --release --example max_error -- scan.png --max-error-mm 0.2 --picture drawn.svg
//! cargo run --release --example max_error -- scan.png --max-error-mm 0.05 --machine examples/machines/marking-board.toml
//! ```

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::max_error::{
    FollowedPath, TruePath, follow, predicted_s, rounding_mm, slowed, speed_trial,
};
use plotter_examples::shared::{at, fit_drawing, print, read_file, run, vectorizer, write_file};
use plotter_motion::{
    Machine, MachineConfig, PlotOp, Point,
    budget::{Budget, BudgetError, BudgetLimits, BudgetPart},
    config::{MachineKind, VectorizeConfig},
};
use plotter_replay::{Canvas, CanvasStyle, draw::Layer};
use plotter_vector::{
    Bitmap, Drawing, Gray, PxPoint, Scale, Vectorized, decode,
    ink::Despeckled,
    report::{FollowedLines, InkDistance, followed_lines},
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// How much worse a drawing may be than the test figure, which was drawn with the same motors but other lines.
const SAFETY: f64 = 1.5;

/// Share of the speed at which the machine is tried a second time, and which is the least that is proposed: a quarter of the
/// speed and a sixteenth of the acceleration. Far below that a motor is no more exact, since its encoder is seldom heard of.
const SLOW_SHARE: f64 = 0.25;

/// Tolerances that the vectorization is tried with, px: from the finest, each a fifth more than the one before, so that a
/// greater error has all choices of a smaller one.
const FINEST_PX: f64 = 0.125;
const STEPS: u32 = 48;

/// Tolerance of the strokes that the ink's widths are measured along, px.
const REFERENCE_PX: f64 = 0.5;

/// Draws a scan so that nothing of it is farther off than you say.
#[derive(Parser)]
#[command(
    name = "max_error",
    after_help = "Examples:\n  max_error\n  max_error scan.png --max-error-mm 0.2 --picture drawn.svg\n  \
                  max_error scan.png --max-error-mm 0.05 --machine examples/machines/marking-board.toml --report plot.json\n\n\
                  Exit status: 0 drawn within the error; 1 that error cannot be promised, or something cannot be read or \
                  written; 2 wrong options."
)]
struct Args {
    /// PNG, JPEG, PBM or PGM picture [default: a flag as line art]
    image: Option<PathBuf>,
    /// Greatest distance between the scan's ink and what is drawn, either way, mm
    #[arg(long, value_name = "E", default_value_t = 0.2, allow_negative_numbers = true)]
    max_error_mm: f64,
    /// The machine's TOML file, with DC motors, a belt or stepper motors [default: the semi-virtual gantry]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// Width of the drawing on the sheet, mm; less where the machine is smaller
    #[arg(long, value_name = "MM", default_value_t = 50.0, allow_negative_numbers = true)]
    width_mm: f64,
    /// Ink that is taken for dirt need not be drawn
    #[arg(long)]
    allow_dirt: bool,
    /// Lines closer together than the error may be drawn as one: each is near something drawn, not along a
    /// line of its own
    #[arg(long)]
    allow_merged_lines: bool,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Writes what was drawn, on a band about the scan's lines as wide as the error allows
    #[arg(long, value_name = "F.svg")]
    picture: Option<PathBuf>,
}

fn main() -> ExitCode {
    run("max_error", || draw(&Args::parse()))
}

fn draw(args: &Args) -> Result<(), String> {
    let machine = machine(args)?;
    let scan = Scan::read(args, &machine)?;
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(core::time::Duration::from_millis(100));
    let planned = plan(args, &machine, &scan, &bar);
    bar.set_message("drawing");
    let drawn = planned.and_then(|plan| {
        let path = follow(&plan.machine, &plan.ops, plan.budget.blend_mm)?;
        Ok((plan, path))
    });
    bar.finish_and_clear();
    let (plan, path) = drawn.map_err(|refusal: Refusal| {
        report_refusal(args, &machine, &refusal);
        refusal.to_string()
    })?;
    let report = Report::new(args, &machine, &scan, plan, &path);
    if let Some(file) = &args.report {
        write_file(file, format!("{:#}\n", report.json()))?;
    }
    if let Some(file) = &args.picture {
        write_file(file, picture(&scan, &path, args.max_error_mm))?;
    }
    print(&report.table())?;
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

fn machine(args: &Args) -> Result<Machine, String> {
    let Some(path) = &args.machine else {
        return Machine::new(MachineConfig::default()).map_err(|error| error.to_string());
    };
    let text = String::from_utf8(read_file(path)?)
        .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
    Machine::from_toml(&text).map_err(|error| at(path, &error))
}

/// The scan, and where it lies on the sheet.
struct Scan {
    picture: Gray,
    /// What is to be drawn, and all that there was before its dirt was taken out.
    ink: Bitmap,
    all_ink: Bitmap,
    dirt: Despeckled,
    scale: Scale,
    vectorize: VectorizeConfig,
    /// Strokes along which the ink's widths are measured.
    reference: Drawing,
}

impl Scan {
    fn read(args: &Args, machine: &Machine) -> Result<Self, String> {
        let (bytes, path) = match &args.image {
            Some(path) => (read_file(path)?, path.as_path()),
            None => (include_bytes!("data/flag.png").to_vec(), Path::new("flag.png")),
        };
        let picture = decode(&bytes).map_err(|error| at(path, &error))?;
        let scale = fit_drawing((picture.width(), picture.height()), machine, args.width_mm)?;
        // Straight lines: what is followed is what was measured.
        let vectorize = VectorizeConfig { arcs: false, curves: false, ..machine.config().vectorize };
        let settings = vectorizer(&vectorize, scale.mm_per_px())?;
        let (ink, (all_ink, _)) = (settings.ink(&picture), settings.threshold.apply(&picture));
        let (reference, dirt) = (Drawing::default(), Despeckled::default());
        let mut scan = Self { picture, ink, all_ink, dirt, scale, vectorize, reference };
        let Vectorized { drawing, removed, .. } =
            scan.traced(REFERENCE_PX).map_err(|error| at(path, &error))?;
        (scan.reference, scan.dirt) = (drawing, removed);
        if scan.ink.count() == 0 {
            return Err(at(path, &"there is no ink on it"));
        }
        Ok(scan)
    }

    fn traced(&self, max_error_px: f64) -> Result<Vectorized, String> {
        let config = VectorizeConfig { max_error_px, ..self.vectorize };
        let vectorizer = vectorizer(&config, self.scale.mm_per_px())?;
        vectorizer.vectorize(&self.picture).map_err(|error| error.to_string())
    }

    /// No line of the drawing is longer, mm.
    fn diagonal_mm(&self) -> f64 {
        f64::from(self.ink.width()).hypot(f64::from(self.ink.height())) * self.scale.mm_per_px()
    }

    /// How far the ink is from something drawn and it from the ink, mm.
    fn distance_mm(&self, ink: &Bitmap, drawn: &Drawing) -> [f64; 2] {
        let distance = InkDistance::new(ink, &self.reference);
        [distance.of_ink(drawn).max_px, distance.of_drawn(drawn)].map(|px| px * self.scale.mm_per_px())
    }

    /// How each line of the scan is followed, in order, no farther off than this.
    fn followed(&self, drawn: &Drawing, bound_mm: f64) -> FollowedLines {
        followed_lines(&self.reference, drawn, bound_mm / self.scale.mm_per_px() + REFERENCE_PX)
    }

    /// What was drawn on the sheet as a drawing in pixels of the scan.
    fn in_pixels(&self, strokes: &[Vec<Point>]) -> Drawing {
        let corner = self.scale.to_sheet(PxPoint::new(0.0, 0.0));
        let per_px = self.scale.mm_per_px();
        let mut drawing = Drawing::new(self.ink.width(), self.ink.height());
        for stroke in strokes {
            drawing.push(
                stroke.iter().map(|p| PxPoint::new((p.x - corner.x) / per_px, (corner.y - p.y) / per_px)),
            );
        }
        drawing
    }
}

/// A vectorization, and what it costs.
struct Traced {
    tolerance_px: f64,
    drawing: Drawing,
    error_mm: f64,
}

/// All vectorizations that may do, the finest first.
fn candidates(scan: &Scan, max_error_mm: f64) -> Result<Vec<Traced>, String> {
    let mut found: Vec<Traced> = Vec::new();
    for step in 0..STEPS {
        let tolerance_px = FINEST_PX * libm::exp2(0.25 * f64::from(step));
        // The finest ones are always tried, to find out what the smallest error is.
        if tolerance_px > REFERENCE_PX && tolerance_px * scan.scale.mm_per_px() > max_error_mm {
            break;
        }
        let drawing = scan.traced(tolerance_px)?.drawing;
        if found.last().is_some_and(|before| before.drawing == drawing) {
            continue;
        }
        // Measured on this very scan, both ways: what was asked of the vectorization is the most that it can be.
        let [ink_mm, drawn_mm] = scan.distance_mm(&scan.ink, &drawing);
        found.push(Traced { tolerance_px, drawing, error_mm: ink_mm.max(drawn_mm) });
    }
    Ok(found)
}

/// What is drawn, and how.
struct Plan {
    budget: Budget,
    traced: Traced,
    machine: Machine,
    ops: Vec<PlotOp>,
    control: Control,
}

/// What control makes of the error, by the test figure.
#[derive(Clone, Copy, Debug)]
struct Control {
    rounding_mm: f64,
    /// Greatest share of the machine's speed at which it finishes the figure.
    most_share: f64,
    /// Measured at that share, and at a quarter of it.
    fast_mm: f64,
    slow_mm: f64,
}

impl Control {
    fn measured(machine: &Machine, length_mm: f64) -> Result<Self, String> {
        /// A machine that does not move at a hundredth of its speed never does.
        const LEAST_SHARE: f64 = 0.01;
        let trial_mm = |speed_share| {
            let slower = Budget { vectorization_mm: 0.0, blend_mm: 0.0, control_mm: 0.0, speed_share };
            speed_trial(&slowed(machine, &slower)?, length_mm, 0.0)
        };
        let mut most_share = 1.0;
        let mut fast_mm = trial_mm(most_share)?;
        while fast_mm.is_infinite() && most_share > LEAST_SHARE {
            most_share *= 0.5;
            fast_mm = trial_mm(most_share)?;
        }
        if fast_mm.is_infinite() {
            return Err(String::from(
                "control: the machine does not finish its test figure at any speed, so no error can be promised",
            ));
        }
        let slow_mm = trial_mm(SLOW_SHARE * most_share)?;
        Ok(Self { rounding_mm: rounding_mm(machine), most_share, fast_mm, slow_mm })
    }

    /// What is promised when the test figure is `trial_mm` off. The places of the pen are kept within a micrometre.
    fn promised_mm(&self, trial_mm: f64) -> f64 {
        self.rounding_mm + SAFETY * (trial_mm + TruePath::TOLERANCE_MM)
    }

    fn limits(&self) -> BudgetLimits {
        // A machine that is less exact when it is slow has nothing to gain from slowness.
        let grows_mm = SAFETY * (self.fast_mm - self.slow_mm).max(0.0);
        let moving_mm = grows_mm / (1.0 - SLOW_SHARE * SLOW_SHARE);
        BudgetLimits {
            standing_mm: (self.promised_mm(self.fast_mm) - moving_mm).max(0.0),
            moving_mm,
            least_speed_share: SLOW_SHARE,
            ..BudgetLimits::default()
        }
    }
}

/// Why there is no plan.
#[derive(Clone, Debug)]
enum Refusal {
    Budget(BudgetError),
    Other(String),
}

impl From<String> for Refusal {
    fn from(text: String) -> Self {
        Self::Other(text)
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Budget(error) => error.fmt(f),
            Self::Other(text) => f.write_str(text),
        }
    }
}

/// The split with which the drawing is done soonest.
fn plan(args: &Args, machine: &Machine, scan: &Scan, bar: &ProgressBar) -> Result<Plan, Refusal> {
    let asked_mm = args.max_error_mm;
    // Whether it is a length at all comes before all work.
    if let Err(error @ BudgetError::NoLength { .. }) = Budget::split(asked_mm, &BudgetLimits::default()) {
        return Err(Refusal::Other(format!("--max-error-mm: {error}")));
    }
    bar.set_message("trying the machine on its test figure");
    let control = Control::measured(machine, scan.diagonal_mm())?;
    let blends = machine.kind() == MachineKind::Steppers;
    bar.set_message("tracing");
    let mut best: Option<(f64, Budget, Traced)> = None;
    let mut refusal: Option<BudgetError> = None;
    // Of those with lines that run together, the one with the fewest.
    let mut broken: Option<FollowedLines> = None;
    for traced in candidates(scan, asked_mm)? {
        let limits = BudgetLimits {
            vectorization_least_mm: traced.error_mm,
            vectorization_most_mm: traced.error_mm,
            blend_most_mm: if blends { asked_mm } else { 0.0 },
            ..control.limits()
        };
        match Budget::split(asked_mm, &limits) {
            Ok(budget) => {
                let ops: Vec<PlotOp> = traced.drawing.plot_ops(scan.scale).collect();
                let budget = Budget { speed_share: control.most_share * budget.speed_share, ..budget };
                let time_s = predicted_s(&slowed(machine, &budget)?, &ops, budget.blend_mm)?;
                if best.as_ref().is_some_and(|(least_s, ..)| time_s >= *least_s) {
                    continue;
                }
                let followed = scan.followed(&traced.drawing, traced.error_mm);
                if args.allow_merged_lines || followed.broken() == 0 {
                    best = Some((time_s, budget, traced));
                } else if broken.as_ref().is_none_or(|least| followed.broken() < least.broken()) {
                    broken = Some(followed);
                }
            }
            Err(error) => refusal = Some(least(refusal, error)),
        }
    }
    let Some((_, budget, traced)) = best else {
        if let Some(broken) = broken {
            return Err(Refusal::Other(broken_lines(&broken)));
        }
        return Err(refusal.map_or_else(|| Refusal::Other("nothing to draw".into()), Refusal::Budget));
    };
    bar.set_message("trying the machine as it is to draw");
    let (budget, machine) = confirmed(machine, scan, budget, &control)?;
    let ops = traced.drawing.plot_ops(scan.scale).collect();
    Ok(Plan { budget, machine, traced, ops, control })
}

/// The budget with a speed at which the test figure keeps it: what was measured at two speeds says nothing sure of those between,
/// nor of rounded corners.
fn confirmed(
    machine: &Machine,
    scan: &Scan,
    mut budget: Budget,
    control: &Control,
) -> Result<(Budget, Machine), String> {
    const SLOWER: f64 = 0.85;
    const ROUNDING_MM: f64 = 1e-9;
    let allowed_mm = budget.control_mm + budget.blend_mm;
    loop {
        let slower = slowed(machine, &budget)?;
        if budget.speed_share >= control.most_share && budget.blend_mm == 0.0 {
            return Ok((budget, slower)); // as it was tried
        }
        let trial_mm = speed_trial(&slower, scan.diagonal_mm(), budget.blend_mm)?;
        // Rounded corners are planned, not found out: no safety is needed for them.
        let found_mm = control.promised_mm((trial_mm - budget.blend_mm).max(0.0)) + budget.blend_mm;
        if found_mm <= allowed_mm + ROUNDING_MM {
            return Ok((budget, slower));
        }
        if budget.speed_share <= SLOW_SHARE * control.most_share {
            return Err(format!(
                "control: the test figure is {trial_mm:.4} mm off at {:.0} % of the speed, more than was allowed",
                100.0 * budget.speed_share
            ));
        }
        budget.speed_share = (SLOWER * budget.speed_share).max(SLOW_SHARE * control.most_share);
    }
}

/// The one that could promise more.
fn least(before: Option<BudgetError>, error: BudgetError) -> BudgetError {
    let smallest = |error: &BudgetError| match error {
        BudgetError::TooSmall { smallest_mm, .. } => *smallest_mm,
        _ => f64::INFINITY,
    };
    before.filter(|before| smallest(before) <= smallest(&error)).unwrap_or(error)
}

/// Which lines of the scan nothing drawn follows, and what can be done, in words.
fn broken_lines(followed: &FollowedLines) -> String {
    let at = followed.dropped.iter().chain(&followed.merged).next();
    let at = at.map_or_else(String::new, |at| format!(", the first at ({:.0}, {:.0}) px", at.x, at.y));
    format!(
        "{} of {} lines of the scan are not drawn as lines of their own ({} merged, {} dropped{at}); ask for another \
         error, or allow it with --allow-merged-lines",
        followed.broken(),
        followed.lines,
        followed.merged.len(),
        followed.dropped.len()
    )
}

/// What was asked, promised and measured.
struct Report<'a> {
    args: &'a Args,
    name: String,
    mm_per_px: f64,
    plan: Plan,
    duration_s: f64,
    /// The ink from what was drawn, and that from the ink, mm.
    measured: [f64; 2],
    /// Line by line.
    followed: FollowedLines,
    dirt: Despeckled,
}

impl<'a> Report<'a> {
    fn new(args: &'a Args, machine: &Machine, scan: &Scan, plan: Plan, path: &FollowedPath) -> Self {
        // Against all ink: what was taken for dirt counts, unless that is allowed.
        let ink = if args.allow_dirt { &scan.ink } else { &scan.all_ink };
        let drawn = scan.in_pixels(&path.drawn);
        let measured = scan.distance_mm(ink, &drawn);
        Self {
            followed: scan.followed(&drawn, args.max_error_mm),
            dirt: scan.dirt,
            args,
            name: machine.config().name.to_string(),
            mm_per_px: scan.scale.mm_per_px(),
            plan,
            duration_s: path.duration.as_secs_f64(),
            measured: measured.map(|mm| mm + TruePath::TOLERANCE_MM),
        }
    }

    fn measured_mm(&self) -> f64 {
        self.measured.into_iter().fold(0.0, f64::max)
    }

    /// What was taken for dirt, if anything.
    fn dirt(&self) -> Option<String> {
        let Despeckled { removed_marks, removed_px, largest_removed_px, .. } = self.dirt;
        let of = if removed_marks == 1 { "mark is" } else { "marks are" };
        (removed_marks > 0).then(|| {
            format!(
                "{removed_marks} {of} left out, {removed_px} px of ink (the largest {largest_removed_px} px)"
            )
        })
    }

    /// The part that takes most of what was promised.
    fn largest_part(&self) -> BudgetPart {
        let Budget { vectorization_mm, blend_mm, control_mm, .. } = self.plan.budget;
        if control_mm >= vectorization_mm.max(blend_mm) {
            BudgetPart::Control
        } else if vectorization_mm >= blend_mm {
            BudgetPart::Vectorization
        } else {
            BudgetPart::Blend
        }
    }

    fn json(&self) -> serde_json::Value {
        let Plan { budget, traced, control, .. } = &self.plan;
        let [ink_mm, drawn_mm] = self.measured;
        json!({
            "machine": self.name,
            "asked_mm": self.args.max_error_mm,
            "promised_mm": budget.promised_mm(),
            "measured_mm": self.measured_mm(),
            "parts": {
                "vectorization_mm": budget.vectorization_mm,
                "blend_mm": budget.blend_mm,
                "control_mm": budget.control_mm,
            },
            "largest_part": self.largest_part().to_string(),
            "dirt": {
                "marks": self.dirt.removed_marks,
                "px": self.dirt.removed_px,
                "largest_px": self.dirt.largest_removed_px,
            },
            "lines": {
                "of_scan": self.followed.lines,
                "followed": self.followed.followed(),
                "merged": self.followed.merged.len(),
                "dropped": self.followed.dropped.len(),
            },
            "drawing_time_s": self.duration_s,
            "speed_share": budget.speed_share,
            "measured": { "ink_from_drawn_mm": ink_mm, "drawn_from_ink_mm": drawn_mm },
            "vectorization": {
                "mm_per_px": self.mm_per_px,
                "tolerance_px": traced.tolerance_px,
                "vertices": traced.drawing.vertices(),
                "strokes": traced.drawing.strokes().len(),
            },
            "control": {
                "rounding_mm": control.rounding_mm,
                "test_figure_mm": control.fast_mm,
                "test_figure_slowly_mm": control.slow_mm,
                "safety": SAFETY,
            },
        })
    }

    fn table(&self) -> String {
        let Plan { budget, traced, .. } = &self.plan;
        let mm = |mm: f64| format!("{mm:.4} mm");
        let rows = [
            ("machine", self.name.clone()),
            ("asked", mm(self.args.max_error_mm)),
            ("promised", mm(budget.promised_mm())),
            ("  vectorization", mm(budget.vectorization_mm)),
            ("  blends", mm(budget.blend_mm)),
            ("  control", mm(budget.control_mm)),
            ("measured", mm(self.measured_mm())),
            ("  ink from what was drawn", mm(self.measured[0])),
            ("  what was drawn from ink", mm(self.measured[1])),
            ("lines followed", format!("{} of {}", self.followed.followed(), self.followed.lines)),
            ("  merged, dropped", format!("{}, {}", self.followed.merged.len(), self.followed.dropped.len())),
            ("vertices", traced.drawing.vertices().to_string()),
            ("share of the speed", format!("{:.0} %", 100.0 * budget.speed_share)),
            ("drawing time", format!("{:.1} s", self.duration_s)),
        ];
        let dirt = self.dirt().map(|dirt| format!("{dirt}\n"));
        rows.map(|(name, value)| format!("{name:28} {value:>22}\n")).concat() + dirt.as_deref().unwrap_or("")
    }
}

/// A refusal as JSON, where one was asked for; what cannot be written is no second error.
fn report_refusal(args: &Args, machine: &Machine, refusal: &Refusal) {
    let Some(file) = &args.report else { return };
    let mut report = json!({
        "machine": machine.config().name.to_string(),
        "asked_mm": args.max_error_mm,
        "refused": refusal.to_string(),
    });
    if let (Refusal::Budget(BudgetError::TooSmall { limiting, smallest_mm, .. }), Some(keys)) =
        (refusal, report.as_object_mut())
    {
        keys.insert("limiting_part".into(), json!(limiting.to_string()));
        keys.insert("smallest_mm".into(), json!(smallest_mm));
    }
    let _ = write_file(file, format!("{report:#}\n"));
}

/// What was drawn, on a band as wide as the error allows about the scan's lines.
fn picture(scan: &Scan, path: &FollowedPath, max_error_mm: f64) -> String {
    let mut canvas = Canvas::new();
    for stroke in scan.reference.strokes() {
        canvas.add(Layer::Desired, stroke.iter().map(|at| scan.scale.to_sheet(*at)));
    }
    for stroke in &path.drawn {
        canvas.add(Layer::Ink, stroke.iter().copied());
    }
    let style = canvas.fitted_style();
    let desired_width_mm = 2.0 * max_error_mm;
    canvas.to_svg(&CanvasStyle {
        desired_width_mm,
        ink_width_mm: (0.25 * desired_width_mm).min(0.1),
        margin_mm: style.margin_mm + max_error_mm,
        tolerance_mm: 0.01 * max_error_mm,
        ..style
    })
}
