//! [`Followed`]: what a plotter has to know of its instructions to answer questions about them.

use plotter_motion::hpgl::{Error, Event, ReadOptions, UNITS_PER_MM};
use plotter_motion::{Pen, Point};

/// Numbers of an instruction that are looked at.
const MOST_NUMBERS: usize = 4;

/// An instruction that is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Question {
    /// `OA`: where the pen is, plotter units, and whether it is down.
    Actual,
    /// `OC`: where it was sent, in the text's own units, and whether it is down.
    Commanded,
    /// `OE`: the error.
    Error,
    /// `OF`: units to the millimetre.
    Factors,
    /// `OH`: the corners of the area.
    HardClip,
    /// `OI`: the model.
    Identification,
    /// `OO`: what it can do.
    Options,
    /// `OP`: P1 and P2.
    ScalingPoints,
    /// `OS`: the status byte.
    Status,
}

impl Question {
    fn of(letters: [u8; 2]) -> Option<Self> {
        Some(match &letters {
            b"OA" => Self::Actual,
            b"OC" => Self::Commanded,
            b"OE" => Self::Error,
            b"OF" => Self::Factors,
            b"OH" => Self::HardClip,
            b"OI" => Self::Identification,
            b"OO" => Self::Options,
            b"OP" => Self::ScalingPoints,
            b"OS" => Self::Status,
            _ => return None,
        })
    }
}

/// Follows the instructions as they are read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Followed {
    usual: [i32; 4],
    /// P1 and P2, plotter units.
    points: [i32; 4],
    /// What `SC` has said: the corners in the text's own units.
    scale: Option<[f64; 4]>,
    pub(super) pen: Pen,
    letters: [u8; 2],
    numbers: Vec<f64>,
    error: u8,
    initialized: bool,
    points_changed: bool,
}

impl Followed {
    /// A plotter whose P1 and P2 are these until a text moves them.
    pub(super) fn new(options: &ReadOptions) -> Self {
        let ((x1, y1), (x2, y2)) = (options.p1_units, options.p2_units);
        let usual = [x1, y1, x2, y2];
        Self {
            usual,
            points: usual,
            scale: None,
            pen: Pen::Up,
            letters: [0; 2],
            numbers: Vec::new(),
            error: 0,
            initialized: true,
            points_changed: false,
        }
    }

    /// Takes what was read; the question that is complete with it.
    pub(super) fn look(&mut self, event: &Event) -> Option<Question> {
        match *event {
            Event::Command { command, .. } => {
                let question = self.end();
                self.begin(command.letters().map(|letter| letter.to_ascii_uppercase()));
                return question;
            }
            Event::Number { value, last, .. } => {
                if self.numbers.len() < MOST_NUMBERS {
                    self.numbers.push(value);
                }
                return if last { self.end() } else { None };
            }
            Event::End | Event::Byte { last: true, .. } => return self.end(),
            Event::EndedBy { commands, .. } => {
                if let Some(last) = commands.iter().last() {
                    self.begin(last.letters().map(|letter| letter.to_ascii_uppercase()));
                }
            }
            _ => {}
        }
        None
    }

    fn begin(&mut self, letters: [u8; 2]) {
        (self.letters, self.numbers) = (letters, Vec::new());
        match &letters {
            b"PU" => self.pen = Pen::Up,
            b"PD" => self.pen = Pen::Down,
            b"IN" => {
                (self.pen, self.points, self.scale) = (Pen::Up, self.usual, None);
                (self.error, self.initialized) = (0, true);
            }
            b"DF" => self.scale = None,
            _ => {}
        }
    }

    fn end(&mut self) -> Option<Question> {
        let letters = core::mem::take(&mut self.letters);
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let whole = |number: f64| libm::round(number) as i32;
        let numbers = core::mem::take(&mut self.numbers);
        match (&letters, numbers.as_slice()) {
            (b"IP", []) => self.move_points(self.usual),
            (b"IP", &[x1, y1]) => {
                let [old_x1, old_y1, x2, y2] = self.points;
                let (x1, y1) = (whole(x1), whole(y1));
                let (by_x, by_y) = (x1.saturating_sub(old_x1), y1.saturating_sub(old_y1));
                self.move_points([x1, y1, x2.saturating_add(by_x), y2.saturating_add(by_y)]);
            }
            (b"IP", &[x1, y1, x2, y2]) => self.move_points([x1, y1, x2, y2].map(whole)),
            (b"SC", []) => self.scale = None,
            (b"SC", &[left, right, bottom, top]) if left != right && bottom != top => {
                self.scale = Some([left, right, bottom, top]);
            }
            _ => {}
        }
        Question::of(letters)
    }

    fn move_points(&mut self, points: [i32; 4]) {
        (self.points, self.points_changed) = (points, true);
    }

    /// Takes what the interpreter complains of. The first error is kept until it is asked for.
    pub(super) fn complain(&mut self, error: &Error) {
        let number = match error {
            Error::Unsupported { .. }
            | Error::Extension { .. }
            | Error::BadMnemonic { .. }
            | Error::UnexpectedByte { command: None, .. } => 1,
            Error::MissingNumber { .. } | Error::OddCoordinates { .. } | Error::MissingParameter { .. } => 2,
            Error::UnknownSigns { .. } => 5,
            _ => 3,
        };
        if self.error == 0 {
            self.error = number;
        }
    }

    /// Answers a question about a plotter whose pen is at `actual` and was sent to `commanded`, mm, on an
    /// area of this size.
    pub(super) fn answer(
        &mut self,
        question: Question,
        actual: Point,
        commanded: Point,
        area_mm: [f64; 2],
    ) -> String {
        let units = |mm: f64| libm::round(mm * UNITS_PER_MM) + 0.0; // (no minus before a zero)
        let pen = u8::from(self.pen == Pen::Down);
        match question {
            Question::Actual => format!("{},{},{pen}", units(actual.x), units(actual.y)),
            Question::Commanded => {
                let [x, y] = self.user_units(commanded);
                format!("{x},{y},{pen}")
            }
            Question::Error => core::mem::take(&mut self.error).to_string(),
            Question::Factors => String::from("40,40"),
            Question::HardClip => {
                let [width, height] = area_mm.map(units);
                format!("0,0,{width},{height}")
            }
            Question::Identification => String::from("7475A"),
            // Changes pens by itself, and draws circles and arcs.
            Question::Options => String::from("0,1,0,0,1,0,0,0"),
            Question::ScalingPoints => {
                self.points_changed = false;
                let [x1, y1, x2, y2] = self.points;
                format!("{x1},{y1},{x2},{y2}")
            }
            Question::Status => {
                let bits = [
                    (1, self.pen == Pen::Down),
                    (2, self.points_changed),
                    (8, core::mem::take(&mut self.initialized)),
                    (16, true), // ready for data
                    (32, self.error != 0),
                ];
                let status: u8 = bits.into_iter().filter_map(|(bit, is)| is.then_some(bit)).sum();
                status.to_string()
            }
        }
    }

    /// A place in the text's own units, whole ones.
    fn user_units(&self, at: Point) -> [f64; 2] {
        let [x, y] = [at.x, at.y].map(|mm| mm * UNITS_PER_MM);
        let [x, y] = match self.scale {
            None => [x, y],
            Some([left, right, bottom, top]) => {
                let [x1, y1, x2, y2] = self.points.map(f64::from);
                let along =
                    |at: f64, from: f64, to: f64| if to == from { 0.0 } else { (at - from) / (to - from) };
                [left + along(x, x1, x2) * (right - left), bottom + along(y, y1, y2) * (top - bottom)]
            }
        };
        [libm::round(x) + 0.0, libm::round(y) + 0.0]
    }
}
