//! [`PlotOps`]: a text of a cutter as plot operations, read byte by byte.

use super::super::escape::{Escape, Step};
use super::super::scaling::limited;
use super::super::{Cursor, Position};
use super::command::{Entry, Form, MOST_ENTRIES, entry};
use super::{Command, Dialect, Error, Problem};
use crate::bezier::Bezier;
use crate::decimal::Decimal;
use crate::{PlotOp, Point, Vec2};
use core::f64::consts::TAU;
use core::iter::Copied;
use core::slice::Iter;

/// Ends a command of GP-GL.
const ETX: u8 = 3;
/// Numbers kept of a command: a curve of GP-GL has a kind, four places and a step.
const NUMBERS: usize = 10;
/// Greatest magnitude of a number: 2³⁰.
const MOST: f64 = 1_073_741_824.0;
/// Most that one byte gives: a travel, an arc and a complaint.
const QUEUE: usize = 4;
/// Chords of more than so many degrees are drawn as chords; narrower ones are only the machine's way to draw
/// an arc.
const USUAL_CHORD_DEG: f64 = 5.0;
/// Steps to a degree of the angles of GP-GL.
const TENTHS: f64 = 10.0;

/// Settings that a text for a cutter leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct ReadOptions {
    /// Language of the text.
    pub dialect: Dialect,
    /// Size of a step, mm, above 0.
    pub step_mm: f64,
    /// How far lines may be from the curves that they stand for, mm, above 0.
    pub tolerance_mm: f64,
}

impl ReadOptions {
    /// A text in this language for a machine as it is delivered: steps of [`Dialect::step_mm`], curves to
    /// 0.01 mm.
    #[must_use]
    pub const fn for_dialect(dialect: Dialect) -> Self {
        Self { dialect, step_mm: dialect.step_mm(), tolerance_mm: 0.01 }
    }
}

/// Where in the text it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Between two commands.
    Idle,
    /// After the first sign of a command of GP-GL, which may have a second one.
    Sign { first: u8, at: Position },
    /// Before, between or within its numbers.
    Numbers { entry: Entry, at: Position, number: Option<(Decimal, Position)> },
    /// Within what ends with the line (or with `;`).
    Rest { at_semicolon: bool },
    /// After an error, before the next command.
    Skip,
}

/// What is drawn piece by piece.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Job {
    None,
    Curve(Bezier),
    Chords { centre: Point, out: Vec2, sweep_rad: f64, chords: u32, next: u32 },
}

/// The plot operations of a text of a cutter, read from an iterator of bytes as they are asked for, in
/// constant memory.
///
/// An [`Error`] stands in the place of what could not be carried out, and the operations after it follow.
#[derive(Clone, Debug)]
pub struct PlotOps<I> {
    bytes: I,
    options: ReadOptions,
    escape: Escape,
    cursor: Cursor,
    state: State,
    /// The numbers of the command that have not been used, and how many there were in all.
    numbers: [f64; NUMBERS],
    count: usize,
    given: usize,
    queue: [Option<Result<PlotOp, Error>>; QUEUE],
    job: Job,
    /// Where the pen is, and what coordinates and arcs count from, steps.
    at: Vec2,
    origin: Vec2,
    centre: Vec2,
    /// Settings that have been named: a bit for each entry.
    said: u128,
    has_ended: bool,
}

const _: () = assert!(MOST_ENTRIES <= 128, "a bit for each entry");

impl<I: Iterator<Item = u8>> PlotOps<I> {
    /// The operations of the text `bytes`.
    pub fn with_options(bytes: impl IntoIterator<Item = u8, IntoIter = I>, options: ReadOptions) -> Self {
        Self {
            bytes: bytes.into_iter(),
            options,
            escape: Escape::None,
            cursor: Cursor::START,
            state: State::Idle,
            numbers: [0.0; NUMBERS],
            count: 0,
            given: 0,
            queue: [None; QUEUE],
            job: Job::None,
            at: Vec2::default(),
            origin: Vec2::default(),
            centre: Vec2::default(),
            said: 0,
            has_ended: false,
        }
    }
}

impl<I> PlotOps<I> {
    fn take(&mut self, byte: u8) {
        let at = self.cursor.here();
        self.cursor.pass(byte);
        match self.escape.push(byte) {
            Step::NotMine => self.plain(byte, at),
            // What asks the machine, or sets its interface, draws nothing; a command goes on behind it.
            Step::Begun | Step::Within | Step::Named { .. } | Step::Broken => {}
        }
    }

    fn plain(&mut self, byte: u8, at: Position) {
        match self.state {
            State::Idle => self.begin(byte, at),
            State::Sign { first, at: start } => {
                let second = byte.to_ascii_uppercase();
                if let Some(entry) = entry(self.options.dialect, first, Some(second)) {
                    return self.open(entry, start);
                }
                // By themselves these two take a number: with a letter they are a command of two that is not
                // in the table.
                let is_pair = matches!(first, b'F' | b'T') && second.is_ascii_alphabetic();
                match entry_of_one(self.options.dialect, first).filter(|_| !is_pair) {
                    Some(entry) => {
                        self.open(entry, start);
                        self.plain_within(byte, at);
                    }
                    None => {
                        self.state = State::Skip;
                        self.say(start, Problem::Unknown { command: Command::unknown(first, Some(second)) });
                    }
                }
            }
            State::Numbers { .. } | State::Rest { .. } | State::Skip => self.plain_within(byte, at),
        }
    }

    /// A byte within a command.
    fn plain_within(&mut self, byte: u8, at: Position) {
        let ends_line = matches!(byte, b'\r' | b'\n' | ETX);
        match self.state {
            State::Numbers { entry, at: start, number: Some((digits, from)) } => {
                let mut digits = digits;
                if digits.push(byte) {
                    self.state = State::Numbers { entry, at: start, number: Some((digits, from)) };
                    return;
                }
                self.state = State::Numbers { entry, at: start, number: None };
                if byte == b'.' || !self.number(entry, digits, from) {
                    if byte == b'.' {
                        self.say(from, Problem::BadNumber { command: entry.command });
                    }
                    self.state = if ends_line || byte == b';' { State::Idle } else { State::Skip };
                    return;
                }
                self.plain_between(entry, start, byte, at);
            }
            State::Numbers { entry, at: start, number: None } => self.plain_between(entry, start, byte, at),
            State::Rest { at_semicolon } => {
                if ends_line || (at_semicolon && byte == b';') {
                    self.state = State::Idle;
                }
            }
            State::Skip => {
                if ends_line || byte == b';' {
                    self.state = State::Idle;
                } else if byte.is_ascii_alphabetic() {
                    self.begin(byte, at);
                }
            }
            State::Idle | State::Sign { .. } => {}
        }
    }

    /// A byte that is no part of a number in progress.
    fn plain_between(&mut self, entry: Entry, start: Position, byte: u8, at: Position) {
        if let Some(digits) = Decimal::begin(byte) {
            self.state = State::Numbers { entry, at: start, number: Some((digits, at)) };
        } else if matches!(byte, b',' | b' ' | b'\t') {
            // Separators may stand in a row.
        } else {
            self.end(entry, start);
            self.state = State::Idle;
            self.begin(byte, at);
        }
    }

    /// The first byte of a command, or one between two.
    fn begin(&mut self, byte: u8, at: Position) {
        if byte == b';' || byte == b',' || byte <= b' ' || byte == 127 {
            self.state = State::Idle;
            return;
        }
        let first = byte.to_ascii_uppercase();
        let dialect = self.options.dialect;
        if dialect.is_gp_gl() && (first.is_ascii_alphabetic() || matches!(first, b'^' | b'(')) {
            self.state = State::Sign { first, at };
        } else if let Some(entry) = entry_of_one(dialect, first) {
            self.open(entry, at);
        } else {
            let problem = if first.is_ascii_alphabetic() {
                Problem::Unknown { command: Command::unknown(first, None) }
            } else {
                Problem::UnexpectedByte { byte }
            };
            self.state = State::Skip;
            self.say(at, problem);
        }
    }

    fn open(&mut self, entry: Entry, at: Position) {
        (self.count, self.given) = (0, 0);
        let command = entry.command;
        self.state = match entry.form {
            Form::Text => {
                self.say(
                    at,
                    Problem::LeftOut { command, remedy: "have the program turn its letters into lines (D)" },
                );
                State::Rest { at_semicolon: false }
            }
            Form::Rest(remedy) => {
                if !remedy.is_empty() {
                    self.say(at, Problem::LeftOut { command, remedy });
                } else if self.is_new(entry) {
                    self.say(at, Problem::Setting { command });
                }
                State::Rest { at_semicolon: true }
            }
            _ => State::Numbers { entry, at, number: None },
        };
    }

    /// A number that is complete; whether it is one.
    fn number(&mut self, entry: Entry, digits: Decimal, at: Position) -> bool {
        let Some(value) = digits.value().filter(|value| value.abs() <= MOST) else {
            self.say(at, Problem::BadNumber { command: entry.command });
            return false;
        };
        if let Some(slot) = self.numbers.get_mut(self.count) {
            *slot = value;
            self.count += 1;
        }
        self.given = self.given.saturating_add(1);
        if let (Form::Path { draws, relative, polar }, 2) = (entry.form, self.count) {
            self.count = 0;
            let [a, b, ..] = self.numbers;
            let way = if polar { Vec2::new(a, 0.0).rotated(angle_rad(b, TENTHS)) } else { Vec2::new(a, b) };
            let to = if relative { self.at + way } else { self.origin + way };
            self.go(to, draws);
        }
        true
    }

    /// The end of a command.
    fn end(&mut self, entry: Entry, at: Position) {
        let command = entry.command;
        if let Err(problem) = self.carry_out(entry, at) {
            self.say(
                at,
                match problem {
                    Wrong::Missing(expected) => Problem::MissingNumbers { command, expected },
                    Wrong::Bad(value, expected) => Problem::BadParameter { command, value, expected },
                },
            );
        }
    }

    fn carry_out(&mut self, entry: Entry, at: Position) -> Result<(), Wrong> {
        let command = entry.command;
        let n = self.numbers;
        match entry.form {
            Form::Path { .. } if self.given == 0 => return Err(Wrong::Missing("pairs of numbers")),
            Form::Path { .. } => {
                if self.count == 1 {
                    self.say(at, Problem::OddCoordinates { command, value: n[0] });
                }
            }
            Form::Home => self.go(Vec2::default(), false),
            Form::Pen => {
                let pen = self.at_least(1, "the number of a pen").map(|()| n[0])?;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "checked just before"
                )]
                match pen {
                    0.0..=255.0 if libm::floor(pen) == pen => {
                        self.give(Ok(PlotOp::SelectPen { pen: pen as u8 }))
                    }
                    _ => return Err(Wrong::Bad(pen, "a whole pen number from 0 to 255")),
                }
            }
            Form::Origin => {
                self.at_least(2, "the x and y of the new origin")?;
                self.origin = Vec2::new(n[0], n[1]);
            }
            Form::Centre => {
                self.at_least(2, "the x and y of a centre")?;
                self.centre = self.origin + Vec2::new(n[0], n[1]);
            }
            Form::Circle => {
                self.at_least(3, "a centre, a radius and two angles")?;
                let centre = self.origin + Vec2::new(n[0], n[1]);
                self.circle(Some(centre), 2)?;
            }
            Form::CircleFrom => self.circle(None, 0)?,
            Form::ArcAbout => self.circle(Some(self.centre), 0)?,
            Form::Bezier => {
                self.at_least(9, "a kind and the x and y of four points")?;
                let points = [1, 3, 5, 7].map(|index| {
                    let number = |index: usize| n.get(index).copied().unwrap_or(0.0);
                    self.origin + Vec2::new(number(index), number(index + 1))
                });
                if self.at != points[0] {
                    self.go(points[0], false);
                }
                let mm = points.map(|place| place * self.options.step_mm);
                self.job = Job::Curve(Bezier::new(mm, libm::fmax(self.options.tolerance_mm, f64::EPSILON)));
                self.at = points[3];
            }
            Form::LineType if self.given == 0 || n[0] == 0.0 => {}
            Form::LineType => {
                if self.is_new(entry) {
                    self.say(at, Problem::Solid { command });
                }
            }
            Form::LeftOut(remedy) => self.say(at, Problem::LeftOut { command, remedy }),
            Form::Setting => {
                if self.is_new(entry) {
                    self.say(at, Problem::Setting { command });
                }
            }
            Form::Text | Form::Rest(_) | Form::Quiet => {}
        }
        Ok(())
    }

    /// An arc: its radius is number `from` (in GP-GL there are two, where it begins and ends), then come its
    /// angles and the angle of its chords. Without a centre it begins where the pen is.
    fn circle(&mut self, centre: Option<Vec2>, from: usize) -> Result<(), Wrong> {
        let is_gp_gl = self.options.dialect.is_gp_gl();
        let expected = if is_gp_gl { "two radii and two angles" } else { "a radius and two angles" };
        let radii = if is_gp_gl { 2 } else { 1 };
        let angles = from + radii;
        // Without angles a circle of CAMM-GL about a place is whole.
        let is_whole = !is_gp_gl && from > 0 && self.given == angles;
        self.at_least(if is_whole { angles } else { angles + 2 }, expected)?;
        let numbers = self.numbers;
        let number = |index: usize| numbers.get(index).copied().unwrap_or(0.0);
        let (first, last) = (number(from), number(from + radii - 1));
        if first <= 0.0 || last < 0.0 {
            return Err(Wrong::Bad(if first <= 0.0 { first } else { last }, "a radius above 0"));
        }
        let unit = if is_gp_gl { TENTHS } else { 1.0 };
        let (begin, end) =
            if is_whole { (0.0, 360.0) } else { (number(angles) / unit, number(angles + 1) / unit) };
        if (end - begin).abs() > 360.0 {
            return Err(Wrong::Bad(number(angles + 1), "angles at most a whole turn apart"));
        }
        let out = Vec2::new(first, 0.0).rotated(angle_rad(begin, 1.0));
        let centre = centre.unwrap_or(self.at - out);
        if self.at != centre + out {
            self.go(centre + out, false);
        }
        let is_turn = (end - begin).abs() == 360.0 && first == last;
        let sweep_rad = if (end - begin).abs() == 360.0 {
            (end - begin).signum() * TAU
        } else {
            (end - begin).to_radians()
        };
        let to =
            if is_turn { centre + out } else { centre + Vec2::new(last, 0.0).rotated(angle_rad(end, 1.0)) };
        let chord_deg = if is_gp_gl || self.given <= angles + 2 { 0.0 } else { number(angles + 2).abs() };
        if sweep_rad == 0.0 {
            return Ok(());
        }
        if chord_deg > USUAL_CHORD_DEG {
            let chords = libm::ceil((end - begin).abs() / chord_deg);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to 72")]
            let chords = chords.clamp(1.0, 72.0) as u32;
            let out = out * self.options.step_mm;
            self.job = Job::Chords { centre: self.point(centre), out, sweep_rad, chords, next: 1 };
        } else {
            let arc = PlotOp::DrawArc {
                centre: self.point(centre),
                sweep_rad,
                to: self.point(to),
                feed_mm_s: None,
            };
            self.give(Ok(arc));
        }
        self.at = limited(to);
        Ok(())
    }

    fn at_least(&self, least: usize, expected: &'static str) -> Result<(), Wrong> {
        if self.given >= least { Ok(()) } else { Err(Wrong::Missing(expected)) }
    }

    fn go(&mut self, to: Vec2, draws: bool) {
        self.at = limited(to);
        let to = self.point(self.at);
        self.give(Ok(if draws { PlotOp::Draw { to, feed_mm_s: None } } else { PlotOp::Travel { to } }));
    }

    fn point(&self, steps: Vec2) -> Point {
        let place = limited(steps) * self.options.step_mm;
        Point::new(place.x, place.y)
    }

    /// Whether this setting has not been named yet; now it is.
    fn is_new(&mut self, entry: Entry) -> bool {
        let bit = u32::try_from(entry.index).ok().and_then(|index| 1_u128.checked_shl(index)).unwrap_or(0);
        let is_new = self.said & bit == 0;
        self.said |= bit;
        is_new
    }

    fn say(&mut self, at: Position, problem: Problem) {
        self.give(Err(Error { at, problem }));
    }

    fn give(&mut self, outcome: Result<PlotOp, Error>) {
        match self.queue.iter_mut().find(|slot| slot.is_none()) {
            Some(slot) => *slot = Some(outcome),
            None => debug_assert!(false, "a byte gives at most {QUEUE} outcomes"),
        }
    }

    fn next_of_job(&mut self) -> Option<PlotOp> {
        let to = match &mut self.job {
            Job::None => return None,
            Job::Curve(curve) => curve.next().map(|to| Point::new(to.x, to.y)),
            Job::Chords { centre, out, sweep_rad, chords, next } => (*next <= *chords).then(|| {
                let share = f64::from(*next) / f64::from(*chords);
                *next += 1;
                *centre + out.rotated(*sweep_rad * share)
            }),
        };
        if to.is_none() {
            self.job = Job::None;
        }
        to.map(|to| PlotOp::Draw { to, feed_mm_s: None })
    }

    fn finish(&mut self) {
        self.has_ended = true;
        if let State::Sign { first, at } = self.state {
            match entry_of_one(self.options.dialect, first) {
                Some(entry) => self.open(entry, at),
                None => self.say(at, Problem::Unknown { command: Command::unknown(first, None) }),
            }
        }
        if let State::Numbers { entry, at, number } = self.state
            && number.is_none_or(|(digits, from)| self.number(entry, digits, from))
        {
            self.end(entry, at);
        }
        self.state = State::Idle;
    }
}

/// Why a command cannot be carried out.
enum Wrong {
    Missing(&'static str),
    Bad(f64, &'static str),
}

fn entry_of_one(dialect: Dialect, first: u8) -> Option<Entry> {
    entry(dialect, first, None)
}

fn angle_rad(angle: f64, to_a_degree: f64) -> f64 {
    (angle / to_a_degree).to_radians()
}

impl<I: Iterator<Item = u8>> Iterator for PlotOps<I> {
    type Item = Result<PlotOp, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(outcome) = self.queue.iter_mut().find_map(Option::take) {
                return Some(outcome);
            }
            if let Some(op) = self.next_of_job() {
                return Some(Ok(op));
            }
            if self.job != Job::None {
                continue;
            }
            if self.has_ended {
                return None;
            }
            match self.bytes.next() {
                Some(byte) => self.take(byte),
                None => self.finish(),
            }
        }
    }
}

impl<I: Iterator<Item = u8>> core::iter::FusedIterator for PlotOps<I> {}

/// The plot operations of a text of a cutter that is in memory, for a machine as it is delivered. For others
/// see [`PlotOps::with_options`].
///
/// ```
/// # use plotter_motion::hpgl::cutter::{Dialect, plot_ops};
/// # use plotter_motion::{PlotOp, Point};
/// let ops: Result<Vec<PlotOp>, _> = plot_ops(b"M100,0\x03E0,50\x03", Dialect::GpGl).collect();
/// let (from, to) = (Point::new(10.0, 0.0), Point::new(10.0, 5.0));
/// assert_eq!(ops?, [PlotOp::Travel { to: from }, PlotOp::Draw { to, feed_mm_s: None }]);
/// # Ok::<(), plotter_motion::hpgl::cutter::Error>(())
/// ```
pub fn plot_ops(text: &[u8], dialect: Dialect) -> PlotOps<Copied<Iter<'_, u8>>> {
    PlotOps::with_options(text.iter().copied(), ReadOptions::for_dialect(dialect))
}
