//! [`Marlin`]: what machines with Marlin's firmware speak.

use super::gcode_words::GcodeWords;
use super::language::{Answer, Doing, Language, OpText, Report};
use super::{InFlight, MOST_LINE, Words};
use crate::gcode::{DwellUnit, WriteError, WriteOptions};
use crate::{PlotOp, Point, Vec2};
use core::fmt::Write as _;
use core::time::Duration;

/// The code of [`Refused`](super::MachineNotice::Refused) for a command that the machine does not know.
const UNKNOWN: u16 = 1;
/// The code for one whose parameters it cannot carry out.
const PARAMETERS: u16 = 2;
/// The code of [`Alarm`](super::MachineNotice::Alarm) for a machine that has halted: the number of the
/// command that does it.
const HALTED: u16 = 112;

/// Marlin's language: lines with a number and a checksum, each answered by `ok` once it is planned.
///
/// - The next line goes out when the one before is answered. Marlin drops all that waits when a line came
///   wrong, and asks again for each that follows; with one on the way it asks once.
/// - A line that was asked for, or not answered at all, goes out again. The machine takes each number once,
///   so an answer that came wrong costs nothing. Only a line that lost its number on the way is taken without
///   looking at its checksum: a move to the same place once more.
/// - `echo:busy: processing` says that a line takes long. `G4 P0` and `M114` tell where the machine rests.
///   `M400` would wait as well, but its emergency parser acts on a damaged line, too: one bit makes it
///   `M410`, which drops what is planned. So do not use it for the pen either. What begins the count, `M110`,
///   is one bit from `M112`, which halts the machine, and says so; it is sent once, before the drawing.
/// - A stop (`M112`) halts the machine until it is reset, and it has lost its place then. Its firmware needs
///   `EMERGENCY_PARSER`, else the stop waits behind what is planned.
/// - Pens on a servo are moved by `M280`, which acts at once: `G4 P0` waits before.
///
/// ```
/// # use plotter_motion::{PlotOp, Point};
/// # use plotter_motion::gcode::{PenControl, WriteOptions};
/// # use plotter_motion::protocol::hosts::{LineHost, LineHostSettings, MachineHost, Marlin};
/// # use core::time::Duration;
/// let pen = PenControl::Commands { up: "G4 P0\nM280 P0 S160", down: "G4 P0\nM280 P0 S90" };
/// let marlin = Marlin::new(WriteOptions { pen, settle: Duration::ZERO, ..WriteOptions::default() });
/// let drawing = [PlotOp::Travel { to: Point::new(1.0, 2.0) }];
/// let mut host = LineHost::new(marlin, LineHostSettings::default(), drawing.into_iter());
/// b"start\n".iter().for_each(|&byte| host.receive(Duration::ZERO, byte));
/// let sent: Vec<u8> = core::iter::from_fn(|| host.next_byte(Duration::ZERO)).collect();
/// assert_eq!(sent, b"N0 M110*35\n"); // lines are counted from here on
/// ```
///
/// Source: Marlin's documentation of G-codes; `gcode/queue.cpp` and `feature/e_parser.h` of its source.
#[derive(Clone, Debug)]
pub struct Marlin<'a> {
    words: GcodeWords<'a>,
    /// The machine is to count lines from the next one on.
    counts_anew: bool,
    /// What it has said of the line that it answers next.
    complaint: Option<Complaint>,
    /// The command that it does not know, as it came to it.
    unknown: Words<MOST_LINE>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Complaint {
    /// It does not know the command.
    Unknown,
    /// The command's parameters make no sense.
    Parameters,
    /// The line came wrong, or what it said of it did. An `ok` comes behind that all the same.
    Line,
}

impl<'a> Marlin<'a> {
    /// With these words for the pen. Coordinates have three decimals, whatever the options say: arcs need
    /// them. A pause of `G4` is in milliseconds.
    #[must_use]
    pub fn new(options: WriteOptions<'a>) -> Self {
        let options = WriteOptions { decimals: 3, dwell_unit: DwellUnit::Milliseconds, ..options };
        Self {
            words: GcodeWords::new(options),
            counts_anew: true,
            complaint: None,
            unknown: Words::default(),
        }
    }

    /// The next `ok` answers no line for certain.
    fn doubt(&mut self, answer: Answer) -> Answer {
        self.complaint = Some(Complaint::Line);
        self.unknown.clear();
        answer
    }

    fn say_words(&mut self, text: &OpText, out: &mut OpText) -> Result<(), WriteError> {
        out.clear();
        let text = core::str::from_utf8(text.as_bytes()).unwrap_or_default();
        if text.is_empty() || self.say(text, out) { Ok(()) } else { Err(WriteError::Output) }
    }

    /// Writes lines, behind the one that sets their number where that is due. Says whether they found room.
    fn say(&mut self, text: &str, out: &mut OpText) -> bool {
        let begins = if core::mem::take(&mut self.counts_anew) { "M110\n" } else { "" };
        out.write_str(begins).is_ok() && out.write_str(text).is_ok()
    }
}

impl Language for Marlin<'_> {
    /// Behind the end of a line that was begun.
    const STOP: &'static [u8] = b"\nM112\n";
    const IS_NUMBERED: bool = true;
    const RESTS_BY_REPORT: bool = true;
    const GREETS_AT_ORIGIN: bool = true;
    /// Twice the time between two words of a machine that is busy (`DEFAULT_KEEPALIVE_INTERVAL`), and more.
    const PATIENCE: Duration = Duration::from_secs(5);

    fn begin(&mut self) {
        self.words.begin();
    }

    fn count_anew(&mut self) {
        (self.counts_anew, self.complaint) = (true, None);
    }

    fn write(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError> {
        let mut text = OpText::default();
        self.words.write(op, &mut text)?;
        self.say_words(&text, out)
    }

    fn lift(&mut self, _: Point, out: &mut OpText) -> Result<(), WriteError> {
        let mut text = OpText::default();
        self.words.lift(&mut text)?;
        self.say_words(&text, out)
    }

    fn jog(&mut self, _: Point, by: Vec2, feed_mm_s: f64, out: &mut OpText) -> bool {
        let mut text = OpText::default();
        let feed_mm_min = (60.0 * feed_mm_s).max(1.0);
        let written = writeln!(text, "G91\nG0 X{:.3} Y{:.3} F{feed_mm_min:.0}\nG90\nG4 P0\nM114", by.x, by.y);
        // What is written next does not know of this place and speed.
        self.words.begin();
        written.is_ok() && self.say(core::str::from_utf8(text.as_bytes()).unwrap_or_default(), out)
    }

    fn rest(&mut self, out: &mut OpText) {
        self.say("G4 P0\nM114\n", out);
    }

    fn questions(&mut self, out: &mut OpText) {
        self.say("M115\nM114\n", out);
    }

    fn home(&mut self, out: &mut OpText) -> bool {
        self.say("G28\n", out)
    }

    fn stands_at(&mut self, place: Point, out: &mut OpText) -> bool {
        let mut text = OpText::default();
        writeln!(text, "G92 X{:.3} Y{:.3}\nM114", place.x, place.y).is_ok()
            && self.say(core::str::from_utf8(text.as_bytes()).unwrap_or_default(), out)
    }

    fn pen_down_at(&mut self, number: u16) -> bool {
        self.words.pen_down_at(number)
    }

    fn frame(&self, number: u64, line: &[u8], out: &mut Words<MOST_LINE>) -> bool {
        let Ok(text) = core::str::from_utf8(line.trim_ascii_end()) else { return false };
        if write!(out, "N{number} {text}").is_err() {
            return false;
        }
        let checksum = out.as_bytes().iter().fold(0, |sum, byte| sum ^ byte);
        writeln!(out, "*{checksum}").is_ok()
    }

    fn fits(&self, flight: InFlight, _: usize) -> bool {
        flight.lines == 0
    }

    fn complains_of(&self, line: &[u8]) -> bool {
        let Some(star) = line.iter().rposition(|&byte| byte == b'*') else { return false };
        let command = line.get(..star).unwrap_or_default();
        let blank = command.iter().position(|&byte| byte == b' ').unwrap_or(0);
        let unknown = self.unknown.as_bytes();
        !unknown.is_empty() && command.get(blank + 1..) == Some(unknown)
    }

    fn hear(&mut self, line: &[u8]) -> Answer {
        let text = core::str::from_utf8(line).unwrap_or_default();
        if text == "ok" || text.starts_with("ok ") {
            return match self.complaint.take() {
                None => Answer::Taken,
                Some(Complaint::Unknown | Complaint::Line) => Answer::Doubtful(UNKNOWN),
                Some(Complaint::Parameters) => Answer::Refused(PARAMETERS),
            };
        }
        if let Some(number) = text.strip_prefix("Resend: ").or_else(|| text.strip_prefix("rs ")) {
            self.complaint = None;
            return match number.trim().parse() {
                Ok(number) => Answer::Again(number),
                Err(_) => self.doubt(Answer::Unknown),
            };
        }
        if let Some(at) = place(text) {
            return Answer::Report(Report { doing: Some(Doing::Idle), at: Some(at) });
        }
        match text {
            "start" => {
                self.complaint = None;
                Answer::Greeting
            }
            _ if text.starts_with("echo:busy: ") => Answer::Busy,
            _ if text.starts_with("echo:Unknown command: ") => {
                self.complaint = Some(Complaint::Unknown);
                self.unknown.clear();
                let quoted = text.split_once('"').and_then(|(_, command)| command.strip_suffix('"'));
                let _ = self.unknown.write_str(quoted.unwrap_or_default()); // (a longer one is none of ours)
                Answer::Known
            }
            _ if text.starts_with("Error:Printer halted") => Answer::Alarm(HALTED),
            // Of these a wish for a line comes behind.
            _ if ["checksum mismatch", "No Checksum", "Line Number is not"]
                .iter()
                .any(|why| text.strip_prefix("Error:").is_some_and(|error| error.starts_with(why))) =>
            {
                self.doubt(Answer::Known)
            }
            _ if text.starts_with("Error:G2/G3") || text.starts_with("Error:Servo ") => {
                self.complaint = Some(Complaint::Parameters);
                Answer::Known
            }
            _ if ["echo:", "Error:", "T:", "FIRMWARE_NAME:", "Cap:", "//"]
                .iter()
                .any(|head| text.starts_with(head)) =>
            {
                Answer::Known
            }
            _ => self.doubt(Answer::Unknown),
        }
    }
}

/// `X:10.00 Y:5.50 Z:0.00 E:0.00 Count X:800 Y:440 Z:0`.
fn place(text: &str) -> Option<Point> {
    let (x, rest) = text.strip_prefix("X:")?.split_once(" Y:")?;
    let (y, rest) = rest.split_once(' ')?;
    let at = Point::new(x.parse().ok()?, y.parse().ok()?);
    (rest.starts_with("Z:") && at.is_finite()).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hear(lines: &[&str]) -> Answer {
        let mut marlin = Marlin::new(WriteOptions::default());
        let mut last = Answer::Unknown;
        for line in lines {
            last = marlin.hear(line.as_bytes());
        }
        last
    }

    #[test]
    fn its_lines_are_told_apart() {
        let at = |x, y| Answer::Report(Report { doing: Some(Doing::Idle), at: Some(Point::new(x, y)) });
        for (lines, wanted) in [
            (&["ok"][..], Answer::Taken),
            (&["ok N5 P15 B3"], Answer::Taken),
            (&["ok T:20.0 /0.0 @:0"], Answer::Taken),
            (&["okk"], Answer::Unknown),
            (&["Resend: 12"], Answer::Again(12)),
            (&["Resend: 1x"], Answer::Unknown),
            (&["rs 7"], Answer::Again(7)),
            (&["echo:busy: processing"], Answer::Busy),
            (&["T:20.00 /0.00 @:0"], Answer::Known),
            (&["start"], Answer::Greeting),
            (&["Error:Printer halted. kill() called!"], Answer::Alarm(112)),
            (&["X:1.00 Y:-2.50 Z:0.00 E:0.00 Count X:80 Y:-200 Z:0"], at(1.0, -2.5)),
            (&["X:1.0q Y:-2.50 Z:0.00 E:0.00 Count X:80 Y:-200 Z:0"], Answer::Unknown),
            (&["echo:Unknown command: \"M280 P0\"", "ok"], Answer::Doubtful(UNKNOWN)),
            (&["Error:G2/G3 bad parameters", "ok"], Answer::Refused(PARAMETERS)),
            (&["echo:Unknown command: \"M280 P0\"", "ok", "ok"], Answer::Taken),
            (&["Error:checksum mismatch, Last Line: 3", "ok"], Answer::Doubtful(UNKNOWN)),
            (&["Error:checksum mismatch, Last Line: 3", "Resend: 4", "ok"], Answer::Taken),
            (&["Rese~d: 4", "ok"], Answer::Doubtful(UNKNOWN)),
        ] {
            assert_eq!(hear(lines), wanted, "{lines:?}");
        }
    }

    #[test]
    fn a_line_has_its_number_and_the_exclusive_or_of_its_bytes() {
        let mut out = Words::default();
        assert!(Marlin::new(WriteOptions::default()).frame(1, b"G28\n", &mut out));
        assert_eq!(out.as_bytes(), b"N1 G28*18\n");
        let mut out = Words::default();
        assert!(!Marlin::new(WriteOptions::default()).frame(1, &[b'G'; 90], &mut out));
    }
}
