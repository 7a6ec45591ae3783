//! [`DrawingFile`]: a drawing in any of the languages, read as plot operations and diagnostics.

use crate::drawings::arrangement::Hidden;
use crate::drawings::language::is_dm_pl;
use crate::drawings::{Arrangement, Diagnostics, Language, PenLines, SvgReading, svg_drawing};
use crate::shared::at;
use plotter_motion::drawing::{Bounds, Hatching};
use plotter_motion::hpgl::{cutter, thesis_text};
use plotter_motion::toolpath::{ModalState, chords};
use plotter_motion::{PlotOp, Vec2, dxf, gcode, hpgl};
use plotter_vector::svg_in::SvgFonts;
use serde::Serialize;
use std::borrow::Cow;
use std::cell::{Cell, OnceCell, RefCell};
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Beginning of a file that tells its language.
const HEAD_BYTES: usize = 64 << 10;

/// Most that is held in memory: an SVG picture, or what comes through a pipe.
const MOST_HELD_BYTES: u64 = 1 << 30;

/// How bad something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The file is wrong there, and that part of it is left out.
    Error,
    /// It can be drawn, but perhaps not so.
    Warning,
    /// The file is right; something of it is not done here.
    Notice,
}

/// What there is to say about a drawing, and where.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnostic {
    /// Line of the file, from 1, if it belongs to one.
    pub line: Option<u32>,
    /// Byte within the line, from 1.
    pub column: Option<u32>,
    /// How bad it is.
    pub severity: Severity,
    /// What it is.
    pub text: String,
}

impl Diagnostic {
    /// One without a place.
    #[must_use]
    pub fn new(severity: Severity, text: String) -> Self {
        Self { line: None, column: None, severity, text }
    }

    fn placed(place: hpgl::Position, is_notice: bool, text: String) -> Self {
        let severity = if is_notice { Severity::Notice } else { Severity::Error };
        // The place stands in fields of its own.
        let text = text.strip_prefix(&format!("{place}: ")).map_or(text.clone(), str::to_owned);
        Self { line: Some(place.line), column: Some(place.column), severity, text }
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.column) {
            (Some(line), Some(column)) => write!(f, "line {line}, column {column}: ")?,
            (Some(line), None) => write!(f, "line {line}: ")?,
            _ => {}
        }
        f.write_str(&self.text)
    }
}

/// How drawings are read.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Farthest that lines may be from the curves that they stand for, mm.
    pub tolerance_mm: f64,
    /// Counts to the millimetre in the thesis' text.
    pub counts_per_mm: f64,
    /// How G-code lifts the pen; `None` finds it out.
    pub pen: Option<gcode::PenConvention>,
    /// Size of a step in the languages of cutters, and of the unit of a DXF, mm; `None` takes that of a
    /// machine as it is delivered, and what the DXF says, or a millimetre. Where it is not said, there is a
    /// notice.
    pub step_mm: Option<f64>,
}

impl Default for Reading {
    fn default() -> Self {
        Self { tolerance_mm: 0.01, counts_per_mm: hpgl::UNITS_PER_MM, pen: None, step_mm: None }
    }
}

/// A drawing's file, of a known language.
#[derive(Debug)]
pub struct DrawingFile {
    name: String,
    source: Source,
    language: Language,
    fonts: SvgFonts,
    svg: SvgReading,
    arrangement: Arrangement,
    /// What is in it, if it is a DXF.
    dxf: OnceCell<dxf::Drawing>,
    /// The lines that move its pen, if somebody says them.
    pen_words: Option<gcode::PenWords>,
    /// What there is to say about the files of its fonts.
    notices: Vec<String>,
}

#[derive(Debug)]
enum Source {
    /// A file that can be read as often as needed.
    File(PathBuf),
    /// What has come through a pipe, or is built in.
    Held(Vec<u8>),
}

impl DrawingFile {
    /// Opens a file, or the standard input for `-`, and finds out its language unless that is given.
    ///
    /// # Errors
    ///
    /// The file, and why it cannot be read or is no drawing.
    pub fn open(path: &Path, language: Option<Language>) -> Result<Self, String> {
        if path == Path::new("-") {
            let bytes = held(io::stdin().lock()).map_err(|error| format!("standard input: {error}"))?;
            return Self::held("standard input", bytes, language);
        }
        let failed = |error: io::Error| at(path, &format!("cannot be read: {error}"));
        let file = File::open(path).map_err(failed)?;
        let kind = file.metadata().map_err(failed)?;
        if kind.is_dir() {
            return Err(at(path, &"this is a folder: name a file in it"));
        }
        if !kind.is_file() {
            let bytes = held(file).map_err(|error| at(path, &error))?;
            return Self::held(&path.display().to_string(), bytes, language);
        }
        let mut head = Vec::new();
        file.take(HEAD_BYTES as u64).read_to_end(&mut head).map_err(failed)?;
        let name = path.display().to_string();
        let language = told(&name, &head, language)?;
        Ok(Self::of(name, Source::File(path.to_owned()), language))
    }

    /// A drawing in memory.
    ///
    /// # Errors
    ///
    /// That it is empty, or of no known language.
    pub fn held(name: &str, bytes: Vec<u8>, language: Option<Language>) -> Result<Self, String> {
        let language = told(name, bytes.get(..HEAD_BYTES).unwrap_or(&bytes), language)?;
        Ok(Self::of(name.to_owned(), Source::Held(bytes), language))
    }

    fn of(name: String, source: Source, language: Language) -> Self {
        let (fonts, svg) = (SvgFonts::default(), SvgReading::default());
        Self {
            name,
            source,
            language,
            fonts,
            svg,
            arrangement: Arrangement::default(),
            dxf: OnceCell::new(),
            pen_words: None,
            notices: Vec::new(),
        }
    }

    /// Reads it so, if it is an SVG picture; what is a pen counts for a DXF too.
    ///
    /// # Errors
    ///
    /// What is wrong with the files of its fonts.
    pub fn with_svg(mut self, how: &SvgReading) -> Result<Self, String> {
        if self.language == Language::Svg {
            (self.fonts, self.notices) = how.fonts.load()?;
        }
        self.svg = how.clone();
        Ok(self)
    }

    /// Does so with what is read.
    #[must_use]
    pub fn arranged(mut self, arrangement: &Arrangement) -> Self {
        self.arrangement = arrangement.clone();
        self
    }

    /// Lifts and lowers the pen by these lines, if there are any.
    ///
    /// # Errors
    ///
    /// The line that is no G-code, or that the drawing is none.
    pub fn with_pen_lines(mut self, lines: &PenLines) -> Result<Self, String> {
        self.pen_words = lines.words()?;
        if self.pen_words.is_some() && self.language != Language::Gcode {
            let name = self.language.name();
            return Err(format!(
                "{}: --pen-up and --pen-down are lines of G-code, and this is {name}",
                self.name
            ));
        }
        Ok(self)
    }

    /// What to say where nothing is drawn: what has been seen instead, and what helps.
    #[must_use]
    pub fn nothing_drawn(&self, said: &Diagnostics) -> String {
        if let Some(text) = self.arrangement.from_line.and_then(|line| self.nothing_from(line)) {
            return text;
        }
        let why = said.why_nothing();
        let text = format!("{}: nothing is drawn by it, read as {}{why}", self.name, self.language.name());
        if self.language != Language::Gcode {
            return text;
        }
        let seen = if self.pen_words.is_some() {
            "none of the lines that lower the pen stands before a movement".to_owned()
        } else {
            let detection = self.bytes(&Rc::default()).map(gcode::Detection::from_bytes).unwrap_or_default();
            lifted_by(detection.pen())
        };
        format!(
            "{text}; {seen}: say the lines that lift and lower it by --pen-up LINE --pen-down LINE, such as M5 and M3"
        )
    }

    /// That nothing is drawn from a line on, if something is drawn before it.
    fn nothing_from(&self, line: u32) -> Option<String> {
        let mut ops = self.read(Reading::default(), None).ok()?;
        let mut last = None;
        while let Some(op) = ops.next() {
            if matches!(op, Ok(PlotOp::Draw { .. } | PlotOp::DrawArc { .. })) {
                last = ops.line();
            }
        }
        let (last, lines) = (last.filter(|last| *last < line)?, ops.line()?);
        let name = &self.name;
        Some(if lines < line {
            format!(
                "{name}: --from-line {line}: the file has {lines} lines, and line {last} is the last one that draws"
            )
        } else {
            format!(
                "{name}: --from-line {line}: nothing is drawn from there on: line {last} is the last one that draws"
            )
        })
    }

    /// Name in messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Language of the file.
    #[must_use]
    pub fn language(&self) -> Language {
        self.language
    }

    /// How long it is, bytes.
    #[must_use]
    pub fn length_bytes(&self) -> u64 {
        match &self.source {
            Source::Held(bytes) => bytes.len() as u64,
            Source::File(path) => std::fs::metadata(path).map_or(0, |kind| kind.len()),
        }
    }

    /// Its operations, from the start, with what is to be done with them.
    ///
    /// # Errors
    ///
    /// The file, and why it cannot be read, or what cannot be done with it.
    pub fn ops(&self, how: Reading) -> Result<Ops<'_>, String> {
        if self.arrangement.from_line.is_some() && matches!(self.language, Language::Svg | Language::Dxf) {
            return Err(format!(
                "{}: --from-line: the lines of {} say nothing of what is drawn when: give --from-layer",
                self.name,
                self.language.name()
            ));
        }
        let named = |error| format!("{}: {error}", self.name);
        // SVG says itself what is filled, and hides when it is read: what is hatched then is hidden too.
        let (occludes, hidden) = match self.language {
            Language::Svg => (false, self.svg.occlude),
            _ => (self.svg.occlude, false),
        };
        let hatch = match self.arrangement.hatching(how.tolerance_mm).filter(|_| hidden) {
            Some(hatching) => {
                Some(self.arrangement.before_placing(hatching, self.read(how, None)?).map_err(named)?)
            }
            None => None,
        };
        let hides = match (occludes, hatch) {
            (_, Some(_)) => Hidden::Hatched,
            (true, None) => Hidden::Below,
            (false, None) => Hidden::None,
        };
        self.arrangement.apply(self.read(how, hatch)?, how.tolerance_mm, hides).map_err(named)
    }

    /// Its operations as they are in the file; an SVG picture hatched.
    fn read(&self, how: Reading, hatch: Option<Hatching>) -> Result<Ops<'_>, String> {
        let place = Rc::new(Place::default());
        let bytes = self.bytes(&place)?;
        let mut colours = Vec::new();
        let mut digit_mm = None;
        let mut sheet_mm = None;
        let mut layers = Rc::default();
        let inner: Box<dyn Iterator<Item = Result<PlotOp, Diagnostic>>> = match self.language {
            Language::Hpgl => {
                digit_mm = Some(1.0 / hpgl::UNITS_PER_MM);
                let options =
                    hpgl::ReadOptions { tolerance_mm: how.tolerance_mm, ..hpgl::ReadOptions::default() };
                let ops = hpgl::PlotOps::with_options(bytes, options);
                Box::new(ops.map(|op| {
                    op.map_err(|error| {
                        Diagnostic::placed(error.position(), error.is_notice(), error.to_string())
                    })
                }))
            }
            Language::Gcode => {
                let detection = gcode::Detection::from_bytes(bytes);
                digit_mm = detection.digit_mm();
                let mut options = detection.options();
                options.pen = how.pen.unwrap_or(options.pen);
                place.restart()?;
                let mut ops = gcode::PlotOps::with_options(self.bytes(&place)?, options);
                if let Some(words) = &self.pen_words {
                    ops = ops.with_pen_words(words.clone());
                }
                Box::new(ops.map(|op| {
                    op.map_err(|error| {
                        Diagnostic::placed(error.at, error.is_notice(), error.problem.to_string())
                    })
                }))
            }
            Language::Thesis => {
                digit_mm = Some(1.0 / how.counts_per_mm);
                Box::new(thesis_text::plot_ops(bytes, how.counts_per_mm).map(|op| {
                    op.map_err(|error| Diagnostic::placed(error.position(), false, error.to_string()))
                }))
            }
            Language::CammGl | Language::GpGl => {
                let dialect = self.dialect()?;
                let mut options = cutter::ReadOptions::for_dialect(dialect);
                options.tolerance_mm = how.tolerance_mm;
                options.step_mm = how.step_mm.unwrap_or(options.step_mm);
                digit_mm = Some(options.step_mm);
                let assumed = how.step_mm.is_none().then(|| {
                    let text = format!(
                        "the size of a step is not said in {}: it is taken for {} mm; if the drawing has another size, \
                         give another step (--step-mm)",
                        self.language.name(),
                        options.step_mm
                    );
                    Err(Diagnostic::new(Severity::Notice, text))
                });
                let ops = cutter::PlotOps::with_options(bytes, options).map(|op| {
                    op.map_err(|error| Diagnostic::placed(error.at, error.is_notice(), error.to_string()))
                });
                Box::new(assumed.into_iter().chain(ops))
            }
            Language::Svg => {
                let bytes = match &self.source {
                    Source::Held(bytes) => Cow::Borrowed(&bytes[..]),
                    Source::File(path) => Cow::Owned(crate::shared::read_file(path)?),
                };
                let drawing = svg_drawing(bytes, how.tolerance_mm, &self.svg, &self.fonts, hatch)
                    .map_err(|error| format!("{}: {error}", self.name))?;
                colours = drawing.colours;
                sheet_mm = Some(drawing.sheet_mm);
                let notices = self.notices.iter().map(|text| Diagnostic::new(Severity::Notice, text.clone()));
                let diagnostics = notices.chain(drawing.diagnostics);
                let (names, begins): (Vec<String>, Vec<usize>) = drawing.layers.into_iter().unzip();
                layers = Rc::new(names);
                let (place, mut stroke) = (Rc::clone(&place), 0);
                let ops = drawing.ops.inspect(move |op| {
                    if matches!(op, PlotOp::Travel { .. }) {
                        let layer = begins.partition_point(|first| *first <= stroke);
                        place.layer.set(u32::try_from(layer).unwrap_or(0));
                        stroke += 1;
                    }
                });
                Box::new(diagnostics.map(Err).chain(ops.map(Ok)))
            }
            Language::Dxf => {
                let drawing = self.dxf()?;
                let mut options = dxf::ReadOptions {
                    tolerance_mm: how.tolerance_mm,
                    unit_mm: how.step_mm,
                    pens: self.svg.pens.map_or(dxf::Pens::ByLayer, dxf::Pens::from),
                    ..dxf::ReadOptions::default()
                };
                let placed = placed(drawing, options);
                (options.moved_mm, colours) = (placed.moved_mm, placed.colours);
                let unit_mm = drawing.unit_mm().filter(|_| how.step_mm.is_none());
                let is_resized = self.arrangement.fit.is_some() || self.arrangement.scale.is_some();
                let large = very_large(placed.size_mm, unit_mm).filter(|_| !is_resized);
                if let Some((VeryLarge::ForAll, text)) = large {
                    return Err(format!("{}: {text}", self.name));
                }
                let large = large.map(|(_, text)| Diagnostic::new(Severity::Warning, text));
                layers = Rc::new(drawing.layers().map(str::to_owned).collect());
                let mut ops = drawing.plot_ops(options);
                let place = Rc::clone(&place);
                let ops = std::iter::from_fn(move || {
                    let op = ops.next()?;
                    place.layer.set(ops.layer());
                    Some(op)
                });
                let ops = ops.map(|op| {
                    op.map_err(|error| {
                        let severity = if error.is_notice() { Severity::Notice } else { Severity::Error };
                        let line = Some(error.line).filter(|line| *line > 0);
                        Diagnostic { line, ..Diagnostic::new(severity, error.problem.to_string()) }
                    })
                });
                Box::new(placed.moved.into_iter().chain(large).map(Err).chain(ops))
            }
        };
        Ok(Ops { inner, place, colours, digit_mm, sheet_mm, layers, failed: false })
    }

    /// What is in it, if it is a DXF: held, since it is walked through more than once.
    fn dxf(&self) -> Result<&dxf::Drawing, String> {
        if let Some(drawing) = self.dxf.get() {
            return Ok(drawing);
        }
        let place = Rc::default();
        let drawing =
            dxf::Drawing::read(self.bytes(&place)?).map_err(|error| format!("{}: {error}", self.name))?;
        place.restart()?;
        Ok(self.dxf.get_or_init(|| drawing))
    }

    /// Which of the languages of cutters it is.
    fn dialect(&self) -> Result<cutter::Dialect, String> {
        if self.language == Language::CammGl {
            return Ok(cutter::Dialect::CammGl);
        }
        let head: Vec<u8> = self.bytes(&Rc::default())?.take(HEAD_BYTES).collect();
        let found = cutter::Dialect::detect(&head).map(|(dialect, _)| dialect);
        Ok(found.filter(|dialect| *dialect != cutter::Dialect::CammGl).unwrap_or(cutter::Dialect::GpGl))
    }

    fn bytes(&self, place: &Rc<Place>) -> Result<Bytes<'_>, String> {
        let reader: Box<dyn Read + '_> = match &self.source {
            Source::Held(bytes) => Box::new(bytes.as_slice()),
            Source::File(path) => {
                Box::new(File::open(path).map_err(|error| at(path, &format!("cannot be read: {error}")))?)
            }
        };
        Ok(Bytes { reader, buffer: vec![0; HEAD_BYTES], filled: 0, next: 0, place: Rc::clone(place) })
    }
}

/// Farthest from the origin that a drawing of a CAD program may begin, mm: no table is as large.
const FARTHEST_MM: f64 = 10_000.0;

/// Largest drawing that is written or drawn, mm: the coordinates of G-code and of SVG end there.
const LARGEST_MM: f64 = 100_000.0;

/// Longest side that a drawing in a larger unit than the millimetre has before its unit is doubted, mm: that
/// of the largest table of the documented machines.
const LONG_SIDE_MM: f64 = 2_000.0;

/// Where a DXF is put, and what there is to say of that.
struct Placed {
    moved_mm: Vec2,
    moved: Option<Diagnostic>,
    size_mm: Vec2,
    /// Those of its pens.
    colours: Vec<[u8; 3]>,
}

/// By how much a DXF is moved. Drawings of CAD programs lie anywhere; what begins to the left of the origin,
/// below it, or far from it is put there with its lower left corner.
fn placed(drawing: &dxf::Drawing, options: dxf::ReadOptions) -> Placed {
    let mut ops = drawing.plot_ops(options);
    let mut bounds = Bounds::default();
    /// Within this an arc's box is known, mm.
    const BOX_MM: f64 = 0.1;
    chords(ops.by_ref().flatten(), BOX_MM).filter_map(PlotOp::target).for_each(|at| bounds.grow(at));
    let most_pen = ops.pens().map(|(pen, _)| pen).max().unwrap_or(0);
    let mut colours: Vec<[u8; 3]> = (1..=most_pen).map(crate::shared::usual_colour).collect();
    for (pen, colour) in ops.pens() {
        if let Some(known) = colours.get_mut(usize::from(pen).saturating_sub(1)) {
            *known = colour;
        }
    }
    /// What rounding may put to the left of an origin on which the drawing stands, mm.
    const ROUNDING_MM: f64 = 1e-6;
    let is_fine = |at: f64| (-ROUNDING_MM..=FARTHEST_MM).contains(&at);
    let (width_mm, height_mm) = bounds.size_mm();
    let size_mm = Vec2::new(width_mm, height_mm);
    let least = bounds.least;
    if bounds.is_empty() || is_fine(least.x) && is_fine(least.y) {
        return Placed { moved_mm: Vec2::default(), moved: None, size_mm, colours };
    }
    let text = format!(
        "the drawing begins at {:.3}, {:.3} mm: it is moved, so that its lower left corner is the origin",
        least.x, least.y
    );
    let moved = Some(Diagnostic::new(Severity::Notice, text));
    Placed { moved_mm: Vec2::new(-least.x, -least.y), moved, size_mm, colours }
}

/// How large a drawing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum VeryLarge {
    /// It cannot be written.
    ForAll,
    /// Its unit is to be doubted.
    ForItsUnit,
}

/// What there is to say of a very large drawing whose file says how large its unit is: many programs write
/// metres without being asked, while their users mean millimetres.
fn very_large(size_mm: Vec2, unit_mm: Option<f64>) -> Option<(VeryLarge, String)> {
    let side_mm = size_mm.x.max(size_mm.y);
    let unit_mm = unit_mm.filter(|unit_mm| *unit_mm > 1.0);
    let large = match unit_mm {
        _ if side_mm > LARGEST_MM => VeryLarge::ForAll,
        Some(_) if side_mm > LONG_SIDE_MM => VeryLarge::ForItsUnit,
        _ => return None,
    };
    let mut text = format!("the drawing is {:.1} x {:.1} m", size_mm.x / 1e3, size_mm.y / 1e3);
    if let Some(unit_mm) = unit_mm {
        text += &format!(
            ", since it says that its unit is {unit_mm} mm: give --step-mm 1 if its numbers are millimetres ({:.1} x {:.1} mm)",
            size_mm.x / unit_mm,
            size_mm.y / unit_mm
        );
    }
    text += if unit_mm.is_some() { ", else " } else { ": " };
    text += "make it smaller by --fit A4 or --scale";
    Some((large, text))
}

/// How a pen is lifted and lowered.
fn lifted_by(pen: gcode::PenConvention) -> String {
    use gcode::PenConvention;
    match pen {
        PenConvention::Spindle => "its pen seems to be lowered by M3 and lifted by M5".into(),
        PenConvention::SpindleWords { up, down } => {
            format!("its pen seems to be lowered by M{down} and lifted by M{up}")
        }
        PenConvention::Height { threshold_mm } => {
            format!("its pen seems to be down at Z {threshold_mm} mm and below")
        }
        PenConvention::Servo { command, up, down } => {
            format!("its pen seems to be moved by a servo ({command:?}: up at {up}, down at {down})")
        }
        PenConvention::Laser { command, .. } => {
            format!("it seems to be for a laser ({command:?}) that is never on as it moves")
        }
        _ => "it has no word that is known to move a pen, and no line by G1".into(),
    }
}

/// Share of a text that makes sense in the language its name says, above which that is told: any text makes
/// some, since every seventh pair of letters is a command of HPGL.
const WORTH_A_WORD: f64 = 0.25;

fn told(name: &str, head: &[u8], language: Option<Language>) -> Result<Language, String> {
    if head.is_empty() {
        return Err(format!("{name}: the file is empty"));
    }
    if head.starts_with(&[0x1f, 0x8b]) {
        return Err(format!("{name}: the file is compressed: unpack it first (gunzip)"));
    }
    if matches!(head, [b'A', b'C', b'1', b'0', digit, ..] if digit.is_ascii_digit()) {
        return Err(format!("{name}: this is a DWG, which is not read: save it as ASCII DXF"));
    }
    if let Some(language) = language {
        return Ok(language);
    }
    let found = Language::of_contents(head);
    // A comment of G-code may begin so, too.
    if found != Some(Language::Gcode) && is_dm_pl(head) {
        return Err(format!(
            "{name}: this is DM/PL, the language of Houston Instrument's plotters, which is not read: have the program write HPGL \
             (most cutters that take DM/PL take it too)"
        ));
    }
    let language = found.ok_or_else(|| {
        let named = Language::of_name(Path::new(name)).and_then(|named| Some((named, named.sense_of(head)?)));
        match named.filter(|(_, sense)| *sense > WORTH_A_WORD) {
            Some((named, sense)) => format!(
                "{name}: its name says {language}, but only {:.0} % of its beginning makes sense as that: correct it, or say \
                 that it is {language} to read it all the same",
                (100.0 * sense).floor(),
                language = named.name()
            ),
            None => format!(
                "{name}: this looks like none of HPGL, G-code, SVG, DXF, CAMM-GL, GP-GL and the thesis' text; if it is one, say which"
            ),
        }
    })?;
    if let Some(line) = (language == Language::Gcode).then(|| first_extrusion(head)).flatten() {
        return Err(format!(
            "{name}: line {line}: this is a file for a 3D printer: it feeds plastic (E) as it moves, and a pen cannot draw its \
             layers; export the drawing for a pen plotter, or say that it is G-code to read it all the same"
        ));
    }
    Ok(language)
}

/// The first line that moves in the plane and feeds plastic, which no plotter's file does.
fn first_extrusion(head: &[u8]) -> Option<u32> {
    let mut reader = gcode::Reader::new();
    head.iter().filter_map(|byte| reader.push(*byte)?.ok()).find_map(|block| {
        let moves = block.number(b'X').or(block.number(b'Y')).is_some();
        (moves && block.number(b'E')? > 0.0).then(|| block.position().line)
    })
}

fn held(reader: impl Read) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    reader
        .take(MOST_HELD_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.len() as u64 > MOST_HELD_BYTES {
        return Err(format!("more than {} MiB: save it as a file first", MOST_HELD_BYTES >> 20));
    }
    Ok(bytes)
}

/// The operations of a drawing; in their place, what there is to say.
pub struct Ops<'a> {
    inner: Box<dyn Iterator<Item = Result<PlotOp, Diagnostic>> + 'a>,
    place: Rc<Place>,
    /// Colours of the pens from 1 on, as red, green and blue, if the drawing says them.
    pub colours: Vec<[u8; 3]>,
    /// What the last digit of a place is worth that the file writes, mm, if the file tells: places are
    /// rounded to it.
    pub digit_mm: Option<f64>,
    /// Width and height of its sheet, mm, if it has one: the lower left corner is the origin.
    pub sheet_mm: Option<(f64, f64)>,
    /// Names of its layers, if it has any.
    pub(crate) layers: Rc<Vec<String>>,
    failed: bool,
}

impl fmt::Debug for Ops<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ops").field("line", &self.line()).finish_non_exhaustive()
    }
}

impl<'a> Ops<'a> {
    /// Number of the layer on which the operation given last lies, from 1; 0 for none.
    pub(crate) fn layer(&self) -> u32 {
        self.place.layer.get()
    }

    /// Other operations and what there is to say, with what these tell besides; no line of the file belongs
    /// to them.
    pub(crate) fn with(self, said: Vec<Diagnostic>, ops: impl Iterator<Item = PlotOp> + 'a) -> Self {
        let inner = Box::new(said.into_iter().map(Err).chain(ops.map(Ok)));
        self.place.line.set(0);
        Ops { inner, failed: false, ..self }
    }

    /// From a line on, with the pen, the power and the place that hold there; a line that is cut is drawn
    /// from there on.
    pub(crate) fn beginning_at(mut self, line: u32) -> Self {
        let place = Rc::clone(&self.place);
        let mut state = Some(ModalState::default());
        let inner = std::mem::replace(&mut self.inner, Box::new(std::iter::empty()));
        self.inner = Box::new(inner.flat_map(move |item| {
            let op = match (item, &mut state) {
                (Ok(op), Some(state)) if place.line.get() < line => {
                    state.pass(&op);
                    return Vec::new();
                }
                (Ok(op), _) => op,
                (diagnostic, _) => return vec![diagnostic],
            };
            state.take().map_or_else(|| vec![Ok(op)], |state| state.resume(op).map(Ok).collect())
        }));
        self
    }

    /// The line that has been read up to, from 1: that of the operation given last, or near it; `None` where
    /// the whole file was read before the first operation.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        Some(self.place.line.get()).filter(|line| *line > 0)
    }

    /// Bytes that have been read of the file: to the end of the part of it that is in memory.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.place.bytes.get()
    }
}

impl Iterator for Ops<'_> {
    type Item = Result<PlotOp, Diagnostic>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(item) = self.inner.next() {
            return Some(item);
        }
        let failure = self.place.failure.borrow_mut().take()?;
        self.failed = true;
        Some(Err(Diagnostic {
            line: self.line(),
            column: None,
            severity: Severity::Error,
            text: format!("cannot be read further: {failure}"),
        }))
    }
}

/// How far the bytes have been read.
#[derive(Debug)]
struct Place {
    /// Line of the byte given last; 0 before the first.
    line: Cell<u32>,
    /// How many lines later the byte to come is: one after a line end, and at the start.
    further: Cell<u32>,
    /// Layer of the operation given last, from 1; 0 for none.
    layer: Cell<u32>,
    /// Bytes that have been fetched to be given.
    bytes: Cell<u64>,
    failure: RefCell<Option<String>>,
}

impl Default for Place {
    fn default() -> Self {
        Self {
            line: Cell::new(0),
            further: Cell::new(1),
            layer: Cell::new(0),
            bytes: Cell::new(0),
            failure: RefCell::new(None),
        }
    }
}

impl Place {
    fn pass(&self, byte: u8) {
        self.line.set(self.line.get().saturating_add(self.further.get()));
        self.further.set(u32::from(byte == b'\n'));
    }

    fn restart(&self) -> Result<(), String> {
        self.line.set(0);
        self.further.set(1);
        self.bytes.set(0);
        self.failure.borrow_mut().take().map_or(Ok(()), Err)
    }
}

/// The bytes of a file, with a note of a failure.
struct Bytes<'a> {
    reader: Box<dyn Read + 'a>,
    buffer: Vec<u8>,
    filled: usize,
    next: usize,
    place: Rc<Place>,
}

impl Iterator for Bytes<'_> {
    type Item = u8;

    fn next(&mut self) -> Option<u8> {
        while self.next == self.filled {
            match self.reader.read(&mut self.buffer) {
                Ok(0) => return None,
                Ok(filled) => {
                    (self.filled, self.next) = (filled, 0);
                    let bytes = self.place.bytes.get();
                    self.place.bytes.set(bytes.saturating_add(filled as u64));
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => {
                    *self.place.failure.borrow_mut() = Some(error.to_string());
                    self.reader = Box::new(io::empty());
                    return None;
                }
            }
        }
        let byte = self.buffer.get(self.next).copied()?;
        self.next += 1;
        self.place.pass(byte);
        Some(byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::Point;

    fn read(text: &str) -> (Vec<PlotOp>, Vec<String>) {
        let file = DrawingFile::held("test", text.into(), None).unwrap();
        let (ops, said): (Vec<_>, Vec<_>) = file.ops(Reading::default()).unwrap().partition(Result::is_ok);
        let said = said.into_iter().filter_map(|item| item.err().map(|said| said.to_string())).collect();
        (ops.into_iter().flatten().collect(), said)
    }

    #[test]
    fn the_same_line_in_four_languages() {
        let texts = [
            "IN;PU400,0;PD800,400;",
            "PU, 00400, 00000\nPD, 00800, 00400",
            "G0 X10 Y0\nG1 X20 Y10\n",
            "<svg xmlns='http://www.w3.org/2000/svg' width='30mm' height='20mm' viewBox='0 0 30 20'>\
             <path d='M10 20L20 10' stroke='black'/></svg>",
        ];
        for text in texts {
            let (ops, said) = read(text);
            let places: Vec<Point> = ops.iter().filter_map(|op| op.target()).collect();
            assert_eq!(said, Vec::<String>::new(), "{text}");
            assert_eq!(places.len(), 2, "{text}");
            assert!(places[0].distance(Point::new(10.0, 0.0)) < 1e-5, "{text}");
            assert!(places[1].distance(Point::new(20.0, 10.0)) < 1e-5, "{text}");
        }
    }

    #[test]
    fn a_file_for_a_3d_printer_is_refused_unless_it_is_wanted() {
        // As slicers write: heat, a retraction, which moves nothing in the plane, and then the first line of
        // plastic.
        let text =
            "; sliced\nM104 S215\nG28\nM83\nG1 E-0.8 F2100\nG1 Z.2\nG1 X10 Y10 F9000\nG1 X20 Y10 E.52\n";
        let refused = DrawingFile::held("cube.gcode", text.into(), None).unwrap_err();
        assert!(refused.starts_with("cube.gcode: line 8: this is a file for a 3D printer"), "{refused}");
        assert!(DrawingFile::held("cube.gcode", text.into(), Some(Language::Gcode)).is_ok());
        // A pen on such a printer feeds nothing.
        let pen = "M104 S0\nG92 E0\nG0 Z2\nG0 X10 Y10\nG0 Z0\nG1 X20 Y10 E0\n";
        assert!(DrawingFile::held("pen.gcode", pen.into(), None).is_ok());
    }

    #[test]
    fn errors_have_their_place_and_the_rest_is_read() {
        let (ops, said) = read("IN;PU0,0;\nPD40,0,80;\nPD80,0;");
        assert_eq!(ops.len(), 3);
        assert_eq!(said.len(), 1);
        assert!(said[0].starts_with("line 2, column 8: PD has an x of 80 without a y"), "{said:?}");
        let (ops, said) = read("PU, 1, 2\nPD, 3, x\nPD, 5, 6\n");
        assert_eq!(ops.len(), 2);
        assert!(said[0].starts_with("line 2, column 8: `x` stands where a number belongs"), "{said:?}");
    }

    #[test]
    fn the_line_of_an_operation_is_known() {
        let file = DrawingFile::held("test", b"IN;\nPU0,0;\nPD40,0;\n".to_vec(), None).unwrap();
        let mut ops = file.ops(Reading::default()).unwrap();
        let mut lines = Vec::new();
        while let Some(op) = ops.next() {
            assert!(op.is_ok());
            lines.push(ops.line());
        }
        assert_eq!(lines, [Some(2), Some(3)]);
    }

    #[test]
    fn what_is_no_drawing_is_named() {
        let open = |bytes: &[u8]| DrawingFile::held("a.plt", bytes.to_vec(), None).unwrap_err();
        assert_eq!(open(b""), "a.plt: the file is empty");
        assert!(open(b"\x1f\x8b\x08").contains("compressed"));
        assert!(open(b"hello, world").contains("none of HPGL, G-code, SVG"));
        let refused = open(b";:H A L0 EC1 U 100,100 D 200,200 @");
        assert!(refused.starts_with("a.plt: this is DM/PL"), "{refused}");
        assert!(refused.contains("write HPGL"), "{refused}");
        let commented =
            DrawingFile::held("a.nc", b";: by hand\nG0 X1 Y2\nM3\nG1 X3\n".to_vec(), None).unwrap();
        assert_eq!(commented.language(), Language::Gcode);
    }

    #[test]
    fn the_languages_of_cutters_are_read_in_steps_of_their_machines() {
        for (text, step_mm, expected_mm) in [
            ("H\nM400,0\nD800,400\n", None, (10.0, 20.0)),
            ("H\nM400,0\nD800,400\n", Some(0.1), (40.0, 80.0)),
            ("H\u{3}M400,0\u{3}D800,400\u{3}", None, (40.0, 80.0)),
            ("\u{1b}\u{4}H\u{3}M400,0\u{3}D800,400\u{3}", None, (20.0, 40.0)),
        ] {
            let file = DrawingFile::held("test", text.into(), None).unwrap();
            let how = Reading { step_mm, ..Reading::default() };
            let (ops, said): (Vec<_>, Vec<_>) = file.ops(how).unwrap().partition(Result::is_ok);
            let places: Vec<f64> =
                ops.into_iter().flatten().filter_map(PlotOp::target).map(|to| to.x).collect();
            assert_eq!(places, [0.0, expected_mm.0, expected_mm.1], "{text:?}");
            // Whoever does not say the step is told which one is taken.
            assert_eq!(said.len(), usize::from(step_mm.is_none()), "{said:?}");
        }
    }
}
