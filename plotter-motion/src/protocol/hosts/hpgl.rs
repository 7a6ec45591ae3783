//! [`Hpgl`]: what pen plotters speak on a serial line.

use super::language::{Answer, Doing, Language, OpText, Report};
use super::{InFlight, MOST_LINE, Words};
use crate::gcode::WriteError;
use crate::hpgl::UNITS_PER_MM;
use crate::{PlotOp, Point, Vec2};
use core::fmt::Write as _;

/// A line goes out when so many bytes are free: two lines, as an answer may be older than the last line. The
/// least buffer of such plotters has 255 bytes (HP 7470A).
const ROOM: u32 = 192;
const _: () = assert!(ROOM as usize >= 2 * MOST_LINE, "room for two lines");
/// Greatest number of an error that `OE` tells. So few bytes are never free with [`ROOM`] kept.
const GREATEST_ERROR: u32 = 8;
/// Errors of the plotter are told by this and their number: 1 to 8 are those of `OE`, 10 to 16 of `ESC .E`.
const ERRORS: u16 = 200;
/// What a plotter answers to `OF`: units to the millimetre, of x and y.
const FACTORS: &str = "40,40";
/// Greatest coordinate, units: the plotters before HP-GL/2 end there.
const MOST_UNITS: f64 = 32_767.0;
/// Speeds that a plotter of that age takes, cm/s.
const SPEEDS: (f64, f64) = (1.0, 38.0);

/// How a plotter says that it has no room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum HpglFlow {
    /// It is asked for its free bytes behind each line (`ESC .B`). A lost answer is asked for again, and it
    /// needs nothing of the cable but the two lines for bytes.
    #[default]
    Asked,
    /// It sends XOFF when fewer than 128 bytes are free, and XON when there is room again (`ESC .I`, `ESC .N`).
    /// Lines go out without a pause between them. Half of the least buffer: an adapter on USB keeps up to 16
    /// ms of what both sides say, 31 bytes at 9600 bits a second, and sends on what it has.
    XonXoff,
    /// Its line DTR says so, which the cable leads to the CTS of this computer, and whose driver waits for
    /// it: the port is opened so. What stops the plotter waits, too.
    Dtr,
}

/// XON and XOFF, the control characters DC1 and DC3 of ASCII.
const XON: u8 = 0x11;
const XOFF: u8 = 0x13;

/// HPGL for a plotter with device control, as Hewlett-Packard's 7470A to 7595A have it.
///
/// - Behind each line the plotter is asked how many bytes of its buffer are free (`ESC .B`), and the next
///   goes out when there is room for it: no handshake of the line itself is needed.
/// - It is asked for its errors (`OE`, `ESC .E`) and for its place (`OA`) at each rest.
/// - It changes pens by itself.
/// - There is no word for a stop. `ESC .K` drops what is buffered; the line that it draws is drawn to its
///   end. Whoever has to stop it at once switches it off.
/// - Nothing guards against bytes that come wrong: an error is told by its number, and the place at rest.
///
/// ```
/// # use plotter_motion::PlotOp;
/// # use plotter_motion::protocol::hosts::{Hpgl, HostState, LineHost, LineHostSettings, MachineHost};
/// # use core::time::Duration;
/// let drawing = [PlotOp::SelectPen { pen: 2 }];
/// let mut host = LineHost::new(Hpgl::new(), LineHostSettings::default(), drawing.into_iter());
/// host.poll(Duration::ZERO);
/// let now = Duration::from_secs(2); // it says nothing by itself
/// host.poll(now);
/// let sent: Vec<u8> = core::iter::from_fn(|| host.next_byte(now)).collect();
/// assert_eq!(sent, b"\x1b.@;0:\x1b.M;;;10:\x1b.B"); // answers end with a line feed from here on
/// b"1024\n".iter().for_each(|&byte| host.receive(now, byte));
/// let sent: Vec<u8> = core::iter::from_fn(|| host.next_byte(now)).collect();
/// assert_eq!(sent, b"IN;SP1;\x1b.B");
/// ```
///
/// Source: *HP 7475A Interfacing and Programming Manual*, chapters on output and on RS-232-C interfacing.
#[derive(Clone, Debug)]
pub struct Hpgl {
    pen: u8,
    speed_cm_s: Option<i32>,
    /// The plotter is to be set up before the next line.
    begins: bool,
    /// The place that comes next was asked for at rest.
    rests: bool,
    flow: HpglFlow,
    /// It has sent XOFF.
    is_held: bool,
}

impl Default for Hpgl {
    fn default() -> Self {
        Self::new()
    }
}

impl Hpgl {
    /// A plotter that draws with its first pen until the drawing selects one.
    #[must_use]
    pub const fn new() -> Self {
        Self { pen: 1, speed_cm_s: None, begins: true, rests: false, flow: HpglFlow::Asked, is_held: false }
    }

    /// The same, which says so that it has no room.
    #[must_use]
    pub const fn with_flow(self, flow: HpglFlow) -> Self {
        Self { flow, ..self }
    }

    /// Sets the plotter up, if that is due.
    fn lead(&mut self, out: &mut OpText) -> core::fmt::Result {
        if core::mem::take(&mut self.begins) {
            match self.flow {
                HpglFlow::Asked => writeln!(out, "\x1b.@;0:\x1b.M;;;10:")?,
                HpglFlow::XonXoff => writeln!(out, "\x1b.@;0:\x1b.I128;;17:\x1b.N;19:\x1b.M;;;10:")?,
                HpglFlow::Dtr => writeln!(out, "\x1b.@;1:\x1b.M;;;10:")?,
            }
            writeln!(out, "IN;SP{};", self.pen)?;
        }
        Ok(())
    }

    fn operation(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError> {
        self.lead(out)?;
        match op {
            PlotOp::Travel { to } => {
                let [x, y] = units(to)?;
                writeln!(out, "PU{x},{y};")?;
            }
            PlotOp::Draw { to, feed_mm_s } => {
                let [x, y] = units(to)?;
                self.speed(feed_mm_s, out)?;
                writeln!(out, "PD{x},{y};")?;
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                let ([x, y], [to_x, to_y]) = (units(centre)?, units(to)?);
                self.speed(feed_mm_s, out)?;
                // To its end, as the centre is rounded.
                writeln!(out, "PD;AA{x},{y},{:.2};PA{to_x},{to_y};", sweep_rad.to_degrees())?;
            }
            PlotOp::SelectPen { pen } => {
                self.pen = pen;
                writeln!(out, "PU;SP{pen};")?;
            }
            _ => {}
        }
        Ok(())
    }

    /// The speed of what comes, if it is another one.
    fn speed(&mut self, feed_mm_s: Option<f64>, out: &mut OpText) -> core::fmt::Result {
        #[expect(clippy::cast_possible_truncation, reason = "1 to 38, as clamped")]
        let wanted = feed_mm_s.map(|feed| libm::round((feed / 10.0).clamp(SPEEDS.0, SPEEDS.1)) as i32);
        if wanted == self.speed_cm_s {
            return Ok(());
        }
        self.speed_cm_s = wanted;
        match wanted {
            Some(speed) => write!(out, "VS{speed};"),
            None => out.write_str("VS;"),
        }
    }
}

fn units(at: Point) -> Result<[f64; 2], WriteError> {
    let units = [at.x, at.y].map(|mm| libm::round(mm * UNITS_PER_MM) + 0.0); // (no minus before a zero)
    if units.iter().all(|unit| unit.abs() <= MOST_UNITS) {
        Ok(units)
    } else {
        Err(WriteError::Point { index: 0, to: at, limit_mm: MOST_UNITS / UNITS_PER_MM })
    }
}

impl Language for Hpgl {
    const STOP: &'static [u8] = b"\x1b.K";
    const ROOM_QUERY: &'static [u8] = b"\x1b.B";
    const CHANGES_PENS: bool = true;
    const RESTS_BY_REPORT: bool = true;

    fn begin(&mut self) {
        (self.begins, self.rests, self.speed_cm_s) = (true, false, None);
        self.is_held = false;
    }

    fn unsaid(&mut self) {
        self.speed_cm_s = None;
    }

    fn holds(&mut self, pen: u8) {
        self.pen = pen.max(1);
    }

    fn write(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError> {
        let before = self.clone();
        out.clear();
        self.operation(op, out).inspect_err(|_| *self = before)
    }

    fn jog(&mut self, _: Point, by: Vec2, _: f64, out: &mut OpText) -> bool {
        let [x, y] = [by.x, by.y].map(|mm| libm::round(mm * UNITS_PER_MM) + 0.0);
        self.lead(out).is_ok() && writeln!(out, "PU;PR{x},{y};PA;OA;").is_ok()
    }

    fn rest(&mut self, out: &mut OpText) {
        let _ = self.lead(out); // there is room for all of it in an empty text
        // The error of the line is told behind an E, as it comes before what is asked in the drawing. The
        // units to the millimetre come before a place that is one of rest: an answer to an earlier question
        // has none.
        let _ = out.write_str("\x1b.M;;;10;0;69:\x1b.E\x1b.M;;;10:PU;OE;OF;OA;\n");
    }

    fn place(&mut self, out: &mut OpText) {
        let _ = self.lead(out);
        let _ = out.write_str("OA;\n");
    }

    fn questions(&mut self, out: &mut OpText) {
        let _ = self.lead(out);
        let _ = out.write_str("OI;OA;\n");
    }

    fn frame(&self, _: u64, line: &[u8], out: &mut Words<MOST_LINE>) -> bool {
        let query = if self.answers_lines() { Self::ROOM_QUERY } else { b"" };
        line.trim_ascii_end().iter().chain(query).all(|&byte| out.push(byte))
    }

    fn fits(&self, flight: InFlight, _: usize) -> bool {
        flight.lines == 0
    }

    fn hear_byte(&mut self, byte: u8) -> bool {
        match (self.flow, byte) {
            (HpglFlow::XonXoff, XON) => self.is_held = false,
            (HpglFlow::XonXoff, XOFF) => self.is_held = true,
            _ => return false,
        }
        true
    }

    fn is_held(&self) -> bool {
        self.is_held
    }

    fn may_be_silent(&self) -> bool {
        // A question waits with the rest.
        self.is_held || self.flow == HpglFlow::Dtr
    }

    fn answers_lines(&self) -> bool {
        self.flow == HpglFlow::Asked
    }

    fn hear(&mut self, line: &[u8]) -> Answer {
        let Ok(text) = core::str::from_utf8(line) else { return Answer::Unknown };
        let error = |number: u32| match u16::try_from(number) {
            Ok(0) => Answer::Known,
            Ok(number @ 1..=16) => Answer::Complains(ERRORS + number),
            _ => Answer::Unknown,
        };
        if let Some(number) = text.strip_prefix('E').and_then(|number| number.parse::<u32>().ok()) {
            return error(number);
        }
        if let Ok(number) = text.parse::<u32>() {
            return match number {
                0..=GREATEST_ERROR => error(number),
                ROOM.. => Answer::Taken,
                _ => Answer::Busy,
            };
        }
        if text == FACTORS {
            self.rests = true;
            return Answer::Known;
        }
        if let Some(at) = place(text) {
            let doing = core::mem::take(&mut self.rests).then_some(Doing::Idle);
            return Answer::Report(Report { doing, at: Some(at) });
        }
        // Its name: 7475A.
        let is_name = text.len() <= 16 && text.bytes().all(|byte| byte.is_ascii_alphanumeric());
        if is_name { Answer::Known } else { Answer::Unknown }
    }
}

/// `400,200,1`.
fn place(text: &str) -> Option<Point> {
    let mut numbers = text.split(',');
    let mut mm = || Some(f64::from(numbers.next()?.trim().parse::<i32>().ok()?) / UNITS_PER_MM);
    let at = Point::new(mm()?, mm()?);
    let pen = numbers.next()?;
    (matches!(pen, "0" | "1") && numbers.next().is_none()).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_answers_are_told_apart() {
        let at = |x, y| Answer::Report(Report { doing: None, at: Some(Point::new(x, y)) });
        for (line, wanted) in [
            ("1024", Answer::Taken),
            ("192", Answer::Taken),
            ("191", Answer::Busy),
            ("0", Answer::Known),
            ("3", Answer::Complains(203)),
            ("E16", Answer::Complains(216)),
            ("E0", Answer::Known),
            ("400,-20,1", at(10.0, -0.5)),
            ("400,200", Answer::Unknown),
            ("7475A", Answer::Known),
            ("74~5A", Answer::Unknown),
        ] {
            assert_eq!(Hpgl::new().hear(line.as_bytes()), wanted, "{line}");
        }
        let mut hpgl = Hpgl::new();
        assert_eq!(hpgl.hear(b"40,40"), Answer::Known);
        let rest = Report { doing: Some(Doing::Idle), at: Some(Point::new(1.0, 2.0)) };
        assert_eq!(hpgl.hear(b"40,80,0"), Answer::Report(rest));
        assert_eq!(hpgl.hear(b"40,80,0"), at(1.0, 2.0));
    }

    #[test]
    fn operations_are_instructions_in_units_of_a_fortieth_millimetre() {
        let mut hpgl = Hpgl { begins: false, ..Hpgl::new() };
        let mut say = |op| {
            let mut out = OpText::default();
            let written = hpgl.write(op, &mut out).is_ok();
            (written, out)
        };
        let to = Point::new(10.0, 5.0);
        assert_eq!(say(PlotOp::Travel { to }).1.as_bytes(), b"PU400,200;\n");
        assert_eq!(say(PlotOp::Draw { to, feed_mm_s: Some(52.0) }).1.as_bytes(), b"VS5;PD400,200;\n");
        assert_eq!(say(PlotOp::Draw { to, feed_mm_s: Some(52.0) }).1.as_bytes(), b"PD400,200;\n");
        let arc = PlotOp::DrawArc {
            centre: Point::new(5.0, 5.0),
            sweep_rad: core::f64::consts::PI,
            to: Point::new(0.0, 5.0),
            feed_mm_s: None,
        };
        assert_eq!(say(arc).1.as_bytes(), b"VS;PD;AA200,200,180.00;PA0,200;\n");
        assert_eq!(say(PlotOp::SelectPen { pen: 3 }).1.as_bytes(), b"PU;SP3;\n");
        assert!(!say(PlotOp::Travel { to: Point::new(820.0, 0.0) }).0);
    }
}
