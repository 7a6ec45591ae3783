//! [`Interpreter`]: commands in, plot operations out.

mod commands;
mod job;
mod labels;
mod open;
mod pen;
mod polygons;
mod rounds;
mod setup;
mod text_job;

use super::character_set::CharacterSets;
use super::encoded::{Bytes, Decoder};
use super::lettering::{Lettering, MOST_KEPT};
use super::line_type::{LineType, PATTERNS, Pattern};
use super::own_characters::OwnCharacters;
use super::pen_path::PenPath;
use super::piece::Piece;
use super::polygon::Polygon;
use super::scaling::Scaling;
use super::{Error, Event, Mnemonic, Position, ReadOptions, UNITS_PER_MM};
use crate::{PlotOp, Point, Vec2};
use core::fmt;
use job::{Job, Round, Shape};
use open::Open;
use polygons::Fill;

/// Pens that have a speed and a width of their own.
const PENS: usize = 8;
/// Most that one event gives, apart from what is drawn piece by piece: two complaints, a dot, and a circle
/// with the ways to it and back.
const QUEUE: usize = 8;
/// Places in the polygon buffer, unless one says otherwise.
pub(super) const USUAL_VERTICES: usize = 1024;
/// What `EA` and `EW` need of it.
const LEAST_VERTICES: usize = 8;

type Outcome = Result<PlotOp, Error>;

/// The operations of the event before have not all been taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Undrained;

impl fmt::Display for Undrained {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("operations are waiting: take them with next_op until it gives none")
    }
}

impl core::error::Error for Undrained {}

/// What waits to be given.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Item {
    Outcome(Outcome),
    /// A piece at the speed that held when it came; the line type applies to it if `patterned`.
    Piece {
        piece: Piece,
        patterned: bool,
        feed_mm_s: Option<f64>,
    },
    /// A side that the polygon buffer has no room for.
    Overflown(Piece),
}

/// Carries commands out: knows the pen, where it stands, and what coordinates mean.
///
/// Feed it what a [`Reader`](super::Reader) gives and take the operations after each event:
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// let (mut reader, mut interpreter) = (hpgl::Reader::new(), hpgl::Interpreter::new());
/// let mut ops = Vec::new();
/// for byte in *b"PU40,80;PR;PD400,0;" {
///     if let Some(event) = reader.push(byte) {
///         interpreter.push(event)?;
///     }
///     while let Some(op) = interpreter.next_op() {
///         ops.push(op?);
///     }
/// }
/// assert_eq!(
///     ops,
///     [
///         PlotOp::Travel { to: Point::new(1.0, 2.0) },
///         PlotOp::Draw { to: Point::new(11.0, 2.0), feed_mm_s: None },
///     ]
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - The pen marks when it is lowered. A `PD` whose pen is lifted again without a line is a dot, a line to
///   where the pen stands.
/// - `PU` and `PD` act when their two letters have been read, coordinates as each pair is complete. A pen
///   that is lifted goes up with the travel that follows; where the text ends instead, a travel to where it
///   stands lifts it.
/// - A circle begins and ends on the same point, right of the centre (left of it for a negative radius), and
///   runs counter-clockwise. It is drawn whether the pen is up or down; then the pen goes back to the centre
///   and is as it was. Circles and arcs are [`PlotOp::DrawArc`], unless the text asks for chords of more than
///   5 degrees.
/// - `IN` lifts the pen where it stands, and everything is as at the start but the place of the pen and the
///   size of the sheet; `DF` leaves the pen, its speed, P1, P2 and the turn of `RO` as well.
/// - Nothing is cut at the edges of a sheet that nobody has described: only `IW` cuts.
/// - What is not carried out is reported as [`Error::Unsupported`], and nothing else is lost by it.
///
/// # Memory
///
/// All of it is in the struct. The polygon buffer is what is big: 17 bytes for each of its `VERTICES` places,
/// and one more for the characters that a text draws itself (`DL`). A corner takes a place and an arc three;
/// a plotter of 1986 had room for a few hundred corners. The default is 1024 places, 22 KiB in all; a small
/// controller takes `Interpreter<64>`, 5 KiB. At least 8 places are needed: what `EA` and `EW` draw lies
/// there too. A side that does not fit is drawn as it comes, with a report ([`Error::PolygonTooLong`]): no
/// line is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpreter<const VERTICES: usize = USUAL_VERTICES> {
    // the pen
    pen_down: bool,
    /// The pen has been lowered and has not moved since.
    dot_owed: bool,
    relative: bool,
    /// Where the pen is, plotter units.
    at: Vec2,
    pen: u8,
    /// Speed of each pen from 1, mm/s.
    feeds_mm_s: [Option<f64>; PENS],
    /// Speed of any other pen, mm/s.
    feed_mm_s: Option<f64>,
    widths_mm: [f64; PENS],
    width_mm: f64,
    /// Whether `PW` speaks of percent.
    width_in_percent: bool,
    // what coordinates and lines are
    scaling: Scaling,
    /// Opposite corners of the window, plotter units along the turned axes.
    window: Option<(Vec2, Vec2)>,
    tolerance_units: f64,
    patterns: [Pattern; PATTERNS],
    /// Length of a pattern, units.
    pattern_length: f64,
    line_type_before: LineType,
    /// Whether a fourth number of arcs is a distance, not an angle.
    chord_is_distance: bool,
    /// Tick lengths to the right and up, and to the left and down, %.
    tick_percent: (f64, f64),
    /// Drawn at each place that the pen is sent to.
    symbol: Option<u8>,
    // labels
    lettering: Lettering,
    sets: CharacterSets,
    own: OwnCharacters<VERTICES>,
    kept: [u16; MOST_KEPT],
    kept_count: usize,
    /// A label to be drawn later, and which of its bytes is next while it is.
    buffered: [u8; MOST_KEPT],
    buffered_count: usize,
    playing: Option<usize>,
    /// Where the pen was before the label.
    label_from: Vec2,
    /// The first byte of a character that may have two.
    lead: Option<u8>,
    // polygons
    polygon: Polygon<VERTICES>,
    /// Between `PM0` and `PM2`.
    recording: bool,
    /// That a side did not fit has been said.
    overflow_said: bool,
    fill: Fill,
    // encoded data
    decoder: Option<Decoder>,
    bytes: Bytes,
    /// User-defined character: whether its pen is down.
    character_down: bool,
    /// Where it stands, plotter units.
    character_at: Vec2,
    // commands in, operations out
    open: Option<Open>,
    /// What has been said and is said once: a bit for each kind.
    said: u32,
    /// The command that has begun last.
    latest: Option<(Mnemonic, Position)>,
    queue: [Option<Item>; QUEUE],
    /// How many of them there are.
    queued: u8,
    report: Option<Error>,
    job: Job,
    path: PenPath,
    /// Speed of what is in `path`, mm/s.
    path_feed_mm_s: Option<f64>,
    /// Whether something has been drawn on the sheet.
    marked: bool,
    /// What has been given leaves the pen on the sheet.
    on_sheet: bool,
    /// It has been told to lift it, and nothing that lifts it has been given since.
    lift_owed: bool,
}

impl Default for Interpreter {
    fn default() -> Self {
        Self::new()
    }
}

impl Interpreter {
    /// A plotter that has just been switched on: pen up at the origin, absolute coordinates.
    #[must_use]
    pub fn new() -> Self {
        Self::with_options(ReadOptions::default())
    }
}

impl<const VERTICES: usize> Interpreter<VERTICES> {
    /// A plotter that has just been switched on, with `VERTICES` places in its polygon buffer: at least 8.
    ///
    /// ```
    /// # use plotter_motion::hpgl::{Interpreter, ReadOptions};
    /// let small = Interpreter::<64>::with_options(ReadOptions::default());
    /// assert!(size_of_val(&small) < 5 * 1024);
    /// ```
    #[must_use]
    pub fn with_options(options: ReadOptions) -> Self {
        const { assert!(VERTICES >= LEAST_VERTICES, "the polygon buffer has at least 8 places") };
        let tolerance_units = options.tolerance_mm * UNITS_PER_MM;
        Self {
            pen_down: false,
            dot_owed: false,
            relative: false,
            at: Vec2::default(),
            pen: 0,
            feeds_mm_s: [None; PENS],
            feed_mm_s: None,
            widths_mm: [setup::USUAL_WIDTH_MM; PENS],
            width_mm: setup::USUAL_WIDTH_MM,
            width_in_percent: false,
            scaling: Scaling::new(&options),
            window: None,
            // A tolerance of 0 would ask for lines without end.
            tolerance_units: if tolerance_units > f64::EPSILON { tolerance_units } else { f64::EPSILON },
            patterns: core::array::from_fn(Pattern::usual),
            pattern_length: 0.0,
            line_type_before: LineType::Solid,
            chord_is_distance: false,
            tick_percent: setup::USUAL_TICK_PERCENT,
            symbol: None,
            lettering: Lettering::new(),
            sets: CharacterSets::default(),
            own: OwnCharacters::new(),
            kept: [0; MOST_KEPT],
            kept_count: 0,
            buffered: [0; MOST_KEPT],
            buffered_count: 0,
            playing: None,
            label_from: Vec2::default(),
            lead: None,
            polygon: Polygon::new(),
            recording: false,
            overflow_said: false,
            fill: Fill::default(),
            decoder: None,
            bytes: Bytes::default(),
            character_down: false,
            character_at: Vec2::default(),
            open: None,
            said: 0,
            latest: None,
            queue: [None; QUEUE],
            queued: 0,
            report: None,
            job: Job::None,
            path: PenPath::new(),
            path_feed_mm_s: None,
            marked: false,
            on_sheet: false,
            lift_owed: false,
        }
    }

    /// Takes the next event, or the error that the reader gave instead.
    ///
    /// # Errors
    ///
    /// [`Undrained`] when [`Interpreter::next_op`] still has something to give; the event is not taken.
    pub fn push(&mut self, event: Result<Event, Error>) -> Result<(), Undrained> {
        self.drained()?;
        self.path.refill();
        match event {
            Ok(Event::Command { command, at }) => self.begin(command, at),
            Ok(Event::Number { value, at, last }) => {
                self.number(value, at);
                if last {
                    self.end();
                }
            }
            Ok(Event::Byte { byte, at, last }) => {
                self.byte(byte, at);
                if last {
                    self.end();
                }
            }
            Ok(Event::End) => self.end(),
            Ok(Event::EndedBy { commands, at, last, byte }) => self.end_by(commands, at, last, byte),
            Ok(Event::Extension { extension, at }) => {
                if self.is_new(extension.kind()) {
                    self.complain(Error::Extension { at, extension });
                }
            }
            Ok(Event::Escape { kind: b'.', .. }) => {}
            Ok(Event::Escape { kind, .. }) => {
                self.end();
                // ESC E starts a printer afresh.
                if kind == b'E' {
                    self.initialize();
                }
            }
            Err(error) => {
                self.open = None;
                self.decoder = None;
                self.give(Item::Outcome(Err(error)));
            }
        }
        Ok(())
    }

    /// Ends the drawing: a pen that has been lowered and never moved leaves its dot, one that has been lifted
    /// since its last line is lifted.
    ///
    /// # Errors
    ///
    /// As [`Interpreter::push`].
    pub fn finish(&mut self) -> Result<(), Undrained> {
        self.drained()?;
        self.leave_dot();
        if self.on_sheet && self.lift_owed {
            self.give(Item::Outcome(Ok(PlotOp::Travel { to: point(self.path.given()) })));
        }
        Ok(())
    }

    /// The next operation, or what could not be carried out; `None` when the next event is wanted.
    pub fn next_op(&mut self) -> Option<Outcome> {
        loop {
            if let Some(report) = self.report.take() {
                return Some(Err(report));
            }
            if let Some(piece) = self.path.next() {
                return Some(Ok(self.operation(piece)));
            }
            if self.queued > 0
                && let Some(item) = self.queue.iter_mut().find_map(Option::take)
            {
                self.queued -= 1;
                match item {
                    Item::Outcome(outcome) => {
                        if let Ok(PlotOp::SelectPen { pen }) = outcome {
                            self.pen = pen;
                        }
                        self.marked &= outcome != Ok(PlotOp::NewPage);
                        // All of them lift it: another pen, a new sheet, a travel.
                        self.on_sheet &= outcome.is_err();
                        self.lift_owed &= outcome.is_err();
                        return Some(outcome);
                    }
                    Item::Piece { piece, patterned, feed_mm_s } => {
                        self.path_feed_mm_s = feed_mm_s;
                        self.lay(piece, patterned);
                    }
                    Item::Overflown(piece) => {
                        self.path_feed_mm_s = self.feed();
                        self.path.push(piece, true);
                    }
                }
                continue;
            }
            let Some((piece, patterned)) = self.next_of_job() else {
                if self.play() {
                    continue;
                }
                return None;
            };
            self.path_feed_mm_s = self.feed();
            self.lay(piece, patterned);
        }
    }

    fn next_of_job(&mut self) -> Option<(Piece, bool)> {
        let next = match &mut self.job {
            Job::None => return None,
            Job::Round(round) => round.next(&self.scaling).map(|piece| (piece, true)),
            Job::Curve(curve, at) => curve.next().map(|to| {
                let from = core::mem::replace(at, to);
                (Piece::Line { from, to }, true)
            }),
            Job::Edge(cursor) => loop {
                match self.polygon.side(cursor) {
                    Some(side) if side.drawn => break Some((side.piece, true)),
                    Some(_) => {}
                    None => break None,
                }
            },
            Job::Fill(hatch, patterned) => hatch.next(&self.polygon).map(|piece| (piece, *patterned)),
            Job::Text(text) => {
                let kept = self.kept.get(..self.kept_count).unwrap_or(&self.kept);
                text.next(kept, &self.own).map(|piece| (piece, false))
            }
        };
        if next.is_some() {
            return next;
        }
        match core::mem::take(&mut self.job) {
            Job::Round(round) if matches!(round.shape, Shape::Circle { .. }) => {
                if !self.recording {
                    return Some((Piece::Travel { to: self.at }, true));
                }
                let closed = self.polygon.close(true);
                self.record(closed);
                None
            }
            Job::Text(_) => {
                self.kept_count = 0;
                None
            }
            _ => None,
        }
    }

    /// Into the polygon, or onto the sheet.
    fn lay(&mut self, piece: Piece, patterned: bool) {
        if !self.recording {
            self.path.push(piece, patterned);
            return;
        }
        // A circle lowers the pen itself.
        let circle = matches!(self.job, Job::Round(Round { shape: Shape::Circle { .. }, .. }));
        if let Err(piece) = self.polygon.push(piece, self.pen_down || circle) {
            self.say_overflow();
            self.path.push(piece, patterned);
        }
    }

    /// What the polygon buffer has no room for is drawn.
    fn record(&mut self, stored: Result<(), Piece>) {
        if let Err(piece) = stored {
            self.say_overflow();
            self.give(Item::Overflown(piece));
        }
    }

    fn operation(&mut self, piece: Piece) -> PlotOp {
        let feed_mm_s = self.path_feed_mm_s;
        self.on_sheet = !matches!(piece, Piece::Travel { .. });
        self.lift_owed &= self.on_sheet;
        self.marked |= self.on_sheet;
        match piece {
            Piece::Travel { to } => PlotOp::Travel { to: point(to) },
            Piece::Line { to, .. } => PlotOp::Draw { to: point(to), feed_mm_s },
            Piece::Arc(arc) => PlotOp::DrawArc {
                centre: point(arc.centre),
                sweep_rad: arc.sweep_rad,
                to: point(arc.to),
                feed_mm_s,
            },
        }
    }

    fn drained(&self) -> Result<(), Undrained> {
        let empty = self.job == Job::None
            && self.path.is_empty()
            && self.report.is_none()
            && self.playing.is_none()
            && self.queued == 0;
        if empty { Ok(()) } else { Err(Undrained) }
    }

    fn give(&mut self, item: Item) {
        match self.queue.iter_mut().find(|slot| slot.is_none()) {
            Some(slot) => {
                *slot = Some(item);
                self.queued += 1;
            }
            None => debug_assert!(false, "an event gives at most {QUEUE} items"),
        }
    }

    /// Whether this kind of thing has not been said yet; now it is.
    fn is_new(&mut self, kind: usize) -> bool {
        let bit = u32::try_from(kind).ok().and_then(|kind| 1_u32.checked_shl(kind)).unwrap_or(0);
        let is_new = self.said & bit == 0;
        self.said |= bit;
        is_new
    }

    fn complain(&mut self, error: Error) {
        self.give(Item::Outcome(Err(error)));
    }

    fn draw(&mut self, piece: Piece) {
        self.give(Item::Piece { piece, patterned: true, feed_mm_s: self.feed() });
    }

    /// Speed of the pen, mm/s.
    fn feed(&self) -> Option<f64> {
        let own = usize::from(self.pen).checked_sub(1).and_then(|index| self.feeds_mm_s.get(index));
        own.copied().unwrap_or(self.feed_mm_s)
    }

    /// Lifts the pen where it stands, or with the travel that follows.
    fn lift(&mut self) {
        self.leave_dot();
        self.lift_owed |= core::mem::take(&mut self.pen_down);
    }

    fn leave_dot(&mut self) {
        if core::mem::take(&mut self.dot_owed) {
            self.draw(Piece::Line { from: self.at, to: self.at });
        }
    }
}

/// A place in plotter units on the sheet, mm.
fn point(at: Vec2) -> Point {
    Point::new(at.x / UNITS_PER_MM, at.y / UNITS_PER_MM)
}
