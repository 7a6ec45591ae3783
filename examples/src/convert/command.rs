//! The command line of `convert`, and its course.

use super::writer::{At, Writer};
use crate::drawings::{
    Arrangement, Diagnostic, Diagnostics, DrawingFile, Language, PenLines, Reading, Severity, SvgReading,
};
use crate::shared::{ExitStatus, Telling, run};
use clap::{Parser, ValueEnum};
use plotter_motion::{
    PlotOp,
    gcode::{LaserCommand, PenConvention, ServoCommand},
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Converts a drawing between HPGL, G-code, SVG and the thesis' text; reads DXF, CAMM-GL and GP-GL too.
///
/// Lines and arcs, pens, speeds and pauses are converted as far as the target knows them. Arcs stay arcs in
/// HPGL (AA), G-code (G2, G3) and SVG (A). SVG is read in mm by width, height and viewBox, with the lower
/// left corner as the origin: along strokes, and along the border of what is only filled; each colour is a
/// pen, 1, 2, … in the order in which they come, or each layer (--pens). Clip paths and masks cut it, and
/// white is taken for the paper (--paper). Its texts are set in the fonts that --font gives, and never in
/// others, or drawn in letters of one line (--single-stroke): so a file becomes the same strokes everywhere.
/// In the SVG that it writes, all that one pen draws until the next is taken is a group, and has that pen
/// when it is read again; the sheet of an SVG keeps its size. Layers of a DXF are pens, and its texts are
/// set in the font of HPGL's labels.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "convert",
    after_help = "Examples:\n  \
                  plotter convert drawing.plt drawing.gcode\n  \
                  plotter convert drawing.svg drawing.plt --tolerance-mm 0.02\n  \
                  plotter convert drawing.gcode drawing.svg --convention unicorn\n  \
                  plotter convert drawing.gcode drawing.svg --pen-up PEN_UP --pen-down PEN_DOWN\n  \
                  plotter convert plan.svg plan.plt --font DejaVuSans.ttf --font /usr/share/fonts\n  \
                  plotter convert plan.dxf plan.plt --step-mm 25.4\n  \
                  plotter convert sign.svg sign.gcode --single-stroke\n  \
                  plotter convert layers.svg layers.plt --pens layer --paper none\n  \
                  plotter convert drawing.svg - --to gcode --pen-up \"M280 P0 S60\" --pen-down \"M280 P0 S30\"\n  \
                  cat drawing.plt | plotter convert - drawing.svg\n\n\
                  Suffixes: .hpgl .plt .hpg for hpgl; .gcode .nc .ngc for gcode; .svg; .dxf; .txt for thesis.\n\
                  Exit status: 0 converted; 1 nothing that can be converted, or with --strict any error; 2 wrong options.\n\n\
                  In a checkout of the project, `cargo run --release --example convert --` stands for `plotter convert`."
)]
pub struct ConvertCommand {
    /// Drawing to read; - is the standard input
    input: PathBuf,
    /// Drawing to write; - is the standard output
    pub(super) output: PathBuf,
    /// Language of the drawing [default: found from its contents]
    #[arg(long, value_enum, value_name = "L")]
    pub(super) from: Option<Language>,
    /// Language to write [default: found from the suffix]
    #[arg(long, value_enum, value_name = "L")]
    pub(super) to: Option<Language>,
    /// Greatest distance of chords from arcs and curves that the target does not know, mm
    #[arg(long, value_name = "T", default_value = "0.01", value_parser = positive, allow_negative_numbers = true)]
    pub(super) tolerance_mm: f64,
    /// How G-code to read lifts its pen [default: found from its contents]
    #[arg(long, value_enum, value_name = "C")]
    convention: Option<Convention>,
    /// How G-code to write lifts its pen
    #[arg(long, value_enum, default_value = "servo")]
    pub(super) gcode_pen: GcodePen,
    // The pen of G-code in other words: where G-code is written, instead of --gcode-pen; and where it is
    // read, if it has them
    #[command(flatten)]
    pub(super) pen_lines: PenLines,
    /// Encoder counts per millimetre in the thesis' text
    #[arg(long, value_name = "N", default_value = "40", value_parser = positive, allow_negative_numbers = true)]
    pub(super) counts_per_mm: f64,
    /// Size of a step in CAMM-GL and GP-GL, or of the unit of a DXF, mm: 25.4 for inches [default: 0.025
    /// for CAMM-GL, 0.1 for GP-GL, 0.05 for Silhouette; the unit in the DXF, else 1]
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    #[command(flatten)]
    svg_reading: SvgReading,
    #[command(flatten)]
    arrangement: Arrangement,
    /// Ends at the first error, with exit status 1; notices do not count
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    telling: Telling,
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
pub(super) enum GcodePen {
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

impl ConvertCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let arguments = self;
        let Some(language) = arguments.to.or_else(|| Language::of_name(&arguments.output)) else {
            eprintln!(
                "convert: {}: no suffix that tells the language: give --to hpgl, gcode, svg or thesis",
                arguments.output.display()
            );
            return ExitStatus::WrongUse.into();
        };
        if matches!(language, Language::CammGl | Language::GpGl | Language::Dxf) {
            eprintln!(
                "convert: {} is read, not written: give --to hpgl, gcode, svg or thesis",
                language.name()
            );
            return ExitStatus::WrongUse.into();
        }
        if is_same(&arguments.input, &arguments.output) {
            eprintln!("convert: {}: the drawing would be written over itself", arguments.output.display());
            return ExitStatus::WrongUse.into();
        }
        run("convert", || convert(&arguments, language))
    }
}

fn is_same(input: &Path, output: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    real(input).is_some_and(|input| real(output) == Some(input)) && output.is_file()
}

fn convert(arguments: &ConvertCommand, language: Language) -> Result<(), String> {
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
    let (from, to) = (drawing.language().name(), language.name());
    let json = || {
        let written = arguments.output.display().to_string();
        let figures = json!({
            "written": written, "lines_and_arcs": drawn, "from": from, "to": to, "diagnostics": said.kept
        });
        Ok(figures.to_string())
    };
    if arguments.output == Path::new("-") {
        return arguments.telling.tell_aside("", json);
    }
    let told = format!("{}: {drawn} lines and arcs, {from} to {to}\n", arguments.output.display());
    arguments.telling.tell(&told, json)
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
