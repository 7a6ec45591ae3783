//! [`Interpreter`]: commands in, plot operations out.

use super::{Error, Event, Mnemonic, Position, UNITS_PER_MM};
use crate::shapes::unit_circle;
use crate::{PlotOp, Point, Vec2};
use core::fmt;

/// Angle of a circle that one chord spans, where the command says none.
const CHORD_ANGLE_DEG: f64 = 5.0;
/// The finest chord angle: a finer one is taken as this, so that a circle never has more than 1000 chords.
const MIN_CHORD_ANGLE_DEG: f64 = 0.36;
/// The greatest angle of an arc, degrees: the whole circle.
const MOST_SWEEP_DEG: f64 = 360.0;
/// mm/s in a cm/s, the unit of `VS`.
const MM_S_PER_CM_S: f64 = 10.0;
/// Pens that have a speed of their own.
const PENS: usize = 8;
/// Most that one event gives, a circle apart: a complaint, a dot and one operation.
const QUEUE: usize = 4;
/// Numbers kept of a command that takes no pairs.
const NUMBERS: usize = 4;

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

/// The command in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Open {
    command: Mnemonic,
    at: Position,
    numbers: [(f64, Position); NUMBERS],
    count: u32,
    /// An x that waits for its y.
    x: Option<(f64, Position)>,
}

/// A circle or an arc that is drawn chord by chord.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Round {
    centre: Point,
    chords: u32,
    next: u32,
    shape: Shape,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Chord 0 is the way to the rim; then along it, then back to the centre.
    Circle { radius_mm: f64 },
    /// From where the pen stood, which is so far from the centre; by this angle. There is no chord 0.
    Arc { out: Vec2, sweep_rad: f64 },
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
/// - `PU` and `PD` act when their two letters have been read, coordinates as each pair is complete.
/// - A circle begins and ends on the same point, right of the centre (left of it for a negative radius), and runs
///   counter-clockwise. It is drawn whether the pen is up or down; then the pen goes back to the centre and is
///   as it was.
/// - `IN` lifts the pen where it stands, and sets absolute coordinates and the plotter's own speed; `DF` sets
///   absolute coordinates only.
/// - What is not carried out is reported as [`Error::Unsupported`], and nothing else is lost by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpreter {
    pen_down: bool,
    /// The pen has been lowered and has not moved since.
    dot_owed: bool,
    relative: bool,
    x_units: f64,
    y_units: f64,
    pen: u8,
    /// Speed of each pen from 1, mm/s.
    feeds_mm_s: [Option<f64>; PENS],
    /// Speed of any other pen, mm/s.
    feed_mm_s: Option<f64>,
    open: Option<Open>,
    queue: [Option<Outcome>; QUEUE],
    round: Option<Round>,
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
        Self {
            pen_down: false,
            dot_owed: false,
            relative: false,
            x_units: 0.0,
            y_units: 0.0,
            pen: 0,
            feeds_mm_s: [None; PENS],
            feed_mm_s: None,
            open: None,
            queue: [None; QUEUE],
            round: None,
        }
    }

    /// Takes the next event, or the error that the reader gave instead.
    ///
    /// # Errors
    ///
    /// [`Undrained`] when [`Interpreter::next_op`] still has something to give; the event is not taken.
    pub fn push(&mut self, event: Result<Event, Error>) -> Result<(), Undrained> {
        self.drained()?;
        match event {
            Ok(Event::Command { command, at }) => self.begin(command, at),
            Ok(Event::Number { value, at, last }) => {
                self.number(value, at);
                if last {
                    self.end();
                }
            }
            Ok(Event::Byte { last: true, .. } | Event::End) => self.end(),
            Ok(Event::Byte { last: false, .. } | Event::Escape { kind: b'.', .. }) => {}
            Ok(Event::Escape { .. }) => self.end(),
            Err(error) => {
                self.open = None;
                self.give(Err(error));
            }
        }
        Ok(())
    }

    /// Ends the drawing: a pen that has been lowered and never moved leaves its dot.
    ///
    /// # Errors
    ///
    /// As [`Interpreter::push`].
    pub fn finish(&mut self) -> Result<(), Undrained> {
        self.drained()?;
        self.leave_dot();
        Ok(())
    }

    /// The next operation, or what could not be carried out; `None` when the next event is wanted.
    pub fn next_op(&mut self) -> Option<Outcome> {
        if let Some(slot) = self.queue.iter_mut().find(|slot| slot.is_some()) {
            return slot.take();
        }
        let round = self.round.as_mut()?;
        let step = round.next;
        round.next += 1;
        let Round { centre, chords, shape, .. } = *round;
        match shape {
            Shape::Circle { .. } if step > chords => {
                self.round = None;
                Some(Ok(PlotOp::Travel { to: centre }))
            }
            Shape::Circle { radius_mm } => {
                // The last chord ends on the very first point: step == chords is step 0 again.
                let to = centre + unit_circle(step, chords) * radius_mm;
                Some(Ok(if step == 0 { PlotOp::Travel { to } } else { self.draw(to) }))
            }
            Shape::Arc { out, sweep_rad } => {
                let to = centre + out.rotated(sweep_rad * f64::from(step) / f64::from(chords));
                if step == chords {
                    self.round = None;
                    (self.x_units, self.y_units) = (to.x * UNITS_PER_MM, to.y * UNITS_PER_MM);
                }
                Some(Ok(if self.pen_down { self.draw(to) } else { PlotOp::Travel { to } }))
            }
        }
    }

    fn drained(&self) -> Result<(), Undrained> {
        if self.round.is_some() || self.queue.iter().any(Option::is_some) { Err(Undrained) } else { Ok(()) }
    }

    fn give(&mut self, outcome: Outcome) {
        match self.queue.iter_mut().find(|slot| slot.is_none()) {
            Some(slot) => *slot = Some(outcome),
            None => debug_assert!(false, "an event gives at most {QUEUE} outcomes"),
        }
    }

    fn here(&self) -> Point {
        Point::new(self.x_units / UNITS_PER_MM, self.y_units / UNITS_PER_MM)
    }

    fn draw(&self, to: Point) -> PlotOp {
        let own = usize::from(self.pen).checked_sub(1).and_then(|index| self.feeds_mm_s.get(index));
        PlotOp::Draw { to, feed_mm_s: own.copied().unwrap_or(self.feed_mm_s) }
    }

    fn leave_dot(&mut self) {
        if core::mem::take(&mut self.dot_owed) {
            self.give(Ok(self.draw(self.here())));
        }
    }

    fn begin(&mut self, command: Mnemonic, at: Position) {
        let start = (0.0, at);
        self.open = Some(Open { command, at, numbers: [start; NUMBERS], count: 0, x: None });
        match command.letters() {
            b"PU" => {
                self.leave_dot();
                self.pen_down = false;
            }
            b"PD" => {
                self.dot_owed |= !self.pen_down;
                self.pen_down = true;
            }
            b"PA" => self.relative = false,
            b"PR" => self.relative = true,
            b"IN" | b"DF" | b"SP" | b"VS" | b"CI" | b"AA" | b"AR" | b"PG" => {}
            // The reader has seen to the label terminator, and a comment is nothing to do.
            b"DT" | b"CO" => self.open = None,
            _ => {
                self.open = None;
                self.give(Err(Error::Unsupported { at, command }));
            }
        }
    }

    fn number(&mut self, value: f64, at: Position) {
        let Some(open) = &mut self.open else { return };
        if let b"PU" | b"PD" | b"PA" | b"PR" = open.command.letters() {
            match open.x.take() {
                None => open.x = Some((value, at)),
                Some((x, _)) => self.go(x, value),
            }
            return;
        }
        if let Some(slot) = usize::try_from(open.count).ok().and_then(|index| open.numbers.get_mut(index)) {
            *slot = (value, at);
        }
        open.count = open.count.saturating_add(1);
    }

    fn go(&mut self, x: f64, y: f64) {
        if self.relative {
            self.x_units += x;
            self.y_units += y;
        } else {
            (self.x_units, self.y_units) = (x, y);
        }
        let to = self.here();
        self.dot_owed = false;
        self.give(Ok(if self.pen_down { self.draw(to) } else { PlotOp::Travel { to } }));
    }

    fn end(&mut self) {
        let Some(open) = self.open.take() else { return };
        let Open { command, at, count, .. } = open;
        let [(first, first_at), (second, second_at), third, fourth] = open.numbers;
        let takes = match command.letters() {
            b"SP" => 1,
            b"VS" | b"CI" => 2,
            b"AA" | b"AR" => 4,
            _ => u32::MAX,
        };
        if count > takes {
            self.give(Err(Error::TooManyParameters { at, command, given: count, takes }));
        }
        let carried_out = match command.letters() {
            b"IN" => {
                self.initialize();
                Ok(())
            }
            b"DF" => {
                self.relative = false;
                Ok(())
            }
            b"PG" => {
                self.leave_dot();
                self.give(Ok(PlotOp::NewPage));
                Ok(())
            }
            b"SP" => self.select_pen(first, first_at, command),
            b"VS" => self.set_speed(
                (count > 0).then_some((first, first_at)),
                (count > 1).then_some((second, second_at)),
                command,
            ),
            b"CI" if count == 0 => {
                Err(Error::MissingParameter { at, command, expected: "a radius in plotter units" })
            }
            b"CI" => self.start_circle(first, (count > 1).then_some((second, second_at)), command),
            b"AA" | b"AR" if count < 3 => {
                Err(Error::MissingParameter { at, command, expected: "the centre's x and y and an angle" })
            }
            b"AA" | b"AR" => {
                let chord = (count > 3).then_some(fourth);
                self.start_arc(Vec2::new(first, second), third, chord, command)
            }
            _ => match open.x {
                Some((x, at)) => Err(Error::OddCoordinates { at, command, x }),
                None => Ok(()),
            },
        };
        if let Err(error) = carried_out {
            self.give(Err(error));
        }
    }

    fn initialize(&mut self) {
        self.leave_dot();
        self.pen_down = false;
        self.relative = false;
        self.feeds_mm_s = [None; PENS];
        self.feed_mm_s = None;
    }

    fn select_pen(&mut self, value: f64, at: Position, command: Mnemonic) -> Result<(), Error> {
        let pen = whole(value, 0, u8::MAX).ok_or(Error::BadParameter {
            at,
            command,
            value,
            expected: "a whole pen number from 0 to 255",
        })?;
        self.leave_dot();
        self.pen = pen;
        self.give(Ok(PlotOp::SelectPen { pen }));
        Ok(())
    }

    fn set_speed(
        &mut self,
        speed: Option<(f64, Position)>,
        pen: Option<(f64, Position)>,
        command: Mnemonic,
    ) -> Result<(), Error> {
        let feed_mm_s = match speed {
            Some((cm_s, _)) if cm_s > 0.0 => Some(cm_s * MM_S_PER_CM_S),
            Some((value, at)) => {
                return Err(Error::BadParameter { at, command, value, expected: "a speed above 0 cm/s" });
            }
            None => None,
        };
        let Some((value, at)) = pen else {
            self.feeds_mm_s = [feed_mm_s; PENS];
            self.feed_mm_s = feed_mm_s;
            return Ok(());
        };
        let slot = whole(value, 1, u8::MAX).and_then(|pen| self.feeds_mm_s.get_mut(usize::from(pen) - 1));
        let expected = "a whole pen number from 1 to 8 as its second number";
        *slot.ok_or(Error::BadParameter { at, command, value, expected })? = feed_mm_s;
        Ok(())
    }

    fn start_circle(
        &mut self,
        radius: f64,
        chord: Option<(f64, Position)>,
        command: Mnemonic,
    ) -> Result<(), Error> {
        let chords = chords(360.0, chord, command)?;
        // Lowered before the circle, the pen has already left its dot at the centre.
        self.leave_dot();
        let centre = self.here();
        if radius == 0.0 {
            self.give(Ok(self.draw(centre)));
        } else {
            let shape = Shape::Circle { radius_mm: radius / UNITS_PER_MM };
            self.round = Some(Round { centre, chords, next: 0, shape });
        }
        Ok(())
    }

    fn start_arc(
        &mut self,
        centre_units: Vec2,
        (sweep_deg, at): (f64, Position),
        chord: Option<(f64, Position)>,
        command: Mnemonic,
    ) -> Result<(), Error> {
        if sweep_deg.abs() > MOST_SWEEP_DEG {
            let expected = "an angle of at most 360 degrees";
            return Err(Error::BadParameter { at, command, value: sweep_deg, expected });
        }
        let chords = chords(sweep_deg, chord, command)?;
        // Nothing is drawn with the pen up: it goes to the end.
        let chords = if self.pen_down { chords } else { 1 };
        let here = self.here();
        let centre = Point::ORIGIN + centre_units * (1.0 / UNITS_PER_MM);
        let centre = if command.letters() == b"AR" { here + (centre - Point::ORIGIN) } else { centre };
        let shape = Shape::Arc { out: here - centre, sweep_rad: sweep_deg.to_radians() };
        self.dot_owed &= !self.pen_down;
        self.round = Some(Round { centre, chords, next: 1, shape });
        Ok(())
    }
}

/// Into how many chords an angle is divided.
fn chords(sweep_deg: f64, chord: Option<(f64, Position)>, command: Mnemonic) -> Result<u32, Error> {
    let (angle_deg, at) = chord.unwrap_or((CHORD_ANGLE_DEG, Position::START));
    if angle_deg.abs() > 180.0 {
        let expected = "a chord angle of at most 180 degrees";
        return Err(Error::BadParameter { at, command, value: angle_deg, expected });
    }
    let chords = libm::ceil(sweep_deg.abs() / angle_deg.abs().max(MIN_CHORD_ANGLE_DEG));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 1 to 1000, by the bounds of both angles"
    )]
    let chords = chords.max(1.0) as u32;
    Ok(chords)
}

/// `value` as a whole number from `least` to `greatest`.
fn whole(value: f64, least: u8, greatest: u8) -> Option<u8> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "compared with the value below"
    )]
    let number = value as u8;
    (f64::from(number) == value && (least..=greatest).contains(&number)).then_some(number)
}
