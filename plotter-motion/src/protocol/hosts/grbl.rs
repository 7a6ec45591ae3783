//! [`Grbl`]: what GRBL 1.1 speaks, and with it GRBLHAL and `FluidNC`.

use super::gcode_words::GcodeWords;
use super::language::{Answer, Doing, Language, OpText, Report};
use super::{InFlight, MachineLimits};
use crate::gcode::{WriteError, WriteOptions};
use crate::{PlotOp, Point, Vec2};
use core::fmt::Write as _;
use core::time::Duration;

/// Bytes of lines that GRBL keeps before it takes them: 128, of which a ring keeps one free in some versions.
const RX_BYTES: usize = 127;

/// GRBL's language (its wiki, "Grbl v1.1 Interface"): lines answered by `ok` or `error:N` once they are
/// taken, so many of them on the way that its buffer of 128 bytes is never full (character counting); orders
/// of one byte past all lines; `?` is answered by a report at once.
#[derive(Clone, Debug)]
pub struct Grbl<'a> {
    words: GcodeWords<'a>,
    /// From the machine's own origin to that of the sheet, mm.
    offset: Vec2,
    limits: MachineLimits,
}

impl<'a> Grbl<'a> {
    /// With these words for the pen. Coordinates have three decimals, whatever the options say: arcs need
    /// them.
    #[must_use]
    pub fn new(options: WriteOptions<'a>) -> Self {
        Self {
            words: GcodeWords::new(WriteOptions { decimals: 3, ..options }),
            offset: Vec2::default(),
            limits: MachineLimits::default(),
        }
    }

    /// A report between its brackets: `Idle|MPos:0.000,0.000,0.000|FS:0,0`.
    fn report(&mut self, text: &str) -> Answer {
        let mut fields = text.split('|');
        let state = fields.next().unwrap_or_default();
        let (word, part) = state.split_once(':').unwrap_or((state, ""));
        let doing = match (word, part) {
            ("Idle", _) => Doing::Idle,
            ("Run" | "Jog", _) => Doing::Moves,
            ("Hold", "0") => Doing::Held,
            ("Hold", _) => Doing::Brakes,
            ("Home", _) => Doing::Homes,
            ("Alarm", _) => Doing::Locked,
            ("Door" | "Check" | "Sleep" | "Tool", _) => Doing::Elsewhere,
            _ => return Answer::Unknown,
        };
        let (mut machine, mut work) = (None, None);
        for field in fields {
            match field.split_once(':') {
                Some(("MPos", place)) => machine = Some(two(place)),
                Some(("WPos", place)) => work = Some(two(place)),
                Some(("WCO", place)) => match two(place) {
                    Some(offset) => self.offset = offset - Point::ORIGIN,
                    None => return Answer::Unknown,
                },
                _ => {}
            }
        }
        let at = match (work, machine) {
            (Some(at), _) => at,
            (None, Some(at)) => at.map(|at| at - self.offset),
            (None, None) => return Answer::Report(Report { doing: Some(doing), at: None }),
        };
        // A place that is no place: the report came wrong.
        at.map_or(Answer::Unknown, |at| Answer::Report(Report { doing: Some(doing), at: Some(at) }))
    }

    /// `$110=500.000`.
    fn setting(&mut self, text: &str) -> Answer {
        let number = text.split_once('=').and_then(|(key, value)| {
            let value = value.split(' ').next().unwrap_or_default();
            Some((key.parse::<u16>().ok()?, value.parse::<f64>().ok().filter(|value| value.is_finite())?))
        });
        let Some((key, value)) = number else { return Answer::Unknown };
        let limits = &mut self.limits;
        let (of, value) = match key {
            20 => {
                limits.refuses_beyond = Some(value != 0.0);
                return Answer::Known;
            }
            100 | 101 => (&mut limits.steps_per_mm, value),
            110 | 111 => (&mut limits.speed_mm_s, value / 60.0),
            120 | 121 => (&mut limits.acceleration_mm_s2, value),
            130 | 131 => (&mut limits.travel_mm, value),
            _ => return Answer::Known,
        };
        if let Some(of) = of.get_mut(usize::from(key % 10)) {
            *of = Some(value).filter(|&value| value > 0.0);
        }
        Answer::Known
    }
}

/// The first two of numbers with commas.
fn two(text: &str) -> Option<Point> {
    let mut numbers = text.split(',').map(|number| number.parse::<f64>().ok());
    let at = Point::new(numbers.next()??, numbers.next()??);
    at.is_finite().then_some(at)
}

fn code(text: &str) -> Option<u16> {
    text.trim().parse().ok()
}

impl Language for Grbl<'_> {
    const STOP: &'static [u8] = &[0x18];
    const HOLD: Option<(u8, u8)> = Some((b'!', 0x18));
    const QUERY: Option<u8> = Some(b'?');
    const END_JOG: Option<u8> = Some(0x85);

    fn begin(&mut self) {
        self.words.begin();
    }

    fn write(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError> {
        self.words.write(op, out)
    }

    fn lift(&mut self, _: Point, out: &mut OpText) -> Result<(), WriteError> {
        self.words.lift(out)
    }

    fn jog(&mut self, _: Point, by: Vec2, feed_mm_s: f64, out: &mut OpText) -> bool {
        writeln!(out, "$J=G91 G21 X{:.3} Y{:.3} F{:.0}", by.x, by.y, (60.0 * feed_mm_s).max(1.0)).is_ok()
    }

    fn rest(&mut self, out: &mut OpText) {
        let _ = out.write_str("G4 P0\n"); // there is room for it in an empty text
    }

    fn questions(&mut self, out: &mut OpText) {
        let _ = out.write_str("$$\n");
    }

    fn home(&mut self, out: &mut OpText) -> bool {
        out.write_str("$H\n").is_ok()
    }

    fn unlock(&mut self, out: &mut OpText) -> bool {
        out.write_str("$X\n").is_ok()
    }

    fn stands_at(&mut self, place: Point, out: &mut OpText) -> bool {
        writeln!(out, "G10 L20 P1 X{:.3} Y{:.3}", place.x, place.y).is_ok()
    }

    /// Overrides by tens and ones from what is in force: bytes 0x90 to 0x94.
    fn feed(&mut self, from_percent: u8, to_percent: u8, out: &mut OpText) -> Option<u8> {
        let to = to_percent.clamp(10, 200);
        let mut at = from_percent;
        if to == 100 {
            return out.push(0x90).then_some(100);
        }
        while at != to {
            let (byte, next) = match i16::from(to) - i16::from(at) {
                10.. => (0x91, at.saturating_add(10)),
                1..10 => (0x93, at.saturating_add(1)),
                ..=-10 => (0x92, at.saturating_sub(10)),
                _ => (0x94, at.saturating_sub(1)),
            };
            if !out.push(byte) {
                return None;
            }
            at = next;
        }
        Some(at)
    }

    fn pen_down_at(&mut self, number: u16) -> bool {
        self.words.pen_down_at(number)
    }

    fn stands_for(&self) -> Duration {
        self.words.settle()
    }

    fn fits(&self, flight: InFlight, bytes: usize) -> bool {
        flight.bytes.saturating_add(bytes) <= RX_BYTES
    }

    fn hear(&mut self, line: &[u8]) -> Answer {
        let Ok(text) = core::str::from_utf8(line) else { return Answer::Unknown };
        if text == "ok" {
            return Answer::Taken;
        }
        if let Some(report) = text.strip_prefix('<').and_then(|text| text.strip_suffix('>')) {
            return self.report(report);
        }
        if let Some(number) = text.strip_prefix("error:") {
            return code(number).map_or(Answer::Unknown, Answer::Refused);
        }
        if let Some(number) = text.strip_prefix("ALARM:") {
            return code(number).map_or(Answer::Unknown, Answer::Alarm);
        }
        if let Some(setting) = text.strip_prefix('$') {
            return self.setting(setting);
        }
        match text {
            _ if text.starts_with("Grbl ") || text.starts_with("GrblHAL ") => Answer::Greeting,
            // Start-up lines are answered behind this.
            _ if text.starts_with('[') || text.starts_with('>') => Answer::Known,
            _ => Answer::Unknown,
        }
    }

    fn limits(&self) -> MachineLimits {
        self.limits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hear(lines: &[&str]) -> (Answer, MachineLimits) {
        let mut grbl = Grbl::new(WriteOptions::default());
        let mut last = Answer::Unknown;
        for line in lines {
            last = grbl.hear(line.as_bytes());
        }
        (last, grbl.limits())
    }

    #[test]
    fn a_report_tells_the_place_on_the_sheet() {
        let at = |x, y, doing| Answer::Report(Report { doing: Some(doing), at: Some(Point::new(x, y)) });
        let reports = [
            (&["<Idle|MPos:1.000,2.500,0.000|FS:0,0>"][..], at(1.0, 2.5, Doing::Idle)),
            (
                &["<Idle|MPos:0,0,0|FS:0,0|WCO:-10.000,5.000,0>", "<Run|MPos:1,2,3>"],
                at(11.0, -3.0, Doing::Moves),
            ),
            (&["<Hold:0|WPos:1.000,2.000,0.000|Bf:15,128>"], at(1.0, 2.0, Doing::Held)),
            (&["<Hold:1|WPos:1,2>"], at(1.0, 2.0, Doing::Brakes)),
        ];
        for (lines, wanted) in reports {
            assert_eq!(hear(lines).0, wanted, "{lines:?}");
        }
        for line in ["<Idle|MPos:1.0x0,2,0>", "<Idel|MPos:1,2,0>", "<Idle|MPos:1,2,0", "okk", "error:x"] {
            assert_eq!(hear(&[line]).0, Answer::Unknown, "{line}");
        }
    }

    #[test]
    fn its_settings_are_its_limits() {
        let (_, limits) =
            hear(&["$100=80.000", "$110=3000.000", "$121=250.000", "$130=300.000 (mm)", "$20=1"]);
        assert_eq!(limits.steps_per_mm, [Some(80.0), None]);
        assert_eq!(limits.speed_mm_s, [Some(50.0), None]);
        assert_eq!(limits.acceleration_mm_s2, [None, Some(250.0)]);
        assert_eq!((limits.travel_mm[0], limits.refuses_beyond), (Some(300.0), Some(true)));
    }

    #[test]
    fn a_speed_is_reached_by_tens_and_ones() {
        let mut out = OpText::default();
        assert_eq!(Grbl::new(WriteOptions::default()).feed(100, 78, &mut out), Some(78));
        assert_eq!(out.as_bytes(), [0x92, 0x92, 0x94, 0x94]);
    }
}
