//! One language of plotters into another: HPGL, G-code, SVG and the thesis' text; from CAMM-GL and GP-GL of cutters, and DXF of CAD programs, too.
//!
//! All of them say the same few things: take a pen, go there, draw there, along a line or an arc. What one language says and the
//! other cannot is told on the standard error, with its line and column; the rest is converted. HPGL and G-code stream through:
//! a file of any size needs the same memory.
//!
//! Look at how an arc fares: `AA` in HPGL, `G2` and `G3` in G-code and `A` in SVG are the same arc, and stay one; where there are
//! none, chords take its place within a tolerance.
//!
//! ```text
//! cargo run --release --example convert -- drawing.plt drawing.gcode
//! cargo run --release --example convert -- drawing.svg drawing.plt
//! cargo run --release --example convert -- plan.svg plan.plt --font DejaVuSans.ttf
//! cargo run --release --example convert -- drawing.svg - --to gcode --pen-up "M280 P0 S60" --pen-down "M280 P0 S30"
//! ```

use clap::{Parser, ValueEnum};
use plotter_examples::drawings::{
    Arrangement, Diagnostic, Diagnostics, DrawingFile, Language, PenLines, Reading, Severity, SvgReading,
    SvgText,
};
use plotter_examples::shared::{at, print, run};
use plotter_motion::gcode::{self, LaserCommand, PenControl, PenConvention, ServoCommand};
use plotter_motion::hpgl::{self, thesis_text};
use plotter_motion::{PenMove, PlotOp, Point, StepPoint, toolpath::chords};
use std::cell::RefCell;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;
use std::time::Duration;

/// Greatest coordinate in an SVG: beyond it the single precision of viewers is coarser than a plotter, mm.
const SVG_MOST_MM: f64 = 100_000.0;

/// Converts a drawing between HPGL, G-code, SVG and the thesis' text; reads DXF, CAMM-GL and GP-GL too.
///
/// Lines and arcs, pens, speeds and pauses are converted as far as the target knows them. Arcs stay arcs in HPGL (AA), G-code (G2,
/// G3) and SVG (A). SVG is read in mm by width, height and viewBox, with the lower left corner as the origin: along strokes, and
/// along the border of what is only filled; each colour is a pen, 1, 2, … in the order in which they come, or each layer (--pens). Clip
/// paths and masks cut it, and white is taken for the paper (--paper). Its texts are set in the fonts that --font gives, and never in
/// others, or drawn in letters of one line (--single-stroke): so a file becomes the same strokes everywhere. In SVG written here each pen
/// is a group, and is that pen when it is read again; the sheet of an SVG stays as large as it is. Layers of a DXF are pens, its texts are
/// set in the font of HPGL's labels.
#[derive(Debug, Parser)]
#[command(
    name = "convert",
    after_help = "Examples:\n  \
                  convert drawing.plt drawing.gcode\n  \
                  convert drawing.svg drawing.plt --tolerance-mm 0.02\n  \
                  convert drawing.gcode drawing.svg --convention unicorn\n  \
                  convert drawing.gcode drawing.svg --pen-up PEN_UP --pen-down PEN_DOWN\n  \
                  convert plan.svg plan.plt --font DejaVuSans.ttf --font /usr/share/fonts\n  \
                  convert plan.dxf plan.plt --step-mm 25.4\n  \
                  convert sign.svg sign.gcode --single-stroke\n  \
                  convert layers.svg layers.plt --pens layer --paper none\n  \
                  convert drawing.svg - --to gcode --pen-up \"M280 P0 S60\" --pen-down \"M280 P0 S30\"\n  \
                  cat drawing.plt | convert - drawing.svg\n\n\
                  Suffixes: .hpgl .plt .hpg for hpgl; .gcode .nc .ngc for gcode; .svg; .dxf; .txt for thesis.\n\
                  Exit status: 0 converted; 1 nothing that can be converted, or with --strict any error; 2 wrong options."
)]
struct Arguments {
    /// Drawing to read; - is the standard input
    input: PathBuf,
    /// Drawing to write; - is the standard output
    output: PathBuf,
    /// What the drawing is written in [default: told by its contents]
    #[arg(long, value_enum, value_name = "L")]
    from: Option<Language>,
    /// What is written [default: told by the suffix]
    #[arg(long, value_enum, value_name = "L")]
    to: Option<Language>,
    /// Farthest that chords may be from arcs and curves that the target does not know, mm
    #[arg(long, value_name = "T", default_value = "0.01", value_parser = positive, allow_negative_numbers = true)]
    tolerance_mm: f64,
    /// How G-code that is read lifts its pen [default: told by its contents]
    #[arg(long, value_enum, value_name = "C")]
    convention: Option<Convention>,
    /// How G-code that is written lifts its pen
    #[arg(long, value_enum, default_value = "servo")]
    gcode_pen: GcodePen,
    // The pen of G-code in other words: where G-code is written, instead of --gcode-pen; and where it is read, if it has them
    #[command(flatten)]
    pen_lines: PenLines,
    /// Encoder counts to the millimetre in the thesis' text
    #[arg(long, value_name = "N", default_value = "40", value_parser = positive, allow_negative_numbers = true)]
    counts_per_mm: f64,
    /// Size of a step in CAMM-GL and GP-GL, or of the unit of a DXF, mm: 25.4 for inches [default: 0.025, 0.1, Silhouette's 0.05; what
    /// the DXF says, else 1]
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    #[command(flatten)]
    svg_reading: SvgReading,
    #[command(flatten)]
    arrangement: Arrangement,
    /// Ends at the first error, with exit status 1; notices pass
    #[arg(long)]
    strict: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Convention {
    /// M3 lowers, M5 lifts
    Spindle,
    /// The Z axis, down at 0 and below
    Z,
    /// M300 S30 and S50
    Unicorn,
    /// M1 90 and 160
    Mdraw,
    /// A laser on GRBL: M3 or M4 with S
    Laser,
    /// A laser for a printer's fan: M106, M107
    Fan,
    /// Z in degrees, as older Makeblock firmware has it: up 130, down 90
    ZServo,
    /// G0 travels, G1 draws
    Motion,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum GcodePen {
    /// M3 S90 and M5: GRBL with a pen servo
    Servo,
    /// Z 5 mm and 0
    Z,
    /// M300 S50 and S30: the Unicorn plotter
    Unicorn,
    /// M1 160 and M1 90, without arcs
    Mdraw,
    /// M4 S1000 and M5: a laser on GRBL
    Laser,
}

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if (1e-6..=1e6).contains(&number) { Ok(number) } else { Err("give a number above 0".into()) }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let Some(language) = arguments.to.or_else(|| Language::of_name(&arguments.output)) else {
        eprintln!(
            "convert: {}: no suffix that tells the language: give --to hpgl, gcode, svg or thesis",
            arguments.output.display()
        );
        return ExitCode::from(2);
    };
    if matches!(language, Language::CammGl | Language::GpGl | Language::Dxf) {
        eprintln!("convert: {} is read, not written: give --to hpgl, gcode, svg or thesis", language.name());
        return ExitCode::from(2);
    }
    if is_same(&arguments.input, &arguments.output) {
        eprintln!("convert: {}: the drawing would be written over itself", arguments.output.display());
        return ExitCode::from(2);
    }
    run("convert", || convert(&arguments, language))
}

fn is_same(input: &Path, output: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    real(input).is_some_and(|input| real(output) == Some(input)) && output.is_file()
}

fn convert(arguments: &Arguments, language: Language) -> Result<(), String> {
    let mut drawing = DrawingFile::open(&arguments.input, arguments.from)?
        .with_svg(&arguments.svg_reading)?
        .arranged(&arguments.arrangement);
    let writes_gcode = language == Language::Gcode;
    let reads_gcode = drawing.language() == Language::Gcode;
    if writes_gcode && (arguments.pen_lines.up.len() > 1 || arguments.pen_lines.down.len() > 1) {
        return Err(
            "--pen-up, --pen-down: G-code is written with one line each: give each option once".into()
        );
    }
    let how = Reading {
        tolerance_mm: arguments.tolerance_mm,
        counts_per_mm: arguments.counts_per_mm,
        pen: arguments.convention.map(convention),
        step_mm: arguments.step_mm,
    };
    if reads_gcode || !writes_gcode {
        drawing = drawing.with_pen_lines(&arguments.pen_lines)?;
    }
    // From G-code to G-code, words that the drawing does not have are only those to write.
    let draws =
        |op: Result<PlotOp, Diagnostic>| matches!(op, Ok(PlotOp::Draw { .. } | PlotOp::DrawArc { .. }));
    if reads_gcode && writes_gcode && !drawing.ops(how)?.any(draws) {
        drawing = drawing.with_pen_lines(&PenLines::default())?;
    }
    let mut ops = drawing.ops(how)?;
    let colours = std::mem::take(&mut ops.colours);
    let sheet_mm = ops.sheet_mm;
    let mut said = Diagnostics::default();
    // Nothing is written, and no file replaced, before there is something to draw.
    let mut waiting = Vec::new();
    let mut writer = None;
    let (mut drawn, mut at_op) = (0_u64, At::default());
    let name = drawing.name();
    while let Some(item) = ops.next() {
        let found = match item {
            Ok(op) => {
                drawn += u64::from(matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }));
                if writer.is_none() && drawn == 0 {
                    waiting.push((op, ops.line()));
                    continue;
                }
                if writer.is_none() {
                    let mut opened = Writer::open(arguments, language, sheet_mm)?;
                    for (op, line) in waiting.drain(..) {
                        opened.push(op, line, &mut at_op, &mut said);
                    }
                    writer = Some(opened);
                }
                let errors = said.errors;
                if let Some(writer) = &mut writer {
                    writer.push(op, ops.line(), &mut at_op, &mut said);
                    if !writer.is_wanted()? {
                        return Ok(());
                    }
                }
                if said.errors == errors {
                    continue;
                }
                said.kept.last().cloned()
            }
            Err(found) => {
                said.push(found.clone());
                Some(found)
            }
        };
        if let Some(found) = found.filter(|found| arguments.strict && found.severity == Severity::Error) {
            return Err(format!("{name}: {found}"));
        }
    }
    let Some(writer) = writer else {
        return Err(drawing.nothing_drawn(&said));
    };
    writer.finish(&colours, &mut said)?;
    said.complain(name);
    if arguments.output != Path::new("-") {
        let (from, to) = (drawing.language().name(), language.name());
        print(&format!("{}: {drawn} lines and arcs, {from} to {to}\n", arguments.output.display()))?;
    }
    Ok(())
}

fn convention(choice: Convention) -> PenConvention {
    match choice {
        Convention::Spindle => PenConvention::Spindle,
        Convention::Z => PenConvention::Height { threshold_mm: 0.0 },
        Convention::Unicorn => PenConvention::UNICORN,
        Convention::Mdraw => PenConvention::MDRAW,
        Convention::Laser => PenConvention::GRBL_LASER,
        Convention::Fan => PenConvention::Laser { command: LaserCommand::Fan, full: 255.0 },
        Convention::ZServo => PenConvention::Servo { command: ServoCommand::Z, up: 130.0, down: 90.0 },
        Convention::Motion => PenConvention::Motion,
    }
}

/// Where the drawing's pen is, and whether it can be drawn from there.
#[derive(Default)]
struct At {
    place: Point,
    is_lost: bool,
}

/// What is written.
struct Writer<'a> {
    target: Target<'a>,
    tolerance_mm: f64,
    /// Whether arcs have to be chords.
    has_chords: bool,
    counts_per_mm: f64,
    path: &'a Path,
    /// Why the sink, which the target keeps to itself, has refused text.
    failure: Rc<RefCell<Option<io::Error>>>,
    has_drawn: bool,
    /// The line at which a new sheet was asked for, on which nothing has been drawn yet.
    sheet_owed: Option<Option<u32>>,
    /// What has been said once already.
    said_pens: bool,
    said_pages: bool,
    said_dwells: bool,
    said_power: bool,
    has_laser: bool,
}

enum Target<'a> {
    Hpgl(hpgl::Writer<Sink>),
    Gcode(gcode::Writer<'a, Sink>),
    Thesis(Sink, StepPoint),
    Svg(SvgText, Sink),
}

/// Text goes to a file or the standard output.
struct Sink {
    out: BufWriter<Box<dyn Write>>,
    failure: Rc<RefCell<Option<io::Error>>>,
}

impl fmt::Write for Sink {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.out.write_all(text.as_bytes()).map_err(|error| {
            *self.failure.borrow_mut() = Some(error);
            fmt::Error
        })
    }
}

impl<'a> Writer<'a> {
    fn open(
        arguments: &'a Arguments,
        language: Language,
        sheet_mm: Option<(f64, f64)>,
    ) -> Result<Self, String> {
        let path = arguments.output.as_path();
        let out: Box<dyn Write> = if path == Path::new("-") {
            Box::new(io::stdout())
        } else {
            Box::new(File::create(path).map_err(|error| at(path, &format!("cannot be written: {error}")))?)
        };
        let failure = Rc::default();
        let sink = Sink { out: BufWriter::new(out), failure: Rc::clone(&failure) };
        let mut has_chords = language == Language::Thesis;
        let target = match language {
            Language::Hpgl => Target::Hpgl(hpgl::Writer::new(sink)),
            Language::Thesis => Target::Thesis(sink, StepPoint::default()),
            Language::Svg => Target::Svg(SvgText::new().on_sheet(sheet_mm), sink),
            Language::CammGl | Language::GpGl | Language::Dxf => {
                return Err(format!("{} is not written", language.name()));
            }
            Language::Gcode => {
                let usual = gcode::WriteOptions::default();
                let pen = match (
                    arguments.pen_lines.up.first(),
                    arguments.pen_lines.down.first(),
                    arguments.gcode_pen,
                ) {
                    (Some(up), Some(down), _) => PenControl::Commands { up, down },
                    (.., GcodePen::Servo) => usual.pen,
                    (.., GcodePen::Z) => PenControl::Height { up_mm: 5.0, down_mm: 0.0 },
                    (.., GcodePen::Unicorn) => PenControl::Commands { up: "M300 S50", down: "M300 S30" },
                    (.., GcodePen::Mdraw) => PenControl::Commands { up: "M1 160", down: "M1 90" },
                    (.., GcodePen::Laser) => PenControl::Laser { full: 1000 },
                };
                // mDraw knows neither arcs nor pauses.
                let is_mdraw = arguments.pen_lines.up.is_empty() && arguments.gcode_pen == GcodePen::Mdraw;
                has_chords = is_mdraw;
                let settle = if is_mdraw { Duration::ZERO } else { usual.settle };
                Target::Gcode(gcode::Writer::with_options(sink, gcode::WriteOptions { pen, settle, ..usual }))
            }
        };
        Ok(Self {
            target,
            tolerance_mm: arguments.tolerance_mm,
            has_chords,
            counts_per_mm: arguments.counts_per_mm,
            path,
            failure,
            has_drawn: false,
            sheet_owed: None,
            said_pens: false,
            said_pages: false,
            said_dwells: false,
            said_power: false,
            has_laser: arguments.gcode_pen == GcodePen::Laser && language == Language::Gcode,
        })
    }

    /// Takes the next operation. Plotters that advance their paper do so when they are told; nobody is asked for a sheet before
    /// something is drawn on it, nor before anything has been drawn at all.
    fn push(&mut self, op: PlotOp, line: Option<u32>, at: &mut At, said: &mut Diagnostics) {
        let advances = matches!(self.target, Target::Hpgl(_));
        match op {
            PlotOp::NewPage if !advances => {
                self.sheet_owed = self.has_drawn.then_some(line);
                return;
            }
            PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => {
                self.has_drawn = true;
                if let Some(line) = self.sheet_owed.take() {
                    self.put(PlotOp::NewPage, line, at, said);
                }
            }
            _ => {}
        }
        self.put(op, line, at, said);
    }

    /// Writes an operation, or says why not.
    fn put(&mut self, op: PlotOp, line: Option<u32>, at: &mut At, said: &mut Diagnostics) {
        let from = at.place;
        at.place = op.target().unwrap_or(from);
        if let Some((is_said, text)) = self.unknown(op) {
            if !std::mem::replace(is_said, true) {
                said.push(Diagnostic { line, ..Diagnostic::new(Severity::Notice, text.into()) });
            }
            return;
        }
        // Nothing is drawn that the drawing does not hold: the way from what is left out is made with the pen up.
        let op = match op.target() {
            Some(to) if std::mem::take(&mut at.is_lost) => PlotOp::Travel { to },
            _ => op,
        };
        let outcome = if self.has_chords && matches!(op, PlotOp::DrawArc { .. }) {
            // The first operation takes the arc to its place.
            chords([PlotOp::Travel { to: from }, op], self.tolerance_mm)
                .skip(1)
                .try_for_each(|chord| self.write(chord))
        } else {
            self.write(op)
        };
        if let Err(text) = outcome {
            at.is_lost = op.target().is_some();
            said.push(Diagnostic { line, ..Diagnostic::new(Severity::Error, text) });
        }
    }

    /// What to say where the target has no word for an operation, and whether that has been said.
    fn unknown(&mut self, op: PlotOp) -> Option<(&mut bool, &'static str)> {
        let is_thesis = matches!(self.target, Target::Thesis(..));
        let is_svg = matches!(self.target, Target::Svg(..));
        let is_gcode = matches!(self.target, Target::Gcode(..));
        match op {
            PlotOp::SelectPen { pen } if is_thesis && pen > 1 => {
                Some((&mut self.said_pens, "the thesis' text knows one pen: all is drawn with it"))
            }
            PlotOp::NewPage if is_thesis || is_svg => Some((
                &mut self.said_pages,
                "the target has no sheets: what follows is drawn on the first one",
            )),
            PlotOp::Dwell { .. } if !is_gcode => {
                Some((&mut self.said_dwells, "pauses are left out: the target has none"))
            }
            PlotOp::LaserPower { .. } if !self.has_laser => {
                Some((&mut self.said_power, "the power of a laser is left out (--gcode-pen laser writes it)"))
            }
            _ => None,
        }
    }

    fn write(&mut self, op: PlotOp) -> Result<(), String> {
        match &mut self.target {
            Target::Hpgl(writer) => writer.push(op).map_err(|error| reason(&error.to_string())),
            Target::Gcode(writer) => writer.push(op).map_err(|error| reason(&error.to_string())),
            Target::Svg(text, _) => match op.target() {
                Some(Point { x, y }) if !(x.abs() <= SVG_MOST_MM && y.abs() <= SVG_MOST_MM) => {
                    Err(format!("point ({x}, {y}) mm: pictures reach to ±{SVG_MOST_MM} mm here"))
                }
                _ => {
                    text.push(op);
                    Ok(())
                }
            },
            Target::Thesis(sink, before) => {
                let Some(pen_move) = PenMove::from_op(op, self.counts_per_mm) else { return Ok(()) };
                let stays = pen_move.pen == plotter_motion::Pen::Up && pen_move.target == *before;
                if !stays {
                    thesis_text::write_moves([pen_move], sink).map_err(|error| error.to_string())?;
                    *before = pen_move.target;
                }
                Ok(())
            }
        }
    }

    /// Whether there is somebody left to write for. A reader who has seen enough (`| head -1`) is no failure.
    fn is_wanted(&self) -> Result<bool, String> {
        match self.failure.borrow_mut().take() {
            None => Ok(true),
            Some(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
            Some(error) => Err(at(self.path, &format!("cannot be written: {error}"))),
        }
    }

    fn finish(self, colours: &[[u8; 3]], said: &mut Diagnostics) -> Result<(), String> {
        let (path, failure) = (self.path, self.failure);
        let failed = |error: &dyn fmt::Display| {
            let error =
                failure.borrow_mut().take().map_or_else(|| error.to_string(), |error| error.to_string());
            at(path, &format!("cannot be written: {error}"))
        };
        let mut sink = match self.target {
            Target::Hpgl(writer) => writer.finish().map_err(|error| failed(&error))?,
            Target::Gcode(writer) => writer.finish().map_err(|error| failed(&error))?,
            Target::Thesis(sink, _) => sink,
            Target::Svg(text, mut sink) => {
                let Point { x, y } = text.corner();
                if x < 0.0 || y < 0.0 {
                    let text = format!("the picture's corner lies at ({x:.3}, {y:.3}) mm, not at the origin");
                    said.push(Diagnostic::new(Severity::Notice, text));
                }
                sink.out.write_all(text.finish(colours).as_bytes()).map_err(|error| failed(&error))?;
                sink
            }
        };
        sink.out.flush().map_err(|error| failed(&error))
    }
}

/// Without the number of the operation, which says nothing to a reader of the file.
fn reason(text: &str) -> String {
    let rest = text.strip_prefix("operation ").and_then(|rest| rest.split_once(": "));
    rest.map_or(text, |(_, rest)| rest).to_owned()
}
