//! [`MDraw`]: what Makeblock's XY plotter with mDraw's firmware speaks.

use super::InFlight;
use super::gcode_words::GcodeWords;
use super::language::{Answer, Doing, Language, OpText, Report};
use crate::gcode::{PenControl, WriteError, WriteOptions};
use crate::{PlotOp, Point, Vec2};
use core::fmt::Write as _;
use core::time::Duration;

/// mDraw's language (firmware `xybot`): one line at a time, each answered by `OK` when it is carried out. It
/// has no word for a stop, a hold or a speed, and no checksum; `P` tells the place.
#[derive(Clone, Debug)]
pub struct MDraw<'a> {
    words: GcodeWords<'a>,
}

impl<'a> MDraw<'a> {
    /// With these words for the pen, `M1 160` and `M1 90` on a machine as it comes, of one that keeps its
    /// angles.
    #[must_use]
    pub fn new(up: &'a str, down: &'a str) -> Self {
        let options = WriteOptions {
            pen: PenControl::Commands { up, down },
            settle: Duration::ZERO, // G4 is answered at once, and nothing waits
            decimals: 2,
            ..WriteOptions::default()
        };
        Self { words: GcodeWords::new(options) }
    }
}

impl Language for MDraw<'_> {
    const ANSWERS_WHEN_DONE: bool = true;
    /// The longest line across a table of its kind, at its least speed.
    const PATIENCE: Duration = Duration::from_secs(60);

    fn begin(&mut self) {
        self.words.begin();
    }

    fn write(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError> {
        self.words.write(op, out)
    }

    fn lift(&mut self, _: Point, out: &mut OpText) -> Result<(), WriteError> {
        self.words.lift(out)
    }

    fn jog(&mut self, at: Point, by: Vec2, _: f64, out: &mut OpText) -> bool {
        let to = at + by;
        writeln!(out, "G1 X{:.2} Y{:.2}", to.x, to.y).is_ok()
    }

    fn rest(&mut self, out: &mut OpText) {
        let _ = out.write_str("P\n"); // there is room for it in an empty text
    }

    fn questions(&mut self, out: &mut OpText) {
        self.rest(out);
    }

    fn home(&mut self, out: &mut OpText) -> bool {
        out.write_str("G28\n").is_ok()
    }

    fn fits(&self, flight: InFlight, _: usize) -> bool {
        flight.lines == 0
    }

    fn hear(&mut self, line: &[u8]) -> Answer {
        // What mDraw itself goes by: these letters anywhere in a line.
        if line.windows(2).any(|letters| letters == b"OK") {
            return Answer::Taken;
        }
        if let Some(at) = place(line) {
            return Answer::Report(Report { doing: Some(Doing::Idle), at: Some(at) });
        }
        match line {
            b"set to default setup" => Answer::Known,
            _ if [b"distance=".as_slice(), b"M10 ", b"M11 "].iter().any(|head| line.starts_with(head)) => {
                Answer::Known
            }
            _ => Answer::Unknown,
        }
    }
}

/// `POS X12.00 Y3.50`.
fn place(line: &[u8]) -> Option<Point> {
    let text = core::str::from_utf8(line).ok()?.strip_prefix("POS X")?;
    let (x, y) = text.split_once(" Y")?;
    let at = Point::new(x.parse().ok()?, y.trim().parse().ok()?);
    at.is_finite().then_some(at)
}
