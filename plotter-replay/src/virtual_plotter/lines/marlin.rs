//! What Marlin's lines and answers are besides those of other machines: numbers and checksums, lines that are
//! asked for again, and a place that is told as it is planned.
//!
//! ```text
//! host     N5 G1 X10*45     N6 G1 X2?*91             N6 G1 X20*91
//! machine  ok               Error:checksum ..        ok
//!                           Resend: 6
//!                           ok (to no line)
//! ```
//!
//! Source: Marlin's documentation of its G-codes; `gcode/queue.cpp` of its source.

use super::super::{AnomalyKind, VirtualPlotter};
use super::Sent;
use plotter_motion::Point;

/// A line as the host has sent it, without number, checksum and comment.
pub(super) fn sent(line: &[u8]) -> Sent {
    let line = line.split(|byte| *byte == b';').next().unwrap_or(line).trim_ascii();
    let line = line.split(|byte| *byte == b'*').next().unwrap_or(line);
    let numbered = line.strip_prefix(b"N").or_else(|| line.strip_prefix(b"n"));
    let digits = numbered.map_or(0, |rest| rest.iter().take_while(|byte| byte.is_ascii_digit()).count());
    let Some((number, text)) = numbered.and_then(|rest| rest.split_at_checked(digits)) else {
        return Sent { number: None, text: line.to_vec() };
    };
    let number = core::str::from_utf8(number).ok().and_then(|number| number.parse().ok());
    Sent { number, text: text.trim_ascii().to_vec() }
}

/// Whether a line, in capitals, leads x and y home: both, where it names neither them nor the height.
pub(super) fn homed_axes(line: &[u8]) -> [bool; 2] {
    let Some(axes) = line.strip_prefix(b"G28").filter(|axes| !axes.first().is_some_and(u8::is_ascii_digit))
    else {
        return [false; 2];
    };
    let has = |axis: u8| axes.contains(&axis);
    let all = !(has(b'X') || has(b'Y') || has(b'Z'));
    [all || has(b'X'), all || has(b'Y')]
}

/// The place in an answer to `M114`.
fn told_place(answer: &str) -> Option<Point> {
    let number = |axis: &str| {
        let (_, behind) = answer.split_once(axis)?;
        behind.split(' ').next()?.parse().ok().filter(|mm: &f64| mm.abs() <= 1e6)
    };
    answer.starts_with("X:").then_some(())?;
    Some(Point::new(number("X:")?, number(" Y:")?))
}

/// The number of the line that is asked for again.
fn asked_again(answer: &str) -> Option<u64> {
    let number = answer.strip_prefix("Resend:").or_else(|| answer.strip_prefix("rs "))?;
    number.trim().trim_start_matches('N').parse().ok()
}

impl VirtualPlotter {
    pub(super) fn marlin_answer(&mut self, answer: &str) {
        let Some(lines) = &mut self.lines else { return };
        if answer == "ok" || answer.starts_with("ok ") {
            if !core::mem::take(&mut lines.asks_again) {
                let is_good = !core::mem::take(&mut lines.is_refused);
                self.answered(is_good, "error");
            }
        } else if let Some(at) = told_place(answer) {
            // Where the lines so far lead, which is where it is once they are drawn.
            match (lines.planned.is_empty(), lines.knows_place) {
                (true, true) => self.compare_place(at),
                (true, false) => self.begins_at(at),
                (false, _) => {}
            }
        } else if let Some(number) = asked_again(answer) {
            // It drops what has come behind that line, too; those before it are still answered.
            let is_dropped = |sent: &Sent| sent.number.is_some_and(|sent| sent >= number);
            let kept = lines.unanswered.iter().position(is_dropped).unwrap_or(lines.unanswered.len());
            lines.unanswered.truncate(kept);
            lines.asks_again = true;
        } else if answer.starts_with("echo:Unknown command") {
            lines.is_refused = true;
        } else if answer == "start" {
            // It was switched on, or reset: nothing of before will be drawn.
            lines.unanswered.clear();
            (lines.asks_again, lines.is_refused) = (false, false);
            self.forget_planned();
        } else if answer.starts_with("Error:") && answer.contains("halted") {
            lines.unanswered.clear();
            self.forget_planned();
            self.note(self.now, AnomalyKind::Alarm { number: 0 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_checksums_are_taken_off() {
        let of = |line: &str| {
            let sent = sent(line.as_bytes());
            (sent.number, String::from_utf8(sent.text).unwrap())
        };
        assert_eq!(of("N12 G1 X10 Y5*34"), (Some(12), String::from("G1 X10 Y5")));
        assert_eq!(of("G1 X10 ; to the right"), (None, String::from("G1 X10")));
        assert_eq!(of("; a comment"), (None, String::new()));
        assert_eq!(of("M117 No numbers"), (None, String::from("M117 No numbers")));
    }

    #[test]
    fn homing_names_its_axes_or_all() {
        assert_eq!(homed_axes(b"G28"), [true, true]);
        assert_eq!(homed_axes(b"G28 X"), [true, false]);
        assert_eq!(homed_axes(b"G28 Z"), [false, false]);
        assert_eq!(homed_axes(b"G280"), [false, false]);
    }

    #[test]
    fn places_and_questions_are_read() {
        let at = "X:4.00 Y:1.00 Z:0.00 E:0.00 Count X:80 Y:20 Z:0";
        assert_eq!(told_place(at), Some(Point::new(4.0, 1.0)));
        assert_eq!(told_place("echo:busy: processing"), None);
        assert_eq!(
            (asked_again("Resend: 6"), asked_again("rs N7"), asked_again("ok")),
            (Some(6), Some(7), None)
        );
    }
}
