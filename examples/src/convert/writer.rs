//! Writes a drawing in any of the languages.

use super::command::{ConvertCommand, GcodePen};
use crate::drawings::{Diagnostic, Diagnostics, Language, Severity, SvgText};
use crate::shared::at;
use plotter_motion::{
    PenMove, PlotOp, Point, StepPoint, gcode, gcode::PenControl, hpgl, hpgl::thesis_text, toolpath::chords,
};
use std::cell::RefCell;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::rc::Rc;
use std::time::Duration;

/// Greatest coordinate in an SVG: beyond it the single precision of viewers is coarser than a plotter, mm.
const SVG_MOST_MM: f64 = 100_000.0;

/// Where the drawing's pen is, and whether it can be drawn from there.
#[derive(Default)]
pub(super) struct At {
    place: Point,
    is_lost: bool,
}

/// What is written.
pub(super) struct Writer<'a> {
    target: Target<'a>,
    pub(super) tolerance_mm: f64,
    /// Whether arcs have to be chords.
    has_chords: bool,
    pub(super) counts_per_mm: f64,
    pub(super) path: &'a Path,
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
    pub(super) fn open(
        arguments: &'a ConvertCommand,
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

    /// Takes the next operation. Plotters that advance their paper do so when they are told; nobody is asked
    /// for a sheet before something is drawn on it, nor before anything has been drawn at all.
    pub(super) fn push(&mut self, op: PlotOp, line: Option<u32>, at: &mut At, said: &mut Diagnostics) {
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
        // Nothing is drawn that the drawing does not hold: the way from what is left out is made with the pen
        // up.
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

    pub(super) fn write(&mut self, op: PlotOp) -> Result<(), String> {
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
    pub(super) fn is_wanted(&self) -> Result<bool, String> {
        match self.failure.borrow_mut().take() {
            None => Ok(true),
            Some(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
            Some(error) => Err(at(self.path, &format!("cannot be written: {error}"))),
        }
    }

    pub(super) fn finish(self, colours: &[[u8; 3]], said: &mut Diagnostics) -> Result<(), String> {
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
