//! [`Lines`]: a session of text, of Grbl, mDraw, Marlin or HPGL, as what the machine has drawn.
//!
//! A host's line counts once it is answered, and is carried out then by the interpreter that reads drawings.
//! What it draws is *planned*: nobody says when it is drawn. What the machine tells of itself bounds it:
//!
//! ```text
//! host     G1 X10    G1 X20    G1 X30    ?                               G4 P0
//! machine  ok        ok        ok        <Run|MPos:13.2,0,0|...>                     ok
//!          └─ planned ─────────────────┘ └ drawn up to 13.2 ┘ └ planned ┘            └ all is drawn
//! ```
//!
//! Where the log has the motors' steps, they are the way, and the lines only say where it should go.

mod carry_out;
mod hpgl_text;
mod marlin;

use super::{AnomalyKind, Reached, VirtualPlotter};
use core::time::Duration;
use hpgl_text::HpglText;
use plotter_motion::gcode::{Interpreter, PenConvention, ReadOptions, Reader, Spacing};
use plotter_motion::{Pen, PlotOp, Point, Segment, StepPoint, toolpath::chords};
use std::collections::VecDeque;

/// Which machine's lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Tongue {
    Grbl,
    MDraw,
    Marlin,
    Hpgl,
}

/// Facts about a session of text lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineCounts {
    /// Lines that the host sent; questions and orders of one byte are none.
    pub sent: u64,
    /// Lines that the machine has taken.
    pub accepted: u64,
    /// Lines that it has refused.
    pub refused: u64,
    /// Until when the machine has told where it was.
    pub told_until: Option<Duration>,
    /// Moves at the end that were taken, and of which nothing says that they were drawn.
    pub assumed: u64,
}

/// Bytes of a line that are kept.
const MOST_LINE: usize = 256;
/// Lines without an answer that are kept.
const MOST_UNANSWERED: usize = 4_096;
/// Lines that a machine has taken and not made, at most: queue and look-ahead of the largest are smaller.
const MOST_PLANNED_LINES: usize = 48;
/// The same of commands of HPGL: the 1024 bytes of a plotter's buffer, of which the shortest take four.
const MOST_PLANNED_COMMANDS: usize = 256;
/// How far from its way a machine may say to be, mm: the tenth of a millimetre by which paths are usually
/// rounded, and four steps of the documented machine.
const ON_WAY_MM: f64 = 0.15;
/// How far a corner is rounded at most, mm, twenty times as much as is usual: beyond it the machine is
/// elsewhere.
const NEAR_WAY_MM: f64 = 2.0;

/// By how many steps the motors lead away from a place that they have passed: a way drawn in whole steps
/// goes to and fro by one.
const PASSED_STEPS: f64 = 2.0;

/// A line of the host that is not answered yet.
#[derive(Clone, Debug)]
struct Sent {
    /// Its number, where it has one.
    number: Option<u64>,
    /// What it says, without number and checksum.
    text: Vec<u8>,
}

/// A straight move that is not made yet.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Planned {
    pen: Pen,
    number: u8,
    to: Point,
    /// The line that it comes from, counted from the first.
    line: u64,
}

/// What is known of a session of lines.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    tongue: Tongue,
    reader: Reader,
    interpreter: Interpreter,
    /// What HPGL is read by.
    hpgl: Option<Box<HpglText>>,
    /// The host's line so far.
    line: Vec<u8>,
    ended_by_return: bool,
    unanswered: VecDeque<Sent>,
    /// The machine's line so far.
    answer: Vec<u8>,
    /// Whether a machine that answers all lines alike has said that the one under way is wrong.
    is_refused: bool,
    /// Whether the next answer is to no line: Marlin has asked for one again.
    asks_again: bool,
    planned: VecDeque<Planned>,
    /// From when on what is planned was being drawn.
    since: Duration,
    /// How near the steps have come to the place that is under way, mm.
    nearest_mm: f64,
    knows_place: bool,
    last_report: Option<Duration>,
    last_answer: Option<Duration>,
    has_steps: bool,
    /// The pen that the lines have selected.
    pen_number: u8,
    counts: LineCounts,
}

impl Lines {
    pub(super) fn new(tongue: Tongue, pen: PenConvention, start: Option<Point>) -> Self {
        let pen = if tongue == Tongue::MDraw { PenConvention::MDRAW } else { pen };
        let spacing = if tongue == Tongue::MDraw { Spacing::Required } else { Spacing::default() };
        let mut interpreter = Interpreter::with_options(ReadOptions { pen, ..ReadOptions::default() });
        interpreter.stand_at(start.unwrap_or(Point::ORIGIN));
        Self {
            tongue,
            reader: Reader::with_spacing(spacing),
            interpreter,
            hpgl: (tongue == Tongue::Hpgl).then(Box::default),
            line: Vec::new(),
            ended_by_return: false,
            unanswered: VecDeque::new(),
            answer: Vec::new(),
            is_refused: false,
            asks_again: false,
            planned: VecDeque::new(),
            since: Duration::ZERO,
            nearest_mm: f64::INFINITY,
            knows_place: start.is_some(),
            last_report: None,
            last_answer: None,
            has_steps: false,
            pen_number: 0,
            counts: LineCounts::default(),
        }
    }
}

/// What a report of Grbl says: its state, and where it is.
fn report(line: &str) -> Option<(&str, Option<Point>)> {
    let inside = line.strip_prefix('<')?.strip_suffix('>')?;
    let mut fields = inside.split('|');
    let state = fields.next()?.split(':').next()?;
    let place = |text: &str| {
        let mut numbers = text.split(',').map(str::parse::<f64>);
        let (x, y) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
        (x.abs() <= 1e6 && y.abs() <= 1e6).then(|| Point::new(x, y))
    };
    let at = fields.find_map(|field| field.strip_prefix("MPos:").and_then(place));
    Some((state, at))
}

/// What mDraw's machine says of its place.
fn told_place(line: &str) -> Option<Point> {
    let (x, y) = line.strip_prefix("POS X")?.split_once(" Y")?;
    let (x, y): (f64, f64) = (x.parse().ok()?, y.trim().parse().ok()?);
    (x.abs() <= 1e6 && y.abs() <= 1e6).then(|| Point::new(x, y))
}

impl VirtualPlotter {
    /// Facts about a session of text lines; `None` for other protocols.
    #[must_use]
    pub fn line_counts(&self) -> Option<LineCounts> {
        self.lines.as_ref().map(|lines| lines.counts)
    }

    /// A motor made a step: from here on the steps are the way.
    pub(super) fn line_step(&mut self) {
        if let Some(lines) = &mut self.lines {
            lines.has_steps = true;
        }
        self.begin_planned();
        let (Some(target), Some(lines)) = (self.next, &mut self.lines) else { return };
        if self.counted == target {
            self.planned_reached();
            return;
        }
        // On a straight way to a place each step is nearer to it: one that leads away has passed it by. So do
        // corners that are rounded, and the machine's own chords of an arc.
        let away_mm = self.settings.to_sheet(self.counted).distance(self.settings.to_sheet(target));
        let step_mm = self.settings.x_mm_per_pulse.max(self.settings.y_mm_per_pulse);
        if away_mm <= lines.nearest_mm {
            lines.nearest_mm = away_mm;
        } else if lines.nearest_mm <= NEAR_WAY_MM && away_mm > lines.nearest_mm + PASSED_STEPS * step_mm {
            self.planned_passed(target);
        }
    }

    /// Takes a byte of the host.
    pub(super) fn host_line_byte(&mut self, byte: u8) {
        let Some(lines) = &mut self.lines else { return };
        if lines.tongue == Tongue::Hpgl {
            self.hpgl_byte(byte);
            return;
        }
        let is_grbl = lines.tongue == Tongue::Grbl;
        match byte {
            // A movement by hand ends where the machine says.
            0x85 if is_grbl => self.forget_planned(),
            b'?' | b'!' | b'~' | 0x80.. if is_grbl => {}
            0x18 if is_grbl => {
                lines.line.clear();
                lines.unanswered.clear();
                lines.reader = Reader::with_spacing(Spacing::default());
                self.forget_planned();
            }
            b'\n' if core::mem::take(&mut lines.ended_by_return) => {}
            b'\n' | b'\r' => {
                lines.ended_by_return = byte == b'\r';
                let line = core::mem::take(&mut lines.line);
                self.host_line(line);
            }
            _ => {
                lines.ended_by_return = false;
                if lines.line.len() < MOST_LINE {
                    lines.line.push(byte);
                }
            }
        }
    }

    fn host_line(&mut self, line: Vec<u8>) {
        let Some(lines) = &mut self.lines else { return };
        let sent = match lines.tongue {
            Tongue::Marlin => marlin::sent(&line),
            _ => Sent { number: None, text: line },
        };
        let is_empty = sent.text.trim_ascii().is_empty();
        if is_empty && lines.tongue == Tongue::Marlin {
            return; // it says nothing to that
        }
        lines.counts.sent = lines.counts.sent.saturating_add(u64::from(!is_empty));
        if lines.unanswered.len() >= MOST_UNANSWERED {
            lines.unanswered.pop_front();
        }
        if lines.planned.is_empty() {
            lines.since = self.now;
        }
        lines.unanswered.push_back(sent);
        // A machine of mDraw's answers when it has moved; its steps come before.
        if lines.tongue == Tongue::MDraw && lines.unanswered.len() == 1 {
            self.plan_mdraw();
        }
    }

    /// mDraw's machine begins with its line.
    fn plan_mdraw(&mut self) {
        let Some(lines) = &mut self.lines else { return };
        let Some(line) = lines.unanswered.front().cloned() else { return };
        lines.is_refused = false;
        self.plan(&line.text);
    }

    /// Takes a byte of the machine.
    pub(super) fn controller_line_byte(&mut self, byte: u8) {
        let Some(lines) = &mut self.lines else { return };
        if byte != b'\n' && byte != b'\r' {
            if lines.answer.len() < MOST_LINE {
                lines.answer.push(byte);
            }
            return;
        }
        if lines.answer.is_empty() {
            return;
        }
        // By far the most of them, without a copy.
        if lines.answer == b"ok" && lines.tongue == Tongue::Grbl {
            lines.answer.clear();
            self.answered(true, "ok");
            return;
        }
        let answer = core::mem::take(&mut lines.answer);
        let answer = String::from_utf8_lossy(&answer).trim().to_owned();
        match lines.tongue {
            Tongue::Grbl => self.grbl_answer(&answer),
            Tongue::MDraw => self.mdraw_answer(&answer),
            Tongue::Marlin => self.marlin_answer(&answer),
            // Answers to questions, of which it is not said what they are to.
            Tongue::Hpgl => {}
        }
    }

    fn grbl_answer(&mut self, answer: &str) {
        if let Some((state, at)) = report(answer) {
            match (state, at) {
                ("Idle" | "Sleep" | "Check", Some(at)) => self.stands_at(at),
                ("Alarm", Some(at)) => {
                    self.forget_planned();
                    self.stands_at(at);
                }
                // Homing goes its own way.
                ("Home", _) | (_, None) => {}
                (_, Some(at)) => self.passes(at),
            }
        } else if answer == "ok" {
            self.answered(true, answer);
        } else if answer.starts_with("error") {
            self.answered(false, answer);
        } else if let Some(alarm) = answer.strip_prefix("ALARM:") {
            self.note(self.now, AnomalyKind::Alarm { number: alarm.trim().parse().unwrap_or(0) });
        } else if answer.starts_with("Grbl ") {
            // It was switched on, or reset: nothing of before will be drawn.
            if let Some(lines) = &mut self.lines {
                lines.unanswered.clear();
            }
            self.forget_planned();
        } else if answer == "[MSG:Pgm End]" {
            self.all_drawn(self.now);
        }
    }

    fn mdraw_answer(&mut self, answer: &str) {
        let Some(lines) = &mut self.lines else { return };
        if let Some(at) = told_place(answer) {
            self.stands_at(at);
        } else if answer.starts_with("error") {
            lines.is_refused = true;
            lines.planned.clear();
            self.next = None;
        } else if answer.contains("OK") {
            let is_good = !lines.is_refused;
            self.answered(is_good, "error");
            self.plan_mdraw();
        }
    }

    /// The line that has waited longest is answered.
    fn answered(&mut self, is_good: bool, answer: &str) {
        let now = self.now;
        let Some(lines) = &mut self.lines else { return };
        lines.last_answer = Some(now);
        let Some(Sent { text: line, .. }) = lines.unanswered.pop_front() else { return };
        if line.trim_ascii().is_empty() {
            return;
        }
        if !is_good {
            lines.counts.refused = lines.counts.refused.saturating_add(1);
            let code = answer.rsplit(':').next().and_then(|code| code.trim().parse().ok()).unwrap_or(0);
            let line = String::from_utf8_lossy(&line).trim().to_owned();
            self.note(now, AnomalyKind::LineRefused { line, code });
            return;
        }
        lines.counts.accepted = lines.counts.accepted.saturating_add(1);
        let text = line.trim_ascii();
        let [x_homes, y_homes] = match lines.tongue {
            Tongue::Grbl => [text.eq_ignore_ascii_case(b"$H"); 2],
            Tongue::MDraw => [text.to_ascii_uppercase().starts_with(b"G28"); 2],
            Tongue::Marlin => marlin::homed_axes(&text.to_ascii_uppercase()),
            Tongue::Hpgl => [false; 2],
        };
        if x_homes || y_homes {
            if lines.tongue == Tongue::Marlin {
                self.all_drawn(now); // it is led home behind them
            }
            self.forget_planned();
            self.slack = super::Slack::default();
            let at = self.settings.to_sheet(self.counted);
            self.put_at(Point::new(if x_homes { 0.0 } else { at.x }, if y_homes { 0.0 } else { at.y }));
        } else if lines.tongue == Tongue::MDraw || self.plan(&line) {
            self.all_drawn(now);
        }
    }

    /// Takes into the plan what a line draws; says whether all is drawn when it is answered.
    fn plan(&mut self, line: &[u8]) -> bool {
        let now = self.now;
        let Some(lines) = &mut self.lines else { return false };
        let from = lines.interpreter.modes().position;
        let Ok((ops, waits)) = lines.carry_out(line) else {
            let line = String::from_utf8_lossy(line).trim().to_owned();
            self.note(now, AnomalyKind::LineNotUnderstood { line });
            return false;
        };
        let number = lines.counts.sent.saturating_sub(lines.unanswered.len() as u64);
        self.plan_ops(from, ops, number, MOST_PLANNED_LINES);
        waits
    }

    /// Takes into the plan what the line of this number draws from a place on; of lines farther back than
    /// `most_lines` all is drawn.
    fn plan_ops(&mut self, from: Point, ops: Vec<PlotOp>, number: u64, most_lines: usize) {
        let now = self.now;
        let tolerance_mm = 0.5 * self.settings.x_mm_per_pulse.min(self.settings.y_mm_per_pulse);
        let Some(lines) = &mut self.lines else { return };
        let mut added = 0_u64;
        for op in chords([PlotOp::Travel { to: from }].into_iter().chain(ops), tolerance_mm).skip(1) {
            if let PlotOp::SelectPen { pen } = op {
                lines.pen_number = pen;
            }
            let pen = if matches!(op, PlotOp::Draw { .. }) { Pen::Down } else { Pen::Up };
            if let Some(to) = op.target() {
                lines.planned.push_back(Planned { pen, number: lines.pen_number, to, line: number });
                added = added.saturating_add(1);
            }
        }
        self.target_count = self.target_count.saturating_add(added);
        let first = lines.planned.front().map_or(number, |planned| planned.line);
        let drawn = usize::try_from(number.saturating_sub(first)).unwrap_or(0);
        if drawn > most_lines {
            let until = number.saturating_sub(most_lines as u64);
            let count = lines.planned.iter().take_while(|planned| planned.line < until).count();
            self.draw(count, now);
        }
        self.begin_planned();
    }

    /// Takes a byte of a host that speaks HPGL.
    fn hpgl_byte(&mut self, byte: u8) {
        let now = self.now;
        let Some(lines) = &mut self.lines else { return };
        let Some(hpgl) = &mut lines.hpgl else { return };
        let Some(read) = hpgl.push(byte) else { return };
        lines.counts.sent = lines.counts.sent.saturating_add(u64::from(read.is_command));
        if lines.planned.is_empty() {
            lines.since = now;
        }
        let number = lines.counts.sent;
        for line in read.not_understood {
            self.note(now, AnomalyKind::LineNotUnderstood { line });
        }
        self.plan_ops(read.from, read.ops, number, MOST_PLANNED_COMMANDS);
    }

    /// The plan's next place is where the pen goes now.
    fn begin_planned(&mut self) {
        if self.next.is_some() {
            return;
        }
        let Some(planned) = self.lines.as_ref().and_then(|lines| lines.planned.front().copied()) else {
            return;
        };
        let target = self.settings.to_counts(planned.to);
        self.next = Some(target);
        if let Some(lines) = &mut self.lines {
            lines.nearest_mm = f64::INFINITY;
        }
        self.under_way = 1;
        if !self.pen_recorded {
            self.set_pen(planned.pen);
        }
        self.set_pen_number(planned.number);
        self.leg.target = Some(target);
        if self.targets.len() < self.settings.max_entries {
            self.targets.push((self.now, target));
        }
        if self.counted == target && self.lines.as_ref().is_some_and(|lines| lines.has_steps) {
            self.planned_reached();
        }
    }

    /// The place that is under way is reached.
    fn planned_reached(&mut self) {
        if let Some(lines) = &mut self.lines {
            lines.planned.pop_front();
            // Its lines name places: where it was before matters no more.
            lines.knows_place = true;
        }
        self.target_reached();
        self.begin_planned();
    }

    /// The motors have passed the place that is under way without having stood in it.
    fn planned_passed(&mut self, target: StepPoint) {
        if let Some(lines) = &mut self.lines {
            lines.planned.pop_front();
            lines.knows_place = true;
        }
        let (time, actual) = (self.now, self.counted);
        let error = StepPoint::new(actual.x.saturating_sub(target.x), actual.y.saturating_sub(target.y));
        (self.next, self.under_way, self.from) = (None, 0, target);
        self.reached_count = self.reached_count.saturating_add(1);
        self.end_leg(Some(Reached { time, desired: target, actual, error, resync_error: error }));
        self.begin_planned();
    }

    /// All that is planned is drawn by `until`.
    fn all_drawn(&mut self, until: Duration) {
        let count = self.lines.as_ref().map_or(0, |lines| lines.planned.len());
        self.draw(count, until);
        if let Some(lines) = &mut self.lines {
            lines.counts.told_until = Some(until);
        }
    }

    /// The next `count` moves of the plan are drawn by `until`: evenly from when they may have begun.
    fn draw(&mut self, count: usize, until: Duration) {
        let at = self.settings.to_sheet(self.counted);
        let Some(lines) = &self.lines else { return };
        let since = lines.since.min(until);
        let has_steps = lines.has_steps;
        let way = |from: &mut Point, to: Point| Some(core::mem::replace(from, to).distance(to));
        let lengths: Vec<f64> =
            lines.planned.iter().take(count).scan(at, |from, planned| way(from, planned.to)).collect();
        let total: f64 = lengths.iter().sum();
        let (now, mut done) = (self.now, 0.0);
        for length in lengths {
            done += length;
            let share = if total > 0.0 { done / total } else { 1.0 };
            self.now = since.saturating_add(until.saturating_sub(since).mul_f64(share.clamp(0.0, 1.0)));
            self.begin_planned();
            let Some(target) = self.next else { break };
            if !has_steps {
                self.counted = target;
                self.add_point();
            }
            if self.counted == target {
                self.planned_reached();
            } else {
                // Its steps have passed it by, as those of a rounded corner do.
                self.next = None;
                self.from = target;
                if let Some(lines) = &mut self.lines {
                    lines.planned.pop_front();
                }
            }
        }
        self.now = now;
        if let Some(lines) = &mut self.lines {
            lines.since = until;
        }
    }

    /// The machine stands at `at`, and has nothing more to do.
    fn stands_at(&mut self, at: Point) {
        let Some(lines) = &mut self.lines else { return };
        lines.last_report = Some(self.now);
        if !lines.knows_place && lines.planned.is_empty() {
            self.begins_at(at);
            return;
        }
        // What lies unanswered may be in its hands by now.
        if lines.unanswered.is_empty() || lines.tongue == Tongue::MDraw {
            self.all_drawn(self.now);
        }
        self.compare_place(at);
    }

    /// The machine says to be at `at`, on its way.
    fn passes(&mut self, at: Point) {
        let counted = self.settings.to_sheet(self.counted);
        let now = self.now;
        let Some(lines) = &mut self.lines else { return };
        lines.last_report = Some(now);
        lines.counts.told_until = Some(now);
        if lines.has_steps {
            return;
        }
        let mut from = counted;
        let mut nearest: Option<(f64, usize)> = None;
        for (index, planned) in lines.planned.iter().enumerate() {
            let away = Segment::new(from, planned.to).distance(at);
            from = planned.to;
            if nearest.is_none_or(|(least, _)| away < least - ON_WAY_MM) {
                nearest = Some((away, index));
            }
            if away <= ON_WAY_MM {
                break;
            }
        }
        match nearest {
            Some((away, index)) if away <= NEAR_WAY_MM => {
                lines.knows_place = true;
                // The part of the last move counts with its own length.
                self.draw(index, now);
                self.begin_planned();
                self.counted = self.settings.to_counts(at);
                self.add_point();
            }
            _ if !lines.knows_place => self.begins_at(at),
            _ => self.compare_place(at),
        }
    }

    /// What the machine says of its place is compared with where it should be, and believed.
    fn compare_place(&mut self, at: Point) {
        let reported = self.settings.to_counts(at);
        let off = StepPoint::new(
            reported.x.saturating_sub(self.counted.x),
            reported.y.saturating_sub(self.counted.y),
        );
        let away = at.distance(self.settings.to_sheet(self.counted));
        if away > ON_WAY_MM + self.settings.x_mm_per_pulse {
            self.note(self.now, AnomalyKind::ReportedElsewhere { off });
            self.put_at(at);
        }
    }

    /// The recording begins with the pen at `at`.
    fn begins_at(&mut self, at: Point) {
        if let Some(lines) = &mut self.lines {
            lines.knows_place = true;
            lines.interpreter.stand_at(at);
        }
        self.put_at(at);
    }

    /// The pen is at `at` without having drawn its way there.
    fn put_at(&mut self, at: Point) {
        let counted = self.settings.to_counts(at);
        if let Some(lines) = &mut self.lines {
            lines.knows_place = true;
            if lines.planned.is_empty() {
                lines.interpreter.stand_at(at);
            }
        }
        self.end_leg(None);
        (self.counted, self.from) = (counted, counted);
        self.leg = self.begin_leg();
    }

    /// Nothing of what is planned will be drawn.
    fn forget_planned(&mut self) {
        if let Some(lines) = &mut self.lines {
            lines.planned.clear();
        }
        self.next = None;
        self.end_leg(None);
    }

    /// The recording is over.
    pub(super) fn finish_lines(&mut self) {
        let Some(lines) = &mut self.lines else { return };
        let unanswered = lines.unanswered.iter().filter(|line| !line.text.trim_ascii().is_empty()).count();
        if unanswered > 0 && lines.last_answer.is_none() {
            // Only one side was recorded: all of it is taken as it is.
            while let Some(line) = self.lines.as_mut().and_then(|lines| lines.unanswered.pop_front()) {
                self.plan(&line.text);
            }
        } else if unanswered > 0 {
            self.note(self.now, AnomalyKind::Unanswered { lines: unanswered as u64 });
        }
        let Some(lines) = &mut self.lines else { return };
        // A machine that was on its way when it was heard last has not drawn what comes after that.
        let is_told = lines.last_report.is_some_and(|told| lines.last_answer.is_none_or(|last| told > last));
        let left = lines.planned.len() as u64;
        if left == 0 || lines.has_steps {
            return;
        }
        if is_told {
            self.note(self.now, AnomalyKind::NotKnownDrawn { moves: left });
            self.forget_planned();
        } else {
            lines.counts.assumed = left;
            let count = lines.planned.len();
            self.draw(count, self.now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_read() {
        let at = Some(Point::new(62.617, 35.933));
        assert_eq!(report("<Run|MPos:62.617,35.933,0.000|Bf:0,11|FS:5400,0>"), Some(("Run", at)));
        assert_eq!(report("<Hold:0|WPos:1,2,3>"), Some(("Hold", None)));
        assert_eq!(report("<Idle|MPos:nan,0,0>"), Some(("Idle", None)));
        assert_eq!(report("ok"), None);
        assert_eq!(told_place("POS X3.00 Y4.00"), Some(Point::new(3.0, 4.0)));
        assert_eq!(told_place("POS X3.00"), None);
    }
}
